//! A result of a design read back, refused where its parts contradict each other.

use super::design_outcome::{DesignOutcome, DesignStatus, Measured};
use super::design_outputs::swings;
use super::{Envelope, Rms, StudyError, read_result};
use crate::files::FileError;
use crate::linalg::C64;
use std::path::{Path, PathBuf};

/// The result of `design` in a directory or file, and the file's path.
///
/// # Errors
/// A file that is missing or of another schema or command, a controller that does not fit its names or order, poles that
/// contradict `stable`, negative norms, gains of another length: the message names file and field.
pub fn read_design(path: &Path) -> Result<(PathBuf, Envelope<DesignOutcome>), StudyError> {
    let file = if path.is_dir() { path.join("result.json") } else { path.to_owned() };
    let result = read_result::<DesignOutcome>(&file)?;
    let wrong = |message: String| StudyError::from(FileError::content(&file, None, message));
    if result.command != "design" {
        return Err(wrong(format!("command: expected `design`, found `{}`", result.command)));
    }
    check(&result.outcome).map_err(wrong)?;
    Ok((file, result))
}

/// What contradicts the rest: field, what was expected, what was found.
pub(super) fn check(o: &DesignOutcome) -> Result<(), String> {
    let designed = o.status == DesignStatus::Designed;
    if designed != (o.controller.is_some() && o.verified.is_some()) {
        return Err(format!(
            "status: expected one that fits the controller {}, found `{}`",
            if o.controller.is_some() { "beside it" } else { "that is missing" },
            serde_json::to_value(o.status)
                .ok()
                .and_then(|v| v.as_str().map(str::to_owned))
                .unwrap_or_default()
        ));
    }
    if let Some(file) = &o.controller {
        let order = file.state_space().map_err(|e| e.to_string())?.order();
        if o.order != Some(order) {
            return Err(format!(
                "order: expected {order}, found {}",
                o.order.map_or_else(|| "none".to_owned(), |n| n.to_string())
            ));
        }
    }
    for (field, measured) in [("passive", Some(&o.passive)), ("verified", o.verified.as_ref())] {
        let Some(m) = measured else { continue };
        numbers(m).map_err(|e| format!("{field}.{e}"))?;
        if field == "verified" && !m.stable {
            return Err("verified.stable: expected true of a design, found false".into());
        }
    }
    let bins = o.gains.freq_hz.len();
    for (name, values) in o.gains.passive.iter().chain(o.gains.closed.iter()) {
        if values.len() != bins {
            return Err(format!("gains.{name}: expected {bins} values, found {}", values.len()));
        }
    }
    Ok(())
}

fn numbers(m: &Measured) -> Result<(), String> {
    // a mode that swings on is on either side of the axis by rounding
    let poles: Vec<C64> = m.poles.iter().map(|p| C64::new(p[0], p[1])).collect();
    let inside = poles.iter().all(|p| p.re < 0.0);
    if m.stable != inside && (m.stable || swings(&poles).is_none()) {
        return Err(format!("poles: they contradict stable = {}", m.stable));
    }
    let rms = m.h2.iter().chain(m.rms.iter()).chain(m.rms_with_noise.iter());
    for (name, value) in rms {
        if let Rms::Finite(v) = value
            && !(*v >= 0.0)
        {
            return Err(format!("rms or h2 of {name}: expected a number ≥ 0, found {v}"));
        }
    }
    match m.hinf.iter().find(|(_, v)| !(**v >= 0.0)) {
        Some((name, v)) => Err(format!("hinf.{name}: expected a number ≥ 0, found {v}")),
        None => Ok(()),
    }
}
