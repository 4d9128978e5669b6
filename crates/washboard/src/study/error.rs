//! What a job refuses: the message names the file or the field, what was expected and what was found.

use super::design_words::short_numbers;
use crate::cases::CaseError;
use crate::files::FileError;
use crate::metrics::MetricsError;
use crate::road::RoadError;
use crate::signal::SignalError;
use crate::subspace::SubspaceError;
use crate::synthesis::SynthesisError;
use crate::vehicle::{
    BumpError, ControlError, LineariseError, PlantError, RideError, SimulateError, VehicleError,
};
use thiserror::Error;

/// What is refused of a job.
#[derive(Debug, Error)]
pub enum StudyError {
    /// A file cannot be read or written, or is not what it should be.
    #[error(transparent)]
    File(#[from] FileError),
    /// A `case:NAME` that is none.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// A vehicle that cannot be built, or has not what is asked of it.
    #[error("{name}: {source}")]
    Vehicle {
        /// Its file or `case:NAME`.
        name: String,
        /// Why.
        source: VehicleError,
    },
    /// A ride that has no answer.
    #[error("{name}: {source}")]
    Ride {
        /// The vehicle's file or `case:NAME`.
        name: String,
        /// Why.
        source: RideError,
    },
    /// Dampers that have no linear equivalent on a road.
    #[error("{name}: {source}")]
    Linearise {
        /// The vehicle's file or `case:NAME`, and the road's.
        name: String,
        /// Why.
        source: LineariseError,
    },
    /// A vehicle that is no plant on this road, with these outputs.
    #[error("{name}: {source}")]
    Plant {
        /// The vehicle's file or `case:NAME`.
        name: String,
        /// Why.
        source: Box<PlantError>,
    },
    /// A design that cannot be computed.
    #[error("{name}: {}", short_numbers(&source.to_string()))]
    Design {
        /// The vehicle's file or `case:NAME`.
        name: String,
        /// Why.
        source: Box<SynthesisError>,
    },
    /// Data that nothing interpolates.
    #[error("{name}: {source}")]
    Interpolation {
        /// Their file.
        name: String,
        /// Why.
        source: Box<SubspaceError>,
    },
    /// A bump that has no response.
    #[error("{name}: {source}")]
    Bump {
        /// The vehicle's file or `case:NAME`.
        name: String,
        /// Why.
        source: Box<BumpError>,
    },
    /// A controller that cannot be used.
    #[error("{name}: {source}")]
    Controller {
        /// Its file.
        name: String,
        /// Why.
        source: Box<ControlError>,
    },
    /// A road that cannot be what is asked.
    #[error("{name}: {source}")]
    Road {
        /// Its file or `case:NAME`.
        name: String,
        /// Why.
        source: RoadError,
    },
    /// A profile that has no measure.
    #[error("{name}: {source}")]
    Measure {
        /// Its file.
        name: String,
        /// Why.
        source: MetricsError,
    },
    /// Samples that have no rational model.
    #[error("{name}: {source}")]
    Shape {
        /// Their file or `case:NAME`.
        name: String,
        /// Why.
        source: Box<SubspaceError>,
    },
    /// A published item that cannot be computed.
    #[error("{item}: {source}")]
    Reproduce {
        /// Its name.
        item: String,
        /// Why.
        source: Box<super::ReproduceError>,
    },
    /// A drive that cannot be simulated.
    #[error(transparent)]
    Simulate(#[from] SimulateError),
    /// A recording that is not what its description says, or too short for what is asked.
    #[error(transparent)]
    Signal(#[from] SignalError),
    /// A setting has a value that it cannot have.
    #[error("{field}: expected {expected}, found {found}")]
    Setting {
        /// Which.
        field: &'static str,
        /// What it should be.
        expected: String,
        /// What it is.
        found: String,
    },
}

impl StudyError {
    /// Whether other input would help (true), or the computation itself failed.
    #[must_use]
    pub fn is_wrong_input(&self) -> bool {
        let numerical = |e: &RideError| matches!(e, RideError::Quadrature { .. } | RideError::Linalg(_));
        match self {
            StudyError::Ride { source, .. } | StudyError::Simulate(SimulateError::Ride(source)) => {
                !numerical(source)
            }
            StudyError::Linearise { source: LineariseError::Ride(source), .. } => !numerical(source),
            StudyError::Linearise { source: LineariseError::NotConverged { .. }, .. } => false,
            StudyError::Simulate(SimulateError::Steps { .. }) | StudyError::Reproduce { .. } => false,
            StudyError::Measure { source: MetricsError::Linalg(_), .. } => false,
            StudyError::Shape { source, .. } => !matches!(
                **source,
                SubspaceError::Linalg(_)
                    | SubspaceError::Lti(_)
                    | SubspaceError::NoSplit { .. }
                    | SubspaceError::NoFactor(_)
                    | SubspaceError::NotPositive { .. }
                    | SubspaceError::Unverified { .. }
            ),
            StudyError::Interpolation { source, .. } => super::interpolation::is_wrong_input(source),
            _ => true,
        }
    }
}
