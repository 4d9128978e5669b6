//! Small quadratic programs over products of simplices, by an active set: exact, and quick where few entries are not 0.

use super::simplex::dot;

/// Curvature added along every direction, as a share of its entries': two alike have none between them.
const ADDED: f64 = 1e-13;
/// An entry comes in where it gains more than this share of what its slope is made of.
const GAIN: f64 = 1e-14;

/// min ½ λᵀQλ − fᵀλ over λ ≥ 0 with Σλ = 1 over the entries of each group, from the entry of each group whose f is the
/// largest: Newton steps in those that are let in, the one let go that would become negative first, the one with the
/// steepest slope let in where nothing is left to gain.
///
/// None where rounding keeps it from ending in 4 m + 20 steps, or where more than `most` entries are let in: then an
/// interior point is as quick.
///
/// Source: Nocedal and Wright, *Numerical Optimization*, 2nd ed., algorithm 16.3.
pub(super) fn active_set(
    q: &[f64],
    f: &[f64],
    group: &[usize],
    groups: usize,
    most: usize,
) -> Option<Vec<f64>> {
    let m = f.len();
    let mut lambda = vec![0.0; m];
    // let in, each group's first the one that the others are counted from
    let mut inside: Vec<usize> = Vec::with_capacity(most + groups);
    for k in 0..groups {
        let best = (0..m).filter(|i| group[*i] == k).max_by(|i, j| f[*i].total_cmp(&f[*j]))?;
        lambda[best] = 1.0;
        inside.push(best);
    }
    let size: Vec<f64> =
        (0..m).map(|i| q[i * m..(i + 1) * m].iter().fold(f[i].abs(), |s, v| s.max(v.abs()))).collect();
    let mut room = Room::default();
    let mut g = vec![0.0; m];
    let mut y = vec![0.0; groups];
    for _ in 0..4 * m + 20 {
        for i in 0..m {
            g[i] = inside.iter().map(|j| q[i * m + j] * lambda[*j]).sum::<f64>() - f[i];
        }
        let moved = room.step(q, m, &g, group, groups, &mut inside, &lambda)?;
        let mut reach = 1.0;
        let mut blocks = None;
        for (place, (i, d)) in inside.iter().zip(moved).enumerate() {
            if *d < 0.0 && -lambda[*i] / d < reach {
                (reach, blocks) = (-lambda[*i] / d, Some(place));
            }
        }
        for (i, d) in inside.iter().zip(moved) {
            lambda[*i] = (lambda[*i] + reach * d).max(0.0);
        }
        if let Some(place) = blocks {
            lambda[inside[place]] = 0.0;
            inside.remove(place);
            continue;
        }
        y.fill(0.0);
        for i in 0..m {
            g[i] = inside.iter().map(|j| q[i * m + j] * lambda[*j]).sum::<f64>() - f[i];
        }
        inside.iter().for_each(|i| y[group[*i]] += lambda[*i] * g[*i]);
        let steep = |i: usize| (y[group[i]] - g[i]) / (size[i] + size[inside[0]]);
        let next = (0..m)
            .filter(|i| !inside.contains(i))
            .max_by(|i, j| steep(*i).total_cmp(&steep(*j)))
            .filter(|i| steep(*i) > GAIN);
        match next {
            None => return lambda.iter().all(|l| l.is_finite()).then_some(lambda),
            Some(i) if inside.len() < most + groups => inside.push(i),
            Some(_) => return None,
        }
    }
    None
}

/// Room to work in.
#[derive(Default)]
struct Room {
    h: Vec<f64>,
    d: Vec<f64>,
    from: Vec<usize>,
    moved: Vec<f64>,
}

impl Room {
    /// Newton's step of the entries inside that keeps the groups' sums; each group is counted from its largest entry.
    #[allow(clippy::too_many_arguments, reason = "a step of one loop, in a place of its own")]
    fn step(
        &mut self,
        q: &[f64],
        m: usize,
        g: &[f64],
        group: &[usize],
        groups: usize,
        inside: &mut [usize],
        lambda: &[f64],
    ) -> Option<&[f64]> {
        // of each group the largest first, in its groups' order
        for k in 0..groups {
            let largest = (k..inside.len())
                .filter(|p| group[inside[*p]] == k)
                .max_by(|p, r| lambda[inside[*p]].total_cmp(&lambda[inside[*r]]))?;
            inside.swap(k, largest);
        }
        let free = &inside[groups..];
        let n = free.len();
        self.from.clear();
        self.from.extend(free.iter().map(|i| inside[group[*i]]));
        self.h.clear();
        self.h.resize(n * n, 0.0);
        for a in 0..n {
            let (i, r) = (free[a], self.from[a]);
            for b in 0..=a {
                let (j, s) = (free[b], self.from[b]);
                self.h[a * n + b] = q[i * m + j] - q[i * m + s] - q[r * m + j] + q[r * m + s];
            }
            self.h[a * n + a] += ADDED * (q[i * m + i] + q[r * m + r]) + f64::MIN_POSITIVE;
        }
        self.d.clear();
        self.d.extend(free.iter().zip(&self.from).map(|(i, r)| g[*r] - g[*i]));
        if !solved(&mut self.h, &mut self.d) {
            return None;
        }
        self.moved.clear();
        self.moved.resize(groups, 0.0);
        for (i, d) in free.iter().zip(&self.d) {
            self.moved[group[*i]] -= d;
        }
        self.moved.extend(&self.d);
        Some(&self.moved)
    }
}

/// x of a symmetric positive definite system in place of b, its lower triangle given; false where rounding has made it
/// indefinite.
fn solved(h: &mut [f64], b: &mut [f64]) -> bool {
    let n = b.len();
    for i in 0..n {
        let (above, rest) = h.split_at_mut(i * n);
        let row = &mut rest[..n];
        for (j, l) in above.chunks_exact(n).enumerate() {
            row[j] = (row[j] - dot(&row[..j], &l[..j])) * l[j];
        }
        let square = row[i] - dot(&row[..i], &row[..i]);
        if !(square > 0.0 && square.is_finite()) {
            return false;
        }
        // 1/Lᵢᵢ in the diagonal's place
        row[i] = square.sqrt().recip();
        b[i] = (b[i] - dot(&row[..i], &b[..i])) * row[i];
    }
    for i in (0..n).rev() {
        b[i] *= h[i * n + i];
        let x = b[i];
        (0..i).for_each(|k| b[k] -= h[i * n + k] * x);
    }
    true
}
