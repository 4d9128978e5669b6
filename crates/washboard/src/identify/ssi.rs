//! Covariance-driven stochastic subspace identification (SSI-cov): modes from output correlations alone.

mod clusters;
mod stabilization;
mod subspace;

pub use clusters::{Mode, Reason, Rejected, ShapeComponent};
pub use stabilization::{Pole, PoleStatus, StabilizationDiagram};

use crate::linalg::{LinalgError, Mat};
use crate::signal::{CorrelationError, correlations};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// What SSI-cov is told beside the data. [`SsiSettings::default`] suits a dozen modes or fewer.
///
/// No setting is a cut-off of damping: a car's body mode with ζ = 0.3–0.45 is an ordinary mode.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SsiSettings {
    /// Block rows i of the Toeplitz matrix: lags 1 … 2i − 1 are used. Choose i ≥ rate/(2 f) for the lowest mode f.
    pub block_rows: usize,
    /// Lowest model order, even.
    pub min_order: usize,
    /// Highest model order, even, at most (i − 1) × channels.
    pub max_order: usize,
    /// A stable pole's frequency differs by at most this fraction from one of the order before.
    pub frequency_tolerance: f64,
    /// A stable pole's damping ratio differs by at most this from that pole's (0.02 is two points) …
    pub damping_tolerance: f64,
    /// … or by this fraction of itself, whichever is more: a heavily damped mode's ζ scatters more.
    pub damping_tolerance_relative: f64,
    /// A stable pole's shape has at least this modal assurance criterion with that pole's.
    pub min_mac: f64,
    /// A mode is a cluster of stable poles at so many orders at least, as a fraction of the orders computed.
    pub min_order_fraction: f64,
    /// A mode's part of the spectrum exceeds the spectrum's sampling error by so many standard deviations: poles settle
    /// on the highest of some hundred chance bumps, which reach about four.
    pub min_significance: f64,
    /// Poles outside this band are left out, with that reason; without it, those within 2 % of the Nyquist frequency.
    pub band_hz: Option<[f64; 2]>,
}

impl Default for SsiSettings {
    fn default() -> Self {
        Self {
            block_rows: 50,
            min_order: 2,
            max_order: 60,
            frequency_tolerance: 0.02,
            damping_tolerance: 0.02,
            damping_tolerance_relative: 0.1,
            min_mac: 0.95,
            min_order_fraction: 0.4,
            min_significance: 5.0,
            band_hz: None,
        }
    }
}

/// What [`ssi_cov`] found, and what it left out and why.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SsiOutcome {
    /// The modes, by ascending frequency.
    pub modes: Vec<Mode>,
    /// Every other pole, condensed by reason and place; `Σ modes.orders + Σ rejected.poles` is the number of poles.
    pub rejected: Vec<Rejected>,
    /// The poles of all orders.
    pub diagram: StabilizationDiagram,
    /// Singular values of the Toeplitz matrix of normalised correlations, descending.
    pub singular_values: Vec<f64>,
}

