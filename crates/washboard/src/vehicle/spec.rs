//! Vehicles as they are written in files.

use super::{
    ActuatorColumn, BounceTruck, FullCar, HalfCar, Matrices, OutputRow, QuarterCar, Response, TruckCabin,
    Vehicle, VehicleError, WheelRow,
};
use serde::{Deserialize, Serialize};

/// A vehicle file: `model`, and the table of that model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct VehicleSpec {
    /// Which table is meant.
    pub model: Model,
    /// `[quarter-car]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub quarter_car: Option<QuarterCar>,
    /// `[half-car]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub half_car: Option<HalfCar>,
    /// `[full-car]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub full_car: Option<FullCar>,
    /// `[truck-cabin]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub truck_cabin: Option<TruckCabin>,
    /// `[bounce-truck]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bounce_truck: Option<BounceTruck>,
    /// `[matrices]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub matrices: Option<Matrices>,
    /// `[response]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub response: Option<Response>,
    /// `[[wheel]]` of `matrices`, which may stand in its table too.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub wheel: Vec<WheelRow>,
    /// `[[output]]` of `matrices`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub output: Vec<OutputRow>,
    /// `[[actuator]]` of `matrices`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub actuator: Vec<ActuatorColumn>,
}

/// The models.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[allow(missing_docs)]
pub enum Model {
    QuarterCar,
    HalfCar,
    FullCar,
    TruckCabin,
    BounceTruck,
    Matrices,
    Response,
}

impl Model {
    /// As it is written.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Model::QuarterCar => "quarter-car",
            Model::HalfCar => "half-car",
            Model::FullCar => "full-car",
            Model::TruckCabin => "truck-cabin",
            Model::BounceTruck => "bounce-truck",
            Model::Matrices => "matrices",
            Model::Response => "response",
        }
    }
}

impl VehicleSpec {
    fn empty(model: Model) -> Self {
        VehicleSpec {
            model,
            quarter_car: None,
            half_car: None,
            full_car: None,
            truck_cabin: None,
            bounce_truck: None,
            matrices: None,
            response: None,
            wheel: Vec::new(),
            output: Vec::new(),
            actuator: Vec::new(),
        }
    }

    /// The vehicle. `chassis` answers the name of a truck cabin's chassis.
    ///
    /// # Errors
    /// A table that is missing or stray, or a value that is impossible, named `table.field`.
    pub fn build(
        &self,
        chassis: impl FnOnce(&str) -> Result<VehicleSpec, VehicleError>,
    ) -> Result<Vehicle, VehicleError> {
        let name = self.model.name();
        for (other, given) in [
            (Model::QuarterCar, self.quarter_car.is_some()),
            (Model::HalfCar, self.half_car.is_some()),
            (Model::FullCar, self.full_car.is_some()),
            (Model::TruckCabin, self.truck_cabin.is_some()),
            (Model::BounceTruck, self.bounce_truck.is_some()),
            (Model::Matrices, self.matrices.is_some()),
            (Model::Response, self.response.is_some()),
        ] {
            if given != (other == self.model) {
                return Err(VehicleError::Field {
                    field: format!("[{}]", other.name()),
                    expected: if given { "the table of the model only" } else { "the table of the model" },
                    found: format!("model = {name:?} and {} such table", if given { "a" } else { "no" }),
                });
            }
        }
        for (field, given) in [
            ("[[wheel]]", !self.wheel.is_empty()),
            ("[[output]]", !self.output.is_empty()),
            ("[[actuator]]", !self.actuator.is_empty()),
        ] {
            if given && self.model != Model::Matrices {
                let found = format!("model = {name:?}");
                return Err(VehicleError::Field {
                    field: field.into(),
                    expected: "model = \"matrices\" with it",
                    found,
                });
            }
        }
        let built = if let Some(v) = &self.quarter_car {
            v.assemble()
        } else if let Some(v) = &self.half_car {
            v.assemble()
        } else if let Some(v) = &self.full_car {
            v.assemble()
        } else if let Some(v) = &self.bounce_truck {
            v.assemble()
        } else if let Some(v) = &self.matrices {
            let mut v = v.clone();
            v.wheel.extend(self.wheel.iter().cloned());
            v.output.extend(self.output.iter().cloned());
            v.actuator.extend(self.actuator.iter().cloned());
            v.assemble()
        } else if let Some(v) = &self.response {
            v.assemble()
        } else if let Some(v) = &self.truck_cabin {
            let below = chassis(&v.chassis)?;
            let truck = below.bounce_truck.ok_or_else(|| VehicleError::Field {
                field: "chassis".into(),
                expected: "a vehicle of model bounce-truck",
                found: format!("{:?} of model {}", v.chassis, below.model.name()),
            })?;
            v.assemble(&truck)
        } else {
            // the loop above has found the model's table
            return Err(VehicleError::Field {
                field: format!("[{name}]"),
                expected: "the table of the model",
                found: "none".into(),
            });
        };
        built.map_err(|e| match e {
            VehicleError::Field { field, expected, found } => {
                VehicleError::Field { field: format!("{name}.{field}"), expected, found }
            }
            other => other,
        })
    }

