//! `identify --method ssi`, `plscf` and `fdd`: the classical estimators on a recording.

use super::IdentifyMethod;
use super::StudyError;
use super::identify::{Task, blank};
use super::identify_evidence::{RejectedMode, StabilizationPole};
use super::identify_outcome::{Flag, IdentifiedMode, IdentifyOutcome, ShapeValue};
use crate::identify::operational::modal_assurance;
use crate::identify::{
    FddMode, FddSettings, Mode, OperationalError, PlscfSettings, Rejected, ShapeComponent, SsiSettings,
    StabilitySettings, StabilizationDiagram, fdd, plscf, ssi_cov,
};
use crate::signal::Recording;
use crate::units::rad_per_s;

/// The rate is brought down to about this multiple of the band's end.
const RATE_OVER_BAND: f64 = 2.56;
/// A mode this near to a line, relative to its frequency, and damped less than that, is the line.
const LINE_WIDTH: f64 = 0.03;
const LINE_DAMPING: f64 = 0.05;
/// Multiples of a fundamental beyond this stand too close to each other to accuse a mode.
const HIGHEST_MULTIPLE: f64 = 8.0;

/// Segments side by side that frequency domain decomposition wants.
pub(super) const FDD_SEGMENTS: usize = 4;

/// What a method found, before lines are told from modes.
struct Found {
    modes: Vec<IdentifiedMode>,
    rejected: Vec<RejectedMode>,
    stabilization: Vec<StabilizationPole>,
    no_modes: &'static str,
}

pub(super) fn run(
    task: &Task<'_>,
    method: IdentifyMethod,
    segment_s: Option<f64>,
) -> Result<IdentifyOutcome, StudyError> {
    let factor = (task.recording.rate_hz() / (RATE_OVER_BAND * task.band_hz[1])).floor().max(1.0) as usize;
    let recording = task.recording.decimated(factor)?;
    if method == IdentifyMethod::Fdd {
        room_for_segments(&recording, segment_s)?;
    }
    let found = match method {
        IdentifyMethod::Plscf => by_plscf(task, &recording),
        IdentifyMethod::Fdd => by_fdd(task, &recording, segment_s),
        _ => by_ssi(task, &recording),
    };
    let found = found.map_err(|e| StudyError::Setting {
        field: "recording",
        expected: format!("data that the method {} can use", method.name()),
        found: e.to_string(),
    })?;
    let mut outcome = blank(task, method, None);
    outcome.rejected = found.rejected;
    outcome.stabilization = found.stabilization;
    for mut mode in found.modes {
        if let Some(why) = of_a_line(&outcome, mode.freq_hz, mode.damping) {
            outcome.rejected.push(RejectedMode { freq_hz: mode.freq_hz, damping: mode.damping, why });
            continue;
        }
        mode.label = format!("mode {}", outcome.modes.len() + 1);
        outcome.modes.push(mode);
    }
    outcome.rejected.sort_by(|a, b| a.freq_hz.total_cmp(&b.freq_hz));
    outcome.mac = assurance(&outcome.modes);
    if outcome.modes.is_empty() {
        outcome.converged = false;
        outcome.flags.push(Flag { name: "no-modes".into(), text: found.no_modes.into() });
    }
    if task.recording.speed_m_s().is_some() {
        let text =
            "this method assumes white, uncorrelated forces; a road's are neither, and its frequencies and \
                    dampings of a vehicle may be off by ten per cent and by several points, modes may be missing, and bumps that the road makes may stand among them"
                .to_owned();
        outcome.flags.push(Flag { name: "classical".into(), text });
    }
    Ok(outcome)
}

const NO_STABLE_POLE: &str =
    "no pole is a mode by the tests of the stabilisation diagram: see what was rejected";

fn by_ssi(task: &Task<'_>, recording: &Recording) -> Result<Found, OperationalError> {
    let usual = SsiSettings::default();
    // the subspace has no more room than this, and orders are even
    let room = (usual.block_rows - 1) * recording.channels().len() / 2 * 2;
    let settings = SsiSettings { stability: stability(task), max_order: usual.max_order.min(room), ..usual };
    let found = ssi_cov(recording.samples(), recording.rate_hz(), &settings)?;
    Ok(of_diagram(recording, &found.modes, &found.rejected, &found.diagram))
}

fn by_plscf(task: &Task<'_>, recording: &Recording) -> Result<Found, OperationalError> {
    let settings = PlscfSettings { stability: stability(task), ..PlscfSettings::default() };
    let found = plscf(recording.samples(), recording.rate_hz(), &settings)?;
    Ok(of_diagram(recording, &found.modes, &found.rejected, &found.diagram))
}

fn stability(task: &Task<'_>) -> StabilitySettings {
    StabilitySettings { band_hz: Some(task.band_hz), ..StabilitySettings::default() }
}

