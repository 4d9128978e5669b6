//! The model's spectra and their derivatives, seen through the window.

use super::data::BandData;
use crate::linalg::{C64, CMat, Mat, solve_complex};
use crate::lti::{Parametric, WheeledSystem};
use crate::units::Convention;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// This much (of channels scaled to a mean density of 1) is added to the measured spectra's diagonals and is the least of
/// the model's floors: two tracks give spectra of rank two, and without any noise the rest is leakage that no model
/// knows. Sensors that are 0.1 % noisy have as much of their own.
pub(super) const LEAST_NOISE: f64 = 1e-6;
/// Relative step of the differences that give the derivatives of M, C, K: they are polynomials of low degree.
const PARAMETER_STEP: f64 = 1e-5;

/// Where each parameter stands in θ: logarithms of the vehicle's, ln S₀, e, ln μ, ln of the delay's factor, ln noise.
#[derive(Debug, Clone)]
pub(super) struct Layout {
    pub vehicle: usize,
    pub mu: Option<usize>,
    pub delay: Option<usize>,
    pub noise: usize,
    pub channels: usize,
}

impl Layout {
    pub fn new(vehicle: usize, tracks: bool, axles: bool, channels: usize) -> Self {
        let mut next = vehicle + 2;
        let mut take = |yes: bool| {
            yes.then(|| {
                next += 1;
                next - 1
            })
        };
        let (mu, delay) = (take(tracks), take(axles));
        Layout { vehicle, mu, delay, noise: next, channels }
    }

    pub fn s0(&self) -> usize {
        self.vehicle
    }

    pub fn exponent(&self) -> usize {
        self.vehicle + 1
    }

    pub fn len(&self) -> usize {
        self.noise + self.channels
    }
}

/// Spectra at the bins of the band, and their derivatives by θ.
pub(super) struct Evaluation {
    /// n × n at each bin.
    pub s: Vec<CMat>,
    /// [bin][parameter]; the noise floors' derivatives are known without.
    pub ds: Vec<Vec<CMat>>,
}

/// A vehicle under sensors on a road at a speed.
pub(super) struct Model<'a> {
    pub vehicle: &'a dyn Parametric,
    /// Time derivatives of displacement that each channel measures.
    pub derivatives: &'a [usize],
    pub speed_m_s: f64,
    pub convention: Convention,
    pub layout: Layout,
    pub data: &'a BandData,
    /// Independent averages at one bin.
    pub averages: f64,
}

/// The vehicle at θ, and its derivatives by each ln p.
struct Linearised {
    base: WheeledSystem,
    slopes: Vec<Slope>,
}

struct Slope {
    m: Mat,
    c: Mat,
    k: Mat,
    kw: Mat,
    cw: Mat,
    rows: Mat,
}

