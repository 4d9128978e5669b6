//! `identify --method physical`: a vehicle, from a file or from nothing, and its roads fitted to all cross-spectra.

use super::drives::{Drive, Families, cannot_start, fit};
use super::fit_generic::{GenericFit, Sides, fit_generic, values};
use super::identify::{Files, Task, blank};
use super::identify_evidence::{ClockOffset, FitQuality};
use super::identify_outcome::{
    FittedParameter, Flag, IdentifiedMode, IdentifyOutcome, RunSummary, ShapeValue,
};
use super::parts::{self, RoadEstimate};
use super::physical_inputs::{recordings, same_wheels};
use super::physical_notes::{files, held, notes};
use super::{IdentifyMethod, StudyError, shape_points};
use crate::identify::{ANNEALING_NONE, FitError, PhysicalOutcome, PhysicalSettings};
use crate::signal::Recording;
use crate::vehicle::{ParametricVehicle, Vehicle, VehicleError, VehicleSpec};
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
