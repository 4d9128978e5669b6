//! A controller that its loop confirms and that keeps to `goal.max_pole_rad_s` and `goal.max_gain`: as asked, else farther inside.

use super::design_advice::{infeasible, stalled, unconfirmed};
use super::design_gains::{fast_controller, fastest, largest_gain, lighter};
use super::design_outcome::{DesignOutcome, DesignStatus};
use super::design_problem::Problem;
use super::design_smallest::smallest;
use super::design_words::short;
use super::{Flag, design_advice};
use crate::linalg::C64;
use crate::lti::{Continuous, StateSpace};
use crate::optimize::Measures;
use crate::synthesis::{PoleRegion, SynthesisError};

/// Shares of the objective that are given up, one after another.
const BACK_OFFS: [f64; 4] = [1e-2, 5e-2, 0.2, 0.5];
/// A pole nearer to the axis than this share of the largest may be on it but for rounding: a loop's eigenvalues are known to
/// about ε times a condition of 1e6.
const AT_REST: f64 = 1e-10;
/// One that is not slower than the vehicle's slowest by this is not: a loop may have very fast poles beside it.
const SLOW: f64 = 1e-3;
/// Where rounding leaves a pole there, the loop's are kept left of the vehicle's slowest times this.
const MARGIN: f64 = 0.1;

/// What one try is asked.
#[derive(Clone, Copy)]
pub(super) struct Try {
    /// A factor on all bounds.
    pub times: f64,
    pub back_off: f64,
    pub region: PoleRegion,
    /// Beside the `input_weight` that is stated, 1/N².
    pub added_weight: f64,
}

/// How one try ended.
pub(super) enum Attempt<T> {
    Found(Box<Made<T>>),
    Infeasible(Option<f64>),
    Stalled(Measures),
}

/// A controller, what it was made with, and the poles of all its loops.
pub(super) struct Made<T> {
    pub controller: StateSpace<Continuous>,
    pub of: T,
    pub poles: Vec<C64>,
}

/// A controller that keeps to the limits.
pub(super) struct Kept<T> {
    pub controller: StateSpace<Continuous>,
    pub of: T,
    how: How,
}

/// What it took, and the controller's fastest pole and largest gain.
#[derive(Clone, Copy)]
struct How {
    around: Around,
    back_off: f64,
    added_weight: f64,
    found: [f64; 2],
}

/// A region, and what was added to it.
#[derive(Clone, Copy)]
struct Around {
    region: PoleRegion,
    bounded: bool,
    margin: Option<f64>,
}

/// Why no try gave a controller.
enum Failure {
    Error(SynthesisError),
    AtRest(C64),
    Stalled(Measures),
}

impl<T> Kept<T> {
    /// Its numbers among the claims.
    pub fn claim(&self, outcome: &mut DesignOutcome) {
        let [pole, gain] = self.how.found;
        if self.controller.order() > 0 {
            outcome.claimed.insert("fastest_controller_pole", pole);
        }
        outcome.claimed.insert("controller_gain", gain);
        let also = [
            ("back_off", Some(self.how.back_off).filter(|b| *b > 0.0)),
            ("pole_margin", self.how.around.margin),
            ("added_input_weight", self.added_weight()),
        ];
        for (name, value) in also {
            if let Some(value) = value {
                outcome.claimed.insert(name, value);
            }
        }
    }

    fn added_weight(&self) -> Option<f64> {
        Some(self.how.added_weight).filter(|w| *w > 0.0)
    }
}

/// Tries, and what they left.
struct Search<'a, T, S> {
    problem: &'a Problem,
    solve: S,
    /// The vehicle's slowest decay, 1/s.
    slowest: f64,
    nearest: Option<[f64; 2]>,
    failed: Option<Failure>,
    /// The first with a pole at rest.
    resting: Option<Kept<T>>,
}