    /// The same file without damper curves: what stands for them stays.
    #[must_use]
    pub fn without_damper_curves(&self) -> Self {
        let mut spec = self.clone();
        let axles = spec.full_car.as_mut().map(|c| [&mut c.front, &mut c.rear]).into_iter();
        let half = spec.half_car.as_mut().map(|c| [&mut c.front, &mut c.rear]).into_iter();
        axles.chain(half).flatten().for_each(|axle| axle.damper_curve = None);
        if let Some(car) = &mut spec.quarter_car {
            car.damper_curve = None;
        }
        spec
    }

    /// The vehicle of a model that needs no other file.
    ///
    /// # Errors
    /// As [`VehicleSpec::build`]; a truck cabin is refused.
    pub fn build_alone(&self) -> Result<Vehicle, VehicleError> {
        self.build(|name| {
            Err(VehicleError::Field {
                field: "chassis".into(),
                expected: "a chassis at hand",
                found: name.to_owned(),
            })
        })
    }
}

macro_rules! from_model {
    ($($type:ty, $model:expr, $field:ident;)*) => {$(
        impl From<$type> for VehicleSpec {
            fn from(v: $type) -> Self {
                VehicleSpec { $field: Some(v), ..VehicleSpec::empty($model) }
            }
        }
    )*};
}
from_model! {
    QuarterCar, Model::QuarterCar, quarter_car;
    HalfCar, Model::HalfCar, half_car;
    FullCar, Model::FullCar, full_car;
    TruckCabin, Model::TruckCabin, truck_cabin;
    BounceTruck, Model::BounceTruck, bounce_truck;
    Matrices, Model::Matrices, matrices;
    Response, Model::Response, response;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::parse_toml;
    use std::path::Path;

    #[test]
    fn wheels_and_outputs_of_matrices_stand_inside_or_after_the_table() {
        let head = "model = \"matrices\"\n[matrices]\nm = [[2.0]]\nc = [[3.0]]\nk = [[100.0]]\nwheel_stiffness = [[100.0]]\n";
        let tail = |at: &str| {
            format!(
                "{head}[[{at}wheel]]\nname = \"w\"\nat_m = [0.0, 0.0]\n[[{at}output]]\nname = \"y\"\nacceleration = [1.0]\n"
            )
        };
        let build = |text: &str| parse_toml::<VehicleSpec>(text, Path::new("v")).unwrap().build_alone();
        let (inside, after) = (build(&tail("matrices.")).unwrap(), build(&tail("")).unwrap());
        assert_eq!(inside, after);
        assert_eq!((after.wheels().len(), after.outputs()[0].name.as_str()), (1, "y"));
        let e = build(&tail("").replace("model = \"matrices\"", "model = \"quarter-car\"")).unwrap_err();
        assert!(e.to_string().contains("[quarter-car]"), "{e}");
    }
}
