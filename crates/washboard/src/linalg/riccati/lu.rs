//! An LU factorisation whose memory is used again: at ten states allocations cost as much as the arithmetic.

use super::super::dense::Mat;
use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::lu::partial_pivoting::{factor, solve};
use faer::perm::{PermRef, permute_rows_in_place_scratch};
use faer::{MatMut, Par};

/// P A = L U of a square matrix of fixed order.
pub(super) struct Lu {
    factors: Mat,
    forward: Vec<usize>,
    inverse: Vec<usize>,
    memory: MemBuffer,
}

impl Lu {
    /// Memory for matrices of order n with up to `columns` right-hand sides.
    pub fn new(n: usize, columns: usize) -> Self {
        let factoring = factor::lu_in_place_scratch::<usize, f64>(n, n, Par::Seq, Default::default());
        let solving = permute_rows_in_place_scratch::<usize, f64>(n, columns);
        Self {
            factors: Mat::zeros(n, n),
            forward: vec![0; n],
            inverse: vec![0; n],
            memory: MemBuffer::new(StackReq::any_of(&[factoring, solving])),
        }
    }

    /// The matrix that [`Lu::factor`] will factor, to be filled.
    pub fn matrix(&mut self) -> &mut Mat {
        &mut self.factors
    }

    /// Factors what [`Lu::matrix`] holds.
    pub fn factor(&mut self) {
        let stack = MemStack::new(&mut self.memory);
        let (a, forward, inverse) = (self.factors.as_mut(), &mut self.forward, &mut self.inverse);
        factor::lu_in_place(a, forward, inverse, Par::Seq, stack, Default::default());
    }

    /// B ← A⁻¹ B.
    pub fn solve(&mut self, b: MatMut<'_, f64>) {
        let f = self.factors.as_ref();
        let row_perm = PermRef::new_checked(&self.forward, &self.inverse, f.nrows());
        solve::solve_in_place(f, f, row_perm, b, Par::Seq, MemStack::new(&mut self.memory));
    }

    /// B ← A⁻ᵀ B.
    pub fn solve_transposed(&mut self, b: MatMut<'_, f64>) {
        let f = self.factors.as_ref();
        let row_perm = PermRef::new_checked(&self.forward, &self.inverse, f.nrows());
        solve::solve_transpose_in_place(f, f, row_perm, b, Par::Seq, MemStack::new(&mut self.memory));
    }

    /// |u_ii|.
    pub fn pivots(&self) -> impl Iterator<Item = f64> + '_ {
        (0..self.factors.nrows()).map(|i| self.factors[(i, i)].abs())
    }
}
