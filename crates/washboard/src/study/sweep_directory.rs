//! A sweep on disk: what it is (`sweep.json`), and a file a point that is there as a whole as soon as the point is computed.

use super::checked_design::check;
use super::sweep_outcome::{PointDesign, PointFile, SweepDetail, SweepOutcome, SweepPoint};
use super::{Envelope, Input, MergedSweep, SCHEMA_VERSION, StudyError, SweepPlan, SweepSeal};
use crate::files::{FileError, read_text, write_whole};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// What the directory of a sweep may hold.
const OWN: [&str; 6] = ["sweep.json", "result.json", "table.csv", "table.parquet", "report.html", "points"];
/// Differences that a message names.
const SHOWN: usize = 6;

/// `sweep.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SweepFile {
    /// [`SCHEMA_VERSION`].
    pub schema_version: u32,
    /// SWEEP.toml.
    pub file: Input,
    /// Of the seal.
    pub sha256: String,
    /// What the points are valid for.
    pub sweep: SweepSeal,
}

/// A directory with points of one sweep.
#[derive(Debug, Clone)]
pub struct SweepDirectory {
    dir: PathBuf,
    file: SweepFile,
}

/// The name of a point's file in the directory.
#[must_use]
pub fn point_name(index: usize) -> String {
    format!("points/{index:04}.json")
}

fn wrong(path: &Path, message: impl Into<String>) -> StudyError {
    FileError::content(path, None, message).into()
}

/// Refuses what is no directory, and one with anything that is not a sweep's.
fn check_place(dir: &Path) -> Result<(), StudyError> {
    if dir.as_os_str().is_empty() || dir.file_name().is_none() || (dir.exists() && !dir.is_dir()) {
        return Err(wrong(dir, "expected the name of a directory"));
    }
    match stranger(dir) {
        Some(stranger) => {
            let expected = format!("a new directory or a sweep's own files ({})", OWN.join(", "));
            Err(wrong(dir, format!("holds {stranger:?}: expected {expected}")))
        }
        None => Ok(()),
    }
}

impl SweepDirectory {
    /// The directory of a sweep that begins or goes on; `file` is SWEEP.toml.
    ///
    /// # Errors
    /// A directory that holds anything else, or another sweep (the message says what differs), unless `overwrite`, which takes
    /// away a sweep's own files and nothing else.
    pub fn begin(dir: &Path, plan: &SweepPlan, file: Input, overwrite: bool) -> Result<Self, StudyError> {
        let fail = |source| FileError::Write { path: dir.to_owned(), source };
        check_place(dir)?;
        let own = SweepFile {
            schema_version: SCHEMA_VERSION,
            file,
            sha256: plan.seal.sha256(),
            sweep: plan.seal.clone(),
        };
        if overwrite && dir.exists() {
            fs::remove_dir_all(dir).map_err(fail)?;
        }
        if is_filled(dir) {
            if !dir.join("sweep.json").is_file() {
                return Err(wrong(
                    dir,
                    "the directory is not empty, and no sweep (sweep.json); --overwrite replaces it",
                ));
            }
            let old = SweepDirectory::open(dir)?;
            if old.file.sha256 != own.sha256 {
                let what = differences(&old.file.sweep, &own.sweep).join("; ");
                return Err(wrong(
                    dir,
                    format!("holds points of another sweep; --overwrite begins anew. {what}"),
                ));
            }
        }
        fs::create_dir_all(dir).map_err(fail)?;
        let directory = SweepDirectory { dir: dir.to_owned(), file: own };
        // first what it is: whenever a run is ended, the next one knows the directory
        write_whole(&dir.join("sweep.json"), &directory.seal_bytes())?;
        fs::create_dir_all(dir.join("points")).map_err(fail)?;
        Ok(directory)
    }

    /// Refuses a place that is no directory's, or that holds something and may not be replaced: to be asked before work starts.
    ///
    /// # Errors
    /// What is in the way.
    pub fn check_target(dir: &Path, overwrite: bool) -> Result<(), StudyError> {
        check_place(dir)?;
        if is_filled(dir) && !overwrite {
            return Err(wrong(dir, "the directory is not empty; --overwrite replaces it"));
        }
        Ok(())
    }

