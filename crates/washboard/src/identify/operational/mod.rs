//! Operational modal analysis: what the classical estimators share. Poles of all orders with the reason of each that is
//! not stable, clusters that are modes, shapes and their criteria, standard deviations by leaving out blocks.

mod clusters;
mod deviations;
mod record;
mod settings;
mod shape;
mod stabilization;

pub use clusters::{Mode, Reason, Rejected};
pub use settings::StabilitySettings;
pub use shape::{
    ShapeComponent, mean_phase_deg, mean_phase_deviation_deg, modal_assurance, phase_collinearity,
};
pub use stabilization::{Pole, PoleStatus, StabilizationDiagram};

pub(super) use clusters::{Cluster, modes};
pub(super) use deviations::{Resampling, Start, deviations, jackknife};
pub(super) use record::{Record, normalise};
pub(super) use settings::require;
pub(super) use shape::largest_one;
pub(super) use stabilization::{ModelPole, OrderModel, diagram, nearest_pole};

use crate::linalg::LinalgError;
use crate::signal::CorrelationError;
use thiserror::Error;

/// What the estimators of operational modal analysis refuse.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum OperationalError {
    /// A setting that has no meaning, or not for these channels.
    #[error("{field}: expected {expected}, found {found}")]
    Setting {
        /// Which field.
        field: &'static str,
        /// What it must be.
        expected: String,
        /// What it is.
        found: f64,
    },
    /// A channel does not move: it has nothing to learn from.
    #[error("channel {channel} is constant ({value})")]
    Constant {
        /// Which channel.
        channel: usize,
        /// Its value.
        value: f64,
    },
    /// The channels can't be correlated.
    #[error(transparent)]
    Correlation(#[from] CorrelationError),
    /// A factorisation failed.
    #[error(transparent)]
    Linalg(#[from] LinalgError),
}
