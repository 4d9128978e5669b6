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

/// How many factorisations of an order are kept.
fn kept(n: usize) -> usize {
    (MOST_NUMBERS / (n * n).max(1)).clamp(1, MOST_KEPT)
}

/// A loop's matrices in slices, row after row, with room to work in.
pub(super) struct Resolvent {
    order: usize,
    n: usize,
    m: usize,
    p: usize,
    nu: usize,
    ny: usize,
    a: Vec<f64>,
    b: Vec<f64>,
    c: Vec<f64>,
    d: Vec<f64>,
    /// What a controller's entry sees of the states, and what of the outputs: zu = `into` left + D₁₂ᵀu.
    to_controls: Vec<f64>,
    d12: Vec<f64>,
    /// And yw = `out` right + D₂₁v.
    from_states: Vec<f64>,
    d21: Vec<f64>,
    room: Room,
    /// Which one is written next when no more are kept.
    next: usize,
    /// Factorisations.
    pub counted: usize,
    in_form: bool,
}

/// What a loop's factorisations are kept in: another loop's can be kept there after it.
#[derive(Debug, Default)]
pub(super) struct Room {
    /// One after another, each at its frequency; none where it is singular.
    factors: Vec<C64>,
    pivots: Vec<usize>,
    at: Vec<(f64, bool)>,
    x: Vec<C64>,
}

/// The loop's matrix in Hessenberg form, where that pays.
pub(super) fn form(closed: &Closed) -> Option<Hessenberg> {
    (closed.a.nrows() >= LARGE).then(|| Hessenberg::new(&closed.a))
}

impl Resolvent {
    pub fn new(open: &Open, closed: &Closed, order: usize, form: Option<Hessenberg>, mut room: Room) -> Self {
        let (n, m, p) = (closed.a.nrows(), closed.b.ncols(), closed.c.nrows());
        let rows = |x: &Mat| -> Vec<f64> {
            (0..x.nrows() * x.ncols()).map(|k| x[(k / x.ncols(), k % x.ncols())]).collect()
        };
        let np = n - order;
        let (nu, ny) = (open.b2.ncols(), open.c2.nrows());
        // the controller's states, then what its outputs do and its inputs see
        let own = |i: usize, j: usize| f64::from(u8::from(i + np == j));
        let seen = Mat::from_fn(order + ny, n, |i, j| match (i < order, j < np) {
            (true, _) => own(i, j),
            (false, true) => open.c2[(i - order, j)],
            (false, false) => 0.0,
        });
        let done = Mat::from_fn(order + nu, n, |i, j| match (i < order, j < np) {
            (true, _) => own(i, j),
            (false, true) => open.b2[(j, i - order)],
            (false, false) => 0.0,
        });
        room.at.clear();
        room.factors.clear();
        room.pivots.clear();
        room.x.clear();
        room.x.resize(n * m, small::ZERO);
        let in_form = form.is_some();
        let (b, c, to_controls, from_states, a) = match form {
            Some(f) => (f.turned(&closed.b), f.out_of(&closed.c), f.out_of(&done), f.out_of(&seen), f.h),
            None => (rows(&closed.b), rows(&closed.c), rows(&done), rows(&seen), rows(&closed.a)),
        };
        Resolvent {
            order,
            n,
            m,
            p,
            nu,
            ny,
            a,
            b,
            c,
            d: rows(&closed.d),
            to_controls,
            d12: rows(&open.d12),
            from_states,
            d21: rows(&open.d21),
            room,
            next: 0,
            counted: 0,
            in_form,
        }
    }

    /// The room, for another loop.
    pub fn into_room(self) -> Room {
        self.room
    }

