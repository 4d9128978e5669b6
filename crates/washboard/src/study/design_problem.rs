//! From a design's words to its plant: outputs, measurements, weights over passive norms.

use super::design_outcome::{Gains, Measured};
use super::{
    DesignMethod, DesignSpec, Infinite, LoadedRoad, Named, Rms, StudyError, load_road, load_vehicle,
};
use crate::linalg::C64;
use crate::lti::{Continuous, GeneralizedPlant, LtiError, StateSpace};
use crate::units::rad_per_s;
use crate::vehicle::{Control, Output, PlantSettings, Ride, Variance, Vehicle, VehicleSpec};

/// Where gains are looked at, Hz, evenly in log f.
const GAINS_HZ: [f64; 2] = [0.05, 50.0];
const POINTS: usize = 240;

/// A design made ready.
pub(super) struct Problem {
    pub spec: DesignSpec,
    /// The vehicle's file, overrides in it.
    pub file: VehicleSpec,
    pub vehicle: Vehicle,
    pub road: LoadedRoad,
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
        let road = load_road(&spec.road)?;
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
                return Ok(loaded.vehicle.clone());
            }
            let chassis = loaded.chassis.clone();
            let changed = loaded.spec.with_overrides(&all).map_err(of_file)?;
            changed
                .build(|wanted| {
                    chassis.ok_or_else(|| crate::vehicle::VehicleError::Field {
                        field: "chassis".into(),
                        expected: "a vehicle file or case",
                        found: wanted.to_owned(),
                    })
                })
                .map_err(of_file)
        };
        let overrides: Vec<(String, f64)> = spec.r#override.iter().map(|(n, v)| (n.to_owned(), *v)).collect();
        let file = loaded.spec.with_overrides(&overrides).map_err(of_file)?;
        let vehicle = build(&Named::default())?;
        let settings = PlantSettings {
            road: &road.road,
            speed_m_s: spec.speed_m_s,
            disturbance: spec.disturbance.into(),
            delay_order: spec.delay_order,
        };
        let plant_error = |source| StudyError::Plant { name: spec.vehicle.clone(), source: Box::new(source) };
        let measurements = outputs(&vehicle, &spec.measurements, "measurements")?;
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
        for output in &wanted {
            let alone = vehicle.plant(&[output], &[], &settings).map_err(plant_error)?;
            if !settles(&alone) {
                return Err(StudyError::Setting {
                    field: "goal.minimize",
                    expected: "outputs that settle; on white road velocity a height wanders off (take another output, or a filtered road with disturbance road-noise)".into(),
                    found: format!("`{}`", output.name),
                });
            }
        }
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
        let mut goals = Vec::new();
        for (name, weight) in weights.iter() {
            let members: Vec<usize> = (0..reported.len())
                .filter(|i| reported[*i].name == name || reported[*i].base == name)
                .collect();
            let passive = norm
                .of(&reference, &members)
                .map_err(|e| StudyError::Design { name: spec.vehicle.clone(), source: Box::new(e.into()) })?;
            let floor = floor(&reported, &reference, name);
            if !(passive > floor) {
                return Err(StudyError::Setting {
                    field: "goal.minimize",
                    expected: "outputs that the road moves".into(),
                    found: format!("{name}, whose passive norm is {passive}"),
                });
            }
            goals.push(GoalBlock { name: name.to_owned(), members, weight: *weight, passive });
        }
        let inputs = loaded.inputs.into_iter().chain(road.inputs.clone()).collect();
        Ok(Problem { spec: spec.clone(), file, vehicle, road, reported, measurements, goals, plant, inputs })
    }

    /// What a passive H∞ norm must be above to be more than rounding.
    pub fn floor(&self, name: &str) -> f64 {
        floor(&self.reported, &self.plant.passive(), name)
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

    /// Norms and rms of the passive vehicle, or of the loop with a controller.
    pub fn measure(&self, controller: Option<&StateSpace<Continuous>>) -> Result<Measured, StudyError> {
        let design =
            |e: LtiError| StudyError::Design { name: self.spec.vehicle.clone(), source: Box::new(e.into()) };
        let closed = match controller {
            Some(k) => self.plant.close(k).map_err(design)?,
            None => self.plant.passive(),
        };
        let mut measured = Measured {
            poles: closed.poles().map_err(design)?.iter().map(|p| [p.re, p.im]).collect(),
            stable: closed.is_stable().map_err(design)?,
            ..Measured::default()
        };
        measured.poles.sort_by(|a, b| a[0].hypot(a[1]).total_cmp(&b[0].hypot(b[1])));
        if !measured.stable {
            return Ok(measured);
        }
        let inputs: Vec<usize> = (0..closed.inputs()).collect();
        for (name, members) in self.blocks() {
            let one = closed.select(&members, &inputs).map_err(design)?;
            let h2 = match one.h2_norm() {
                Ok(v) => Rms::Finite(v),
                Err(LtiError::NotStrictlyProper { .. }) => Rms::Infinite(Infinite::Infinite),
                Err(e) => return Err(design(e)),
            };
            let peak = one.hinf_norm().map_err(design)?;
            measured.h2.insert(&name, h2);
            measured.hinf.insert(&name, peak.norm);
            let at = peak.omega_rad_s;
            measured.hinf_at_rad_s.insert(&name, at.is_finite().then_some(at));
        }
        measured.rms = self.rms(controller)?;
        Ok(measured)
    }

    /// rms on the road, exact delays.
    fn rms(&self, controller: Option<&StateSpace<Continuous>>) -> Result<Named<Rms>, StudyError> {
        let fail = |source| StudyError::Ride { name: self.spec.vehicle.clone(), source };
        let control = controller
            .map(|k| {
                let y: Vec<String> = self.measurements.iter().map(|o| o.name.clone()).collect();
                let u: Vec<String> = self.vehicle.actuators().iter().map(|a| a.name.clone()).collect();
                Control::new(&self.vehicle, k.clone(), &y, &u)
            })
            .transpose()
            .map_err(|e| fail(e.into()))?;
        let (road, speed) = (&self.road.road, self.spec.speed_m_s);
        let ride = match &control {
            Some(c) => Ride::controlled(&self.vehicle, road, speed, c),
            None => Ride::new(&self.vehicle, road, speed),
        }
        .map_err(fail)?;
        let outputs: Vec<&Output> = self.reported.iter().collect();
        let variances = ride.variances(&outputs).map_err(fail)?;
        let blocks = self.blocks().into_iter().map(|(name, members)| {
            let sum = members.iter().map(|i| variances[*i]).try_fold(0.0, |sum, v| match v {
                Variance::Finite(v) => Some(sum + v.max(0.0)),
                Variance::Infinite(_) => None,
            });
            (name, sum.map_or(Rms::Infinite(Infinite::Infinite), |v| Rms::Finite(v.sqrt())))
        });
        Ok(blocks.collect())
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

    /// Gains over frequency.
    pub fn gains(&self, controller: Option<&StateSpace<Continuous>>) -> Result<Gains, StudyError> {
        let design =
            |e: LtiError| StudyError::Design { name: self.spec.vehicle.clone(), source: Box::new(e.into()) };
        let step = (GAINS_HZ[1] / GAINS_HZ[0]).ln() / (POINTS - 1) as f64;
        let freq_hz: Vec<f64> = (0..POINTS).map(|i| GAINS_HZ[0] * (step * i as f64).exp()).collect();
        let omegas: Vec<f64> = freq_hz.iter().map(|f| rad_per_s(*f)).collect();
        let of = |g: &StateSpace<Continuous>| -> Result<Named<Vec<f64>>, StudyError> {
            let responses = g.frequency_response(&omegas).map_err(design)?;
            let own = self.blocks().into_iter().map(|(name, members)| {
                let gain = |r: &crate::linalg::CMat| {
                    let rows: Vec<C64> = members
                        .iter()
                        .flat_map(|i| (0..r.ncols()).map(move |j| (*i, j)))
                        .map(|(i, j)| r[(i, j)])
                        .collect();
                    let block = crate::linalg::CMat::from_fn(members.len(), r.ncols(), |i, j| {
                        rows[i * r.ncols() + j]
                    });
                    block.singular_values().ok().and_then(|s| s.first().copied()).unwrap_or(f64::NAN)
                };
                (name, responses.iter().map(gain).collect())
            });
            Ok(own.collect())
        };
        let passive = of(&self.plant.passive())?;
        let closed = match controller {
            Some(k) => of(&self.plant.close(k).map_err(design)?)?,
            None => Named::default(),
        };
        Ok(Gains { freq_hz, passive, closed })
    }
}

/// What a symmetric vehicle cancels is a small share of what outputs of the same kind show.
fn floor(reported: &[Output], passive: &StateSpace<Continuous>, name: &str) -> f64 {
    const ROUNDING: f64 = 1e-9;
    let kind =
        |n: &str| ["acceleration", "travel", "deflection", "force"].into_iter().find(|k| n.contains(k));
    let alike: Vec<usize> = (0..reported.len()).filter(|i| kind(&reported[*i].name) == kind(name)).collect();
    ROUNDING * Norm::Hinf.of(passive, &alike).unwrap_or(0.0)
}

/// The norm that a method minimises.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Norm {
    H2,
    Hinf,
}

