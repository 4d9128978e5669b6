//! Invariants and second routes.

#![allow(clippy::unwrap_used)]

mod cabin_road;
mod dampers;
mod light_peaks;
mod lti;
mod points;
mod ride;
mod sensors;
mod simulate;
mod stretches;
