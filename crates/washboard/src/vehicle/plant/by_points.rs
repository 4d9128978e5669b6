//! A vehicle driven by the white noises behind a filter of all its road inputs: [ν; u] to outputs.

use super::PlantError;
use crate::lti::{Continuous, StateSpace};
use crate::road::Excitation;
use crate::vehicle::driven::{Driven, Growth};
use crate::vehicle::{Output, Vehicle};

impl Vehicle {
    /// From [ν; u] to outputs, with names of ν: state [q, q̇, x_w], heights and their derivatives from the filter's own state, so
    /// that a damper under the body (the cabin's at its chassis points) needs no derivative of an input.
    ///
    /// Source: Türkay's thesis, eq. (8.2).
    pub(super) fn driven_by_points(
        &self,
        road: Excitation<'_>,
        speed_m_s: f64,
        outputs: &[&Output],
    ) -> Result<(StateSpace<Continuous>, Vec<String>), PlantError> {
        let driven = Driven::new(self, road, speed_m_s, outputs)?.ok_or(PlantError::NoFilter)?;
        for (output, growth) in outputs.iter().zip(&driven.growth) {
            let output = output.name.clone();
            match growth {
                Growth::Finite => {}
                Growth::White => return Err(PlantError::White { output }),
                Growth::Difference | Growth::Wandering => return Err(PlantError::Wandering { output }),
            }
        }
        let names = (1..=driven.b.ncols()).map(|i| format!("noise {i}")).collect();
        let all: Vec<usize> = (0..self.actuators().len()).collect();
        Ok((driven.with_forces(self, &all)?, names))
    }
}
