//! Norms, rms and gains of a design's vehicle, passive or in the loop with a controller.

use super::beyond_band::{BeyondBand, beyond};
use super::design_outcome::{Gains, Measured};
use super::design_outputs::swings;
use super::design_problem::Problem;
use super::{Infinite, Named, Rms, StudyError};
use crate::linalg::{C64, CMat};
use crate::lti::{Continuous, LtiError, StateSpace};
use crate::units::rad_per_s;
use crate::vehicle::{Control, Output, Ride, Variance};

/// Where gains are looked at, Hz, evenly in log f.
const GAINS_HZ: [f64; 2] = [0.05, 50.0];
const POINTS: usize = 240;

/// rms, and the shares of it from beyond a band.
type OnRoad = (Named<Rms>, Option<BeyondBand>);

impl Problem {
    /// Norms and rms of the passive vehicle, or of the loop with a controller.
    pub fn measure(&self, controller: Option<&StateSpace<Continuous>>) -> Result<Measured, StudyError> {
        let design =
            |e: LtiError| StudyError::Design { name: self.spec.vehicle.clone(), source: Box::new(e.into()) };
        let closed = match controller {
            Some(k) => self.plant.close(k).map_err(design)?,
            None => self.plant.passive(),
        };
        let mut measured = Measured {
            poles: closed.poles().map_err(design)?.iter().map(|p| [p.re, p.im]).collect(),
            stable: closed.is_stable().map_err(design)?,
            ..Measured::default()
        };
        if controller.is_none() {
            let poles: Vec<C64> = measured.poles.iter().map(|p| C64::new(p[0], p[1])).collect();
            measured.stable &= swings(&poles).is_none();
        }
        measured.poles.sort_by(|a, b| a[0].hypot(a[1]).total_cmp(&b[0].hypot(b[1])));
        if !measured.stable {
            return Ok(measured);
        }
        let inputs: Vec<usize> = (0..closed.inputs()).collect();
        for (name, members) in self.blocks() {
            let one = closed.select(&members, &inputs).map_err(design)?;
            let h2 = match one.h2_norm() {
                Ok(v) => Rms::Finite(v),
                Err(LtiError::NotStrictlyProper { .. }) => Rms::Infinite(Infinite::Infinite),
                Err(e) => return Err(design(e)),
            };
            let peak = one.hinf_norm().map_err(design)?;
            // what a symmetric vehicle cancels is zero but for rounding
            let still = peak.norm <= floor(&self.reported, &closed, &name);
            let at = peak.omega_rad_s;
            measured.h2.insert(&name, if still { Rms::Finite(0.0) } else { h2 });
            measured.hinf.insert(&name, if still { 0.0 } else { peak.norm });
            // what stands still does so everywhere; the others may have their largest gain at infinity
            let at = if still { 0.0 } else { at };
            measured.hinf_at_rad_s.insert(&name, Some(at).filter(|w| w.is_finite()));
        }
        (measured.rms, measured.beyond_band) = self.rms(controller)?;
        Ok(measured)
    }

    /// rms on the road, exact delays, and what of it is from beyond the band of a filter's data.
    fn rms(&self, controller: Option<&StateSpace<Continuous>>) -> Result<OnRoad, StudyError> {
        let fail = |source| StudyError::Ride { name: self.spec.vehicle.clone(), source };
        let control = controller
            .map(|k| {
                let y: Vec<String> = self.measurements.iter().map(|o| o.name.clone()).collect();
                let u: Vec<String> = self.vehicle.actuators().iter().map(|a| a.name.clone()).collect();
                Control::new(&self.vehicle, k.clone(), &y, &u)
            })
            .transpose()
            .map_err(|e| fail(e.into()))?;
        let (road, speed) = (self.ground.excitation(), self.spec.speed_m_s);
        let ride = match &control {
            Some(c) => Ride::controlled(&self.vehicle, road, speed, c),
            None => Ride::new(&self.vehicle, road, speed),
        }
        .map_err(fail)?;
        let outputs: Vec<&Output> = self.reported.iter().collect();
        let variances = ride.variances(&outputs).map_err(fail)?;
        let blocks = self.blocks().into_iter().map(|(name, members)| {
            let sum = members.iter().map(|i| variances[*i]).try_fold(0.0, |sum, v| match v {
                Variance::Finite(v) => Some(sum + v.max(0.0)),
                Variance::Infinite(_) => None,
            });
            (name, sum.map_or(Rms::Infinite(Infinite::Infinite), |v| Rms::Finite(v.sqrt())))
        });
        let band = self.ground.fitted_band_rad_s;
        let beyond = band.map(|band| beyond(&ride, &outputs, &variances, band)).transpose().map_err(fail)?;
        Ok((blocks.collect(), beyond))
    }

