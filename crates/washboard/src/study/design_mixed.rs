//! `method = "mixed-h2-hinf"`: from a design's goals to matrix inequalities, and what they promise beside what is so.

use super::Flag;
use super::design_limits;
use super::design_methods::Found;
use super::design_outcome::DesignOutcome;
use super::design_problem::{GoalBlock, Problem};
use super::design_search::{Attempt, Made, Try};
use crate::lti::{GeneralizedPlant, LtiError};
use crate::optimize::SdpSettings;
use crate::synthesis::{
    H2Goal, HinfGoal, LqgWeights, MixedAchieved, MixedClaims, MixedEnd, MixedGoals, SynthesisError,
    lqg_plant, mixed_h2_hinf,
};

/// Modes that nothing reaches or sees, relative, are left out of the inequalities.
const MINIMAL: f64 = 1e-10;

/// The goals as the inequalities take them, for a plant whose performances are the problem's `reported` ones followed by
/// weighted controls; all bounds `times` what is asked.
pub(super) fn goals(problem: &Problem, plant: &GeneralizedPlant, asked: Try) -> MixedGoals {
    let Try { times, back_off, region, added_weight, .. } = asked;
    let of = |g: &GoalBlock, factor: f64| g.members.iter().map(move |i| (*i, factor)).collect::<Vec<_>>();
    let mut outputs: Vec<(usize, f64)> = Vec::new();
    for g in problem.goals.iter().filter(|g| g.weight > 0.0) {
        outputs.extend(of(g, g.weight / g.passive));
    }
    let asked = !outputs.is_empty() || problem.spec.input_weight + added_weight > 0.0;
    outputs.extend((problem.reported.len()..plant.nz()).map(|k| (k, 1.0)));
    // the sensors' noise is white, and no part of a largest gain
    let road: Vec<usize> = (0..problem.plant.nw()).collect();
    let peak = |p: &super::design_problem::PeakBlock| HinfGoal {
        outputs: of(&p.block, 1.0),
        disturbances: road.clone(),
        weight: (p.block.weight / p.block.passive).powi(2),
        bound: p.bound.map(|b| times * b * p.block.passive),
    };
    let minimised = asked.then(|| H2Goal { outputs, weight: 1.0, ..H2Goal::default() });
    // over the passive norm: of order one
    let bounded = problem.bounded.iter().map(|g| H2Goal {
        outputs: of(g, 1.0 / g.passive),
        bound: Some(times * g.weight),
        ..H2Goal::default()
    });
    MixedGoals {
        h2: minimised.into_iter().chain(bounded).collect(),
        hinf: problem.peaks.iter().map(peak).collect(),
        region,
        scale: problem.spec.lyapunov_scale.into(),
        back_off,
    }
}

/// The problem's plant with weighted controls as performances and the sensors' noise as disturbances, without the modes that
/// no signal shows.
fn plant(problem: &Problem, added_weight: f64) -> Result<GeneralizedPlant, SynthesisError> {
    let noise = problem.spec.mixed.unwrap_or_default().sensor_noise;
    Ok(minimal(lqg_plant(&problem.plant, &weights(problem, noise, added_weight))?)?)
}

/// Weighted controls and noisy sensors.
pub(super) fn weights(problem: &Problem, sensor_noise: f64, added_weight: f64) -> LqgWeights {
    LqgWeights {
        sensor_noise: vec![sensor_noise; problem.measurements.len()],
        input_weight: vec![problem.spec.input_weight + added_weight; problem.plant.nu()],
        process_noise: 1.0,
        cross_term: true,
    }
}

/// Without the modes that no signal shows: they would be called unstable where they stand still.
pub(super) fn minimal(plant: GeneralizedPlant) -> Result<GeneralizedPlant, LtiError> {
    let small = plant.system().minimal(MINIMAL)?;
    if small.order() == plant.order() {
        return Ok(plant);
    }
    GeneralizedPlant::new(small, plant.signals().clone())
}

