//! `method = "fixed-order"`: from a design's words to goals and bounds of one or several vehicles, and what the search says.

use super::design_fixed_active::clusters;
use super::design_fixed_member::Member;
use super::design_fixed_outcome::{FixedOrderOutcome, FixedOrderTarget, Stationarity, TargetAim, TargetNorm};
use super::design_fixed_search::{is_bound, searched};
use super::design_fixed_starts::{given, in_order, invariant_frequencies, regulators};
use super::design_fixed_structure::structure;
use super::design_fixed_words::{not_met, not_stabilised, refused};
use super::design_gains::{fast_controller, fastest, high_dynamic_gain, largest_gain};
use super::design_methods::Found;
use super::design_outcome::{ControllerFile, DesignOutcome, DesignStatus};
use super::design_problem::{GoalBlock, Problem};
use super::design_robust::named_fields;
use super::design_words::short;
use super::{Flag, Input, Named, StudyError};
use crate::lti::{Continuous, GeneralizedPlant, LtiError, StateSpace};
use crate::synthesis::{
    Aim, Channel, FixedOrder, FixedOrderDesign, FixedOrderEnd, Measure, PointwiseBound, Structure,
    SynthesisError, Target, TargetValue, pointwise_bound,
};
use crate::units::hz;

/// The loop's poles are left of minus this share of the vehicle's fastest pole where no region is asked for.
const CLEAR: f64 = 1e-6;

/// No gap is told to a lower bound below this: goals of a share of the passive norm are larger.
const NEXT_TO_0: f64 = 1e-6;

/// A steeper descent around the result than this, of ln goal, is worth a warning.
const STEEP: f64 = 1.0;

/// What a target is in the design's words.
pub(super) struct About {
    pub name: String,
    pub norm: TargetNorm,
    pub aim: TargetAim,
    /// The value is so many times what is minimised, or this is the bound.
    pub unit: f64,
}

impl About {
    /// Whether it is all of `minimize_h2` together, which has no name of its own.
    pub fn is_sum(&self) -> bool {
        self.norm == TargetNorm::H2 && self.aim == TargetAim::Goal
    }
}

/// All that a fixed-order design is made of.
pub(super) struct Fleet {
    pub members: Vec<Member>,
    structure: Structure,
    /// Of a neighbour in a sweep, and of a file.
    starts: Vec<StateSpace<Continuous>>,
    /// The file of `start`.
    pub input: Option<Input>,
    pub targets: Vec<Target>,
    pub about: Vec<About>,
}

impl Fleet {
    /// # Errors
    /// Fields that the vehicle does not have, a structure that does not fit the plant, a start with other signals.
    pub fn new(problem: &Problem, neighbour: Option<&ControllerFile>) -> Result<Self, StudyError> {
        let spec = &problem.spec;
        let structure = structure(problem)?;
        let bases: Vec<Vec<(String, f64)>> = if spec.plant.is_empty() {
            vec![Vec::new()]
        } else {
            spec.plant.iter().map(named_fields).collect()
        };
        let members = bases
            .into_iter()
            .enumerate()
            .map(|(k, fields)| Member::new(problem, fields, k + 1))
            .collect::<Result<Vec<_>, _>>()?;
        let (start, input) = given(problem)?.unzip();
        let near = neighbour.map(|k| in_order(problem, k, "the neighbour")).transpose()?;
        let starts = near.into_iter().chain(start).collect();
        let (targets, about) = members.iter().enumerate().flat_map(|(k, m)| targets(&m.problem, k)).unzip();
        Ok(Fleet { members, structure, starts, input, targets, about })
    }

    pub fn is_many(&self) -> bool {
        self.members.len() > 1 || self.members.iter().any(|m| !m.at.is_empty())
    }
}

