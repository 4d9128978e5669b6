//! The stabilisation diagram: the poles of all orders, each compared with the poles of the order before.

use super::subspace::Realisation;
use super::{SsiError, SsiSettings};
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
    /// there, in standard deviations; 0 for one that does not decay.
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
    pub(super) fn in_units(mut self, rms: &[f64]) -> Self {
        for pole in &mut self.poles {
            pole.shape.iter_mut().zip(rms).for_each(|(s, rms)| *s = [s[0] * rms, s[1] * rms]);
            unit_norm(&mut pole.shape);
        }
        self
    }
}

/// What the record says about every pole's sampling error.
pub(super) struct Record {
    /// Sample rate.
    pub rate_hz: f64,
    /// Samples a channel.
    pub samples: usize,
    /// Lags used.
    pub lags: usize,
    /// Λ₀ of the normalised channels.
    pub at_zero_lag: Mat,
}

/// The parts that the poles of one order have in the spectrum: S⁺(ω) = Σ_k φ_k g_kᵀ/(e^{iω} − μ_k).
struct Parts {
    /// μ.
    values: Vec<C64>,
    /// C Ψ: channels × n.
    shapes: CMat,
    /// Ψ⁻¹ G: n × channels; none where the eigenvectors are dependent.
    inputs: Option<CMat>,
}

impl Parts {
    fn new(r: &Realisation, values: &[C64], vectors: &CMat) -> Self {
        let complex = |m: &Mat| CMat::from_fn(m.nrows(), m.ncols(), |i, j| C64::new(m[(i, j)], 0.0));
        let inputs = solve_complex(vectors, &complex(&r.g)).ok();
        Self { values: values.to_vec(), shapes: complex(&r.c) * vectors, inputs }
    }

    /// ‖part of pole k‖/‖S‖ at its own frequency, times √K with K the averages that the record has in the pole's
    /// equivalent bandwidth πζf, but no narrower than the lags resolve.
    fn significance(&self, k: usize, damping: f64, freq_hz: f64, record: &Record) -> f64 {
        let Some(inputs) = &self.inputs else { return 0.0 };
        if self.values[k].norm() >= 1.0 {
            return 0.0; // its part has no spectrum
        }
        let (n, channels) = (self.values.len(), self.shapes.nrows());
        let at = C64::new(0.0, self.values[k].arg()).exp();
        // Σ_k w_k r^k/μ over the lags used, w_k = (1 + cos(πk/L))/2: what they can show of a pole, which may ring far
        // beyond them, without the leakage of strong modes elsewhere
        let one = C64::new(1.0, 0.0);
        let sum = |r: C64| (one - r.powu(record.lags as u32)) / (one - r);
        let turn = C64::new(0.0, std::f64::consts::PI / record.lags as f64).exp();
        let seen = |m: usize| {
            let r = self.values[m] / at;
            let sides = turn * sum(r * turn) + turn.conj() * sum(r * turn.conj());
            (sum(r) * 0.5 + sides * 0.25) / at
        };
        let seen: Vec<C64> = (0..n).map(seen).collect();
        let mine = |i: usize, j: usize| self.shapes[(i, k)] * inputs[(k, j)] * seen[k];
        let half = |i: usize, j: usize| -> C64 {
            (0..n).map(|m| self.shapes[(i, m)] * inputs[(m, j)] * seen[m]).sum()
        };
        // S = Λ₀ + S⁺ + S⁺ᴴ: the half spectrum alone has an imaginary part that falls off too slowly
        let (mut part, mut whole) = (0.0, 0.0);
        for i in 0..channels {
            for j in 0..channels {
                part += (mine(i, j) + mine(j, i).conj()).norm_sqr();
                whole += (half(i, j) + half(j, i).conj() + record.at_zero_lag[(i, j)]).norm_sqr();
            }
        }
        let resolved = LAG_WINDOW * record.rate_hz / record.lags as f64;
        let bandwidth = (std::f64::consts::PI * damping.abs() * freq_hz).max(resolved);
        let averages = bandwidth * record.samples as f64 / record.rate_hz;
        let sigmas = (part / whole.max(f64::MIN_POSITIVE) * averages).sqrt();
        if sigmas.is_finite() { sigmas } else { 0.0 } // eigenvectors that are nearly dependent
    }
}

