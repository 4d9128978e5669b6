//! A matrix brought to Hessenberg form once, so that iωI − A costs n² a frequency.

use crate::linalg::{C64, Mat};

/// A = Q H Qᵀ, H zero below its first subdiagonal; row after row.
pub(super) struct Hessenberg {
    pub order: usize,
    pub q: Vec<f64>,
    pub h: Vec<f64>,
}

impl Hessenberg {
    /// By Householder reflections.
    pub fn new(a: &Mat) -> Self {
        let n = a.nrows();
        let mut h: Vec<f64> = (0..n * n).map(|k| a[(k / n, k % n)]).collect();
        let mut q: Vec<f64> = (0..n * n).map(|k| f64::from(u8::from(k / n == k % n))).collect();
        let mut room = vec![0.0; 2 * n];
        for k in 0..n.saturating_sub(2) {
            let (v, sums) = room.split_at_mut(n);
            let v = &mut v[..n - k - 1];
            v.iter_mut().enumerate().for_each(|(i, v)| *v = h[(k + 1 + i) * n + k]);
            let norm = v.iter().map(|x| x * x).sum::<f64>().sqrt();
            if !(norm > 0.0) || v[1..].iter().all(|x| *x == 0.0) {
                continue;
            }
            let alpha = -norm.copysign(v[0]);
            v[0] -= alpha;
            let tau = 2.0 / v.iter().map(|x| x * x).sum::<f64>();
            // from the left: what is left of column k is known
            let below = &mut h[(k + 1) * n..];
            let sums = &mut sums[k..];
            sums.fill(0.0);
            for (x, row) in v.iter().zip(below.chunks_exact(n)) {
                sums.iter_mut().zip(&row[k..]).for_each(|(s, h)| *s += x * h);
            }
            for (x, row) in v.iter().zip(below.chunks_exact_mut(n)) {
                let f = tau * x;
                row[k..].iter_mut().zip(&*sums).for_each(|(h, s)| *h -= f * s);
            }
            for m in [&mut h, &mut q] {
                for row in m.chunks_exact_mut(n) {
                    let row = &mut row[k + 1..];
                    let f = tau * v.iter().zip(&*row).map(|(x, m)| x * m).sum::<f64>();
                    row.iter_mut().zip(&*v).for_each(|(m, x)| *m -= f * x);
                }
            }
            (k + 2..n).for_each(|i| h[i * n + k] = 0.0);
        }
        Hessenberg { order: n, q, h }
    }

    /// Qᵀ B of B's rows one after another.
    pub fn turned(&self, b: &Mat) -> Vec<f64> {
        let (n, m) = (self.order, b.ncols());
        let mut out = vec![0.0; n * m];
        for (i, row) in self.q.chunks_exact(n.max(1)).enumerate() {
            for (q, out) in row.iter().zip(out.chunks_exact_mut(m.max(1))) {
                out.iter_mut().enumerate().for_each(|(j, o)| *o += q * b[(i, j)]);
            }
        }
        out
    }

    /// C Q of C's rows one after another.
    pub fn out_of(&self, c: &Mat) -> Vec<f64> {
        let (n, p) = (self.order, c.nrows());
        let mut out = vec![0.0; p * n];
        for (r, out) in out.chunks_exact_mut(n.max(1)).enumerate() {
            for (i, q) in self.q.chunks_exact(n.max(1)).enumerate() {
                let c = c[(r, i)];
                if c != 0.0 {
                    out.iter_mut().zip(q).for_each(|(o, q)| *o += c * q);
                }
            }
        }
        out
    }
}

/// P A = L U of a Hessenberg matrix in place, row after row: `pivots[k]` is k + 1 where the two rows were swapped. The
/// factor of each elimination stands below the diagonal.
pub(super) fn lu(a: &mut [C64], pivots: &mut [usize]) -> bool {
    let n = pivots.len();
    for k in 0..n {
        let row =
            if k + 1 < n && a[(k + 1) * n + k].norm_sqr() > a[k * n + k].norm_sqr() { k + 1 } else { k };
        if row != k {
            let (one, other) = a.split_at_mut((k + 1) * n);
            one[k * n + k..].swap_with_slice(&mut other[k..n]);
        }
        pivots[k] = row;
        let size = a[k * n + k].norm_sqr();
        if !(size > 0.0 && size.is_finite()) {
            return false;
        }
        if k + 1 < n {
            let (top, below) = a.split_at_mut((k + 1) * n);
            let pivot = &top[k * n + k..];
            let row = &mut below[k..n];
            let factor = row[0] / pivot[0];
            row[0] = factor;
            take_off(&mut row[1..], factor, &pivot[1..]);
        }
    }
    true
}

