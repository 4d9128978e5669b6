//! What the hybrid design does that one would not look for, in words.

use super::super::{HiddenMode, Response};
use super::{HybridRms, HybridSettings};
use crate::lti::rational::number::short;
use crate::synthesis::Certificate;

/// A response whose rms is above the passive one by more than this is warned of.
const WORSE: f64 = 1.01;
/// A relative difference of rms in floating point from the exact one that is warned of.
const SENSITIVE: f64 = 1e-6;

/// Hidden modes, the tire at the wheel-hop frequency, responses that are worse than the passive car's.
pub(super) fn warnings(hidden: &[HiddenMode], rms: &HybridRms, factor: f64, hop: f64) -> Vec<String> {
    let names = |of: &[Response]| of.iter().map(|r| in_words(*r)).collect::<Vec<_>>().join(" and ");
    let mut all: Vec<String> = hidden
        .iter()
        .filter(|m| !m.visible_in.is_empty())
        .map(|m| {
            format!(
                "the closed loop hides a mode at {} Hz with {} % damping: not in {}, but in {}",
                short4(m.freq_hz),
                short4(100.0 * m.damping),
                names(&m.hidden_in),
                names(&m.visible_in)
            )
        })
        .collect();
    let hz = short4(hop / std::f64::consts::TAU);
    all.push(format!(
        "at {hz} Hz the tire deflects {} times as much as in the design that is copied",
        short4(factor)
    ));
    for response in Response::ALL {
        let k = response as usize;
        if rms.hybrid[k] > WORSE * rms.passive[k] {
            all.push(format!(
                "rms {}: {} against {} of the passive car, {} times",
                in_words(response),
                short4(rms.hybrid[k]),
                short4(rms.passive[k]),
                short4(rms.hybrid[k] / rms.passive[k])
            ));
        }
    }
    all
}

/// Where the loop in floating point is not the exact one: the controller can't be written down well enough.
pub(super) fn sensitivity(
    rms: &HybridRms,
    certificate: &Certificate,
    settings: &HybridSettings,
) -> Option<String> {
    let root = settings.road_velocity_intensity.sqrt();
    let off = certificate.channels.iter().zip(rms.hybrid).find_map(|(c, exact)| {
        let found = c.h2.map_or(f64::INFINITY, |h| root * h);
        (!((found / exact - 1.0).abs() < SENSITIVE)).then_some((c.name.clone(), exact, found))
    });
    off.map(|(name, exact, found)| {
        format!(
            "rms {name} is {} exactly and {} in double precision: the design is too sensitive",
            short4(exact),
            short4(found)
        )
    })
}

fn in_words(response: Response) -> &'static str {
    match response {
        Response::Acceleration => "acceleration",
        Response::Travel => "suspension travel",
        Response::TireDeflection => "tire deflection",
    }
}

/// Four significant digits.
fn short4(x: f64) -> String {
    if x == 0.0 || !x.is_finite() {
        return format!("{x}");
    }
    let unit = 10f64.powi(x.abs().log10().floor() as i32 - 3);
    short((x / unit).round() * unit)
}