/// The first controller that keeps to the limits: as asked; with the loop's poles kept as slow as the controller's are to be;
/// where rounding leaves a pole on the axis, or a loop that contradicts its promise, with poles left of a margin; with more of
/// the objective given up; for a gain that is too large with the controls weighted. Without one `outcome` says why.
pub(super) fn within<T>(
    problem: &Problem,
    asked: f64,
    region: PoleRegion,
    outcome: &mut DesignOutcome,
    solve: impl Fn(Try) -> Result<Attempt<T>, SynthesisError>,
) -> Result<Option<Kept<T>>, SynthesisError> {
    let goal = &problem.spec.goal;
    let mut arounds = vec![Around { region, bounded: false, margin: None }];
    if let Some(most) = goal.max_pole_rad_s {
        let within = region.within.map_or(most, |w| w.min(most));
        let region = PoleRegion { within: Some(within), ..region };
        arounds.push(Around { region, bounded: true, margin: None });
    }
    let margins: Vec<Around> = arounds.iter().filter_map(|a| a.with_margin(outcome)).collect();
    let mut search = Search {
        problem,
        solve,
        slowest: slowest(outcome).unwrap_or(f64::INFINITY),
        nearest: None,
        failed: None,
        resting: None,
    };
    for back_off in std::iter::once(asked).chain(BACK_OFFS.iter().copied().filter(|b| *b > asked)) {
        // nearer to the middle equations are better conditioned; a solver that stalls does so there too
        let better = matches!(search.failed, Some(Failure::Error(_) | Failure::AtRest(_)));
        if back_off > asked && !search.is_limited() && !better {
            break;
        }
        let mut k = 0;
        while let Some(around) = arounds.get(k).copied() {
            let first = k == 0 && search.nearest.is_none() && search.failed.is_none();
            k += 1;
            match search.one(around, back_off, 0.0)? {
                Ended::Kept(kept) => return Ok(Some(said(problem, asked, *kept, outcome))),
                // what is added may be too much; what is asked may not
                Ended::Infeasible(times) if first => {
                    // what is possible may need a margin too
                    arounds.extend(&margins);
                    let least = search.smallest(times, &arounds, asked);
                    infeasible(problem, least, true, outcome);
                    return Ok(None);
                }
                _ => {}
            }
            if search.failed.is_some() && arounds.iter().all(|a| a.margin.is_none()) {
                arounds.extend(&margins);
            }
        }
    }
    if search.nearest.is_some() {
        if let Some(kept) = search.weighted(&arounds, asked, &lighter(problem, &outcome.passive))? {
            return Ok(Some(said(problem, asked, kept, outcome)));
        }
        outcome.status = DesignStatus::Refused;
        outcome.why = search.nearest.map(|n| refusal(problem, n));
        return Ok(None);
    }
    let measurable = |k: &Kept<T>| problem.measure(Some(&k.controller)).is_ok_and(|m| m.stable);
    if let Some(kept) = search.resting.take().filter(measurable) {
        return Ok(Some(said(problem, asked, kept, outcome)));
    }
    if problem.has_bounds() {
        let least = search.smallest(None, &arounds, asked);
        if least.is_some() {
            infeasible(problem, least, false, outcome);
            return Ok(None);
        }
    }
    match search.failed {
        Some(Failure::Error(e)) => return Err(e),
        Some(Failure::AtRest(pole)) => unconfirmed(problem, pole, outcome),
        Some(Failure::Stalled(measures)) => stalled(problem, &measures, outcome),
        None => {}
    }
    Ok(None)
}

enum Ended<T> {
    Kept(Box<Kept<T>>),
    Infeasible(Option<f64>),
    Missed,
}

