//! What a fixed-order design gives.

use super::asked::FixedOrder;
use super::problem::{Id, Of, Problem};
use super::search::MET;
use super::targets::{Aim, Measure};
use super::verify::{self, Values};
use crate::lti::{Continuous, StateSpace};
use crate::optimize::{BundleEnd, BundleResult, Sampled, sampled_subdifferential};
use crate::synthesis::SynthesisError;
use std::sync::atomic::Ordering::Relaxed;

/// The ball around the result in which gradients are sampled, as a share of 1 + ‖x‖.
const RADIUS: f64 = 1e-4;
/// A peak counts as active whose weight is at least this share of all weights.
const ACTIVE: f64 = 1e-3;

/// A bound is not at its limit that is below it by more than this share.
const ROOM: f64 = 5e-3;

/// How it ended.
#[derive(Debug, Clone)]
pub enum FixedOrderEnd {
    /// All bounds are met.
    Designed(Box<FixedOrderDesign>),
    /// No start led to a stable loop: the least abscissa, rad/s.
    NotStabilised {
        /// The largest real part of a pole at its least.
        abscissa: f64,
        /// What was done.
        work: FixedOrderWork,
    },
    /// The loop is stable, and a bound is exceeded: the least violation found, and the controller of it.
    BoundsNotMet(Box<FixedOrderDesign>),
}

impl FixedOrderEnd {
    pub(super) fn of(design: FixedOrderDesign) -> Self {
        if design.violation <= MET {
            FixedOrderEnd::Designed(Box::new(design))
        } else {
            FixedOrderEnd::BoundsNotMet(Box::new(design))
        }
    }

    pub(super) fn design(&self) -> Option<&FixedOrderDesign> {
        match self {
            FixedOrderEnd::Designed(d) | FixedOrderEnd::BoundsNotMet(d) => Some(d),
            FixedOrderEnd::NotStabilised { .. } => None,
        }
    }
}

impl FixedOrderDesign {
    /// Bounds first, then the goal, by more than rounding.
    pub(super) fn is_better(&self, other: &Self) -> bool {
        match (self.violation <= MET, other.violation <= MET) {
            (true, true) => match (self.verified_goal, other.verified_goal) {
                (Some(a), Some(b)) => a < b * (1.0 - 1e-9),
                _ => false,
            },
            (true, false) => true,
            (false, true) => false,
            (false, false) => self.violation < other.violation,
        }
    }
}

/// A controller, and what its loops are.
#[derive(Debug, Clone)]
pub struct FixedOrderDesign {
    /// u = +K y.
    pub controller: StateSpace<Continuous>,
    /// The largest value/unit over the goals, as the search has it; none without goals.
    pub goal: Option<f64>,
    /// The same by the independent norms.
    pub verified_goal: Option<f64>,
    /// Each target in the loop, by the independent norms.
    pub values: Vec<TargetValue>,
    /// The largest excess of a bound, as a share of it (of an abscissa in units of the plants' pace); up to 1e-6 counts as met.
    pub violation: f64,
    /// The distance of 0 from the gradients of ln goal + penalty around the result, in units of the search's numbers, which
    /// are of the order of 1: what a step of length 1 would gain by, as a share, at this slope.
    pub stationarity: Option<Sampled>,
    /// Whether the last search ended as no model promised more, and looked at every frequency where a norm is attained.
    pub converged: bool,
    /// What was done.
    pub work: FixedOrderWork,
}

/// A target in the loop.
#[derive(Debug, Clone, PartialEq)]
pub struct TargetValue {
    /// Its name.
    pub name: String,
    /// A norm, or rad/s.
    pub value: f64,
    /// Where a norm is attained, rad/s.
    pub omega_rad_s: Option<f64>,
    /// Its weight in the optimality conditions: 0 where it does not matter.
    pub multiplier: f64,
    /// Frequencies of its peaks that hold the optimum, rad/s.
    pub active_rad_s: Vec<f64>,
}

