//! A loop with an actuator that is no ideal one: a low-pass of some bandwidth and a pure delay between controller and vehicle.

use super::design_goal::plain;
use super::design_goal_norms::GoalNorms;
use super::design_problem::Problem;
use super::{DesignSpec, Named, StudyError};
use crate::linalg::{C64, Mat};
use crate::lti::{Continuous, LtiError, StateSpace, pade_delay};
use crate::units::rad_per_s;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// What is looked at where a design does not state its actuator: a fast hydraulic one.
const WHAT_IF: ActuatorSection = ActuatorSection { bandwidth_hz: 30.0, delay_s: 0.005, order: 1 };
/// Bandwidths, Hz, between which a loop is looked at.
const BANDWIDTHS_HZ: [f64; 2] = [0.1, 1e4];
/// Delays, s, likewise, beside none.
const DELAYS_S: [f64; 2] = [2e-4, 1.0];
/// The factor between two neighbours: a loop that changes twice between them is not seen to.
const STEP: f64 = 1.25;
/// Halvings of the interval in which a loop becomes or ceases to be stable: 25 % between two steps become 1e-5.
const HALVINGS: usize = 15;
/// The approximated delay's error times the loop's gain, at most, wherever that gain is [`LEAST_GAIN`] or more.
const DELAY_ERROR: f64 = 1e-3;
/// Where no approximation at all is wrong by less than this share of it, there is none.
const NO_DELAY: f64 = 1e-3;
/// Orders of the delay's approximation: beyond the last one a delay is not looked at.
const DELAY_ORDERS: std::ops::RangeInclusive<usize> = 2..=24;
/// Where the loop's gain is below this, no phase brings it near 1: the delay need not be right there.
const LEAST_GAIN: f64 = 0.1;
/// The highest order of one approximation alone.
const IN_ONE: usize = 12;
/// Where loop gains are looked at, rad/s.
const LOOKED_AT_RAD_S: [f64; 2] = [0.1, 1e5];
const POINTS: usize = 120;

/// `[actuator]`: what stands between the controller's outputs and the forces.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ActuatorSection {
    /// Where its gain has fallen by 3 dB.
    pub bandwidth_hz: f64,
    /// Pure delay, of computation and valves.
    #[serde(default)]
    pub delay_s: f64,
    /// 1: ω_b/(s + ω_b); 2: Butterworth's.
    #[serde(default = "first")]
    pub order: usize,
}

fn first() -> usize {
    1
}

/// A loop with an actuator, and which others it bears.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ActuatorLoop {
    /// The actuator.
    pub actuator: ActuatorSection,
    /// Whether the design states it; else it is a question only.
    pub stated: bool,
    /// Whether the loop is stable; none where the delay is too long for its approximation.
    pub stable: Option<bool>,
    /// The goal's value over the one without it; none where the loop is not stable.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub goal: Option<f64>,
    /// Norms of the goal over those without it: `h2_NAME`, `hinf_NAME`.
    #[serde(default, skip_serializing_if = "Named::is_empty")]
    pub norms: Named<f64>,
    /// Order of Padé's approximation of the delay, the last one tried where none is good enough.
    pub delay_order: usize,
    /// Its error times the loop's gain, at most, where that gain is a tenth or more.
    pub delay_error: f64,
    /// Bandwidths, Hz, with the delay given.
    pub bandwidth_hz: Reach,
    /// Delays, s, with the bandwidth given.
    pub delay_s: Reach,
}

/// Where a loop is stable: of slow low-passes some may be that faster ones are not.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Reach {
    /// The least and the largest value that was looked at: none beyond which the delay cannot be approximated.
    pub looked_at: Option<[f64; 2]>,
    /// From where to where the loop is stable, ascending.
    pub stable: Vec<[f64; 2]>,
}

impl DesignSpec {
    /// Refuses an actuator that is none.
    pub(super) fn check_actuator(&self) -> Result<(), StudyError> {
        let Some(a) = self.actuator else { return Ok(()) };
        let wrong = |field, expected: &str, found: String| {
            Err(StudyError::Setting { field, expected: expected.to_owned(), found })
        };
        if !(BANDWIDTHS_HZ[0]..=BANDWIDTHS_HZ[1]).contains(&a.bandwidth_hz) {
            return wrong("actuator.bandwidth_hz", "0.1 to 10000 Hz", plain(a.bandwidth_hz));
        }
        if !(0.0..=DELAYS_S[1]).contains(&a.delay_s) {
            return wrong("actuator.delay_s", "0 to 1 s", plain(a.delay_s));
        }
        if !(1..=2).contains(&a.order) {
            return wrong("actuator.order", "1, or 2 (Butterworth)", a.order.to_string());
        }
        Ok(())
    }
}

