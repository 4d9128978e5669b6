//! The stabilisation diagram: the poles of all orders, each compared with the poles of the order before.

use super::record::{Record, lag_weight};
use super::shape::{modal_assurance, unit_norm};
use super::{OperationalError, StabilitySettings};
use crate::linalg::{C64, CMat, Mat, eigen, solve_complex};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Without a band, a pole whose damped frequency is above this part of the Nyquist frequency is left out: there the
/// logarithm's branch can't be told.
const NYQUIST_PART: f64 = 0.98;
/// |μ| below this is a pole that dies within one sample; its logarithm says nothing.
const DEAD_BEAT: f64 = 1e-9;

/// Equivalent bandwidth of the Hann lag window of L samples, times L/rate.
const LAG_WINDOW: f64 = 4.0 / 3.0;

/// The poles of all orders.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StabilizationDiagram {
    /// The orders computed, ascending.
    pub orders: Vec<usize>,
    /// Every pole once (of a conjugate pair the one with Im > 0), by order, then by frequency.
    pub poles: Vec<Pole>,
}

/// One pole of one order.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Pole {
    /// Model order that it belongs to.
    pub order: usize,
    /// |λ|/2π in Hz.
    pub freq_hz: f64,
    /// −Re λ/|λ|.
    pub damping: f64,
    /// λ in rad/s as [re, im].
    pub pole: [f64; 2],
    /// The mode shape at the channels, as [re, im], of norm one.
    pub shape: Vec<[f64; 2]>,
    /// How far the pole's part of the spectrum at its frequency stands above the sampling error of the spectrum
    /// there, in standard deviations; 0 for one that is not compared with the order before.
    pub significance: f64,
    /// Stable, or why not.
    pub status: PoleStatus,
}

/// Whether a pole is found again at the order before, or why it takes no part.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PoleStatus {
    /// Frequency, damping and shape agree with a pole of the order before.
    Stable,
    /// Re λ ≥ 0: it grows.
    Growing,
    /// Re λ ≥ 0, and −λ* is a pole of the same order: full spectra have each pole twice.
    Mirror,
    /// A real pole: no oscillation.
    Real,
    /// Outside the band, or near the Nyquist frequency.
    OutOfBand,
    /// The lowest order has none before it.
    FirstOrder,
    /// No pole of the order before has nearly this frequency.
    NewFrequency,
    /// One has nearly this frequency, but none of these nearly this damping.
    NewDamping,
    /// One has nearly this frequency and damping, but another shape.
    NewShape,
}

impl PoleStatus {
    /// Why a pole is not stable, in words; `stable` for one that is.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            PoleStatus::Stable => "stable",
            PoleStatus::Growing => "it grows (Re λ ≥ 0)",
            PoleStatus::Mirror => "the mirror image of a decaying pole: full spectra have each twice",
            PoleStatus::Real => "a real pole: no oscillation",
            PoleStatus::OutOfBand => "outside the band, or near the Nyquist frequency",
            PoleStatus::FirstOrder => "the lowest order has none before it",
            PoleStatus::NewFrequency => "no pole of the order before has nearly this frequency",
            PoleStatus::NewDamping => {
                "one of the order before has nearly this frequency, none nearly this damping"
            }
            PoleStatus::NewShape => {
                "one of the order before has nearly this frequency and damping, but another shape"
            }
        }
    }
}

impl Pole {
    /// Whether it is found again at the order before.
    #[must_use]
    pub fn stable(&self) -> bool {
        self.status == PoleStatus::Stable
    }
}

impl StabilizationDiagram {
    /// The same poles with the shapes of normalised channels multiplied by the channels' rms.
    pub(in crate::identify) fn in_units(mut self, rms: &[f64]) -> Self {
        for pole in &mut self.poles {
            pole.shape.iter_mut().zip(rms).for_each(|(s, rms)| *s = [s[0] * rms, s[1] * rms]);
            unit_norm(&mut pole.shape);
        }
        self
    }
}

impl StabilizationDiagram {
    /// Calls the growing poles mirror images that stand opposite a decaying pole of their order, within this fraction of
    /// its |λ|.
    pub(in crate::identify) fn name_mirrors(&mut self, tolerance: f64) {
        let decaying: Vec<(usize, [f64; 2])> =
            self.poles.iter().filter(|p| p.pole[0] < 0.0).map(|p| (p.order, p.pole)).collect();
        for pole in self.poles.iter_mut().filter(|p| p.status == PoleStatus::Growing) {
            let opposite = |p: &[f64; 2]| {
                (p[0] + pole.pole[0]).hypot(p[1] - pole.pole[1]) <= tolerance * p[0].hypot(p[1])
            };
            if decaying.iter().any(|(order, p)| *order == pole.order && opposite(p)) {
                pole.status = PoleStatus::Mirror;
            }
        }
    }
}

