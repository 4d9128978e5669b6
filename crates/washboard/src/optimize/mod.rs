//! Optimisation: semidefinite programs, and linear matrix inequalities on top of them.

mod lmi;
mod sdp;

pub use lmi::{Expr, Lmi, LmiSolution, Variable};
pub use sdp::{Atom, Block, Certificate, Measures, Sdp, SdpError, SdpOutcome, SdpSettings, Status};
