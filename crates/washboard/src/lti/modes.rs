//! Modes of a non-proportionally damped system by its state space: poles, frequencies, damping ratios and shapes.

use super::{MechanicsError, SecondOrder};
use crate::linalg::{C64, LinalgError, eigen};
use std::f64::consts::TAU;

/// A pole below this share of the largest one is a rigid mode's. A double zero pole is perturbed by rounding to about
/// √ε of the largest, 1.5e-8, times a modest constant; the slowest mode of a vehicle is 1e-3 of its fastest.
const RIGID_TOLERANCE: f64 = 1e-6;
/// Singular values of K below this share of the largest belong to rigid motions.
const NULL_TOLERANCE: f64 = 1e-11;
/// An imaginary part below this share of |λ| is rounding: critical damping splits a double pole by √ε.
const REAL_TOLERANCE: f64 = 1e-9;

/// What sort of motion a mode is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ModeKind {
    /// A conjugate pair of poles.
    Oscillatory,
    /// A real pole.
    Overdamped,
    /// A motion without stiffness.
    Rigid,
}

/// One mode: a conjugate pair (the pole with Im λ > 0), a real pole, or a rigid motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Mode {
    /// λ, 1/s.
    pub pole: C64,
    /// |λ|/2π.
    pub freq_hz: f64,
    /// |Im λ|/2π.
    pub damped_hz: f64,
    /// −Re λ/|λ|; 0 for a rigid motion.
    pub damping: f64,
    /// Oscillatory, overdamped or rigid.
    pub kind: ModeKind,
    /// Displacements q of the mode, scaled so that the largest is 1.
    pub shape: Vec<C64>,
}

impl Mode {
    /// The mode of a pole and a shape.
    #[must_use]
    pub fn new(pole: C64, kind: ModeKind, shape: Vec<C64>) -> Self {
        let size = pole.norm();
        let damping = if size > 0.0 { -pole.re / size } else { 0.0 };
        Mode {
            pole,
            freq_hz: size / TAU,
            damped_hz: pole.im.abs() / TAU,
            damping,
            kind,
            shape: unit_largest(shape),
        }
    }
}

/// A shape divided by its largest component.
fn unit_largest(shape: Vec<C64>) -> Vec<C64> {
    let largest = shape
        .iter()
        .copied()
        .fold(C64::new(0.0, 0.0), |a, b| if b.norm() > a.norm() * (1.0 + 1e-9) { b } else { a });
    if largest.norm() == 0.0 { shape } else { shape.into_iter().map(|z| z / largest).collect() }
}

/// All modes, ascending in |λ|: one entry a conjugate pair, one a real pole, one a rigid motion.
///
/// λ and ψ solve (λ²M + λC + K)ψ = 0. Rigid motions are the null space of K, so that the double zero pole of a free
/// body, whose eigenvectors coincide, has independent shapes.
///
/// # Errors
/// An iteration that does not converge.
///
/// Source: De Filippis et al., eqs. (12)–(20).
pub fn modes(system: &SecondOrder) -> Result<Vec<Mode>, MechanicsError> {
    let n = system.order();
    let (poles, vectors) = eigen(&system.state_matrix()?)?;
    let largest = poles.iter().map(|p| p.norm()).fold(0.0, f64::max);
    let mut found = rigid_motions(system)?;
    let floor = if found.is_empty() { 0.0 } else { RIGID_TOLERANCE * largest };
    for (index, pole) in poles.iter().enumerate() {
        if pole.norm() <= floor || pole.im < -REAL_TOLERANCE * pole.norm() {
            continue;
        }
        let shape: Vec<C64> = (0..n).map(|i| vectors[(i, index)]).collect();
        if pole.im > REAL_TOLERANCE * pole.norm() {
            found.push(Mode::new(*pole, ModeKind::Oscillatory, shape));
        } else {
            found.push(Mode::new(C64::new(pole.re, 0.0), ModeKind::Overdamped, shape));
        }
    }
    found.sort_by(|a, b| a.freq_hz.total_cmp(&b.freq_hz));
    Ok(found)
}