pub(super) fn by_mixed(problem: &Problem, alone: &Problem, outcome: &mut DesignOutcome) -> Found {
    let spec = &problem.spec;
    let whole = plant(alone, 0.0)?;
    let asked = spec.mixed.unwrap_or_default().back_off;
    let region = spec.poles.unwrap_or_default().region().unwrap_or_default();
    let solve = |tried: Try| {
        let settings = SdpSettings { double_double: tried.patient, ..SdpSettings::default() };
        let weighted = if tried.added_weight > 0.0 { &plant(alone, tried.added_weight)? } else { &whole };
        let goals = goals(alone, weighted, tried);
        Ok(match mixed_h2_hinf(weighted, &goals, &settings)? {
            MixedEnd::Found(found) => Attempt::Found(Box::new(Made {
                controller: found.controller.clone(),
                poles: found.achieved.poles.clone(),
                of: found,
            })),
            MixedEnd::Infeasible { bounds_times, .. } => Attempt::Infeasible(bounds_times),
            MixedEnd::Stalled(measures) => Attempt::Stalled(measures),
        })
    };
    let Some(kept) = design_limits::within(problem, asked, region, outcome, solve)? else { return Ok(None) };
    let found = &kept.of;
    let all =
        goals(alone, &whole, Try { times: 1.0, back_off: asked, region, added_weight: 0.0, patient: true });
    claims(problem, &all, &found.claims, std::slice::from_ref(&found.achieved), outcome);
    kept.claim(outcome);
    outcome.claimed.insert("optimum", found.optimum);
    outcome.claimed.insert("condition", found.condition);
    iterations(found.iterations, outcome);
    if !found.optimal {
        let text = "the solver stalled before its optimum: the promise is kept, but a better controller may be possible";
        outcome.warnings.push(Flag { name: "not-optimal".into(), text: text.into() });
    }
    Ok(Some(kept.controller))
}

pub(super) fn iterations(count: [usize; 2], outcome: &mut DesignOutcome) {
    outcome.claimed.insert("iterations", count[0] as f64);
    if count[1] > 0 {
        outcome.claimed.insert("iterations_double_double", count[1] as f64);
    }
}

/// Promises beside what the worst of the loops has.
pub(super) fn claims(
    problem: &Problem,
    goals: &MixedGoals,
    claims: &MixedClaims,
    achieved: &[MixedAchieved],
    outcome: &mut DesignOutcome,
) {
    let worst =
        |of: &dyn Fn(&MixedAchieved) -> f64| achieved.iter().map(of).fold(f64::NEG_INFINITY, f64::max);
    let value = |a: &MixedAchieved| {
        let peaks = goals.hinf.iter().zip(&a.hinf).map(|(g, v)| g.weight * v * v).sum::<f64>();
        peaks + goals.h2.iter().zip(&a.h2).map(|(g, v)| g.weight * v * v).sum::<f64>()
    };
    let weighted = goals.h2.iter().take_while(|g| g.weight > 0.0).count();
    let minimised = weighted > 0 || goals.hinf.iter().any(|g| g.weight > 0.0);
    if minimised {
        outcome.claimed.insert("objective", claims.objective);
        outcome.claimed.insert("objective_recomputed", worst(&value));
    }
    if let Some(h2) = claims.h2.first().filter(|_| weighted > 0) {
        outcome.claimed.insert("h2", *h2);
        outcome.claimed.insert("h2_recomputed", worst(&|a| a.h2[0]));
    }
    for (k, block) in problem.bounded.iter().enumerate() {
        let (name, k) = (&block.name, weighted + k);
        outcome.claimed.insert(format!("h2_{name}"), claims.h2[k] * block.passive);
        outcome.claimed.insert(format!("h2_{name}_recomputed"), worst(&|a| a.h2[k]) * block.passive);
    }
    for (k, (peak, claimed)) in problem.peaks.iter().zip(&claims.hinf).enumerate() {
        let name = &peak.block.name;
        outcome.claimed.insert(format!("hinf_{name}"), *claimed);
        outcome.claimed.insert(format!("hinf_{name}_recomputed"), worst(&|a| a.hinf[k]));
        if !claims.h2.is_empty() {
            outcome.claimed.insert(format!("lyapunov_scale_{name}"), claims.scales[k]);
        }
    }
}
