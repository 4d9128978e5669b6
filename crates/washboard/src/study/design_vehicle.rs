//! The vehicle of a design as far as a drawing needs it: its model, its numbers, its wheels.

use super::Named;
use super::design_problem::Problem;
use serde::{Deserialize, Serialize};

/// What is drawn.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct DesignVehicle {
    /// `quarter-car` …
    pub model: String,
    /// Numbers of its file that are not 0, after `override`; none of `matrices`.
    #[serde(default, skip_serializing_if = "Named::is_empty")]
    pub parameters: Named<f64>,
    /// Its wheels, or points of a chassis.
    pub wheels: Vec<DesignWheel>,
    /// Its actuators.
    pub actuators: Vec<String>,
}

/// A wheel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DesignWheel {
    /// Its name.
    pub name: String,
    /// Forward and left of the c.g., m.
    pub at_m: [f64; 2],
}

/// The vehicle of a problem.
pub(super) fn vehicle(problem: &Problem) -> DesignVehicle {
    let own = |(name, fields): (String, Vec<(String, f64)>)| match fields.as_slice() {
        [(field, value)] if *field == name => Some((name, *value)),
        _ => None,
    };
    DesignVehicle {
        model: problem.file.model.name().to_owned(),
        parameters: problem.file.parameters().into_iter().filter_map(own).collect(),
        wheels: problem
            .vehicle
            .wheels()
            .iter()
            .map(|w| DesignWheel { name: w.name.clone(), at_m: w.at_m })
            .collect(),
        actuators: problem.vehicle.actuators().iter().map(|a| a.name.clone()).collect(),
    }
}
