//! A vehicle under sensors on a road: its spectra, and how a pull on the spectra acts on its parameters.

use super::layout::Layout;
use crate::identify::likelihood::{BandData, Drive, RoadAt};
use crate::linalg::{C64, CMat, Mat, solve_complex};
use crate::lti::{Parametric, WheeledSystem};
use rayon::prelude::*;

/// Relative step of the differences that give the derivatives of M, C, K: they are polynomials of low degree.
const PARAMETER_STEP: f64 = 1e-5;

/// The model at one half bin.
pub(super) struct GridPoint {
    omega: f64,
    /// G B (dofs × wheels).
    x: CMat,
    /// Weighted R G (channels × dofs).
    y: CMat,
    /// H (channels × wheels).
    h: CMat,
    /// S_r Hᵀ (wheels × channels).
    p: CMat,
    /// The channels' weights (iω)^d e^{−iωδ}/scale.
    weight: Vec<C64>,
    road: RoadAt,
}

/// The model everywhere.
pub(super) struct Evaluation {
    /// None at ω = 0.
    pub grid: Vec<Option<GridPoint>>,
    /// Spectra at the bins of the band, window and noise included.
    pub s: Vec<CMat>,
}

/// One recording of a vehicle at a speed.
pub(super) struct Model<'a> {
    pub vehicle: &'a dyn Parametric,
    /// Time derivatives of displacement that each channel measures.
    pub derivatives: &'a [usize],
    pub drive: Drive,
    pub layout: Layout,
    /// Names of the channels.
    pub channels: &'a [String],
    pub data: BandData,
    /// Independent averages at one bin.
    pub averages: f64,
}

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
    /// The vehicle at θ.
    pub fn system(&self, theta: &[f64]) -> Result<WheeledSystem, String> {
        let values: Vec<f64> = theta[..self.layout.vehicle].iter().map(|t| t.exp()).collect();
        self.vehicle.system(&values)
    }

    /// Spectra at the bins, and the parts that their derivatives are made of.
    pub fn evaluate(&self, theta: &[f64]) -> Result<Evaluation, String> {
        let base = self.system(theta)?;
        let [from, last] = self.data.grid();
        let grid: Vec<Option<GridPoint>> = (from..=last)
            .into_par_iter()
            .map(|index| match index {
                0 => Ok(None),
                _ => self.at(&base, theta, self.data.half_omega(index)).map(Some),
            })
            .collect::<Result<_, String>>()?;
        let n = self.layout.channels;
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
        let noise = &theta[self.layout.noise..];
        let s = self.data.convolve(&flat).into_iter().map(|block| {
            CMat::from_fn(n, n, |i, j| {
                block[i * n + j] + C64::new(if i == j { noise[i].exp() } else { 0.0 }, 0.0)
            })
        });
        Ok(Evaluation { s: s.collect(), grid })
    }

    fn at(&self, base: &WheeledSystem, theta: &[f64], omega: f64) -> Result<GridPoint, String> {
        let n = self.layout.channels;
        let (dofs, wheels) = (base.system().order(), base.at_m().len());
        let b = CMat::from_fn(dofs, wheels, |i, j| {
            C64::new(base.wheel_stiffness()[(i, j)], omega * base.wheel_damping()[(i, j)])
        });
        let z = base.system().dynamic_stiffness(omega);
        let x = solve_complex(&z, &b).map_err(|e| e.to_string())?;
        let rows = base.rows();
        let turned = CMat::from_fn(dofs, n, |i, j| C64::new(rows[(j, i)], 0.0));
        let y = solve_complex(&z.transpose().to_owned(), &turned).map_err(|e| e.to_string())?;
        let late = |i: usize| self.layout.clocks.map_or(0.0, |first| theta[first + i]);
        let weight: Vec<C64> = (0..n)
            .map(|i| {
                C64::new(0.0, omega).powu(self.derivatives[i] as u32) / self.data.scale[i]
                    * C64::new(0.0, -omega * late(i)).exp()
            })
            .collect();
        let y = CMat::from_fn(n, dofs, |i, j| weight[i] * y[(j, i)]);
        let h = &y * &b;
        let road = RoadAt::new(self.drive, &self.layout.road(theta), base.at_m(), omega);
        let p = &road.s * h.transpose();
        Ok(GridPoint { omega, x, y, h, p, weight, road })
    }

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

    /// The gradient of Σ_k tr(G_k S_k) by θ.
    ///
    /// On the grid, with Q = (P G)*: 2 Re tr(dH Q), dH = D(dR X) + Y(dB − dZ X), B = K_w + iωC_w, Z = K + iωC − ω²M. The
    /// parameters' real matrices meet sums over the grid once.
    pub fn pull(&self, evaluation: &Evaluation, slopes: &[Slope], theta: &[f64], bins: &[CMat]) -> Vec<f64> {
        let spread = self.data.spread(bins);
        let n = self.layout.channels;
        let parts: Vec<Part> = evaluation
            .grid
            .par_iter()
            .zip(&spread)
            .filter_map(|(g, pull)| g.as_ref().map(|g| self.part(g, pull)))
            .collect();
        let mut sum = Part::zeros(&parts[0]);
        parts.iter().for_each(|p| sum.add(p));
        let mut out = vec![0.0; self.layout.len()];
        for (slope, g) in slopes.iter().zip(&mut out) {
            *g = 2.0
                * (inner(&slope.rows, &sum.rows) + inner(&slope.kw, &sum.kw) + inner(&slope.cw, &sum.cw)
                    - inner(&slope.k, &sum.k)
                    - inner(&slope.c, &sum.c)
                    - inner(&slope.m, &sum.m));
        }
        out[self.layout.s0()] = sum.road[0];
        out[self.layout.exponent()] = sum.road[1];
        if let Some(i) = self.layout.mu {
            out[i] = sum.road[2];
        }
        if let Some(i) = self.layout.delay {
            out[i] = sum.road[3];
        }
        for c in 0..n {
            if let Some(first) = self.layout.clocks {
                out[first + c] = sum.clocks[c];
            }
            out[self.layout.noise + c] =
                bins.iter().map(|g| g[(c, c)].re).sum::<f64>() * theta[self.layout.noise + c].exp();
        }
        out
    }

    fn part(&self, g: &GridPoint, pull: &CMat) -> Part {
        let (n, wheels, dofs) = (g.h.nrows(), g.h.ncols(), g.x.nrows());
        let pg = &g.p * pull;
        let q = pg.conjugate();
        let xq = &g.x * q; // dofs × channels
        let qy = q * &g.y; // wheels × dofs
        let xqy = &g.x * &qy; // dofs × dofs
        let w = g.omega;
        let through = g.h.transpose() * pull * g.h.conjugate();
        let trace = |d: &CMat| -> f64 {
            let mut sum = 0.0;
            for i in 0..wheels {
                for j in 0..wheels {
                    let z: C64 = through[(i, j)] * d[(j, i)];
                    sum += z.re;
                }
            }
            sum
        };
        let level = trace(&g.road.s);
        let turn = if self.layout.clocks.is_some() {
            // S_ij turns with e^{iω(δᵢ − δⱼ)}: 2 Re(iω (S G)_cc)
            let sg = g.h.conjugate() * pg;
            (0..n).map(|c| -2.0 * w * sg[(c, c)].im).collect()
        } else {
            Vec::new()
        };
        Part {
            rows: Mat::from_fn(n, dofs, |i, j| (xq[(j, i)] * g.weight[i]).re),
            kw: Mat::from_fn(dofs, wheels, |i, j| qy[(j, i)].re),
            cw: Mat::from_fn(dofs, wheels, |i, j| -w * qy[(j, i)].im),
            k: Mat::from_fn(dofs, dofs, |i, j| xqy[(j, i)].re),
            c: Mat::from_fn(dofs, dofs, |i, j| -w * xqy[(j, i)].im),
            m: Mat::from_fn(dofs, dofs, |i, j| -w * w * xqy[(j, i)].re),
            road: [level, -g.road.ln_nu * level, trace(&g.road.by_mu), trace(&g.road.by_delay)],
            clocks: turn,
        }
    }

    /// L⁻¹(∂S/∂θ)L⁻ᴴ at the middle of a bin, as real vectors of n² entries, one column a parameter.
    pub fn whitened_slopes(&self, g: &GridPoint, slopes: &[Slope], theta: &[f64], inverse: &CMat) -> Mat {
        let (n, layout) = (self.layout.channels, &self.layout);
        let mut out = Mat::zeros(n * n, layout.len());
        let mut put = |column: usize, v: &CMat| {
            let mut at = 0;
            for i in 0..n {
                out[(at, column)] = v[(i, i)].re;
                at += 1;
                for j in 0..i {
                    let z: C64 = v[(i, j)] * std::f64::consts::SQRT_2;
                    (out[(at, column)], out[(at + 1, column)]) = (z.re, z.im);
                    at += 2;
                }
            }
        };
        // L⁻¹ conj(dH) · P L⁻ᴴ + its conjugate transpose
        let right = &g.p * inverse.adjoint();
        let w = g.omega;
        let complex = |a: &Mat| CMat::from_fn(a.nrows(), a.ncols(), |i, j| C64::new(a[(i, j)], 0.0));
        let left = inverse * g.y.conjugate();
        let x = g.x.conjugate();
        for (column, slope) in slopes.iter().enumerate() {
            let dz = CMat::from_fn(g.x.nrows(), g.x.nrows(), |i, j| {
                C64::new(slope.k[(i, j)] - w * w * slope.m[(i, j)], -w * slope.c[(i, j)])
            });
            let db = CMat::from_fn(g.x.nrows(), g.x.ncols(), |i, j| {
                C64::new(slope.kw[(i, j)], -w * slope.cw[(i, j)])
            });
            let mut dh = &left * (db - dz * x);
            if slope.rows.norm_max() > 0.0 {
                let seen = complex(&slope.rows) * x;
                dh += inverse * CMat::from_fn(n, x.ncols(), |i, j| g.weight[i].conj() * seen[(i, j)]);
            }
            let half = dh * &right;
            put(column, &CMat::from_fn(n, n, |i, j| half[(i, j)] + half[(j, i)].conj()));
        }
        let h = inverse * g.h.conjugate();
        let through = |sr: &CMat| &h * sr * h.adjoint();
        let level = through(&g.road.s);
        put(layout.s0(), &level);
        put(layout.exponent(), &CMat::from_fn(n, n, |i, j| level[(i, j)] * -g.road.ln_nu));
        if let Some(i) = layout.mu {
            put(i, &through(&g.road.by_mu));
        }
        if let Some(i) = layout.delay {
            put(i, &through(&g.road.by_delay));
        }
        for c in 0..n {
            if let Some(first) = layout.clocks {
                let s = g.h.conjugate() * &g.p;
                let turned = CMat::from_fn(n, n, |i, j| {
                    s[(i, j)] * C64::new(0.0, w * (f64::from(u8::from(i == c)) - f64::from(u8::from(j == c))))
                });
                put(first + c, &(inverse * turned * inverse.adjoint()));
            }
            let floor = theta[layout.noise + c].exp();
            put(
                layout.noise + c,
                &CMat::from_fn(n, n, |i, j| inverse[(i, c)] * inverse[(j, c)].conj() * floor),
            );
        }
        out
    }
}

