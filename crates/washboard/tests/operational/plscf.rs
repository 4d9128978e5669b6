//! p-LSCF: exact spectra give exact poles, known modes are recovered, both images of a pole are one mode.

use crate::structure::Structure;
use washboard::identify::{
    Constraint, HalfSpectra, PlscfOutcome, PlscfSettings, PlscfSpectrum, PoleStatus, plscf, plscf_poles,
};
use washboard::linalg::C64;

const SAMPLES: usize = 36_000;
const NOISE: f64 = 0.05;
/// What normal equations keep of sixteen digits for four modes of one to ten per cent: asked for is 1e-6.
const EXACT: f64 = 1e-7;

/// Half spectra of the structure in closed form at lines from `low` to `high` Hz.
fn analytic(structure: &Structure, beta: f64, low: f64, high: f64) -> HalfSpectra {
    const LINES: usize = 201;
    let freq_hz: Vec<f64> = (0..LINES).map(|k| low + (high - low) * k as f64 / (LINES - 1) as f64).collect();
    let values = freq_hz.iter().map(|f| structure.half_spectrum(*f, beta)).collect();
    HalfSpectra { rate_hz: structure.rate_hz, freq_hz, values }
}

fn found(seed: u64, settings: &PlscfSettings) -> PlscfOutcome {
    let structure = Structure::mixed();
    plscf(&structure.simulate(seed, SAMPLES, NOISE), structure.rate_hz, settings).unwrap()
}

#[test]
fn exact_spectra_give_exact_poles() {
    let structure = Structure::mixed();
    for (low, high) in [(0.0, 20.0), (0.5, 14.0)] {
        for constraint in [Constraint::Lowest, Constraint::Highest] {
            // four channels × order 2 are the eight poles
            let poles = plscf_poles(&analytic(&structure, 0.0, low, high), 2, constraint).unwrap();
            assert_eq!(poles.len(), structure.modes.len());
            for (k, pole) in poles.iter().enumerate() {
                let error = (pole - structure.pole(k)).norm() / structure.pole(k).norm();
                assert!(error < EXACT, "{constraint:?}, {low}–{high} Hz, mode {k}: {error:.1e}");
            }
        }
    }
}

#[test]
fn an_exponential_lag_window_adds_its_damping_and_nothing_else() {
    let (structure, beta) = (Structure::mixed(), 0.02);
    let poles = plscf_poles(&analytic(&structure, beta, 0.0, 20.0), 2, Constraint::Lowest).unwrap();
    for (k, pole) in poles.iter().enumerate() {
        let expected = structure.pole(k) - beta * structure.rate_hz;
        assert!((pole - expected).norm() < EXACT * expected.norm(), "mode {k}: {pole} for {expected}");
    }
}

#[test]
fn the_windows_damping_is_taken_out_of_the_modes() {
    let with = |window_end| found(3, &PlscfSettings { window_end, ..PlscfSettings::default() });
    let (light, heavy) = (with(0.1), with(0.0001));
    let added = |end: f64| -f64::ln(end) / 256.0 * 40.0;
    for (k, (a, b)) in light.modes.iter().zip(&heavy.modes).enumerate() {
        let omega = std::f64::consts::TAU * a.freq_hz;
        let left_in = (added(0.0001) - added(0.1)) / omega;
        // two weightings of the same lags: what they differ by is less than one estimate's error
        let allowed = 2.0 * b.damping_sd.unwrap();
        assert!((a.damping - b.damping).abs() < allowed, "mode {k}: {} {}", a.damping, b.damping);
        assert!(
            left_in > 1.5 * allowed || k == 3,
            "mode {k}: the test would not see it: {left_in} {allowed}"
        );
    }
    assert_eq!((light.modes.len(), heavy.modes.len()), (4, 4));
}

#[test]
fn known_modes_are_recovered() {
    let structure = Structure::mixed();
    for seed in 0..5 {
        let outcome = found(seed, &PlscfSettings::default());
        for (k, (f, zeta)) in structure.modes.iter().enumerate() {
            let near = |f0: f64| (f0 / f - 1.0).abs() < 0.02;
            let mode = outcome.modes.iter().find(|m| near(m.freq_hz)).unwrap();
            let (f_sd, zeta_sd) = (mode.freq_sd_hz.unwrap(), mode.damping_sd.unwrap());
            // forty numbers: the chance that one of them is off by four standard deviations is below 1 %
            assert!((mode.freq_hz - f).abs() < 4.0 * f_sd, "seed {seed}: {mode:?}");
            assert!((mode.damping - zeta).abs() < 4.0 * zeta_sd, "seed {seed}: {mode:?}");
            assert!(f_sd < 0.01 * f && zeta_sd < 0.01, "seed {seed}: {mode:?}");
            let mac = structure.mac(k, &mode.shape);
            assert!(mac > 0.995, "seed {seed}, mode {k}: MAC {mac}");
            assert!(mode.phase_collinearity > 0.98 && mode.mean_phase_deg.abs() < 5.0, "{mode:?}");
        }
        // a chance bump may pass once in some records
        assert!(outcome.modes.len() <= 5, "seed {seed}");
    }
}

