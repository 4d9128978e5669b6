//! Roads and spectra, fitted and ridden again: one road in every way of writing it.

use super::folder::{Folder, fit, grid, source};
use std::f64::consts::{PI, TAU};
use std::fmt::Write;
use std::fs;
use washboard::linalg::C64;
use washboard::road::Spectrum;
use washboard::study::{DensityConvention, RideSpec, RoadFitSpec, load_road, ride, road_fit};
use washboard::units::Convention;

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
        let (o, _) =
            ride(&RideSpec { vehicle, road, speed_m_s: 20.0, controller: None, stroke_m: None }).unwrap();
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

/// Where no corner is given, the filter is as near to the samples as with the better one of the two that are tried, though the other
/// one needs no state for its low-pass: order 2 of samples of order 3.
#[test]
fn a_filter_without_a_low_pass_is_not_taken_where_it_is_far_off() {
    /// Two filters of one fit, with the low-pass and without.
    const AS_NEAR: f64 = 1.01;
    let folder = Folder::new("corners");
    let (low, high) = (0.05, 30.0);
    let mut text = "omega_rad_s,psd\n".to_owned();
    for w in grid(low, high, 300) {
        let s = C64::new(0.0, w);
        let g = (s + 3.0) * 0.02 / ((s * s + s * 0.4 + 1.0) * (s + 0.3));
        writeln!(text, "{w},{:e}", g.norm_sqr()).unwrap();
    }
    let spec = RoadFitSpec { order: Some(2), ..source(folder.file("S.csv", &text)) };
    let found = fit(spec.clone()).unwrap();
    let given =
        [0.5 * low, 2.0 * high].map(|c| fit(RoadFitSpec { roll_off_rad: Some(c), ..spec.clone() }).unwrap());
    let errors = given.each_ref().map(|g| g.log10_rms_error);
    // the corner below the band needs a state and is nearer, the one beyond needs none
    assert!(given[0].states > given[1].states && 2.0 * errors[0] < errors[1], "{errors:?}");
    assert!(found.log10_rms_error <= AS_NEAR * errors[0] && found.usable, "{}", found.log10_rms_error);
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
