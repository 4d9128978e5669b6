//! Data that are no road, no function or no bound: a message with the field and the numbers, or the right answer.

use super::folder::{Folder, fit, grid, source};
use std::fmt::Write;
use std::path::PathBuf;
use washboard::linalg::C64;
use washboard::study::{
    FitWeight, InterpolateSpec, RoadAnalyticSpec, RoadFitSpec, StudyError, interpolate_file, road_analytic,
};

fn profile(height: impl Fn(f64) -> f64) -> String {
    (0..2000).fold("x_m,h_m\n".to_owned(), |mut text, k| {
        let x = 0.1 * f64::from(k);
        writeln!(text, "{x},{}", height(x)).unwrap();
        text
    })
}

fn spectrum(density: impl Fn(f64) -> f64) -> String {
    grid(0.05, 30.0, 80).iter().fold("omega_rad_s,psd\n".to_owned(), |mut text, w| {
        writeln!(text, "{w},{:e}", density(*w)).unwrap();
        text
    })
}

fn refused(e: &StudyError, part: &str) {
    assert!(e.is_wrong_input() && e.to_string().contains(part), "{e} should have {part:?}");
}

#[test]
fn profiles_without_a_spectrum_are_refused() {
    let folder = Folder::new("degenerate-profiles");
    for (text, segment_m, part) in [
        (profile(|x| 0.02 * x), None, "column h_m: expected heights that leave a straight line"),
        (profile(|_| 5.0), None, "column h_m: expected heights that leave a straight line"),
        (profile(|_| 0.0), None, "column h_m: expected heights that leave a straight line"),
        (profile(|x| 1e200 * x.sin()), None, "column h_m: expected heights below 1e100 m"),
        (
            profile(f64::sin),
            Some(300.0),
            "segment_m: expected at most the profile's length, 199.9 m, found 300",
        ),
        (profile(f64::sin), Some(0.0), "segment_m: expected a positive number, found 0"),
    ] {
        let e = fit(RoadFitSpec { segment_m, ..source(folder.file("P.csv", &text)) }).unwrap_err();
        refused(&e, part);
    }
}

#[test]
fn spectra_without_power_are_refused_and_any_unit_is_one() {
    let folder = Folder::new("degenerate-spectra");
    let spec = |text: &str, weight, p| RoadFitSpec {
        order: Some(1),
        weight,
        block_rows: p,
        ..source(folder.file("S.csv", text))
    };
    let law = |w: f64| 1.0 / (w * w + 1.0);
    let zero = spectrum(|_| 0.0);
    let gap = spectrum(|w| if (1.0..2.0).contains(&w) { 0.0 } else { law(w) });
    let channel = spectrum(law).replace("psd\n", "psd_11,psd_12_re,psd_12_im,psd_22\n");
    let channel = channel.replace('\n', ",0,0,0\n").replacen(",0,0,0\n", "\n", 1);
    for (text, weight, p, part) in [
        (&zero, None, None, "column psd: expected densities above 0, found 0 in all 80 rows"),
        (
            &zero,
            Some(FitWeight::None),
            None,
            "column psd: expected densities above 0, found 0 in all 80 rows",
        ),
        (&gap, None, None, "S.csv:39: expected a density above 0, which relative weights need, found 0"),
        (&channel, None, None, "column psd_22: expected densities above 0, found 0 in all 80 rows"),
        (&spectrum(law), None, Some(1), "p: expected 3 or more, (2 order)/1 + 1 of order 1, found 1"),
    ] {
        refused(&fit(spec(text, weight, p)).unwrap_err(), part);
    }
    // the gap is data to equal weights
    assert!(fit(spec(&gap, Some(FitWeight::None), None)).unwrap().log10_rms_error.is_finite());
    for size in [1e-290, 1e-200, 1.0, 1e200, 1e300] {
        let found = fit(spec(&spectrum(|w| size * law(w)), None, None)).unwrap();
        let gain = found.gain.unwrap() / size.sqrt();
        assert!((gain - 1.0).abs() < 1e-9 && (found.poles[0][0] + 1.0).abs() < 1e-9, "{size:e}: {gain}");
        assert!(found.log10_max_error < 1e-9 && found.spectrum.given[0] > 0.9 * size);
    }
}

#[test]
fn one_value_is_no_function() {
    let folder = Folder::new("degenerate-analytic");
    let run = |column: &str, value: &dyn Fn(f64) -> f64| {
        let text = (0..40).fold(format!("theta_rad,{column}\n"), |mut text, k| {
            let theta = std::f64::consts::PI * (f64::from(k) + 0.5) / 40.0;
            writeln!(text, "{theta},{:e}", value(theta)).unwrap();
            text
        });
        road_analytic(&RoadAnalyticSpec {
            data: PathBuf::from(folder.file("A.csv", &text)),
            order: 1,
            block_rows: None,
            lambda_rad: None,
            positive: false,
            output: None,
            overwrite: false,
        })
    };
    for (column, value) in
        [("real", 0.0), ("real", 3.0), ("imag", 0.0), ("magnitude", 1.0), ("phase_rad", 0.0)]
    {
        let e = run(column, &|_| value).unwrap_err();
        refused(
            &e,
            &format!(
                "column {column}: expected values that vary, above 1e-290, found {value:?} in all 40 rows"
            ),
        );
    }
    // Re 1/z = cos θ
    for size in [1e-200, 1e200] {
        let found = run("real", &|t| size * t.cos()).unwrap().outcome;
        let imag = found.samples.imag[10] / -(size * found.samples.theta_rad[10].sin());
        assert!((imag - 1.0).abs() < 1e-9 && found.rms_error < 1e-12 * found.rms_given, "{size:e}: {imag}");
    }
}

