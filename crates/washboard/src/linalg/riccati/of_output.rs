//! The Riccati equation of ∫ |C x + D u|² dt: definite by construction, from factors that are never squared and subtracted.

use super::super::dense::{LinalgError, Mat, check_square};
use super::care::{Factors, solve};
use super::input::{average, check};
use super::{RiccatiError, RiccatiSolution};

/// D counts as without full column rank below this many m ε of its smallest over its largest singular value, with columns
/// of length 1.
const SINGULAR_EPSILONS: f64 = 10.0;

/// The stabilising X ≥ 0 of [`care`](super::care) with Q = CᵀC, R = DᵀD, S = CᵀD: u = +F x minimises ∫ |C x + D u|² dt.
///
/// | symbol | shape | what |
/// |---|---|---|
/// | `a`, `b` | n × n, n × m | (A, B) stabilisable |
/// | `c`, `d` | p × n, p × m | D of full column rank |
///
/// With D = Q₁R₁ and \[Q₁ Q₂\] orthogonal the equation is that of A − BR₁⁻¹Q₁ᵀC, G = BR₁⁻¹(BR₁⁻¹)ᵀ and Q = (Q₂ᵀC)ᵀQ₂ᵀC: no
/// Q − SR⁻¹Sᵀ is formed, which would keep nothing of a performance that is small beside what the input can cancel
/// (measurements of little noise, in the dual). X exists exactly where B reaches every unstable mode and Q₂ᵀC sees every mode
/// on the axis, and that is what is tested, however near to the axis the closed loop is.
///
/// # Errors
/// As [`care`](super::care); a D without full column rank is [`RiccatiError::SingularR`] with the square of its smallest over
/// its largest singular value, columns of length 1.
///
/// Source: Zhou, Doyle, Glover, *Robust and Optimal Control*, corollary 13.10 for existence.
///
/// ```
/// use washboard::linalg::{Mat, care_of_output};
/// // ẋ = x + u, ∫ 3x² + u²: X² − 2X − 3 = 0, X = 3, F = −3
/// let one = |v: f64| Mat::from_fn(1, 1, |_, _| v);
/// let c = Mat::from_fn(2, 1, |i, _| if i == 0 { 3f64.sqrt() } else { 0.0 });
/// let d = Mat::from_fn(2, 1, |i, _| i as f64);
/// let solution = care_of_output(&one(1.0), &one(1.0), &c, &d)?;
/// assert!((solution.x[(0, 0)] - 3.0).abs() < 1e-14);
/// assert!((solution.gain[(0, 0)] + 3.0).abs() < 1e-14);
/// # Ok::<(), washboard::linalg::RiccatiError>(())
/// ```
pub fn care_of_output(a: &Mat, b: &Mat, c: &Mat, d: &Mat) -> Result<RiccatiSolution, RiccatiError> {
    let n = check_square("A", a)?;
    let (p, m) = (c.nrows(), b.ncols());
    check("A", a, (n, n))?;
    check("B", b, (n, m))?;
    check("C", c, (p, n))?;
    check("D", d, (p, m))?;
    // columns of length 1: units of the inputs do not matter
    let lengths: Vec<f64> = (0..m).map(|j| d.subcols(j, 1).norm_l2()).collect();
    if p < m || lengths.contains(&0.0) {
        return Err(RiccatiError::SingularR { ratio: 0.0 });
    }
    let unit = Mat::from_fn(p, m, |i, j| d[(i, j)] / lengths[j]);
    let b_unit = Mat::from_fn(n, m, |i, j| b[(i, j)] / lengths[j]);
    let qr = unit.qr();
    let (q, r) = (qr.compute_Q(), qr.thin_R().to_owned());
    let values = r.singular_values().map_err(|_| LinalgError::NoConvergence { what: "the SVD", order: m })?;
    if let (Some(most), Some(least)) = (values.first(), values.last())
        && !(*least > SINGULAR_EPSILONS * m as f64 * f64::EPSILON * most)
    {
        return Err(RiccatiError::SingularR { ratio: (least / most).powi(2) });
    }
    let over_r = |rhs: Mat| {
        let mut rhs = rhs;
        r.as_ref().solve_upper_triangular_in_place(rhs.as_mut());
        rhs
    };
    let mut half_b = b_unit.transpose().to_owned();
    r.transpose().solve_lower_triangular_in_place(half_b.as_mut());
    let cancelled = q.subcols(0, m).transpose() * c;
    let left = q.subcols(m, p - m).transpose() * c;
    let mut g = half_b.transpose() * &half_b;
    average(&mut g);
    let mut weight = left.transpose() * &left;
    average(&mut weight);
    let a_left = a - half_b.transpose() * &cancelled;
    let factors = Factors { reach: half_b.transpose().to_owned(), seen: Some(left) };
    let solution = solve(&a_left, &g, &weight, Some(&factors))?;
    let unscaled = over_r(&half_b * &solution.x + cancelled);
    let gain = Mat::from_fn(m, n, |i, j| -unscaled[(i, j)] / lengths[i]);
    Ok(RiccatiSolution { gain, ..solution })
}
