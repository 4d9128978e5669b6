//! A car whose engine moves on its mounts: seven modes do not suffice. `study_engine [seeds] [mass_kg] [hz]`.

#![allow(clippy::print_stdout, clippy::unwrap_used)]

mod common;

use common::{cars, sensors, settings, with_engine};
use std::time::Instant;
use washboard::study::{IdentifyMethod, identify_recording};
use washboard::vehicle::{DriveSettings, simulate};

fn main() {
    let number = |i: usize, default: f64| std::env::args().nth(i).map_or(default, |a| a.parse().unwrap());
    let (seeds, mass, hz) = (number(1, 2.0) as u64, number(2, 160.0), number(3, 14.9));
    let road = washboard::cases::road("iso8608-c").unwrap();
    let all = cars();
    for (name, spec) in all[..4].iter().filter(|(n, _)| std::env::args().nth(4).is_none_or(|a| a == *n)) {
        let vehicle = with_engine(spec, mass, hz, [1.1, 0.15]).build_alone().unwrap();
        let truth = vehicle.modes().unwrap();
        println!(
            "{name}: true modes {}",
            truth
                .iter()
                .map(|(m, _)| format!("{:.3}/{:.1} ", m.freq_hz, 100.0 * m.damping))
                .collect::<String>()
        );
        for seed in 0..seeds {
            let drive = DriveSettings { speed_m_s: 20.0, duration_s: 1200.0, rate_hz: 200.0, seed };
            let recording = simulate(&vehicle, &road, &sensors("all", 0.02), &drive).unwrap();
            let begin = Instant::now();
            let found = identify_recording(&recording, "", None, &settings(IdentifyMethod::Tvimm)).unwrap().0;
            println!("  seed {seed}: converged {} in {:.1?}", found.converged, begin.elapsed());
            for o in &found.orders {
                println!(
                    "    {} modes: cost {:.1} bic {:.1} chi {:.3} converged {} chosen {}",
                    o.modes, o.cost, o.bic, o.chi, o.converged, o.chosen
                );
            }
            for s in &found.starts {
                println!(
                    "    start {}: cost {:.1} chi {:.2} {} {} steps",
                    s.name, s.cost, s.chi, s.converged, s.steps
                );
            }
            for m in &found.modes {
                println!(
                    "    {:<24} {:.3} ± {:.3} Hz {:.2} ± {:.2} %",
                    m.label,
                    m.freq_hz,
                    m.freq_sd_hz.unwrap(),
                    100.0 * m.damping,
                    100.0 * m.damping_sd.unwrap()
                );
            }
            for f in &found.flags {
                println!("    ! {}: {}", f.name, f.text);
            }
            println!(
                "    S0 {:.3e} e {:.3} mu {:.2}",
                found.road.as_ref().unwrap().roughness_m3,
                found.road.as_ref().unwrap().exponent,
                found.coherence.as_ref().unwrap().mu
            );
        }
    }
}
