//! Standard deviations by leaving out one block of the recording after the other.

use super::clusters::{Cluster, median};
use super::record::Record;
use super::stabilization::{Pole, StabilizationDiagram};
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
struct Blocks {
    parts: Vec<Correlations>,
    whole: Correlations,
}

/// A pole to be found again: its order and λ in rad/s.
pub(in crate::identify) type Start = (usize, C64);

impl Blocks {
    /// Blocks of normalised channels at the lags 0 … `max_lag`; none where the recording is too short.
    fn new(channels: &[Vec<f64>], max_lag: usize) -> Result<Option<Self>, OperationalError> {
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
}

/// Gives modes the standard deviations of their medians over orders: `refit` finds poles again in the correlations less
/// one block, and s² = (B − 1)/B Σ_b (x_b − x̄)².
///
/// At most `most_orders` of a cluster's orders are refitted, spread over all of them. A mode has no standard deviation
/// where the recording is too short for blocks, or where a fit has lost most of its poles: their spread would not be that
/// of one mode.
///
/// Source: Efron and Stein, *The jackknife estimate of variance*, Annals of Statistics 9 (1981).
pub(in crate::identify) fn deviations<F>(
    clusters: &mut [Cluster],
    diagram: &StabilizationDiagram,
    record: &Record,
    most_orders: usize,
    refit: F,
) -> Result<(), OperationalError>
where
    F: Fn(&Correlations, &[Start]) -> Vec<Option<C64>> + Sync,
{
    let starts: Vec<Vec<Start>> =
        clusters.iter().map(|c| chosen(&c.members, &diagram.poles, most_orders)).collect();
    let all = starts.concat();
    if all.is_empty() {
        return Ok(());
    }
    let Some(blocks) = Blocks::new(&record.channels, record.lags())? else { return Ok(()) };
    let without: Vec<Vec<Option<[f64; 2]>>> = blocks
        .parts
        .par_iter()
        .map(|part| {
            let found = refit(&blocks.whole.without(part, blocks.parts.len()), &all);
            let mut rest = found.as_slice();
            let of_mode = |starts: &Vec<Start>| {
                let (here, after) = rest.split_at(starts.len().min(rest.len()));
                rest = after;
                medians(here, starts.len())
            };
            starts.iter().map(of_mode).collect()
        })
        .collect();
    for (k, cluster) in clusters.iter_mut().enumerate() {
        let values: Option<Vec<[f64; 2]>> = without.iter().map(|w| w[k]).collect();
        if let Some(values) = values {
            cluster.mode.freq_sd_hz = Some(spread(values.iter().map(|v| v[0])));
            cluster.mode.damping_sd = Some(spread(values.iter().map(|v| v[1])));
        }
    }
    Ok(())
}

/// The poles of a cluster at so many of its orders, evenly.
fn chosen(members: &[usize], poles: &[Pole], most: usize) -> Vec<Start> {
    let count = members.len().min(most);
    let at = |k: usize| &poles[members[(2 * k + 1) * members.len() / (2 * count)]];
    (0..count).map(|k| (at(k).order, C64::new(at(k).pole[0], at(k).pole[1]))).collect()
}

/// Median frequency and damping ratio of the poles that were found, where at least half of them were.
fn medians(found: &[Option<C64>], asked: usize) -> Option<[f64; 2]> {
    let poles: Vec<C64> = found.iter().copied().flatten().collect();
    if 2 * poles.len() < asked.max(1) {
        return None;
    }
    Some([
        median(poles.iter().map(|l| l.norm() / TAU)),
        median(poles.iter().map(|l| -l.re / l.norm())),
    ])
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
