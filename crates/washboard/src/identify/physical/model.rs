//! The model's spectra and their derivatives, seen through the window.

use super::layout::Layout;
use crate::identify::likelihood::{BandData, Drive, RoadAt};
use crate::linalg::{C64, CMat, Mat, solve_complex};
use crate::lti::{Parametric, WheeledSystem};
use rayon::prelude::*;

/// Relative step of the differences that give the derivatives of M, C, K: they are polynomials of low degree.
const PARAMETER_STEP: f64 = 1e-5;

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
    pub drive: Drive,
    pub layout: Layout,
    /// Names of the channels.
    pub channels: &'a [String],
    pub data: BandData,
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
        let [from, last] = self.data.grid();
        let grid: Vec<Vec<C64>> = (from..=last)
            .into_par_iter()
            .map(|index| self.at(&linear, theta, self.data.half_omega(index), width))
            .collect::<Result<_, String>>()?;
        let blocks = self.data.convolve(&grid);
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

    /// ∂S/∂θ at a bin, noise floors included.
    pub fn slopes(&self, evaluation: &Evaluation, theta: &[f64], bin: usize) -> Vec<CMat> {
        let n = self.layout.channels;
        let mut all = evaluation.ds[bin].clone();
        all.extend((0..n).map(|c| {
            let floor = theta[self.layout.noise + c].exp();
            CMat::from_fn(n, n, |i, j| C64::new(if i == c && j == c { floor } else { 0.0 }, 0.0))
        }));
        all
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
        let late = |i: usize| self.layout.clocks.map_or(0.0, |first| theta[first + i]);
        let weight: Vec<C64> = (0..n)
            .map(|i| {
                C64::new(0.0, omega).powu(self.derivatives[i] as u32) / self.data.scale[i]
                    * C64::new(0.0, -omega * late(i)).exp()
            })
            .collect();
        let weigh = |a: CMat| CMat::from_fn(n, a.ncols(), |i, j| weight[i] * a[(i, j)]);
        let h = weigh(&rows * &x);
        let road = RoadAt::new(self.drive, &self.layout.road(theta), base.at_m(), omega);
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
        write(&mut out, 1 + self.layout.exponent(), &CMat::from_fn(n, n, |i, j| s[(i, j)] * -road.ln_nu));
        if let Some(mu) = self.layout.mu {
            write(&mut out, 1 + mu, &through(&road.by_mu));
        }
        if let Some(delay) = self.layout.delay {
            write(&mut out, 1 + delay, &through(&road.by_delay));
        }
        if let Some(clocks) = self.layout.clocks {
            for c in 0..n {
                // S_ij turns with e^{iω(δᵢ − δⱼ)}
                let turn = |i: usize, j: usize| {
                    C64::new(0.0, omega * (f64::from(u8::from(i == c)) - f64::from(u8::from(j == c))))
                };
                write(&mut out, 1 + clocks + c, &CMat::from_fn(n, n, |i, j| s[(i, j)] * turn(i, j)));
            }
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
