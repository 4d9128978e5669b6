//! Functions from a part of them.

use super::folder::{Folder, grid};
use std::fmt::Write;
use std::path::PathBuf;
use washboard::linalg::C64;
use washboard::study::{RoadAnalyticSpec, road_analytic};

/// f(s) = (s + 2)(s + 5)/(s² + 2s + 4), over frequency: imaginary from real part, magnitude from phase, phase from magnitude.
#[test]
fn analytic_functions_come_from_a_part_of_them() {
    let folder = Folder::new("analytic");
    let f = |w: f64| {
        let s = C64::new(0.0, w);
        (s + 2.0) * (s + 5.0) / (s * s + s * 2.0 + 4.0)
    };
    let omega = grid(0.02, 200.0, 60);
    let run = |column: &str, of: &dyn Fn(C64) -> f64, order: usize| {
        let mut text = format!("omega_rad_s,{column}\n");
        for w in &omega {
            writeln!(text, "{w},{:e}", of(f(*w))).unwrap();
        }
        let data = PathBuf::from(folder.file("D.csv", &text));
        let spec = RoadAnalyticSpec {
            data,
            order,
            block_rows: None,
            lambda_rad: Some(2.0),
            positive: false,
            output: Some(folder.0.join("O.csv")),
            overwrite: false,
        };
        road_analytic(&spec).unwrap()
    };
    let real = run("real", &|z| z.re, 2);
    for (w, imag) in omega.iter().zip(&real.outcome.samples.imag) {
        assert!((imag - f(*w).im).abs() < 1e-8, "{w}: {imag} {}", f(*w).im);
    }
    assert!(real.outcome.rms_error < 1e-9 && real.outcome.system == "f");
    assert!(String::from_utf8(real.file.unwrap().1).unwrap().starts_with("theta_rad,given_real,real,imag,"));
    // f is 0 at z = ∞ only up to a constant, which an imaginary part does not show
    let imag = run("imag", &|z| z.im, 2).outcome;
    let constant = f(omega[30]).re - imag.samples.real[30];
    for (w, re) in omega.iter().zip(&imag.samples.real) {
        assert!((re + constant - f(*w).re).abs() < 1e-8, "{w}");
    }
    // the logarithm is not rational: an approximation that follows the magnitude to a per cent, up to a factor
    let magnitude = run("magnitude", &|z| z.norm(), 12).outcome;
    let phase = run("phase_rad", &|z| z.arg(), 12).outcome;
    let factor = f(omega[30]).norm() / phase.samples.magnitude[30];
    let (mut worst_phase, mut worst_size) = (0.0f64, 0.0f64);
    for (k, w) in omega.iter().enumerate().filter(|(_, w)| (0.1..40.0).contains(*w)) {
        worst_phase = worst_phase.max((magnitude.samples.phase_rad[k] - f(*w).arg()).abs());
        worst_size = worst_size.max((phase.samples.magnitude[k] * factor / f(*w).norm()).ln().abs());
    }
    println!("phase from magnitude: {worst_phase:.2e} rad; magnitude from phase: {worst_size:.2e}");
    assert!(worst_phase < 0.01 && worst_size < 0.01, "{worst_phase} {worst_size}");
    assert!(magnitude.system == "ln f" && magnitude.notes.iter().any(|n| n.name == "minimum-phase"));
    for (text, part) in [
        ("theta_rad,real\n0,1\n4,1\n", ":3: column theta_rad: expected angles from 0 to pi, found 4"),
        (
            "omega_rad_s,phase_rad\n0,0\n1,-3\n2,3\n",
            ":4: column phase_rad: expected a continuous phase, found 3 after -3",
        ),
        ("omega_rad_s,magnitude\n0,1\n1,0\n", ":3: column magnitude: expected a number above 0"),
        ("omega_rad_s,real,imag\n0,1,1\n", "one of the columns real, imag"),
        ("omega_rad_s,real\n0,1\n1,2\n", "needed"),
    ] {
        let data = PathBuf::from(folder.file("E.csv", text));
        let spec = RoadAnalyticSpec {
            data,
            order: 3,
            block_rows: None,
            lambda_rad: None,
            positive: false,
            output: None,
            overwrite: false,
        };
        let e = road_analytic(&spec).unwrap_err();
        assert!(
            e.is_wrong_input() && (part == "needed" || e.to_string().contains(part)),
            "{e} should have {part:?}"
        );
    }
}