impl<T, S: Fn(Try) -> Result<Attempt<T>, SynthesisError>> Search<'_, T, S> {
    /// A pole that is on the axis but for rounding.
    fn at_rest(&self, poles: &[C64]) -> Option<C64> {
        let largest = poles.iter().map(|p| p.norm()).fold(0.0, f64::max);
        poles.iter().copied().find(|p| -p.re < (AT_REST * largest).min(SLOW * self.slowest))
    }

    fn is_limited(&self) -> bool {
        let goal = &self.problem.spec.goal;
        goal.max_pole_rad_s.is_some() || goal.max_gain.is_some()
    }

    fn one(&mut self, around: Around, back_off: f64, added_weight: f64) -> Result<Ended<T>, SynthesisError> {
        let tried = (self.solve)(Try { times: 1.0, back_off, region: around.region, added_weight });
        let (controller, of, poles) = match tried {
            Ok(Attempt::Found(made)) => (made.controller, made.of, made.poles),
            Ok(Attempt::Infeasible(times)) => return Ok(Ended::Infeasible(times)),
            Ok(Attempt::Stalled(measures)) => {
                if self.nearest.is_none() {
                    self.failed.get_or_insert(Failure::Stalled(measures));
                }
                return Ok(Ended::Missed);
            }
            Err(e) => {
                self.failed.get_or_insert(Failure::Error(e));
                return Ok(Ended::Missed);
            }
        };
        let found = [fastest(&controller)?, largest_gain(&controller)?];
        let kept = Kept { controller, of, how: How { around, back_off, added_weight, found } };
        let goal = &self.problem.spec.goal;
        if over(goal.max_pole_rad_s, found[0]) || over(goal.max_gain, found[1]) {
            let excess = |f: &[f64; 2]| {
                let of = |limit: Option<f64>, v: f64| limit.map_or(0.0, |l| v / l);
                of(goal.max_pole_rad_s, f[0]).max(of(goal.max_gain, f[1]))
            };
            if self.nearest.as_ref().is_none_or(|n| excess(&found) < excess(n)) {
                self.nearest = Some(found);
            }
            return Ok(Ended::Missed);
        }
        if let Some(pole) = self.at_rest(&poles) {
            self.failed.get_or_insert(Failure::AtRest(pole));
            self.resting.get_or_insert(kept);
            return Ok(Ended::Missed);
        }
        Ok(Ended::Kept(Box::new(kept)))
    }

    /// The least of the weights, in ascending order, that keeps to the limits, by bisection, and then a smaller one between.
    fn weighted(
        &mut self,
        arounds: &[Around],
        asked: f64,
        weights: &[f64],
    ) -> Result<Option<Kept<T>>, SynthesisError> {
        const HALVINGS: usize = 3;
        if self.problem.spec.goal.max_gain.is_none() {
            return Ok(None);
        }
        let mut best: Option<Kept<T>> = None;
        let (mut low, mut high) = (0, weights.len());
        while low < high {
            let middle = usize::midpoint(low, high);
            match self.around(arounds, asked, weights[middle])? {
                Some(kept) => (best, high) = (Some(kept), middle),
                None => low = middle + 1,
            }
        }
        // weights below `high` are too small
        if let Some(mut least) = high.checked_sub(1).map(|k| weights[k]) {
            for _ in 0..HALVINGS {
                let Some(kept) = &best else { break };
                let middle = f64::sqrt(least * kept.how.added_weight);
                match self.around(arounds, asked, middle)? {
                    Some(kept) => best = Some(kept),
                    None => least = middle,
                }
            }
        }
        Ok(best)
    }

    /// The first of the regions that gives a controller.
    fn around(
        &mut self,
        arounds: &[Around],
        back_off: f64,
        added_weight: f64,
    ) -> Result<Option<Kept<T>>, SynthesisError> {
        for around in arounds {
            if let Ended::Kept(kept) = self.one(*around, back_off, added_weight)? {
                return Ok(Some(*kept));
            }
        }
        Ok(None)
    }

    /// The smallest factor on all bounds with which there is a controller.
    fn smallest(&self, least: Option<f64>, arounds: &[Around], asked: f64) -> Option<f64> {
        let tightest = self.problem.bounds().map(|(_, b)| b).reduce(f64::min)?;
        let met = |times: f64| {
            // what was added last is what it took before
            arounds.iter().rev().any(|around| {
                let asked = Try { times, back_off: asked, region: around.region, added_weight: 0.0 };
                match (self.solve)(asked) {
                    Ok(Attempt::Found(made)) => self.at_rest(&made.poles).is_none(),
                    _ => false,
                }
            })
        };
        smallest(least, tightest, met)
    }
}

