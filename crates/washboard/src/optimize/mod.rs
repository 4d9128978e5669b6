//! Optimisation: semidefinite programs, and linear matrix inequalities on top of them.

mod lmi;
mod nonsmooth;
mod sdp;

pub use lmi::{Expr, Lmi, LmiSolution, Variable};
pub use nonsmooth::{
    BfgsEnd, BfgsResult, BfgsSettings, BundleEnd, BundleResult, BundleSettings, Descent, Pieces, Role,
    Sampled, SmoothPiece, bfgs, minimize, sampled_subdifferential,
};
pub use sdp::{Atom, Block, Certificate, Measures, Sdp, SdpError, SdpOutcome, SdpSettings, Status};
