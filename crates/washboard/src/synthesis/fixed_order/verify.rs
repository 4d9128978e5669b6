//! What a controller does to the plants, by norms that share nothing with the search.

use super::targets::{Channel, Measure, Target};
use crate::linalg::Mat;
use crate::lti::{Continuous, GeneralizedPlant, LtiError, StateSpace};

/// Places around each lightly damped pole where the response is looked at again.
const AROUND: [f64; 9] = [-3.0, -1.5, -0.7, -0.3, 0.0, 0.3, 0.7, 1.5, 3.0];

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
                let size = crate::lti::norms::peak::largest_singular_value(&response);
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
