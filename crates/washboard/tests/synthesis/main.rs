//! Designs: against published numbers, against second routes, and with plants that break an assumption.

#![allow(clippy::unwrap_used, clippy::print_stderr, clippy::print_stdout)]

mod half_car;
mod low_noise;
mod mathworks;
mod mixed;
mod mixed_cars;
mod other_vehicles;
mod plants;
mod quarter_car;
mod wrong_plants;
