//! The ordered real Schur form A = Q T Qᵀ: what Lyapunov, Sylvester and Riccati equations are solved on.

mod block;
mod flat;
mod francis;
mod swap;

use super::dense::{C64, LinalgError, Mat, check_finite, check_square};

/// A real Schur form: A = Q T Qᵀ with Q orthogonal and T quasi-upper-triangular.
///
/// | symbol | shape | what |
/// |---|---|---|
/// | `q` | n × n | orthogonal |
/// | `t` | n × n | upper triangular but for 2 × 2 blocks on its diagonal |
///
/// A 2 × 2 block is standardised: equal diagonal entries and off-diagonal entries of opposite sign, so that it is
/// exactly one conjugate pair a ± i√(−bc); a pair of real eigenvalues is always split.
///
/// Householder reduction to Hessenberg form, then Francis's implicit double-shift QR with deflation, exceptional
/// shifts and the Ahues–Tisseur criterion. Source: Golub and Van Loan, *Matrix Computations*, 4th ed., §7.4–7.6;
/// LAPACK's dlahqr and dlanv2.
#[derive(Debug, Clone)]
pub struct RealSchur {
    /// The orthogonal factor.
    pub q: Mat,
    /// The quasi-triangular factor.
    pub t: Mat,
}

impl RealSchur {
    /// The Schur form of a real square matrix.
    ///
    /// # Errors
    /// A matrix that is not square or not finite; an iteration that does not converge.
    ///
    /// ```
    /// use washboard::linalg::{Mat, RealSchur};
    /// let a = Mat::from_fn(2, 2, |i, j| [[0.0, 1.0], [-4.0, -0.4]][i][j]);
    /// let schur = RealSchur::new(&a)?;
    /// assert!((schur.eigenvalues()[0].re + 0.2).abs() < 1e-14);
    /// let back = &schur.q * &schur.t * schur.q.transpose();
    /// assert!((back - a).norm_l2() < 1e-14);
    /// # Ok::<(), washboard::linalg::LinalgError>(())
    /// ```
    pub fn new(a: &Mat) -> Result<Self, LinalgError> {
        check_square("A", a)?;
        check_finite("A", a)?;
        let (q, h) = francis::hessenberg(a);
        let (q, t) = francis::iterate(q, h)?;
        Ok(Self { q, t })
    }

    /// The eigenvalues of a real square matrix, without its Schur form: a third of the work.
    ///
    /// # Errors
    /// As [`RealSchur::new`].
    pub fn only_eigenvalues(a: &Mat) -> Result<Vec<C64>, LinalgError> {
        check_square("A", a)?;
        check_finite("A", a)?;
        let blocks = francis::diagonal_blocks(a)?;
        Ok(Self { q: Mat::zeros(0, 0), t: blocks }.eigenvalues())
    }

    /// The eigenvalues of a square matrix that is 0 below its first subdiagonal already, row after row.
    pub(crate) fn eigenvalues_of_hessenberg(rows: &[f64], order: usize) -> Result<Vec<C64>, LinalgError> {
        let h = Mat::from_fn(order, order, |i, j| if i > j + 1 { 0.0 } else { rows[i * order + j] });
        check_finite("A", &h)?;
        let blocks = francis::diagonal_blocks_of_hessenberg(&h)?;
        Ok(Self { q: Mat::zeros(0, 0), t: blocks }.eigenvalues())
    }

    /// Order of the matrix.
    #[must_use]
    pub fn order(&self) -> usize {
        self.t.nrows()
    }

    /// First index and size (1 or 2) of every diagonal block, from the top.
    #[must_use]
    pub fn blocks(&self) -> Vec<(usize, usize)> {
        let (n, mut k, mut found) = (self.order(), 0, Vec::new());
        while k < n {
            let size = if k + 1 < n && self.t[(k + 1, k)] != 0.0 { 2 } else { 1 };
            found.push((k, size));
            k += size;
        }
        found
    }

    /// The eigenvalues in the order of the diagonal of T; of a pair the one with Im > 0 first.
    #[must_use]
    pub fn eigenvalues(&self) -> Vec<C64> {
        let mut values = Vec::with_capacity(self.order());
        for (k, size) in self.blocks() {
            let re = self.t[(k, k)];
            if size == 1 {
                values.push(C64::new(re, 0.0));
            } else {
                // standardised: b and c have opposite signs; √|b|√|c| cannot overflow
                let im = self.t[(k, k + 1)].abs().sqrt() * self.t[(k + 1, k)].abs().sqrt();
                values.extend([C64::new(re, im), C64::new(re, -im)]);
            }
        }
        values
    }

    /// Size of the diagonal block that starts at row `k`.
    pub(super) fn block_at(&self, k: usize) -> usize {
        if k + 1 < self.order() && self.t[(k + 1, k)] != 0.0 { 2 } else { 1 }
    }

