//! From a start to a local optimum: into the stable set, then down.

use super::problem::{Id, Problem};
use crate::optimize::{BfgsSettings, BundleResult, BundleSettings, Descent, Pieces, bfgs, minimize};
use rayon::prelude::*;

/// An abscissa below this, in units of the plants' pace, is enough to begin with.
const STABLE: f64 = -1e-2;
/// And above this it is not stable.
const LEAST: f64 = -1e-10;
/// A bound may be exceeded by this, in ln.
pub(super) const MET: f64 = 1e-6;
/// Steps towards the stable set, and into it.
const STABILISE: usize = 60;
const FARTHER: usize = 8;
/// Rounds with a smooth function, and steps of one.
const SMOOTH_ROUNDS: usize = 40;
const SMOOTH_STEPS: usize = 30;
/// Results whose goals and whose bounds' excess are this near (in ln) are one.
const TWINS: f64 = 1e-4;
/// Results that are carried to the end.
pub(super) const KEPT: usize = 3;
/// And of those that exceed a bound, with a lower goal.
const LOWEST: usize = 2;
/// What bounds that are exceeded count in a heat, beside the goal.
const EXCEEDED: f64 = 10.0;

/// Where a start led.
#[derive(Debug, Clone)]
pub(super) enum Led {
    /// No stable loop: the least abscissa found, rad/s.
    Unstable(f64),
    To(Box<BundleResult<Id>>),
}

/// A start on its way.
enum Way<'a> {
    /// No stable loop: the least abscissa found, rad/s.
    Unstable(f64),
    Down {
        begun: Vec<f64>,
        descent: Box<Descent<'a, Problem>>,
    },
}

/// One start; `smooth` where it is worth the effort to stabilise it by a smooth function.
pub(super) fn from(problem: &Problem, x: &[f64], settings: &BundleSettings, smooth: bool) -> Led {
    let mut way = begin(problem, x, settings, smooth);
    way.to(settings.iterations);
    way.led(problem, settings)
}

/// All starts, a heat at a time: after each (steps in all, one of how many goes on), those go on that stand lowest. The
/// others are left as they stand. The first `own` starts compete among themselves, and so do the others: none is left
/// because there are more of the others.
pub(super) fn race(
    problem: &Problem,
    starts: &[Vec<f64>],
    own: usize,
    settings: &BundleSettings,
    heats: &[(usize, usize)],
) -> Vec<Led> {
    let mut ways: Vec<Way> = starts.par_iter().map(|x| begin(problem, x, settings, false)).collect();
    let mut running: [Vec<usize>; 2] = [(0..own).collect(), (own..ways.len()).collect()];
    let marked = |running: &[Vec<usize>; 2]| {
        let mut on = vec![false; starts.len()];
        running.iter().flatten().for_each(|k| on[*k] = true);
        on
    };
    for (steps, share) in heats {
        let on = marked(&running);
        ways.par_iter_mut().zip(&on).filter(|(_, on)| **on).for_each(|(way, _)| way.to(*steps));
        for (group, size) in running.iter_mut().zip([own, starts.len() - own]) {
            group.retain(|k| matches!(ways[*k], Way::Down { .. }));
            group.sort_by(|a, b| ways[*a].height().total_cmp(&ways[*b].height()));
            group.truncate(size.div_ceil(*share).max(KEPT));
        }
    }
    let on = marked(&running);
    ways.into_par_iter()
        .zip(on)
        .map(|(mut way, on)| {
            if on {
                way.to(settings.iterations);
            }
            way.led(problem, settings)
        })
        .collect()
}

/// Goal and bounds as one number.
fn height(goal: f64, violation: f64) -> f64 {
    goal.max(f64::MIN) + EXCEEDED * violation
}

/// Those that are worth a long search: the best ones; and those that exceed a bound yet, with a goal below these, which
/// stand lowest. Twins count once.
pub(super) fn promising(results: &[BundleResult<Id>], most: usize) -> Vec<usize> {
    let mut best: Vec<usize> = (0..results.len()).collect();
    best.sort_by(|a, b| order(&results[*a], &results[*b]));
    let alike = |a: usize, b: usize| {
        let (a, b) = (&results[a], &results[b]);
        (a.goal - b.goal).abs() < TWINS && (a.violation - b.violation).abs() < TWINS
    };
    let first = best.first().map_or(f64::INFINITY, |k| results[*k].goal);
    let mut lowest = best.clone();
    lowest.retain(|k| results[*k].violation > MET && results[*k].goal < first);
    let height = |k: usize| height(results[k].goal, results[k].violation);
    lowest.sort_by(|a, b| height(*a).total_cmp(&height(*b)));
    let mut chosen: Vec<usize> = Vec::new();
    for (of, most) in [(best, most), (lowest, LOWEST)] {
        let mut taken: Vec<usize> = Vec::new();
        for k in of {
            if taken.len() < most && !taken.iter().any(|t| alike(*t, k)) {
                taken.push(k);
            }
        }
        taken.retain(|k| !chosen.iter().any(|c| alike(*c, *k)));
        chosen.extend(taken);
    }
    chosen
}

