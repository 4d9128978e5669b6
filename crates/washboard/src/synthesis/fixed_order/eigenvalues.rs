//! A loop's eigenvalues and what they gain from each entry of the controller.

use super::closed::Open;
use crate::linalg::{C64, CMat, Mat, eigen, solve_complex};

/// λ, and right and left eigenvectors with wᴴv = 1.
pub(super) struct Spectrum {
    pub values: Vec<C64>,
    right: CMat,
    left: CMat,
}

impl Spectrum {
    /// None where the eigenvectors are no basis.
    pub fn new(a: &Mat) -> Option<Self> {
        let n = a.nrows();
        let (values, right) = eigen(a).ok()?;
        let one = CMat::from_fn(n, n, |i, j| C64::new(f64::from(u8::from(i == j)), 0.0));
        let left = solve_complex(&right, &one).ok()?;
        Some(Spectrum { values, right, left })
    }

    /// The eigenvalue with the largest real part.
    pub fn rightmost(&self) -> Option<usize> {
        (0..self.values.len()).max_by(|a, b| self.values[*a].re.total_cmp(&self.values[*b].re))
    }

    /// The eigenvalue nearest to a value.
    pub fn nearest(&self, value: C64) -> Option<usize> {
        let distance = |k: &usize| (self.values[*k] - value).norm();
        (0..self.values.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }

    /// Re(along · dλ) by each entry of the block: dλ = wᴴ B dK C v.
    pub fn derivative(&self, k: usize, open: &Open, order: usize, along: C64) -> Option<Mat> {
        let n = self.values.len();
        let np = n - order;
        let (nu, ny) = (open.b2.ncols(), open.c2.nrows());
        let left: Vec<C64> = (0..order)
            .map(|i| self.left[(k, np + i)])
            .chain((0..nu).map(|j| (0..np).map(|i| self.left[(k, i)] * open.b2[(i, j)]).sum()))
            .collect();
        let right: Vec<C64> = (0..order)
            .map(|i| self.right[(np + i, k)])
            .chain((0..ny).map(|i| (0..np).map(|j| self.right[(j, k)] * open.c2[(i, j)]).sum()))
            .collect();
        let g = Mat::from_fn(order + nu, order + ny, |i, j| (along * left[i] * right[j]).re);
        g.norm_max().is_finite().then_some(g)
    }
}
