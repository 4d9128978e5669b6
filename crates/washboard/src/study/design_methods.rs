//! The methods of a design: each gives a controller (or a limit), its claims, and the same numbers recomputed.

use super::Flag;
use super::design_outcome::{DesignOutcome, DesignStatus};
use super::design_problem::Problem;
use crate::lti::{Continuous, GeneralizedPlant, StateSpace};
use crate::synthesis::{
    Assumption, HinfSettings, LqgWeights, SynthesisError, broken_assumptions, full_information, h2_limit,
    hinf, lqg, lqg_plant,
};

/// A claimed H2 norm and the recomputed one agree to this: two Riccati equations and a Lyapunov equation of stiff systems.
const SAME_H2: f64 = 1e-6;
/// An H∞ bound is exceeded by at most this.
const SAME_HINF: f64 = 1e-5;
/// Two routes to the H2 limit agree to this.
const SAME_LIMIT: f64 = 1e-7;

pub(super) type Found = Result<Option<StateSpace<Continuous>>, SynthesisError>;

fn weights(problem: &Problem) -> LqgWeights {
    let spec = &problem.spec;
    LqgWeights {
        sensor_noise: vec![spec.noises().sensor_noise; problem.measurements.len()],
        input_weight: vec![spec.input_weight; problem.plant.nu()],
        process_noise: spec.noises().process_noise,
        cross_term: spec.noises().cross_term,
    }
}

pub(super) fn by_lqg(problem: &Problem, goal: &GeneralizedPlant, outcome: &mut DesignOutcome) -> Found {
    let weights = weights(problem);
    let found = lqg(goal, &weights)?;
    // the same number from plant and controller alone
    let whole = lqg_plant(goal, &weights)?;
    let recomputed = whole.close(&found.controller)?.h2_norm()?;
    outcome.claimed.insert("h2_with_noise", found.claimed_h2);
    outcome.claimed.insert("h2_with_noise_recomputed", recomputed);
    same("the H2 norm", found.claimed_h2, recomputed, SAME_H2)?;
    for (name, solution) in [("control", &found.regulator.solution), ("filter", &found.filter.solution)] {
        outcome.claimed.insert(format!("{name}_riccati_residual"), solution.scaled_residual);
    }
    let quiet =
        LqgWeights { sensor_noise: vec![0.0; problem.measurements.len()], process_noise: 1.0, ..weights };
    if let Ok((limit, _)) = lqg_plant(goal, &quiet).and_then(|p| full_information(&p)) {
        outcome.claimed.insert("h2_limit", limit);
        outcome.objective.insert("limit", limit * limit);
    }
    Ok(Some(found.controller))
}

pub(super) fn by_hinf(problem: &Problem, goal: &GeneralizedPlant, outcome: &mut DesignOutcome) -> Found {
    // noise and weighted controls make the problem regular, as in lqg
    let whole = lqg_plant(goal, &LqgWeights { process_noise: 1.0, ..weights(problem) })?;
    let found = hinf(&whole, &HinfSettings::default())?;
    outcome.claimed.insert("gamma", found.gamma);
    outcome.claimed.insert("level", found.level);
    let recomputed = whole.close(&found.controller)?.hinf_norm()?.norm;
    outcome.claimed.insert("gamma_recomputed", recomputed);
    if recomputed > found.level * (1.0 + SAME_HINF) {
        return Err(SynthesisError::Refused {
            what: "the H∞ norm", claimed: found.level, found: recomputed
        });
    }
    let text = "gamma is the norm of all weighted outputs together, sensors' noise and weighted controls included: the largest \
                of the single ones is smaller (goal)";
    outcome.notes.push(Flag { name: "joint-norm".into(), text: text.into() });
    if !found.decided {
        let text = format!(
            "below {:.4} the equations are too ill-conditioned to be solved: the controller is confirmed, but a smaller norm may be \
             possible; raise lqg.sensor_noise or weight the controls (input_weight)",
            found.gamma
        );
        outcome.warnings.push(Flag { name: "gamma-undecided".into(), text });
    }
    Ok(Some(found.controller))
}

pub(super) fn by_limit(
    problem: &Problem,
    goal: &GeneralizedPlant,
    outcome: &mut DesignOutcome,
) -> Result<(), SynthesisError> {
    outcome.status = DesignStatus::Limit;
    let quiet = LqgWeights { sensor_noise: vec![0.0; problem.measurements.len()], ..weights(problem) };
    let whole = lqg_plant(goal, &LqgWeights { process_noise: 1.0, ..quiet })?;
    let (riccati, _) = full_information(&whole).or_else(|e| {
        let mut broken = broken_assumptions(&whole)?;
        broken.retain(|b| {
            matches!(
                b.assumption,
                Assumption::Stabilisable | Assumption::ControlsWeighted | Assumption::NoControlZeroOnAxis
            )
        });
        Err(if broken.is_empty() { e } else { SynthesisError::Assumptions(broken) })
    })?;
    outcome.claimed.insert("h2_limit", riccati);
    outcome.objective.insert("limit", riccati * riccati);
    match h2_limit(&whole) {
        Ok(closed) => {
            outcome.claimed.insert("h2_limit_closed_form", closed.h2);
            same("the H2 limit", riccati, closed.h2, SAME_LIMIT)?;
        }
        Err(e) => {
            let text = format!("the closed form by inner-outer factors is not at hand: {e}");
            outcome.notes.push(Flag { name: "one-route".into(), text });
        }
    }
    let text = "the limit of regulators that see every state: with these measurements it is approached, and not reached, as \
                sensor noise vanishes, where the measurements lose nothing of the road (no zeros from road to measurements \
                in the right half plane, as many measurements as disturbances)";
    outcome.notes.push(Flag { name: "limit".into(), text: text.into() });
    Ok(())
}

fn same(what: &'static str, claimed: f64, found: f64, tolerance: f64) -> Result<(), SynthesisError> {
    if (claimed - found).abs() <= tolerance * claimed.abs().max(found.abs()) {
        Ok(())
    } else {
        Err(SynthesisError::Refused { what, claimed, found })
    }
}
