//! One of the vehicles that a fixed-order controller is for: its goal over passive norms, or why it has none.

use super::design_mixed::minimal;
use super::design_outputs::{not_decaying, swings};
use super::design_problem::{GoalBlock, Norm, PeakBlock, Problem};
use super::design_robust::{words, wrong_fields};
use super::{Named, StudyError};
use crate::lti::{GeneralizedPlant, LtiError};

/// One of the vehicles that a controller is for.
pub(super) struct Member {
    /// Its goal, over its own passive norms.
    pub problem: Problem,
    pub at: Named<f64>,
    /// Without modes that no signal shows.
    pub plant: GeneralizedPlant,
}

impl Member {
    /// # Errors
    /// Fields that the vehicle does not have; one without norms of its own.
    pub fn new(problem: &Problem, fields: Vec<(String, f64)>, number: usize) -> Result<Self, StudyError> {
        let at: Named<f64> = fields.iter().cloned().collect();
        let own = problem.at(&fields).map_err(|e| match e {
            StudyError::Vehicle { source, .. } if !fields.is_empty() => {
                numbered(wrong_fields("plant", &at, &source.to_string()), number)
            }
            other => other,
        })?;
        let own = if fields.is_empty() || !problem.spec.normalize_at.is_empty() {
            own
        } else {
            own.over_its_own(&at).map_err(|e| numbered(e, number))?
        };
        let plant = minimal(own.plant.clone()).map_err(|e| fail(problem, e))?;
        Ok(Member { problem: own, at, plant })
    }
}

/// A refusal of `[[plant]]` with the number of the one that it is of.
fn numbered(e: StudyError, number: usize) -> StudyError {
    match e {
        StudyError::Setting { field, expected, found } => {
            StudyError::Setting { field, expected, found: format!("number {number}, {found}") }
        }
        other => other,
    }
}

pub(super) fn fail(problem: &Problem, e: LtiError) -> StudyError {
    StudyError::Design { name: problem.spec.vehicle.clone(), source: Box::new(e.into()) }
}

impl Problem {
    /// The same goal over this vehicle's own passive norms.
    fn over_its_own(self, at: &Named<f64>) -> Result<Problem, StudyError> {
        let passive = self.plant.passive();
        let poles = passive.poles().map_err(|e| fail(&self, e))?;
        let stable = passive.is_stable().map_err(|e| fail(&self, e))?;
        if !stable || swings(&poles).is_some() {
            let what =
                not_decaying(&poles).map_or_else(|| "a pole on the axis".to_owned(), |p| p.to_string());
            return Err(StudyError::Setting {
                field: "plant",
                expected: "vehicles that are stable without control, as each has its goals over its own passive norms; or \
                           [normalize_at], fields of one whose norms count for all"
                    .into(),
                found: format!("{}: {what}", words(at)),
            });
        }
        let of = |g: &GoalBlock, norm: Norm| -> Result<GoalBlock, StudyError> {
            let found = norm.of(&passive, &g.members).map_err(|e| fail(&self, e))?;
            if !(found > 0.0 && found.is_finite()) {
                return Err(wrong_fields(
                    "plant",
                    at,
                    &format!("`{}` has a passive norm of {found}", g.name),
                ));
            }
            Ok(GoalBlock { passive: found, ..g.clone() })
        };
        let goals = self.goals.iter().map(|g| of(g, Norm::H2)).collect::<Result<Vec<_>, _>>()?;
        let bounded = self.bounded.iter().map(|g| of(g, Norm::H2)).collect::<Result<Vec<_>, _>>()?;
        let peak = |p: &PeakBlock| Ok(PeakBlock { block: of(&p.block, Norm::Hinf)?, bound: p.bound });
        let peaks = self.peaks.iter().map(peak).collect::<Result<Vec<_>, StudyError>>()?;
        Ok(Problem { goals, bounded, peaks, ..self })
    }
}
