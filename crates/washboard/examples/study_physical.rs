//! Accuracy of the physical fit over many simulated drives: `study_physical [seeds] [duration_s]`.
//!
//! The paper's car on a class C road at 20 m/s, 200 Hz, 8 accelerometers, 2 % noise; starts off by ±30 % in every
//! parameter. Prints rms errors over seeds, the coverage of 95 % intervals, and SSI's error on the same drives.

#![allow(clippy::print_stdout, clippy::unwrap_used)]

mod common;

use common::{perturbed, sensors};
use std::time::Instant;
use washboard::cases;
use washboard::identify::{PhysicalSettings, fit_physical};
use washboard::signal::{Segment, WelchSettings, welch};
use washboard::units::Convention;
use washboard::vehicle::{DriveSettings, ParametricVehicle, simulate};

fn main() {
    let argument = |i: usize, default: f64| std::env::args().nth(i).map_or(default, |a| a.parse().unwrap());
    let (seeds, duration_s) = (argument(1, 8.0) as u64, argument(2, 1200.0));
    let spec = cases::vehicle_spec("guiggiani-full-car").unwrap();
    let truth = spec.build_alone().unwrap();
    let road = cases::road("iso8608-c").unwrap();
    let true_modes = truth.modes().unwrap();
    let (mut squares, mut inside, mut asked) = ([0.0; 5], 0, 0);
    let mut worst_f = [0.0; 7];
    let mut worst_z = [0.0; 7];
    for seed in 0..seeds {
        let settings = DriveSettings { speed_m_s: 20.0, duration_s, rate_hz: 200.0, seed };
        let recording = simulate(&truth, &road, &sensors("all", 0.02), &settings).unwrap();
        let begin = Instant::now();
        let spectra =
            welch(&recording, &WelchSettings::hann(Segment::Samples(argument(4, 4000.0) as usize))).unwrap();
        let start = perturbed(&spec, recording.channels(), recording.wheels(), seed, 0.3);
        let (family, derivatives) =
            ParametricVehicle::new(&start, recording.channels(), recording.wheels(), &[]).unwrap();
        let physical = PhysicalSettings {
            speed_m_s: 20.0,
            band_hz: [0.4, argument(3, 20.0)],
            convention: Convention::OneSidedRadPerM,
        };
        let found = fit_physical(&family, &derivatives, &spectra, &physical).unwrap();
        let time = begin.elapsed();
        let mut covers = |truth: f64, value: f64, sd: f64| {
            asked += 1;
            inside += u32::from((value - truth).abs() <= 1.96 * sd);
        };
        let (mut f, mut z): (f64, f64) = (0.0, 0.0);
        for (k, (mode, f_sd, z_sd)) in found.modes.iter().enumerate() {
            let (t, _) = &true_modes[k];
            covers(t.freq_hz, mode.freq_hz, *f_sd);
            covers(t.damping, mode.damping, *z_sd);
            worst_f[k] += (100.0 * (mode.freq_hz / t.freq_hz - 1.0)).powi(2);
            worst_z[k] += (100.0 * (mode.damping - t.damping)).powi(2);
            f = f.max((mode.freq_hz / t.freq_hz - 1.0).abs());
            z = z.max((mode.damping - t.damping).abs());
        }
        let mu = found.mu.unwrap();
        let delay = found.delay_s.unwrap();
        covers(16e-6, found.roughness_m3.value, found.roughness_m3.sd);
        covers(2.0, found.exponent.value, found.exponent.sd);
        covers(3.8, mu.value, mu.sd);
        covers(0.133, delay.value, delay.sd);
        let errors = [
            found.roughness_m3.value / 16e-6 - 1.0,
            found.exponent.value - 2.0,
            mu.value / 3.8 - 1.0,
            delay.value / 0.133 - 1.0,
            found.chi,
        ];
        errors.iter().zip(&mut squares).for_each(|(e, s)| *s += e * e);
        println!(
            "seed {seed}: {:?} chi {:.3} decrement {:.1e} steps {:?} | f {:.3} % zeta {:.3} points S0 {:+.2} % e {:+.4} mu {:+.2} % delay {:+.4} % | {time:.2?} {:?}",
            found.problems.is_empty(),
            found.chi,
            found.decrement,
            found.work,
            100.0 * f,
            100.0 * z,
            100.0 * errors[0],
            errors[1],
            100.0 * errors[2],
            100.0 * errors[3],
            found.problems,
        );
    }
    let n = seeds as f64;
    let rms = |s: f64| (s / n).sqrt();
    println!(
        "rms over {seeds} seeds: f by mode {:.4?} %",
        worst_f.iter().map(|s| rms(*s)).collect::<Vec<_>>()
    );
    println!("zeta by mode {:.4?} points", worst_z.iter().map(|s| rms(*s)).collect::<Vec<_>>());
    println!(
        "S0 {:.2} %, e {:.4}, mu {:.2} %, delay {:.4} %; 95 % intervals cover {:.1} % of {asked}",
        100.0 * rms(squares[0]),
        rms(squares[1]),
        100.0 * rms(squares[2]),
        100.0 * rms(squares[3]),
        100.0 * f64::from(inside) / f64::from(asked),
    );
}
