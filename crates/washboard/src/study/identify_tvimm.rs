//! `identify --method tvimm`: free modes and the road, from a recording alone.

use super::drives::cannot_start;
use super::fit_generic::values;
use super::identify::{Files, Task, blank};
use super::identify_agreement::{CarFit, differences};
use super::identify_evidence::{FitQuality, OrderTried, RejectedMode, StartTried};
use super::identify_outcome::{Flag, IdentifiedMode, IdentifyOutcome, RunSummary, ShapeValue};
use super::identify_physical::{Fitted, Refusal, fitted, modes};
use super::parts::{self, RoadEstimate};
use super::physical_inputs::recordings;
use super::physical_notes::road_file;
use super::{IdentifyMethod, StudyError, shape_points};
use crate::identify::{FitError, FreeDrive, FreeOutcome, FreeStart, NoDataStart, data_start, fit_free_modes};
use crate::linalg::{C64, CMat, eigen, solve_complex};
use crate::lti::{FirstOrder, Mode, ModeKind, Parametric, WheeledSystem};
use crate::signal::{Channel, Direction, Place, Quantity};
use crate::vehicle::{GenericStart, ParametricVehicle, Response, Symmetry, VehicleSpec, WheelRow};

/// Modes of a car's wheels lie above this, Hz, where the sensors alone cannot tell which modes are the body's.
const HOPS_ABOVE_HZ: f64 = 4.0;
/// A mode whose frequency is not known to this share of itself is not identified.
const LARGEST_FREQ_SD: f64 = 0.1;

