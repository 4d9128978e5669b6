//! Shards of one sweep put together.

use super::sweep_directory::{differences, point_name};
use super::{StudyError, SweepDirectory};
use crate::files::FileError;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Numbers that a message names.
const SHOWN: usize = 20;

/// Points of several directories.
#[derive(Debug)]
pub struct MergedSweep {
    /// Where each point is.
    pub points: BTreeMap<usize, PathBuf>,
    /// Points that no directory has.
    pub missing: Vec<usize>,
    /// Points that several have, alike to the last byte.
    pub duplicates: Vec<usize>,
    /// One of the directories: it says what the sweep is.
    pub sweep: SweepDirectory,
}

/// Numbers in words, the first of them where they are many.
#[must_use]
pub fn point_list(points: &[usize]) -> String {
    let shown: Vec<String> = points.iter().take(SHOWN).map(ToString::to_string).collect();
    let more = points.len().saturating_sub(SHOWN);
    let rest = if more > 0 { format!(" and {more} more") } else { String::new() };
    shown.join(", ") + &rest
}

/// Finds every point in the directories.
///
/// # Errors
/// Directories of different sweeps (what differs), points that differ between directories (their numbers).
pub fn merge(dirs: &[PathBuf]) -> Result<MergedSweep, StudyError> {
    let wrong = |path: &Path, message: String| StudyError::from(FileError::content(path, None, message));
    let shards = dirs.iter().map(|d| SweepDirectory::open(d)).collect::<Result<Vec<_>, _>>()?;
    let Some(sweep) = shards.first().cloned() else {
        return Err(wrong(Path::new("merge"), "expected directories, found none".into()));
    };
    for other in &shards[1..] {
        if other.file().sha256 != sweep.file().sha256 {
            let what = differences(&sweep.file().sweep, &other.file().sweep).join("; ");
            let message = format!("is of another sweep than {}. {what}", sweep.path().display());
            return Err(wrong(other.path(), message));
        }
    }
    let mut points: BTreeMap<usize, PathBuf> = BTreeMap::new();
    let (mut duplicates, mut conflicts) = (Vec::new(), Vec::new());
    for shard in &shards {
        for index in shard.present() {
            shard.read(index)?;
            let path = shard.path().join(point_name(index));
            let Some(first) = points.get(&index) else {
                points.insert(index, path);
                continue;
            };
            let bytes =
                |p: &Path| std::fs::read(p).map_err(|source| FileError::Read { path: p.to_owned(), source });
            if bytes(first)? == bytes(&path)? {
                duplicates.push(index);
            } else {
                conflicts.push((index, format!("{} and {}", first.display(), path.display())));
            }
        }
    }
    if let Some((_, files)) = conflicts.first() {
        let numbers = point_list(&conflicts.iter().map(|(k, _)| *k).collect::<Vec<_>>());
        let message =
            format!("holds points that differ from another directory's: {numbers} (first: {files})");
        return Err(wrong(dirs.last().map_or(Path::new(""), PathBuf::as_path), message));
    }
    let missing = (0..sweep.total()).filter(|k| !points.contains_key(k)).collect();
    Ok(MergedSweep { points, missing, duplicates, sweep })
}
