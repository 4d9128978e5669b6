//! SSI-cov on systems simulated exactly: what is known is recovered, heavily damped modes included.

#![allow(clippy::unwrap_used)]

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::TAU;
use washboard::identify::{SsiOutcome, SsiSettings, StabilitySettings, ssi_cov};
use washboard::linalg::{C64, Mat, expm, lyapunov};

const RATE_HZ: f64 = 40.0;
const SAMPLES: usize = 60_000;
/// (Hz, damping ratio): a car body's pitch, a light and a medium mode, a wheel hop's damping.
const MODES: [(f64, f64); 4] = [(1.2, 0.30), (2.3, 0.02), (6.0, 0.05), (9.0, 0.12)];
/// Displacements of five places in these modes.
const SHAPES: [[f64; 4]; 5] = [
    [1.0, 0.5, 1.0, -0.7],
    [0.8, -1.0, -0.6, 1.0],
    [0.3, 0.9, -1.0, 0.2],
    [-0.5, 0.4, 0.8, 0.9],
    [-0.9, -0.7, 0.2, -0.5],
];
/// Efficient standard deviations allowed. SSI weighs all lags alike: over twelve seeds its rms error is 1 to 3.3
/// of them (the 9 Hz mode, which decays in a tenth of the lags); 10 is three times that.
const SIGMAS: f64 = 10.0;

/// Standard deviations of f/f and of ζ that an efficient estimator has after T seconds of a mode alone under white
/// noise: √(ζ/4πfT) and √(ζ/2πfT), from the Fisher information of a lightly damped resonance.
fn sigma(f: f64, zeta: f64) -> (f64, f64) {
    let cycles = f * SAMPLES as f64 / RATE_HZ;
    ((zeta / (2.0 * TAU * cycles)).sqrt(), (zeta / (TAU * cycles)).sqrt())
}

/// Channels under unit white noise on every mode, with 1 % sensor noise, from the stationary state.
///
/// x⁺ = F x + w exactly: F = e^{Ah}, cov w = P − F P Fᵀ with A P + P Aᵀ + B Bᵀ = 0.
fn simulate(seed: u64) -> Vec<Vec<f64>> {
    let n = 2 * MODES.len();
    let (mut a, mut q) = (Mat::zeros(n, n), Mat::zeros(n, n));
    for (k, (f, zeta)) in MODES.iter().enumerate() {
        let omega = TAU * f;
        a[(2 * k, 2 * k + 1)] = 1.0;
        a[(2 * k + 1, 2 * k)] = -omega * omega;
        a[(2 * k + 1, 2 * k + 1)] = -2.0 * zeta * omega;
        q[(2 * k + 1, 2 * k + 1)] = 4.0 * zeta * omega.powi(3); // unit variance of every modal displacement
    }
    let p = lyapunov(&a, &q).unwrap().x;
    let step = expm(&(&a * faer::Scale(1.0 / RATE_HZ))).unwrap();
    let noise = &p - &step * &p * step.transpose();
    check_noise_covariance(&a, &q, &noise);
    let root = noise.llt(faer::Side::Lower).unwrap().L().to_owned();
    let start = p.llt(faer::Side::Lower).unwrap().L().to_owned();
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut normal =
        |count: usize| Mat::from_fn(count, 1, |_, _| Distribution::<f64>::sample(&StandardNormal, &mut rng));
    let mut x = start * normal(n);
    let mut channels = vec![Vec::with_capacity(SAMPLES); SHAPES.len()];
    for _ in 0..SAMPLES {
        let sensor = normal(SHAPES.len());
        for (c, channel) in channels.iter_mut().enumerate() {
            let y: f64 = (0..MODES.len()).map(|k| SHAPES[c][k] * x[(2 * k, 0)]).sum();
            channel.push(y + 0.01 * sensor[(c, 0)]);
        }
        x = &step * x + &root * normal(n);
    }
    channels
}