pub(super) fn run(
    tasks: &[Task<'_>],
    file: Option<(&str, &VehicleSpec)>,
    known: &[(String, f64)],
) -> Result<(IdentifyOutcome, Files), StudyError> {
    let mut done = tasks
        .iter()
        .map(|task| one(std::slice::from_ref(task), file, known))
        .collect::<Result<Vec<_>, _>>()?;
    if done.len() == 1 {
        return Ok(done.remove(0));
    }
    let runs = done.iter().map(|(o, _)| summary(o)).collect();
    let (mut outcome, files) = done.remove(0);
    outcome.runs = runs;
    outcome.notes.push(Flag {
        name: "own-modes".into(),
        text: "free modes are each recording's own (runs): those above are the first recording's".into(),
    });
    Ok((outcome, files))
}

/// An outcome as one run of several.
pub(super) fn summary(o: &IdentifyOutcome) -> RunSummary {
    let bare = |m: &IdentifiedMode| IdentifiedMode { shape: Vec::new(), points: Vec::new(), ..m.clone() };
    RunSummary {
        name: o.recording.name.clone(),
        speed_m_s: o.recording.speed_m_s,
        duration_s: o.recording.duration_s,
        converged: o.converged,
        flags: o.flags.clone(),
        modes: o.modes.iter().map(bare).collect(),
        road: o.road.clone(),
        coherence: o.coherence.clone(),
        delay_s: o.delay_s,
        chi: o.fit.as_ref().map(|f| f.chi),
    }
}

fn one(
    tasks: &[Task<'_>],
    file: Option<(&str, &VehicleSpec)>,
    known: &[(String, f64)],
) -> Result<(IdentifyOutcome, Files), StudyError> {
    let (recordings, left_out) = recordings(tasks, file)?;
    let channels = recordings[0].channels();
    let refuse = |text: String| {
        let mut outcome = blank(&tasks[0], IdentifyMethod::Tvimm, None);
        outcome.converged = false;
        outcome.flags.push(Flag { name: "not-identifiable".into(), text });
        Ok((outcome, Vec::new()))
    };
    let on_wheels = |c: &Channel| matches!(c.place, Place::Hub | Place::Axle);
    let (hubs, bodies) =
        (channels.iter().filter(|c| on_wheels(c)).count(), channels.iter().filter(|c| !on_wheels(c)).count());
    if hubs == 0 {
        return refuse(
            "free modes need sensors on the wheels beside those on the body: bodies alone do not tell the vehicle from its road (method physical can, as it knows what a car is)"
                .into(),
        );
    }
    let fitted = match fitted(tasks, &recordings, file, known) {
        Ok(fitted) => fitted,
        Err(Refusal::OneChannel(channel)) => {
            return refuse(format!(
                "one sensor (`{channel}`) cannot tell the vehicle from its road: free modes need body and wheel sensors"
            ));
        }
        Err(Refusal::Wrong(e)) => return Err(*e),
    };
    let drive = &fitted.drives[0];
    let mut starts = starts(&fitted, file.is_some())?;
    let system = fitted.families[0].0.system(&values(&fitted.found)).map_err(|e| no_start(&e))?;
    let planes: Vec<[f64; 3]> = channels.iter().map(|c| plane(c, &fitted, &recordings[0])).collect();
    let of_fit = FreeDrive {
        spectra: &drive.task.spectra,
        blocks: &drive.blocks,
        at_m: system.at_m(),
        derivatives: &fitted.families[0].1,
        planes: &planes,
        speed_m_s: drive.speed_m_s,
        band_hz: drive.task.band_hz,
    };
    // the last: it needs longer searches than a generic car, and is there where no two of the others agree
    let from_data = from_data(&of_fit, &fitted, &recordings[0], 2 * system.system().order());
    let no_data_start = match from_data {
        Ok(start) => {
            starts.push(start);
            None
        }
        Err(e) => Some(e),
    };
    let found = match fit_free_modes(&of_fit, &starts, drive.task.convention) {
        Ok(found) => found,
        Err(FitError::OneChannel { channel }) => return refuse(format!("one sensor (`{channel}`)")),
        Err(e) => return Err(cannot_start(&e)),
    };
    let task = &drive.task;
    let mut outcome = blank(task, IdentifyMethod::Tvimm, Some((&found.freq_hz, &found.fitted)));
    fill(&mut outcome, &found, &fitted, bodies == 0);
    if let Some(why) = no_data_start {
        let text = format!("no search started from the data alone: {why}");
        outcome.notes.push(Flag { name: "no-data-start".into(), text });
    }
    if !left_out.is_empty() {
        let text = format!("not used: {}", left_out.join("; "));
        outcome.flags.push(Flag { name: "channels-left-out".into(), text });
    }
    let files = if outcome.converged { files(&found, &fitted, &outcome)? } else { Vec::new() };
    Ok((outcome, files))
}

fn no_start(found: &str) -> StudyError {
    StudyError::Setting {
        field: "recording",
        expected: "a recording that a generic vehicle can be laid under".into(),
        found: found.to_owned(),
    }
}

/// The physical fit's answer, and generic cars that know nothing.
fn starts(fitted: &Fitted<'_>, from_file: bool) -> Result<Vec<FreeStart>, StudyError> {
    let drive = &fitted.drives[0];
    let road = &fitted.found.drives[0];
    let (exponent, mu) = (road.exponent.value, road.mu.map(|m| m.value));
    let physical = fitted.families[0].0.system(&values(&fitted.found)).map_err(|e| no_start(&e))?;
    let of = |wheeled: &WheeledSystem| FirstOrder::of_wheeled(wheeled).map_err(|e| no_start(&e.to_string()));
    let mut starts = vec![FreeStart {
        name: if from_file { "the physical fit from the file" } else { "the physical fit" }.into(),
        far: !fitted.found.problems.is_empty(),
        base: true,
        system: of(&physical)?,
        roughness_m3: road.roughness_m3.value,
        exponent,
        mu,
    }];
    let recording = drive.task.recording;
    for (start, name) in
        GenericStart::ALL.iter().zip(["a generic car", "a stiffer generic car", "a softer generic car"])
    {
        let (channels, wheels) = (recording.channels(), recording.wheels());
        let (generic, _) = ParametricVehicle::generic(start, Symmetry::Symmetric, channels, wheels, &[])
            .map_err(|source| StudyError::Vehicle { name: "a generic vehicle".into(), source })?;
        let generic = generic.system(&generic.start()).map_err(|e| no_start(&e))?;
        if generic.at_m().len() == physical.at_m().len() {
            starts.push(FreeStart {
                name: name.into(),
                far: true,
                base: true,
                system: of(&generic)?,
                roughness_m3: road.roughness_m3.value,
                exponent: 2.0,
                mu: mu.map(|_| 4.0),
            });
        }
    }
    Ok(starts)
}

/// A start from the data alone, by the sensors on the front wheels.
fn from_data(
    drive: &FreeDrive<'_>,
    fitted: &Fitted<'_>,
    recording: &crate::signal::Recording,
    states: usize,
) -> Result<FreeStart, NoDataStart> {
    let wheels = recording.wheels();
    let on_wheel = |c: &Channel| {
        let there = matches!(c.place, Place::Hub | Place::Axle) && c.quantity != Quantity::AngularVelocity;
        c.wheel.filter(|_| there).and_then(|w| fitted.vehicle.match_wheel(w, wheels).ok())
    };
    let on_wheel: Vec<Option<usize>> = recording.channels().iter().map(on_wheel).collect();
    data_start(drive, &on_wheel, states, fitted.drives[0].task.convention)
}

/// What a sensor shows of a plane 1, y, x that the vehicle follows, in the vehicle's frame.
fn plane(channel: &Channel, fitted: &Fitted<'_>, recording: &crate::signal::Recording) -> [f64; 3] {
    if channel.quantity == Quantity::AngularVelocity {
        // roll is the slope over y, pitch (nose down) the negative slope over x
        return match channel.direction {
            Direction::PlusX => [0.0, 1.0, 0.0],
            _ => [0.0, 0.0, -1.0],
        };
    }
    if channel.place == Place::Suspension {
        return [0.0; 3];
    }
    let wheels = recording.wheels();
    let at = channel.wheel.map(|w| wheels[w].at_m).or(channel.at_m).unwrap_or([0.0, 0.0]);
    let [x, y] = fitted.vehicle.in_frame(at, wheels);
    [1.0, y, x]
}

fn fill(outcome: &mut IdentifyOutcome, found: &FreeOutcome, fitted: &Fitted<'_>, hubs_only: bool) {
    let drive = &fitted.drives[0];
    outcome.converged = found.problems.is_empty();
    outcome.flags.extend(found.problems.iter().chain(&found.remarks).map(parts::flag));
    report_modes(outcome, found, fitted, hubs_only);
    parts::criteria(outcome);
    let (road, coherence) = parts::road(&drive.task, drive.speed_m_s, &RoadEstimate::of_free(found));
    (outcome.road, outcome.coherence) = (Some(road), coherence);
    if let Some(flag) = differs_from_car(outcome, found, fitted) {
        outcome.converged = false;
        outcome.flags.push(flag);
    }
    outcome.delay_s = found.delay_s.map(|d| d.value);
    outcome.delay_sd_s = found.delay_s.map(|d| d.sd);
    outcome.noise = parts::noise(&drive.task, &found.noise);
    outcome.fit = Some(FitQuality {
        cost: found.cost,
        decrement: found.decrement,
        chi: found.chi,
        residual_freq_hz: found.freq_hz.clone(),
        residual: found.residual.clone(),
        iterations: found.work[0],
        evaluations: found.work[1],
    });
    outcome.starts = found
        .trials
        .iter()
        .map(|t| StartTried {
            name: t.name.clone(),
            cost: t.cost,
            chi: t.chi,
            converged: t.converged,
            steps: t.steps,
        })
        .collect();
    outcome.orders = found
        .orders
        .iter()
        .map(|o| OrderTried {
            modes: o.modes,
            parameters: o.parameters,
            cost: o.cost,
            bic: o.bic,
            chi: o.chi,
            converged: o.converged,
            chosen: o.chosen,
        })
        .collect();
    outcome.notes.push(Flag {
        name: "static-calibration".into(),
        text: format!(
            "the road's level is calibrated by the vehicle following the road statically; the sensors' static gains agree to {:.2} %",
            100.0 * found.static_spread
        ),
    });
}

/// Where the car explains the same spectra.
fn differs_from_car(outcome: &IdentifyOutcome, found: &FreeOutcome, fitted: &Fitted<'_>) -> Option<Flag> {
    let own = fitted.found.problems.is_empty().then_some(&fitted.found)?;
    let road = own.drives.first()?;
    let car = CarFit {
        modes: &modes(own, &fitted.vehicle, false),
        roughness_m3: road.roughness_m3.value,
        exponent: road.exponent.value,
        mu: road.mu.map(|m| m.value),
    };
    let free = found.system.order() / 2;
    differences(&outcome.modes, outcome.road.as_ref(), outcome.coherence.as_ref(), free, &car)
}

/// Oscillatory modes that the sensors determine, labelled by the physical fit's; the others with their reason.
fn report_modes(outcome: &mut IdentifyOutcome, found: &FreeOutcome, fitted: &Fitted<'_>, hubs_only: bool) {
    let drive = &fitted.drives[0];
    let labels = labels(found, fitted);
    for ((mode, f_sd, zeta_sd), label) in found.modes.iter().zip(labels) {
        let why = if mode.kind != ModeKind::Oscillatory {
            Some("a real pole: no oscillation".to_owned())
        } else if hubs_only && mode.freq_hz < HOPS_ABOVE_HZ {
            Some("sensors on the wheels alone do not determine the body's modes".to_owned())
        } else if !(*f_sd <= LARGEST_FREQ_SD * mode.freq_hz) {
            Some(format!("not determined by these sensors: {:.2} ± {f_sd:.2} Hz", mode.freq_hz))
        } else {
            None
        };
        if let Some(why) = why {
            outcome.rejected.push(RejectedMode { freq_hz: mode.freq_hz, damping: mode.damping, why });
            continue;
        }
        let channels = drive.task.recording.channels();
        let wheels = drive.task.recording.wheels();
        let points = channels
            .iter()
            .zip(&mode.shape)
            .filter(|(c, _)| c.quantity != Quantity::AngularVelocity && c.place != Place::Suspension)
            .map(|(c, z)| {
                let at = c.wheel.map(|w| wheels[w].at_m).or(c.at_m).unwrap_or([0.0, 0.0]);
                let place = match c.place {
                    Place::Hub | Place::Axle => "hub",
                    Place::Cab => "cab",
                    _ => "body",
                };
                (c.name.clone(), place, at, *z)
            })
            .collect();
        outcome.modes.push(IdentifiedMode {
            freq_hz: mode.freq_hz,
            freq_sd_hz: Some(*f_sd),
            damping: mode.damping,
            damping_sd: Some(*zeta_sd),
            pole: [mode.pole.re, mode.pole.im],
            shape: channels
                .iter()
                .zip(&mode.shape)
                .map(|(c, z)| ShapeValue { dof: c.name.clone(), re: z.re, im: z.im })
                .collect(),
            label,
            points: shape_points::points(points),
            ..IdentifiedMode::default()
        });
    }
    if hubs_only {
        outcome.flags.push(Flag {
            name: "wheels-only".into(),
            text: "sensors on the wheels alone: only the wheels' modes are reported, the body's are not determined".into(),
        });
    }
}

/// The physical fit's labels, shared out one by one, best resemblance of shape and pole first; what is left over has its
/// frequency as name.
fn labels(found: &FreeOutcome, fitted: &Fitted<'_>) -> Vec<String> {
    let known = modes(&fitted.found, &fitted.vehicle, false);
    let at_sensors = |m: &Mode| -> Vec<C64> {
        let system = fitted.families[0].0.system(&values(&fitted.found));
        let Ok(system) = system else { return Vec::new() };
        let rows = system.rows();
        (0..rows.nrows()).map(|i| (0..rows.ncols()).map(|j| m.shape[j] * rows[(i, j)]).sum()).collect()
    };
    let physical: Vec<(Vec<C64>, &Mode, &str)> = fitted
        .found
        .modes
        .iter()
        .zip(&known)
        .map(|((m, ..), k)| (at_sensors(m), m, k.label.as_str()))
        .collect();
    let mac = |a: &[C64], b: &[C64]| -> f64 {
        let inner = |a: &[C64], b: &[C64]| -> C64 { a.iter().zip(b).map(|(x, y)| x.conj() * y).sum() };
        inner(a, b).norm_sqr() / (inner(a, a).re * inner(b, b).re)
    };
    let mut pairs = Vec::new();
    for (i, (mode, ..)) in found.modes.iter().enumerate().filter(|(_, m)| m.0.kind == ModeKind::Oscillatory) {
        for (k, (shape, other, _)) in physical.iter().enumerate() {
            let apart = (mode.pole - other.pole).norm() / other.pole.norm();
            pairs.push((mac(&mode.shape, shape) - apart, i, k));
        }
    }
    pairs.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut labels: Vec<Option<String>> = vec![None; found.modes.len()];
    let mut used = vec![false; physical.len()];
    for (likeness, i, k) in pairs {
        if labels[i].is_none() && !used[k] && likeness > 0.0 {
            labels[i] = Some(physical[k].2.to_owned());
            used[k] = true;
        }
    }
    labels
        .into_iter()
        .zip(&found.modes)
        .map(|(label, (mode, ..))| label.unwrap_or_else(|| format!("extra mode at {:.1} Hz", mode.freq_hz)))
        .collect()
}

/// response.toml and road.toml to go on with.
fn files(found: &FreeOutcome, fitted: &Fitted<'_>, outcome: &IdentifyOutcome) -> Result<Files, StudyError> {
    let response = response(found, fitted)?;
    let spec = VehicleSpec::from(response);
    let mut files = Vec::new();
    if let Ok(text) = toml::to_string(&spec) {
        let text = format!("# identified from {}\n{text}", outcome.recording.name);
        files.push(("vehicle.toml".to_owned(), text.into_bytes()));
    }
    files.extend(road_file(outcome));
    Ok(files)
}

/// The modal sum of the fitted state space: ψ = C v, Lᵀ = v⁻¹ B.
fn response(found: &FreeOutcome, fitted: &Fitted<'_>) -> Result<Response, StudyError> {
    let failed = |e: String| no_start(&e);
    let system = &found.system;
    let n = system.order();
    let (poles, v) = eigen(&system.a).map_err(|e| failed(e.to_string()))?;
    let complex =
        |m: &crate::linalg::Mat| CMat::from_fn(m.nrows(), m.ncols(), |i, j| C64::new(m[(i, j)], 0.0));
    let shapes = complex(&system.c) * &v;
    let participation = solve_complex(&v, &complex(&system.b)).map_err(|e| failed(e.to_string()))?;
    let turned = CMat::from_fn(system.b.ncols(), n, |w, k| participation[(k, w)]);
    let wheels =
        fitted.vehicle.wheels().iter().map(|w| WheelRow { name: w.name.clone(), at_m: w.at_m }).collect();
    let outputs: Vec<String> =
        fitted.drives[0].task.recording.channels().iter().map(output_name(fitted)).collect();
    let response = Response::new(wheels, &outputs, &poles, &shapes, &turned);
    let mut response =
        response.map_err(|source| StudyError::Vehicle { name: "the response found".into(), source })?;
    let labels = labels(found, fitted);
    for mode in &mut response.mode {
        let near = |m: &&(usize, &(Mode, f64, f64))| (m.1.0.freq_hz - mode.freq_hz).abs();
        let at = found.modes.iter().enumerate().collect::<Vec<_>>();
        let at = at.iter().min_by(|a, b| near(a).total_cmp(&near(b)));
        mode.label = at.map(|(i, _)| labels[*i].clone());
    }
    Ok(response)
}

/// `body_displacement_front_left` … where a sensor is at a wheel, else its own name.
fn output_name<'f>(fitted: &'f Fitted<'_>) -> impl Fn(&Channel) -> String + 'f {
    let wheels = fitted.drives[0].task.recording.wheels();
    move |c: &Channel| {
        let corner = c
            .wheel
            .and_then(|w| fitted.vehicle.match_wheel(w, wheels).ok())
            .map(|w| fitted.vehicle.wheels()[w].name.clone());
        let part = match c.place {
            Place::Hub | Place::Axle => "unsprung",
            Place::Suspension => "suspension",
            Place::Body | Place::Cab => "body",
        };
        match (c.quantity, corner) {
            (Quantity::AngularVelocity, _) if c.direction == Direction::PlusX => "roll_displacement".into(),
            (Quantity::AngularVelocity, _) => "pitch_displacement".into(),
            (_, Some(corner)) if corner.is_empty() => format!("{part}_displacement"),
            (_, Some(corner)) => format!("{part}_displacement_{corner}"),
            (_, None) => format!("{}_displacement", c.name.replace('-', "_")),
        }
    }
}