impl Way<'_> {
    fn to(&mut self, steps: usize) {
        if let Way::Down { descent, .. } = self {
            descent.to(steps);
        }
    }

    /// Goal and bounds as one number, the same measure for all starts.
    fn height(&self) -> f64 {
        match self {
            Way::Unstable(_) => f64::INFINITY,
            Way::Down { descent, .. } => {
                let (goal, violation) = descent.stands();
                height(goal, violation)
            }
        }
    }

    fn led(self, problem: &Problem, settings: &BundleSettings) -> Led {
        match self {
            Way::Unstable(least) => Led::Unstable(least),
            Way::Down { begun, descent } => {
                Led::To(Box::new(not_worse(problem, descent.result(), &begun, settings.penalty)))
            }
        }
    }
}

/// The start with a stable loop.
fn begin<'a>(problem: &'a Problem, x: &[f64], settings: &BundleSettings, smooth: bool) -> Way<'a> {
    let mut x = x.to_vec();
    let mut abscissa = f64::INFINITY;
    if problem.pieces(&x).is_none() {
        (x, abscissa) = match stabilised(problem, &x, smooth) {
            Ok(stable) => stable,
            Err(least) => return Way::Unstable(least),
        };
    }
    match Descent::from(problem, &x, settings) {
        Some(descent) => Way::Down { begun: x, descent: Box::new(descent) },
        None => Way::Unstable(abscissa),
    }
}

/// A point with a stable loop and its abscissa, rad/s, or the least abscissa found.
fn stabilised(problem: &Problem, x: &[f64], smooth: bool) -> Result<(Vec<f64>, f64), f64> {
    let pace = problem.scales.pace;
    let wanted = STABLE - 1.5 * problem.margin / pace;
    let enough = |value: f64| value < LEAST - problem.margin / pace;
    let settings = BfgsSettings {
        iterations: if smooth { 3 * STABILISE } else { STABILISE },
        enough: wanted,
        flat: 1e-12,
    };
    let mut best = (x.to_vec(), f64::INFINITY);
    // only just stable first: from there a few steps are enough, where poles meet there may be no more to gain
    let just = BfgsSettings { enough: LEAST - problem.margin / pace, ..settings };
    if let Some(mut found) = bfgs(x, &just, |x| problem.abscissa(x)) {
        if enough(found.value) {
            let on = BfgsSettings { iterations: FARTHER, ..settings };
            if let Some(farther) =
                bfgs(&found.x, &on, |x| problem.abscissa(x)).filter(|f| f.value < found.value)
            {
                found = farther;
            }
            return Ok((found.x, found.value * pace));
        }
        best = (found.x, found.value);
    }
    if !smooth {
        return Err(best.1 * pace);
    }
    // where eigenvalues meet the abscissa has no slope to follow: a smooth function that is large near it has
    for from in [x.to_vec(), best.0.clone()] {
        let mut x = from;
        let mut room = 1.0;
        for _ in 0..SMOOTH_ROUNDS {
            let Some(now) = problem.rightmost(&x).map(|v| v / pace) else { break };
            if now < best.1 {
                best = (x.clone(), now);
            }
            if enough(now) {
                return Ok((x, now * pace));
            }
            let shift = (now + room) * pace;
            let settings = BfgsSettings { iterations: SMOOTH_STEPS, enough: f64::NEG_INFINITY, flat: 1e-6 };
            let Some(found) = bfgs(&x, &settings, |x| problem.smoothed(x, shift)) else { break };
            let then = problem.rightmost(&found.x).map_or(f64::INFINITY, |v| v / pace);
            if now - then < 0.1 * room {
                room *= 0.3;
            }
            if room < 1e-5 {
                break;
            }
            x = found.x;
        }
    }
    Err(best.1 * pace)
}

/// What was found, or where it was begun if that is better: a penalty may trade bounds for the goal.
fn not_worse(problem: &Problem, found: BundleResult<Id>, x: &[f64], penalty: f64) -> BundleResult<Id> {
    match as_it_is(problem, x, penalty) {
        Some(begun) if better(&begun, &found, MET) => begun,
        _ => found,
    }
}

/// A point as a result, no step made.
pub(super) fn as_it_is(problem: &Problem, x: &[f64], penalty: f64) -> Option<BundleResult<Id>> {
    minimize(problem, x, &BundleSettings { iterations: 0, penalty, ..BundleSettings::default() })
}

/// Whether one result is better than another: bounds first, then the goal.
pub(super) fn better(one: &BundleResult<Id>, other: &BundleResult<Id>, met: f64) -> bool {
    match (one.violation <= met, other.violation <= met) {
        (true, true) => one.goal < other.goal,
        (true, false) => true,
        (false, true) => false,
        (false, false) => one.violation < other.violation,
    }
}

/// Goes on from a result.
pub(super) fn further(
    problem: &Problem,
    from: &BundleResult<Id>,
    settings: &BundleSettings,
) -> BundleResult<Id> {
    let settings = BundleSettings { penalty: from.penalty, ..*settings };
    match minimize(problem, &from.x, &settings) {
        Some(found) if !better(from, &found, MET) => found,
        _ => from.clone(),
    }
}

/// The best first.
pub(super) fn sort(results: &mut [BundleResult<Id>]) {
    results.sort_by(order);
}

/// The better one first.
fn order(a: &BundleResult<Id>, b: &BundleResult<Id>) -> std::cmp::Ordering {
    use std::cmp::Ordering::{Equal, Greater, Less};
    if better(a, b, MET) {
        Less
    } else if better(b, a, MET) {
        Greater
    } else {
        Equal
    }
}
