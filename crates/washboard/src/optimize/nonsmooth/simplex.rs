//! Small quadratic programs over products of simplices, by an interior point.

/// Steps at most: 10 to 25 are usual.
const MOST_STEPS: usize = 60;
/// The gap at the end, as a share of the data's size.
const GAP: f64 = 1e-12;
/// Below this nothing is to be won.
const LEAST_GAP: f64 = 1e-16;
/// How much of the way to the boundary a step goes.
const TO_BOUNDARY: f64 = 0.995;

/// min ½ λᵀQλ − fᵀλ over λ ≥ 0 with Σλ = 1 over the entries of each group.
///
/// `q` is m × m, positive semidefinite, row after row; `group[i]` says to which of `groups` simplices entry i belongs, and
/// none of them is empty. None where numbers overflow.
pub(super) fn minimize(q: &[f64], f: &[f64], group: &[usize], groups: usize) -> Option<Vec<f64>> {
    let m = f.len();
    let members: Vec<f64> = (0..groups).map(|g| group.iter().filter(|h| **h == g).count() as f64).collect();
    // a group's values by their largest: that changes nothing but a constant
    let top: Vec<f64> = (0..groups)
        .map(|g| (0..m).filter(|i| group[*i] == g).map(|i| f[i]).fold(f64::NEG_INFINITY, f64::max))
        .collect();
    let f: Vec<f64> = (0..m).map(|i| f[i] - top[group[i]]).collect();
    let size = q.iter().chain(&f).fold(0.0f64, |s, v| s.max(v.abs()));
    if !size.is_finite() {
        return None;
    }
    if size == 0.0 {
        return Some((0..m).map(|i| 1.0 / members[group[i]]).collect());
    }
    let (q, f): (Vec<f64>, Vec<f64>) =
        (q.iter().map(|v| v / size).collect(), f.iter().map(|v| v / size).collect());
    let mut lambda: Vec<f64> = (0..m).map(|i| 1.0 / members[group[i]]).collect();
    let gradient =
        |lambda: &[f64]| -> Vec<f64> { (0..m).map(|i| dot(&q[i * m..(i + 1) * m], lambda) - f[i]).collect() };
    let g = gradient(&lambda);
    let mut y: Vec<f64> = (0..groups)
        .map(|k| (0..m).filter(|i| group[*i] == k).map(|i| g[i]).fold(f64::INFINITY, f64::min) - 1.0)
        .collect();
    let mut z: Vec<f64> = (0..m).map(|i| g[i] - y[group[i]]).collect();
    let mut matrix = vec![0.0; m * m];
    let mut best = (f64::INFINITY, lambda.clone());
    for _ in 0..MOST_STEPS {
        let g = gradient(&lambda);
        let dual: Vec<f64> = (0..m).map(|i| g[i] - y[group[i]] - z[i]).collect();
        let primal: Vec<f64> = (0..groups)
            .map(|k| (0..m).filter(|i| group[*i] == k).map(|i| lambda[i]).sum::<f64>() - 1.0)
            .collect();
        let mu = dot(&lambda, &z) / m as f64;
        let left = dual.iter().chain(&primal).fold(0.0f64, |s, v| s.max(v.abs()));
        // below a gap of rounding's size the equations lose digits again: the best iterate counts
        if mu.max(left) < best.0 {
            best = (mu.max(left), lambda.clone());
        }
        if best.0 <= GAP || mu <= LEAST_GAP {
            break;
        }
        for i in 0..m {
            matrix[i * m..(i + 1) * m].copy_from_slice(&q[i * m..(i + 1) * m]);
            matrix[i * m + i] += z[i] / lambda[i];
        }
        if !cholesky(&mut matrix, m) {
            break;
        }
        // M⁻¹ of the groups' indicators
        let ones: Vec<Vec<f64>> = (0..groups)
            .map(|k| {
                let mut e: Vec<f64> = (0..m).map(|i| f64::from(u8::from(group[i] == k))).collect();
                solve(&matrix, m, &mut e);
                e
            })
            .collect();
        let newton = |center: &[f64]| {
            let mut h: Vec<f64> = (0..m).map(|i| -dual[i] + center[i] / lambda[i]).collect();
            solve(&matrix, m, &mut h);
            let sum = |v: &[f64], k: usize| (0..m).filter(|i| group[*i] == k).map(|i| v[i]).sum::<f64>();
            let mut small: Vec<f64> = vec![0.0; groups * groups];
            for k in 0..groups {
                for l in 0..groups {
                    small[k * groups + l] = sum(&ones[l], k);
                }
            }
            let right: Vec<f64> = (0..groups).map(|k| -primal[k] - sum(&h, k)).collect();
            let dy = tiny(&small, &right);
            let dl: Vec<f64> =
                (0..m).map(|i| h[i] + (0..groups).map(|k| ones[k][i] * dy[k]).sum::<f64>()).collect();
            let dz: Vec<f64> = (0..m).map(|i| (center[i] - z[i] * dl[i]) / lambda[i]).collect();
            (dl, dy, dz)
        };
        let affine: Vec<f64> = (0..m).map(|i| -lambda[i] * z[i]).collect();
        let (dl, _, dz) = newton(&affine);
        let a = reach(&lambda, &dl).min(reach(&z, &dz)).min(1.0);
        let then: f64 = (0..m).map(|i| (lambda[i] + a * dl[i]) * (z[i] + a * dz[i])).sum::<f64>() / m as f64;
        let sigma = (then / mu).powi(3).clamp(0.0, 1.0);
        let center: Vec<f64> = (0..m).map(|i| sigma * mu - lambda[i] * z[i] - dl[i] * dz[i]).collect();
        let (dl, dy, dz) = newton(&center);
        // one step for both: the dual equations hold Qλ
        let a = (TO_BOUNDARY * reach(&lambda, &dl).min(reach(&z, &dz))).min(1.0);
        if !a.is_finite() || dl.iter().chain(&dz).any(|v| !v.is_finite()) {
            break;
        }
        (0..m).for_each(|i| lambda[i] += a * dl[i]);
        (0..m).for_each(|i| z[i] += a * dz[i]);
        (0..groups).for_each(|k| y[k] += a * dy[k]);
    }
    let lambda = best.1;
    let sums: Vec<f64> =
        (0..groups).map(|k| (0..m).filter(|i| group[*i] == k).map(|i| lambda[i]).sum()).collect();
    let found: Vec<f64> = (0..m).map(|i| lambda[i] / sums[group[i]]).collect();
    found.iter().all(|v| v.is_finite()).then_some(found)
}

