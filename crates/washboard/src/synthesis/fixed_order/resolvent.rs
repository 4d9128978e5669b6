//! A closed loop at a frequency: one LU factorisation, its response and what that gains from each entry of the controller.

use super::closed::{Closed, Open};
use super::hessenberg::{self, Hessenberg};
use crate::linalg::{C64, Mat, small};

/// From this order on the matrix is brought to Hessenberg form, in which a factorisation costs n² and not n³.
const LARGE: usize = 6;
/// Factorisations that are kept, the latest ones: a place that was looked at is asked for its derivative later.
const MOST_KEPT: usize = 48;
/// Numbers in them at most.
const MOST_NUMBERS: usize = 1 << 19;
/// So many are likely.
const LIKELY: usize = 32;

/// How many factorisations of an order are kept.
fn kept(n: usize) -> usize {
    (MOST_NUMBERS / (n * n).max(1)).clamp(1, MOST_KEPT)
}

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
    /// One after another, each at its frequency; none where it is singular.
    factors: Vec<C64>,
    pivots: Vec<usize>,
    at: Vec<(f64, bool)>,
    /// Which one is written next when no more are kept.
    next: usize,
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
            factors: Vec::with_capacity(n * n * kept(n).min(LIKELY)),
            pivots: Vec::with_capacity(n * LIKELY),
            at: Vec::with_capacity(LIKELY),
            next: 0,
            x: vec![small::ZERO; n * m],
            counted: 0,
            hessenberg,
        }
    }

    /// Which of the factorisations kept is that at a frequency; none where it is singular.
    fn factor(&mut self, omega: f64) -> Option<usize> {
        let n = self.n;
        if let Some(k) = self.at.iter().rposition(|(w, _)| *w == omega) {
            return self.at[k].1.then_some(k);
        }
        let most = kept(n);
        let k = if self.at.len() < most {
            self.factors.resize(self.factors.len() + n * n, small::ZERO);
            self.pivots.resize(self.pivots.len() + n, 0);
            self.at.push((omega, false));
            self.at.len() - 1
        } else {
            let oldest = self.next;
            self.next = (oldest + 1) % most;
            oldest
        };
        let factors = &mut self.factors[k * n * n..(k + 1) * n * n];
        let pivots = &mut self.pivots[k * n..(k + 1) * n];
        for (f, a) in factors.iter_mut().zip(&self.a) {
            *f = C64::new(-a, 0.0);
        }
        (0..n).for_each(|i| factors[i * n + i].im += omega);
        self.counted += 1;
        let sound = if self.hessenberg.is_some() {
            hessenberg::lu(factors, pivots)
        } else {
            small::lu(factors, pivots)
        };
        self.at[k] = (omega, sound);
        sound.then_some(k)
    }

    /// Factors and pivots of one that is kept.
    fn kept(&self, k: usize) -> (&[C64], &[usize]) {
        let n = self.n;
        (&self.factors[k * n * n..(k + 1) * n * n], &self.pivots[k * n..(k + 1) * n])
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
        let Some(k) = self.factor(omega) else { return false };
        let mut x = std::mem::take(&mut self.x);
        for (x, b) in x.iter_mut().zip(&self.b) {
            *x = C64::new(*b, 0.0);
        }
        let (factors, pivots) = self.kept(k);
        if self.hessenberg.is_some() {
            hessenberg::solve(factors, pivots, &mut x, self.m);
        } else {
            small::lu_solve(factors, pivots, &mut x, self.m);
        }
        for (row, c) in t.chunks_exact_mut(self.m.max(1)).zip(self.c.chunks_exact(self.n)).take(self.p) {
            for (c, x) in c.iter().zip(x.chunks_exact(self.m.max(1))) {
                if *c != 0.0 {
                    row.iter_mut().zip(x).for_each(|(t, x)| *t += *x * *c);
                }
            }
        }
        self.x = x;
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
            let k = self.factor(omega)?;
            let (factors, pivots) = self.kept(k);
            for (r, b) in right.iter_mut().zip(self.b.chunks_exact(self.m.max(1))) {
                *r = b.iter().zip(v).map(|(b, v)| *v * *b).sum();
            }
            if self.hessenberg.is_some() {
                hessenberg::solve(factors, pivots, &mut right, 1);
            } else {
                small::lu_solve(factors, pivots, &mut right, 1);
            }
            for (c, u) in self.c.chunks_exact(n).zip(u) {
                left.iter_mut().zip(c).for_each(|(l, c)| *l += u.conj() * *c);
            }
            value += left.iter().zip(&right).map(|(l, r)| l * r).sum::<C64>();
            match &self.hessenberg {
                Some(h) => {
                    hessenberg::solve_transposed(factors, pivots, &mut left);
                    (left, right) = (h.back(&left), h.back(&right));
                }
                None => small::lu_solve_transposed(factors, pivots, &mut left, 1),
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::{CMat, solve_complex};

    #[test]
    fn places_that_are_looked_at_again_are_not_factored_again_and_older_ones_are_forgotten() {
        for n in [3, LARGE + 1] {
            let any = |i: usize, j: usize| ((5 * i * i + 7 * j + i * j) as f64 + 0.3).sin();
            let block = |r: usize, c: usize| Mat::from_fn(r, c, |i, j| any(i + r, j + c));
            let mut open = Open::bare(1, 1);
            open.a = block(n, n) - Mat::identity(n, n) * 4.0;
            (open.b1, open.b2) = (block(n, 2), block(n, 1));
            (open.c1, open.c2) = (block(2, n), block(1, n));
            (open.d11, open.d12, open.d21) = (block(2, 2), block(2, 1), block(1, 2));
            let closed = open.close(&Mat::zeros(1, 1), 0).unwrap();
            let mut resolvent = Resolvent::new(&open, &closed, 0);
            let mut t = Vec::new();
            let places: Vec<f64> = (0..MOST_KEPT + 20).map(|k| 0.1 * k as f64).collect();
            for round in 1..3 {
                for (k, omega) in places.iter().enumerate() {
                    assert!(resolvent.response(*omega, &mut t));
                    assert_eq!(resolvent.counted, (round - 1) * places.len() + k + 1);
                    assert!(resolvent.derivative(*omega, &t[..2], &t[..2]).is_some());
                    assert_eq!(resolvent.counted, (round - 1) * places.len() + k + 1);
                    let shifted = CMat::from_fn(n, n, |i, j| {
                        C64::new(-closed.a[(i, j)], if i == j { *omega } else { 0.0 })
                    });
                    let b = CMat::from_fn(n, 2, |i, j| C64::new(closed.b[(i, j)], 0.0));
                    let x = solve_complex(&shifted, &b).unwrap();
                    for (place, t) in t.iter().enumerate() {
                        let (i, j) = (place / 2, place % 2);
                        let sum: C64 = (0..n).map(|k| x[(k, j)] * closed.c[(i, k)]).sum();
                        assert!((*t - sum - closed.d[(i, j)]).norm() < 1e-12, "{n} {omega}");
                    }
                }
            }
            // the last ones are at hand
            assert!(resolvent.response(places[30], &mut t) && resolvent.counted == 2 * places.len());
        }
    }
}
