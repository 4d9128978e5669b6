//! Evidence for the errata of chapter 2.

use super::ReproduceError;
use super::chapter_2::{NoiseOn, at, example, spectrum_errors};
use super::context::Context;
use super::errata::shown;
use super::item::Evidence;
use crate::linalg::{C64, LinalgError, Mat};
use crate::lti::StateSpace;
use crate::subspace::{
    AnalyticSettings, Part, Samples, SpectrumSettings, Weights, fit_analytic, fit_spectrum,
};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use std::f64::consts::PI;

type Shown = Result<Vec<Evidence>, ReproduceError>;

/// Runs that tell a factor of seven.
const RUNS: u64 = 20;
/// Draws that give a mean to three digits.
const DRAWS: u32 = 200_000;

/// Errors by the printed noise and by noise on the amplitude.
pub(super) fn noise(_: &Context) -> Shown {
    let mut all = Vec::new();
    for (weighted, with) in [(true, "with covariance"), (false, "with R_k = 1")] {
        let (printed, right) = (
            spectrum_errors(NoiseOn::Spectrum, weighted, RUNS)?,
            spectrum_errors(NoiseOn::Amplitude, weighted, RUNS)?,
        );
        all.push(shown(format!("mean H2 error {with}, 20 runs"), printed.h2, right.h2));
        all.push(shown(format!("mean sup error {with}, 20 runs"), printed.sup, right.sup));
    }
    Ok(all)
}

/// U Σ V and U Σ Vᵀ beside the matrix.
pub(super) fn transposed_blocks(_: &Context) -> Shown {
    let a = example()?.a().clone();
    let svd = a.svd().map_err(|_| LinalgError::NoConvergence { what: "the SVD", order: 4 })?;
    let scaled = Mat::from_fn(4, 4, |i, j| svd.U()[(i, j)] * svd.S()[j]);
    let v = svd.V().to_owned();
    let printed = (&scaled * &v - &a).norm_l2();
    let right = (&scaled * v.transpose() - &a).norm_l2();
    // rounding, which no two machines share
    Ok(vec![shown("‖UΣV − M‖ of a 4 × 4 matrix, to 1e-9", rounded(printed), rounded(right))])
}

fn rounded(x: f64) -> f64 {
    (x * 1e9).round() / 1e9
}

/// Rows of the zero block and of the block beside it, m = 2, p = 3.
pub(super) fn zero_blocks(_: &Context) -> Shown {
    let (m, p) = (2, 3);
    let beside = Mat::identity((p - 1) * m, (p - 1) * m).nrows();
    Ok(vec![shown(
        "m = 2, p = 3: rows of the zero block beside I of (p − 1)m",
        (p - 1) as f64,
        beside as f64,
    )])
}

/// Columns of [0 I] or [I 0] beside rows of the observability matrix.
pub(super) fn zero_blocks_beside(_: &Context) -> Shown {
    let (m, p) = (2, 3);
    let wide = |zeros: usize| (m + zeros) as f64;
    Ok(vec![shown(
        "m = 2, p = 3: columns of the selector, where 𝒪_p has 6 rows",
        wide(p - 1),
        wide((p - 1) * m),
    )])
}

/// The least number of samples that recovers, found by trying.
pub(super) fn fewest_samples(_: &Context) -> Shown {
    let f = example()?;
    let recovers = |count: usize| -> Result<bool, ReproduceError> {
        let theta: Vec<f64> = (0..count).map(|k| PI * (k as f64 + 0.5) / count as f64).collect();
        let values: Vec<C64> = theta.iter().map(|t| at(&f, *t)).collect::<Result<_, _>>()?;
        let u: Vec<f64> = values.iter().map(|v| v.re).collect();
        let Ok(model) = fit_analytic(&theta, &u, Weights::Equal, Part::Real, &AnalyticSettings::new(4, 9))
        else {
            return Ok(false);
        };
        let mut worst = 0.0f64;
        for (t, v) in theta.iter().zip(&values) {
            worst = worst.max((at(&model.system, *t)? - v).norm());
        }
        Ok(worst < 1e-8)
    };
    let mut least = 0;
    for count in 1..=10 {
        if recovers(count)? {
            least = count;
            break;
        }
    }
    Ok(vec![shown("p = 9, n = 4: samples", 10.0, least as f64)])
}

/// Two channels, order 4, p = 6.
pub(super) fn fewer_block_rows(_: &Context) -> Shown {
    let a = [[0.6, 0.4, 0.0, 0.0], [-0.4, 0.6, 0.0, 0.0], [0.0, 0.0, -0.5, 0.3], [0.0, 0.0, -0.3, -0.5]];
    let (b, c) =
        ([[1.0, 0.2], [0.0, 0.5], [0.3, 1.0], [-0.4, 0.1]], [[1.0, 0.0, 0.2, 0.5], [0.1, 0.7, 1.0, 0.0]]);
    let g = StateSpace::discrete(
        Mat::from_fn(4, 4, |i, j| a[i][j]),
        Mat::from_fn(4, 2, |i, j| 0.3 * b[i][j]),
        Mat::from_fn(2, 4, |i, j| c[i][j]),
        Mat::identity(2, 2),
        1.0,
    )?;
    let theta: Vec<f64> = (0..12).map(|k| PI * (f64::from(k) + 0.5) / 12.0).collect();
    let spectrum = |theta: f64| -> Result<_, ReproduceError> {
        let h = g.at(C64::from_polar(1.0, theta))?;
        Ok(&h * h.adjoint())
    };
    let s = theta.iter().map(|t| spectrum(*t)).collect::<Result<Vec<_>, _>>()?;
    let mut fewest = 0;
    for p in 2..=9 {
        let samples = Samples::new(theta.clone(), s.clone(), Weights::Equal)?;
        let Ok(model) = fit_spectrum(&samples, &SpectrumSettings::new(4, p)) else { continue };
        let h = model.factor.system.at(C64::from_polar(1.0, 1.0))?;
        if (&h * h.adjoint() - spectrum(1.0)?).norm_max() < 1e-8 {
            fewest = p;
            break;
        }
    }
    Ok(vec![shown("two channels, n = 4: block rows that are enough", 9.0, fewest as f64)])
}

pub(super) fn reduction(_: &Context) -> Shown {
    Ok(vec![shown("1 − .3307/.4500, %", 30.0, 100.0 * (1.0 - 0.3307 / 0.4500))])
}

/// m = 1, R = 1: the mean modulus of the real part of complex noise of unit variance.
pub(super) fn mean_norm(_: &Context) -> Shown {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut draw = || 0.5f64.sqrt() * rng.sample::<f64, _>(StandardNormal);
    let mean = (0..DRAWS).map(|_| draw().abs()).sum::<f64>() / f64::from(DRAWS);
    Ok(vec![shown("E|Re η|, 2·10⁵ draws", 0.5, mean), shown("E|Re η|, 1/√π", 0.5, 1.0 / PI.sqrt())])
}

pub(super) fn last_interval(_: &Context) -> Shown {
    Ok(vec![shown("N = 400: upper end of the last interval", PI / 400.0 * 400.5, PI)])
}
