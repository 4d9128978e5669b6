//! Where a fixed-order search begins beside chance: regulators of every order that sensors of little noise allow, and a file.

use super::controller_files::read_controller;
use super::design_outcome::ControllerFile;
use super::design_problem::Problem;
use super::{Input, StudyError};
use crate::lti::{Continuous, GeneralizedPlant, LtiError, StateSpace};
use crate::synthesis::{Aim, LqgWeights, Measure, SynthesisError, Target, lqg};
use std::path::Path;

/// Sensor noise and weight of the control of the regulators, as shares of what the road makes of a measurement and the
/// control of the goal at their largest.
const SHARES: [[f64; 2]; 3] = [[0.03, 0.03], [0.3, 0.3], [0.003, 0.01]];
/// Vehicles that regulators are made for.
const MOST_VEHICLES: usize = 4;

/// Regulators for some of the plants, whose performances weigh what the targets make of them. A plant without one (outputs
/// that white noise reaches at once) has no such start.
pub(super) fn regulators(plants: &[GeneralizedPlant], targets: &[Target]) -> Vec<StateSpace<Continuous>> {
    let some = plants.len().min(MOST_VEHICLES);
    // evenly over all of them
    let which = (0..some).map(|k| k * plants.len() / some.max(1));
    which
        .flat_map(|plant| {
            let of_plant = |shares: &[f64; 2]| regulator(&plants[plant], targets, plant, *shares).ok();
            SHARES.iter().filter_map(of_plant).collect::<Vec<_>>()
        })
        .collect()
}

fn regulator(
    plant: &GeneralizedPlant,
    targets: &[Target],
    number: usize,
    [noise, weight]: [f64; 2],
) -> Result<StateSpace<Continuous>, SynthesisError> {
    let mut weights = vec![0.0f64; plant.nz()];
    for t in targets.iter().filter(|t| t.plant == number) {
        let (Measure::Hinf(channel) | Measure::H2(channel)) = &t.measure else { continue };
        let (Aim::Goal(unit) | Aim::Bound(unit)) = t.aim;
        for (row, w) in &channel.outputs {
            weights[*row] = weights[*row].max(w / unit);
        }
    }
    let signals = plant.signals();
    let rows: Vec<usize> = (0..plant.nz()).filter(|i| weights[*i] > 0.0).collect();
    let z: Vec<&str> = rows.iter().map(|i| signals.performances[*i].as_str()).collect();
    let y: Vec<&str> = signals.measurements.iter().map(String::as_str).collect();
    let factors: Vec<f64> = rows.iter().map(|i| weights[*i]).collect();
    let goal = plant.select(&z, &y)?.with_weights(&factors)?;
    let (nz, nw) = (goal.nz(), goal.nw());
    let largest = |rows: &[usize], columns: &[usize]| -> Result<f64, LtiError> {
        Ok(goal.system().select(rows, columns)?.hinf_norm()?.norm)
    };
    let (disturbances, performances): (Vec<usize>, Vec<usize>) = ((0..nw).collect(), (0..nz).collect());
    let of_sensor = |i: usize| Ok((noise * largest(&[nz + i], &disturbances)?).powi(2));
    let of_control = |j: usize| Ok((weight * largest(&performances, &[nw + j])?).powi(2));
    let weights = LqgWeights {
        sensor_noise: (0..goal.ny()).map(of_sensor).collect::<Result<_, LtiError>>()?,
        input_weight: (0..goal.nu()).map(of_control).collect::<Result<_, LtiError>>()?,
        process_noise: 1.0,
        cross_term: true,
    };
    Ok(lqg(&goal, &weights)?.controller)
}

/// The controller of `start`, its signals in the order of the problem's.
///
/// # Errors
/// A file that has none, signals that are not the design's.
pub(super) fn given(problem: &Problem) -> Result<Option<(StateSpace<Continuous>, Input)>, StudyError> {
    let Some(path) = &problem.spec.start else { return Ok(None) };
    // whatever is wrong with it, `start` is where it stands
    let (file, input) = read_controller(Path::new(path)).map_err(|e| StudyError::Setting {
        field: "start",
        expected: "a design's directory or result.json, or a controller's file".into(),
        found: e.to_string(),
    })?;
    let k = in_order(problem, &file, &input.path)?;
    Ok(Some((k, input)))
}

/// A controller whose signals are in the order of the problem's.
///
/// # Errors
/// Signals that are not the design's.
pub(super) fn in_order(
    problem: &Problem,
    file: &ControllerFile,
    name: &str,
) -> Result<StateSpace<Continuous>, StudyError> {
    let fail = |e: LtiError| StudyError::Design { name: name.to_owned(), source: Box::new(e.into()) };
    let places = |what: &str, wanted: Vec<&str>, found: &[String]| -> Result<Vec<usize>, StudyError> {
        let at: Option<Vec<usize>> = wanted.iter().map(|n| found.iter().position(|f| f == n)).collect();
        at.filter(|at| at.len() == found.len()).ok_or_else(|| StudyError::Setting {
            field: "start",
            expected: format!("a controller with the design's {what}: {}", wanted.join(", ")),
            found: format!("{} in {name}", found.join(", ")),
        })
    };
    let inputs =
        places("measurements", problem.measurements.iter().map(|o| o.name.as_str()).collect(), &file.inputs)?;
    let actuators = problem.vehicle.actuators().iter().map(|a| a.name.as_str()).collect();
    let outputs = places("actuators", actuators, &file.outputs)?;
    file.state_space().map_err(fail)?.select(&outputs, &inputs).map_err(fail)
}

/// ω₁ = √(k_t/(m_s + m_u)) and ω₂ = √(k_t/m_u) of quarter cars, where no control changes what it does elsewhere: a search
/// that leaves them out between two points of a grid finds controllers that are none.
pub(super) fn invariant_frequencies(problem: &Problem) -> Vec<f64> {
    let of = |q: &crate::vehicle::QuarterCar| {
        let (k, wheel) = (q.tire_stiffness_n_per_m, q.unsprung_mass_kg);
        [(k / (q.sprung_mass_kg + wheel)).sqrt(), (k / wheel).sqrt()]
    };
    problem.file.quarter_car.as_ref().map(of).into_iter().flatten().collect()
}
