//! `identify --method physical`: a vehicle file as start, its parameters and the road fitted to all cross-spectra.

use super::identify::{Files, Task, blank};
use super::identify_outcome::{
    ChannelNoise, FitQuality, FittedParameter, Flag, IdentifiedCoherence, IdentifiedMode, IdentifiedRoad,
    IdentifyOutcome, ShapeValue,
};
use super::{IdentifyMethod, StudyError, shape_points};
use crate::identify::{FitError, PhysicalDrive, PhysicalOutcome, PhysicalSettings, fit_physical};
use crate::road::{CoherenceSpec, IsoClass, RoadSpec};
use crate::signal::{CrossSpectra, Segment, WelchSettings, welch};
use crate::units::{Convention, per_hz_from_two_sided, rad_per_s};
use crate::vehicle::{Model, ParametricVehicle, Vehicle, VehicleError, VehicleSpec};

/// A wheel of the recording may be this far from the vehicle file's: track widths are measured carelessly.
const WHEEL_TOLERANCE_M: f64 = 0.25;
/// Pieces of the recording whose spread widens the intervals.
const BLOCKS: usize = 24;
/// Wheelbases of the recording and of the vehicle file may differ by this share.
const WHEELBASE_TOLERANCE: f64 = 0.02;

pub(super) fn run(
    task: &Task<'_>,
    file: &str,
    start: &VehicleSpec,
) -> Result<(IdentifyOutcome, Files), StudyError> {
    let of_file = |source: VehicleError| StudyError::Vehicle { name: file.to_owned(), source };
    let speed_m_s = task.recording.speed_m_s().ok_or_else(|| StudyError::Setting {
        field: "speed_m_s",
        expected: "the recording's speed: without it a delay and a road cannot be told".into(),
        found: "none".into(),
    })?;
    if matches!(start.model, Model::TruckCabin | Model::Matrices | Model::Response) {
        return Err(StudyError::Setting {
            field: "vehicle",
            expected: "a model that the physical fit knows (quarter-car, half-car, full-car, bounce-truck), or --method ssi".into(),
            found: format!("{file} of model {}", start.model.name()),
        });
    }
    let vehicle = start.build_alone().map_err(of_file)?;
    check_wheelbase(task, &vehicle)?;
    let mut left_out = Vec::new();
    let mut used = Vec::new();
    for channel in task.recording.channels() {
        match vehicle.sensor_row(channel, task.recording.wheels()) {
            Ok(_) => used.push(channel.name.as_str()),
            Err(e) => left_out.push(e.to_string()),
        }
    }
    if used.is_empty() {
        let expected = "channels that the vehicle model has".to_owned();
        return Err(StudyError::Setting { field: "channel", expected, found: left_out.join("; ") });
    }
    let recording = task.recording.select(&used)?;
    let task = Task {
        recording: &recording,
        spectra: welch(&recording, &WelchSettings::hann(Segment::Samples(task.spectra.segment_len)))?,
        ..task.clone()
    };
    let (family, derivatives) =
        ParametricVehicle::new(start, recording.channels(), recording.wheels(), &[]).map_err(of_file)?;
    let blocks = blocks(&task)?;
    let drive = PhysicalDrive {
        vehicle: &family,
        derivatives: &derivatives,
        spectra: &task.spectra,
        blocks: &blocks,
        speed_m_s,
        band_hz: task.band_hz,
    };
    let found = match fit_physical(&[drive], &PhysicalSettings::new(task.convention)) {
        Ok(found) => found,
        // too few sensors is an answer, not a mistake in a file
        Err(FitError::OneChannel { channel }) => {
            let mut outcome = blank(&task, IdentifyMethod::Physical, None);
            outcome.converged = false;
            let text = format!(
                "one sensor (`{channel}`) cannot tell the vehicle from its road: at least two are needed, better four"
            );
            outcome.flags.push(Flag { name: "not-identifiable".into(), text });
            return Ok((outcome, Vec::new()));
        }
        Err(e) => {
            let expected = "a recording and a start that can be fitted".to_owned();
            return Err(StudyError::Setting { field: "recording", expected, found: e.to_string() });
        }
    };
    let values: Vec<f64> = found.parameters.iter().map(|(_, _, e)| e.value).collect();
    let fitted = family.spec_at(&values).map_err(|e| StudyError::Setting {
        field: "vehicle",
        expected: "fitted values that make a vehicle".into(),
        found: e,
    })?;
    let fitted_vehicle = fitted.build_alone().map_err(of_file)?;
    let mut outcome =
        blank(&task, IdentifyMethod::Physical, Some((&found.drives[0].freq_hz, &found.drives[0].fitted)));
    fill(&mut outcome, &found, &fitted_vehicle, &task, speed_m_s);
    if !left_out.is_empty() {
        let text = format!("not used: {}", left_out.join("; "));
        outcome.flags.push(Flag { name: "channels-left-out".into(), text });
    }
    let files = if outcome.converged { files(&fitted, &outcome) } else { Vec::new() };
    Ok((outcome, files))
}

