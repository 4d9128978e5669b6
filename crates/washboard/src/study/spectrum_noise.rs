//! How noisy the samples of a spectrum are, told from neighbours: averages that they are worth, and local means for weights.

use crate::linalg::{C64, CMat};
use crate::subspace::ShapeWeights;

/// Neighbours on either side that local means are of, at most and at least.
const MOST_NEIGHBOURS: usize = 20;
const LEAST_NEIGHBOURS: usize = 2;
/// How far apart they may be, beyond the least number: a ratio of frequencies.
const WIDTH: f64 = 1.25;
/// Neighbours may be up to this far apart for their scatter to be noise, not shape: a ratio of frequencies.
const NEAR: f64 = 1.1;
/// Fewer triples of neighbours than this say nothing.
const LEAST_TRIPLES: usize = 20;
/// Triples that bend by more than √30 of the median are a resonance, not noise: 3.7 standard deviations.
const RESONANCE: f64 = 30.0;
/// Densities that scatter less than those of this many averages are taken to be exact: weights from them are off by 1e-4.
const EXACT: f64 = 1e4;

/// The noise of a spectrum's samples.
#[derive(Debug, Clone)]
pub(super) struct Noise {
    /// N: ‖S_k − S‖ has the mean square (tr S)²/N, as means of N periodograms have.
    pub averages: f64,
    /// Independent real numbers a sample: 1 of one channel, m² of m alike without a relation, 1 of m that are one.
    pub freedom: f64,
    /// Local means of tr S about each sample and without it: weights from these know nothing of the sample's own error, and draw the
    /// level neither up nor down.
    pub level: Vec<f64>,
}

impl Noise {
    /// From second differences of three neighbours, which a smooth spectrum hardly has. None where there are too few of them, or where
    /// they are those of exact data.
    pub fn of(omega: &[f64], s: &[CMat]) -> Option<Self> {
        let traces: Vec<f64> = s.iter().map(|s| (0..s.nrows()).map(|i| s[(i, i)].re).sum()).collect();
        if traces.iter().any(|t| !(*t > 0.0 && t.is_finite())) {
            return None;
        }
        let local = Local { omega, ln: traces.iter().map(|t| t.ln()).collect(), traces };
        let all: Vec<(f64, f64)> = (0..omega.len()).map(|k| local.at(k, true)).collect();
        let (mut bent, mut squares) = (Vec::new(), Vec::new());
        for k in 1..omega.len().max(1) - 1 {
            if !(omega[k - 1] > 0.0 && omega[k + 1] < NEAR * NEAR * omega[k - 1]) {
                continue;
            }
            let (mean, slope) = all[k];
            let factor = |j: usize| C64::new((omega[k] / omega[j]).powf(slope) / mean, 0.0);
            let x = |j: usize| &s[j] * faer::Scale(factor(j));
            let centre = x(k);
            bent.push(
                (x(k - 1) - &centre * faer::Scale(C64::new(2.0, 0.0)) + x(k + 1)).squared_norm_l2() / 6.0,
            );
            squares.push(centre.squared_norm_l2());
        }
        if bent.len() < LEAST_TRIPLES {
            return None;
        }
        let mut sorted = bent.clone();
        sorted.sort_by(f64::total_cmp);
        let limit = RESONANCE * sorted[sorted.len() / 2];
        let kept: Vec<f64> = sorted.into_iter().filter(|b| *b <= limit).collect();
        let variance = kept.iter().sum::<f64>() / kept.len() as f64;
        let averages = 1.0 / variance.max(f64::MIN_POSITIVE);
        if !(averages < EXACT) {
            return None;
        }
        let m = s.first().map_or(1, |s| s.nrows()) as f64;
        let square = squares.iter().sum::<f64>() / squares.len() as f64 - variance;
        let freedom = if m > 1.0 { (1.0 / (square * square)).clamp(1.0, m * m) } else { 1.0 };
        let level = (0..omega.len()).map(|k| local.at(k, false).0).collect();
        Some(Noise { averages, freedom, level })
    }

    /// Relative weights from the local means in place of the samples.
    pub fn weights(&self, weights: &ShapeWeights) -> ShapeWeights {
        let like = |squared| ShapeWeights::Like { level: self.level.clone(), squared };
        match weights {
            ShapeWeights::Relative => like(false),
            ShapeWeights::RelativeSquared => like(true),
            other => other.clone(),
        }
    }

    /// −2 ln of the likelihood of samples that are S with `averages` averages, less that of the best S can be: of one channel
    /// 2N Σ(r − 1 − ln r), r = S_k/S; of a matrix N Σ‖S_k − S‖²/(tr S_k tr S), times the freedom. About 1 for each number that is free.
    pub fn deviance(&self, averages: f64, unlikely: f64) -> f64 {
        self.freedom * averages * unlikely
    }
}

/// One sample's part of [`Noise::deviance`] at N = 1.
pub(super) fn unlikely(given: &CMat, fitted: &CMat) -> f64 {
    let trace = |s: &CMat| (0..s.nrows()).map(|i| s[(i, i)].re).sum::<f64>();
    let (given_trace, fitted_trace) = (trace(given), trace(fitted));
    let ratio = given_trace / fitted_trace;
    if given.nrows() == 1 {
        return 2.0 * (ratio - 1.0 - ratio.ln());
    }
    (fitted - given).squared_norm_l2() / (given_trace * fitted_trace)
}

/// Power laws through neighbours.
struct Local<'a> {
    omega: &'a [f64],
    ln: Vec<f64>,
    traces: Vec<f64>,
}

impl Local<'_> {
    /// The mean of tr S about sample k, neighbours brought to its frequency by their own slope, and that slope.
    fn at(&self, k: usize, own: bool) -> (f64, f64) {
        let w = self.omega[k];
        if !(w > 0.0) {
            let next = self.omega.iter().position(|w| *w > 0.0);
            return next.map_or((self.traces[k], 0.0), |j| self.at(j, own));
        }
        let used = |j: &usize| {
            let apart = j.abs_diff(k);
            let ratio = (self.omega[*j] / w).max(w / self.omega[*j]);
            (own || apart > 0) && (apart <= LEAST_NEIGHBOURS || ratio < WIDTH) && self.omega[*j] > 0.0
        };
        let range = k.saturating_sub(MOST_NEIGHBOURS)..(k + MOST_NEIGHBOURS + 1).min(self.omega.len());
        let near: Vec<(f64, usize)> = range.filter(used).map(|j| ((self.omega[j] / w).ln(), j)).collect();
        let count = near.len() as f64;
        if near.is_empty() {
            return (self.traces[k], 0.0);
        }
        let (mean_x, mean_y) = (
            near.iter().map(|(x, _)| x).sum::<f64>() / count,
            near.iter().map(|(_, j)| self.ln[*j]).sum::<f64>() / count,
        );
        let spread: f64 = near.iter().map(|(x, _)| (x - mean_x).powi(2)).sum();
        let along: f64 = near.iter().map(|(x, j)| (x - mean_x) * (self.ln[*j] - mean_y)).sum();
        let slope = if spread > 0.0 { along / spread } else { 0.0 };
        let mean = near.iter().map(|(x, j)| self.traces[*j] * (-slope * x).exp()).sum::<f64>() / count;
        (mean, slope)
    }
}
