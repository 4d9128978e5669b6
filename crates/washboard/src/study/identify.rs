//! The job `identify`: from a recording to modes and the road.

use super::identify_outcome::{ChannelSummary, Flag, IdentifyOutcome, RecordingSummary};
use super::{
    IdentifyMethod, IdentifySpec, Input, StudyError, identify_operational, identify_physical, identify_tvimm,
    input_checks, load_vehicle, spectra_plot, speed_parts,
};
use crate::files::FileError;
use crate::identify::{LineSettings, spectral_lines};
use crate::signal::{CrossSpectra, Recording, SignalError, read_recording};
use crate::units::{Convention, per_hz_from_two_sided, rad_per_s};
use crate::vehicle::VehicleSpec;
use speed_parts::Part;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// The band that is looked at by default, Hz: body and wheel modes of road vehicles.
const BAND_HZ: [f64; 2] = [0.4, 20.0];
/// Wavelengths of ISO 8608 as ν in rad/m: the band is cut to where the road is described at the speed driven.
const ISO_BAND_RAD_PER_M: [f64; 2] = [0.063, 17.77];
/// What an identification gives: the outcome, and the files to go on with.
#[derive(Debug, Clone)]
pub struct IdentifyRun {
    /// What was found.
    pub outcome: IdentifyOutcome,
    /// vehicle.toml, road.toml: names and contents.
    pub files: Vec<(String, Vec<u8>)>,
    /// Every file that was read.
    pub inputs: Vec<Input>,
}

/// What is told to a method besides the recording.
#[derive(Debug, Clone)]
pub(super) struct Task<'a> {
    /// Detrended; of a drive that was cut by speed, its pieces one after another.
    pub recording: &'a Recording,
    /// Samples of the pieces: all of them, where the drive was not cut.
    pub pieces: &'a [Range<usize>],
    pub name: &'a str,
    pub band_hz: [f64; 2],
    pub spectra: CrossSpectra,
    pub convention: Convention,
}

/// Identifies a recording.
///
/// # Errors
/// A recording or vehicle file that is wrong, settings that do not fit them. A method that ended without success is an
/// outcome with `converged = false` and flags that say why.
pub fn identify(spec: &IdentifySpec) -> Result<IdentifyRun, StudyError> {
    spec.check()?;
    let paths: Vec<&Path> =
        std::iter::once(&spec.recording).chain(&spec.more).map(PathBuf::as_path).collect();
    let mut recordings = Vec::new();
    let mut inputs = Vec::new();
    for path in &paths {
        let recording = read_recording(path).map_err(|e| match e {
            SignalError::File(_) | SignalError::Field { .. } | SignalError::Data { .. } => {
                StudyError::Signal(e)
            }
            other => FileError::content(path, None, other.to_string()).into(),
        })?;
        let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        recordings.push((name, recording));
        inputs.extend(recording_inputs(path)?);
    }
    let start = spec.vehicle.as_deref().map(load_vehicle).transpose()?;
    inputs.extend(start.iter().flat_map(|s| s.inputs.clone()));
    let vehicle = start.as_ref().map(|s| (s.name.as_str(), &s.spec));
    let (outcome, files) = identify_recordings(&recordings, vehicle, spec).map_err(|e| match e {
        // what does not fit is about these recordings: name the first
        StudyError::Signal(source) => FileError::content(&spec.recording, None, source.to_string()).into(),
        StudyError::Setting { field, expected, found } if field != "known" => {
            let message = format!("{field}: expected {expected}, found {found}");
            FileError::content(&spec.recording, None, message).into()
        }
        other => other,
    })?;
    Ok(IdentifyRun { outcome, files, inputs })
}

/// Files by name and content.
pub type Files = Vec<(String, Vec<u8>)>;

/// Identifies one recording that is at hand: see [`identify_recordings`].
///
/// # Errors
/// As [`identify`].
pub fn identify_recording(
    recording: &Recording,
    name: &str,
    vehicle: Option<(&str, &VehicleSpec)>,
    spec: &IdentifySpec,
) -> Result<(IdentifyOutcome, Files), StudyError> {
    identify_recordings(&[(name.to_owned(), recording.clone())], vehicle, spec)
}

