//! Any mechanical system with wheels: M, C and K given as rows.

use super::{Actuator, Output, Parts, Vehicle, VehicleError, Wheel};
use crate::linalg::Mat;
use serde::{Deserialize, Serialize};

/// M q̈ + C q̇ + K q = K_w r + C_w ṙ + B u, all given.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Matrices {
    /// Rows of M.
    pub m: Vec<Vec<f64>>,
    /// Rows of C.
    pub c: Vec<Vec<f64>>,
    /// Rows of K.
    pub k: Vec<Vec<f64>>,
    /// Rows of K_w (dofs × wheels).
    #[serde(default)]
    pub wheel_stiffness: Vec<Vec<f64>>,
    /// Rows of C_w (dofs × wheels); zero where left out.
    #[serde(default)]
    pub wheel_damping: Vec<Vec<f64>>,
    /// Names of the degrees of freedom; q1, q2 … where left out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub dofs: Vec<String>,
    /// The wheels.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub wheel: Vec<WheelRow>,
    /// The outputs.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub output: Vec<OutputRow>,
    /// The actuators.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub actuator: Vec<ActuatorColumn>,
}

/// A wheel of [`Matrices`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WheelRow {
    /// Its name.
    pub name: String,
    /// Its place [x, y], m.
    pub at_m: [f64; 2],
}

/// An output of [`Matrices`]: one row over q, for its displacement, velocity or acceleration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OutputRow {
    /// Its name.
    pub name: String,
    /// Row over q.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub displacement: Option<Vec<f64>>,
    /// Row over q̇.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocity: Option<Vec<f64>>,
    /// Row over q̈.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub acceleration: Option<Vec<f64>>,
    /// Row over the road heights, taken to the same derivative.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub road: Option<Vec<f64>>,
}

/// An actuator of [`Matrices`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ActuatorColumn {
    /// Its name.
    pub name: String,
    /// Generalised force per newton.
    pub column: Vec<f64>,
}

impl Matrices {
    /// Parts as a file: all outputs that are one row over q and the same derivative of the road.
    pub(super) fn of(parts: &Parts) -> Self {
        let rows = |a: &Mat| -> Vec<Vec<f64>> {
            (0..a.nrows()).map(|i| (0..a.ncols()).map(|j| a[(i, j)]).collect()).collect()
        };
        Matrices {
            m: rows(&parts.m),
            c: rows(&parts.c),
            k: rows(&parts.k),
            wheel_stiffness: rows(&parts.wheel_stiffness),
            wheel_damping: rows(&parts.wheel_damping),
            dofs: parts.dofs.clone(),
            wheel: parts.wheels.iter().map(|w| WheelRow { name: w.name.clone(), at_m: w.at_m }).collect(),
            output: parts.outputs.iter().filter_map(OutputRow::of).collect(),
            actuator: parts
                .actuators
                .iter()
                .map(|a| ActuatorColumn { name: a.name.clone(), column: a.column.clone() })
                .collect(),
        }
    }

    /// The vehicle.
    ///
    /// # Errors
    /// Rows whose lengths do not fit, an output without exactly one row over q.
    pub fn assemble(&self) -> Result<Vehicle, VehicleError> {
        let (n, w) = (self.m.len(), self.wheel.len());
        let wheel_matrix = |field: &str, rows: &[Vec<f64>]| {
            if rows.is_empty() { Ok(Mat::zeros(n, w)) } else { matrix(field, rows, n, w) }
        };
        if self.wheel_stiffness.is_empty() && w > 0 {
            let found = format!("{w} wheels and no wheel_stiffness");
            return Err(VehicleError::Field {
                field: "wheel_stiffness".into(),
                expected: "dofs × wheels",
                found,
            });
        }
        if !self.dofs.is_empty() && self.dofs.len() != n {
            let found = format!("{} names for {n} dofs", self.dofs.len());
            return Err(VehicleError::Field { field: "dofs".into(), expected: "one name a dof", found });
        }
        let dofs =
            if self.dofs.is_empty() { (1..=n).map(|i| format!("q{i}")).collect() } else { self.dofs.clone() };
        Vehicle::new(Parts {
            m: matrix("m", &self.m, n, n)?,
            c: matrix("c", &self.c, n, n)?,
            k: matrix("k", &self.k, n, n)?,
            dofs,
            wheel_stiffness: wheel_matrix("wheel_stiffness", &self.wheel_stiffness)?,
            wheel_damping: wheel_matrix("wheel_damping", &self.wheel_damping)?,
            wheels: self.wheel.iter().map(|w| Wheel { name: w.name.clone(), at_m: w.at_m }).collect(),
            outputs: self.output.iter().map(|o| o.build(n, &self.wheel)).collect::<Result<_, _>>()?,
            actuators: self
                .actuator
                .iter()
                .map(|a| {
                    row(&format!("actuator `{}`", a.name), &a.column, n)?;
                    Ok(Actuator { name: a.name.clone(), column: a.column.clone() })
                })
                .collect::<Result<_, VehicleError>>()?,
            patterns: self.patterns(),
            dampers: vec![],
        })
    }

