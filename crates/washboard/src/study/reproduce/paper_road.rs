//! The paper's road: band, ISO class, spectrum and correlation of one track (figure 3), coherence of two (figure 4).

use super::ReproduceError;
use super::context::{Context, SPEED_M_S};
use super::item::{Axis, Curve, Sheet};
use super::paper_car::{car, coordinates};
use crate::identify::interaction::{CorrelationModel, InteractionModel};
use crate::road::{Coherence, IsoClass, Road, Spectrum};
use crate::units::{Convention, hz};
use std::f64::consts::{PI, TAU};

/// ω_a and ω_b as printed, rad/s.
pub(super) const BAND_RAD_S: [f64; 2] = [1.89, 177.7];
/// ν_a and ν_b of ISO 8608, rad/m.
pub(super) const BAND_RAD_PER_M: [f64; 2] = [0.063, 17.77];
/// S₀ as printed, m³.
pub(super) const ROUGHNESS_M3: f64 = 16e-6;
/// W₁ of table 1, m.
pub(super) const TRACK_M: f64 = 1.49;
/// μ of (61).
pub(super) const MU: f64 = 3.8;
/// Quadratures of the library and of this file, to 10⁻⁸ of what they measure.
const QUADRATURE: (f64, &str) = (1e-8, "by quadrature");
/// Lags of the figures, s, and steps to them.
const LAG_S: f64 = 5.0;
const LAGS: i32 = 200;

/// Power law of the exponent 2 in a band of ν.
pub(super) fn spectrum(band: [f64; 2], convention: Convention) -> Result<Spectrum, ReproduceError> {
    Ok(Spectrum::power_law(ROUGHNESS_M3, 1.0, 2.0, band, convention)?)
}

/// The road of §4.2 at 20 m/s, its spectrum as printed.
pub(super) fn road() -> Result<Road, ReproduceError> {
    let spectrum = spectrum(BAND_RAD_S.map(|w| w / SPEED_M_S), Convention::Paper)?;
    Ok(Road::new(spectrum, Coherence::bogsjo(MU)?))
}

/// The model of (45) in the first coordinate set.
pub(super) fn model() -> Result<InteractionModel, ReproduceError> {
    let car = car(true)?;
    let [q1, _] = coordinates(&car)?;
    Ok(InteractionModel::new(&car.wheeled(q1)?, &road()?, SPEED_M_S)?)
}

pub(super) fn lags_of(model: &InteractionModel, most_s: f64) -> Result<CorrelationModel, ReproduceError> {
    CorrelationModel::new(model, most_s)
        .ok_or_else(|| ReproduceError::unexpected("(43)", "a road of finite band", BAND_RAD_S))
}

/// R_d(0) of a power law of the exponent 2: S₀V/π (1/ω_a − 1/ω_b).
pub(super) fn variance([low, high]: [f64; 2]) -> f64 {
    ROUGHNESS_M3 * SPEED_M_S / PI * (1.0 / low - 1.0 / high)
}

/// §4.2: the band and the class.
pub(super) fn section_4_2(_: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let iso = spectrum(BAND_RAD_PER_M, Convention::Paper)?;
    // the least frequency at the highest speed, the highest at the least speed
    let (low, high) = (iso.band_rad_s(30.0)[0], iso.band_rad_s(10.0)[1]);
    sheet.printed("ω_a, rad/s", "1.89", low).noted("at 30 m/s (EP.6)");
    sheet.printed("ω_b, rad/s", "177.7", high).noted("at 10 m/s (EP.6)");
    sheet.printed("ω_a/2π, Hz", "0.30", hz(low));
    sheet.printed("ω_b/2π, Hz", "28.3", hz(high));
    sheet.printed("longest wavelength, m", "100", TAU / BAND_RAD_PER_M[0]);
    sheet.printed("shortest wavelength, m", "0.35", TAU / BAND_RAD_PER_M[1]);
    sheet.printed("S₀ of class C, m³", "16e-6", IsoClass::C.roughness_m3());
    let gamma = |distance: f64, omega: f64| {
        Ok::<_, ReproduceError>(Coherence::bogsjo(MU)?.gamma(distance, omega, SPEED_M_S))
    };
    sheet.within("Γ₁ at ω → 0", "1", gamma(TRACK_M, 0.0)?, (0.0, "the limit named in the text"));
    sheet.within("Γ₁ at W₁ → 0, 10 Hz", "1", gamma(0.0, TAU * 10.0)?, (0.0, "the limit named in the text"));
    Ok(())
}