/// Identifies recordings that are at hand with their names for messages, from a vehicle file and its name or without one;
/// of the spec only the settings count. Returns the outcome, and vehicle.toml and road.toml to go on with.
///
/// Several recordings are of one vehicle: `physical` fits its parameters to all of them and a road to each; the other
/// methods identify each by itself. A recording whose speed varies by more than 3 % is cut into parts of steady speed
/// (see [`by_speed`](crate::signal::by_speed)), which are treated as several recordings, the longest first, and told in
/// the notes; where it cannot be, the flag `speed-varies` says why. `runs` has the modes of each recording or part.
///
/// # Errors
/// As [`identify`].
pub fn identify_recordings(
    recordings: &[(String, Recording)],
    vehicle: Option<(&str, &VehicleSpec)>,
    spec: &IdentifySpec,
) -> Result<(IdentifyOutcome, Files), StudyError> {
    input_checks::known(spec)?;
    input_checks::different(recordings)?;
    let (mut parts, mut flags, mut notes) = (Vec::new(), Vec::new(), Vec::new());
    for (name, recording) in recordings {
        let several = if recordings.len() > 1 { name.as_str() } else { "" };
        let made = speed_parts::parts(recording, name, several, spec)?;
        parts.extend(made.parts);
        flags.extend(made.flag);
        notes.extend(made.note);
    }
    let tasks = parts.iter().map(|part| task(part, spec)).collect::<Result<Vec<_>, _>>()?;
    let Some(first) = tasks.first() else {
        return Err(StudyError::Setting {
            field: "recording",
            expected: "a recording".into(),
            found: "none".into(),
        });
    };
    let (mut outcome, files) = match spec.method {
        IdentifyMethod::Physical => identify_physical::run(&tasks, vehicle, &spec.known)?,
        IdentifyMethod::Tvimm => identify_tvimm::run(&tasks, vehicle, &spec.known)?,
        _ => {
            let mut done = tasks
                .iter()
                .map(|task| identify_operational::run(task, spec.method, spec.segment_s))
                .collect::<Result<Vec<_>, _>>()?;
            let runs =
                if done.len() > 1 { done.iter().map(identify_tvimm::summary).collect() } else { vec![] };
            (IdentifyOutcome { runs, ..done.remove(0) }, Vec::new())
        }
    };
    outcome.flags.extend(input_checks::suspicious(recordings));
    outcome.flags.extend(no_speed(first));
    outcome.flags.extend(flags);
    outcome.notes.extend(notes);
    Ok((outcome, files))
}

fn task<'a>(part: &'a Part, spec: &IdentifySpec) -> Result<Task<'a>, StudyError> {
    Ok(Task {
        band_hz: band(&part.recording, spec)?,
        recording: &part.recording,
        pieces: &part.pieces,
        name: &part.name,
        spectra: part.spectra.clone(),
        convention: spec.convention.unwrap_or_default(),
    })
}

/// The band asked for, or the default one cut to the road's and to the sampling rate.
fn band(recording: &Recording, spec: &IdentifySpec) -> Result<[f64; 2], StudyError> {
    let nyquist = recording.rate_hz() / 2.0;
    if let Some([low, high]) = spec.band_hz {
        if !(low >= 0.0 && high > low && high <= nyquist) {
            let expected =
                format!("two ascending frequencies from 0 to half the sampling rate, {nyquist} Hz");
            return Err(StudyError::Setting { field: "band_hz", expected, found: format!("{low}, {high}") });
        }
        return Ok([low, high]);
    }
    if spec.method.is_operational() {
        return Ok([0.0, BAND_HZ[1].min(0.8 * nyquist)]);
    }
    // the edges of a described road are not sharp to a window: stay inside
    let road = recording.speed_m_s().map_or(BAND_HZ, |v| {
        let hz = |nu: f64| nu * v / rad_per_s(1.0);
        [1.5 * hz(ISO_BAND_RAD_PER_M[0]), hz(ISO_BAND_RAD_PER_M[1]) / 1.1]
    });
    Ok([BAND_HZ[0].max(road[0]), BAND_HZ[1].min(road[1]).min(0.8 * nyquist)])
}

