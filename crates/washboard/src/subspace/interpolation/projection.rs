//! Stage one: the data matrix freed of what any input could explain, (3.38)–(3.49).

use super::super::SubspaceError;
use super::basis::{Basis, Kind};
use super::conditions::Condition;
use crate::linalg::{C64, LinalgError, Mat};

/// The observability range in a basis of polynomials: block row i is C φ_i(A).
pub(super) struct Range {
    /// Left singular vectors of R₂₂, pq rows.
    pub u: Mat,
    pub singular_values: Vec<f64>,
    pub basis: Basis,
}

impl Range {
    /// From conditions on all rows of G: p, m and q block rows.
    ///
    /// # Errors
    /// An SVD that does not converge.
    pub fn new(
        conditions: &[Condition],
        (p, m): (usize, usize),
        q: usize,
        kind: Kind,
    ) -> Result<Self, SubspaceError> {
        let basis = Basis::new(conditions, q, kind);
        let q = basis.len();
        let mut stacked = Mat::zeros(columns(conditions), q * (m + p));
        let mut row = 0;
        for (k, c) in conditions.iter().enumerate() {
            for (l, weight) in c.weights.iter().enumerate() {
                for column in 0..c.right.ncols() {
                    for i in 0..q {
                        let phi = &basis.phi[i][k];
                        let mut put = |at: usize, x: C64| {
                            stacked[(row, at)] = weight * x.re;
                            if !c.real {
                                stacked[(row + 1, at)] = weight * x.im;
                            }
                        };
                        for b in 0..m {
                            put(i * m + b, phi[l] * c.right[(b, column)]); // F, eq. (3.40)
                        }
                        for a in 0..p {
                            // Leibniz on φ_i G, eq. (3.23), over l!
                            let x = (0..=l).map(|j| phi[l - j] * c.series[j][(a, column)]).sum();
                            put(q * m + i * p + a, x);
                        }
                    }
                    row += c.parts();
                }
            }
        }
        let r = stacked.qr().thin_R().to_owned(); // eq. (3.46), transposed
        let left = r.nrows().saturating_sub(q * m);
        let r22 = Mat::from_fn(p * q, left, |i, j| if j <= i { r[(q * m + j, q * m + i)] } else { 0.0 });
        let failed = |_| LinalgError::NoConvergence { what: "the SVD", order: p * q };
        let svd = r22.thin_svd().map_err(failed)?; // eq. (3.49)
        let singular_values = (0..left.min(p * q)).map(|i| svd.S()[i]).collect();
        Ok(Self { u: svd.U().to_owned(), singular_values, basis })
    }
}

/// Real columns of the data matrix: mN of (3.43), conjugates counted once.
pub(super) fn columns(conditions: &[Condition]) -> usize {
    conditions.iter().map(|c| c.series.len() * c.right.ncols() * c.parts()).sum()
}
