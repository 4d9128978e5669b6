//! How fast and how strong a controller is, against the vehicle that it is for.

use super::design_outcome::Measured;
use super::design_problem::Problem;
use super::design_words::{short, usual_weight};
use super::{Flag, design_advice};
use crate::linalg::singular_values;
use crate::lti::{Continuous, LtiError, StateSpace};

/// A controller whose poles are so many times the fastest of the vehicle, or whose gain is so many times its springs and
/// dampers, is worth a warning.
const FAST: f64 = 100.0;
/// The same of a dynamic controller's largest gain over frequency, which is far above its gain at a ride's frequencies or not: a
/// spring ten times as stiff as the stiffest of the vehicle, tires included, is none.
const STRONG: f64 = 10.0;
/// Frequencies at which an unstable controller's gain is looked at, beside its poles', 0 and ∞.
const POINTS: usize = 400;
/// Powers of ten of the usual weight of the control that are tried for a smaller gain.
const WEIGHTS: std::ops::RangeInclusive<i32> = -6..=6;

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

/// Weights of the control, ascending, around the one at which 1 kN costs as much as an output without control.
pub(super) fn lighter(problem: &Problem, passive: &Measured) -> Vec<f64> {
    let usual = usual_weight(problem, passive);
    usual.map_or_else(Vec::new, |w| WEIGHTS.map(|k| w * 10f64.powi(k)).collect())
}

/// A warning of a controller that is far faster than the vehicle.
pub(super) fn fast_controller(problem: &Problem, passive: &Measured, found: [f64; 2]) -> Option<Flag> {
    let own = passive.poles.iter().map(|p| p[0].hypot(p[1])).fold(0.0, f64::max);
    if !(found[0] > FAST * own && own > 0.0) {
        return None;
    }
    let noise = problem.spec.mixed.unwrap_or_default().sensor_noise;
    let mixes = problem.spec.method == crate::study::DesignMethod::MixedH2Hinf;
    let why = if mixes && noise == 0.0 {
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
    Some(Flag { name: "fast-controller".into(), text })
}

/// A warning of a dynamic controller whose largest gain from a measurement is far above what the vehicle's own springs (of
/// travels), dampers (of velocities) or masses (of accelerations) do.
pub(super) fn high_dynamic_gain(problem: &Problem, k: &StateSpace<Continuous>) -> Option<Flag> {
    let system = problem.vehicle.system();
    let (spring, mass) = (system.k().norm_max(), system.m().norm_max());
    let damper = system.c().norm_max().max((spring * mass).sqrt());
    let controls: Vec<usize> = (0..k.outputs()).collect();
    let all = problem.measurements.iter().enumerate().filter_map(|(j, o)| {
        let gain = largest_gain(&k.select(&controls, &[j]).ok()?).ok()?;
        let (own, what) = if o.unit.ends_with("/s²") {
            (mass, "masses")
        } else if o.unit.ends_with("/s") {
            (damper, "dampers")
        } else {
            (spring, "springs")
        };
        // a force is no motion
        (o.unit != "N").then_some((gain / own, gain, own, what, o))
    });
    let (times, gain, own, what, o) = all.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (times > STRONG && own > 0.0).then(|| {
        let text = format!(
            "the largest gain of {} over frequency is {} N per {}, {} times the vehicle's largest of its own {what} ({} N per {}): \
             no actuator does that; bound it, goal.max_gain = {}",
            o.name,
            short(gain),
            o.unit,
            short(times),
            short(own),
            o.unit,
            short(own)
        );
        Flag { name: "high-gain".into(), text }
    })
}

/// A warning of a gain from states that is far above the vehicle's own springs (of travels) and dampers (of velocities: the
/// largest, or √(k m) where there are hardly any).
pub(super) fn high_gain(problem: &Problem, passive: &Measured, k: &StateSpace<Continuous>) -> Option<Flag> {
    let system = problem.vehicle.system();
    let spring = system.k().norm_max();
    let damper = system.c().norm_max().max((spring * system.m().norm_max()).sqrt());
    let ratio = |j: usize, unit: &str| {
        let gain = (0..k.d().nrows()).map(|i| k.d()[(i, j)].abs()).fold(0.0, f64::max);
        let (own, what) = if unit.ends_with("/s") { (damper, "dampers") } else { (spring, "springs") };
        (gain / own, gain, own, what)
    };
    let units = problem.units();
    let all = problem.measurements.iter().enumerate().map(|(j, o)| {
        let unit = units.get(&o.name).cloned().unwrap_or_default();
        (ratio(j, &unit), &o.name, unit)
    });
    let ((times, gain, own, what), name, unit) = all.max_by(|a, b| a.0.0.total_cmp(&b.0.0))?;
    (times > FAST && own > 0.0).then(|| {
        let text = format!(
            "the gain of {name} is {} N per {unit}, {} times the vehicle's own {what} ({} N per {unit}): a direction of the states costs next to nothing, and \
             no actuator does that; {}",
            short(gain),
            short(times),
            short(own),
            design_advice::weigh(problem, passive)
        );
        Flag { name: "high-gain".into(), text }
    })
}
