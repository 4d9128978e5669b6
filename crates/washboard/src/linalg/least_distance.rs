//! Least squares with inequalities: Lawson and Hanson's active sets.

use super::dense::{LinalgError, Mat};

/// A gradient below this share of the data's size is zero.
const ZERO: f64 = 1e-12;
/// A column with less than this share of its length outside the others' span is one of them.
const DEPENDENT: f64 = 1e-14;

/// Q and R of columns that come and go: O(m k) for each, where a new factorisation takes O(m k²).
#[derive(Debug, Default)]
struct Chosen {
    /// Which columns.
    of: Vec<usize>,
    /// Orthonormal, of length m.
    q: Vec<Vec<f64>>,
    /// Column j has j + 1 entries.
    r: Vec<Vec<f64>>,
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

impl Chosen {
    /// Whether the column is outside the others' span, and was taken.
    fn enter(&mut self, index: usize, column: &[f64]) -> bool {
        let (mut v, mut r) = (column.to_vec(), vec![0.0; self.q.len() + 1]);
        // twice is enough (Kahan, Parlett)
        for _ in 0..2 {
            for (q, r) in self.q.iter().zip(&mut r) {
                let share = dot(q, &v);
                v.iter_mut().zip(q).for_each(|(v, q)| *v -= share * q);
                *r += share;
            }
        }
        let length = dot(&v, &v).sqrt();
        if !(length > DEPENDENT * dot(column, column).sqrt()) {
            return false;
        }
        v.iter_mut().for_each(|v| *v /= length);
        r[self.q.len()] = length;
        self.of.push(index);
        self.q.push(v);
        self.r.push(r);
        true
    }

    /// Takes the k-th of them out: R is a Hessenberg matrix then, and Givens rotations make it triangular.
    fn leave(&mut self, k: usize) {
        self.of.remove(k);
        self.r.remove(k);
        for j in k..self.r.len() {
            let (x, y) = (self.r[j][j], self.r[j][j + 1]);
            let length = x.hypot(y);
            let (c, s) = (x / length, y / length);
            for column in &mut self.r[j..] {
                (column[j], column[j + 1]) =
                    (c * column[j] + s * column[j + 1], c * column[j + 1] - s * column[j]);
            }
            self.r[j].truncate(j + 1);
            let (left, right) = self.q.split_at_mut(j + 1);
            for (x, y) in left[j].iter_mut().zip(&mut right[0]) {
                (*x, *y) = (c * *x + s * *y, c * *y - s * *x);
            }
        }
        self.q.pop();
    }

