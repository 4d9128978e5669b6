//! A vehicle with its actuators as a generalised plant: road in, performances and measurements out.

mod by_height;
mod by_velocity;
mod tracks;

use super::{Output, Vehicle};
use crate::linalg::{LinalgError, Mat};
use crate::lti::{GeneralizedPlant, LtiError, Signals, StateSpace};
use crate::road::{Road, Shapes};
use thiserror::Error;

/// A coefficient below this share of the terms that it is a sum of has cancelled.
const CANCELLED: f64 = 1e-10;
/// Padé's order of a rear wheel's delay, where none is given.
pub const DELAY_ORDER: usize = 4;

/// What drives the plant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Disturbance {
    /// The vertical velocity of the road under each wheel that leads, m/s.
    RoadVelocity,
    /// Its height, m.
    RoadDisplacement,
    /// The white noise (unit intensity) behind the road's shaping filter.
    RoadNoise,
}

/// The road that a plant stands on, and how it is to be written down.
#[derive(Debug, Clone, Copy)]
pub struct PlantSettings<'a> {
    /// Spectrum and coherence; only the coherence counts unless the disturbance is the road's noise.
    pub road: &'a Road,
    /// Forward speed.
    pub speed_m_s: f64,
    /// What drives the plant.
    pub disturbance: Disturbance,
    /// Order of Padé's approximation of the delay of wheels that follow.
    pub delay_order: usize,
}

/// What is refused of a plant.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum PlantError {
    /// An output with derivatives of the disturbance.
    #[error(
        "`{output}` contains the derivative of the {disturbance}: its response grows without bound with frequency: take disturbance road-velocity or road-noise, or leave it out"
    )]
    Improper {
        /// The output.
        output: String,
        /// The disturbance, in words.
        disturbance: &'static str,
    },
    /// A road without a rational filter.
    #[error(
        "the road has no rational shaping filter: a design needs kind white-velocity, first-order or filter (road fit makes one)"
    )]
    NoFilter,
    /// A coherence without a rational form.
    #[error(
        "the road's coherence is `bogsjo`, which is not rational: a design needs full, none or independent"
    )]
    Coherence,
    /// A vehicle without actuators or wheels.
    #[error("the vehicle has no {0}")]
    Nothing(&'static str),
    /// The systems do not fit.
    #[error(transparent)]
    Lti(#[from] LtiError),
    /// Linear algebra refused.
    #[error(transparent)]
    Linalg(#[from] LinalgError),
}

impl Vehicle {
    /// The vehicle with its actuators u and the outputs asked for, on a road.
    ///
    /// Driven by velocities, the state is q − K⁻¹K_w r, q̇ and as many road heights as outputs depend on; driven by
    /// heights, q and q̇ − M⁻¹C_w r. A wheel that follows another one's track repeats its input through Padé's
    /// approximation of the delay. Disturbances are one a track that leads (`road`, `road left` …), or one a wheel on a road
    /// of independent wheels.
    ///
    /// # Errors
    /// Outputs with derivatives of the disturbance, a road without rational filter or coherence, a vehicle without
    /// actuators, a stiffness matrix that can't be solved with.
    pub fn plant(
        &self,
        performances: &[&Output],
        measurements: &[&Output],
        settings: &PlantSettings<'_>,
    ) -> Result<GeneralizedPlant, PlantError> {
        if self.actuators().is_empty() {
            return Err(PlantError::Nothing("actuators"));
        }
        if self.wheels().is_empty() {
            return Err(PlantError::Nothing("wheels"));
        }
        let filter = match settings.disturbance {
            Disturbance::RoadNoise => Some(
                settings.road.spectrum().shaping_filter(settings.speed_m_s).ok_or(PlantError::NoFilter)?,
            ),
            _ => None,
        };
        let by_velocity = match (settings.disturbance, &filter) {
            (Disturbance::RoadVelocity, _) => true,
            (_, Some(filter)) => filter.of() == Shapes::Velocity,
            _ => false,
        };
        let outputs: Vec<&Output> = performances.iter().chain(measurements).copied().collect();
        let bare =
            if by_velocity { self.driven_by_velocity(&outputs)? } else { self.driven_by_height(&outputs)? };
        let (tracks, names) = self.tracks(settings)?;
        let road = match filter {
            Some(f) => {
                let column = |v: &[f64]| Mat::from_fn(v.len(), 1, |i, _| v[i]);
                let d = Mat::from_fn(1, 1, |_, _| f.d());
                let one = StateSpace::continuous(
                    f.a().clone(),
                    column(f.b()),
                    column(f.c()).transpose().to_owned(),
                    d,
                )?;
                let all = (1..names.len()).try_fold(one.clone(), |all, _| all.append(&one))?;
                all.series(&tracks)?
            }
            None => tracks,
        };
        let controls =
            StateSpace::continuous_gain(Mat::identity(self.actuators().len(), self.actuators().len()))?;
        let system = road.append(&controls)?.series(&bare)?;
        let own = |o: &&Output| o.name.clone();
        let signals = Signals {
            disturbances: names,
            controls: self.actuators().iter().map(|a| a.name.clone()).collect(),
            performances: performances.iter().map(own).collect(),
            measurements: measurements.iter().map(own).collect(),
        };
        Ok(GeneralizedPlant::new(system, signals)?)
    }
}

#[cfg(test)]
mod tests;
