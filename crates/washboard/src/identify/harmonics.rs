//! Narrow spectral lines and harmonic families: engine orders and limit cycles, which are no modes.

mod peaks;

use peaks::{Peak, peaks};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Harmonics up to this multiple of a fundamental are looked for.
const HIGHEST_MULTIPLE: usize = 8;
/// A family's member lies within so many bins of its multiple: peaks of a wandering cycle are known to about one.
const FAMILY_BINS: f64 = 1.25;
/// So many sharp peaks at integer ratios are no coincidence of modes.
const FAMILY_MEMBERS: usize = 3;
/// Trial fundamentals per bin.
const TRIALS_PER_BIN: i32 = 10;

/// What [`spectral_lines`] is told beside the spectra.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LineSettings {
    /// Probability that noise alone yields one peak or more in all bins of all channels.
    pub false_alarm: f64,
    /// A peak stands at least so far above the local floor, whatever the averages say (4 is 6 dB).
    pub min_ratio: f64,
    /// The least damping ratio that a mode may have: a narrower peak is a line. A vehicle's are 0.02 and more.
    pub least_mode_damping: f64,
}

impl Default for LineSettings {
    fn default() -> Self {
        Self { false_alarm: 0.01, min_ratio: 4.0, least_mode_damping: 0.015 }
    }
}

/// A narrow line in the spectra.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Line {
    /// Centre of gravity of the peak in Hz.
    pub freq_hz: f64,
    /// The channels in which it stands above the threshold, the clearest first.
    pub channels: Vec<usize>,
    /// Peak over the local floor in the clearest channel.
    pub ratio: f64,
    /// Width at half power in Hz in that channel, the window's own included.
    pub width_hz: f64,
    /// Power at the peak over the power a little beside it …
    pub drop: f64,
    /// … and the most that the least damped mode would have there by theory and chance.
    pub mode_drop: f64,
    /// The family that it belongs to.
    pub family: Option<Family>,
}

impl Line {
    /// Whether it is a line by itself, narrower than any mode, and not by its family alone.
    #[must_use]
    pub fn narrow(&self) -> bool {
        self.drop > self.mode_drop
    }
}

/// Which harmonic of what.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Family {
    /// The fundamental in Hz, from all members.
    pub fundamental_hz: f64,
    /// The line is at about so many times it.
    pub multiple: usize,
}

/// What [`spectral_lines`] refuses.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum LineError {
    /// The frequency grid is not one.
    #[error("freq_hz: expected at least {least} frequencies evenly spaced from 0 or above, found {found}")]
    Grid {
        /// Fewest.
        least: usize,
        /// How many are evenly spaced from the first.
        found: usize,
    },
    /// A spectrum does not fit the grid.
    #[error("spectrum {channel}: expected {expected} values, found {found}")]
    Length {
        /// Which channel.
        channel: usize,
        /// Frequencies.
        expected: usize,
        /// Values.
        found: usize,
    },
    /// A spectral value is negative, NaN or infinite.
    #[error("spectrum {channel} at {freq_hz} Hz: expected a number from 0, found {value}")]
    Value {
        /// Which channel.
        channel: usize,
        /// Where.
        freq_hz: f64,
        /// What stands there.
        value: f64,
    },
    /// A setting or the number of averages has no meaning.
    #[error("{field}: expected {expected}, found {found}")]
    Setting {
        /// Which field.
        field: &'static str,
        /// What it must be.
        expected: &'static str,
        /// What it is.
        found: f64,
    },
}

/// Lines that are narrower than a damped mode could be, and harmonic families of sharp peaks, by ascending frequency.
///
/// A peak is a local maximum of max over channels of G/floor above the quantile of χ²_{2K}/2K at the false-alarm
/// rate over all bins and channels; the floor is the geometric mean of the medians on both sides, which a slope
/// leaves alone. A mode of damping ζ falls to 1/(1 + (d/ζf)²) at d Hz beside its peak: a peak that falls further
/// than the least damped mode is a line. A limit cycle that wanders, or lasts for part of the drive, may be as wide
/// as a mode; three sharp peaks or more at f, 2f, 3f, … are lines too.
///
/// | symbol | shape | unit |
/// |---|---|---|
/// | `freq_hz` | bins, evenly spaced | Hz |
/// | `psd` | channels × bins | any, one- or two-sided |
/// | `averages` | K | effective number of independent averages |
///
/// Assumes spectra averaged under a window whose leakage is below a hundredth beyond three bins, as Hann's; the
/// resolution should be finer than the width 2ζf of the modes of interest.
///
/// # Errors
/// A grid that is not even, spectra that don't fit or are negative, settings without meaning.
///
/// Source: Brincker, Andersen and Møller, *An indicator for separation of structural and harmonic modes*, IMAC 2000,
/// states the problem; the test is built from χ² statistics and the resonance curve.
pub fn spectral_lines(
    freq_hz: &[f64],
    psd: &[Vec<f64>],
    averages: f64,
    settings: &LineSettings,
) -> Result<Vec<Line>, LineError> {
    check(freq_hz, psd, averages, settings)?;
    let bin_hz = freq_hz[1] - freq_hz[0];
    let found = peaks(freq_hz, psd, averages, settings);
    let mut member: Vec<Option<Family>> = vec![None; found.len()];
    // the strongest family first; a peak belongs to one
    while let Some((fundamental_hz, members)) = best_family(&found, &member, bin_hz) {
        for (peak, multiple) in members {
            member[peak] = Some(Family { fundamental_hz, multiple });
        }
    }
    let lines = found.into_iter().zip(member).filter(|(p, family)| p.narrow() || family.is_some());
    Ok(lines.map(|(p, family)| p.into_line(family)).collect())
}

