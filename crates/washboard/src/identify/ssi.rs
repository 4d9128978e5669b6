//! Covariance-driven stochastic subspace identification (SSI-cov): modes from output correlations alone.

mod subspace;

use super::operational::{
    Mode, OperationalError, OrderModel, Record, Rejected, Resampling, StabilitySettings,
    StabilizationDiagram, Start, deviations, diagram, modes, nearest_pole, require,
};
use crate::linalg::C64;
use crate::signal::{CorrelationError, Correlations};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use subspace::Subspace;

/// Orders of a mode that are fitted again without each block: more tell nothing new of their median.
const REFITTED: usize = 8;

/// A pole that moved by so many frequency tolerances is another one.
const LOST: f64 = 5.0;

/// What SSI-cov is told beside the data. [`SsiSettings::default`] suits a dozen modes or fewer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SsiSettings {
    /// Block rows i of the Toeplitz matrix: lags 1 … 2i − 1 are used. Choose i ≥ rate/(2 f) for the lowest mode f.
    pub block_rows: usize,
    /// Lowest model order, even.
    pub min_order: usize,
    /// Highest model order, even, at most (i − 1) × channels.
    pub max_order: usize,
    /// When a pole is stable, and a cluster a mode.
    pub stability: StabilitySettings,
}

impl Default for SsiSettings {
    fn default() -> Self {
        Self { block_rows: 50, min_order: 2, max_order: 60, stability: StabilitySettings::default() }
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
/// Standard deviations are the bootstrap's over blocks of the recording, of each mode's median over eight orders.
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
/// # Ok::<(), washboard::identify::OperationalError>(())
/// ```
pub fn ssi_cov(
    channels: &[Vec<f64>],
    rate_hz: f64,
    settings: &SsiSettings,
) -> Result<SsiOutcome, OperationalError> {
    check(channels.len(), rate_hz, settings)?;
    let record = Record::new(channels, rate_hz, 2 * settings.block_rows - 1)?;
    let subspace = Subspace::new(&record.lambda, settings.block_rows)?;
    let orders: Vec<usize> =
        (settings.min_order..=settings.max_order.min(subspace.rank())).step_by(2).collect();
    let realisations = subspace.realisations(&orders);
    let models: Vec<OrderModel> = realisations
        .par_iter()
        .map(|r| OrderModel::of_realisation(&r.a, &r.c, &r.g))
        .collect::<Result<_, _>>()?;
    let diagram = diagram(&models, &record, &settings.stability);
    let (mut clusters, rejected) = modes(&diagram, &record.rms, &settings.stability);
    let again = |lambda: &Correlations, starts: &[Start]| {
        refit(&subspace, lambda, starts, &settings.stability, rate_hz)
    };
    deviations(&mut clusters, &diagram, &record, REFITTED, Resampling::Bootstrap, again)?;
    let modes = clusters.into_iter().map(|c| c.mode).collect();
    let diagram = diagram.in_units(&record.rms);
    Ok(SsiOutcome { modes, rejected, diagram, singular_values: subspace.singular_values })
}

/// The poles in other correlations of the same record, each at its order.
fn refit(
    subspace: &Subspace,
    lambda: &Correlations,
    starts: &[Start],
    stability: &StabilitySettings,
    rate_hz: f64,
) -> Vec<Option<C64>> {
    let mut orders: Vec<usize> = starts.iter().map(|s| s.0).collect();
    orders.sort_unstable();
    orders.dedup();
    let Ok(near) = subspace.near(lambda, &orders) else { return vec![None; starts.len()] };
    let models: Vec<OrderModel> =
        near.iter().filter_map(|r| OrderModel::of_realisation(&r.a, &r.c, &r.g).ok()).collect();
    let find = |(order, pole): &Start| {
        let model = models.iter().find(|m| m.order == *order)?;
        nearest_pole(&model.poles, *pole, rate_hz, LOST * stability.frequency_tolerance)
    };
    starts.iter().map(find).collect()
}

fn check(channels: usize, rate_hz: f64, s: &SsiSettings) -> Result<(), OperationalError> {
    if channels == 0 {
        return Err(CorrelationError::NoChannel.into());
    }
    let even = |x: usize| x >= 2 && x.is_multiple_of(2);
    let largest = s.block_rows.saturating_sub(1) * channels;
    require(s.block_rows >= 2, "block_rows", "at least 2", s.block_rows as f64)?;
    let low = "an even number from 2 to max_order";
    let sound = even(s.min_order) && s.min_order <= s.max_order;
    require(sound, "min_order", low, s.min_order as f64)?;
    let high = format!("an even number up to (block_rows − 1) × channels = {largest}");
    let sound = even(s.max_order) && s.max_order <= largest;
    require(sound, "max_order", high, s.max_order as f64)?;
    s.stability.check(rate_hz)
}
