//! The job `simulate`: a drive as RUN.csv, its description RUN.toml, and RUN.truth.json, which no identification reads.

use super::sensors::{Sensor, default_sensors, read_sensors};
use super::{
    Envelope, Input, LoadedRoad, LoadedVehicle, SimulateSpec, StudyError, VehicleMode, load_road,
    load_vehicle,
};
use crate::files::{FileError, read_text};
use crate::road::{Coherence, RoadSpec};
use crate::signal::{ChannelDescription, Column, Quantity, Recording, RecordingDescription, SpeedUnit, Unit};
use crate::vehicle::{Drive, DriveSettings, SimulateError, Stretch, VehicleSpec, drive, drive_stretches};
use serde::{Deserialize, Serialize};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// The column of the speed, where it changes.
const SPEED_COLUMN: &str = "speed_m_s";

/// Significant digits of a sample: a relative error of 5e-9.
const DIGITS: usize = 9;

/// What was recorded.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SimulateOutcome {
    /// The data, the description, the truth.
    pub files: Vec<String>,
    /// In each channel.
    pub samples: usize,
    /// Samples per second.
    pub rate_hz: f64,
    /// Forward speed; of stretches the mean over the time.
    pub speed_m_s: f64,
    /// Of the throw.
    pub seed: u64,
    /// Where the speed changes: each part.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stretches: Vec<DrivenStretch>,
    /// The columns after `t`.
    pub channels: Vec<SimulatedChannel>,
    /// Rear axle behind front axle; none for one axle, where every wheel has a road of its own, or the speed changes.
    pub delay_s: Option<f64>,
}

/// A part of a drive at one speed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct DrivenStretch {
    /// Forward speed.
    pub speed_m_s: f64,
    /// Length.
    pub duration_s: f64,
    /// Rear axle behind front axle, as for the whole drive.
    pub delay_s: Option<f64>,
}

/// A column.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SimulatedChannel {
    /// Header.
    pub name: String,
    /// `acceleration` …
    pub quantity: Quantity,
    /// As it is written.
    pub unit: String,
    /// As recorded, noise included.
    pub rms: f64,
    /// Of the noise alone.
    pub noise_rms: f64,
}

/// What RUN.truth.json holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DriveTruth {
    /// The vehicle's file.
    pub vehicle: VehicleSpec,
    /// A truck cabin's chassis.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub chassis: Option<VehicleSpec>,
    /// Its modes.
    pub modes: Vec<VehicleMode>,
    /// The road's file.
    pub road: RoadSpec,
    /// Forward speed; of stretches the mean over the time.
    pub speed_m_s: f64,
    /// Rear axle behind front axle.
    pub delay_s: Option<f64>,
    /// Where the speed changes: each part.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stretches: Vec<DrivenStretch>,
    /// Of the throw.
    pub seed: u64,
    /// What each sensor added.
    pub noise: Vec<TrueNoise>,
}

/// Noise that a sensor added.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TrueNoise {
    /// The channel.
    pub channel: String,
    /// In its SI unit.
    pub rms: f64,
}

/// A drive and the files that hold it, not yet written.
#[derive(Debug, Clone)]
pub struct SimulateRun {
    /// What was recorded.
    pub outcome: SimulateOutcome,
    /// Every file that was read.
    pub inputs: Vec<Input>,
    /// RUN.csv, RUN.toml, RUN.truth.json.
    pub files: Vec<(PathBuf, Vec<u8>)>,
}

