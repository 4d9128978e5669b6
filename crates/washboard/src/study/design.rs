//! The job `design`: a controller for a vehicle on a road, what it buys, and the proof.

use super::design_outcome::{ControllerFile, DesignOutcome, DesignStatus, Measured};
use super::design_problem::{Norm, Problem};
use super::{DesignMethod, DesignSpec, Flag, Input, Named, Rms, StudyError};
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
/// A response that is so many times the passive one at its worst is worth a warning.
const WORSE_PEAK: f64 = 3.0;
/// An output that becomes worse by more than this share is worth a warning.
const WORSE_RMS: f64 = 0.1;

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
        super::design_interpolation::check(&problem)?;
    }
    let fail =
        |source: SynthesisError| StudyError::Design { name: spec.vehicle.clone(), source: Box::new(source) };
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
        notes: Vec::new(),
        gains: super::design_outcome::Gains::default(),
        forces: Named::default(),
    };
    let goal = problem.weighted().map_err(|e| fail(e.into()))?;
    outcome.objective.insert("passive", objective(&problem, norm, &outcome.passive));
    let found = match spec.method {
        DesignMethod::Lqg => by_lqg(&problem, &goal, &mut outcome),
        DesignMethod::Interpolation => super::design_interpolation::by_interpolation(&problem, &mut outcome),
        DesignMethod::Hinf => by_hinf(&problem, &goal, &mut outcome),
        DesignMethod::H2Limit => by_limit(&problem, &goal, &mut outcome).map(|()| None),
    };
    let controller = match found {
        Ok(controller) => controller,
        Err(e) => {
            outcome.status = match &e {
                SynthesisError::Refused { .. } => DesignStatus::Refused,
                // no control at all is a controller of a stable plant: what fails there is the method
                SynthesisError::NoLevel { .. } if outcome.passive.stable => DesignStatus::Stalled,
                SynthesisError::NotAchievable(_)
                | SynthesisError::Assumptions(_)
                | SynthesisError::NoLevel { .. } => DesignStatus::Infeasible,
                _ => DesignStatus::Stalled,
            };
            outcome.why = Some(advice(&e));
            outcome.gains = problem.gains(None)?;
            return Ok((outcome, problem.inputs));
        }
    };
    if let Some(k) = &controller {
        finish(&problem, norm, k, &mut outcome)?;
    }
    outcome.gains = problem.gains(controller.as_ref())?;
    Ok((outcome, problem.inputs))
}

/// Why, and what may help.
fn advice(e: &SynthesisError) -> String {
    use crate::linalg::RiccatiError;
    match e {
        SynthesisError::Riccati { equation: "filter", source: RiccatiError::OnTheBoundary { .. } } => {
            format!(
                "{e}: the measurements hardly see the road there; raise lqg.sensor_noise, or measure something that the road moves at that frequency"
            )
        }
        SynthesisError::NoLevel { .. } => {
            format!(
                "{e}; raise lqg.sensor_noise, or weight the controls (input_weight): as it stands the equations are too ill-conditioned to be solved"
            )
        }
        _ => e.to_string(),
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
        measured.rms_with_noise = with_noise(problem, k, &measured)?;
        let louder: Vec<String> = problem
            .goals
            .iter()
            .filter_map(|g| {
                let noisy = measured.rms_with_noise.get(&g.name)?.finite()?;
                let passive = outcome.passive.rms.get(&g.name)?.finite()?;
                (noisy > passive).then(|| format!("{} {:+.0} %", g.name, 100.0 * (noisy / passive - 1.0)))
            })
            .collect();
        if !louder.is_empty() {
            let text = format!(
                "with the sensor noise stated, outputs are worse than passive: {}. The filter trusts the sensors as lqg.process_noise \
                 (road) over lqg.sensor_noise says: give both as they are, or take rms as the road's part alone",
                louder.join(", ")
            );
            outcome.warnings.push(Flag { name: "noise".into(), text });
        }
    }
    outcome.objective.insert("verified", objective(problem, norm, &measured));
    outcome.warnings.extend(warnings(problem, &outcome.passive, &measured));
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
        outcome.warnings.extend(sampled_loop(problem, k, discretize)?);
    }
    outcome.order = Some(k.order());
    outcome.controller = Some(ControllerFile::new(k, y, u));
    outcome.verified = Some(measured);
    Ok(())
}

