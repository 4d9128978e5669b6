//! A controller of given order: many starts, a local search from each, the best one verified.

use super::problem::{Id, Of, Problem};
use super::search::{Led, MET, as_it_is, better, from, further};
use super::structure::{Entry, Structure, controller_of};
use super::targets::{Aim, Measure, Target};
use super::{full_order, starts, verify};
use crate::lti::{Continuous, GeneralizedPlant, LtiError, StateSpace};
use crate::optimize::{BundleEnd, BundleResult, BundleSettings, Pieces, Sampled, sampled_subdifferential};
use crate::synthesis::SynthesisError;
use rayon::prelude::*;
use std::sync::atomic::Ordering::Relaxed;

/// Bounds are aimed at this much below themselves.
const BELOW: f64 = 1e-7;
/// The search's value of a norm may be below the verified one by this share, or its frequency is added and the search
/// goes on.
const SEEN: f64 = 1e-6;
/// Rounds of that.
const ROUNDS: usize = 6;
/// Results that are carried to the end.
const KEPT: usize = 3;
/// Steps of the first search from each start.
const SHORT: usize = 40;
/// Steps of a search from a shaken result.
const MEDIUM: usize = 80;
/// Rounds of shaking without a gain of [`GAIN`] (in ln) that end it.
const VAIN: usize = 6;
const GAIN: f64 = 2e-5;
/// The ball around the result in which gradients are sampled.
const RADIUS: f64 = 1e-4;

/// Plants, what is asked of their loops, and the controllers that are allowed.
#[derive(Debug, Clone)]
pub struct FixedOrder {
    /// One or more, with the same measurements and controls.
    pub plants: Vec<GeneralizedPlant>,
    /// Goals and bounds.
    pub targets: Vec<Target>,
    /// The controller's order and free entries.
    pub structure: Structure,
    /// |λ| of every controller pole is at most this, rad/s.
    pub max_pole_rad_s: Option<f64>,
    /// sup σ(K(iω)) is at most this.
    pub max_gain: Option<f64>,
    /// −Re of every pole of every loop is at least this, rad/s.
    pub margin_rad_s: f64,
    /// Controllers to begin with, of any order.
    pub starts: Vec<StateSpace<Continuous>>,
    /// Frequencies that are always looked at, rad/s.
    pub frequencies_rad_s: Vec<f64>,
}

/// How long to look.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FixedOrderSettings {
    /// Random starts.
    pub tries: usize,
    /// Of their numbers.
    pub seed: u64,
    /// Steps of a search at most.
    pub iterations: usize,
    /// A relative gain below this is none.
    pub tolerance: f64,
    /// Whether lower orders are designed first and begun from: then more states are never worse.
    pub lower_orders: bool,
}

impl Default for FixedOrderSettings {
    fn default() -> Self {
        FixedOrderSettings { tries: 8, seed: 1, iterations: 400, tolerance: 1e-7, lower_orders: true }
    }
}

