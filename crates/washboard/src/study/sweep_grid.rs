//! Values of a grid's axes, where each stands in a design, and the product of all.

use super::{Named, SweepAxis};
use serde::Deserialize;
use serde_json::{Map, Value};

/// An axis of more values is a slip of the pen.
const MOST_STEPS: usize = 100_000;

/// Tables of a design whose keys are names that may have dots themselves.
const NAMES: [&str; 9] = [
    "override",
    "normalize_at",
    "range",
    "goal.minimize",
    "goal.minimize_h2",
    "goal.minimize_hinf",
    "goal.bound",
    "goal.bound_hinf",
    "goal.bound_h2",
];

/// How an axis is divided.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Scale {
    /// Equal differences.
    #[default]
    Linear,
    /// Equal ratios.
    Log,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Range {
    from: toml::Value,
    to: toml::Value,
    steps: usize,
    #[serde(default)]
    scale: Scale,
}

/// The values of an axis: a list as it stands, or `steps` numbers from `from` to `to`, both ends exact.
pub(super) fn axis_values(value: &toml::Value) -> Result<Vec<Value>, String> {
    let expected = "a list, or { from, to, steps }";
    match value {
        toml::Value::Array(list) if list.is_empty() => {
            Err(format!("expected {expected}, found an empty list"))
        }
        toml::Value::Array(list) => list.iter().map(json).collect(),
        toml::Value::Table(_) => {
            let range = Range::deserialize(value.clone()).map_err(|e| crate::files::said(e.message()))?;
            range.values()
        }
        other => Err(format!("expected {expected}, found {other}")),
    }
}

impl Range {
    fn values(&self) -> Result<Vec<Value>, String> {
        let number = |name: &str, v: &toml::Value| {
            let found = v.as_float().or_else(|| v.as_integer().map(|i| i as f64)).filter(|f| f.is_finite());
            found.ok_or_else(|| format!("{name}: expected a number, found {v}"))
        };
        let (from, to, n) = (number("from", &self.from)?, number("to", &self.to)?, self.steps);
        if !(2..=MOST_STEPS).contains(&n) {
            return Err(format!("steps: expected 2 to {MOST_STEPS}, found {n}"));
        }
        if self.scale == Scale::Log && !(from > 0.0 && to > 0.0) {
            return Err(format!(
                "from, to: expected positive numbers for scale = \"log\", found {from} and {to}"
            ));
        }
        let last = (n - 1) as f64;
        let at = |k: usize| match (self.scale, k) {
            (_, 0) => from,
            (_, k) if k == n - 1 => to,
            // one division, so that tenths are tenths
            (Scale::Linear, k) => (from * (n - 1 - k) as f64 + to * k as f64) / last,
            (Scale::Log, k) => from * (to / from).powf(k as f64 / last),
        };
        let all: Vec<f64> = (0..n).map(at).collect();
        // orders are whole numbers: what is written as such stays so
        let (Some(first), Some(end)) = (self.from.as_integer(), self.to.as_integer()) else {
            return Ok(all.into_iter().map(Value::from).collect());
        };
        let steps = (n - 1) as i64;
        if self.scale == Scale::Linear && (end - first) % steps == 0 {
            return Ok((0..=steps).map(|k| Value::from(first + (end - first) / steps * k)).collect());
        }
        Ok(all.into_iter().map(Value::from).collect())
    }
}

/// A TOML value as JSON, which has neither infinities nor dates.
pub(super) fn json(value: &toml::Value) -> Result<Value, String> {
    Ok(match value {
        toml::Value::String(s) => Value::from(s.as_str()),
        toml::Value::Integer(i) => Value::from(*i),
        toml::Value::Float(f) if f.is_finite() => Value::from(*f),
        toml::Value::Float(f) => return Err(format!("expected finite numbers, found {f}")),
        toml::Value::Boolean(b) => Value::from(*b),
        toml::Value::Datetime(d) => {
            return Err(format!("expected a number, text or list, found the date {d}"));
        }
        toml::Value::Array(list) => Value::Array(list.iter().map(json).collect::<Result<_, _>>()?),
        toml::Value::Table(t) => {
            let pair = |(k, v): (&String, &toml::Value)| {
                json(v).map(|v| (k.clone(), v)).map_err(|e| format!("{k}: {e}"))
            };
            Value::Object(t.iter().map(pair).collect::<Result<Map<_, _>, _>>()?)
        }
    })
}

