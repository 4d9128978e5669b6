//! A square matrix in one slice, column after column: what the QR iteration spends its time on is reached without a
//! check an entry.

use super::Mat;
use super::block::Rotation;
use std::ops::{Index, IndexMut, Range};

/// A square matrix, column-major.
#[derive(Debug, Clone)]
pub(super) struct Flat {
    order: usize,
    values: Vec<f64>,
}

impl From<&Mat> for Flat {
    fn from(a: &Mat) -> Self {
        let order = a.nrows();
        let mut values = Vec::with_capacity(order * order);
        (0..order).for_each(|j| values.extend_from_slice(a.col_as_slice(j)));
        Self { order, values }
    }
}

impl Index<(usize, usize)> for Flat {
    type Output = f64;

    fn index(&self, (row, col): (usize, usize)) -> &f64 {
        &self.values[row + col * self.order]
    }
}

impl IndexMut<(usize, usize)> for Flat {
    fn index_mut(&mut self, (row, col): (usize, usize)) -> &mut f64 {
        &mut self.values[row + col * self.order]
    }
}

impl Flat {
    /// Rows and columns.
    pub fn order(&self) -> usize {
        self.order
    }

    /// Back to a matrix.
    pub fn into_mat(self) -> Mat {
        Mat::from_fn(self.order, self.order, |i, j| self[(i, j)])
    }

    /// Rows k and on, columns `k..to`, times I − τ v vᵀ from the left; v has two or three entries, v₀ = 1.
    pub fn reflect_rows(&mut self, v: &[f64], tau: f64, k: usize, to: usize) {
        let n = self.order;
        let columns = self.values[k * n..to * n].chunks_exact_mut(n);
        match *v {
            [_, v1, v2] => {
                let (t1, t2) = (tau * v1, tau * v2);
                for column in columns {
                    if let [x, y, z] = &mut column[k..k + 3] {
                        let sum = *x + v1 * *y + v2 * *z;
                        *x -= tau * sum;
                        *y -= t1 * sum;
                        *z -= t2 * sum;
                    }
                }
            }
            [_, v1] => {
                for column in columns {
                    if let [x, y] = &mut column[k..k + 2] {
                        let sum = tau * (*x + v1 * *y);
                        *x -= sum;
                        *y -= sum * v1;
                    }
                }
            }
            _ => {}
        }
    }

    /// Columns k and on, `rows`, times I − τ v vᵀ from the right.
    pub fn reflect_cols(&mut self, v: &[f64], tau: f64, k: usize, rows: Range<usize>) {
        let n = self.order;
        let (first, rest) = self.values[k * n..(k + v.len()) * n].split_at_mut(n);
        let (second, third) = rest.split_at_mut(n);
        let pairs = first[rows.clone()].iter_mut().zip(&mut second[rows.clone()]);
        match *v {
            [_, v1, v2] => {
                let (t1, t2) = (tau * v1, tau * v2);
                for ((x, y), z) in pairs.zip(&mut third[rows]) {
                    let sum = *x + v1 * *y + v2 * *z;
                    *x -= tau * sum;
                    *y -= t1 * sum;
                    *z -= t2 * sum;
                }
            }
            [_, v1] => {
                for (x, y) in pairs {
                    let sum = tau * (*x + v1 * *y);
                    *x -= sum;
                    *y -= sum * v1;
                }
            }
            _ => {}
        }
    }

    /// Rows k and k + 1, columns `from..`, times G from the left.
    pub fn rotate_rows(&mut self, g: Rotation, k: usize, from: usize) {
        let n = self.order;
        for column in self.values[from * n..].chunks_exact_mut(n) {
            let (x, y) = (column[k], column[k + 1]);
            (column[k], column[k + 1]) = (g.c * x + g.s * y, g.c * y - g.s * x);
        }
    }

    /// Columns k and k + 1, rows `..to`, times Gᵀ from the right.
    pub fn rotate_cols(&mut self, g: Rotation, k: usize, to: usize) {
        let n = self.order;
        let (first, second) = self.values[k * n..(k + 2) * n].split_at_mut(n);
        for (x, y) in first[..to].iter_mut().zip(&mut second[..to]) {
            (*x, *y) = (g.c * *x + g.s * *y, g.c * *y - g.s * *x);
        }
    }
}
