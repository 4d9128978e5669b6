//! Parts of an outcome that all likelihood fits share: road, coherence, noise, flags.

use super::identify::Task;
use super::identify_evidence::ChannelNoise;
use super::identify_outcome::IdentifyOutcome;
use super::identify_outcome::{Flag, IdentifiedCoherence, IdentifiedRoad};
use crate::identify::operational::{mean_phase_deg, modal_assurance, phase_collinearity};
use crate::identify::{DriveOutcome, Estimate, FitReason, FreeOutcome};
use crate::road::IsoClass;
use crate::units::{Convention, per_hz_from_two_sided, rad_per_s};

/// A road as a fit has it.
pub(super) struct RoadEstimate {
    roughness_m3: Estimate,
    exponent: Estimate,
    correlation: f64,
    mu: Option<Estimate>,
}

impl RoadEstimate {
    pub fn of(drive: &DriveOutcome) -> Self {
        RoadEstimate {
            roughness_m3: drive.roughness_m3,
            exponent: drive.exponent,
            correlation: drive.road_correlation,
            mu: drive.mu,
        }
    }

    pub fn of_free(found: &FreeOutcome) -> Self {
        RoadEstimate {
            roughness_m3: found.roughness_m3,
            exponent: found.exponent,
            correlation: found.road_correlation,
            mu: found.mu,
        }
    }
}

/// Road and coherence as they are reported.
pub(super) fn road(
    task: &Task<'_>,
    speed_m_s: f64,
    found: &RoadEstimate,
) -> (IdentifiedRoad, Option<IdentifiedCoherence>) {
    // the same road as a one-sided density per rad/m, through S(ω) at any speed
    let one_sided = Convention::OneSidedRadPerM
        .density(task.convention.two_sided_time(found.roughness_m3.value, 1.0), 1.0);
    let nu = |hz: f64| rad_per_s(hz) / speed_m_s;
    let road = IdentifiedRoad {
        roughness_m3: found.roughness_m3.value,
        roughness_sd_m3: found.roughness_m3.sd,
        exponent: found.exponent.value,
        exponent_sd: found.exponent.sd,
        correlation: Some(found.correlation),
        convention: task.convention,
        class: IsoClass::of(one_sided),
        band_rad_per_m: [nu(task.band_hz[0]), nu(task.band_hz[1])],
    };
    (road, found.mu.map(|mu| IdentifiedCoherence { mu: mu.value, mu_sd: mu.sd }))
}

/// Noise floors as densities per Hz and rms.
pub(super) fn noise(task: &Task<'_>, floors: &[Estimate]) -> Vec<ChannelNoise> {
    floors
        .iter()
        .zip(task.recording.channels())
        .map(|(noise, channel)| {
            let floor_per_hz = per_hz_from_two_sided(noise.value);
            let rms = (floor_per_hz * task.recording.rate_hz() / 2.0).sqrt();
            ChannelNoise { channel: channel.name.clone(), floor_per_hz, rms }
        })
        .collect()
}

/// A reason as a flag.
pub(super) fn flag((name, text): &FitReason) -> Flag {
    Flag { name: (*name).to_owned(), text: text.clone() }
}

/// MAC between all modes, and collinearity and mean phase of each, from the points where the vehicle is drawn.
pub(super) fn criteria(outcome: &mut IdentifyOutcome) {
    let shapes: Vec<Vec<[f64; 2]>> =
        outcome.modes.iter().map(|m| m.points.iter().map(|p| [p.re, p.im]).collect()).collect();
    if shapes.iter().any(|s| s.len() < 2) {
        return;
    }
    for (mode, shape) in outcome.modes.iter_mut().zip(&shapes) {
        mode.mpc = Some(phase_collinearity(shape));
        mode.mean_phase_deg = Some(mean_phase_deg(shape));
    }
    outcome.mac = shapes.iter().map(|a| shapes.iter().map(|b| modal_assurance(a, b)).collect()).collect();
}
