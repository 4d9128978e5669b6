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
mod tests {
    use super::super::{Channel, Direction, Place, Quantity};
    use super::*;
    use rand::{Rng, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::StandardNormal;
    use std::f64::consts::{PI, TAU};

    fn noise(seed: u64, n: usize) -> Vec<f64> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        (0..n).map(|_| rng.sample::<f64, _>(StandardNormal)).collect()
    }

    fn recording(rate_hz: f64, samples: Vec<Vec<f64>>) -> Recording {
        let channel = |i: usize| Channel {
            name: format!("c{i}"),
            quantity: Quantity::Acceleration,
            direction: Direction::PlusZ,
            place: Place::Body,
            wheel: None,
            at_m: None,
        };
        Recording::new(rate_hz, None, vec![], (0..samples.len()).map(channel).collect(), samples).unwrap()
    }

    fn segments_of(n: usize) -> WelchSettings {
        WelchSettings::hann(Segment::Samples(n))
    }

    #[test]
    fn an_autoregression_has_its_spectrum() {
        // x_k = 1.5 x_{k−1} − .8 x_{k−2} + e_k at 50 Hz: S = Δt σ²/|1 − 1.5 z + .8 z²|², z = e^{−iωΔt}
        let (rate, n) = (50.0, 400_000);
        let e = noise(1, n);
        let mut x = vec![0.0; n];
        for k in 2..n {
            x[k] = 1.5 * x[k - 1] - 0.8 * x[k - 2] + 2.0 * e[k];
        }
        let got = welch(&recording(rate, vec![x]), &segments_of(512)).unwrap();
        let kernel = got.kernel();
        let model = |omega: f64| {
            let z = C64::new(0.0, -omega / rate).exp();
            4.0 / rate / (C64::new(1.0, 0.0) - z * 1.5 + z * z * 0.8).norm_sqr()
        };
        let half_bin = PI * rate / 512.0;
        let mut mean = 0.0;
        for k in 4..250 {
            // the window's smear is part of what is expected
            let omega = got.omega_rad_s[k];
            let smeared: f64 =
                (0..15).map(|m| kernel[m] * model(omega - (m as f64 - KERNEL as f64) * half_bin)).sum();
            let ratio = got.s[k][(0, 0)].re / smeared;
            assert!((ratio - 1.0).abs() < 5.0 / got.averages.sqrt(), "{k}: {ratio}");
            mean += ratio / 246.0;
        }
        assert!((mean - 1.0).abs() < 0.006, "{mean}");
    }

    const KERNEL: usize = super::super::KERNEL_HALF_WIDTH;

    #[test]
    fn a_channel_that_comes_later_lags_in_phase() {
        let (rate, delay) = (100.0, 3);
        let e = noise(2, 60_000);
        let later: Vec<f64> = (0..60_000).map(|k| if k < delay { 0.0 } else { e[k - delay] }).collect();
        let got = welch(&recording(rate, vec![e, later]), &segments_of(1024)).unwrap();
        for k in 2..500 {
            let expected =
                C64::new(0.0, -got.omega_rad_s[k] * delay as f64 / rate).exp() * got.s[k][(0, 0)].re;
            let s12 = got.s[k][(0, 1)];
            assert!((s12 - expected).norm() < 0.05 * expected.norm(), "{k}: {s12} against {expected}");
            assert_eq!(got.s[k][(1, 0)], s12.conj());
        }
    }

