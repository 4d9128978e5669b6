//! `identify --method ssi`: the classical estimator on a recording.

use super::IdentifyMethod;
use super::StudyError;
use super::identify::{Task, blank};
use super::identify_outcome::{
    Flag, IdentifiedMode, IdentifyOutcome, RejectedMode, ShapeValue, StabilizationPole,
};
use crate::identify::{SsiSettings, StabilitySettings, ssi_cov};

/// The rate is brought down to about this multiple of the band's end.
const RATE_OVER_BAND: f64 = 2.56;
/// A mode this near to a line, relative to its frequency, and damped less than that, is the line.
const LINE_WIDTH: f64 = 0.03;
const LINE_DAMPING: f64 = 0.05;
/// Multiples of a fundamental beyond this stand too close to each other to accuse a mode.
const HIGHEST_MULTIPLE: f64 = 8.0;

pub(super) fn run(task: &Task<'_>) -> Result<IdentifyOutcome, StudyError> {
    let factor = (task.recording.rate_hz() / (RATE_OVER_BAND * task.band_hz[1])).floor().max(1.0) as usize;
    let recording = task.recording.decimated(factor)?;
    let usual = SsiSettings::default();
    // the subspace has no more room than this, and orders are even
    let room = (usual.block_rows - 1) * recording.channels().len() / 2 * 2;
    let settings = SsiSettings {
        stability: StabilitySettings { band_hz: Some(task.band_hz), ..StabilitySettings::default() },
        max_order: usual.max_order.min(room),
        ..usual
    };
    let found =
        ssi_cov(recording.samples(), recording.rate_hz(), &settings).map_err(|e| StudyError::Setting {
            field: "recording",
            expected: "data that the subspace method can use".into(),
            found: e.to_string(),
        })?;
    let mut outcome = blank(task, IdentifyMethod::Ssi, None);
    for r in &found.rejected {
        outcome.rejected.push(RejectedMode { freq_hz: r.freq_hz, damping: r.damping, why: r.why.clone() });
    }
    for mode in &found.modes {
        if let Some(why) = of_a_line(&outcome, mode.freq_hz, mode.damping) {
            outcome.rejected.push(RejectedMode { freq_hz: mode.freq_hz, damping: mode.damping, why });
            continue;
        }
        let number = outcome.modes.len() + 1;
        outcome.modes.push(IdentifiedMode {
            freq_hz: mode.freq_hz,
            freq_sd_hz: mode.freq_sd_hz,
            damping: mode.damping,
            damping_sd: mode.damping_sd,
            pole: mode.pole,
            shape: mode
                .shape
                .iter()
                .map(|s| ShapeValue { dof: recording.channels()[s.channel].name.clone(), re: s.re, im: s.im })
                .collect(),
            label: format!("mode {number}"),
            ..IdentifiedMode::default()
        });
    }
    outcome.rejected.sort_by(|a, b| a.freq_hz.total_cmp(&b.freq_hz));
    outcome.stabilization = found
        .diagram
        .poles
        .iter()
        .map(|p| StabilizationPole {
            order: p.order,
            freq_hz: p.freq_hz,
            damping: p.damping,
            stable: p.stable(),
            why: (!p.stable()).then(|| p.status.words().to_owned()),
        })
        .collect();
    if outcome.modes.is_empty() {
        outcome.converged = false;
        let text =
            "no pole is a mode by the tests of the stabilisation diagram: see what was rejected".to_owned();
        outcome.flags.push(Flag { name: "no-modes".into(), text });
    }
    if task.recording.speed_m_s().is_some() {
        let text =
            "this method assumes white, uncorrelated forces; a road's are neither, and its frequencies and \
                    dampings of a vehicle may be off by ten per cent and by several points"
                .to_owned();
        outcome.flags.push(Flag { name: "classical".into(), text });
    }
    Ok(outcome)
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
