//! Drives whose speed changes: stretches of constant speed, one after another.

use super::{Drive, DriveSettings, Flaws, GUARD_S, MAX_SAMPLES, SimulateError, recorded, spoiled};
use crate::road::Road;
use crate::signal::Channel;
use crate::vehicle::Vehicle;
use serde::{Deserialize, Serialize};

/// The recorded speed goes from one stretch's to the next one's in a line over so many s, half on either side.
pub const SPEED_RAMP_S: f64 = 4.0;
/// Speeds one after the other differ by this share at least: else nothing in the recorded speed would show the joint.
const LEAST_JUMP: f64 = 0.1;
/// Shorter stretches would be all ramp, in s.
const SHORTEST_S: f64 = 2.0 * SPEED_RAMP_S;

/// A part of a drive at one speed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stretch {
    /// V.
    pub speed_m_s: f64,
    /// T.
    pub duration_s: f64,
}

/// Records a drive of several stretches.
///
/// Each is a [`drive`](super::drive) of its own on the same road model, independent of the others, and exact; where they
/// meet all channels jump. Noise and other flaws are those of one sensor over the whole drive. The recording has the
/// speed at each sample: the stretches', but for a straight line over [`SPEED_RAMP_S`] about each joint, which is how
/// whoever looks for steady speed ([`by_speed`](crate::signal::by_speed)) sees the joints and leaves them out.
///
/// # Errors
/// As [`drive`](super::drive); no stretch, one shorter than twice the ramp, speeds in a row within a tenth of each
/// other, a sensor whose clock drifts.
pub fn drive_stretches(
    vehicle: &Vehicle,
    road: &Road,
    sensors: &[(Channel, Flaws)],
    stretches: &[Stretch],
    rate_hz: f64,
    seed: u64,
) -> Result<Drive, SimulateError> {
    check(stretches, sensors, rate_hz)?;
    let mut joined: Option<super::Recorded> = None;
    let mut speed = Vec::new();
    for (index, stretch) in stretches.iter().enumerate() {
        let settings = DriveSettings {
            speed_m_s: stretch.speed_m_s,
            duration_s: stretch.duration_s,
            rate_hz,
            // far from the seeds that anyone would give the next drive
            seed: seed.wrapping_add((index as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15)),
        };
        let part = recorded(vehicle, road, sensors, &settings)?;
        speed.resize(speed.len() + part.series.first().map_or(0, Vec::len), stretch.speed_m_s);
        match &mut joined {
            None => joined = Some(part),
            Some(whole) => {
                whole.series.iter_mut().zip(part.series).for_each(|(a, b)| a.extend(b));
                whole.step_error =
                    whole.step_error.zip(part.step_error).map(|(a, b)| a.max(b)).or(part.step_error);
            }
        }
    }
    let Some(joined) = joined else { return Err(none()) };
    let mean = speed.iter().sum::<f64>() / speed.len() as f64;
    let spread = (speed.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / speed.len() as f64).sqrt();
    let mut driven = spoiled(joined, sensors, rate_hz, mean, seed)?;
    driven.recording =
        driven.recording.with_speed_spread(spread)?.with_speed_series(ramped(&speed, rate_hz))?;
    Ok(driven)
}

/// Lines about the jumps.
fn ramped(speed: &[f64], rate_hz: f64) -> Vec<f64> {
    let mut out = speed.to_vec();
    let half = SPEED_RAMP_S / 2.0 * rate_hz;
    for joint in (1..speed.len()).filter(|k| speed[*k] != speed[k - 1]) {
        let (before, after) = (speed[joint - 1], speed[joint]);
        // the joint lies between two samples
        let middle = joint as f64 - 0.5;
        let first = (middle - half).ceil().max(0.0) as usize;
        let last = ((middle + half).floor() as usize).min(speed.len() - 1);
        for (k, v) in out.iter_mut().enumerate().take(last + 1).skip(first) {
            *v = before + (after - before) * (0.5 + (k as f64 - middle) / (2.0 * half));
        }
    }
    out
}

fn none() -> SimulateError {
    SimulateError::Setting { field: "speeds", expected: "at least one stretch", found: "none".into() }
}

fn check(stretches: &[Stretch], sensors: &[(Channel, Flaws)], rate_hz: f64) -> Result<(), SimulateError> {
    let refuse = |expected, found| Err(SimulateError::Setting { field: "speeds", expected, found });
    if stretches.is_empty() {
        return Err(none());
    }
    for s in stretches {
        // NaN must be refused too
        if !(s.speed_m_s > 0.0 && s.speed_m_s.is_finite()) {
            return refuse("positive speeds", format!("{} m/s", s.speed_m_s));
        }
        if !(s.duration_s >= SHORTEST_S && s.duration_s.is_finite()) {
            return refuse("stretches of at least 8 s", format!("{} s", s.duration_s));
        }
    }
    for pair in stretches.windows(2) {
        let (a, b) = (pair[0].speed_m_s, pair[1].speed_m_s);
        if (a - b).abs() < LEAST_JUMP * a.min(b) {
            let expected =
                "speeds in a row that differ by a tenth or more, so that the recorded speed shows the joint";
            return refuse(expected, format!("{a} m/s, then {b} m/s"));
        }
    }
    let samples = (stretches.iter().map(|s| s.duration_s).sum::<f64>() + GUARD_S) * rate_hz;
    if samples * sensors.len() as f64 > MAX_SAMPLES {
        let found = format!("{samples} samples in each of {} channels", sensors.len());
        return refuse("at most 2.5e8 samples in all", found);
    }
    match sensors.iter().find(|(_, flaws)| flaws.clock_ppm != 0.0) {
        Some((channel, _)) => Err(SimulateError::Setting {
            field: "clock_ppm",
            expected: "none with stretches of different speeds: a drift does not start again at each",
            found: format!("sensor `{}`", channel.name),
        }),
        None => Ok(()),
    }
}
