//! A road's spectrum as a table in a file.

use super::Spectrum;
use crate::files::{FileError, read_text};
use crate::units::{Convention, rad_per_s};
use std::path::Path;

/// A table from a CSV with a frequency column `nu_rad_per_m` or `n_cycles_per_m` and a column `psd`, one-sided densities
/// per that unit unless a convention is given.
pub(super) fn read_table(path: &Path, convention: Option<Convention>) -> Result<Spectrum, FileError> {
    let text = read_text(path)?;
    let fail = |line: usize, message: String| FileError::content(path, Some(line), message);
    let mut lines = text.lines().enumerate().filter(|(_, l)| !l.trim().is_empty());
    let (_, header) = lines
        .next()
        .ok_or_else(|| FileError::content(path, None, "expected a header line, found an empty file"))?;
    let names: Vec<&str> = header.split(',').map(str::trim).collect();
    let column = |name: &str| names.iter().position(|n| *n == name);
    let (x, per_cycle) = match (column("nu_rad_per_m"), column("n_cycles_per_m")) {
        (Some(x), None) => (x, false),
        (None, Some(x)) => (x, true),
        _ => {
            return Err(fail(
                1,
                format!("expected one column nu_rad_per_m or n_cycles_per_m, found {header:?}"),
            ));
        }
    };
    let y = column("psd").ok_or_else(|| fail(1, format!("expected a column psd, found {header:?}")))?;
    let (mut nu, mut density) = (Vec::new(), Vec::new());
    for (index, line) in lines {
        let fields: Vec<&str> = line.split(',').map(str::trim).collect();
        if fields.len() != names.len() {
            return Err(fail(index + 1, format!("expected {} fields, found {}", names.len(), fields.len())));
        }
        let number = |i: usize| {
            fields[i].parse::<f64>().map_err(|_| {
                fail(index + 1, format!("{}: expected a number, found {:?}", names[i], fields[i]))
            })
        };
        nu.push(if per_cycle { rad_per_s(number(x)?) } else { number(x)? });
        density.push(number(y)?);
    }
    let written = if per_cycle { Convention::OneSidedCyclesPerM } else { Convention::OneSidedRadPerM };
    Spectrum::table(nu, density, convention.unwrap_or(written))
        .map_err(|e| FileError::content(path, None, e.to_string()))
}
