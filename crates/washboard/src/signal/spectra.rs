//! Welch's auto- and cross-spectra of all channels, and how far they may be trusted.

use super::{HannWindow, Recording, SignalError};
use crate::linalg::{C64, CMat};
use crate::units::rad_per_s;
use rayon::prelude::*;
use realfft::{RealFftPlanner, RealToComplex};
use std::sync::Arc;

/// The length of a segment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Segment {
    /// In samples.
    Samples(usize),
    /// In s; rounded to samples.
    Seconds(f64),
}

/// How a recording is cut into segments.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WelchSettings {
    /// The length of a segment; its inverse is the distance of the bins.
    pub segment: Segment,
    /// The share of a segment that the next one covers too, from 0 to below 1.
    pub overlap: f64,
}

impl WelchSettings {
    /// Segments of this length with 75 % overlap: more overlap tells nothing new with Hann's window.
    #[must_use]
    pub fn hann(segment: Segment) -> Self {
        WelchSettings { segment, overlap: 0.75 }
    }
}

/// Auto- and cross-spectra at the bins 0, rate/N, …, rate/2.
///
/// | field | what | unit |
/// |---|---|---|
/// | `freq_hz[k]`, `omega_rad_s[k]` | k·rate/N, and 2π times it | Hz, rad/s |
/// | `s[k]` | Hermitian n × n: `s[k][(i, j)]` = S_ij(ω_k), **two-sided**, S_ij = E\[X_i* X_j\] | unit_i·unit_j·s/rad |
/// | `averages` | the variance of a diagonal entry is S²/averages | |
///
/// R_ij(τ) = E\[q_i(t) q_j(t+τ)\] = (1/2π) ∫ S_ij(ω) e^{iωτ} dω. A channel j that repeats channel i a time τ₀ later has
/// S_ij = S_ii e^{−iωτ₀}. A one-sided density per Hz is twice S
/// ([`per_hz_from_two_sided`](crate::units::per_hz_from_two_sided)).
#[derive(Debug, Clone)]
pub struct CrossSpectra {
    /// The bins in Hz.
    pub freq_hz: Vec<f64>,
    /// The bins in rad/s.
    pub omega_rad_s: Vec<f64>,
    /// One Hermitian matrix a bin.
    pub s: Vec<CMat>,
    /// How many independent segments the overlapping ones are worth, at one bin: about 2.08 T/T_seg for 75 % overlap.
    pub averages: f64,
    /// Segments that were averaged.
    pub segments: usize,
    /// How many of them each uninterrupted piece of the recording gave: one entry, but for [`CrossSpectra::merged`].
    pub pieces: Vec<usize>,
    /// Samples in a segment, N.
    pub segment_len: usize,
    /// Samples from one segment's start to the next one's.
    pub hop: usize,
    /// Samples per second.
    pub rate_hz: f64,
    /// The names of the channels, in the order of the matrices.
    pub channels: Vec<String>,
    /// The window.
    pub window: HannWindow,
}

impl CrossSpectra {
    /// |W|² on half bins: see [`HannWindow::kernel`].
    #[must_use]
    pub fn kernel(&self) -> Vec<f64> {
        self.window.kernel()
    }

    /// The averages that a likelihood summed over *all* bins may count at each: T/T_seg for 75 % overlap, as the samples
    /// hold no more. See [`HannWindow::independent_over_bins`].
    #[must_use]
    pub fn likelihood_averages(&self) -> f64 {
        worth(&self.pieces, |segments| self.window.independent_over_bins(segments, self.hop))
    }

