//! Signals: what is computed from recorded channels before any model of a vehicle.

mod correlation;

pub use correlation::{CorrelationError, Correlations, correlations};
