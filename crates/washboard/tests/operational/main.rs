//! The classical estimators of operational modal analysis on structures that are simulated exactly.

#![allow(clippy::unwrap_used)]

#[path = "../../examples/common/structure.rs"]
mod structure;

mod deviations;
mod fdd;
mod hostile;
mod plscf;
mod vehicle;
