//! Spectra of a free state space on a road, and how a pull on the spectra acts on its entries.

use super::orbit::Entries;
use crate::identify::likelihood::{BandData, Drive, PlaceMut, Response, Road, RoadValues, Shape, Spectra};
use crate::linalg::small::{lu, lu_solve, lu_solve_transposed, real_product};
use crate::linalg::{C64, Mat};
use crate::lti::FirstOrder;

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

/// The model everywhere.
pub(super) struct Evaluation {
    /// The parts of the derivatives, on the grid: G = (sI − A)⁻¹.
    pub grid: Response,
    /// Spectra at the bins, window and noise included.
    pub s: Spectra,
}

/// A system's matrices, row after row.
struct Flat {
    a: Vec<f64>,
    b: Vec<f64>,
    c: Vec<f64>,
}

impl Flat {
    fn new(system: &FirstOrder) -> Self {
        let flat = |a: &Mat| (0..a.nrows() * a.ncols()).map(|k| a[(k / a.ncols(), k % a.ncols())]).collect();
        Flat { a: flat(&system.a), b: flat(&system.b), c: flat(&system.c) }
    }
}

impl FreeModel {
    /// Spectra, and the parts that their derivatives are made of.
    pub fn evaluate(&self, at: &Point) -> Option<Evaluation> {
        let (shape, flat) = (self.shape(at), Flat::new(&at.system));
        let solve = |omega: f64, place: PlaceMut<'_>| self.solve(shape, &flat, omega, place);
        let (s, grid) = Response::new(&self.data, shape, &self.road(at), &noise(at), solve)?;
        Some(Evaluation { grid, s })
    }

    /// Spectra alone.
    pub fn spectra(&self, at: &Point) -> Option<Spectra> {
        let (shape, flat) = (self.shape(at), Flat::new(&at.system));
        let solve = |omega: f64, place: PlaceMut<'_>| self.solve(shape, &flat, omega, place);
        Response::spectra(&self.data, shape, &self.road(at), &noise(at), solve)
    }

    /// The road under the wheels.
    pub fn road(&self, at: &Point) -> Road<'_> {
        Road::new(self.drive, at.road, &self.at_m)
    }

    fn shape(&self, at: &Point) -> Shape {
        Shape { channels: self.derivatives.len(), wheels: self.at_m.len(), states: at.system.order() }
    }

    /// X = (sI − A)⁻¹B, Y = W C(sI − A)⁻¹, H = W C X, with W_i = (iω)^d/scale.
    fn solve(&self, shape: Shape, system: &Flat, omega: f64, place: PlaceMut<'_>) -> bool {
        let Shape { channels: n, wheels, states } = shape;
        let PlaceMut { x, y, h, weight, matrix, turned, pivots } = place;
        matrix.iter_mut().zip(&system.a).for_each(|(z, a)| *z = C64::new(-a, 0.0));
        (0..states).for_each(|i| matrix[i * states + i].im = omega / RATE);
        if !lu(matrix, pivots) {
            return false;
        }
        x.iter_mut().zip(&system.b).for_each(|(x, b)| *x = C64::new(*b, 0.0));
        lu_solve(matrix, pivots, x, wheels);
        for (i, w) in weight.iter_mut().enumerate() {
            *w = C64::new(0.0, omega).powu(self.derivatives[i] as u32) / self.data.scale[i];
        }
        real_product(h, [n, states, wheels], &system.c, x);
        h.chunks_exact_mut(wheels).zip(&*weight).for_each(|(row, w)| row.iter_mut().for_each(|v| *v *= w));
        if let Some(y) = y {
            for j in 0..states {
                (0..n).for_each(|i| turned[j * n + i] = C64::new(system.c[i * states + j], 0.0));
            }
            lu_solve_transposed(matrix, pivots, turned, n);
            for i in 0..n {
                (0..states).for_each(|j| y[i * states + j] = weight[i] * turned[j * n + i]);
            }
        }
        true
    }

    /// The gradient of Σ_k tr(G_k S_k) by the entries of [A B; C 0], then by ln S₀, e, ln μ, ln delay, ln noise.
    ///
    /// With G on the grid and Q = (P G)*: 2 Re tr(dH Q), dH = W dC X + Y(dA X + dB).
    pub fn pull(&self, evaluation: &Evaluation, at: &Point, bins: &Spectra) -> Vec<f64> {
        let Shape { channels: n, wheels, states } = evaluation.grid.shape;
        let (e, road) = (Entries { states, inputs: wheels, outputs: n }, self.road(at));
        let size = e.len() + 4;
        let parts = evaluation.grid.pulled(
            &self.data,
            bins,
            || vec![0.0; size],
            |sum, place, pulled| {
                for i in 0..states {
                    let row = &mut sum[e.row(i).0..];
                    for j in 0..states {
                        row[j] += 2.0 * pulled.xqy[j * states + i].re;
                    }
                    for w in 0..wheels {
                        row[states + w] += 2.0 * pulled.qy[w * states + i].re;
                    }
                }
                for c in 0..n {
                    let row = &mut sum[e.row(states + c).0..];
                    for j in 0..states {
                        row[j] += 2.0 * (pulled.xq[j * n + c] * place.weight[c]).re;
                    }
                }
                let slopes = road.slopes(place.omega, place.road, &pulled.through);
                sum[e.len()..].iter_mut().zip(slopes).for_each(|(s, v)| *s += v);
            },
        );
        let mut sum = vec![0.0; size];
        for part in &parts {
            sum.iter_mut().zip(part).for_each(|(s, p)| *s += p);
        }
        sum.extend((0..n).map(|c| bins.diagonal_sum(c) * at.ln_noise[c].exp()));
        sum
    }
}

fn noise(at: &Point) -> Vec<f64> {
    at.ln_noise.iter().map(|v| v.exp()).collect()
}
