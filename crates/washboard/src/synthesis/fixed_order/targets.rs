//! What a fixed-order design is asked for.

use crate::lti::{GeneralizedPlant, LtiError};

/// A number of a closed loop.
#[derive(Debug, Clone, PartialEq)]
pub enum Measure {
    /// ‖T‖∞ of weighted outputs, stacked.
    Hinf(Channel),
    /// ‖T‖₂ of weighted outputs, stacked: √Σ(wᵢ‖Tᵢ‖₂)².
    H2(Channel),
    /// The largest real part of the closed loop's poles, rad/s.
    Abscissa,
}

/// Some performances with their weights, from some disturbances.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// Performances and weights.
    pub outputs: Vec<(usize, f64)>,
    /// Disturbances; all where it is empty.
    pub disturbances: Vec<usize>,
}

/// A measure of one plant's loop that is minimised or bounded.
#[derive(Debug, Clone, PartialEq)]
pub struct Target {
    /// Which plant.
    pub plant: usize,
    /// What of its loop.
    pub measure: Measure,
    /// Minimised: the largest of value/unit over all goals; or bounded.
    pub aim: Aim,
    /// What it is called.
    pub name: String,
}

/// What is to become of a measure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Aim {
    /// The largest of all value/unit is minimised, where an abscissa counts as exp(value/unit).
    Goal(f64),
    /// At most this.
    Bound(f64),
}

impl Target {
    pub(in crate::synthesis) fn check(&self, plants: &[GeneralizedPlant]) -> Result<(), LtiError> {
        let Some(plant) = plants.get(self.plant) else {
            let expected = format!("below {}", plants.len());
            return Err(LtiError::Join { what: "a target's plant", expected, found: self.plant.to_string() });
        };
        let number = match self.aim {
            Aim::Goal(v) | Aim::Bound(v) => v,
        };
        let abscissa = self.measure == Measure::Abscissa;
        if !number.is_finite() || !(number > 0.0 || (abscissa && matches!(self.aim, Aim::Bound(_)))) {
            let (field, expected) = ("a target's unit or bound", "a positive, finite number");
            return Err(LtiError::Field { field, expected, found: number });
        }
        let (Measure::Hinf(channel) | Measure::H2(channel)) = &self.measure else { return Ok(()) };
        if channel.outputs.iter().all(|(_, w)| *w == 0.0) {
            let expected = "an output with a weight above 0".to_owned();
            return Err(LtiError::Join { what: "a target's outputs", expected, found: "none".into() });
        }
        for (row, weight) in &channel.outputs {
            if *row >= plant.nz() {
                let expected = format!("below {}", plant.nz());
                return Err(LtiError::Join { what: "a target's output", expected, found: row.to_string() });
            }
            if !(*weight >= 0.0 && weight.is_finite()) {
                let (field, expected) = ("a target's weight", "a finite number, not negative");
                return Err(LtiError::Field { field, expected, found: *weight });
            }
        }
        let mut seen = vec![false; plant.nw()];
        for w in &channel.disturbances {
            if let Some(s) = seen.get_mut(*w)
                && std::mem::replace(s, true)
            {
                let expected = "each disturbance once".to_owned();
                return Err(LtiError::Join {
                    what: "a target's disturbances",
                    expected,
                    found: format!("{w} twice"),
                });
            }
        }
        match channel.disturbances.iter().find(|w| **w >= plant.nw()) {
            None => Ok(()),
            Some(found) => {
                let expected = format!("below {}", plant.nw());
                Err(LtiError::Join { what: "a target's disturbance", expected, found: found.to_string() })
            }
        }
    }
}
