//! The shaping filter of a road in `demo`: its spectrum by subspace identification, told how far it is to be believed.

use super::demo_outcome::DemoFilter;
use super::road_fit::fit_samples;
use super::road_fit_source::{FitSamples, FitSource, one};
use super::{LoadedRoad, RoadFitSpec, StudyError};
use crate::road::{CoherenceKind, CoherenceSpec, FilterOutput, FilterVariable, RoadKind, RoadSpec};

/// n of the fit: a power law near 2, rounded, is a first-order spectrum but for a few per cent.
const ORDER: usize = 1;
/// ν₀: below it the filter's height no longer grows, rad/m. A sixth of the least that the drive saw, so that it bends the
/// spectrum there by no more than 2.5 %; without it the height of a ν⁻² road wanders without bound.
const ROUNDED_BELOW: f64 = 0.02;
/// The samples begin at this share of ν₀: the shoulder is a part of the fit.
const FROM: f64 = 0.1;
/// The low-pass that makes road velocities finite is this many times above the band.
const ROLL_OFF: f64 = 2.0;
const SAMPLES: usize = 120;

/// G(√(ν² + ν₀²)) of a road's power law G, as a filter of left and right tracks that know nothing of each other, and its file.
///
/// # Errors
/// A fit that fails.
pub(super) fn filter(
    road: &LoadedRoad,
    name: &str,
    band: [f64; 2],
) -> Result<(DemoFilter, String), StudyError> {
    let from = FROM * ROUNDED_BELOW;
    // the same law where nobody looked
    let law = RoadSpec { band_rad_per_m: Some([from, 2.0 * band[1]]), ..road.spec.clone() }
        .build()
        .map_err(|source| StudyError::Road { name: road.name.clone(), source })?;
    let even = |[low, high]: [f64; 2]| {
        let at = move |k: usize| low * (high / low).powf(k as f64 / (SAMPLES - 1) as f64);
        (0..SAMPLES).map(at)
    };
    let omega: Vec<f64> = even([from, band[1]]).collect();
    let samples = FitSamples {
        kind: FitSource::Road,
        variable: FilterVariable::Distance,
        of: FilterOutput::Displacement,
        s: omega.iter().map(|nu| one(law.spectrum().psd(nu.hypot(ROUNDED_BELOW), 1.0))).collect(),
        omega,
        variances: None,
        coherence: None,
        notes: Vec::new(),
        inputs: Vec::new(),
    };
    let asked = RoadFitSpec {
        source: road.name.clone(),
        order: Some(ORDER),
        roll_off_rad: Some(ROLL_OFF * band[1]),
        roll_off_order: Some(1),
        ..RoadFitSpec::default()
    };
    let fit = fit_samples(&asked, samples)?.outcome;
    let column = |m: &[Vec<f64>]| m.iter().filter_map(|row| row.first().copied()).collect::<Vec<f64>>();
    let spec = RoadSpec {
        kind: RoadKind::Filter,
        a: Some(fit.a.clone()),
        b: Some(column(&fit.b)),
        c: fit.c.first().cloned(),
        d: Some(0.0),
        poles: Some(fit.poles.clone()),
        zeros: Some(fit.zeros.clone()),
        gain: fit.gain,
        of: Some(FilterOutput::Displacement),
        variable: Some(FilterVariable::Distance),
        fitted_band_rad: Some(band),
        coherence: Some(CoherenceSpec { kind: CoherenceKind::None, mu: None }),
        ..RoadSpec::default()
    };
    let made = spec.build().map_err(|source| StudyError::Road { name: name.to_owned(), source })?;
    let nu: Vec<f64> = even(band).map(|nu| nu.clamp(band[0], band[1])).collect();
    let given: Vec<f64> = nu.iter().map(|nu| law.spectrum().psd(*nu, 1.0)).collect();
    let fitted: Vec<f64> = nu.iter().map(|nu| made.spectrum().psd(*nu, 1.0)).collect();
    let errors: Vec<f64> = fitted.iter().zip(&given).map(|(f, g)| (f / g).log10()).collect();
    let filter = DemoFilter {
        order: fit.order,
        states: fit.states,
        poles: fit.poles,
        band_rad_per_m: band,
        rounded_below_rad_per_m: ROUNDED_BELOW,
        log10_rms_error: (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt(),
        log10_max_error: errors.iter().fold(0.0, |m, e| e.abs().max(m)),
        nu_rad_per_m: nu,
        given,
        fitted,
    };
    let head = format!(
        "# {}, rounded below {ROUNDED_BELOW} rad/m, as a filter of order {}: log10 rms error {:.1e} from {:.4} to {:.4} rad/m;\n\
         # left and right tracks know nothing of each other, as a rational model of all wheels needs\n",
        road.name, filter.order, filter.log10_rms_error, band[0], band[1]
    );
    let text = toml::to_string(&spec)
        .map_err(|e| crate::files::FileError::content(std::path::Path::new(name), None, e.to_string()))?;
    Ok((filter, head + &text))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::load_road;

    const BAND: [f64; 2] = [0.126, 6.0];

    #[test]
    fn a_road_of_exponent_two_is_its_filter_but_for_the_rounding() {
        // ν⁻² rounded is first-order: the error in the band is the rounding's own, log₁₀(1 + ν₀²/ν²)
        let road = load_road("case:iso8608-c").unwrap();
        let (found, text) = filter(&road, "filter.toml", BAND).unwrap();
        let rounding = (1.0 + (ROUNDED_BELOW / BAND[0]).powi(2)).log10();
        assert!((found.log10_max_error - rounding).abs() < 1e-4, "{} {rounding}", found.log10_max_error);
        // strictly proper by itself: no low-pass
        assert_eq!((found.order, found.states), (1, 1));
        let slowest = found.poles.iter().map(|p| -p[0]).fold(f64::INFINITY, f64::min);
        assert!((slowest / ROUNDED_BELOW - 1.0).abs() < 1e-3, "{slowest}");
        assert!(RoadSpec::parse(&text, std::path::Path::new("x")).unwrap().build().is_ok());
    }

    #[test]
    fn a_road_of_another_exponent_is_followed_within_the_error_told() {
        let text =
            "kind = \"iso8608\"\nroughness_m3 = 16e-6\nexponent = 2.02\nband_rad_per_m = [0.126, 6.28]\n";
        let road = LoadedRoad::of_text("road.toml", text).unwrap();
        let (found, _) = filter(&road, "filter.toml", BAND).unwrap();
        assert!(found.log10_rms_error < 0.02, "{}", found.log10_rms_error);
        assert!(found.poles.iter().all(|p| p[0] < 0.0), "{:?}", found.poles);
    }
}