    /// Moves the block that starts at row `from` up to row `to`, past all between, or as far as blocks can be swapped
    /// backward-stably: the row that it reaches.
    pub(super) fn lift(&mut self, from: usize, to: usize) -> usize {
        let mut at = from;
        while at > to {
            let above = if at >= 2 && self.t[(at - 1, at - 2)] != 0.0 { 2 } else { 1 };
            let width = self.block_at(at);
            if swap::swap_adjacent(&mut self.q, &mut self.t, at - above, above, width).is_err() {
                break;
            }
            at -= above;
        }
        at
    }

    /// The same matrix with the eigenvalues that `first` selects moved to the top, and how many these are.
    ///
    /// The leading columns of the new Q span the invariant subspace of the selected eigenvalues. The order within
    /// the selected and within the others is kept. `first` is asked once a block, with the eigenvalue of Im ≥ 0, so
    /// that a conjugate pair is never torn.
    ///
    /// # Errors
    /// [`LinalgError::Singular`] where two blocks are too close to be swapped backward-stably, with the size that
    /// the eliminated block kept, relative to ‖T‖.
    ///
    /// Source: Bai and Demmel, *On swapping diagonal blocks in real Schur form*, 1993; LAPACK's dtrsen.
    pub fn reordered(&self, first: impl Fn(C64) -> bool) -> Result<(Self, usize), LinalgError> {
        let values = self.eigenvalues();
        let mut queue: Vec<(usize, bool)> =
            self.blocks().iter().map(|&(k, size)| (size, first(values[k]))).collect();
        let mut new = self.clone();
        let mut sorted = 0; // blocks at the top that are selected
        let mut selected = 0; // and their total size
        while let Some(found) = queue[sorted..].iter().position(|b| b.1) {
            let mut at = sorted + found;
            let mut row: usize = queue[..at].iter().map(|b| b.0).sum();
            while at > sorted {
                let (above, below) = (queue[at - 1].0, queue[at].0);
                row -= above;
                swap::swap_adjacent(&mut new.q, &mut new.t, row, above, below)?;
                queue.swap(at - 1, at);
                // rounding may have turned a nearly defective pair into two real eigenvalues
                for (block, start) in [(at, row + below), (at - 1, row)] {
                    if queue[block].0 == 2 && new.t[(start + 1, start)] == 0.0 {
                        queue[block].0 = 1;
                        queue.insert(block + 1, (1, queue[block].1));
                    }
                }
                at -= 1;
            }
            // a split pair counts its two halves when the loop meets each
            selected += queue[sorted].0;
            sorted += 1;
        }
        Ok((new, selected))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::{eigen, test_matrices};

    /// Backward error and orthogonality per order: Householder and Givens steps each add a few ε.
    const BACKWARD: f64 = 1e-13;

    fn check_form(name: &str, a: &Mat, schur: &RealSchur) {
        let n = a.nrows();
        let bound = BACKWARD * n.max(1) as f64;
        let residual = (a - &schur.q * &schur.t * schur.q.transpose()).norm_l2();
        assert!(residual <= bound * a.norm_l2(), "{name}: residual {residual:e}");
        let orthogonal = (schur.q.transpose() * &schur.q - Mat::identity(n, n)).norm_l2();
        assert!(orthogonal <= bound, "{name}: orthogonality {orthogonal:e}");
        for j in 0..n {
            for i in j + 2..n {
                assert_eq!(schur.t[(i, j)], 0.0, "{name}: entry ({i}, {j}) below the blocks");
            }
        }
        for (k, size) in schur.blocks() {
            if size == 2 {
                assert_eq!(schur.t[(k, k)], schur.t[(k + 1, k + 1)], "{name}: block {k} is not standardised");
                assert!(schur.t[(k, k + 1)] * schur.t[(k + 1, k)] < 0.0, "{name}: block {k} is real");
                assert!(k + 2 >= n || schur.t[(k + 2, k + 1)] == 0.0, "{name}: blocks touch at {k}");
            }
        }
    }

    /// Largest distance when every value of `one` takes its nearest unused value of `other`.
    fn distance(one: &[C64], other: &[C64]) -> f64 {
        let mut left = other.to_vec();
        let mut worst: f64 = 0.0;
        for a in one {
            let (k, d) =
                left.iter().map(|b| (a - b).norm()).enumerate().min_by(|x, y| x.1.total_cmp(&y.1)).unwrap();
            worst = worst.max(d);
            left.swap_remove(k);
        }
        worst
    }

    #[test]
    fn every_kind_of_matrix_has_its_form() {
        for (name, a) in test_matrices::all() {
            let schur = RealSchur::new(&a).unwrap();
            check_form(&name, &a, &schur);
        }
    }

    #[test]
    fn eigenvalues_agree_with_another_algorithm() {
        for (name, a) in test_matrices::all() {
            if name.starts_with("jordan") || name.starts_with("companion") {
                continue; // ill-conditioned eigenvalues: two backward-stable routes may differ
            }
            let ours = RealSchur::new(&a).unwrap().eigenvalues();
            let d = distance(&ours, &eigen(&a).unwrap().0);
            assert!(d <= 1e-10 * a.norm_l2().max(1.0), "{name}: {d:e}");
        }
    }

    #[test]
    fn eigenvalues_alone_are_those_of_the_form() {
        for (name, a) in test_matrices::all() {
            let (alone, whole) =
                (RealSchur::only_eigenvalues(&a).unwrap(), RealSchur::new(&a).unwrap().eigenvalues());
            // the same rotations on the same numbers: no rounding apart
            assert_eq!(alone, whole, "{name}");
        }
    }

    #[test]
    fn known_eigenvalues_are_found() {
        // λ³ − 6λ² + 11λ − 6 = (λ − 1)(λ − 2)(λ − 3)
        let a = Mat::from_fn(3, 3, |i, j| [[6.0, -11.0, 6.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]][i][j]);
        let expected = [1.0, 2.0, 3.0].map(|re| C64::new(re, 0.0));
        assert!(distance(&RealSchur::new(&a).unwrap().eigenvalues(), &expected) < 1e-12);
        // a cyclic permutation defeats the ordinary shifts
        let p = Mat::from_fn(4, 4, |i, j| if (j + 1) % 4 == i { 1.0 } else { 0.0 });
        let roots = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)].map(|(r, i)| C64::new(r, i));
        assert!(distance(&RealSchur::new(&p).unwrap().eigenvalues(), &roots) < 1e-13);
    }

    #[test]
    fn reordering_keeps_the_matrix_and_sorts() {
        for (name, a) in test_matrices::all() {
            if name.starts_with("jordan") {
                continue;
            }
            let schur = RealSchur::new(&a).unwrap();
            let before = schur.eigenvalues();
            for stable_first in [true, false] {
                // a pair on the axis must not change sides by rounding
                let edge = -1e-9 * a.norm_l2();
                let pick = |z: C64| (z.re < edge) == stable_first;
                let (sorted, count) = schur.reordered(pick).unwrap();
                check_form(&name, &a, &sorted);
                assert_eq!(count, before.iter().filter(|z| pick(**z)).count(), "{name}");
                let after = sorted.eigenvalues();
                assert!(after[..count].iter().all(|z| pick(*z)), "{name}: {after:?}");
                assert!(after[count..].iter().all(|z| !pick(*z)), "{name}: {after:?}");
                // an invariant subspace: A Q₁ = Q₁ T₁₁
                let q1 = sorted.q.subcols(0, count);
                let t11 = sorted.t.submatrix(0, 0, count, count);
                let residual = (&a * q1 - q1 * t11).norm_l2();
                assert!(residual <= BACKWARD * a.nrows() as f64 * a.norm_l2(), "{name}: {residual:e}");
            }
        }
    }

    #[test]
    fn reordering_keeps_eigenvalues_where_they_are_well_conditioned() {
        for (name, a) in test_matrices::all().into_iter().filter(|m| m.0.starts_with("random")) {
            let schur = RealSchur::new(&a).unwrap();
            let (sorted, _) = schur.reordered(|z| z.norm() < 1.0).unwrap();
            let d = distance(&schur.eigenvalues(), &sorted.eigenvalues());
            assert!(d <= 1e-10 * a.norm_l2(), "{name}: {d:e}");
        }
    }

    #[test]
    fn a_defective_matrix_is_reordered_or_refused_but_never_wrong() {
        for (name, a) in test_matrices::all().into_iter().filter(|m| m.0.starts_with("jordan")) {
            let schur = RealSchur::new(&a).unwrap();
            for threshold in [-2.0, -1.0, 0.0] {
                if let Ok((sorted, _)) = schur.reordered(|z| z.im > 0.0 || z.re > threshold) {
                    check_form(&name, &a, &sorted);
                }
            }
        }
    }

    #[test]
    fn small_integer_matrices_with_repeated_eigenvalues_converge() {
        use rand::{Rng, SeedableRng};
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        for _ in 0..3000 {
            let n = rng.random_range(1..8);
            let a = Mat::from_fn(n, n, |_, _| f64::from(rng.random_range(-1..=1)));
            let schur = RealSchur::new(&a).unwrap();
            check_form("integers", &a, &schur);
            if let Ok((sorted, count)) = schur.reordered(|z| z.re > 0.3) {
                check_form("integers, sorted", &a, &sorted);
                assert!(count <= n);
            }
        }
    }

    #[test]
    fn a_wrong_matrix_is_refused() {
        assert!(RealSchur::new(&Mat::zeros(2, 3)).is_err());
        let mut a = Mat::identity(3, 3);
        a[(1, 2)] = f64::NAN;
        assert!(matches!(RealSchur::new(&a), Err(LinalgError::NotFinite { row: 1, col: 2, .. })));
    }
}
