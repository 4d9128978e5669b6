//! Why an item cannot be computed.

use crate::cases::CaseError;
use crate::linalg::LinalgError;
use crate::lti::{LtiError, MechanicsError, RationalError};
use crate::road::RoadError;
use crate::subspace::SubspaceError;
use crate::synthesis::SynthesisError;
use crate::synthesis::achievable::AchievableError;
use crate::vehicle::{BumpError, PlantError, RideError, VehicleError};
use thiserror::Error;

/// What stands in the way of an item.
#[derive(Debug, Error)]
pub enum ReproduceError {
    /// A published vehicle or road.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// The quarter car in exact polynomials.
    #[error(transparent)]
    Achievable(#[from] AchievableError),
    /// A design.
    #[error(transparent)]
    Synthesis(#[from] SynthesisError),
    /// A fit or an interpolation.
    #[error(transparent)]
    Subspace(#[from] SubspaceError),
    /// An exact fraction.
    #[error(transparent)]
    Rational(#[from] RationalError),
    /// A system.
    #[error(transparent)]
    Lti(#[from] LtiError),
    /// A matrix.
    #[error(transparent)]
    Linalg(#[from] LinalgError),
    /// A vehicle.
    #[error(transparent)]
    Vehicle(#[from] VehicleError),
    /// Its modes.
    #[error(transparent)]
    Mechanics(#[from] MechanicsError),
    /// A vehicle with its actuators.
    #[error(transparent)]
    Plant(#[from] PlantError),
    /// A ride.
    #[error(transparent)]
    Ride(#[from] RideError),
    /// A bump.
    #[error(transparent)]
    Bump(#[from] BumpError),
    /// A road.
    #[error(transparent)]
    Road(#[from] RoadError),
    /// A step that gave something else than the source presumes.
    #[error("{what}: expected {expected}, found {found}")]
    Unexpected {
        /// Which step.
        what: &'static str,
        /// What the source presumes.
        expected: &'static str,
        /// What came.
        found: String,
    },
}

impl ReproduceError {
    /// A step that gave something else than the source presumes.
    pub(super) fn unexpected(
        what: &'static str,
        expected: &'static str,
        found: impl std::fmt::Debug,
    ) -> Self {
        ReproduceError::Unexpected { what, expected, found: format!("{found:?}") }
    }
}