impl ActuatorSection {
    /// Its low-pass, without the delay.
    fn low_pass(&self) -> Result<StateSpace<Continuous>, LtiError> {
        let w = rad_per_s(self.bandwidth_hz);
        let of = |rows: usize, cols: usize, v: &[f64]| Mat::from_fn(rows, cols, |i, j| v[cols * i + j]);
        let none = Mat::zeros(1, 1);
        if self.order < 2 {
            return StateSpace::continuous(of(1, 1, &[-w]), of(1, 1, &[w]), of(1, 1, &[1.0]), none);
        }
        // states x and ẋ/ω_b
        let damping = 2f64.sqrt();
        let a = of(2, 2, &[0.0, w, -w, -damping * w]);
        StateSpace::continuous(a, of(2, 1, &[0.0, w]), of(1, 2, &[1.0, 0.0]), none)
    }
}

/// The loop seen from the actuators: controller and vehicle, each with its own part.
struct Loop<'a> {
    k: &'a StateSpace<Continuous>,
    /// From forces to measurements, the road standing still.
    back: StateSpace<Continuous>,
    /// |K G| over frequency without actuators.
    gains: Vec<(f64, f64)>,
}

impl<'a> Loop<'a> {
    fn new(problem: &Problem, k: &'a StateSpace<Continuous>) -> Result<Self, StudyError> {
        let y: Vec<&crate::vehicle::Output> = problem.measurements.iter().collect();
        let all: Vec<usize> = (0..problem.vehicle.actuators().len()).collect();
        let name = || problem.spec.vehicle.clone();
        let back = problem
            .vehicle
            .actuated(&y, &all)
            .map_err(|source| StudyError::Controller { name: name(), source: Box::new(source) })?;
        let fail = |e: LtiError| StudyError::Design { name: name(), source: Box::new(e.into()) };
        let step = (LOOKED_AT_RAD_S[1] / LOOKED_AT_RAD_S[0]).ln() / (POINTS - 1) as f64;
        let omegas: Vec<f64> = (0..POINTS).map(|i| LOOKED_AT_RAD_S[0] * (step * i as f64).exp()).collect();
        let responses = back.series(k).and_then(|l| l.frequency_response(&omegas)).map_err(fail)?;
        let size = |r: &crate::linalg::CMat| {
            r.singular_values().ok().and_then(|s| s.first().copied()).unwrap_or(f64::INFINITY)
        };
        let gains = omegas.into_iter().zip(responses.iter().map(size)).collect();
        Ok(Loop { k, back, gains })
    }

    /// The least order of the delay's approximation that is good enough, or the last one, and its error times the loop's gain.
    fn delay_order(&self, a: &ActuatorSection) -> (usize, f64) {
        if a.delay_s == 0.0 {
            return (0, 0.0);
        }
        let corner = rad_per_s(a.bandwidth_hz);
        let low_pass = |w: f64| 1.0 / (1.0 + (w / corner).powi(2 * a.order as i32)).sqrt();
        let largest = |of: &dyn Fn(f64) -> f64| {
            self.gains
                .iter()
                .map(|(w, gain)| (gain * low_pass(*w), *w))
                .filter(|(gain, _)| *gain >= LEAST_GAIN)
                .map(|(gain, w)| gain * of(w * a.delay_s))
                .fold(0.0, f64::max)
        };
        // |1 − e^{−ix}| ≤ x: a delay as short as this is none, and its approximation's coefficients are beyond doubles
        let none = largest(&|x| x);
        if none <= NO_DELAY * DELAY_ERROR {
            return (0, none);
        }
        let error = |order: usize| largest(&|x| pade_error(x, order));
        let last = *DELAY_ORDERS.end();
        let good = DELAY_ORDERS.map(|order| (order, error(order))).find(|(_, error)| *error <= DELAY_ERROR);
        good.unwrap_or_else(|| (last, error(last)))
    }

    /// The controller with actuators behind it.
    fn with(&self, a: &ActuatorSection, delay_order: usize) -> Result<StateSpace<Continuous>, LtiError> {
        let one = a.low_pass()?.series(&pade_delay(a.delay_s, delay_order)?)?;
        let all = (1..self.k.outputs()).try_fold(one.clone(), |all, _| all.append(&one))?;
        self.k.series(&all)
    }

    /// None where the delay is too long for its approximation.
    fn is_stable(&self, a: &ActuatorSection) -> Result<Option<bool>, LtiError> {
        let (order, error) = self.delay_order(a);
        if !(error <= DELAY_ERROR) {
            return Ok(None);
        }
        let closed = match self.back.feedback(&self.with(a, order)?) {
            Err(LtiError::IllPosed { .. }) => return Ok(Some(false)),
            closed => closed?,
        };
        closed.is_stable().map(Some)
    }

