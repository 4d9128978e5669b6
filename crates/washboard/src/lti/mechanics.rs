//! A mechanical system M q̈ + C q̇ + K q = f with a positive definite mass matrix.

use crate::linalg::{C64, CMat, LinalgError, Mat, solve, symmetric_eigenvalues};
use thiserror::Error;

/// Relative asymmetry of M that is put down to rounding in a file's digits.
const SYMMETRY_TOLERANCE: f64 = 1e-9;

/// What is refused of a mechanical system.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum MechanicsError {
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
    /// M is not symmetric.
    #[error("the mass matrix is not symmetric: m[{row}][{col}] = {upper}, m[{col}][{row}] = {lower}")]
    MassNotSymmetric {
        /// Row.
        row: usize,
        /// Column.
        col: usize,
        /// Entry (row, col).
        upper: f64,
        /// Entry (col, row).
        lower: f64,
    },
    /// M is not positive definite.
    #[error("the mass matrix is not positive definite: its smallest eigenvalue is {smallest:e}")]
    MassNotPositive {
        /// The smallest eigenvalue of M.
        smallest: f64,
    },
    /// The state matrix has no complete set of eigenvectors to working precision.
    #[error(
        "the system cannot be written in modal form: its eigenvector matrix has condition number {condition:e} \
         (expected below {limit:e}); repeated poles without independent shapes"
    )]
    Defective {
        /// Condition number of the eigenvector matrix.
        condition: f64,
        /// The largest that is accepted.
        limit: f64,
    },
    /// Linear algebra refused.
    #[error(transparent)]
    Linalg(#[from] LinalgError),
}

/// M q̈ + C q̇ + K q = f: M symmetric positive definite, C and K any (n × n), SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct SecondOrder {
    m: Mat,
    c: Mat,
    k: Mat,
}

impl SecondOrder {
    /// The system of three n × n matrices.
    ///
    /// # Errors
    /// Shapes that differ, entries that are not finite, an M that is not symmetric positive definite.
    pub fn new(m: Mat, c: Mat, k: Mat) -> Result<Self, MechanicsError> {
        let n = m.nrows();
        for (name, a) in [("m", &m), ("c", &c), ("k", &k)] {
            if a.nrows() != n || a.ncols() != n || n == 0 {
                let found = (a.nrows(), a.ncols());
                return Err(MechanicsError::Shape { name, expected: (n.max(1), n.max(1)), found });
            }
            crate::linalg::check_finite(name, a)?;
        }
        let scale = m.norm_max();
        for row in 0..n {
            for col in 0..row {
                let (upper, lower) = (m[(row, col)], m[(col, row)]);
                if (upper - lower).abs() > SYMMETRY_TOLERANCE * scale {
                    return Err(MechanicsError::MassNotSymmetric { row, col, upper, lower });
                }
            }
        }
        // scaled to unit diagonal, so that kg beside kg·m² does not decide
        let mut smallest = (0..n).map(|i| m[(i, i)]).fold(f64::INFINITY, f64::min);
        if smallest > 0.0 {
            let scaled = Mat::from_fn(n, n, |i, j| m[(i, j)] / (m[(i, i)] * m[(j, j)]).sqrt());
            smallest = symmetric_eigenvalues(&scaled)?[0];
        }
        if smallest <= f64::EPSILON {
            return Err(MechanicsError::MassNotPositive { smallest });
        }
        Ok(SecondOrder { m, c, k })
    }

    /// Number of degrees of freedom n.
    #[must_use]
    pub fn order(&self) -> usize {
        self.m.nrows()
    }

    /// Mass matrix.
    #[must_use]
    pub fn m(&self) -> &Mat {
        &self.m
    }

    /// Damping matrix.
    #[must_use]
    pub fn c(&self) -> &Mat {
        &self.c
    }

    /// Stiffness matrix.
    #[must_use]
    pub fn k(&self) -> &Mat {
        &self.k
    }

    /// The state matrix [0 I; −M⁻¹K −M⁻¹C] of x = [q; q̇] (2n × 2n).
    ///
    /// # Errors
    /// An M that is singular to working precision.
    pub fn state_matrix(&self) -> Result<Mat, MechanicsError> {
        let n = self.order();
        let (mk, mc) = (solve(&self.m, &self.k)?, solve(&self.m, &self.c)?);
        Ok(Mat::from_fn(2 * n, 2 * n, |i, j| match (i < n, j < n) {
            (true, _) => f64::from(u8::from(j == i + n)),
            (false, true) => -mk[(i - n, j)],
            (false, false) => -mc[(i - n, j - n)],
        }))
    }

    /// The dynamic stiffness −ω²M + iωC + K, whose inverse is the receptance G(ω) of De Filippis et al., eq. (51).
    #[must_use]
    pub fn dynamic_stiffness(&self, omega_rad_s: f64) -> CMat {
        let n = self.order();
        let w2 = omega_rad_s * omega_rad_s;
        CMat::from_fn(n, n, |i, j| {
            C64::new(self.k[(i, j)] - w2 * self.m[(i, j)], omega_rad_s * self.c[(i, j)])
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mass_matrix_that_is_not_positive_definite_is_refused_with_its_eigenvalue() {
        let one = Mat::identity(2, 2);
        let m = Mat::from_fn(2, 2, |i, j| if i == j { 1.0 } else { 2.0 });
        let e = SecondOrder::new(m, one.clone(), one.clone()).unwrap_err();
        assert!(
            matches!(e, MechanicsError::MassNotPositive { smallest } if (smallest + 1.0).abs() < 1e-12),
            "{e}"
        );
        let m = Mat::from_fn(2, 2, |i, j| if i == j { 1.0 } else { 0.1 * i as f64 });
        assert!(matches!(
            SecondOrder::new(m, one.clone(), one.clone()),
            Err(MechanicsError::MassNotSymmetric { .. })
        ));
        assert!(matches!(
            SecondOrder::new(one.clone(), Mat::identity(3, 3), one),
            Err(MechanicsError::Shape { name: "c", .. })
        ));
    }

    #[test]
    fn kilograms_beside_small_inertias_are_accepted() {
        let m = Mat::from_fn(2, 2, |i, j| if i != j { 0.0 } else { [1e5, 1e-14][i] });
        assert!(SecondOrder::new(m, Mat::zeros(2, 2), Mat::identity(2, 2)).is_ok());
    }
}
