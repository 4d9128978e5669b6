//! Accuracy of the physical fit over many simulated drives: `study_physical [seeds] [duration_s] [ssi seeds]`.
//!
//! The paper's car on a class C road at 20 m/s, 200 Hz, 8 accelerometers, 2 % noise; starts off by ±30 % in every
//! parameter. Prints rms errors over seeds, the coverage of 95 % intervals, and SSI's errors on the same drives and on a
//! control without a road's colour and correlation (every wheel on its own white-acceleration road).

#![allow(clippy::print_stdout, clippy::unwrap_used)]

mod common;

use common::{perturbed, sensors, settings};
use std::time::Instant;
use washboard::cases;
use washboard::linalg::C64;
use washboard::lti::Mode;
use washboard::road::{Coherence, Road, Shapes, ShapingFilter, Spectrum};
use washboard::study::{IdentifyMethod, IdentifyOutcome, identify_recording};
use washboard::vehicle::{DriveSettings, simulate};

fn main() {
    let argument = |i: usize, default: f64| std::env::args().nth(i).map_or(default, |a| a.parse().unwrap());
    let (seeds, duration_s, ssi_seeds) =
        (argument(1, 8.0) as u64, argument(2, 1200.0), argument(3, 3.0) as u64);
    let spec = cases::vehicle_spec("guiggiani-full-car").unwrap();
    let truth = spec.build_alone().unwrap();
    let road = cases::road("iso8608-c").unwrap();
    let true_modes = truth.modes().unwrap();
    let drive = |road: &Road, seed| {
        let settings = DriveSettings { speed_m_s: 20.0, duration_s, rate_hz: 200.0, seed };
        simulate(&truth, road, &sensors("all", 0.02), &settings).unwrap()
    };
    // f and ζ of seven modes, S0, e, mu, delay
    let mut errors: Vec<Vec<f64>> = vec![Vec::new(); 18];
    let mut scores: Vec<Vec<f64>> = vec![Vec::new(); 18];
    let mut converged = 0;
    for seed in 0..seeds {
        let recording = drive(&road, seed);
        let start = perturbed(&spec, recording.channels(), recording.wheels(), seed, 0.3);
        let begin = Instant::now();
        let physical = settings(IdentifyMethod::Physical);
        let found = identify_recording(&recording, "", Some(("start", &start)), &physical).unwrap().0;
        let time = begin.elapsed();
        converged += u32::from(found.converged);
        let fit = found.fit.as_ref().unwrap();
        let line = errors_of(&found, &true_modes);
        println!(
            "seed {seed}: {} chi {:.3} decrement {:.1e} steps {} | worst f {:.3} % zeta {:.3} points | S0 {:+.2} % e {:+.4} mu {:+.2} % delay {:+.4} % | {time:.2?}",
            if found.converged { "converged" } else { "FLAGGED" },
            fit.chi,
            fit.decrement,
            fit.iterations,
            line[..14].iter().step_by(2).fold(0.0f64, |a, b| a.max(b.0.abs())),
            line[1..14].iter().step_by(2).fold(0.0f64, |a, b| a.max(b.0.abs())),
            line[14].0,
            line[15].0,
            line[16].0,
            line[17].0,
        );
        for (k, (error, score)) in line.into_iter().enumerate() {
            errors[k].push(error);
            scores[k].push(score);
        }
    }
    let rms = |v: &Vec<f64>| (v.iter().map(|x| x * x).sum::<f64>() / v.len() as f64).sqrt();
    println!("rms over {seeds} seeds, {converged} converged:");
    println!("f, % by mode:          {:.4?}", errors[..14].iter().step_by(2).map(rms).collect::<Vec<_>>());
    println!("zeta, points by mode:  {:.4?}", errors[1..14].iter().step_by(2).map(rms).collect::<Vec<_>>());
    println!("S0 %, e, mu %, delay %: {:.4?}", errors[14..].iter().map(rms).collect::<Vec<_>>());
    println!(
        "error over its standard deviation, in the order above: {:.2?}",
        scores.iter().map(rms).collect::<Vec<_>>()
    );
    let asked = scores.iter().map(Vec::len).sum::<usize>();
    let inside = scores.iter().flatten().filter(|z| z.abs() <= 1.96).count();
    println!("95 % intervals cover {:.1} % of {asked}", 100.0 * inside as f64 / asked as f64);

    // white forces: road height ∝ 1/(s + a) with a far above the band is white in height, so are the tires' forces
    let white =
        ShapingFilter::from_zeros_poles(&[], &[C64::new(-6e3, 0.0)], 20.0, Shapes::Height, false).unwrap();
    let control = Road::new(Spectrum::Filter(white), Coherence::Independent);
    for (name, road) in [("the road", &road), ("the control: white, uncorrelated", &control)] {
        for seed in 0..ssi_seeds {
            let found =
                identify_recording(&drive(road, seed), "", None, &settings(IdentifyMethod::Ssi)).unwrap().0;
            let poles: Vec<String> = true_modes.iter().map(|(t, label)| nearest(&found, t, label)).collect();
            let accepted = found.modes.len();
            println!(
                "ssi on {name}, seed {seed}: {accepted} accepted; nearest stable poles {}",
                poles.join("; ")
            );
        }
    }
}

/// At each order from 20 the stable pole nearest to a true one: medians of their errors. What a kind reader would take
/// from the stabilisation diagram.
fn nearest(found: &IdentifyOutcome, truth: &Mode, label: &str) -> String {
    let mut errors: Vec<(f64, f64)> = Vec::new();
    for order in (20..=60).step_by(2) {
        let poles = found.stabilization.iter().filter(|p| p.order == order && p.stable);
        let off = |p: &&washboard::study::StabilizationPole| {
            (p.freq_hz / truth.freq_hz).ln().abs() + (p.damping - truth.damping).abs()
        };
        if let Some(p) = poles.min_by(|a, b| off(a).total_cmp(&off(b))) {
            errors.push((100.0 * (p.freq_hz / truth.freq_hz - 1.0), 100.0 * (p.damping - truth.damping)));
        }
    }
    let median = |mut v: Vec<f64>| {
        v.sort_by(f64::total_cmp);
        v.get(v.len() / 2).copied().unwrap_or(f64::NAN)
    };
    let (f, zeta) =
        (median(errors.iter().map(|e| e.0).collect()), median(errors.iter().map(|e| e.1).collect()));
    format!("{label}: {f:+.1} % {zeta:+.1} points")
}

/// Error in per cent (f, S0, mu, delay), points (ζ) or as it is (e), and over its standard deviation.
fn errors_of(found: &IdentifyOutcome, truth: &[(Mode, String)]) -> Vec<(f64, f64)> {
    let relative = |value: f64, truth: f64, sd: f64| (100.0 * (value / truth - 1.0), (value - truth) / sd);
    let mut line = Vec::new();
    for (mode, (t, _)) in found.modes.iter().zip(truth) {
        line.push(relative(mode.freq_hz, t.freq_hz, mode.freq_sd_hz.unwrap()));
        let off = mode.damping - t.damping;
        line.push((100.0 * off, off / mode.damping_sd.unwrap()));
    }
    let (road, coherence) = (found.road.as_ref().unwrap(), found.coherence.as_ref().unwrap());
    line.push(relative(road.roughness_m3, 16e-6, road.roughness_sd_m3));
    line.push((road.exponent - 2.0, (road.exponent - 2.0) / road.exponent_sd));
    line.push(relative(coherence.mu, 3.8, coherence.mu_sd));
    line.push(relative(found.delay_s.unwrap(), 0.133, found.delay_sd_s.unwrap()));
    line
}