/// Goals and bounds of one vehicle, whose performances are its `reported` outputs.
fn targets(problem: &Problem, plant: usize) -> Vec<(Target, About)> {
    let channel = |outputs: Vec<(usize, f64)>| Channel { outputs, disturbances: Vec::new() };
    let whole = |g: &GoalBlock| channel(g.members.iter().map(|i| (*i, 1.0)).collect());
    let mut all = Vec::new();
    let mut add = |name: &str, measure: Measure, aim: TargetAim, unit: f64| {
        let norm = if matches!(measure, Measure::H2(_)) { TargetNorm::H2 } else { TargetNorm::Hinf };
        let number = if aim == TargetAim::Goal { Aim::Goal(unit) } else { Aim::Bound(unit) };
        let target = Target { plant, measure, aim: number, name: name.to_owned() };
        all.push((target, About { name: name.to_owned(), norm, aim, unit }));
    };
    if !problem.goals.is_empty() {
        let of = |g: &GoalBlock| g.members.iter().map(|i| (*i, g.weight / g.passive)).collect::<Vec<_>>();
        let mut rows: Vec<(usize, f64)> = problem.goals.iter().flat_map(of).collect();
        let rho = problem.spec.input_weight;
        if rho > 0.0 {
            let force = |i: &usize| problem.reported[*i].base == "actuator_force";
            rows.extend((0..problem.reported.len()).filter(force).map(|i| (i, rho.sqrt())));
        }
        add("goal", Measure::H2(channel(rows)), TargetAim::Goal, 1.0);
    }
    for p in &problem.peaks {
        let (b, of) = (&p.block, Measure::Hinf(whole(&p.block)));
        if b.weight > 0.0 {
            add(&b.name, of.clone(), TargetAim::Goal, b.passive / b.weight);
        }
        if let Some(times) = p.bound {
            add(&b.name, of, TargetAim::Bound, times * b.passive);
        }
    }
    for g in &problem.bounded {
        add(&g.name, Measure::H2(whole(g)), TargetAim::Bound, g.weight * g.passive);
    }
    all
}

pub(super) fn by_fixed_order(problem: &Problem, fleet: &Fleet, outcome: &mut DesignOutcome) -> Found {
    let spec = &problem.spec;
    let plants: Vec<GeneralizedPlant> = fleet.members.iter().map(|m| m.plant.clone()).collect();
    let mut frequencies_rad_s: Vec<f64> = Vec::new();
    for omega in fleet.members.iter().flat_map(|m| invariant_frequencies(&m.problem)) {
        if !frequencies_rad_s.contains(&omega) {
            frequencies_rad_s.push(omega);
        }
    }
    let starts: Vec<_> = fleet.starts.iter().cloned().chain(regulators(&plants, &fleet.targets)).collect();
    let section = spec.fixed_order.unwrap_or_default();
    let asked = FixedOrder {
        plants,
        targets: fleet.targets.clone(),
        structure: fleet.structure.clone(),
        max_pole_rad_s: Some(spec.max_pole_rad_s()),
        max_gain: spec.goal.max_gain,
        margin_rad_s: spec.poles.and_then(|p| p.max_real_rad_s).map_or_else(|| fleet.clear(), |v| -v),
        starts,
        frequencies_rad_s,
    };
    let ended = match searched(&asked, &section.into()) {
        Err(SynthesisError::Lti(LtiError::NotStable { pole, .. })) => {
            outcome.status = DesignStatus::Refused;
            let found = format!("its loop has a pole with real part {} 1/s", short(pole.re));
            outcome.why = Some(refused(&Named::default(), &found));
            return Ok(None);
        }
        ended => ended?,
    };
    let (design, met) = match ended {
        FixedOrderEnd::NotStabilised { abscissa, .. } => {
            outcome.status = DesignStatus::Stalled;
            let tried = FixedOrderOutcome {
                abscissa_rad_s: Some(abscissa).filter(|a| a.is_finite()),
                starts: asked.starts.len() + 1 + section.tries,
                ..FixedOrderOutcome::default()
            };
            outcome.why = Some(not_stabilised(problem, fleet.structure.order(), &tried));
            outcome.fixed_order = Some(tried);
            return Ok(None);
        }
        FixedOrderEnd::Designed(d) => (d, true),
        FixedOrderEnd::BoundsNotMet(d) => (d, false),
    };
    let mut evidence = fleet.evidence(&design);
    let proven = pointwise_bound(&asked.plants, &asked.targets, &asked.frequencies_rad_s)?;
    evidence.compare(&proven, design.goal.filter(|_| met));
    outcome.fixed_order = Some(evidence);
    let found = [fastest(&design.controller)?, largest_gain(&design.controller).unwrap_or(f64::INFINITY)];
    if !met {
        outcome.status = DesignStatus::Infeasible;
        outcome.why = Some(not_met(problem, fleet.structure.order(), outcome, found));
        return Ok(None);
    }
    fleet.claim(&design, found, outcome);
    outcome.warnings.extend(fast_controller(problem, &outcome.passive, found));
    outcome.warnings.extend(high_dynamic_gain(problem, &design.controller));
    outcome.warnings.extend(not_optimal(outcome.fixed_order.as_ref()));
    Ok(Some(design.controller))
}

