//! Derivatives of a vehicle's matrices, and what of the grid they meet.

use super::model::Model;
use crate::identify::likelihood::{Place, Pulled, Road, Shape};
use crate::linalg::C64;
use crate::linalg::Mat;
use crate::linalg::small::{ZERO, product};
use crate::lti::WheeledSystem;
use rayon::prelude::*;

/// Relative step of the differences that give the derivatives of M, C, K: they are polynomials of low degree.
const PARAMETER_STEP: f64 = 1e-5;

/// Derivatives of the vehicle's matrices by the logarithm of a parameter.
pub(super) struct Slope {
    m: Mat,
    c: Mat,
    k: Mat,
    kw: Mat,
    cw: Mat,
    rows: Mat,
}

impl Model<'_> {
    /// Derivatives of M, C, K, K_w, C_w and the sensors' rows by each of the vehicle's parameters.
    pub fn slopes(&self, theta: &[f64]) -> Result<Vec<Slope>, String> {
        let of = |p: usize| -> Result<Slope, String> {
            let mut moved = theta.to_vec();
            moved[p] = theta[p] + PARAMETER_STEP;
            let up = self.system(&moved)?;
            moved[p] = theta[p] - PARAMETER_STEP;
            let down = self.system(&moved)?;
            let slope = |f: &dyn Fn(&WheeledSystem) -> &Mat| {
                let (a, b) = (f(&up), f(&down));
                Mat::from_fn(a.nrows(), a.ncols(), |i, j| (a[(i, j)] - b[(i, j)]) / (2.0 * PARAMETER_STEP))
            };
            Ok(Slope {
                m: slope(&|w| w.system().m()),
                c: slope(&|w| w.system().c()),
                k: slope(&|w| w.system().k()),
                kw: slope(&WheeledSystem::wheel_stiffness),
                cw: slope(&WheeledSystem::wheel_damping),
                rows: slope(&WheeledSystem::rows),
            })
        };
        (0..self.layout.vehicle).into_par_iter().map(of).collect()
    }

    /// L⁻¹(∂S/∂θ)L⁻ᴴ at the middle of a bin, as real vectors of n² entries, one column a parameter.
    pub fn whitened_slopes(
        &self,
        shape: Shape,
        g: Place<'_>,
        slopes: &[Slope],
        theta: &[f64],
        inverse: &[C64],
    ) -> Mat {
        let (Shape { channels: n, wheels, states }, layout) = (shape, &self.layout);
        let mut out = Mat::zeros(n * n, layout.len());
        let mut put = |column: usize, v: &dyn Fn(usize, usize) -> C64| {
            let mut at = 0;
            for i in 0..n {
                out[(at, column)] = v(i, i).re;
                at += 1;
                for j in 0..i {
                    let z: C64 = v(i, j) * std::f64::consts::SQRT_2;
                    (out[(at, column)], out[(at + 1, column)]) = (z.re, z.im);
                    at += 2;
                }
            }
        };
        let zeros = |len: usize| vec![ZERO; len];
        // L⁻¹ conj(dH) · P L⁻ᴴ + its conjugate transpose, conj(dH) = conj(Y)(dB − dZ X)* + conj(D)(dR X*)
        let (mut right, mut left) = (zeros(wheels * n), zeros(n * states));
        for i in 0..wheels {
            for j in 0..n {
                right[i * n + j] = (0..=j).map(|k| g.p[i * n + k] * inverse[j * n + k].conj()).sum();
            }
        }
        let y: Vec<C64> = g.y.iter().map(|v| v.conj()).collect();
        product(&mut left, [n, n, states], |i, j| inverse[i * n + j], &y);
        let w = g.omega;
        let x = |j: usize, k: usize| g.x[j * wheels + k].conj();
        let (mut dh, mut half) = (zeros(n * wheels), zeros(n * n));
        for (column, slope) in slopes.iter().enumerate() {
            dh.fill(ZERO);
            for i in 0..states {
                for j in 0..wheels {
                    let mut u = C64::new(slope.kw[(i, j)], -w * slope.cw[(i, j)]);
                    for k in slope.touched(i) {
                        let dz = C64::new(slope.k[(i, k)] - w * w * slope.m[(i, k)], -w * slope.c[(i, k)]);
                        u -= dz * x(k, j);
                    }
                    if u != ZERO {
                        (0..n).for_each(|c| dh[c * wheels + j] += left[c * states + i] * u);
                    }
                }
            }
            for c in 0..n {
                for i in (0..states).filter(|i| slope.rows[(c, *i)] != 0.0) {
                    for j in 0..wheels {
                        let seen = g.weight[c].conj() * slope.rows[(c, i)] * x(i, j);
                        (c..n).for_each(|k| dh[k * wheels + j] += inverse[k * n + c] * seen);
                    }
                }
            }
            product(&mut half, [n, wheels, n], |i, j| dh[i * wheels + j], &right);
            put(column, &|i, j| half[i * n + j] + half[j * n + i].conj());
        }
        let road = self.road(theta);
        let hc: Vec<C64> = g.h.iter().map(|v| v.conj()).collect();
        let mut h = zeros(n * wheels);
        product(&mut h, [n, n, wheels], |i, j| inverse[i * n + j], &hc);
        let through = |sr: &[C64]| -> Vec<C64> {
            let (mut half, mut whole) = (zeros(n * wheels), zeros(n * n));
            product(&mut half, [n, wheels, wheels], |i, j| h[i * wheels + j], sr);
            for i in 0..n {
                for j in 0..n {
                    whole[i * n + j] =
                        (0..wheels).map(|k| half[i * wheels + k] * h[j * wheels + k].conj()).sum();
                }
            }
            whole
        };
        let level = through(g.road);
        put(layout.s0(), &|i, j| level[i * n + j]);
        let ln_nu = road.ln_nu(w);
        put(layout.exponent(), &|i, j| level[i * n + j] * -ln_nu);
        let [by_mu, by_delay] = road.derivatives(w, g.road);
        for (place, by) in [(layout.mu, by_mu), (layout.delay, by_delay)] {
            if let Some(column) = place {
                let by = through(&by);
                put(column, &|i, j| by[i * n + j]);
            }
        }
        for c in 0..n {
            if let Some(first) = layout.clocks {
                // S_cj turns by iω, S_ic by −iω; row c of L⁻¹ … is L⁻¹ e_c times row c of (S L⁻ᴴ), S L⁻ᴴ = H* P L⁻ᴴ
                let row: Vec<C64> = (0..n)
                    .map(|j| (0..wheels).map(|k| hc[c * wheels + k] * right[k * n + j]).sum())
                    .collect();
                let turned = |i: usize, j: usize| inverse[i * n + c] * row[j] * C64::new(0.0, w);
                put(first + c, &|i, j| turned(i, j) + turned(j, i).conj());
            }
            let floor = theta[layout.noise + c].exp();
            put(layout.noise + c, &|i, j| inverse[i * n + c] * inverse[j * n + c].conj() * floor);
        }
        out
    }
}

