//! From a design's words to its plant: outputs, measurements, weights over passive norms.

pub(super) use super::design_measure::Norm;
use super::design_measure::floor;
use super::design_outputs::{
    Lasts, damped, decays, finite, held, no_own_output, once, outputs, settles, settling, shown,
};
use super::design_states::states;
use super::ground::{Ground, ground_of};
use super::{
    DesignMethod, DesignSpec, LoadedExcitation, LoadedVehicle, Named, StudyError, load_excitation,
    load_vehicle,
};
use crate::lti::{GeneralizedPlant, LtiError};
use crate::vehicle::{Output, PlantError, PlantSettings, Vehicle, VehicleSpec};

/// A design made ready.
#[derive(Clone)]
pub(super) struct Problem {
    pub spec: DesignSpec,
    /// The vehicle's file, overrides in it.
    pub file: VehicleSpec,
    /// What a cabin stands on.
    pub chassis: Option<VehicleSpec>,
    pub vehicle: Vehicle,
    pub ground: Ground,
    /// Outputs with a finite response, all of the vehicle's: what is reported.
    pub reported: Vec<Output>,
    pub measurements: Vec<Output>,
    /// Blocks of outputs that are minimised: name, members among `reported`, the weight, the passive norm of the block.
    pub goals: Vec<GoalBlock>,
    /// H∞ norms of the methods by inequalities.
    pub peaks: Vec<PeakBlock>,
    /// H2 norms that are bounded.
    pub bounded: Vec<GoalBlock>,
    /// Performances `reported`, measurements.
    pub plant: GeneralizedPlant,
    pub inputs: Vec<super::Input>,
}

/// A stacked vector, or one output, and its weight or bound.
#[derive(Clone)]
pub(super) struct GoalBlock {
    pub name: String,
    pub members: Vec<usize>,
    pub weight: f64,
    pub passive: f64,
}

/// The same of an H∞ norm, with its bound.
#[derive(Clone)]
pub(super) struct PeakBlock {
    pub block: GoalBlock,
    /// As a multiple of the passive norm.
    pub bound: Option<f64>,
}

impl Problem {
    /// Of the vehicle and the road that the spec names.
    pub fn new(spec: &DesignSpec, norm: Norm) -> Result<Self, StudyError> {
        Problem::on(spec, norm, load_vehicle(&spec.vehicle)?, load_excitation(&spec.road)?)
    }

