//! Why no stabilising solution was found: an eigenvalue that the input does not reach, or one on the boundary.

use super::super::dense::{C64, CMat, Mat};
use super::super::quasi_triangular::Equation;
use super::super::schur::RealSchur;
use super::doubling::hamiltonian;
use super::error::RiccatiError;
use super::schur_route;

/// An eigenvalue of A counts as out of reach below this many n ε of the norm of [A, B].
const OUT_OF_REACH_EPSILONS: f64 = 100.0;
/// Two eigenvalues that meet on the boundary are known to √ε only.
const ON_THE_BOUNDARY: f64 = 1e-7;

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

/// The Hamiltonian's (the symplectic pencil's) eigenvalue nearest to the boundary, if it is on it.
pub(super) fn boundary(equation: Equation, a: &Mat, g: &Mat, q: &Mat) -> Option<RiccatiError> {
    let (frequency, distance) = match equation {
        Equation::Continuous => {
            let h = hamiltonian(a, g, q);
            let size = h.norm_l2();
            let values = schur_route::eigenvalues(&h).ok()?;
            let nearest = values.iter().min_by(|x, y| x.re.abs().total_cmp(&y.re.abs()))?;
            let distance = if size > 0.0 { nearest.re.abs() / size } else { 0.0 };
            (nearest.im.abs(), distance)
        }
        Equation::Discrete => {
            // no (M + L)⁻¹: z = −1 is an eigenvalue
            let Ok(s) = schur_route::cayley(a, g, q) else {
                return Some(RiccatiError::OnTheBoundary { frequency: std::f64::consts::PI, distance: 0.0 });
            };
            let values = schur_route::eigenvalues(&s).ok()?;
            let one = C64::new(1.0, 0.0);
            let z = |s: C64| (one + s) / (one - s);
            let far = |s: C64| (z(s).norm() - 1.0).abs();
            let nearest = values.iter().copied().min_by(|x, y| far(*x).total_cmp(&far(*y)))?;
            (z(nearest).arg().abs(), far(nearest))
        }
    };
    (distance <= ON_THE_BOUNDARY).then_some(RiccatiError::OnTheBoundary { frequency, distance })
}
