//! Lines and harmonic families: synthetic ones in coloured noise, and a real steering wobble.

#![allow(clippy::unwrap_used, clippy::print_stderr)]

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use realfft::RealFftPlanner;
use std::f64::consts::TAU;
use std::path::Path;
use washboard::identify::{Line, LineSettings, spectral_lines};

/// Independent averages per segment's length: half-overlapping Hann windows give 36/19 (Welch 1967), and the ends less.
const WORTH: f64 = 1.8;

/// Welch's estimate: frequencies, densities, effective averages.
fn welch(channels: &[Vec<f64>], rate_hz: f64, segment: usize) -> (Vec<f64>, Vec<Vec<f64>>, f64) {
    let fft = RealFftPlanner::<f64>::new().plan_fft_forward(segment);
    let window: Vec<f64> =
        (0..segment).map(|t| 0.5 - 0.5 * (TAU * t as f64 / segment as f64).cos()).collect();
    let density = |data: &Vec<f64>| {
        let mean = data.iter().sum::<f64>() / data.len() as f64;
        let mut sum = vec![0.0; segment / 2 + 1];
        for start in (0..=data.len() - segment).step_by(segment / 2) {
            let mut x: Vec<f64> = (0..segment).map(|t| (data[start + t] - mean) * window[t]).collect();
            let mut out = fft.make_output_vec();
            fft.process(&mut x, &mut out).unwrap();
            sum.iter_mut().zip(&out).for_each(|(s, v)| *s += v.norm_sqr());
        }
        sum
    };
    let freq = (0..=segment / 2).map(|k| k as f64 * rate_hz / segment as f64).collect();
    let averages = (WORTH * channels[0].len() as f64 / segment as f64).max(1.0);
    (freq, channels.iter().map(density).collect(), averages)
}

/// A resonance in noise that falls with frequency.
fn coloured(samples: usize, rate_hz: f64, mode: Option<(f64, f64)>, seed: u64) -> Vec<f64> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut gauss = || (0..12).map(|_| rng.random_range(-0.5..0.5)).sum::<f64>();
    let (a1, a2) = mode.map_or((0.0, 0.0), |(f, zeta)| {
        let omega = TAU * f / rate_hz;
        let r = (-zeta * omega).exp();
        (2.0 * r * (omega * (1.0 - zeta * zeta).sqrt()).cos(), -r * r)
    });
    let (mut y1, mut y2, mut slow) = (0.0, 0.0, 0.0);
    (0..samples)
        .map(|_| {
            slow = 0.9 * slow + gauss();
            let y = a1 * y1 + a2 * y2 + gauss();
            (y1, y2) = (y, y1);
            0.3 * slow + if mode.is_some() { y } else { 0.0 }
        })
        .collect()
}

fn found(lines: &[Line], f: f64, within: f64) -> Option<&Line> {
    lines.iter().find(|l| (l.freq_hz - f).abs() <= within)
}

#[test]
fn lines_in_coloured_noise_are_found_and_harmonics_flagged() {
    let (rate, n) = (100.0, 60_000);
    for seed in 0..5 {
        let mut x = coloured(n, rate, Some((9.0, 0.1)), seed);
        let y = coloured(n, rate, None, seed + 100);
        for (t, v) in x.iter_mut().enumerate() {
            let phase = TAU * t as f64 / rate;
            *v += 10.0 * (7.3 * phase).sin() + 3.0 * (14.6 * phase).cos() + (21.9 * phase).sin();
            *v += (31.7 * phase).sin();
        }
        let (f, g, k) = welch(&[x, y], rate, 1024);
        let lines = spectral_lines(&f, &g, k, &LineSettings::default()).unwrap();
        assert_eq!(lines.len(), 4, "seed {seed}: {lines:#?}");
        for (hz, multiple) in [(7.3, 1), (14.6, 2), (21.9, 3)] {
            let line = found(&lines, hz, 0.05).unwrap();
            let family = line.family.unwrap();
            assert_eq!(family.multiple, multiple);
            assert!((family.fundamental_hz - 7.3).abs() < 0.02);
            assert!(line.narrow() && line.channels == [0], "seed {seed}: {line:?}");
        }
        assert!(found(&lines, 31.7, 0.05).unwrap().family.is_none());
    }
}

#[test]
fn a_lightly_damped_mode_in_coloured_noise_is_no_line() {
    let (rate, n) = (100.0, 60_000);
    for seed in 0..20 {
        let channels = [
            coloured(n, rate, Some((11.0, 0.02)), seed),
            coloured(n, rate, Some((22.0, 0.02)), seed + 50),
            coloured(n, rate, Some((1.2, 0.3)), seed + 70),
        ];
        for segment in [512, 1024, 2048] {
            let (f, g, k) = welch(&channels, rate, segment);
            let lines = spectral_lines(&f, &g, k, &LineSettings::default()).unwrap();
            assert!(lines.is_empty(), "seed {seed}, {segment}: {lines:#?}");
        }
    }
}

#[test]
fn units_do_not_matter_and_wrong_input_is_refused() {
    let mut x = coloured(30_000, 100.0, None, 3);
    x.iter_mut().enumerate().for_each(|(t, v)| *v += (0.5 * t as f64).sin());
    let (f, g, k) = welch(&[x], 100.0, 1024);
    let settings = LineSettings::default();
    let plain = spectral_lines(&f, &g, k, &settings).unwrap();
    let scaled = vec![g[0].iter().map(|v| v * 1024.0).collect()];
    assert_eq!(plain, spectral_lines(&f, &scaled, k, &settings).unwrap());
    assert_eq!(plain.len(), 1);
    assert!(spectral_lines(&f[1..], &g, k, &settings).is_err());
    assert!(spectral_lines(&f, &g, 0.0, &settings).is_err());
    let mut uneven = f.clone();
    uneven[40] += 0.01;
    let refused = spectral_lines(&uneven, &g, k, &settings).unwrap_err().to_string();
    assert!(refused.contains("found 40"), "{refused}");
    let nan = vec![vec![f64::NAN; f.len()]];
    assert!(spectral_lines(&f, &nan, k, &settings).is_err());
}

#[test]
fn a_real_wobble_is_one_family() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().nth(3).unwrap();
    let folder = root.join("shared/data/wobbletracker");
    if !folder.is_dir() {
        eprintln!("skipped: {} is absent", folder.display());
        return;
    }
    for name in ["20211027T145614_sensors.csv", "20211027T145815_sensors.csv"] {
        let text = std::fs::read_to_string(folder.join(name)).unwrap();
        let rows: Vec<Vec<f64>> =
            text.lines().map(|l| l.split(',').map(|v| v.trim().parse().unwrap()).collect()).collect();
        let rate = (rows.len() - 1) as f64 / (rows[rows.len() - 1][0] - rows[0][0]);
        let channels: Vec<Vec<f64>> = (1..25).map(|c| rows.iter().map(|r| r[c]).collect()).collect();
        let (f, g, k) = welch(&channels, rate, 512);
        let lines = spectral_lines(&f, &g, k, &LineSettings::default()).unwrap();
        for (hz, multiple) in [(5.9, 1), (11.9, 2), (17.6, 3), (29.5, 5)] {
            let line = found(&lines, hz, 0.3).unwrap_or_else(|| panic!("{name}: {hz} Hz"));
            let family = line.family.unwrap();
            assert_eq!(family.multiple, multiple, "{name}: {hz} Hz");
            assert!((family.fundamental_hz - 5.9).abs() < 0.1, "{name}: {family:?}");
        }
    }
}
