//! From a design's words to its plant: outputs, measurements, weights over passive norms.

pub(super) use super::design_measure::Norm;
use super::design_measure::floor;
use super::design_outputs::{finite, once, outputs, settles, settling, shown};
use super::ground::{Ground, ground};
use super::{DesignMethod, DesignSpec, Named, StudyError, load_vehicle};
use crate::lti::{GeneralizedPlant, LtiError};
use crate::vehicle::{Output, PlantSettings, Vehicle, VehicleSpec};

/// A design made ready.
pub(super) struct Problem {
    pub spec: DesignSpec,
    /// The vehicle's file, overrides in it.
    pub file: VehicleSpec,
    pub vehicle: Vehicle,
    pub ground: Ground,
    /// Outputs with a finite response, all of the vehicle's: what is reported.
    pub reported: Vec<Output>,
    pub measurements: Vec<Output>,
    /// Blocks of outputs that are minimised: name, members among `reported`, the weight, the passive norm of the block.
    pub goals: Vec<GoalBlock>,
    /// Performances `reported`, measurements.
    pub plant: GeneralizedPlant,
    pub inputs: Vec<super::Input>,
}

/// A stacked vector, or one output.
pub(super) struct GoalBlock {
    pub name: String,
    pub members: Vec<usize>,
    pub weight: f64,
    pub passive: f64,
}

impl Problem {
    pub fn new(spec: &DesignSpec, norm: Norm) -> Result<Self, StudyError> {
        let loaded = load_vehicle(&spec.vehicle)?;
        let (ground, standing, road_inputs) = ground(&loaded, &spec.road, spec.speed_m_s)?;
        if spec.method == DesignMethod::Interpolation && loaded.spec.quarter_car.is_none() {
            return Err(StudyError::Setting {
                field: "vehicle",
                expected: "a quarter car: interpolation is exact in its polynomials".into(),
                found: loaded.spec.model.name().into(),
            });
        }
        let weights = spec.weights()?;
        let of_file = |source| StudyError::Vehicle { name: spec.vehicle.clone(), source };
        let build = |more: &Named<f64>| -> Result<Vehicle, StudyError> {
            let all: Vec<(String, f64)> =
                spec.r#override.iter().chain(more.iter()).map(|(n, v)| (n.to_owned(), *v)).collect();
            if all.is_empty() {
                return Ok(standing.clone());
            }
            let changed = loaded.spec.with_overrides(&all).map_err(of_file)?;
            ground.vehicle(&changed, loaded.chassis.as_ref()).map_err(of_file)
        };
        let overrides: Vec<(String, f64)> = spec.r#override.iter().map(|(n, v)| (n.to_owned(), *v)).collect();
        let file = loaded.spec.with_overrides(&overrides).map_err(of_file)?;
        let vehicle = build(&Named::default())?;
        let settings = PlantSettings {
            road: ground.excitation(),
            speed_m_s: spec.speed_m_s,
            disturbance: spec.disturbance.into(),
            delay_order: spec.delay_order,
        };
        let design_error =
            |e: LtiError| StudyError::Design { name: spec.vehicle.clone(), source: Box::new(e.into()) };
        let plant_error = |source| StudyError::Plant { name: spec.vehicle.clone(), source: Box::new(source) };
        let measurements = outputs(&vehicle, &spec.measurements, "measurements")?;
        once(&vehicle, &spec.measurements)?;
        if measurements.is_empty() {
            return Err(StudyError::Setting {
                field: "measurements",
                expected: "what the controller sees: outputs of the vehicle".into(),
                found: "none".into(),
            });
        }
        let names: Vec<String> = weights.iter().map(|(n, _)| n.to_owned()).collect();
        let wanted = outputs(&vehicle, &names, "goal.minimize")?;
        // a wanted output that can't be a performance is an error; of the others, those that can be are shown
        let y: Vec<&Output> = measurements.iter().collect();
        vehicle.plant(&wanted.iter().collect::<Vec<_>>(), &y, &settings).map_err(plant_error)?;
        let mut wandering = Vec::new();
        for output in &wanted {
            if !settles(&vehicle.plant(&[output], &[], &settings).map_err(plant_error)?) {
                // corners stand or fall together: by the name that was asked for
                let whole = names.contains(&output.base);
                let name = if whole { output.base.as_str() } else { output.name.as_str() };
                if !wandering.contains(&name) {
                    wandering.push(name);
                }
            }
        }
        settling(spec, &wandering)?;
        let reported: Vec<Output> = vehicle
            .outputs()
            .iter()
            .filter(|o| {
                wanted.contains(o)
                    || (shown(o) && vehicle.plant(&[o], &[], &settings).is_ok_and(|p| settles(&p)))
            })
            .cloned()
            .collect();
        let z: Vec<&Output> = reported.iter().collect();
        let plant = vehicle.plant(&z, &y, &settings).map_err(plant_error)?;
        let reference = if spec.normalize_at.is_empty() {
            plant.passive()
        } else {
            let other = build(&spec.normalize_at)?;
            let z =
                z.iter().map(|o| other.output(&o.name)).collect::<Result<Vec<_>, _>>().map_err(of_file)?;
            other.plant(&z, &[], &settings).map_err(plant_error)?.passive()
        };
        if !reference.is_stable().map_err(design_error)? {
            settling(spec, &names.iter().map(String::as_str).collect::<Vec<_>>())?;
        }
        if norm == Norm::H2 {
            finite(
                spec,
                &wanted,
                &vehicle.plant(&wanted.iter().collect::<Vec<_>>(), &[], &settings).map_err(plant_error)?,
            )?;
        }
        let mut goals = Vec::new();
        for (name, weight) in weights.iter() {
            let members: Vec<usize> = (0..reported.len())
                .filter(|i| reported[*i].name == name || reported[*i].base == name)
                .collect();
            let passive = norm.of(&reference, &members).map_err(design_error)?;
            if !(passive > floor(&reported, &reference, name)) {
                return Err(StudyError::Setting {
                    field: "goal.minimize",
                    expected:
                        "outputs that this road moves (with coherence full, left and right tracks are alike)"
                            .into(),
                    found: format!("`{name}`, which stands still"),
                });
            }
            goals.push(GoalBlock { name: name.to_owned(), members, weight: *weight, passive });
        }
        let inputs = loaded.inputs.into_iter().chain(road_inputs).collect();
        Ok(Problem {
            spec: spec.clone(),
            file,
            vehicle,
            ground,
            reported,
            measurements,
            goals,
            plant,
            inputs,
        })
    }

