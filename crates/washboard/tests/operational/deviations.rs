//! Reported standard deviations are those of the errors: a short guard of `examples/study_operational.rs`.

use crate::structure::Structure;
use rayon::prelude::*;
use washboard::identify::{FddSettings, PlscfSettings, SsiSettings, fdd, plscf, ssi_cov};

const SEEDS: u64 = 12;
const SAMPLES: usize = 36_000;
/// rms of 96 errors over their standard deviations: theirs own error is about 15 % (modes of a record are nearly
/// independent, a standard deviation is known to 15–20 %).
const BETWEEN: std::ops::Range<f64> = 0.6..1.5;

type Found = Vec<(f64, Option<f64>, f64, Option<f64>)>;

fn check(method: impl Fn(&[Vec<f64>], f64) -> Found + Sync) {
    let structure = Structure::mixed();
    let scores: Vec<f64> = (100..100 + SEEDS)
        .into_par_iter()
        .flat_map(|seed| {
            let found = method(&structure.simulate(seed, SAMPLES, 0.05), structure.rate_hz);
            let mut scores = Vec::new();
            for (f, zeta) in &structure.modes {
                let off = |m: &&(f64, Option<f64>, f64, Option<f64>)| (m.0 / f - 1.0).abs();
                let near = found.iter().filter(|m| off(m) < 0.03).min_by(|a, b| off(a).total_cmp(&off(b)));
                if let Some((f0, Some(f_sd), zeta0, Some(zeta_sd))) = near {
                    scores.extend([(f0 - f) / f_sd, (zeta0 - zeta) / zeta_sd]);
                }
            }
            scores
        })
        .collect();
    assert!(scores.len() as u64 >= 7 * SEEDS, "{} of {}", scores.len(), 8 * SEEDS);
    let rms = (scores.iter().map(|s| s * s).sum::<f64>() / scores.len() as f64).sqrt();
    assert!(BETWEEN.contains(&rms), "rms of errors over their standard deviations: {rms}");
    let covered = scores.iter().filter(|s| s.abs() < 1.96).count() as f64 / scores.len() as f64;
    assert!(covered > 0.85, "95 % intervals cover {covered}");
}

#[test]
fn of_ssi() {
    check(|x, rate| {
        let modes = ssi_cov(x, rate, &SsiSettings::default()).unwrap().modes;
        modes.iter().map(|m| (m.freq_hz, m.freq_sd_hz, m.damping, m.damping_sd)).collect()
    });
}

#[test]
fn of_plscf() {
    check(|x, rate| {
        let modes = plscf(x, rate, &PlscfSettings::default()).unwrap().modes;
        modes.iter().map(|m| (m.freq_hz, m.freq_sd_hz, m.damping, m.damping_sd)).collect()
    });
}

#[test]
fn of_fdd() {
    check(|x, rate| {
        let modes = fdd(x, rate, &FddSettings::default()).unwrap().modes;
        modes.iter().map(|m| (m.freq_hz, m.freq_sd_hz, m.damping.unwrap(), m.damping_sd)).collect()
    });
}

#[test]
fn a_record_too_short_for_blocks_has_none() {
    let structure = Structure::mixed();
    let short = structure.simulate(0, 2_000, 0.05);
    let found = plscf(&short, 40.0, &PlscfSettings { max_order: 10, ..PlscfSettings::default() }).unwrap();
    assert!(found.modes.iter().all(|m| m.freq_sd_hz.is_none() && m.damping_sd.is_none()));
}