    /// z that minimises |A z − b| over the chosen columns.
    fn solve(&self, b: &[f64]) -> Vec<f64> {
        let mut z: Vec<f64> = self.q.iter().map(|q| dot(q, b)).collect();
        for j in (0..z.len()).rev() {
            z[j] /= self.r[j][j];
            let last = z[j];
            z[..j].iter_mut().zip(&self.r[j]).for_each(|(z, r)| *z -= last * r);
        }
        z
    }
}

/// u ≥ 0 that minimises |A u − b|.
///
/// `a` is m × n, `b` of length m.
///
/// # Errors
/// No end within 10 n exchanges.
///
/// Source: Lawson and Hanson, *Solving Least Squares Problems* (1974), ch. 23, algorithm NNLS.
pub fn nonnegative_least_squares(a: &Mat, b: &[f64]) -> Result<Vec<f64>, LinalgError> {
    from(a, b, &[])
}

/// The same, begun with u of which some are above zero: those of a problem with fewer columns.
fn from(a: &Mat, b: &[f64], start: &[f64]) -> Result<Vec<f64>, LinalgError> {
    let (m, n) = (a.nrows(), a.ncols());
    if b.len() != m {
        return Err(LinalgError::Shape { name: "b", expected: (m, 1), found: (b.len(), 1) });
    }
    let columns: Vec<Vec<f64>> = (0..n).map(|j| (0..m).map(|i| a[(i, j)]).collect()).collect();
    let size: Vec<f64> = columns.iter().map(|c| dot(c, c).sqrt()).collect();
    let length = dot(b, b).sqrt();
    let mut x = vec![0.0; n];
    let mut chosen = Chosen::default();
    for (k, start) in start.iter().enumerate().take(n) {
        if *start > 0.0 && chosen.enter(k, &columns[k]) {
            x[k] = *start;
        }
    }
    settle(&mut chosen, &mut x, b, &size);
    for _ in 0..10 * n.max(1) {
        let mut left = b.to_vec();
        for k in &chosen.of {
            left.iter_mut().zip(&columns[*k]).for_each(|(l, c)| *l -= c * x[*k]);
        }
        let best = (0..n)
            .filter(|j| !chosen.of.contains(j) && size[*j] > 0.0)
            .map(|j| (j, dot(&columns[j], &left) / size[j]))
            .max_by(|p, q| p.1.total_cmp(&q.1));
        let Some((enter, _)) = best.filter(|(_, g)| *g > ZERO * length) else { return Ok(x) };
        // a column that is a combination of the others would only swing against them
        if !chosen.enter(enter, &columns[enter]) || !(chosen.solve(b).last().is_some_and(|z| *z > 0.0)) {
            return Ok(x);
        }
        settle(&mut chosen, &mut x, b, &size);
    }
    Err(LinalgError::NoConvergence { what: "nonnegative least squares", order: n })
}

/// From x towards the least squares of the chosen columns; each that comes to zero on the way leaves.
fn settle(chosen: &mut Chosen, x: &mut [f64], b: &[f64], size: &[f64]) {
    let length = dot(b, b).sqrt();
    while !chosen.of.is_empty() {
        let z = chosen.solve(b);
        if z.iter().all(|z| *z > 0.0) {
            chosen.of.iter().zip(&z).for_each(|(k, z)| x[*k] = *z);
            break;
        }
        let shares =
            z.iter().zip(&chosen.of).filter(|(z, _)| !(**z > 0.0)).map(|(z, k)| (x[*k] / (x[*k] - z), *k));
        let Some((share, first)) = shares.min_by(|p, q| p.0.total_cmp(&q.0)) else { break };
        chosen.of.iter().zip(&z).for_each(|(k, z)| x[*k] += share * (z - x[*k]));
        for at in (0..chosen.of.len()).rev() {
            let k = chosen.of[at];
            if k == first || !(x[k] > ZERO * length / size[k]) {
                x[k] = 0.0;
                chosen.leave(at);
            }
        }
    }
}

/// The shortest x with G x ≥ h; None where there is none.
///
/// `g` is k × n, `h` of length k.
///
/// # Errors
/// As [`nonnegative_least_squares`].
///
/// Source: Lawson and Hanson (1974), ch. 23, algorithm LDP.
///
/// ```
/// use washboard::linalg::{Mat, least_distance};
/// // x + y ≥ 2: the foot of the perpendicular from 0
/// let g = Mat::from_fn(1, 2, |_, _| 1.0);
/// let x = least_distance(&g, &[2.0])?.unwrap();
/// assert!((x[0] - 1.0).abs() < 1e-14 && (x[1] - 1.0).abs() < 1e-14);
/// # Ok::<(), washboard::linalg::LinalgError>(())
/// ```
pub fn least_distance(g: &Mat, h: &[f64]) -> Result<Option<Vec<f64>>, LinalgError> {
    least_distance_from(g, h, &mut Vec::new())
}

/// The same, begun with the multipliers of a problem that has the first rows alone, if any; they become those of this one.
///
/// # Errors
/// As [`least_distance`].
pub fn least_distance_from(
    g: &Mat,
    h: &[f64],
    multipliers: &mut Vec<f64>,
) -> Result<Option<Vec<f64>>, LinalgError> {
    let (k, n) = (g.nrows(), g.ncols());
    if h.len() != k {
        return Err(LinalgError::Shape { name: "h", expected: (k, 1), found: (h.len(), 1) });
    }
    // rows of length 1, and h of size 1
    let length: Vec<f64> = (0..k).map(|i| g.subrows(i, 1).norm_l2().max(f64::MIN_POSITIVE)).collect();
    let size = (0..k).map(|i| (h[i] / length[i]).abs()).fold(0.0, f64::max);
    if size == 0.0 || (0..k).all(|i| h[i] <= 0.0) {
        return Ok(Some(vec![0.0; n]));
    }
    let e =
        Mat::from_fn(n + 1, k, |i, j| if i < n { g[(j, i)] / length[j] } else { h[j] / length[j] / size });
    let f: Vec<f64> = (0..=n).map(|i| f64::from(u8::from(i == n))).collect();
    let u = from(&e, &f, multipliers)?;
    multipliers.clone_from(&u);
    let r: Vec<f64> = (0..=n).map(|i| (0..k).map(|j| e[(i, j)] * u[j]).sum::<f64>() - f[i]).collect();
    // r_{n+1} = −|r|²
    if r[n] > -ZERO {
        return Ok(None);
    }
    Ok(Some((0..n).map(|i| -r[i] / r[n] * size).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kuhn_and_tuckers_conditions_hold() {
        for seed in 0..60 {
            let (k, n) = (1 + seed % 7, 1 + seed % 4);
            let any = |i: usize, j: usize| ((7 * i * i + 3 * j + i * j + 11 * seed) as f64 + 0.3).sin();
            let g = Mat::from_fn(k, n, any);
            let h: Vec<f64> = (0..k).map(|i| any(i, 9)).collect();
            let slack = |x: &[f64], i: usize| (0..n).map(|j| g[(i, j)] * x[j]).sum::<f64>() - h[i];
            let Some(x) = least_distance(&g, &h).unwrap() else {
                // Farkas: some u ≥ 0 with Gᵀu = 0, hᵀu > 0
                let e = Mat::from_fn(n + 1, k, |i, j| if i < n { g[(j, i)] } else { h[j] });
                let f: Vec<f64> = (0..=n).map(|i| f64::from(u8::from(i == n))).collect();
                let u = nonnegative_least_squares(&e, &f).unwrap();
                let left = |i: usize| (0..k).map(|j| e[(i, j)] * u[j]).sum::<f64>() - f[i];
                assert!((0..=n).all(|i| left(i).abs() < 1e-9), "{seed}");
                continue;
            };
            assert!((0..k).all(|i| slack(&x, i) > -1e-10), "{seed}: {x:?}");
            // x = Gᵀλ with λ ≥ 0 on the active rows alone
            let active: Vec<usize> = (0..k).filter(|i| slack(&x, *i) < 1e-9).collect();
            let columns = Mat::from_fn(n, active.len(), |i, j| g[(active[j], i)]);
            let lambda = nonnegative_least_squares(&columns, &x).unwrap();
            let off = |i: usize| (0..active.len()).map(|j| columns[(i, j)] * lambda[j]).sum::<f64>() - x[i];
            assert!((0..n).all(|i| off(i).abs() < 1e-9), "{seed}: {x:?} {lambda:?}");
        }
    }

    /// Columns that come and go leave QᵀQ = I and QR = A.
    #[test]
    fn factors_are_those_of_the_chosen_columns() {
        let columns: Vec<Vec<f64>> = (0..9)
            .map(|j| (0..7).map(|i| ((3 * i * i + 5 * j + 2 * i * j) as f64 + 0.4).sin()).collect())
            .collect();
        let mut chosen = Chosen::default();
        for k in 0..6 {
            assert!(chosen.enter(k, &columns[k]));
        }
        let sum: Vec<f64> = (0..7).map(|i| 2.0 * columns[1][i] - 0.5 * columns[4][i]).collect();
        assert!(!chosen.enter(9, &sum));
        for k in [4, 0, 2] {
            chosen.leave(k);
        }
        assert!(chosen.enter(7, &columns[7]));
        assert_eq!(chosen.of, [1, 2, 5, 7]);
        for (j, k) in chosen.of.iter().enumerate() {
            assert_eq!(chosen.r[j].len(), j + 1);
            for i in 0..7 {
                let product: f64 = (0..=j).map(|l| chosen.q[l][i] * chosen.r[j][l]).sum();
                assert!((product - columns[*k][i]).abs() < 1e-14, "{k} {i}");
            }
            for l in 0..4 {
                let expected = f64::from(u8::from(l == j));
                assert!((dot(&chosen.q[l], &chosen.q[j]) - expected).abs() < 1e-14, "{l} {j}");
            }
        }
    }

    /// Rows one after another, each begun with the multipliers before, against all at once.
    #[test]
    fn rows_that_are_added_lead_to_the_same_point() {
        let mut moved = 0;
        for seed in 0..40 {
            let (k, n) = (12, 5);
            let any = |i: usize, j: usize| ((7 * i * i + 3 * j + i * j + 11 * seed) as f64 + 0.3).sin();
            let h: Vec<f64> = (0..k).map(|i| any(i, 9) - 0.6).collect();
            let mut multipliers = Vec::new();
            for rows in 1..=k {
                let g = Mat::from_fn(rows, n, any);
                let cold = least_distance(&g, &h[..rows]).unwrap();
                let warm = least_distance_from(&g, &h[..rows], &mut multipliers).unwrap();
                let (Some(cold), Some(warm)) = (cold, warm) else { break };
                moved += usize::from(multipliers.iter().filter(|u| **u > 0.0).count() > 1);
                for (x, y) in cold.iter().zip(&warm) {
                    assert!((x - y).abs() < 1e-9 * (1.0 + x.abs()), "{seed} {rows}: {cold:?} {warm:?}");
                }
            }
        }
        assert!(moved > 20, "{moved}");
    }
}
