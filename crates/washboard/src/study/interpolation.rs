//! The job `interpolate`: a rational function through the values of a file, or near its measurements.

use super::interpolation_file::{Bound, File, Row, measured, no_lambda, node, scale_of};
use super::json_path::parse_json;
use super::{Input, StudyError};
use crate::files::{FileError, read_text};
use crate::linalg::Mat;
use crate::subspace::{
    Domain, Interpolant, InterpolationData, Measured, Node, Point, SubspaceError, fit_response, interpolate,
    interpolate_bounded,
};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// A file of values to interpolate.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InterpolateSpec {
    /// JSON: `domain`, `nodes`, `measured`, `constraints`, `order`, `bound`.
    pub data: PathBuf,
}

/// What went through the data.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum InterpolateStatus {
    /// A function that meets its data and is stable.
    Found,
    /// The function through the data has a pole where it must not.
    NotStable,
    /// No function of this order meets the data.
    NotMet,
}

/// A rational function C(zI − A)⁻¹B + D, or of s.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct InterpolateOutcome {
    /// Whether it is what was asked for.
    pub status: InterpolateStatus,
    /// Why it is not.
    pub why: Option<String>,
    /// `disk` or `half-plane`.
    pub domain: String,
    /// Of the half plane, rad/s.
    pub lambda: Option<f64>,
    /// n.
    pub order: usize,
    /// Rows of A.
    pub a: Vec<Vec<f64>>,
    /// Rows of B.
    pub b: Vec<Vec<f64>>,
    /// Rows of C.
    pub c: Vec<Vec<f64>>,
    /// Rows of D.
    pub d: Vec<Vec<f64>>,
    /// Those that the order was told by.
    pub singular_values: Vec<f64>,
    /// At any node or constraint, over the largest value of the same derivative; recomputed from A, B, C, D. None where there are neither.
    pub max_error: Option<f64>,
    /// Root mean square of the measured values' residuals over that of the values; none without them.
    #[serde(default)]
    pub measured_rms_error: Option<f64>,
    /// Poles inside the disk, or left of the axis.
    pub stable: bool,
    /// The modulus on the boundary, where one was asked for, and the least that there can be.
    pub bound: Option<[f64; 2]>,
}

/// The function of a file, and the file's fingerprint.
///
/// With `measured` a fit of `order` that meets `constraints`; with `bound` a function of that modulus on the boundary; else the
/// interpolant of least order, or of `order`.
///
/// # Errors
/// A file that is none, data that contradict themselves or are too few; constraints or a bound that nothing meets.
pub fn interpolate_file(spec: &InterpolateSpec) -> Result<(InterpolateOutcome, Vec<Input>), StudyError> {
    let path = &spec.data;
    let text = read_text(path)?;
    let file: File = parse_json(&text, path)?;
    let wrong = |message: String| StudyError::from(FileError::content(path, None, message));
    let scale = scale_of(&file);
    let refused = |source| {
        let source = match source {
            SubspaceError::Bound { bound, least } => {
                SubspaceError::Bound { bound: bound * scale, least: least * scale }
            }
            other => other,
        };
        StudyError::Interpolation { name: path.display().to_string(), source: Box::new(source) }
    };
    let domain = match (file.domain.as_str(), file.lambda) {
        ("disk", None) => Domain::Disk,
        ("disk", Some(l)) => return Err(wrong(format!("lambda: expected none on the disk, found {l}"))),
        ("half-plane", Some(lambda_rad_s)) => Domain::HalfPlane { lambda_rad_s },
        ("half-plane", None) => return Err(wrong(no_lambda(&file))),
        (other, _) => {
            return Err(wrong(format!("domain: expected \"disk\" or \"half-plane\", found {other:?}")));
        }
    };
    let nodes = |field: &str, rows: &[Row]| -> Result<Vec<Node>, StudyError> {
        rows.iter()
            .enumerate()
            .map(|(k, row)| node(row, scale).map_err(|e| wrong(format!("{field}[{k}].{e}"))))
            .collect()
    };
    let (data, constraints) = (nodes("nodes", &file.nodes)?, nodes("constraints", &file.constraints)?);
    let (mut bound, mut residual) = (None, None);
    let found = if file.measured.is_empty() {
        if !constraints.is_empty() {
            return Err(wrong("constraints: expected measured values to fit beside them, found none".into()));
        }
        let data = InterpolationData::new(domain, data).map_err(refused)?;
        match file.bound {
            None => interpolate(&data, file.order).map_err(refused)?,
            Some(asked) => {
                if let Some(n) = file.order {
                    return Err(wrong(format!("order: expected none with a bound, found {n}")));
                }
                let asked = match asked {
                    Bound::Value(v) if v > 0.0 && v.is_finite() => Some(v / scale),
                    Bound::Value(v) => {
                        return Err(wrong(format!(
                            "bound: expected a number above 0 or \"least\", found {v}"
                        )));
                    }
                    Bound::Word(w) if w == "least" => None,
                    Bound::Word(w) => {
                        return Err(wrong(format!("bound: expected a number or \"least\", found {w:?}")));
                    }
                };
                let found = interpolate_bounded(&data, asked).map_err(refused)?;
                bound = Some([found.bound * scale, found.least * scale]);
                found.interpolant
            }
        }
    } else {
        if !data.is_empty() || file.bound.is_some() {
            let found = if data.is_empty() { "bound" } else { "nodes" };
            return Err(wrong(format!(
                "{found}: expected none beside measured values; exact ones are constraints"
            )));
        }
        let Some(order) = file.order else {
            return Err(wrong("order: expected a number for measured values, found none".into()));
        };
        let measured = measured(&file.measured, scale).map_err(wrong)?;
        let found = fit_response(domain, &measured, &constraints, order).map_err(refused)?;
        residual = Some(rms_residual(&found, &measured).map_err(refused)?);
        found
    };
    let mut outcome = outcome(&found, file.domain, file.lambda, bound, scale);
    outcome.measured_rms_error = residual;
    if residual.is_some() && constraints.is_empty() {
        outcome.max_error = None;
    }
    Ok((outcome, vec![Input::of(path.display().to_string(), text.as_bytes())]))
}

