//! Algorithm 3.1.1 to the letter: powers of z, and what the printed example counts.

use super::super::SubspaceError;
use super::basis::Kind;
use super::conditions::conditions;
use super::data::{Domain, InterpolationData};
use super::plane::Mobius;
use super::projection::Range;
use super::{conditions::Condition, realise};
use crate::linalg::Mat;
use crate::lti::{Discrete, StateSpace};

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
    let all = as_printed(data, form)?;
    Ok(Range::new(&all, (data.outputs, data.inputs), block_rows, Kind::Powers)?.singular_values)
}

/// What algorithm 3.1.1 computes on its way, in the basis of its own singular vectors (their signs are free).
#[derive(Debug, Clone)]
pub struct PrintedSteps {
    /// R₂₂ of (3.46), signs of its columns free.
    pub r22: Mat,
    /// Its singular values.
    pub singular_values: Vec<f64>,
    /// Â, B̂, Ĉ, D̂; the step is 1 s, for none is given.
    pub system: StateSpace<Discrete>,
}

/// Steps 1 to 6 with q block rows of powers of z and an order, for data on the disk without a node at infinity.
///
/// # Errors
/// As [`projected_singular_values`]; data that do not determine a model of this order.
///
/// Source: Türkay's thesis, (3.46)–(3.58), example 3.3.
pub fn printed_steps(
    data: &InterpolationData,
    block_rows: usize,
    order: usize,
    form: PrintedForm,
) -> Result<PrintedSteps, SubspaceError> {
    let all = as_printed(data, form)?;
    let range = Range::new(&all, (data.outputs, data.inputs), block_rows, Kind::Powers)?;
    let (a, c) = realise::poles(&range, data.outputs, order)?;
    let (b, d) = realise::inputs(&all, &[], (&a, &c), data.inputs)?;
    let system = StateSpace::discrete(a, b, c, d, 1.0)?;
    Ok(PrintedSteps { r22: range.r22, singular_values: range.singular_values, system })
}

/// The conditions with the weights that the printed matrices give them.
fn as_printed(data: &InterpolationData, form: PrintedForm) -> Result<Vec<Condition>, SubspaceError> {
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
    Ok(all)
}