/// Van Loan's integral ∫₀^h e^{As} Q e^{Aᵀs} ds, the other route to the step's noise.
fn check_noise_covariance(a: &Mat, q: &Mat, noise: &Mat) {
    let n = a.nrows();
    let h = 1.0 / RATE_HZ;
    let block = Mat::from_fn(2 * n, 2 * n, |i, j| {
        h * match (i < n, j < n) {
            (true, true) => -a[(i, j)],
            (true, false) => q[(i, j - n)],
            (false, true) => 0.0,
            (false, false) => a[(j - n, i - n)],
        }
    });
    let e = expm(&block).unwrap();
    let other = e.submatrix(n, n, n, n).transpose() * e.submatrix(0, n, n, n);
    assert!((&other - noise).norm_l2() < 1e-9 * noise.norm_l2());
}

fn settings() -> SsiSettings {
    SsiSettings { block_rows: 40, max_order: 40, ..SsiSettings::default() }
}

fn mac(found: &washboard::identify::Mode, k: usize) -> f64 {
    let (mut re, mut im, mut one, mut other) = (0.0, 0.0, 0.0, 0.0);
    for s in &found.shape {
        let truth = SHAPES[s.channel][k];
        re += s.re * truth;
        im += s.im * truth;
        one += s.re * s.re + s.im * s.im;
        other += truth * truth;
    }
    (re * re + im * im) / (one * other)
}

#[test]
fn known_modes_are_recovered_and_no_other() {
    for seed in 0..10 {
        let outcome = ssi_cov(&simulate(seed), RATE_HZ, &settings()).unwrap();
        let found: Vec<_> = outcome.modes.iter().map(|m| (m.freq_hz, m.damping, m.orders)).collect();
        assert_eq!(found.len(), MODES.len(), "seed {seed}: {found:?}");
        for (k, (mode, (f, zeta))) in outcome.modes.iter().zip(MODES).enumerate() {
            let (f_sigma, zeta_sigma) = sigma(f, zeta);
            let (df, dz) = ((mode.freq_hz / f - 1.0) / f_sigma, (mode.damping - zeta) / zeta_sigma);
            assert!(df.abs() < SIGMAS, "seed {seed}: {mode:?}");
            assert!(dz.abs() < SIGMAS, "seed {seed}: {mode:?}");
            assert!(mac(mode, k) > 0.99, "seed {seed}, mode {k}: MAC {}", mac(mode, k));
            let omega = mode.pole[0].hypot(mode.pole[1]);
            assert!((omega / TAU - mode.freq_hz).abs() < 1e-12 * omega);
            assert!((-mode.pole[0] / omega - mode.damping).abs() < 1e-12);
        }
    }
}

#[test]
fn every_pole_is_accounted_for() {
    let outcome = ssi_cov(&simulate(5), RATE_HZ, &settings()).unwrap();
    let kept: usize = outcome.modes.iter().map(|m| m.orders).sum();
    let left: usize = outcome.rejected.iter().map(|r| r.poles).sum();
    assert_eq!(kept + left, outcome.diagram.poles.len());
    // and the diagram has every pole: at each order, pairs count two
    for order in &outcome.diagram.orders {
        let here = outcome.diagram.poles.iter().filter(|p| p.order == *order);
        let degree: usize = here.map(|p| if p.pole[1] == 0.0 || p.damping == 1.0 { 1 } else { 2 }).sum();
        // a real pole with negative μ has Im λ at the Nyquist frequency, and is one root
        let folded = outcome
            .diagram
            .poles
            .iter()
            .filter(|p| p.order == *order && (p.pole[1] / RATE_HZ - std::f64::consts::PI).abs() < 1e-12);
        assert_eq!(degree - folded.count(), *order, "order {order}");
    }
    let json = serde_json::to_string(&outcome).unwrap();
    assert!(!json.contains("null"), "a number that JSON can't say");
    let back: SsiOutcome = serde_json::from_str(&json).unwrap();
    assert_eq!((back.modes.len(), back.rejected.len()), (outcome.modes.len(), outcome.rejected.len()));
    assert!(outcome.rejected.iter().all(|r| r.poles > 0 && !r.why.is_empty() && r.freq_hz.is_finite()));
}

