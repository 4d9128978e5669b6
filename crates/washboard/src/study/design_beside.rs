//! What a page shows beside a design's certificate: what no controller beats, robustness, responses in time. None of it decides whether there
//! is a design: where a part cannot be had, a note says why.

use super::design_outcome::DesignOutcome;
use super::design_problem::Problem;
use super::design_words::short;
use super::{
    Flag, StudyError, design_bode, design_fragile, design_limit_loop, design_responses, design_robustness,
    design_vehicle,
};
use crate::lti::{Continuous, StateSpace};

/// Adds them to an outcome; all but limit and vehicle are of a controller.
pub(super) fn beside(
    problem: &Problem,
    controller: Option<&StateSpace<Continuous>>,
    outcome: &mut DesignOutcome,
) {
    outcome.vehicle = Some(design_vehicle::vehicle(problem));
    outcome.invariant = design_bode::invariant_points(problem);
    if outcome.passive.stable {
        outcome.limit = design_limit_loop::limit(problem);
    }
    let Some(k) = controller else { return };
    let note =
        |name: &str, e: &StudyError| Flag { name: name.into(), text: format!("{name} is not shown: {e}") };
    match design_fragile::over_frequency(problem, k, outcome) {
        Ok(warnings) => outcome.warnings.extend(warnings),
        Err(e) => outcome.notes.push(note("hidden-mode", &e)),
    }
    match design_robustness::robustness(problem, k) {
        Ok(Ok(r)) => {
            design_fragile::fragile(&r, outcome);
            outcome.robustness = Some(r);
        }
        Ok(Err(grows)) => {
            let text = format!(
                "robustness is not shown: as it is computed the loop grows at {} 1/s and has no norms to compare with",
                short(grows)
            );
            outcome.notes.push(Flag { name: "robustness".into(), text });
        }
        Err(e) => outcome.notes.push(note("robustness", &e)),
    }
    match design_responses::responses(problem, k, outcome.passive.stable) {
        Ok((responses, notes)) => {
            outcome.responses = Some(responses);
            outcome.notes.extend(notes);
        }
        Err(e) => outcome.notes.push(note("responses", &e)),
    }
}
