//! The job `design`: a controller for a vehicle on a road, what it buys, and the proof.

use super::beyond_band::continued;
use super::design_methods::{by_hinf, by_limit, by_lqg};
use super::design_outcome::{ControllerFile, DesignOutcome, DesignStatus, Gains, Measured};
use super::design_problem::{GoalBlock, Norm, Problem};
use super::{
    DesignMethod, DesignSpec, Flag, Input, LoadedExcitation, LoadedVehicle, MetricsSection, Named,
    StudyError, load_excitation, load_vehicle,
};
use super::{
    design_advice, design_beside, design_fixed_order, design_interpolation, design_mixed, design_outputs,
    design_robust, design_states, design_truncated, design_warnings, design_words,
};
use crate::lti::{Continuous, StateSpace};
use crate::synthesis::SynthesisError;
use crate::vehicle::{Output, RideError};

/// Designs a controller.
///
/// # Errors
/// A vehicle, road or goal that is wrong. A plant that breaks an assumption of the method, or a loop that contradicts
/// its controller, is an outcome with `status` and `why`.
pub fn design(spec: &DesignSpec) -> Result<(DesignOutcome, Vec<Input>), StudyError> {
    design_with(spec, None, Some(spec.metrics.unwrap_or_default()), true)
}

/// The controller and its certificate, where a controller of the same signals is at hand: one more start of `fixed-order`,
/// and nothing to the others; with metrics where they are asked for.
pub(super) fn design_from(
    spec: &DesignSpec,
    neighbour: Option<&ControllerFile>,
    metrics: Option<MetricsSection>,
) -> Result<(DesignOutcome, Vec<Input>), StudyError> {
    design_with(spec, neighbour, metrics, false)
}

/// `whole`: what a page shows beside the certificate, too, and a sweep of many designs has no time for.
fn design_with(
    spec: &DesignSpec,
    neighbour: Option<&ControllerFile>,
    metrics: Option<MetricsSection>,
    whole: bool,
) -> Result<(DesignOutcome, Vec<Input>), StudyError> {
    spec.check()?;
    let (vehicle, road) = (load_vehicle(&spec.vehicle)?, load_excitation(&spec.road)?);
    on(spec, vehicle, road, neighbour, metrics, whole)
}

/// For a vehicle and a road that are at hand under the names that the spec has: the controller and its certificate alone, or what a page
/// shows beside them, too.
pub(super) fn design_on(
    spec: &DesignSpec,
    vehicle: LoadedVehicle,
    road: LoadedExcitation,
    whole: bool,
) -> Result<(DesignOutcome, Vec<Input>), StudyError> {
    on(spec, vehicle, road, None, None, whole)
}

