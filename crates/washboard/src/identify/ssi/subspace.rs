//! From correlations to a realisation (A, C) at every order: block Toeplitz, one SVD, one QR.

use super::{SsiError, SsiSettings};
use crate::linalg::{LinalgError, Mat};
use crate::signal::Correlations;

/// The realisations of all orders.
pub(super) struct Realisations {
    /// By ascending order.
    pub orders: Vec<Realisation>,
    /// Of the Toeplitz matrix, descending.
    pub singular_values: Vec<f64>,
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

/// (A, C) at the even orders from `min_order` to `max_order`, as far as the correlations have that rank.
pub(super) fn realisations(r: &Correlations, settings: &SsiSettings) -> Result<Realisations, SsiError> {
    let toeplitz = block_toeplitz(r, settings.block_rows);
    let size = toeplitz.nrows();
    let svd = toeplitz
        .svd()
        .map_err(|_| LinalgError::NoConvergence { what: "the Toeplitz matrix's SVD", order: size })?;
    let singular_values: Vec<f64> = (0..size).map(|k| svd.S().column_vector()[k]).collect();
    // below rounding of the largest there is no direction left to realise
    let floor = singular_values[0] * size as f64 * f64::EPSILON;
    let rank = singular_values.iter().take_while(|s| **s > floor).count();
    let top = settings.max_order.min(rank - rank % 2);
    // O = U S^{1/2}
    let u = svd.U();
    let o = Mat::from_fn(size, top, |i, k| u[(i, k)] * singular_values[k].sqrt());
    // Γ = S^{1/2} Vᵀ = [A^{i−1}G … G]
    let (v, last) = (svd.V(), size - r.channels());
    let g = Mat::from_fn(top, r.channels(), |k, j| v[(last + j, k)] * singular_values[k].sqrt());
    Ok(Realisations { orders: nested(&o, &g, settings.min_order, top), singular_values })
}

/// T with the blocks Λ_{i+r−c}, 0 ≤ r, c < i, where Λ_k[a, b] = E[y_a(t + k) y_b(t)] = R_ba(k).
fn block_toeplitz(r: &Correlations, block_rows: usize) -> Mat {
    let l = r.channels();
    Mat::from_fn(block_rows * l, block_rows * l, |row, col| {
        r.at(col % l, row % l, block_rows + row / l - col / l)
    })
}

/// A_n minimising ‖O↑ A_n − O↓‖ over the leading n columns, for every n from one QR of O↑ at the highest order.
///
/// O↑ = QR nests: its first n columns are Q_n R_n, so A_n = R_n⁻¹ (Qᵀ O↓)_n.
fn nested(o: &Mat, g: &Mat, min_order: usize, max_order: usize) -> Vec<Realisation> {
    if max_order == 0 {
        return Vec::new();
    }
    let channels = g.ncols();
    let rows = o.nrows() - channels;
    let up = o.subrows(0, rows).to_owned();
    let qr = up.qr();
    let s = qr.compute_thin_Q().transpose() * o.subrows(channels, rows);
    let r = qr.thin_R();
    (min_order..=max_order)
        .step_by(2)
        .map(|n| {
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
        for (k, realisation) in nested(&o, &g, 2, 8).iter().enumerate() {
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
