//! Natural frequencies and damping ratios.

use washboard::cases;
use washboard::lti::Mode;
use washboard::vehicle::{LeftRight, Vehicle};

fn modes(v: &Vehicle) -> Vec<(Mode, String)> {
    v.modes().unwrap()
}

fn check(found: &[(Mode, String)], expected: &[(f64, f64)], half_digit_hz: f64, half_digit_percent: f64) {
    assert_eq!(found.len(), expected.len());
    for ((mode, label), (freq_hz, percent)) in found.iter().zip(expected) {
        assert!((mode.freq_hz - freq_hz).abs() <= half_digit_hz, "{label}: {} Hz, {freq_hz}", mode.freq_hz);
        let damping = 100.0 * mode.damping;
        assert!((damping - percent).abs() <= half_digit_percent, "{label}: {damping} %, {percent}");
    }
}

/// De Filippis et al., table 1 as printed; figures of an independent reference implementation.
#[test]
fn paper_table_1_as_printed() {
    let expected = [
        (1.06384, 27.968),
        (1.22148, 32.194),
        (1.29496, 34.286),
        (8.04421, 26.023),
        (8.12880, 27.808),
        (8.13387, 28.387),
        (8.20616, 25.347),
    ];
    check(&modes(&cases::vehicle("guiggiani-full-car").unwrap()), &expected, 0.5e-5 * 1.01, 0.5e-3 * 1.01);
}

/// De Filippis et al., figure 5: every digit and every name, with c = 0.0936 k.
#[test]
fn paper_figure_5() {
    let mut spec = cases::vehicle_spec("guiggiani-full-car").unwrap();
    let car = spec.full_car.as_mut().unwrap();
    car.front.suspension_damping_n_s_per_m = LeftRight::Both(0.0936 * 15750.0);
    car.rear.suspension_damping_n_s_per_m = LeftRight::Both(0.0936 * 14000.0);
    let found = modes(&spec.build_alone().unwrap());
    let expected = [
        (1.064, 27.954, "heave"),
        (1.221, 32.189, "roll"),
        (1.295, 34.295, "pitch"),
        (8.044, 26.031, "rear axle hop"),
        (8.129, 27.794, "front axle roll"),
        (8.134, 28.372, "front axle hop"),
        (8.207, 25.354, "rear axle roll"),
    ];
    let numbers: Vec<_> = expected.iter().map(|e| (e.0, e.1)).collect();
    check(&found, &numbers, 0.5e-3, 0.5e-3);
    for ((_, label), (_, _, name)) in found.iter().zip(expected) {
        assert_eq!(label, name);
    }
}

/// Türkay, section 4.1, at c_t = 0 and 0.1 c_s.
#[test]
fn thesis_quarter_car() {
    let mut spec = cases::vehicle_spec("turkay-quarter-car").unwrap();
    check(&modes(&spec.build_alone().unwrap()), &[(1.25065, 21.782), (11.02469, 20.126)], 5e-6, 5e-4);
    spec.quarter_car.as_mut().unwrap().tire_damping_n_s_per_m = 98.0;
    check(&modes(&spec.build_alone().unwrap()), &[(1.25042, 21.797), (11.02673, 22.085)], 5e-6, 5e-4);
}

/// Türkay, section 7.1.1: 0.99, 1.23 and 1.69 Hz are damped frequencies.
#[test]
fn thesis_full_car() {
    let found = modes(&cases::vehicle("chalasani-full-car").unwrap());
    for ((mode, _), printed) in found.iter().zip([0.988, 1.226, 1.688]) {
        assert!((mode.damped_hz - printed).abs() <= 5e-4, "{} Hz", mode.damped_hz);
    }
}
