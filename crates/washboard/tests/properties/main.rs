//! Invariants and second routes.

#![allow(clippy::unwrap_used)]

mod ride;
mod sensors;
mod simulate;
