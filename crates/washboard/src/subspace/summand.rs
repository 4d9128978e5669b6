//! The causal half of a Hermitian function on the circle: S(z) = H(z) + Hᵀ(1/z), H(z) = E/2 + C(zI − A)⁻¹F.

use super::SubspaceError;
use super::range::{accumulated, half_of};
use super::samples::Samples;
use crate::linalg::{C64, CMat, LinalgError, Mat, least_distance_from, solve_complex};

/// A, C, F and E = Eᵀ.
#[derive(Debug, Clone)]
pub struct Summand {
    /// n × n, eigenvalues inside the unit circle.
    pub a: Mat,
    /// m × n.
    pub c: Mat,
    /// n × m.
    pub f: Mat,
    /// m × m, symmetric.
    pub e: Mat,
    /// Poles that were outside the circle, or paired with none, and were mirrored or replaced.
    pub folded: usize,
}

impl Summand {
    /// S(e^{iθ}) = E + χF + (χF)ᴴ, χ = C(e^{iθ}I − A)⁻¹.
    ///
    /// # Errors
    /// A pole at e^{iθ}.
    pub fn at(&self, theta: f64) -> Result<CMat, LinalgError> {
        Ok(self.with_chi(&self.chi(theta)?))
    }

    /// S where χ is known.
    pub(super) fn with_chi(&self, chi: &CMat) -> CMat {
        let m = self.c.nrows();
        let h = chi * complex(&self.f);
        CMat::from_fn(m, m, |i, j| h[(i, j)] + h[(j, i)].conj() + self.e[(i, j)])
    }

    /// χ(e^{iθ}), m × n.
    pub(super) fn chi(&self, theta: f64) -> Result<CMat, LinalgError> {
        chi(&self.a, &self.c, theta)
    }
}

fn complex(m: &Mat) -> CMat {
    CMat::from_fn(m.nrows(), m.ncols(), |i, j| C64::new(m[(i, j)], 0.0))
}

fn chi(a: &Mat, c: &Mat, theta: f64) -> Result<CMat, LinalgError> {
    let n = a.nrows();
    let z = C64::from_polar(1.0, theta);
    let pencil = CMat::from_fn(n, n, |i, j| if i == j { z } else { C64::new(0.0, 0.0) } - a[(j, i)]);
    // (zI − A)ᵀ χᵀ = Cᵀ
    Ok(solve_complex(&pencil, &complex(&c.transpose().to_owned()))?.transpose().to_owned())
}

/// Whether samples are those of H + H~ or of H − H~, which has no constant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Parity {
    Even,
    Odd,
}

impl Parity {
    fn sign(self) -> f64 {
        match self {
            Self::Even => 1.0,
            Self::Odd => -1.0,
        }
    }
}

/// E and F by least squares, eq. (2.92) with E = Eᵀ: the triangle that is left, so that constraints can be added.
#[derive(Debug)]
pub(super) struct LeastSquares {
    parity: Parity,
    a: Mat,
    c: Mat,
    folded: usize,
    /// Entries (i, j), j ≤ i, of E: the first unknowns; F's rows follow, times `scale`.
    symmetric: Vec<(usize, usize)>,
    scale: Vec<f64>,
    triangle: Mat,
    /// The free solution.
    best: Vec<f64>,
    /// Root of the sum of squares that it leaves.
    left: f64,
    /// Root of the weighted sum of squares of the samples themselves.
    size: f64,
}

