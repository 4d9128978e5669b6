//! Small quadratic programs over products of simplices: an active set, and where that is no shorter an interior point.

use super::active_set::active_set;
use super::interior::interior_point;

/// Entries beside one of each group that an active set may let in.
const MOST_INSIDE: usize = 24;
/// Sums that are made at once.
const LANES: usize = 4;

/// min ½ λᵀQλ − fᵀλ over λ ≥ 0 with Σλ = 1 over the entries of each group.
///
/// `q` is m × m, positive semidefinite, row after row; `group[i]` says to which of `groups` simplices entry i belongs, and
/// none of them is empty. None where numbers overflow.
pub(super) fn minimize(q: &[f64], f: &[f64], group: &[usize], groups: usize) -> Option<Vec<f64>> {
    // a group's values by their largest: that changes nothing but a constant
    let mut top = vec![f64::NEG_INFINITY; groups];
    group.iter().zip(f).for_each(|(g, f)| top[*g] = top[*g].max(*f));
    let mut f: Vec<f64> = group.iter().zip(f).map(|(g, f)| f - top[*g]).collect();
    let size = q.iter().chain(&f).fold(0.0f64, |s, v| s.max(v.abs()));
    if !size.is_finite() {
        return None;
    }
    let by = if size > 0.0 { size } else { 1.0 };
    let q: Vec<f64> = q.iter().map(|v| v / by).collect();
    f.iter_mut().for_each(|v| *v /= by);
    let mut lambda = active_set(&q, &f, group, groups, MOST_INSIDE)
        .unwrap_or_else(|| interior_point(&q, &f, group, groups));
    let mut whole = vec![0.0; groups];
    sums(group, &lambda, &mut whole);
    lambda.iter_mut().zip(group).for_each(|(l, g)| *l /= whole[*g]);
    lambda.iter().all(|v| v.is_finite()).then_some(lambda)
}

/// Of each group the sum.
pub(super) fn sums(group: &[usize], v: &[f64], sums: &mut [f64]) {
    sums.fill(0.0);
    group.iter().zip(v).for_each(|(k, v)| sums[*k] += v);
}

/// aᵀb, in four sums: one after another they wait for each other.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut four = [0.0; LANES];
    let (mut a, mut b) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    for (a, b) in (&mut a).zip(&mut b) {
        four.iter_mut().zip(a.iter().zip(b)).for_each(|(s, (a, b))| *s += a * b);
    }
    let rest: f64 = a.remainder().iter().zip(b.remainder()).map(|(a, b)| a * b).sum();
    (four[0] + four[2]) + (four[1] + four[3]) + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The optimality conditions, which are enough in a convex program: where λᵢ > 0 the gradient is its group's least.
    fn residual(q: &[f64], f: &[f64], group: &[usize], groups: usize, lambda: &[f64]) -> f64 {
        let m = f.len();
        let g: Vec<f64> = (0..m).map(|i| dot(&q[i * m..(i + 1) * m], lambda) - f[i]).collect();
        (0..groups)
            .map(|k| {
                let of = || (0..m).filter(|i| group[*i] == k);
                let least = of().map(|i| g[i]).fold(f64::INFINITY, f64::min);
                of().map(|i| lambda[i] * (g[i] - least)).sum::<f64>()
            })
            .sum()
    }

    #[test]
    fn the_nearest_point_of_a_triangle_to_the_origin() {
        // corners (1, 1), (1, −1), (3, 0): the middle of the first two
        let p = [[1.0, 1.0], [1.0, -1.0], [3.0, 0.0]];
        let q: Vec<f64> = (0..9).map(|k| dot(&p[k / 3], &p[k % 3])).collect();
        let lambda = minimize(&q, &[0.0; 3], &[0; 3], 1).unwrap();
        assert!((lambda[0] - 0.5).abs() < 1e-7 && (lambda[1] - 0.5).abs() < 1e-7, "{lambda:?}");
    }

    #[test]
    fn random_programs_meet_their_conditions() {
        use rand::{Rng, SeedableRng};
        let mut ended = 0;
        for seed in 0..200 {
            let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
            let (m, n, groups) = (rng.random_range(3..30), rng.random_range(1..8), 1 + (seed % 3) as usize);
            let scale = 10f64.powi((seed % 7) as i32 - 3);
            let rows: Vec<Vec<f64>> =
                (0..m).map(|_| (0..n).map(|_| scale * rng.random_range(-1.0..1.0)).collect()).collect();
            let q: Vec<f64> = (0..m * m).map(|k| dot(&rows[k / m], &rows[k % m])).collect();
            let f: Vec<f64> = (0..m).map(|_| rng.random_range(-1.0..1.0)).collect();
            let group: Vec<usize> = (0..m).map(|i| i % groups).collect();
            let lambda = minimize(&q, &f, &group, groups).unwrap();
            let left = residual(&q, &f, &group, groups, &lambda);
            // the interior point's gap, where an active set does not end
            assert!(left < 1e-12 * (1.0 + scale * scale), "{seed}: {left:e}");
            assert!(lambda.iter().all(|l| *l >= 0.0));
            // the other route: as low, to what an interior point comes to
            let other = interior_point(&q, &f, &group, groups);
            let value = |l: &[f64]| -> f64 {
                (0..m).map(|i| l[i] * (0.5 * dot(&q[i * m..(i + 1) * m], l) - f[i])).sum()
            };
            let (one, two) = (value(&lambda), value(&other));
            assert!((one - two).abs() < 1e-9 * (1.0 + scale * scale), "{seed}: {one} {two}");
            ended += usize::from(active_set(&q, &f, &group, groups, MOST_INSIDE).is_some());
        }
        assert!(ended >= 195, "{ended}");
    }

    #[test]
    fn entries_that_are_twice_there_do_no_harm() {
        // the same slope at two heights, and one that is wholly twice there
        let p = [[1.0, 0.0], [1.0, 0.0], [-1.0, 0.5], [-1.0, 0.5]];
        let q: Vec<f64> = (0..16).map(|k| dot(&p[k / 4], &p[k % 4])).collect();
        let f = [0.0, -0.3, 0.0, 0.0];
        let lambda = minimize(&q, &f, &[0; 4], 1).unwrap();
        assert!(lambda[1] == 0.0 && (lambda[0] - 9.0 / 17.0).abs() < 1e-12, "{lambda:?}");
    }

    #[test]
    fn numbers_that_overflow_are_none() {
        assert!(minimize(&[f64::INFINITY], &[0.0], &[0], 1).is_none());
    }
}