    /// A new directory with the points of others, as they are.
    ///
    /// # Errors
    /// The system's.
    pub fn gather(dir: &Path, merged: &MergedSweep) -> Result<Self, StudyError> {
        let write =
            |path: &Path, source| StudyError::from(FileError::Write { path: path.to_owned(), source });
        fs::create_dir_all(dir.join("points")).map_err(|e| write(dir, e))?;
        let own = SweepDirectory { dir: dir.to_owned(), file: merged.sweep.file.clone() };
        write_whole(&dir.join("sweep.json"), &own.seal_bytes())?;
        for (index, from) in &merged.points {
            let bytes = fs::read(from).map_err(|source| FileError::Read { path: from.clone(), source })?;
            let to = dir.join(point_name(*index));
            fs::write(&to, bytes).map_err(|e| write(&to, e))?;
        }
        Ok(own)
    }

    /// A directory that has a sweep.
    ///
    /// # Errors
    /// No `sweep.json`, or one whose parts contradict each other.
    pub fn open(dir: &Path) -> Result<Self, StudyError> {
        let path = dir.join("sweep.json");
        let text = read_text(&path)?;
        let file: SweepFile = serde_json::from_str(&text)
            .map_err(|e| FileError::content(&path, Some(e.line()), e.to_string()))?;
        if file.schema_version != SCHEMA_VERSION || file.sha256 != file.sweep.sha256() {
            let expected = format!("schema {SCHEMA_VERSION} and a sha256 of what stands beside it");
            return Err(wrong(
                &path,
                format!("expected {expected}, found schema {} and {}", file.schema_version, file.sha256),
            ));
        }
        Ok(SweepDirectory { dir: dir.to_owned(), file })
    }

    /// What it is.
    #[must_use]
    pub fn file(&self) -> &SweepFile {
        &self.file
    }

    /// Its place.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.dir
    }

    fn seal_bytes(&self) -> Vec<u8> {
        (serde_json::to_string_pretty(&self.file).unwrap_or_default() + "\n").into_bytes()
    }

    /// How many points the whole sweep has.
    #[must_use]
    pub fn total(&self) -> usize {
        super::sweep_grid::count(&self.file.sweep.grid).unwrap_or(0)
    }

    /// The points that are there.
    #[must_use]
    pub fn present(&self) -> BTreeSet<usize> {
        let entries = fs::read_dir(self.dir.join("points")).into_iter().flatten().flatten();
        entries
            .filter_map(|e| number(&e.file_name().to_string_lossy()))
            .filter(|k| *k < self.total())
            .collect()
    }

    /// A point that is there.
    ///
    /// # Errors
    /// A file that is none, or of another sweep.
    pub fn read(&self, index: usize) -> Result<PointFile, StudyError> {
        let path = self.dir.join(point_name(index));
        let text = read_text(&path)?;
        let point: PointFile = serde_json::from_str(&text).map_err(|e| {
            FileError::content(
                &path,
                Some(e.line()),
                format!("expected a point of a sweep ({e}); delete it to compute it again"),
            )
        })?;
        let stamp = &point.outcome.point;
        if (stamp.index, &stamp.sweep_sha256) != (index, &self.file.sha256) {
            let found = format!("point {} of {}", stamp.index, stamp.sweep_sha256);
            return Err(wrong(
                &path,
                format!("expected point {index} of the sweep {}, found {found}", self.file.sha256),
            ));
        }
        if stamp.sha256 != point.digest() {
            return Err(wrong(
                &path,
                "its SHA-256 (point.sha256) is not that of what stands in it: it was edited; delete it to compute it again",
            ));
        }
        if let PointDesign::Outcome(o) = &point.outcome.result {
            check(o).map_err(|e| wrong(&path, format!("{e}; delete it to compute it again")))?;
        }
        Ok(point)
    }

    /// Puts a point on disk, whole; what is read back later is the same to the last bit.
    ///
    /// # Errors
    /// The system's.
    pub fn write(&self, point: &PointFile) -> Result<(), StudyError> {
        Ok(write_whole(&self.dir.join(point_name(point.outcome.point.index)), point.to_json().as_bytes())?)
    }

    /// All that is there as rows, and what a page shows of each point with a loop.
    ///
    /// # Errors
    /// A point's file that is none, or of another sweep.
    pub fn outcome(&self) -> Result<(SweepOutcome, Vec<SweepDetail>), StudyError> {
        let present = self.present();
        let missing = (0..self.total()).filter(|k| !present.contains(k)).collect();
        let (mut rows, mut details) = (Vec::new(), Vec::new());
        let mut goals: Vec<&'static str> = Vec::new();
        for index in present {
            let point = self.read(index)?.outcome;
            rows.push(SweepPoint::new(&point, &point_name(index)));
            if let PointDesign::Outcome(o) = &point.result {
                details.extend(SweepDetail::new(index, o));
                goals.push(o.goal_words());
            }
        }
        goals.dedup();
        let goal = <[&str; 1]>::try_from(goals).ok().map(|[words]| words.to_owned());
        let sweep = &self.file.sweep;
        Ok((SweepOutcome::new(&sweep.grid, sweep.warm_start, goal, missing, rows), details))
    }

    /// The envelope of a result.
    #[must_use]
    pub fn envelope(&self, outcome: SweepOutcome) -> Envelope<SweepOutcome> {
        let inputs = std::iter::once(&self.file.file).chain(&self.file.sweep.inputs).cloned().collect();
        Envelope::new("sweep", inputs, outcome)
    }

    /// Takes away what a run that was ended by force had half written.
    ///
    /// # Errors
    /// The system's.
    pub fn sweep_up(&self) -> Result<(), StudyError> {
        for dir in [self.dir.clone(), self.dir.join("points")] {
            for entry in fs::read_dir(&dir).into_iter().flatten().flatten() {
                if is_part(&entry.file_name().to_string_lossy()) {
                    fs::remove_file(entry.path())
                        .map_err(|source| FileError::Write { path: entry.path(), source })?;
                }
            }
        }
        Ok(())
    }
}

