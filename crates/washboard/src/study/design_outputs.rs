//! Names of outputs as a design file has them: which outputs they mean, and which can be designed for.

use super::design_problem::Problem;
use super::design_words::short;
use super::{DesignDisturbance, DesignMethod, DesignSpec, Flag, StudyError};
use crate::linalg::{C64, eigen};
use crate::lti::{Continuous, GeneralizedPlant, StateSpace};
use crate::vehicle::{Output, PlantSettings, Vehicle, VehicleSpec};
use std::fmt;

/// What a suspension engineer looks at; displacements follow the road and say little.
pub(super) fn shown(output: &Output) -> bool {
    ["acceleration", "travel", "deflection", "force"].iter().any(|word| output.base.contains(word))
}

/// Whether the response has no mode on the axis.
pub(super) fn settles(plant: &GeneralizedPlant) -> bool {
    plant.passive().minimal(1e-10).is_ok_and(|g| decays(&g))
}

/// Whether all poles are left of the axis by more than rounding: a height's own pole at 0 is computed as ±1e-15, on either side.
pub(super) fn decays(g: &StateSpace<Continuous>) -> bool {
    let Ok(poles) = g.poles() else { return false };
    let largest = poles.iter().map(|p| p.norm()).fold(0.0, f64::max);
    poles.iter().all(|p| p.re < -UNDAMPED * largest)
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
            let near = with_all_words(name, known.clone())
                .or_else(|| crate::files::nearest(name, known))
                .map_or_else(String::new, |n| format!(" (did you mean `{n}`?)"));
            let mut bases: Vec<&str> = vehicle.outputs().iter().map(|o| o.base.as_str()).collect();
            bases.dedup();
            return Err(StudyError::Setting {
                field,
                expected: format!("outputs of the vehicle{near}"),
                found: format!("`{name}`; it has {}", bases.join(", ")),
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

/// The shortest name that has all words of another one: `driver_heave_acceleration` of `driver_acceleration`.
fn with_all_words<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let has_all = |k: &&str| name.split('_').all(|word| k.split('_').any(|w| w == word));
    known.filter(|_| name.contains('_')).filter(has_all).min_by_key(|k| k.len())
}

/// A note of what an engineer looks at and no table has: outputs whose response does not die away, or that white noise reaches through
/// derivatives.
pub(super) fn left_out(problem: &Problem) -> Option<Flag> {
    let shows = |base: &str| problem.reported.iter().any(|o| o.base == base);
    let mut missing: Vec<&Output> = Vec::new();
    for output in problem.vehicle.outputs().iter().filter(|o| shown(o) && !shows(&o.base)) {
        if !missing.iter().any(|o| o.base == output.base) {
            missing.push(output);
        }
    }
    let settings = PlantSettings {
        road: problem.ground.excitation(),
        speed_m_s: problem.spec.speed_m_s,
        disturbance: problem.spec.disturbance.into(),
        delay_order: problem.spec.delay_order,
    };
    let at_once = |o: &&&Output| problem.vehicle.plant(&[**o], &[], &settings).is_err();
    let (white, lasting): (Vec<&&Output>, Vec<&&Output>) = missing.iter().partition(at_once);
    let names = |of: &[&&Output]| quoted(&of.iter().map(|o| o.base.as_str()).collect::<Vec<_>>());
    let white = (!white.is_empty()).then(|| {
        format!(
            "{}, infinite at all frequencies: derivatives of what drives this road reach them",
            names(&white)
        )
    });
    let lasting = (!lasting.is_empty())
        .then(|| format!("{}, whose response does not die away on this road", names(&lasting)));
    let all: Vec<String> = white.into_iter().chain(lasting).collect();
    let text = format!("in no table, as infinite on this road: {}", all.join("; "));
    (!all.is_empty()).then(|| Flag { name: "left-out".into(), text })
}

/// Refuses a measurement that is asked for twice, by itself or in a stacked vector: one sensor would count for two.
pub(super) fn once(vehicle: &Vehicle, names: &[String], field: &'static str) -> Result<(), StudyError> {
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
            return Err(StudyError::Setting { field, expected, found });
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

/// A real part below this share of the largest pole is rounding.
const UNDAMPED: f64 = 1e-10;
/// A pole that is a double one but for rounding is spread by this share of the largest.
const DOUBLE: f64 = 1e-7;

/// A pole that swings on: on the axis but for rounding, and not at 0.
pub(super) fn swings(poles: &[C64]) -> Option<C64> {
    let largest = poles.iter().map(|p| p.norm()).fold(0.0, f64::max);
    let on = |p: &&C64| p.re.abs() <= UNDAMPED * largest && p.im > UNDAMPED.sqrt() * largest;
    poles.iter().find(on).copied()
}

/// Why a vehicle without control is not stable; none of one that is.
fn unstable(vehicle: &Vehicle) -> Option<Lasting> {
    let poles =
        vehicle.system().state_matrix().ok().and_then(|a| Some(eigen(&a).ok()?.0)).unwrap_or_default();
    not_decaying(&poles)
}

/// A pole that does not decay.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Lasting {
    /// In the right half plane.
    Grows(C64),
    /// On the axis, at so many rad/s.
    Swings(f64),
    /// At 0.
    Free,
}

impl fmt::Display for Lasting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Lasting::Grows(p) if p.im == 0.0 => write!(f, "a pole at {} rad/s that grows", short(p.re)),
            Lasting::Grows(p) => {
                write!(f, "a pole at {} ± {}i rad/s that grows", short(p.re), short(p.im.abs()))
            }
            Lasting::Swings(omega) => write!(f, "a mode at {} rad/s that does not decay", short(*omega)),
            Lasting::Free => write!(f, "a motion that no spring brings back (a pole at 0)"),
        }
    }
}

