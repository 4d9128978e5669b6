//! Singular values, rank and an estimate of the condition number.

use super::dense::{LinalgError, Mat, check_finite, check_square};
use faer::linalg::solvers::Solve;

/// Steps of the estimator; it almost always ends after two.
const STEPS: usize = 5;

/// Singular values, descending: as many as the smaller side.
///
/// # Errors
/// Entries that are not finite; an iteration that does not converge.
pub fn singular_values(a: &Mat) -> Result<Vec<f64>, LinalgError> {
    check_finite("A", a)?;
    let order = a.nrows().max(a.ncols());
    a.singular_values()
        .map_err(|_| LinalgError::NoConvergence { what: "the singular value decomposition", order })
}

/// The number of singular values above `tolerance` times the largest: 0 for a zero matrix.
///
/// max(rows, cols) · ε is the tolerance at which rounding of the entries themselves can't be told from rank.
///
/// # Errors
/// As [`singular_values`].
///
/// ```
/// use washboard::linalg::{Mat, rank};
/// let a = Mat::from_fn(3, 3, |i, j| (i + j) as f64); // [0 1 2; 1 2 3; 2 3 4]
/// assert_eq!(rank(&a, 1e-12)?, 2);
/// # Ok::<(), washboard::linalg::LinalgError>(())
/// ```
pub fn rank(a: &Mat, tolerance: f64) -> Result<usize, LinalgError> {
    let values = singular_values(a)?;
    let largest = values.first().copied().unwrap_or(0.0);
    Ok(values.into_iter().filter(|s| *s > tolerance * largest && *s > 0.0).count())
}

/// A lower bound of ‖A‖₁‖A⁻¹‖₁, almost always within a factor of three; infinite where A is singular.
///
/// # Errors
/// A matrix that is not square or not finite.
///
/// Source: Hager (1984); Higham, *FORTRAN codes for estimating the one-norm*, ACM TOMS 14 (1988), algorithm 4.1.
///
/// ```
/// use washboard::linalg::{Mat, condition_estimate};
/// let a = Mat::from_fn(2, 2, |i, j| if i == j { [1.0, 1e-6][i] } else { 0.0 });
/// assert!((condition_estimate(&a)? / 1e6 - 1.0).abs() < 1e-9);
/// # Ok::<(), washboard::linalg::LinalgError>(())
/// ```
pub fn condition_estimate(a: &Mat) -> Result<f64, LinalgError> {
    let n = check_square("A", a)?;
    check_finite("A", a)?;
    if n == 0 {
        return Ok(1.0);
    }
    let lu = a.partial_piv_lu();
    let size = |x: &Mat| x.col_as_slice(0).iter().map(|v| v.abs()).sum::<f64>();
    let norm = (0..n).map(|j| a.col_as_slice(j).iter().map(|v| v.abs()).sum::<f64>()).fold(0.0, f64::max);
    let mut x = Mat::from_fn(n, 1, |_, _| 1.0 / n as f64);
    let mut estimate = 0.0;
    let mut visited = n;
    for _ in 0..STEPS {
        let y = lu.solve(&x);
        let found = size(&y);
        if !found.is_finite() {
            return Ok(f64::INFINITY);
        }
        if found <= estimate {
            break;
        }
        estimate = found;
        let z = lu.solve_transpose(Mat::from_fn(n, 1, |i, _| 1f64.copysign(y[(i, 0)])));
        let best = (0..n).fold(0, |b, i| if z[(i, 0)].abs() > z[(b, 0)].abs() { i } else { b });
        let reached: f64 = (0..n).map(|i| z[(i, 0)] * x[(i, 0)]).sum();
        if best == visited || z[(best, 0)].abs() <= reached {
            break;
        }
        visited = best;
        x = Mat::from_fn(n, 1, |i, _| f64::from(i == best));
    }
    // Higham's safeguard against cancellation
    let alternating = Mat::from_fn(n, 1, |i, _| {
        let slope = 1.0 + i as f64 / (n.max(2) - 1) as f64;
        if i % 2 == 0 { slope } else { -slope }
    });
    let other = 2.0 * size(&lu.solve(&alternating)) / (3.0 * n as f64);
    let condition = norm * estimate.max(other);
    Ok(if condition.is_nan() { f64::INFINITY } else { condition })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::solve;
    use crate::linalg::test_matrices::{all, random};

    #[test]
    fn the_estimate_is_near_the_condition_and_never_above() {
        for (name, a) in all() {
            let n = a.nrows();
            let estimate = condition_estimate(&a).unwrap();
            if n == 0 || estimate > 1e12 {
                continue;
            }
            let inverse = solve(&a, &Mat::identity(n, n)).unwrap();
            let one =
                |m: &Mat| (0..n).map(|j| (0..n).map(|i| m[(i, j)].abs()).sum::<f64>()).fold(0.0, f64::max);
            let exact = one(&a) * one(&inverse);
            assert!(
                estimate <= exact * (1.0 + 1e-6) && estimate >= exact / 3.0,
                "{name}: {estimate:e} {exact:e}"
            );
        }
        assert_eq!(condition_estimate(&Mat::zeros(3, 3)).unwrap(), f64::INFINITY);
        assert!(condition_estimate(&Mat::zeros(3, 2)).is_err());
    }

    #[test]
    fn rank_counts_directions() {
        let a = random(7, 3, 1) * random(3, 9, 2);
        assert_eq!(rank(&a, 1e-12).unwrap(), 3);
        assert_eq!(singular_values(&a).unwrap().len(), 7);
        assert_eq!(rank(&Mat::zeros(4, 2), 1e-12).unwrap(), 0);
        assert_eq!(rank(&Mat::zeros(0, 2), 1e-12).unwrap(), 0);
        assert!(rank(&Mat::from_fn(1, 1, |_, _| f64::NAN), 0.0).is_err());
    }
}
