//! A sweep made ready: every point's design read, every input's fingerprint taken, and what may be computed at once.

use super::design_homes::told;
use super::sweep_grid::{count, places, put, values_at};
use super::{DesignMethod, DesignSpec, Input, Named, StudyError, SweepAxis, SweepSpec};
use super::{design_outputs, load};
use crate::files::said;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::collections::BTreeSet;
use std::ops::Range;
use std::path::Path;

/// Points of a sweep at most: a row each has to fit a table.
const MOST_POINTS: usize = 1_000_000;

/// What makes two sweeps the same: where these agree, so do their points.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SweepSeal {
    /// The program's version.
    pub washboard: String,
    /// What all points have in common.
    pub design: Value,
    /// The axes.
    pub grid: Vec<SweepAxis>,
    /// Whether neighbours are begun from.
    pub warm_start: bool,
    /// Every file that a point reads.
    pub inputs: Vec<Input>,
}

impl SweepSeal {
    /// SHA-256 of its JSON.
    #[must_use]
    pub fn sha256(&self) -> String {
        super::envelope::sha256(&serde_json::to_vec(self).unwrap_or_default())
    }
}

/// A point: where it is on the grid, and its design with the names of files as they are written.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedPoint {
    /// Values by key.
    pub at: Named<Value>,
    /// The design there.
    pub design: DesignSpec,
}

/// A sweep ready to be computed.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepPlan {
    /// What was asked.
    pub spec: SweepSpec,
    /// All points in order.
    pub points: Vec<PlannedPoint>,
    /// What the results are valid for.
    pub seal: SweepSeal,
}

fn setting(field: &'static str, expected: impl Into<String>, found: impl Into<String>) -> StudyError {
    StudyError::Setting { field, expected: expected.into(), found: found.into() }
}

impl SweepPlan {
    /// Reads every point's design; computes nothing.
    ///
    /// # Errors
    /// A key that no design has, with the nearest that is; a value of the wrong kind; a design that is not complete at a point; a
    /// vehicle's field or output that it does not have; a file that cannot be read.
    pub fn new(spec: &SweepSpec) -> Result<Self, StudyError> {
        let n = count(&spec.grid).unwrap_or(usize::MAX);
        if spec.grid.is_empty() || n == 0 || n > MOST_POINTS {
            return Err(setting(
                "grid",
                format!("1 to {MOST_POINTS} points"),
                format!("{n} on {} axes", spec.grid.len()),
            ));
        }
        known(&spec.design).map_err(|e| setting("design", "keys and values of a design", e))?;
        for axis in &spec.grid {
            for value in &axis.values {
                let mut alone = Map::new();
                let put = put(&mut alone, &axis.key, value);
                put.map_err(|e| setting("grid", "keys of a design", e))?;
                let expected = format!("a key and value of a design in `{}`", axis.key);
                known(&alone).map_err(|e| setting("grid", expected, e))?;
            }
        }
        let point = |index: usize| -> Result<PlannedPoint, StudyError> {
            let at = values_at(&spec.grid, index);
            let mut table = spec.design.clone();
            for (key, value) in at.iter() {
                put(&mut table, key, value).map_err(|e| setting("grid", "keys of a design", e))?;
            }
            let design = DesignSpec::deserialize(Value::Object(table));
            let design = design.map_err(|e| {
                let place = serde_json::to_string(&at).unwrap_or_default();
                setting("grid", format!("a design at point {index} {place}"), said(&e.to_string()))
            })?;
            Ok(PlannedPoint { at, design })
        };
        let points = (0..n).map(point).collect::<Result<Vec<_>, _>>()?;
        let fixed = |p: &PlannedPoint| p.design.method == DesignMethod::FixedOrder;
        if spec.warm_start == Some(true) && !points.iter().any(fixed) {
            return Err(setting(
                "sweep.warm_start",
                "it with method fixed-order alone, which has starts",
                "true",
            ));
        }
        let mut plan = SweepPlan {
            seal: SweepSeal {
                washboard: env!("CARGO_PKG_VERSION").to_owned(),
                design: Value::Object(spec.design.clone()),
                grid: spec.grid.clone(),
                warm_start: spec.warm_start != Some(false) && points.iter().any(fixed),
                inputs: Vec::new(),
            },
            spec: spec.clone(),
            points,
        };
        plan.check_names()?;
        plan.seal.inputs = plan.read_inputs()?;
        Ok(plan)
    }

