//! The same range from moments Σ cos(lθ_k)(1, S_k, S_k², r_k): for scalar spectra the Gram matrices are Toeplitz.

use super::range::{Range, Route};
use super::samples::{Samples, Weights};
use crate::linalg::Mat;
use rayon::prelude::*;

/// Moments square the conditioning; the range is taken from them where its estimated error is below this, so that models
/// agree with those of the orthogonal route to 1e-10.
const ACCEPTED: f64 = 1e-12;
/// Samples that are summed by one task, so that sums do not depend on the number of threads.
const TASK: usize = 8192;
/// Samples side by side in one pass.
const LANES: usize = 4;

/// 1, S, S² and r, times cos(lθ), l = 0 … p − 1, over N.
#[derive(Clone)]
struct Moments([Vec<f64>; 4]);

/// The range, if samples are scalar and what moments lose can be spared.
pub(super) fn range(samples: &Samples, p: usize, order: Option<usize>) -> Option<Range> {
    let equal = match samples.weights() {
        Weights::Equal => true,
        Weights::Variances(_) => false,
        Weights::Covariances(_) => return None,
    };
    let n = order?;
    let real = samples.s().iter().all(|s| s[(0, 0)].im == 0.0);
    if samples.size() != 1 || !real || 2 * n >= p {
        return None;
    }
    let Moments([w, s, q, r]) = moments(samples, p);
    let toeplitz = |c: &[f64]| Mat::from_fn(p, p, |i, j| c[i.abs_diff(j)]);
    let lw = toeplitz(&w).llt(faer::Side::Lower).ok()?.L().to_owned();
    let mut explained = toeplitz(&s);
    lw.as_ref().solve_lower_triangular_in_place(explained.as_mut());
    let rest = toeplitz(&q) - explained.transpose() * &explained;
    let k = if equal { lw.clone() } else { toeplitz(&r).llt(faer::Side::Lower).ok()?.L().to_owned() };
    // K⁻¹ rest K⁻ᵀ
    let mut half = rest;
    k.as_ref().solve_lower_triangular_in_place(half.as_mut());
    let mut weighted = half.transpose().to_owned();
    k.as_ref().solve_lower_triangular_in_place(weighted.as_mut());
    let even = Mat::from_fn(p, p, |i, j| 0.5 * (weighted[(i, j)] + weighted[(j, i)]));
    let eigen = even.self_adjoint_eigen(faer::Side::Lower).ok()?;
    // ascending
    let squares: Vec<f64> = (0..p).rev().map(|i| eigen.S()[i].max(0.0)).collect();
    let gap = squares[2 * n - 1] - squares[2 * n];
    let size = q[0].max(s[0] * s[0]) / smallest_pivot(&k).powi(2);
    let error = f64::EPSILON * spread(&lw).max(spread(&k)) * size / gap;
    if !(error < ACCEPTED) {
        return None;
    }
    let u = Mat::from_fn(p, p, |i, j| eigen.U()[(i, p - 1 - j)]);
    let singular_values = squares.iter().map(|v| v.sqrt()).collect();
    Some(Range { ku: k * u, singular_values, route: Route::Moments, size: 1 })
}

fn smallest_pivot(l: &Mat) -> f64 {
    (0..l.nrows()).map(|i| l[(i, i)]).fold(f64::INFINITY, f64::min)
}

/// Largest over smallest pivot, squared: what the Gram matrix's condition is at least.
fn spread(l: &Mat) -> f64 {
    let most = (0..l.nrows()).map(|i| l[(i, i)]).fold(0.0, f64::max);
    (most / smallest_pivot(l)).powi(2)
}

fn moments(samples: &Samples, p: usize) -> Moments {
    let (theta, n) = (samples.theta_rad(), samples.count());
    let parts: Vec<Moments> = (0..n.div_ceil(TASK))
        .into_par_iter()
        .map(|task| {
            let mut sums = [vec![0.0; p], vec![0.0; p], vec![0.0; p], vec![0.0; p]];
            let end = n.min((task + 1) * TASK);
            let mut k = task * TASK;
            while k < end {
                let lanes = LANES.min(end - k);
                let at = |lane: usize| if lane < lanes { Some(k + lane) } else { None };
                let (mut re, mut im) = ([1.0; LANES], [0.0; LANES]);
                let mut weights = [[0.0; LANES]; 4];
                let (mut cos, mut sin) = ([1.0; LANES], [0.0; LANES]);
                for lane in 0..LANES {
                    let Some(i) = at(lane) else { continue };
                    (sin[lane], cos[lane]) = theta[i].sin_cos();
                    let s = samples.s()[i][(0, 0)].re;
                    let r = match samples.weights() {
                        Weights::Variances(r) => r[i],
                        _ => 1.0,
                    };
                    for (row, v) in weights.iter_mut().zip([1.0, s, s * s, r]) {
                        row[lane] = v / n as f64;
                    }
                }
                for l in 0..p {
                    for (sum, weight) in sums.iter_mut().zip(&weights) {
                        sum[l] += (0..LANES).map(|i| weight[i] * re[i]).sum::<f64>();
                    }
                    for i in 0..LANES {
                        let next = re[i] * cos[i] - im[i] * sin[i];
                        im[i] = re[i] * sin[i] + im[i] * cos[i];
                        re[i] = next;
                    }
                }
                k += lanes;
            }
            Moments(sums)
        })
        .collect();
    let mut all = Moments([vec![0.0; p], vec![0.0; p], vec![0.0; p], vec![0.0; p]]);
    for part in parts {
        for (sum, more) in all.0.iter_mut().zip(part.0) {
            sum.iter_mut().zip(more).for_each(|(s, m)| *s += m);
        }
    }
    all
}
