//! What a physical fit can use of its recordings, and places of wheels that no vehicle, or another one, has.

use super::StudyError;
use super::drives::usable;
use super::identify::Task;
use crate::signal::Recording;
use crate::vehicle::{Model, ParametricVehicle, Vehicle, VehicleError, VehicleSpec};

/// A wheel of the recording may be this far from the vehicle file's: track widths are measured carelessly.
const WHEEL_TOLERANCE_M: f64 = 0.25;
/// Wheelbases of the recording and of the vehicle file may differ by this share.
const WHEELBASE_TOLERANCE: f64 = 0.02;
/// Longer and wider than any road vehicle, m.
const LONGEST_M: f64 = 30.0;
const WIDEST_M: f64 = 5.0;
/// Wheels of several recordings of one vehicle agree to this.
const SAME_WHEEL_M: f64 = 0.02;
/// The recordings with the channels that the vehicle has, and why others are left out.
pub(super) fn recordings(
    tasks: &[Task<'_>],
    file: Option<(&str, &VehicleSpec)>,
) -> Result<(Vec<Recording>, Vec<String>), StudyError> {
    let model = match file {
        Some((name, spec)) => {
            if matches!(spec.model, Model::TruckCabin | Model::Matrices | Model::Response) {
                return Err(StudyError::Setting {
                    field: "vehicle",
                    expected: "a model that the physical fit knows (quarter-car, half-car, full-car, bounce-truck), none, or another method".into(),
                    found: format!("{name} of model {}", spec.model.name()),
                });
            }
            let of_file = |source: VehicleError| StudyError::Vehicle { name: name.to_owned(), source };
            Some(spec.build_alone().map_err(of_file)?)
        }
        None => None,
    };
    let (mut recordings, mut all_left_out) = (Vec::new(), Vec::new());
    for task in tasks {
        let wheels = task.recording.wheels();
        let generic;
        let vehicle = if let Some(vehicle) = &model {
            check_wheelbase(task, vehicle)?;
            vehicle
        } else {
            if wheels.is_empty() {
                return Err(StudyError::Setting {
                    field: "wheel",
                    expected: "the places of the wheels ([[wheel]] in the recording's description), or a vehicle file (--vehicle)".into(),
                    found: "none".into(),
                });
            }
            let of_wheels = |source| StudyError::Vehicle { name: "a generic vehicle".into(), source };
            let start = crate::vehicle::GenericStart::ALL[0];
            let symmetric = crate::vehicle::Symmetry::Symmetric;
            let (family, _) =
                ParametricVehicle::generic(&start, symmetric, &[], wheels, &[]).map_err(of_wheels)?;
            let values = crate::lti::Parametric::start(&family);
            generic = family.vehicle_at(&values).map_err(|found| StudyError::Setting {
                field: "wheel",
                expected: "wheels that a body stands on".into(),
                found,
            })?;
            check_places(task)?;
            check_wheelbase(task, &generic)?;
            &generic
        };
        let (usable, left_out) =
            usable(task.recording, |channel, wheels| vehicle.sensor_row(channel, wheels).map(|_| ()))?;
        recordings.push(usable);
        for text in left_out {
            if !all_left_out.contains(&text) {
                all_left_out.push(text);
            }
        }
    }
    Ok((recordings, all_left_out))
}

/// Recordings that share a vehicle have its wheels at the same places.
pub(super) fn same_wheels(recordings: &[Recording]) -> Result<(), StudyError> {
    let Some((first, rest)) = recordings.split_first() else { return Ok(()) };
    let places = |r: &Recording| r.wheels().iter().map(|w| w.at_m).collect::<Vec<_>>();
    let base = places(first);
    for other in rest {
        let theirs = places(other);
        let apart = |(a, b): (&[f64; 2], &[f64; 2])| (a[0] - b[0]).hypot(a[1] - b[1]);
        if theirs.len() != base.len() || base.iter().zip(&theirs).any(|p| apart(p) > SAME_WHEEL_M) {
            return Err(StudyError::Setting {
                field: "wheel.at_m",
                expected: format!("the first recording's wheels, {base:.3?} m"),
                found: format!("{theirs:.3?} m"),
            });
        }
    }
    Ok(())
}

/// Places that no vehicle has: a unit that is wrong shows here.
fn check_places(task: &Task<'_>) -> Result<(), StudyError> {
    for (axis, what, most) in [(0, "a wheelbase", LONGEST_M), (1, "a track", WIDEST_M)] {
        let at = task.recording.wheels().iter().map(|w| w.at_m[axis]);
        let extent = at.clone().fold(f64::NEG_INFINITY, f64::max) - at.fold(f64::INFINITY, f64::min);
        if extent > most {
            return Err(StudyError::Setting {
                field: "wheel.at_m",
                expected: format!("{what} of at most {most} m: places are in m"),
                found: format!("{extent} m"),
            });
        }
    }
    Ok(())
}

/// Delays come from the vehicle's wheelbase: a recording that says another one is of another car.
fn check_wheelbase(task: &Task<'_>, vehicle: &Vehicle) -> Result<(), StudyError> {
    let extent = |x: Vec<f64>| {
        x.iter().copied().fold(f64::NEG_INFINITY, f64::max) - x.iter().copied().fold(f64::INFINITY, f64::min)
    };
    let theirs = extent(task.recording.wheels().iter().map(|w| w.at_m[0]).collect());
    let ours = extent(vehicle.wheels().iter().map(|w| w.at_m[0]).collect());
    for (index, wheel) in task.recording.wheels().iter().enumerate() {
        let Ok(ours) = vehicle.match_wheel(index, task.recording.wheels()) else { continue };
        let (at, known) =
            (vehicle.in_frame(wheel.at_m, task.recording.wheels()), vehicle.wheels()[ours].at_m);
        if (at[0] - known[0]).hypot(at[1] - known[1]) > WHEEL_TOLERANCE_M {
            return Err(StudyError::Setting {
                field: "wheel.at_m",
                expected: format!(
                    "wheel `{}` at {known:.3?} m from the c.g., as its name says or the vehicle file has it",
                    wheel.name
                ),
                found: format!("{at:.3?} m"),
            });
        }
    }
    if task.recording.wheels().len() < 2 || (theirs - ours).abs() <= WHEELBASE_TOLERANCE * ours.max(theirs) {
        return Ok(());
    }
    Err(StudyError::Setting {
        field: "wheel.at_m",
        expected: format!("the vehicle file's wheelbase of {ours:.3} m within 2 %"),
        found: format!("{theirs:.3} m"),
    })
}
