//! Tries at a controller, one region of poles, share of the goal and weight of the control after another.

use super::DesignMethod;
use super::design_gains::{fastest, largest_gain};
use super::design_outcome::DesignOutcome;
use super::design_problem::Problem;
use super::design_smallest::smallest;
use crate::linalg::C64;
use crate::lti::{Continuous, StateSpace};
use crate::optimize::Measures;
use crate::synthesis::{PoleRegion, SynthesisError};
use std::cell::Cell;

/// A pole nearer to the axis than this share of the largest may be on it but for rounding: a loop's eigenvalues are known to
/// about ε times a condition of 1e6.
const AT_REST: f64 = 1e-10;
/// One that is not slower than the vehicle's slowest by this is not: a loop may have very fast poles beside it.
const SLOW: f64 = 1e-3;
/// Where rounding leaves a pole there, the loop's are kept left of the vehicle's slowest times this.
const MARGIN: f64 = 0.1;

/// The share of the objective that the search for the smallest bounds gives up where the stated one is not enough: one of those that a
/// design of these bounds tries too.
const GIVEN_UP: f64 = 5e-2;

/// States from which on a program in double-double takes many seconds: so many tries go on in it.
const LARGE: usize = 10;
const PATIENT: usize = 2;

/// What one try is asked.
#[derive(Clone, Copy)]
pub(super) struct Try {
    /// A factor on all bounds.
    pub times: f64,
    pub back_off: f64,
    pub region: PoleRegion,
    /// Beside the `input_weight` that is stated, 1/N².
    pub added_weight: f64,
    /// Whether a solver that stalls may go on in double-double: not where one of many tries matters little.
    pub patient: bool,
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
    pub how: How,
}

/// What it took, and the controller's fastest pole and largest gain.
#[derive(Clone, Copy)]
pub(super) struct How {
    pub around: Around,
    pub back_off: f64,
    pub added_weight: f64,
    pub found: [f64; 2],
}

/// A region, and what was added to it.
#[derive(Clone, Copy)]
pub(super) struct Around {
    pub region: PoleRegion,
    pub bounded: bool,
    pub margin: Option<f64>,
}

/// Why no try gave a controller.
pub(super) enum Failure {
    Error(SynthesisError),
    AtRest(C64),
    Stalled(Measures),
}

/// Tries are bounded by their number, not by a clock: the same on any machine.
#[derive(Clone, Copy)]
pub(super) struct Work {
    pub left: usize,
    pub tries: usize,
    is_large: bool,
}

impl Work {
    /// Of output feedback, whose programs grow with the square of the states: programs that take about half a minute, 16 a try where
    /// each searches a scale. A gain's programs are small.
    pub fn of(problem: &Problem) -> Self {
        const MOST: f64 = 640.0;
        const LEAST: f64 = 2.0;
        const A_SEARCH: f64 = 16.0;
        const AT_TWELVE: f64 = 130.0;
        let order = problem.plant.order();
        if problem.spec.method != DesignMethod::MixedH2Hinf {
            return Work { left: MOST as usize, tries: 0, is_large: false };
        }
        let both = !(problem.peaks.is_empty() || problem.goals.is_empty() && problem.bounded.is_empty());
        let each = if both && problem.spec.lyapunov_scale.is_searched() { A_SEARCH } else { 1.0 };
        let programs = (AT_TWELVE * (12.0 / order.max(1) as f64).powi(5)).min(MOST);
        let left = (programs / each).max(LEAST) as usize;
        Work { left, tries: 0, is_large: order >= LARGE }
    }
}

/// Tries, and what they left.
pub(super) struct Search<'a, T, S> {
    pub problem: &'a Problem,
    pub solve: S,
    /// The vehicle's slowest decay, 1/s.
    pub slowest: f64,
    pub nearest: Option<[f64; 2]>,
    pub failed: Option<Failure>,
    /// The first with a pole at rest.
    pub resting: Option<Kept<T>>,
    /// What was done, and what is left.
    pub work: Cell<Work>,
}

pub(super) enum Ended<T> {
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

    /// Counts one try; none where no work is left for it, else whether it may go on in double-double.
    fn next_try(&self) -> Option<bool> {
        let work = self.work.get();
        if work.left == 0 {
            return None;
        }
        self.work.set(Work { left: work.left - 1, tries: work.tries + 1, ..work });
        Some(!work.is_large || work.tries < PATIENT)
    }

    /// Whether the search ended for want of tries.
    pub fn is_spent(&self) -> bool {
        self.work.get().left == 0
    }

    pub fn is_limited(&self) -> bool {
        let goal = &self.problem.spec.goal;
        goal.max_pole_rad_s.is_some() || goal.max_gain.is_some()
    }

    pub fn one(
        &mut self,
        around: Around,
        back_off: f64,
        added_weight: f64,
    ) -> Result<Ended<T>, SynthesisError> {
        let Some(patient) = self.next_try() else { return Ok(Ended::Missed) };
        let tried = (self.solve)(Try { times: 1.0, back_off, region: around.region, added_weight, patient });
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
    pub fn weighted(
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
    pub fn smallest(&self, least: Option<f64>, arounds: &[Around], asked: f64) -> Option<f64> {
        let tightest = self.problem.bounds().map(|(_, b)| b).reduce(f64::min)?;
        if !self.work.get().is_large {
            self.work.set(Work::of(self.problem));
        }
        let met = |times: f64| {
            // what was added last is what it took before, and where rounding decides a larger share may be given up
            arounds.iter().rev().any(|around| {
                [asked, asked.max(GIVEN_UP)].into_iter().any(|back_off| {
                    if self.next_try().is_none() {
                        return false;
                    }
                    let asked =
                        Try { times, back_off, region: around.region, added_weight: 0.0, patient: false };
                    match (self.solve)(asked) {
                        Ok(Attempt::Found(made)) => self.at_rest(&made.poles).is_none(),
                        _ => false,
                    }
                })
            })
        };
        smallest(least, tightest, met)
    }
}

impl Around {
    /// The same left of a margin, where it does not ask for that itself.
    pub fn with_margin(&self, outcome: &DesignOutcome) -> Option<Self> {
        let margin = MARGIN * slowest(outcome)?;
        let r = self.region;
        let room = [r.within, r.slower_than].into_iter().flatten().all(|far| margin < far);
        let new = r.faster_than.is_none_or(|own| own < margin);
        let region = PoleRegion { faster_than: Some(margin), ..r };
        (room && new).then_some(Around { region, margin: Some(margin), ..*self })
    }
}

/// The vehicle's slowest decay that is one.
pub(super) fn slowest(outcome: &DesignOutcome) -> Option<f64> {
    let poles = &outcome.passive.poles;
    let largest = poles.iter().map(|p| p[0].hypot(p[1])).fold(0.0, f64::max);
    poles.iter().map(|p| -p[0]).filter(|d| *d > AT_REST * largest).reduce(f64::min)
}

fn over(limit: Option<f64>, found: f64) -> bool {
    limit.is_some_and(|l| !(found <= l))
}
