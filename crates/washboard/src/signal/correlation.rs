//! Output correlations R_ij(τ) of many channels, unbiased, in linear time and memory.

use rayon::prelude::*;
use realfft::num_complex::Complex;
use realfft::{RealFftPlanner, RealToComplex};
use std::sync::Arc;
use thiserror::Error;

/// The record is cut into so many runs of blocks, each summed in its own order and these then in order: the result
/// does not depend on how many threads there are.
const LANES: usize = 8;
/// A transform is at least so long: shorter ones cost more in overhead than they win in cache.
const SHORTEST_TRANSFORM: usize = 1024;
/// A transform has at least so many times the longest lag: (1 − 1/8) of its work is then of use.
const TRANSFORM_PER_LAG: usize = 8;

/// What [`correlations`] refuses.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum CorrelationError {
    /// There is no channel.
    #[error("expected at least one channel, found none")]
    NoChannel,
    /// Channels differ in length.
    #[error("channel {channel}: expected {expected} samples as in channel 0, found {found}")]
    Lengths {
        /// Which channel.
        channel: usize,
        /// Samples of channel 0.
        expected: usize,
        /// Samples of this channel.
        found: usize,
    },
    /// A lag needs more samples than there are.
    #[error("a lag of {max_lag} samples: expected more than {max_lag} samples, found {samples}")]
    TooShort {
        /// The longest lag asked for.
        max_lag: usize,
        /// Samples of every channel.
        samples: usize,
    },
    /// A sample is NaN or infinite.
    #[error("channel {channel}, sample {sample}: expected a finite number, found {value}")]
    NotFinite {
        /// Which channel.
        channel: usize,
        /// Which sample.
        sample: usize,
        /// What stands there.
        value: f64,
    },
}

/// R_ij(τ_k) = E[q_i(t) q_j(t + τ_k)] of every ordered pair of channels, τ_k = 0, 1, … samples.
///
/// Negative lags need no storage: R_ij(−τ) = R_ji(τ).
#[derive(Debug, Clone, PartialEq)]
pub struct Correlations {
    channels: usize,
    lags: usize,
    values: Vec<f64>,
}

impl Correlations {
    /// Number of channels.
    #[must_use]
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// Number of lags, zero included.
    #[must_use]
    pub fn lags(&self) -> usize {
        self.lags
    }

    /// R_ij at a lag of k samples.
    ///
    /// # Panics
    /// On an index out of range, like a slice.
    #[must_use]
    pub fn at(&self, i: usize, j: usize, k: usize) -> f64 {
        self.pair(i, j)[k]
    }

    /// Σ weight · part: of equal blocks of a recording and weights that sum to one, a mean of their correlations.
    #[must_use]
    pub(crate) fn weighted(parts: &[Correlations], weights: &[f64]) -> Correlations {
        let (channels, lags) = parts.first().map_or((0, 0), |p| (p.channels, p.lags));
        let mut values = vec![0.0; channels * channels * lags];
        for (part, weight) in parts.iter().zip(weights).filter(|(_, w)| **w != 0.0) {
            values.iter_mut().zip(&part.values).for_each(|(v, p)| *v += weight * p);
        }
        Correlations { channels, lags, values }
    }

    /// R_ij at all lags, from zero.
    ///
    /// # Panics
    /// On an index out of range, like a slice.
    #[must_use]
    pub fn pair(&self, i: usize, j: usize) -> &[f64] {
        let start = (i * self.channels + j) * self.lags;
        &self.values[start..start + self.lags]
    }
}

