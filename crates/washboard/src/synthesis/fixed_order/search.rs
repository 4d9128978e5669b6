//! From a start to a local optimum: into the stable set, then down.

use super::problem::{Id, Problem};
use crate::optimize::{BfgsSettings, BundleEnd, BundleResult, BundleSettings, bfgs, minimize};

/// An abscissa below this, in units of the plants' pace, is enough to begin with.
const STABLE: f64 = -1e-2;
/// And above this it is not stable.
const LEAST: f64 = -1e-10;
/// Steps towards the stable set.
const STABILISE: usize = 400;

/// Where a start led.
#[derive(Debug, Clone)]
pub(super) enum Led {
    /// No stable loop: the least abscissa found, rad/s.
    Unstable(f64),
    To(Box<BundleResult<Id>>),
}

/// One start.
pub(super) fn from(problem: &Problem, x: &[f64], settings: &BundleSettings) -> Led {
    use crate::optimize::Pieces;
    let mut x = x.to_vec();
    let mut abscissa = f64::INFINITY;
    if problem.pieces(&x).is_none() {
        let least = -problem.margin / problem.scales.pace;
        let wanted = BfgsSettings { iterations: STABILISE, enough: STABLE + 1.5 * least, flat: 1e-12 };
        let Some(found) = bfgs(&x, &wanted, |x| problem.abscissa(x)) else {
            return Led::Unstable(abscissa);
        };
        abscissa = found.value * problem.scales.pace;
        if !(found.value < LEAST + least) {
            return Led::Unstable(abscissa);
        }
        x = found.x;
    }
    match minimize(problem, &x, settings) {
        Some(found) => Led::To(Box::new(found)),
        None => Led::Unstable(abscissa),
    }
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
) -> Option<BundleResult<Id>> {
    if from.end == BundleEnd::Converged {
        return None;
    }
    minimize(problem, &from.x, &BundleSettings { penalty: from.penalty, ..*settings })
}
