//! Recordings made ready for a fit: channels that the model has, spectra of the whole and of its pieces.

use super::identify::Task;
use super::{IdentifyMethod, StudyError};
use crate::identify::{FitError, PhysicalDrive, PhysicalOutcome, PhysicalSettings, fit_physical};
use crate::lti::{Parametric, StartedAt};
use crate::signal::{Channel, CrossSpectra, Recording, Segment, WelchSettings, WheelPlace, welch};
use crate::vehicle::{ParametricVehicle, VehicleError};
use std::ops::Range;

/// Pieces of a recording whose spread widens the intervals.
const BLOCKS: usize = 24;

/// A recording with the channels that a model has.
#[derive(Debug, Clone)]
pub(super) struct Drive<'a> {
    pub task: Task<'a>,
    pub speed_m_s: f64,
    pub blocks: Vec<CrossSpectra>,
}

/// A recording less the channels that a model does not have, and why each is left out.
pub(super) fn usable(
    recording: &Recording,
    has: impl Fn(&Channel, &[WheelPlace]) -> Result<(), VehicleError>,
) -> Result<(Recording, Vec<String>), StudyError> {
    let (mut left_out, mut used) = (Vec::new(), Vec::new());
    for channel in recording.channels() {
        match has(channel, recording.wheels()) {
            Ok(()) => used.push(channel.name.as_str()),
            Err(e) => left_out.push(e.to_string()),
        }
    }
    if used.is_empty() {
        let expected = "channels that the vehicle model has".to_owned();
        return Err(StudyError::Setting { field: "channel", expected, found: left_out.join("; ") });
    }
    Ok((recording.select(&used)?, left_out))
}

impl<'a> Drive<'a> {
    /// Spectra of `recording` with the task's settings.
    ///
    /// # Errors
    /// A recording without a speed, or too short for its segments.
    pub fn new(task: &Task<'a>, recording: &'a Recording, name: &'a str) -> Result<Self, StudyError> {
        let speed_m_s = recording.speed_m_s().ok_or_else(|| StudyError::Setting {
            field: "speed_m_s",
            expected: "the recording's speed: without it a delay and a road cannot be told".into(),
            found: "none".into(),
        })?;
        let len = task.spectra.segment_len;
        let blocks = match task.pieces {
            [_] => blocks(recording, len)?,
            pieces => blocks_of_pieces(recording, pieces, len)?,
        };
        let task = Task {
            recording,
            pieces: task.pieces,
            name,
            band_hz: task.band_hz,
            spectra: spectra_of_pieces(recording, task.pieces, len)?,
            convention: task.convention,
        };
        Ok(Drive { blocks, task, speed_m_s })
    }
}

fn spectra(recording: &Recording, len: usize) -> Result<CrossSpectra, StudyError> {
    Ok(welch(recording, &WelchSettings::hann(Segment::Samples(len)))?)
}

/// Spectra of equal pieces of the recording, one segment long at least: what the intervals are checked by.
fn blocks(recording: &Recording, len: usize) -> Result<Vec<CrossSpectra>, StudyError> {
    let total = recording.len();
    let count = BLOCKS.min(total / len);
    (0..count).map(|b| spectra(&recording.part(b * total / count..(b + 1) * total / count)?, len)).collect()
}

/// Welch's spectra over all segments that lie within a piece.
pub(super) fn spectra_of_pieces(
    recording: &Recording,
    pieces: &[Range<usize>],
    len: usize,
) -> Result<CrossSpectra, StudyError> {
    let of_pieces = pieces
        .iter()
        .map(|piece| {
            if piece.len() == recording.len() {
                return spectra(recording, len);
            }
            spectra(&recording.part(piece.clone())?, len)
        })
        .collect::<Result<Vec<_>, _>>()?;
    Ok(CrossSpectra::merged(&of_pieces)?)
}

/// As [`blocks`], none across a cut: all of one length, a twenty-fourth of the whole or the shortest piece.
fn blocks_of_pieces(
    recording: &Recording,
    pieces: &[Range<usize>],
    len: usize,
) -> Result<Vec<CrossSpectra>, StudyError> {
    let total: usize = pieces.iter().map(Range::len).sum();
    let shortest = pieces.iter().map(Range::len).min().unwrap_or(total);
    let block = (total / BLOCKS).min(shortest).max(len);
    pieces
        .iter()
        .flat_map(|p| (0..p.len() / block).map(move |b| p.start + b * block))
        .map(|start| spectra(&recording.part(start..start + block)?, len))
        .collect()
}

/// A family for each recording, with the derivatives that its channels measure.
pub(super) type Families = Vec<(ParametricVehicle, Vec<usize>)>;

/// Fits a vehicle to all drives, from `start` where one is given.
pub(super) fn fit(
    drives: &[Drive<'_>],
    families: &Families,
    start: Option<&[f64]>,
    settings: &PhysicalSettings,
) -> Result<PhysicalOutcome, FitError> {
    let started: Vec<StartedAt<'_>> = families
        .iter()
        .map(|(family, _)| StartedAt { family, start: start.map_or_else(|| family.start(), <[f64]>::to_vec) })
        .collect();
    let of_fit: Vec<PhysicalDrive<'_>> = drives
        .iter()
        .zip(families)
        .zip(&started)
        .map(|((d, (_, derivatives)), vehicle)| PhysicalDrive {
            vehicle,
            derivatives,
            spectra: &d.task.spectra,
            // a start that is only compared needs no intervals
            blocks: if settings.rough { &[] } else { &d.blocks },
            speed_m_s: d.speed_m_s,
            band_hz: d.task.band_hz,
        })
        .collect();
    fit_physical(&of_fit, settings)
}

/// A fit that cannot start is about the recording.
pub(super) fn cannot_start(e: &FitError) -> StudyError {
    let expected = "a recording and a start that can be fitted".to_owned();
    StudyError::Setting { field: "recording", expected, found: e.to_string() }
}

/// The length of segments as a share of a recording, by what a method wants.
pub(super) fn segments(method: IdentifyMethod) -> f64 {
    match method {
        // a likelihood takes a few averages as well as many, and long segments keep delays and slow modes sharp
        IdentifyMethod::Physical | IdentifyMethod::Tvimm => 15.0,
        // forty leave each bin about 80 averages
        _ => 40.0,
    }
}
