//! The first half of `demo`: a published car is driven over a road, and identified without a look at the truth.

use super::identify::{Files, identify_recording};
use super::identify_outcome::{IdentifyOutcome, TrueMode, Truth};
use super::sensors::default_sensors;
use super::{DemoSpec, IdentifyMethod, IdentifySpec, LoadedRoad, LoadedVehicle, StudyError};
use crate::lti::Parametric;
use crate::signal::Recording;
use crate::vehicle::{DriveSettings, ParametricVehicle, VehicleError, simulate};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Every parameter of the start is off by up to this share.
const START_ERROR: f64 = 0.3;
/// Noise of the sensors, as a multiple of each channel's rms.
const NOISE: f64 = 0.02;
/// Of the drive, and of the designs after it.
pub(super) const SPEED_M_S: f64 = 20.0;
const DURATION_S: f64 = 1200.0;
const RATE_HZ: f64 = 200.0;

/// What the sensors on body and hubs felt.
pub(super) fn drive(
    car: &LoadedVehicle,
    road: &LoadedRoad,
    spec: &DemoSpec,
) -> Result<Recording, StudyError> {
    let sensors: Vec<_> = default_sensors(car, NOISE)?.into_iter().map(|s| (s.channel, s.flaws)).collect();
    let settings =
        DriveSettings { speed_m_s: SPEED_M_S, duration_s: DURATION_S, rate_hz: RATE_HZ, seed: spec.seed };
    Ok(simulate(&car.vehicle, &road.road, &sensors, &settings)?)
}

/// Car and road from the recording and a start that is off by up to 30 %, with the truth beside what was found.
pub(super) fn identify(
    recording: &Recording,
    car: &LoadedVehicle,
    road: &LoadedRoad,
    spec: &DemoSpec,
) -> Result<(IdentifyOutcome, Files), StudyError> {
    let of_case = |source: VehicleError| StudyError::Vehicle { name: car.name.clone(), source };
    let (family, _) =
        ParametricVehicle::new(&car.spec, recording.channels(), recording.wheels(), &[]).map_err(of_case)?;
    let mut rng = ChaCha8Rng::seed_from_u64(spec.seed);
    rng.set_stream(u64::MAX);
    let wrong: Vec<f64> =
        family.start().iter().map(|v| v * (1.0 + START_ERROR * rng.random_range(-1.0..=1.0))).collect();
    let start = family.spec_at(&wrong).map_err(|found| StudyError::Setting {
        field: "vehicle",
        expected: "a start that makes a vehicle".into(),
        found,
    })?;
    let settings = IdentifySpec {
        recording: "demo".into(),
        method: IdentifyMethod::Physical,
        ..IdentifySpec::default()
    };
    let name = "a simulated drive of the paper's car";
    let (mut outcome, files) = identify_recording(recording, name, Some((&car.name, &start)), &settings)?;
    let modes = car.vehicle.modes().map_err(of_case)?;
    let wheelbase = car.vehicle.wheels().iter().map(|w| w.at_m[0]);
    let wheelbase =
        wheelbase.clone().fold(f64::NEG_INFINITY, f64::max) - wheelbase.fold(f64::INFINITY, f64::min);
    outcome.truth = Some(Truth {
        modes: modes
            .into_iter()
            .map(|(m, label)| TrueMode { label, freq_hz: m.freq_hz, damping: m.damping })
            .collect(),
        roughness_m3: road.spec.class.map_or(0.0, crate::road::IsoClass::roughness_m3),
        exponent: road.spec.exponent.unwrap_or(2.0),
        mu: road.spec.coherence.and_then(|c| c.mu),
        delay_s: wheelbase / SPEED_M_S,
        parameters: family.names().into_iter().zip(family.start()).collect(),
    });
    Ok((outcome, files))
}