    /// The plant whose performances are the goals, weighted over their passive norms.
    pub fn weighted(&self) -> Result<GeneralizedPlant, LtiError> {
        let mut names: Vec<&str> = Vec::new();
        let mut factors = Vec::new();
        for goal in &self.goals {
            for i in &goal.members {
                names.push(&self.reported[*i].name);
                factors.push(goal.weight / goal.passive);
            }
        }
        let y: Vec<&str> = self.measurements.iter().map(|o| o.name.as_str()).collect();
        self.plant.select(&names, &y)?.with_weights(&factors)
    }

    /// Stacked vectors and single outputs, in the vehicle's order.
    pub fn blocks(&self) -> Vec<(String, Vec<usize>)> {
        let mut blocks: Vec<(String, Vec<usize>)> = Vec::new();
        for (i, output) in self.reported.iter().enumerate() {
            if output.base != output.name && !blocks.iter().any(|(n, _)| *n == output.base) {
                let members = (0..self.reported.len()).filter(|k| self.reported[*k].base == output.base);
                blocks.push((output.base.clone(), members.collect()));
            }
            blocks.push((output.name.clone(), vec![i]));
        }
        blocks
    }

    /// Units of stacked vectors and single outputs.
    pub fn units(&self) -> Named<String> {
        let unit = |(name, members): (String, Vec<usize>)| {
            let unit = members.first().map_or("", |i| self.reported[*i].unit);
            (name, unit.to_owned())
        };
        self.blocks().into_iter().map(unit).collect()
    }
}
