//! The range of the extended observability matrix from samples, free of what samples of polynomials explain.

use super::samples::{Samples, Weights};
use super::{SubspaceError, toeplitz};
use crate::linalg::{C64, CMat, LinalgError, Mat};
use rayon::prelude::*;

/// Rows that are factored at a time, in columns: memory does not grow with the number of samples.
const CHUNK: usize = 8;
/// Chunks that one task takes after each other. Tasks do not depend on the number of threads, and so R does not.
const CHUNKS: usize = 32;

/// How the range was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Route {
    /// Orthogonal factors of the data.
    Orthogonal,
    /// Moments, for scalar spectra that are conditioned well enough.
    Moments,
}

#[derive(Debug)]
/// K U of the decomposition K⁻¹ Ŝ W⊥ = U Σ Vᵀ, pm × pm, and Σ.
pub(super) struct Range {
    pub ku: Mat,
    pub singular_values: Vec<f64>,
    pub route: Route,
    /// m.
    pub size: usize,
}

impl Range {
    /// By moments where `moments` allows and 2n singular values are clear of the noise by that route, else by QR.
    pub fn of(
        samples: &Samples,
        p: usize,
        order: Option<usize>,
        moments: bool,
    ) -> Result<Self, SubspaceError> {
        if moments && let Some(found) = toeplitz::range(samples, p, order) {
            return Ok(found);
        }
        let (m, n) = (samples.size(), samples.count());
        let pm = p * m;
        let root = (n as f64).sqrt().recip();
        // R of the QR of [Wᵀ Ŝᵀ]
        let r = accumulated(
            n,
            2 * pm,
            |k, mut rows| {
                let z = powers(samples.theta_rad()[k], p);
                let s = &samples.s()[k];
                for a in 0..m {
                    for (i, z) in z.iter().enumerate() {
                        for b in 0..m {
                            let unit = if a == b { *z * root } else { C64::new(0.0, 0.0) };
                            let value = *z * s[(b, a)] * root;
                            let (at, col) = (2 * a, i * m + b);
                            rows[(at, col)] = unit.re;
                            rows[(at + 1, col)] = unit.im;
                            rows[(at, pm + col)] = value.re;
                            rows[(at + 1, pm + col)] = value.im;
                        }
                    }
                }
                Ok(())
            },
            2 * m,
        )?;
        let r22 = r.submatrix(pm, pm, pm, pm).transpose().to_owned();
        let k = match samples.weights() {
            Weights::Equal => r.submatrix(0, 0, pm, pm).transpose().to_owned(),
            weights => accumulated(
                n,
                pm,
                |k, mut rows| {
                    let z = powers(samples.theta_rad()[k], p);
                    let half = half_of(weights, k, m);
                    for a in 0..m {
                        for (i, z) in z.iter().enumerate() {
                            for b in 0..m {
                                let value = *z * half[(b, a)] * root;
                                rows[(2 * a, i * m + b)] = value.re;
                                rows[(2 * a + 1, i * m + b)] = value.im;
                            }
                        }
                    }
                    Ok(())
                },
                2 * m,
            )?
            .transpose()
            .to_owned(),
        };
        Self::from_factors(k, r22, Route::Orthogonal, m)
    }

    /// From a lower triangular K and any matrix with the Gram matrix of Ŝ W⊥.
    pub fn from_factors(k: Mat, residual: Mat, route: Route, size: usize) -> Result<Self, SubspaceError> {
        let pm = k.nrows();
        let largest = (0..pm).map(|i| k[(i, i)].abs()).fold(0.0, f64::max);
        if let Some(i) = (0..pm).find(|i| !(k[(*i, *i)].abs() > f64::EPSILON * largest)) {
            let expected = format!("at most {} block rows for these frequencies", i / size.max(1));
            return Err(SubspaceError::Field { field: "p", expected, found: (pm / size.max(1)).to_string() });
        }
        let mut weighted = residual;
        k.as_ref().solve_lower_triangular_in_place(weighted.as_mut());
        let svd =
            weighted.thin_svd().map_err(|_| LinalgError::NoConvergence { what: "the SVD", order: pm })?;
        let singular_values = (0..weighted.nrows().min(weighted.ncols())).map(|i| svd.S()[i]).collect();
        Ok(Self { ku: &k * svd.U(), singular_values, route, size })
    }
}

/// z⁰ … z^{p−1}.
pub(super) fn powers(theta: f64, p: usize) -> Vec<C64> {
    (0..p).map(|i| C64::from_polar(1.0, i as f64 * theta)).collect()
}

/// A square root of R_k: R_k = H Hᴴ.
pub(super) fn half_of(weights: &Weights, k: usize, m: usize) -> CMat {
    let scaled = |r: f64| CMat::from_fn(m, m, |i, j| C64::new(if i == j { r.sqrt() } else { 0.0 }, 0.0));
    match weights {
        Weights::Equal => scaled(1.0),
        Weights::Variances(r) => scaled(r[k]),
        // positive definite since they were made
        Weights::Covariances(r) => {
            r[k].llt(faer::Side::Lower).map_or_else(|_| scaled(1.0), |l| l.L().to_owned())
        }
    }
}

/// R of the QR of a tall matrix whose rows come in groups, one a sample: square, zeros below where there are few rows.
pub(super) fn accumulated(
    samples: usize,
    columns: usize,
    fill: impl Fn(usize, faer::MatMut<'_, f64>) -> Result<(), LinalgError> + Sync,
    group: usize,
) -> Result<Mat, LinalgError> {
    let per_chunk = (CHUNK * columns).div_ceil(group.max(1)).max(1);
    let per_task = per_chunk * CHUNKS;
    let task = |t: usize| -> Result<Mat, LinalgError> {
        let end = samples.min((t + 1) * per_task);
        let mut r = Mat::zeros(0, columns);
        let mut first = t * per_task;
        while first < end {
            let count = per_chunk.min(end - first);
            let kept = r.nrows();
            let mut stacked = Mat::zeros(kept + count * group, columns);
            stacked.as_mut().subrows_mut(0, kept).copy_from(&r);
            for k in 0..count {
                fill(first + k, stacked.as_mut().subrows_mut(kept + k * group, group))?;
            }
            r = upper(&stacked);
            first += count;
        }
        Ok(r)
    };
    let parts: Vec<Mat> =
        (0..samples.div_ceil(per_task)).into_par_iter().map(task).collect::<Result<_, _>>()?;
    let all = parts.into_iter().reduce(|above, below| {
        let (a, b) = (above.nrows(), below.nrows());
        upper(&Mat::from_fn(a + b, columns, |i, j| if i < a { above[(i, j)] } else { below[(i - a, j)] }))
    });
    let r = all.unwrap_or_else(|| Mat::zeros(0, columns));
    Ok(Mat::from_fn(columns, columns, |i, j| if i < r.nrows() { r[(i, j)] } else { 0.0 }))
}

/// R with zeros below its diagonal.
fn upper(tall: &Mat) -> Mat {
    let qr = tall.qr();
    let r = qr.thin_R();
    Mat::from_fn(r.nrows(), r.ncols(), |i, j| if i <= j { r[(i, j)] } else { 0.0 })
}
