//! Matrices that are affine in matrix variables: C + Σ L V R, V a variable or its transpose.

use crate::linalg::Mat;
use std::ops::{Add, Mul, Neg, Sub};

/// A matrix variable of a program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Variable {
    pub(super) id: usize,
    rows: usize,
    cols: usize,
}

/// L V R, or L Vᵀ R.
#[derive(Debug, Clone)]
pub(super) struct Term {
    pub variable: usize,
    pub transposed: bool,
    pub left: Mat,
    pub right: Mat,
}

/// A matrix, affine in the variables of a program.
///
/// Sums, products with matrices, transposes and blocks are again expressions. Sizes that do not fit are remembered and
/// refused where the expression is used ([`super::Lmi::positive`], [`super::Lmi::minimize`]).
#[derive(Debug, Clone)]
pub struct Expr {
    pub(super) constant: Mat,
    pub(super) terms: Vec<Term>,
    pub(super) slip: Option<String>,
}

impl Variable {
    pub(super) fn new(id: usize, rows: usize, cols: usize) -> Self {
        Variable { id, rows, cols }
    }

    /// Rows and columns.
    pub fn shape(&self) -> (usize, usize) {
        (self.rows, self.cols)
    }

    /// The variable as an expression.
    pub fn expr(&self) -> Expr {
        let (left, right) = (Mat::identity(self.rows, self.rows), Mat::identity(self.cols, self.cols));
        Expr {
            constant: Mat::zeros(self.rows, self.cols),
            terms: vec![Term { variable: self.id, transposed: false, left, right }],
            slip: None,
        }
    }

    /// A variable of one row and column times a matrix.
    pub fn times(&self, matrix: &Mat) -> Expr {
        let (n, m) = matrix.shape();
        let mut out = Expr::constant(Mat::zeros(n, m));
        if (self.rows, self.cols) != (1, 1) {
            out.slip = Some(format!(
                "a variable of {} × {} times a matrix entry by entry: expected 1 × 1",
                self.rows, self.cols
            ));
            return out;
        }
        for k in 0..m {
            if (0..n).any(|i| matrix[(i, k)] != 0.0) {
                out.terms.push(Term {
                    variable: self.id,
                    transposed: false,
                    left: Mat::from_fn(n, 1, |i, _| matrix[(i, k)]),
                    right: Mat::from_fn(1, m, |_, j| if j == k { 1.0 } else { 0.0 }),
                });
            }
        }
        out
    }
}

impl Expr {
    /// A matrix that holds no variable.
    pub fn constant(matrix: Mat) -> Self {
        Expr { constant: matrix, terms: Vec::new(), slip: None }
    }

    /// 0.
    pub fn zero(rows: usize, cols: usize) -> Self {
        Self::constant(Mat::zeros(rows, cols))
    }

    /// value · I.
    pub fn identity(n: usize, value: f64) -> Self {
        Self::constant(Mat::from_fn(n, n, |i, j| if i == j { value } else { 0.0 }))
    }

    /// Rows and columns.
    pub fn shape(&self) -> (usize, usize) {
        self.constant.shape()
    }

    /// Eᵀ.
    #[must_use]
    pub fn t(&self) -> Self {
        let terms = self.terms.iter().map(|t| Term {
            variable: t.variable,
            transposed: !t.transposed,
            left: t.right.transpose().to_owned(),
            right: t.left.transpose().to_owned(),
        });
        Expr {
            constant: self.constant.transpose().to_owned(),
            terms: terms.collect(),
            slip: self.slip.clone(),
        }
    }

    /// E + Eᵀ.
    #[must_use]
    pub fn he(&self) -> Self {
        self + &self.t()
    }

    /// The sum of the diagonal, 1 × 1.
    #[must_use]
    pub fn trace(&self) -> Self {
        let (n, m) = self.shape();
        let mut out = Expr::zero(1, 1);
        out.slip.clone_from(&self.slip);
        if n != m {
            out.slip.get_or_insert(format!("the trace of {n} × {m}: expected a square matrix"));
            return out;
        }
        for k in 0..n {
            let mut e = Mat::zeros(1, n);
            e[(0, k)] = 1.0;
            out = out + &(&e * self) * &e.transpose().to_owned();
        }
        out
    }

    /// The same, each entry times a number.
    #[must_use]
    pub fn scaled(&self, by: f64) -> Self {
        let scale = |m: &Mat| Mat::from_fn(m.nrows(), m.ncols(), |i, j| by * m[(i, j)]);
        let terms = self.terms.iter().map(|t| Term { left: scale(&t.left), ..t.clone() });
        Expr { constant: scale(&self.constant), terms: terms.collect(), slip: self.slip.clone() }
    }

