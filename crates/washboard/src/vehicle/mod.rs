//! Vehicles: quarter, half and full cars, a truck cabin on its chassis, any M, C, K with wheels, or modes alone.

mod body;
mod bounce_truck;
mod bump;
mod controlled;
mod damper;
mod driven;
mod full_car;
mod generic;
mod half_car;
mod known;
mod linearise;
mod matrices;
mod multi_axle;
mod overrides;
mod parametric;
mod plant;
mod ports;
mod quarter_car;
mod response;
mod ride;
mod road_run;
mod sensors;
mod simulate;
mod spec;
mod statics;
#[cfg(test)]
mod test_cases;
mod truck_cabin;
mod values;

pub use bounce_truck::BounceTruck;
pub(crate) use bump::Modes as BumpModes;
pub use bump::{Bump, BumpError, BumpResponse};
pub use controlled::{Control, ControlError};
pub use damper::{Damper, DamperCurve};
pub use full_car::FullCar;
pub use generic::{GenericStart, Symmetry};
pub use half_car::{HalfCar, HalfCarVariant};
pub(crate) use known::of_scale;
pub use linearise::{LineariseError, Linearised, linearise};
pub use matrices::{ActuatorColumn, Matrices, OutputRow, WheelRow};
pub use parametric::ParametricVehicle;
pub(crate) use parametric::SPRUNG_MASS;
pub use plant::{DELAY_ORDER, Disturbance, PlantError, PlantSettings};
pub use quarter_car::QuarterCar;
pub use response::{Response, ResponseMode, ResponseOutput, ResponseReal};
pub use ride::{Ride, RideError, Variance};
pub use road_run::{RoadRun, RoadRunError};
pub use simulate::{
    Drive, DriveSettings, Flaws, SPEED_RAMP_S, SimulateError, Stretch, drive, drive_stretches, simulate,
};
pub use spec::{Model, VehicleSpec};
pub use statics::GRAVITY_M_S2;
pub use truck_cabin::{CabinAxle, TruckCabin};
pub use values::{Axle, LeftRight};

use crate::linalg::{C64, CMat, LinalgError, Mat, solve_complex};
use crate::lti::{MechanicsError, Mode, ModeKind, SecondOrder};
use thiserror::Error;

/// What is refused of a vehicle.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum VehicleError {
    /// A field has a value that it cannot have.
    #[error("{field}: expected {expected}, found {found}")]
    Field {
        /// The field, as it is written in a vehicle file.
        field: String,
        /// What it should be.
        expected: &'static str,
        /// What it is.
        found: String,
    },
    /// A name that the vehicle does not have.
    #[error("the vehicle has no {what} `{name}`{}; it has {known}", suggestion.as_ref().map(|s| format!(" (did you mean `{s}`?)")).unwrap_or_default())]
    Unknown {
        /// Output, parameter …
        what: &'static str,
        /// The name.
        name: String,
        /// The nearest known name.
        suggestion: Option<String>,
        /// All known names.
        known: String,
    },
    /// The matrices are no mechanical system.
    #[error(transparent)]
    Mechanics(#[from] MechanicsError),
}

/// A wheel (or, of a cabin, a chassis point): its name and place, x forward and y left, m.
#[derive(Debug, Clone, PartialEq)]
pub struct Wheel {
    /// `front_left` …
    pub name: String,
    /// [x, y] in m.
    pub at_m: [f64; 2],
}

/// A linear output y = Σ_d (d/dt)^d (q-row_d · q + r-row_d · r) + u-row · u, d = 0, 1, 2.
#[derive(Debug, Clone, PartialEq)]
pub struct Output {
    /// Its full name, `suspension_travel_front_left`.
    pub name: String,
    /// The name of the stacked vector that it is a component of, `suspension_travel`; its own name if none.
    pub base: String,
    /// SI unit.
    pub unit: &'static str,
    /// Rows over q for derivatives 0, 1, 2 (empty where zero).
    pub q: [Vec<f64>; 3],
    /// Rows over the road heights r for derivatives 0, 1, 2 (empty where zero).
    pub r: [Vec<f64>; 3],
    /// Row over the actuator forces (empty where zero).
    pub u: Vec<f64>,
}

/// An actuator: the column of generalised forces of a unit force.
#[derive(Debug, Clone, PartialEq)]
pub struct Actuator {
    /// `front_left` …, or the name given.
    pub name: String,
    /// Generalised force per newton (n).
    pub column: Vec<f64>,
}

/// M q̈ + C q̇ + K q = K_w r + C_w ṙ + B_u u with road heights r under the wheels, and named outputs.
#[derive(Debug, Clone, PartialEq)]
pub struct Vehicle {
    system: SecondOrder,
    dofs: Vec<String>,
    wheel_stiffness: Mat,
    wheel_damping: Mat,
    wheels: Vec<Wheel>,
    outputs: Vec<Output>,
    actuators: Vec<Actuator>,
    patterns: Vec<(String, Vec<f64>)>,
    dampers: Vec<Damper>,
    known_modes: Option<KnownModes>,
}

