//! A vehicle as a family over its own parameters: what a fit moves, and what it leaves alone.

use super::known::{apply, follow, leaves, names, of_scale, unknown};
use super::multi_axle::Layout;
use super::{Model, Vehicle, VehicleError, VehicleSpec};
use crate::linalg::Mat;
use crate::lti::{Parametric, WheeledSystem};
use crate::signal::{Channel, WheelPlace};
use serde_json::Value;

/// Fields that a fit does not move: the mass that sets the scale, and what a tape measure gives.
const HELD: [&str; 8] =
    [SPRUNG_MASS, CG, "rear_axle_m", "front_track_m", "rear_track_m", CG_LEFT, "driver_m", "cabin_mass_kg"];
/// What sets the scale where nothing else is known.
/// What holds the scale where no value is known.
pub(crate) const SPRUNG_MASS: &str = "sprung_mass_kg";
/// The longitudinal place of the c.g. between the axles: moved at a fixed wheelbase.
pub(super) const CG: &str = "front_axle_m";
/// The lateral place of the c.g., the one number that may be negative.
const CG_LEFT: &str = "cg_left_m";
/// What may differ from left to right in an asymmetric family.
const PER_CORNER: [&str; 5] = [
    "tire_damping_n_s_per_m",
    "unsprung_mass_kg",
    "suspension_stiffness_n_per_m",
    "suspension_damping_n_s_per_m",
    "tire_stiffness_n_per_m",
];

/// Where the c.g. may be, as shares of the wheelbase behind the front axle.
const CG_RANGE: [f64; 2] = [0.1, 0.9];
/// How far the c.g. may be from the middle, as a share of the narrower track.
const CG_LEFT_REACH: f64 = 0.2;
/// Other parameters may move by a factor of e⁴ ≈ 55.
const REACH: f64 = 4.0;
/// What a vehicle may be without, and how much further such a number may move: a start does not know its size.
const MAY_VANISH: [&str; 2] = ["tire_damping_n_s_per_m", "anti_roll_stiffness_n_m_per_rad"];
const VANISHING_REACH: f64 = 9.0;

/// A vehicle under the sensors of a recording, with its numbers as positive parameters.
///
/// Free are all masses, inertias, stiffnesses and dampings that are not zero at the start (a zero says that the part is
/// absent), and the c.g.'s place between the axles. Held are the sprung mass, which sets the scale that responses can't
/// show, and the distances.
///
/// The lateral place of the c.g. y (`cg_left_m`, where it is freed) may be negative; its parameter `cg_left_ratio` is
/// e^(y/W) with W the narrower track: 1 on the middle line, and a step in its logarithm is a step in y.
/// [`ParametricVehicle::physical`] gives y back.
#[derive(Debug, Clone)]
pub struct ParametricVehicle {
    template: Template,
    fields: Vec<Field>,
    held: Vec<String>,
    freed: Vec<String>,
    wheelbase_m: Option<f64>,
    track_m: Option<f64>,
    channels: Vec<Channel>,
    wheels: Vec<WheelPlace>,
}

/// Numbers, and how they become a vehicle file.
#[derive(Debug, Clone)]
pub(super) enum Template {
    /// A file of a model with parameters of its own.
    File(Box<VehicleSpec>),
    /// A body on any axles: its numbers under the names of [`MultiAxle`](super::multi_axle::MultiAxle), and the wheels.
    Axles(Value, Layout),
}

/// One free number.
#[derive(Debug, Clone)]
struct Field {
    path: Vec<String>,
    name: String,
    start: f64,
}

impl Field {
    fn may_vanish(&self) -> bool {
        MAY_VANISH.iter().any(|name| self.path.iter().any(|p| p == name))
    }

    fn is_one_side(&self) -> bool {
        self.path.last().is_some_and(|p| p.parse::<usize>().is_ok())
    }

    fn is_lateral(&self) -> bool {
        self.path[..] == [CG_LEFT.to_owned()]
    }
}

impl Template {
    /// Its numbers.
    fn table(&self) -> Result<Value, VehicleError> {
        match self {
            Template::Axles(value, _) => Ok(value.clone()),
            Template::File(spec) => {
                let mut file = serde_json::to_value(spec).map_err(|e| VehicleError::Field {
                    field: spec.model.name().into(),
                    expected: "numbers that can be written",
                    found: e.to_string(),
                })?;
                let mut table = file[spec.model.name()].take();
                if let (Model::FullCar, Some(table)) = (spec.model, table.as_object_mut()) {
                    // a zero is left out of files, but it may be freed
                    table.entry(CG_LEFT).or_insert_with(|| Value::from(0.0));
                }
                Ok(table)
            }
        }
    }