    /// The spectra of several pieces as one, each counting by its segments:
    ///
    /// S = Σ_p K_p S_p/K, K = Σ_p K_p, and as pieces are independent 1/averages = Σ_p (K_p/K)²/averages_p,
    ///
    /// the likelihood's averages likewise. Exactly what Welch's method gives over all segments that lie within a piece.
    ///
    /// # Errors
    /// No spectra; spectra of other channels, another rate, segment or hop than the first ones.
    pub fn merged(parts: &[CrossSpectra]) -> Result<CrossSpectra, SignalError> {
        let Some((first, rest)) = parts.split_first() else {
            return Err(SignalError::TooShort { what: "merged spectra, of pieces", needed: 1, found: 0 });
        };
        for other in rest {
            first.check_alike(other)?;
        }
        if rest.is_empty() {
            return Ok(first.clone());
        }
        let segments: usize = parts.iter().map(|p| p.segments).sum();
        let share = |p: &CrossSpectra| p.segments as f64 / segments as f64;
        let n = first.channels.len();
        let s = (0..first.s.len())
            .map(|k| CMat::from_fn(n, n, |i, j| parts.iter().map(|p| p.s[k][(i, j)] * share(p)).sum()))
            .collect();
        let pieces: Vec<usize> = parts.iter().flat_map(|p| p.pieces.iter().copied()).collect();
        let averages = worth(&pieces, |k| first.window.independent_segments(k, first.hop));
        Ok(CrossSpectra { s, averages, segments, pieces, ..first.clone() })
    }

    fn check_alike(&self, other: &CrossSpectra) -> Result<(), SignalError> {
        let differ = |what: &str, expected, found| {
            Err(SignalError::Length { what: format!("{what} of spectra to be merged"), expected, found })
        };
        if self.channels.len() != other.channels.len() {
            return differ("channels", self.channels.len(), other.channels.len());
        }
        if let Some((_, name)) = self.channels.iter().zip(&other.channels).find(|(a, b)| a != b) {
            let nearest = None;
            return Err(SignalError::UnknownChannel { name: name.clone(), nearest });
        }
        if self.segment_len != other.segment_len {
            return differ("samples in a segment", self.segment_len, other.segment_len);
        }
        if self.hop != other.hop {
            return differ("samples from segment to segment", self.hop, other.hop);
        }
        if self.rate_hz != other.rate_hz {
            let expected = "the rate of the other spectra to be merged";
            return Err(SignalError::Value { name: "rate_hz", expected, found: other.rate_hz });
        }
        Ok(())
    }

    /// The distance of the bins in Hz.
    #[must_use]
    pub fn resolution_hz(&self) -> f64 {
        self.rate_hz / self.segment_len as f64
    }
}

/// What pieces of K_p segments that are each worth A_p are worth together: K²/Σ K_p²/A_p.
fn worth(pieces: &[usize], of_piece: impl Fn(usize) -> f64) -> f64 {
    if let [only] = pieces {
        return of_piece(*only);
    }
    let segments: usize = pieces.iter().sum();
    let sum: f64 = pieces.iter().map(|k| (*k as f64).powi(2) / of_piece(*k)).sum();
    (segments as f64).powi(2) / sum
}

/// Segments whose transforms are held at once; the sum runs over all segments in order, so it changes no bit.
const BLOCK: usize = 32;

/// Welch's averaged periodograms with Hann's window, each segment less its mean:
///
/// S_ij(ω_k) = (1/K) Σ_s X_i* X_j / (rate Σ w²), X_i(k) = Σ_n w_n (q_i(n) − mean) e^{−2πikn/N}
///
/// Samples after the last whole segment are left out. Time and memory grow linearly with the recording; every number of
/// threads gives the same bits. The means that are removed lower the first two bins.
///
/// # Errors
/// A segment that is longer than the recording, or shorter than 8 samples; an overlap outside \[0, 1).
///
/// P. D. Welch, IEEE Trans. Audio Electroacoust. 15 (1967) 70–73; the normalisation and the order of the conjugate are
/// those of `scipy.signal.csd(q_i, q_j)`.
pub fn welch(recording: &Recording, settings: &WelchSettings) -> Result<CrossSpectra, SignalError> {
    let (len, hop) = cut(recording, settings)?;
    let rate_hz = recording.rate_hz();
    let segments = (recording.len() - len) / hop + 1;
    let bins = len / 2 + 1;
    let window = HannWindow::new(len);
    let s = averaged(recording.samples(), rate_hz, &window, hop, 0..segments);
    let freq_hz: Vec<f64> = (0..bins).map(|k| k as f64 * rate_hz / len as f64).collect();
    Ok(CrossSpectra {
        omega_rad_s: freq_hz.iter().map(|f| rad_per_s(*f)).collect(),
        freq_hz,
        s,
        averages: window.independent_segments(segments, hop),
        segments,
        pieces: vec![segments],
        segment_len: len,
        hop,
        rate_hz,
        channels: recording.channels().iter().map(|c| c.name.clone()).collect(),
        window,
    })
}