/// One order's poles before they are judged.
pub(in crate::identify) struct OrderModel {
    /// Model order.
    pub order: usize,
    /// All of them.
    pub poles: Vec<ModelPole>,
}

/// A pole μ of the sampled model, and its part φ gᵀ μ^{k−1} of the correlations Λ_k of normalised channels.
#[derive(Clone)]
pub(in crate::identify) struct ModelPole {
    /// e^{λ/rate}.
    pub mu: C64,
    /// φ: channels.
    pub shape: Vec<C64>,
    /// g: references; none where the eigenvectors are dependent.
    pub input: Option<Vec<C64>>,
}

impl OrderModel {
    /// The poles of Λ_k = C A^{k−1} G (channels × n, n × n, n × references).
    pub fn of_realisation(a: &Mat, c: &Mat, g: &Mat) -> Result<Self, OperationalError> {
        let (values, vectors) = eigen(a)?;
        let complex = |m: &Mat| CMat::from_fn(m.nrows(), m.ncols(), |i, j| C64::new(m[(i, j)], 0.0));
        let inputs = solve_complex(&vectors, &complex(g)).ok();
        let shapes = complex(c) * &vectors;
        let poles = values.iter().enumerate().map(|(k, mu)| ModelPole {
            mu: *mu,
            shape: (0..c.nrows()).map(|i| shapes[(i, k)]).collect(),
            input: inputs.as_ref().map(|g| (0..g.ncols()).map(|j| g[(k, j)]).collect()),
        });
        Ok(Self { order: a.nrows(), poles: poles.collect() })
    }
}

impl ModelPole {
    /// λ = rate · ln μ; a dead-beat pole is put where its logarithm ends.
    pub fn lambda(&self, rate_hz: f64) -> C64 {
        if self.mu.norm() < DEAD_BEAT {
            C64::new(DEAD_BEAT.ln() * rate_hz, 0.0)
        } else {
            // −0 + 0 is +0: a real negative μ has its logarithm at +π
            C64::new(self.mu.re, self.mu.im + 0.0).ln() * rate_hz
        }
    }

    /// ‖part of the pole‖/‖S‖ at its own frequency, times √K with K the averages that the record has in the pole's
    /// equivalent bandwidth πζf, but no narrower than the lags resolve.
    fn significance(&self, record: &Record) -> f64 {
        let Some(input) = &self.input else { return 0.0 };
        if self.mu.norm() >= 1.0 {
            return 0.0; // its part has no spectrum
        }
        let lambda = self.lambda(record.rate_hz);
        let (freq_hz, damping) = (lambda.norm() / TAU, -lambda.re / lambda.norm());
        let at = C64::new(0.0, self.mu.arg()).exp();
        // Σ_k w_k r^k/at over the lags used: what they can show of a pole, which may ring far beyond them
        let lags = record.lags();
        let one = C64::new(1.0, 0.0);
        let sum = |r: C64| (one - r.powu(lags as u32)) / (one - r);
        let turn = C64::new(0.0, std::f64::consts::PI / lags as f64).exp();
        let r = self.mu / at;
        debug_assert!((lag_weight(1, lags) - (0.5 + 0.25 * (turn + turn.conj()).re)).abs() < 1e-9);
        let sides = turn * sum(r * turn) + turn.conj() * sum(r * turn.conj());
        let seen = (sum(r) * 0.5 + sides * 0.25) / at;
        let mine = |i: usize, j: usize| self.shape[i] * input[j] * seen;
        // S = Λ₀ + S⁺ + S⁺ᴴ: the half spectrum alone has an imaginary part that falls off too slowly
        let mut part = 0.0;
        for i in 0..self.shape.len() {
            for j in 0..input.len() {
                part += (mine(i, j) + mine(j, i).conj()).norm_sqr();
            }
        }
        let whole = record.spectrum_square(self.mu.arg());
        let resolved = LAG_WINDOW * record.rate_hz / lags as f64;
        let bandwidth = (std::f64::consts::PI * damping.abs() * freq_hz).max(resolved);
        let averages = bandwidth * record.samples as f64 / record.rate_hz;
        let sigmas = (part / whole.max(f64::MIN_POSITIVE) * averages).sqrt();
        if sigmas.is_finite() { sigmas } else { 0.0 } // eigenvectors that are nearly dependent
    }
}