    #[test]
    fn a_segments_spectrum_sums_to_its_windowed_power() {
        // Parseval, exactly: (rate/N) Σ over both sides of S = Σ (w x)²/Σ w²
        for n in [256, 255] {
            let x = noise(3, n);
            let got = welch(&recording(10.0, vec![x.clone()]), &segments_of(n)).unwrap();
            let mean = x.iter().sum::<f64>() / n as f64;
            let power: f64 =
                x.iter().zip(got.window.samples()).map(|(x, w)| ((x - mean) * w).powi(2)).sum::<f64>()
                    / got.window.power();
            let both: f64 = (0..got.s.len())
                .map(|k| got.s[k][(0, 0)].re * if k == 0 || 2 * k == n { 1.0 } else { 2.0 })
                .sum();
            assert!((both * got.resolution_hz() / power - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn a_sine_has_its_mean_square() {
        // (1/π) ∫₀^∞ S dω of amplitude 3 is 4.5
        let x: Vec<f64> = (0..20_000).map(|k| 3.0 * (TAU * 0.0617 * f64::from(k)).sin()).collect();
        let got = welch(&recording(200.0, vec![x]), &segments_of(1000)).unwrap();
        let sum: f64 = got.s.iter().map(|s| s[(0, 0)].re).sum();
        let square = sum * TAU * got.resolution_hz() / PI;
        assert!((square / 4.5 - 1.0).abs() < 1e-3, "{square}");
    }

    #[test]
    fn every_number_of_threads_gives_the_same_bits() {
        let r = recording(100.0, (0..5).map(|i| noise(10 + i, 30_000)).collect());
        let under = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| welch(&r, &segments_of(500)).unwrap())
        };
        let (one, four) = (under(1), under(4));
        for (a, b) in one.s.iter().zip(&four.s) {
            for i in 0..5 {
                for j in 0..5 {
                    assert_eq!(a[(i, j)].re.to_bits(), b[(i, j)].re.to_bits());
                    assert_eq!(a[(i, j)].im.to_bits(), b[(i, j)].im.to_bits());
                }
            }
        }
    }

    #[test]
    fn the_scatter_of_white_noise_is_what_the_averages_say() {
        // variance over many bins and trials of Ŝ/S; and of its sum over a band, where bins share
        let (trials, len, n) = (1500, 64, 64 * 20);
        let (mut square, mut band_square, mut count) = (0.0, 0.0, 0.0);
        let (first, last) = (3, 29);
        let (mut averages, mut by_bin) = (0.0, 0.0);
        for trial in 0..trials {
            let r = recording(1.0, vec![noise(100 + trial, n)]);
            let got = welch(&r, &segments_of(len)).unwrap();
            (averages, by_bin) = (got.averages, got.likelihood_averages());
            let mut band = 0.0;
            for k in first..last {
                let d = got.s[k][(0, 0)].re - 1.0;
                square += d * d;
                band += d;
                count += 1.0;
            }
            band_square += band * band;
        }
        let measured = count / square;
        assert!((measured / averages - 1.0).abs() < 0.1, "{measured} against {averages}");
        assert!((averages / 20.0 - 2.08).abs() < 0.1, "{averages}");
        // a variance from 1500 sums is known to √(2/1500) = 3.7 %; the band's ends share with bins outside, 2 % of 26
        let measured = count / band_square;
        assert!((measured / by_bin).ln().abs() < 0.1, "{measured} against {by_bin}");
        assert!((by_bin / 20.0 - 1.0).abs() < 0.05, "{by_bin}");
    }

    #[test]
    fn merged_spectra_are_those_of_all_segments_within_a_piece() {
        // the other way: all segments of the whole, less those over the cut, straight from the periodograms
        let (len, hop) = (64, 16);
        let whole = recording(10.0, vec![noise(7, 900), noise(8, 900)]);
        let halves = [whole.part(0..400).unwrap(), whole.part(400..900).unwrap()];
        let spectra = halves.each_ref().map(|r| welch(r, &segments_of(len)).unwrap());
        let merged = CrossSpectra::merged(&spectra).unwrap();
        let (a, b) = ((400 - len) / hop + 1, (500 - len) / hop + 1);
        assert_eq!((merged.segments, merged.pieces.as_slice()), (a + b, [a, b].as_slice()));
        // 400 is a whole number of hops: segments 0..a and 25..25 + b of the whole
        let window = HannWindow::new(len);
        let sum = |range: std::ops::Range<usize>| averaged(whole.samples(), 10.0, &window, hop, range);
        let (one, other) = (sum(0..a), sum(25..25 + b));
        for k in 0..merged.s.len() {
            for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                let direct = (one[k][(i, j)] * a as f64 + other[k][(i, j)] * b as f64) / (a + b) as f64;
                assert!((merged.s[k][(i, j)] - direct).norm() < 1e-13 * (1.0 + direct.norm()), "{k}");
            }
        }
        // equal pieces are worth twice one; a piece alone is untouched
        let twice = CrossSpectra::merged(&[spectra[0].clone(), spectra[0].clone()]).unwrap();
        assert!((twice.averages / (2.0 * spectra[0].averages) - 1.0).abs() < 1e-14);
        let (both, single) = (twice.likelihood_averages(), spectra[0].likelihood_averages());
        assert!((both / (2.0 * single) - 1.0).abs() < 1e-14);
        let alone = CrossSpectra::merged(&spectra[..1]).unwrap();
        assert_eq!(alone.averages.to_bits(), spectra[0].averages.to_bits());
        // long pieces hold T/T_seg each, so that cutting a long drive loses next to nothing
        let pieces =
            [10_000, 30_000].map(|n| welch(&recording(1.0, vec![noise(9, n)]), &segments_of(len)).unwrap());
        let held = CrossSpectra::merged(&pieces).unwrap().likelihood_averages();
        assert!((held * len as f64 / 40_000.0 - 1.0).abs() < 0.01, "{held}");
        assert!(CrossSpectra::merged(&[]).is_err());
        let other = |r: &Recording, n| {
            CrossSpectra::merged(&[spectra[0].clone(), welch(r, &segments_of(n)).unwrap()])
        };
        assert!(other(&halves[1], 32).unwrap_err().to_string().contains("expected 64, found 32"));
        assert!(other(&recording(20.0, vec![noise(1, 400), noise(2, 400)]), len).is_err());
        assert!(other(&recording(10.0, vec![noise(1, 400)]), len).is_err());
    }

    #[test]
    fn merged_white_noise_scatters_as_its_averages_say() {
        let (trials, len, pieces) = (800, 64, [64 * 3, 64 * 5, 64 * 12]);
        let (mut square, mut count, mut averages) = (0.0, 0.0, 0.0);
        for trial in 0..trials {
            let parts: Vec<CrossSpectra> = pieces
                .iter()
                .enumerate()
                .map(|(p, n)| {
                    let r = recording(1.0, vec![noise(9000 + 10 * trial + p as u64, *n)]);
                    welch(&r, &segments_of(len)).unwrap()
                })
                .collect();
            let got = CrossSpectra::merged(&parts).unwrap();
            averages = got.averages;
            for k in 3..29 {
                square += (got.s[k][(0, 0)].re - 1.0).powi(2);
                count += 1.0;
            }
        }
        // 800 trials of about ten independent bins: the variance is known to 1.6 %; 5 % are three of these
        let measured = count / square;
        assert!((measured / averages - 1.0).abs() < 0.05, "{measured} against {averages}");
    }

    #[test]
    fn too_short_is_said_with_both_numbers() {
        let r = recording(100.0, vec![noise(1, 400)]);
        let e = welch(&r, &WelchSettings::hann(Segment::Seconds(5.0))).unwrap_err().to_string();
        assert!(e.contains("500") && e.contains("400"), "{e}");
        assert!(welch(&r, &segments_of(4)).is_err());
        assert!(welch(&r, &WelchSettings { segment: Segment::Samples(64), overlap: 1.0 }).is_err());
        assert_eq!(welch(&r, &segments_of(400)).unwrap().segments, 1);
    }
}