/// Modes that are the vehicle's definition: their shapes at named places, and their names.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct KnownModes {
    /// What the components of a shape are.
    pub places: Vec<String>,
    /// Ascending in |λ|.
    pub modes: Vec<(Mode, String)>,
}

/// The parts that a model brings together; [`Vehicle::new`] checks them.
#[derive(Debug, Clone)]
pub(crate) struct Parts {
    pub m: Mat,
    pub c: Mat,
    pub k: Mat,
    pub dofs: Vec<String>,
    pub wheel_stiffness: Mat,
    pub wheel_damping: Mat,
    pub wheels: Vec<Wheel>,
    pub outputs: Vec<Output>,
    pub actuators: Vec<Actuator>,
    /// Names of motions and their displacement patterns, for the labels of modes.
    pub patterns: Vec<(String, Vec<f64>)>,
    /// Dampers with a curve; C holds what stands for them.
    pub dampers: Vec<Damper>,
}

impl Vehicle {
    pub(crate) fn new(parts: Parts) -> Result<Self, VehicleError> {
        let system = SecondOrder::new(parts.m, parts.c, parts.k)?;
        let (n, w) = (system.order(), parts.wheels.len());
        for (name, a) in
            [("wheel_stiffness", &parts.wheel_stiffness), ("wheel_damping", &parts.wheel_damping)]
        {
            if (a.nrows(), a.ncols()) != (n, w) {
                let found = (a.nrows(), a.ncols());
                return Err(MechanicsError::Shape { name, expected: (n, w), found }.into());
            }
            crate::linalg::check_finite(name, a).map_err(MechanicsError::from)?;
        }
        Ok(Vehicle {
            system,
            dofs: parts.dofs,
            wheel_stiffness: parts.wheel_stiffness,
            wheel_damping: parts.wheel_damping,
            wheels: parts.wheels,
            outputs: parts.outputs,
            actuators: parts.actuators,
            patterns: parts.patterns,
            dampers: parts.dampers,
            known_modes: None,
        })
    }

    pub(crate) fn with_known_modes(self, modes: KnownModes) -> Self {
        Vehicle { known_modes: Some(modes), ..self }
    }

    /// M, C and K.
    #[must_use]
    pub fn system(&self) -> &SecondOrder {
        &self.system
    }

    /// Names of the degrees of freedom.
    #[must_use]
    pub fn dofs(&self) -> &[String] {
        &self.dofs
    }

    /// K_w: generalised force per road height (n × wheels).
    #[must_use]
    pub fn wheel_stiffness(&self) -> &Mat {
        &self.wheel_stiffness
    }

    /// C_w: generalised force per road velocity (n × wheels).
    #[must_use]
    pub fn wheel_damping(&self) -> &Mat {
        &self.wheel_damping
    }

    /// The wheels, front-left, front-right, rear-left, rear-right.
    #[must_use]
    pub fn wheels(&self) -> &[Wheel] {
        &self.wheels
    }

    /// Places of the wheels, m.
    #[must_use]
    pub fn wheel_places(&self) -> Vec<[f64; 2]> {
        self.wheels.iter().map(|w| w.at_m).collect()
    }

    /// All outputs by name.
    #[must_use]
    pub fn outputs(&self) -> &[Output] {
        &self.outputs
    }

    /// The dampers that have a curve, in the order of the corners.
    #[must_use]
    pub fn dampers(&self) -> &[Damper] {
        &self.dampers
    }

    /// The same vehicle with other linear dampings in the place of its dampers with a curve (N·s/m, one a damper).
    ///
    /// # Errors
    /// Another number of values than dampers; values that are not finite.
    pub fn with_damping(&self, c_n_s_per_m: &[f64]) -> Result<Self, VehicleError> {
        if c_n_s_per_m.len() != self.dampers.len() {
            return Err(VehicleError::Field {
                field: "damping".into(),
                expected: "one value a damper with a curve",
                found: format!("{} for {}", c_n_s_per_m.len(), self.dampers.len()),
            });
        }
        let mut c = self.system.c().clone();
        let mut dampers = self.dampers.clone();
        for (damper, value) in dampers.iter_mut().zip(c_n_s_per_m) {
            let more = value - damper.linear;
            for i in 0..damper.row.len() {
                for j in 0..damper.row.len() {
                    c[(i, j)] += more * damper.row[i] * damper.row[j];
                }
            }
            damper.linear = *value;
        }
        let system = SecondOrder::new(self.system.m().clone(), c, self.system.k().clone())?;
        Ok(Vehicle { system, dampers, ..self.clone() })
    }

    /// The actuators.
    #[must_use]
    pub fn actuators(&self) -> &[Actuator] {
        &self.actuators
    }

    /// One output by its full name.
    ///
    /// # Errors
    /// A name that is none, with the nearest that is.
    pub fn output(&self, name: &str) -> Result<&Output, VehicleError> {
        self.outputs.iter().find(|o| o.name == name).ok_or_else(|| VehicleError::Unknown {
            what: "output",
            name: name.to_owned(),
            suggestion: crate::files::nearest(name, self.outputs.iter().map(|o| o.name.as_str()))
                .map(str::to_owned),
            known: self.outputs.iter().map(|o| o.name.as_str()).collect::<Vec<_>>().join(", "),
        })
    }

