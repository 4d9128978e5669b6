//! Many different drives: `study_other_drives [runs] [first]`. Each must be within 3 standard deviations + 1 % of the
//! truth (1 point for damping ratios), or flagged.
//!
//! Speeds of 10–40 m/s, roads A–E, all sensors, bodies only, hubs only, two a side, 5–60 min, six cars, starts off by
//! up to 50 %.

#![allow(clippy::print_stdout, clippy::unwrap_used)]

mod common;

use common::{cars, perturbed, sensors, settings};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::time::Instant;
use washboard::road::IsoClass;
use washboard::study::{IdentifyMethod, identify_recording};
use washboard::vehicle::{DriveSettings, simulate};

fn main() {
    let argument = |i: usize, default: u64| std::env::args().nth(i).map_or(default, |a| a.parse().unwrap());
    let (runs, first) = (argument(1, 200), argument(2, 0));
    let (mut good, mut flagged, mut silent) = (0, 0, 0);
    for run in first..first + runs {
        let mut rng = ChaCha8Rng::seed_from_u64(run);
        let cars = cars();
        let (name, spec) = &cars[rng.random_range(0..cars.len())];
        let speed_m_s = rng.random_range(10.0..=40.0);
        let class = IsoClass::ALL[rng.random_range(0..5)];
        let which = ["all", "all", "body", "hub", "side"][rng.random_range(0..5)];
        let duration_s = 60.0 * [5.0, 10.0, 20.0, 60.0][rng.random_range(0..4)];
        let share = [0.3, 0.5][rng.random_range(0..2)];
        let vehicle = spec.build_alone().unwrap();
        let road = washboard::cases::road(&format!("iso8608-{class:?}").to_lowercase()).unwrap();
        let drive = DriveSettings { speed_m_s, duration_s, rate_hz: 200.0, seed: run };
        let recording = simulate(&vehicle, &road, &sensors(which, 0.02), &drive).unwrap();
        let start = perturbed(spec, recording.channels(), recording.wheels(), run, share);
        let begin = Instant::now();
        let (found, _) =
            identify_recording(&recording, "", Some(("start", &start)), &settings(IdentifyMethod::Physical))
                .unwrap();
        let time = begin.elapsed();
        let mut off: Vec<String> = Vec::new();
        let mut check = |what: String, value: f64, truth: f64, sd: f64, slack: f64| {
            if !((value - truth).abs() <= 3.0 * sd + slack) {
                off.push(format!("{what} {value:.5} for {truth:.5} ± {sd:.5}"));
            }
        };
        for (mode, (truth, label)) in found.modes.iter().zip(vehicle.modes().unwrap()) {
            check(
                format!("f {label}"),
                mode.freq_hz,
                truth.freq_hz,
                mode.freq_sd_hz.unwrap(),
                0.01 * truth.freq_hz,
            );
            check(format!("zeta {label}"), mode.damping, truth.damping, mode.damping_sd.unwrap(), 0.01);
        }
        if let Some(r) = &found.road {
            let s0 = class.roughness_m3();
            check("S0".into(), r.roughness_m3, s0, r.roughness_sd_m3, 0.01 * s0);
            check("e".into(), r.exponent, 2.0, r.exponent_sd, 0.01);
        }
        if let Some(c) = &found.coherence {
            check("mu".into(), c.mu, 3.8, c.mu_sd, 0.038);
        }
        let verdict = match (off.is_empty(), found.converged) {
            (true, true) => {
                good += 1;
                "right"
            }
            (_, false) => {
                flagged += 1;
                "flagged"
            }
            (false, true) => {
                silent += 1;
                "WRONG"
            }
        };
        let flags: Vec<&str> =
            found.flags.iter().map(|f| f.name.as_str()).filter(|f| *f != "scale-held").collect();
        let fit = found.fit.as_ref().unwrap();
        println!(
            "{run}: {verdict} {name} {speed_m_s:.1} m/s {class:?} {which} {:.0} min start {share} chi {:.2} steps {} {time:.1?} {flags:?} {}",
            duration_s / 60.0,
            fit.chi,
            fit.iterations,
            off.first().map_or("", String::as_str),
        );
    }
    println!("{runs} runs: {good} right, {flagged} flagged, {silent} wrong without a flag");
}
