//! What an identification found, as it is written to `result.json`.

use super::identify_evidence::{
    ChannelNoise, ClockOffset, FitQuality, OrderTried, RejectedMode, SingularValues, SpectraPlot,
    SpectralLine, StabilizationPole, StartTried,
};
use crate::signal::Repair;
use serde::{Deserialize, Serialize};

/// The result of `identify` (and, with [`IdentifyOutcome::truth`], of `demo`). Frequencies in Hz, damping as a ratio,
/// spectra one-sided per Hz in the channel's SI unit squared.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct IdentifyOutcome {
    /// Whether the method ended with success; false goes with flags that say why.
    pub converged: bool,
    /// `physical`, `ssi` …
    pub method: String,
    /// What a reader must know before the numbers, in words.
    pub flags: Vec<Flag>,
    /// What holds for every result of the method, in words: no warnings.
    #[serde(default)]
    pub notes: Vec<Flag>,
    /// The modes, ascending in frequency.
    pub modes: Vec<IdentifiedMode>,
    /// The road's roughness, where the method finds it.
    pub road: Option<IdentifiedRoad>,
    /// The coherence of left and right tracks, where the method finds it.
    pub coherence: Option<IdentifiedCoherence>,
    /// Delay of the rear axle behind the front one, s, where a speed is known.
    pub delay_s: Option<f64>,
    /// Its standard deviation, s.
    pub delay_sd_s: Option<f64>,
    /// Noise floor of each channel.
    pub noise: Vec<ChannelNoise>,
    /// What was found and left out, and why.
    pub rejected: Vec<RejectedMode>,
    /// Narrow spectral lines (rotating parts, limit cycles): not modes.
    #[serde(default)]
    pub lines: Vec<SpectralLine>,
    /// The vehicle's fitted parameters (`physical`).
    #[serde(default)]
    pub parameters: Vec<FittedParameter>,
    /// Parameters held at a value: the scale of masses, stiffnesses and dampers (`physical`).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub held: Vec<HeldParameter>,
    /// How good the fit is (`physical`).
    #[serde(default)]
    pub fit: Option<FitQuality>,
    /// What was recorded, and what was repaired.
    pub recording: RecordingSummary,
    /// Measured and fitted spectra.
    pub spectra: SpectraPlot,
    /// All poles at all orders (`ssi`, `plscf`).
    #[serde(default)]
    pub stabilization: Vec<StabilizationPole>,
    /// Singular values of the cross-spectral matrix, largest first: what stabilisation diagrams are drawn over.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub singular_values: Option<SingularValues>,
    /// Modal assurance criteria between all modes, in their order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub mac: Vec<Vec<f64>>,
    /// The starts that were tried, the best first (`physical` without a vehicle file, `tvimm`).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub starts: Vec<StartTried>,
    /// The numbers of modes that were tried (`tvimm`).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub orders: Vec<OrderTried>,
    /// Sensors whose clock is off (`physical`).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub clocks: Vec<ClockOffset>,
    /// Each recording by itself, where several were given or one was cut by speed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub runs: Vec<RunSummary>,
    /// What is known of a simulated drive, for comparison: `demo` only, `identify` never sees it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub truth: Option<Truth>,
}

/// A warning in words, with a name to script against.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Flag {
    /// `not-converged`, `misfit`, `not-identifiable`, `no-speed` …
    pub name: String,
    /// A sentence with the numbers.
    pub text: String,
}

/// One mode.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct IdentifiedMode {
    /// |λ|/2π.
    pub freq_hz: f64,
    /// Its standard deviation, where the method gives one.
    pub freq_sd_hz: Option<f64>,
    /// −Re λ/|λ|.
    pub damping: f64,
    /// Its standard deviation.
    pub damping_sd: Option<f64>,
    /// λ as [re, im], 1/s.
    pub pole: [f64; 2],
    /// The shape at degrees of freedom (`physical`) or channels (`ssi`, `plscf`, `fdd`), largest component 1.
    pub shape: Vec<ShapeValue>,
    /// The motion that it resembles.
    pub label: String,
    /// Vertical displacements where the vehicle can be drawn: corners, hubs, sensors.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub points: Vec<ShapePoint>,
    /// Modal phase collinearity of the shape: 1 for a standing wave, 0 for a travelling one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mpc: Option<f64>,
    /// Mean phase of the shape's components, degrees in (−90, 90].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mean_phase_deg: Option<f64>,
}

/// The vertical displacement of a point of the vehicle in a mode; the largest of all points of a mode is 1.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ShapePoint {
    /// A sensor's name, or `body front-left`, `hub front-left` …
    pub name: String,
    /// `body`, `hub`, `axle`, `cab`.
    pub place: String,
    /// [x, y], m: x forward, y left.
    pub at_m: [f64; 2],
    /// Real part.
    pub re: f64,
    /// Imaginary part.
    pub im: f64,
}

