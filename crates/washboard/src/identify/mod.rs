//! Identification: from responses alone to modes and the road, with the reason of everything that is left out.

mod fdd;
mod harmonics;
pub mod interaction;
mod likelihood;
pub mod operational;
mod physical;
mod plscf;
mod ssi;
mod tvimm;

pub use fdd::{FddMode, FddOutcome, FddSettings, fdd};
pub use harmonics::{Family, Line, LineError, LineSettings, spectral_lines};
pub use likelihood::{CHI_LIMIT, Estimate, FitError, Reason as FitReason};
pub use operational::{
    Mode, OperationalError, Pole, PoleStatus, Reason, Rejected, ShapeComponent, StabilitySettings,
    StabilizationDiagram,
};
pub use physical::{
    ANNEALING_FAR, ANNEALING_NEAR, ANNEALING_NONE, ClockEstimate, DriveOutcome, PhysicalDrive,
    PhysicalOutcome, PhysicalSettings, RoadStart, fit_physical,
};
pub use plscf::{
    Constraint, HalfSpectra, PlscfOutcome, PlscfSettings, Spectrum as PlscfSpectrum, plscf, plscf_poles,
};
pub use ssi::{SsiOutcome, SsiSettings, ssi_cov};
pub use tvimm::{
    FreeDrive, FreeOrder, FreeOutcome, FreeStart, FreeTrial, NoDataStart, data_start, fit_free_modes,
};