#[test]
fn interpolation_answers_what_is_wrong_and_what_is_trivial() {
    let folder = Folder::new("degenerate-interpolation");
    let run = |text: &str| {
        interpolate_file(&InterpolateSpec { data: PathBuf::from(folder.file("d.json", text)) }).map(|f| f.0)
    };
    let nodes = |values: [f64; 3], more: &str| {
        let one = |(k, v): (usize, &f64)| format!("{{\"z\": [{}, 0], \"values\": [[[[{v:e}, 0]]]]}}", k + 2);
        let rows: Vec<String> = values.iter().enumerate().map(one).collect();
        format!("{{\"domain\": \"disk\",\n\"nodes\": [{}]{more}}}", rows.join(",\n"))
    };
    let any = [1.0, 0.5, 0.25];
    let off = |z: &str| {
        format!(
            "{{\"domain\": \"disk\", \"order\": 1, \"measured\": [{{\"z\": [1, 0], \"value\": [[[1, 0]]]}}, {{\"z\": {z}, \"value\": [[[1, 0]]]}}]}}"
        )
    };
    for (text, part) in [
        (nodes(any, ", \"bound\": 0"), "bound: expected a number above 0 or \"least\", found 0"),
        (nodes(any, ", \"bound\": -1"), "bound: expected a number above 0 or \"least\", found -1"),
        (nodes(any, ", \"bound\": 1e300"), "bound: expected at most 1e8 times the least, 2.97"),
        (nodes(any, ", \"bound\": [1]"), "d.json:4: bound"),
        (nodes(any, "").replace("[3, 0]", "3"), "d.json:3: nodes[1].z: expected [re, im] or \"infinity\""),
        (off("[0, 2]"), "measured value 1: 0 + 2i is 1e0 off the unit circle"),
        (
            off("[0.001, 2]")
                .replace("\"disk\"", "\"half-plane\", \"lambda\": 1")
                .replace("[1, 0], \"v", "[0, 1], \"v"),
            "measured value 1: 0.001 + 2i is 1e-3 off the imaginary axis",
        ),
        (off("[0, 0.999999]"), "measured value 1: 0 + 0.999999i is"),
    ] {
        refused(&run(&text).unwrap_err(), part);
    }
    let e = run(&nodes(any, ", \"bound\": 1e-300")).unwrap_err();
    assert!(!e.is_wrong_input() && e.to_string().contains("bound 1e-300: no stable function"), "{e}");
    // constants, of any size, with and without a bound, and a byte order mark
    for size in [0.0, 0.5, 1e-200, 1e200] {
        for (text, bounded) in
            [(nodes([size; 3], ""), false), (nodes([size; 3], ", \"bound\": \"least\""), true)]
        {
            let found = run(&format!("\u{feff}{text}")).unwrap();
            assert_eq!(
                (found.order, found.d[0][0] == size || found.max_error.unwrap() < 1e-14),
                (0, true),
                "{size:e}"
            );
            assert_eq!(
                found.bound.map(|b| (b[0] / size - 1.0).abs() < 1e-12 || size == 0.0),
                bounded.then_some(true)
            );
        }
    }
}

/// A fit of measurements alone has no error at constraints, and tells its residual: that of its own A, B, C, D.
#[test]
fn a_fit_of_measurements_tells_its_residual() {
    let folder = Folder::new("measured");
    let run = |noise: f64| {
        let row = |k: usize| {
            let z = C64::from_polar(1.0, 0.25 * k as f64);
            let g = (z - 0.5).inv() + noise * (1.7 * k as f64).sin();
            (z, g, format!("{{\"z\": [{}, {}], \"value\": [[[{}, {}]]]}}", z.re, z.im, g.re, g.im))
        };
        let rows: Vec<_> = (1..=12).map(row).collect();
        let listed: Vec<&str> = rows.iter().map(|r| r.2.as_str()).collect();
        let text = format!("{{\"domain\": \"disk\", \"order\": 1, \"measured\": [{}]}}", listed.join(", "));
        let spec = InterpolateSpec { data: PathBuf::from(folder.file("m.json", &text)) };
        let found = interpolate_file(&spec).unwrap().0;
        let (a, b, c, d) = (found.a[0][0], found.b[0][0], found.c[0][0], found.d[0][0]);
        let off: f64 = rows.iter().map(|(z, g, _)| ((z - a).inv() * (b * c) + d - g).norm_sqr()).sum();
        let size: f64 = rows.iter().map(|r| r.1.norm_sqr()).sum();
        (found.max_error, found.measured_rms_error.unwrap(), (off / size).sqrt())
    };
    let (error, exact, _) = run(0.0);
    assert!(error.is_none() && exact < 1e-12, "{exact:e}");
    let (_, noisy, own) = run(0.1);
    assert!(noisy > 0.01 && (noisy / own - 1.0).abs() < 1e-9, "{noisy} {own}");
}
