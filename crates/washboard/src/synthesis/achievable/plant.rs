//! The quarter car as a generalised plant in floating point.

use super::{AchievableError, Measurement, QuarterCar, Response};
use crate::linalg::Mat;
use crate::lti::{GeneralizedPlant, Signals, StateSpace, to_f64};

impl QuarterCar {
    /// The plant (4.43)–(4.49) on the road's velocity, z = [ẍ₁, x₁ − x₂, x₂ − w], states [x₁ − x₂, x₂ − w, ẋ₁, ẋ₂].
    ///
    /// # Errors
    /// The unsprung displacement, which these states do not have.
    pub fn plant(&self, measurements: &[Measurement]) -> Result<GeneralizedPlant, AchievableError> {
        let f = to_f64;
        let (ms, mu, ks, cs, kt, ct) =
            (f(&self.ms), f(&self.mu), f(&self.ks), f(&self.cs), f(&self.kt), f(&self.ct));
        let sprung = [-ks / ms, 0.0, -cs / ms, cs / ms];
        let unsprung = [ks / mu, -kt / mu, cs / mu, -(cs + ct) / mu];
        let (travel, deflection) = ([1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]);
        let a = [[0.0, 0.0, 1.0, -1.0], [0.0, 0.0, 0.0, 1.0], sprung, unsprung];
        let b = [[0.0, 0.0], [-1.0, 0.0], [0.0, -1.0 / ms], [ct / mu, 1.0 / mu]];
        let mut rows = vec![(sprung, [0.0, -1.0 / ms]), (travel, [0.0; 2]), (deflection, [0.0; 2])];
        for m in measurements {
            rows.push(match m {
                Measurement::Acceleration => (sprung, [0.0, -1.0 / ms]),
                Measurement::Travel => (travel, [0.0; 2]),
                Measurement::TireDeflection => (deflection, [0.0; 2]),
                Measurement::UnsprungAcceleration => (unsprung, [ct / mu, 1.0 / mu]),
                Measurement::UnsprungDisplacement => {
                    return Err(AchievableError::ImproperMeasurement { measurement: m.name() });
                }
            });
        }
        let system = StateSpace::continuous(
            Mat::from_fn(4, 4, |i, j| a[i][j]),
            Mat::from_fn(4, 2, |i, j| b[i][j]),
            Mat::from_fn(rows.len(), 4, |i, j| rows[i].0[j]),
            Mat::from_fn(rows.len(), 2, |i, j| rows[i].1[j]),
        )?;
        let signals = Signals {
            disturbances: vec!["road velocity".to_owned()],
            controls: vec!["force".to_owned()],
            performances: Response::ALL.iter().map(|r| r.name().to_owned()).collect(),
            measurements: measurements.iter().map(|m| m.name().to_owned()).collect(),
        };
        Ok(GeneralizedPlant::new(system, signals)?)
    }
}
