//! A closed loop measured: exactly, and in floating point from the plant and K alone.

use super::{AchievableError, Measurement, QuarterCar, Response};
use crate::lti::{Continuous, GeneralizedPlant, Polynomial, RationalFunction, Signals, StateSpace};
use crate::synthesis::Certificate;

/// The certificate of the plant closed by u = +K y.
///
/// K has poles of 10⁻² and of 10⁵ rad/s and states of its own units: the closed loop's states are balanced first, or its
/// slowest poles are lost in the rounding of the fastest.
pub(super) fn certificate(
    plant: &GeneralizedPlant,
    controller: &StateSpace<Continuous>,
) -> Result<Certificate, AchievableError> {
    let closed = plant.close(controller)?.balanced_scales()?.0;
    let signals = Signals { controls: Vec::new(), measurements: Vec::new(), ..plant.signals().clone() };
    Ok(Certificate::passive(&GeneralizedPlant::new(closed, signals)?)?)
}

/// T_zw of u = K y₂ from the four blocks: G₁₁ + G₁₂K(1 − G₂₂K)⁻¹G₂₁, exactly.
pub(super) fn responses(
    car: &QuarterCar,
    controller: &RationalFunction,
) -> Result<[RationalFunction; 3], AchievableError> {
    let (g21, g22) = (car.road_to(Measurement::Travel), car.force_to(Measurement::Travel));
    let force = &controller.over(&(&RationalFunction::one() - &(&g22 * controller)))? * &g21;
    Ok(Response::ALL.map(|r| &car.passive(r) + &(&car.forced(r) * &force)))
}

/// ‖T_{zₖV}‖₂ from the road's velocity, of responses from its height, exactly but for the last rounding.
pub(super) fn h2_norms(responses: &[RationalFunction; 3]) -> Result<[f64; 3], AchievableError> {
    let over_s = RationalFunction::new(Polynomial::one(), Polynomial::power_of_s(1))?;
    let mut norms = [0.0; 3];
    for (norm, h) in norms.iter_mut().zip(responses) {
        *norm = (h * &over_s).h2_norm()?;
    }
    Ok(norms)
}