#[test]
fn every_pole_is_accounted_for() {
    let outcome = found(0, &PlscfSettings { max_order: 20, ..PlscfSettings::default() });
    let kept: usize = outcome.modes.iter().map(|m| m.orders).sum();
    let left: usize = outcome.rejected.iter().map(|r| r.poles).sum();
    assert_eq!(kept + left, outcome.diagram.poles.len());
    assert_eq!(outcome.factorisations, 1 + 2 * 20);
    for order in &outcome.diagram.orders {
        let here = outcome.diagram.poles.iter().filter(|p| p.order == *order);
        let nyquist = std::f64::consts::PI * 40.0;
        let real = |p: &[f64; 2]| p[1] == 0.0 || (p[1] - nyquist).abs() < 1e-9 * nyquist;
        let degree: usize = here.map(|p| if real(&p.pole) { 1 } else { 2 }).sum();
        assert_eq!(degree, 4 * order, "order {order}: four channels");
    }
    assert!(!serde_json::to_string(&outcome).unwrap().contains("null"));
}

#[test]
fn full_spectra_have_mirror_images_and_the_same_modes() {
    let half = found(1, &PlscfSettings::default());
    let full = found(1, &PlscfSettings { spectrum: PlscfSpectrum::Full, ..PlscfSettings::default() });
    assert_eq!((half.modes.len(), full.modes.len()), (4, 4));
    for (a, b) in half.modes.iter().zip(&full.modes) {
        // two estimates from one record
        assert!((a.freq_hz - b.freq_hz).abs() < 2.0 * a.freq_sd_hz.unwrap(), "{} {}", a.freq_hz, b.freq_hz);
        assert!((a.damping - b.damping).abs() < 2.0 * a.damping_sd.unwrap(), "{} {}", a.damping, b.damping);
    }
    let mirrors =
        |o: &PlscfOutcome| o.diagram.poles.iter().filter(|p| p.status == PoleStatus::Mirror).count();
    assert_eq!(mirrors(&half), 0);
    assert!(mirrors(&full) > 2 * full.diagram.orders.len(), "{}", mirrors(&full));
    assert!(full.diagram.poles.iter().filter(|p| p.stable()).all(|p| p.pole[0] < 0.0));
}

#[test]
fn the_constraint_that_is_the_default_drives_mathematical_poles_out() {
    let growing = |constraint| {
        let outcome = found(2, &PlscfSettings { constraint, max_order: 20, ..PlscfSettings::default() });
        let growing = outcome.diagram.poles.iter().filter(|p| p.status == PoleStatus::Growing).count();
        growing as f64 / outcome.diagram.poles.len() as f64
    };
    let (lowest, highest) = (growing(Constraint::Lowest), growing(Constraint::Highest));
    assert!(lowest > 0.7 && highest < 0.2, "{lowest} {highest}");
}

#[test]
fn units_and_threads_do_not_matter() {
    let structure = Structure::mixed();
    let channels = structure.simulate(1, SAMPLES, NOISE);
    let settings = PlscfSettings { max_order: 20, ..PlscfSettings::default() };
    let run = |x: &[Vec<f64>]| plscf(x, structure.rate_hz, &settings).unwrap();
    let plain = run(&channels);
    let mut counts = channels.clone();
    counts[2].iter_mut().for_each(|v| *v = 2048.0 * *v + 100.0);
    let scaled = run(&counts);
    assert_eq!(plain.modes.len(), scaled.modes.len());
    for (a, b) in plain.modes.iter().zip(&scaled.modes) {
        // rounding of the rms division times the condition of the normal equations
        assert!((a.freq_hz / b.freq_hz - 1.0).abs() < 1e-8 && (a.damping - b.damping).abs() < 1e-8);
        let size = |m: &washboard::identify::Mode, c: usize| C64::new(m.shape[c].re, m.shape[c].im).norm();
        let ratio = size(b, 2) / size(b, 0) / (size(a, 2) / size(a, 0));
        assert!((ratio / 2048.0 - 1.0).abs() < 1e-6, "shapes keep the channel's unit: {ratio}");
    }
    let pool = |n| rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
    assert!(pool(1).install(|| run(&channels)) == pool(3).install(|| run(&channels)));
}