    /// Of ascending values those with which the loop is stable, as far as the delay can be approximated.
    fn reach(&self, values: &[f64], with: impl Fn(f64) -> ActuatorSection + Sync) -> Result<Reach, LtiError> {
        let found: Vec<_> = values.par_iter().map(|v| self.is_stable(&with(*v))).collect();
        let mut seen: Vec<(f64, bool)> = Vec::new();
        for (value, stable) in values.iter().zip(found) {
            let Some(stable) = stable? else { break };
            seen.push((*value, stable));
        }
        let end = |mut good: f64, mut bad: f64| -> Result<f64, LtiError> {
            for _ in 0..HALVINGS {
                let middle = 0.5 * (good + bad);
                if self.is_stable(&with(middle))? == Some(true) {
                    good = middle;
                } else {
                    bad = middle;
                }
            }
            Ok(good)
        };
        let mut stable: Vec<[f64; 2]> = Vec::new();
        let mut last: Option<(f64, bool)> = None;
        for (value, is) in &seen {
            match (last, stable.last_mut()) {
                (Some((_, true)), Some(open)) if *is => open[1] = *value,
                (Some((before, true)), Some(open)) => open[1] = end(before, *value)?,
                (Some((before, _)), _) if *is => stable.push([end(*value, before)?, *value]),
                (None, _) if *is => stable.push([*value, *value]),
                _ => {}
            }
            last = Some((*value, *is));
        }
        let looked_at = seen.first().zip(seen.last()).map(|(a, b)| [a.0, b.0]);
        Ok(Reach { looked_at, stable })
    }
}

impl Reach {
    /// In words, with numbers as they are shown.
    pub(super) fn words(&self, show: impl Fn(f64) -> String) -> String {
        let Some([low, high]) = self.looked_at else {
            return "not looked at: the delay is too long to be approximated".into();
        };
        let one = |[from, to]: &[f64; 2]| match (*from <= low, *to >= high) {
            (true, true) => "all".to_owned(),
            (true, false) => format!("up to {}", show(*to)),
            (false, true) => format!("from {} on", show(*from)),
            (false, false) => format!("{} to {}", show(*from), show(*to)),
        };
        let all = if self.stable.is_empty() {
            "none".to_owned()
        } else {
            self.stable.iter().map(one).collect::<Vec<_>>().join(" and ")
        };
        format!("{all} (looked at: {} to {})", show(low), show(high))
    }
}

/// The actuator that a design states, or the usual question, in the loop.
///
/// # Errors
/// A loop that is not well posed; an iteration that does not converge.
pub(super) fn with_actuator(
    problem: &Problem,
    k: &StateSpace<Continuous>,
    nominal: &GoalNorms,
) -> Result<ActuatorLoop, StudyError> {
    let fail =
        |e: LtiError| StudyError::Design { name: problem.spec.vehicle.clone(), source: Box::new(e.into()) };
    let (actuator, stated) = (problem.spec.actuator.unwrap_or(WHAT_IF), problem.spec.actuator.is_some());
    let own = Loop::new(problem, k)?;
    let (delay_order, delay_error) = own.delay_order(&actuator);
    let stable = own.is_stable(&actuator).map_err(fail)?;
    let (goal, norms) = if stable == Some(true) {
        let with = own.with(&actuator, delay_order).map_err(fail)?;
        let found = GoalNorms::of(problem, &with).map_err(fail)?;
        found.map(|f| f.over(nominal)).unwrap_or_default()
    } else {
        Default::default()
    };
    let bandwidths = steps(BANDWIDTHS_HZ, &[actuator.bandwidth_hz]);
    let delays = steps(DELAYS_S, &[0.0, actuator.delay_s]);
    let (over_bandwidth, over_delay) = rayon::join(
        || own.reach(&bandwidths, |bandwidth_hz| ActuatorSection { bandwidth_hz, ..actuator }),
        || own.reach(&delays, |delay_s| ActuatorSection { delay_s, ..actuator }),
    );
    Ok(ActuatorLoop {
        actuator,
        stated,
        stable,
        goal,
        norms,
        delay_order,
        delay_error,
        bandwidth_hz: over_bandwidth.map_err(fail)?,
        delay_s: over_delay.map_err(fail)?,
    })
}

/// From one end to the other and both of them, with others, ascending.
fn steps([low, high]: [f64; 2], others: &[f64]) -> Vec<f64> {
    let next = |v: &f64| Some(v * STEP).filter(|v| *v < high);
    let mut all: Vec<f64> =
        std::iter::successors(Some(low), next).chain([high]).chain(others.iter().copied()).collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

/// |P(−ix)/P(ix) − e^{−ix}| of Padé's P of some order: both are of modulus 1, so it is 2 |sin| of half the phases' difference.
fn pade_error(x: f64, order: usize) -> f64 {
    // longer ones are shorter ones in series, as in `pade_delay`, and their errors add up at most
    if order > IN_ONE {
        let pieces = order.div_ceil(IN_ONE);
        let share = |k: usize| order / pieces + usize::from(k < order % pieces);
        return (0..pieces).map(|k| pade_error(x * share(k) as f64 / order as f64, share(k))).sum();
    }
    // P(x) = Σ (2n − k)! n!/((2n)! k! (n − k)!) xᵏ
    let (mut term, mut sum) = (C64::new(1.0, 0.0), C64::new(1.0, 0.0));
    for k in 0..order {
        term *= C64::new(0.0, x) * ((order - k) as f64 / ((2 * order - k) * (k + 1)) as f64);
        sum += term;
    }
    let turned = sum.conj() / sum;
    (turned - C64::from_polar(1.0, -x)).norm()
}

#[cfg(test)]
mod tests;