/// `0012.json`, as it is written and not otherwise.
fn number(name: &str) -> Option<usize> {
    let index = name.strip_suffix(".json")?.parse().ok()?;
    (point_name(index) == format!("points/{name}")).then_some(index)
}

/// What [`write_whole`] has not yet renamed.
fn is_part(name: &str) -> bool {
    name.starts_with('.') && name.ends_with(".part")
}

/// Whether there is anything but half-written files.
fn is_filled(dir: &Path) -> bool {
    let mut entries = fs::read_dir(dir).into_iter().flatten().flatten();
    entries.any(|e| !is_part(&e.file_name().to_string_lossy()))
}

/// The first entry that is not a sweep's, by its name or by what it is.
fn stranger(dir: &Path) -> Option<String> {
    let entries = |dir: &Path| -> Vec<(String, bool)> {
        let entries = fs::read_dir(dir).into_iter().flatten().flatten();
        entries
            .map(|e| (e.file_name().to_string_lossy().into_owned(), e.file_type().is_ok_and(|t| t.is_file())))
            .filter(|(n, _)| !is_part(n))
            .collect()
    };
    let above = |(n, file): &(String, bool)| OWN.contains(&n.as_str()) && *file == (n != "points");
    let point = |(n, file): &(String, bool)| *file && number(n).is_some();
    let name = |(n, _): (String, bool)| n;
    entries(dir).into_iter().find(|e| !above(e)).map(name).or_else(|| {
        entries(&dir.join("points")).into_iter().find(|e| !point(e)).map(|e| format!("points/{}", e.0))
    })
}

/// Where two sweeps differ, in words.
pub(super) fn differences(old: &SweepSeal, new: &SweepSeal) -> Vec<String> {
    fn walk(place: &str, old: &Value, new: &Value, into: &mut Vec<String>) {
        if old == new {
            return;
        }
        if let (Value::Object(a), Value::Object(b)) = (old, new) {
            let names: BTreeSet<&String> = a.keys().chain(b.keys()).collect();
            for name in names {
                let place = if place.is_empty() { name.clone() } else { format!("{place}.{name}") };
                walk(&place, a.get(name).unwrap_or(&Value::Null), b.get(name).unwrap_or(&Value::Null), into);
            }
            return;
        }
        let shown = |v: &Value| if v.is_null() { "nothing".to_owned() } else { v.to_string() };
        into.push(format!("{place}: was {}, is {}", shown(old), shown(new)));
    }
    let mut found = Vec::new();
    walk("washboard", &old.washboard.as_str().into(), &new.washboard.as_str().into(), &mut found);
    walk("", &old.design, &new.design, &mut found);
    walk("sweep.warm_start", &old.warm_start.into(), &new.warm_start.into(), &mut found);
    let keys = |s: &SweepSeal| s.grid.iter().map(|a| a.key.clone()).collect::<Vec<_>>();
    if keys(old) == keys(new) {
        for (a, b) in old.grid.iter().zip(&new.grid) {
            walk(&format!("grid.{}", a.key), &a.values.clone().into(), &b.values.clone().into(), &mut found);
        }
    } else {
        walk("grid", &keys(old).into(), &keys(new).into(), &mut found);
    }
    let files = |s: &SweepSeal| -> Value {
        Value::Object(s.inputs.iter().map(|i| (i.path.clone(), i.sha256.as_str().into())).collect())
    };
    walk("sha256 of", &files(old), &files(new), &mut found);
    let left = found.len().saturating_sub(SHOWN);
    found.truncate(SHOWN);
    if left > 0 {
        found.push(format!("and {left} more"));
    }
    found
}
