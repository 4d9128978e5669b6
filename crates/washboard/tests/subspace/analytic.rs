//! Functions from one of their parts: exact without noise, as accurate as the notes say with it.

use super::systems::{example, random_system};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use std::f64::consts::PI;
use washboard::linalg::{C64, Mat};
use washboard::lti::{Discrete, StateSpace};
use washboard::subspace::{AnalyticSettings, Part, Weights, fit_analytic, magnitude_of_phase};

fn at(f: &StateSpace<Discrete>, theta: f64) -> C64 {
    f.at(C64::from_polar(1.0, theta)).unwrap()[(0, 0)]
}

fn worst(f: &StateSpace<Discrete>, g: &StateSpace<Discrete>) -> f64 {
    (0..=300).map(|k| PI * f64::from(k) / 300.0).map(|t| (at(f, t) - at(g, t)).norm()).fold(0.0, f64::max)
}

/// Nine samples and p = 9 for order 4: 2N > p + 2n − 1.
#[test]
fn nine_samples_of_the_real_part_are_enough() {
    let f = example();
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    for trial in 0..5 {
        let theta: Vec<f64> =
            (0..9).map(|k| PI * (f64::from(k) + rng.random_range(0.2..0.8)) / 9.0).collect();
        let u: Vec<f64> = theta.iter().map(|t| at(&f, *t).re).collect();
        let model =
            fit_analytic(&theta, &u, Weights::Equal, Part::Real, &AnalyticSettings::new(4, 9)).unwrap();
        let off = worst(&model.system, &f);
        assert!(off < 1e-9 * 20.0, "{trial}: {off:e}");
        let short =
            fit_analytic(&theta[..8], &u[..8], Weights::Equal, Part::Real, &AnalyticSettings::new(4, 9));
        assert!(short.is_err());
    }
}

/// The imaginary part gives all but the constant.
#[test]
fn the_imaginary_part_leaves_the_constant_open() {
    let mut rng = ChaCha8Rng::seed_from_u64(8);
    for n in 1..=6 {
        let f = random_system(n, 1, [0.4, 0.8], &mut rng);
        let without =
            StateSpace::discrete(f.a().clone(), f.b().clone(), f.c().clone(), Mat::zeros(1, 1), 1.0).unwrap();
        let theta: Vec<f64> = (0..30).map(|k| PI * (f64::from(k) + 0.5) / 30.0).collect();
        let v: Vec<f64> = theta.iter().map(|t| at(&f, *t).im).collect();
        let settings = AnalyticSettings::new(n, 2 * n + 3);
        let model = fit_analytic(&theta, &v, Weights::Equal, Part::Imaginary, &settings).unwrap();
        let off = worst(&model.system, &without);
        assert!(off < 1e-9, "{n}: {off:e}");
    }
}

/// Example 2.4.3: 20 runs of 1000 noisy samples; .0315 is printed, the notes have .0316 ± .0015.
#[test]
fn the_error_under_noise_is_the_printed_one() {
    let f = example();
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let count = 1000;
    let theta: Vec<f64> =
        (0..count).map(|k| PI * (f64::from(k) + rng.random_range(0.0..1.0)) / f64::from(count)).collect();
    let mut sum = 0.0;
    for _ in 0..20 {
        let u: Vec<f64> =
            theta.iter().map(|t| at(&f, *t).re + 0.25 * rng.sample::<f64, _>(StandardNormal)).collect();
        let model =
            fit_analytic(&theta, &u, Weights::Equal, Part::Real, &AnalyticSettings::new(4, 100)).unwrap();
        let squares: f64 = theta.iter().map(|t| (at(&model.system, *t) - at(&f, *t)).norm_sqr()).sum();
        sum += (squares / f64::from(count)).sqrt() / 20.0;
    }
    println!("example 2.4.3: {sum:.4}");
    // ± .006 by the measure: four standard errors
    assert!((sum - 0.0315).abs() < 0.006, "{sum}");
}

/// A real part that noise takes below zero is lifted where f must be positive real.
#[test]
fn a_positive_real_function_stays_one() {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    // u = 1 + cos θ touches 0 at π
    let theta: Vec<f64> = (0..200).map(|k| PI * (f64::from(k) + 0.5) / 200.0).collect();
    let mut lifted = 0;
    for _ in 0..10 {
        let u: Vec<f64> =
            theta.iter().map(|t| 1.01 + t.cos() + 0.1 * rng.sample::<f64, _>(StandardNormal)).collect();
        let settings = AnalyticSettings::new(1, 20);
        let plain = fit_analytic(&theta, &u, Weights::Equal, Part::Real, &settings).unwrap();
        let model = fit_analytic(&theta, &u, Weights::Equal, Part::PositiveReal, &settings).unwrap();
        let least = |f: &StateSpace<Discrete>| {
            (0..=2000).map(|k| at(f, PI * f64::from(k) / 2000.0).re).fold(f64::INFINITY, f64::min)
        };
        assert!(least(&model.system) > 0.0);
        assert_eq!(model.repair.is_some(), least(&plain.system) < 0.0);
        if let Some(repair) = model.repair {
            lifted += 1;
            assert!((repair.least_before - least(&plain.system)).abs() < 1e-6);
            assert!(repair.misfit[1] >= repair.misfit[0]);
        }
    }
    assert!(lifted > 0);
}

/// ln f of a minimum-phase f is analytic: its phase gives its magnitude, better with order.
#[test]
fn phase_gives_magnitude_up_to_a_factor() {
    let z = C64::from_polar(0.5, 1.0);
    let f = |t: f64| {
        let w = C64::from_polar(1.0, -t);
        (C64::new(1.0, 0.0) - w * 0.4) / ((C64::new(1.0, 0.0) - w * z) * (C64::new(1.0, 0.0) - w * z.conj()))
    };
    let theta: Vec<f64> = (0..80).map(|k| PI * (f64::from(k) + 0.5) / 80.0).collect();
    let phase: Vec<f64> = theta.iter().map(|t| f(*t).arg()).collect();
    let mut errors = Vec::new();
    for n in [3, 5, 8] {
        let found = magnitude_of_phase(&theta, &phase, &AnalyticSettings::new(n, 2 * n + 6)).unwrap();
        // f(∞) = 1: ln f has no mean
        errors
            .push(theta.iter().zip(&found).map(|(t, m)| (m / f(*t).norm() - 1.0).abs()).fold(0.0, f64::max));
    }
    println!("magnitude from phase: {errors:?}");
    assert!(errors[2] < 1e-4 && errors[2] < errors[1] && errors[1] < errors[0], "{errors:?}");
}