fn lags() -> Vec<f64> {
    (-LAGS..=LAGS).map(|k| LAG_S * f64::from(k) / f64::from(LAGS)).collect()
}

fn line([low, high]: [f64; 2]) -> Vec<f64> {
    (0..=200).map(|k| low * (high / low).powf(f64::from(k) / 200.0)).collect()
}

/// Figure 3: spectrum and correlation of one track.
pub(super) fn figure_3(_: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let road = road()?;
    // inside the printed band by rounding
    let omega = line([BAND_RAD_S[0] * (1.0 + 1e-12), BAND_RAD_S[1] * (1.0 - 1e-12)]);
    let y: Vec<f64> = omega.iter().map(|w| road.spectrum().psd(*w, SPEED_M_S)).collect();
    let formula = |w: f64| ROUGHNESS_M3 / SPEED_M_S * (w / SPEED_M_S).powi(-2);
    let off = omega.iter().zip(&y).map(|(w, s)| (s / formula(*w) - 1.0).abs()).fold(0.0, f64::max);
    sheet.within("(60): largest relative difference", "0", off, (1e-12, "rounding"));
    let x: Vec<f64> = omega.iter().map(|w| hz(*w)).collect();
    let curves = vec![Curve { label: "S_d".to_owned(), y }];
    let title = "Spectrum of one track, ISO 8608 class C at 20 m/s";
    sheet.figure("a", title, Axis::log("frequency, Hz").at(&x), Axis::log("S_d, m² s/rad"), curves);
    let of_lag = lags_of(&model()?, LAG_S)?;
    let at_rest = of_lag.track_correlation(0.0, 0.0);
    sheet.within("R_d(0) over S₀V/π (1/ω_a − 1/ω_b)", "1", at_rest / variance(BAND_RAD_S), QUADRATURE);
    let x = lags();
    let y = x.iter().map(|t| of_lag.track_correlation(0.0, *t)).collect();
    let curves = vec![Curve { label: "R_d".to_owned(), y }];
    let title = "Correlation of one track, ISO 8608 class C at 20 m/s";
    sheet.figure("b", title, Axis::linear("lag, s").at(&x), Axis::linear("R_d, m²"), curves);
    Ok(())
}

/// Figure 4: coherence and its inverse transform, a/(π(a² + τ²)) with a = μW₁/(2πV).
pub(super) fn figure_4(_: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let coherence = Coherence::bogsjo(MU)?;
    let gamma = |omega: f64| coherence.gamma(TRACK_M, omega, SPEED_M_S);
    let x = line(BAND_RAD_S.map(hz));
    let curves = vec![Curve { label: "Γ₁".to_owned(), y: x.iter().map(|f| gamma(TAU * f)).collect() }];
    let (across, up) = (Axis::log("frequency, Hz").at(&x), Axis::linear("Γ₁"));
    sheet.figure("a", "Coherence of tracks 1.49 m apart at 20 m/s", across, up, curves);
    let a = MU * TRACK_M / (TAU * SPEED_M_S);
    let known = |lag: f64| a / (PI * (a * a + lag * lag));
    let mut worst = 0.0f64;
    for lag in [0.0, 0.02, 0.1, 0.5] {
        worst = worst.max((transformed(&gamma, lag, 45.0 / a) / known(lag) - 1.0).abs());
    }
    let text = "H₁ by quadrature over its closed form, at 4 lags to 0.5 s: largest difference";
    sheet.within(text, "0", worst, QUADRATURE);
    let x: Vec<f64> = lags().iter().map(|t| t / LAG_S).collect();
    let curves = vec![Curve { label: "H₁".to_owned(), y: x.iter().map(|t| known(*t)).collect() }];
    let title = "Inverse transform of the coherence";
    sheet.figure("b", title, Axis::linear("lag, s").at(&x), Axis::linear("H₁, 1/s"), curves);
    Ok(())
}

/// (1/π)∫₀^ω_b Γ cos ωτ dω by Simpson's rule; Γ is e^−45 at the end.
fn transformed(gamma: &dyn Fn(f64) -> f64, lag: f64, most: f64) -> f64 {
    const STEPS: i32 = 40_000;
    let h = most / f64::from(STEPS);
    let weight = |k: i32| match k {
        0 | STEPS => 1.0,
        k if k % 2 == 1 => 4.0,
        _ => 2.0,
    };
    let at = |k: i32| {
        let w = h * f64::from(k);
        weight(k) * gamma(w) * (w * lag).cos()
    };
    (0..=STEPS).map(at).sum::<f64>() * h / (3.0 * PI)
}