    /// A symmetric matrix from the blocks on and above its diagonal: row i holds the blocks (i, i), (i, i + 1), …
    #[must_use]
    pub fn symmetric(upper: Vec<Vec<Expr>>) -> Self {
        let count = upper.len();
        let sizes: Vec<usize> = upper.iter().map(|row| row.first().map_or(0, |e| e.shape().0)).collect();
        let n: usize = sizes.iter().sum();
        let start = |k: usize| sizes[..k].iter().sum::<usize>();
        let place = |k: usize| {
            let first = start(k);
            Mat::from_fn(n, sizes[k], |i, j| if i == first + j { 1.0 } else { 0.0 })
        };
        let mut out = Expr::zero(n, n);
        for (i, row) in upper.iter().enumerate() {
            if row.len() != count - i {
                let found = format!("row {i} has {} blocks, expected {}", row.len(), count - i);
                out.slip.get_or_insert(found);
                return out;
            }
            for (k, block) in row.iter().enumerate() {
                let j = i + k;
                if block.shape() != (sizes[i], sizes[j]) {
                    let (found, expected) = (block.shape(), (sizes[i], sizes[j]));
                    out.slip.get_or_insert(format!("block ({i}, {j}) is {found:?}, expected {expected:?}"));
                    return out;
                }
                let placed = &(&place(i) * block) * &place(j).transpose().to_owned();
                out = if i == j { &out + &placed } else { &out + &placed.he() };
            }
        }
        out
    }
}

impl From<Variable> for Expr {
    fn from(v: Variable) -> Self {
        v.expr()
    }
}

impl Add<&Expr> for &Expr {
    type Output = Expr;

    fn add(self, other: &Expr) -> Expr {
        let mut slip = self.slip.clone().or_else(|| other.slip.clone());
        if self.shape() != other.shape() {
            slip.get_or_insert(format!("{:?} + {:?}", self.shape(), other.shape()));
            return Expr { slip, ..self.clone() };
        }
        Expr {
            constant: &self.constant + &other.constant,
            terms: self.terms.iter().chain(&other.terms).cloned().collect(),
            slip,
        }
    }
}

impl Add<Expr> for Expr {
    type Output = Expr;

    fn add(self, other: Expr) -> Expr {
        &self + &other
    }
}

impl Neg for &Expr {
    type Output = Expr;

    fn neg(self) -> Expr {
        self.scaled(-1.0)
    }
}

impl Neg for Expr {
    type Output = Expr;

    fn neg(self) -> Expr {
        self.scaled(-1.0)
    }
}

impl Sub<&Expr> for &Expr {
    type Output = Expr;

    fn sub(self, other: &Expr) -> Expr {
        self + &-other
    }
}

impl Sub<Expr> for Expr {
    type Output = Expr;

    fn sub(self, other: Expr) -> Expr {
        &self + &-other
    }
}

impl Mul<&Expr> for &Mat {
    type Output = Expr;

    fn mul(self, e: &Expr) -> Expr {
        let mut slip = e.slip.clone();
        if self.ncols() != e.shape().0 {
            slip.get_or_insert(format!("{:?} × {:?}", self.shape(), e.shape()));
            return Expr { slip, ..Expr::zero(self.nrows(), e.shape().1) };
        }
        let terms = e.terms.iter().map(|t| Term { left: self * &t.left, ..t.clone() });
        Expr { constant: self * &e.constant, terms: terms.collect(), slip }
    }
}

impl Mul<&Mat> for &Expr {
    type Output = Expr;

    fn mul(self, m: &Mat) -> Expr {
        let mut slip = self.slip.clone();
        if self.shape().1 != m.nrows() {
            slip.get_or_insert(format!("{:?} × {:?}", self.shape(), m.shape()));
            return Expr { slip, ..Expr::zero(self.shape().0, m.ncols()) };
        }
        let terms = self.terms.iter().map(|t| Term { right: &t.right * m, ..t.clone() });
        Expr { constant: &self.constant * m, terms: terms.collect(), slip }
    }
}

impl Mul<Variable> for &Mat {
    type Output = Expr;

    fn mul(self, v: Variable) -> Expr {
        self * &v.expr()
    }
}

impl Mul<&Mat> for Variable {
    type Output = Expr;

    fn mul(self, m: &Mat) -> Expr {
        &self.expr() * m
    }
}
