//! What no controller beats, beside what a design does: the loop of the regulator that sees every state, for the design's own weights.

use super::design_problem::{Norm, Problem};
use super::design_spec::DesignSpec;
use super::{DesignDisturbance, DesignMethod, Goal, Infinite, Named, Rms, StudyError};
use crate::lti::{Continuous, LtiError, StateSpace};
use crate::synthesis::{LqgWeights, full_information, lqg_plant};
use serde::{Deserialize, Serialize};

/// The H2 limit of a design's weighted outputs: Σ(wᵢ‖Tᵢ‖₂/‖Gᵢ‖₂)² + ρ‖u‖₂² of the regulator that sees every state and the road.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct DesignLimit {
    /// Its least value.
    pub value: f64,
    /// Weights of the outputs.
    pub weights: Named<f64>,
    /// H2 norms at it; of single outputs others may be smaller.
    pub h2: Named<Rms>,
    /// rms on the road, where they are proportional to H2 norms: white road velocity, or the road's own noise.
    #[serde(default, skip_serializing_if = "Named::is_empty")]
    pub rms: Named<Rms>,
}

/// The limit of what a design minimises, in whatever norm, as H2 norms; none where the control costs nothing at all, or equations have no
/// solution.
pub(super) fn limit(problem: &Problem) -> Option<DesignLimit> {
    let spec = &problem.spec;
    let goal = &spec.goal;
    let mut weights: Named<f64> = Named::default();
    if spec.method == DesignMethod::Interpolation {
        weights = spec.weights().ok()?;
    }
    for (name, w) in goal.minimize.iter().chain(goal.minimize_h2.iter()).chain(goal.minimize_hinf.iter()) {
        if *w > 0.0 {
            weights.insert(name, *w);
        }
    }
    // a limit of a method in H∞ norms has other controls, which cost √ρ
    let alone = DesignSpec {
        method: DesignMethod::H2Limit,
        goal: Goal { minimize: weights.clone(), groups: goal.groups.clone(), ..Goal::default() },
        vehicle: spec.vehicle.clone(),
        road: spec.road.clone(),
        speed_m_s: spec.speed_m_s,
        measurements: problem.measurements.iter().map(|o| o.name.clone()).collect(),
        disturbance: spec.disturbance,
        r#override: spec.r#override.clone(),
        normalize_at: spec.normalize_at.clone(),
        input_weight: spec.input_weight,
        delay_order: spec.delay_order,
        ..DesignSpec::default()
    };
    found(&alone, weights).ok().flatten()
}

fn found(spec: &DesignSpec, weights: Named<f64>) -> Result<Option<DesignLimit>, StudyError> {
    let problem = Problem::new(spec, Norm::H2)?;
    let fail =
        |e: LtiError| StudyError::Design { name: problem.spec.vehicle.clone(), source: Box::new(e.into()) };
    let costs = LqgWeights {
        sensor_noise: vec![0.0; problem.measurements.len()],
        input_weight: vec![spec.input_weight; problem.plant.nu()],
        ..LqgWeights::default()
    };
    let goal = problem.weighted().map_err(fail)?;
    let Ok((norm, regulator)) = lqg_plant(&goal, &costs).and_then(|p| full_information(&p)) else {
        return Ok(None);
    };
    let (p, f) = (&problem.plant, &regulator.gain);
    let closed =
        StateSpace::continuous(p.a() + p.b2() * f, p.b1(), p.c1() + p.d12() * f, p.d11()).map_err(fail)?;
    if !closed.is_stable().map_err(fail)? {
        return Ok(None);
    }
    let h2 = norms(&problem, &closed).map_err(fail)?;
    let passive = norms(&problem, &p.passive()).map_err(fail)?;
    let road = problem.ground.excitation();
    let white = match spec.disturbance {
        DesignDisturbance::RoadVelocity => road.white_intensity(spec.speed_m_s).is_some(),
        DesignDisturbance::RoadNoise => true,
        DesignDisturbance::RoadDisplacement => false,
    };
    let own = problem.measure(None)?.rms;
    let rms = |(name, limit): (&str, &Rms)| {
        // the force has none without control
        let scale = own.iter().find_map(|(n, r)| {
            let (rms, h2) = (r.finite()?, passive.get(n)?.finite()?);
            (rms > 0.0 && h2 > 0.0).then_some(rms / h2)
        });
        let by = own.get(name)?.finite()?.max(0.0);
        let before = passive.get(name)?.finite()?;
        let scale = if before > 0.0 { by / before } else { scale? };
        Some((name.to_owned(), Rms::Finite(limit.finite()? * scale)))
    };
    let rms = h2.iter().filter_map(rms).collect();
    let rms = if white { rms } else { Named::default() };
    Ok(Some(DesignLimit { value: norm * norm, weights, h2, rms }))
}

