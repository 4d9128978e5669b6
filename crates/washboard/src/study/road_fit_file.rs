//! The file of a fitted filter: a road file, of one track or of all inputs of a vehicle, or a state space.

use super::StudyError;
use super::road_fit::{RoadFitOutcome, pairs};
use super::road_fit_filter::RoadFilter;
use super::road_fit_source::FitSamples;
use crate::files::FileError;
use crate::road::{MatrixFilterKind, MatrixFilterSpec, RoadKind, RoadSpec};
use serde::Serialize;
use std::path::Path;

/// Refuses another ending than `.toml` and `.json`.
pub(super) fn check_name(path: &Path) -> Result<(), FileError> {
    match path.extension().and_then(|e| e.to_str()) {
        Some("json" | "toml") => Ok(()),
        _ => {
            let message = "expected a name that ends in .toml (a road file) or .json (a state space)";
            Err(FileError::content(path, None, message))
        }
    }
}

/// The road of a scalar filter.
pub(super) fn road_of(filter: &RoadFilter, samples: &FitSamples) -> RoadSpec {
    let g = &filter.system;
    let n = g.order();
    RoadSpec {
        kind: RoadKind::Filter,
        a: Some((0..n).map(|i| (0..n).map(|j| g.a()[(i, j)]).collect()).collect()),
        b: Some((0..n).map(|i| g.b()[(i, 0)]).collect()),
        c: Some((0..n).map(|j| g.c()[(0, j)]).collect()),
        d: Some(g.d()[(0, 0)]),
        poles: Some(pairs(&filter.poles)),
        zeros: Some(pairs(&filter.zeros)),
        gain: filter.gain,
        of: Some(samples.of),
        variable: Some(samples.variable),
        fitted_band_rad: Some(filter.fit.band_rad),
        coherence: samples.coherence,
        ..RoadSpec::default()
    }
}

/// The bytes of `.toml` or `.json`.
pub(super) fn filter_file(
    path: &Path,
    outcome: &RoadFitOutcome,
    samples: &FitSamples,
    source: &str,
) -> Result<Vec<u8>, StudyError> {
    if path.extension().is_some_and(|e| e == "json") {
        let value = serde_json::json!({
            "a": outcome.a, "b": outcome.b, "c": outcome.c, "d": outcome.d,
            "poles": outcome.poles, "zeros": outcome.zeros, "gain": outcome.gain,
            "of": outcome.of, "variable": outcome.variable, "band": outcome.band, "unit": outcome.unit,
            "points": outcome.points, "log10_rms_error": outcome.log10_rms_error,
        });
        return Ok(format!("{value:#}\n").into_bytes());
    }
    if outcome.c.len() > 1 {
        let filter = MatrixFilterSpec {
            kind: MatrixFilterKind::MatrixFilter,
            of: outcome.of,
            variable: outcome.variable,
            points: outcome.points.clone(),
            fitted_band_rad: Some(outcome.band),
            a: outcome.a.clone(),
            b: outcome.b.clone(),
            c: outcome.c.clone(),
            d: Some(outcome.d.clone()),
        };
        // what is written can be read
        filter.build().map_err(|e| FileError::content(path, None, e.to_string()))?;
        return written(path, &filter, outcome, source);
    }
    let column = |m: &[Vec<f64>]| m.iter().filter_map(|r| r.first().copied()).collect::<Vec<f64>>();
    let road = RoadSpec {
        kind: RoadKind::Filter,
        a: Some(outcome.a.clone()),
        b: Some(column(&outcome.b)),
        c: outcome.c.first().cloned(),
        d: outcome.d.first().and_then(|r| r.first().copied()),
        poles: Some(outcome.poles.clone()),
        zeros: Some(outcome.zeros.clone()),
        gain: outcome.gain,
        of: Some(outcome.of),
        variable: Some(outcome.variable),
        fitted_band_rad: Some(outcome.band),
        coherence: samples.coherence,
        ..RoadSpec::default()
    };
    written(path, &road, outcome, source)
}

fn written(
    path: &Path,
    road: &impl Serialize,
    outcome: &RoadFitOutcome,
    source: &str,
) -> Result<Vec<u8>, StudyError> {
    let text = toml::to_string(road).map_err(|e| FileError::content(path, None, e.to_string()))?;
    // a source's name is a user's: it stays on its line
    let source: String = source.chars().filter(|c| !c.is_control()).collect();
    let head = format!(
        "# washboard road fit {source}\n# order {}, fitted from {:.4e} to {:.4e} {}: log10 rms error {:.1e}; beyond that band it is no more than the filter's own continuation\n",
        outcome.order, outcome.band[0], outcome.band[1], outcome.unit, outcome.log10_rms_error
    );
    Ok((head + &text).into_bytes())
}