    /// Gains over frequency; a vehicle that is not stable without control has none.
    pub fn gains(
        &self,
        passive_is_stable: bool,
        controller: Option<&StateSpace<Continuous>>,
    ) -> Result<Gains, StudyError> {
        let design =
            |e: LtiError| StudyError::Design { name: self.spec.vehicle.clone(), source: Box::new(e.into()) };
        let step = (GAINS_HZ[1] / GAINS_HZ[0]).ln() / (POINTS - 1) as f64;
        let freq_hz: Vec<f64> = (0..POINTS).map(|i| GAINS_HZ[0] * (step * i as f64).exp()).collect();
        let omegas: Vec<f64> = freq_hz.iter().map(|f| rad_per_s(*f)).collect();
        let of = |g: &StateSpace<Continuous>| self.gains_at(g, &omegas);
        let passive = if passive_is_stable { of(&self.plant.passive())? } else { Named::default() };
        let closed = match controller {
            Some(k) => of(&self.plant.close(k).map_err(design)?)?,
            None => Named::default(),
        };
        Ok(Gains { freq_hz, passive, closed })
    }

    /// Largest singular values of the blocks at some frequencies, of a system from the disturbances to what is reported.
    pub fn gains_at(
        &self,
        g: &StateSpace<Continuous>,
        omegas: &[f64],
    ) -> Result<Named<Vec<f64>>, StudyError> {
        let design =
            |e: LtiError| StudyError::Design { name: self.spec.vehicle.clone(), source: Box::new(e.into()) };
        let responses = g.frequency_response(omegas).map_err(design)?;
        let own = self.blocks().into_iter().map(|(name, members)| {
            let gain = |r: &CMat| {
                let rows: Vec<C64> = members
                    .iter()
                    .flat_map(|i| (0..r.ncols()).map(move |j| (*i, j)))
                    .map(|(i, j)| r[(i, j)])
                    .collect();
                let block = CMat::from_fn(members.len(), r.ncols(), |i, j| rows[i * r.ncols() + j]);
                block.singular_values().ok().and_then(|s| s.first().copied()).unwrap_or(f64::NAN)
            };
            let values: Vec<f64> = responses.iter().map(gain).collect();
            let still = values.iter().all(|v| *v <= floor(&self.reported, g, &name));
            (name, if still { vec![0.0; values.len()] } else { values })
        });
        Ok(own.collect())
    }
}

/// What a symmetric vehicle cancels is a small share of what outputs of the same kind show.
pub(super) fn floor(reported: &[Output], passive: &StateSpace<Continuous>, name: &str) -> f64 {
    const ROUNDING: f64 = 1e-9;
    let kind =
        |n: &str| ["acceleration", "travel", "deflection", "force"].into_iter().find(|k| n.contains(k));
    let alike: Vec<usize> = (0..reported.len()).filter(|i| kind(&reported[*i].name) == kind(name)).collect();
    ROUNDING * Norm::Hinf.of(passive, &alike).unwrap_or(0.0)
}

/// The norm that a method minimises.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Norm {
    H2,
    Hinf,
}

impl Norm {
    pub fn of(self, g: &StateSpace<Continuous>, members: &[usize]) -> Result<f64, LtiError> {
        let one = g.select(members, &(0..g.inputs()).collect::<Vec<_>>())?;
        match self {
            Norm::H2 => one.h2_norm(),
            Norm::Hinf => Ok(one.hinf_norm()?.norm),
        }
    }
}