/// Spectra of equal pieces of the recording, two segments long at least: what the intervals are checked by.
fn blocks(task: &Task<'_>) -> Result<Vec<CrossSpectra>, StudyError> {
    let (len, total) = (task.spectra.segment_len, task.recording.len());
    let count = BLOCKS.min(total / (2 * len));
    let rate = task.recording.rate_hz();
    (0..count)
        .map(|b| {
            let edge = |i: usize| (i * total / count) as f64 / rate;
            let piece = task.recording.between(edge(b), edge(b + 1))?;
            Ok(welch(&piece, &WelchSettings::hann(Segment::Samples(len)))?)
        })
        .collect()
}

/// Delays come from the vehicle's wheelbase: a recording that says another one is of another car.
fn check_wheelbase(task: &Task<'_>, vehicle: &Vehicle) -> Result<(), StudyError> {
    let extent = |x: Vec<f64>| {
        x.iter().copied().fold(f64::NEG_INFINITY, f64::max) - x.iter().copied().fold(f64::INFINITY, f64::min)
    };
    let theirs = extent(task.recording.wheels().iter().map(|w| w.at_m[0]).collect());
    let ours = extent(vehicle.wheels().iter().map(|w| w.at_m[0]).collect());
    for (index, wheel) in task.recording.wheels().iter().enumerate() {
        let Ok(ours) = vehicle.match_wheel(index, task.recording.wheels()) else { continue };
        let (at, known) =
            (vehicle.in_frame(wheel.at_m, task.recording.wheels()), vehicle.wheels()[ours].at_m);
        if (at[0] - known[0]).hypot(at[1] - known[1]) > WHEEL_TOLERANCE_M {
            return Err(StudyError::Setting {
                field: "wheel.at_m",
                expected: format!(
                    "wheel `{}` at {known:.3?} m from the c.g., as in the vehicle file",
                    wheel.name
                ),
                found: format!("{at:.3?} m"),
            });
        }
    }
    if task.recording.wheels().len() < 2 || (theirs - ours).abs() <= WHEELBASE_TOLERANCE * ours.max(theirs) {
        return Ok(());
    }
    Err(StudyError::Setting {
        field: "wheel.at_m",
        expected: format!("the vehicle file's wheelbase of {ours:.3} m within 2 %"),
        found: format!("{theirs:.3} m"),
    })
}