/// H2 norms of the blocks.
fn norms(problem: &Problem, g: &StateSpace<Continuous>) -> Result<Named<Rms>, LtiError> {
    let inputs: Vec<usize> = (0..g.inputs()).collect();
    let mut all = Named::default();
    for (name, members) in problem.blocks() {
        let norm = match g.select(&members, &inputs)?.h2_norm() {
            Ok(v) => Rms::Finite(v),
            Err(LtiError::NotStrictlyProper { .. }) => Rms::Infinite(Infinite::Infinite),
            Err(e) => return Err(e),
        };
        all.insert(name, norm);
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::{DesignOutcome, design};

    /// A Riccati equation and Lyapunov equations of 4 to 20 states.
    const SAME: f64 = 1e-6;

    fn designed(vehicle: &str, outputs: &[&str], measured: &str, input_weight: f64) -> DesignOutcome {
        let spec = DesignSpec {
            vehicle: format!("case:{vehicle}"),
            road: "case:turkay-white-velocity".into(),
            speed_m_s: 20.0,
            measurements: vec![measured.into()],
            input_weight,
            delay_order: 2,
            goal: Goal {
                minimize: outputs.iter().map(|n| ((*n).to_owned(), 1.0)).collect(),
                ..Goal::default()
            },
            ..DesignSpec::default()
        };
        design(&spec).unwrap().0
    }

    #[test]
    fn the_limits_norms_make_its_value_and_no_design_is_below() {
        let three = ["sprung_acceleration", "suspension_travel", "tire_deflection"];
        let all = [
            designed("turkay-quarter-car", &three, "suspension_travel", 0.0),
            designed(
                "turkay-half-car",
                &["heave_acceleration", "suspension_travel"],
                "suspension_travel",
                1e-9,
            ),
        ];
        for o in all {
            let limit = o.limit.as_ref().unwrap();
            let h2 = |name: &str| limit.h2.get(name).and_then(|r| r.finite()).unwrap();
            let passive = |name: &str| o.passive.h2.get(name).and_then(|r| r.finite()).unwrap();
            let sum: f64 = limit.weights.iter().map(|(n, w)| (w * h2(n) / passive(n)).powi(2)).sum();
            let force = o.design.input_weight * h2("actuator_force").powi(2);
            assert!(((sum + force) / limit.value - 1.0).abs() < SAME, "{} {}", sum + force, limit.value);
            // the method's own limit, and what it reached
            assert!((limit.value / o.objective.get("limit").unwrap() - 1.0).abs() < SAME);
            assert!(limit.value < *o.objective.get("verified").unwrap());
            let rms = limit.rms.get("suspension_travel").and_then(|r| r.finite()).unwrap();
            let by_norm = o.passive.rms.get("suspension_travel").and_then(|r| r.finite()).unwrap()
                * h2("suspension_travel")
                / passive("suspension_travel");
            assert!((rms / by_norm - 1.0).abs() < SAME);
        }
    }

    #[test]
    fn a_limit_needs_a_control_that_costs_or_moves_something() {
        // neither travel nor tire moves with the force at once
        let o = designed("turkay-quarter-car", &["suspension_travel"], "suspension_travel", 0.0);
        assert!(o.limit.is_none() && o.verified.is_none());
    }
}
