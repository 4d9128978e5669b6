//! The actuator over frequency and tire damping: figures 4.11 and 4.12 as data.

use super::super::{AchievableError, Measurement, QuarterCar};
use super::{Copied, HybridSettings, check_stable, controller_of, log_spaced, lqg_of_travel, rms_of};
use crate::lti::{RationalFunction, decimal};

/// Magnitudes over frequency, on tires of several dampings.
#[derive(Debug, Clone, PartialEq)]
pub struct HybridCurve {
    /// Hz.
    pub freq_hz: Vec<f64>,
    /// The LQG design on the fictitious tire.
    pub copied: Actuator,
    /// One a tire damping.
    pub at: Vec<HybridAt>,
}

/// What an actuator does over frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct Actuator {
    /// |K(jω)|, N/m.
    pub gain: Vec<f64>,
    /// |T_{uV}(jω)| from the road's velocity, N s/m.
    pub force: Vec<f64>,
    /// rms of acceleration, travel, tire deflection.
    pub rms: [f64; 3],
}

/// One tire damping.
#[derive(Debug, Clone, PartialEq)]
pub struct HybridAt {
    /// c_t, N s/m.
    pub tire_damping: f64,
    /// LQG designed for this tire.
    pub lqg: Actuator,
    /// The hybrid design on this tire.
    pub hybrid: Actuator,
}

/// LQG and hybrid designs for each of `tire_dampings` (N s/m): the thesis has 101 between 0.001 c_s and 0.1 c_s.
///
/// `over_hz` is first and last frequency and their number, evenly in the logarithm.
///
/// # Errors
/// As [`super::hybrid`]; a tire damping that is not positive; a hybrid loop that is not stable.
pub fn hybrid_over_tire_damping(
    car: &QuarterCar,
    settings: &HybridSettings,
    tire_dampings: &[f64],
    over_hz: (f64, f64, usize),
) -> Result<HybridCurve, AchievableError> {
    let (from, to, _) = over_hz;
    if !(from > 0.0 && to > from && to.is_finite()) {
        let (field, expected) = ("over_hz", "two ascending, positive frequencies");
        return Err(AchievableError::Number { field, expected, found: from });
    }
    let omegas = log_spaced(over_hz);
    let copied = Copied::new(car, settings)?;
    let fictitious = car.with_tire_damping(copied.tire_damping.clone())?;
    let curve_of = |car: &QuarterCar, k: &RationalFunction| actuator(car, k, settings, &omegas);
    let copied_curve = curve_of(&fictitious, &copied.controller)?;
    let mut at = Vec::with_capacity(tire_dampings.len());
    for found in tire_dampings {
        if !(*found > 0.0 && found.is_finite()) {
            let (field, expected) = ("tire damping", "a positive, finite number");
            return Err(AchievableError::Number { field, expected, found: *found });
        }
        let own = car.with_tire_damping(decimal(*found)?)?;
        let target = &copied.responses[0] * &settings.psi.function(&copied.sigma_on(&own))?;
        let controller = controller_of(&own, &target)?;
        check_stable(&own, &controller)?;
        at.push(HybridAt {
            tire_damping: *found,
            lqg: curve_of(&own, &lqg_of_travel(&own, settings.sensor_noise)?)?,
            hybrid: curve_of(&own, &controller)?,
        });
    }
    let freq_hz = omegas.iter().map(|w| w / std::f64::consts::TAU).collect();
    Ok(HybridCurve { freq_hz, copied: copied_curve, at })
}

fn actuator(
    car: &QuarterCar,
    controller: &RationalFunction,
    settings: &HybridSettings,
    omegas: &[f64],
) -> Result<Actuator, AchievableError> {
    let (g22, g21) = (car.force_to(Measurement::Travel), car.road_to(Measurement::Travel));
    let (mut gain, mut force) = (Vec::new(), Vec::new());
    for omega in omegas {
        let (k, p, d) =
            (controller.at_frequency(*omega)?, g22.at_frequency(*omega)?, g21.at_frequency(*omega)?);
        gain.push(k.norm());
        force.push((k / (1.0 - p * k) * d).norm() / omega);
    }
    Ok(Actuator { gain, force, rms: rms_of(car, controller, settings)? })
}
