//! How much a design depends on numbers that nobody knows to 5 %: each number of the vehicle and of the controller changed by itself, and
//! an actuator in the loop.

use super::design_actuator::{ActuatorLoop, with_actuator};
use super::design_controller_changes::{ControllerChanges, controller_changes};
use super::design_goal_norms::GoalNorms;
use super::design_problem::Problem;
use super::{Named, StudyError};
use crate::lti::{Continuous, LtiError, StateSpace};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// δ: every number times 1 − δ and 1 + δ.
const SHARE: f64 = 0.05;

/// The loop with each number changed by itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Robustness {
    /// The share by which each number is changed, down and up.
    pub share: f64,
    /// Every number of the vehicle, of its chassis too, that is not 0.
    pub vehicle: Vec<Perturbed>,
    /// Gains, poles and residues of the controller, and the entries of its matrices where these are few.
    pub controller: Vec<Perturbed>,
    /// Entries of the controller's matrices that are too many to be changed one by one.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub entries_left_out: usize,
    /// Poles of the controller so near to each other that none has a residue of its own.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub repeated_poles: usize,
    /// Numbers of the vehicle that make none when they are changed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub left_out: Vec<String>,
    /// With an actuator.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub actuator: Option<ActuatorLoop>,
}

fn is_zero(n: &usize) -> bool {
    *n == 0
}

/// One number, changed down and up.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Perturbed {
    /// What kind of number.
    pub kind: PerturbedKind,
    /// Which: a field of the vehicle, a signal, a pole, an entry.
    pub what: String,
    /// The worse one of both changes: of loops that are not stable the one that grows faster, else the larger goal, else the larger norm.
    pub by: f64,
    /// Whether the loop is stable for both.
    pub stable: bool,
    /// Of a loop that is not stable: how fast it grows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub grows_1_per_s: Option<f64>,
    /// The goal's value over the nominal one, the larger of both; none where a loop is not stable or nothing is minimised.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub goal: Option<f64>,
    /// Norms over the nominal ones, each the larger of both: `h2_NAME`, `hinf_NAME`; none where a loop is not stable.
    #[serde(default, skip_serializing_if = "Named::is_empty")]
    pub norms: Named<f64>,
}

/// What is changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PerturbedKind {
    /// A number of the vehicle's file.
    Vehicle,
    /// The whole controller.
    Gain,
    /// The gain from one measurement.
    Sensor,
    /// The gain to one actuator.
    Actuator,
    /// A pole of the controller, with its conjugate.
    Pole,
    /// What a pole contributes to the controller.
    Residue,
    /// An entry of a matrix as it is written.
    Entry,
}

/// The loop with every number changed, and with an actuator; of a loop as designed that has no norms how fast it grows, 1/s.
///
/// # Errors
/// An iteration that does not converge.
pub(super) fn robustness(
    problem: &Problem,
    k: &StateSpace<Continuous>,
) -> Result<Result<Robustness, f64>, StudyError> {
    let fail = |e| failed(problem, e);
    let own = problem.at(&[])?;
    let nominal = match GoalNorms::of(&own, k).map_err(fail)? {
        Ok(nominal) => nominal,
        Err(grows) => return Ok(Err(grows)),
    };
    let mut vehicle = Vec::new();
    let mut left_out = Vec::new();
    let parameters = parameters(problem);
    let found: Vec<_> = parameters
        .par_iter()
        .map(|p| -> Result<Option<Perturbed>, StudyError> {
            let mut loops = Vec::new();
            for share in [-SHARE, SHARE] {
                let Ok(other) = p.times(problem, 1.0 + share) else { return Ok(None) };
                loops.push(GoalNorms::of(&other, k).map_err(fail)?);
            }
            Ok(Some(perturbed(PerturbedKind::Vehicle, p.name.clone(), &loops, &nominal)))
        })
        .collect();
    for (p, found) in parameters.iter().zip(found) {
        match found? {
            Some(one) => vehicle.push(one),
            None => left_out.push(p.name.clone()),
        }
    }
    let inputs: Vec<String> = problem.measurements.iter().map(|o| o.name.clone()).collect();
    let outputs: Vec<String> = problem.vehicle.actuators().iter().map(|a| a.name.clone()).collect();
    let ControllerChanges { changes, entries_left_out, repeated_poles } =
        controller_changes(k, (&inputs, &outputs), SHARE).map_err(fail)?;
    let controller = changes
        .par_iter()
        .map(|change| {
            let loops = change.changed.iter().map(|k| GoalNorms::of(&own, k));
            let loops = loops.collect::<Result<Vec<_>, _>>().map_err(fail)?;
            Ok(perturbed(change.kind, change.what.clone(), &loops, &nominal))
        })
        .collect::<Result<Vec<_>, StudyError>>()?;
    let actuator = Some(with_actuator(&own, k, &nominal)?);
    Ok(Ok(Robustness {
        share: SHARE,
        vehicle,
        controller,
        entries_left_out,
        repeated_poles,
        left_out,
        actuator,
    }))
}

