//! Small quadratic programs over products of simplices, by an interior point.

use super::simplex::{dot, sums};

/// Steps at most: 10 to 25 are usual.
const MOST_STEPS: usize = 60;
/// The gap at the end, as a share of the data's size.
const GAP: f64 = 1e-12;
/// Below this nothing is to be won.
const LEAST_GAP: f64 = 1e-16;
/// Numbers that are worked on at once.
const LANES: usize = 4;
/// How much of the way to the boundary a step goes.
const TO_BOUNDARY: f64 = 0.995;

/// min ½ λᵀQλ − fᵀλ over λ ≥ 0 with Σλ = 1 over the entries of each group, all numbers of size 1 at most. The sums are so
/// but for rounding.
///
/// Source: Mehrotra, SIAM J. Optim. 2 (1992) 575–601 (predictor and corrector).
pub(super) fn interior_point(q: &[f64], f: &[f64], group: &[usize], groups: usize) -> Vec<f64> {
    let m = f.len();
    let mut members = vec![0.0; groups];
    group.iter().for_each(|g| members[*g] += 1.0);
    let mut lambda: Vec<f64> = group.iter().map(|g| 1.0 / members[*g]).collect();
    // rows in whole groups of four: what is added stays 0
    let wide = m.next_multiple_of(LANES);
    let mut rows = vec![0.0; m * wide];
    for (to, from) in rows.chunks_exact_mut(wide).zip(q.chunks_exact(m)) {
        to[..m].copy_from_slice(from);
    }
    let q = rows;
    lambda.resize(wide, 0.0);
    let mut g = vec![0.0; m];
    gradient(&q, f, &lambda, &mut g);
    let mut y = vec![f64::INFINITY; groups];
    group.iter().zip(&g).for_each(|(k, g)| y[*k] = y[*k].min(*g - 1.0));
    let mut z: Vec<f64> = (0..m).map(|i| g[i] - y[group[i]]).collect();
    let mut newton = Newton::new(m, groups);
    let mut best = (f64::INFINITY, lambda.clone());
    let (mut dual, mut primal, mut center) = (vec![0.0; m], vec![0.0; groups], vec![0.0; m]);
    for _ in 0..MOST_STEPS {
        gradient(&q, f, &lambda, &mut g);
        (0..m).for_each(|i| dual[i] = g[i] - y[group[i]] - z[i]);
        sums(group, &lambda, &mut primal);
        primal.iter_mut().for_each(|v| *v -= 1.0);
        let mu = dot(&lambda[..m], &z) / m as f64;
        let left = dual.iter().chain(&primal).fold(0.0f64, |s, v| s.max(v.abs()));
        // below a gap of rounding's size the equations lose digits again: the best iterate counts
        if mu.max(left) < best.0 {
            best.0 = mu.max(left);
            best.1.copy_from_slice(&lambda);
        }
        if best.0 <= GAP || mu <= LEAST_GAP || !newton.factor(&q, &lambda, &z, group) {
            break;
        }
        (0..m).for_each(|i| center[i] = -lambda[i] * z[i]);
        newton.step(&lambda, &z, group, &dual, &primal, &center);
        let (dl, dz) = (&newton.dl, &newton.dz);
        let a = reach(&lambda[..m], dl).min(reach(&z, dz)).min(1.0);
        let then: f64 = (0..m).map(|i| (lambda[i] + a * dl[i]) * (z[i] + a * dz[i])).sum::<f64>() / m as f64;
        let sigma = (then / mu).powi(3).clamp(0.0, 1.0);
        (0..m).for_each(|i| center[i] = sigma * mu - lambda[i] * z[i] - dl[i] * dz[i]);
        newton.step(&lambda, &z, group, &dual, &primal, &center);
        let (dl, dz) = (&newton.dl, &newton.dz);
        // one step for both: the dual equations hold Qλ
        let a = (TO_BOUNDARY * reach(&lambda[..m], dl).min(reach(&z, dz))).min(1.0);
        if !a.is_finite() || dl.iter().chain(dz).any(|v| !v.is_finite()) {
            break;
        }
        (0..m).for_each(|i| lambda[i] += a * dl[i]);
        (0..m).for_each(|i| z[i] += a * dz[i]);
        (0..groups).for_each(|k| y[k] += a * newton.dy[k]);
    }
    best.1.truncate(m);
    best.1
}

/// Qλ − f.
fn gradient(q: &[f64], f: &[f64], lambda: &[f64], g: &mut [f64]) {
    for ((g, row), f) in g.iter_mut().zip(q.chunks_exact(lambda.len())).zip(f) {
        *g = dot(row, lambda) - f;
    }
}

/// Newton's equations of an iterate, eliminated to M = Q + Z/Λ and the groups' sums.
struct Newton {
    m: usize,
    /// Length of a row, a multiple of [`LANES`].
    wide: usize,
    groups: usize,
    /// U of M = UᵀU above the diagonal, 0 elsewhere, and 1/Uᵢᵢ.
    u: Vec<f64>,
    inverse: Vec<f64>,
    /// M⁻¹ of the groups' indicators, one after another, and their sums.
    ones: Vec<f64>,
    small: Vec<f64>,
    dl: Vec<f64>,
    dy: Vec<f64>,
    dz: Vec<f64>,
}

