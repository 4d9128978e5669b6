//! What a fit of a spectrum costs: N = 1000, p = 100 by both routes, 100 noisy fits of N = 400, p = 50, and N = 10³ … 10⁶.

#![allow(clippy::print_stdout, clippy::unwrap_used)]

#[path = "common/spectra.rs"]
mod spectra;

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::f64::consts::PI;
use std::time::Instant;
use washboard::linalg::C64;
use washboard::subspace::{Samples, SpectrumSettings, Weights, fit_spectrum};

fn noisy(count: u32, seed: u64) -> Samples {
    let g = spectra::example();
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let theta: Vec<f64> =
        (0..count).map(|k| PI / f64::from(count) * (f64::from(k) + rng.random_range(0.1..0.9))).collect();
    let s: Vec<f64> = theta
        .iter()
        .map(|t| {
            g.at(C64::from_polar(1.0, *t)).unwrap()[(0, 0)].norm_sqr() * (1.0 + rng.random_range(-0.02..0.02))
        })
        .collect();
    Samples::scalar(theta, &s, Weights::Equal).unwrap()
}

fn best(runs: usize, mut work: impl FnMut()) -> f64 {
    (0..runs)
        .map(|_| {
            let begin = Instant::now();
            work();
            begin.elapsed().as_secs_f64()
        })
        .fold(f64::INFINITY, f64::min)
}

fn main() {
    let samples = noisy(1000, 1);
    for moments in [true, false] {
        let settings = SpectrumSettings { moments, ..SpectrumSettings::new(4, 100) };
        let mut route = None;
        let time = best(20, || route = Some(fit_spectrum(&samples, &settings).unwrap().route));
        println!("N = 1000, p = 100: {:.2} ms ({:?})", 1e3 * time, route.unwrap());
    }
    let many: Vec<Samples> = (0..100).map(|k| noisy(400, 100 + k)).collect();
    let time = best(5, || {
        let errors: Vec<f64> = many
            .par_iter()
            .map(|s| fit_spectrum(s, &SpectrumSettings::new(4, 50)).unwrap().factor.error)
            .collect();
        assert!(errors.iter().all(|e| *e < 1e-9));
    });
    println!("100 fits of N = 400, p = 50: {:.0} ms", 1e3 * time);
    for power in 3..=6 {
        let count = 10u32.pow(power);
        let samples = noisy(count, 7);
        for moments in [true, false] {
            let settings = SpectrumSettings { moments, ..SpectrumSettings::new(4, 50) };
            let time = best(if power < 5 { 5 } else { 1 }, || {
                fit_spectrum(&samples, &settings).unwrap();
            });
            let per = 1e6 * time / f64::from(count);
            println!("N = {count}, p = 50, moments {moments}: {:.1} ms, {per:.2} µs a sample", 1e3 * time);
        }
    }
}