impl Model<'_> {
    /// The vehicle at θ.
    pub fn system(&self, theta: &[f64]) -> Result<WheeledSystem, String> {
        let values: Vec<f64> = theta[..self.layout.vehicle].iter().map(|t| t.exp()).collect();
        self.vehicle.system(&values)
    }

    /// Spectra and, where asked, derivatives.
    pub fn evaluate(&self, theta: &[f64], derivatives: bool) -> Result<Evaluation, String> {
        let linear = self.linearise(theta, derivatives)?;
        let n = self.layout.channels;
        let width = if derivatives { self.layout.noise } else { 0 };
        let half = self.data.kernel.len() / 2;
        // half bins of |index| from 0 up to the last one that the window reaches
        let last = 2 * (self.data.first + self.data.omega.len() - 1) + half;
        let lowest = (2 * self.data.first).saturating_sub(half);
        let from = if 2 * self.data.first < half { 0 } else { lowest };
        let grid: Vec<Vec<C64>> = (from..=last)
            .into_par_iter()
            .map(|index| self.at(&linear, theta, 0.5 * self.data.step * index as f64, width))
            .collect::<Result<_, String>>()?;
        let blocks: Vec<Vec<C64>> = (0..self.data.omega.len())
            .into_par_iter()
            .map(|bin| {
                let mut sum = vec![C64::new(0.0, 0.0); (1 + width) * n * n];
                for (offset, weight) in self.data.kernel.iter().enumerate() {
                    let index = (2 * (self.data.first + bin) + offset) as i64 - half as i64;
                    let values = &grid[index.unsigned_abs() as usize - from];
                    // S(−ω) = S(ω)*
                    let sign = if index < 0 { -1.0 } else { 1.0 };
                    for (s, v) in sum.iter_mut().zip(values) {
                        *s += C64::new(weight * v.re, sign * weight * v.im);
                    }
                }
                sum
            })
            .collect();
        let noise = &theta[self.layout.noise..];
        let matrix = |block: &[C64]| CMat::from_fn(n, n, |i, j| block[i * n + j]);
        let mut s = Vec::with_capacity(blocks.len());
        let mut ds = Vec::with_capacity(if derivatives { blocks.len() } else { 0 });
        for block in &blocks {
            let mut m = matrix(&block[..n * n]);
            for i in 0..n {
                m[(i, i)] += noise[i].exp();
            }
            s.push(m);
            if derivatives {
                ds.push(block.chunks_exact(n * n).skip(1).map(matrix).collect());
            }
        }
        Ok(Evaluation { s, ds })
    }

    fn linearise(&self, theta: &[f64], derivatives: bool) -> Result<Linearised, String> {
        let base = self.system(theta)?;
        let mut slopes = Vec::new();
        if derivatives {
            for p in 0..self.layout.vehicle {
                let mut moved = theta.to_vec();
                moved[p] = theta[p] + PARAMETER_STEP;
                let up = self.system(&moved)?;
                moved[p] = theta[p] - PARAMETER_STEP;
                let down = self.system(&moved)?;
                let slope = |f: &dyn Fn(&WheeledSystem) -> &Mat| {
                    let (a, b) = (f(&up), f(&down));
                    Mat::from_fn(a.nrows(), a.ncols(), |i, j| {
                        (a[(i, j)] - b[(i, j)]) / (2.0 * PARAMETER_STEP)
                    })
                };
                slopes.push(Slope {
                    m: slope(&|w| w.system().m()),
                    c: slope(&|w| w.system().c()),
                    k: slope(&|w| w.system().k()),
                    kw: slope(&WheeledSystem::wheel_stiffness),
                    cw: slope(&WheeledSystem::wheel_damping),
                    rows: slope(&WheeledSystem::rows),
                });
            }
        }
        Ok(Linearised { base, slopes })
    }

    /// S and its derivatives at one ω ≥ 0 before window and noise: blocks of n × n, rows first.
    ///
    /// S = H* S_r Hᵀ, H = D R G B with G = (K + iωC − ω²M)⁻¹, B = K_w + iωC_w;
    /// dH = D (dR G B − R G dZ G B + R G dB), dS = dH* S_r Hᵀ + its conjugate transpose.
    fn at(&self, linear: &Linearised, theta: &[f64], omega: f64, width: usize) -> Result<Vec<C64>, String> {
        let (n, base) = (self.layout.channels, &linear.base);
        let mut out = vec![C64::new(0.0, 0.0); (1 + width) * n * n];
        if omega == 0.0 {
            return Ok(out);
        }
        let (dofs, wheels) = (base.system().order(), base.at_m().len());
        let complex = |a: &Mat| CMat::from_fn(a.nrows(), a.ncols(), |i, j| C64::new(a[(i, j)], 0.0));
        let under =
            |k: &Mat, c: &Mat| CMat::from_fn(dofs, wheels, |i, j| C64::new(k[(i, j)], omega * c[(i, j)]));
        let b = under(base.wheel_stiffness(), base.wheel_damping());
        let z = base.system().dynamic_stiffness(omega);
        let rows = complex(base.rows());
        let x = solve_complex(&z, &b).map_err(|e| e.to_string())?;
        let weight: Vec<C64> = (0..n)
            .map(|i| C64::new(0.0, omega).powu(self.derivatives[i] as u32) / self.data.scale[i])
            .collect();
        let weigh = |a: CMat| CMat::from_fn(n, a.ncols(), |i, j| weight[i] * a[(i, j)]);
        let h = weigh(&rows * &x);
        let road = Road::new(self, theta, base.at_m(), omega);
        let p = &road.s * h.transpose();
        let s = h.conjugate() * &p;
        write(&mut out, 0, &s);
        if width == 0 {
            return Ok(out);
        }
        let y = solve_complex(&z.transpose().to_owned(), &rows.transpose().to_owned())
            .map_err(|e| e.to_string())?;
        for (index, slope) in linear.slopes.iter().enumerate() {
            let dz = CMat::from_fn(dofs, dofs, |i, j| {
                C64::new(slope.k[(i, j)] - omega * omega * slope.m[(i, j)], omega * slope.c[(i, j)])
            });
            let inner = under(&slope.kw, &slope.cw) - &dz * &x;
            let dh = weigh(complex(&slope.rows) * &x + y.transpose() * inner);
            let a = dh.conjugate() * &p;
            write(&mut out, 1 + index, &CMat::from_fn(n, n, |i, j| a[(i, j)] + a[(j, i)].conj()));
        }
        let through = |sr: &CMat| h.conjugate() * (sr * h.transpose());
        write(&mut out, 1 + self.layout.s0(), &s);
        let ln_nu = (omega / self.speed_m_s).ln();
        write(&mut out, 1 + self.layout.exponent(), &CMat::from_fn(n, n, |i, j| s[(i, j)] * -ln_nu));
        if let Some(mu) = self.layout.mu {
            write(&mut out, 1 + mu, &through(&road.by_mu));
        }
        if let Some(delay) = self.layout.delay {
            write(&mut out, 1 + delay, &through(&road.by_delay));
        }
        Ok(out)
    }
}

fn write(out: &mut [C64], block: usize, a: &CMat) {
    let n = a.nrows();
    for i in 0..n {
        for j in 0..n {
            out[block * n * n + i * n + j] = a[(i, j)];
        }
    }
}

/// The spectrum matrix under the wheels and its derivatives by ln μ and the logarithm of the delay's factor.
struct Road {
    s: CMat,
    by_mu: CMat,
    by_delay: CMat,
}

impl Road {
    fn new(model: &Model<'_>, theta: &[f64], at_m: &[[f64; 2]], omega: f64) -> Self {
        let (layout, v) = (&model.layout, model.speed_m_s);
        let density = theta[layout.s0()].exp() * (omega / v).powf(-theta[layout.exponent()]);
        let level = model.convention.two_sided_time(density, v);
        let mu = layout.mu.map_or(0.0, |i| theta[i].exp());
        let factor = layout.delay.map_or(1.0, |i| theta[i].exp());
        let w = at_m.len();
        let decay = |i: usize, j: usize| mu * (at_m[i][1] - at_m[j][1]).abs() * omega / (TAU * v);
        let turn = |i: usize, j: usize| omega * factor * (at_m[i][0] - at_m[j][0]) / v;
        let s = CMat::from_fn(w, w, |i, j| C64::new(0.0, -turn(i, j)).exp() * (level * (-decay(i, j)).exp()));
        let by_mu = CMat::from_fn(w, w, |i, j| s[(i, j)] * -decay(i, j));
        let by_delay = CMat::from_fn(w, w, |i, j| s[(i, j)] * C64::new(0.0, -turn(i, j)));
        Road { s, by_mu, by_delay }
    }
}
