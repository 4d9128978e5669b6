//! A controller near what no controller beats: the H2-optimal Q, made proper.

use super::approximate::only;
use super::closed::{certificate, h2_norms, responses};
use super::{AchievableError, Measurement, QuarterCar, Youla};
use crate::lti::{Continuous, Polynomial, RationalFunction, StateSpace, decimal};
use crate::synthesis::{Certificate, full_information, h2_limit};
use num_traits::One;

/// The cost in floating point has to be the exact one to this share.
const CONFIRMED: f64 = 1e-6;

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
    /// ‖Λ T_zV‖₂ recomputed from the four blocks of the plant and K, exactly but for the last rounding.
    pub h2: f64,
    /// What no controller is below: [`h2_limit`].
    pub limit: f64,
    /// The closed loop of the weighted performances in floating point, if that gives the same cost; else why not: for ε and
    /// τ so small that double precision does not hold the loop, the controller is of no use.
    pub certificate: Result<Certificate, AchievableError>,
}

/// The optimal Q of (5.17) with the travel measured, divided by the regularised factor of (5.10).
///
/// The infimum of ‖F + G₁₂ Q₀‖₂ is attained by Q₀ = F_x(sI − A − B₂F_x)⁻¹B₁, F_x the full-information gain; it is
/// Q₀ = Q̂ G₂₁ with G₂₁ = −m_s s(c_t s + k_t)/Δ from the road's velocity, which is zero at 0 and at infinity. So
///
/// Q̂ = −Q₀ Δ/(m_s(s + ε)(c_t s + k_t)(τ s + 1)ᵏ), K = Q̂(1 + G₂₂Q̂)⁻¹,
///
/// and Q̂G₂₁ → Q₀ as ε, τ → 0. The cost is recomputed exactly, and by [`Certificate`], which shares nothing with this.
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
    for (field, found) in [
        ("weight of the acceleration", weights[0]),
        ("weight of the travel", weights[1]),
        ("epsilon_rad_s", epsilon),
        ("tau_s", tau),
    ] {
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
    let driven =
        StateSpace::continuous(plant.a() + plant.b2() * &f, plant.b1(), f, crate::linalg::Mat::zeros(1, 1))?;
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
    let norms = h2_norms(&responses(car, &controller)?)?;
    let h2 = norms.iter().zip(weights).map(|(n, w)| (w * n).powi(2)).sum::<f64>().sqrt();
    let certificate = certificate(&plant, &system).and_then(|c| {
        c.confirm_h2(h2, CONFIRMED)?;
        Ok(c)
    });
    Ok(NearOptimal { q_hat, controller, system, h2, limit, certificate })
}
