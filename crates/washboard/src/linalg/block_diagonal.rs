//! A = V diag(A₁, A₂, …) V⁻¹ with real blocks, as small as a well-conditioned V allows.

use super::blocked;
use super::dense::{C64, LinalgError, Mat};
use super::schur::RealSchur;
use std::ops::{AddAssign, SubAssign};

/// A block diagonal form.
#[derive(Debug, Clone)]
pub struct BlockDiagonal {
    /// V, n × n.
    pub v: Mat,
    /// V⁻¹, built from the same steps and not by inversion.
    pub v_inverse: Mat,
    /// The diagonal blocks, real and quasi-upper-triangular, from the top.
    pub blocks: Vec<Mat>,
    /// ‖V‖_F ‖V⁻¹‖_F / n: 1 for an orthogonal V.
    pub condition: f64,
}

impl BlockDiagonal {
    /// diag(A₁, A₂, …).
    #[must_use]
    pub fn diagonal(&self) -> Mat {
        let n = self.v.nrows();
        let (mut d, mut at) = (Mat::zeros(n, n), 0);
        for block in &self.blocks {
            let k = block.nrows();
            d.submatrix_mut(at, at, k, k).copy_from(block);
            at += k;
        }
        d
    }
}

/// Splits A = V diag(A₁, A₂, …) V⁻¹, real.
///
/// `a` is n × n; `bound` ≥ 1 limits the entries of every Sylvester solution P that decouples a cluster of eigenvalues
/// from those below, [I P; 0 I], and thereby V's condition. From the ordered real Schur form a cluster starts as one
/// eigenvalue or conjugate pair; where ‖P‖_max would exceed `bound`, the eigenvalue nearest to the cluster's mean joins.
/// A defective or nearly defective eigenvalue so stays in one block.
///
/// # Errors
/// As [`RealSchur::new`]; a `bound` that is not at least 1.
///
/// Source: Bavely and Stewart, *An algorithm for computing reducing subspaces by block diagonalization*, SIAM J. Numer.
/// Anal. 16 (1979).
///
/// ```
/// use washboard::linalg::{Mat, block_diagonalize};
/// let a = Mat::from_fn(2, 2, |i, j| [[1.0, 5.0], [0.0, 3.0]][i][j]);
/// assert_eq!(block_diagonalize(&a, 100.0)?.blocks.len(), 2);
/// let jordan = Mat::from_fn(2, 2, |i, j| [[1.0, 5.0], [0.0, 1.0]][i][j]);
/// assert_eq!(block_diagonalize(&jordan, 100.0)?.blocks.len(), 1);
/// # Ok::<(), washboard::linalg::LinalgError>(())
/// ```
pub fn block_diagonalize(a: &Mat, bound: f64) -> Result<BlockDiagonal, LinalgError> {
    if !(bound >= 1.0) {
        let (what, why) = ("block diagonalisation", "the bound of the transformation is below 1");
        return Err(LinalgError::Singular { what, why, value: bound });
    }
    let mut schur = RealSchur::new(a)?;
    let n = schur.order();
    // what decouples each cluster from the rest: (start, size, P)
    let mut couplings: Vec<(usize, usize, Mat)> = Vec::new();
    let mut start = 0;
    while start < n {
        let mut size = schur.block_at(start);
        loop {
            let rest = n - start - size;
            if rest == 0 {
                break;
            }
            let p = decoupling(&schur.t, start, size);
            if p.norm_max() <= bound {
                couplings.push((start, size, p));
                break;
            }
            let from = nearest(&schur, start, size);
            // what it can't pass is too near to it, and joins too
            let reached = schur.lift(from, start + size);
            size = reached + schur.block_at(reached) - start;
        }
        couplings.push((start, size, Mat::zeros(size, 0)));
        start += size;
    }
    // a cluster has two entries, its coupling and its end; the last one only its end
    let (mut v, mut w) = (schur.q.clone(), schur.q.transpose().to_owned());
    let mut blocks = Vec::new();
    for (start, size, p) in couplings {
        if p.ncols() == 0 {
            blocks.push(schur.t.submatrix(start, start, size, size).to_owned());
            continue;
        }
        let rest = p.ncols();
        // V ← V [I P; 0 I], V⁻¹ ← [I −P; 0 I] V⁻¹
        let change = v.subcols(start, size) * &p;
        v.subcols_mut(start + size, rest).add_assign(&change);
        let change = &p * w.subrows(start + size, rest);
        w.subrows_mut(start, size).sub_assign(&change);
    }
    let condition = if n == 0 { 1.0 } else { v.norm_l2() * w.norm_l2() / n as f64 };
    Ok(BlockDiagonal { v, v_inverse: w, blocks, condition })
}