/// The outcomes agree in what can't depend on units and order. A relative difference of rounding, times the
/// condition of the poles, is what the rms division leaves.
fn assert_same_modes(one: &SsiOutcome, other: &SsiOutcome) {
    assert_eq!(one.modes.len(), other.modes.len());
    for (a, b) in one.modes.iter().zip(&other.modes) {
        assert!((a.freq_hz / b.freq_hz - 1.0).abs() < 1e-8, "{} {}", a.freq_hz, b.freq_hz);
        assert!((a.damping - b.damping).abs() < 1e-8, "{} {}", a.damping, b.damping);
        assert_eq!(a.orders, b.orders);
    }
}

/// A shape is C ψ, so a channel that repeats another d samples later has μ^{−d} of its component: it lags. (The
/// correlations transposed give the same poles but a leading shape.)
#[test]
fn a_later_copy_lags_in_the_shape() {
    const LATER: usize = 3;
    let source = simulate(4).swap_remove(1);
    let early = source[LATER..].to_vec();
    let late = source[..source.len() - LATER].to_vec();
    let outcome = ssi_cov(&[early, late], RATE_HZ, &settings()).unwrap();
    let light = outcome.modes.iter().find(|m| (m.freq_hz - MODES[1].0).abs() < 0.1).unwrap();
    let one = C64::new(light.shape[0].re, light.shape[0].im);
    let other = C64::new(light.shape[1].re, light.shape[1].im);
    let lambda = C64::new(light.pole[0], light.pole[1]);
    let expected = (-lambda * (LATER as f64 / RATE_HZ)).exp();
    assert!((other / one - expected).norm() < 0.05, "{} for {expected}", other / one);
}

#[test]
fn channel_order_and_units_do_not_matter() {
    let channels = simulate(1);
    let plain = ssi_cov(&channels, RATE_HZ, &settings()).unwrap();
    let mut turned = channels.clone();
    turned.rotate_left(2);
    assert_same_modes(&plain, &ssi_cov(&turned, RATE_HZ, &settings()).unwrap());
    let mut scaled = channels.clone();
    // a channel in counts with an offset
    scaled[3].iter_mut().for_each(|v| *v = 2048.0 * *v + 100.0);
    let counts = ssi_cov(&scaled, RATE_HZ, &settings()).unwrap();
    assert_same_modes(&plain, &counts);
    for (a, b) in plain.modes.iter().zip(&counts.modes) {
        let ratio = |m: &washboard::identify::Mode| {
            let (x, y) = (&m.shape[3], &m.shape[0]);
            (x.re.hypot(x.im)) / (y.re.hypot(y.im))
        };
        assert!((ratio(b) / ratio(a) / 2048.0 - 1.0).abs() < 1e-6, "shapes keep the channel's unit");
    }
}

#[test]
fn settings_without_meaning_are_refused() {
    let channels = vec![(0..2000).map(|t| f64::from(t * t % 17)).collect::<Vec<_>>(); 1];
    let refused = |settings: SsiSettings| ssi_cov(&channels, 10.0, &settings).unwrap_err().to_string();
    let defaults = SsiSettings::default;
    assert!(refused(defaults()).starts_with("max_order: expected an even number up to"));
    assert!(refused(SsiSettings { max_order: 7, ..defaults() }).starts_with("max_order"));
    assert!(refused(SsiSettings { max_order: 10, min_order: 12, ..defaults() }).starts_with("min_order"));
    let band = SsiSettings {
        max_order: 10,
        stability: StabilitySettings { band_hz: Some([1.0, 6.0]), ..StabilitySettings::default() },
        ..defaults()
    };
    assert!(refused(band).starts_with("band_hz"));
    let flat = vec![vec![9.81; 2000]];
    let small = SsiSettings { max_order: 10, ..defaults() };
    assert!(ssi_cov(&flat, 10.0, &small).unwrap_err().to_string().starts_with("channel 0 is constant"));
    assert!(ssi_cov(&[vec![1.0, 2.0, 1.0]], 10.0, &small).is_err());
    assert!(ssi_cov(&channels, f64::NAN, &small).is_err());
}
