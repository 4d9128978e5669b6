//! The linear-quadratic regulator and, its dual, the Kalman filter.

use super::SynthesisError;
use crate::linalg::{Mat, RiccatiSolution, care, care_of_output};

/// u = F x, optimal for a quadratic cost.
#[derive(Debug, Clone)]
pub struct Regulator {
    /// F, inputs × states: u = +F x.
    pub gain: Mat,
    /// The equation's solution: the cost from x₀ is x₀ᵀX x₀.
    pub solution: RiccatiSolution,
}

/// A stationary observer, x̂' = A x̂ + B u + L (C x̂ + D u − y).
#[derive(Debug, Clone)]
pub struct Filter {
    /// L, states × measurements; A + L C is stable.
    pub gain: Mat,
    /// The equation's solution: X is the covariance of x − x̂.
    pub solution: RiccatiSolution,
}

/// The regulator that minimises ∫ xᵀQx + 2xᵀS u + uᵀR u dt for ẋ = A x + B u.
///
/// F = −R⁻¹(BᵀX + Sᵀ) with AᵀX + XA − (XB + S)R⁻¹(BᵀX + Sᵀ) + Q = 0.
///
/// | symbol | shape | what |
/// |---|---|---|
/// | `a`, `b` | n × n, n × m | the system |
/// | `q`, `r`, `s` | n × n, m × m, n × m | weights; R positive definite, [Q S; Sᵀ R] positive semidefinite |
///
/// # Errors
/// Shapes, weights that are not symmetric, an R that is not positive definite, a system that is not stabilisable or has
/// an unweighted mode on the axis: each with the matrix and the number.
///
/// ```
/// use washboard::linalg::Mat;
/// use washboard::synthesis::lqr;
/// // ẋ = u with the cost ∫ 4x² + u² dt: u = −2x
/// let one = |x: f64| Mat::from_fn(1, 1, |_, _| x);
/// let found = lqr(&one(0.0), &one(1.0), &one(4.0), &one(1.0), None)?;
/// assert!((found.gain[(0, 0)] + 2.0).abs() < 1e-12);
/// # Ok::<(), washboard::synthesis::SynthesisError>(())
/// ```
pub fn lqr(a: &Mat, b: &Mat, q: &Mat, r: &Mat, s: Option<&Mat>) -> Result<Regulator, SynthesisError> {
    let solution =
        care(a, b, q, r, s).map_err(|source| SynthesisError::Riccati { equation: "control", source })?;
    Ok(Regulator { gain: solution.gain.clone(), solution })
}

/// The Kalman filter of ẋ = A x + w, y = C x + v: the regulator of the dual system.
///
/// | symbol | shape | what |
/// |---|---|---|
/// | `a`, `c` | n × n, p × n | the system |
/// | `w`, `v`, `cross` | n × n, p × p, n × p | intensities of w, of v, and of w with v |
///
/// # Errors
/// As [`lqr`], of Aᵀ and Cᵀ.
pub fn kalman(a: &Mat, c: &Mat, w: &Mat, v: &Mat, cross: Option<&Mat>) -> Result<Filter, SynthesisError> {
    let (at, ct) = (a.transpose().to_owned(), c.transpose().to_owned());
    let solution = care(&at, &ct, w, v, cross)
        .map_err(|source| SynthesisError::Riccati { equation: "filter", source })?;
    Ok(Filter { gain: solution.gain.transpose().to_owned(), solution })
}

/// The regulator that minimises ∫ |C x + D u|² dt for ẋ = A x + B u: [`lqr`] with CᵀC, DᵀD, CᵀD, without squaring them.
///
/// `c` is p × n, `d` p × m of full column rank. Existence is decided by what B reaches and C sees, so that closed loops very
/// near the axis (zeros almost on it) are found too.
///
/// # Errors
/// As [`lqr`].
pub fn lqr_of_output(a: &Mat, b: &Mat, c: &Mat, d: &Mat) -> Result<Regulator, SynthesisError> {
    let solution = care_of_output(a, b, c, d)
        .map_err(|source| SynthesisError::Riccati { equation: "control", source })?;
    Ok(Regulator { gain: solution.gain.clone(), solution })
}

/// The Kalman filter of ẋ = A x + B w, y = C x + D w with white w of intensity 1: the dual of [`lqr_of_output`].
///
/// `b` is n × m, `d` p × m of full row rank.
///
/// # Errors
/// As [`lqr_of_output`], of the dual system.
pub fn kalman_of_input(a: &Mat, c: &Mat, b: &Mat, d: &Mat) -> Result<Filter, SynthesisError> {
    let turned = |m: &Mat| m.transpose().to_owned();
    let solution = care_of_output(&turned(a), &turned(c), &turned(b), &turned(d))
        .map_err(|source| SynthesisError::Riccati { equation: "filter", source })?;
    Ok(Filter { gain: turned(&solution.gain), solution })
}
