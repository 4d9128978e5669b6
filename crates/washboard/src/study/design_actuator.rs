//! A loop with an actuator that is no ideal one: a low-pass of some bandwidth and a pure delay between controller and vehicle.

use super::design_goal::plain;
use super::design_goal_norms::GoalNorms;
use super::design_problem::Problem;
use super::{DesignSpec, Named, StudyError};
use crate::linalg::{C64, Mat};
use crate::lti::{Continuous, LtiError, StateSpace, pade_delay};
use crate::units::rad_per_s;
use serde::{Deserialize, Serialize};

/// What is looked at where a design does not state its actuator: a fast hydraulic one.
const WHAT_IF: ActuatorSection = ActuatorSection { bandwidth_hz: 30.0, delay_s: 0.005, order: 1 };
/// Bandwidths, Hz, from which and down to which a loop is looked at, and the factor between two.
const BANDWIDTHS_HZ: [f64; 2] = [0.1, 1e4];
const BANDWIDTH_STEP: f64 = 1.25;
/// Delays, s, likewise, upwards from none.
const DELAYS_S: [f64; 2] = [2e-4, 1.0];
const DELAY_STEP: f64 = 1.25;
/// Halvings of the interval in which a loop ceases to be stable: 25 % between two steps become 1e-5.
const HALVINGS: usize = 15;
/// The approximated delay's error times the loop's gain, at most, wherever that gain is [`LEAST_GAIN`] or more.
const DELAY_ERROR: f64 = 1e-3;
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

/// A loop with an actuator, and how much worse the actuator may be.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ActuatorLoop {
    /// The actuator.
    pub actuator: ActuatorSection,
    /// Whether the design states it; else it is a question only.
    pub stated: bool,
    /// Whether the loop is stable.
    pub stable: bool,
    /// The goal's value over the one without it; none where the loop is not stable.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub goal: Option<f64>,
    /// Norms of the goal over those without it: `h2_NAME`, `hinf_NAME`.
    #[serde(default, skip_serializing_if = "Named::is_empty")]
    pub norms: Named<f64>,
    /// Order of Padé's approximation of the delay.
    pub delay_order: usize,
    /// Its error times the loop's gain, at most, where that gain is a tenth or more.
    pub delay_error: f64,
    /// The least bandwidth, Hz, with the delay given, coming down from 10 kHz or the largest that can be looked at.
    pub bandwidth_hz: Reach,
    /// The largest delay, s, with the bandwidth given, going up from none.
    pub delay_s: Reach,
}

/// How far a loop stays stable.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Reach {
    /// From the first value at which the delay can be approximated …
    pub from: f64,
    /// … up to here …
    pub to: f64,
    /// … and this is how it ends there.
    pub end: ReachEnd,
}

