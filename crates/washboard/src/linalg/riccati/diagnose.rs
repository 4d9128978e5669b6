//! Why no stabilising solution was found: an eigenvalue that the input does not reach, or one on the boundary.

use super::super::dense::{C64, CMat, Mat, eigen, solve_complex};
use super::super::quasi_triangular::Equation;
use super::super::schur::RealSchur;
use super::doubling::hamiltonian;
use super::error::RiccatiError;
use super::schur_route;

/// An eigenvalue of A counts as out of reach below this many n ε of the norm of [A, B].
const OUT_OF_REACH_EPSILONS: f64 = 100.0;
/// Eigenvalues of A within this share of its norm may be on the axis, doubled or trebled there and parted by rounding.
const NEAR_THE_AXIS: f64 = 1e-4;
/// Two eigenvalues that meet on the boundary are known to √ε only.
const ON_THE_BOUNDARY: f64 = 1e-7;
/// A real part below this many n ε times the eigenvalue's condition, entry by entry, may be rounding.
const INDISTINCT_EPSILONS: f64 = 10.0;

/// What counts as on the boundary.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Nearness {
    /// Near, by the size of the matrix: explains why nothing was found.
    Near,
    /// Not to be told from it, by the eigenvalue's own condition: refutes a solution that was found.
    Indistinct,
}

/// The least reachable eigenvalue of A on or beyond the boundary of stability, if it is out of reach.
///
/// `g` is G, or any matrix with the column space of B.
pub(super) fn unreachable(equation: Equation, a: &Mat, g: &Mat) -> Option<RiccatiError> {
    let (n, m) = (a.nrows(), g.ncols());
    let (na, ng) = (a.norm_l2(), g.norm_l2());
    let size = na + if ng > 0.0 { na.max(f64::MIN_POSITIVE) } else { 0.0 };
    if !(size > 0.0) {
        // A = 0: continuous, on the axis, and out of reach where B lacks rank
        return (equation == Equation::Continuous && n > 0 && ng == 0.0)
            .then_some(RiccatiError::NotStabilisable { eigenvalue: C64::new(0.0, 0.0), distance: 0.0 });
    }
    // B to the size of A: units of the input do not matter
    let weight = if ng > 0.0 { na.max(f64::MIN_POSITIVE) / ng } else { 0.0 };
    let tolerance = OUT_OF_REACH_EPSILONS * n as f64 * f64::EPSILON;
    let values = RealSchur::new(a).ok()?.eigenvalues();
    let mut worst: Option<(C64, f64)> = None;
    for z in values {
        let unstable = match equation {
            Equation::Continuous => z.re >= -tolerance * na,
            Equation::Discrete => z.norm() >= 1.0 - tolerance,
        };
        if !unstable || z.im < 0.0 {
            continue;
        }
        let pencil = CMat::from_fn(n, n + m, |i, j| {
            if j >= n {
                C64::new(g[(i, j - n)] * weight, 0.0)
            } else {
                C64::new(a[(i, j)], 0.0) - if i == j { z } else { C64::new(0.0, 0.0) }
            }
        });
        let least = pencil.singular_values().ok()?.last().copied()?;
        let distance = least / size;
        if worst.is_none_or(|w| distance < w.1) {
            worst = Some((z, distance));
        }
    }
    let (eigenvalue, distance) = worst?;
    (distance <= tolerance).then_some(RiccatiError::NotStabilisable { eigenvalue, distance })
}

