//! `truncate_to`: the controller with fewer states, each order in its own loop.

use super::design::objective;
use super::design_outcome::{ControllerFile, DesignOutcome, Measured, TruncatedController};
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
            left_out.push(format!("{order} (the controller has {})", controller.order()));
            continue;
        }
        let reduced = match controller.balanced_truncation(*order) {
            Ok(reduced) => reduced,
            Err(LtiError::Field { .. }) => {
                left_out.push(format!("{order} (more of its poles are unstable, and these are kept)"));
                continue;
            }
            Err(e) => return Err(fail(e)),
        };
        let verified = match problem.measure(Some(&reduced.system)) {
            // a pole on the axis but for rounding
            Err(StudyError::Ride { .. }) => Measured::default(),
            verified => verified?,
        };
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
    let unstable = outcome.truncated.iter().filter(|t| !t.verified.stable).map(|t| t.order.to_string());
    let unstable: Vec<String> = unstable.collect();
    if !unstable.is_empty() {
        let text = format!(
            "truncated to order {} the controller's loop is not stable: no controller file is written for it; leave it out of truncate_to",
            unstable.join(", ")
        );
        outcome.warnings.push(Flag { name: "truncated-unstable".into(), text });
    }
    if !left_out.is_empty() {
        let text = format!("of truncate_to, these orders are left out: {}", left_out.join("; "));
        outcome.notes.push(Flag { name: "not-truncated".into(), text });
    }
    Ok(())
}
