//! A vehicle under sensors on a road: its spectra, and how a pull on the spectra acts on its parameters.

use super::layout::Layout;
use super::slopes::{Slope, Sums};
use crate::identify::likelihood::{BandData, Drive, PlaceMut, Response, Road, Shape, Spectra};
use crate::linalg::small::{lu, lu_solve, lu_solve_transposed, real_product};
use crate::linalg::{C64, Mat};
use crate::lti::{Parametric, WheeledSystem};

/// The model everywhere.
pub(super) struct Evaluation {
    /// The parts of the derivatives, on the grid.
    pub grid: Response,
    /// Spectra at the bins of the band, window and noise included.
    pub s: Spectra,
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
    /// Places of the wheels, m.
    pub at_m: Vec<[f64; 2]>,
    pub data: BandData,
    /// Independent averages at one bin.
    pub averages: f64,
}

/// The matrices of a vehicle, row after row.
struct Flat {
    m: Vec<f64>,
    c: Vec<f64>,
    k: Vec<f64>,
    kw: Vec<f64>,
    cw: Vec<f64>,
    rows: Vec<f64>,
}

impl Flat {
    fn new(base: &WheeledSystem) -> Self {
        let flat = |a: &Mat| (0..a.nrows() * a.ncols()).map(|k| a[(k / a.ncols(), k % a.ncols())]).collect();
        let system = base.system();
        Flat {
            m: flat(system.m()),
            c: flat(system.c()),
            k: flat(system.k()),
            kw: flat(base.wheel_stiffness()),
            cw: flat(base.wheel_damping()),
            rows: flat(base.rows()),
        }
    }
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
        let (shape, flat) = (self.shape(&base), Flat::new(&base));
        let solve = |omega: f64, place: PlaceMut<'_>| self.solve(shape, &flat, theta, omega, place);
        let (s, grid) = Response::new(&self.data, shape, &self.road(theta), &self.noise(theta), solve)
            .ok_or(NO_RESPONSE)?;
        Ok(Evaluation { grid, s })
    }

    /// Spectra at the bins alone.
    pub fn spectra(&self, theta: &[f64]) -> Result<Spectra, String> {
        let base = self.system(theta)?;
        let (shape, flat) = (self.shape(&base), Flat::new(&base));
        let solve = |omega: f64, place: PlaceMut<'_>| self.solve(shape, &flat, theta, omega, place);
        Response::spectra(&self.data, shape, &self.road(theta), &self.noise(theta), solve)
            .ok_or_else(|| NO_RESPONSE.to_owned())
    }

    /// The road at θ.
    pub fn road(&self, theta: &[f64]) -> Road<'_> {
        Road::new(self.drive, self.layout.road(theta), &self.at_m)
    }

    fn noise(&self, theta: &[f64]) -> Vec<f64> {
        theta[self.layout.noise..].iter().map(|t| t.exp()).collect()
    }

    fn shape(&self, base: &WheeledSystem) -> Shape {
        Shape { channels: self.layout.channels, wheels: self.at_m.len(), states: base.system().order() }
    }

    /// X = Z⁻¹B, Y = W R Z⁻¹, H = W R X, with W_i = (iω)^d e^{−iωδ}/scale, Z = K + iωC − ω²M, B = K_w + iωC_w.
    fn solve(&self, shape: Shape, base: &Flat, theta: &[f64], omega: f64, place: PlaceMut<'_>) -> bool {
        let Shape { channels: n, wheels, states } = shape;
        let PlaceMut { x, y, h, weight, matrix, turned, pivots } = place;
        for (i, z) in matrix.iter_mut().enumerate() {
            *z = C64::new(base.k[i] - omega * omega * base.m[i], omega * base.c[i]);
        }
        if !lu(matrix, pivots) {
            return false;
        }
        for (i, b) in x.iter_mut().enumerate() {
            *b = C64::new(base.kw[i], omega * base.cw[i]);
        }
        lu_solve(matrix, pivots, x, wheels);
        for (i, w) in weight.iter_mut().enumerate() {
            *w = C64::new(0.0, omega).powu(self.derivatives[i] as u32) / self.data.scale[i];
            if let Some(first) = self.layout.clocks {
                *w *= C64::new(0.0, -omega * theta[first + i]).exp();
            }
        }
        real_product(h, [n, states, wheels], &base.rows, x);
        h.chunks_exact_mut(wheels).zip(&*weight).for_each(|(row, w)| row.iter_mut().for_each(|v| *v *= w));
        if let Some(y) = y {
            for j in 0..states {
                (0..n).for_each(|i| turned[j * n + i] = C64::new(base.rows[i * states + j], 0.0));
            }
            lu_solve_transposed(matrix, pivots, turned, n);
            for i in 0..n {
                (0..states).for_each(|j| y[i * states + j] = weight[i] * turned[j * n + i]);
            }
        }
        true
    }

    /// The gradient of Σ_k tr(G_k S_k) by θ.
    ///
    /// On the grid, with Q = (P G)*: 2 Re tr(dH Q), dH = D(dR X) + Y(dB − dZ X), B = K_w + iωC_w, Z = K + iωC − ω²M. The
    /// parameters' real matrices meet sums over the grid once.
    pub fn pull(&self, evaluation: &Evaluation, slopes: &[Slope], theta: &[f64], bins: &Spectra) -> Vec<f64> {
        let (shape, road) = (evaluation.grid.shape, self.road(theta));
        let clocks = self.layout.clocks.is_some();
        let parts = evaluation.grid.pulled(
            &self.data,
            bins,
            || Sums::new(shape),
            |sum, at, pulled| sum.add(shape, &road, at, pulled, clocks),
        );
        let mut sum = Sums::new(shape);
        parts.iter().for_each(|p| sum.join(p));
        let mut out = vec![0.0; self.layout.len()];
        for (slope, g) in slopes.iter().zip(&mut out) {
            *g = sum.along(slope);
        }
        out[self.layout.s0()] = sum.road[0];
        out[self.layout.exponent()] = sum.road[1];
        if let Some(i) = self.layout.mu {
            out[i] = sum.road[2];
        }
        if let Some(i) = self.layout.delay {
            out[i] = sum.road[3];
        }
        for c in 0..self.layout.channels {
            if let Some(first) = self.layout.clocks {
                out[first + c] = sum.clocks[c];
            }
            out[self.layout.noise + c] = bins.diagonal_sum(c) * theta[self.layout.noise + c].exp();
        }
        out
    }
}

const NO_RESPONSE: &str = "the vehicle has no response at a frequency of the band";