/// The longest step that keeps v + t dv ≥ 0.
fn reach(v: &[f64], dv: &[f64]) -> f64 {
    v.iter().zip(dv).filter(|(_, d)| **d < 0.0).map(|(v, d)| -v / d).fold(1e30, f64::min)
}

/// aᵀb.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// L of A = L Lᵀ in place of its lower triangle.
fn cholesky(a: &mut [f64], m: usize) -> bool {
    for i in 0..m {
        let (above, rest) = a.split_at_mut(i * m);
        let row = &mut rest[..m];
        for (j, l) in above.chunks_exact(m).enumerate() {
            row[j] = (row[j] - dot(&row[..j], &l[..j])) / l[j];
        }
        let square = row[i] - dot(&row[..i], &row[..i]);
        if !(square > 0.0 && square.is_finite()) {
            return false;
        }
        row[i] = square.sqrt();
    }
    true
}

/// x of L Lᵀ x = b in place of b.
fn solve(l: &[f64], m: usize, b: &mut [f64]) {
    for i in 0..m {
        b[i] = (b[i] - dot(&l[i * m..i * m + i], &b[..i])) / l[i * m + i];
    }
    for i in (0..m).rev() {
        b[i] /= l[i * m + i];
        let x = b[i];
        (0..i).for_each(|k| b[k] -= l[i * m + k] * x);
    }
}

/// x of a system of a few equations, a symmetric positive definite one: by elimination.
fn tiny(a: &[f64], b: &[f64]) -> Vec<f64> {
    let n = b.len();
    let (mut a, mut x) = (a.to_vec(), b.to_vec());
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
    x
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
            assert!(left < 1e-9 * (1.0 + scale * scale), "{seed}: {left:e}");
            assert!(lambda.iter().all(|l| *l >= 0.0));
        }
    }

    #[test]
    fn numbers_that_overflow_are_none() {
        assert!(minimize(&[f64::INFINITY], &[0.0], &[0], 1).is_none());
    }
}
