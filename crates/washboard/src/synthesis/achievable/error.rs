//! What is refused of quarter cars and of what is asked of them.

use crate::lti::{LtiError, RationalError};
use crate::synthesis::SynthesisError;
use thiserror::Error;

/// A wrong call, or an assumption that a car and its measurements break.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum AchievableError {
    /// A number outside what it may be.
    #[error("{field}: expected {expected}, found {found}")]
    Number {
        /// Which one.
        field: &'static str,
        /// What was expected.
        expected: &'static str,
        /// What was found.
        found: f64,
    },
    /// No measurement, or one twice.
    #[error("measurements: expected at least one, each once, found {found}")]
    Measurements {
        /// Their names.
        found: String,
    },
    /// A measurement whose response to the road is not finite at high frequencies.
    #[error(
        "`{measurement}` is not proper: with tire damping it has the derivative of the road's velocity in it"
    )]
    ImproperMeasurement {
        /// Its name.
        measurement: &'static str,
    },
    /// The measurement does not see a mode that is not stable: no controller of it stabilises the car.
    #[error(
        "`{measurement}` can not parametrise the stabilising controllers: it does not see the modes at {omega_rad_s:?} rad/s, which are not stable"
    )]
    NotParametrisable {
        /// Its name.
        measurement: &'static str,
        /// |λ| of the modes that it does not see.
        omega_rad_s: Vec<f64>,
    },
    /// Several measurements of a car that is not stable.
    #[error(
        "the car is not stable by itself (its characteristic polynomial {delta} is not Hurwitz): give it damping and a spring, or use one measurement"
    )]
    NotHurwitz {
        /// Δ.
        delta: String,
    },
    /// No single measurement reaches all that the measurements reach together.
    #[error(
        "no single one of {found} reaches all that they reach together, which this parametrisation needs; leave one out"
    )]
    NoLeadingMeasurement {
        /// Their names.
        found: String,
    },
    /// Zeros in the closed right half plane elsewhere than where constraints are known.
    #[error(
        "the controls' reach has zeros in the closed right half plane besides 0, ω₁, ω₂ and infinity: {factor}"
    )]
    OtherZeros {
        /// The factor that has them.
        factor: String,
    },
    /// A function that has to be in RH∞.
    #[error("{what} has to be stable and proper; found {found}")]
    NotStable {
        /// Which one.
        what: &'static str,
        /// The function.
        found: String,
    },
    /// 1 + G₂₂Q is zero at infinity: K would not be proper.
    #[error("the controller would not be proper: 1 + G22 Q is 0 at infinity")]
    ImproperController,
    /// A wrong number of functions.
    #[error("{what}: expected {expected}, found {found}")]
    Count {
        /// Of what.
        what: &'static str,
        /// How many.
        expected: usize,
        /// How many were given.
        found: usize,
    },
    /// Exact arithmetic refused.
    #[error(transparent)]
    Rational(#[from] RationalError),
    /// A synthesis refused.
    #[error(transparent)]
    Synthesis(#[from] SynthesisError),
}

impl From<LtiError> for AchievableError {
    fn from(e: LtiError) -> Self {
        AchievableError::Synthesis(e.into())
    }
}
