//! A plant's matrices in units in which they are of order one, and a design's way back to the plant's own.

use super::goals::{H2Goal, HinfGoal, PoleRegion};
use crate::linalg::{Mat, eigen};
use crate::lti::GeneralizedPlant;

/// x = T x̃, u = F ũ, y = G ỹ, t = t̃/ω: diagonal.
#[derive(Debug, Clone)]
pub(super) struct Units {
    pub states: Vec<f64>,
    pub controls: Vec<f64>,
    pub measurements: Vec<f64>,
    /// ω, rad/s.
    pub rate: f64,
}

/// One channel of a plant in its units: rows and columns chosen and weighted.
#[derive(Debug, Clone)]
pub(super) struct Channel {
    pub b1: Mat,
    pub c1: Mat,
    pub d11: Mat,
    pub d12: Mat,
    pub d21: Mat,
}

/// A plant in its units.
#[derive(Debug, Clone)]
pub(super) struct Parts {
    pub a: Mat,
    pub b2: Mat,
    pub c2: Mat,
    pub h2: Vec<Channel>,
    pub hinf: Vec<Channel>,
    /// Outputs and disturbances of all H2 channels, stacked.
    pub all_h2: Option<Channel>,
}

/// Powers of two: units change no digit.
fn rounded(v: f64) -> f64 {
    if v > 0.0 && v.is_finite() { v.log2().round().exp2() } else { 1.0 }
}

impl Units {
    /// Time by the geometric mean of the frequencies, states by balancing inputs against outputs, forces and measurements
    /// to entries of order one.
    pub fn of(plant: &GeneralizedPlant) -> Self {
        let (a, b2, c2) = (plant.a(), plant.b2(), plant.c2());
        let n = a.nrows();
        let poles = eigen(a).map(|(poles, _)| poles).unwrap_or_default();
        let sizes: Vec<f64> = poles.iter().map(|p| p.norm()).filter(|s| *s > 1e-6).collect();
        let rate = if sizes.is_empty() {
            1.0
        } else {
            rounded((sizes.iter().map(|s| s.ln()).sum::<f64>() / sizes.len() as f64).exp())
        };
        // Osborne's balancing of A by rows and columns
        let mut states = vec![1.0; n];
        for _ in 0..20 {
            for i in 0..n {
                let entry = |r: usize, c: usize| (a[(r, c)] * states[c] / states[r] / rate).abs();
                let row: f64 = (0..n).filter(|j| *j != i).map(|j| entry(i, j)).sum();
                let col: f64 = (0..n).filter(|j| *j != i).map(|j| entry(j, i)).sum();
                if row > 0.0 && col > 0.0 {
                    states[i] *= rounded((row / col).sqrt());
                }
            }
        }
        let column =
            |m: &Mat, j: usize| (0..n).map(|i| (m[(i, j)] / states[i] / rate).powi(2)).sum::<f64>().sqrt();
        let row = |m: &Mat, i: usize| (0..n).map(|j| (m[(i, j)] * states[j]).powi(2)).sum::<f64>().sqrt();
        let controls = (0..b2.ncols()).map(|j| rounded(1.0 / column(&b2, j))).collect();
        let measurements = (0..c2.nrows()).map(|i| rounded(row(&c2, i))).collect();
        Units { states, controls, measurements, rate }
    }

    /// The plant's channels in these units.
    pub fn parts(&self, plant: &GeneralizedPlant, h2: &[H2Goal], hinf: &[HinfGoal]) -> Parts {
        let (t, f, g, w) = (&self.states, &self.controls, &self.measurements, self.rate);
        let (a, b1, b2, c1, c2) = (plant.a(), plant.b1(), plant.b2(), plant.c1(), plant.c2());
        let (d11, d12, d21) = (plant.d11(), plant.d12(), plant.d21());
        let n = a.nrows();
        let channel = |outputs: &[(usize, f64)], disturbances: &[usize]| {
            let all: Vec<usize> = (0..b1.ncols()).collect();
            let columns = if disturbances.is_empty() { &all } else { disturbances };
            let (p, q) = (outputs.len(), columns.len());
            // unit white noise per time keeps its norm: w = √ω w̃
            let root = w.sqrt();
            Channel {
                b1: Mat::from_fn(n, q, |i, j| b1[(i, columns[j])] / t[i] / root),
                c1: Mat::from_fn(p, n, |i, j| outputs[i].1 * c1[(outputs[i].0, j)] * t[j]),
                d11: Mat::from_fn(p, q, |i, j| outputs[i].1 * d11[(outputs[i].0, columns[j])] * root),
                d12: Mat::from_fn(p, f.len(), |i, j| outputs[i].1 * d12[(outputs[i].0, j)] * f[j]),
                d21: Mat::from_fn(g.len(), q, |i, j| d21[(i, columns[j])] / g[i] * root),
            }
        };
        Parts {
            a: Mat::from_fn(n, n, |i, j| a[(i, j)] * t[j] / t[i] / w),
            b2: Mat::from_fn(n, f.len(), |i, j| b2[(i, j)] * f[j] / t[i] / w),
            c2: Mat::from_fn(g.len(), n, |i, j| c2[(i, j)] * t[j] / g[i]),
            h2: h2.iter().map(|goal| channel(&goal.outputs, &goal.disturbances)).collect(),
            hinf: hinf.iter().map(|goal| channel(&goal.outputs, &goal.disturbances)).collect(),
            all_h2: (!h2.is_empty()).then(|| {
                let outputs: Vec<_> = h2.iter().flat_map(|g| g.outputs.iter().copied()).collect();
                let mut union: Vec<usize> = h2.iter().flat_map(|g| g.disturbances.iter().copied()).collect();
                union.sort_unstable();
                union.dedup();
                // an empty list is all of them
                let whole = h2.iter().any(|g| g.disturbances.is_empty());
                channel(&outputs, if whole { &[] } else { &union })
            }),
        }
    }

    /// An H∞ norm in these units, of one in the plant's: inputs are per √ω.
    pub fn hinf(&self, norm: f64) -> f64 {
        norm * self.rate.sqrt()
    }

    /// Back.
    pub fn plain_hinf(&self, norm: f64) -> f64 {
        norm / self.rate.sqrt()
    }

    pub fn region(&self, region: &PoleRegion) -> PoleRegion {
        let over = |v: Option<f64>| v.map(|v| v / self.rate);
        PoleRegion {
            faster_than: over(region.faster_than),
            slower_than: over(region.slower_than),
            below_frequency: over(region.below_frequency),
            within: over(region.within),
            cone: region.cone,
        }
    }

    /// K of u = Kx.
    pub fn gain(&self, k: &Mat) -> Mat {
        Mat::from_fn(k.nrows(), k.ncols(), |i, j| self.controls[i] * k[(i, j)] / self.states[j])
    }
}
