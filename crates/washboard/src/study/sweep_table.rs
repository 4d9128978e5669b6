//! A sweep as a table: one row a point, one column a number.

use super::{Rms, SweepOutcome, SweepPoint};
use serde_json::Value;

/// A cell.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// Nothing there.
    Empty,
    /// A number.
    Number(f64),
    /// A text; of an infinite norm the word.
    Text(String),
}

/// What a column is taken from.
type Take<'a> = Box<dyn Fn(&SweepPoint) -> Cell + 'a>;

/// Names of columns, and rows.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepTable {
    /// `index`, keys of the grid, `status`, `why`, `order`, `objective_…`, `lower_bound`, numbers of each output, `warnings`, `controller`.
    pub columns: Vec<String>,
    /// A cell a column.
    pub rows: Vec<Vec<Cell>>,
}

impl SweepOutcome {
    /// All points as a table.
    #[must_use]
    pub fn table(&self) -> SweepTable {
        let mut columns: Vec<(String, Take<'_>)> =
            vec![("index".into(), Box::new(|p| Cell::Number(p.index as f64)))];
        for axis in &self.grid {
            columns.push((axis.key.clone(), Box::new(|p| cell(p.at.get(&axis.key)))));
        }
        columns.push(("status".into(), Box::new(|p| Cell::Text(p.status.name().into()))));
        columns.push(("why".into(), Box::new(|p| text(p.why.as_ref()))));
        columns.push(("order".into(), Box::new(|p| number(p.order.map(|n| n as f64)))));
        for name in ["passive", "verified", "limit"] {
            columns.push((
                format!("objective_{name}"),
                Box::new(move |p| number(p.objective.get(name).copied())),
            ));
        }
        if self.points.iter().any(|p| p.lower_bound.is_some()) {
            columns.push(("lower_bound".into(), Box::new(|p| number(p.lower_bound))));
        }
        for name in self.outputs() {
            let shown = |r: Option<&Rms>| match r {
                Some(Rms::Finite(v)) => Cell::Number(*v),
                Some(Rms::Infinite(_)) => Cell::Text("infinite".into()),
                None => Cell::Empty,
            };
            columns.push((format!("rms_{name}"), Box::new(move |p| shown(p.rms.get(name)))));
            columns.push((
                format!("rms_relative_{name}"),
                Box::new(move |p| number(p.rms_relative.get(name).copied())),
            ));
            columns.push((format!("h2_{name}"), Box::new(move |p| shown(p.h2.get(name)))));
            columns.push((
                format!("h2_relative_{name}"),
                Box::new(move |p| number(p.h2_relative.get(name).copied())),
            ));
            columns.push((format!("hinf_{name}"), Box::new(move |p| number(p.hinf.get(name).copied()))));
            columns.push((
                format!("hinf_relative_{name}"),
                Box::new(move |p| number(p.hinf_relative.get(name).copied())),
            ));
        }
        for name in self.metric_names() {
            columns.push((name.to_owned(), Box::new(move |p| number(p.metrics.get(name).copied()))));
        }
        columns.push(("warnings".into(), Box::new(|p| Cell::Text(p.warnings.join(" ")))));
        columns.push(("controller".into(), Box::new(|p| text(p.controller.as_ref()))));
        let rows = self.points.iter().map(|p| columns.iter().map(|(_, take)| take(p)).collect()).collect();
        SweepTable { columns: columns.into_iter().map(|(name, _)| name).collect(), rows }
    }

    /// Metrics of any point, in the order in which they first appear.
    #[must_use]
    pub fn metric_names(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for (name, _) in self.points.iter().flat_map(|p| p.metrics.iter()) {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        names
    }

    /// Outputs of any point, in the order in which they first appear.
    #[must_use]
    pub fn outputs(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for (name, _) in self.points.iter().flat_map(|p| p.rms.iter()) {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        names
    }
}

impl SweepTable {
    /// Comma-separated, one header; numbers as JSON writes them, nothing where there is none.
    #[must_use]
    pub fn csv(&self) -> Vec<u8> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        // into memory: there is nothing that could fail
        let _ = writer.write_record(&self.columns);
        for row in &self.rows {
            let _ = writer.write_record(row.iter().map(Cell::text));
        }
        writer.into_inner().unwrap_or_default()
    }
}

impl Cell {
    /// As it stands in `table.csv`.
    #[must_use]
    pub fn text(&self) -> String {
        match self {
            Cell::Empty => String::new(),
            Cell::Number(v) if v.fract() == 0.0 && v.abs() < 1e15 => format!("{v:.0}"),
            Cell::Number(v) => Value::from(*v).to_string(),
            Cell::Text(t) => t.clone(),
        }
    }
}

fn number(v: Option<f64>) -> Cell {
    v.filter(|v| v.is_finite()).map_or(Cell::Empty, Cell::Number)
}

fn text(v: Option<&String>) -> Cell {
    v.map_or(Cell::Empty, |t| Cell::Text(t.clone()))
}

fn cell(value: Option<&Value>) -> Cell {
    match value {
        Some(Value::Number(n)) => number(n.as_f64()),
        Some(Value::String(s)) => Cell::Text(s.clone()),
        Some(other) => Cell::Text(other.to_string()),
        None => Cell::Empty,
    }
}