impl LeastSquares {
    pub fn of(
        samples: &Samples,
        parity: Parity,
        a: Mat,
        c: Mat,
        folded: usize,
    ) -> Result<Self, SubspaceError> {
        let (m, n) = (samples.size(), a.nrows());
        let rows_of_e = if parity == Parity::Even { m } else { 0 };
        let symmetric: Vec<(usize, usize)> =
            (0..rows_of_e).flat_map(|i| (0..=i).map(move |j| (i, j))).collect();
        let sign = parity.sign();
        let unknowns = symmetric.len() + n * m;
        // columns of χ alike in size
        let scale: Vec<f64> = (0..n).map(|j| c.subcols(j, 1).norm_l2().max(f64::MIN_POSITIVE)).collect();
        let fill = |k: usize, mut rows: faer::MatMut<'_, f64>| {
            let chi = chi(&a, &c, samples.theta_rad()[k])?;
            let whiten = inverse(&half_of(samples.weights(), k, m));
            let mut put = |column: usize, value: &dyn Fn(usize, usize) -> C64| {
                for i in 0..m {
                    for j in 0..m {
                        let v: C64 = (0..=i).map(|l| whiten[(i, l)] * value(l, j)).sum();
                        rows[(2 * (i * m + j), column)] = v.re;
                        rows[(2 * (i * m + j) + 1, column)] = v.im;
                    }
                }
            };
            let zero = C64::new(0.0, 0.0);
            for (column, (r, s)) in symmetric.iter().enumerate() {
                let on = |i, j| (i == *r && j == *s) || (i == *s && j == *r);
                put(column, &|i, j| if on(i, j) { C64::new(1.0, 0.0) } else { zero });
            }
            for x in 0..n {
                for y in 0..m {
                    // χF + (χF)ᴴ of a unit entry (x, y) of F
                    put(symmetric.len() + x * m + y, &|i, j| {
                        let one = if j == y { chi[(i, x)] / scale[x] } else { zero };
                        one + if i == y { chi[(j, x)].conj() * (sign / scale[x]) } else { zero }
                    });
                }
            }
            put(unknowns, &|i, j| samples.s()[k][(i, j)]);
            Ok(())
        };
        let r = accumulated(samples.count(), unknowns + 1, fill, 2 * m * m)?;
        let triangle = r.submatrix(0, 0, unknowns, unknowns).to_owned();
        let largest = (0..unknowns).map(|i| triangle[(i, i)].abs()).fold(0.0, f64::max);
        let least = (0..unknowns).map(|i| triangle[(i, i)].abs()).fold(f64::INFINITY, f64::min);
        if !(least > f64::EPSILON * largest) {
            let (what, value) = ("the least squares for E and F", least / largest);
            let why = "the samples do not tell its poles apart (an order higher than that of exact data), smallest over largest pivot";
            return Err(LinalgError::Singular { what, why, value }.into());
        }
        let mut x = r.submatrix(0, unknowns, unknowns, 1).to_owned();
        triangle.as_ref().solve_upper_triangular_in_place(x.as_mut());
        let best = (0..unknowns).map(|i| x[(i, 0)]).collect();
        let left = r[(unknowns, unknowns)].abs();
        let size = r.subcols(unknowns, 1).norm_l2();
        Ok(Self { parity, a, c, folded, symmetric, scale, triangle, best, left, size })
    }

    /// The free solution.
    pub fn best(&self) -> Summand {
        self.summand(&self.best)
    }

    pub fn summand(&self, x: &[f64]) -> Summand {
        let (m, n) = (self.c.nrows(), self.a.nrows());
        let mut e = Mat::zeros(m, m);
        for (x, (i, j)) in x.iter().zip(&self.symmetric) {
            (e[(*i, *j)], e[(*j, *i)]) = (*x, *x);
        }
        let first = self.symmetric.len();
        let f = Mat::from_fn(n, m, |i, j| x[first + i * m + j] / self.scale[i]);
        Summand { a: self.a.clone(), c: self.c.clone(), f, e, folded: self.folded }
    }

    /// Root of the weighted sum of squares at x, or at the free solution.
    pub fn misfit(&self, x: Option<&[f64]>) -> f64 {
        let moved = x.map_or(0.0, |x| {
            let step = Mat::from_fn(x.len(), 1, |i, _| x[i] - self.best[i]);
            (&self.triangle * step).norm_l2()
        });
        self.left.hypot(moved)
    }

    /// Root of the weighted sum of squares of the samples.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// g with vᴴS(e^{iθ})v = gᵀx, of even samples.
    pub fn row(&self, theta: f64, v: &[C64]) -> Result<Vec<f64>, LinalgError> {
        debug_assert!(self.parity == Parity::Even);
        let chi = chi(&self.a, &self.c, theta)?;
        let m = self.c.nrows();
        let of_e = self.symmetric.iter().map(|(i, j)| {
            let product = (v[*i].conj() * v[*j]).re;
            if i == j { product } else { 2.0 * product }
        });
        let of_f = (0..self.a.nrows()).flat_map(|x| {
            let seen: C64 = (0..m).map(|i| v[i].conj() * chi[(i, x)]).sum();
            let scale = self.scale[x];
            (0..m).map(move |y| 2.0 * (seen * v[y]).re / scale).collect::<Vec<_>>()
        });
        Ok(of_e.chain(of_f).collect())
    }

    /// The best x with gᵀx ≥ aim for every row g; begun with the multipliers of the first rows, if any.
    pub fn constrained(
        &self,
        rows: &[Vec<f64>],
        aims: &[f64],
        multipliers: &mut Vec<f64>,
    ) -> Result<Vec<f64>, LinalgError> {
        let unknowns = self.best.len();
        // y = R(x − best): rows G R⁻¹
        let mut turned = Mat::from_fn(unknowns, rows.len(), |i, j| rows[j][i]);
        self.triangle.transpose().solve_lower_triangular_in_place(turned.as_mut());
        let h: Vec<f64> = rows
            .iter()
            .zip(aims)
            .map(|(g, aim)| aim - g.iter().zip(&self.best).map(|(g, x)| g * x).sum::<f64>())
            .collect();
        let y = least_distance_from(&turned.transpose().to_owned(), &h, multipliers)?;
        let y =
            y.ok_or(LinalgError::NoConvergence { what: "the constrained least squares", order: unknowns })?;
        let mut step = Mat::from_fn(unknowns, 1, |i, _| y[i]);
        self.triangle.as_ref().solve_upper_triangular_in_place(step.as_mut());
        Ok((0..unknowns).map(|i| self.best[i] + step[(i, 0)]).collect())
    }
}

/// Of a small lower triangular matrix.
fn inverse(l: &CMat) -> CMat {
    let m = l.nrows();
    let mut x = CMat::from_fn(m, m, |i, j| C64::new(f64::from(u8::from(i == j)), 0.0));
    l.as_ref().solve_lower_triangular_in_place(x.as_mut());
    x
}
