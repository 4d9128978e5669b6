//! From correlations to a realisation (A, C) at every order: block Toeplitz, one SVD, one QR.

use crate::linalg::{LinalgError, Mat};
use crate::signal::Correlations;

/// Directions beside the highest order's that are carried along to a neighbouring matrix.
const OVERSAMPLED: usize = 20;

/// The column space of a Toeplitz matrix of correlations.
pub(super) struct Subspace {
    /// Of the Toeplitz matrix, descending.
    pub singular_values: Vec<f64>,
    u: Mat,
    v: Mat,
    channels: usize,
}

/// One order's matrices, of normalised channels.
pub(super) struct Realisation {
    /// n × n.
    pub a: Mat,
    /// channels × n.
    pub c: Mat,
    /// n × channels: Λ_k = C A^{k−1} G.
    pub g: Mat,
}

impl Subspace {
    /// By one SVD of the Toeplitz matrix of so many block rows.
    pub fn new(r: &Correlations, block_rows: usize) -> Result<Self, LinalgError> {
        Self::of(&block_toeplitz(r, block_rows), r.channels())
    }

    fn of(matrix: &Mat, channels: usize) -> Result<Self, LinalgError> {
        let (rows, size) = (matrix.nrows(), matrix.nrows().min(matrix.ncols()));
        let svd = matrix
            .thin_svd()
            .map_err(|_| LinalgError::NoConvergence { what: "the Toeplitz matrix's SVD", order: rows })?;
        let singular_values: Vec<f64> = (0..size).map(|k| svd.S().column_vector()[k]).collect();
        Ok(Self { singular_values, u: svd.U().to_owned(), v: svd.V().to_owned(), channels })
    }

    /// The highest even order that the matrix has the rank for: below rounding of the largest singular value there is
    /// no direction left to realise.
    pub fn rank(&self) -> usize {
        let floor = self.singular_values[0] * self.u.nrows() as f64 * f64::EPSILON;
        let rank = self.singular_values.iter().take_while(|s| **s > floor).count();
        rank - rank % 2
    }

    /// (A, C, G) at these ascending orders.
    pub fn realisations(&self, orders: &[usize]) -> Vec<Realisation> {
        let Some(&top) = orders.last() else { return Vec::new() };
        let (s, size) = (&self.singular_values, self.u.nrows());
        // O = U S^{1/2}
        let o = Mat::from_fn(size, top, |i, k| self.u[(i, k)] * s[k].sqrt());
        // Γ = S^{1/2} Vᵀ = [A^{i−1}G … G]
        let last = size - self.channels;
        let g = Mat::from_fn(top, self.channels, |k, j| self.v[(last + j, k)] * s[k].sqrt());
        nested(&o, &g, orders)
    }

    /// The realisations of other correlations that differ little from these: their leading subspace is found from this
    /// one by two steps of subspace iteration, which leave of its error the product of (s_{p+1}/s_n)⁴ and what it was.
    pub fn near(&self, r: &Correlations, orders: &[usize]) -> Result<Vec<Realisation>, LinalgError> {
        let size = self.u.nrows();
        let toeplitz = block_toeplitz(r, size / self.channels);
        let p = (orders.last().copied().unwrap_or(0) + OVERSAMPLED).min(size);
        let left = (&toeplitz * self.v.subcols(0, p)).qr().compute_thin_Q();
        let right = (toeplitz.transpose() * &left).qr().compute_thin_Q();
        let left = (&toeplitz * &right).qr().compute_thin_Q();
        let small = Self::of(&(left.transpose() * &toeplitz * &right), self.channels)?;
        let Self { singular_values, u, v, channels } = small;
        Ok(Self { singular_values, u: left * u, v: right * v, channels }.realisations(orders))
    }
}

/// T with the blocks Λ_{i+r−c}, 0 ≤ r, c < i, where Λ_k[a, b] = E[y_a(t + k) y_b(t)] = R_ba(k).
fn block_toeplitz(r: &Correlations, block_rows: usize) -> Mat {
    let l = r.channels();
    Mat::from_fn(block_rows * l, block_rows * l, |row, col| {
        r.at(col % l, row % l, block_rows + row / l - col / l)
    })
}

/// A_n minimising ‖O↑ A_n − O↓‖ over the leading n columns, for every n of `orders` from one QR of O↑ at the highest order.
///
/// O↑ = QR nests: its first n columns are Q_n R_n, so A_n = R_n⁻¹ (Qᵀ O↓)_n.
fn nested(o: &Mat, g: &Mat, orders: &[usize]) -> Vec<Realisation> {
    let channels = g.ncols();
    let rows = o.nrows() - channels;
    let up = o.subrows(0, rows).to_owned();
    let qr = up.qr();
    let s = qr.compute_thin_Q().transpose() * o.subrows(channels, rows);
    let r = qr.thin_R();
    orders
        .iter()
        .map(|&n| {
            let mut a = s.submatrix(0, 0, n, n).to_owned();
            for col in 0..n {
                for i in (0..n).rev() {
                    let sum: f64 = (i + 1..n).map(|k| r[(i, k)] * a[(k, col)]).sum();
                    a[(i, col)] = (a[(i, col)] - sum) / r[(i, i)];
                }
            }
            let c = o.submatrix(0, 0, channels, n).to_owned();
            Realisation { a, c, g: g.subrows(0, n).to_owned() }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::solve;

    #[test]
    fn the_nested_orders_are_the_separate_least_squares() {
        let (l, rows) = (2, 24);
        let o = Mat::from_fn(rows, 8, |i, j| ((i * i * 7 + j * 13 + i * j * 5) % 19) as f64 - 9.0);
        let g = Mat::zeros(8, l);
        for (k, realisation) in nested(&o, &g, &[2, 4, 6, 8]).iter().enumerate() {
            let n = 2 * k + 2;
            let up = o.submatrix(0, 0, rows - l, n);
            let down = o.submatrix(l, 0, rows - l, n);
            // the normal equations are well-conditioned enough here
            let a = solve(&(up.transpose() * up), &(up.transpose() * down)).unwrap();
            assert!((&realisation.a - a).norm_l2() < 1e-11, "order {n}");
            assert!((&realisation.c - o.submatrix(0, 0, l, n)).norm_l2() == 0.0);
        }
    }
}
