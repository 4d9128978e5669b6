//! Profiles as files: a distance and one height a track.

use super::StudyError;
use super::number_table::NumberTable;
use crate::files::FileError;
use std::path::Path;

/// Tracks of a profile over common distances.
#[derive(Debug, Clone)]
pub(super) struct ProfileFile {
    /// As the header has them.
    pub names: Vec<String>,
    pub x_m: Vec<f64>,
    pub tracks: Vec<Vec<f64>>,
    pub table: NumberTable,
}

/// The column of distances.
pub(super) const DISTANCE: &str = "x_m";

/// Whether a file's header is a profile's.
pub(super) fn is_profile(table: &NumberTable) -> bool {
    table.index(DISTANCE).is_some()
}

/// A profile from a CSV file with columns `x_m` and heights whose names end in `_m`; or (`bare`) without a header, distance first.
pub(super) fn read_profile(path: &Path, bare: bool) -> Result<ProfileFile, StudyError> {
    profile_of(NumberTable::read(path, bare).map_err(|e| hint(e, bare))?)
}

/// A profile from a table.
pub(super) fn profile_of(table: NumberTable) -> Result<ProfileFile, StudyError> {
    let bare = table.names.is_empty();
    let at = if bare { Some(0) } else { table.index(DISTANCE) };
    let Some(at) = at else {
        return Err(table.header_error(
            "a column x_m (distance in m), and one of heights for each track, such as height_m",
        ));
    };
    let others: Vec<usize> = (0..table.columns.len()).filter(|k| *k != at).collect();
    if others.is_empty() {
        let message = "expected a column of heights beside the distances, found none".to_owned();
        return Err(FileError::content(&table.path, None, message).into());
    }
    if let Some(k) = others.iter().find(|k| !bare && !table.names[**k].ends_with("_m")) {
        let expected =
            format!("heights in m under a name that ends in _m, for each track, not {:?}", table.names[*k]);
        return Err(table.header_error(&expected));
    }
    table.ascending(at, f64::NEG_INFINITY)?;
    let name = |k: usize| if bare { format!("track_{k}_m") } else { table.names[k].clone() };
    Ok(ProfileFile {
        names: others.iter().map(|k| name(*k)).collect(),
        x_m: table.columns[at].clone(),
        tracks: others.iter().map(|k| table.columns[*k].clone()).collect(),
        table,
    })
}

/// A file without a header is told how to be read.
pub(super) fn hint(e: FileError, bare: bool) -> FileError {
    match e {
        FileError::Content { path, line, message }
            if !bare && message.starts_with("expected a header with") =>
        {
            let message = format!(
                "{message} (--no-header reads a profile without one: distance in m, then heights in m)"
            );
            FileError::Content { path, line, message }
        }
        e => e,
    }
}