impl Norm {
    pub fn of(self, g: &StateSpace<Continuous>, members: &[usize]) -> Result<f64, LtiError> {
        let one = g.select(members, &(0..g.inputs()).collect::<Vec<_>>())?;
        match self {
            Norm::H2 => one.h2_norm(),
            Norm::Hinf => Ok(one.hinf_norm()?.norm),
        }
    }
}

/// What a suspension engineer looks at; displacements follow the road and say little.
fn shown(output: &Output) -> bool {
    ["acceleration", "travel", "deflection", "force"].iter().any(|word| output.base.contains(word))
}

/// Whether the response has no mode on the axis.
fn settles(plant: &GeneralizedPlant) -> bool {
    plant.passive().minimal(1e-10).is_ok_and(|g| g.is_stable().unwrap_or(false))
}

/// Outputs by names, a base name meaning all of its components.
fn outputs(vehicle: &Vehicle, names: &[String], field: &'static str) -> Result<Vec<Output>, StudyError> {
    let mut found: Vec<Output> = Vec::new();
    for name in names {
        let members: Vec<&Output> =
            vehicle.outputs().iter().filter(|o| o.name == *name || o.base == *name).collect();
        if members.is_empty() {
            let known = vehicle.outputs().iter().flat_map(|o| [o.name.as_str(), o.base.as_str()]);
            let near = crate::files::nearest(name, known)
                .map_or_else(String::new, |n| format!(" (did you mean `{n}`?)"));
            return Err(StudyError::Setting {
                field,
                expected: format!("outputs of the vehicle{near}"),
                found: format!("`{name}`"),
            });
        }
        for o in members {
            if !found.contains(o) {
                found.push(o.clone());
            }
        }
    }
    Ok(found)
}