/// How a reach ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ReachEnd {
    /// Beyond it the loop is not stable.
    Unstable,
    /// It was not looked at farther.
    LookedAt,
    /// Not even there is the loop stable.
    Nowhere,
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

    /// The least order of the delay's approximation that is good enough, and its error times the loop's gain.
    fn delay_order(&self, a: &ActuatorSection) -> Option<(usize, f64)> {
        if a.delay_s == 0.0 {
            return Some((0, 0.0));
        }
        let corner = rad_per_s(a.bandwidth_hz);
        let low_pass = |w: f64| 1.0 / (1.0 + (w / corner).powi(2 * a.order as i32)).sqrt();
        DELAY_ORDERS.into_iter().find_map(|order| {
            let error = self
                .gains
                .iter()
                .map(|(w, gain)| (gain * low_pass(*w), *w))
                .filter(|(gain, _)| *gain >= LEAST_GAIN)
                .map(|(gain, w)| gain * pade_error(w * a.delay_s, order))
                .fold(0.0, f64::max);
            (error <= DELAY_ERROR).then_some((order, error))
        })
    }

    /// The controller with actuators behind it.
    fn with(&self, a: &ActuatorSection, delay_order: usize) -> Result<StateSpace<Continuous>, LtiError> {
        let one = a.low_pass()?.series(&pade_delay(a.delay_s, delay_order)?)?;
        let all = (1..self.k.outputs()).try_fold(one.clone(), |all, _| all.append(&one))?;
        self.k.series(&all)
    }

    /// None where the delay is too long for its approximation.
    fn is_stable(&self, a: &ActuatorSection) -> Result<Option<bool>, LtiError> {
        let Some((order, _)) = self.delay_order(a) else { return Ok(None) };
        let closed = match self.back.feedback(&self.with(a, order)?) {
            Err(LtiError::IllPosed { .. }) => return Ok(Some(false)),
            closed => closed?,
        };
        closed.is_stable().map(Some)
    }

    /// From the first value on, as far as the loop stays stable.
    fn reach(
        &self,
        values: impl Iterator<Item = f64>,
        with: impl Fn(f64) -> ActuatorSection,
    ) -> Result<Reach, LtiError> {
        // the first value that could be looked at, and the last at which the loop is stable
        let (mut from, mut last): (Option<f64>, Option<f64>) = (None, None);
        for value in values {
            let Some(stable) = self.is_stable(&with(value))? else {
                // a bandwidth so large that loop gains beyond the delay's approximation count; or a delay too long for it
                if last.is_some() {
                    break;
                }
                continue;
            };
            let from = *from.get_or_insert(value);
            if stable {
                last = Some(value);
                continue;
            }
            let Some(mut good) = last else { return Ok(Reach { from, to: value, end: ReachEnd::Nowhere }) };
            let mut bad = value;
            for _ in 0..HALVINGS {
                let middle = 0.5 * (good + bad);
                if self.is_stable(&with(middle))? == Some(true) {
                    good = middle;
                } else {
                    bad = middle;
                }
            }
            return Ok(Reach { from, to: good, end: ReachEnd::Unstable });
        }
        let to = last.unwrap_or_default();
        Ok(Reach { from: from.unwrap_or_default(), to, end: ReachEnd::LookedAt })
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
) -> Result<Option<ActuatorLoop>, StudyError> {
    let fail =
        |e: LtiError| StudyError::Design { name: problem.spec.vehicle.clone(), source: Box::new(e.into()) };
    let (actuator, stated) = (problem.spec.actuator.unwrap_or(WHAT_IF), problem.spec.actuator.is_some());
    let own = Loop::new(problem, k)?;
    let Some((delay_order, delay_error)) = own.delay_order(&actuator) else { return Ok(None) };
    let stable = own.is_stable(&actuator).map_err(fail)? == Some(true);
    let found = own.with(&actuator, delay_order).and_then(|k| GoalNorms::of(problem, &k)).map_err(fail)?;
    let (goal, norms) = found.ok().filter(|_| stable).map(|f| f.over(nominal)).unwrap_or_default();
    let (down, up) = rayon::join(
        || own.reach(bandwidths(), |bandwidth_hz| ActuatorSection { bandwidth_hz, ..actuator }),
        || own.reach(delays(), |delay_s| ActuatorSection { delay_s, ..actuator }),
    );
    Ok(Some(ActuatorLoop {
        actuator,
        stated,
        stable,
        goal,
        norms,
        delay_order,
        delay_error,
        bandwidth_hz: down.map_err(fail)?,
        delay_s: up.map_err(fail)?,
    }))
}

fn bandwidths() -> impl Iterator<Item = f64> {
    let next = |b: &f64| Some(b / BANDWIDTH_STEP).filter(|b| *b >= BANDWIDTHS_HZ[0]);
    std::iter::successors(Some(BANDWIDTHS_HZ[1]), next)
}

