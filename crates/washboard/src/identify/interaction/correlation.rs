//! The model in the lag domain: eqs. (43) and (44).

use super::spectrum::{Delay, InteractionModel};
use crate::linalg::{C64, Mat};
use std::f64::consts::{PI, TAU};

/// Nodes and weights of 10-point Gauss–Legendre quadrature on [−1, 1] (positive half).
const GAUSS: [(f64, f64); 5] = [
    (0.148_874_338_981_631_22, 0.295_524_224_714_752_87),
    (0.433_395_394_129_247_2, 0.269_266_719_309_996_35),
    (0.679_409_568_299_024_4, 0.219_086_362_515_982_04),
    (0.865_063_366_688_984_5, 0.149_451_349_150_580_6),
    (0.973_906_528_517_171_7, 0.066_671_344_308_688_14),
];
/// e^{Re λ T} at which the memory of a mode is cut: below the accuracy asked of correlations.
const MEMORY: f64 = 1e-13;

/// R_q(τ) = Σₙ φ̄ₙ(τ)ψₙᵀ + ψₙφ̄ₙᵀ(−τ), with φ̄ₙ(τ) = R_d * Σ H_p * (α h(τ)e^{λₙτ} + β h(τ + τ_l)e^{λₙ(τ + τ_l)} + …).
///
/// The convolutions are done in time, on panels that resolve the band's highest frequency; the correlation of parallel
/// tracks R_d * H_p is an integral over the road's band, which must be finite.
#[derive(Debug, Clone)]
pub struct CorrelationModel {
    model: InteractionModel,
    /// Distances of tracks, one a p.
    distances: Vec<f64>,
    /// Panel width, s.
    step: f64,
    /// Panels before lag 0.
    before: usize,
    /// c_pn at the panel ends: [p][panel][n].
    ends: Vec<Vec<Vec<C64>>>,
    /// Nodes over ω.
    omega: Vec<f64>,
    /// Quadrature weight × S_d(ω)/π at the nodes.
    density: Vec<f64>,
    /// The same × Γ_p(ω), one row a p.
    coherent: Vec<Vec<f64>>,
}

impl CorrelationModel {
    /// The model for lags up to `max_lag_s`; None where the road has no finite band.
    #[must_use]
    pub fn new(model: &InteractionModel, max_lag_s: f64) -> Option<Self> {
        let [low, high] = model.road.spectrum().band_rad_s(model.speed_m_s);
        if !(high.is_finite() && low > 0.0) {
            return None;
        }
        let slowest = model.poles.iter().map(|p| -p.re).fold(f64::INFINITY, f64::min);
        let fastest = model.poles.iter().map(|p| p.norm()).fold(high, f64::max);
        let longest_delay = model.terms.iter().map(|t| delay(t.delay).abs()).fold(0.0, f64::max);
        let reach = max_lag_s.abs() + longest_delay;
        let memory = -MEMORY.ln() / slowest;
        let step = 0.5 * TAU / fastest;
        let before = ((memory + reach) / step).ceil() as usize;
        let after = (reach / step).ceil() as usize + 1;
        // the highest frequency over the farthest lag makes this many periods; the band's bottom is steep
        let far = before.max(after) as f64 * step;
        let panels = ((high - low) * far / TAU).ceil().max(32.0) as usize;
        let mut nodes: Vec<(f64, f64)> = Vec::with_capacity(10 * panels);
        let mut edges: Vec<f64> =
            (0..=panels).map(|i| low + (high - low) * i as f64 / panels as f64).collect();
        edges.extend((1..40).map(|i| low * (high / low).powf(f64::from(i) / 40.0)));
        edges.sort_by(f64::total_cmp);
        for pair in edges.windows(2) {
            nodes.extend(gauss(pair[0], pair[1]));
        }
        let mut distances: Vec<f64> = model.terms.iter().map(|t| t.distance_m).collect();
        distances.sort_by(f64::total_cmp);
        distances.dedup();
        let (road, v) = (&model.road, model.speed_m_s);
        let omega: Vec<f64> = nodes.iter().map(|n| n.0).collect();
        let density: Vec<f64> =
            nodes.iter().map(|(w, weight)| weight * road.spectrum().psd(*w, v) / PI).collect();
        let coherent = distances.iter().map(|d| weigh(model, *d, &omega, &density)).collect();
        let (model, ends) = (model.clone(), vec![]);
        let mut this = CorrelationModel { model, distances, step, before, ends, omega, density, coherent };
        this.ends = (0..this.distances.len()).map(|p| this.accumulate(p, before + after)).collect();
        Some(this)
    }

