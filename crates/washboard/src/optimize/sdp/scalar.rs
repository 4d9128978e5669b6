//! The numbers that the solver computes with: double, and double-double where double does not suffice.

use faer::MatRef;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{cholesky_in_place, cholesky_in_place_scratch};
use faer::traits::RealField;
use rayon::prelude::*;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, Neg, Sub, SubAssign};

/// A real number of some precision.
pub(super) trait Real:
    RealField
    + Copy
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + DivAssign
    + Send
    + Sync
{
    /// Distance of 1 to the next number.
    const EPSILON: f64;
    fn of(value: f64) -> Self;
    /// Rounded.
    fn double(self) -> f64;
    fn root(self) -> Self;
    /// A·B.
    fn product(a: MatRef<'_, Self>, b: MatRef<'_, Self>) -> MatOf<Self>;
    /// L with LLᵀ = A, of which the lower triangle is read; None where A is not positive definite.
    fn cholesky(a: MatOf<Self>) -> Option<MatOf<Self>>;
    /// (LLᵀ)⁻¹ b.
    fn solve(l: &MatOf<Self>, b: &[Self]) -> Vec<Self>;
}

impl Real for f64 {
    const EPSILON: f64 = f64::EPSILON;

    fn of(value: f64) -> Self {
        value
    }

    fn double(self) -> f64 {
        self
    }

    fn root(self) -> Self {
        self.sqrt()
    }

    fn product(a: MatRef<'_, f64>, b: MatRef<'_, f64>) -> MatOf<f64> {
        a * b
    }

    fn cholesky(mut a: MatOf<f64>) -> Option<MatOf<f64>> {
        let parallel = faer::get_global_parallelism();
        let size = cholesky_in_place_scratch::<f64>(a.nrows(), parallel, Default::default());
        let mut memory = MemBuffer::new(size);
        let stack = MemStack::new(&mut memory);
        let plain = Default::default();
        cholesky_in_place(a.as_mut(), plain, parallel, stack, Default::default()).ok()?;
        for (j, column) in a.col_iter_mut().enumerate() {
            column.get_mut(..j).fill(0.0);
        }
        Some(a)
    }

    fn solve(l: &MatOf<f64>, b: &[f64]) -> Vec<f64> {
        let mut x = MatOf::from_fn(b.len(), 1, |i, _| b[i]);
        l.solve_lower_triangular_in_place(&mut x);
        l.transpose().solve_upper_triangular_in_place(&mut x);
        (0..b.len()).map(|i| x[(i, 0)]).collect()
    }
}

impl Real for faer::fx128 {
    const EPSILON: f64 = f64::EPSILON * f64::EPSILON;

    fn of(value: f64) -> Self {
        faer::fx128::from(value)
    }

    fn double(self) -> f64 {
        self.0 + self.1
    }

    fn root(self) -> Self {
        self.sqrt()
    }

    fn product(a: MatRef<'_, Self>, b: MatRef<'_, Self>) -> MatOf<Self> {
        let (n, inner, m) = (a.nrows(), a.ncols(), b.ncols());
        let rows = lines(a.transpose());
        let columns = lines(b);
        let column = |j: usize| -> Vec<Self> {
            let b = &columns[j * inner..(j + 1) * inner];
            (0..n).map(|i| dot(&rows[i * inner..(i + 1) * inner], b)).collect()
        };
        let all: Vec<Vec<Self>> = if n * inner * m > SMALL {
            (0..m).into_par_iter().map(column).collect()
        } else {
            (0..m).map(column).collect()
        };
        MatOf::from_fn(n, m, |i, j| all[j][i])
    }

    fn cholesky(a: MatOf<Self>) -> Option<MatOf<Self>> {
        let n = a.nrows();
        let mut l: Vec<Vec<Self>> = (0..n).map(|i| (0..=i).map(|j| a[(i, j)]).collect()).collect();
        for j in 0..n {
            let (above, below) = l.split_at_mut(j + 1);
            let row = &mut above[j];
            let pivot = row[j] - dot(&row[..j], &row[..j]);
            if !(pivot.double() > 0.0 && pivot.double().is_finite()) {
                return None;
            }
            let root = pivot.root();
            row[j] = root;
            let row = &row[..j];
            let eliminate = |other: &mut Vec<Self>| other[j] = (other[j] - dot(&other[..j], row)) / root;
            if (n - j) * j > SMALL {
                below.par_iter_mut().for_each(eliminate);
            } else {
                below.iter_mut().for_each(eliminate);
            }
        }
        Some(MatOf::from_fn(n, n, |i, j| if i >= j { l[i][j] } else { Self::of(0.0) }))
    }

    fn solve(l: &MatOf<Self>, b: &[Self]) -> Vec<Self> {
        let n = b.len();
        let mut x = b.to_vec();
        for j in 0..n {
            x[j] /= l[(j, j)];
            for i in j + 1..n {
                let part = l[(i, j)] * x[j];
                x[i] -= part;
            }
        }
        for j in (0..n).rev() {
            for i in j + 1..n {
                let part = l[(i, j)] * x[i];
                x[j] -= part;
            }
            x[j] /= l[(j, j)];
        }
        x
    }
}

/// Products of fewer numbers are made on one core.
const SMALL: usize = 4096;

/// A's columns one after another.
fn lines<T: Real>(a: MatRef<'_, T>) -> Vec<T> {
    (0..a.ncols()).flat_map(|j| (0..a.nrows()).map(move |i| (i, j))).map(|(i, j)| a[(i, j)]).collect()
}

/// A matrix of such numbers.
pub(super) type MatOf<T> = faer::Mat<T>;

pub(super) fn cast<T: Real>(a: &faer::Mat<f64>) -> MatOf<T> {
    MatOf::from_fn(a.nrows(), a.ncols(), |i, j| T::of(a[(i, j)]))
}

pub(super) fn rounded<T: Real>(a: &MatOf<T>) -> faer::Mat<f64> {
    faer::Mat::from_fn(a.nrows(), a.ncols(), |i, j| a[(i, j)].double())
}

/// tr AB of symmetric matrices.
pub(super) fn inner<T: Real>(a: &MatOf<T>, b: &MatOf<T>) -> T {
    let mut sum = T::of(0.0);
    for j in 0..a.ncols() {
        for i in 0..a.nrows() {
            sum += a[(i, j)] * b[(i, j)];
        }
    }
    sum
}

pub(super) fn dot<T: Real>(a: &[T], b: &[T]) -> T {
    let mut sum = T::of(0.0);
    a.iter().zip(b).for_each(|(x, y)| sum += *x * *y);
    sum
}

/// √(Σ aᵢ²), rounded.
pub(super) fn norm<T: Real>(a: &[T]) -> f64 {
    a.iter().map(|v| v.double() * v.double()).sum::<f64>().sqrt()
}

/// (A + Aᵀ)/2.
pub(super) fn symmetric<T: Real>(a: &MatOf<T>) -> MatOf<T> {
    MatOf::from_fn(a.nrows(), a.ncols(), |i, j| T::of(0.5) * (a[(i, j)] + a[(j, i)]))
}
