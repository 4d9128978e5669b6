//! Spectra as files: a frequency column, one density or a matrix of them, optionally weights.

use super::number_table::NumberTable;
use super::road_fit_source::{FitSamples, FitSource};
use super::{DensityConvention, FitWeight, RoadFitSpec, StudyError};
use crate::files::FileError;
use crate::linalg::{C64, CMat};
use crate::road::{FilterOutput, FilterVariable};
use crate::units::rad_per_s;

/// An entry and its mirror image may differ by this share of the row's largest entry.
const HERMITIAN: f64 = 1e-6;
/// Entries of a matrix beyond this have squares that a double does not hold.
const MOST_DENSITY: f64 = 1e150;
/// Relative weights are squares of densities: beyond this ratio a double does not hold both ends.
const MOST_SPREAD: f64 = 1e100;
/// A matrix may have an eigenvalue below zero by this share of its trace: rounding of what is written.
const DEFINITE: f64 = 1e-6;

/// The frequency columns: name, whether in cycles, whether over distance, convention of the densities.
const AXES: [(&str, bool, bool, DensityConvention); 4] = [
    ("omega_rad_s", false, false, DensityConvention::TwoSidedPerHz),
    ("freq_hz", true, false, DensityConvention::TwoSidedPerHz),
    ("nu_rad_per_m", false, true, DensityConvention::OneSidedRadPerM),
    ("n_cycles_per_m", true, true, DensityConvention::OneSidedCyclesPerM),
];

/// The samples of a table; entries follow S_ij = E\[X_i* X_j\] (scipy.signal.csd), and are turned to G Gᴴ.
pub(super) fn spectrum_of(table: NumberTable, spec: &RoadFitSpec) -> Result<FitSamples, StudyError> {
    let found: Vec<_> = AXES.iter().filter_map(|a| table.index(a.0).map(|k| (k, a))).collect();
    let [(at, (axis, cycles, spatial, written))] = found.as_slice() else {
        let expected = "one frequency column, omega_rad_s, freq_hz, nu_rad_per_m or n_cycles_per_m (or x_m, of a profile)";
        return Err(table.header_error(expected));
    };
    if let Some(convention) = spec.convention
        && convention.is_spatial() != *spatial
    {
        let over = if *spatial { "distance" } else { "time" };
        let expected = format!("a convention over {over}, as the column {axis} is");
        let found = serde_json::to_value(convention).unwrap_or_default().as_str().unwrap_or("").to_owned();
        return Err(StudyError::Setting { field: "convention", expected, found });
    }
    let factor = spec.convention.unwrap_or(*written).factor();
    table.ascending(*at, 0.0)?;
    let entries = entries(&table)?;
    let mut known: Vec<String> = vec![(*axis).to_owned(), "weight".to_owned(), "psd".to_owned()];
    known.extend(entries.names.iter().cloned());
    if table.names.iter().any(|n| is_part_of_own(n) && !known.contains(n)) {
        let expected = "a channel's own density as one real column, psd_11, psd_22 …, without _re and _im";
        return Err(table.header_error(expected));
    }
    table.only(&known.iter().map(String::as_str).collect::<Vec<_>>())?;
    let rows = table.lines.len();
    let mut s = Vec::with_capacity(rows);
    for row in 0..rows {
        s.push(entries.matrix(&table, row, factor)?);
    }
    let variances = match table.index("weight") {
        None => None,
        Some(_) if spec.weight.is_some() => {
            let expected = "no --weight beside a column weight, or a file without it".to_owned();
            return Err(StudyError::Setting { field: "weight", expected, found: "both".into() });
        }
        Some(k) => {
            let weights = &table.columns[k];
            if let Some(row) = weights.iter().position(|w| !(*w > 0.0)) {
                let found = weights[row];
                return Err(
                    table.row_error(row, format!("column weight: expected a number above 0, found {found}"))
                );
            }
            Some(weights.iter().map(|w| 1.0 / w).collect())
        }
    };
    let omega: Vec<f64> =
        table.columns[*at].iter().map(|w| if *cycles { rad_per_s(*w) } else { *w }).collect();
    let [low, high] = spec.band_rad.unwrap_or([0.0, f64::INFINITY]);
    let inside: Vec<usize> = (0..rows).filter(|k| (low..=high).contains(&omega[*k])).collect();
    entries.powered(&table, &inside)?;
    let relative = variances.is_none() && spec.weight != Some(FitWeight::None);
    if relative && spec.smooth_per_octave.is_none() {
        let trace = |k: usize| (0..entries.m).map(|i| s[k][(i, i)].re).sum::<f64>();
        if let Some(row) = inside.iter().find(|k| !(trace(**k) > 0.0)) {
            let message = "expected a density above 0, which relative weights need, found 0: leave the row out, narrow --band, or take --weight none";
            return Err(table.row_error(*row, message.into()));
        }
        let mut sizes: Vec<(f64, usize)> = inside.iter().map(|k| (trace(*k), *k)).collect();
        sizes.sort_by(|x, y| x.0.total_cmp(&y.0));
        if let (Some(least), Some(largest)) = (sizes.first(), sizes.last())
            && least.0 < largest.0 / MOST_SPREAD
        {
            // the one that is further from most of them
            let middle = sizes[sizes.len() / 2].0;
            let (odd, other) =
                if largest.0 / middle > middle / least.0 { (largest, least) } else { (least, largest) };
            let message = format!(
                "expected densities within a factor of {MOST_SPREAD:e} of each other, found {:.3e} beside {:.3e}",
                odd.0 / factor,
                other.0 / factor
            );
            return Err(table.row_error(odd.1, message));
        }
    }
    Ok(FitSamples {
        kind: FitSource::Spectrum,
        variable: if *spatial { FilterVariable::Distance } else { FilterVariable::Time },
        of: spec.of.unwrap_or(FilterOutput::Displacement),
        omega,
        s,
        variances,
        coherence: None,
        notes: Vec::new(),
        inputs: vec![table.input],
    })
}