    /// The file with these numbers.
    fn spec(&self, table: Value) -> Result<VehicleSpec, String> {
        match self {
            Template::Axles(_, layout) => layout.spec(table),
            Template::File(spec) => {
                let mut file = serde_json::to_value(spec).map_err(|e| e.to_string())?;
                file[spec.model.name()] = table;
                serde_json::from_value(file).map_err(|e| e.to_string())
            }
        }
    }

    fn with_table(&self, table: Value) -> Result<Self, String> {
        Ok(match self {
            Template::Axles(_, layout) => Template::Axles(table, layout.clone()),
            Template::File(_) => Template::File(Box::new(self.spec(table)?)),
        })
    }
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
        Self::with_known(spec, channels, wheels, freed, &[])
    }

    /// As [`ParametricVehicle::new`], with values that are `known`: such a field is held at the value given. A name
    /// without its axle means every axle, one without its side both sides.
    ///
    /// A fit is linear: damper curves of the file are left out, and so of its results.
    ///
    /// Where a mass, inertia, stiffness or damping other than the sprung mass is known, it sets the scale, and the
    /// sprung mass is free.
    ///
    /// # Errors
    /// As [`ParametricVehicle::new`]; a known value that makes no vehicle.
    pub fn with_known(
        spec: &VehicleSpec,
        channels: &[Channel],
        wheels: &[WheelPlace],
        freed: &[String],
        known: &[(String, f64)],
    ) -> Result<(Self, Vec<usize>), VehicleError> {
        let linear = Box::new(spec.without_damper_curves());
        Self::from_template(Template::File(linear), channels, wheels, freed, known, false)
    }

    /// `rescale`: the start's scale is nobody's knowledge, and follows the known values.
    pub(super) fn from_template(
        template: Template,
        channels: &[Channel],
        wheels: &[WheelPlace],
        freed: &[String],
        known: &[(String, f64)],
        rescale: bool,
    ) -> Result<(Self, Vec<usize>), VehicleError> {
        let mut table = template.table()?;
        let found = leaves(&table);
        for name in freed {
            if !found.iter().any(|(path, _)| path.join(".") == *name) {
                return Err(unknown(name, &found));
            }
        }
        for (name, value) in known {
            apply(&mut table, name, *value, &found)?;
        }
        if rescale {
            follow(&mut table, known, &found);
        }
        let template = template.with_table(table.clone()).map_err(|e| no_vehicle(&e))?;
        let mut freed = freed.to_vec();
        if known.iter().any(|(n, v)| *v > 0.0 && of_scale(n)) && !known.iter().any(|(n, _)| n == SPRUNG_MASS)
        {
            freed.push(SPRUNG_MASS.to_owned());
        }
        let number = |field: &str| table[field].as_f64();
        let wheelbase_m = match &template {
            Template::Axles(_, layout) => layout.wheelbase_m(),
            Template::File(_) => number(CG).zip(number("rear_axle_m")).map(|(a, b)| a + b),
        };
        let track_m = match &template {
            Template::Axles(_, layout) => layout.track_m(),
            Template::File(_) => number("front_track_m").zip(number("rear_track_m")).map(|(f, r)| f.min(r)),
        };
        let held = known.iter().map(|(n, _)| n.clone()).collect();
        let (channels, wheels) = (channels.to_vec(), wheels.to_vec());
        let mut this = ParametricVehicle {
            template,
            fields: vec![],
            held,
            freed,
            wheelbase_m,
            track_m,
            channels,
            wheels,
        };
        this.collect_fields()?;
        let derivatives = this.look()?;
        Ok((this, derivatives))
    }

    /// A leaf as a free number, if it is one.
    fn field(&self, path: Vec<String>, value: f64) -> Option<Field> {
        let name = path.join(".");
        let last = path.iter().rfind(|p| p.parse::<usize>().is_err()).map_or("", String::as_str);
        if self.held.iter().any(|k| names(k, &path)) {
            return None;
        }
        if self.freed.contains(&name) && last == CG_LEFT {
            let start = (value / self.track_m?).exp();
            return Some(Field { path, name: "cg_left_ratio".into(), start });
        }
        let moves = last == CG && self.wheelbase_m.is_some();
        let held = HELD.contains(&last) && !moves && !self.freed.contains(&name);
        (value > 0.0 && !held).then_some(Field { path, name, start: value })
    }

    /// Builds the start and asks it for every channel: the derivatives.
    fn look(&self) -> Result<Vec<usize>, VehicleError> {
        let spec = self.spec_at(&self.start()).map_err(|e| no_vehicle(&e))?;
        let vehicle = spec.build_alone()?;
        self.channels.iter().map(|c| vehicle.sensor_row(c, &self.wheels).map(|(_, d)| d)).collect()
    }

    /// The asymmetric family that starts at given values of this one: unsprung mass, suspension stiffness and damping
    /// and tire stiffness and damping of each corner on its own, and the c.g. off the middle. What is held stays held.
    ///
    /// A vehicle of one track has no other side: its family comes back with these values as start.
    ///
    /// # Errors
    /// Values that make no vehicle.
    pub fn asymmetric_at(&self, values: &[f64]) -> Result<Self, String> {
        let (template, freed) = self.split(values).map_err(|e| e.to_string())?;
        let mut this = ParametricVehicle { template, fields: vec![], freed, ..self.clone() };
        this.collect_fields().map_err(|e| e.to_string())?;
        this.look().map_err(|e| e.to_string())?;
        Ok(this)
    }

    /// The numbers with left and right written apart, and what is freed.
    pub(super) fn split(&self, values: &[f64]) -> Result<(Template, Vec<String>), VehicleError> {
        let mut table = self.table_at(values).map_err(|e| no_vehicle(&e))?;
        let mut freed = self.freed.clone();
        if let (Some(_), Some(fields)) = (self.track_m, table.as_object_mut()) {
            for (axle, of_axle) in fields.iter_mut().filter_map(|(n, v)| v.as_object_mut().map(|o| (n, o))) {
                let pair = match &self.template {
                    Template::Axles(_, layout) => layout.is_pair(axle),
                    Template::File(_) => true,
                };
                for field in PER_CORNER {
                    if let (true, Some(v)) = (pair, of_axle.get(field).and_then(Value::as_f64)) {
                        of_axle.insert(field.to_owned(), Value::from(vec![v, v]));
                    }
                }
            }
            if !freed.iter().any(|f| f == CG_LEFT) {
                freed.push(CG_LEFT.to_owned());
            }
        }
        Ok((self.template.with_table(table).map_err(|e| no_vehicle(&e))?, freed))
    }

    fn collect_fields(&mut self) -> Result<(), VehicleError> {
        let found = leaves(&self.template.table()?);
        self.fields = found.into_iter().filter_map(|(path, value)| self.field(path, value)).collect();
        Ok(())
    }

    /// The vehicle's own name of parameter `index`, its value there at a value of the parameter, and its derivative by
    /// the parameter: the same name, value and 1 but for `cg_left_ratio`, which is `cg_left_m` = W ln(ratio).
    #[must_use]
    pub fn physical(&self, index: usize, value: f64) -> Option<(String, f64, f64)> {
        let field = self.fields.get(index)?;
        match self.track_m.filter(|_| field.is_lateral()) {
            Some(w) => Some((CG_LEFT.to_owned(), w * value.ln(), w / value)),
            None => Some((field.name.clone(), value, 1.0)),
        }
    }

    fn table_at(&self, values: &[f64]) -> Result<Value, String> {
        if values.len() != self.fields.len() {
            return Err(format!("expected {} values, found {}", self.fields.len(), values.len()));
        }
        let mut table = self.template.table().map_err(|e| e.to_string())?;
        for (index, (field, v)) in self.fields.iter().zip(values).enumerate() {
            let pointer = format!("/{}", field.path.join("/"));
            let slot = table.pointer_mut(&pointer).ok_or_else(|| format!("no field {pointer}"))?;
            *slot = Value::from(self.physical(index, *v).map_or(*v, |(_, value, _)| value));
            // a body on axles has no distance to the rear: its wheels say the wheelbase
            let both_ends = field.path[..] == [CG.to_owned()] && table.get("rear_axle_m").is_some();
            if let (true, Some(l)) = (both_ends, self.wheelbase_m) {
                table["rear_axle_m"] = Value::from(l - v);
            }
        }
        Ok(table)
    }

    /// The file at given values of the parameters.
    ///
    /// # Errors
    /// Values that make no vehicle file.
    pub fn spec_at(&self, values: &[f64]) -> Result<VehicleSpec, String> {
        self.template.spec(self.table_at(values)?)
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
        self.fields.iter().map(|f| f.name.clone()).collect()
    }

    fn start(&self) -> Vec<f64> {
        self.fields.iter().map(|f| f.start).collect()
    }

    fn limits(&self) -> Vec<[f64; 2]> {
        self.fields
            .iter()
            .map(|f| match self.wheelbase_m {
                _ if f.is_lateral() => [(-CG_LEFT_REACH).exp(), CG_LEFT_REACH.exp()],
                Some(l) if f.path[..] == [CG.to_owned()] => CG_RANGE.map(|share| share * l),
                _ => {
                    let reach = if f.may_vanish() { VANISHING_REACH } else { REACH };
                    [f.start * (-reach).exp(), f.start * reach.exp()]
                }
            })
            .collect()
    }

    /// Of the whole vehicle or an axle; a part that only one side lacks is a search gone astray.
    fn may_vanish(&self) -> Vec<bool> {
        self.fields.iter().map(|f| f.may_vanish() && !f.is_one_side()).collect()
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

fn no_vehicle(why: &str) -> VehicleError {
    let field = "parameters".to_owned();
    VehicleError::Field { field, expected: "values that make a vehicle", found: why.to_owned() }
}