fn failed(problem: &Problem, e: LtiError) -> StudyError {
    StudyError::Design { name: problem.spec.vehicle.clone(), source: Box::new(e.into()) }
}

/// A number of the vehicle, or several that change together.
struct Parameter {
    name: String,
    fields: Vec<(String, f64)>,
    of_chassis: bool,
}

fn parameters(problem: &Problem) -> Vec<Parameter> {
    let own = problem.file.parameters().into_iter();
    let own = own.map(|(name, fields)| Parameter { name, fields, of_chassis: false });
    // a road that moves the chassis points leaves the chassis out
    let chassis = problem.chassis.iter().filter(|_| !problem.ground.at_points).flat_map(|c| c.parameters());
    let chassis =
        chassis.map(|(name, fields)| Parameter { name: format!("chassis.{name}"), fields, of_chassis: true });
    own.chain(chassis).collect()
}

impl Parameter {
    /// The problem of the vehicle with this number times a factor.
    fn times(&self, problem: &Problem, factor: f64) -> Result<Problem, StudyError> {
        let fields: Vec<(String, f64)> = self.fields.iter().map(|(n, v)| (n.clone(), v * factor)).collect();
        let Some(chassis) = problem.chassis.as_ref().filter(|_| self.of_chassis) else {
            return problem.at(&fields);
        };
        let name = problem.spec.vehicle.clone();
        let chassis =
            chassis.with_overrides(&fields).map_err(|source| StudyError::Vehicle { name, source })?;
        Problem { chassis: Some(chassis), ..problem.clone() }.at(&[])
    }
}

