//! Standard deviations of the classical estimators against their errors: `study_operational [seeds] [samples] [method]`.
//!
//! A structure of four modes (1 to 3 % and 10 % of damping) under white forces, 40 Hz, 5 % sensor noise. Prints for each
//! method and mode: times found, mean and rms error of f and ζ, the ratio of the rms error to the mean standard deviation
//! and the coverage of 95 % intervals; and what else was called a mode.

#![allow(clippy::print_stdout, clippy::unwrap_used)]

#[path = "common/structure.rs"]
mod structure;

use std::time::Instant;
use structure::Structure;
use washboard::identify::{FddSettings, PlscfSettings, PlscfSpectrum, SsiSettings, fdd, plscf, ssi_cov};

/// f, its standard deviation, ζ, its standard deviation.
type Found = (f64, Option<f64>, f64, Option<f64>);

fn main() {
    let argument = |i: usize| std::env::args().nth(i);
    let seeds: u64 = argument(1).map_or(60, |a| a.parse().unwrap());
    let samples: usize = argument(2).map_or(36_000, |a| a.parse().unwrap());
    let structure = Structure::mixed();
    let rate = structure.rate_hz;
    let ssi = |x: &[Vec<f64>]| -> Vec<Found> {
        let found = ssi_cov(x, rate, &SsiSettings::default()).unwrap();
        found.modes.iter().map(|m| (m.freq_hz, m.freq_sd_hz, m.damping, m.damping_sd)).collect()
    };
    let half = |x: &[Vec<f64>]| -> Vec<Found> {
        let found = plscf(x, rate, &PlscfSettings::default()).unwrap();
        found.modes.iter().map(|m| (m.freq_hz, m.freq_sd_hz, m.damping, m.damping_sd)).collect()
    };
    let full = |x: &[Vec<f64>]| -> Vec<Found> {
        let settings = PlscfSettings { spectrum: PlscfSpectrum::Full, ..PlscfSettings::default() };
        let found = plscf(x, rate, &settings).unwrap();
        found.modes.iter().map(|m| (m.freq_hz, m.freq_sd_hz, m.damping, m.damping_sd)).collect()
    };
    let bell = |x: &[Vec<f64>]| -> Vec<Found> {
        let found = fdd(x, rate, &FddSettings::default()).unwrap();
        let damped =
            found.modes.iter().filter_map(|m| Some((m.freq_hz, m.freq_sd_hz, m.damping?, m.damping_sd)));
        damped.collect()
    };
    type Method<'a> = (&'a str, &'a (dyn Fn(&[Vec<f64>]) -> Vec<Found> + Sync));
    let methods: [Method<'_>; 4] = [("ssi", &ssi), ("plscf", &half), ("plscf-full", &full), ("fdd", &bell)];
    println!("{seeds} seeds of {samples} samples at {rate} Hz");
    for (name, method) in methods.iter().filter(|m| argument(3).is_none_or(|only| only == m.0)) {
        let start = Instant::now();
        let all: Vec<Vec<Found>> =
            (0..seeds).map(|seed| method(&structure.simulate(seed, samples, 0.05))).collect();
        let seconds = start.elapsed().as_secs_f64() / seeds as f64;
        let total: usize = all.iter().map(Vec::len).sum();
        println!(
            "{name}: {:.2} modes a record, {seconds:.3} s with its simulation",
            total as f64 / seeds as f64
        );
        for &(f, zeta) in &structure.modes {
            report(f, zeta, &all);
        }
    }
}

fn report(f: f64, zeta: f64, all: &[Vec<Found>]) {
    let near: Vec<Found> = all
        .iter()
        .filter_map(|modes| {
            let off = |m: &&Found| (m.0 / f - 1.0).abs();
            modes.iter().filter(|m| off(m) < 0.05).min_by(|a, b| off(a).total_cmp(&off(b))).copied()
        })
        .collect();
    let f_line: Vec<(f64, Option<f64>)> = near.iter().map(|m| (m.0 - f, m.1)).collect();
    let zeta_line: Vec<(f64, Option<f64>)> = near.iter().map(|m| (m.2 - zeta, m.3)).collect();
    println!("  {f} Hz, ζ {zeta}: found {} times", near.len());
    for (what, line, unit) in [("f  ", f_line, f / 100.0), ("ζ  ", zeta_line, 0.01)] {
        let with: Vec<(f64, f64)> = line.iter().filter_map(|(e, s)| Some((*e, (*s)?))).collect();
        let n = with.len().max(1) as f64;
        let mean = with.iter().map(|w| w.0).sum::<f64>() / n;
        let rms = (with.iter().map(|w| w.0 * w.0).sum::<f64>() / n).sqrt();
        let sd = with.iter().map(|w| w.1).sum::<f64>() / n;
        let covered = with.iter().filter(|w| w.0.abs() <= 1.96 * w.1).count();
        println!(
            "    {what} mean error {:+.3} rms {:.3} (% or points); rms/sd {:.2}; 95 % covers {:.0} % of {}",
            mean / unit,
            rms / unit,
            rms / sd,
            100.0 * covered as f64 / n,
            with.len()
        );
    }
}