fn fill(
    outcome: &mut IdentifyOutcome,
    found: &PhysicalOutcome,
    vehicle: &Vehicle,
    task: &Task<'_>,
    speed_m_s: f64,
) {
    let flag = |(name, text): &(&'static str, String)| Flag { name: (*name).to_owned(), text: text.clone() };
    outcome.converged = found.problems.is_empty();
    outcome.flags.extend(found.problems.iter().chain(&found.remarks).map(flag));
    outcome.notes.push(Flag {
        name: "scale-held".into(),
        text: "responses do not show the common scale of masses, stiffnesses and dampers: the sprung mass is the vehicle \
               file's, and the others are relative to it; modes, road and delay do not depend on it"
            .into(),
    });
    let modes: Vec<_> = found.modes.iter().map(|(m, ..)| m.clone()).collect();
    let labels = vehicle.labels(&modes);
    outcome.modes = found
        .modes
        .iter()
        .zip(labels)
        .map(|((mode, f_sd, zeta_sd), label)| IdentifiedMode {
            freq_hz: mode.freq_hz,
            freq_sd_hz: Some(*f_sd),
            damping: mode.damping,
            damping_sd: Some(*zeta_sd),
            pole: [mode.pole.re, mode.pole.im],
            shape: mode
                .shape
                .iter()
                .zip(vehicle.dofs())
                .map(|(z, dof)| ShapeValue { dof: dof.clone(), re: z.re, im: z.im })
                .collect(),
            label,
            points: shape_points::of_vehicle(vehicle, &mode.shape),
            ..IdentifiedMode::default()
        })
        .collect();
    let one_sided = |v: f64| {
        // the same road as a one-sided density per rad/m, through S(ω) at any speed
        Convention::OneSidedRadPerM.density(task.convention.two_sided_time(v, 1.0), 1.0)
    };
    let nu = |hz: f64| rad_per_s(hz) / speed_m_s;
    let drive = &found.drives[0];
    outcome.road = Some(IdentifiedRoad {
        roughness_m3: drive.roughness_m3.value,
        roughness_sd_m3: drive.roughness_m3.sd,
        exponent: drive.exponent.value,
        exponent_sd: drive.exponent.sd,
        correlation: Some(drive.road_correlation),
        convention: task.convention,
        class: IsoClass::of(one_sided(drive.roughness_m3.value)),
        band_rad_per_m: [nu(task.band_hz[0]), nu(task.band_hz[1])],
    });
    outcome.coherence = drive.mu.map(|mu| IdentifiedCoherence { mu: mu.value, mu_sd: mu.sd });
    outcome.delay_s = drive.delay_s.map(|d| d.value);
    outcome.delay_sd_s = drive.delay_s.map(|d| d.sd);
    outcome.noise = drive
        .noise
        .iter()
        .zip(task.recording.channels())
        .map(|(noise, channel)| {
            let floor_per_hz = per_hz_from_two_sided(noise.value);
            let rms = (floor_per_hz * task.recording.rate_hz() / 2.0).sqrt();
            ChannelNoise { channel: channel.name.clone(), floor_per_hz, rms }
        })
        .collect();
    outcome.parameters = found
        .parameters
        .iter()
        .map(|(name, start, e)| FittedParameter {
            name: name.clone(),
            value: e.value,
            sd: e.sd,
            start: *start,
        })
        .collect();
    outcome.fit = Some(FitQuality {
        cost: found.cost,
        decrement: found.decrement,
        chi: found.chi,
        residual_freq_hz: drive.freq_hz.clone(),
        residual: drive.residual.clone(),
        iterations: found.work[0],
        evaluations: found.work[1],
    });
}

/// vehicle.toml and road.toml to go on with.
fn files(vehicle: &VehicleSpec, outcome: &IdentifyOutcome) -> Files {
    let mut files = Vec::new();
    if let Ok(text) = toml::to_string(vehicle) {
        let text = format!("# identified from {}\n{text}", outcome.recording.name);
        files.push(("vehicle.toml".to_owned(), text.into_bytes()));
    }
    if let Some(road) = &outcome.road {
        let spec = RoadSpec {
            roughness_m3: Some(road.roughness_m3),
            exponent: Some(road.exponent),
            band_rad_per_m: Some(road.band_rad_per_m),
            convention: Some(road.convention),
            coherence: outcome.coherence.as_ref().map(|c| CoherenceSpec::bogsjo(c.mu)),
            ..RoadSpec::default()
        };
        if let Ok(text) = toml::to_string(&spec) {
            let text = format!("# identified from {}\n{text}", outcome.recording.name);
            files.push(("road.toml".to_owned(), text.into_bytes()));
        }
    }
    files
}
