//! Spectra of signals whose spectra are known.

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
        let expected = C64::new(0.0, -got.omega_rad_s[k] * delay as f64 / rate).exp() * got.s[k][(0, 0)].re;
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
    let other =
        |r: &Recording, n| CrossSpectra::merged(&[spectra[0].clone(), welch(r, &segments_of(n)).unwrap()]);
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
