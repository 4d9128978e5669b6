//! Invariants and second routes.

#![allow(clippy::unwrap_used)]

mod dampers;
mod ride;
mod sensors;
mod simulate;
mod stretches;
