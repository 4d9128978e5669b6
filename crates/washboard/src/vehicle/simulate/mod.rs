//! A drive as a test engineer would record it: a Gaussian road under exact delays, the exact response, imperfect sensors.

mod flaws;
mod nonlinear;
mod stretches;
mod synthesis;
mod tracks;
mod transfer;

pub use flaws::Flaws;
pub use stretches::{SPEED_RAMP_S, Stretch, drive_stretches};

use super::{Ride, RideError, Vehicle, VehicleError};
use crate::road::Road;
use crate::signal::{Channel, Recording, SignalError, WheelPlace};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use synthesis::RoadInput;
use thiserror::Error;

/// The synthesised drive is longer than the recorded one by this many s: it is periodic, and its ends must not know each
/// other. Vehicles forget in a few seconds.
const GUARD_S: f64 = 20.0;
/// The largest number of samples in all channels that one drive may have.
const MAX_SAMPLES: f64 = 2e9 / 8.0;

/// What is refused of a drive.
#[derive(Debug, Error)]
pub enum SimulateError {
    /// A setting has a value that it cannot have.
    #[error("{field}: expected {expected}, found {found}")]
    Setting {
        /// Which.
        field: &'static str,
        /// What it should be.
        expected: &'static str,
        /// What it is.
        found: String,
    },
    /// A response that is infinite on this road cannot be recorded.
    #[error("channel `{channel}` has no stationary response on this road: {why}")]
    Infinite {
        /// The channel.
        channel: String,
        /// Why.
        why: String,
    },
    /// The dampers' curves could not be followed closely enough.
    #[error(
        "damper_curve: halving the step to {step_s:e} s still changes a channel by {reached:e} of its rms (expected \
         below {expected:e}); a shorter drive or a lower rate_hz leaves room for smaller steps"
    )]
    Steps {
        /// The last step.
        step_s: f64,
        /// What the last halving changed.
        reached: f64,
        /// What it should have.
        expected: f64,
    },
    /// The vehicle cannot ride.
    #[error(transparent)]
    Ride(#[from] RideError),
    /// A sensor's place is none.
    #[error(transparent)]
    Vehicle(#[from] VehicleError),
    /// The recording is impossible.
    #[error(transparent)]
    Signal(#[from] SignalError),
}

/// How long, how fast, how often, and which throw of the dice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DriveSettings {
    /// V.
    pub speed_m_s: f64,
    /// T.
    pub duration_s: f64,
    /// Samples per second.
    pub rate_hz: f64,
    /// Same seed, same drive, on any number of threads.
    pub seed: u64,
}

/// A drive, with what no recording tells.
#[derive(Debug, Clone, PartialEq)]
pub struct Drive {
    /// As it was recorded.
    pub recording: Recording,
    /// rms of the noise that each sensor added, in its channel's unit.
    pub noise_rms: Vec<f64>,
    /// With damper curves: what the last halving of the time step changed, as a share of a channel's rms (the worst). The
    /// error of what is recorded is less; a linear vehicle has no steps.
    pub step_error: Option<f64>,
}

/// Records a drive: see [`drive`].
///
/// # Errors
/// As [`drive`].
pub fn simulate(
    vehicle: &Vehicle,
    road: &Road,
    sensors: &[(Channel, Flaws)],
    settings: &DriveSettings,
) -> Result<Recording, SimulateError> {
    Ok(drive(vehicle, road, sensors, settings)?.recording)
}

/// Records a drive, and keeps what its sensors added.
///
/// Every frequency k/T' of a period T' longer than the drive carries complex normal amplitudes with
/// E\[X_a* X_b\] = Γ_ab S(ω) Δω/2π for tracks a, b; a wheel's input is its track's times e^{−iωδ}, and a channel is
/// (iω)^d H(ω) times that: no step size, no rounding of delays to samples. Above half the sampling rate nothing is
/// recorded, as if behind an ideal anti-aliasing filter.
///
/// A vehicle whose dampers have curves ([`Vehicle::dampers`]) is driven by the same road, up to four times that
/// frequency: its response is the linear one, exact as above, plus what the curves' differences from the linear dampers
/// make of it, by steps in time that are halved until nothing changes (1e-5 of each channel's rms).
///
/// # Errors
/// Settings that are not positive, a channel that the model does not have or whose response is infinite on this road.
pub fn drive(
    vehicle: &Vehicle,
    road: &Road,
    sensors: &[(Channel, Flaws)],
    settings: &DriveSettings,
) -> Result<Drive, SimulateError> {
    let recorded = recorded(vehicle, road, sensors, settings)?;
    spoiled(recorded, sensors, settings.rate_hz, settings.speed_m_s, settings.seed)
}

/// What sensors without noise record.
struct Recorded {
    wheels: Vec<WheelPlace>,
    series: Vec<Vec<f64>>,
    step_error: Option<f64>,
}

fn recorded(
    vehicle: &Vehicle,
    road: &Road,
    sensors: &[(Channel, Flaws)],
    settings: &DriveSettings,
) -> Result<Recorded, SimulateError> {
    for (field, value) in [
        ("speed_m_s", settings.speed_m_s),
        ("duration_s", settings.duration_s),
        ("rate_hz", settings.rate_hz),
    ] {
        if !(value.is_finite() && value > 0.0) {
            return Err(SimulateError::Setting {
                field,
                expected: "a positive number",
                found: value.to_string(),
            });
        }
    }
    let samples = settings.duration_s * settings.rate_hz;
    // what is synthesised counts, not only what is kept
    let made = samples + GUARD_S * settings.rate_hz;
    if !(samples >= 2.0 && made <= MAX_SAMPLES / sensors.len().max(1) as f64) {
        let found = format!("{samples} samples in each of {} channels", sensors.len());
        return Err(SimulateError::Setting {
            field: "duration_s",
            expected: "2 to 2.5e8 samples in all",
            found,
        });
    }
    for (_, flaws) in sensors {
        flaws.check(settings.duration_s)?;
    }
    let samples = samples.round() as usize;
    let wheels: Vec<WheelPlace> = vehicle
        .wheels()
        .iter()
        .map(|w| WheelPlace { name: w.name.replace('_', "-"), at_m: w.at_m })
        .collect();
    let looks = sensors
        .iter()
        .map(|(channel, _)| vehicle.sensor_row(channel, &wheels))
        .collect::<Result<Vec<_>, _>>()?;
    check_finite_response(vehicle, road, settings, sensors, &looks)?;
    let input = RoadInput::new(vehicle, road, settings, samples);
    let mut spectra = input.responses(&looks, input.recorded());
    let mut step_error = None;
    if !vehicle.dampers().is_empty() {
        let (difference, error) = nonlinear::difference(&input, &looks, &spectra)?;
        spectra.iter_mut().zip(difference).for_each(|(s, d)| s.iter_mut().zip(d).for_each(|(a, b)| *a += b));
        step_error = Some(error);
    }
    let series: Vec<Vec<f64>> = spectra
        .into_par_iter()
        .zip(sensors)
        .map(|(spectrum, (_, flaws))| flaws.sample(spectrum, &input, samples))
        .collect();
    Ok(Recorded { wheels, series, step_error })
}

/// The recording with what the sensors add.
fn spoiled(
    recorded: Recorded,
    sensors: &[(Channel, Flaws)],
    rate_hz: f64,
    speed_m_s: f64,
    seed: u64,
) -> Result<Drive, SimulateError> {
    let Recorded { wheels, mut series, step_error } = recorded;
    let mut noise_rms = Vec::with_capacity(sensors.len());
    for (index, (data, (_, flaws))) in series.iter_mut().zip(sensors).enumerate() {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(1 + index as u64);
        noise_rms.push(flaws.spoil(data, &mut rng));
    }
    let channels = sensors.iter().map(|(c, _)| c.clone()).collect();
    let recording = Recording::new(rate_hz, Some(speed_m_s), wheels, channels, series)?;
    Ok(Drive { recording, noise_rms, step_error })
}

/// Displacements of a road that wanders have no stationary record.
fn check_finite_response(
    vehicle: &Vehicle,
    road: &Road,
    settings: &DriveSettings,
    sensors: &[(Channel, Flaws)],
    looks: &[(Vec<f64>, usize)],
) -> Result<(), SimulateError> {
    let ride = Ride::new(vehicle, road, settings.speed_m_s)?;
    let outputs: Vec<super::Output> = looks
        .iter()
        .zip(sensors)
        .map(|((row, d), (channel, _))| {
            let mut q = [vec![], vec![], vec![]];
            q[*d].clone_from(row);
            let (name, base) = (channel.name.clone(), channel.name.clone());
            super::Output { name, base, unit: "", q, r: [vec![], vec![], vec![]], u: vec![] }
        })
        .collect();
    let references: Vec<&super::Output> = outputs.iter().collect();
    for (index, why) in ride.infinite(&references)?.into_iter().enumerate() {
        // white noise is cut off at half the sampling rate; what wanders off is not
        if let Some(why) = why.filter(|_| sensors[index].0.quantity == crate::signal::Quantity::Displacement)
        {
            return Err(SimulateError::Infinite {
                channel: sensors[index].0.name.clone(),
                why: why.to_owned(),
            });
        }
    }
    Ok(())
}
