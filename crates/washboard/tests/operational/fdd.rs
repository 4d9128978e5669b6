//! FDD and EFDD: known modes with their damping, and the reason of every peak that is none.

use crate::structure::Structure;
use std::f64::consts::TAU;
use washboard::identify::{FddSettings, Reason, fdd};

const SAMPLES: usize = 36_000;
const NOISE: f64 = 0.05;

#[test]
fn known_modes_are_recovered_with_their_damping() {
    let structure = Structure::mixed();
    for seed in 0..5 {
        let outcome =
            fdd(&structure.simulate(seed, SAMPLES, NOISE), structure.rate_hz, &FddSettings::default());
        let outcome = outcome.unwrap();
        assert_eq!(outcome.modes.len(), 4, "seed {seed}");
        for (k, (mode, (f, zeta))) in outcome.modes.iter().zip(&structure.modes).enumerate() {
            let (f_sd, zeta_sd) = (mode.freq_sd_hz.unwrap(), mode.damping_sd.unwrap());
            // forty numbers
            assert!((mode.freq_hz - f).abs() < 4.0 * f_sd, "seed {seed}: {mode:?}");
            assert!((mode.damping.unwrap() - zeta).abs() < 4.0 * zeta_sd, "seed {seed}: {mode:?}");
            assert!(f_sd < 0.01 * f && zeta_sd < 0.01, "seed {seed}: {mode:?}");
            let mac = structure.mac(k, &mode.shape);
            assert!(mac > 0.98, "seed {seed}, mode {k}: MAC {mac}");
            assert!(mode.bell_hz[0] < *f && *f < mode.bell_hz[1]);
        }
        assert_eq!(outcome.singular_values.len(), 4);
        assert!(outcome.singular_values.iter().all(|c| c.len() == outcome.freq_hz.len()));
        assert!(outcome.rejected.iter().any(|r| r.reason == Reason::Noise));
    }
}

/// The window's part in the decay is taken out: segments of two lengths agree, where the decay of the window alone
/// differs by more than the light mode's.
#[test]
fn the_segments_length_does_not_show_in_the_damping() {
    let structure = Structure::mixed();
    let channels = structure.simulate(7, SAMPLES, NOISE);
    let with = |segment| {
        let settings = FddSettings { segment: Some(segment), ..FddSettings::default() };
        fdd(&channels, structure.rate_hz, &settings).unwrap().modes
    };
    let (short, long) = (with(600), with(1800));
    assert_eq!((short.len(), long.len()), (4, 4));
    for (a, b) in short.iter().zip(&long) {
        let allowed = 3.0 * a.damping_sd.unwrap().hypot(b.damping_sd.unwrap());
        let (a, b) = (a.damping.unwrap(), b.damping.unwrap());
        assert!((a - b).abs() < allowed, "{a} {b} {allowed}");
    }
}

#[test]
fn a_line_is_no_mode() {
    let structure = Structure::mixed();
    let mut channels = structure.simulate(2, SAMPLES, NOISE);
    let line_hz = 7.7;
    for (c, channel) in channels.iter_mut().enumerate() {
        let tone = |t: usize| (TAU * line_hz * t as f64 / structure.rate_hz).sin();
        channel.iter_mut().enumerate().for_each(|(t, v)| *v += (1.0 - 0.3 * c as f64) * tone(t));
    }
    let outcome = fdd(&channels, structure.rate_hz, &FddSettings::default()).unwrap();
    assert_eq!(outcome.modes.len(), 4);
    let line = outcome.rejected.iter().find(|r| r.reason == Reason::Line).unwrap();
    assert!((line.freq_hz - line_hz).abs() < 0.05 && line.why.contains("from block to block"), "{line:?}");
    // a peak outside the band is told as that
    let settings = FddSettings { band_hz: Some([2.0, 20.0]), ..FddSettings::default() };
    let outcome = fdd(&channels, structure.rate_hz, &settings).unwrap();
    assert!(outcome.rejected.iter().any(|r| r.reason == Reason::OutOfBand && r.freq_hz < 2.0));
}

#[test]
fn a_damping_that_cannot_be_had_is_said() {
    // a mode of 60 % dies within a cycle
    let structure = Structure { rate_hz: 40.0, modes: vec![(3.0, 0.6)], shapes: vec![vec![1.0], vec![0.5]] };
    let outcome = fdd(&structure.simulate(0, SAMPLES, 0.01), 40.0, &FddSettings::default()).unwrap();
    for mode in &outcome.modes {
        assert!(mode.damping.is_some() != mode.damping_why.is_some());
        assert!(mode.damping.is_none_or(|z| (z - 0.6).abs() < 0.2), "{mode:?}");
    }
}

#[test]
fn units_and_threads_do_not_matter() {
    let structure = Structure::mixed();
    let channels = structure.simulate(1, SAMPLES, NOISE);
    let run = |x: &[Vec<f64>]| fdd(x, structure.rate_hz, &FddSettings::default()).unwrap();
    let plain = run(&channels);
    let mut counts = channels.clone();
    counts[2].iter_mut().for_each(|v| *v = 2048.0 * *v + 100.0);
    let scaled = run(&counts);
    assert_eq!(plain.modes.len(), scaled.modes.len());
    for (a, b) in plain.modes.iter().zip(&scaled.modes) {
        // rounding of the rms division
        assert!((a.freq_hz / b.freq_hz - 1.0).abs() < 1e-8, "{} {}", a.freq_hz, b.freq_hz);
        assert!((a.damping.unwrap() - b.damping.unwrap()).abs() < 1e-8);
    }
    let pool = |n| rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
    assert!(pool(1).install(|| run(&channels)) == pool(3).install(|| run(&channels)));
}