/// What the parameters' matrices are contracted with.
struct Part {
    rows: Mat,
    kw: Mat,
    cw: Mat,
    k: Mat,
    c: Mat,
    m: Mat,
    road: [f64; 4],
    clocks: Vec<f64>,
}

impl Part {
    fn zeros(like: &Part) -> Self {
        let zero = |m: &Mat| Mat::zeros(m.nrows(), m.ncols());
        Part {
            rows: zero(&like.rows),
            kw: zero(&like.kw),
            cw: zero(&like.cw),
            k: zero(&like.k),
            c: zero(&like.c),
            m: zero(&like.m),
            road: [0.0; 4],
            clocks: vec![0.0; like.clocks.len()],
        }
    }

    fn add(&mut self, other: &Part) {
        self.rows += &other.rows;
        self.kw += &other.kw;
        self.cw += &other.cw;
        self.k += &other.k;
        self.c += &other.c;
        self.m += &other.m;
        self.road.iter_mut().zip(&other.road).for_each(|(a, b)| *a += b);
        self.clocks.iter_mut().zip(&other.clocks).for_each(|(a, b)| *a += b);
    }
}

fn inner(a: &Mat, b: &Mat) -> f64 {
    let mut sum = 0.0;
    for j in 0..a.ncols() {
        for i in 0..a.nrows() {
            sum += a[(i, j)] * b[(i, j)];
        }
    }
    sum
}
