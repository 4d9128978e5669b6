//! Identification: from responses alone to modes and the road, with the reason of everything that is left out.

mod harmonics;
pub mod interaction;
mod likelihood;
mod physical;
mod ssi;
mod tvimm;

pub use harmonics::{Family, Line, LineError, LineSettings, spectral_lines};
pub use likelihood::{CHI_LIMIT, Estimate, FitError, Reason as FitReason};
pub use physical::{
    ANNEALING_FAR, ANNEALING_NEAR, ANNEALING_NONE, ClockEstimate, DriveOutcome, PhysicalDrive,
    PhysicalOutcome, PhysicalSettings, RoadStart, fit_physical,
};
pub use ssi::{
    Mode, Pole, PoleStatus, Reason, Rejected, ShapeComponent, SsiError, SsiOutcome, SsiSettings,
    StabilizationDiagram, ssi_cov,
};
pub use tvimm::{FreeDrive, FreeOrder, FreeOutcome, FreeStart, FreeTrial, fit_free_modes};