/// The places of a dotted key: names of fields and outputs keep their dots.
pub(super) fn places(key: &str) -> Vec<&str> {
    let named = |table: &&&str| key.strip_prefix(**table).is_some_and(|rest| rest.starts_with('.'));
    match NAMES.iter().find(named) {
        Some(table) => table.split('.').chain(key.get(table.len() + 1..)).collect(),
        None => key.split('.').collect(),
    }
}

/// Puts a value at a dotted key; tables on the way are made.
pub(super) fn put(design: &mut Map<String, Value>, key: &str, value: &Value) -> Result<(), String> {
    let all = places(key);
    let Some((last, way)) = all.split_last() else { return Ok(()) };
    let mut table = design;
    for name in way {
        let next = table.entry((*name).to_owned()).or_insert_with(|| Value::Object(Map::new()));
        table = match next {
            Value::Object(inner) => inner,
            _ => return Err(format!("`{name}` is no table that `{key}` could be in")),
        };
    }
    table.insert((*last).to_owned(), value.clone());
    Ok(())
}

/// How many points a grid has; none where they cannot be counted.
pub(super) fn count(grid: &[SweepAxis]) -> Option<usize> {
    grid.iter().try_fold(1usize, |n, axis| n.checked_mul(axis.values.len()))
}

/// The values at a point, the last axis varying fastest.
pub(super) fn values_at(grid: &[SweepAxis], index: usize) -> Named<Value> {
    let mut rest = index;
    let mut found: Vec<(String, Value)> = Vec::with_capacity(grid.len());
    for axis in grid.iter().rev() {
        found.push((axis.key.clone(), axis.values[rest % axis.values.len()].clone()));
        rest /= axis.values.len();
    }
    found.into_iter().rev().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(text: &str) -> Result<Vec<Value>, String> {
        let table: toml::Table = toml::from_str(&format!("x = {text}")).unwrap();
        axis_values(&table["x"])
    }

    #[test]
    fn ranges_have_exact_ends_and_whole_numbers_stay_whole() {
        let tenths = values("{ from = 0.0, to = 1.0, steps = 11 }").unwrap();
        assert_eq!(tenths[3], Value::from(0.3));
        assert_eq!(tenths[10], Value::from(1.0));
        assert_eq!(values("{ from = 0, to = 4, steps = 5 }").unwrap()[3].to_string(), "3");
        assert_eq!(values("{ from = 0, to = 1, steps = 3 }").unwrap()[1].to_string(), "0.5");
        let decades = values("{ from = 1e-9, to = 1e-7, steps = 3, scale = \"log\" }").unwrap();
        assert!((decades[1].as_f64().unwrap() / 1e-8 - 1.0).abs() < 1e-14 && decades[2] == 1e-7);
    }

    #[test]
    fn what_is_no_axis_is_said() {
        for (text, expected) in [
            ("3.0", "expected a list, or { from, to, steps }, found 3.0"),
            ("[]", "empty list"),
            ("{ from = 0.0, to = 1.0, step = 3 }", "did you mean `steps`?"),
            ("{ from = 0.0, to = 1.0, steps = 1 }", "steps: expected 2 to"),
            ("{ from = 0.0, to = 1.0, steps = 3, scale = \"log\" }", "positive numbers"),
            ("[inf]", "finite"),
        ] {
            let e = values(text).unwrap_err();
            assert!(e.contains(expected), "{text}: {e}");
        }
    }

    #[test]
    fn names_of_fields_keep_their_dots_and_the_last_axis_is_the_fastest() {
        assert_eq!(
            places("override.front.tire_damping_n_s_per_m"),
            ["override", "front.tire_damping_n_s_per_m"]
        );
        assert_eq!(places("goal.bound.tire_deflection"), ["goal", "bound", "tire_deflection"]);
        assert_eq!(places("lqg.sensor_noise"), ["lqg", "sensor_noise"]);
        assert_eq!(places("override"), ["override"]);
        let axis =
            |key: &str, n: i64| SweepAxis { key: key.into(), values: (0..n).map(Value::from).collect() };
        let grid = [axis("a", 2), axis("b", 3)];
        let all: Vec<String> = (0..6).map(|k| serde_json::to_string(&values_at(&grid, k)).unwrap()).collect();
        assert_eq!(all[1], r#"{"a":0,"b":1}"#);
        assert_eq!(all[3], r#"{"a":1,"b":0}"#);
        assert_eq!(count(&grid), Some(6));
    }
}
