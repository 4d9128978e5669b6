//! Functions that are the largest of many smooth ones: BFGS, a bundle method for goals under bounds, and the distance of
//! 0 from the subdifferential.

mod active_set;
mod bfgs;
mod bundle;
mod interior;
mod model;
mod pieces;
mod sampled;
mod simplex;
mod steps;
#[cfg(test)]
mod tests;

pub use bfgs::{BfgsEnd, BfgsResult, BfgsSettings, bfgs};
pub use bundle::{BundleEnd, BundleResult, BundleSettings, Descent, minimize};
pub use pieces::{Pieces, Role, SmoothPiece};
pub use sampled::{Sampled, sampled_subdifferential};
