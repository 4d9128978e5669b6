//! Samples without noise give the spectrum back, from the least number of them that theory allows.

use super::systems::{random_system, spectrum};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::PI;
use washboard::linalg::{C64, Mat};
use washboard::lti::{Discrete, StateSpace};
use washboard::subspace::{Route, Samples, SpectrumModel, SpectrumSettings, Weights, fit_spectrum};

fn sampled(g: &StateSpace<Discrete>, theta: &[f64]) -> Samples {
    let s = theta.iter().map(|t| spectrum(g, *t)).collect();
    Samples::new(theta.to_vec(), s, Weights::Equal).unwrap()
}

/// Largest error of the factor's spectrum between the samples, over the largest value.
fn error(model: &SpectrumModel, g: &StateSpace<Discrete>) -> f64 {
    let (mut worst, mut largest) = (0.0f64, 0.0f64);
    for k in 0..=500 {
        let theta = PI * f64::from(k) / 500.0;
        let (found, known) = (spectrum(&model.factor.system, theta), spectrum(g, theta));
        worst = worst.max((&found - &known).norm_max());
        largest = largest.max(known.norm_max());
    }
    worst / largest
}

#[test]
fn the_least_number_of_samples_is_enough() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut worst = [0.0f64; 3];
    for m in 1..=3 {
        for n in 1..=12 {
            let g = random_system(n, m, [0.5, 0.8], &mut rng);
            let p = if m == 1 { 2 * n + 1 } else { 2 * n.div_ceil(m) + 2 };
            // 2N ≥ p + 2n/m, none of them at 0 or π
            let count = (p * m + 2 * n).div_ceil(2 * m);
            let theta: Vec<f64> = (0..count).map(|k| PI * (k as f64 + 0.5) / count as f64).collect();
            let samples = sampled(&g, &theta);
            let model = fit_spectrum(&samples, &SpectrumSettings::new(n, p))
                .unwrap_or_else(|e| panic!("m = {m}, n = {n}: {e}"));
            let off = error(&model, &g);
            worst[m - 1] = worst[m - 1].max(off);
            assert!(off < 1e-9, "m = {m}, n = {n}: {off:e}");
            // stable and minimum phase
            assert!(model.factor.system.is_stable().unwrap());
            assert!(model.factor.zeros.iter().all(|z| z.norm() < 1.0));
            // one fewer is refused with the number
            let fewer = sampled(&g, &theta[1..]);
            let refused = fit_spectrum(&fewer, &SpectrumSettings::new(n, p));
            assert!(refused.is_err(), "m = {m}, n = {n}");
        }
    }
    println!("worst errors for m = 1, 2, 3: {worst:?}");
}

/// A resonance of half a per cent damping: the peak is 1e4 above the ground.
#[test]
fn a_sharp_peak_is_recovered() {
    for angle in [0.4f64, 1.5, 2.9] {
        let z = C64::from_polar((-0.005 * angle).exp(), angle);
        let a = Mat::from_fn(2, 2, |i, j| [[z.re, z.im], [-z.im, z.re]][i][j]);
        let g = StateSpace::discrete(
            a,
            Mat::from_fn(2, 1, |i, _| [1.0, 0.3][i]),
            Mat::from_fn(1, 2, |_, j| [0.5, -1.0][j]),
            Mat::identity(1, 1),
            1.0,
        )
        .unwrap();
        let theta: Vec<f64> = (0..40).map(|k| PI * (f64::from(k) + 0.5) / 40.0).collect();
        let model = fit_spectrum(&sampled(&g, &theta), &SpectrumSettings::new(2, 12)).unwrap();
        let off = error(&model, &g);
        assert!(off < 1e-9, "{angle}: {off:e}");
        let pole = model.factor.system.poles().unwrap();
        assert!(pole.iter().all(|p| (p.norm() - z.norm()).abs() < 1e-12), "{pole:?}");
    }
}

/// z⁻¹ chains have a pole at 0 whose inverse is not there; repeated poles have no eigenvectors.
#[test]
fn poles_at_zero_and_repeated_ones_are_recovered() {
    let jordan = |pole: f64, n: usize| {
        Mat::from_fn(n, n, |i, j| if i == j { pole } else { f64::from(u8::from(j == i + 1)) })
    };
    for (pole, n) in [(0.0, 1), (0.0, 2), (0.0, 3), (0.6, 2), (0.6, 3), (-0.5, 3)] {
        let b = Mat::from_fn(n, 1, |i, _| 1.0 / (1.0 + i as f64));
        let c = Mat::from_fn(1, n, |_, j| if j == 0 { 0.7 } else { 0.1 });
        let g = StateSpace::discrete(jordan(pole, n), b, c, Mat::from_fn(1, 1, |_, _| 1.5), 1.0).unwrap();
        let theta: Vec<f64> = (0..30).map(|k| PI * (f64::from(k) + 0.5) / 30.0).collect();
        let model = fit_spectrum(&sampled(&g, &theta), &SpectrumSettings::new(n, 10))
            .unwrap_or_else(|e| panic!("{pole} × {n}: {e}"));
        let off = error(&model, &g);
        assert!(off < 1e-9, "{pole} × {n}: {off:e}");
    }
}

/// The route by moments gives what the orthogonal one gives, and is left where it would not.
#[test]
fn moments_agree_with_orthogonal_factors() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let mut by_moments = 0;
    for trial in 0..20 {
        let g = random_system(4, 1, [0.5, 0.9], &mut rng);
        let count = 300;
        let theta: Vec<f64> =
            (0..count).map(|k| PI * (f64::from(k) + rng.random_range(0.2..0.8)) / f64::from(count)).collect();
        let values: Vec<f64> = theta
            .iter()
            .map(|t| spectrum(&g, *t)[(0, 0)].re * (1.0 + 0.01 * rng.random_range(-1.0..1.0)))
            .collect();
        let weights = if trial % 2 == 0 {
            Weights::Equal
        } else {
            Weights::Variances(values.iter().map(|v| v * v).collect())
        };
        let samples = Samples::scalar(theta, &values, weights).unwrap();
        let settings = SpectrumSettings::new(4, 40);
        let fast = fit_spectrum(&samples, &settings).unwrap();
        let sure = fit_spectrum(&samples, &SpectrumSettings { moments: false, ..settings }).unwrap();
        assert_eq!(sure.route, Route::Orthogonal);
        by_moments += usize::from(fast.route == Route::Moments);
        for k in 0..=100 {
            let theta = PI * f64::from(k) / 100.0;
            let (x, y) = (fast.summand.at(theta).unwrap(), sure.summand.at(theta).unwrap());
            let largest = values.iter().copied().fold(0.0, f64::max);
            assert!((x - y).norm_max() < 1e-10 * largest, "{trial}");
        }
    }
    println!("{by_moments} of 20 by moments");
    assert!(by_moments >= 15, "{by_moments}");
}
