//! Free modes.
#![allow(clippy::print_stdout, clippy::unwrap_used)]
mod common;
use common::{cars, perturbed, sensors};
use std::time::Instant;
use washboard::identify::*;
use washboard::lti::{FirstOrder, Parametric};
use washboard::signal::{Segment, WelchSettings, welch};
use washboard::units::Convention;
use washboard::vehicle::{DriveSettings, ParametricVehicle, simulate};

fn main() {
    let argument = |i: usize, default: f64| std::env::args().nth(i).map_or(default, |a| a.parse().unwrap());
    let (seeds, duration_s, segment) = (argument(1, 1.0) as u64, argument(2, 1200.0), argument(3, 20.0));
    let road = washboard::cases::road("iso8608-c").unwrap();
    for (name, spec) in cars() {
        let truth = spec.build_alone().unwrap();
        for seed in 0..seeds {
            let settings = DriveSettings { speed_m_s: 20.0, duration_s, rate_hz: 200.0, seed };
            let r = simulate(&truth, &road, &sensors("all", 0.02), &settings).unwrap().detrended();
            let start = perturbed(&spec, r.channels(), r.wheels(), seed, 0.3);
            let (family, derivatives) =
                ParametricVehicle::new(&start, r.channels(), r.wheels(), &[]).unwrap();
            let spectra = welch(&r, &WelchSettings::hann(Segment::Seconds(segment))).unwrap();
            let system = family.system(&family.start()).unwrap();
            let at_m = system.at_m().to_vec();
            let planes: Vec<[f64; 3]> = r
                .channels()
                .iter()
                .map(|c| {
                    let p = at_m[c.wheel.unwrap()];
                    [1.0, p[1], p[0]]
                })
                .collect();
            let drive = FreeDrive {
                spectra: &spectra,
                blocks: &[],
                at_m: &at_m,
                derivatives: &derivatives,
                planes: &planes,
                speed_m_s: 20.0,
                band_hz: [0.4, 20.0],
            };
            let s = FreeStart {
                name: "start".into(),
                far: true,
                system: FirstOrder::of_wheeled(&system).unwrap(),
                roughness_m3: 16e-6,
                exponent: 2.0,
                mu: Some(3.0),
            };
            let begin = Instant::now();
            let found = fit_free_modes(&drive, &[s], Convention::default()).unwrap();
            let time = begin.elapsed();
            println!(
                "{name} {seed}: {:?} {:?} chi {:.3} {time:.2?} spread {:.4}",
                found.problems, found.trials, found.chi, found.static_spread
            );
            for ((m, fs, zs), (t, label)) in found.modes.iter().zip(truth.modes().unwrap()) {
                println!(
                    "   {label}: f {:+.2} % ({:.2})  zeta {:+.2} ({:.2})",
                    100.0 * (m.freq_hz / t.freq_hz - 1.0),
                    100.0 * fs / m.freq_hz,
                    100.0 * (m.damping - t.damping),
                    100.0 * zs
                );
            }
            println!(
                "   S0 {:+.2} % ({:.2}) e {:+.4} ({:.4}) mu {:+.2} % ({:.2})",
                100.0 * (found.roughness_m3.value / 16e-6 - 1.0),
                100.0 * found.roughness_m3.sd / 16e-6,
                found.exponent.value - 2.0,
                found.exponent.sd,
                100.0 * (found.mu.unwrap().value / 3.8 - 1.0),
                100.0 * found.mu.unwrap().sd / 3.8
            );
        }
    }
}
