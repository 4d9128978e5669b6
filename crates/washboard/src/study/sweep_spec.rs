//! What a sweep is told: a SWEEP.toml, which is a DESIGN.toml with a grid, as data.

use super::StudyError;
use super::sweep_grid::{axis_values, json};
use crate::files::{FileError, parse_toml, read_text};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::path::{Path, PathBuf};

/// A design at every point of a grid.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SweepSpec {
    /// What all points have in common: a design, but for what the grid says.
    pub design: Map<String, Value>,
    /// The axes: of the product of their values the last varies fastest.
    pub grid: Vec<SweepAxis>,
    /// Whether a fixed-order design begins at its neighbour along the last axis too; where nothing is said it does.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub warm_start: Option<bool>,
    /// What names of files are relative to.
    #[serde(default, skip_serializing_if = "is_empty")]
    pub folder: PathBuf,
}

fn is_empty(folder: &Path) -> bool {
    folder.as_os_str().is_empty()
}

/// One axis of a grid.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SweepAxis {
    /// Dotted path into the design: `goal.order`, `override.front.tire_damping_n_s_per_m`.
    pub key: String,
    /// Its values in order.
    pub values: Vec<Value>,
}

/// How a sweep is run.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct SweepSection {
    warm_start: Option<bool>,
}

impl SweepSpec {
    /// The sweep of a file; the files that it names are relative to it.
    ///
    /// # Errors
    /// A file that cannot be read or is not TOML, no grid, an axis that is neither a list nor `{ from, to, steps }`. Keys that
    /// no design has are refused by [`SweepPlan::new`](super::SweepPlan::new).
    pub fn read(path: &Path) -> Result<Self, StudyError> {
        let text = read_text(path)?;
        let wrong = |message: String| FileError::content(path, None, message);
        let mut file: toml::Table = parse_toml(&text, path)?;
        let section = match file.remove("sweep") {
            Some(section) => SweepSection::deserialize(section)
                .map_err(|e| wrong(format!("[sweep] {}", crate::files::said(e.message()))))?,
            None => SweepSection::default(),
        };
        let grid = match file.remove("grid") {
            Some(toml::Value::Table(grid)) => grid,
            Some(other) => {
                let found = other.type_str();
                return Err(
                    wrong(format!("grid: expected a table [grid], found a value of type {found}")).into()
                );
            }
            None => {
                let expected =
                    "[grid] with keys such as \"override.tire_damping_n_s_per_m\" = { from, to, steps }";
                return Err(wrong(format!("expected {expected}, found none")).into());
            }
        };
        let mut axes = Vec::new();
        collect(&grid, "", &mut axes).map_err(wrong)?;
        let order = written(&text);
        let place = |key: &str| order.iter().position(|k| k == key).unwrap_or(usize::MAX);
        axes.sort_by_key(|a| place(&a.key));
        let design = match json(&toml::Value::Table(file)).map_err(wrong)? {
            Value::Object(design) => design,
            _ => Map::new(),
        };
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        Ok(SweepSpec { design, grid: axes, warm_start: section.warm_start, folder })
    }
}

/// A table of the grid that is an axis by itself, and no part of a dotted path.
fn is_range(table: &toml::Table) -> bool {
    ["from", "to", "steps"].iter().any(|k| table.contains_key(*k))
}

/// The axes of a table: `goal.order = …` and `"goal.order" = …` are the same.
fn collect(table: &toml::Table, prefix: &str, into: &mut Vec<SweepAxis>) -> Result<(), String> {
    for (name, value) in table {
        let key = dotted(prefix, name);
        match value {
            toml::Value::Table(inner) if !is_range(inner) => collect(inner, &key, into)?,
            value => {
                if into.iter().any(|a| a.key == key) {
                    return Err(format!("grid.{key}: expected once, found twice"));
                }
                let values = axis_values(value).map_err(|e| format!("grid.{key}: {e}"))?;
                into.push(SweepAxis { key, values });
            }
        }
    }
    Ok(())
}

fn dotted(prefix: &str, name: &str) -> String {
    if prefix.is_empty() { name.to_owned() } else { format!("{prefix}.{name}") }
}

/// Dotted keys of the grid in the order in which they are written: a table by itself does not keep it.
fn written(text: &str) -> Vec<String> {
    fn walk(table: &toml::de::DeTable<'_>, prefix: &str, into: &mut Vec<(usize, String)>) {
        for (name, value) in table {
            let key = dotted(prefix, name.get_ref());
            if let toml::de::DeValue::Table(inner) = value.get_ref() {
                walk(inner, &key, into);
            }
            into.push((name.span().start, key));
        }
    }
    let mut found = Vec::new();
    if let Ok(file) = toml::de::DeTable::parse(text) {
        let grid = file.get_ref().iter().find(|(name, _)| name.get_ref() == "grid");
        if let Some(toml::de::DeValue::Table(grid)) = grid.map(|(_, v)| v.get_ref()) {
            walk(grid, "", &mut found);
        }
    }
    found.sort();
    found.into_iter().map(|(_, key)| key).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_keep_the_order_of_the_file_and_both_ways_of_dots() {
        let text = "speed_m_s = 20\n[grid]\n\"z.b\" = [1]\na = [2.5]\nm.x = { from = 0, to = 4, steps = 3 }\nc = [[\"p\"]]\n[sweep]\nwarm_start = false\n";
        let path = std::env::temp_dir().join(format!("washboard-sweep-{}.toml", std::process::id()));
        std::fs::write(&path, text).unwrap();
        let spec = SweepSpec::read(&path).unwrap();
        std::fs::remove_file(&path).unwrap();
        let axes: Vec<String> =
            spec.grid.iter().map(|a| format!("{} {}", a.key, Value::from(a.values.clone()))).collect();
        assert_eq!(axes, ["z.b [1]", "a [2.5]", "m.x [0,2,4]", "c [[\"p\"]]"]);
        assert_eq!((spec.warm_start, &spec.design["speed_m_s"]), (Some(false), &Value::from(20)));
    }
}