/// Counted work.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct FixedOrderWork {
    /// Starts.
    pub starts: usize,
    /// Starts that led to a stable loop.
    pub stabilised: usize,
    /// Loops that were closed: each is an evaluation of all norms of one plant.
    pub loops: usize,
    /// Factorisations of iωI − A.
    pub factorisations: usize,
    /// Eigenvalue problems.
    pub eigenproblems: usize,
    /// Lyapunov equations.
    pub lyapunov: usize,
}

/// A result in words of its targets.
pub(super) fn describe(
    asked: &FixedOrder,
    problem: &Problem,
    best: &BundleResult<Id>,
    controller: StateSpace<Continuous>,
    values: &Values,
    seed: u64,
) -> Result<FixedOrderDesign, SynthesisError> {
    let mut goal: Option<f64> = None;
    let mut violation: f64 = 0.0;
    let mut listed = Vec::new();
    let all: f64 = best.active.iter().map(|(_, w)| w).sum();
    for (k, (t, (value, omega))) in asked.targets.iter().zip(values).enumerate() {
        match t.aim {
            Aim::Goal(unit) => {
                let share = if t.measure == Measure::Abscissa { (value / unit).exp() } else { value / unit };
                goal = Some(goal.map_or(share, |g: f64| g.max(share)));
            }
            Aim::Bound(limit) => {
                let excess = match t.measure {
                    Measure::Abscissa => (value - limit) / problem.scales.pace,
                    _ => value / limit - 1.0,
                };
                violation = violation.max(excess);
            }
        }
        // a bound with room holds nothing, whatever the last step's model weighed it by
        let has_room = matches!((t.aim, &t.measure), (Aim::Bound(limit), Measure::Hinf(_) | Measure::H2(_)) if *value < (1.0 - ROOM) * limit);
        let of_target = || best.active.iter().filter(|(p, _)| p.id.target == k && !has_room);
        let mut active_rad_s: Vec<f64> = of_target()
            .filter(|(_, w)| *w >= ACTIVE * all)
            .filter_map(|(p, _)| match &p.id.of {
                Of::Peak(peak) => Some(peak.omega),
                _ => None,
            })
            .collect();
        active_rad_s.sort_by(f64::total_cmp);
        active_rad_s.dedup_by(|a, b| (*a - *b).abs() <= 1e-3 * *b);
        listed.push(TargetValue {
            name: t.name.clone(),
            value: *value,
            omega_rad_s: *omega,
            multiplier: of_target().map(|(_, w)| w).sum::<f64>().max(0.0),
            active_rad_s,
        });
    }
    let violation = violation.max(verify::beyond_limits(asked, &controller, problem.scales.pace)?);
    let scale = 1.0 + best.x.iter().map(|v| v * v).sum::<f64>().sqrt();
    let stationarity = sampled_subdifferential(
        problem,
        &best.x,
        best.penalty,
        RADIUS * scale,
        2 * best.x.len().min(40),
        seed,
    );
    Ok(FixedOrderDesign {
        controller,
        goal: best.goal.is_finite().then(|| best.goal.exp()),
        verified_goal: goal,
        values: listed,
        violation,
        stationarity,
        converged: best.end == BundleEnd::Converged,
        work: FixedOrderWork::default(),
    })
}

impl FixedOrderWork {
    pub(super) fn add(&mut self, o: Self) {
        self.starts += o.starts;
        self.stabilised += o.stabilised;
        self.loops += o.loops;
        self.factorisations += o.factorisations;
        self.eigenproblems += o.eigenproblems;
        self.lyapunov += o.lyapunov;
    }

    pub(super) fn count(&mut self, problem: &Problem) {
        let c = &problem.counters;
        self.loops += c.loops.load(Relaxed);
        self.factorisations += c.factorisations.load(Relaxed);
        self.eigenproblems += c.eigenproblems.load(Relaxed);
        self.lyapunov += c.lyapunov.load(Relaxed);
    }
}