fn of_diagram(
    recording: &Recording,
    modes: &[Mode],
    rejected: &[Rejected],
    diagram: &StabilizationDiagram,
) -> Found {
    let mode = |m: &Mode| IdentifiedMode {
        freq_hz: m.freq_hz,
        freq_sd_hz: m.freq_sd_hz,
        damping: m.damping,
        damping_sd: m.damping_sd,
        pole: m.pole,
        shape: shape(recording, &m.shape),
        mpc: Some(m.phase_collinearity),
        mean_phase_deg: Some(m.mean_phase_deg),
        ..IdentifiedMode::default()
    };
    let poles = diagram.poles.iter().map(|p| StabilizationPole {
        order: p.order,
        freq_hz: p.freq_hz,
        damping: p.damping,
        stable: p.stable(),
        why: (!p.stable()).then(|| p.status.words().to_owned()),
    });
    Found {
        modes: modes.iter().map(mode).collect(),
        rejected: rejected.iter().map(left_out).collect(),
        stabilization: poles.collect(),
        no_modes: NO_STABLE_POLE,
    }
}

/// Refuses segments that a recording has not four of: singular values of fewer say nothing.
fn room_for_segments(recording: &Recording, segment_s: Option<f64>) -> Result<(), StudyError> {
    let (samples, rate_hz) = (recording.len(), recording.rate_hz());
    let longest = samples / FDD_SEGMENTS / 4 * 4;
    match segment_s {
        Some(asked) if fdd_segment(asked, rate_hz) > longest => Err(StudyError::Setting {
            field: "segment_s",
            expected: format!(
                "at most {:.2} s for method fdd, a quarter of what it can use of the recording, {:.2} s",
                // down, so that what is said is taken
                (100.0 * longest as f64 / rate_hz).floor() / 100.0,
                samples as f64 / rate_hz
            ),
            found: format!("{asked} s"),
        }),
        _ => Ok(()),
    }
}

/// Samples of a segment: a multiple of four, as its overlap wants.
fn fdd_segment(segment_s: f64, rate_hz: f64) -> usize {
    (segment_s * rate_hz / 4.0).round() as usize * 4
}

fn by_fdd(task: &Task<'_>, recording: &Recording, segment_s: Option<f64>) -> Result<Found, OperationalError> {
    let segment = segment_s.map(|s| fdd_segment(s, recording.rate_hz()));
    let settings = FddSettings { band_hz: Some(task.band_hz), segment, ..FddSettings::default() };
    let found = fdd(recording.samples(), recording.rate_hz(), &settings)?;
    let mut rejected: Vec<RejectedMode> = found.rejected.iter().map(left_out).collect();
    // a mode is a pole: a peak whose damping cannot be had is told, with the damping of its width
    rejected.extend(found.modes.iter().filter(|m| m.damping.is_none()).map(|m| RejectedMode {
        freq_hz: m.freq_hz,
        damping: m.width_damping,
        why: format!("a peak with a shape, but {}", m.damping_why.as_deref().unwrap_or("without damping")),
    }));
    let mode = |m: &FddMode| {
        let (damping, omega) = (m.damping?, rad_per_s(m.freq_hz));
        Some(IdentifiedMode {
            freq_hz: m.freq_hz,
            freq_sd_hz: m.freq_sd_hz,
            damping,
            damping_sd: m.damping_sd,
            pole: [-omega * damping, omega * (1.0 - damping * damping).max(0.0).sqrt()],
            shape: shape(recording, &m.shape),
            mpc: Some(m.phase_collinearity),
            mean_phase_deg: Some(m.mean_phase_deg),
            ..IdentifiedMode::default()
        })
    };
    Ok(Found {
        modes: found.modes.iter().filter_map(mode).collect(),
        rejected,
        stabilization: Vec::new(),
        no_modes: "no peak of the first singular value is a mode with a damping: see what was rejected",
    })
}

fn left_out(r: &Rejected) -> RejectedMode {
    RejectedMode { freq_hz: r.freq_hz, damping: r.damping, why: r.why.clone() }
}

fn shape(recording: &Recording, components: &[ShapeComponent]) -> Vec<ShapeValue> {
    let name = |s: &ShapeComponent| recording.channels()[s.channel].name.clone();
    components.iter().map(|s| ShapeValue { dof: name(s), re: s.re, im: s.im }).collect()
}

/// The criteria between all modes.
fn assurance(modes: &[IdentifiedMode]) -> Vec<Vec<f64>> {
    let shape = |m: &IdentifiedMode| m.shape.iter().map(|s| [s.re, s.im]).collect::<Vec<_>>();
    let shapes: Vec<_> = modes.iter().map(shape).collect();
    shapes.iter().map(|a| shapes.iter().map(|b| modal_assurance(a, b)).collect()).collect()
}

/// Why a lightly damped mode is no mode: it stands at a line, or at a multiple of a family's fundamental.
fn of_a_line(outcome: &IdentifyOutcome, freq_hz: f64, damping: f64) -> Option<String> {
    if damping >= LINE_DAMPING {
        return None;
    }
    let near = |f: f64| (freq_hz / f - 1.0).abs() < LINE_WIDTH;
    outcome.lines.iter().find_map(|line| {
        if near(line.freq_hz) {
            return Some(format!("at the line of {:.2} Hz: {}", line.freq_hz, line.text));
        }
        let fundamental = line.fundamental_hz?;
        let multiple = (freq_hz / fundamental).round();
        ((1.0..=HIGHEST_MULTIPLE).contains(&multiple) && near(multiple * fundamental))
            .then(|| format!("harmonic {multiple} of the lines' fundamental {fundamental:.2} Hz, not a mode"))
    })
}
