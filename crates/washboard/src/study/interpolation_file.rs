//! The file of the job `interpolate`: nodes, measurements and constraints as JSON has them.

use crate::linalg::{C64, CMat};
use crate::subspace::{Measured, Node, Point, Side};
use serde::Deserialize;

/// Values whose squares a double holds with room to spare.
const HELD: std::ops::RangeInclusive<f64> = 1e-100..=1e100;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    pub domain: String,
    #[serde(default)]
    pub lambda: Option<f64>,
    #[serde(default)]
    pub nodes: Vec<Row>,
    #[serde(default)]
    pub measured: Vec<MeasuredRow>,
    #[serde(default)]
    pub constraints: Vec<Row>,
    #[serde(default)]
    pub order: Option<usize>,
    #[serde(default)]
    pub bound: Option<Bound>,
}

#[derive(Deserialize)]
#[serde(untagged, expecting = "expected a number or \"least\"")]
pub(super) enum Bound {
    Value(f64),
    Word(String),
}

#[derive(Deserialize)]
#[serde(untagged, expecting = "expected [re, im] or \"infinity\"")]
pub(super) enum Place {
    Finite([f64; 2]),
    Word(String),
}

pub(super) type Rows = Vec<Vec<[f64; 2]>>;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Row {
    pub z: Place,
    pub values: Vec<Rows>,
    #[serde(default)]
    pub left: Option<Vec<[f64; 2]>>,
    #[serde(default)]
    pub right: Option<Vec<[f64; 2]>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MeasuredRow {
    pub z: [f64; 2],
    pub value: Rows,
    #[serde(default = "one")]
    pub variance: f64,
}

fn one() -> f64 {
    1.0
}

fn number(x: [f64; 2]) -> C64 {
    C64::new(x[0], x[1])
}

/// A power of two, about the largest value where squares of it are not held by a double; else 1.
pub(super) fn scale_of(file: &File) -> f64 {
    let nodes = file.nodes.iter().chain(&file.constraints).flat_map(|n| &n.values);
    let all = nodes.chain(file.measured.iter().map(|m| &m.value)).flatten().flatten().flatten();
    let largest = all.map(|x| x.abs()).fold(0.0, f64::max);
    if HELD.contains(&largest) || !(largest > 0.0 && largest.is_finite()) {
        return 1.0;
    }
    2f64.powi(largest.log2().round() as i32)
}

/// Over `scale`.
fn matrix(rows: &Rows, scale: f64) -> Result<CMat, String> {
    let columns = rows.first().map_or(0, Vec::len);
    match rows.iter().find(|r| r.len() != columns || columns == 0) {
        Some(row) => {
            Err(format!("expected rows of {} numbers [re, im], found {}", columns.max(1), row.len()))
        }
        None if rows.is_empty() => Err("expected rows of numbers [re, im], found none".into()),
        None => Ok(CMat::from_fn(rows.len(), columns, |i, j| number(rows[i][j].map(|x| x / scale)))),
    }
}

pub(super) fn node(row: &Row, scale: f64) -> Result<Node, String> {
    let z = match &row.z {
        Place::Finite(z) => Point::Finite(number(*z)),
        Place::Word(w) if w == "infinity" => Point::Infinity,
        Place::Word(w) => return Err(format!("z: expected [re, im] or \"infinity\", found {w:?}")),
    };
    let direction = |v: &[[f64; 2]]| v.iter().map(|x| number(*x)).collect();
    let side = match (&row.left, &row.right) {
        (None, None) => Side::Full,
        (Some(v), None) => Side::Left(direction(v)),
        (None, Some(u)) => Side::Right(direction(u)),
        (Some(_), Some(_)) => return Err("left: expected one direction, found left and right".into()),
    };
    let values = row.values.iter().enumerate();
    let values = values
        .map(|(k, v)| matrix(v, scale).map_err(|e| format!("values[{k}]: {e}")))
        .collect::<Result<_, _>>()?;
    Ok(Node { z, values, side })
}

pub(super) fn measured(rows: &[MeasuredRow], scale: f64) -> Result<Vec<Measured>, String> {
    let one = |(k, row): (usize, &MeasuredRow)| {
        let value = matrix(&row.value, scale).map_err(|e| format!("measured[{k}].value: {e}"))?;
        Ok(Measured { z: number(row.z), value, variance: row.variance })
    };
    rows.iter().enumerate().map(one).collect()
}

/// λ must be given; said with one to begin with, the geometric mean of where the data are.
pub(super) fn no_lambda(file: &File) -> String {
    let finite = |row: &Row| match &row.z {
        Place::Finite(z) => Some(number(*z)),
        Place::Word(_) => None,
    };
    let places = file.nodes.iter().chain(&file.constraints).filter_map(finite);
    let logs: Vec<f64> = places
        .chain(file.measured.iter().map(|m| number(m.z)))
        .map(|z| z.norm().ln())
        .filter(|l| l.is_finite())
        .collect();
    let mean = (logs.iter().sum::<f64>() / logs.len().max(1) as f64).exp();
    format!(
        "lambda: expected a number above 0 in the half plane (rad/s, what goes to the middle of the unit disk; the geometric mean of the nodes' moduli is one to begin with: \"lambda\": {}), found none",
        format!("{mean:.3e}").parse::<f64>().unwrap_or(1.0)
    )
}
