//! Accuracy without a vehicle file on the cars of the notes: `study_cars METHOD [seeds] [duration_s] [speed] [noise] [first]`.
//!
//! METHOD is physical or tvimm. Published, SUV, sports and asymmetric car on a class C road, 8 accelerometers. Prints
//! each run, rms errors and the worst run a car, and how often 95 % intervals cover the truth.

#![allow(clippy::print_stdout, clippy::unwrap_used)]

mod common;

use common::{Errors, cars, sensors, settings};
use std::time::Instant;
use washboard::study::{IdentifyMethod, identify_recording};
use washboard::vehicle::{DriveSettings, simulate};

fn main() {
    let text = |i: usize| std::env::args().nth(i);
    let number = |i: usize, default: f64| text(i).map_or(default, |a| a.parse().unwrap());
    let method = match text(1).as_deref() {
        Some("tvimm") => IdentifyMethod::Tvimm,
        _ => IdentifyMethod::Physical,
    };
    let (seeds, duration_s, speed_m_s, noise, first) =
        (number(2, 8.0) as u64, number(3, 1200.0), number(4, 20.0), number(5, 0.02), number(6, 0.0) as u64);
    let road = washboard::cases::road("iso8608-c").unwrap();
    let (mut all, mut scores, mut runs, mut converged, mut time) = (Errors::default(), Vec::new(), 0, 0, 0.0);
    for (name, spec) in
        cars().into_iter().filter(|(n, _)| ["published", "suv", "sports", "asymmetric"].contains(n))
    {
        let vehicle = spec.build_alone().unwrap();
        let mut car = Errors::default();
        for seed in first..first + seeds {
            let drive = DriveSettings { speed_m_s, duration_s, rate_hz: 200.0, seed };
            let recording = simulate(&vehicle, &road, &sensors("all", noise), &drive).unwrap();
            let begin = Instant::now();
            let found = identify_recording(&recording, "", None, &settings(method)).unwrap().0;
            let took = begin.elapsed().as_secs_f64();
            let errors = Errors::of(&found, &vehicle.modes().unwrap(), 16e-6, 2.0, 3.8);
            println!(
                "{name} {seed}: {} chi {:.3} steps {} | {} | {took:.2} s{}",
                if found.converged { "converged" } else { "FLAGGED" },
                found.fit.as_ref().unwrap().chi,
                found.fit.as_ref().unwrap().iterations,
                errors.line(),
                found
                    .flags
                    .iter()
                    .filter(|f| f.name != "weak-parameters")
                    .map(|f| format!(" [{}: {}]", f.name, f.text))
                    .collect::<String>()
            );
            if std::env::var("DEBUG").is_ok() {
                println!("   {:?}", found.starts);
            }
            runs += 1;
            time += took;
            if found.converged {
                converged += 1;
                scores.extend(errors.scores.iter().copied());
                car.add(&errors);
                all.add(&errors);
            }
        }
        println!("{name}: rms {}; worst run {}", car.rms_line(), car.worst_line());
    }
    println!(
        "all: {converged} of {runs} converged; rms {}; worst run {}; {:.2} s a run",
        all.rms_line(),
        all.worst_line(),
        time / f64::from(runs)
    );
    let inside = scores.iter().filter(|z: &&f64| z.abs() <= 1.96).count();
    println!("95 % intervals cover {:.1} % of {}", 100.0 * inside as f64 / scores.len() as f64, scores.len());
    println!("errors over standard deviations, rms: {}", all.score_line());
}