    /// The displacements of all degrees of freedom per road height, G(ω)(K_w + iωC_w) (n × wheels).
    ///
    /// # Errors
    /// A dynamic stiffness that is singular at ω: an undamped resonance, or a rigid motion at ω = 0.
    pub fn road_response(&self, omega_rad_s: f64) -> Result<CMat, LinalgError> {
        let (n, w) = (self.system.order(), self.wheels.len());
        let input = CMat::from_fn(n, w, |i, j| {
            C64::new(self.wheel_stiffness[(i, j)], omega_rad_s * self.wheel_damping[(i, j)])
        });
        solve_complex(&self.system.dynamic_stiffness(omega_rad_s), &input)
    }

    /// The responses of outputs per road height (outputs × wheels) at ω.
    ///
    /// # Errors
    /// As [`Vehicle::road_response`].
    pub fn output_response(&self, outputs: &[&Output], omega_rad_s: f64) -> Result<CMat, LinalgError> {
        let h = self.road_response(omega_rad_s)?;
        let iw = C64::new(0.0, omega_rad_s);
        let powers = [C64::new(1.0, 0.0), iw, iw * iw];
        Ok(CMat::from_fn(outputs.len(), self.wheels.len(), |i, j| {
            let mut sum = C64::new(0.0, 0.0);
            for d in 0..3 {
                let from_q: C64 = outputs[i].q[d].iter().enumerate().map(|(k, v)| h[(k, j)] * *v).sum();
                let from_r = outputs[i].r[d].get(j).copied().unwrap_or(0.0);
                sum += powers[d] * (from_q + C64::new(from_r, 0.0));
            }
            sum
        }))
    }

    /// What the components of a mode's shape are: the degrees of freedom, or the outputs of a vehicle known by its modes.
    #[must_use]
    pub fn shape_places(&self) -> &[String] {
        self.known_modes.as_ref().map_or(&self.dofs, |known| &known.places)
    }

    /// Modes, ascending in |λ|, each with the name of the motion that it resembles most.
    ///
    /// # Errors
    /// An eigenvalue iteration that does not converge.
    pub fn modes(&self) -> Result<Vec<(Mode, String)>, VehicleError> {
        if let Some(known) = &self.known_modes {
            return Ok(known.modes.clone());
        }
        let modes = crate::lti::modes(&self.system)?;
        let labels = self.labels(&modes);
        Ok(modes.into_iter().zip(labels).collect())
    }

    /// A name for each shape: the motions are shared out one by one, best resemblance in kinetic energy first, each to
    /// one oscillatory mode; what is left over has a number.
    #[must_use]
    pub fn labels(&self, modes: &[Mode]) -> Vec<String> {
        let m = self.system.m();
        let n = self.system.order();
        let inner = |a: &dyn Fn(usize) -> C64, b: &dyn Fn(usize) -> C64| -> C64 {
            let mut sum = C64::new(0.0, 0.0);
            for i in 0..n {
                for j in 0..n {
                    if m[(i, j)] != 0.0 {
                        sum += a(i).conj() * m[(i, j)] * b(j);
                    }
                }
            }
            sum
        };
        let mut ranked: Vec<(f64, usize, usize)> = Vec::new();
        for (im, mode) in modes.iter().enumerate().filter(|(_, m)| m.kind == ModeKind::Oscillatory) {
            let shape = |i: usize| mode.shape[i];
            for (ip, (_, pattern)) in self.patterns.iter().enumerate() {
                let norm = inner(&shape, &shape).re;
                let p = |i: usize| C64::new(pattern[i], 0.0);
                let likeness = inner(&p, &shape).norm_sqr() / (norm * inner(&p, &p).re);
                ranked.push((likeness, im, ip));
            }
        }
        ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut labels: Vec<Option<String>> = vec![None; modes.len()];
        let mut used = vec![false; self.patterns.len()];
        for (_, im, ip) in ranked {
            if labels[im].is_none() && !used[ip] {
                labels[im] = Some(self.patterns[ip].0.clone());
                used[ip] = true;
            }
        }
        labels
            .into_iter()
            .zip(modes)
            .enumerate()
            .map(|(i, (label, mode))| {
                label.unwrap_or_else(|| match mode.kind {
                    ModeKind::Rigid => "rigid".to_owned(),
                    ModeKind::Overdamped => "overdamped".to_owned(),
                    ModeKind::Oscillatory => format!("mode {}", i + 1),
                })
            })
            .collect()
    }
}

impl Vehicle {
    /// The vehicle as identification sees it, with sensor rows over q (sensors × n).
    ///
    /// # Errors
    /// Rows of another length.
    pub fn wheeled(&self, rows: Mat) -> Result<crate::lti::WheeledSystem, MechanicsError> {
        crate::lti::WheeledSystem::new(
            self.system.clone(),
            self.wheel_stiffness.clone(),
            self.wheel_damping.clone(),
            self.wheel_places(),
            rows,
        )
    }
}