    /// Which of the factorisations kept is that at a frequency; none where it is singular.
    fn factor(&mut self, omega: f64) -> Option<usize> {
        let n = self.n;
        if let Some(k) = self.room.at.iter().rposition(|(w, _)| *w == omega) {
            return self.room.at[k].1.then_some(k);
        }
        let most = kept(n);
        let k = if self.room.at.len() < most {
            self.room.factors.resize(self.room.factors.len() + n * n, small::ZERO);
            self.room.pivots.resize(self.room.pivots.len() + n, 0);
            self.room.at.push((omega, false));
            self.room.at.len() - 1
        } else {
            let oldest = self.next;
            self.next = (oldest + 1) % most;
            oldest
        };
        let factors = &mut self.room.factors[k * n * n..(k + 1) * n * n];
        let pivots = &mut self.room.pivots[k * n..(k + 1) * n];
        for (f, a) in factors.iter_mut().zip(&self.a) {
            *f = C64::new(-a, 0.0);
        }
        (0..n).for_each(|i| factors[i * n + i].im += omega);
        self.counted += 1;
        let sound = if self.in_form { hessenberg::lu(factors, pivots) } else { small::lu(factors, pivots) };
        self.room.at[k] = (omega, sound);
        sound.then_some(k)
    }

    /// Factors and pivots of one that is kept.
    fn kept(&self, k: usize) -> (&[C64], &[usize]) {
        let n = self.n;
        (&self.room.factors[k * n * n..(k + 1) * n * n], &self.room.pivots[k * n..(k + 1) * n])
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
        let mut x = std::mem::take(&mut self.room.x);
        for (x, b) in x.iter_mut().zip(&self.b) {
            *x = C64::new(*b, 0.0);
        }
        let (factors, pivots) = self.kept(k);
        if self.in_form {
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
        self.room.x = x;
        t.iter().all(|z| z.re.is_finite() && z.im.is_finite())
    }

    /// uᴴ T(iω) v, and its derivative by each entry of the block: (uᴴ T_zu)ᵢ (T_yw v)ⱼ. u is as long as all outputs, v as
    /// all disturbances. None on a pole.
    pub fn derivative(&mut self, omega: f64, u: &[C64], v: &[C64]) -> Option<(C64, Vec<C64>, Vec<C64>)> {
        let (n, m) = (self.n, self.m);
        let mut value: C64 =
            (0..self.p).map(|i| u[i].conj() * (0..m).map(|j| v[j] * self.d[i * m + j]).sum::<C64>()).sum();
        let (order, nu, ny) = (self.order, self.nu, self.ny);
        let (mut zu, mut yw) = (vec![small::ZERO; order + nu], vec![small::ZERO; order + ny]);
        if omega < f64::INFINITY && n > 0 {
            let k = self.factor(omega)?;
            let (factors, pivots) = self.kept(k);
            let mut right: Vec<C64> =
                self.b.chunks_exact(m.max(1)).map(|b| b.iter().zip(v).map(|(b, v)| *v * *b).sum()).collect();
            right.resize(n, small::ZERO);
            if self.in_form {
                hessenberg::solve(factors, pivots, &mut right, 1);
            } else {
                small::lu_solve(factors, pivots, &mut right, 1);
            }
            let mut left = vec![small::ZERO; n];
            for (c, u) in self.c.chunks_exact(n).zip(u) {
                left.iter_mut().zip(c).for_each(|(l, c)| *l += u.conj() * *c);
            }
            value += left.iter().zip(&right).map(|(l, r)| l * r).sum::<C64>();
            if self.in_form {
                hessenberg::solve_transposed(factors, pivots, &mut left);
            } else {
                small::lu_solve_transposed(factors, pivots, &mut left, 1);
            }
            for (out, rows, x) in [(&mut zu, &self.to_controls, left), (&mut yw, &self.from_states, right)] {
                for (out, row) in out.iter_mut().zip(rows.chunks_exact(n)) {
                    *out = row.iter().zip(&x).map(|(r, x)| *x * *r).sum();
                }
            }
        }
        for (j, z) in zu[order..].iter_mut().enumerate() {
            *z += (0..self.p).map(|i| u[i].conj() * self.d12[i * nu + j]).sum::<C64>();
        }
        for (i, y) in yw[order..].iter_mut().enumerate() {
            *y += (0..m).map(|j| v[j] * self.d21[i * m + j]).sum::<C64>();
        }
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
            let mut resolvent = Resolvent::new(&open, &closed, 0, form(&closed), Room::default());
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
