//! Semidefinite programs and matrix inequalities.

#![allow(clippy::unwrap_used)]

mod matrix_inequalities;
mod random_programs;
mod sdplib;
