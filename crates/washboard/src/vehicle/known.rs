//! Known values of a family's numbers: which leaf of a vehicle's table a name means, and the scale that follows from it.

use super::VehicleError;
use super::parametric::CG;
use serde_json::Value;

/// Endings of masses, inertias, stiffnesses and dampings: responses do not show their common factor.
const OF_SCALE: [&str; 5] = ["_kg", "_kg_m2", "_n_per_m", "_n_s_per_m", "_n_m_per_rad"];
/// Distances that the recording's wheels say: nobody else may.
const OF_WHEELS: [&str; 3] = ["rear_axle_m", "front_track_m", "rear_track_m"];

/// A number of a table: its path, and its value.
pub(super) type Leaf = (Vec<String>, f64);

/// Whether a name means this leaf: its path, the path without its side, or its field of any axle.
pub(super) fn names(name: &str, path: &[String]) -> bool {
    let side = path.last().is_some_and(|p| p.parse::<usize>().is_ok());
    let plain = &path[..path.len() - usize::from(side)];
    path.join(".") == name || plain.join(".") == name || plain.last().is_some_and(|last| last == name)
}

/// Whether a field is a mass, inertia, stiffness or damping; its side, if any, does not matter.
pub(crate) fn of_scale(name: &str) -> bool {
    let plain = name.trim_end_matches(".0").trim_end_matches(".1");
    OF_SCALE.iter().any(|end| plain.ends_with(end))
}

/// Writes a known value into all leaves that it names.
pub(super) fn apply(table: &mut Value, name: &str, value: f64, found: &[Leaf]) -> Result<(), VehicleError> {
    let field = format!("known {name}");
    if OF_WHEELS.contains(&name) {
        let (expected, found) = ("another field: the places of the wheels give this one", value.to_string());
        return Err(VehicleError::Field { field, expected, found });
    }
    if !value.is_finite() {
        let (expected, found) = ("a finite number", value.to_string());
        return Err(VehicleError::Field { field, expected, found });
    }
    let wheelbase = table[CG].as_f64().zip(table["rear_axle_m"].as_f64()).map(|(a, b)| a + b);
    let mut written = false;
    for (path, _) in found.iter().filter(|(path, _)| names(name, path)) {
        if let Some(slot) = table.pointer_mut(&format!("/{}", path.join("/"))) {
            *slot = Value::from(value);
            written = true;
        }
    }
    if let (CG, Some(l)) = (name, wheelbase) {
        table["rear_axle_m"] = Value::from(l - value);
    }
    if written { Ok(()) } else { Err(unknown(name, found)) }
}

/// Multiplies what is not known of the scale by the geometric mean of the known values over the start's own.
pub(super) fn follow(table: &mut Value, known: &[(String, f64)], found: &[Leaf]) {
    let is_known = |path: &[String]| known.iter().find(|(n, _)| names(n, path));
    let ratios: Vec<f64> = found
        .iter()
        .filter(|(path, start)| of_scale(&path.join(".")) && *start > 0.0)
        .filter_map(|(path, start)| is_known(path).map(|(_, v)| v / start))
        .filter(|ratio| *ratio > 0.0)
        .map(f64::ln)
        .collect();
    if ratios.is_empty() {
        return;
    }
    let factor = (ratios.iter().sum::<f64>() / ratios.len() as f64).exp();
    for (path, start) in
        found.iter().filter(|(path, _)| of_scale(&path.join(".")) && is_known(path).is_none())
    {
        if let Some(slot) = table.pointer_mut(&format!("/{}", path.join("/"))) {
            *slot = Value::from(factor * start);
        }
    }
}

pub(super) fn unknown(name: &str, found: &[Leaf]) -> VehicleError {
    let known: Vec<String> = found.iter().map(|(path, _)| path.join(".")).collect();
    // a name may stand without its axle, and its unit is what people leave out
    let last = |path: &str| path.rsplit('.').next().unwrap_or(path).to_owned();
    let bare: Vec<String> = known.iter().map(|k| last(k)).collect();
    let unit = ["_n_s_per_m", "_n_per_m", "_kg_m2", "_kg", "_m"];
    let stem = |k: &str| unit.iter().find_map(|u| k.strip_suffix(u)).unwrap_or(k).to_owned();
    let stems: Vec<String> = bare.iter().map(|k| stem(k)).collect();
    let near = |of: &[String]| crate::files::nearest(name, of.iter().map(String::as_str)).map(str::to_owned);
    let by_stem = || near(&stems).and_then(|n| Some(bare[stems.iter().position(|s| *s == n)?].clone()));
    VehicleError::Unknown {
        what: "parameter",
        name: name.to_owned(),
        suggestion: near(&known).or_else(|| near(&bare)).or_else(by_stem),
        known: known.join(", "),
    }
}

/// All numbers of a table with their paths, in the file's order.
pub(super) fn leaves(table: &Value) -> Vec<Leaf> {
    let mut found = Vec::new();
    collect(table, &mut Vec::new(), &mut found);
    found
}

fn collect(value: &Value, path: &mut Vec<String>, into: &mut Vec<Leaf>) {
    let mut below = |key: String, v: &Value| {
        path.push(key);
        collect(v, path, into);
        path.pop();
    };
    match value {
        Value::Object(map) => map.iter().for_each(|(key, v)| below(key.clone(), v)),
        Value::Array(items) => items.iter().enumerate().for_each(|(i, v)| below(i.to_string(), v)),
        Value::Number(n) => into.extend(n.as_f64().map(|v| (path.clone(), v))),
        _ => {}
    }
}