/// Records a drive.
///
/// # Errors
/// A vehicle, road or sensors file that is wrong, settings that are not positive, an output that does not end in `.csv`
/// or that is a recording of someone else's: a RUN.csv is replaced only where its RUN.truth.json is beside it.
pub fn simulate(spec: &SimulateSpec) -> Result<SimulateRun, StudyError> {
    let names = output_names(&spec.output)?;
    if !(spec.noise.is_finite() && spec.noise >= 0.0) {
        let (expected, found) = ("a number ≥ 0".to_owned(), spec.noise.to_string());
        return Err(StudyError::Setting { field: "noise", expected, found });
    }
    let loaded = load_vehicle(&spec.vehicle)?;
    let road = load_road(&spec.road)?;
    let stretches = stretches(spec)?;
    let mut inputs: Vec<Input> = loaded.inputs.iter().chain(&road.inputs).cloned().collect();
    let sensors = match &spec.sensors {
        Some(path) => {
            let text = read_text(path)?;
            inputs.push(Input::of(path.display().to_string(), text.as_bytes()));
            read_sensors(path, &text, &loaded, spec.noise)?
        }
        None => default_sensors(&loaded, spec.noise)?,
    };
    if !spec.speeds.is_empty() && sensors.iter().any(|s| s.channel.name == SPEED_COLUMN) {
        return Err(StudyError::Setting {
            field: "sensor.name",
            expected: "another name than the speed's column".into(),
            found: SPEED_COLUMN.into(),
        });
    }
    let channels: Vec<_> = sensors.iter().map(|s| (s.channel.clone(), s.flaws)).collect();
    let (vehicle, on) = (&loaded.vehicle, &road.road);
    let driven = match stretches.as_slice() {
        [Stretch { speed_m_s, duration_s }] if spec.speeds.is_empty() => {
            let (speed_m_s, duration_s) = (*speed_m_s, *duration_s);
            let settings = DriveSettings { speed_m_s, duration_s, rate_hz: spec.rate_hz, seed: spec.seed };
            drive(vehicle, on, &channels, &settings)
        }
        stretches => drive_stretches(vehicle, on, &channels, stretches, spec.rate_hz, spec.seed),
    };
    let driven = driven.map_err(|e| match e {
        SimulateError::Ride(source) => StudyError::Ride { name: loaded.name.clone(), source },
        other => other.into(),
    })?;
    let parts: Vec<DrivenStretch> = stretches
        .iter()
        .map(|s| DrivenStretch {
            speed_m_s: s.speed_m_s,
            duration_s: s.duration_s,
            delay_s: delay_s(&loaded, &road, s.speed_m_s),
        })
        .collect();
    let truth = truth(&loaded, &road, &driven, spec, &parts)?;
    let outcome = outcome(&driven, &names, spec, &parts);
    let [csv, toml, json] = names;
    let description = description(&driven.recording, &sensors, &csv);
    let text = toml::to_string(&description)
        .map_err(|e| FileError::content(&toml, None, format!("cannot be written as TOML: {e}")))?;
    let files = vec![
        (csv, data(&driven.recording, &sensors).into_bytes()),
        (toml, text.into_bytes()),
        (json, Envelope::new("simulate", inputs.clone(), truth).to_json().into_bytes()),
    ];
    Ok(SimulateRun { outcome, inputs, files })
}

/// The speed and length, or the stretches: one of them.
fn stretches(spec: &SimulateSpec) -> Result<Vec<Stretch>, StudyError> {
    match (spec.speed_m_s, spec.duration_s, spec.speeds.is_empty()) {
        (Some(speed_m_s), Some(duration_s), true) => {
            super::ride::check_speed(speed_m_s)?;
            Ok(vec![Stretch { speed_m_s, duration_s }])
        }
        (None, None, false) => Ok(spec.speeds.clone()),
        (speed, duration, _) => {
            let word = |name: &str, there: bool| if there { Some(name.to_owned()) } else { None };
            let found: Vec<String> = [
                word("speed_m_s", speed.is_some()),
                word("duration_s", duration.is_some()),
                word("speeds", !spec.speeds.is_empty()),
            ]
            .into_iter()
            .flatten()
            .collect();
            Err(StudyError::Setting {
                field: "speeds",
                expected: "either speed_m_s and duration_s, or speeds alone".into(),
                found: if found.is_empty() { "none of them".into() } else { found.join(", ") },
            })
        }
    }
}

/// RUN.csv, RUN.toml, RUN.truth.json.
fn output_names(csv: &Path) -> Result<[PathBuf; 3], StudyError> {
    let refuse = |message: &str| Err(FileError::content(csv, None, message).into());
    if csv.extension().is_none_or(|e| !e.eq_ignore_ascii_case("csv")) {
        return refuse("output: expected a file name that ends in .csv");
    }
    let parent = csv.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if !parent.is_dir() {
        return refuse("output: expected a directory that exists to write to");
    }
    let (toml, truth) = (csv.with_extension("toml"), csv.with_extension("truth.json"));
    if (csv.exists() || toml.exists()) && !truth.exists() {
        return refuse(
            "output: the file or its description exists and is no simulated drive (no .truth.json beside it); \
             move it away or choose another name",
        );
    }
    Ok([csv.to_owned(), toml, truth])
}

fn delay_s(loaded: &LoadedVehicle, road: &LoadedRoad, speed_m_s: f64) -> Option<f64> {
    let x = || loaded.vehicle.wheels().iter().map(|w| w.at_m[0]);
    let base = x().fold(f64::NEG_INFINITY, f64::max) - x().fold(f64::INFINITY, f64::min);
    (base > 0.0 && *road.road.coherence() != Coherence::Independent).then(|| base / speed_m_s)
}

