//! Measures of roads and rides that standards and engineers' usage define.

mod actuator;
mod crossing;
mod iri;
mod settling;
mod weighting;

pub use actuator::ActuatorPower;
pub use crossing::{ExceedanceRate, exceedance};
pub use settling::{SETTLING_BAND, settling_time};
pub use weighting::{REACTIONS, Weighting, reactions};

pub use iri::{COARSE_STEP_M, GoldenCar, Iri, IriSegment, IriSettings, MOVING_AVERAGE_M, iri};

use crate::linalg::LinalgError;
use thiserror::Error;

/// What is refused of a measure.
#[derive(Debug, Error)]
pub enum MetricsError {
    /// An input that can't be.
    #[error("{field}: expected {expected}, found {found}")]
    Field {
        /// Which.
        field: &'static str,
        /// What it should be.
        expected: String,
        /// What it is.
        found: String,
    },
    /// Linear algebra that failed.
    #[error(transparent)]
    Linalg(#[from] LinalgError),
}
