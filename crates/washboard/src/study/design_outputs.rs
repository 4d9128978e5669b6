//! Names of outputs as a design file has them: which outputs they mean, and which can be designed for.

use super::design_problem::Problem;
use super::design_words::short;
use super::{DesignDisturbance, DesignMethod, DesignSpec, Flag, StudyError};
use crate::linalg::{C64, Mat, eigen};
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
            let seat = if name.starts_with("driver_")
                && !vehicle.outputs().iter().any(|o| o.base.starts_with("driver_"))
            {
                "; a driver's seat needs driver_m in the vehicle's file"
            } else {
                ""
            };
            return Err(StudyError::Setting {
                field,
                expected: format!("outputs of the vehicle{near}"),
                found: format!("`{name}`; it has {}{seat}", all_names(vehicle)),
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

/// Every output once, and the corners that stacked ones are of.
fn all_names(vehicle: &Vehicle) -> String {
    let (mut bases, mut corners): (Vec<&str>, Vec<&str>) = (Vec::new(), Vec::new());
    for o in vehicle.outputs() {
        let corner = o.name.strip_prefix(o.base.as_str()).and_then(|c| c.strip_prefix('_'));
        let new = |list: &[&str], name: &str| !list.contains(&name);
        if new(&bases, &o.base) {
            bases.push(&o.base);
        }
        corners.extend(corner.filter(|c| new(&corners, c)));
    }
    let each = match corners.is_empty() {
        true => String::new(),
        false => format!(" (what a corner has also with _{} at its end)", corners.join(", _")),
    };
    bases.join(", ") + &each
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

/// A scaled stiffness below this in some direction is none but for rounding: a free motion leaves 1e-16.
const HELD: f64 = 1e-12;

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
    let what = not_decaying(&poles)?;
    let sizes = || poles.iter().map(|p| p.norm());
    Some(match what {
        // springs may hold what is slow beside the rest
        Lasting::Free if holds(vehicle.system().k()) => Lasting::Slow {
            slowest: sizes().fold(f64::INFINITY, f64::min),
            fastest: sizes().fold(0.0, f64::max),
        },
        other => other,
    })
}

/// Whether a stiffness holds all motions: its Cholesky factor, rows scaled to a diagonal of ones, has no entry that is rounding.
fn holds(k: &Mat) -> bool {
    let n = k.nrows();
    if (0..n).any(|i| !(k[(i, i)] > 0.0)) {
        return false;
    }
    let mut l = Mat::from_fn(n, n, |i, j| k[(i, j)] / (k[(i, i)] * k[(j, j)]).sqrt());
    for j in 0..n {
        let left = l[(j, j)] - (0..j).map(|m| l[(j, m)].powi(2)).sum::<f64>();
        if !(left > HELD) {
            return false;
        }
        l[(j, j)] = left.sqrt();
        for i in j + 1..n {
            l[(i, j)] = (l[(i, j)] - (0..j).map(|m| l[(i, m)] * l[(j, m)]).sum::<f64>()) / l[(j, j)];
        }
    }
    true
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
    /// So slow beside the fastest that doubles do not tell whether it decays, rad/s.
    Slow {
        /// Its pole's size.
        slowest: f64,
        /// The largest pole's.
        fastest: f64,
    },
}

impl fmt::Display for Lasting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Lasting::Grows(p) if p.im == 0.0 => write!(f, "a pole at {} rad/s that grows", short(p.re)),
            Lasting::Grows(p) => {
                write!(f, "a pole at {} ± {}i rad/s that grows", short(p.re), short(p.im.abs()))
            }
            Lasting::Swings(omega) => write!(f, "a mode at {} rad/s that does not decay", short(*omega)),
            Lasting::Slow { slowest, fastest } => write!(
                f,
                "a motion at {} rad/s beside one at {}: too far apart for doubles to tell whether it decays",
                short(*slowest),
                short(*fastest)
            ),
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
    spec: &DesignSpec,
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
    let own = if file.is_some() { overridden(spec) } else { String::new() };
    let or = match (file, spec.method) {
        (Some(_), DesignMethod::FixedOrder) => "; or [normalize_at], fields with which it is",
        _ => "",
    };
    Err(StudyError::Setting {
        field: if file.is_some() { "vehicle" } else { "normalize_at" },
        expected: format!("a passive vehicle that is damped and stable: goals are over its norms{or}"),
        found: format!("a vehicle with {}{what}{own}", zeros.concat()),
    })
}

/// Refuses a vehicle whose stiffness holds not all of its motions, where the equations need that.
pub(super) fn held(vehicle: &Vehicle, spec: &DesignSpec) -> Result<(), StudyError> {
    match unstable(vehicle).filter(|what| *what == Lasting::Free) {
        None => Ok(()),
        Some(what) => Err(StudyError::Setting {
            field: "vehicle",
            expected: "springs that bring back every motion".into(),
            found: format!("{what}{}", overridden(spec)),
        }),
    }
}

/// Why a response does not die away.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Lasts {
    /// It follows a road height that has no bound.
    Follows,
    /// It does not, and its poles are too far apart for doubles to tell.
    Unresolved,
}

/// Refuses goals and measurements that follow a road height without bound, all in one message.
pub(super) fn settling(
    spec: &DesignSpec,
    wandering: &[(String, Lasts)],
    seen: &[(String, Lasts)],
) -> Result<(), StudyError> {
    let names = |of: &[(String, Lasts)]| quoted(&of.iter().map(|(n, _)| n.as_str()).collect::<Vec<_>>());
    let field = match (wandering.first(), seen.first()) {
        (None, None) => return Ok(()),
        (_, Some(_)) => "measurements",
        (Some((name, _)), None) => spec.goal.field_of(name),
    };
    let expected = "outputs whose response dies away".to_owned();
    if wandering.iter().chain(seen).all(|(_, why)| *why == Lasts::Unresolved) {
        let all = names(if seen.is_empty() { wandering } else { seen });
        let found = format!(
            "{all}, of which rounding does not show it: the vehicle's numbers are further apart than doubles resolve{}",
            overridden(spec)
        );
        return Err(StudyError::Setting { field, expected, found });
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
    let goals = match wandering.first().filter(|_| !seen.is_empty()) {
        Some((name, _)) => format!(", and {} in {}", names(wandering), spec.goal.field_of(name)),
        None => String::new(),
    };
    let found = format!("{}{goals}, {why}", names(if seen.is_empty() { wandering } else { seen }));
    Err(StudyError::Setting { field, expected, found })
}

/// What of the vehicle the design has replaced, for messages that blame the vehicle.
fn overridden(spec: &DesignSpec) -> String {
    let fields: Vec<String> =
        spec.r#override.iter().map(|(name, v)| format!("{name} = {}", short(*v))).collect();
    if fields.is_empty() { String::new() } else { format!(" (its [override] has {})", fields.join(", ")) }
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
