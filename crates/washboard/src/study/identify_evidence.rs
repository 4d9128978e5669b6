//! What stands behind an identification: spectra, starts, orders, poles left out, and how good the fit is.

use serde::{Deserialize, Serialize};

/// Singular values over frequency of spectra whose channels are scaled to an rms of 1.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SingularValues {
    /// Bins, Hz.
    pub freq_hz: Vec<f64>,
    /// One curve a singular value, largest first, 1/Hz.
    pub values: Vec<Vec<f64>>,
}

/// One start of a fit, and where it led.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StartTried {
    /// What it was made from.
    pub name: String,
    /// Whittle cost at its end.
    pub cost: f64,
    /// Residual statistic at its end.
    pub chi: f64,
    /// Whether the search converged.
    pub converged: bool,
    /// Steps taken.
    pub steps: usize,
}

/// One number of modes, and how well it explains the data.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct OrderTried {
    /// Pairs of poles.
    pub modes: usize,
    /// Free parameters.
    pub parameters: usize,
    /// Whittle cost.
    pub cost: f64,
    /// Bayes' criterion (twice the cost and ln of the averages a parameter): the smallest explains best.
    pub bic: f64,
    /// Residual statistic.
    pub chi: f64,
    /// Whether the search converged.
    pub converged: bool,
    /// Whether it is the one reported.
    pub chosen: bool,
}

/// A sensor whose clock runs behind the others.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ClockOffset {
    /// The channel.
    pub channel: String,
    /// How much later than the others' its samples are stamped, s.
    pub offset_s: f64,
    /// Standard deviation, s.
    pub sd_s: f64,
}

/// Noise of a channel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ChannelNoise {
    /// The channel.
    pub channel: String,
    /// White floor, one-sided per Hz, unit²/Hz.
    pub floor_per_hz: f64,
    /// rms of that floor up to half the sampling rate, unit.
    pub rms: f64,
}

/// How good a fit is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FitQuality {
    /// Whittle cost at the end.
    pub cost: f64,
    /// Newton decrement at the end (converged below 1).
    pub decrement: f64,
    /// n_avg · mean |L⁻¹ŜL⁻ᴴ − I|²: about .4 for a model that explains the data, above .6 for one that does not.
    pub chi: f64,
    /// The same per frequency bin.
    pub residual_freq_hz: Vec<f64>,
    /// The same per frequency bin.
    pub residual: Vec<f64>,
    /// Steps taken.
    pub iterations: usize,
    /// Evaluations of the model and its derivatives.
    pub evaluations: usize,
}

/// Spectra to plot.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct SpectraPlot {
    /// Bins, Hz.
    pub freq_hz: Vec<f64>,
    /// A measured density times these is its 95 % interval.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub confidence: Option<[f64; 2]>,
    /// Auto-spectra, one a channel.
    pub channels: Vec<ChannelSpectrum>,
    /// Cross-spectra of a few telling pairs: front-rear, left-right, body-hub.
    pub pairs: Vec<PairSpectrum>,
}

/// Measured and fitted auto-spectrum, one-sided per Hz.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ChannelSpectrum {
    /// The channel.
    pub channel: String,
    /// unit²/Hz.
    pub unit: String,
    /// Welch's estimate.
    pub measured: Vec<f64>,
    /// The model's, noise floor included; empty where the method has none.
    pub fitted: Vec<f64>,
}

/// Coherence (|S₁₂|²/(S₁₁S₂₂)) and phase of a pair.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PairSpectrum {
    /// First channel.
    pub first: String,
    /// Second channel.
    pub second: String,
    /// Magnitude-squared coherence, measured.
    pub coherence: Vec<f64>,
    /// Magnitude-squared coherence of the model; empty where the method has none.
    pub fitted_coherence: Vec<f64>,
    /// Phase of S₁₂ in rad, measured.
    pub phase_rad: Vec<f64>,
    /// Phase of the model.
    pub fitted_phase_rad: Vec<f64>,
}

/// A pole of the stabilisation diagram.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StabilizationPole {
    /// Model order.
    pub order: usize,
    /// Hz.
    pub freq_hz: f64,
    /// Damping ratio.
    pub damping: f64,
    /// Whether it is stable.
    pub stable: bool,
    /// Why not.
    pub why: Option<String>,
}

/// A narrow line.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SpectralLine {
    /// Frequency, Hz.
    pub freq_hz: f64,
    /// Height over the local floor, as a ratio of densities.
    pub over_floor: f64,
    /// The fundamental of its family of harmonics, Hz.
    pub fundamental_hz: Option<f64>,
    /// Which multiple of it.
    pub multiple: Option<u32>,
    /// In words.
    pub text: String,
}

/// Something that was found and left out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RejectedMode {
    /// Frequency, Hz.
    pub freq_hz: f64,
    /// Damping ratio.
    pub damping: f64,
    /// The reason.
    pub why: String,
}