    /// Motions of the body that the file names; which wheels hop together it does not say.
    fn patterns(&self) -> Vec<(String, Vec<f64>)> {
        let n = self.dofs.len();
        let unit = |i: usize| (0..n).map(|j| f64::from(u8::from(i == j))).collect();
        let body = |(_, name): &(usize, &String)| ["heave", "pitch", "roll"].contains(&name.as_str());
        self.dofs.iter().enumerate().filter(body).map(|(i, name)| (name.clone(), unit(i))).collect()
    }
}

impl OutputRow {
    fn of(output: &Output) -> Option<Self> {
        let given: Vec<usize> = (0..3).filter(|d| !output.q[*d].is_empty()).collect();
        let [d] = given[..] else { return None };
        if !output.u.is_empty() || (0..3).any(|e| e != d && !output.r[e].is_empty()) {
            return None;
        }
        let row = |e: usize| (e == d).then(|| output.q[d].clone());
        let road = Some(output.r[d].clone()).filter(|r| !r.is_empty());
        let (displacement, velocity, acceleration) = (row(0), row(1), row(2));
        Some(OutputRow { name: output.name.clone(), displacement, velocity, acceleration, road })
    }

    fn build(&self, n: usize, wheels: &[WheelRow]) -> Result<Output, VehicleError> {
        let rows = [&self.displacement, &self.velocity, &self.acceleration];
        let given: Vec<usize> = (0..3).filter(|d| rows[*d].is_some()).collect();
        let [d] = given[..] else {
            return Err(VehicleError::Field {
                field: format!("output `{}`", self.name),
                expected: "exactly one of displacement, velocity, acceleration",
                found: format!("{} of them", given.len()),
            });
        };
        let mut q = [vec![], vec![], vec![]];
        let mut r = [vec![], vec![], vec![]];
        q[d] = rows[d].clone().unwrap_or_default();
        row(&format!("output `{}`", self.name), &q[d], n)?;
        if let Some(road) = &self.road {
            row(&format!("output `{}` road", self.name), road, wheels.len())?;
            r[d].clone_from(road);
        }
        let angle = ["pitch_", "roll_"].iter().any(|s| self.name.starts_with(s));
        let unit = [["m", "m/s", "m/s²"], ["rad", "rad/s", "rad/s²"]][usize::from(angle)][d];
        // `suspension_travel_front_left` is a component of `suspension_travel` where a wheel has that name
        let of_wheel = |w: &WheelRow| self.name.strip_suffix(&w.name).and_then(|s| s.strip_suffix('_'));
        let base = wheels.iter().find_map(of_wheel).unwrap_or(&self.name).to_owned();
        Ok(Output { name: self.name.clone(), base, unit, q, r, u: vec![] })
    }
}

fn row(field: &str, values: &[f64], n: usize) -> Result<(), VehicleError> {
    if values.len() == n && values.iter().all(|v| v.is_finite()) {
        return Ok(());
    }
    let found = format!("{} values", values.len());
    Err(VehicleError::Field { field: field.to_owned(), expected: "one finite value a column", found })
}

fn matrix(field: &str, rows: &[Vec<f64>], n: usize, m: usize) -> Result<Mat, VehicleError> {
    if rows.len() != n || rows.iter().any(|r| r.len() != m) {
        let lengths: Vec<usize> = rows.iter().map(Vec::len).collect();
        return Err(VehicleError::Field {
            field: field.to_owned(),
            expected: "as many rows as dofs, and each row as long as the matrix is wide",
            found: format!("{} rows of lengths {lengths:?}, expected {n} × {m}", rows.len()),
        });
    }
    Ok(Mat::from_fn(n, m, |i, j| rows[i][j]))
}
