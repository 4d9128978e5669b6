//! What a controller does to the plants, by the library's own norms of loops closed anew: routes that the search does not
//! take.

use super::asked::FixedOrder;
use super::targets::{Channel, Measure, Target};
use crate::linalg::Mat;
use crate::lti::norms::peak::largest_singular_value;
use crate::lti::{Continuous, GeneralizedPlant, LtiError, StateSpace};

/// Places around each lightly damped pole where the response is looked at again.
const AROUND: [f64; 9] = [-3.0, -1.5, -0.7, -0.3, 0.0, 0.3, 0.7, 1.5, 3.0];

/// Frequencies at which the gain of an unstable controller is looked at.
const GRID: usize = 400;

/// Of each target its value, and the frequency of it where it is a peak's.
pub(super) type Values = Vec<(f64, Option<f64>)>;

/// A target's value in the loop, and the frequency of it where it is a peak's.
pub(super) fn value(
    closed: &StateSpace<Continuous>,
    target: &Target,
) -> Result<(f64, Option<f64>), LtiError> {
    match &target.measure {
        Measure::Abscissa => Ok((closed.least_stable_pole()?.map_or(f64::NEG_INFINITY, |(_, m)| -m), None)),
        Measure::H2(c) => match channel(closed, c)?.h2_norm() {
            Ok(norm) => Ok((norm, None)),
            Err(LtiError::NotStrictlyProper { .. }) => Ok((f64::INFINITY, None)),
            Err(e) => Err(e),
        },
        Measure::Hinf(c) => {
            let one = channel(closed, c)?;
            let peak = one.hinf_norm()?;
            let (norm, omega) = refined(&one, (peak.norm, peak.omega_rad_s))?;
            Ok((norm, Some(omega)))
        }
    }
}

/// The highest of a norm and what a plain solve says around every pole's frequency.
fn refined(g: &StateSpace<Continuous>, found: (f64, f64)) -> Result<(f64, f64), LtiError> {
    let mut best = found;
    for p in g.poles()?.iter().filter(|p| p.im > 0.0) {
        for k in AROUND {
            let omega = p.im + k * p.re.abs();
            if omega > 0.0 {
                let response = g.at(crate::linalg::C64::new(0.0, omega))?;
                let size = largest_singular_value(&response);
                if size > best.0 {
                    best = (size, omega);
                }
            }
        }
    }
    Ok(best)
}

/// Rows and columns of a channel, weighted.
fn channel(closed: &StateSpace<Continuous>, channel: &Channel) -> Result<StateSpace<Continuous>, LtiError> {
    let rows: Vec<usize> = channel.outputs.iter().map(|o| o.0).collect();
    let all: Vec<usize> = (0..closed.inputs()).collect();
    let columns = if channel.disturbances.is_empty() { &all } else { &channel.disturbances };
    let one = closed.select(&rows, columns)?;
    let weighted = |m: &Mat| Mat::from_fn(m.nrows(), m.ncols(), |i, j| channel.outputs[i].1 * m[(i, j)]);
    StateSpace::continuous(one.a().clone(), one.b().clone(), weighted(one.c()), weighted(one.d()))
}

/// All targets' values; each plant's loop is closed once.
pub(super) fn values(
    plants: &[GeneralizedPlant],
    targets: &[Target],
    controller: &StateSpace<Continuous>,
) -> Result<Values, LtiError> {
    let loops = plants.iter().map(|p| p.close(controller)).collect::<Result<Vec<_>, _>>()?;
    for closed in &loops {
        closed.check_stable("the closed loop")?;
    }
    targets.iter().map(|t| value(&loops[t.plant], t)).collect()
}

/// How far the controller's own limits and the loops' margin are exceeded: shares of the limits, a margin in units of the
/// pace; 0 where they are kept.
pub(super) fn beyond_limits(
    asked: &FixedOrder,
    controller: &StateSpace<Continuous>,
    pace: f64,
) -> Result<f64, LtiError> {
    let mut excess = 0.0f64;
    if let Some(most) = asked.max_pole_rad_s {
        let fastest = controller.poles()?.iter().map(|p| p.norm()).fold(0.0, f64::max);
        excess = excess.max(fastest / most - 1.0);
    }
    if let Some(most) = asked.max_gain {
        excess = excess.max(largest_gain(controller)? / most - 1.0);
    }
    if asked.margin_rad_s > 0.0 {
        for plant in &asked.plants {
            let margin = plant.close(controller)?.least_stable_pole()?.map_or(f64::INFINITY, |(_, m)| m);
            excess = excess.max((asked.margin_rad_s - margin) / pace);
        }
    }
    Ok(excess)
}

/// sup σ̄(K(iω)); of a controller that is not stable the largest at its poles' frequencies and on a grid around them.
fn largest_gain(k: &StateSpace<Continuous>) -> Result<f64, LtiError> {
    if k.is_stable()? {
        return Ok(k.hinf_norm()?.norm);
    }
    let sizes: Vec<f64> = k.poles()?.iter().map(|p| p.norm()).filter(|s| *s > 0.0).collect();
    let (low, high) =
        sizes.iter().fold((f64::INFINITY, 0.0f64), |(low, high), s| (low.min(0.1 * s), high.max(10.0 * s)));
    let step = (high / low).ln() / (GRID - 1) as f64;
    let grid = (0..GRID).map(|i| low * (step * i as f64).exp());
    let omegas: Vec<f64> = std::iter::once(0.0).chain(sizes.iter().copied()).chain(grid).collect();
    let gains = k.frequency_response(&omegas)?;
    Ok(gains.iter().map(largest_singular_value).fold(0.0, f64::max))
}