impl Around {
    /// The same left of a margin, where it does not ask for that itself.
    fn with_margin(&self, outcome: &DesignOutcome) -> Option<Self> {
        let margin = MARGIN * slowest(outcome)?;
        let r = self.region;
        let room = [r.within, r.slower_than].into_iter().flatten().all(|far| margin < far);
        let new = r.faster_than.is_none_or(|own| own < margin);
        let region = PoleRegion { faster_than: Some(margin), ..r };
        (room && new).then_some(Around { region, margin: Some(margin), ..*self })
    }
}

/// The vehicle's slowest decay that is one.
fn slowest(outcome: &DesignOutcome) -> Option<f64> {
    let poles = &outcome.passive.poles;
    let largest = poles.iter().map(|p| p[0].hypot(p[1])).fold(0.0, f64::max);
    poles.iter().map(|p| -p[0]).filter(|d| *d > AT_REST * largest).reduce(f64::min)
}

fn over(limit: Option<f64>, found: f64) -> bool {
    limit.is_some_and(|l| !(found <= l))
}

/// Notes of what the limits cost, a warning of what was added to what is asked, or of what is absurd.
fn said<T>(problem: &Problem, asked: f64, kept: Kept<T>, outcome: &mut DesignOutcome) -> Kept<T> {
    let How { around, back_off, added_weight, found } = kept.how;
    let flag = |name: &str, text: String| Flag { name: name.into(), text };
    if back_off > asked || around.bounded {
        let given = format!(
            "{} % of the least value are given up instead of {} %",
            short(100.0 * back_off),
            short(100.0 * asked)
        );
        let slow = "the loop's poles are kept as slow as the controller's are to be".to_owned();
        let what: Vec<String> =
            (back_off > asked).then_some(given).into_iter().chain(around.bounded.then_some(slow)).collect();
        let goal = &problem.spec.goal;
        let why = if goal.max_pole_rad_s.is_none() && goal.max_gain.is_none() {
            "nearer to the least value rounding makes the loop contradict its promise"
        } else {
            "for a controller that is slow and gentle enough"
        };
        outcome.notes.push(flag("backed-off", format!("{why}: {}", what.join(", and "))));
    }
    if let Some(margin) = around.margin {
        let text = format!(
            "as asked, rounding leaves the loop a pole at 0 or contradicts its promise; this controller is made with the loop's poles left \
             of −{} 1/s, which is not asked: state poles = {{ max_real_rad_s = … }} for another margin",
            short(margin)
        );
        outcome.warnings.push(flag("pole-margin", text));
    }
    if added_weight > 0.0 {
        let text = format!(
            "goal.max_gain is kept by a weight of the control that is not asked: it is made for input_weight = {} (1/N²), and the claims hold \
             this part of the cost too",
            short(problem.spec.input_weight + added_weight)
        );
        outcome.warnings.push(flag("added-weight", text));
    }
    outcome.warnings.extend(fast_controller(problem, &outcome.passive, found));
    kept
}

fn refusal(problem: &Problem, found: [f64; 2]) -> String {
    let goal = &problem.spec.goal;
    let part = |field: &str, what: &str, unit: &str, limit: Option<f64>, found: f64| {
        let limit = limit?;
        (found > limit)
            .then(|| format!("{field} is {} {unit}, and {what} {} {unit}", short(limit), short(found)))
    };
    let parts: Vec<String> = [
        part(
            "goal.max_pole_rad_s",
            "the controller's fastest pole is",
            "rad/s",
            goal.max_pole_rad_s,
            found[0],
        ),
        part("goal.max_gain", "the controller's largest gain is", "N per unit", goal.max_gain, found[1]),
    ]
    .into_iter()
    .flatten()
    .collect();
    let most = 100.0 * BACK_OFFS[BACK_OFFS.len() - 1];
    let weights = if goal.max_gain.is_some() { " and with the control weighted" } else { "" };
    let method = design_advice::remedy(problem);
    format!(
        "{}: that is the nearest of all that were tried, up to {most:.0} % above the least objective{weights}. Allow more, {method}",
        parts.join("; ")
    )
}