impl Newton {
    fn new(m: usize, groups: usize) -> Self {
        let none = |n: usize| vec![0.0; n];
        let wide = m.next_multiple_of(LANES);
        Newton {
            m,
            wide,
            groups,
            u: none(m * wide),
            inverse: none(m),
            ones: none(groups * wide),
            small: none(groups * groups),
            dl: none(wide),
            dy: none(groups),
            dz: none(m),
        }
    }

    /// False where rounding has made M indefinite.
    fn factor(&mut self, q: &[f64], lambda: &[f64], z: &[f64], group: &[usize]) -> bool {
        let (m, wide) = (self.m, self.wide);
        self.u.copy_from_slice(q);
        (0..m).for_each(|i| self.u[i * wide + i] += z[i] / lambda[i]);
        if !cholesky(&mut self.u, &mut self.inverse) {
            return false;
        }
        for (k, ones) in self.ones.chunks_exact_mut(wide).enumerate() {
            ones.iter_mut().zip(group).for_each(|(e, g)| *e = f64::from(u8::from(*g == k)));
            solve(&self.u, &self.inverse, ones);
        }
        self.small.fill(0.0);
        for (l, ones) in self.ones.chunks_exact(wide).enumerate() {
            group.iter().zip(ones).for_each(|(k, v)| self.small[k * self.groups + l] += v);
        }
        true
    }

    /// Steps of λ, of the sums' multipliers and of z towards λz = what it is now + `center`.
    fn step(
        &mut self,
        lambda: &[f64],
        z: &[f64],
        group: &[usize],
        dual: &[f64],
        primal: &[f64],
        center: &[f64],
    ) {
        let h = &mut self.dl;
        (0..self.m).for_each(|i| h[i] = -dual[i] + center[i] / lambda[i]);
        solve(&self.u, &self.inverse, h);
        sums(group, h, &mut self.dy);
        self.dy.iter_mut().zip(primal).for_each(|(d, p)| *d = -p - *d);
        tiny(&self.small, &mut self.dy);
        for (ones, dy) in self.ones.chunks_exact(self.wide).zip(&self.dy) {
            h.iter_mut().zip(ones).for_each(|(h, e)| *h += e * dy);
        }
        (0..self.m).for_each(|i| self.dz[i] = (center[i] - z[i] * h[i]) / lambda[i]);
    }
}

/// The longest step that keeps v + t dv ≥ 0.
fn reach(v: &[f64], dv: &[f64]) -> f64 {
    v.iter().zip(dv).filter(|(_, d)| **d < 0.0).map(|(v, d)| -v / d).fold(1e30, f64::min)
}

/// y − f x in place of y, whose lengths are multiples of [`LANES`].
fn take_off(y: &mut [f64], f: f64, x: &[f64]) {
    for (y, x) in y.chunks_exact_mut(LANES).zip(x.chunks_exact(LANES)) {
        for (y, x) in y.iter_mut().zip(x) {
            *y -= f * x;
        }
    }
}

/// U of A = UᵀU above the diagonal of A's rows, 0 in the place of the rest, and 1/Uᵢᵢ: each row is taken off those below.
fn cholesky(a: &mut [f64], inverse: &mut [f64]) -> bool {
    let m = inverse.len();
    let wide = a.len() / m.max(1);
    for k in 0..m {
        let (upto, below) = a.split_at_mut((k + 1) * wide);
        let row = &mut upto[k * wide..];
        let square = row[k];
        if !(square > 0.0 && square.is_finite()) {
            return false;
        }
        inverse[k] = square.sqrt().recip();
        row[..=k].fill(0.0);
        row[k + 1..].iter_mut().for_each(|v| *v *= inverse[k]);
        for (i, other) in below.chunks_exact_mut(wide).enumerate() {
            let from = first(k + 1 + i);
            take_off(&mut other[from..], row[k + 1 + i], &row[from..]);
        }
    }
    true
}

/// Where the group of four begins that an entry is in.
fn first(i: usize) -> usize {
    i - i % LANES
}

/// x of UᵀU x = b in place of b.
fn solve(u: &[f64], inverse: &[f64], b: &mut [f64]) {
    let wide = b.len();
    for (i, row) in u.chunks_exact(wide).enumerate() {
        b[i] *= inverse[i];
        let x = b[i];
        take_off(&mut b[first(i)..], x, &row[first(i)..]);
    }
    for (i, row) in u.chunks_exact(wide).enumerate().rev() {
        b[i] = (b[i] - dot(&row[first(i)..], &b[first(i)..])) * inverse[i];
    }
}

/// x of a system of a few equations, a symmetric positive definite one, in place of b: by elimination.
fn tiny(a: &[f64], x: &mut [f64]) {
    let n = x.len();
    let mut a = a.to_vec();
    for k in 0..n {
        for i in k + 1..n {
            let factor = a[i * n + k] / a[k * n + k];
            (k..n).for_each(|j| a[i * n + j] -= factor * a[k * n + j]);
            x[i] -= factor * x[k];
        }
    }
    for k in (0..n).rev() {
        x[k] = (x[k] - (k + 1..n).map(|j| a[k * n + j] * x[j]).sum::<f64>()) / a[k * n + k];
    }
}