/// √(Σ‖G(z_k) − G_k‖²/Σ‖G_k‖²); of values that are all 0 the root of the sum above.
fn rms_residual(found: &Interpolant, measured: &[Measured]) -> Result<f64, SubspaceError> {
    let (mut off, mut size) = (0.0, 0.0);
    for x in measured {
        for g in found.system.derivatives(Point::Finite(x.z), 1)? {
            off += (g - &x.value).squared_norm_l2();
        }
        size += x.value.squared_norm_l2();
    }
    Ok((if size > 0.0 { off / size } else { off }).sqrt())
}

/// Whether other data would help, or the answer is no.
pub(super) fn is_wrong_input(e: &SubspaceError) -> bool {
    !matches!(
        e,
        SubspaceError::Constraints { .. }
            | SubspaceError::Bound { .. }
            | SubspaceError::Improper { .. }
            | SubspaceError::Linalg(_)
            | SubspaceError::Lti(_)
    )
}

fn outcome(
    found: &Interpolant,
    domain: String,
    lambda: Option<f64>,
    bound: Option<[f64; 2]>,
    scale: f64,
) -> InterpolateOutcome {
    let rows =
        |m: &Mat, by: f64| (0..m.nrows()).map(|i| (0..m.ncols()).map(|j| m[(i, j)] * by).collect()).collect();
    let [a, b, c, d] = found.system.matrices();
    let (a, b, c, d) = (rows(a, 1.0), rows(b, 1.0), rows(c, scale), rows(d, scale));
    let (status, why) = if !found.meets_its_data() {
        let why = format!(
            "the function of order {} misses the data by {:.1e} of their size",
            found.order, found.max_error
        );
        (InterpolateStatus::NotMet, Some(why))
    } else if !found.stable {
        let region = if lambda.is_some() { "right half plane" } else { "outside of the unit circle" };
        let why = format!("the function of order {} has a pole in the {region} or on its edge", found.order);
        (InterpolateStatus::NotStable, Some(why))
    } else {
        (InterpolateStatus::Found, None)
    };
    InterpolateOutcome {
        status,
        why,
        domain,
        lambda,
        order: found.order,
        a,
        b,
        c,
        d,
        singular_values: found.singular_values.iter().map(|s| s * scale).collect(),
        max_error: Some(found.max_error),
        measured_rms_error: None,
        stable: found.stable,
        bound,
    }
}

/// Refuses to write a result over its own data.
///
/// # Errors
/// The same file twice.
pub fn check_interpolation_target(data: &Path, output: &Path) -> Result<(), StudyError> {
    let same = |a: &Path, b: &Path| match (a.canonicalize(), b.canonicalize()) {
        (Ok(a), Ok(b)) => a == b,
        _ => false,
    };
    if same(data, output) {
        let (expected, found) = ("another file than the data".to_owned(), output.display().to_string());
        return Err(StudyError::Setting { field: "output", expected, found });
    }
    Ok(())
}
