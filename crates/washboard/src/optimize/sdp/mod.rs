//! Semidefinite programs of the size of linear matrix inequalities, by a primal-dual interior-point method.

mod embedding;
mod error;
mod judge;
mod newton;
mod outcome;
mod problem;
mod refine;
mod scalar;
mod scales;
mod scaling;
mod schur;
mod solve;

pub use error::SdpError;
pub use outcome::{Certificate, Measures, SdpOutcome, Status};
pub use problem::{Atom, Block, Sdp};
pub use solve::SdpSettings;