/// P with T₁₁ P − P T₂₂ = −T₁₂ for the cluster at `start` and all that is below it.
fn decoupling(t: &Mat, start: usize, size: usize) -> Mat {
    let (n, below) = (t.nrows(), start + size);
    let rest = n - below;
    let (t11, t22) = (t.submatrix(start, start, size, size), t.submatrix(below, below, rest, rest));
    // P T₂₂ as Y Rᵀ with a quasi-upper R: reverse the order, R = J T₂₂ᵀ J and Y = P J
    let r = Mat::from_fn(rest, rest, |i, j| -t22[(rest - 1 - j, rest - 1 - i)]);
    let mut y = Mat::from_fn(size, rest, |i, j| -t[(start + i, n - 1 - j)]);
    blocked::sylvester(t11, r.as_ref(), y.as_mut(), f64::EPSILON * t.norm_max());
    Mat::from_fn(size, rest, |i, j| y[(i, rest - 1 - j)])
}

/// Where the block below the cluster starts whose eigenvalue is nearest to the cluster's mean.
fn nearest(schur: &RealSchur, start: usize, size: usize) -> usize {
    let values = schur.eigenvalues();
    let upper = |z: C64| C64::new(z.re, z.im.abs());
    let sum: C64 = values.iter().skip(start).take(size).map(|z| upper(*z)).sum();
    let mean = sum / size as f64;
    let below = schur.blocks().into_iter().map(|b| b.0).filter(|k| *k >= start + size);
    let far = |k: usize| values.get(k).map_or(f64::INFINITY, |z| (upper(*z) - mean).norm());
    below.min_by(|x, y| far(*x).total_cmp(&far(*y))).unwrap_or(start + size)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::test_matrices::{all, random};

    const BOUND: f64 = 1e3;

    #[test]
    fn the_blocks_are_the_matrix_and_v_is_invertible() {
        for (name, a) in all() {
            let form = block_diagonalize(&a, BOUND).unwrap_or_else(|e| panic!("{name}: {e}"));
            let n = a.nrows();
            let scale = 1e-14 * (n * n) as f64 * form.condition * n as f64;
            let one = (&form.v * &form.v_inverse - Mat::identity(n, n)).norm_l2();
            assert!(one <= scale, "{name}: {one:e}");
            let back = &form.v * form.diagonal() * &form.v_inverse;
            let error = (back - &a).norm_l2();
            assert!(error <= scale * a.norm_l2(), "{name}: {error:e} of {:e}", form.condition);
            assert_eq!(form.blocks.iter().map(Mat::nrows).sum::<usize>(), n, "{name}");
        }
    }

    #[test]
    fn clusters_join_and_others_do_not() {
        // eigenvalues 1, 1 (defective), 5 and 2 ± 3i in random coordinates
        let mut d = Mat::zeros(5, 5);
        for (k, v) in [1.0, 1.0, 5.0, 2.0, 2.0].into_iter().enumerate() {
            d[(k, k)] = v;
        }
        (d[(0, 1)], d[(3, 4)], d[(4, 3)]) = (1.0, 3.0, -3.0);
        let turn = random(5, 5, 4).qr().compute_Q();
        let form = block_diagonalize(&(&turn * d * turn.transpose()), BOUND).unwrap();
        let mut sizes: Vec<usize> = form.blocks.iter().map(Mat::nrows).collect();
        sizes.sort_unstable();
        assert_eq!(sizes, [1, 2, 2]);
        assert!(form.condition < 100.0, "{}", form.condition);
        assert!(block_diagonalize(&turn, 0.5).is_err());
    }
}