fn recording_inputs(path: &Path) -> Result<Vec<Input>, StudyError> {
    let description = crate::signal::read_description(path)?;
    let beside = |name: &Path| path.parent().unwrap_or(Path::new(".")).join(name);
    let mut inputs = vec![Input::of_file(path)?, Input::of_file(&beside(&description.data))?];
    if let Some(speed) = &description.speed_file {
        inputs.push(Input::of_file(&beside(&speed.data))?);
    }
    Ok(inputs)
}

fn no_speed(task: &Task<'_>) -> Option<Flag> {
    let text =
        "the recording has no speed: neither a wheelbase delay nor the road's roughness can be reported";
    let flag = || Flag { name: "no-speed".into(), text: text.into() };
    task.recording.speed_m_s().is_none().then(flag)
}

/// What was recorded, for the outcome.
pub(super) fn summary(task: &Task<'_>) -> RecordingSummary {
    let r = task.recording;
    let channels = r.channels().iter().zip(r.samples()).map(|(c, x)| {
        let mean = x.iter().sum::<f64>() / x.len() as f64;
        ChannelSummary {
            name: c.name.clone(),
            quantity: c.quantity.name().to_owned(),
            unit: c.quantity.si_unit().to_owned(),
            place: format!("{:?}", c.place).to_lowercase(),
            wheel: c.wheel.map(|w| r.wheels()[w].name.clone()),
            rms: (x.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / x.len() as f64).sqrt(),
        }
    });
    RecordingSummary {
        name: task.name.to_owned(),
        duration_s: r.duration_s(),
        rate_hz: r.rate_hz(),
        speed_m_s: r.speed_m_s(),
        speed_spread_m_s: r.speed_spread_m_s(),
        channels: channels.collect(),
        repairs: r.repairs().to_vec(),
        segment_s: task.spectra.segment_len as f64 / task.spectra.rate_hz,
        averages: task.spectra.averages,
        band_hz: task.band_hz,
    }
}

/// An outcome with all that does not depend on the method; `fitted` are model spectra at the first bins of the band.
pub(super) fn blank(
    task: &Task<'_>,
    method: IdentifyMethod,
    fitted: Option<(&[f64], &[crate::linalg::CMat])>,
) -> IdentifyOutcome {
    IdentifyOutcome {
        converged: true,
        method: method.name().to_owned(),
        lines: lines(task),
        recording: summary(task),
        spectra: spectra_plot::plot(task, fitted),
        singular_values: spectra_plot::singular_values(task),
        ..IdentifyOutcome::default()
    }
}

/// Narrow lines and families of harmonics in the band.
fn lines(task: &Task<'_>) -> Vec<super::SpectralLine> {
    let s = &task.spectra;
    let bins: Vec<usize> = (1..s.freq_hz.len()).filter(|k| s.freq_hz[*k] <= 0.9 * s.rate_hz / 2.0).collect();
    let freq: Vec<f64> = bins.iter().map(|k| s.freq_hz[*k]).collect();
    let psd: Vec<Vec<f64>> = (0..s.channels.len())
        .map(|i| bins.iter().map(|k| per_hz_from_two_sided(s.s[*k][(i, i)].re)).collect())
        .collect();
    // a spectrum too short to look for lines in has none to report
    let found = spectral_lines(&freq, &psd, s.averages, &LineSettings::default()).unwrap_or_default();
    found
        .into_iter()
        .map(|l| {
            let mut names: Vec<&str> = l.channels.iter().map(|c| s.channels[*c].as_str()).take(3).collect();
            let more = format!("{} more", l.channels.len().saturating_sub(3));
            if l.channels.len() > 3 {
                names.push(&more);
            }
            let text = match &l.family {
                Some(f) => format!(
                    "harmonic {} of {:.2} Hz, not a mode (in {})",
                    f.multiple,
                    f.fundamental_hz,
                    names.join(", ")
                ),
                None => format!("a narrow line, not a mode (in {})", names.join(", ")),
            };
            super::SpectralLine {
                freq_hz: l.freq_hz,
                over_floor: l.ratio,
                fundamental_hz: l.family.as_ref().map(|f| f.fundamental_hz),
                multiple: l.family.as_ref().map(|f| f.multiple as u32),
                text,
            }
        })
        .collect()
}
