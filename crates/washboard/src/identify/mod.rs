//! Identification: from recorded channels alone to modes, with the reason of everything that is left out.

mod ssi;

pub use ssi::{
    Mode, Pole, PoleStatus, Reason, Rejected, ShapeComponent, SsiError, SsiOutcome, SsiSettings,
    StabilizationDiagram, ssi_cov,
};
