//! Spectra of a free state space on a road, and how a pull on the spectra acts on its entries.

use super::orbit::Entries;
use crate::identify::likelihood::{BandData, Drive, RoadAt, RoadValues};
use crate::linalg::{C64, CMat, Mat, solve_complex};
use crate::lti::FirstOrder;
use rayon::prelude::*;

/// Time is counted in 1/20 s, so that a car's poles are of size 1.
pub(super) const RATE: f64 = 20.0;

/// What a search moves: the state space (displacements of the sensors per road height, in scaled time), the road, ln noise.
#[derive(Debug, Clone)]
pub(super) struct Point {
    pub system: FirstOrder,
    pub road: RoadValues,
    pub ln_noise: Vec<f64>,
}

/// A recording under free modes.
pub(super) struct FreeModel {
    pub data: BandData,
    pub drive: Drive,
    /// Places of the wheels, m.
    pub at_m: Vec<[f64; 2]>,
    /// Time derivatives of displacement that each channel measures.
    pub derivatives: Vec<usize>,
    /// What each sensor shows of a road's plane: of 1, y and x.
    pub planes: Vec<[f64; 3]>,
}

/// The model at one half bin.
pub(super) struct GridPoint {
    /// (sI − A)⁻¹B (states × wheels).
    pub x: CMat,
    /// Weighted C(sI − A)⁻¹ (channels × states).
    pub y: CMat,
    /// S_r Hᵀ (wheels × channels).
    pub p: CMat,
    /// The channels' weights (iω)^d/scale.
    pub weight: Vec<C64>,
    pub road: RoadAt,
    /// H (channels × wheels).
    pub h: CMat,
}

/// The model everywhere.
pub(super) struct Evaluation {
    /// None at ω = 0.
    pub grid: Vec<Option<GridPoint>>,
    /// Spectra at the bins, window and noise included.
    pub s: Vec<CMat>,
}

impl FreeModel {
    /// Spectra, and the parts that their derivatives are made of.
    pub fn evaluate(&self, at: &Point) -> Option<Evaluation> {
        let [from, last] = self.data.grid();
        let grid: Vec<Option<GridPoint>> = (from..=last)
            .into_par_iter()
            .map(|index| match index {
                0 => Some(None),
                _ => self.at(at, self.data.half_omega(index)).map(Some),
            })
            .collect::<Option<_>>()?;
        Some(Evaluation { s: self.spectra(&grid, at), grid })
    }

    fn spectra(&self, grid: &[Option<GridPoint>], at: &Point) -> Vec<CMat> {
        let n = self.derivatives.len();
        let flat: Vec<Vec<C64>> = grid
            .par_iter()
            .map(|g| match g {
                None => vec![C64::new(0.0, 0.0); n * n],
                Some(g) => {
                    let s = g.h.conjugate() * &g.p;
                    (0..n * n).map(|k| s[(k / n, k % n)]).collect()
                }
            })
            .collect();
        self.data
            .convolve(&flat)
            .into_iter()
            .map(|block| {
                CMat::from_fn(n, n, |i, j| {
                    let noise = if i == j { at.ln_noise[i].exp() } else { 0.0 };
                    block[i * n + j] + C64::new(noise, 0.0)
                })
            })
            .collect()
    }

    fn at(&self, at: &Point, omega: f64) -> Option<GridPoint> {
        let (system, n) = (&at.system, at.system.order());
        let s = C64::new(0.0, omega / RATE);
        let resolvent = CMat::from_fn(n, n, |i, j| {
            let diagonal = if i == j { s } else { C64::new(0.0, 0.0) };
            diagonal - C64::new(system.a[(i, j)], 0.0)
        });
        let complex = |m: &Mat| CMat::from_fn(m.nrows(), m.ncols(), |i, j| C64::new(m[(i, j)], 0.0));
        let x = solve_complex(&resolvent, &complex(&system.b)).ok()?;
        let turned = CMat::from_fn(n, n, |i, j| resolvent[(j, i)]);
        let c = &system.c;
        let y = solve_complex(&turned, &CMat::from_fn(n, c.nrows(), |i, j| C64::new(c[(j, i)], 0.0))).ok()?;
        let weight: Vec<C64> = (0..c.nrows())
            .map(|i| C64::new(0.0, omega).powu(self.derivatives[i] as u32) / self.data.scale[i])
            .collect();
        let y = CMat::from_fn(c.nrows(), n, |i, j| weight[i] * y[(j, i)]);
        let h = complex(c) * &x;
        let h = CMat::from_fn(h.nrows(), h.ncols(), |i, j| weight[i] * h[(i, j)]);
        let road = RoadAt::new(self.drive, &at.road, &self.at_m, omega);
        let p = &road.s * h.transpose();
        Some(GridPoint { x, y, p, weight, road, h })
    }

    /// The gradient of Σ_k tr(G_k S_k) by the entries of [A B; C 0], then by ln S₀, e, ln μ, ln delay.
    ///
    /// With G on the grid and Q = (P G)*: 2 Re tr(dH Q), dH = W dC X + Y(dA X + dB).
    pub fn pull(&self, evaluation: &Evaluation, bins: &[CMat]) -> Vec<f64> {
        let spread = self.data.spread(bins);
        let (n, wheels) = (self.derivatives.len(), self.at_m.len());
        let states = evaluation.grid.iter().flatten().next().map_or(0, |g| g.x.nrows());
        let e = Entries { states, inputs: wheels, outputs: n };
        let parts: Vec<Vec<f64>> = evaluation
            .grid
            .par_iter()
            .zip(&spread)
            .filter_map(|(g, pull)| g.as_ref().map(|g| (g, pull)))
            .map(|(g, pull)| {
                let pg = &g.p * pull;
                let q = pg.conjugate();
                let qy = q * &g.y; // wheels × states
                let xq = &g.x * q; // states × channels
                let xqy = &g.x * &qy; // states × states
                let mut out = vec![0.0; e.len() + 4];
                for i in 0..states {
                    for j in 0..states {
                        out[e.at(i, j)] = 2.0 * xqy[(j, i)].re;
                    }
                    for w in 0..wheels {
                        out[e.at(i, states + w)] = 2.0 * qy[(w, i)].re;
                    }
                }
                for c in 0..n {
                    for j in 0..states {
                        out[e.at(states + c, j)] = 2.0 * (xq[(j, c)] * g.weight[c]).re;
                    }
                }
                // tr(G dS) of S = H* S_r Hᵀ: tr(Hᵀ G H* dS_r)
                let inner = g.h.transpose() * pull * g.h.conjugate();
                let trace = |d: &CMat| -> f64 {
                    let mut sum = 0.0;
                    for i in 0..wheels {
                        for j in 0..wheels {
                            let z: C64 = inner[(i, j)] * d[(j, i)];
                            sum += z.re;
                        }
                    }
                    sum
                };
                let level = trace(&g.road.s);
                let tail = e.len();
                out[tail] = level;
                out[tail + 1] = -g.road.ln_nu * level;
                out[tail + 2] = trace(&g.road.by_mu);
                out[tail + 3] = trace(&g.road.by_delay);
                out
            })
            .collect();
        let mut sum = vec![0.0; e.len() + 4];
        for part in &parts {
            sum.iter_mut().zip(part).for_each(|(s, p)| *s += p);
        }
        sum
    }
}
