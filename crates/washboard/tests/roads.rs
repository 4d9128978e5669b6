//! Roads from data: spectra and profiles from files, shaping filters of them, the roughness index of real profiles.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

use std::f64::consts::{PI, TAU};
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use washboard::linalg::{C64, CMat, Mat};
use washboard::lti::StateSpace;
use washboard::road::Spectrum;
use washboard::study::{
    DensityConvention, FitWeight, RideSpec, RoadAnalyticSpec, RoadFitOutcome, RoadFitSpec, RoadIriSpec,
    RoadProfileSpec, StudyError, load_road, ride, road_analytic, road_fit, road_iri, road_profile,
};
use washboard::units::Convention;

/// A folder of its own, gone at the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let dir = std::env::temp_dir().join(format!("washboard-roads-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&dir);
        fs::create_dir_all(&dir).unwrap();
        Folder(dir)
    }

    fn file(&self, name: &str, text: &str) -> String {
        let path = self.0.join(name);
        fs::write(&path, text).unwrap();
        path.display().to_string()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn fit(spec: RoadFitSpec) -> Result<RoadFitOutcome, StudyError> {
    road_fit(&spec).map(|run| run.outcome)
}

fn source(source: impl Into<String>) -> RoadFitSpec {
    RoadFitSpec { source: source.into(), ..RoadFitSpec::default() }
}

fn grid(low: f64, high: f64, count: usize) -> Vec<f64> {
    (0..count).map(|k| low * (high / low).powf(k as f64 / (count - 1) as f64)).collect()
}

/// The case's own numbers come back from samples of its road: a = 0.0572 rad/m and b = 0.0195, and order 1 is found.
#[test]
fn the_first_order_road_is_recovered_from_its_samples() {
    let road = load_road("case:turkay-first-order").unwrap();
    let Spectrum::FirstOrder { gain, corner_rad_per_m } = road.road.spectrum().clone() else { panic!() };
    let found =
        fit(RoadFitSpec { band_rad: Some([0.005, 20.0]), ..source("case:turkay-first-order") }).unwrap();
    assert_eq!((found.order, found.states, found.roll_off_rad), (1, 1, None));
    assert!((found.poles[0][0] / -corner_rad_per_m - 1.0).abs() < 1e-9, "{:?}", found.poles);
    assert!((found.gain.unwrap() / gain - 1.0).abs() < 1e-9, "{:?}", found.gain);
    assert!(found.zeros.is_empty() && found.d[0][0] == 0.0 && found.log10_max_error < 1e-9);
}

/// FILTER.toml rides as the road that it came from: exactly where that is rational, else within the fit's error.
#[test]
fn a_written_filter_rides_as_its_road() {
    let folder = Folder::new("ride");
    let rms = |vehicle: &str, road: &str, name: &str| {
        let (vehicle, road) = (vehicle.to_owned(), road.to_owned());
        let (o, _) = ride(&RideSpec { vehicle, road, speed_m_s: 20.0, controller: None }).unwrap();
        o.rms.get(name).unwrap().finite().unwrap()
    };
    for (road, band, tolerance) in [
        ("case:turkay-first-order", Some([0.005, 20.0]), 1e-8),
        // density to 10^±.02 (rms), rms to half of that; what is beyond the band is more (none in the original)
        ("case:iso8608-c", None, 0.04),
    ] {
        let output = folder.0.join("F.toml");
        let spec =
            RoadFitSpec { band_rad: band, output: Some(output.clone()), overwrite: true, ..source(road) };
        let run = road_fit(&spec).unwrap();
        assert!(run.outcome.log10_rms_error < 0.02, "{}", run.outcome.log10_rms_error);
        let (path, bytes) = run.file.unwrap();
        assert_eq!(path, output);
        fs::write(&path, bytes).unwrap();
        for (vehicle, name) in [
            ("case:turkay-quarter-car", "sprung_acceleration"),
            ("case:turkay-quarter-car", "suspension_travel"),
            ("case:guiggiani-full-car", "pitch_acceleration"),
        ] {
            let (a, b) = (rms(vehicle, &path.display().to_string(), name), rms(vehicle, road, name));
            println!("{road} {name}: {a} {b} {:.2e}", a / b - 1.0);
            assert!((a / b - 1.0).abs() < tolerance, "{road} {name}: {a} {b}");
        }
    }
}

/// One road in every way of writing it: the filters are the same, and the variance is.
#[test]
fn conventions_are_one_road() {
    let folder = Folder::new("conventions");
    let law = Spectrum::first_order(0.0195, 0.3).unwrap();
    let nu = grid(0.02, 30.0, 40);
    let write = |axis: &str, scale: f64, factor: f64| {
        let mut text = format!("{axis},psd\n");
        for v in &nu {
            writeln!(text, "{},{}", v * scale, law.psd(*v, 1.0) * factor).unwrap();
        }
        folder.file("S.csv", &text)
    };
    // by hand: var = (1/2π)∫_{-∞}^{∞} S dν
    for (axis, scale, factor, convention) in [
        ("nu_rad_per_m", 1.0, 1.0 / PI, None),
        ("n_cycles_per_m", 1.0 / TAU, 2.0, None),
        ("nu_rad_per_m", 1.0, 1.0 / TAU, Some(DensityConvention::TwoSidedRadPerM)),
        ("n_cycles_per_m", 1.0 / TAU, 1.0, Some(DensityConvention::TwoSidedCyclesPerM)),
        // the axis is one thing, the density another
        ("n_cycles_per_m", 1.0 / TAU, 1.0 / PI, Some(DensityConvention::OneSidedRadPerM)),
        ("omega_rad_s", 1.0, 1.0, None),
        ("freq_hz", 1.0 / TAU, 1.0, None),
        ("freq_hz", 1.0 / TAU, 2.0, Some(DensityConvention::OneSidedPerHz)),
        ("omega_rad_s", 1.0, 1.0 / PI, Some(DensityConvention::OneSidedRadPerS)),
        ("omega_rad_s", 1.0, 1.0 / TAU, Some(DensityConvention::TwoSidedRadPerS)),
    ] {
        let file = write(axis, scale, factor);
        let found = fit(RoadFitSpec { convention, order: Some(1), ..source(file) }).unwrap();
        let off = [found.poles[0][0] / -0.3 - 1.0, found.gain.unwrap() / 0.0195 - 1.0];
        assert!(off.iter().all(|e| e.abs() < 1e-9), "{axis} {convention:?}: {off:?}");
        let per_m = axis.ends_with("per_m");
        assert_eq!(found.unit, if per_m { "rad/m" } else { "rad/s" });
    }
    let wrong = RoadFitSpec {
        convention: Some(DensityConvention::OneSidedPerHz),
        ..source(write("nu_rad_per_m", 1.0, 1.0))
    };
    let e = fit(wrong).unwrap_err().to_string();
    assert!(
        e.contains("convention: expected a convention over distance") && e.contains("one-sided-per-hz"),
        "{e}"
    );
}

/// A random profile of a road, fitted again: the variance of the band is the profile's, and the densities are the road's.
#[test]
fn a_profile_of_a_road_gives_the_road_back() {
    let folder = Folder::new("profile");
    let output = folder.0.join("P.csv");
    let road = folder.file(
        "road.toml",
        "kind = \"iso8608\"\nclass = \"C\"\nband_rad_per_m = [0.2, 10.0]\n[coherence]\nkind = \"none\"\n",
    );
    let run = road_profile(&RoadProfileSpec {
        road: road.clone(),
        length_m: 4000.0,
        step_m: 0.25,
        track_width_m: Some(1.5),
        speed_m_s: None,
        seed: 11,
        output: output.clone(),
        overwrite: false,
    })
    .unwrap();
    fs::write(&run.file.0, &run.file.1).unwrap();
    assert_eq!((run.outcome.points, run.outcome.tracks.len()), (16_001, 2));
    // ∫ G dν = 16e-6 (1/.2 − 1/10), one-sided per rad/m
    let variance = 16e-6 * (5.0 - 0.1);
    for track in &run.outcome.tracks {
        assert!((track.rms_m.powi(2) / variance - 1.0).abs() < 0.15, "{}", track.rms_m.powi(2) / variance);
    }
    let spec = RoadFitSpec { band_rad: Some([0.25, 9.0]), ..source(output.display().to_string()) };
    let found = fit(spec).unwrap();
    assert!(found.log10_rms_error < 0.05, "{}", found.log10_rms_error);
    let law = load_road(&road).unwrap();
    for (w, fitted) in found.spectrum.omega_rad.iter().zip(&found.spectrum.fitted) {
        let off = (fitted / law.road.spectrum().psd(*w, 1.0)).log10();
        assert!(off.abs() < 0.15, "{w}: {off}");
    }
    let said: Vec<&str> = found.notes.iter().map(|n| n.name.as_str()).collect();
    for name in ["tracks", "profile-spectrum", "order-chosen", "band"] {
        assert!(said.contains(&name), "{said:?}");
    }
}

fn sorel(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/sorel_iri").join(name);
    if path.is_file() {
        return Some(path);
    }
    println!("skipped: {} is not there", path.display());
    None
}

/// Sayers' program on the evenly sampled profile (a reference by others), and the irregular one of the same road.
#[test]
fn the_index_of_real_profiles_is_the_references() {
    let (Some(one), Some(reference)) = (sorel("profile_1.txt"), sorel("iri20_method0_sayers.csv")) else {
        return;
    };
    let spec = |profile: PathBuf, moving_average_m| RoadIriSpec {
        profile,
        no_header: true,
        segment_m: Some(20.0),
        moving_average_m,
    };
    let (found, _) = road_iri(&spec(one, None)).unwrap();
    let rows: Vec<Vec<f64>> = fs::read_to_string(reference)
        .unwrap()
        .lines()
        .filter(|l| !l.starts_with('#'))
        .map(|l| l.split(',').map(|f| f.parse().unwrap()).collect())
        .collect();
    let segments = &found.tracks[0].segments;
    assert_eq!((segments.len(), rows.len(), found.moving_average_m), (27, 27, 0.0));
    let mut worst = 0.0f64;
    for (s, row) in segments.iter().zip(&rows) {
        assert!((s.start_m - row[0]).abs() < 1e-6 && (s.end_m - row[1]).abs() < 1e-6);
        worst = worst.max((s.iri_mm_per_m / row[2] - 1.0).abs());
    }
    println!("worst segment: {worst:.2e}");
    // the start over 11 m there is over half a second: a transient that the first segments keep
    assert!(worst < 1e-3, "{worst}");
}

/// Profile → spectrum → fit with relative weights: log₁₀ rms error of 0.1 or less over the band, order given and chosen.
#[test]
fn real_profiles_are_fitted_over_the_band_of_the_data() {
    for name in ["profile_1.txt", "profile_2.txt"] {
        let Some(path) = sorel(name) else { return };
        let spec = |order, weight| RoadFitSpec {
            no_header: true,
            order,
            weight,
            ..source(path.display().to_string())
        };
        for weight in [Some(FitWeight::Relative), Some(FitWeight::Relative2), None] {
            let found = fit(spec(None, weight)).unwrap();
            println!(
                "{name} {}: order {}, log10 rms {:.4}, largest {:.4}, {} samples over {:.3?}, repaired {}, folded {}",
                found.weight,
                found.order,
                found.log10_rms_error,
                found.log10_max_error,
                found.samples,
                found.band,
                found.positivity_repaired,
                found.folded
            );
            assert!(found.log10_rms_error < 0.1, "{name}: {}", found.log10_rms_error);
        }
    }
}

/// A 4 × 4 spectrum as the house writes it, S_ij = E[X_i* X_j]: the filter's G Gᴴ has the conjugate, delays the right way round.
#[test]
fn four_points_of_a_chassis_become_one_filter() {
    let folder = Folder::new("matrix");
    let n = 5;
    let a = Mat::from_fn(n, n, |i, j| match (i, j) {
        (0, 0) => -0.8,
        (1, 1) | (2, 2) => -1.5,
        (1, 2) => 7.0,
        (2, 1) => -7.0,
        (3, 3) | (4, 4) => -4.0,
        (3, 4) => 30.0,
        (4, 3) => -30.0,
        _ => 0.0,
    });
    let b = Mat::from_fn(n, 4, |i, j| (1.0 + (3 * i + 5 * j) as f64).sin() + if i == j { 1.0 } else { 0.0 });
    let c = Mat::from_fn(4, n, |i, j| 0.01 * ((2.0 + (4 * i + 7 * j) as f64).cos() + 0.5));
    let g = StateSpace::continuous(a, b, c, Mat::identity(4, 4) * faer::Scale(1e-3)).unwrap();
    let omega = grid(0.3, 120.0, 60);
    let spectrum = |w: f64| -> CMat {
        let h = g.at(C64::new(0.0, w)).unwrap();
        &h * h.adjoint()
    };
    let mut text = "omega_rad_s".to_owned();
    for i in 1..=4 {
        for j in i..=4 {
            text += &if i == j { format!(",psd_{i}{i}") } else { format!(",psd_{i}{j}_re,psd_{i}{j}_im") };
        }
    }
    for w in &omega {
        let s = spectrum(*w);
        write!(text, "\n{w}").unwrap();
        for i in 0..4 {
            for j in i..4 {
                // E[X_i* X_j]
                let z = s[(i, j)].conj();
                write!(text, ",{}", z.re).unwrap();
                if i != j {
                    write!(text, ",{}", z.im).unwrap();
                }
            }
        }
    }
    let file = folder.file("S.csv", &text);
    let spec = RoadFitSpec { order: Some(n), proper: true, ..source(file.clone()) };
    let found = fit(spec.clone()).unwrap();
    assert_eq!((found.states, found.b[0].len(), found.c.len(), found.gain), (n, 4, 4, None));
    let mat = |rows: &[Vec<f64>]| Mat::from_fn(rows.len(), rows[0].len(), |i, j| rows[i][j]);
    let filter = StateSpace::continuous(mat(&found.a), mat(&found.b), mat(&found.c), mat(&found.d)).unwrap();
    for w in grid(0.4, 100.0, 25) {
        let h = filter.at(C64::new(0.0, w)).unwrap();
        let (own, known) = (&h * h.adjoint(), spectrum(w));
        assert!((own - &known).norm_max() < 1e-7 * known.norm_max(), "{w}");
    }
    // as a road file it is a matrix filter, with S_ij = E[X_i* X_j] again
    let run = road_fit(&RoadFitSpec { output: Some(folder.0.join("F.toml")), ..spec.clone() }).unwrap();
    let written = String::from_utf8(run.file.unwrap().1).unwrap();
    let (_, read) = washboard::road::MatrixFilterSpec::parse(&written, "F.toml".as_ref()).unwrap();
    let (own, known) = (read.height_spectrum(3.0), spectrum(3.0).conjugate().to_owned());
    assert!((own - &known).norm_max() < 1e-7 * known.norm_max());
    let run = road_fit(&RoadFitSpec { output: Some(folder.0.join("F.json")), ..spec }).unwrap();
    let json: serde_json::Value = serde_json::from_slice(&run.file.unwrap().1).unwrap();
    assert_eq!(json["c"].as_array().unwrap().len(), 4);
    // and a strictly proper one for a chassis's heights
    let rolled = fit(RoadFitSpec { order: Some(n), ..source(file.clone()) }).unwrap();
    assert!(rolled.roll_off_rad.is_some() && rolled.d.iter().flatten().all(|d| *d == 0.0));
    println!("4 × 4 strictly proper: log10 rms {:.4}", rolled.log10_rms_error);
    let tampered = text.replace("\n0.3,", "\n0.3,-");
    let e = fit(source(folder.file("T.csv", &tampered))).unwrap_err().to_string();
    assert!(e.contains("T.csv:2: column psd_11: expected a density of 0 or more"), "{e}");
}

/// What is wrong with a file is said with its line.
#[test]
fn wrong_files_are_answered_with_their_line() {
    let folder = Folder::new("wrong");
    let good = "nu_rad_per_m,psd\n0.1,1\n0.2,0.5\n0.4,0.2\n0.8,0.1\n1.6,0.05\n";
    for (text, parts) in [
        ("".to_owned(), vec!["expected a header and rows of numbers, found nothing"]),
        ("nu_rad_per_m,psd\n".into(), vec!["expected rows of numbers, found none"]),
        (good.replace("psd", "density"), vec![":1: expected a column psd", "density"]),
        (good.replace("nu_rad_per_m", "nu"), vec![":1: expected one frequency column, omega_rad_s"]),
        (good.replace("nu_rad_per_m,psd", "nu_rad_per_m,psd,wieght").replace('\n', ",1\n").replacen(",1\n", "\n", 1),
            vec![":1: column wieght", "did you mean `weight`?"]),
        (good.replace("0.4,0.2", "0.4,-0.2"), vec![":4: column psd: expected a density of 0 or more, found -0.2"]),
        (good.replace("0.4,0.2", "0.2,0.2"), vec![":4: column nu_rad_per_m: expected ascending values, found 0.2 after 0.2"]),
        (good.replace("0.4,0.2", "0.05,0.2"), vec![":4:", "found 0.05 after 0.2"]),
        (good.replace("0.1,1", "-0.1,1"), vec![":2: column nu_rad_per_m: expected 0 or more, found -0.1"]),
        (good.replace("0.4,0.2", "0.4,NaN"), vec![":4: column psd: expected a finite number, found \"NaN\""]),
        (good.replace("0.4,0.2", "0.4"), vec![":4: expected 2 fields, found 1"]),
        ("nu_rad_per_m,psd\n0.1,1\n".into(), vec!["samples: expected 3 frequencies or more", "1 in"]),
        ("1,2\n3,4\n".into(), vec![":1: expected a header", "--no-header"]),
        ("nu_rad_per_m,psd,psd\n0.1,1,1\n".into(), vec!["column psd: expected each name once"]),
        ("nu_rad_per_m,psd,psd_11\n0.1,1,1\n".into(), vec!["either a column psd, or psd_11"]),
        ("nu_rad_per_m,psd_11,psd_22\n0.1,1,1\n".into(), vec!["columns psd_12_re and psd_12_im of a 2 × 2"]),
        (
            "omega_rad_s,psd_11,psd_22,psd_12_re,psd_12_im,psd_21_re,psd_21_im\n1,1,1,0.1,0.2,0.1,-0.2\n2,1,1,0.1,0.2,0.1,0.2\n".into(),
            vec![":3: psd_21: expected the conjugate of psd_12", "not Hermitian"],
        ),
        (
            "omega_rad_s,psd_11,psd_22,psd_12_re,psd_12_im\n1,1,1,0.1,0.2\n2,1,1,1.1,0\n".into(),
            vec![":3: expected a matrix without negative eigenvalues, found -1.000e-1"],
        ),
        (good.replace("psd\n", "psd,weight\n").replace("1\n", "1,1\n").replace("5\n", "5,0\n").replace("2\n", "2,1\n"),
            vec![":3: column weight: expected a number above 0, found 0"]),
    ] {
        let file = folder.file("S.csv", &text);
        let e = fit(source(file)).unwrap_err();
        let said = e.to_string();
        assert!(e.is_wrong_input() && said.contains("S.csv"), "{said}");
        for part in parts {
            assert!(said.contains(part), "{text:?}: {said} should have {part:?}");
        }
    }
    let file = folder.file("S.csv", good);
    for (spec, part) in [
        (
            RoadFitSpec { order: Some(9), ..source(file.clone()) },
            "order: expected at most 2 of 5 frequencies, found 9",
        ),
        (RoadFitSpec { order: Some(0), ..source(file.clone()) }, "order: expected a number from 1 to 40"),
        (
            RoadFitSpec { lambda_rad: Some(-1.0), ..source(file.clone()) },
            "lambda: expected a positive number",
        ),
        (RoadFitSpec { band_rad: Some([2.0, 1.0]), ..source(file.clone()) }, "band: expected two ascending"),
        (
            RoadFitSpec { band_rad: Some([5.0, 6.0]), ..source(file.clone()) },
            "band: expected 3 frequencies or more",
        ),
        (RoadFitSpec { output: Some(folder.0.join("F.csv")), ..source(file.clone()) }, "ends in .toml"),
        (RoadFitSpec { segment_m: Some(1.0), ..source(file.clone()) }, "segment_m: expected none"),
        (source("case:turkay-first-order"), "band: expected --band LOW,HIGH in rad/m"),
        (
            RoadFitSpec { band_rad: Some([0.001, 1.0]), ..source("case:iso8608-c") },
            "a part of the road's own band",
        ),
        (source(folder.0.display().to_string()), "a directory with a road.toml"),
        (source("no.csv"), "no.csv"),
    ] {
        let e = fit(spec).unwrap_err();
        assert!(e.is_wrong_input() && e.to_string().contains(part), "{e} should have {part:?}");
    }
    let profile = |text: &str| {
        let profile = PathBuf::from(folder.file("P.csv", text));
        let spec = RoadIriSpec { profile, no_header: false, segment_m: None, moving_average_m: None };
        road_iri(&spec).unwrap_err().to_string()
    };
    for (text, part) in [
        ("x_m\n0\n1\n", "expected a column of heights"),
        ("x,z_m\n0,0\n", ":1: expected a column x_m"),
        ("x_m,z\n0,0\n", "under a name that ends in _m"),
        ("x_m,z_m\n0,0\n1,0\n0.5,0\n", ":4: column x_m: expected ascending values, found 0.5 after 1"),
        ("x_m,z_m\n0,0\n1,0\n", "11 m or more"),
    ] {
        assert!(profile(text).contains(part), "{} should have {part:?}", profile(text));
    }
}

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

/// The convention of the road layer itself is what fits are held against.
#[test]
fn a_table_and_a_fit_of_one_file_are_one_road() {
    let folder = Folder::new("table");
    let law = Spectrum::power_law(16e-6, 1.0, 2.0, [0.1, 10.0], Convention::OneSidedCyclesPerM).unwrap();
    let mut text = "n_cycles_per_m,psd\n".to_owned();
    for nu in grid(0.1, 10.0, 50) {
        writeln!(text, "{},{:e}", nu / TAU, 16e-6 / (nu * nu)).unwrap();
    }
    let file = folder.file("S.csv", &text);
    let road = folder.file("road.toml", "kind = \"table\"\ndata = \"S.csv\"\n");
    let table = load_road(&road).unwrap();
    let found = fit(source(file)).unwrap();
    for (w, fitted) in found.spectrum.omega_rad.iter().zip(&found.spectrum.fitted).skip(1).take(48) {
        let (by_table, by_law) = (table.road.spectrum().psd(*w, 1.0), law.psd(*w, 1.0));
        assert!((by_table / by_law - 1.0).abs() < 1e-6 && (fitted / by_law).log10().abs() < 0.1, "{w}");
    }
}
