//! Controllers of given order: the quarter car's levels, a benchmark collection where it is present, independent routes
//! to full-order optima, structure, and what is refused.

#![allow(clippy::unwrap_used, clippy::print_stdout, clippy::print_stderr)]

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::Value;
use std::path::Path;
use washboard::cases;
use washboard::linalg::{C64, CMat, Mat};
use washboard::lti::{Continuous, GeneralizedPlant, LtiError, Signals, StateSpace};
use washboard::synthesis::{
    Aim, Channel, Entry, FixedOrder, FixedOrderDesign, FixedOrderEnd, FixedOrderSettings, HinfSettings,
    Local, Measure, Structure, SynthesisError, Target, fixed_order, h2, hinf,
};
use washboard::vehicle::{Disturbance, Output, PlantSettings};

/// Norms recomputed here and those reported: both are found to 1e-7 or better.
const NORMS: f64 = 1e-6;
/// A result above the best known one by more than this share is not as good.
const AS_GOOD: f64 = 1.005;

type System = StateSpace<Continuous>;

fn channel(rows: &[usize]) -> Channel {
    Channel { outputs: rows.iter().map(|r| (*r, 1.0)).collect(), disturbances: Vec::new() }
}

fn all_outputs(plant: &GeneralizedPlant) -> Channel {
    channel(&(0..plant.nz()).collect::<Vec<_>>())
}

fn target(plant: usize, measure: Measure, aim: Aim) -> Target {
    Target { plant, measure, aim, name: "a target".into() }
}

fn asked(plants: Vec<GeneralizedPlant>, targets: Vec<Target>, structure: Structure) -> FixedOrder {
    FixedOrder {
        structure,
        plants,
        targets,
        max_pole_rad_s: None,
        max_gain: None,
        margin_rad_s: 0.0,
        starts: Vec::new(),
        frequencies_rad_s: Vec::new(),
    }
}

fn designed(asked: &FixedOrder, settings: &FixedOrderSettings) -> FixedOrderDesign {
    match fixed_order(asked, settings).unwrap() {
        FixedOrderEnd::Designed(d) => *d,
        other => panic!("not designed: {other:?}"),
    }
}

fn few(tries: usize) -> FixedOrderSettings {
    FixedOrderSettings { tries, lower_orders: false, ..FixedOrderSettings::default() }
}

fn largest(response: &CMat) -> f64 {
    response.singular_values().unwrap()[0]
}

/// ‖T‖∞ of rows by the library's norm and by plain solves around every lightly damped pole, whichever is larger.
fn peak(closed: &System, rows: &[usize]) -> f64 {
    let columns: Vec<usize> = (0..closed.inputs()).collect();
    let one = closed.select(rows, &columns).unwrap();
    let mut norm = one.hinf_norm().unwrap().norm;
    for p in one.poles().unwrap().iter().filter(|p| p.im > 0.0 && -p.re < 0.3 * p.norm()) {
        for k in -100..=100 {
            let omega = p.im + 0.05 * f64::from(k) * p.re.abs();
            if omega > 0.0 {
                norm = norm.max(largest(&one.at(C64::new(0.0, omega)).unwrap()));
            }
        }
    }
    norm
}

mod collection;
mod full_order;
mod quarter;
mod refused;
mod structure;
