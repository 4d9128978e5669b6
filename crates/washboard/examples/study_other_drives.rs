//! Many different drives, identified without a vehicle file: `study_other_drives METHOD [runs] [first] [set]`. Everything that is
//! reported must be within 3 standard deviations + 2 % of the truth (2 points for damping ratios), or flagged.
//!
//! METHOD is physical or tvimm. Speeds of 10–40 m/s, noise of .5–10 %, roads A–E with e 1.7–2.5 and μ 2–8, all sensors,
//! bodies only, hubs only, two a side, 5–20 min, six cars. With a set (all, body, hub, side) only the runs that have it. At the end,
//! for each set of sensors, the rms of error over standard deviation of what converged.

#![allow(clippy::print_stdout, clippy::unwrap_used)]

mod common;

use common::{Errors, cars, sensors, settings, wrong};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;
use std::time::Instant;
use washboard::study::{IdentifyMethod, identify_recording};
use washboard::vehicle::{DriveSettings, simulate};

fn main() {
    let text = |i: usize| std::env::args().nth(i);
    let number = |i: usize, default: u64| text(i).map_or(default, |a| a.parse().unwrap());
    let method = match text(1).as_deref() {
        Some("tvimm") => IdentifyMethod::Tvimm,
        _ => IdentifyMethod::Physical,
    };
    let (runs, first) = (number(2, 500), number(3, 0));
    let only = text(4);
    let (mut good, mut flagged, mut silent) = (0, 0, 0);
    let mut errors: BTreeMap<&str, (usize, Errors)> = BTreeMap::new();
    for run in first..first + runs {
        let mut rng = ChaCha8Rng::seed_from_u64(run);
        let cars = cars();
        let (name, spec) = &cars[rng.random_range(0..cars.len())];
        let speed_m_s = rng.random_range(10.0..=40.0);
        let (level, e, mu) = common::road_values(&mut rng);
        let which = ["all", "all", "all", "body", "hub", "side"][rng.random_range(0..6)];
        if only.as_deref().is_some_and(|o| o != which) {
            continue;
        }
        let duration_s = 60.0 * [5.0, 10.0, 20.0][rng.random_range(0..3)];
        let noise = 0.005 * 20f64.powf(rng.random_range(0.0..=1.0));
        let vehicle = spec.build_alone().unwrap();
        let road = common::road(level, e, mu);
        let drive = DriveSettings { speed_m_s, duration_s, rate_hz: 200.0, seed: run };
        let recording = simulate(&vehicle, &road, &sensors(which, noise), &drive).unwrap();
        let begin = Instant::now();
        let (found, _) = identify_recording(&recording, "", None, &settings(method)).unwrap();
        let time = begin.elapsed();
        let off = wrong(&found, &vehicle.modes().unwrap(), level, e, mu, 0.02);
        if found.converged {
            let set = errors.entry(which).or_default();
            set.0 += 1;
            set.1.add(&Errors::of(&found, &vehicle.modes().unwrap(), level, e, mu));
        }
        match (found.converged, off.is_empty()) {
            (true, true) => good += 1,
            (false, _) => flagged += 1,
            (true, false) => silent += 1,
        }
        if !off.is_empty() || !found.converged {
            println!(
                "run {run}: {} {name} {which} {speed_m_s:.1} m/s S0 {level:.1e} e {e:.2} mu {mu:.1} noise {:.1} % {} min {time:.2?}: off {off:?}{}",
                if found.converged { "WRONG" } else { "flagged" },
                100.0 * noise,
                duration_s / 60.0,
                found.flags.iter().map(|f| format!(" [{}: {}]", f.name, f.text)).collect::<String>()
            );
        } else if run % 25 == 0 {
            println!("run {run}: right, {time:.2?}");
        }
    }
    for (which, (count, e)) in &errors {
        println!("{which}: {count} converged, error over deviation: {}", e.score_line());
    }
    println!(
        "{} drives: {good} right, {flagged} flagged, {silent} wrong without a flag",
        good + flagged + silent
    );
}
