//! A single bump under a vehicle, in time: exact between samples but for the road, which is straight from one to the next.

use super::{Control, ControlError, Disturbance, Output, PlantError, PlantSettings, Vehicle};
use crate::linalg::{C64, Mat};
use crate::lti::{Continuous, Hold, StateSpace};
use crate::road::{Coherence, Road, Spectrum};
use crate::units::plain;
use std::f64::consts::{PI, TAU};
use thiserror::Error;

/// Steps over the shorter of the bump and the fastest mode's period.
const STEPS: f64 = 400.0;
/// Samples of a response, at most.
const MOST_SAMPLES: usize = 400_000;

/// w(τ) = ½h(1 − cos(2πvτ/l)) for 0 ≤ τ ≤ l/v, and 0 after: Türkay, (5.21).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bump {
    /// h, m; negative for a hole.
    pub height_m: f64,
    /// l, m.
    pub length_m: f64,
}

/// Whose modes have samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Modes {
    /// All of the loop.
    Loop,
    /// The vehicle's without its controller.
    Vehicle,
}

/// Outputs after a bump.
#[derive(Debug, Clone, PartialEq)]
pub struct BumpResponse {
    /// Times, s, from the first wheel's touching the bump.
    pub time_s: Vec<f64>,
    /// One series an output.
    pub outputs: Vec<Vec<f64>>,
}

/// A vehicle, in the loop or not, whose every wheel has a road of its own: from velocities to outputs, and all poles.
pub(super) struct OwnRoads {
    pub closed: StateSpace<Continuous>,
    pub poles: Vec<C64>,
}

/// What is refused.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum BumpError {
    /// A number that is none for a bump.
    #[error("{field}: expected {expected}, found {found}")]
    Field {
        /// Which.
        field: &'static str,
        /// What was expected.
        expected: &'static str,
        /// What was found.
        found: f64,
    },
    /// The vehicle is no plant.
    #[error(transparent)]
    Plant(#[from] PlantError),
    /// The controller does not fit.
    #[error(transparent)]
    Control(#[from] ControlError),
    /// A bump so short that its response needs more samples than are computed.
    #[error(
        "bump length, m: expected at least {least_m:.2e} at this speed and for this vehicle's fastest mode, found {}",
        plain(*length_m)
    )]
    TooShort {
        /// Its length, m.
        length_m: f64,
        /// The least, m.
        least_m: f64,
    },
    /// The loop is not stable.
    #[error("the response grows without end: a pole is at {re:e} {im:+e}i 1/s")]
    NotStable {
        /// Real part.
        re: f64,
        /// Imaginary part.
        im: f64,
    },
}

impl Bump {
    /// A bump.
    ///
    /// # Errors
    /// A height that is not finite or zero, a length that is not positive.
    pub fn new(height_m: f64, length_m: f64) -> Result<Self, BumpError> {
        if !(height_m.abs() <= 100.0 && height_m != 0.0) {
            let (field, expected) = ("bump height, m", "a number up to 100, not 0");
            return Err(BumpError::Field { field, expected, found: height_m });
        }
        if !(length_m.is_finite() && length_m > 0.0) {
            let (field, expected) = ("bump length, m", "a positive number");
            return Err(BumpError::Field { field, expected, found: length_m });
        }
        Ok(Bump { height_m, length_m })
    }

    /// dw/dτ at a time after it is touched.
    fn velocity(self, tau_s: f64, speed_m_s: f64) -> f64 {
        let turn = TAU * speed_m_s * tau_s / self.length_m;
        if !(0.0..=TAU).contains(&turn) {
            return 0.0;
        }
        PI * self.height_m * speed_m_s / self.length_m * turn.sin()
    }
}

impl Vehicle {
    /// The response of outputs to a bump that every wheel runs over in its turn, for so many seconds.
    ///
    /// The road's velocity is straight between samples, of which there are 400 over the bump and over a period of the
    /// fastest mode.
    ///
    /// # Errors
    /// A speed or duration that is not positive; outputs with derivatives of the road's velocity; a loop that is not
    /// stable; a controller whose measurements are not proper.
    pub fn bump_response(
        &self,
        outputs: &[&Output],
        bump: Bump,
        speed_m_s: f64,
        duration_s: f64,
        control: Option<&Control>,
    ) -> Result<BumpResponse, BumpError> {
        self.bump_response_for(outputs, bump, speed_m_s, duration_s, control, Modes::Loop)
    }

    /// The same with samples for the vehicle's own modes or for the loop's: exact at its samples either way, but a controller may have
    /// modes of a thousandth of the bump's time, which a smooth bump moves no faster than itself.
    pub(crate) fn bump_response_for(
        &self,
        outputs: &[&Output],
        bump: Bump,
        speed_m_s: f64,
        duration_s: f64,
        control: Option<&Control>,
        modes: Modes,
    ) -> Result<BumpResponse, BumpError> {
        for (field, found) in [("speed_m_s", speed_m_s), ("duration_s", duration_s)] {
            if !(found.is_finite() && found > 0.0) {
                return Err(BumpError::Field { field, expected: "a positive number", found });
            }
        }
        let OwnRoads { closed, poles } = self.on_own_roads(outputs, speed_m_s, control)?;
        let lti = |e| BumpError::Plant(PlantError::Lti(e));
        let seen = match (modes, control) {
            (Modes::Vehicle, Some(_)) => StateSpace::poles(&self.actuated(&[], &[])?).map_err(lti)?,
            _ => poles,
        };
        let fastest = seen.iter().map(|p| p.norm()).fold(1.0, f64::max);
        let wanted = (bump.length_m / speed_m_s).min(TAU / fastest) / STEPS;
        let dt_s = wanted;
        if duration_s / dt_s > MOST_SAMPLES as f64 {
            return Err(BumpError::TooShort {
                length_m: bump.length_m,
                least_m: duration_s / MOST_SAMPLES as f64 * STEPS * speed_m_s,
            });
        }
        let samples = (duration_s / dt_s).ceil() as usize + 1;
        let ahead = self.wheels().iter().map(|w| w.at_m[0]).fold(f64::NEG_INFINITY, f64::max);
        let touched: Vec<f64> = self.wheels().iter().map(|w| (ahead - w.at_m[0]) / speed_m_s).collect();
        let rows: Vec<Vec<f64>> = (0..samples)
            .map(|k| touched.iter().map(|t| bump.velocity(dt_s * k as f64 - t, speed_m_s)).collect())
            .collect();
        let y = closed.respond(&rows, dt_s, Hold::First).map_err(lti)?;
        Ok(BumpResponse {
            time_s: (0..samples).map(|k| dt_s * k as f64).collect(),
            outputs: (0..outputs.len()).map(|i| y.iter().map(|row| row[i]).collect()).collect(),
        })
    }

