//! What the signal layer refuses, with the numbers that matter.

use crate::files::FileError;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// What went wrong with a recording, its description or its spectra.
#[derive(Debug, Error)]
pub enum SignalError {
    /// A file cannot be read, or is not what its format says.
    #[error(transparent)]
    File(#[from] FileError),
    /// A field of a description does not fit the others, or the data.
    #[error("{}: {field}: expected {expected}, found {found}", path.display())]
    Field {
        /// The description.
        path: PathBuf,
        /// The field, with its channel.
        field: String,
        /// What would do.
        expected: String,
        /// What is there.
        found: String,
    },
    /// A place in a data file holds something else than a number, or the file has another shape.
    #[error("{}{}: {place}: expected {expected}, found {found}", path.display(), line.map_or_else(String::new, |l| format!(":{l}")))]
    Data {
        /// The data file.
        path: PathBuf,
        /// The line, counted from 1, in a text file.
        line: Option<usize>,
        /// The column or the part of the file.
        place: String,
        /// What would do.
        expected: String,
        /// What is there.
        found: String,
    },
    /// A number that must be positive, or lie in a range, does not.
    #[error("{name}: expected {expected}, found {found}")]
    Value {
        /// The name, with its unit.
        name: &'static str,
        /// What would do.
        expected: &'static str,
        /// What was given.
        found: f64,
    },
    /// A channel has another number of samples than the first one, or there are more or fewer series than channels.
    #[error("{what}: expected {expected}, found {found}")]
    Length {
        /// What was counted.
        what: String,
        /// The first channel's number of samples, or the number of channels.
        expected: usize,
        /// What was given.
        found: usize,
    },
    /// A sample is NaN or infinite.
    #[error("channel `{channel}`: sample {index} is {value}, expected a finite number")]
    NotFinite {
        /// The channel.
        channel: String,
        /// The first such sample, counted from 0.
        index: usize,
        /// The sample.
        value: f64,
    },
    /// Too few samples for what is asked.
    #[error("{what}: expected at least {needed} samples, found {found}")]
    TooShort {
        /// What needs them.
        what: &'static str,
        /// How many are needed.
        needed: usize,
        /// How many there are.
        found: usize,
    },
    /// The speed is known as a mean at most.
    #[error(
        "speed: expected a speed at each sample (speed_column, or speed_file with time_column), found none"
    )]
    NoSpeedSeries,
    /// Time stamps run backwards, or are no time.
    #[error("time stamps: expected {expected}, found {found} at sample {index} (counted from 0)")]
    Stamps {
        /// What would do.
        expected: &'static str,
        /// The stamps concerned.
        found: String,
        /// The sample.
        index: usize,
    },
    /// There is no channel of this name.
    #[error("no channel is named `{name}`{}", nearest.as_ref().map_or_else(String::new, |n| format!(" (did you mean `{n}`?)")))]
    UnknownChannel {
        /// The name that was asked for.
        name: String,
        /// The nearest name, if one is near.
        nearest: Option<String>,
    },
    /// Two channels have one name.
    #[error("two channels are named `{name}`")]
    DuplicateChannel {
        /// The name.
        name: String,
    },
    /// A channel refers to a wheel that does not exist.
    #[error("channel `{channel}`: wheel {index} of {wheels} wheels")]
    Wheel {
        /// The channel.
        channel: String,
        /// The index that it holds.
        index: usize,
        /// How many wheels there are.
        wheels: usize,
    },
    /// Nothing is left to work with.
    #[error("no channel: {why}")]
    NoChannel {
        /// Why there is none.
        why: String,
    },
}

impl SignalError {
    /// An error at a place in a data file.
    pub(super) fn data(
        path: &Path,
        line: Option<usize>,
        place: impl Into<String>,
        expected: impl Into<String>,
        found: impl Into<String>,
    ) -> Self {
        SignalError::Data {
            path: path.to_owned(),
            line,
            place: place.into(),
            expected: expected.into(),
            found: found.into(),
        }
    }

    /// An error in a field of a description.
    pub(super) fn field(
        path: &Path,
        field: impl Into<String>,
        expected: impl Into<String>,
        found: impl Into<String>,
    ) -> Self {
        SignalError::Field {
            path: path.to_owned(),
            field: field.into(),
            expected: expected.into(),
            found: found.into(),
        }
    }
}

/// Text from a file, short enough for a message.
pub(super) fn quoted(bytes: &[u8]) -> String {
    /// Longer text is cut.
    const LONGEST: usize = 40;
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(4 * LONGEST)]);
    let short: String = text.chars().take(LONGEST).collect();
    let cut = if short.len() < bytes.len() && text.chars().count() >= LONGEST { "…" } else { "" };
    format!("\"{}{cut}\"", short.escape_debug())
}

/// The candidate nearest in spelling, for names of a sane length.
pub(super) fn suggest<'a>(name: &str, candidates: impl Iterator<Item = &'a str>) -> Option<String> {
    /// The edit distance takes the product of the lengths: long names are not names.
    const LONGEST: usize = 64;
    if name.len() > LONGEST {
        return None;
    }
    crate::files::nearest(name, candidates.filter(|c| c.len() <= LONGEST)).map(str::to_owned)
}
