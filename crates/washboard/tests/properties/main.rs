//! Invariants and second routes.

#![allow(clippy::unwrap_used)]

mod dampers;
mod light_peaks;
mod lti;
mod ride;
mod sensors;
mod simulate;
mod stretches;
