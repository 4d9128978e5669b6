//! Identification: from responses alone to modes and the road, with the reason of everything that is left out.

mod fdd;
mod harmonics;
pub mod interaction;
pub mod operational;
mod physical;
mod plscf;
mod ssi;

pub use fdd::{FddMode, FddOutcome, FddSettings, fdd};
pub use harmonics::{Family, Line, LineError, LineSettings, spectral_lines};
pub use operational::{
    Mode, OperationalError, Pole, PoleStatus, Reason, Rejected, ShapeComponent, StabilitySettings,
    StabilizationDiagram,
};
pub use physical::{CHI_LIMIT, Estimate, PhysicalError, PhysicalOutcome, PhysicalSettings, fit_physical};
pub use plscf::{
    Constraint, HalfSpectra, PlscfOutcome, PlscfSettings, Spectrum as PlscfSpectrum, plscf, plscf_poles,
};
pub use ssi::{SsiOutcome, SsiSettings, ssi_cov};
