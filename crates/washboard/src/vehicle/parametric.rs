//! A vehicle file as a family over its own parameters: what a fit moves, and what it leaves alone.

use super::{Vehicle, VehicleError, VehicleSpec};
use crate::linalg::Mat;
use crate::lti::{Parametric, WheeledSystem};
use crate::signal::{Channel, WheelPlace};
use serde_json::Value;

/// Fields that a fit does not move: the mass that sets the scale, and what a tape measure gives.
const HELD: [&str; 8] = [
    "sprung_mass_kg",
    "front_axle_m",
    "rear_axle_m",
    "front_track_m",
    "rear_track_m",
    "cg_left_m",
    "driver_m",
    "cabin_mass_kg",
];
/// The longitudinal place of the c.g. between the axles: moved through `front_axle_m` at a fixed wheelbase.
const CG: &str = "front_axle_m";

/// Where the c.g. may be, as shares of the wheelbase behind the front axle.
const CG_RANGE: [f64; 2] = [0.1, 0.9];
/// Other parameters may move by a factor of e⁴ ≈ 55.
const REACH: f64 = 4.0;

/// A vehicle file under the sensors of a recording, with its positive numbers as parameters.
///
/// Free are all masses, inertias, stiffnesses and dampings that are not zero in the file (a zero says that the part is
/// absent), and the c.g.'s place between the axles. Held are the sprung mass, which sets the scale that responses can't
/// show, and the distances.
#[derive(Debug, Clone)]
pub struct ParametricVehicle {
    spec: Value,
    table: String,
    paths: Vec<Vec<String>>,
    names: Vec<String>,
    start: Vec<f64>,
    wheelbase_m: Option<f64>,
    channels: Vec<Channel>,
    wheels: Vec<WheelPlace>,
}

impl ParametricVehicle {
    /// The family of a file, and the derivative that each channel measures. `freed` names held fields to move as well.
    ///
    /// # Errors
    /// A vehicle that is wrong, a channel that it does not have, a name that is none.
    pub fn new(
        spec: &VehicleSpec,
        channels: &[Channel],
        wheels: &[WheelPlace],
        freed: &[String],
    ) -> Result<(Self, Vec<usize>), VehicleError> {
        let vehicle = spec.build_alone()?;
        let looks = channels.iter().map(|c| vehicle.sensor_row(c, wheels)).collect::<Result<Vec<_>, _>>()?;
        let value = serde_json::to_value(spec).unwrap_or(Value::Null);
        let table = spec.model.name().to_owned();
        let mut this = ParametricVehicle {
            wheelbase_m: None,
            paths: Vec::new(),
            names: Vec::new(),
            start: Vec::new(),
            channels: channels.to_vec(),
            wheels: wheels.to_vec(),
            table: table.clone(),
            spec: value.clone(),
        };
        let mut leaves = Vec::new();
        collect(&value[&table], &mut Vec::new(), &mut leaves);
        for name in freed {
            if !leaves.iter().any(|(path, _)| path.join(".") == *name) {
                let known: Vec<String> = leaves.iter().map(|(path, _)| path.join(".")).collect();
                return Err(VehicleError::Unknown {
                    what: "parameter",
                    name: name.clone(),
                    suggestion: crate::files::nearest(name, known.iter().map(String::as_str))
                        .map(str::to_owned),
                    known: known.join(", "),
                });
            }
        }
        let number = |field: &str| value[&table][field].as_f64();
        if let (Some(a), Some(b)) = (number("front_axle_m"), number("rear_axle_m")) {
            this.wheelbase_m = Some(a + b);
        }
        for (path, v) in leaves {
            let name = path.join(".");
            let last = path.iter().rfind(|p| p.parse::<usize>().is_err()).map_or("", String::as_str);
            let held =
                HELD.contains(&last) && !(last == CG && this.wheelbase_m.is_some()) && !freed.contains(&name);
            if v > 0.0 && !held {
                this.paths.push(path);
                this.names.push(name);
                this.start.push(v);
            }
        }
        Ok((this, looks.into_iter().map(|(_, d)| d).collect()))
    }

    /// The file at given values of the parameters.
    ///
    /// # Errors
    /// Values that make no vehicle file.
    pub fn spec_at(&self, values: &[f64]) -> Result<VehicleSpec, String> {
        let mut spec = self.spec.clone();
        for (path, v) in self.paths.iter().zip(values) {
            let pointer = format!("/{}/{}", self.table, path.join("/"));
            let slot = spec.pointer_mut(&pointer).ok_or_else(|| format!("no field {pointer}"))?;
            *slot = Value::from(*v);
            if let (true, Some(l)) = (path[..] == [CG.to_owned()], self.wheelbase_m) {
                spec[&self.table]["rear_axle_m"] = Value::from(l - v);
            }
        }
        serde_json::from_value(spec).map_err(|e| e.to_string())
    }

    /// The vehicle at given values of the parameters.
    ///
    /// # Errors
    /// Values that make no vehicle.
    pub fn vehicle_at(&self, values: &[f64]) -> Result<Vehicle, String> {
        self.spec_at(values)?.build_alone().map_err(|e| e.to_string())
    }
}

impl Parametric for ParametricVehicle {
    fn names(&self) -> Vec<String> {
        self.names.clone()
    }

    fn start(&self) -> Vec<f64> {
        self.start.clone()
    }

    fn limits(&self) -> Vec<[f64; 2]> {
        let around = |v: &f64| [v * (-REACH).exp(), v * REACH.exp()];
        let mut limits: Vec<[f64; 2]> = self.start.iter().map(around).collect();
        if let (Some(i), Some(l)) =
            (self.paths.iter().position(|p| p[..] == [CG.to_owned()]), self.wheelbase_m)
        {
            limits[i] = CG_RANGE.map(|share| share * l);
        }
        limits
    }

    fn system(&self, values: &[f64]) -> Result<WheeledSystem, String> {
        let vehicle = self.vehicle_at(values)?;
        let rows = self
            .channels
            .iter()
            .map(|c| vehicle.sensor_row(c, &self.wheels).map(|(row, _)| row))
            .collect::<Result<Vec<_>, _>>()
            .map_err(|e| e.to_string())?;
        let n = vehicle.system().order();
        vehicle.wheeled(Mat::from_fn(rows.len(), n, |i, j| rows[i][j])).map_err(|e| e.to_string())
    }
}

/// All numbers of a table with their paths, in the file's order.
fn collect(value: &Value, path: &mut Vec<String>, into: &mut Vec<(Vec<String>, f64)>) {
    match value {
        Value::Number(n) => into.extend(n.as_f64().map(|v| (path.clone(), v))),
        Value::Object(map) => {
            for (key, v) in map {
                path.push(key.clone());
                collect(v, path, into);
                path.pop();
            }
        }
        Value::Array(items) => {
            for (i, v) in items.iter().enumerate() {
                path.push(i.to_string());
                collect(v, path, into);
                path.pop();
            }
        }
        _ => {}
    }
}