/// A warning where the discrete controller, on the vehicle sampled at its step, is not stable.
fn sampled_loop(
    problem: &Problem,
    k: &StateSpace<Continuous>,
    discretize: super::Discretize,
) -> Result<Option<Flag>, StudyError> {
    let fail =
        |e: SynthesisError| StudyError::Design { name: problem.spec.vehicle.clone(), source: Box::new(e) };
    let y: Vec<&crate::vehicle::Output> = problem.measurements.iter().collect();
    let all: Vec<usize> = (0..problem.vehicle.actuators().len()).collect();
    let vehicle = problem.vehicle.actuated(&y, &all).map_err(|source| StudyError::Controller {
        name: problem.spec.vehicle.clone(),
        source: Box::new(source),
    })?;
    let discrete = match discretize.rule {
        super::DiscretizeRule::Tustin => k.tustin(discretize.dt_s),
        super::DiscretizeRule::ZeroOrderHold => k.sampled(discretize.dt_s),
    };
    let closed = discrete
        .and_then(|d| vehicle.sampled(discretize.dt_s)?.feedback(&d))
        .and_then(|closed| closed.least_stable_pole())
        .map_err(|e| fail(e.into()))?;
    let (pole, margin) = closed.unwrap_or_default();
    Ok((!(margin > 0.0)).then(|| Flag {
        name: "sampled-loop".into(),
        text: format!(
            "at a step of {} s the loop of controller.h and the vehicle is not stable: a pole of size {:.4}; take a shorter step",
            discretize.dt_s,
            pole.norm()
        ),
    }))
}

type Found = Result<Option<StateSpace<Continuous>>, SynthesisError>;

fn weights(problem: &Problem) -> LqgWeights {
    let spec = &problem.spec;
    LqgWeights {
        sensor_noise: vec![spec.lqg.sensor_noise; problem.measurements.len()],
        input_weight: vec![spec.input_weight; problem.plant.nu()],
        process_noise: spec.lqg.process_noise,
        cross_term: spec.lqg.cross_term,
    }
}

fn by_lqg(problem: &Problem, goal: &GeneralizedPlant, outcome: &mut DesignOutcome) -> Found {
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

fn by_hinf(problem: &Problem, goal: &GeneralizedPlant, outcome: &mut DesignOutcome) -> Found {
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
                of the single ones is smaller (objective)";
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

fn by_limit(
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

/// The rms of road and sensors' noise together, where both are finite.
fn with_noise(
    problem: &Problem,
    k: &StateSpace<Continuous>,
    measured: &Measured,
) -> Result<Named<Rms>, StudyError> {
    let fail =
        |e: SynthesisError| StudyError::Design { name: problem.spec.vehicle.clone(), source: Box::new(e) };
    let noise = vec![problem.spec.lqg.sensor_noise; problem.measurements.len()];
    let noisy = problem.plant.with_sensor_noise(&noise).map_err(|e| fail(e.into()))?;
    let closed = noisy.close(k).map_err(|e| fail(e.into()))?;
    let sensors: Vec<usize> = (problem.plant.nw()..noisy.nw()).collect();
    let mut both = Named::default();
    for (name, members) in problem.blocks() {
        let part = closed.select(&members, &sensors).map_err(|e| fail(e.into()))?.h2_norm();
        let road = measured.rms.get(&name).and_then(|r| r.finite());
        let rms = match (part, road) {
            (Ok(noise), Some(road)) => Rms::Finite(noise.hypot(road)),
            _ => Rms::Infinite(super::Infinite::Infinite),
        };
        both.insert(name, rms);
    }
    Ok(both)
}

/// What a reader must know: responses that became much worse somewhere, and lightly damped modes that hide.
fn warnings(problem: &Problem, passive: &Measured, closed: &Measured) -> Vec<Flag> {
    let mut warnings = Vec::new();
    let mut warn = |name: &str, text: String| warnings.push(Flag { name: name.into(), text });
    let singles =
        problem.reported.iter().map(|o| o.name.as_str()).filter(|n| !n.starts_with("actuator_force"));
    for name in singles {
        if let (Some(before), Some(after)) = (passive.hinf.get(name), closed.hinf.get(name))
            && *after > WORSE_PEAK * before
            && *before > problem.floor(name)
        {
            let at = closed.hinf_at_rad_s.get(name).copied().flatten();
            let place = at.map_or_else(
                || "at high frequencies".to_owned(),
                |w| format!("at {:.2} Hz", crate::units::hz(w)),
            );
            warn(
                "worse-peak",
                format!("the largest gain of {name} is {:.1} times the passive one, {place}", after / before),
            );
        }
        if let (Some(Some(before)), Some(Some(after))) =
            (passive.rms.get(name).map(|r| r.finite()), closed.rms.get(name).map(|r| r.finite()))
            && after > (1.0 + WORSE_RMS) * before
        {
            warn(
                "worse-rms",
                format!("{name} is {:.0} % larger than passive on this road", 100.0 * (after / before - 1.0)),
            );
        }
    }
    warnings
}
