//! Dense real and complex matrices, and the factorisations that may fail said as `Result`.

use faer::linalg::solvers::Solve;
use thiserror::Error;

/// A real matrix, f64, column-major.
pub type Mat = faer::Mat<f64>;
/// A complex scalar.
pub type C64 = faer::c64;
/// A complex matrix.
pub type CMat = faer::Mat<C64>;

/// What a factorisation or equation solver refuses.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum LinalgError {
    /// A matrix has the wrong shape.
    #[error("{name}: expected shape {expected:?}, found {found:?}")]
    Shape {
        /// Which matrix.
        name: &'static str,
        /// Rows and columns that were expected.
        expected: (usize, usize),
        /// Rows and columns that were given.
        found: (usize, usize),
    },
    /// An entry is NaN or infinite.
    #[error("{name}: entry ({row}, {col}) is {value}, expected a finite number")]
    NotFinite {
        /// Which matrix.
        name: &'static str,
        /// Row of the first such entry.
        row: usize,
        /// Column of the first such entry.
        col: usize,
        /// The entry.
        value: f64,
    },
    /// An iteration did not converge.
    #[error("{what} did not converge for a matrix of order {order}")]
    NoConvergence {
        /// Which iteration.
        what: &'static str,
        /// Order of the matrix.
        order: usize,
    },
    /// The equation has no unique solution, or none that the residual confirms.
    #[error("{what}: {why} (measured {value:e})")]
    Singular {
        /// Which equation.
        what: &'static str,
        /// In words.
        why: &'static str,
        /// The number that shows it.
        value: f64,
    },
}

/// Refuses a matrix with a NaN or an infinity.
pub(crate) fn check_finite(name: &'static str, a: &Mat) -> Result<(), LinalgError> {
    for col in 0..a.ncols() {
        for row in 0..a.nrows() {
            if !a[(row, col)].is_finite() {
                return Err(LinalgError::NotFinite { name, row, col, value: a[(row, col)] });
            }
        }
    }
    Ok(())
}

/// Refuses a matrix that is not square.
pub(crate) fn check_square(name: &'static str, a: &Mat) -> Result<usize, LinalgError> {
    if a.nrows() == a.ncols() {
        Ok(a.nrows())
    } else {
        Err(LinalgError::Shape { name, expected: (a.nrows(), a.nrows()), found: (a.nrows(), a.ncols()) })
    }
}

/// Eigenvalues and right eigenvectors of a real square matrix: A V = V diag(λ).
///
/// # Errors
/// A matrix that is not square or not finite; an iteration that does not converge.
pub fn eigen(a: &Mat) -> Result<(Vec<C64>, CMat), LinalgError> {
    let order = check_square("A", a)?;
    check_finite("A", a)?;
    let e = a.eigen().map_err(|_| LinalgError::NoConvergence { what: "the QR algorithm", order })?;
    let values = (0..order).map(|i| e.S().column_vector()[i]).collect();
    Ok((values, e.U().to_owned()))
}

/// Eigenvalues of a real symmetric matrix, ascending.
///
/// # Errors
/// A matrix that is not square or not finite; an iteration that does not converge.
pub fn symmetric_eigenvalues(a: &Mat) -> Result<Vec<f64>, LinalgError> {
    let order = check_square("A", a)?;
    check_finite("A", a)?;
    a.self_adjoint_eigenvalues(faer::Side::Lower)
        .map_err(|_| LinalgError::NoConvergence { what: "the symmetric QR algorithm", order })
}

/// X with A X = B, by LU with partial pivoting.
///
/// # Errors
/// Shapes that do not fit, and an A that is singular to working precision.
pub fn solve(a: &Mat, b: &Mat) -> Result<Mat, LinalgError> {
    let n = check_square("A", a)?;
    if b.nrows() != n {
        return Err(LinalgError::Shape {
            name: "B",
            expected: (n, b.ncols()),
            found: (b.nrows(), b.ncols()),
        });
    }
    let x = a.partial_piv_lu().solve(b);
    match check_finite("X", &x) {
        Ok(()) => Ok(x),
        Err(_) => Err(LinalgError::Singular { what: "A X = B", why: "A is singular", value: 0.0 }),
    }
}

/// X with A X = B for complex matrices, by LU with partial pivoting.
///
/// # Errors
/// Shapes that do not fit, and an A that is singular to working precision.
pub fn solve_complex(a: &CMat, b: &CMat) -> Result<CMat, LinalgError> {
    if a.nrows() != a.ncols() || b.nrows() != a.nrows() {
        return Err(LinalgError::Shape {
            name: "B",
            expected: (a.ncols(), b.ncols()),
            found: (b.nrows(), b.ncols()),
        });
    }
    let x = a.partial_piv_lu().solve(b);
    let finite =
        (0..x.ncols()).all(|j| (0..x.nrows()).all(|i| x[(i, j)].re.is_finite() && x[(i, j)].im.is_finite()));
    if finite {
        Ok(x)
    } else {
        Err(LinalgError::Singular { what: "A X = B", why: "A is singular", value: 0.0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eigen_pairs_satisfy_their_equation() {
        let a = Mat::from_fn(5, 5, |i, j| ((3 * i + 7 * j) % 11) as f64 - 4.0);
        let (values, vectors) = eigen(&a).unwrap();
        for (k, lambda) in values.iter().enumerate() {
            for i in 0..5 {
                let mut av = C64::new(0.0, 0.0);
                for j in 0..5 {
                    av += vectors[(j, k)] * a[(i, j)];
                }
                assert!((av - lambda * vectors[(i, k)]).norm() < 1e-12);
            }
        }
    }

    #[test]
    fn a_singular_matrix_is_refused() {
        let a = Mat::from_fn(2, 2, |_, _| 1.0);
        assert!(solve(&a, &Mat::identity(2, 2)).is_err());
        assert!(solve(&Mat::identity(2, 3), &a).is_err());
    }
}