/// One recording of several, identified by itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunSummary {
    /// The description's file name, or the part of the drive.
    pub name: String,
    /// Mean speed.
    pub speed_m_s: Option<f64>,
    /// Length.
    pub duration_s: f64,
    /// Whether the fit of this recording converged.
    pub converged: bool,
    /// Its flags.
    pub flags: Vec<Flag>,
    /// Its own modes (shapes and points left out).
    pub modes: Vec<IdentifiedMode>,
    /// Its road: from the fit with the shared vehicle where there is one.
    pub road: Option<IdentifiedRoad>,
    /// Its coherence, likewise.
    pub coherence: Option<IdentifiedCoherence>,
    /// Its delay, s, likewise.
    pub delay_s: Option<f64>,
    /// Its residual statistic.
    pub chi: Option<f64>,
}

/// One component of a shape.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ShapeValue {
    /// Degree of freedom or channel.
    pub dof: String,
    /// Real part.
    pub re: f64,
    /// Imaginary part.
    pub im: f64,
}

/// The road: G(ν) = roughness (ν/1 rad/m)^−exponent in `convention`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct IdentifiedRoad {
    /// At 1 rad/m, m³.
    pub roughness_m3: f64,
    /// Standard deviation.
    pub roughness_sd_m3: f64,
    /// e.
    pub exponent: f64,
    /// Standard deviation.
    pub exponent_sd: f64,
    /// Correlation of the errors of the roughness's logarithm and the exponent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub correlation: Option<f64>,
    /// What the roughness is a density of.
    pub convention: crate::units::Convention,
    /// The class of ISO 8608 of the same roughness as a one-sided density per rad/m.
    pub class: crate::road::IsoClass,
    /// The band of ν that the fit saw, rad/m.
    pub band_rad_per_m: [f64; 2],
}

impl IdentifiedRoad {
    /// The roughness and its standard deviation as ISO 8608 writes them: one-sided, per rad/m, at 1 rad/m.
    #[must_use]
    pub fn one_sided(&self) -> (f64, f64) {
        use crate::units::Convention;
        // a factor between conventions does not depend on the speed
        let convert =
            |s: f64| Convention::OneSidedRadPerM.density(self.convention.two_sided_time(s, 1.0), 1.0);
        (convert(self.roughness_m3), convert(self.roughness_sd_m3))
    }
}

/// Bogsjö's μ.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct IdentifiedCoherence {
    /// μ of Γ = exp(−μ W ν/2π).
    pub mu: f64,
    /// Standard deviation.
    pub mu_sd: f64,
}

/// A fitted parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FittedParameter {
    /// Dotted name as in the vehicle file.
    pub name: String,
    /// Found.
    pub value: f64,
    /// Standard deviation.
    pub sd: f64,
    /// Where the fit started.
    pub start: f64,
}

/// A parameter that was not fitted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HeldParameter {
    /// Dotted name as in the vehicle file.
    pub name: String,
    /// Where it stood.
    pub value: f64,
}

/// What was recorded.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct RecordingSummary {
    /// The description's file name.
    pub name: String,
    /// s.
    pub duration_s: f64,
    /// Samples per second.
    pub rate_hz: f64,
    /// Mean speed.
    pub speed_m_s: Option<f64>,
    /// Standard deviation of the speed.
    pub speed_spread_m_s: Option<f64>,
    /// Channels that were used.
    pub channels: Vec<ChannelSummary>,
    /// Each repair.
    pub repairs: Vec<Repair>,
    /// Segment length of the spectra, s.
    pub segment_s: f64,
    /// Independent averages of the spectra.
    pub averages: f64,
    /// The band that was fitted, Hz.
    pub band_hz: [f64; 2],
}

/// One channel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ChannelSummary {
    /// Name.
    pub name: String,
    /// `acceleration` …
    pub quantity: String,
    /// SI unit.
    pub unit: String,
    /// `body` …
    pub place: String,
    /// Wheel, where it is at one.
    pub wheel: Option<String>,
    /// rms without the mean, in the unit.
    pub rms: f64,
}

/// What is known of a simulated drive.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Truth {
    /// Modes.
    pub modes: Vec<TrueMode>,
    /// One-sided per rad/m at 1 rad/m, m³.
    pub roughness_m3: f64,
    /// e.
    pub exponent: f64,
    /// μ.
    pub mu: Option<f64>,
    /// Delay, s.
    pub delay_s: f64,
    /// Parameters by dotted name.
    pub parameters: Vec<(String, f64)>,
}

/// A true mode.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TrueMode {
    /// Label.
    pub label: String,
    /// Hz.
    pub freq_hz: f64,
    /// Ratio.
    pub damping: f64,
}
