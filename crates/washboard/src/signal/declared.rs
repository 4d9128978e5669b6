//! What a description declares, made sure of: fields that fit each other, units that fit their quantity, wheels that exist.

use super::error::suggest;
use super::{Channel, ChannelDescription, Column, Format, Quantity, RecordingDescription, SignalError, Unit};
use std::path::Path;

/// What no type says: fields that exclude or need each other.
pub(super) fn check(d: &RecordingDescription, path: &Path) -> Result<(), SignalError> {
    let fail =
        |field: &str, expected: &str, found: &str| Err(SignalError::field(path, field, expected, found));
    if d.rate_hz.is_some() && d.time_column.is_some() {
        return fail("rate_hz", "either rate_hz or time_column", "both");
    }
    if d.rate_hz.is_none() && d.time_column.is_none() && format(d, path)? != Format::Sst {
        return fail("rate_hz", "rate_hz or time_column", "neither");
    }
    if d.time_column.is_none() && (d.time_unit.is_some() || d.stamps.is_some()) {
        return fail("time_column", "a time_column for time_unit and stamps to speak of", "none");
    }
    let of_speed = [d.speed_m_s.is_some(), d.speed_column.is_some(), d.speed_file.is_some()];
    match of_speed.iter().filter(|x| **x).count() {
        0 | 1 => {}
        n => return fail("speed_m_s", "one of speed_m_s, speed_column and speed_file", &n.to_string()),
    }
    let measured = d.speed_column.is_some() || d.speed_file.is_some();
    if measured != d.speed_unit.is_some() {
        let expected = "a unit (m/s, km/h, knots, mph) with speed_column or speed_file, and only there";
        return fail("speed_unit", expected, if measured { "none" } else { "one without them" });
    }
    if let Some([a, b]) = d.span_s.filter(|[a, b]| a.is_nan() || b.is_nan() || a >= b) {
        return fail("span_s", "two times in s, ascending", &format!("[{a}, {b}]"));
    }
    if let Some(c) = d.delimiter.filter(|c| !c.is_ascii() || *c == '"' || *c == '\n' || *c == '\r') {
        return fail("delimiter", "one ASCII character", &format!("{c:?}"));
    }
    if d.channels.is_empty() {
        return fail("channel", "at least one [[channel]]", "none");
    }
    Ok(())
}

/// The data's format: declared, or by the extension.
pub(super) fn format(d: &RecordingDescription, path: &Path) -> Result<Format, SignalError> {
    if let Some(format) = d.format {
        return Ok(format);
    }
    let extension = d.data.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    match extension.as_str() {
        "csv" | "txt" => Ok(Format::Csv),
        "npy" => Ok(Format::Npy),
        "sst" => Ok(Format::Sst),
        _ => {
            let expected = "a data file that ends in .csv, .npy or .sst, or its format beside it";
            Err(SignalError::field(path, "format", expected, format!("`{}`", d.data.display())))
        }
    }
}

/// A function from stored number to SI.
pub(super) type ToSi = Box<dyn Fn(f64) -> f64>;

/// How a channel's stored numbers become SI.
pub(super) fn to_si(c: &ChannelDescription, path: &Path) -> Result<ToSi, SignalError> {
    let fail = |field: &str, expected: String, found: &str| {
        Err(SignalError::field(path, format!("channel `{}`: {field}", channel_name(c)), expected, found))
    };
    let fits = |unit: Unit| unit.si().filter(|(q, _)| *q == c.quantity).map(|(_, factor)| factor);
    let units = || format!("a unit of {} ({}, or counts)", c.quantity.name(), Unit::names_of(c.quantity));
    if c.unit != Unit::Counts {
        if c.scale.is_some() || c.scale_unit.is_some() || c.calibration.is_some() {
            let expected = "scale, scale_unit and calibration with unit = \"counts\" only".to_owned();
            return fail("scale", expected, c.unit.name());
        }
        return match fits(c.unit) {
            Some(factor) => Ok(Box::new(move |x| factor * x)),
            None => fail("unit", units(), c.unit.name()),
        };
    }
    match (c.scale, c.calibration) {
        (Some(scale), None) => {
            let Some(unit) = c.scale_unit.map_or(Some(1.0), fits) else {
                return fail("scale_unit", units(), c.scale_unit.map_or("none", Unit::name));
            };
            if scale == 0.0 || !scale.is_finite() {
                let expected = "the size of one count: a finite number that is not 0".to_owned();
                return fail("scale", expected, &scale.to_string());
            }
            Ok(Box::new(move |x| scale * unit * x))
        }
        (None, Some(calibration)) => {
            if c.quantity != Quantity::Displacement {
                return fail("calibration", "quantity = \"displacement\"".to_owned(), c.quantity.name());
            }
            if !calibration.metres(0.0).is_finite() {
                return fail(
                    "calibration",
                    "max_mm below 2 arm_mm, both positive".to_owned(),
                    "a triangle that cannot be",
                );
            }
            Ok(Box::new(move |x| calibration.metres(x)))
        }
        (Some(_), Some(_)) => fail("calibration", "either scale or calibration".to_owned(), "both"),
        (None, None) => {
            let expected = format!("the size of one count in {} (or in scale_unit)", c.quantity.si_unit());
            fail("scale", expected, "none")
        }
    }
}

fn channel_name(c: &ChannelDescription) -> String {
    c.name.clone().unwrap_or_else(|| match &c.column {
        Column::Name(name) => name.clone(),
        Column::Index(i) => format!("column {i}"),
    })
}

/// The channels as declared, wheels by index.
pub(super) fn channels(d: &RecordingDescription, path: &Path) -> Result<Vec<Channel>, SignalError> {
    d.channels
        .iter()
        .map(|c| {
            let name = channel_name(c);
            let fail = |field: &str, expected: String, found: String| {
                Err(SignalError::field(path, format!("channel `{name}`: {field}"), expected, found))
            };
            if c.wheel.is_some() && c.at_m.is_some() {
                return fail("at_m", "either wheel or at_m".to_owned(), "both".to_owned());
            }
            let wheel = match &c.wheel {
                None => None,
                Some(wanted) => match d.wheels.iter().position(|w| w.name == *wanted) {
                    Some(index) => Some(index),
                    None => {
                        let names: Vec<&str> = d.wheels.iter().map(|w| w.name.as_str()).collect();
                        let near = suggest(wanted, names.iter().copied())
                            .map_or_else(String::new, |n| format!(" (did you mean `{n}`?)"));
                        let expected = format!("the name of a [[wheel]] ({})", names.join(", "));
                        return fail("wheel", expected, format!("`{wanted}`{near}"));
                    }
                },
            };
            let (quantity, direction, place) = (c.quantity, c.direction, c.place);
            Ok(Channel { name: name.clone(), quantity, direction, place, wheel, at_m: c.at_m })
        })
        .collect()
}
