//! Identification of simulated drives: accuracy, intervals, and what must be refused.

#![allow(clippy::unwrap_used, clippy::expect_used)]

#[path = "../../examples/common/mod.rs"]
mod common;

mod kernel;
mod other_drives;
mod physical;
mod speeds;
mod without_file;
