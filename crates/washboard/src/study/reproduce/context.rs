//! What the items of chapters 4 and 5 share: the car of table 4.1 on its road, and designs on it.

use super::ReproduceError;
use super::chapter_6_figures::Sweep;
use super::chapter_7_design::FullCarDesign;
use super::item::{Curve, Sheet};
use super::shared::Shared;
use crate::cases;
use crate::linalg::C64;
use crate::lti::{Continuous, GeneralizedPlant, StateSpace};
use crate::synthesis::achievable::{HybridSettings, Measurement, Psi, QuarterCar, QuarterCarNumbers};
use crate::synthesis::{Certificate, LqgWeights, lqg};
use crate::vehicle::VehicleSpec;
use std::f64::consts::TAU;

/// The case of table 4.1.
pub(super) const CAR: &str = "turkay-quarter-car";
/// The case of (4.50).
pub(super) const ROAD: &str = "turkay-white-velocity";
/// v, m/s.
pub(super) const SPEED_M_S: f64 = 20.0;
/// 2c_s: the damping of the fictitious tire, N s/m.
pub(super) const OVERDAMPED: f64 = 1960.0;
/// 0.1c_s, N s/m.
pub(super) const DAMPED: f64 = 98.0;
/// μ of (4.51): the intensity of the measurements' noise.
pub(super) const SENSOR_NOISE: f64 = 1e-8;
/// y₂.
pub(super) const TRAVEL: [Measurement; 1] = [Measurement::Travel];
/// [y₁ y₂].
pub(super) const BOTH: [Measurement; 2] = [Measurement::Acceleration, Measurement::Travel];

/// The car and the road.
#[derive(Debug)]
pub(super) struct Context {
    /// Table 4.1 with c_t = 0.
    pub numbers: QuarterCarNumbers,
    /// Its file.
    pub spec: VehicleSpec,
    /// W = (2πn₀)²κv, m²/s.
    pub intensity: f64,
    /// §6.2.2's designs over tire damping, by ρ₁.
    pub half_car_sweeps: Shared<f64, Sweep>,
    /// §7.2.1's designs, by λ, μ and the decay rate asked of the poles, 1/s.
    pub full_car_designs: Shared<[f64; 3], FullCarDesign>,
}

impl Context {
    /// From the published cases.
    pub fn new() -> Result<Self, ReproduceError> {
        let spec = cases::vehicle_spec(CAR)?;
        let Some(car) = spec.quarter_car.as_ref() else {
            return Err(ReproduceError::unexpected("case", "a quarter car", CAR));
        };
        let numbers = QuarterCarNumbers {
            ms: car.sprung_mass_kg,
            mu: car.unsprung_mass_kg,
            ks: car.suspension_stiffness_n_per_m,
            cs: car.suspension_damping_n_s_per_m,
            kt: car.tire_stiffness_n_per_m,
            ct: car.tire_damping_n_s_per_m,
        };
        let white = cases::road(ROAD)?.spectrum().white_intensity(SPEED_M_S);
        let Some(intensity) = white else {
            return Err(ReproduceError::unexpected("case", "a road of white velocity", ROAD));
        };
        Ok(Context {
            numbers,
            spec,
            intensity,
            half_car_sweeps: Shared::default(),
            full_car_designs: Shared::default(),
        })
    }

    /// The car on a tire of this damping, N s/m.
    pub fn car(&self, ct: f64) -> Result<QuarterCar, ReproduceError> {
        Ok(QuarterCar::new(&QuarterCarNumbers { ct, ..self.numbers })?)
    }

    /// Its plant from road velocity and force to z₁ z₂ z₃ and measurements.
    pub fn plant(&self, ct: f64, y: &[Measurement]) -> Result<GeneralizedPlant, ReproduceError> {
        Ok(self.car(ct)?.plant(y)?)
    }

    /// rms of z₁ z₂ z₃ (m/s², m, m) of what was certified.
    pub fn rms(&self, of: &Certificate) -> [f64; 3] {
        let rms =
            |k: usize| of.channels.get(k).and_then(|c| c.h2).map_or(f64::NAN, |h| self.intensity.sqrt() * h);
        [rms(0), rms(1), rms(2)]
    }

