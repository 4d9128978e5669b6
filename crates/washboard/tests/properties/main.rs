//! Invariants and second routes.

#![allow(clippy::unwrap_used)]

mod ride;
mod simulate;