    /// What one worker computes in order: a row along the last axis where its points begin from each other, else a point.
    #[must_use]
    pub fn chains(&self) -> Vec<Range<usize>> {
        let row = self.spec.grid.last().map_or(1, |axis| axis.values.len());
        let length = if self.seal.warm_start { row } else { 1 };
        (0..self.points.len() / length).map(|k| k * length..(k + 1) * length).collect()
    }

    /// The design of a point with its files as they are to be opened.
    #[must_use]
    pub fn opened(&self, index: usize) -> DesignSpec {
        let mut design = self.points[index].design.clone();
        design.resolve(&self.spec.folder);
        design
    }

    /// Whether a point may begin from the controller of the one before it: both have the same signals.
    #[must_use]
    pub fn follows(&self, index: usize, before: usize) -> bool {
        let [a, b] = [before, index].map(|k| &self.points[k].design);
        self.seal.warm_start
            && [a, b].iter().all(|d| d.method == DesignMethod::FixedOrder)
            && (&a.vehicle, &a.road, &a.measurements, &a.structure, &a.local)
                == (&b.vehicle, &b.road, &b.measurements, &b.structure, &b.local)
    }

    /// A path below the sweep's folder as it was written.
    pub(super) fn written(&self, path: &str) -> String {
        let folder = &self.spec.folder;
        Path::new(path).strip_prefix(folder).map_or_else(|_| path.to_owned(), |p| p.display().to_string())
    }

    /// A message that begins with such a path.
    pub(super) fn written_text(&self, text: &str) -> String {
        let folder = format!("{}/", self.spec.folder.display());
        text.strip_prefix(&folder).filter(|_| folder.len() > 1).unwrap_or(text).to_owned()
    }

    /// Fields of vehicles and outputs in the grid's keys.
    fn check_names(&self) -> Result<(), StudyError> {
        let vehicles: BTreeSet<String> = (0..self.points.len()).map(|k| self.opened(k).vehicle).collect();
        let groups = |name: &str| self.points.iter().any(|p| p.design.goal.groups.get(name).is_some());
        for vehicle in vehicles {
            let loaded = load::load_vehicle(&vehicle)?;
            for axis in &self.spec.grid {
                match places(&axis.key)[..] {
                    ["override" | "normalize_at" | "range", field] => {
                        let found = loaded.spec.with_overrides(&[(field.to_owned(), 1.0)]);
                        found.map_err(|source| StudyError::Vehicle {
                            name: format!("{vehicle}: grid.{}", axis.key),
                            source,
                        })?;
                    }
                    ["goal", table, name] if table != "groups" && !groups(name) => {
                        design_outputs::outputs(&loaded.vehicle, &[name.to_owned()], "grid")?;
                    }
                    _ => {}
                }
            }
        }
        Ok(())
    }

    /// Every file that a point reads, by the name that is written, each once.
    fn read_inputs(&self) -> Result<Vec<Input>, StudyError> {
        let designs: Vec<DesignSpec> = (0..self.points.len()).map(|k| self.opened(k)).collect();
        let names = |of: fn(&DesignSpec) -> Option<&String>| -> BTreeSet<String> {
            designs.iter().filter_map(of).cloned().collect()
        };
        let mut inputs = Vec::new();
        for name in names(|d| Some(&d.vehicle)) {
            inputs.extend(load::load_vehicle(&name)?.inputs);
        }
        for name in names(|d| Some(&d.road)) {
            inputs.extend(match load::load_excitation(&name)? {
                load::LoadedExcitation::Road(road) => road.inputs,
                load::LoadedExcitation::Points(filter) => filter.inputs,
            });
        }
        for name in names(|d| d.start.as_ref()) {
            inputs.push(super::read_controller(Path::new(&name))?.1);
        }
        let mut written: Vec<Input> =
            inputs.into_iter().map(|i| Input { path: self.written(&i.path), ..i }).collect();
        written.sort_by(|a, b| a.path.cmp(&b.path));
        written.dedup();
        Ok(written)
    }
}

/// Refuses a part of a design that has a key or a kind of value that none has; what is missing is the business of the whole.
fn known(part: &Map<String, Value>) -> Result<(), String> {
    match DesignSpec::deserialize(Value::Object(part.clone())) {
        Err(e) if !e.to_string().starts_with("missing field") => Err(told(said(&e.to_string()))),
        _ => Ok(()),
    }
}
