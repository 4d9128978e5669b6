//! Standard deviations by leaving out one block of the recording after the other.

use super::OperationalError;
use crate::linalg::C64;
use crate::signal::{Correlations, correlations};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Blocks that a recording is cut into: their number's root gives the standard deviation's own error, 14 % of it.
const BLOCKS: usize = 24;
/// With fewer blocks a standard deviation says too little, and none is given.
const FEWEST: usize = 8;
/// A block is at least so many times the longest lag: correlations across its ends are lost.
const LAGS_A_BLOCK: usize = 10;

/// The correlations of each of a recording's blocks.
pub(in crate::identify) struct Blocks {
    parts: Vec<Correlations>,
    whole: Correlations,
}

/// Standard deviations of a pole's frequency and damping ratio.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::identify) struct Spread {
    /// Of |λ|/2π.
    pub freq_hz: f64,
    /// Of −Re λ/|λ|.
    pub damping: f64,
}

impl Blocks {
    /// Blocks of normalised channels at the lags 0 … `max_lag`; none where the recording is too short.
    pub fn new(channels: &[Vec<f64>], max_lag: usize) -> Result<Option<Self>, OperationalError> {
        let samples = channels.first().map_or(0, Vec::len);
        let count = BLOCKS.min(samples / (LAGS_A_BLOCK * max_lag.max(1)));
        if count < FEWEST {
            return Ok(None);
        }
        let length = samples / count;
        let parts: Vec<Correlations> = (0..count)
            .into_par_iter()
            .map(|b| {
                let part: Vec<Vec<f64>> =
                    channels.iter().map(|x| x[b * length..(b + 1) * length].to_vec()).collect();
                correlations(&part, max_lag)
            })
            .collect::<Result<_, _>>()?;
        let whole = Correlations::mean(&parts);
        Ok(Some(Self { parts, whole }))
    }

    /// Standard deviations of the poles that `refit` gives for the correlations less one block, each by
    /// s² = (B − 1)/B Σ_b (x_b − x̄)².
    ///
    /// None for a pole that one of the fits does not have: its spread is not that of one pole.
    ///
    /// Source: Efron and Stein, *The jackknife estimate of variance*, Annals of Statistics 9 (1981).
    pub fn spreads<F>(&self, refit: F) -> Vec<Option<Spread>>
    where
        F: Fn(&Correlations) -> Vec<Option<C64>> + Sync,
    {
        let without: Vec<Vec<Option<C64>>> =
            self.parts.par_iter().map(|part| refit(&self.whole.without(part, self.parts.len()))).collect();
        let poles = without.iter().map(Vec::len).min().unwrap_or(0);
        (0..poles)
            .map(|k| {
                let found: Option<Vec<C64>> = without.iter().map(|w| w[k]).collect();
                found.map(|lambda| Spread {
                    freq_hz: spread(lambda.iter().map(|l| l.norm() / TAU)),
                    damping: spread(lambda.iter().map(|l| -l.re / l.norm())),
                })
            })
            .collect()
    }
}

/// √((B − 1)/B Σ_b (x_b − x̄)²) of the values without each block.
pub(in crate::identify) fn spread(values: impl Iterator<Item = f64>) -> f64 {
    let values: Vec<f64> = values.collect();
    let count = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / count;
    ((count - 1.0) / count * values.iter().map(|v| (v - mean).powi(2)).sum::<f64>()).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_means_it_is_the_standard_error() {
        let x = [1.0, 4.0, 2.0, 8.0, 5.0, 7.0];
        let sum: f64 = x.iter().sum();
        let mean = sum / 6.0;
        let standard_error = (x.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (5.0 * 6.0)).sqrt();
        assert!((spread(x.iter().map(|v| (sum - v) / 5.0)) - standard_error).abs() < 1e-14);
    }
}