    /// Of a vehicle and a road that are at hand; the spec has their names.
    pub fn on(
        spec: &DesignSpec,
        norm: Norm,
        loaded: LoadedVehicle,
        road: LoadedExcitation,
    ) -> Result<Self, StudyError> {
        let (ground, standing, road_inputs) = ground_of(&loaded, road, spec.speed_m_s)?;
        if spec.method == DesignMethod::Interpolation && loaded.spec.quarter_car.is_none() {
            return Err(StudyError::Setting {
                field: "vehicle",
                expected: "a quarter car: interpolation is exact in its polynomials".into(),
                found: loaded.spec.model.name().into(),
            });
        }
        let weights = spec.weights()?;
        let peaks = spec.hinf_parts()?;
        let by_poles = spec.method.is_by_inequalities();
        if weights.is_empty()
            && peaks.is_empty()
            && spec.goal.bound_h2.is_empty()
            && !(by_poles && spec.poles.is_some())
        {
            let poles = if by_poles { ", bounds, or poles" } else { ", or bounds" };
            return Err(StudyError::Setting {
                field: "goal.minimize",
                expected: format!("outputs and their weights{poles}"),
                found: "none".into(),
            });
        }
        let of_file = |source| StudyError::Vehicle { name: spec.vehicle.clone(), source };
        let build = |more: &Named<f64>| -> Result<Vehicle, StudyError> {
            if spec.r#override.is_empty() && more.is_empty() {
                return Ok(standing.clone());
            }
            // one after the other: a bare name of the second replaces a specific one of the first
            let own = loaded.spec.with_overrides(&fields(&spec.r#override));
            let changed = own.and_then(|own| own.with_overrides(&fields(more))).map_err(of_file)?;
            ground.vehicle(&changed, loaded.chassis.as_ref()).map_err(of_file)
        };
        let file =
            loaded.spec.with_overrides(&fields(&spec.r#override)).map_err(|e| StudyError::Setting {
                field: "override",
                expected: format!("numbers of the file of {}", spec.vehicle),
                found: format!("others: {e}"),
            })?;
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
        let mut measurements = outputs(&vehicle, &spec.measurements, "measurements")?;
        once(&vehicle, &spec.measurements, "measurements")?;
        no_own_output(&measurements)?;
        if measurements.is_empty() && spec.method == DesignMethod::RobustStateFeedback {
            measurements = states(&vehicle, &settings).map_err(plant_error)?;
        }
        if measurements.is_empty() {
            return Err(StudyError::Setting {
                field: "measurements",
                expected: "what the controller sees: outputs of the vehicle".into(),
                found: "none".into(),
            });
        }
        let groups = &spec.goal.groups;
        if let Some((name, _)) = groups
            .iter()
            .find(|(name, _)| vehicle.outputs().iter().any(|o| o.name == *name || o.base == *name))
        {
            return Err(StudyError::Setting {
                field: "goal.groups",
                expected: "names that are not outputs of the vehicle".into(),
                found: format!("`{name}`"),
            });
        }
        if let Some((name, own)) = groups.iter().find_map(|(name, members)| {
            members.iter().find(|m| groups.get(m).is_some()).map(|own| (name, own))
        }) {
            return Err(StudyError::Setting {
                field: "goal.groups",
                expected: "outputs of the vehicle in each group, and no other group".into(),
                found: format!("`{own}` in `{name}`"),
            });
        }
        let members_of =
            |names: &[&str]| names.iter().flat_map(|n| spec.members_of(n)).collect::<Vec<String>>();
        let squared: Vec<&str> = weights.iter().chain(spec.goal.bound_h2.iter()).map(|(n, _)| n).collect();
        let bounded: Vec<&str> = peaks.iter().map(|p| p.name.as_str()).collect();
        let in_groups: Vec<&str> = groups.iter().map(|(n, _)| n).collect();
        outputs(&vehicle, &members_of(&in_groups), "goal.groups")?;
        for (field, list) in spec.goal.lists() {
            outputs(&vehicle, &members_of(&list.iter().map(|(n, _)| n).collect::<Vec<_>>()), field)?;
        }
        let in_h2 = outputs(&vehicle, &members_of(&squared), "goal.minimize")?;
        let in_hinf = outputs(&vehicle, &members_of(&bounded), "goal.bound")?;
        let mut wanted = in_h2.clone();
        wanted.extend(in_hinf.into_iter().filter(|o| !in_h2.contains(o)));
        let names: Vec<String> = members_of(&squared.iter().chain(&bounded).copied().collect::<Vec<_>>());
        // a wanted output that can't be a performance is an error; of the others, those that can be are shown
        let y: Vec<&Output> = measurements.iter().collect();
        let made = vehicle.plant(&wanted.iter().collect::<Vec<_>>(), &y, &settings);
        if let Err(PlantError::Linalg(_)) = &made {
            held(&vehicle, spec)?;
        }
        made.map_err(plant_error)?;
        // a controller that is searched may be for a vehicle that is not stable without it, if goals are over another one's norms
        let normalized = if spec.normalize_at.is_empty() { None } else { Some(build(&spec.normalize_at)?) };
        let other = normalized.as_ref().filter(|_| spec.method == DesignMethod::FixedOrder);
        let judged = other.unwrap_or(&vehicle);
        let alone = judged.plant(&[], &[], &settings).map_err(plant_error)?.order();
        let lasts = |output: &Output| -> Result<Option<Lasts>, PlantError> {
            let own = judged.output(&output.name).unwrap_or(output);
            let plant = judged.plant(&[own], &[], &settings)?;
            // only what follows a height has a state for it
            let why = if plant.order() > alone { Lasts::Follows } else { Lasts::Unresolved };
            Ok((!settles(&plant)).then_some(why))
        };
        let dies_away = |output: &Output| lasts(output).map(|why| why.is_none());
        let lasting = |of: &[Output], asked: &[String]| -> Result<Vec<(String, Lasts)>, StudyError> {
            let mut found: Vec<(String, Lasts)> = Vec::new();
            for output in of {
                let Some(why) = lasts(output).map_err(plant_error)? else { continue };
                // corners stand or fall together: by the name that was asked for
                let whole = asked.contains(&output.base);
                let name = if whole { &output.base } else { &output.name };
                if !found.iter().any(|(n, _)| n == name) {
                    found.push((name.clone(), why));
                }
            }
            Ok(found)
        };
        let [wandering, seen] = [lasting(&wanted, &names)?, lasting(&measurements, &spec.measurements)?];
        if !(wandering.is_empty() && seen.is_empty()) {
            damped(judged, Some(&file).filter(|_| other.is_none()), spec)?;
        }
        settling(spec, &wandering, &seen)?;
        let reported: Vec<Output> = vehicle
            .outputs()
            .iter()
            .filter(|o| wanted.contains(o) || (shown(o) && dies_away(o).is_ok_and(|dies| dies)))
            .cloned()
            .collect();
        let z: Vec<&Output> = reported.iter().collect();
        let plant = vehicle.plant(&z, &y, &settings).map_err(plant_error)?;
        let reference = match &normalized {
            None => plant.passive(),
            Some(other) => {
                let z = z.iter().map(|o| other.output(&o.name)).collect::<Result<Vec<_>, _>>();
                other.plant(&z.map_err(of_file)?, &[], &settings).map_err(plant_error)?.passive()
            }
        };
        if !decays(&reference) {
            let all: Vec<_> = names.iter().map(|n| (n.clone(), Lasts::Unresolved)).collect();
            settling(spec, &all, &[])?;
        }
        if norm == Norm::H2 && !in_h2.is_empty() {
            finite(
                spec,
                &in_h2,
                &vehicle.plant(&in_h2.iter().collect::<Vec<_>>(), &[], &settings).map_err(plant_error)?,
            )?;
        }
        let block = |name: &str, weight: f64, norm: Norm| -> Result<GoalBlock, StudyError> {
            let own = spec.members_of(name);
            let members: Vec<usize> = (0..reported.len())
                .filter(|i| own.contains(&reported[*i].name) || own.contains(&reported[*i].base))
                .collect();
            let passive = norm.of(&reference, &members).map_err(design_error)?;
            let still = own.iter().map(|n| floor(&reported, &reference, n)).fold(0.0, f64::max);
            if !(passive > still) {
                return Err(StudyError::Setting {
                    field: spec.goal.field_of(name),
                    expected:
                        "outputs that this road moves (with coherence full, left and right tracks are alike)"
                            .into(),
                    found: format!("`{name}`, which stands still"),
                });
            }
            Ok(GoalBlock { name: name.to_owned(), members, weight, passive })
        };
        let of_h2 = |named: &Named<f64>, norm| {
            named.iter().map(|(name, v)| block(name, *v, norm)).collect::<Result<Vec<_>, _>>()
        };
        let goals = of_h2(&weights, norm)?;
        let bounded = of_h2(&spec.goal.bound_h2, Norm::H2)?;
        let peaks = peaks
            .iter()
            .map(|p| {
                let block = block(&p.name, p.weight, Norm::Hinf)?;
                Ok(PeakBlock { block, bound: p.bound })
            })
            .collect::<Result<Vec<_>, StudyError>>()?;
        let inputs = loaded.inputs.into_iter().chain(road_inputs).collect();
        Ok(Problem {
            spec: spec.clone(),
            file,
            chassis: loaded.chassis,
            vehicle,
            ground,
            reported,
            measurements,
            goals,
            peaks,
            bounded,
            plant,
            inputs,
        })
    }
}

/// Fields and their values as a vehicle file takes them.
fn fields(named: &Named<f64>) -> Vec<(String, f64)> {
    named.iter().map(|(n, v)| (n.to_owned(), *v)).collect()
}