/// The pole among `poles` (all of one order) nearest to λ, no further than this part of |λ|: λ in rad/s.
pub(in crate::identify) fn nearest_pole(
    poles: &[ModelPole],
    lambda: C64,
    rate_hz: f64,
    tolerance: f64,
) -> Option<C64> {
    let away = |l: &C64| (l - lambda).norm();
    let all = poles.iter().map(|p| p.lambda(rate_hz));
    all.min_by(|a, b| away(a).total_cmp(&away(b))).filter(|l| away(l) <= tolerance * lambda.norm())
}

/// The poles of all orders with their statuses.
pub(in crate::identify) fn diagram(
    models: &[OrderModel],
    record: &Record,
    settings: &StabilitySettings,
) -> StabilizationDiagram {
    let per_order: Vec<Vec<Pole>> = models.par_iter().map(|m| poles_of(m, record, settings)).collect();
    let orders = models.iter().map(|m| m.order).collect();
    let mut poles: Vec<Pole> = Vec::new();
    let mut before: &[Pole] = &[];
    for (k, here) in per_order.iter().enumerate() {
        poles.extend(here.iter().map(|pole| {
            let mut pole = pole.clone();
            if pole.status == PoleStatus::Stable {
                pole.status = if k == 0 { PoleStatus::FirstOrder } else { compared(&pole, before, settings) };
            }
            pole
        }));
        before = here;
    }
    StabilizationDiagram { orders, poles }
}

/// The poles of one order, of a pair the one with Im > 0; `Stable` stands for "still to be compared".
fn poles_of(model: &OrderModel, record: &Record, settings: &StabilitySettings) -> Vec<Pole> {
    let rate_hz = record.rate_hz;
    let mut poles = Vec::new();
    for model_pole in model.poles.iter().filter(|p| !(p.mu.im < 0.0)) {
        let (mu, lambda) = (model_pole.mu, model_pole.lambda(rate_hz));
        let size = lambda.norm();
        let freq_hz = size / TAU;
        let in_band = match settings.band_hz {
            Some([low, high]) => (low..=high).contains(&freq_hz),
            None => lambda.im < NYQUIST_PART * std::f64::consts::PI * rate_hz,
        };
        let status = if mu.norm() >= 1.0 {
            PoleStatus::Growing
        } else if mu.im == 0.0 {
            PoleStatus::Real
        } else if !in_band {
            PoleStatus::OutOfBand
        } else {
            PoleStatus::Stable
        };
        let mut shape: Vec<[f64; 2]> = model_pole.shape.iter().map(|s| [s.re, s.im]).collect();
        unit_norm(&mut shape);
        let damping = if size > 0.0 { -lambda.re / size } else { 0.0 };
        // what takes no part in the comparison needs no significance
        let judged = status == PoleStatus::Stable;
        let significance = if judged { model_pole.significance(record) } else { 0.0 };
        let pole = [lambda.re, lambda.im];
        poles.push(Pole { order: model.order, freq_hz, damping, pole, shape, significance, status });
    }
    poles.sort_by(|a, b| a.freq_hz.total_cmp(&b.freq_hz));
    poles
}

/// How a pole stands to the poles of the order before.
fn compared(pole: &Pole, before: &[Pole], settings: &StabilitySettings) -> PoleStatus {
    let mut status = PoleStatus::NewFrequency;
    for other in before.iter().filter(|p| p.status == PoleStatus::Stable) {
        if !near_frequency(pole, other, settings) {
            continue;
        }
        if !near_damping(pole, other, settings) {
            if status == PoleStatus::NewFrequency {
                status = PoleStatus::NewDamping;
            }
        } else if modal_assurance(&pole.shape, &other.shape) < settings.min_mac {
            status = PoleStatus::NewShape;
        } else {
            return PoleStatus::Stable;
        }
    }
    status
}

/// Whether two poles' frequencies agree within the tolerance.
pub(super) fn near_frequency(a: &Pole, b: &Pole, settings: &StabilitySettings) -> bool {
    (a.freq_hz - b.freq_hz).abs() <= settings.frequency_tolerance * a.freq_hz.max(b.freq_hz)
}

/// Whether two poles' damping ratios agree within the tolerances.
pub(super) fn near_damping(a: &Pole, b: &Pole, settings: &StabilitySettings) -> bool {
    let relative = settings.damping_tolerance_relative * a.damping.max(b.damping);
    (a.damping - b.damping).abs() <= settings.damping_tolerance.max(relative)
}