fn on(
    spec: &DesignSpec,
    vehicle: LoadedVehicle,
    road: LoadedExcitation,
    neighbour: Option<&ControllerFile>,
    metrics: Option<MetricsSection>,
    whole: bool,
) -> Result<(DesignOutcome, Vec<Input>), StudyError> {
    let norm = if spec.method == DesignMethod::Hinf { Norm::Hinf } else { Norm::H2 };
    let problem = Problem::on(spec, norm, vehicle, road)?;
    if spec.method == DesignMethod::Interpolation {
        design_interpolation::check(&problem)?;
    }
    if spec.method.takes_bounds() {
        design_states::check_bounded(&problem)?;
    }
    let robust = match spec.method {
        DesignMethod::RobustStateFeedback => Some(design_robust::Family::new(&problem)?),
        _ => None,
    };
    let alone = match spec.method {
        DesignMethod::MixedH2Hinf => Some(problem.at(&[])?),
        _ => None,
    };
    let fleet = match spec.method {
        DesignMethod::FixedOrder => Some(design_fixed_order::Fleet::new(&problem, neighbour)?),
        _ => None,
    };
    let mut outcome = DesignOutcome {
        status: DesignStatus::Designed,
        why: None,
        design: DesignSpec {
            measurements: problem.asked_measurements(),
            lqg: (!spec.method.takes_bounds()).then(|| spec.noises()),
            ..spec.clone().with_search_stated()
        },
        controller: None,
        order: None,
        claimed: Named::default(),
        verified: None,
        feasible_bound: Named::default(),
        fixed_order: None,
        vertices: Vec::new(),
        nominal: None,
        truncated: Vec::new(),
        passive: problem.measure(None)?,
        objective: Named::default(),
        warnings: Vec::new(),
        notes: problem
            .ground
            .notes
            .iter()
            .cloned()
            .chain(design_words::expanded(&problem))
            .chain(design_words::unused(&problem))
            .chain(design_outputs::left_out(&problem))
            .collect(),
        units: problem.units(),
        gains: Gains::default(),
        limit: None,
        vehicle: None,
        invariant: Vec::new(),
        responses: None,
        robustness: None,
        forces: Named::default(),
        metrics: None,
    };
    let goal = problem
        .weighted()
        .map_err(|e| StudyError::Design { name: spec.vehicle.clone(), source: Box::new(e.into()) })?;
    if problem.has_objective() && outcome.passive.stable {
        outcome.objective.insert("passive", objective(&problem, &outcome.passive));
    }
    outcome.notes.extend(design_warnings::unstable_passive(&outcome.passive));
    let found = match spec.method {
        DesignMethod::Lqg => by_lqg(&problem, &goal, &mut outcome),
        DesignMethod::Interpolation => design_interpolation::by_interpolation(&problem, &mut outcome),
        DesignMethod::Hinf => by_hinf(&problem, &goal, &mut outcome),
        DesignMethod::MixedH2Hinf => match &alone {
            Some(alone) => design_mixed::by_mixed(&problem, alone, &mut outcome),
            None => Ok(None),
        },
        DesignMethod::RobustStateFeedback => match &robust {
            Some(family) => design_robust::by_robust(&problem, family, &mut outcome),
            None => Ok(None),
        },
        DesignMethod::FixedOrder => match &fleet {
            Some(fleet) => design_fixed_order::by_fixed_order(&problem, fleet, &mut outcome),
            None => Ok(None),
        },
        DesignMethod::H2Limit => by_limit(&problem, &goal, &mut outcome).map(|()| None),
    };
    let overflow = outcome.claimed.iter().find(|(_, v)| !v.is_finite()).map(|(name, _)| name.to_owned());
    let controller = match (found, overflow) {
        (Ok(_), Some(name)) => {
            design_advice::overflowed(&name, &problem, &mut outcome);
            None
        }
        (Ok(controller), None) => controller,
        (Err(e), _) => {
            outcome.status = status_of(&e, outcome.passive.stable);
            outcome.why = Some(design_words::why(&e, &problem, &outcome.passive));
            None
        }
    };
    if let (Some(fleet), Some(k)) = (&fleet, &controller) {
        fleet.confirm(k, &mut outcome)?;
    }
    if let Some(k) = controller.as_ref().filter(|_| outcome.status != DesignStatus::Refused) {
        finish(&problem, k, &mut outcome)?;
    }
    let kept = controller.as_ref().filter(|_| outcome.status == DesignStatus::Designed);
    if let (Some(family), Some(k)) = (&robust, kept) {
        family.measure(k, &mut outcome)?;
    }
    if let (Some(alone), Some(k)) = (&alone, kept) {
        design_truncated::truncate(alone, k, &mut outcome)?;
    }
    let outputs: Vec<&Output> = problem.reported.iter().collect();
    for (measured, whose) in
        [(Some(&outcome.passive), ", passive,"), (outcome.verified.as_ref(), ", designed,")]
    {
        let shares = measured.and_then(|m| m.beyond_band.as_ref());
        outcome.notes.extend(shares.and_then(|b| continued(b, &outputs, whose)));
    }
    if let Some(section) = metrics {
        let (found, notes) = problem.metrics(&section, outcome.passive.stable, kept);
        if let Some(verified) = &outcome.verified {
            let rows = found.short_rows(&outcome.units);
            outcome.warnings.extend(design_warnings::felt(&rows, &outcome.passive, verified));
        }
        outcome.metrics = Some(found);
        outcome.notes.extend(notes);
    }
    outcome.gains = problem.gains(outcome.passive.stable, kept)?;
    if whole {
        design_beside::beside(&problem, kept, &mut outcome);
    }
    let also = fleet.and_then(|f| f.input);
    Ok((outcome, problem.inputs.into_iter().chain(also).collect()))
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
    k: &StateSpace<Continuous>,
    outcome: &mut DesignOutcome,
) -> Result<(), StudyError> {
    let measured = match problem.measure(Some(k)) {
        Err(StudyError::Ride { source, .. })
            if problem.spec.method.takes_bounds() && !matches!(source, RideError::Control(_)) =>
        {
            design_advice::hidden(problem, outcome);
            return Ok(());
        }
        measured => measured?,
    };
    if !measured.stable {
        // of a controller for other vehicles, which need not hold the one as stated
        let slowest = measured.poles.iter().map(|p| p[0]).fold(f64::NEG_INFINITY, f64::max);
        outcome.status = DesignStatus::Refused;
        let place = if problem.spec.range.is_empty() { "among [[plant]]" } else { "into the range" };
        outcome.why = Some(format!(
            "the loop with the vehicle as stated is not stable (a pole with real part {}): put it {place}, or state one that is \
             in it (override)",
            design_words::short(slowest)
        ));
        outcome.vertices.clear();
        return Ok(());
    }
    let mut measured = measured;
    if problem.spec.method == DesignMethod::Lqg {
        measured.rms_with_noise = design_warnings::with_noise(problem, k, &measured)?;
        outcome.warnings.extend(design_warnings::louder(problem, &outcome.passive, &measured));
    }
    if problem.has_objective() {
        outcome.objective.insert("verified", objective(problem, &measured));
    }
    outcome.warnings.extend(design_warnings::unstable_controller(k));
    outcome.warnings.extend(design_warnings::worse(problem, &outcome.passive, &measured));
    if let Some((flag, is)) = design_warnings::algebraic_loop(problem, k)? {
        let list = if is { &mut outcome.warnings } else { &mut outcome.notes };
        list.push(flag);
    }
    if problem.spec.method.takes_bounds() {
        outcome.warnings.extend(design_warnings::paces(problem.spec.method, &outcome.passive, &measured));
    }
    let (before, after) = (outcome.objective.get("passive"), outcome.objective.get("verified"));
    if let (Some(before), Some(after)) = (before, after)
        && *after > (1.0 + design_warnings::ALIKE) * before
    {
        let why = if problem.spec.method.takes_bounds() {
            "bounds, poles or noise ask for that, or the promise is far above what is so"
        } else {
            "noise and weighted controls outweigh it"
        };
        let text = format!("the goal itself is worse than passive ({after:.4} against {before:.4}): {why}");
        outcome.warnings.push(Flag { name: "worse-goal".into(), text });
    }
    if problem.spec.method == DesignMethod::FixedOrder {
        outcome.notes.extend(design_warnings::no_better(k, &outcome.objective));
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

/// Σ(wᵢ‖Tᵢ‖₂/‖Gᵢ‖₂)², and of the methods by inequalities Σ(wᵢ‖Tᵢ‖∞/‖Gᵢ‖∞)² too; or max wᵢ‖Tᵢ‖∞/‖Gᵢ‖∞; of `fixed-order`
/// the larger one of this and √Σ(wᵢ‖Tᵢ‖₂/‖Gᵢ‖₂)².
pub(super) fn objective(problem: &Problem, measured: &Measured) -> f64 {
    let hinf = |name: &str| measured.hinf.get(name).copied().unwrap_or(f64::INFINITY);
    if problem.spec.method == DesignMethod::Hinf {
        return problem.goals.iter().map(|g| g.weight * hinf(&g.name) / g.passive).fold(0.0, f64::max);
    }
    let peaks = problem.peaks.iter().filter(|p| p.block.weight > 0.0).map(|p| &p.block);
    let peaks = peaks.map(|b| b.weight * hinf(&b.name) / b.passive);
    if problem.spec.method == DesignMethod::FixedOrder {
        return peaks.fold(squared_h2(problem, measured).sqrt(), f64::max);
    }
    squared_h2(problem, measured) + peaks.map(|v| v * v).sum::<f64>()
}

/// Σ(wᵢ‖Tᵢ‖₂/‖Gᵢ‖₂)² + ρ‖u‖₂².
pub(super) fn squared_h2(problem: &Problem, measured: &Measured) -> f64 {
    let h2 = |name: &str| measured.h2.get(name).and_then(|r| r.finite());
    let squared = |g: &GoalBlock| (g.weight * h2(&g.name).unwrap_or(f64::INFINITY) / g.passive).powi(2);
    // the weighted force belongs to the cost
    let force = h2("actuator_force").unwrap_or(0.0);
    problem.goals.iter().map(squared).sum::<f64>() + problem.spec.input_weight * force * force
}
