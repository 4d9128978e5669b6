//! What changed between two identifications, as it is written to `result.json`.

use super::identify_outcome::{Flag, ShapePoint};
use serde::{Deserialize, Serialize};

/// Two results side by side. A difference is after less before; frequencies in Hz, damping as a ratio.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct CompareOutcome {
    /// Whether both are results and have something in common; false goes with flags that say why.
    pub comparable: bool,
    /// The earlier result.
    pub before: ComparedResult,
    /// The later one.
    pub after: ComparedResult,
    /// What a reader must know before the numbers, in words.
    pub flags: Vec<Flag>,
    /// Changes that could be judged: both standard deviations are known.
    pub judged: usize,
    /// How many of these are significant at 95 %; one in twenty would be where nothing changed.
    pub significant: usize,
    /// Modes that both have, in the order of the earlier result.
    pub modes: Vec<ModeChange>,
    /// Parameters that both have, by their dotted names.
    pub parameters: Vec<NamedChange>,
    /// `road.roughness_m3` (one-sided per rad/m at 1 rad/m), `road.exponent`, `coherence.mu`, `delay_s`, where both have it.
    pub quantities: Vec<NamedChange>,
    /// What only one of them has.
    pub unmatched: Unmatched,
    /// Measured spectra of the channels that both have.
    pub spectra: ComparedSpectra,
}

/// One of the two.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct ComparedResult {
    /// The result file.
    pub path: String,
    /// The recording's name.
    pub recording: String,
    /// `physical`, `ssi` …
    pub method: String,
    /// Whether it is a result.
    pub converged: bool,
}

/// A number before and after.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Change {
    /// Before.
    pub before: f64,
    /// Its standard deviation, where one is known.
    pub before_sd: Option<f64>,
    /// After.
    pub after: f64,
    /// Its standard deviation.
    pub after_sd: Option<f64>,
    /// After less before.
    pub difference: f64,
    /// √(sd² + sd²) of independent estimates; null where one of the two is unknown.
    pub difference_sd: Option<f64>,
    /// Whether the difference is beyond 1.96 of its standard deviations; false where it cannot be judged.
    pub significant: bool,
    /// Why it cannot be judged.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub not_judged: Option<String>,
}

/// A number with a name before and after.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NamedChange {
    /// Dotted, with the unit where it has one.
    pub name: String,
    /// The numbers.
    #[serde(flatten)]
    pub change: Change,
}

/// How two modes were found to be one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MatchedBy {
    /// Their shapes at the points that both have are alike.
    Shape,
    /// Their poles are the nearest.
    Pole,
}

/// A mode before and after.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModeChange {
    /// Its number before, from 1.
    pub before: usize,
    /// Its number after, from 1.
    pub after: usize,
    /// Its label before.
    pub label_before: String,
    /// Its label after.
    pub label_after: String,
    /// How it was found again.
    pub matched_by: MatchedBy,
    /// Modal assurance criterion over the points that both have; null where these are fewer than two.
    pub mac: Option<f64>,
    /// Frequency.
    pub freq_hz: Change,
    /// Damping ratio.
    pub damping: Change,
    /// Its shape before.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub points_before: Vec<ShapePoint>,
    /// Its shape after, turned to the phase of the one before.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub points_after: Vec<ShapePoint>,
}

/// What has no partner.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Unmatched {
    /// Modes that only the earlier result has.
    pub modes_before: Vec<UnmatchedMode>,
    /// Modes that only the later one has.
    pub modes_after: Vec<UnmatchedMode>,
    /// Parameters, quantities and channels that only the earlier result has.
    pub names_before: Vec<String>,
    /// The same of the later one.
    pub names_after: Vec<String>,
}

/// A mode without partner.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct UnmatchedMode {
    /// Its number, from 1.
    pub number: usize,
    /// Its label.
    pub label: String,
    /// Frequency.
    pub freq_hz: f64,
    /// Damping ratio.
    pub damping: f64,
}

/// Measured spectra, one-sided per Hz.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct ComparedSpectra {
    /// Bins of the earlier result.
    pub freq_before_hz: Vec<f64>,
    /// Bins of the later one.
    pub freq_after_hz: Vec<f64>,
    /// The channels.
    pub channels: Vec<ComparedChannel>,
}

/// A channel's measured spectrum before and after.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ComparedChannel {
    /// The channel.
    pub channel: String,
    /// Of the densities.
    pub unit: String,
    /// At the earlier result's bins.
    pub before: Vec<f64>,
    /// At the later one's.
    pub after: Vec<f64>,
}
