//! The proof of a fixed-order design: every vehicle's loop from vehicle and controller alone.

use super::design_fixed_order::{Fleet, claimed_name};
use super::design_fixed_outcome::{TargetAim, TargetNorm};
use super::design_fixed_words::refused;
use super::design_outcome::{DesignOutcome, DesignStatus, DesignVertex, Measured};
use super::design_words::{apart, short};
use super::{Named, StudyError};
use crate::lti::{Continuous, StateSpace};

/// Norms of the search and recomputed ones agree to this, and bounds are exceeded by at most this.
const SAME: f64 = 1e-5;

impl Fleet {
    /// Every vehicle's loop from vehicle and controller alone, beside what is claimed of it: a contradiction refuses.
    ///
    /// # Errors
    /// A vehicle that has no norms.
    pub fn confirm(&self, k: &StateSpace<Continuous>, outcome: &mut DesignOutcome) -> Result<(), StudyError> {
        let mut worst = f64::NEG_INFINITY;
        let mut worst_passive = None;
        for (number, member) in self.members.iter().enumerate() {
            let p = &member.problem;
            let closed = match p.measure(Some(k)) {
                // next to the axis
                Err(StudyError::Ride { source, .. }) => {
                    refuse(refused(&member.at, &source.to_string()), outcome);
                    return Ok(());
                }
                measured => measured?,
            };
            if let Some(found) = self.contradiction(number, &closed, outcome) {
                refuse(refused(&member.at, &found), outcome);
                return Ok(());
            }
            let value = super::design::objective(p, &closed);
            let is_worst = value > worst;
            worst = worst.max(value);
            if self.is_many() {
                let passive = p.measure(None)?;
                let mut objective = Named::default();
                if p.has_objective() {
                    // none of a vehicle that is not stable without control
                    let before = passive.stable.then(|| super::design::objective(p, &passive));
                    if let Some(before) = before {
                        objective.insert("passive", before);
                    }
                    worst_passive = if is_worst { before } else { worst_passive };
                    objective.insert("closed", value);
                }
                let at = member.at.clone();
                outcome.vertices.push(DesignVertex {
                    at,
                    corner: true,
                    passive,
                    closed,
                    nominal: None,
                    objective,
                });
            }
        }
        if let Some(claimed) = outcome.claimed.get("objective").copied() {
            outcome.claimed.insert("objective_recomputed", worst);
            if worst > claimed * (1.0 + SAME) {
                let [claimed, worst] = apart(claimed, worst);
                let found = format!("the goal is claimed to be {claimed} and recomputed as {worst}");
                refuse(refused(&Named::default(), &found), outcome);
            } else if self.is_many() {
                if let Some(passive) = worst_passive {
                    outcome.objective.insert("worst_passive", passive);
                }
                outcome.objective.insert("worst", worst);
            }
        }
        Ok(())
    }

    /// What a loop has beside what is claimed of it; in words where the two differ.
    fn contradiction(&self, number: usize, closed: &Measured, outcome: &mut DesignOutcome) -> Option<String> {
        let slowest = closed.poles.iter().map(|p| p[0]).fold(f64::NEG_INFINITY, f64::max);
        let spec = &outcome.design;
        let margin = spec.poles.and_then(|p| p.max_real_rad_s).unwrap_or(0.0);
        if !closed.stable || slowest > margin * (1.0 - SAME) {
            return Some(format!(
                "the loop has a pole with real part {} 1/s, where {margin} is allowed",
                short(slowest)
            ));
        }
        if let Some(found) = outcome.claimed.get("fastest_controller_pole")
            && *found > spec.max_pole_rad_s() * (1.0 + SAME)
        {
            return Some(format!("the controller has a pole at {} rad/s", short(*found)));
        }
        if let (Some(most), Some(found)) = (spec.goal.max_gain, outcome.claimed.get("controller_gain"))
            && *found > most * (1.0 + SAME)
        {
            return Some(format!(
                "the controller has a gain of {}, where {} is allowed",
                short(*found),
                short(most)
            ));
        }
        let p = &self.members[number].problem;
        let block = outcome.fixed_order.as_mut()?;
        let own = self.targets.iter().zip(&self.about).zip(&mut block.targets);
        for ((_, a), shown) in own.filter(|((t, _), _)| t.plant == number) {
            let recomputed = match (a.norm, a.aim) {
                (TargetNorm::H2, TargetAim::Goal) => super::design::squared_h2(p, closed).sqrt(),
                (TargetNorm::H2, TargetAim::Bound) => {
                    closed.h2.get(&a.name).and_then(|r| r.finite()).unwrap_or(f64::INFINITY)
                }
                (TargetNorm::Hinf, _) => closed.hinf.get(&a.name).copied().unwrap_or(f64::INFINITY),
            };
            shown.recomputed = Some(recomputed).filter(|v| v.is_finite());
            let differs = !((recomputed - shown.value).abs() <= SAME * shown.value);
            let exceeds = a.aim == TargetAim::Bound && recomputed > a.unit * (1.0 + SAME);
            if differs || exceeds {
                let norm = if a.norm == TargetNorm::H2 { "H2 norm" } else { "largest gain" };
                let [claimed, recomputed] = apart(shown.value, recomputed);
                return Some(format!(
                    "the {norm} of {} is claimed to be {claimed} and recomputed as {recomputed}",
                    a.name
                ));
            }
            if !self.is_many() && !a.is_sum() {
                outcome.claimed.insert(format!("{}_recomputed", claimed_name(a)), recomputed);
            }
        }
        None
    }
}

fn refuse(why: String, outcome: &mut DesignOutcome) {
    outcome.status = DesignStatus::Refused;
    outcome.why = Some(why);
    outcome.vertices.clear();
}
