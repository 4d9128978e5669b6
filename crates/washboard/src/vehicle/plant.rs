//! A vehicle with its actuators as a generalised plant: road in, performances and measurements out.

mod by_height;
mod by_points;
mod by_velocity;
mod tracks;

use super::{Output, Vehicle};
use crate::linalg::{LinalgError, Mat};
use crate::lti::{Continuous, GeneralizedPlant, LtiError, Signals, StateSpace};
use crate::road::{Excitation, Shapes};
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
    /// Spectrum and coherence, or a filter of all road inputs; only what belongs together counts unless the disturbance is the
    /// road's noise.
    pub road: Excitation<'a>,
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
    /// An output with white noise of a filter of road inputs.
    #[error(
        "`{output}` contains white noise of the road's filter: its spectrum must fall faster beyond the band (road fit --roll-off-order), or leave the output out"
    )]
    White {
        /// The output.
        output: String,
    },
    /// An output that follows heights of a filter of velocities.
    #[error(
        "`{output}` follows a road height that wanders off, as the filter's velocities do not vanish at rest: take a filter of displacement, or leave the output out"
    )]
    Wandering {
        /// The output.
        output: String,
    },
    /// A filter of other road inputs than the vehicle's.
    #[error(
        "the road: expected a filter of {expected} points, as many as the vehicle has road inputs, found {found}"
    )]
    Points {
        /// Wheels.
        expected: usize,
        /// Rows of C.
        found: usize,
    },
    /// A road without a rational filter.
    #[error(
        "the road has no rational shaping filter: a design needs kind white-velocity, first-order or filter (road fit makes one)"
    )]
    NoFilter,
    /// A coherence without a rational form.
    #[error(
        "the road's coherence of left and right is `bogsjo`, which is not rational: a design needs full, none or independent. Write it into \
         the road's file (`washboard cases NAME > road.toml` for a case): [coherence] and below it kind = \"full\" (no roll), or \"none\", \
         which on white velocity takes disturbance = \"road-noise\" and a road of kind first-order where axles differ in track"
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
    /// Driven by velocities, the state is q − K⁻¹K_w r, q̇ and as many road heights as outputs follow at rest; driven by
    /// heights, q and q̇ − M⁻¹C_w r. A wheel that follows another one's track repeats its input through Padé's
    /// approximation of the delay. Disturbances are one a track that leads (`road`, `road left` …), or one a wheel on a road
    /// of independent wheels; of a filter of all road inputs, one an input (`road front_left` …), or one a noise (`noise 1` …).
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
        let outputs: Vec<&Output> = performances.iter().chain(measurements).copied().collect();
        let road = match settings.road {
            Excitation::Road(road) => Some(road),
            Excitation::Points(filter) if filter.size() != self.wheels().len() => {
                return Err(PlantError::Points { expected: self.wheels().len(), found: filter.size() });
            }
            Excitation::Points(_) if settings.disturbance == Disturbance::RoadNoise => {
                let (system, names) = self.driven_by_points(settings.road, settings.speed_m_s, &outputs)?;
                return self.named(system, names, performances, measurements);
            }
            Excitation::Points(_) => None,
        };
        let filter = match (settings.disturbance, road) {
            (Disturbance::RoadNoise, Some(road)) => {
                Some(road.spectrum().shaping_filter(settings.speed_m_s).ok_or(PlantError::NoFilter)?)
            }
            _ => None,
        };
        let by_velocity = match (settings.disturbance, &filter) {
            (Disturbance::RoadVelocity, _) => true,
            (_, Some(filter)) => filter.of() == Shapes::Velocity,
            _ => false,
        };
        let (tracks, names) = match road {
            Some(road) => self.tracks(road, settings)?,
            None => self.points()?,
        };
        let noise = match filter {
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
                Some(all)
            }
            None => None,
        };
        let controls =
            StateSpace::continuous_gain(Mat::identity(self.actuators().len(), self.actuators().len()))?;
        let mut system = if by_velocity {
            self.driven_by_velocity(&outputs, &tracks)?
        } else {
            tracks.append(&controls)?.series(&self.driven_by_height(&outputs)?)?
        };
        if let Some(road) = noise {
            system = road.append(&controls)?.series(&system)?;
        }
        self.named(system, names, performances, measurements)
    }

    /// A system from [w; u] to [z; y] with its names.
    fn named(
        &self,
        system: StateSpace<Continuous>,
        disturbances: Vec<String>,
        performances: &[&Output],
        measurements: &[&Output],
    ) -> Result<GeneralizedPlant, PlantError> {
        let own = |o: &&Output| o.name.clone();
        let signals = Signals {
            disturbances,
            controls: self.actuators().iter().map(|a| a.name.clone()).collect(),
            performances: performances.iter().map(own).collect(),
            measurements: measurements.iter().map(own).collect(),
        };
        Ok(GeneralizedPlant::new(system, signals)?)
    }
}

#[cfg(test)]
mod tests;
