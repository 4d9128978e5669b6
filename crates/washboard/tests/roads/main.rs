//! Roads from data: spectra and profiles from files, shaping filters of them, the roughness index of real profiles.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod analytic;
mod degenerate;
mod filters;
mod folder;
mod matrices;
mod noisy;
mod profiles;
mod wrong_files;
