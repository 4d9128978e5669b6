//! Proposition 4.3.13: what acceleration and travel together do, done by travel alone.

use super::{AchievableError, Measurement, QuarterCar, Response, Youla};
use crate::lti::{Polynomial, Rational, RationalFunction, to_f64};
use num_traits::{One, Zero};

/// Halvings of the lag's time constant before giving up.
const MOST_HALVINGS: usize = 60;

/// A controller of the travel alone, near one of acceleration and travel; or why there is none.
#[derive(Debug, Clone, PartialEq)]
pub enum ByTravelAlone {
    /// q̃(∞) = 0: the same responses exactly, Q̂ = −q̃(c_s s + k_s)/m_s.
    Exact {
        /// Q̂.
        q_hat: RationalFunction,
        /// K, from y₂.
        controller: RationalFunction,
    },
    /// c_t = 0: as near as wanted, Q̂ = −q̃(c_s s + k_s)/(m_s(1 + τ s)).
    Near {
        /// Q̂.
        q_hat: RationalFunction,
        /// K, from y₂.
        controller: RationalFunction,
        /// τ, s.
        tau_s: f64,
        /// sup |H̄ₖ(jω) − Hₖ(jω)| for k = 1, 2, 3.
        differences: [f64; 3],
    },
    /// c_t > 0 and q̃(∞) ≠ 0: H₁ differs at infinity by c_s c_t q̃(∞)/(m_s²m_u), whatever the controller.
    Impossible {
        /// |H₁(∞) − H̄₁(∞)|, m/s² per m.
        gap: f64,
    },
}

/// A controller of y₂ alone whose three responses are within `epsilon` of those of a controller of [y₁ y₂] with the
/// parameter `q` (q̃ of (4.36)), at all frequencies.
///
/// By (4.41) the differences are G₁₂·s²(c_t s + k_t)/Δ·(m_s Q̂ + q̃(c_s s + k_s)) up to sign.
///
/// # Errors
/// A car that is not stable or has no suspension damper's spring; a q that is not in RH∞; an `epsilon` that is not
/// positive.
///
/// Source: Türkay's thesis, (4.41) and proposition 4.3.13.
pub fn by_travel_alone(
    car: &QuarterCar,
    q: &RationalFunction,
    epsilon: f64,
) -> Result<ByTravelAlone, AchievableError> {
    if !(epsilon > 0.0 && epsilon.is_finite()) {
        let (field, expected) = ("epsilon", "a positive, finite number");
        return Err(AchievableError::Number { field, expected, found: epsilon });
    }
    if !q.is_stable() {
        return Err(AchievableError::NotStable { what: "q", found: q.to_string() });
    }
    let both = Youla::new(car, &[Measurement::Acceleration, Measurement::Travel])?;
    if both.leading() != 0 {
        return Err(AchievableError::NotHurwitz { delta: car.delta().to_string() });
    }
    let alone = Youla::new(car, &[Measurement::Travel])?;
    // the wanted Q̂, improper by one degree where q̃(∞) ≠ 0 and c_s > 0
    let wanted = -&(&RationalFunction::polynomial(car.suspension()) * q).scaled(&car.ms.recip());
    if wanted.is_proper() {
        let controller = only(alone.controller(&wanted, &[])?);
        return Ok(ByTravelAlone::Exact { q_hat: wanted, controller });
    }
    if !car.ct.is_zero() {
        let at_infinity = to_f64(&q.at_infinity(1)?.pop().unwrap_or_else(Rational::zero));
        let gap = to_f64(&(&car.cs * &car.ct / (&car.ms * &car.ms * &car.mu))) * at_infinity.abs();
        return Ok(ByTravelAlone::Impossible { gap });
    }
    let mut tau = Rational::one();
    for _ in 0..MOST_HALVINGS {
        tau /= Rational::from_integer(2.into());
        let lag = RationalFunction::new(Polynomial::one(), Polynomial::new(&[Rational::one(), tau.clone()]))?;
        let q_hat = &wanted * &lag;
        let mut differences = [0.0; 3];
        for (difference, response) in differences.iter_mut().zip(Response::ALL) {
            let exact = &alone.response(response, &q_hat) - &both.response(response, q);
            *difference = if exact.is_zero() { 0.0 } else { exact.state_space()?.hinf_norm()?.norm };
        }
        if differences.iter().all(|d| *d < epsilon) {
            let controller = only(alone.controller(&q_hat, &[])?);
            return Ok(ByTravelAlone::Near { q_hat, controller, tau_s: to_f64(&tau), differences });
        }
    }
    Err(AchievableError::Number {
        field: "epsilon",
        expected: "a number that floating point resolves",
        found: epsilon,
    })
}

pub(super) fn only(mut controller: Vec<RationalFunction>) -> RationalFunction {
    controller.pop().unwrap_or_else(RationalFunction::zero)
}
