//! Models of spectra: exact where they can be, against the thesis's numbers, and with samples that are none.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod analytic;
mod bounded_interpolation;
mod constrained_response;
mod exact;
mod interpolation_example;
mod interpolation_random;
mod poles_and_residues;
mod road_shapes;
mod surplus_orders;
#[path = "../../examples/common/spectra.rs"]
mod systems;
mod thesis_example;
mod wrong_nodes;
mod wrong_samples;