/// A warning where the gradients around the result tell of a better one.
fn not_optimal(f: Option<&FixedOrderOutcome>) -> Option<Flag> {
    let found = f?.stationarity.filter(|s| s.distance > STEEP)?;
    let text = format!(
        "the search did not end at a local optimum (the gradients of ln goal around it leave a descent of {}, where 0 is an optimum): \
         another seed (fixed-order.seed), more starts (fixed-order.tries) or more steps (fixed-order.iterations) may find better",
        short(found.distance)
    );
    Some(Flag { name: "not-optimal".into(), text })
}

impl Fleet {
    /// Poles nearer to the axis than this are on it but for rounding.
    fn clear(&self) -> f64 {
        let fastest = |m: &Member| {
            let poles = m.plant.system().poles().unwrap_or_default();
            poles.iter().map(|p| p.norm()).fold(0.0, f64::max)
        };
        CLEAR * self.members.iter().map(fastest).fold(0.0, f64::max)
    }

    /// |λ| of the vehicles' slowest pole.
    fn slowest(&self) -> f64 {
        let poles = self.members.iter().flat_map(|m| m.plant.system().poles().unwrap_or_default());
        poles.map(|p| p.norm()).filter(|size| *size > 0.0).fold(f64::INFINITY, f64::min)
    }

    fn evidence(&self, d: &FixedOrderDesign) -> FixedOrderOutcome {
        // where bounds are not met, only these may have been looked at
        let known = |t: &Target| d.values.len() == self.targets.len() || is_bound(t);
        let own = self.targets.iter().zip(&self.about).filter(|(t, _)| known(t));
        let slowest = self.slowest();
        let of = |((t, a), v): ((&Target, &About), &TargetValue)| FixedOrderTarget {
            name: a.name.clone(),
            vehicle: self.is_many().then_some(t.plant + 1),
            norm: a.norm,
            aim: a.aim,
            value: v.value,
            recomputed: None,
            relative: v.value / a.unit,
            at_hz: v.omega_rad_s.filter(|w| w.is_finite()).map(hz),
            // never −0
            multiplier: v.multiplier + 0.0,
            active_hz: clusters(&v.active_rad_s, v.omega_rad_s, slowest).into_iter().map(hz).collect(),
        };
        let counts = [
            ("loops", d.work.loops),
            ("factorisations", d.work.factorisations),
            ("eigenproblems", d.work.eigenproblems),
            ("lyapunov", d.work.lyapunov),
        ];
        FixedOrderOutcome {
            targets: own.zip(&d.values).map(of).collect(),
            violation: Some(d.violation),
            stationarity: d.stationarity.as_ref().map(|s| Stationarity {
                distance: s.distance,
                radius: s.radius,
                points: s.points,
            }),
            converged: d.converged,
            starts: d.work.starts,
            stabilised: d.work.stabilised,
            work: counts.into_iter().map(|(n, v)| (n.to_owned(), v)).collect(),
            ..FixedOrderOutcome::default()
        }
    }

    fn claim(&self, d: &FixedOrderDesign, [pole, gain]: [f64; 2], outcome: &mut DesignOutcome) {
        if let Some(goal) = d.goal {
            outcome.claimed.insert("objective", goal);
        }
        if !self.is_many() {
            for (a, v) in self.about.iter().zip(&d.values).filter(|(a, _)| !a.is_sum()) {
                outcome.claimed.insert(claimed_name(a), v.value);
            }
        }
        if d.controller.order() > 0 {
            outcome.claimed.insert("fastest_controller_pole", pole);
        }
        if gain.is_finite() {
            outcome.claimed.insert("controller_gain", gain);
        }
    }
}

impl FixedOrderOutcome {
    /// Beside what no controller of any order goes below.
    fn compare(&mut self, proven: &PointwiseBound, goal: Option<f64>) {
        self.lower_bound = proven.goal.map(|l| l.level);
        self.impossible = proven.impossible.map(|l| l.level);
        self.lower_bound_hz = proven.goal.or(proven.impossible).map(|l| hz(l.omega_rad_s));
        let bound = self.lower_bound.filter(|b| *b > NEXT_TO_0);
        self.gap = goal.zip(bound).map(|(goal, bound)| goal / bound - 1.0);
    }
}

/// Its name among the claims.
pub(super) fn claimed_name(a: &About) -> String {
    let norm = if a.norm == TargetNorm::H2 { "h2" } else { "hinf" };
    format!("{norm}_{}", a.name)
}