    /// rms of the passive car.
    pub fn passive_rms(&self, ct: f64) -> Result<[f64; 3], ReproduceError> {
        Ok(self.rms(&Certificate::passive(&self.plant(ct, &TRAVEL)?)?))
    }

    /// The LQG design (4.51): weights 1/passive rms, no weight on the force, process noise 1.
    pub fn lqg(&self, ct: f64, y: &[Measurement]) -> Result<StateSpace<Continuous>, ReproduceError> {
        let plant = self.plant(ct, y)?;
        let weights = self.passive_rms(ct)?.map(|r| 1.0 / r);
        let settings = LqgWeights {
            sensor_noise: vec![SENSOR_NOISE; y.len()],
            input_weight: vec![0.0],
            ..LqgWeights::default()
        };
        Ok(lqg(&plant.with_weights(&weights)?, &settings)?.controller)
    }

    /// rms of the LQG design's loop, the road's part.
    pub fn lqg_rms(&self, ct: f64, y: &[Measurement]) -> Result<[f64; 3], ReproduceError> {
        Ok(self.rms(&Certificate::of(&self.plant(ct, y)?, &self.lqg(ct, y)?)?))
    }

    /// Passive car and LQG loops from road velocity to z, with the names of figures 4.3–4.9.
    pub fn loops(&self, ct: f64) -> Result<[(&'static str, StateSpace<Continuous>); 3], ReproduceError> {
        let closed = |y: &[Measurement]| -> Result<_, ReproduceError> {
            Ok(self.plant(ct, y)?.close(&self.lqg(ct, y)?)?)
        };
        Ok([
            ("passive", self.plant(ct, &TRAVEL)?.passive()),
            ("LQG, y₂", closed(&TRAVEL)?),
            ("LQG, [y₁ y₂]", closed(&BOTH)?),
        ])
    }

    /// The hybrid design of §4.4 as it is printed.
    pub fn hybrid_settings(&self) -> HybridSettings {
        HybridSettings {
            fictitious_tire_damping: OVERDAMPED,
            psi: Psi::PRINTED,
            sensor_noise: SENSOR_NOISE,
            road_velocity_intensity: self.intensity,
        }
    }
}

/// Frequencies of the figures, Hz: 0.1 to 100 evenly in the logarithm, and the invariant ones.
pub(super) fn frequencies(context: &Context) -> Result<Vec<f64>, ReproduceError> {
    let (w1, w2) = context.car(0.0)?.invariant_omegas_rad_s();
    let mut all: Vec<f64> = (0..=300).map(|k| 0.1 * 1000f64.powf(f64::from(k) / 300.0)).collect();
    all.extend([w1 / TAU, w2 / TAU]);
    all.sort_by(f64::total_cmp);
    Ok(all)
}

/// |T(j2πf)| from the first input to an output.
pub(super) fn gain(
    system: &StateSpace<Continuous>,
    output: usize,
    freq_hz: f64,
) -> Result<f64, ReproduceError> {
    Ok(system.at(C64::new(0.0, TAU * freq_hz))?[(output, 0)].norm())
}

/// A curve of gains.
pub(super) fn gains(
    label: &str,
    system: &StateSpace<Continuous>,
    output: usize,
    freq_hz: &[f64],
) -> Result<Curve, ReproduceError> {
    let y = freq_hz.iter().map(|f| gain(system, output, *f)).collect::<Result<_, _>>()?;
    Ok(Curve { label: label.to_owned(), y })
}

/// Three printed rms values beside three computed ones.
pub(super) fn three(sheet: &mut Sheet, of: &str, printed: [&str; 3], found: [f64; 3]) {
    for ((z, digits), found) in ["rms z₁, m/s²", "rms z₂, m", "rms z₃, m"].iter().zip(printed).zip(found)
    {
        sheet.printed(format!("{z}: {of}"), digits, found);
    }
}
