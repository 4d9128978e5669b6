//! `truncate_to`: the controller with fewer states, each order in its own loop.

use super::design::objective;
use super::design_outcome::{ControllerFile, DesignOutcome, TruncatedController};
use super::design_problem::Problem;
use super::{Flag, StudyError};
use crate::lti::{Continuous, LtiError, StateSpace};

/// Balanced truncations of the controller to the orders asked for, each with its loop measured.
///
/// # Errors
/// A controller with a pole on the axis.
pub(super) fn truncate(
    problem: &Problem,
    controller: &StateSpace<Continuous>,
    outcome: &mut DesignOutcome,
) -> Result<(), StudyError> {
    let fail =
        |e: LtiError| StudyError::Design { name: problem.spec.vehicle.clone(), source: Box::new(e.into()) };
    let mut left_out = Vec::new();
    for order in &problem.spec.truncate_to {
        if *order >= controller.order() {
            left_out.push(format!("{order}: the controller has {}", controller.order()));
            continue;
        }
        let reduced = match controller.balanced_truncation(*order) {
            Ok(reduced) => reduced,
            Err(LtiError::Field { .. }) => {
                left_out.push(format!("{order}: more of its poles are unstable, and these are kept"));
                continue;
            }
            Err(e) => return Err(fail(e)),
        };
        let verified = problem.measure(Some(&reduced.system))?;
        let y = problem.measurements.iter().map(|o| o.name.clone()).collect();
        let u = problem.vehicle.actuators().iter().map(|a| a.name.clone()).collect();
        outcome.truncated.push(TruncatedController {
            order: reduced.system.order(),
            error_bound: reduced.bound,
            objective: verified.stable.then(|| objective(problem, &verified)),
            controller: ControllerFile::new(&reduced.system, y, u),
            verified,
        });
    }
    if !left_out.is_empty() {
        let text = format!("not truncated to {}", left_out.join("; "));
        outcome.notes.push(Flag { name: "not-truncated".into(), text });
    }
    Ok(())
}