/// The pole that does not decay, if there is one.
pub(super) fn not_decaying(poles: &[C64]) -> Option<Lasting> {
    let largest = poles.iter().map(|p| p.norm()).fold(0.0, f64::max);
    let growing = poles.iter().filter(|p| p.re > DOUBLE * largest).max_by(|a, b| a.re.total_cmp(&b.re));
    let free = poles.iter().any(|p| p.norm() <= DOUBLE.sqrt() * largest && p.re >= -DOUBLE * largest);
    growing
        .map(|p| Lasting::Grows(*p))
        .or_else(|| swings(poles).map(|p| Lasting::Swings(p.im)))
        .or_else(|| free.then_some(Lasting::Free))
}

/// Refuses a vehicle without control that is not stable: its norms, over which goals are, are infinite.
pub(super) fn damped(
    vehicle: &Vehicle,
    file: Option<&VehicleSpec>,
    method: DesignMethod,
) -> Result<(), StudyError> {
    let Some(what) = unstable(vehicle) else { return Ok(()) };
    // without damping it swings; what grows has other reasons
    let undamped = file.filter(|_| matches!(what, Lasting::Swings(_)));
    let zeros: Vec<String> = undamped
        .map(VehicleSpec::undamped)
        .unwrap_or_default()
        .iter()
        .map(|f| format!("{f} = 0, "))
        .collect();
    let or = match (file, method) {
        (Some(_), DesignMethod::FixedOrder) => "; or [normalize_at], fields with which it is",
        _ => "",
    };
    Err(StudyError::Setting {
        field: if file.is_some() { "vehicle" } else { "normalize_at" },
        expected: format!("a passive vehicle that is damped and stable: goals are over its norms{or}"),
        found: format!("{}with {what}", zeros.concat()),
    })
}

/// Refuses a vehicle whose stiffness holds not all of its motions, where the equations need that.
pub(super) fn held(vehicle: &Vehicle) -> Result<(), StudyError> {
    match unstable(vehicle).filter(|what| *what == Lasting::Free) {
        None => Ok(()),
        Some(what) => Err(StudyError::Setting {
            field: "vehicle",
            expected: "springs that bring back every motion".into(),
            found: what.to_string(),
        }),
    }
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
    Err(StudyError::Setting { field: spec.goal.field_of(wandering[0]), expected, found })
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poles_that_do_not_decay_are_told_apart() {
        let c = C64::new;
        let of = |poles: &[C64]| not_decaying(poles);
        assert_eq!(of(&[c(-1.0, 10.0), c(-1.0, -10.0), c(-1e-3, 0.0)]), None);
        assert_eq!(of(&[c(2.0, 10.0), c(2.0, -10.0), c(3.0, 0.0)]), Some(Lasting::Grows(c(3.0, 0.0))));
        // on the axis but for rounding, on either side
        for rounding in [-1e-14, 1e-14] {
            assert_eq!(
                of(&[c(-5.0, 0.0), c(rounding, 10.0), c(rounding, -10.0)]),
                Some(Lasting::Swings(10.0))
            );
        }
        // a double pole at 0 is spread by the root of rounding
        assert_eq!(of(&[c(-100.0, 0.0), c(1e-7, 0.0), c(-1e-7, 0.0)]), Some(Lasting::Free));
    }

    #[test]
    fn a_name_is_found_by_its_words() {
        let known = ["heave_acceleration", "driver_heave_acceleration", "driver_heave_velocity"];
        let near = |name| with_all_words(name, known.into_iter());
        assert_eq!(near("driver_acceleration"), Some("driver_heave_acceleration"));
        assert_eq!(near("heave_accel"), None);
    }
}
