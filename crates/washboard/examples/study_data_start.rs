//! Free modes from the data alone, against the answer of all starts: `study_data_start [seeds] [duration_s] [speed] [noise] [first]`.
//!
//! Published, SUV, sports and asymmetric car on a class C road, 8 accelerometers. Prints how far the start is from the truth
//! (response, worst over sensors and wheels; μ, S₀), where a search from it alone ends, and how many end at the answer of
//! the other starts of `identify --method tvimm` (costs within 1).

#![allow(clippy::print_stdout, clippy::unwrap_used)]

mod common;

use common::{cars, sensors, settings};
use std::time::Instant;
use washboard::identify::{FreeDrive, data_start, fit_free_modes};
use washboard::linalg::C64;
use washboard::lti::{FirstOrder, Parametric};
use washboard::signal::{Place, Segment, WelchSettings, welch};
use washboard::study::{IdentifyMethod, identify_recording};
use washboard::units::Convention;
use washboard::vehicle::{DriveSettings, ParametricVehicle, simulate};

fn main() {
    let number = |i: usize, default: f64| std::env::args().nth(i).map_or(default, |a| a.parse().unwrap());
    let (seeds, duration_s, speed_m_s, noise, first) =
        (number(1, 3.0) as u64, number(2, 1200.0), number(3, 20.0), number(4, 0.02), number(5, 0.0) as u64);
    let road = washboard::cases::road("iso8608-c").unwrap();
    let (mut runs, mut same) = (0, 0);
    for (name, spec) in
        cars().into_iter().filter(|(n, _)| ["published", "suv", "sports", "asymmetric"].contains(n))
    {
        let vehicle = spec.build_alone().unwrap();
        for seed in first..first + seeds {
            let drive = DriveSettings { speed_m_s, duration_s, rate_hz: 200.0, seed };
            let recording = simulate(&vehicle, &road, &sensors("all", noise), &drive).unwrap();
            let (channels, wheels) = (recording.channels(), recording.wheels());
            let (family, derivatives) = ParametricVehicle::new(&spec, channels, wheels, &[]).unwrap();
            let system = family.system(&family.start()).unwrap();
            let truth = FirstOrder::of_wheeled(&system).unwrap();
            let at: Vec<[f64; 2]> = channels.iter().map(|c| wheels[c.wheel.unwrap()].at_m).collect();
            let planes: Vec<[f64; 3]> = at.iter().map(|[x, y]| [1.0, *y, *x]).collect();
            let segment = Segment::Seconds((duration_s / 15.0).clamp(5.0, 20.0));
            let spectra = welch(&recording, &WelchSettings::hann(segment)).unwrap();
            let of_fit = FreeDrive {
                spectra: &spectra,
                blocks: &[],
                at_m: system.at_m(),
                derivatives: &derivatives,
                planes: &planes,
                speed_m_s,
                band_hz: [0.4, 20.0],
            };
            let on_wheel: Vec<Option<usize>> =
                channels.iter().map(|c| c.wheel.filter(|_| c.place == Place::Hub)).collect();
            let begin = Instant::now();
            let start = match data_start(&of_fit, &on_wheel, truth.order(), Convention::default()) {
                Ok(start) => start,
                Err(e) => {
                    println!("{name} {seed}: {e}");
                    continue;
                }
            };
            let made = begin.elapsed().as_secs_f64();
            let mut worst = [0.0f64; 3];
            for k in 0..98 {
                let s = C64::new(0.0, std::f64::consts::TAU * (0.4 + 0.2 * f64::from(k)));
                let (a, b) = (start.system.response(s).unwrap(), truth.response(s).unwrap());
                let part = if k < 13 {
                    0
                } else if k < 40 {
                    1
                } else {
                    2
                };
                for i in 0..a.nrows() {
                    for j in 0..a.ncols() {
                        worst[part] = worst[part].max((a[(i, j)] - b[(i, j)]).norm());
                    }
                }
            }
            let mut poles: Vec<(f64, f64)> = start
                .system
                .poles()
                .unwrap()
                .iter()
                .filter(|p| p.im >= 0.0)
                .map(|p| (p.norm() / std::f64::consts::TAU, -p.re / p.norm()))
                .collect();
            poles.sort_by(|a, b| a.0.total_cmp(&b.0));
            println!(
                "{name} {seed}: start within {worst:.3?} (to 3, to 8, to 20 Hz) of the truth, mu {:.2} S0 {:.2e}, made in {made:.3} s; poles {poles:.2?}",
                start.mu.unwrap(),
                start.roughness_m3
            );
            let begin = Instant::now();
            let alone = fit_free_modes(&of_fit, &[start], Convention::default()).unwrap();
            let took = begin.elapsed().as_secs_f64();
            let t = &alone.trials[0];
            let all = identify_recording(&recording, "", None, &settings(IdentifyMethod::Tvimm)).unwrap().0;
            let others = all.starts.iter().filter(|s| s.name != t.name);
            let best = others.map(|s| s.cost).fold(f64::INFINITY, f64::min);
            println!(
                "   alone: cost {:.2} chi {:.3} converged {} steps {} evaluations {} in {took:.2} s; other starts: cost {best:.2}",
                t.cost, t.chi, t.converged, t.steps, t.evaluations
            );
            runs += 1;
            same += u32::from(t.converged && (t.cost - best).abs() < 1.0);
        }
    }
    println!("{same} of {runs} searches from the data alone end at the answer of the other starts");
}
