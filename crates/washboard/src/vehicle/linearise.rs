//! Statistical linearisation: the linear dampers that a road makes of dampers with curves.

use super::{Output, Ride, RideError, Vehicle, VehicleError};
use crate::road::Road;
use thiserror::Error;

/// Relative change of every damping at which the fixed point is found.
const FIXED_POINT_TOLERANCE: f64 = 1e-10;
/// The change shrinks to a half or less a step unless a curve is nearly dry friction.
const MAX_STEPS: usize = 400;

/// What is refused of a linearisation.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum LineariseError {
    /// There is nothing to linearise.
    #[error("damper_curve: expected a vehicle with one on some axle, found none")]
    NoCurve,
    /// A damper's velocity is infinite on this road.
    #[error("damper `{damper}` has no finite velocity on this road: {why}")]
    Infinite {
        /// Which.
        damper: String,
        /// Why.
        why: &'static str,
    },
    /// The fixed point was not reached.
    #[error(
        "the equivalent damping still changes by {change:e} a step after {steps} steps (expected {expected:e})"
    )]
    NotConverged {
        /// The largest relative change of the last step.
        change: f64,
        /// Steps taken.
        steps: usize,
        /// What it should be.
        expected: f64,
    },
    /// The linear vehicle cannot ride.
    #[error(transparent)]
    Ride(#[from] RideError),
    /// A damping makes no vehicle.
    #[error(transparent)]
    Vehicle(#[from] VehicleError),
}

/// A vehicle with the linear dampers that a road makes of its curves.
#[derive(Debug, Clone, PartialEq)]
pub struct Linearised {
    /// With the equivalent dampings in C.
    pub vehicle: Vehicle,
    /// rms of each damper's velocity, m/s, in the order of [`Vehicle::dampers`].
    pub velocity_m_s: Vec<f64>,
    /// c_eq of each, N·s/m.
    pub damping_n_s_per_m: Vec<f64>,
    /// Of the fixed-point iteration.
    pub steps: usize,
}

/// The equivalent linear damping c_eq = E\[F v\]/E\[v²\] of every damper with a curve, under the Gaussian velocity that the
/// linear ride at c_eq gives: a fixed point, found by iterating from the file's linear damping to 1e-10.
///
/// Of all linear dampers c_eq leaves the least mean square of the force. The velocity of a car with curves is not
/// Gaussian, and that is the method's error; see docs/interface.md for what was measured.
///
/// # Errors
/// A vehicle without curves, a road on which velocities are infinite, an iteration that does not converge.
///
/// Source: Roberts and Spanos, *Random Vibration and Statistical Linearization* (1990), ch. 5.
pub fn linearise(vehicle: &Vehicle, road: &Road, speed_m_s: f64) -> Result<Linearised, LineariseError> {
    let dampers = vehicle.dampers();
    if dampers.is_empty() {
        return Err(LineariseError::NoCurve);
    }
    let velocities: Vec<Output> = dampers
        .iter()
        .map(|d| Output {
            name: d.name.clone(),
            base: d.name.clone(),
            unit: "m/s",
            q: [vec![], d.row.clone(), vec![]],
            r: [vec![], vec![], vec![]],
            u: vec![],
        })
        .collect();
    let velocities: Vec<&Output> = velocities.iter().collect();
    let mut damping_n_s_per_m: Vec<f64> = dampers.iter().map(|d| d.linear).collect();
    let mut change = f64::INFINITY;
    for steps in 1..=MAX_STEPS {
        let linear = vehicle.with_damping(&damping_n_s_per_m)?;
        let ride = Ride::new(&linear, road, speed_m_s)?;
        let mut velocity_m_s = Vec::with_capacity(dampers.len());
        for (variance, damper) in ride.variances(&velocities)?.into_iter().zip(dampers) {
            match variance {
                super::Variance::Finite(v) => velocity_m_s.push(v.max(0.0).sqrt()),
                super::Variance::Infinite(why) => {
                    return Err(LineariseError::Infinite { damper: damper.name.clone(), why });
                }
            }
        }
        let next: Vec<f64> =
            dampers.iter().zip(&velocity_m_s).map(|(d, sigma)| d.curve.equivalent(*sigma)).collect();
        change = next
            .iter()
            .zip(&damping_n_s_per_m)
            .map(|(a, b)| (a - b).abs() / a.abs().max(f64::MIN_POSITIVE))
            .fold(0.0, f64::max);
        damping_n_s_per_m = next;
        if change <= FIXED_POINT_TOLERANCE {
            let vehicle = vehicle.with_damping(&damping_n_s_per_m)?;
            return Ok(Linearised { vehicle, velocity_m_s, damping_n_s_per_m, steps });
        }
    }
    Err(LineariseError::NotConverged { change, steps: MAX_STEPS, expected: FIXED_POINT_TOLERANCE })
}