/// Unbiased correlations of all channel pairs at lags 0 … `max_lag` samples.
///
/// R_ij(k) = 1/(N − k) Σ_{t=0}^{N−k−1} q_i(t) q_j(t + k)
///
/// | symbol | shape | unit |
/// |---|---|---|
/// | `channels` | channels × N samples | any |
/// | R | channels × channels × (max_lag + 1) | product of the two |
///
/// The mean is *not* removed: subtract it first where it is none of the process. The sum is exact (no circular
/// wrap): blocks of q_i, zero-padded, against longer blocks of q_j in the frequency domain, so that time and memory
/// are linear in N; the result is the same to the last bit for any number of threads.
///
/// # Errors
/// No channel, channels that differ in length, fewer samples than lags, a sample that is not finite.
///
/// ```
/// // the second channel is the first, one sample later: R₀₁ peaks at +1
/// let first = vec![0.0, 1.0, 0.0, 0.0, 0.0];
/// let second = vec![0.0, 0.0, 1.0, 0.0, 0.0];
/// let r = washboard::signal::correlations(&[first, second], 2)?;
/// assert!((r.at(0, 1, 1) - 1.0 / 4.0).abs() < 1e-15);
/// assert!(r.at(1, 0, 1).abs() < 1e-15);
/// # Ok::<(), washboard::signal::CorrelationError>(())
/// ```
pub fn correlations(channels: &[Vec<f64>], max_lag: usize) -> Result<Correlations, CorrelationError> {
    let samples = check(channels, max_lag)?;
    let count = channels.len();
    let length =
        (TRANSFORM_PER_LAG * (max_lag + 1)).max(SHORTEST_TRANSFORM).min(2 * samples).next_power_of_two();
    let block = length - max_lag;
    let transform = RealFftPlanner::<f64>::new().plan_fft_forward(length);
    let blocks = samples.div_ceil(block);
    let per_lane = blocks.div_ceil(LANES);
    let lanes: Vec<Vec<Complex<f64>>> = (0..LANES)
        .into_par_iter()
        .map(|lane| {
            let run = (lane * per_lane).min(blocks)..((lane + 1) * per_lane).min(blocks);
            sum_of_blocks(channels, run, block, length, &transform)
        })
        .collect();
    let mut spectra = vec![Complex::new(0.0, 0.0); count * count * (length / 2 + 1)];
    for lane in lanes.iter().filter(|l| !l.is_empty()) {
        spectra.iter_mut().zip(lane).for_each(|(s, x)| *s += x);
    }
    let back = RealFftPlanner::<f64>::new().plan_fft_inverse(length);
    let lags = max_lag + 1;
    let mut values = vec![0.0; count * count * lags];
    let mut time = back.make_output_vec();
    for (spectrum, pair) in spectra.chunks_mut(length / 2 + 1).zip(values.chunks_mut(lags)) {
        // both ends are sums of products of reals; the transform refuses even a signed zero's rounding
        spectrum[0].im = 0.0;
        spectrum[length / 2].im = 0.0;
        let done = back.process(spectrum, &mut time); // lengths are those of the plan, so this can't fail
        debug_assert!(done.is_ok());
        for (k, value) in pair.iter_mut().enumerate() {
            *value = time[k] / (length as f64 * (samples - k) as f64);
        }
    }
    Ok(Correlations { channels: count, lags, values })
}

fn check(channels: &[Vec<f64>], max_lag: usize) -> Result<usize, CorrelationError> {
    let Some(first) = channels.first() else { return Err(CorrelationError::NoChannel) };
    let expected = first.len();
    for (channel, data) in channels.iter().enumerate() {
        if data.len() != expected {
            return Err(CorrelationError::Lengths { channel, expected, found: data.len() });
        }
        if let Some(sample) = data.iter().position(|v| !v.is_finite()) {
            return Err(CorrelationError::NotFinite { channel, sample, value: data[sample] });
        }
    }
    if max_lag >= expected {
        return Err(CorrelationError::TooShort { max_lag, samples: expected });
    }
    Ok(expected)
}