/// A mode of A on the axis that H does not see, if there is one: of a definite equation the only obstacle beside
/// [`unreachable`].
///
/// Every eigenvalue near the axis is looked at where it would be on it: a double one, known to √ε only, is found there.
pub(super) fn unseen(a: &Mat, h: &Mat) -> Option<RiccatiError> {
    let (n, p) = (a.nrows(), h.nrows());
    let (na, nh) = (a.norm_l2(), h.norm_l2());
    let size = if na > 0.0 { na } else { 1.0 };
    let weight = if nh > 0.0 { size / nh } else { 0.0 };
    let tolerance = OUT_OF_REACH_EPSILONS * n as f64 * f64::EPSILON;
    let near = |z: &C64| z.im >= 0.0 && z.re.abs() <= NEAR_THE_AXIS * size;
    let values = RealSchur::new(a).ok()?.eigenvalues();
    let distance = |omega: f64| {
        let pencil = CMat::from_fn(n + p, n, |i, j| match i.checked_sub(n) {
            Some(k) => C64::new(h[(k, j)] * weight, 0.0),
            None => C64::new(a[(i, j)], if i == j { -omega } else { 0.0 }),
        });
        Some((omega, pencil.singular_values().ok()?.last()? / size))
    };
    let worst = values
        .iter()
        .filter(|z| near(z))
        .filter_map(|z| distance(z.im))
        .min_by(|x, y| x.1.total_cmp(&y.1))?;
    (worst.1 <= tolerance).then_some(RiccatiError::OnTheBoundary { frequency: worst.0, distance: worst.1 })
}

/// The Hamiltonian's (the symplectic pencil's) eigenvalue nearest to the boundary, if it is on it.
pub(super) fn boundary(
    equation: Equation,
    a: &Mat,
    g: &Mat,
    q: &Mat,
    nearness: Nearness,
) -> Option<RiccatiError> {
    if equation == Equation::Discrete {
        return on_the_circle(a, g, q);
    }
    let h = hamiltonian(a, g, q);
    let size = h.norm_l2();
    let share = |re: f64| if size > 0.0 { re.abs() / size } else { 0.0 };
    match nearness {
        Nearness::Near => {
            let values = schur_route::eigenvalues(&h).ok()?;
            let nearest = values.iter().min_by(|x, y| x.re.abs().total_cmp(&y.re.abs()))?;
            let (frequency, distance) = (nearest.im.abs(), share(nearest.re));
            (distance <= ON_THE_BOUNDARY).then_some(RiccatiError::OnTheBoundary { frequency, distance })
        }
        Nearness::Indistinct => {
            let n = h.nrows();
            let (values, v) = eigen(&h).ok()?;
            let left = solve_complex(&v, &CMat::identity(n, n)).ok()?;
            let rounding = INDISTINCT_EPSILONS * n as f64 * f64::EPSILON;
            // |Re λ| over the eigenvalue's condition for changes of H entry by entry, |yᴴ||H||x| / |yᴴx|; yᴴx = 1 as the
            // rows of V⁻¹ have it
            let margin = |k: usize| {
                let change: f64 = (0..n)
                    .flat_map(|j| (0..n).map(move |i| (i, j)))
                    .map(|(i, j)| left[(k, i)].norm() * h[(i, j)].abs() * v[(j, k)].norm())
                    .sum();
                if change > 0.0 { values[k].re.abs() / change } else { 0.0 }
            };
            let worst = (0..n).min_by(|i, j| margin(*i).total_cmp(&margin(*j)))?;
            let (frequency, distance) = (values[worst].im.abs(), share(values[worst].re));
            (!(margin(worst) > rounding)).then_some(RiccatiError::OnTheBoundary { frequency, distance })
        }
    }
}

/// The symplectic pencil's eigenvalue nearest to the unit circle, if it is on it.
fn on_the_circle(a: &Mat, g: &Mat, q: &Mat) -> Option<RiccatiError> {
    // no (M + L)⁻¹: z = −1 is an eigenvalue
    let Ok(s) = schur_route::cayley(a, g, q) else {
        return Some(RiccatiError::OnTheBoundary { frequency: std::f64::consts::PI, distance: 0.0 });
    };
    let values = schur_route::eigenvalues(&s).ok()?;
    let one = C64::new(1.0, 0.0);
    let z = |s: C64| (one + s) / (one - s);
    let far = |s: C64| (z(s).norm() - 1.0).abs();
    let nearest = values.iter().copied().min_by(|x, y| far(*x).total_cmp(&far(*y)))?;
    let (frequency, distance) = (z(nearest).arg().abs(), far(nearest));
    (distance <= ON_THE_BOUNDARY).then_some(RiccatiError::OnTheBoundary { frequency, distance })
}