/// What [`ssi_cov`] refuses.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum SsiError {
    /// A setting that has no meaning, or not for these channels.
    #[error("{field}: expected {expected}, found {found}")]
    Setting {
        /// Which field.
        field: &'static str,
        /// What it must be.
        expected: String,
        /// What it is.
        found: f64,
    },
    /// A channel does not move: it has no correlation to learn from.
    #[error("channel {channel} is constant ({value})")]
    Constant {
        /// Which channel.
        channel: usize,
        /// Its value.
        value: f64,
    },
    /// The channels can't be correlated.
    #[error(transparent)]
    Correlation(#[from] CorrelationError),
    /// A factorisation failed.
    #[error(transparent)]
    Linalg(#[from] LinalgError),
}

/// Modes from channels recorded at one rate under broadband excitation, by SSI-cov.
///
/// Λ_k = E[y(t+k) y(t)ᵀ] = C A^{k−1} G;  T = [Λ_{i+r−c}] = O Γ, O = [C; CA; …] from the leading left singular
/// vectors;  A from O's shift invariance at every order;  λ = rate · ln μ, f = |λ|/2π, ζ = −Re λ/|λ|, shape = C ψ
///
/// | symbol | shape | unit |
/// |---|---|---|
/// | `channels` | channels × samples | any, one unit a channel |
/// | `rate_hz` | | Hz |
/// | T | (block_rows · channels)² | |
///
/// Assumes a linear time-invariant structure under stationary forces that are white in the band. A road is not
/// white and reaches the rear wheels after the front ones, which biases frequencies and dampings by several percent
/// and points: see the physical estimators for a vehicle on a road. The mean of every channel is removed (gravity
/// is no vibration). Channels are divided by their rms while subspaces are computed, so that the result does not
/// depend on units; shapes are returned in the channels' own units.
///
/// # Errors
/// Settings without meaning, channels that differ in length, are constant, too short or not finite.
///
/// Numerical note: one SVD and one QR serve all orders (the leading n columns of O = QR give order n by an n × n
/// triangular solve).
///
/// Source: Peeters and De Roeck, *Reference-based stochastic subspace identification for output-only modal
/// analysis*, MSSP 13 (1999); Döhler and Mevel, *Fast multi-order computation of system matrices in subspace-based
/// system identification*, Control Engineering Practice 20 (2012).
///
/// ```
/// use washboard::identify::{SsiSettings, ssi_cov};
/// // a 1.5 Hz resonance (ζ = 0.05) struck by a pseudo-random force, sampled at 10 Hz
/// let (r, phi) = ((-0.05 * 0.3 * std::f64::consts::PI).exp(), 0.3 * std::f64::consts::PI);
/// let (mut y, mut seed) = (vec![0.0, 0.0], 1u64);
/// for t in 2..20_000 {
///     seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
///     let force = (seed >> 11) as f64 / (1u64 << 53) as f64 - 0.5;
///     y.push(2.0 * r * phi.cos() * y[t - 1] - r * r * y[t - 2] + force);
/// }
/// let settings = SsiSettings { max_order: 20, ..SsiSettings::default() };
/// let outcome = ssi_cov(&[y], 10.0, &settings)?;
/// assert_eq!(outcome.modes.len(), 1);
/// assert!((outcome.modes[0].freq_hz - 1.5).abs() < 0.02);
/// assert!((outcome.modes[0].damping - 0.05).abs() < 0.01);
/// # Ok::<(), washboard::identify::SsiError>(())
/// ```
pub fn ssi_cov(channels: &[Vec<f64>], rate_hz: f64, settings: &SsiSettings) -> Result<SsiOutcome, SsiError> {
    check(channels.len(), rate_hz, settings)?;
    let (normalised, rms) = normalise(channels)?;
    let lambda = correlations(&normalised, 2 * settings.block_rows - 1)?;
    let realisations = subspace::realisations(&lambda, settings)?;
    let samples = channels[0].len();
    let count = channels.len();
    let at_zero_lag = Mat::from_fn(count, count, |i, j| lambda.at(i, j, 0));
    let record = stabilization::Record { rate_hz, samples, lags: lambda.lags() - 1, at_zero_lag };
    let diagram = stabilization::diagram(&realisations.orders, &record, settings)?;
    let (modes, rejected) = clusters::modes(&diagram, &rms, settings);
    let diagram = diagram.in_units(&rms);
    Ok(SsiOutcome { modes, rejected, diagram, singular_values: realisations.singular_values })
}

/// A channel that departs from its mean by less is constant: the mean of a million samples is exact to 1e-13.
const CONSTANT: f64 = 1e-12;

/// Channels without their means and divided by their rms; and these rms.
fn normalise(channels: &[Vec<f64>]) -> Result<(Vec<Vec<f64>>, Vec<f64>), SsiError> {
    let (mut normalised, mut all_rms) = (Vec::new(), Vec::new());
    for (channel, data) in channels.iter().enumerate() {
        if let Some(sample) = data.iter().position(|v| !v.is_finite()) {
            let value = data[sample];
            return Err(CorrelationError::NotFinite { channel, sample, value }.into());
        }
        let count = data.len().max(1) as f64;
        let mean = data.iter().map(|v| v / count).sum::<f64>();
        // by the largest deviation first, so that no square overflows
        let largest = data.iter().fold(0.0f64, |m, v| m.max((v - mean).abs()));
        if largest <= CONSTANT * mean.abs() {
            return Err(SsiError::Constant { channel, value: mean });
        }
        let square = data.iter().map(|v| ((v - mean) / largest).powi(2)).sum::<f64>() / count;
        let rms = largest * square.sqrt();
        normalised.push(data.iter().map(|v| (v - mean) / rms).collect());
        all_rms.push(rms);
    }
    Ok((normalised, all_rms))
}

fn check(channels: usize, rate_hz: f64, s: &SsiSettings) -> Result<(), SsiError> {
    let require = |holds: bool, field, expected: String, found: f64| {
        if holds { Ok(()) } else { Err(SsiError::Setting { field, expected, found }) }
    };
    if channels == 0 {
        return Err(CorrelationError::NoChannel.into());
    }
    let positive = |x: f64| x.is_finite() && x > 0.0;
    let even = |x: usize| x >= 2 && x.is_multiple_of(2);
    let largest = s.block_rows.saturating_sub(1) * channels;
    require(positive(rate_hz), "rate_hz", "a positive number".into(), rate_hz)?;
    require(s.block_rows >= 2, "block_rows", "at least 2".into(), s.block_rows as f64)?;
    let low = "an even number from 2 to max_order";
    let sound = even(s.min_order) && s.min_order <= s.max_order;
    require(sound, "min_order", low.into(), s.min_order as f64)?;
    let high = format!("an even number up to (block_rows − 1) × channels = {largest}");
    let sound = even(s.max_order) && s.max_order <= largest;
    require(sound, "max_order", high, s.max_order as f64)?;
    for (field, value) in
        [("frequency_tolerance", s.frequency_tolerance), ("damping_tolerance", s.damping_tolerance)]
    {
        require(positive(value), field, "a positive number".into(), value)?;
    }
    for (field, value) in [
        ("min_mac", s.min_mac),
        ("min_order_fraction", s.min_order_fraction),
        ("damping_tolerance_relative", s.damping_tolerance_relative),
    ] {
        let sound = (0.0..=1.0).contains(&value);
        require(sound, field, "a number from 0 to 1".into(), value)?;
    }
    let sound = s.min_significance >= 0.0;
    require(sound, "min_significance", "a number from 0".into(), s.min_significance)?;
    if let Some([low, high]) = s.band_hz {
        let sound = low >= 0.0 && high > low && high <= rate_hz / 2.0;
        let expected = format!("0 ≤ low < high ≤ {} Hz", rate_hz / 2.0);
        require(sound, "band_hz", expected, if low >= 0.0 { high } else { low })?;
    }
    Ok(())
}