    /// From the road's velocity under every wheel, each by itself, to outputs; stable.
    pub(super) fn on_own_roads(
        &self,
        outputs: &[&Output],
        speed_m_s: f64,
        control: Option<&Control>,
    ) -> Result<OwnRoads, BumpError> {
        // every wheel its own input: its road is computed, not delayed by a filter
        let flat = Spectrum::white_velocity(1.0).map_err(|_| PlantError::NoFilter)?;
        let road = Road::new(flat, Coherence::Independent);
        let settings = PlantSettings {
            road: (&road).into(),
            speed_m_s,
            disturbance: Disturbance::RoadVelocity,
            delay_order: 0,
        };
        let measured: Vec<&Output> = control.iter().flat_map(|c| c.measurements()).collect();
        let plant = self.plant(outputs, &measured, &settings)?;
        let lti = |e| BumpError::Plant(PlantError::Lti(e));
        let closed = match control {
            Some(c) => plant.close(&c.on_all_actuators(self)).map_err(lti)?,
            None => plant.passive(),
        };
        // heights that are integrated, and modes that nothing shows, do not count
        let poles = match control {
            Some(c) => c.poles().to_vec(),
            None => StateSpace::poles(&self.actuated(&[], &[])?).map_err(lti)?,
        };
        if let Some(p) = poles.iter().find(|p| p.re >= 0.0) {
            return Err(BumpError::NotStable { re: p.re, im: p.im });
        }
        Ok(OwnRoads { closed, poles })
    }
}

impl BumpResponse {
    /// The largest magnitude of each output, and when.
    #[must_use]
    pub fn peaks(&self) -> Vec<(f64, f64)> {
        let peak = |y: &Vec<f64>| {
            let best = y.iter().zip(&self.time_s).max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
            best.map_or((0.0, 0.0), |(y, t)| (y.abs(), *t))
        };
        self.outputs.iter().map(peak).collect()
    }
}

impl Control {
    /// K with a row for every actuator of the vehicle: zero where it drives none.
    fn on_all_actuators(&self, vehicle: &Vehicle) -> StateSpace<Continuous> {
        let k = self.controller();
        let spread = Mat::from_fn(vehicle.actuators().len(), k.outputs(), |i, j| {
            f64::from(u8::from(self.actuators()[j] == i))
        });
        // shapes fit by construction
        StateSpace::continuous_gain(spread).and_then(|s| k.series(&s)).unwrap_or_else(|_| k.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vehicle::test_cases as cases;

    fn quarter(ct: f64) -> Vehicle {
        let spec = cases::spec("turkay-quarter-car");
        spec.with_overrides(&[("tire_damping_n_s_per_m".into(), ct)]).unwrap().build_alone().unwrap()
    }

    #[test]
    fn passive_peaks_are_the_notes() {
        // notes on chapter 5: c_t = 50, h = 0.1 m, l = 2 m, 45 km/h
        let car = quarter(50.0);
        let z =
            ["sprung_acceleration", "suspension_travel", "tire_deflection"].map(|n| car.output(n).unwrap());
        let found = car.bump_response(&z, Bump::new(0.1, 2.0).unwrap(), 12.5, 4.0, None).unwrap();
        for ((peak, _), (known, digits)) in
            found.peaks().into_iter().zip([(13.158, 5e-4), (0.09727, 5e-6), (0.02851, 5e-6)])
        {
            assert!((peak - known).abs() <= 1.01 * digits, "{peak} {known}");
        }
        // settled again on flat road
        assert!(found.outputs[1].last().unwrap().abs() < 1e-3);
    }

    #[test]
    fn the_rear_meets_the_bump_later_and_wrong_numbers_are_refused() {
        let car = cases::vehicle("turkay-half-car").unwrap();
        let z = ["tire_deflection_front", "tire_deflection_rear"].map(|n| car.output(n).unwrap());
        let bump = Bump::new(0.05, 1.0).unwrap();
        let found = car.bump_response(&z, bump, 20.0, 1.0, None).unwrap();
        // 4 m at 20 m/s
        let first = |y: &Vec<f64>| found.time_s[y.iter().position(|v| v.abs() > 1e-3).unwrap()];
        let lag = first(&found.outputs[1]) - first(&found.outputs[0]);
        assert!((lag - 0.2).abs() < 2e-3, "{lag}");
        assert!(Bump::new(0.0, 1.0).is_err() && Bump::new(0.1, -1.0).is_err());
        assert!(car.bump_response(&z, bump, 0.0, 1.0, None).is_err());
    }
}
