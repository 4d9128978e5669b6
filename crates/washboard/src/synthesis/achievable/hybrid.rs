//! The hybrid design of §4.4: an LQG design for a tire of more damping, its acceleration reproduced on the real tire by
//! interpolation; with what that hides.

mod curve;
mod psi;
mod warnings;

pub use curve::{HybridAt, HybridCurve, hybrid_over_tire_damping};
pub use psi::Psi;

use self::warnings::{sensitivity, warnings};
use super::approximate::only;
use super::closed::{certificate, h2_norms, responses};
use super::hidden::characteristic;
use super::{
    AchievableError, HiddenMode, Measurement, NotAchievable, QuarterCar, Response, Youla, hidden_modes,
};
use crate::linalg::C64;
use crate::lti::{Continuous, Rational, RationalFunction, StateSpace, decimal};
use crate::synthesis::{Certificate, LqgWeights, lqg};

/// Where the match of H₁ is measured, Hz: 121 points, evenly in the logarithm.
const MATCHED_OVER_HZ: (f64, f64, usize) = (0.01, 1e4, 121);
/// What the design is to be.
#[derive(Debug, Clone, PartialEq)]
pub struct HybridSettings {
    /// Damping of the fictitious tire that the LQG controller is designed for, N s/m.
    pub fictitious_tire_damping: f64,
    /// Ψ.
    pub psi: Psi,
    /// Intensity of white noise on the travel, for the LQG designs.
    pub sensor_noise: f64,
    /// Intensity of the road's velocity, m²/s: for rms values.
    pub road_velocity_intensity: f64,
}

/// A hybrid design and what it does.
#[derive(Debug, Clone)]
pub struct Hybrid {
    /// Why H₁ of the fictitious tire can't be had exactly: item (i) of §4.4; none on the same tire damping.
    pub exact_match: Option<NotAchievable>,
    /// H₁ of the LQG design on the fictitious tire, times Ψ: from the road's height.
    pub target: RationalFunction,
    /// Q̂ of (4.53).
    pub q_hat: RationalFunction,
    /// K in lowest terms: u = +K y₂.
    pub controller: RationalFunction,
    /// K in state space.
    pub system: StateSpace<Continuous>,
    /// H₁, H₂, H₃ from the road's height, exactly.
    pub responses: [RationalFunction; 3],
    /// max |T_{z₁V} − target/s|/max |target/s|, T by the plant and K in floating point.
    pub match_error: f64,
    /// The closed loop by itself.
    pub certificate: Certificate,
    /// rms of z₁, z₂, z₃: passive, LQG on the real tire, LQG on the fictitious one, hybrid; exact but for rounding once.
    pub rms: HybridRms,
    /// |H₃(jω₂)| over that of the design copied: c_t(fictitious)/c_t by (4.30), as far as Ψ(jω₂) is 1.
    pub tire_factor_at_wheel_hop: f64,
    /// Modes that some response hides.
    pub hidden: Vec<HiddenMode>,
    /// What a user has to know, in words.
    pub warnings: Vec<String>,
}

/// rms values of acceleration (m/s²), travel (m) and tire deflection (m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HybridRms {
    /// Without control.
    pub passive: [f64; 3],
    /// LQG on the real tire.
    pub lqg: [f64; 3],
    /// LQG on the fictitious tire: what is copied.
    pub copied: [f64; 3],
    /// Hybrid, on the real tire.
    pub hybrid: [f64; 3],
}

/// The hybrid design on a car with tire damping: Ψ H₁ of the LQG design for a fictitious tire, interpolated on the real one.
///
/// By (4.30) an H₁ that is the same on a tire of c_t/α damping multiplies H₃ at ω₂ by about α: the wheel's own mode
/// m_u s² + c_t s + k_t is cancelled in H₁ and stays in H₂ and H₃. That is computed, and said in `warnings`.
///
/// The LQG weights are 1/passive rms at the same tire damping (4.51); K of LQG is taken with its transfer function's
/// coefficients rounded to floating point, and everything after is exact.
///
/// # Errors
/// A car without tire damping or not stable; settings out of range; what LQG refuses.
///
/// Source: Türkay's thesis, §4.4, (4.52)–(4.53), figures 4.10–4.12.
pub fn hybrid(
    car: &QuarterCar,
    settings: &HybridSettings,
) -> Result<Result<Hybrid, NotAchievable>, AchievableError> {
    let copied = Copied::new(car, settings)?;
    let own = lqg_of_travel(car, settings.sensor_noise)?;
    let lqg_rms = rms_of(car, &own, settings)?;
    let constraints = Youla::new(car, &[Measurement::Travel])?.constraints(Response::Acceleration)?;
    let exact_match = constraints.check(&copied.responses[0])?.err();
    let target = &copied.responses[0] * &settings.psi.function(&copied.sigma_on(car))?;
    let proof = match constraints.check(&target)? {
        Ok(proof) => proof,
        Err(why) => return Ok(Err(why)),
    };
    let (controller, q_hat) = (only(proof.controller), only(proof.q_hat));
    let system = controller.state_space()?;
    let plant = car.plant(&[Measurement::Travel])?;
    let certificate = certificate(&plant, &system)?;
    let closed = plant.close(&system)?;
    let (mut error, mut size) = (0.0f64, 0.0f64);
    for omega in log_spaced(MATCHED_OVER_HZ) {
        let s = C64::new(0.0, omega);
        let wanted = target.at_frequency(omega)? / s;
        error = error.max((closed.at(s)?[(0, 0)] - wanted).norm());
        size = size.max(wanted.norm());
    }
    let youla = Youla::new(car, &[Measurement::Travel])?;
    let hidden = hidden_modes(&youla, &controller, &proof.responses)?;
    let hop = car.invariant_omegas_rad_s().1;
    let at_hop = |h: &RationalFunction| -> Result<f64, AchievableError> { Ok(h.at_frequency(hop)?.norm()) };
    let tire_factor_at_wheel_hop = at_hop(&proof.responses[2])? / at_hop(&copied.responses[2])?;
    let rms = HybridRms {
        passive: rms_of(car, &RationalFunction::zero(), settings)?,
        lqg: lqg_rms,
        copied: copied.rms,
        hybrid: rms_from(&proof.responses, settings)?,
    };
    let mut warnings = warnings(&hidden, &rms, tire_factor_at_wheel_hop, hop);
    warnings.extend(sensitivity(&rms, &certificate, settings));
    Ok(Ok(Hybrid {
        exact_match,
        target,
        q_hat,
        controller,
        system,
        responses: proof.responses,
        match_error: error / size,
        certificate,
        rms,
        tire_factor_at_wheel_hop,
        hidden,
        warnings,
    }))
}

