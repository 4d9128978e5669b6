//! `identify --method physical`: a vehicle, from a file or from nothing, and its roads fitted to all cross-spectra.

use super::drives::{Drive, Families, cannot_start, fit, usable};
use super::fit_generic::{GenericFit, Sides, fit_generic, values};
use super::identify::{Files, Task, blank};
use super::identify_evidence::{ClockOffset, FitQuality};
use super::identify_outcome::{
    FittedParameter, Flag, HeldParameter, IdentifiedMode, IdentifyOutcome, RunSummary, ShapeValue,
};
use super::parts::{self, RoadEstimate};
use super::{IdentifyMethod, StudyError, shape_points};
use crate::identify::{ANNEALING_NONE, FitError, PhysicalOutcome, PhysicalSettings};
use crate::road::{CoherenceSpec, RoadSpec};
use crate::signal::Recording;
use crate::vehicle::{Model, ParametricVehicle, SPRUNG_MASS, Vehicle, VehicleError, VehicleSpec, of_scale};

/// A wheel of the recording may be this far from the vehicle file's: track widths are measured carelessly.
const WHEEL_TOLERANCE_M: f64 = 0.25;
/// Wheelbases of the recording and of the vehicle file may differ by this share.
const WHEELBASE_TOLERANCE: f64 = 0.02;
/// Longer and wider than any road vehicle, m.
const LONGEST_M: f64 = 30.0;
const WIDEST_M: f64 = 5.0;
/// Wheels of several recordings of one vehicle agree to this.
const SAME_WHEEL_M: f64 = 0.02;

/// A vehicle fitted to one recording or several.
pub(super) struct Fitted<'a> {
    pub drives: Vec<Drive<'a>>,
    pub families: Families,
    pub found: PhysicalOutcome,
    /// The vehicle's file at the answer.
    pub spec: VehicleSpec,
    pub vehicle: Vehicle,
    pub generic: Option<(Vec<super::StartTried>, Option<Sides>)>,
}

pub(super) fn run(
    tasks: &[Task<'_>],
    file: Option<(&str, &VehicleSpec)>,
    known: &[(String, f64)],
) -> Result<(IdentifyOutcome, Files), StudyError> {
    let (recordings, left_out) = recordings(tasks, file)?;
    let fitted = match fitted(tasks, &recordings, file, known) {
        Ok(fitted) => fitted,
        // too few sensors is an answer, not a mistake in a file
        Err(Refusal::OneChannel(channel)) => return Ok((one_channel(&tasks[0], &channel), Vec::new())),
        Err(Refusal::Wrong(e)) => return Err(*e),
    };
    let first = &fitted.drives[0].task;
    let of_first = &fitted.found.drives[0];
    let mut outcome = blank(first, IdentifyMethod::Physical, Some((&of_first.freq_hz, &of_first.fitted)));
    fill(&mut outcome, &fitted, file.is_some(), known);
    if !left_out.is_empty() {
        let text = format!("not used: {}", left_out.join("; "));
        outcome.flags.push(Flag { name: "channels-left-out".into(), text });
    }
    if fitted.drives.len() > 1 {
        outcome.runs = runs(&fitted);
    }
    let files = if outcome.converged { files(&fitted.spec, &outcome) } else { Vec::new() };
    Ok((outcome, files))
}

/// Why there is no fit.
pub(super) enum Refusal {
    /// One sensor cannot tell.
    OneChannel(String),
    /// Something is wrong with the input.
    Wrong(Box<StudyError>),
}

impl<E: Into<StudyError>> From<E> for Refusal {
    fn from(e: E) -> Self {
        Refusal::Wrong(Box::new(e.into()))
    }
}

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

/// The fit from a file, or without one.
pub(super) fn fitted<'a>(
    tasks: &'a [Task<'_>],
    recordings: &'a [Recording],
    file: Option<(&str, &VehicleSpec)>,
    known: &[(String, f64)],
) -> Result<Fitted<'a>, Refusal> {
    if let Some(few) = recordings.iter().find(|r| r.channels().len() < 2) {
        return Err(Refusal::OneChannel(few.channels()[0].name.clone()));
    }
    same_wheels(recordings)?;
    let drives = tasks
        .iter()
        .zip(recordings)
        .map(|(task, recording)| Drive::new(task, recording, task.name))
        .collect::<Result<Vec<_>, _>>()?;
    let (families, found, generic) = match file {
        Some((name, spec)) => {
            let of_file = |source: VehicleError| StudyError::Vehicle { name: name.to_owned(), source };
            let families = recordings
                .iter()
                .map(|r| ParametricVehicle::with_known(spec, r.channels(), r.wheels(), &[], known))
                .collect::<Result<Families, _>>()
                .map_err(of_file)?;
            let settings = PhysicalSettings::new(tasks[0].convention);
            let found = fit(&drives, &families, None, &settings).map_err(|e| match e {
                FitError::OneChannel { channel } => Refusal::OneChannel(channel),
                e => Refusal::Wrong(Box::new(cannot_start(&e))),
            })?;
            (families, found, None)
        }
        None => {
            let GenericFit { families, outcome, starts, sides } = fit_generic(&drives, known)?;
            (families, outcome, Some((starts, sides)))
        }
    };
    let not_a_vehicle = |found: String| StudyError::Setting {
        field: "vehicle",
        expected: "fitted values that make a vehicle".into(),
        found,
    };
    let spec = families[0].0.spec_at(&values(&found)).map_err(not_a_vehicle)?;
    let vehicle = families[0].0.vehicle_at(&values(&found)).map_err(not_a_vehicle)?;
    Ok(Fitted { drives, families, found, spec, vehicle, generic })
}