impl Slope {
    /// Columns of row i in which Z moves.
    fn touched(&self, i: usize) -> impl Iterator<Item = usize> + '_ {
        (0..self.k.ncols())
            .filter(move |k| self.k[(i, *k)] != 0.0 || self.c[(i, *k)] != 0.0 || self.m[(i, *k)] != 0.0)
    }
}

/// What the parameters' matrices are contracted with, all turned: entry (i, j) at j · rows + i.
pub(super) struct Sums {
    rows: Vec<f64>,
    kw: Vec<f64>,
    cw: Vec<f64>,
    k: Vec<f64>,
    c: Vec<f64>,
    m: Vec<f64>,
    pub road: [f64; 4],
    pub clocks: Vec<f64>,
}

impl Sums {
    pub fn new(shape: Shape) -> Self {
        let Shape { channels: n, wheels, states } = shape;
        let zeros = |len: usize| vec![0.0; len];
        Sums {
            rows: zeros(n * states),
            kw: zeros(wheels * states),
            cw: zeros(wheels * states),
            k: zeros(states * states),
            c: zeros(states * states),
            m: zeros(states * states),
            road: [0.0; 4],
            clocks: zeros(n),
        }
    }

    /// Adds one half bin's share.
    pub fn add(&mut self, shape: Shape, road: &Road<'_>, at: Place<'_>, pulled: &Pulled, clocks: bool) {
        let (Shape { channels: n, wheels, .. }, w) = (shape, at.omega);
        for (i, v) in pulled.xq.iter().enumerate() {
            self.rows[i] += (v * at.weight[i % n]).re;
        }
        for ((v, kw), cw) in pulled.qy.iter().zip(&mut self.kw).zip(&mut self.cw) {
            *kw += v.re;
            *cw -= w * v.im;
        }
        for (((v, k), c), m) in pulled.xqy.iter().zip(&mut self.k).zip(&mut self.c).zip(&mut self.m) {
            *k += v.re;
            *c -= w * v.im;
            *m -= w * w * v.re;
        }
        let slopes = road.slopes(w, at.road, &pulled.through);
        self.road.iter_mut().zip(slopes).for_each(|(s, v)| *s += v);
        if clocks {
            // S_ij turns with e^{iω(δᵢ − δⱼ)}: 2 Re(iω (S G)_cc), S G = H* Q*
            for (c, sum) in self.clocks.iter_mut().enumerate() {
                let sg: C64 = (0..wheels).map(|k| (at.h[c * wheels + k] * pulled.q[k * n + c]).conj()).sum();
                *sum -= 2.0 * w * sg.im;
            }
        }
    }

    pub fn join(&mut self, other: &Sums) {
        let pairs = [
            (&mut self.rows, &other.rows),
            (&mut self.kw, &other.kw),
            (&mut self.cw, &other.cw),
            (&mut self.k, &other.k),
            (&mut self.c, &other.c),
            (&mut self.m, &other.m),
            (&mut self.clocks, &other.clocks),
        ];
        for (a, b) in pairs {
            a.iter_mut().zip(b).for_each(|(x, y)| *x += y);
        }
        self.road.iter_mut().zip(&other.road).for_each(|(a, b)| *a += b);
    }

    /// The gradient along a parameter.
    pub fn along(&self, slope: &Slope) -> f64 {
        2.0 * (inner(&slope.rows, &self.rows) + inner(&slope.kw, &self.kw) + inner(&slope.cw, &self.cw)
            - inner(&slope.k, &self.k)
            - inner(&slope.c, &self.c)
            - inner(&slope.m, &self.m))
    }
}

/// Σ a_ij b_ij of a turned b.
fn inner(a: &Mat, turned: &[f64]) -> f64 {
    let mut sum = 0.0;
    for j in 0..a.ncols() {
        for i in 0..a.nrows() {
            sum += a[(i, j)] * turned[j * a.nrows() + i];
        }
    }
    sum
}