    /// R_d * H_p at a lag: the correlation of the heights of two tracks W_p apart, m².
    #[must_use]
    pub fn track_correlation(&self, distance_m: f64, lag_s: f64) -> f64 {
        cosine_sum(&self.omega, &weigh(&self.model, distance_m, &self.omega, &self.density), lag_s)
    }

    /// R_q(τ) (outputs × outputs), |τ| ≤ the `max_lag_s` given.
    #[must_use]
    pub fn correlation(&self, lag_s: f64) -> Mat {
        let (plus, minus) = (self.first(lag_s), self.first(-lag_s));
        &plus + minus.transpose()
    }

    /// Σₙ φ̄ₙ(τ)ψₙᵀ.
    fn first(&self, lag_s: f64) -> Mat {
        let (out, modes) = (self.model.psi.nrows(), self.model.psi.ncols());
        let mut r = Mat::zeros(out, out);
        for term in &self.model.terms {
            let Some(p) = self.distances.iter().position(|d| *d == term.distance_m) else { continue };
            let c = self.convolved(p, lag_s - delay(term.delay));
            for i in 0..out {
                for j in 0..out {
                    let sum: C64 =
                        (0..modes).map(|n| term.factors[(i, n)] * self.model.psi[(j, n)] * c[n]).sum();
                    r[(i, j)] += sum.re;
                }
            }
        }
        r
    }

    /// c_pn(x) = ∫_{−∞}^x (R_d * H_p)(s) e^{λₙ(x − s)} ds for all n.
    fn convolved(&self, p: usize, x: f64) -> Vec<C64> {
        let position = x / self.step + self.before as f64;
        let last = self.ends[p].len() - 1;
        let panel = (position.floor().max(0.0) as usize).min(last);
        let from = (panel as f64 - self.before as f64) * self.step;
        self.advance(p, &self.ends[p][panel], from, x)
    }

    /// c at `to` from c at `from`.
    fn advance(&self, p: usize, start: &[C64], from: f64, to: f64) -> Vec<C64> {
        let nodes: Vec<(f64, f64, f64)> = gauss(from, to)
            .map(|(s, weight)| (s, weight, cosine_sum(&self.omega, &self.coherent[p], s)))
            .collect();
        let poles = &self.model.poles;
        (0..poles.len())
            .map(|n| {
                let grown: C64 =
                    nodes.iter().map(|(s, weight, rho)| (poles[n] * (to - s)).exp() * (weight * rho)).sum();
                start[n] * (poles[n] * (to - from)).exp() + grown
            })
            .collect()
    }

    fn accumulate(&self, p: usize, panels: usize) -> Vec<Vec<C64>> {
        let mut ends = vec![vec![C64::new(0.0, 0.0); self.model.poles.len()]];
        for k in 0..panels {
            let from = (k as f64 - self.before as f64) * self.step;
            let next = self.advance(p, &ends[k], from, from + self.step);
            ends.push(next);
        }
        ends
    }
}

/// Weights × Γ of tracks `distance_m` apart.
fn weigh(model: &InteractionModel, distance_m: f64, omega: &[f64], density: &[f64]) -> Vec<f64> {
    let gamma = |w: &f64| model.road.coherence().gamma(distance_m, *w, model.speed_m_s);
    omega.iter().zip(density).map(|(w, d)| d * gamma(w)).collect()
}

fn cosine_sum(omega: &[f64], weights: &[f64], lag_s: f64) -> f64 {
    omega.iter().zip(weights).map(|(w, d)| d * (w * lag_s).cos()).sum()
}

/// The lag x with e^{−iωx}.
fn delay(d: Delay) -> f64 {
    match d {
        Delay::None => 0.0,
        Delay::Ahead(tau) => -tau,
        Delay::Behind(tau) => tau,
    }
}

/// Nodes and weights on [from, to].
fn gauss(from: f64, to: f64) -> impl Iterator<Item = (f64, f64)> {
    let (mid, half) = (0.5 * (from + to), 0.5 * (to - from));
    GAUSS.into_iter().flat_map(move |(x, w)| [(mid - half * x, half * w), (mid + half * x, half * w)])
}
