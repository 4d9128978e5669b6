//! A controller near what no controller beats: the H2-optimal Q, made proper.

use super::approximate::only;
use super::{AchievableError, Measurement, QuarterCar, Youla};
use crate::lti::{Continuous, Polynomial, RationalFunction, StateSpace, decimal};
use crate::synthesis::{Certificate, full_information, h2_limit};
use num_traits::One;

/// How the factor that Q would be divided by is made invertible.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Regularisation {
    /// s becomes s + ε, rad/s.
    pub epsilon_rad_s: f64,
    /// A low-pass 1/(τ s + 1)ᵏ, s; k is 1 with tire damping and 2 without.
    pub tau_s: f64,
}

/// A controller, its cost and the bound.
#[derive(Debug, Clone)]
pub struct NearOptimal {
    /// Q̂.
    pub q_hat: RationalFunction,
    /// K: u = +K y₂.
    pub controller: RationalFunction,
    /// K in state space.
    pub system: StateSpace<Continuous>,
    /// ‖Λ T_zV‖₂ recomputed from plant and K.
    pub h2: f64,
    /// What no controller is below: [`h2_limit`].
    pub limit: f64,
    /// The whole closed loop, of the weighted performances.
    pub certificate: Certificate,
}

/// The optimal Q of (5.17) with the travel measured, divided by the regularised factor of (5.10).
///
/// The infimum of ‖F + G₁₂ Q₀‖₂ is attained by Q₀ = F_x(sI − A − B₂F_x)⁻¹B₁, F_x the full-information gain; it is
/// Q₀ = Q̂ G₂₁ with G₂₁ = −m_s s(c_t s + k_t)/Δ from the road's velocity, which is zero at 0 and at infinity. So
///
/// Q̂ = −Q₀ Δ/(m_s(s + ε)(c_t s + k_t)(τ s + 1)ᵏ), K = Q̂(1 + G₂₂Q̂)⁻¹,
///
/// and Q̂G₂₁ → Q₀ as ε, τ → 0. The cost is recomputed by [`Certificate`], which shares nothing with this.
///
/// # Errors
/// λ₁ or λ₂ that is not positive, λ₃ negative; ε or τ that is not positive; a car that is not stable.
///
/// Source: Türkay's thesis, (5.2)–(5.18).
pub fn near_optimal(
    car: &QuarterCar,
    weights: [f64; 3],
    regularisation: Regularisation,
) -> Result<NearOptimal, AchievableError> {
    let Regularisation { epsilon_rad_s: epsilon, tau_s: tau } = regularisation;
    for (field, found) in
        [("weight of the acceleration", weights[0]), ("weight of the travel", weights[1]), ("epsilon_rad_s", epsilon), ("tau_s", tau)]
    {
        if !(found > 0.0 && found.is_finite()) {
            return Err(AchievableError::Number { field, expected: "a positive, finite number", found });
        }
    }
    if !car.is_stable() {
        return Err(AchievableError::NotHurwitz { delta: car.delta().to_string() });
    }
    let plant = car.plant(&[Measurement::Travel])?.with_weights(&weights)?;
    let limit = h2_limit(&plant)?.h2;
    let (_, regulator) = full_information(&plant)?;
    let f = regulator.gain;
    let driven = StateSpace::continuous(
        plant.a() + plant.b2() * &f,
        plant.b1(),
        f,
        crate::linalg::Mat::zeros(1, 1),
    )?;
    let q0 = RationalFunction::of_system(&driven)?;
    let q0 = q0.into_iter().flatten().next().unwrap_or_else(RationalFunction::zero).rounded()?;
    let one = num_rational::Ratio::one;
    let lag = Polynomial::new(&[one(), decimal(tau)?]);
    let rolled = if car.tire_damping().numer() == &0.into() { &lag * &lag } else { lag };
    let below = &(&Polynomial::new(&[decimal(epsilon)?, one()]) * &car.tire()) * &rolled;
    let divided = RationalFunction::new(-&car.delta(), below.scaled(&car.ms))?;
    let q_hat = &q0 * &divided;
    let controller = only(Youla::new(car, &[Measurement::Travel])?.controller(&q_hat, &[])?);
    let system = controller.state_space()?;
    let certificate = Certificate::of(&plant, &system)?;
    let h2 = certificate.h2.unwrap_or(f64::INFINITY);
    Ok(NearOptimal { q_hat, controller, system, h2, limit, certificate })
}
