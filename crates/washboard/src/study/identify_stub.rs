//! STUB, to be replaced on merge: `identify` and `demo` check their input and say that they are to come.

use super::{DemoSpec, IdentifyOutcome, IdentifySpec, Input, StudyError};
use crate::signal::{Segment, WelchSettings, read_recording, welch};

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

/// STUB: reads the recording, then refuses.
///
/// # Errors
/// Always.
pub fn identify(spec: &IdentifySpec) -> Result<IdentifyRun, StudyError> {
    spec.check()?;
    let recording = read_recording(&spec.recording)?;
    if let Some(seconds) = spec.segment_s {
        welch(&recording, &WelchSettings::hann(Segment::Seconds(seconds)))?;
    }
    Err(not_yet(spec.method.name(), "this build has no identification"))
}

/// STUB: refuses.
///
/// # Errors
/// Always.
pub fn demo(_: &DemoSpec) -> Result<IdentifyRun, StudyError> {
    Err(not_yet("demo", "this build has no identification"))
}

fn not_yet(name: &str, instead: &'static str) -> StudyError {
    StudyError::NotYet { field: "method", name: name.to_owned(), instead }
}
