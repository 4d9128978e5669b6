//! Least squares with inequalities: Lawson and Hanson's active sets.

use super::dense::{LinalgError, Mat};
use faer::linalg::solvers::SolveLstsq;

/// A gradient below this share of the data's size is zero.
const ZERO: f64 = 1e-12;

/// u ≥ 0 that minimises |A u − b|.
///
/// `a` is m × n, `b` of length m.
///
/// # Errors
/// No end within 10 n exchanges.
///
/// Source: Lawson and Hanson, *Solving Least Squares Problems* (1974), ch. 23, algorithm NNLS.
pub fn nonnegative_least_squares(a: &Mat, b: &[f64]) -> Result<Vec<f64>, LinalgError> {
    let (m, n) = (a.nrows(), a.ncols());
    if b.len() != m {
        return Err(LinalgError::Shape { name: "b", expected: (m, 1), found: (b.len(), 1) });
    }
    let mut x = vec![0.0; n];
    let mut passive: Vec<usize> = Vec::new();
    let size: Vec<f64> = (0..n).map(|j| a.subcols(j, 1).norm_l2()).collect();
    let length = b.iter().map(|v| v * v).sum::<f64>().sqrt();
    for _ in 0..10 * n.max(1) {
        let left: Vec<f64> = (0..m).map(|i| b[i] - (0..n).map(|j| a[(i, j)] * x[j]).sum::<f64>()).collect();
        let gradient =
            |j: usize| (0..m).map(|i| a[(i, j)] * left[i]).sum::<f64>() / size[j].max(f64::MIN_POSITIVE);
        let best = (0..n)
            .filter(|j| !passive.contains(j) && size[*j] > 0.0)
            .map(|j| (j, gradient(j)))
            .max_by(|p, q| p.1.total_cmp(&q.1));
        let Some((enter, _)) = best.filter(|(_, g)| *g > ZERO * length) else { return Ok(x) };
        passive.push(enter);
        let mut fresh = true;
        loop {
            let chosen = Mat::from_fn(m, passive.len(), |i, j| a[(i, passive[j])]);
            let z = chosen.col_piv_qr().solve_lstsq(Mat::from_fn(m, 1, |i, _| b[i]));
            // a column that is a combination of the others would only swing against them
            if fresh && !(z[(passive.len() - 1, 0)] > 0.0) {
                passive.pop();
                return Ok(x);
            }
            fresh = false;
            if (0..passive.len()).all(|j| z[(j, 0)] > 0.0) {
                passive.iter().enumerate().for_each(|(j, k)| x[*k] = z[(j, 0)]);
                break;
            }
            let share = (0..passive.len())
                .filter(|j| z[(*j, 0)] <= 0.0)
                .map(|j| x[passive[j]] / (x[passive[j]] - z[(j, 0)]))
                .fold(1.0, f64::min);
            for (j, k) in passive.iter().enumerate() {
                x[*k] += share * (z[(j, 0)] - x[*k]);
            }
            passive.retain(|k| x[*k] > ZERO * length / size[*k]);
            (0..n).filter(|k| !passive.contains(k)).for_each(|k| x[k] = 0.0);
            if passive.is_empty() {
                break;
            }
        }
    }
    Err(LinalgError::NoConvergence { what: "nonnegative least squares", order: n })
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
    let u = nonnegative_least_squares(&e, &f)?;
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
}