/// Σ conj(A_i) B_j over a run of blocks: A the zero-padded block, B the block with the lags that follow it.
fn sum_of_blocks(
    channels: &[Vec<f64>],
    run: std::ops::Range<usize>,
    block: usize,
    length: usize,
    transform: &Arc<dyn RealToComplex<f64>>,
) -> Vec<Complex<f64>> {
    if run.is_empty() {
        return Vec::new();
    }
    let (count, bins) = (channels.len(), length / 2 + 1);
    let zero = Complex::new(0.0, 0.0);
    let mut sum = vec![zero; count * count * bins];
    let (mut padded, mut whole) = (vec![vec![zero; bins]; count], vec![vec![zero; bins]; count]);
    let mut input = transform.make_input_vec();
    let mut scratch = transform.make_scratch_vec();
    for start in run.map(|b| b * block) {
        for (c, data) in channels.iter().enumerate() {
            for (width, into) in [(block, &mut padded[c]), (length, &mut whole[c])] {
                let end = (start + width).min(data.len());
                input.fill(0.0);
                input[..end - start].copy_from_slice(&data[start..end]);
                // lengths are those of the plan, so this can't fail
                let done = transform.process_with_scratch(&mut input, into, &mut scratch);
                debug_assert!(done.is_ok());
            }
        }
        for i in 0..count {
            for j in 0..count {
                let pair = &mut sum[(i * count + j) * bins..][..bins];
                for ((s, a), b) in pair.iter_mut().zip(&padded[i]).zip(&whole[j]) {
                    *s += a.conj() * b;
                }
            }
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng};

    fn noise(channels: usize, samples: usize) -> Vec<Vec<f64>> {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(7);
        (0..channels).map(|_| (0..samples).map(|_| rng.random_range(-1.0..1.0)).collect()).collect()
    }

    #[test]
    fn agrees_with_the_direct_sum() {
        for (samples, max_lag) in [(5, 4), (300, 0), (1000, 37), (9001, 200), (30_000, 99)] {
            let q = noise(3, samples);
            let r = correlations(&q, max_lag).unwrap();
            assert_eq!((r.channels(), r.lags()), (3, max_lag + 1));
            for i in 0..3 {
                for j in 0..3 {
                    for k in 0..=max_lag {
                        let sum: f64 = (0..samples - k).map(|t| q[i][t] * q[j][t + k]).sum();
                        let direct = sum / (samples - k) as f64;
                        assert!((r.at(i, j, k) - direct).abs() < 1e-14, "{samples} {i} {j} {k}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_later_copy_peaks_at_its_positive_delay() {
        let (source, delay) = (&noise(1, 5000)[0], 13);
        let early = source[delay..].to_vec();
        let late = source[..5000 - delay].to_vec(); // late(t) = early(t − delay)
        let r = correlations(&[early, late], 40).unwrap();
        let peak = |p: &[f64]| (0..p.len()).max_by(|a, b| p[*a].total_cmp(&p[*b])).unwrap();
        assert_eq!(peak(r.pair(0, 1)), delay);
        assert!(r.pair(1, 0).iter().all(|v| v.abs() < 0.1));
    }

    #[test]
    fn the_number_of_threads_changes_no_bit() {
        let q = noise(4, 50_000);
        let pool = |n| rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
        let one = pool(1).install(|| correlations(&q, 99).unwrap());
        let three = pool(3).install(|| correlations(&q, 99).unwrap());
        assert!(one == three);
    }

    #[test]
    fn wrong_channels_are_refused() {
        assert_eq!(correlations(&[], 3), Err(CorrelationError::NoChannel));
        let short = correlations(&[vec![1.0; 4]], 4);
        assert_eq!(short, Err(CorrelationError::TooShort { max_lag: 4, samples: 4 }));
        let uneven = correlations(&[vec![1.0; 4], vec![1.0; 5]], 1);
        assert_eq!(uneven, Err(CorrelationError::Lengths { channel: 1, expected: 4, found: 5 }));
        let nan = correlations(&[vec![1.0, f64::NAN, 1.0]], 1);
        assert!(matches!(nan, Err(CorrelationError::NotFinite { channel: 0, sample: 1, .. })));
    }
}
