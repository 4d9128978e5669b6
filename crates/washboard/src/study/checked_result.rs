//! A result of an identification read back, refused where its numbers contradict each other.

use super::identify_outcome::IdentifyOutcome;
use super::{Envelope, StudyError, read_result};
use crate::files::{FileError, said};
use crate::road::IsoClass;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// A written number is read back to the last bit: what differs by more than this share was changed by hand.
const SAME: f64 = 1e-6;
/// Lists longer than this are not searched for the element that cannot be read.
const SEARCHED: usize = 64;

/// What contradicts the rest: field, what was expected, what was found.
struct Fault(String, String, String);

/// The result of `identify` or `demo` in a directory or file, and the file's path.
///
/// # Errors
/// A file that is missing, is of another schema or command, has a field of the wrong kind, or numbers that cannot be one
/// result: the message names file and field.
pub fn read_identification(path: &Path) -> Result<(PathBuf, Envelope<IdentifyOutcome>), StudyError> {
    let file = if path.is_dir() { path.join("result.json") } else { path.to_owned() };
    let wrong = |message: String| StudyError::from(FileError::content(&file, None, message));
    let raw = read_result::<Value>(&file)?;
    if !matches!(raw.command.as_str(), "identify" | "demo") {
        return Err(wrong(format!("command: expected `identify` or `demo`, found `{}`", raw.command)));
    }
    let outcome: IdentifyOutcome = serde_json::from_value(raw.outcome.clone()).map_err(|e| {
        let field = culprit(&raw.outcome).map_or_else(String::new, |f| format!("{f}: "));
        wrong(format!("{field}{}", said(&e.to_string())))
    })?;
    if let Err(Fault(field, expected, found)) = check(&outcome) {
        return Err(wrong(format!("{field}: expected {expected}, found {found}")));
    }
    Ok((
        file,
        Envelope { schema_version: raw.schema_version, command: raw.command, inputs: raw.inputs, outcome },
    ))
}

/// The field that cannot be read: the one whose replacement makes the rest readable.
fn culprit(root: &Value) -> Option<String> {
    let readable = |v: &Value| serde_json::from_value::<IdentifyOutcome>(v.clone()).is_ok();
    let stand_ins = [Value::Null, json!(1.0), json!(1), json!(""), json!([]), json!(false)];
    let empty = serde_json::to_value(IdentifyOutcome::default()).ok()?;
    let mut found = (String::new(), String::new());
    loop {
        let children: Vec<(String, String)> = match root.pointer(&found.0)? {
            Value::Object(o) => o
                .keys()
                .map(|k| {
                    let dot = if found.1.is_empty() { "" } else { "." };
                    let escaped = k.replace('~', "~0").replace('/', "~1");
                    (format!("{}/{escaped}", found.0), format!("{}{dot}{k}", found.1))
                })
                .collect(),
            Value::Array(a) if a.len() <= SEARCHED => {
                (0..a.len()).map(|k| (format!("{}/{k}", found.0), format!("{}[{k}]", found.1))).collect()
            }
            _ => Vec::new(),
        };
        let at_fault = |(pointer, _): &(String, String)| {
            stand_ins.iter().chain(empty.pointer(pointer)).any(|s| {
                let mut mended = root.clone();
                mended.pointer_mut(pointer).map(|v| *v = s.clone()).is_some() && readable(&mended)
            }) || without_element(root, pointer).is_some_and(|v| readable(&v))
        };
        match children.into_iter().find(at_fault) {
            Some(child) => found = child,
            None => return (!found.1.is_empty()).then_some(found.1),
        }
    }
}

/// The whole without one element of a list.
fn without_element(root: &Value, pointer: &str) -> Option<Value> {
    let (parent, last) = pointer.rsplit_once('/')?;
    let mut mended = root.clone();
    let list = mended.pointer_mut(parent)?.as_array_mut()?;
    let index: usize = last.parse().ok()?;
    (index < list.len()).then(|| list.remove(index))?;
    Some(mended)
}

/// Whether the numbers can be one result's.
fn check(o: &IdentifyOutcome) -> Result<(), Fault> {
    let fault = |field: String, expected: &str, found: String| Err(Fault(field, expected.to_owned(), found));
    let sd = |field: String, sd: Option<f64>| match sd {
        Some(s) if !(s >= 0.0) => fault(field, "a number ≥ 0", s.to_string()),
        _ => Ok(()),
    };
    for (k, m) in o.modes.iter().enumerate() {
        let field = |name: &str| format!("modes[{k}].{name}");
        if !(m.freq_hz > 0.0) {
            return fault(field("freq_hz"), "a positive number", m.freq_hz.to_string());
        }
        let size = m.pole[0].hypot(m.pole[1]);
        let of_pole = size / std::f64::consts::TAU;
        if !((m.freq_hz - of_pole).abs() <= SAME * of_pole) {
            return fault(field("freq_hz"), &format!("{of_pole}, which is |pole|/2π"), m.freq_hz.to_string());
        }
        if !((m.damping + m.pole[0] / size).abs() <= SAME) {
            let expected = format!("{}, which is −Re pole/|pole|", -m.pole[0] / size);
            return fault(field("damping"), &expected, m.damping.to_string());
        }
        sd(field("freq_sd_hz"), m.freq_sd_hz)?;
        sd(field("damping_sd"), m.damping_sd)?;
    }
    for (k, p) in o.parameters.iter().enumerate() {
        sd(format!("parameters[{k}].sd"), Some(p.sd))?;
    }
    if let Some(r) = &o.road {
        if !(r.roughness_m3 > 0.0) {
            return fault("road.roughness_m3".into(), "a positive number", r.roughness_m3.to_string());
        }
        sd("road.roughness_sd_m3".into(), Some(r.roughness_sd_m3))?;
        sd("road.exponent_sd".into(), Some(r.exponent_sd))?;
        let (one_sided, _) = r.one_sided();
        // at a limit between classes the last bit decides
        let classes = [1.0 - SAME, 1.0 + SAME].map(|f| IsoClass::of(one_sided * f));
        if !classes.contains(&r.class) {
            return fault(
                "road.class".into(),
                &format!("{:?} for this roughness", classes[0]),
                format!("{:?}", r.class),
            );
        }
    }
    if let Some(c) = &o.coherence {
        sd("coherence.mu_sd".into(), Some(c.mu_sd))?;
    }
    sd("delay_sd_s".into(), o.delay_sd_s)?;
    let bins = o.spectra.freq_hz.len();
    if !o.spectra.freq_hz.windows(2).all(|w| w[0] < w[1]) {
        return fault("spectra.freq_hz".into(), "ascending frequencies", "others".into());
    }
    for (k, c) in o.spectra.channels.iter().enumerate() {
        if c.measured.len() != bins {
            return fault(
                format!("spectra.channels[{k}].measured"),
                &format!("{bins} values"),
                c.measured.len().to_string(),
            );
        }
        if let Some(v) = c.measured.iter().find(|v| **v < 0.0) {
            return fault(format!("spectra.channels[{k}].measured"), "densities ≥ 0", v.to_string());
        }
    }
    Ok(())
}