fn truth(
    loaded: &LoadedVehicle,
    road: &LoadedRoad,
    driven: &Drive,
    spec: &SimulateSpec,
    parts: &[DrivenStretch],
) -> Result<DriveTruth, StudyError> {
    let channels = driven.recording.channels().iter().zip(&driven.noise_rms);
    Ok(DriveTruth {
        vehicle: loaded.spec.clone(),
        chassis: loaded.chassis.clone(),
        modes: super::modes::vehicle_modes(loaded)?,
        road: road.spec.clone(),
        speed_m_s: driven.recording.speed_m_s().unwrap_or_default(),
        delay_s: one_delay(parts),
        stretches: if spec.speeds.is_empty() { Vec::new() } else { parts.to_vec() },
        seed: spec.seed,
        noise: channels.map(|(c, rms)| TrueNoise { channel: c.name.clone(), rms: *rms }).collect(),
    })
}

/// Of a drive at one speed.
fn one_delay(parts: &[DrivenStretch]) -> Option<f64> {
    match parts {
        [one] => one.delay_s,
        _ => None,
    }
}

fn outcome(
    driven: &Drive,
    names: &[PathBuf; 3],
    spec: &SimulateSpec,
    parts: &[DrivenStretch],
) -> SimulateOutcome {
    let recording = &driven.recording;
    let rms = |x: &[f64]| (x.iter().map(|v| v * v).sum::<f64>() / x.len() as f64).sqrt();
    let channels = recording.channels().iter().zip(recording.samples()).zip(&driven.noise_rms);
    SimulateOutcome {
        files: names.iter().map(|n| n.display().to_string()).collect(),
        samples: recording.len(),
        rate_hz: recording.rate_hz(),
        speed_m_s: recording.speed_m_s().unwrap_or_default(),
        seed: spec.seed,
        stretches: if spec.speeds.is_empty() { Vec::new() } else { parts.to_vec() },
        channels: channels
            .map(|((c, x), noise_rms)| SimulatedChannel {
                name: c.name.clone(),
                quantity: c.quantity,
                unit: c.quantity.si_unit().to_owned(),
                rms: rms(x),
                noise_rms: *noise_rms,
            })
            .collect(),
        delay_s: one_delay(parts),
    }
}

/// The recording's RUN.toml.
fn description(recording: &Recording, sensors: &[Sensor], csv: &Path) -> RecordingDescription {
    let channels = recording.channels().iter().zip(sensors).map(|(c, s)| ChannelDescription {
        column: Column::Name(c.name.clone()),
        name: None,
        quantity: c.quantity,
        unit: match c.quantity {
            Quantity::Displacement => Unit::Metre,
            Quantity::Velocity => Unit::MetrePerSecond,
            Quantity::Acceleration => Unit::MetrePerSecondSquared,
            Quantity::AngularVelocity => Unit::RadianPerSecond,
        },
        scale: None,
        scale_unit: None,
        calibration: None,
        direction: s.declared,
        place: c.place,
        wheel: c.wheel.map(|w| recording.wheels()[w].name.clone()),
        at_m: c.at_m,
    });
    RecordingDescription {
        data: csv.file_name().map(PathBuf::from).unwrap_or_default(),
        format: None,
        header: None,
        delimiter: None,
        rate_hz: Some(recording.rate_hz()),
        time_column: None,
        time_unit: None,
        stamps: None,
        span_s: None,
        speed_m_s: if recording.speed_series().is_some() { None } else { recording.speed_m_s() },
        speed_column: recording.speed_series().map(|_| Column::Name(SPEED_COLUMN.to_owned())),
        speed_file: None,
        speed_unit: recording.speed_series().map(|_| SpeedUnit::MetrePerSecond),
        wheels: recording.wheels().to_vec(),
        channels: channels.collect(),
    }
}

/// The recording's RUN.csv: `t`, the channels along their declared directions, the speed where it changes.
fn data(recording: &Recording, sensors: &[Sensor]) -> String {
    let series = recording.samples();
    let mut text = String::with_capacity(recording.len() * (16 + series.len() * (DIGITS + 8)));
    text.push('t');
    recording.channels().iter().for_each(|c| {
        text.push(',');
        text.push_str(&c.name);
    });
    if recording.speed_series().is_some() {
        text.push(',');
        text.push_str(SPEED_COLUMN);
    }
    text.push('\n');
    let signs: Vec<f64> = sensors.iter().map(|s| s.declared.sign()).collect();
    for k in 0..recording.len() {
        // writing to a string cannot fail
        let _ = write!(text, "{}", k as f64 / recording.rate_hz());
        for (x, sign) in series.iter().zip(&signs) {
            let _ = write!(text, ",{:.*e}", DIGITS - 1, sign * x[k]);
        }
        if let Some(speed) = recording.speed_series() {
            let _ = write!(text, ",{:.*e}", DIGITS - 1, speed[k]);
        }
        text.push('\n');
    }
    text
}