fn one_channel(task: &Task<'_>, channel: &str) -> IdentifyOutcome {
    let mut outcome = blank(task, IdentifyMethod::Physical, None);
    outcome.converged = false;
    let text = format!(
        "one sensor (`{channel}`) cannot tell the vehicle from its road: at least two are needed, better four"
    );
    outcome.flags.push(Flag { name: "not-identifiable".into(), text });
    outcome
}

/// Recordings that share a vehicle have its wheels at the same places.
fn same_wheels(recordings: &[Recording]) -> Result<(), StudyError> {
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

/// Each recording by itself, from the common answer; its road as the common fit has it.
fn runs(fitted: &Fitted<'_>) -> Vec<RunSummary> {
    let start = values(&fitted.found);
    fitted
        .drives
        .iter()
        .enumerate()
        .map(|(r, drive)| {
            let settings = PhysicalSettings {
                annealing: ANNEALING_NONE.to_vec(),
                ..PhysicalSettings::new(drive.task.convention)
            };
            let family: Families = vec![fitted.families[r].clone()];
            let alone = fit(std::slice::from_ref(drive), &family, Some(&start), &settings).ok();
            let common = &fitted.found.drives[r];
            let (road, coherence) = parts::road(&drive.task, drive.speed_m_s, &RoadEstimate::of(common));
            let modes = alone.as_ref().and_then(|found| {
                let vehicle = family[0].0.vehicle_at(&values(found)).ok()?;
                Some(modes(found, &vehicle, false))
            });
            RunSummary {
                name: drive.task.name.to_owned(),
                speed_m_s: Some(drive.speed_m_s),
                duration_s: drive.task.recording.duration_s(),
                converged: alone.as_ref().is_some_and(|a| a.problems.is_empty()),
                flags: alone.iter().flat_map(|a| a.problems.iter().map(parts::flag)).collect(),
                modes: modes.unwrap_or_default(),
                road: Some(road),
                coherence,
                delay_s: common.delay_s.map(|d| d.value),
                chi: alone.map(|a| a.chi),
            }
        })
        .collect()
}

/// The vehicle's modes with their standard deviations.
pub(super) fn modes(found: &PhysicalOutcome, vehicle: &Vehicle, shapes: bool) -> Vec<IdentifiedMode> {
    let modes: Vec<_> = found.modes.iter().map(|(m, ..)| m.clone()).collect();
    let labels = vehicle.labels(&modes);
    let shape = |mode: &crate::lti::Mode| {
        let at = mode.shape.iter().zip(vehicle.dofs());
        at.map(|(z, dof)| ShapeValue { dof: dof.clone(), re: z.re, im: z.im }).collect()
    };
    found
        .modes
        .iter()
        .zip(labels)
        .map(|((mode, f_sd, zeta_sd), label)| IdentifiedMode {
            freq_hz: mode.freq_hz,
            freq_sd_hz: Some(*f_sd),
            damping: mode.damping,
            damping_sd: Some(*zeta_sd),
            pole: [mode.pole.re, mode.pole.im],
            shape: if shapes { shape(mode) } else { Vec::new() },
            label,
            points: if shapes { shape_points::of_vehicle(vehicle, &mode.shape) } else { Vec::new() },
            ..IdentifiedMode::default()
        })
        .collect()
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

fn fill(outcome: &mut IdentifyOutcome, fitted: &Fitted<'_>, from_file: bool, known: &[(String, f64)]) {
    let (found, drive) = (&fitted.found, &fitted.found.drives[0]);
    outcome.converged = found.problems.is_empty();
    outcome.flags.extend(found.problems.iter().chain(&found.remarks).map(parts::flag));
    outcome.notes.extend(notes(fitted, from_file, known));
    outcome.modes = modes(found, &fitted.vehicle, true);
    parts::criteria(outcome);
    let first = &fitted.drives[0];
    let (road, coherence) = parts::road(&first.task, first.speed_m_s, &RoadEstimate::of(drive));
    (outcome.road, outcome.coherence) = (Some(road), coherence);
    outcome.delay_s = drive.delay_s.map(|d| d.value);
    outcome.delay_sd_s = drive.delay_s.map(|d| d.sd);
    outcome.noise = parts::noise(&first.task, &drive.noise);
    outcome.parameters = found
        .parameters
        .iter()
        .enumerate()
        .filter_map(|(i, (_, start, e))| {
            let family = &fitted.families[0].0;
            let (name, value, slope) = family.physical(i, e.value)?;
            let (_, start, _) = family.physical(i, *start)?;
            Some(FittedParameter { name, value, sd: e.sd * slope.abs(), start })
        })
        .collect();
    outcome.held = held(&fitted.spec, known);
    outcome.fit = Some(FitQuality {
        cost: found.cost,
        decrement: found.decrement,
        chi: found.chi,
        residual_freq_hz: drive.freq_hz.clone(),
        residual: drive.residual.clone(),
        iterations: found.work[0],
        evaluations: found.work[1],
    });
    for (r, d) in found.drives.iter().enumerate() {
        let channels = fitted.drives[r].task.recording.channels();
        outcome.clocks.extend(d.clocks.iter().map(|c| ClockOffset {
            channel: channels[c.channel].name.clone(),
            offset_s: c.offset_s.value,
            sd_s: c.offset_s.sd,
        }));
    }
    if let Some((starts, _)) = &fitted.generic {
        outcome.starts.clone_from(starts);
    }
}

/// What was given, and the sprung mass where nothing else sets the scale.
fn held(vehicle: &VehicleSpec, known: &[(String, f64)]) -> Vec<HeldParameter> {
    let mut held: Vec<HeldParameter> =
        known.iter().map(|(name, value)| HeldParameter { name: name.clone(), value: *value }).collect();
    if !known.iter().any(|(name, _)| of_scale(name)) {
        let file = serde_json::to_value(vehicle).unwrap_or_default();
        if let Some(value) = file[vehicle.model.name()][SPRUNG_MASS].as_f64() {
            held.push(HeldParameter { name: SPRUNG_MASS.to_owned(), value });
        }
    }
    held
}

/// What holds for every such fit, and what was decided in this one.
fn notes(fitted: &Fitted<'_>, from_file: bool, known: &[(String, f64)]) -> Vec<Flag> {
    let mut notes = Vec::new();
    let mut note = |name: &str, text: String| notes.push(Flag { name: name.to_owned(), text });
    let scale = "responses do not show the common scale of masses, stiffnesses and dampers";
    let rest = "modes, road and delay do not depend on it";
    if !known.is_empty() {
        let held: Vec<String> = known.iter().map(|(name, value)| format!("{name} = {value}")).collect();
        note("scale-known", format!("{scale}: it comes from {}, held as given; {rest}", held.join(", ")));
    } else if from_file {
        note(
            "scale-held",
            format!(
                "{scale}: the sprung mass is the vehicle file's, and the others are relative to it; {rest}"
            ),
        );
    } else {
        note(
            "scale-unidentifiable",
            format!(
                "{scale}: the sprung mass stands at 1000 kg, and the others are relative to it, until one is given (--known sprung_mass_kg=1150); {rest}"
            ),
        );
    }
    if let Some((_, Some(sides))) = &fitted.generic {
        let Sides { gain, needed, differ } = sides;
        let text = if *gain < 0.0 {
            "left and right are taken as alike: the search with sides that differ found nothing as good"
                .to_owned()
        } else if *differ {
            format!(
                "left and right differ: the likelihood gains {gain:.0} by it, where chance gives {needed:.0} at most"
            )
        } else {
            format!(
                "left and right are taken as alike: the likelihood would gain {gain:.0} by a difference, where chance gives up to {needed:.0}"
            )
        };
        note(if *differ { "asymmetric" } else { "symmetric" }, text);
    }
    if fitted.drives.len() > 1 {
        let text = format!(
            "one vehicle for all {} recordings, a road for each (runs): the road above is the first recording's",
            fitted.drives.len()
        );
        note("shared-vehicle", text);
    }
    notes
}

/// vehicle.toml and road.toml to go on with.
pub(super) fn files(vehicle: &VehicleSpec, outcome: &IdentifyOutcome) -> Files {
    let mut files = Vec::new();
    if let Ok(text) = toml::to_string(vehicle) {
        let text = format!("# identified from {}\n{text}", outcome.recording.name);
        files.push(("vehicle.toml".to_owned(), text.into_bytes()));
    }
    files.extend(road_file(outcome));
    files
}

/// road.toml.
pub(super) fn road_file(outcome: &IdentifyOutcome) -> Option<(String, Vec<u8>)> {
    let road = outcome.road.as_ref()?;
    let spec = RoadSpec {
        roughness_m3: Some(road.roughness_m3),
        exponent: Some(road.exponent),
        band_rad_per_m: Some(road.band_rad_per_m),
        convention: Some(road.convention),
        coherence: outcome.coherence.as_ref().map(|c| CoherenceSpec::bogsjo(c.mu)),
        ..RoadSpec::default()
    };
    let text = toml::to_string(&spec).ok()?;
    let text = format!("# identified from {}\n{text}", outcome.recording.name);
    Some(("road.toml".to_owned(), text.into_bytes()))
}