/// X of A X = B in place of B (n × columns).
pub(super) fn solve(factors: &[C64], pivots: &[usize], b: &mut [C64], columns: usize) {
    let n = pivots.len();
    for k in 0..n.saturating_sub(1) {
        let (one, other) = b.split_at_mut((k + 1) * columns);
        let (one, other) = (&mut one[k * columns..], &mut other[..columns]);
        if pivots[k] != k {
            one.swap_with_slice(other);
        }
        take_off(other, factors[(k + 1) * n + k], one);
    }
    for i in (0..n).rev() {
        let (upto, below) = b.split_at_mut((i + 1) * columns);
        let row = &mut upto[i * columns..];
        for (k, x) in below.chunks_exact(columns.max(1)).enumerate() {
            take_off(row, factors[i * n + i + 1 + k], x);
        }
        let inverse = factors[i * n + i].inv();
        row.iter_mut().for_each(|v| *v *= inverse);
    }
}

/// x of Aᵀ x = b in place of b.
pub(super) fn solve_transposed(factors: &[C64], pivots: &[usize], b: &mut [C64]) {
    let n = pivots.len();
    for i in 0..n {
        b[i] /= factors[i * n + i];
        let (done, rest) = b.split_at_mut(i + 1);
        take_off(rest, done[i], &factors[i * n + i + 1..(i + 1) * n]);
    }
    for k in (0..n.saturating_sub(1)).rev() {
        let x = b[k + 1];
        b[k] -= factors[(k + 1) * n + k] * x;
        if pivots[k] != k {
            b.swap(k, k + 1);
        }
    }
}

/// y − f x in place of y.
fn take_off(y: &mut [C64], f: C64, x: &[C64]) {
    for (y, x) in y.iter_mut().zip(x) {
        y.re -= f.re * x.re - f.im * x.im;
        y.im -= f.re * x.im + f.im * x.re;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::{CMat, solve_complex};

    #[test]
    fn solutions_are_those_of_a_plain_solve() {
        for n in [1, 2, 3, 12] {
            let any = |i: usize, j: usize, s: f64| ((5 * i * i + 7 * j + i * j) as f64 + s).sin();
            let a = Mat::from_fn(n, n, |i, j| any(i, j, 0.3));
            let form = Hessenberg::new(&a);
            let of = |rows: &[f64]| Mat::from_fn(n, n, |i, j| rows[i * n + j]);
            let (q, h) = (of(&form.q), of(&form.h));
            assert!((&q * &h * q.transpose() - &a).norm_l2() < 1e-13 * a.norm_l2());
            assert!((&q * q.transpose() - Mat::identity(n, n)).norm_l2() < 1e-13);
            assert!((2..n).all(|i| (0..i - 1).all(|j| h[(i, j)] == 0.0)));
            assert!((of(&form.turned(&a)) - q.transpose() * &a).norm_l2() < 1e-13 * a.norm_l2());
            assert!((of(&form.out_of(&a)) - &a * &q).norm_l2() < 1e-13 * a.norm_l2());
            let shift = C64::new(0.2, 1.3);
            let entry = |m: &Mat, i: usize, j: usize| {
                C64::new(-m[(i, j)], 0.0) + if i == j { shift } else { C64::new(0.0, 0.0) }
            };
            let mut factors: Vec<C64> = (0..n * n).map(|k| entry(&h, k / n, k % n)).collect();
            let plain = CMat::from_fn(n, n, |i, j| entry(&h, i, j));
            let mut pivots = vec![0; n];
            assert!(lu(&mut factors, &mut pivots));
            let b: Vec<C64> = (0..2 * n).map(|k| C64::new(any(k, 1, 0.0), any(k, 2, 1.0))).collect();
            let mut x = b.clone();
            solve(&factors, &pivots, &mut x, 2);
            let right = CMat::from_fn(n, 2, |i, j| b[i * 2 + j]);
            let known = solve_complex(&plain, &right).unwrap();
            assert!((0..2 * n).all(|k| (x[k] - known[(k / 2, k % 2)]).norm() < 1e-11), "{n}");
            let mut y = b[..n].to_vec();
            solve_transposed(&factors, &pivots, &mut y);
            let right = CMat::from_fn(n, 1, |i, _| b[i]);
            let known = solve_complex(&plain.transpose().to_owned(), &right).unwrap();
            assert!((0..n).all(|i| (y[i] - known[(i, 0)]).norm() < 1e-11), "{n}");
        }
    }
}
