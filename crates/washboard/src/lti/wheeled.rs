//! A mechanical system on wheels with sensors: what identification needs to know of a vehicle, and nothing more.

use super::{MechanicsError, SecondOrder};
use crate::linalg::Mat;

/// M q̈ + C q̇ + K q = K_w r + C_w ṙ, with road heights r under the wheels and sensor displacements y = R q.
#[derive(Debug, Clone)]
pub struct WheeledSystem {
    system: SecondOrder,
    wheel_stiffness: Mat,
    wheel_damping: Mat,
    at_m: Vec<[f64; 2]>,
    rows: Mat,
}

impl WheeledSystem {
    /// The parts: K_w and C_w are n × wheels, `at_m` is [x, y] of each wheel (x forward, y left), `rows` is sensors × n.
    ///
    /// # Errors
    /// Shapes that do not fit.
    pub fn new(
        system: SecondOrder,
        wheel_stiffness: Mat,
        wheel_damping: Mat,
        at_m: Vec<[f64; 2]>,
        rows: Mat,
    ) -> Result<Self, MechanicsError> {
        let (n, w) = (system.order(), at_m.len());
        for (name, a, expected) in [
            ("wheel_stiffness", &wheel_stiffness, (n, w)),
            ("wheel_damping", &wheel_damping, (n, w)),
            ("rows", &rows, (rows.nrows(), n)),
        ] {
            if (a.nrows(), a.ncols()) != expected {
                return Err(MechanicsError::Shape { name, expected, found: (a.nrows(), a.ncols()) });
            }
        }
        Ok(WheeledSystem { system, wheel_stiffness, wheel_damping, at_m, rows })
    }

    /// M, C, K.
    #[must_use]
    pub fn system(&self) -> &SecondOrder {
        &self.system
    }

    /// K_w (n × wheels).
    #[must_use]
    pub fn wheel_stiffness(&self) -> &Mat {
        &self.wheel_stiffness
    }

    /// C_w (n × wheels).
    #[must_use]
    pub fn wheel_damping(&self) -> &Mat {
        &self.wheel_damping
    }

    /// Places of the wheels, m.
    #[must_use]
    pub fn at_m(&self) -> &[[f64; 2]] {
        &self.at_m
    }

    /// Sensor rows over q (sensors × n).
    #[must_use]
    pub fn rows(&self) -> &Mat {
        &self.rows
    }
}

/// A family of wheeled systems over positive parameters: what a vehicle implements so that it can be fitted.
pub trait Parametric: Sync {
    /// Names of the free parameters.
    fn names(&self) -> Vec<String>;
    /// Their values at the start, all positive.
    fn start(&self) -> Vec<f64>;
    /// Between which values each may move; by default a factor of e⁴ ≈ 55 from the start.
    fn limits(&self) -> Vec<[f64; 2]> {
        self.start().iter().map(|v| [v * (-4.0f64).exp(), v * 4.0f64.exp()]).collect()
    }
    /// Whether each may be absent: such a part that runs to its lower limit is none, and no failure.
    fn may_vanish(&self) -> Vec<bool> {
        vec![false; self.names().len()]
    }
    /// The system at given values.
    ///
    /// # Errors
    /// Values that make no system, in words.
    fn system(&self, values: &[f64]) -> Result<WheeledSystem, String>;
}

/// A family that starts elsewhere: at an answer to other data.
pub struct StartedAt<'a> {
    /// The family.
    pub family: &'a dyn Parametric,
    /// Where it starts.
    pub start: Vec<f64>,
}

impl Parametric for StartedAt<'_> {
    fn names(&self) -> Vec<String> {
        self.family.names()
    }

    fn start(&self) -> Vec<f64> {
        self.start.clone()
    }

    fn limits(&self) -> Vec<[f64; 2]> {
        self.family.limits()
    }

    fn may_vanish(&self) -> Vec<bool> {
        self.family.may_vanish()
    }

    fn system(&self, values: &[f64]) -> Result<WheeledSystem, String> {
        self.family.system(values)
    }
}
