//! Singular values of algorithm 3.1.1 to the letter: powers of z, and what the printed example counts.

use super::super::SubspaceError;
use super::basis::Kind;
use super::conditions::conditions;
use super::data::{Domain, InterpolationData};
use super::plane::Mobius;
use super::projection::Range;

/// What stands in the data matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PrintedForm {
    /// Conjugate nodes beside their partners and derivatives as they are: (3.25) and (3.43) as printed.
    AsPrinted,
    /// Each conjugate pair once.
    Deduplicated,
    /// That, and Taylor coefficients for derivatives.
    Taylor,
}

/// Singular values of R₂₂ of (3.46) with q block rows of powers of z, for data on the disk without a node at infinity.
///
/// # Errors
/// As [`interpolate`](super::interpolate); data of another domain or with directions of the left.
///
/// Source: Türkay's thesis, (3.46), example 3.3.
pub fn projected_singular_values(
    data: &InterpolationData,
    block_rows: usize,
    form: PrintedForm,
) -> Result<Vec<f64>, SubspaceError> {
    data.check()?;
    if data.domain != Domain::Disk {
        let (expected, found) = ("the disk".to_owned(), "the half plane".to_owned());
        return Err(SubspaceError::Field { field: "domain", expected, found });
    }
    let mut all = conditions(Mobius::ONE, &data.nodes, (data.outputs, data.inputs));
    if all.len() < data.nodes.len() && all.iter().all(|c| c.real) || all.iter().any(|c| !c.whole[0]) {
        let (expected, found) = ("finite nodes, full or of the right".to_owned(), "others".to_owned());
        return Err(SubspaceError::Field { field: "nodes", expected, found });
    }
    for c in &mut all {
        let mut factorial = 1.0;
        for (l, weight) in c.weights.iter_mut().enumerate() {
            factorial *= l.max(1) as f64;
            *weight = 1.0;
            if form != PrintedForm::Taylor {
                *weight *= factorial;
            }
            if form == PrintedForm::AsPrinted && !c.real {
                // [Re Im] of a node beside those of its conjugate: twice the same columns, but for signs
                *weight *= 2f64.sqrt();
            }
        }
    }
    Ok(Range::new(&all, (data.outputs, data.inputs), block_rows, Kind::Powers)?.singular_values)
}