/// The null space of K, one mode a dimension, with the pole at zero.
fn rigid_motions(system: &SecondOrder) -> Result<Vec<Mode>, MechanicsError> {
    let n = system.order();
    let svd = system.k().svd().map_err(|_| LinalgError::NoConvergence { what: "the SVD", order: n })?;
    let s = svd.S().column_vector();
    let scale = s[0];
    Ok((0..n)
        .filter(|&i| s[i] <= NULL_TOLERANCE * scale)
        .map(|i| {
            let shape = (0..n).map(|r| C64::new(svd.V()[(r, i)], 0.0)).collect();
            Mode::new(C64::new(0.0, 0.0), ModeKind::Rigid, shape)
        })
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::Mat;

    fn single(m: f64, c: f64, k: f64) -> Vec<Mode> {
        let one = |v| Mat::from_fn(1, 1, |_, _| v);
        modes(&SecondOrder::new(one(m), one(c), one(k)).unwrap()).unwrap()
    }

    #[test]
    fn one_degree_of_freedom_in_closed_form() {
        let found = single(2.0, 2.4, 200.0);
        assert_eq!(found.len(), 1);
        assert!((found[0].freq_hz - 10.0 / TAU).abs() < 1e-12);
        assert!((found[0].damping - 0.06).abs() < 1e-12);
        assert_eq!(found[0].kind, ModeKind::Oscillatory);
        assert!((found[0].damped_hz / found[0].freq_hz - (1.0f64 - 0.0036).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn an_overdamped_oscillator_has_two_real_poles() {
        let found = single(1.0, 5.0, 4.0); // λ = −1, −4
        assert_eq!(found.iter().map(|m| m.kind).collect::<Vec<_>>(), [ModeKind::Overdamped; 2]);
        assert!((found[0].pole.re + 1.0).abs() < 1e-12 && (found[1].pole.re + 4.0).abs() < 1e-12);
        assert_eq!(found[0].damping, 1.0);
    }

    #[test]
    fn a_free_chain_has_one_rigid_motion_with_equal_displacements() {
        let m = Mat::from_fn(3, 3, |i, j| if i == j { 1.0 + i as f64 } else { 0.0 });
        let l = [[1.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 1.0]];
        let c = Mat::from_fn(3, 3, |i, j| 0.3 * l[i][j]);
        let k = Mat::from_fn(3, 3, |i, j| 1000.0 * l[i][j]);
        let found = modes(&SecondOrder::new(m, c, k).unwrap()).unwrap();
        let kinds: Vec<_> = found.iter().map(|m| m.kind).collect();
        assert_eq!(kinds, [ModeKind::Rigid, ModeKind::Oscillatory, ModeKind::Oscillatory]);
        assert!(found[0].shape.iter().all(|z| (z - C64::new(1.0, 0.0)).norm() < 1e-9));
    }

    #[test]
    fn every_mode_solves_the_quadratic_eigenvalue_problem() {
        let n = 4;
        let m = Mat::from_fn(n, n, |i, j| if i == j { 2.0 + i as f64 } else { 0.2 });
        let c = Mat::from_fn(n, n, |i, j| if i == j { 3.0 * (1.0 + i as f64) } else { -0.5 });
        let k = Mat::from_fn(n, n, |i, j| if i == j { 900.0 } else { -200.0 + 10.0 * (i + j) as f64 });
        let system = SecondOrder::new(m, c, k).unwrap();
        for mode in modes(&system).unwrap() {
            for i in 0..n {
                let row: C64 = (0..n)
                    .map(|j| {
                        let (m, c, k) = (system.m()[(i, j)], system.c()[(i, j)], system.k()[(i, j)]);
                        (mode.pole * mode.pole * m + mode.pole * c + C64::new(k, 0.0)) * mode.shape[j]
                    })
                    .sum();
                assert!(row.norm() < 1e-9, "row {i} of {:?}: {row}", mode.pole);
            }
        }
    }
}