fn delays() -> impl Iterator<Item = f64> {
    let next = |d: &f64| Some(d * DELAY_STEP).filter(|d| *d <= DELAYS_S[1]);
    std::iter::once(0.0).chain(std::iter::successors(Some(DELAYS_S[0]), next))
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
mod tests {
    use super::*;
    use crate::study::design_problem::Norm;
    use crate::study::{DesignOutcome, Goal, design};

    /// Fifteen halvings of a quarter of the value, and the delay's approximation.
    const BISECTED: f64 = 1e-3;

    fn quarter(actuator: ActuatorSection) -> (DesignSpec, DesignOutcome) {
        let minimize = ["sprung_acceleration", "suspension_travel", "tire_deflection"];
        let spec = DesignSpec {
            vehicle: "case:turkay-quarter-car".into(),
            road: "case:turkay-white-velocity".into(),
            speed_m_s: 20.0,
            measurements: vec!["suspension_travel".into()],
            r#override: [("tire_damping_n_s_per_m".to_owned(), 98.0)].into_iter().collect(),
            input_weight: 1e-9,
            goal: Goal {
                minimize: minimize.iter().map(|n| ((*n).to_owned(), 1.0)).collect(),
                ..Goal::default()
            },
            actuator: Some(actuator),
            ..DesignSpec::default()
        };
        let outcome = design(&spec).unwrap().0;
        (spec, outcome)
    }

    /// Evenly in log ω, so near to each other that what is between them does not count.
    fn omegas() -> Vec<f64> {
        (0..400_000).map(|k| 0.5 * (1e4f64.ln() * f64::from(k) / 4e5).exp()).collect()
    }

    /// K G a(s) over frequency, the delay left out.
    fn open_loop(
        problem: &Problem,
        k: &StateSpace<Continuous>,
        a: &ActuatorSection,
        omegas: &[f64],
    ) -> Vec<C64> {
        let car = &problem.vehicle;
        let back = car.actuated(&[car.output("suspension_travel").unwrap()], &[0]).unwrap();
        let open = back.series(k).unwrap().frequency_response(omegas).unwrap();
        let corner = rad_per_s(a.bandwidth_hz);
        let low_pass = |w: f64| {
            let x = C64::new(0.0, w / corner);
            if a.order == 1 { x + 1.0 } else { x * x + x * 2f64.sqrt() + 1.0 }
        };
        omegas.iter().zip(open).map(|(w, l)| l[(0, 0)] / low_pass(*w)).collect()
    }

    #[test]
    fn the_largest_delay_is_the_delay_margin() {
        for order in [1, 2] {
            let actuator = ActuatorSection { bandwidth_hz: 60.0, delay_s: 0.0, order };
            let (spec, outcome) = quarter(actuator);
            let found = outcome.robustness.as_ref().unwrap().actuator.as_ref().unwrap();
            assert!(found.stable && found.stated && found.delay_order == 0, "{found:?}");
            assert_eq!(found.delay_s.end, ReachEnd::Unstable, "{found:?}");
            // with u = +K y a pole crosses where K G a e^{−iωT} = 1: of all ω with |K G a| = 1 the least T
            let omegas = omegas();
            let problem = Problem::new(&spec, Norm::H2).unwrap();
            let k = outcome.controller.as_ref().unwrap().state_space().unwrap();
            let l = open_loop(&problem, &k, &actuator, &omegas);
            let crossing = |k: &usize| (l[*k].norm() - 1.0) * (l[*k + 1].norm() - 1.0) <= 0.0;
            let turn = |k: usize| l[k].arg().rem_euclid(std::f64::consts::TAU) / omegas[k];
            let margin = (0..l.len() - 1).filter(crossing).map(turn).fold(f64::INFINITY, f64::min);
            let ratio = found.delay_s.to / margin;
            assert!((ratio - 1.0).abs() < BISECTED, "order {order}: {} {margin}", found.delay_s.to);
        }
    }

    #[test]
    fn at_the_least_bandwidth_the_loop_swings_on_with_the_exact_delay() {
        let actuator = ActuatorSection { bandwidth_hz: 200.0, delay_s: 0.004, order: 1 };
        let (spec, _) = quarter(actuator);
        let problem = Problem::new(&spec, Norm::H2).unwrap();
        // a spring eight times as stiff as the car's own, by the actuator: late, it is a negative damper of 512 N s/m and more
        let k = StateSpace::continuous_gain(Mat::from_fn(1, 1, |_, _| 8.0 * 16000.0)).unwrap();
        let nominal = GoalNorms::of(&problem, &k).unwrap().unwrap();
        let found = with_actuator(&problem, &k, &nominal).unwrap().unwrap();
        assert!(found.stable && found.bandwidth_hz.end == ReachEnd::Unstable, "{found:?}");
        let least = found.bandwidth_hz.to;
        let omegas = omegas();
        let nearest = |bandwidth_hz: f64| {
            let l = open_loop(&problem, &k, &ActuatorSection { bandwidth_hz, ..actuator }, &omegas);
            let turned = l.iter().zip(&omegas).map(|(l, w)| l * C64::from_polar(1.0, -w * actuator.delay_s));
            turned.map(|l| (l - 1.0).norm()).fold(f64::INFINITY, f64::min)
        };
        // K G a e^{−iωT} = 1 there, and not at twice that
        assert!(nearest(least) < 5.0 * BISECTED, "{} at {least}", nearest(least));
        assert!(nearest(2.0 * least) > 20.0 * BISECTED, "{}", nearest(2.0 * least));
    }

    #[test]
    fn the_error_of_a_delay_is_the_one_of_its_system() {
        for order in [2, 3, 7, 12] {
            for x in [0.3, 1.0, 2.5] {
                let g = pade_delay(0.1, order).unwrap().frequency_response(&[x / 0.1]).unwrap()[0][(0, 0)];
                let known = (g - C64::from_polar(1.0, -x)).norm();
                assert!((pade_error(x, order) - known).abs() < 1e-9, "{order} {x}");
            }
        }
    }

    #[test]
    fn actuators_that_are_none_are_refused() {
        let wrong = |actuator| {
            let spec = DesignSpec { actuator: Some(actuator), ..DesignSpec::default() };
            spec.check_actuator().unwrap_err().to_string()
        };
        let good = ActuatorSection { bandwidth_hz: 20.0, delay_s: 0.005, order: 1 };
        assert!(wrong(ActuatorSection { bandwidth_hz: 0.0, ..good }).contains("actuator.bandwidth_hz"));
        assert!(wrong(ActuatorSection { delay_s: -1.0, ..good }).contains("actuator.delay_s"));
        assert!(wrong(ActuatorSection { order: 3, ..good }).contains("Butterworth"));
    }
}
