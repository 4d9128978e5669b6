//! A closed loop at a frequency: one LU factorisation, its response and what that gains from each entry of the controller.

use super::closed::{Closed, Open};
use super::hessenberg::{self, Hessenberg};
use crate::linalg::{C64, Mat, small};

/// From this order on the matrix is brought to Hessenberg form, in which a factorisation costs n² and not n³.
const LARGE: usize = 10;

/// A loop's matrices in slices, row after row, with room to work in.
pub(super) struct Resolvent<'a> {
    open: &'a Open,
    order: usize,
    n: usize,
    m: usize,
    p: usize,
    a: Vec<f64>,
    b: Vec<f64>,
    c: Vec<f64>,
    d: Vec<f64>,
    factors: Vec<C64>,
    pivots: Vec<usize>,
    at: f64,
    sound: bool,
    x: Vec<C64>,
    /// Factorisations.
    pub counted: usize,
    hessenberg: Option<Hessenberg>,
}

impl<'a> Resolvent<'a> {
    pub fn new(open: &'a Open, closed: &Closed, order: usize) -> Self {
        let (n, m, p) = (closed.a.nrows(), closed.b.ncols(), closed.c.nrows());
        let rows = |x: &Mat| -> Vec<f64> {
            (0..x.nrows() * x.ncols()).map(|k| x[(k / x.ncols(), k % x.ncols())]).collect()
        };
        let hessenberg = (n >= LARGE).then(|| Hessenberg::new(&closed.a));
        let (mut b, mut c) = (rows(&closed.b), rows(&closed.c));
        if let Some(h) = &hessenberg {
            b = rows(&(h.q.transpose() * &closed.b));
            c = rows(&(&closed.c * &h.q));
        }
        Resolvent {
            open,
            order,
            n,
            m,
            p,
            a: hessenberg.as_ref().map_or_else(|| rows(&closed.a), |h| rows(&h.h)),
            b,
            c,
            d: rows(&closed.d),
            factors: vec![small::ZERO; n * n],
            pivots: vec![0; n],
            at: f64::NAN,
            sound: false,
            x: vec![small::ZERO; n * m],
            counted: 0,
            hessenberg,
        }
    }

    fn factor(&mut self, omega: f64) -> bool {
        if self.at == omega {
            return self.sound;
        }
        for (f, a) in self.factors.iter_mut().zip(&self.a) {
            *f = C64::new(-a, 0.0);
        }
        (0..self.n).for_each(|i| self.factors[i * self.n + i].im += omega);
        self.counted += 1;
        self.at = omega;
        self.sound = if self.hessenberg.is_some() {
            hessenberg::lu(&mut self.factors, &mut self.pivots)
        } else {
            small::lu(&mut self.factors, &mut self.pivots)
        };
        self.sound
    }

    pub fn outputs(&self) -> usize {
        self.p
    }

    pub fn disturbances(&self) -> usize {
        self.m
    }

    /// T(iω), outputs × disturbances, row after row; false on a pole. ω may be infinite.
    pub fn response(&mut self, omega: f64, t: &mut Vec<C64>) -> bool {
        t.clear();
        t.extend(self.d.iter().map(|d| C64::new(*d, 0.0)));
        if omega == f64::INFINITY || self.n == 0 {
            return true;
        }
        if !self.factor(omega) {
            return false;
        }
        for (x, b) in self.x.iter_mut().zip(&self.b) {
            *x = C64::new(*b, 0.0);
        }
        if self.hessenberg.is_some() {
            hessenberg::solve(&self.factors, &self.pivots, &mut self.x, self.m);
        } else {
            small::lu_solve(&self.factors, &self.pivots, &mut self.x, self.m);
        }
        for (row, c) in t.chunks_exact_mut(self.m.max(1)).zip(self.c.chunks_exact(self.n)).take(self.p) {
            for (c, x) in c.iter().zip(self.x.chunks_exact(self.m.max(1))) {
                if *c != 0.0 {
                    row.iter_mut().zip(x).for_each(|(t, x)| *t += *x * *c);
                }
            }
        }
        t.iter().all(|z| z.re.is_finite() && z.im.is_finite())
    }

    /// uᴴ T(iω) v, and its derivative by each entry of the block: (uᴴ T_zu)ᵢ (T_yw v)ⱼ. u is as long as all outputs, v as
    /// all disturbances. None on a pole.
    pub fn derivative(&mut self, omega: f64, u: &[C64], v: &[C64]) -> Option<(C64, Vec<C64>, Vec<C64>)> {
        let (n, nk) = (self.n, self.order);
        let np = n - nk;
        let (nu, ny) = (self.open.b2.ncols(), self.open.c2.nrows());
        let mut right = vec![small::ZERO; n];
        let mut left = vec![small::ZERO; n];
        let through: C64 = (0..self.p)
            .map(|i| u[i].conj() * (0..self.m).map(|j| v[j] * self.d[i * self.m + j]).sum::<C64>())
            .sum();
        let mut value = through;
        if omega < f64::INFINITY && n > 0 {
            if !self.factor(omega) {
                return None;
            }
            for (r, b) in right.iter_mut().zip(self.b.chunks_exact(self.m.max(1))) {
                *r = b.iter().zip(v).map(|(b, v)| *v * *b).sum();
            }
            if self.hessenberg.is_some() {
                hessenberg::solve(&self.factors, &self.pivots, &mut right, 1);
            } else {
                small::lu_solve(&self.factors, &self.pivots, &mut right, 1);
            }
            for (c, u) in self.c.chunks_exact(n).zip(u) {
                left.iter_mut().zip(c).for_each(|(l, c)| *l += u.conj() * *c);
            }
            value += left.iter().enumerate().map(|(i, _)| left[i] * right[i]).sum::<C64>();
            match &self.hessenberg {
                Some(h) => {
                    hessenberg::solve_transposed(&self.factors, &self.pivots, &mut left);
                    (left, right) = (h.back(&left), h.back(&right));
                }
                None => small::lu_solve_transposed(&self.factors, &self.pivots, &mut left, 1),
            }
        }
        let o = self.open;
        let zu: Vec<C64> = left[np..]
            .iter()
            .copied()
            .chain((0..nu).map(|j| {
                (0..np).map(|i| left[i] * o.b2[(i, j)]).sum::<C64>()
                    + (0..self.p).map(|i| u[i].conj() * o.d12[(i, j)]).sum::<C64>()
            }))
            .collect();
        let yw: Vec<C64> = right[np..]
            .iter()
            .copied()
            .chain((0..ny).map(|i| {
                (0..np).map(|j| right[j] * o.c2[(i, j)]).sum::<C64>()
                    + (0..self.m).map(|j| v[j] * o.d21[(i, j)]).sum::<C64>()
            }))
            .collect();
        Some((value, zu, yw))
    }
}