/// How it ended.
#[derive(Debug, Clone)]
pub enum FixedOrderEnd {
    /// All bounds are met.
    Designed(Box<FixedOrderDesign>),
    /// No start led to a stable loop: the least abscissa, rad/s.
    NotStabilised {
        /// The largest real part of a pole at its least.
        abscissa: f64,
    },
    /// The loop is stable, and a bound is exceeded: the least violation found, and the controller of it.
    BoundsNotMet(Box<FixedOrderDesign>),
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
    /// The largest excess of a bound, as a share of it (of an abscissa in units of the plants' pace): 0 where all are met.
    pub violation: f64,
    /// The distance of 0 from the gradients of ln goal + penalty around the result, in units of the search's numbers, which
    /// are of the order of 1: what a step of length 1 would gain by, as a share, at this slope.
    pub stationarity: Option<Sampled>,
    /// Whether the last search ended as no model promised more.
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

/// The controller of the structure given for which the largest of all goals is as small as a local search from many starts
/// finds it, under the bounds.
///
/// Every start is brought into the stable set (BFGS on the largest real part), then ln of the goal under ln of the bounds
/// is minimised by [`minimize`](crate::optimize::minimize): the pieces are Re uᴴT(iω)v at every peak of every channel, H2
/// norms and eigenvalues, with exact gradients. The three best are searched to the end, the best is verified by norms that
/// share nothing with the search, and where these stand higher, their frequencies are added and the search goes on.
///
/// # Errors
/// Plants whose signals don't fit the structure or each other, targets that name no signal, numbers that are none.
///
/// Source: Burke, Henrion, Lewis, Overton, *HIFOO*, IFAC ROCOND 2006; Apkarian and Noll, IEEE Trans. Automat. Control 51
/// (2006) 71–86.
pub fn fixed_order(
    asked: &FixedOrder,
    settings: &FixedOrderSettings,
) -> Result<FixedOrderEnd, SynthesisError> {
    check(asked)?;
    let mut given = asked.starts.clone();
    given.extend(full_order::controllers(&asked.plants, &asked.targets));
    let order = asked.structure.order();
    let mut work = FixedOrderWork::default();
    if settings.lower_orders && asked.structure.is_full() {
        for lower in 0..order {
            let s = &asked.structure;
            let structure = Structure::full(lower, s.controls(), s.measurements());
            let starts = given.clone();
            let less = FixedOrder { structure, starts, ..asked.clone() };
            let found = one_order(&less, settings)?;
            work.add(found.1);
            if let FixedOrderEnd::Designed(d) | FixedOrderEnd::BoundsNotMet(d) = found.0 {
                given.push(d.controller);
            }
        }
    }
    let last = FixedOrder { starts: given, ..asked.clone() };
    let (mut end, own) = one_order(&last, settings)?;
    work.add(own);
    if let FixedOrderEnd::Designed(d) | FixedOrderEnd::BoundsNotMet(d) = &mut end {
        d.work = work;
    }
    Ok(end)
}

fn check(asked: &FixedOrder) -> Result<(), LtiError> {
    let join =
        |what: &'static str, expected: String, found: String| Err(LtiError::Join { what, expected, found });
    let Some(first) = asked.plants.first() else {
        return join("a fixed-order design", "a plant".into(), "none".into());
    };
    for p in &asked.plants {
        let (expected, found) =
            ((p.nu(), p.ny()), (asked.structure.controls(), asked.structure.measurements()));
        if expected != found {
            return join(
                "a controller's structure",
                format!("{} controls and {} measurements, as the plant has", expected.0, expected.1),
                format!("{} and {}", found.0, found.1),
            );
        }
        if (p.nz(), p.nw()) != (first.nz(), first.nw()) {
            let of = |p: &GeneralizedPlant| format!("{} performances and {} disturbances", p.nz(), p.nw());
            return join("plants of one design", of(first), of(p));
        }
    }
    if asked.targets.is_empty() {
        return join("a fixed-order design", "a goal or a bound".into(), "none".into());
    }
    asked.targets.iter().try_for_each(|t| t.check(&asked.plants))?;
    for (field, value) in [("max_pole", asked.max_pole_rad_s), ("max_gain", asked.max_gain)] {
        if let Some(found) = value.filter(|v| !(*v > 0.0 && v.is_finite())) {
            return Err(LtiError::Field { field, expected: "a positive, finite number", found });
        }
    }
    if !(asked.margin_rad_s >= 0.0 && asked.margin_rad_s.is_finite()) {
        let (field, expected) = ("margin", "a finite number, not negative");
        return Err(LtiError::Field { field, expected, found: asked.margin_rad_s });
    }
    Ok(())
}

/// One order, from all its starts.
fn one_order(
    asked: &FixedOrder,
    settings: &FixedOrderSettings,
) -> Result<(FixedOrderEnd, FixedOrderWork), SynthesisError> {
    let structure = without_infinite(asked);
    let aimed: Vec<Target> = asked
        .targets
        .iter()
        .map(|t| match (t.aim, &t.measure) {
            (Aim::Bound(b), Measure::Hinf(_) | Measure::H2(_)) => {
                Target { aim: Aim::Bound(b * (1.0 - BELOW)), ..t.clone() }
            }
            _ => t.clone(),
        })
        .collect();
    let limits = (asked.max_pole_rad_s.map(|p| p * (1.0 - BELOW)), asked.max_gain.map(|g| g * (1.0 - BELOW)));
    let mut problem =
        Problem::new(&asked.plants, &aimed, structure, limits, asked.margin_rad_s, &asked.frequencies_rad_s);
    let mut begun: Vec<Vec<f64>> = Vec::new();
    for (k, given) in asked.starts.iter().enumerate() {
        begun.extend(starts::fitted(&problem, given, settings.seed.wrapping_add(k as u64)));
    }
    begun.push(starts::silent(&problem));
    begun.extend(starts::random(&problem, settings.tries, settings.seed));
    let short = BundleSettings {
        iterations: SHORT.min(settings.iterations),
        evaluations: 4 * SHORT,
        tolerance: 1e-4,
        ..BundleSettings::default()
    };
    let led: Vec<Led> = begun.par_iter().map(|x| from(&problem, x, &short)).collect();
    let mut work = FixedOrderWork { starts: begun.len(), ..FixedOrderWork::default() };
    let mut results: Vec<BundleResult<Id>> = Vec::new();
    let mut least = f64::INFINITY;
    for l in led {
        match l {
            Led::Unstable(a) => least = least.min(a),
            Led::To(r) => {
                work.stabilised += 1;
                results.push(*r);
            }
        }
    }
    if results.is_empty() {
        work.count(&problem);
        return Ok((FixedOrderEnd::NotStabilised { abscissa: least }, work));
    }
    sort(&mut results);
    results.truncate(KEPT.max(settings.tries / 6));
    let long = BundleSettings {
        iterations: settings.iterations,
        evaluations: 6 * settings.iterations,
        tolerance: settings.tolerance,
        ..BundleSettings::default()
    };
    results = results.into_par_iter().map(|r| further(&problem, &r, &long)).collect();
    sort(&mut results);
    let Some(first) = results.first().cloned() else {
        return Ok((FixedOrderEnd::NotStabilised { abscissa: least }, work));
    };
    let mut best = shaken(&problem, first, settings, &long);
    let mut found = verified(asked, &problem, &best)?;
    for _ in 0..ROUNDS {
        let missed: Vec<f64> = missed(asked, &problem, &best, &found.1);
        if missed.is_empty() {
            break;
        }
        problem.frequencies.extend(missed);
        // all that was found, as it is now that these are looked at
        results.push(best);
        results = results.iter().filter_map(|r| as_it_is(&problem, &r.x, r.penalty)).collect();
        sort(&mut results);
        let Some(first) = results.first() else {
            return Ok((FixedOrderEnd::NotStabilised { abscissa: least }, work));
        };
        best = further(&problem, first, &long);
        found = verified(asked, &problem, &best)?;
    }
    let (controller, values) = found;
    let design = describe(asked, &problem, &best, controller, &values, settings.seed);
    work.count(&problem);
    let end = if design.violation <= MET {
        FixedOrderEnd::Designed(Box::new(design))
    } else {
        FixedOrderEnd::BoundsNotMet(Box::new(design))
    };
    Ok((end, work))
}

/// A result shaken and searched from again, for as long as that gains.
fn shaken(
    problem: &Problem,
    mut best: BundleResult<Id>,
    settings: &FixedOrderSettings,
    long: &BundleSettings,
) -> BundleResult<Id> {
    let mut vain = 0;
    for round in 0..settings.tries {
        let places = starts::around(&best.x, settings.seed.wrapping_add(7919 * (round as u64 + 1)));
        let medium = BundleSettings {
            iterations: MEDIUM.min(long.iterations),
            evaluations: 4 * MEDIUM,
            tolerance: 1e-5,
            penalty: best.penalty,
            ..BundleSettings::default()
        };
        let led: Vec<Led> = places.par_iter().map(|x| from(problem, x, &medium)).collect();
        let mut new: Vec<BundleResult<Id>> =
            led.into_iter().filter_map(|l| if let Led::To(r) = l { Some(*r) } else { None }).collect();
        sort(&mut new);
        let before = best.goal;
        if let Some(r) = new.into_iter().next().filter(|r| better(r, &best, MET)) {
            let r = further(problem, &r, long);
            if better(&r, &best, MET) {
                best = r;
            }
        }
        vain = if before - best.goal > GAIN { 0 } else { vain + 1 };
        if vain == VAIN {
            break;
        }
    }
    best
}

fn sort(results: &mut [BundleResult<Id>]) {
    results.sort_by(|a, b| {
        use std::cmp::Ordering::{Equal, Greater, Less};
        if better(a, b, MET) {
            Less
        } else if better(b, a, MET) {
            Greater
        } else {
            Equal
        }
    });
}

/// Feedthrough that would make an H2 norm infinite is fixed at 0.
fn without_infinite(asked: &FixedOrder) -> Structure {
    let mut structure = asked.structure.clone();
    let order = structure.order();
    for t in &asked.targets {
        let Measure::H2(channel) = &t.measure else { continue };
        let plant = &asked.plants[t.plant];
        let (d12, d21) = (plant.d12(), plant.d21());
        let columns: Vec<usize> = if channel.disturbances.is_empty() {
            (0..plant.nw()).collect()
        } else {
            channel.disturbances.clone()
        };
        for u in 0..plant.nu() {
            for y in 0..plant.ny() {
                let out = channel.outputs.iter().any(|(i, w)| *w > 0.0 && d12[(*i, u)] != 0.0);
                let into = columns.iter().any(|w| d21[(y, *w)] != 0.0);
                if out && into && structure.entry(order + u, order + y) == Entry::Free {
                    structure.fix(order + u, order + y, 0.0);
                }
            }
        }
    }
    structure
}

type Values = Vec<(f64, Option<f64>)>;

fn verified(
    asked: &FixedOrder,
    problem: &Problem,
    best: &BundleResult<Id>,
) -> Result<(StateSpace<Continuous>, Values), SynthesisError> {
    let controller = controller_of(&problem.block(&best.x), problem.structure.order())?;
    let values = verify::values(&asked.plants, &asked.targets, &controller)?;
    Ok((controller, values))
}

/// Frequencies of norms that the search has lower than they are.
fn missed(asked: &FixedOrder, problem: &Problem, best: &BundleResult<Id>, values: &Values) -> Vec<f64> {
    let Some(pieces) = problem.pieces(&best.x) else { return Vec::new() };
    let seen = problem.values(&pieces);
    (0..asked.targets.len())
        .filter_map(|k| {
            let omega = values[k].1.filter(|w| w.is_finite() && *w > 0.0)?;
            let claimed = (seen[k] + problem.wanted[k].unit).exp();
            let new = problem.frequencies.iter().all(|w| (w / omega - 1.0).abs() > 1e-9);
            (values[k].0 > claimed * (1.0 + SEEN) && new).then_some(omega)
        })
        .collect()
}

fn describe(
    asked: &FixedOrder,
    problem: &Problem,
    best: &BundleResult<Id>,
    controller: StateSpace<Continuous>,
    values: &Values,
    seed: u64,
) -> FixedOrderDesign {
    let mut goal: Option<f64> = None;
    let mut violation: f64 = 0.0;
    let mut listed = Vec::new();
    for (k, (t, (value, omega))) in asked.targets.iter().zip(values).enumerate() {
        match t.aim {
            Aim::Goal(unit) => goal = Some(goal.map_or(value / unit, |g: f64| g.max(value / unit))),
            Aim::Bound(limit) => {
                let excess = match t.measure {
                    Measure::Abscissa => (value - limit) / problem.scales.pace,
                    _ => value / limit - 1.0,
                };
                violation = violation.max(excess);
            }
        }
        let of_target = || best.active.iter().filter(|(p, _)| p.id.target == k);
        let mut active_rad_s: Vec<f64> = of_target()
            .filter_map(|(p, _)| match p.id.of {
                Of::Peak { omega, .. } => Some(omega),
                _ => None,
            })
            .collect();
        active_rad_s.sort_by(f64::total_cmp);
        active_rad_s.dedup_by(|a, b| (*a - *b).abs() <= 1e-3 * *b);
        listed.push(TargetValue {
            name: t.name.clone(),
            value: *value,
            omega_rad_s: *omega,
            multiplier: of_target().map(|(_, w)| w).sum(),
            active_rad_s,
        });
    }
    // the controller's own limits
    if let Some(pieces) = problem.pieces(&best.x) {
        let values = problem.values(&pieces);
        for (w, v) in problem.wanted.iter().zip(&values).skip(asked.targets.len()) {
            if w.role != crate::optimize::Role::Goal {
                violation = violation.max(v.exp() - 1.0);
            }
        }
    }
    let scale = 1.0 + best.x.iter().map(|v| v * v).sum::<f64>().sqrt();
    let stationarity = sampled_subdifferential(
        problem,
        &best.x,
        best.penalty,
        RADIUS * scale,
        2 * best.x.len().min(40),
        seed,
    );
    FixedOrderDesign {
        controller,
        goal: best.goal.is_finite().then(|| best.goal.exp()),
        verified_goal: goal,
        values: listed,
        violation,
        stationarity,
        converged: best.end == BundleEnd::Converged,
        work: FixedOrderWork::default(),
    }
}

impl FixedOrderWork {
    fn add(&mut self, o: Self) {
        self.starts += o.starts;
        self.stabilised += o.stabilised;
        self.loops += o.loops;
        self.factorisations += o.factorisations;
        self.eigenproblems += o.eigenproblems;
        self.lyapunov += o.lyapunov;
    }

    fn count(&mut self, problem: &Problem) {
        let c = &problem.counters;
        self.loops += c.loops.load(Relaxed);
        self.factorisations += c.factorisations.load(Relaxed);
        self.eigenproblems += c.eigenproblems.load(Relaxed);
        self.lyapunov += c.lyapunov.load(Relaxed);
    }
}