/// `psd_ii_re` and `psd_ii_im`.
fn is_part_of_own(name: &str) -> bool {
    (1..=9).any(|i| name == format!("psd_{i}{i}_im") || name == format!("psd_{i}{i}_re"))
}

/// Where the entries of the matrices are.
struct Entries {
    m: usize,
    /// (i, j) → columns of real and imaginary part; None where only the mirror image is written.
    at: Vec<Option<(usize, Option<usize>)>>,
    names: Vec<String>,
}

/// `psd`, or `psd_ii` and `psd_ij_re`, `psd_ij_im` for i < j (the mirror images may be there too).
fn entries(table: &NumberTable) -> Result<Entries, StudyError> {
    let m = (1..=9).take_while(|i| table.index(&format!("psd_{i}{i}")).is_some()).count();
    if let Some(k) = table.index("psd") {
        if m > 0 {
            return Err(table.header_error("either a column psd, or psd_11, psd_12_re, psd_12_im …"));
        }
        return Ok(Entries { m: 1, at: vec![Some((k, None))], names: Vec::new() });
    }
    let beyond = (m + 2..=9).find(|i| table.index(&format!("psd_{i}{i}")).is_some());
    let crossed = (m + 1..=9).find(|i| {
        (1..=9).any(|j| {
            ["re", "im"].iter().any(|part| {
                table
                    .index(&format!("psd_{j}{i}_{part}"))
                    .or(table.index(&format!("psd_{i}{j}_{part}")))
                    .is_some()
            })
        })
    });
    if let Some(last) = beyond.max(crossed) {
        let missing = m + 1;
        return Err(
            table.header_error(&format!("a column psd_{missing}{missing} of a {last} × {last} matrix"))
        );
    }
    if m == 0 {
        return Err(table.header_error("a column psd, or psd_11, psd_12_re, psd_12_im … of a matrix"));
    }
    let (mut at, mut names) = (Vec::new(), Vec::new());
    for i in 1..=m {
        for j in 1..=m {
            if i == j {
                let name = format!("psd_{i}{i}");
                at.push(table.index(&name).map(|k| (k, None)));
                names.push(name);
                continue;
            }
            let (re, im) = (format!("psd_{i}{j}_re"), format!("psd_{i}{j}_im"));
            match (table.index(&re), table.index(&im)) {
                (Some(a), Some(b)) => at.push(Some((a, Some(b)))),
                (None, None) if i > j => at.push(None),
                _ => return Err(table.header_error(&format!("columns {re} and {im} of a {m} × {m} matrix"))),
            }
            names.extend([re, im]);
        }
    }
    Ok(Entries { m, at, names })
}

