//! Stage one: the data matrix freed of what any input could explain, (3.38)–(3.49).

use super::super::SubspaceError;
use super::basis::{Basis, Kind};
use super::conditions::Condition;
use crate::linalg::{C64, LinalgError, Mat};

/// F lacks rank where a pivot is below this share of the largest.
const DEPENDENT: f64 = 1e-11;

/// The observability range in a basis of polynomials: block row i is C φ_i(A).
pub(super) struct Range {
    /// R₂₂ of (3.46), pq rows: lower triangular.
    pub r22: Mat,
    /// Its left singular vectors.
    pub u: Mat,
    pub singular_values: Vec<f64>,
    /// Norm of the data: what singular values are rounding of.
    pub size: f64,
    pub basis: Basis,
    /// Least over largest pivot of what inputs could explain: F has full rank where it is not 0.
    pivots: f64,
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
        let size = r.subcols(q * m, p * q).norm_l2();
        let r22 = Mat::from_fn(p * q, left, |i, j| if j <= i { r[(q * m + j, q * m + i)] } else { 0.0 });
        let failed = |_| LinalgError::NoConvergence { what: "the SVD", order: p * q };
        let svd = r22.thin_svd().map_err(failed)?; // eq. (3.49)
        let singular_values = (0..left.min(p * q)).map(|i| svd.S()[i]).collect();
        let pivot = |i: usize| r[(i, i)].abs();
        let explained = (q * m).min(r.nrows());
        let (low, high) =
            (0..explained).map(pivot).fold((f64::INFINITY, 0.0f64), |(l, h), x| (l.min(x), h.max(x)));
        let u = svd.U().to_owned();
        Ok(Self { u, r22, singular_values, size, basis, pivots: low / high })
    }

    /// In orthogonal polynomials, q lowered until F has full rank: directions may have few nodes each.
    ///
    /// # Errors
    /// As [`Range::new`].
    pub fn explained(
        conditions: &[Condition],
        size: (usize, usize),
        q: usize,
    ) -> Result<Self, SubspaceError> {
        let mut q = q;
        loop {
            let range = Self::new(conditions, size, q, Kind::Orthogonal)?;
            q = range.basis.len();
            if q <= 1 || range.pivots > DEPENDENT {
                return Ok(range);
            }
            q -= 1;
        }
    }
}

/// Real columns of the data matrix: mN of (3.43), conjugates counted once.
pub(super) fn columns(conditions: &[Condition]) -> usize {
    conditions.iter().map(|c| c.series.len() * c.right.ncols() * c.parts()).sum()
}