/// The LQG design for the fictitious tire.
struct Copied {
    tire_damping: Rational,
    controller: RationalFunction,
    responses: [RationalFunction; 3],
    rms: [f64; 3],
}

impl Copied {
    fn new(car: &QuarterCar, settings: &HybridSettings) -> Result<Self, AchievableError> {
        for (field, found) in [
            ("fictitious tire damping", settings.fictitious_tire_damping),
            ("road velocity intensity", settings.road_velocity_intensity),
        ] {
            if !(found > 0.0 && found.is_finite()) {
                return Err(AchievableError::Number { field, expected: "a positive, finite number", found });
            }
        }
        let fictitious = car.with_tire_damping(decimal(settings.fictitious_tire_damping)?)?;
        let controller = lqg_of_travel(&fictitious, settings.sensor_noise)?;
        let youla = Youla::new(&fictitious, &[Measurement::Travel])?;
        // eq. (4.23) the other way round
        let (q_hat, _) = youla.q_of(std::slice::from_ref(&controller))?;
        let responses = Response::ALL.map(|r| youla.response(r, &q_hat));
        let rms = rms_of(&fictitious, &controller, settings)?;
        Ok(Copied { tire_damping: fictitious.ct, controller, responses, rms })
    }

    /// σ = α₁/α₂.
    fn sigma_on(&self, car: &QuarterCar) -> Rational {
        &car.ct / &self.tire_damping
    }
}

/// (4.51) with y₂ measured: weights 1/passive rms, no weight on the force, the rounded transfer function of K.
fn lqg_of_travel(car: &QuarterCar, sensor_noise: f64) -> Result<RationalFunction, AchievableError> {
    let plant = car.plant(&[Measurement::Travel])?;
    let passive = Certificate::passive(&plant)?;
    let weights: Vec<f64> = passive.channels.iter().map(|c| 1.0 / c.h2.unwrap_or(f64::INFINITY)).collect();
    let weights_of =
        LqgWeights { sensor_noise: vec![sensor_noise], input_weight: vec![0.0], ..LqgWeights::default() };
    let found = lqg(&plant.with_weights(&weights)?, &weights_of)?;
    let exact = RationalFunction::of_system(&found.controller)?;
    Ok(exact.into_iter().flatten().next().unwrap_or_else(RationalFunction::zero).rounded()?)
}

/// rms on the road, of a loop with a controller of the travel; exactly but for the last rounding.
fn rms_of(
    car: &QuarterCar,
    controller: &RationalFunction,
    settings: &HybridSettings,
) -> Result<[f64; 3], AchievableError> {
    rms_from(&responses(car, controller)?, settings)
}

fn rms_from(
    responses: &[RationalFunction; 3],
    settings: &HybridSettings,
) -> Result<[f64; 3], AchievableError> {
    let root = settings.road_velocity_intensity.sqrt();
    Ok(h2_norms(responses)?.map(|h| root * h))
}

/// Angular frequencies evenly in the logarithm.
pub(super) fn log_spaced((from_hz, to_hz, count): (f64, f64, usize)) -> Vec<f64> {
    let (low, high) = (from_hz.ln(), to_hz.ln());
    let step = (high - low) / (count.max(2) - 1) as f64;
    (0..count).map(|k| std::f64::consts::TAU * (low + k as f64 * step).exp()).collect()
}

/// K of an H₁ that is achievable, from the first of (4.1): u = −m_s z₁ − (c_s s + k_s) z₂, so
/// K = −(c_s s + k_s) − m_s H₁/H₂. No polynomial of Q̂'s size is formed.
fn controller_of(car: &QuarterCar, h1: &RationalFunction) -> Result<RationalFunction, AchievableError> {
    let h2 = car.travel_of_acceleration(h1)?;
    let share = h1.over(&h2)?.scaled(&car.ms);
    Ok(-&(&RationalFunction::polynomial(car.suspension()) + &share))
}

/// Refuses a loop that is not stable, by Routh's test.
fn check_stable(car: &QuarterCar, controller: &RationalFunction) -> Result<(), AchievableError> {
    let youla = Youla::new(car, &[Measurement::Travel])?;
    let poly = characteristic(&youla, Measurement::Travel, controller)?;
    if controller.is_proper() && poly.is_hurwitz() {
        return Ok(());
    }
    Err(AchievableError::NotStable { what: "the closed loop", found: poly.to_string() })
}