/// The mean over these segments (segment k starts at k · hop) of X_i* X_j / (rate Σ w²) at each bin.
pub(crate) fn averaged(
    samples: &[Vec<f64>],
    rate_hz: f64,
    window: &HannWindow,
    hop: usize,
    segments: std::ops::Range<usize>,
) -> Vec<CMat> {
    let (n, len) = (samples.len(), window.samples().len());
    let bins = len / 2 + 1;
    let fft = RealFftPlanner::<f64>::new().plan_fft_forward(len);
    // a bin's sums of X_i* X_j for i ≤ j, by column
    let pairs = n * (n + 1) / 2;
    let mut sums = vec![C64::new(0.0, 0.0); bins * pairs];
    for first in segments.clone().step_by(BLOCK) {
        let block = BLOCK.min(segments.end - first);
        let spectra: Vec<Vec<C64>> = (0..block * n)
            .into_par_iter()
            .map_init(
                || fft.make_scratch_vec(),
                |scratch, task| {
                    let start = (first + task / n) * hop;
                    transform(&fft, window, &samples[task % n][start..start + len], scratch)
                },
            )
            .collect();
        sums.par_chunks_mut(pairs).enumerate().for_each(|(k, sum)| {
            for segment in spectra.chunks(n) {
                let mut pair = 0;
                for j in 0..n {
                    for i in 0..=j {
                        sum[pair] += segment[i][k].conj() * segment[j][k];
                        pair += 1;
                    }
                }
            }
        });
    }
    let scale = 1.0 / (segments.len() as f64 * rate_hz * window.power());
    sums.chunks(pairs).map(|sum| hermitian(n, sum, scale)).collect()
}

/// Length and hop in samples.
fn cut(recording: &Recording, settings: &WelchSettings) -> Result<(usize, usize), SignalError> {
    /// Hann's kernel wants a few bins.
    const SHORTEST: usize = 8;
    if !(0.0..1.0).contains(&settings.overlap) {
        let expected = "a share from 0 to below 1";
        return Err(SignalError::Value { name: "overlap", expected, found: settings.overlap });
    }
    let len = match settings.segment {
        Segment::Samples(n) => n,
        Segment::Seconds(t) => (t * recording.rate_hz()).round().max(0.0) as usize,
    };
    if len < SHORTEST {
        return Err(SignalError::TooShort { what: "a Welch segment", needed: SHORTEST, found: len });
    }
    if len > recording.len() {
        let what = "a recording of one Welch segment";
        return Err(SignalError::TooShort { what, needed: len, found: recording.len() });
    }
    let hop = len - (settings.overlap * len as f64).floor() as usize;
    Ok((len, hop.max(1)))
}

fn transform(
    fft: &Arc<dyn RealToComplex<f64>>,
    window: &HannWindow,
    part: &[f64],
    scratch: &mut [C64],
) -> Vec<C64> {
    let mean = part.iter().sum::<f64>() / part.len() as f64;
    let mut tapered: Vec<f64> = part.iter().zip(window.samples()).map(|(x, w)| (x - mean) * w).collect();
    let mut spectrum = fft.make_output_vec();
    let done = fft.process_with_scratch(&mut tapered, &mut spectrum, scratch);
    debug_assert!(done.is_ok(), "all lengths come from the plan");
    spectrum
}

/// The matrix of its upper triangle.
fn hermitian(n: usize, sum: &[C64], scale: f64) -> CMat {
    CMat::from_fn(n, n, |i, j| {
        let (low, high) = (i.min(j), i.max(j));
        let x = sum[high * (high + 1) / 2 + low] * scale;
        if i == j {
            C64::new(x.re, 0.0)
        } else if i < j {
            x
        } else {
            x.conj()
        }
    })
}

#[cfg(test)]
mod tests;