/// The poles of all orders with their statuses.
pub(super) fn diagram(
    realisations: &[Realisation],
    record: &Record,
    settings: &SsiSettings,
) -> Result<StabilizationDiagram, SsiError> {
    let per_order: Vec<Vec<Pole>> =
        realisations.par_iter().map(|r| poles_of(r, record, settings)).collect::<Result<_, SsiError>>()?;
    let orders = realisations.iter().map(|r| r.a.nrows()).collect();
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
    Ok(StabilizationDiagram { orders, poles })
}

/// The poles of one order, of a pair the one with Im > 0; `Stable` stands for "still to be compared".
fn poles_of(r: &Realisation, record: &Record, settings: &SsiSettings) -> Result<Vec<Pole>, SsiError> {
    let rate_hz = record.rate_hz;
    let (values, vectors) = eigen(&r.a)?;
    let parts = Parts::new(r, &values, &vectors);
    let (order, mut poles) = (r.a.nrows(), Vec::new());
    for (k, mu) in values.iter().enumerate() {
        if mu.im < 0.0 {
            continue;
        }
        // a dead-beat pole is put where its logarithm ends; its status says real
        let lambda =
            if mu.norm() < DEAD_BEAT { C64::new(DEAD_BEAT.ln() * rate_hz, 0.0) } else { mu.ln() * rate_hz };
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
        let mut shape: Vec<[f64; 2]> =
            (0..r.c.nrows()).map(|i| [parts.shapes[(i, k)].re, parts.shapes[(i, k)].im]).collect();
        unit_norm(&mut shape);
        let damping = if size > 0.0 { -lambda.re / size } else { 0.0 };
        let pole = [lambda.re, lambda.im];
        let significance = parts.significance(k, damping, freq_hz, record);
        poles.push(Pole { order, freq_hz, damping, pole, shape, significance, status });
    }
    poles.sort_by(|a, b| a.freq_hz.total_cmp(&b.freq_hz));
    Ok(poles)
}

/// How a pole stands to the poles of the order before.
fn compared(pole: &Pole, before: &[Pole], settings: &SsiSettings) -> PoleStatus {
    let mut status = PoleStatus::NewFrequency;
    for other in before.iter().filter(|p| p.status == PoleStatus::Stable) {
        if !near_frequency(pole, other, settings) {
            continue;
        }
        if !near_damping(pole, other, settings) {
            if status == PoleStatus::NewFrequency {
                status = PoleStatus::NewDamping;
            }
        } else if mac(&pole.shape, &other.shape) < settings.min_mac {
            status = PoleStatus::NewShape;
        } else {
            return PoleStatus::Stable;
        }
    }
    status
}

/// Whether two poles' frequencies agree within the tolerance.
pub(super) fn near_frequency(a: &Pole, b: &Pole, settings: &SsiSettings) -> bool {
    (a.freq_hz - b.freq_hz).abs() <= settings.frequency_tolerance * a.freq_hz.max(b.freq_hz)
}

/// Whether two poles' damping ratios agree within the tolerances.
pub(super) fn near_damping(a: &Pole, b: &Pole, settings: &SsiSettings) -> bool {
    let relative = settings.damping_tolerance_relative * a.damping.max(b.damping);
    (a.damping - b.damping).abs() <= settings.damping_tolerance.max(relative)
}

/// Modal assurance criterion |aᴴb|²/(aᴴa · bᴴb).
pub(super) fn mac(a: &[[f64; 2]], b: &[[f64; 2]]) -> f64 {
    let (mut re, mut im, mut aa, mut bb) = (0.0, 0.0, 0.0, 0.0);
    for (x, y) in a.iter().zip(b) {
        re += x[0] * y[0] + x[1] * y[1];
        im += x[0] * y[1] - x[1] * y[0];
        aa += x[0] * x[0] + x[1] * x[1];
        bb += y[0] * y[0] + y[1] * y[1];
    }
    (re * re + im * im) / (aa * bb).max(f64::MIN_POSITIVE)
}

fn unit_norm(shape: &mut [[f64; 2]]) {
    let norm = shape.iter().map(|s| s[0] * s[0] + s[1] * s[1]).sum::<f64>().sqrt();
    if norm > 0.0 {
        shape.iter_mut().for_each(|s| *s = [s[0] / norm, s[1] / norm]);
    }
}
