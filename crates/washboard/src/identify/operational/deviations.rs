//! Standard deviations by fitting again: without one block of the recording after the other, or to blocks drawn anew.

use super::OperationalError;
use super::clusters::{Cluster, median};
use super::record::Record;
use super::stabilization::StabilizationDiagram;
use crate::linalg::C64;
use crate::signal::{Correlations, correlations};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Blocks that a recording is cut into: their number's root gives the standard deviation's own error, 14 % of it.
const BLOCKS: usize = 24;
/// Draws of the bootstrap: their number's root gives the standard deviation's own error, 13 % beside the blocks'.
const DRAWS: usize = 32;
/// Modes are refitted at so many of their orders at least.
const FEWEST_ORDERS: usize = 3;
/// With fewer blocks a standard deviation says too little, and none is given.
const FEWEST: usize = 8;
/// A block is at least so many times the longest lag: correlations across its ends are lost.
const LAGS_A_BLOCK: usize = 10;

/// The correlations of each of a recording's blocks.
struct Blocks {
    parts: Vec<Correlations>,
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
        Ok(Some(Self { parts }))
    }
}

/// How a recording's blocks are put together for a refit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::identify) enum Resampling {
    /// Without one block after the other: s² = (B − 1)/B Σ_b (x_b − x̄)². For estimates that are smooth in the data.
    Jackknife,
    /// As many blocks drawn from all, with the same seed for every recording. For estimates that are not smooth: poles
    /// that come and go from order to order, and their medians.
    Bootstrap,
}

impl Resampling {
    /// The blocks' weights in each refit, and what the scatter is to be multiplied by.
    fn weights(self, count: usize) -> (Vec<Vec<f64>>, f64) {
        let (blocks, one) = (count as f64, 1.0 / count as f64);
        match self {
            Resampling::Jackknife => {
                let weight = |b: usize, k: usize| if k == b { 0.0 } else { 1.0 / (blocks - 1.0) };
                let without = |b: usize| (0..count).map(|k| weight(b, k)).collect();
                ((0..count).map(without).collect(), (blocks - 1.0) / blocks.sqrt())
            }
            Resampling::Bootstrap => {
                let mut rng = ChaCha8Rng::seed_from_u64(0);
                let mut draw = || {
                    let mut weights = vec![0.0; count];
                    (0..count).for_each(|_| weights[rng.random_range(0..count)] += one);
                    weights
                };
                // drawn blocks scatter about their own mean, which is nearer to them than the truth
                ((0..DRAWS).map(|_| draw()).collect(), (blocks / (blocks - 1.0)).sqrt())
            }
        }
    }
}

/// Gives modes the standard deviations of their medians over orders: `refit` finds poles again in the correlations of
/// blocks put together anew.
///
/// At most `most_orders` of the diagram's orders are refitted, spread over all of them. A mode has no standard deviation
/// where the recording is too short for blocks, or where a fit has lost most of its poles: their spread would not be that
/// of one mode.
///
/// Source: Efron and Tibshirani, *An Introduction to the Bootstrap* (1993), sections 6.2 and 11.3.
pub(in crate::identify) fn deviations<F>(
    clusters: &mut [Cluster],
    diagram: &StabilizationDiagram,
    record: &Record,
    most_orders: usize,
    resampling: Resampling,
    refit: F,
) -> Result<(), OperationalError>
where
    F: Fn(&Correlations, &[Start]) -> Vec<Option<C64>> + Sync,
{
    let starts: Vec<Vec<Start>> = clusters.iter().map(|c| chosen(&c.members, diagram, most_orders)).collect();
    let all = starts.concat();
    if all.is_empty() {
        return Ok(());
    }
    let Some(blocks) = Blocks::new(&record.channels, record.lags())? else { return Ok(()) };
    let (draws, scale) = resampling.weights(blocks.parts.len());
    let again: Vec<Vec<Option<[f64; 2]>>> = draws
        .par_iter()
        .map(|weights| {
            let found = refit(&Correlations::weighted(&blocks.parts, weights), &all);
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
        let values: Option<Vec<[f64; 2]>> = again.iter().map(|w| w[k]).collect();
        if let Some(values) = values {
            cluster.mode.freq_sd_hz = Some(scale * scatter(values.iter().map(|v| v[0])));
            cluster.mode.damping_sd = Some(scale * scatter(values.iter().map(|v| v[1])));
        }
    }
    Ok(())
}

/// The poles of a cluster at those of `most` orders, evenly over the diagram, where it has poles; or a few of its own.
fn chosen(members: &[usize], diagram: &StabilizationDiagram, most: usize) -> Vec<Start> {
    let stride = diagram.orders.len().div_ceil(most.max(1)).max(1);
    let common: Vec<usize> = diagram.orders.iter().rev().step_by(stride).copied().collect();
    let start = |k: usize| {
        let pole = &diagram.poles[k];
        (pole.order, C64::new(pole.pole[0], pole.pole[1]))
    };
    let here: Vec<Start> = members.iter().map(|k| start(*k)).filter(|s| common.contains(&s.0)).collect();
    if here.len() >= FEWEST_ORDERS {
        return here;
    }
    let count = members.len().min(FEWEST_ORDERS);
    (0..count).map(|k| start(members[(2 * k + 1) * members.len() / (2 * count)])).collect()
}

/// Median frequency and damping ratio of the poles that were found, where at least half of them were.
fn medians(found: &[Option<C64>], asked: usize) -> Option<[f64; 2]> {
    let poles: Vec<C64> = found.iter().copied().flatten().collect();
    if 2 * poles.len() < asked.max(1) {
        return None;
    }
    Some([median(poles.iter().map(|l| l.norm() / TAU)), median(poles.iter().map(|l| -l.re / l.norm()))])
}

/// √((B − 1)/B Σ_b (x_b − x̄)²) of the values without each block.
pub(in crate::identify) fn jackknife(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len() as f64;
    (count - 1.0) / count.sqrt() * scatter(values)
}

/// √(Σ (x − x̄)²/(n − 1)).
fn scatter(values: impl Iterator<Item = f64>) -> f64 {
    let values: Vec<f64> = values.collect();
    let count = values.len().max(2) as f64;
    let mean = values.iter().sum::<f64>() / count;
    (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (count - 1.0)).sqrt()
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
        assert!((jackknife(x.iter().map(|v| (sum - v) / 5.0)) - standard_error).abs() < 1e-14);
        let (weights, scale) = Resampling::Jackknife.weights(6);
        let means = weights.iter().map(|w| w.iter().zip(&x).map(|(w, x)| w * x).sum());
        assert!((scale * scatter(means) - standard_error).abs() < 1e-14);
    }

    #[test]
    fn drawn_blocks_sum_to_one_and_scatter_as_their_mean() {
        let x: Vec<f64> = (0..24).map(|k| f64::from(k * k % 17)).collect();
        let (weights, scale) = Resampling::Bootstrap.weights(24);
        assert!(weights.iter().all(|w| (w.iter().sum::<f64>() - 1.0).abs() < 1e-14));
        let drawn = scale * scatter(weights.iter().map(|w| w.iter().zip(&x).map(|(w, x)| w * x).sum()));
        let exact = scatter(x.iter().copied()) / 24f64.sqrt();
        // thirty draws tell a scatter to 13 %: three of these
        assert!((drawn / exact - 1.0).abs() < 0.4, "{drawn} for {exact}");
    }
}
