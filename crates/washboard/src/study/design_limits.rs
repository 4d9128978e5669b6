//! `goal.max_pole_rad_s` and `goal.max_gain`: a controller farther inside, until it is slow and gentle enough.

use super::design_mixed::{infeasible, stalled};
use super::design_outcome::{DesignOutcome, DesignStatus};
use super::design_problem::Problem;
use super::design_words::short;
use super::{Flag, design_mixed};
use crate::linalg::singular_values;
use crate::lti::{Continuous, LtiError, StateSpace};
use crate::optimize::Measures;
use crate::synthesis::{PoleRegion, SynthesisError};

/// Shares of the objective that are given up, one after another.
const BACK_OFFS: [f64; 4] = [1e-2, 5e-2, 0.2, 0.5];
/// The smallest feasible bound is found to this share, by factors up to the other number.
const NEAR_BOUND: f64 = 0.01;
const MOST_TIMES: f64 = 1e3;
const GROWTH: f64 = 1.6;
/// A controller whose poles are so many times the fastest of the vehicle is worth a warning.
const FAST: f64 = 100.0;
/// Frequencies at which an unstable controller's gain is looked at, beside its poles', 0 and ∞.
const POINTS: usize = 400;

/// How one try ended.
pub(super) enum Attempt<T> {
    Found { controller: StateSpace<Continuous>, of: T },
    Infeasible(Option<f64>),
    Stalled(Measures),
}

/// A controller that keeps to the limits.
pub(super) struct Kept<T> {
    pub controller: StateSpace<Continuous>,
    pub of: T,
    how: How,
}

/// What it took, and the controller's fastest pole and largest gain.
struct How {
    asked: f64,
    back_off: f64,
    bounded: bool,
    failed: bool,
    found: [f64; 2],
}

impl<T> Kept<T> {
    /// Its numbers among the claims.
    pub fn claim(&self, outcome: &mut DesignOutcome) {
        let [pole, gain] = self.how.found;
        if self.controller.order() > 0 {
            outcome.claimed.insert("fastest_controller_pole", pole);
        }
        outcome.claimed.insert("controller_gain", gain);
        if self.how.back_off > 0.0 {
            outcome.claimed.insert("back_off", self.how.back_off);
        }
    }
}

/// The first controller that keeps to the limits: as asked, then with the loop's poles bounded too, then with more of the
/// objective given up. `solve` takes a factor on all bounds, a back-off and a region. Without a controller `outcome` says why.
pub(super) fn within<T>(
    problem: &Problem,
    asked: f64,
    region: PoleRegion,
    outcome: &mut DesignOutcome,
    solve: impl Fn(f64, f64, PoleRegion) -> Result<Attempt<T>, SynthesisError>,
) -> Result<Option<Kept<T>>, SynthesisError> {
    let goal = &problem.spec.goal;
    let limited = goal.max_pole_rad_s.is_some() || goal.max_gain.is_some();
    let mut regions = vec![region];
    if let Some(most) = goal.max_pole_rad_s {
        let within = region.within.map_or(most, |w| w.min(most));
        regions.push(PoleRegion { within: Some(within), ..region });
    }
    let mut nearest: Option<[f64; 2]> = None;
    let mut failed: Option<SynthesisError> = None;
    for back_off in std::iter::once(asked).chain(BACK_OFFS.iter().copied().filter(|b| *b > asked)) {
        if back_off > asked && !limited && failed.is_none() {
            break;
        }
        for (k, region) in regions.iter().enumerate() {
            let (controller, of) = match solve(1.0, back_off, *region) {
                Ok(Attempt::Found { controller, of }) => (controller, of),
                Err(e) => {
                    // nearer to the middle its equations are better conditioned
                    failed.get_or_insert(e);
                    continue;
                }
                // what the limits add may be too much; what is asked may not
                _ if k > 0 || nearest.is_some() || failed.is_some() => continue,
                Ok(Attempt::Infeasible(times)) => {
                    let met =
                        |factor: f64| matches!(solve(factor, asked, *region), Ok(Attempt::Found { .. }));
                    let bounded = problem.peaks.iter().any(|p| p.bound.is_some());
                    infeasible(problem, if bounded { smallest(times, met) } else { None }, outcome);
                    return Ok(None);
                }
                Ok(Attempt::Stalled(measures)) => {
                    stalled(&measures, outcome);
                    return Ok(None);
                }
            };
            let found = [fastest(&controller)?, largest_gain(&controller)?];
            if over(goal.max_pole_rad_s, found[0]) || over(goal.max_gain, found[1]) {
                let excess = |f: &[f64; 2]| {
                    let of = |limit: Option<f64>, v: f64| limit.map_or(0.0, |l| v / l);
                    of(goal.max_pole_rad_s, f[0]).max(of(goal.max_gain, f[1]))
                };
                if nearest.as_ref().is_none_or(|n| excess(&found) < excess(n)) {
                    nearest = Some(found);
                }
                continue;
            }
            let how = How { asked, back_off, bounded: k > 0, failed: failed.is_some(), found };
            said(problem, &how, outcome);
            return Ok(Some(Kept { controller, of, how }));
        }
    }
    if let (None, Some(e)) = (nearest, failed) {
        return Err(e);
    }
    outcome.status = DesignStatus::Refused;
    outcome.why = nearest.map(|n| refusal(problem, n));
    Ok(None)
}

