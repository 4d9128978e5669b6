//! Identification: from responses alone to modes and the road, with the reason of everything that is left out.

mod harmonics;
pub mod interaction;
mod physical;
mod ssi;

pub use harmonics::{Family, Line, LineError, LineSettings, spectral_lines};
pub use physical::{CHI_LIMIT, Estimate, PhysicalError, PhysicalOutcome, PhysicalSettings, fit_physical};
pub use ssi::{
    Mode, Pole, PoleStatus, Reason, Rejected, ShapeComponent, SsiError, SsiOutcome, SsiSettings,
    StabilizationDiagram, ssi_cov,
};