/// Peaks and which multiple each is.
type Members = Vec<(usize, usize)>;

/// The fundamental and its members with the largest Σ ln ratio among the peaks without a family.
fn best_family(peaks: &[Peak], taken: &[Option<Family>], bin_hz: f64) -> Option<(f64, Members)> {
    let free = |k: &usize| taken[*k].is_none() && (peaks[*k].sharp || peaks[*k].narrow());
    let free: Vec<usize> = (0..peaks.len()).filter(free).collect();
    let mut best: Option<(f64, Members)> = None;
    for &first in &free {
        for trial in -TRIALS_PER_BIN..=TRIALS_PER_BIN {
            let f = peaks[first].freq_hz + bin_hz * f64::from(trial) / f64::from(TRIALS_PER_BIN);
            let (mut members, mut score) = (vec![(first, 1)], peaks[first].ratio.ln());
            for multiple in 2..=HIGHEST_MULTIPLE {
                let away = |k: &usize| (peaks[*k].freq_hz - multiple as f64 * f).abs();
                let nearest = free.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
                if let Some(k) = nearest.filter(|k| **k != first && away(k) <= FAMILY_BINS * bin_hz) {
                    // of two trials with the same members the one that fits better
                    score += peaks[*k].ratio.ln() - 0.1 * (away(k) / bin_hz).powi(2);
                    members.push((*k, multiple));
                }
            }
            let all_narrow = members.iter().all(|(k, _)| peaks[*k].narrow());
            let enough = members.len() >= if all_narrow { 2 } else { FAMILY_MEMBERS };
            if enough && best.as_ref().is_none_or(|b| score > b.0) {
                best = Some((score, members));
            }
        }
    }
    best.map(|(_, members)| {
        // every member's error is about a bin: least squares of f_k = m_k f
        let of = |(k, m): &(usize, usize)| (peaks[*k].freq_hz * *m as f64, (m * m) as f64);
        let (up, down) = members.iter().map(of).fold((0.0, 0.0), |s, x| (s.0 + x.0, s.1 + x.1));
        (up / down, members)
    })
}

fn check(freq_hz: &[f64], psd: &[Vec<f64>], averages: f64, s: &LineSettings) -> Result<(), LineError> {
    const LEAST: usize = 32;
    const EVEN: f64 = 1e-6; // of a bin: a grid printed with seven digits is even
    let step = if freq_hz.len() < 2 { 0.0 } else { freq_hz[1] - freq_hz[0] };
    let even =
        |k: &usize| (freq_hz[*k] - freq_hz[0] - *k as f64 * step).abs() <= EVEN * step * (1 + *k) as f64;
    let found = if step > 0.0 && freq_hz[0] >= 0.0 { (0..freq_hz.len()).take_while(even).count() } else { 0 };
    if found < freq_hz.len() || found < LEAST {
        return Err(LineError::Grid { least: LEAST, found });
    }
    for (channel, g) in psd.iter().enumerate() {
        if g.len() != freq_hz.len() {
            return Err(LineError::Length { channel, expected: freq_hz.len(), found: g.len() });
        }
        if let Some(k) = g.iter().position(|v| !(v.is_finite() && *v >= 0.0)) {
            return Err(LineError::Value { channel, freq_hz: freq_hz[k], value: g[k] });
        }
    }
    let require = |holds: bool, field, expected, found| {
        if holds { Ok(()) } else { Err(LineError::Setting { field, expected, found }) }
    };
    require(averages.is_finite() && averages >= 1.0, "averages", "at least 1", averages)?;
    let part = s.false_alarm > 0.0 && s.false_alarm < 1.0;
    require(part, "false_alarm", "between 0 and 1", s.false_alarm)?;
    require(s.min_ratio >= 1.0, "min_ratio", "at least 1", s.min_ratio)?;
    let least = s.least_mode_damping;
    require(least > 0.0 && least < 1.0, "least_mode_damping", "between 0 and 1", least)
}
