//! What a controller does to a plant, computed from the two alone: nothing here is shared with any synthesis.

use super::SynthesisError;
use crate::linalg::C64;
use crate::lti::{Continuous, GeneralizedPlant, LtiError, StateSpace};

/// The norms of one performance.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelNorms {
    /// Its name.
    pub name: String,
    /// H2 norm from all disturbances: its rms under unit white noise; none where it is infinite (feedthrough).
    pub h2: Option<f64>,
    /// H∞ norm from all disturbances.
    pub hinf: f64,
    /// Where that is attained, rad/s.
    pub hinf_omega_rad_s: f64,
}

/// A closed loop, measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Certificate {
    /// Poles of the closed loop.
    pub poles: Vec<C64>,
    /// −Re of the least stable one: positive, or there would be no certificate.
    pub margin: f64,
    /// H2 norm of all of T_zw; none where it is infinite.
    pub h2: Option<f64>,
    /// H∞ norm of all of T_zw.
    pub hinf: f64,
    /// Each performance by itself.
    pub channels: Vec<ChannelNorms>,
}

impl Certificate {
    /// Closes the loop u = +K y and measures it.
    ///
    /// # Errors
    /// A controller of another shape, a loop that is not well posed, or not stable: then the pole is in the error.
    pub fn of(plant: &GeneralizedPlant, controller: &StateSpace<Continuous>) -> Result<Self, SynthesisError> {
        Self::of_loop(plant, &plant.close(controller)?)
    }

    /// The plant without control.
    ///
    /// # Errors
    /// A plant that is not stable.
    pub fn passive(plant: &GeneralizedPlant) -> Result<Self, SynthesisError> {
        Self::of_loop(plant, &plant.passive())
    }

    fn of_loop(plant: &GeneralizedPlant, closed: &StateSpace<Continuous>) -> Result<Self, SynthesisError> {
        closed.check_stable("a certificate")?;
        let inputs: Vec<usize> = (0..closed.inputs()).collect();
        let channels = plant
            .signals()
            .performances
            .iter()
            .enumerate()
            .map(|(i, name)| {
                let one = closed.select(&[i], &inputs)?;
                let peak = one.hinf_norm()?;
                Ok(ChannelNorms {
                    name: name.clone(),
                    h2: finite(one.h2_norm())?,
                    hinf: peak.norm,
                    hinf_omega_rad_s: peak.omega_rad_s,
                })
            })
            .collect::<Result<Vec<_>, LtiError>>()?;
        Ok(Certificate {
            margin: closed.least_stable_pole()?.map_or(f64::INFINITY, |(_, margin)| margin),
            poles: closed.poles()?,
            h2: finite(closed.h2_norm())?,
            hinf: closed.hinf_norm()?.norm,
            channels,
        })
    }

    /// Refuses a claim about the H2 norm that the closed loop does not keep to `tolerance` (relative).
    ///
    /// # Errors
    /// [`SynthesisError::Refused`] with both numbers.
    pub fn confirm_h2(&self, claimed: f64, tolerance: f64) -> Result<(), SynthesisError> {
        let found = self.h2.unwrap_or(f64::INFINITY);
        if (found - claimed).abs() <= tolerance * claimed.abs().max(found) {
            return Ok(());
        }
        Err(SynthesisError::Refused { what: "the H2 norm", claimed, found })
    }

    /// Refuses a bound on the H∞ norm that the closed loop exceeds by more than `tolerance` (relative).
    ///
    /// # Errors
    /// [`SynthesisError::Refused`] with both numbers.
    pub fn confirm_hinf_below(&self, claimed: f64, tolerance: f64) -> Result<(), SynthesisError> {
        if self.hinf <= claimed * (1.0 + tolerance) {
            return Ok(());
        }
        Err(SynthesisError::Refused { what: "the H∞ norm", claimed, found: self.hinf })
    }
}

fn finite(norm: Result<f64, LtiError>) -> Result<Option<f64>, LtiError> {
    match norm {
        Ok(norm) => Ok(Some(norm)),
        Err(LtiError::NotStrictlyProper { .. }) => Ok(None),
        Err(e) => Err(e),
    }
}
