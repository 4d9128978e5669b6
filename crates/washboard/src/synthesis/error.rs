//! Why there is no controller.

use super::BrokenAssumption;
use crate::linalg::{LinalgError, RiccatiError};
use crate::lti::LtiError;
use thiserror::Error;

/// What a synthesis refuses.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum SynthesisError {
    /// Systems that do not fit or are not what they must be.
    #[error(transparent)]
    Lti(#[from] LtiError),
    /// Linear algebra refused.
    #[error(transparent)]
    Linalg(#[from] LinalgError),
    /// A Riccati equation without the solution that is needed.
    #[error("the {equation} equation: {source}")]
    Riccati {
        /// `control` or `filter`.
        equation: &'static str,
        /// Why.
        source: RiccatiError,
    },
    /// A semidefinite program that is none.
    #[error(transparent)]
    Sdp(#[from] crate::optimize::SdpError),
    /// Assumptions of the method that the plant breaks, the gravest first.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "))]
    Assumptions(Vec<BrokenAssumption>),
    /// No controller meets any level that was tried.
    #[error("no controller with an H∞ norm below {level:e} was found: {why}")]
    NoLevel {
        /// The highest level tried.
        level: f64,
        /// Why it failed.
        why: String,
    },
    /// A quarter car and measurements that have no such design.
    #[error(transparent)]
    Achievable(Box<super::achievable::AchievableError>),
    /// A response that no controller reaches.
    #[error("not achievable: {0}")]
    NotAchievable(String),
    /// The closed loop is not what the method claims.
    #[error("the design is refused: {what} is claimed to be {claimed:e} and recomputed as {found:e}")]
    Refused {
        /// Which number.
        what: &'static str,
        /// Claimed by the synthesis.
        claimed: f64,
        /// Recomputed from plant and controller.
        found: f64,
    },
}
