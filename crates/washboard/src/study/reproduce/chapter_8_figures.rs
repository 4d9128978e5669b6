//! Figures 8.3–8.6: the chassis' spectrum, and what the cabin answers to a pattern of its corners' noises.

use super::ReproduceError;
use super::chapter_8_cabin::{CABIN, LEAK, Reading, TRUCK, controller, plant, road};
use super::context::{Context, ROAD, SPEED_M_S};
use super::item::{Axis, Curve, Relation, Sheet};
use crate::cases;
use crate::linalg::C64;
use crate::lti::{Continuous, StateSpace};
use crate::road::Road;
use crate::units::per_hz_from_two_sided;
use crate::vehicle::{Ride, Vehicle};
use std::f64::consts::TAU;

/// ν of figures 8.4–8.6, called the warp input; corners A, B, C, D.
pub(super) const PATTERN: [f64; 4] = [1.0, 0.0, 0.0, -1.0];
/// 0.01 to 100 Hz.
fn frequencies() -> Vec<f64> {
    (0..=400).map(|k| 0.01 * 1e4f64.powf(f64::from(k) / 400.0)).collect()
}

/// PSD of the chassis' height, m²/Hz.
fn psd(truck: &Vehicle, road: &Road, freq_hz: f64) -> Result<f64, ReproduceError> {
    let chassis = truck.output("sprung_displacement")?;
    let s = Ride::new(truck, road, SPEED_M_S)?.spectrum(&[chassis], TAU * freq_hz)?;
    Ok(per_hz_from_two_sided(s[(0, 0)].re))
}

/// The approximation over what it approximates.
pub(super) fn leaking(context: &Context, freq_hz: f64) -> Result<f64, ReproduceError> {
    let truck = cases::vehicle(TRUCK)?;
    Ok(psd(&truck, &road(context)?, freq_hz)? / psd(&truck, &cases::road(ROAD)?, freq_hz)?)
}

/// Figure 8.3.
pub(super) fn f3(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let truck = cases::vehicle(TRUCK)?;
    let (exact, approximate) = (cases::road(ROAD)?, road(context)?);
    let x = frequencies();
    let curve = |label: &str, road: &Road| -> Result<Curve, ReproduceError> {
        let y = x.iter().map(|f| psd(&truck, road, *f)).collect::<Result<_, _>>()?;
        Ok(Curve { label: label.to_owned(), y })
    };
    let leak = format!("μ²v|H_λ|², λ = {LEAK}");
    let curves = vec![curve("(8.5)", &exact)?, curve(&leak, &approximate)?];
    let (across, up) = (Axis::log("frequency, Hz").at(&x), Axis::log("PSD, m²/Hz"));
    sheet.figure("", "Displacement of the truck's sprung mass", across, up, curves);
    for freq in [0.02, 0.05, 0.1, 1.0] {
        let reading = (0.1, "\"very accurate for all |ω| ≥ 0.02 Hz\", taken as 10 %");
        let text = format!("approximation over (8.5) at {freq} Hz");
        sheet.within(text, "1", leaking(context, freq)?, reading).excused_by("E8.5");
    }
    let modes = truck.modes()?;
    if let Some((mode, _)) = modes.first() {
        let text = "\"roughly the heave natural frequency of the cabin\"";
        sheet.printed("peak of the cabin's heave, Hz", "1.6", mode.freq_hz).noted(text);
    }
    Ok(())
}

/// |z̈_G|, |θ̈|, |φ̈| for ν = e^{jωt}·pattern, unit μ√v.
pub(super) fn answers(
    context: &Context,
    system: &StateSpace<Continuous>,
    pattern: [f64; 4],
    freq_hz: f64,
) -> Result<[f64; 3], ReproduceError> {
    let g = system.at(C64::new(0.0, TAU * freq_hz))?;
    // the plant's noises have unit intensity
    let scale = context.intensity.sqrt();
    Ok(std::array::from_fn(|i| (0..4).map(|j| g[(i, j)] * pattern[j]).sum::<C64>().norm() / scale))
}

/// Passive cabin and LQG loop.
pub(super) fn systems(context: &Context) -> Result<[StateSpace<Continuous>; 2], ReproduceError> {
    let spec = cases::vehicle_spec(CABIN)?;
    let k = controller(context, &spec, Reading::printed(context))?;
    let plant = plant(context, &spec, &["heave_acceleration", "pitch_acceleration", "roll_acceleration"])?;
    Ok([plant.passive(), plant.close(&k)?])
}

fn figure(context: &Context, sheet: &mut Sheet, k: usize, name: &str) -> Result<(), ReproduceError> {
    let [passive, active] = systems(context)?;
    let x: Vec<f64> = frequencies().into_iter().filter(|f| *f >= 0.1).collect();
    let curve = |label: &str, system: &StateSpace<Continuous>| -> Result<Curve, ReproduceError> {
        let at = |f: &f64| Ok(answers(context, system, PATTERN, *f)?[k]);
        Ok(Curve { label: label.to_owned(), y: x.iter().map(at).collect::<Result<_, ReproduceError>>()? })
    };
    let curves = vec![curve("passive", &passive)?, curve("active", &active)?];
    // over the largest road velocity μ√v|ν|
    let up = if k == 0 { "magnitude, (m/s²)/(m/s)" } else { "magnitude, (rad/s²)/(m/s)" };
    let title = format!("{name} acceleration of the cabin for ν = [1 0 0 −1]ᵀ");
    sheet.figure("", &title, Axis::log("frequency, Hz").at(&x), Axis::log(up), curves);
    let ratio = |f: f64| -> Result<f64, ReproduceError> {
        Ok(answers(context, &active, PATTERN, f)?[k] / answers(context, &passive, PATTERN, f)?[k])
    };
    let text = "\"effectively suppressed\", near the cabin's own modes";
    sheet.bound("active over passive at 1.5 Hz", Relation::AtMost, "1", ratio(1.5)?).noted(text);
    for (mode, label) in cases::vehicle(TRUCK)?.modes()?.iter().skip(1) {
        let reading = (0.1, "\"do not change\" at the truck's modes, taken as 10 %");
        let text = format!("active over passive at {:.2} Hz ({label})", mode.freq_hz);
        sheet.within(text, "1", ratio(mode.freq_hz)?, reading).excused_by("E8.7");
    }
    Ok(())
}

pub(super) fn f4(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    figure(context, sheet, 0, "Heave")
}

pub(super) fn f5(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    figure(context, sheet, 1, "Pitch")
}

pub(super) fn f6(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    figure(context, sheet, 2, "Roll")
}