/// The smallest factor on all bounds with which there is a controller, to a per cent: above `least`, which is known to be
/// necessary. None where none of the factors tried helps.
fn smallest(least: Option<f64>, met: impl Fn(f64) -> bool) -> Option<f64> {
    let mut low = least.unwrap_or(1.0).max(1.0);
    let mut high = low * (1.0 + NEAR_BOUND);
    while !met(high) {
        low = high;
        high *= GROWTH;
        if high > MOST_TIMES {
            return None;
        }
    }
    while high / low > 1.0 + NEAR_BOUND {
        let middle = (low * high).sqrt();
        if met(middle) { high = middle } else { low = middle }
    }
    Some(high)
}

fn over(limit: Option<f64>, found: f64) -> bool {
    limit.is_some_and(|l| !(found <= l))
}

/// Notes of what the limits cost, or a warning of what is absurd.
fn said(problem: &Problem, how: &How, outcome: &mut DesignOutcome) {
    let (asked, back_off, found) = (how.asked, how.back_off, how.found);
    if back_off > asked || how.bounded {
        let given = format!(
            "{} % of the least value are given up instead of {} %",
            short(100.0 * back_off),
            short(100.0 * asked)
        );
        let slow = "the loop's poles are kept as slow as the controller's are to be".to_owned();
        let what: Vec<String> =
            (back_off > asked).then_some(given).into_iter().chain(how.bounded.then_some(slow)).collect();
        let why = if how.failed {
            "nearer to the least value rounding makes the loop contradict its promise"
        } else {
            "for a controller that is slow and gentle enough"
        };
        let text = format!("{why}: {}", what.join(", and "));
        outcome.notes.push(Flag { name: "backed-off".into(), text });
    }
    let own = outcome.passive.poles.iter().map(|p| p[0].hypot(p[1])).fold(0.0, f64::max);
    if found[0] > FAST * own && own > 0.0 {
        let noise = problem.spec.mixed.unwrap_or_default().sensor_noise;
        let why = if noise == 0.0 {
            "measurements without noise let it differentiate, and its least objective has gains without bound: state \
             mixed.sensor_noise, or "
        } else {
            ""
        };
        let text = format!(
            "the controller has a pole at {} rad/s, {:.0} times the vehicle's fastest, and a gain of {} N per unit of its \
             measurements: {why}set goal.max_pole_rad_s or goal.max_gain",
            short(found[0]),
            found[0] / own,
            short(found[1])
        );
        outcome.warnings.push(Flag { name: "fast-controller".into(), text });
    }
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
    let method = design_mixed::remedy(problem);
    format!(
        "{}: that is the nearest of all that were tried, up to {most:.0} % above the least objective. Allow more, {method}",
        parts.join("; ")
    )
}

/// |λ| of the fastest pole; 0 of a gain.
pub(super) fn fastest(k: &StateSpace<Continuous>) -> Result<f64, LtiError> {
    Ok(k.poles()?.iter().map(|p| p.norm()).fold(0.0, f64::max))
}

/// sup σ_max(K(iω)): of a controller that is not stable, the largest at 0, ∞, its poles' frequencies and between.
pub(super) fn largest_gain(k: &StateSpace<Continuous>) -> Result<f64, LtiError> {
    if k.is_stable()? {
        return Ok(k.hinf_norm()?.norm);
    }
    let sizes: Vec<f64> = k.poles()?.iter().map(|p| p.norm()).filter(|s| *s > 0.0).collect();
    let (low, high) =
        sizes.iter().fold((f64::INFINITY, 0.0f64), |(low, high), s| (low.min(0.1 * s), high.max(10.0 * s)));
    let step = (high / low).ln() / (POINTS - 1) as f64;
    let grid = (0..POINTS).map(|i| low * (step * i as f64).exp());
    let omegas: Vec<f64> = std::iter::once(0.0).chain(sizes.iter().copied()).chain(grid).collect();
    let direct = singular_values(k.d())?.first().copied().unwrap_or(0.0);
    let responses = k.frequency_response(&omegas)?;
    let gains = responses.iter().filter_map(|r| r.singular_values().ok()?.first().copied());
    Ok(gains.fold(direct, f64::max))
}