/// Both changes of one number: the worse of each norm.
fn perturbed(
    kind: PerturbedKind,
    what: String,
    loops: &[Result<GoalNorms, f64>],
    nominal: &GoalNorms,
) -> Perturbed {
    let shares = [-SHARE, SHARE];
    let growing = loops.iter().zip(shares).filter_map(|(l, by)| Some((l.as_ref().err()?, by)));
    if let Some((grows, by)) = growing.max_by(|a, b| a.0.total_cmp(b.0)) {
        let grows_1_per_s = Some(*grows).filter(|g| g.is_finite());
        return Perturbed {
            kind,
            what,
            by,
            stable: false,
            grows_1_per_s,
            goal: None,
            norms: Named::default(),
        };
    }
    let ratios: Vec<(Option<f64>, Named<f64>)> = loops.iter().flatten().map(|l| l.over(nominal)).collect();
    let badness = |r: &(Option<f64>, Named<f64>)| {
        r.0.unwrap_or_else(|| r.1.iter().map(|(_, v)| *v).fold(0.0, f64::max))
    };
    let worse = match ratios.as_slice() {
        [down, up] if badness(up) > badness(down) => 1,
        _ => 0,
    };
    let mut norms: Named<f64> = Named::default();
    for (name, v) in ratios.iter().flat_map(|r| r.1.iter()) {
        let most = norms.get(name).map_or(*v, |known| known.max(*v));
        norms.insert(name, most);
    }
    let goal = ratios.get(worse).and_then(|r| r.0);
    Perturbed { kind, what, by: shares[worse], stable: true, grows_1_per_s: None, goal, norms }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::design_problem::Norm;
    use crate::study::{DesignOutcome, DesignSpec, Goal, design};

    /// Two Lyapunov equations of eight states.
    const SAME: f64 = 1e-9;

    fn quarter() -> DesignSpec {
        let minimize = ["sprung_acceleration", "suspension_travel", "tire_deflection"];
        DesignSpec {
            vehicle: "case:turkay-quarter-car".into(),
            road: "case:turkay-white-velocity".into(),
            speed_m_s: 20.0,
            measurements: vec!["suspension_travel".into()],
            r#override: [("tire_damping_n_s_per_m".to_owned(), 98.0)].into_iter().collect(),
            goal: Goal {
                minimize: minimize.iter().map(|n| ((*n).to_owned(), 1.0)).collect(),
                ..Goal::default()
            },
            ..DesignSpec::default()
        }
    }

    fn finite(o: &DesignOutcome, name: &str) -> f64 {
        o.verified.as_ref().unwrap().h2.get(name).and_then(|r| r.finite()).unwrap()
    }

    #[test]
    fn a_changed_number_is_the_design_of_another_vehicle() {
        let spec = quarter();
        let outcome = design(&spec).unwrap().0;
        let r = outcome.robustness.as_ref().unwrap();
        let k = outcome.controller.as_ref().unwrap().state_space().unwrap();
        // every number that is not 0, the overridden one too
        assert_eq!(r.vehicle.len(), 6);
        for one in &r.vehicle {
            let at = *outcome.vehicle.as_ref().unwrap().parameters.get(&one.what).unwrap();
            let mut worst = [f64::NEG_INFINITY; 2];
            for share in [0.95, 1.05] {
                // another file, other passive norms, the same controller
                let mut other = spec.clone();
                other.r#override.insert(&one.what, at * share);
                let problem = Problem::new(&other, Norm::H2).unwrap();
                let measured = problem.measure(Some(&k)).unwrap();
                if !measured.stable {
                    assert!(!one.stable, "{}", one.what);
                    continue;
                }
                let h2 = |name: &str| measured.h2.get(name).and_then(|r| r.finite()).unwrap();
                worst[0] = worst[0].max(h2("tire_deflection") / finite(&outcome, "tire_deflection"));
                let passive = |name: &str| outcome.passive.h2.get(name).and_then(|r| r.finite()).unwrap();
                let goal: f64 = spec.goal.minimize.iter().map(|(n, _)| (h2(n) / passive(n)).powi(2)).sum();
                worst[1] = worst[1].max(goal / outcome.objective.get("verified").unwrap());
            }
            if one.stable {
                let found = [*one.norms.get("h2_tire_deflection").unwrap(), one.goal.unwrap()];
                for (a, b) in found.into_iter().zip(worst) {
                    assert!((a / b - 1.0).abs() < SAME, "{}: {a} {b}", one.what);
                }
            }
        }
        // a sweep's points have none of it
        let bare = crate::study::design::design_from(&spec, None, None).unwrap().0;
        assert!(bare.robustness.is_none() && bare.responses.is_none() && bare.vehicle.is_none());
        assert_eq!(bare.verified, outcome.verified);
    }

    #[test]
    fn a_loop_with_a_pole_on_the_axis_but_for_rounding_is_told_and_not_given_up() {
        // travels alone under white velocity: the estimator keeps a mode next to 0, which 5 % of some number brings onto the axis
        let minimize = ["body_acceleration", "suspension_travel", "tire_deflection"];
        let spec = DesignSpec {
            vehicle: "case:turkay-half-car".into(),
            road: "case:turkay-white-velocity".into(),
            speed_m_s: 20.0,
            measurements: vec!["suspension_travel".into()],
            goal: Goal {
                minimize: minimize.map(|n| (n.to_owned(), 1.0)).into_iter().collect(),
                ..Goal::default()
            },
            ..DesignSpec::default()
        };
        let outcome = design(&spec).unwrap().0;
        let found = outcome.robustness.as_ref().unwrap();
        assert!(!found.vehicle.is_empty() && !found.controller.is_empty());
        // what grows does not grow by rounding: levers that are no round numbers bring no pole of their own
        let all = || found.vehicle.iter().chain(&found.controller);
        assert!(all().filter_map(|p| p.grows_1_per_s).all(|g| g > 1e-6));
        for name in ["front_axle_m", "rear_axle_m"] {
            let lever = all().find(|p| p.what == name).unwrap();
            assert!(lever.stable && !lever.norms.is_empty(), "{lever:?}");
        }
        // what is so stays so: a twentieth less of this spring and the loop grows
        let spring = all().find(|p| p.what == "front.suspension_stiffness_n_per_m").unwrap();
        assert!(!spring.stable && spring.grows_1_per_s.is_some_and(|g| g > 0.1), "{spring:?}");
    }

    #[test]
    fn a_law_that_nearly_pushes_the_car_over_is_fragile() {
        // travel alone, fed back with 0.97 of what makes the suspension's spring negative enough
        let problem = Problem::new(&quarter(), Norm::H2).unwrap();
        let file = problem.file.quarter_car.as_ref().unwrap();
        // static: k_s k_t/(k_s + k_t) > 0 holds the body as long as k_s − K > 0
        let gain = |share: f64| {
            let value = -share * file.suspension_stiffness_n_per_m;
            StateSpace::continuous_gain(crate::linalg::Mat::from_fn(1, 1, |_, _| value)).unwrap()
        };
        let sign = if GoalNorms::of(&problem, &gain(1.5)).unwrap().is_err() { 1.0 } else { -1.0 };
        let near = robustness(&problem, &gain(0.97 * sign)).unwrap().unwrap();
        let whole = near.controller.iter().find(|p| p.kind == PerturbedKind::Gain).unwrap();
        assert!(!whole.stable && whole.by > 0.0 && whole.goal.is_none(), "{whole:?}");
        let spring = near.vehicle.iter().find(|p| p.what == "suspension_stiffness_n_per_m").unwrap();
        assert!(!spring.stable && spring.by < 0.0, "{spring:?}");
        let far = robustness(&problem, &gain(0.5 * sign)).unwrap().unwrap();
        assert!(far.controller.iter().chain(&far.vehicle).all(|p| p.stable));
        let mut outcome = design(&quarter()).unwrap().0;
        outcome.warnings.clear();
        super::super::design_fragile::fragile(&near, &mut outcome);
        let text = &outcome.warnings.iter().find(|w| w.name == "fragile").unwrap().text;
        assert!(
            text.contains("suspension_stiffness_n_per_m (-5 %, grows at ") && text.contains("loop unstable"),
            "{text}"
        );
    }
}
