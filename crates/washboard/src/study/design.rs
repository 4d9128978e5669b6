//! The job `design`: a controller for a vehicle on a road, what it buys, and the proof.

use super::beyond_band::continued;
use super::design_methods::{by_hinf, by_limit, by_lqg};
use super::design_outcome::{ControllerFile, DesignOutcome, DesignStatus, Gains, Measured};
use super::design_problem::{Norm, Problem};
use super::{DesignMethod, DesignSpec, Flag, Input, Named, StudyError};
use super::{design_interpolation, design_warnings, design_words};
use crate::lti::{Continuous, StateSpace};
use crate::synthesis::SynthesisError;
use crate::vehicle::Output;

/// Designs a controller.
///
/// # Errors
/// A vehicle, road or goal that is wrong. A plant that breaks an assumption of the method, or a loop that contradicts
/// its controller, is an outcome with `status` and `why`.
pub fn design(spec: &DesignSpec) -> Result<(DesignOutcome, Vec<Input>), StudyError> {
    spec.check()?;
    let norm = if spec.method == DesignMethod::Hinf { Norm::Hinf } else { Norm::H2 };
    let problem = Problem::new(spec, norm)?;
    if spec.method == DesignMethod::Interpolation {
        design_interpolation::check(&problem)?;
    }
    let mut outcome = DesignOutcome {
        status: DesignStatus::Designed,
        why: None,
        design: spec.clone(),
        controller: None,
        order: None,
        claimed: Named::default(),
        verified: None,
        passive: problem.measure(None)?,
        objective: Named::default(),
        warnings: Vec::new(),
        notes: problem.ground.notes.iter().cloned().chain(design_words::expanded(&problem)).collect(),
        units: problem.units(),
        gains: Gains::default(),
        forces: Named::default(),
    };
    let goal = problem
        .weighted()
        .map_err(|e| StudyError::Design { name: spec.vehicle.clone(), source: Box::new(e.into()) })?;
    outcome.objective.insert("passive", objective(&problem, norm, &outcome.passive));
    let found = match spec.method {
        DesignMethod::Lqg => by_lqg(&problem, &goal, &mut outcome),
        DesignMethod::Interpolation => design_interpolation::by_interpolation(&problem, &mut outcome),
        DesignMethod::Hinf => by_hinf(&problem, &goal, &mut outcome),
        DesignMethod::H2Limit => by_limit(&problem, &goal, &mut outcome).map(|()| None),
    };
    let controller = match found {
        Ok(controller) => controller,
        Err(e) => {
            outcome.status = status_of(&e, outcome.passive.stable);
            outcome.why = Some(design_words::why(&e, &problem, &outcome.passive));
            None
        }
    };
    if let Some(k) = &controller {
        finish(&problem, norm, k, &mut outcome)?;
    }
    let outputs: Vec<&Output> = problem.reported.iter().collect();
    for (measured, whose) in
        [(Some(&outcome.passive), ", passive,"), (outcome.verified.as_ref(), ", designed,")]
    {
        let shares = measured.and_then(|m| m.beyond_band.as_ref());
        outcome.notes.extend(shares.and_then(|b| continued(b, &outputs, whose)));
    }
    outcome.gains = problem.gains(controller.as_ref())?;
    Ok((outcome, problem.inputs))
}

fn status_of(e: &SynthesisError, passive_is_stable: bool) -> DesignStatus {
    match e {
        SynthesisError::Refused { .. } => DesignStatus::Refused,
        // no control at all is a controller of a stable plant: what fails there is the method
        SynthesisError::NoLevel { .. } if passive_is_stable => DesignStatus::Stalled,
        SynthesisError::NotAchievable(_)
        | SynthesisError::Assumptions(_)
        | SynthesisError::NoLevel { .. } => DesignStatus::Infeasible,
        _ => DesignStatus::Stalled,
    }
}

/// Measures the loop, warns of what became worse.
fn finish(
    problem: &Problem,
    norm: Norm,
    k: &StateSpace<Continuous>,
    outcome: &mut DesignOutcome,
) -> Result<(), StudyError> {
    let mut measured = problem.measure(Some(k))?;
    if problem.spec.method == DesignMethod::Lqg {
        measured.rms_with_noise = design_warnings::with_noise(problem, k, &measured)?;
        outcome.warnings.extend(design_warnings::louder(problem, &outcome.passive, &measured));
    }
    outcome.objective.insert("verified", objective(problem, norm, &measured));
    outcome.warnings.extend(design_warnings::worse(problem, &outcome.passive, &measured));
    let (before, after) = (outcome.objective.get("passive"), outcome.objective.get("verified"));
    if let (Some(before), Some(after)) = (before, after)
        && after > before
    {
        let text = format!(
            "the goal itself is worse than passive ({after:.4} against {before:.4}): noise and weighted controls outweigh it"
        );
        outcome.warnings.push(Flag { name: "worse-goal".into(), text });
    }
    for (name, rms) in measured.rms.iter().filter(|(name, _)| name.starts_with("actuator_force")) {
        outcome.forces.insert(name, *rms);
    }
    let y = problem.measurements.iter().map(|o| o.name.clone()).collect();
    let u = problem.vehicle.actuators().iter().map(|a| a.name.clone()).collect();
    if let Some(discretize) = problem.spec.discretize {
        outcome.warnings.extend(design_warnings::sampled_loop(problem, k, discretize)?);
    }
    outcome.order = Some(k.order());
    outcome.controller = Some(ControllerFile::new(k, y, u));
    outcome.verified = Some(measured);
    Ok(())
}

/// Σ(wᵢ‖Tᵢ‖₂/‖Gᵢ‖₂)², or max wᵢ‖Tᵢ‖∞/‖Gᵢ‖∞.
fn objective(problem: &Problem, norm: Norm, measured: &Measured) -> f64 {
    let terms = problem.goals.iter().map(|g| {
        let value = match norm {
            Norm::H2 => measured.h2.get(&g.name).and_then(|r| r.finite()),
            Norm::Hinf => measured.hinf.get(&g.name).copied(),
        };
        g.weight * value.unwrap_or(f64::INFINITY) / g.passive
    });
    match norm {
        // the weighted force belongs to the cost
        Norm::H2 => {
            let force = measured.h2.get("actuator_force").and_then(|r| r.finite()).unwrap_or(0.0);
            terms.map(|t| t * t).sum::<f64>() + problem.spec.input_weight * force * force
        }
        Norm::Hinf => terms.fold(0.0, f64::max),
    }
}
