//! What `road analytic` reads: angles, and a part of a function at them.

use super::number_table::NumberTable;
use super::{RoadAnalyticSpec, StudyError};
use crate::units::rad_per_s;
use std::f64::consts::PI;

/// Frequencies: name, in cycles.
pub(super) const AXES: [(&str, bool); 5] = [
    ("theta_rad", false),
    ("omega_rad_s", false),
    ("freq_hz", true),
    ("nu_rad_per_m", false),
    ("n_cycles_per_m", true),
];

/// Angles, λ, and whether λ was chosen here.
pub(super) fn angles(
    table: &NumberTable,
    spec: &RoadAnalyticSpec,
) -> Result<(Vec<f64>, Option<f64>, bool), StudyError> {
    let found: Vec<_> = AXES.iter().filter_map(|a| table.index(a.0).map(|k| (k, a))).collect();
    let [(at, (name, cycles))] = found.as_slice() else {
        return Err(
            table.header_error("one column theta_rad, omega_rad_s, freq_hz, nu_rad_per_m or n_cycles_per_m")
        );
    };
    table.ascending(*at, 0.0)?;
    let values = &table.columns[*at];
    if let Some(l) = spec.lambda_rad
        && !(l > 0.0 && l.is_finite())
    {
        let expected = "a positive number".to_owned();
        return Err(StudyError::Setting { field: "lambda", expected, found: l.to_string() });
    }
    if *name == "theta_rad" {
        if spec.lambda_rad.is_some() {
            let expected = "no lambda with theta_rad, which is on the circle already".to_owned();
            return Err(StudyError::Setting { field: "lambda", expected, found: "one".into() });
        }
        if let Some(row) = values.iter().position(|t| *t > PI) {
            let message = format!("column theta_rad: expected angles from 0 to pi, found {}", values[row]);
            return Err(table.row_error(row, message));
        }
        return Ok((values.clone(), None, false));
    }
    let omega: Vec<f64> = values.iter().map(|w| if *cycles { rad_per_s(*w) } else { *w }).collect();
    let low = omega.iter().copied().find(|w| *w > 0.0).unwrap_or(1.0);
    let high = omega.last().copied().filter(|w| *w > 0.0).unwrap_or(1.0);
    let lambda = spec.lambda_rad.unwrap_or((low * high).sqrt());
    let theta = omega.iter().map(|w| 2.0 * (w / lambda).atan()).collect();
    Ok((theta, Some(lambda), spec.lambda_rad.is_none()))
}

/// What is fitted: logarithms of magnitudes, phases without jumps.
pub(super) fn checked(table: &NumberTable, given: &str, raw: Vec<f64>) -> Result<Vec<f64>, StudyError> {
    match given {
        "magnitude" => {
            if let Some(row) = raw.iter().position(|m| !(*m > 0.0)) {
                let message = format!("column magnitude: expected a number above 0, found {}", raw[row]);
                return Err(table.row_error(row, message));
            }
            Ok(raw.iter().map(|m| m.ln()).collect())
        }
        "phase_rad" => {
            if let Some(row) = (1..raw.len()).find(|k| (raw[*k] - raw[k - 1]).abs() > PI) {
                let message = format!(
                    "column phase_rad: expected a continuous phase, found {} after {}: unwrap it first",
                    raw[row],
                    raw[row - 1]
                );
                return Err(table.row_error(row, message));
            }
            Ok(raw)
        }
        _ => Ok(raw),
    }
}