impl Entries {
    /// Refuses a channel whose density is 0 in all these rows.
    fn powered(&self, table: &NumberTable, rows: &[usize]) -> Result<(), StudyError> {
        for i in 0..self.m {
            let Some((column, _)) = self.at[i * self.m + i] else { continue };
            if !rows.is_empty() && rows.iter().all(|k| table.columns[column][*k] == 0.0) {
                let name = table.label(column);
                let message =
                    format!("column {name}: expected densities above 0, found 0 in all {} rows", rows.len());
                return Err(FileError::content(&table.path, None, message).into());
            }
        }
        Ok(())
    }

    /// The conjugate of what is written, times a factor: (G Gᴴ)_ij = E[X_i X_j*].
    fn matrix(&self, table: &NumberTable, row: usize, factor: f64) -> Result<CMat, StudyError> {
        let m = self.m;
        let value = |i: usize, j: usize| {
            self.at[i * m + j]
                .map(|(re, im)| C64::new(table.columns[re][row], im.map_or(0.0, |k| table.columns[k][row])))
        };
        let largest = (0..m * m).filter_map(|k| value(k / m, k % m)).map(|z| z.norm()).fold(0.0, f64::max);
        let fail = |message: String| Err(table.row_error(row, message));
        for i in 0..m {
            let own = value(i, i).map_or(f64::NAN, |z| z.re);
            if m > 1 && own > MOST_DENSITY {
                let name = self.at[i * m + i].map_or(String::new(), |(k, _)| table.label(k));
                return fail(format!(
                    "column {name}: expected a density up to {MOST_DENSITY:e}, found {own:e}: a double does not hold what is made of it"
                ));
            }
            if !(own >= 0.0) {
                let name = self.at[i * m + i].map_or(String::new(), |(k, _)| table.label(k));
                return fail(format!("column {name}: expected a density of 0 or more, found {own}"));
            }
            for j in 0..i {
                if let (Some(a), Some(b)) = (value(i, j), value(j, i))
                    && (a - b.conj()).norm() > HERMITIAN * largest
                {
                    let (i, j) = (i + 1, j + 1);
                    return fail(format!(
                        "psd_{i}{j}: expected the conjugate of psd_{j}{i}, {}{:+}i, found {}{:+}i: the matrix is not Hermitian",
                        b.re, -b.im, a.re, a.im
                    ));
                }
            }
        }
        let written = |i: usize, j: usize| {
            let upper = value(i.min(j), i.max(j)).unwrap_or_default();
            if i <= j { upper } else { upper.conj() }
        };
        let s = CMat::from_fn(m, m, |i, j| written(i, j).conj() * factor);
        let trace: f64 = (0..m).map(|i| s[(i, i)].re).sum();
        if m > 1 {
            let Ok(eigen) = s.self_adjoint_eigen(faer::Side::Lower) else {
                return fail("a matrix whose eigenvalues cannot be had".into());
            };
            let least = eigen.S()[0].re;
            if least < -DEFINITE * trace {
                return fail(format!(
                    "expected a matrix without negative eigenvalues, found {:.3e} beside a trace of {:.3e}: no cross-spectrum is larger than its own two allow",
                    least / factor,
                    trace / factor
                ));
            }
        }
        Ok(s)
    }
}
