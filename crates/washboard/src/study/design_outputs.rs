//! Names of outputs as a design file has them: which outputs they mean, and which can be designed for.

use super::design_words::short;
use super::{DesignDisturbance, DesignSpec, StudyError};
use crate::linalg::{C64, eigen};
use crate::lti::GeneralizedPlant;
use crate::vehicle::{Output, Vehicle, VehicleSpec};

/// What a suspension engineer looks at; displacements follow the road and say little.
pub(super) fn shown(output: &Output) -> bool {
    ["acceleration", "travel", "deflection", "force"].iter().any(|word| output.base.contains(word))
}

/// Whether the response has no mode on the axis.
pub(super) fn settles(plant: &GeneralizedPlant) -> bool {
    plant.passive().minimal(1e-10).is_ok_and(|g| g.is_stable().unwrap_or(false))
}

/// Outputs by names, a base name meaning all of its components.
pub(super) fn outputs(
    vehicle: &Vehicle,
    names: &[String],
    field: &'static str,
) -> Result<Vec<Output>, StudyError> {
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

/// Refuses a measurement that is asked for twice, by itself or in a stacked vector: one sensor would count for two.
pub(super) fn once(vehicle: &Vehicle, names: &[String]) -> Result<(), StudyError> {
    for output in vehicle.outputs() {
        let asking: Vec<&String> =
            names.iter().filter(|n| **n == output.name || **n == output.base).collect();
        if let [first, second, ..] = asking[..] {
            let found = if first == second {
                format!("`{first}` twice")
            } else {
                format!("`{}` twice: in `{first}` and in `{second}`", output.name)
            };
            let expected = "each output once".to_owned();
            return Err(StudyError::Setting { field: "measurements", expected, found });
        }
    }
    Ok(())
}

/// Refuses a controller that would measure what it gives itself.
pub(super) fn no_own_output(measurements: &[Output]) -> Result<(), StudyError> {
    let own = measurements.iter().find(|o| o.base == "actuator_force");
    own.map_or(Ok(()), |o| {
        Err(StudyError::Setting {
            field: "measurements",
            expected: "outputs of the vehicle that are not the controller's own".into(),
            found: format!("`{}`, the force that the controller itself gives", o.name),
        })
    })
}

/// Refuses a passive vehicle with a mode that swings on: its norms, over which goals are, are infinite.
pub(super) fn damped(vehicle: &Vehicle, file: &VehicleSpec) -> Result<(), StudyError> {
    const UNDAMPED: f64 = 1e-10;
    let poles =
        vehicle.system().state_matrix().ok().and_then(|a| Some(eigen(&a).ok()?.0)).unwrap_or_default();
    let largest = poles.iter().map(|p| p.norm()).fold(0.0, f64::max);
    let swings = |p: &&C64| p.re.abs() <= UNDAMPED * largest && p.im > UNDAMPED.sqrt() * largest;
    let Some(pole) = poles.iter().find(swings) else { return Ok(()) };
    let zeros: Vec<String> = file.undamped().iter().map(|f| format!("{f} = 0, ")).collect();
    let found = format!("{}with a mode at {} rad/s that does not decay", zeros.concat(), short(pole.im));
    let expected = "a passive vehicle that is damped: goals are over its norms".into();
    Err(StudyError::Setting { field: "vehicle", expected, found })
}

/// Refuses a goal with outputs that follow a road height without bound.
pub(super) fn settling(spec: &DesignSpec, wandering: &[&str]) -> Result<(), StudyError> {
    if wandering.is_empty() {
        return Ok(());
    }
    let why = match spec.disturbance {
        DesignDisturbance::RoadVelocity | DesignDisturbance::RoadNoise => {
            "which follow the road's height, and the height of a road whose velocity is white noise has no bound: take \
             disturbance = \"road-noise\" on a road of kind first-order, or leave them out"
        }
        DesignDisturbance::RoadDisplacement => {
            "in which a mode shows that has no damping, or nothing that brings it back: damp it, or leave them out"
        }
    };
    let expected = "outputs whose response dies away".to_owned();
    let found = format!("{}, {why}", quoted(wandering));
    Err(StudyError::Setting { field: "goal.minimize", expected, found })
}

/// Refuses a goal in the H2 norm with outputs that white noise reaches at once.
pub(super) fn finite(
    spec: &DesignSpec,
    wanted: &[Output],
    plant: &GeneralizedPlant,
) -> Result<(), StudyError> {
    let passive = plant.passive();
    let at_once = |i: &usize| (0..passive.inputs()).any(|j| passive.d()[(*i, j)] != 0.0);
    let names: Vec<&str> = (0..wanted.len()).filter(at_once).map(|i| wanted[i].name.as_str()).collect();
    if names.is_empty() {
        return Ok(());
    }
    let (given, what, instead) = match spec.disturbance {
        DesignDisturbance::RoadDisplacement => (
            "road-displacement",
            "the road's height",
            "road-velocity (the usual one), or road-noise on a road of kind first-order",
        ),
        DesignDisturbance::RoadVelocity => {
            ("road-velocity", "the road's velocity", "road-noise on a road of kind first-order")
        }
        DesignDisturbance::RoadNoise => (
            "road-noise",
            "the road",
            "road-noise on a road of kind first-order, or a goal without these outputs",
        ),
    };
    Err(StudyError::Setting {
        field: "disturbance",
        expected: instead.to_owned(),
        found: format!(
            "{given}: white noise as {what} reaches {} at once and at all frequencies alike, so that the H2 norm is \
             infinite and cannot be minimised",
            quoted(&names)
        ),
    })
}

fn quoted(names: &[&str]) -> String {
    names.iter().map(|n| format!("`{n}`")).collect::<Vec<_>>().join(", ")
}
