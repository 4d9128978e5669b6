//! Cost, gradient and Fisher information of free modes, by the structure of the response's derivatives.

use super::model::{Evaluation, FreeModel, GridPoint, Point};
use super::orbit::Entries;
use crate::linalg::{C64, CMat, Mat};
use rayon::prelude::*;

/// The information is summed over every so manyth bin that about this many are left: it is smooth, and they tell as much.
const INFORMATION_BINS: usize = 130;
/// Bins are summed in so many parts, whatever the number of threads: the same bits on all.
const PARTS: usize = 8;
/// The static gain over a road's plane is the plane at the sensors to this.
pub(super) const PLANE_SD: f64 = 0.01;

/// Cost, gradient and information over the entries of [A B; C 0], ln S₀, e, ln μ, ln delay, ln noise.
pub(super) struct Full {
    pub cost: f64,
    pub gradient: Vec<f64>,
    pub fisher: Mat,
}

/// A bin's factor and residual.
struct Whitened {
    cost: f64,
    /// L⁻¹ of S = L Lᴴ.
    inverse: CMat,
    /// S⁻¹(S − Ŝ)S⁻¹.
    pull: CMat,
}

/// n_avg Σ (ln|S| + tr S⁻¹Ŝ) and half the squares of the static plane's misfit.
pub(super) fn cost(model: &FreeModel, evaluation: &Evaluation, measured: &[CMat], at: &Point) -> Option<f64> {
    let fit = crate::identify::likelihood::cost(&evaluation.s, measured, model.data.averages)?;
    let (residual, ..) = plane(model, at)?;
    Some(fit + 0.5 * residual.iter().map(|r| r * r).sum::<f64>())
}

/// All that scoring needs.
///
/// The gradient is exact: the pull n_avg S⁻¹(S − Ŝ)S⁻¹ on each bin goes back through the window to the grid and there to
/// the entries. The information takes each bin's derivative as at its middle (the window moves it by a few per cent at
/// most). An entry's derivative is conj(u) zᵀP + h.c. with u a column of [Y, W] and z a row of [X; I], so that products
/// of derivatives are products of small Gram matrices.
pub(super) fn full(
    model: &FreeModel,
    evaluation: &Evaluation,
    measured: &[CMat],
    at: &Point,
) -> Option<Full> {
    let whitened: Vec<Whitened> =
        evaluation.s.par_iter().zip(measured).map(|(s, m)| whiten(s, m)).collect::<Option<_>>()?;
    let averages = model.data.averages;
    let e = Entries::of(&at.system);
    let n = model.derivatives.len();
    let (tail, p) = (e.len() + 4, e.len() + 4 + n);
    let pulls: Vec<CMat> =
        whitened.iter().map(|w| CMat::from_fn(n, n, |i, j| w.pull[(i, j)] * averages)).collect();
    let mut gradient = model.pull(evaluation, &pulls);
    gradient.resize(p, 0.0);
    for g in &pulls {
        for c in 0..n {
            gradient[tail + c] += g[(c, c)].re * at.ln_noise[c].exp();
        }
    }
    let mut fisher = information(model, evaluation, &whitened, at, p);
    let mut total = averages * whitened.iter().map(|w| w.cost).sum::<f64>();
    let (residual, slopes) = plane(model, at)?;
    total += 0.5 * residual.iter().map(|r| r * r).sum::<f64>();
    for (r, slope) in residual.iter().zip(&slopes) {
        for (a, va) in slope {
            gradient[*a] += r * va;
            for (b, vb) in slope {
                fisher[(*a, *b)] += va * vb;
            }
        }
    }
    Some(Full { cost: total, gradient, fisher })
}

/// n_avg S⁻¹ D S⁻¹ at each bin: the pull of a change D of the spectra in the likelihood's metric.
pub(super) fn metric_pull(model: &FreeModel, evaluation: &Evaluation, change: &[CMat]) -> Option<Vec<CMat>> {
    let averages = model.data.averages;
    evaluation
        .s
        .iter()
        .zip(change)
        .map(|(s, d)| {
            let inverse = inverse_factor(s)?;
            let si = inverse.adjoint() * &inverse;
            let g = &si * d * &si;
            Some(CMat::from_fn(g.nrows(), g.ncols(), |i, j| g[(i, j)] * averages))
        })
        .collect()
}

pub(super) fn inverse_factor(s: &CMat) -> Option<CMat> {
    let n = s.nrows();
    let factor = s.llt(faer::Side::Lower).ok()?;
    let mut inverse = CMat::identity(n, n);
    factor.L().solve_lower_triangular_in_place(inverse.as_mut());
    Some(inverse)
}

fn whiten(s: &CMat, measured: &CMat) -> Option<Whitened> {
    let n = s.nrows();
    let inverse = inverse_factor(s)?;
    let log_det: f64 = (0..n).map(|i| -2.0 * inverse[(i, i)].re.ln()).sum();
    let m = &inverse * measured * inverse.adjoint();
    let trace: f64 = (0..n).map(|i| m[(i, i)].re).sum();
    let residual = CMat::from_fn(n, n, |i, j| C64::new(f64::from(u8::from(i == j)), 0.0) - m[(i, j)]);
    let pull = inverse.adjoint() * residual * &inverse;
    let cost = log_det + trace;
    cost.is_finite().then_some(Whitened { cost, inverse, pull })
}

/// Real and imaginary parts apart, column after column.
struct Split {
    rows: usize,
    re: Vec<f64>,
    im: Vec<f64>,
}

impl Split {
    fn new(m: &CMat) -> Self {
        let (rows, columns) = (m.nrows(), m.ncols());
        let at = |k: usize| m[(k % rows, k / rows)];
        Split {
            rows,
            re: (0..rows * columns).map(|k| at(k).re).collect(),
            im: (0..rows * columns).map(|k| at(k).im).collect(),
        }
    }

    fn column(&self, j: usize) -> (&[f64], &[f64]) {
        let range = j * self.rows..(j + 1) * self.rows;
        (&self.re[range.clone()], &self.im[range])
    }
}

fn information(
    model: &FreeModel,
    evaluation: &Evaluation,
    whitened: &[Whitened],
    at: &Point,
    p: usize,
) -> Mat {
    let stride = (whitened.len() / INFORMATION_BINS).max(1);
    let bins: Vec<usize> = (0..whitened.len()).skip(stride / 2).step_by(stride).collect();
    let size = bins.len().div_ceil(PARTS);
    let first = model.data.first;
    let from = model.data.grid()[0];
    let parts: Vec<Vec<f64>> = (0..PARTS)
        .into_par_iter()
        .map(|part| {
            let mut sum = vec![0.0; p * p];
            for bin in bins.iter().skip(part * size).take(size) {
                if let Some(g) = &evaluation.grid[2 * (first + bin) - from] {
                    add_bin(&mut sum, g, &whitened[*bin].inverse, at, p);
                }
            }
            sum
        })
        .collect();
    let mut total = vec![0.0; p * p];
    for part in &parts {
        total.iter_mut().zip(part).for_each(|(t, v)| *t += v);
    }
    // rows were filled for b ≥ a's row block: the lower part is the upper one's mirror
    let weight = model.data.averages * whitened.len() as f64 / bins.len() as f64;
    Mat::from_fn(p, p, |a, b| {
        let (a, b) = (a.min(b), a.max(b));
        weight * total[a * p + b]
    })
}

fn add_bin(sum: &mut [f64], g: &GridPoint, inverse: &CMat, at: &Point, p: usize) {
    let e = Entries::of(&at.system);
    let (n, wheels, states) = (e.outputs, e.inputs, e.states);
    let (rows, wide) = (e.rows(), states + wheels);
    // ũ: columns L⁻¹ conj(u); p̃: rows conj(z)ᵀ P L⁻ᴴ
    let u = CMat::from_fn(n, rows, |i, l| {
        if l < states {
            g.y[(i, l)].conj()
        } else if l - states == i {
            g.weight[i].conj()
        } else {
            C64::new(0.0, 0.0)
        }
    });
    let u = inverse * u;
    let z = CMat::from_fn(wide, wheels, |r, w| {
        if r < states { g.x[(r, w)].conj() } else { C64::new(f64::from(u8::from(r - states == w)), 0.0) }
    });
    let right = z * &g.p * inverse.adjoint(); // wide × n
    let m1 = Split::new(&(&right * &u)); // wide × rows
    let m2 = Split::new(&(&right * right.adjoint())); // wide × wide
    let m3 = u.adjoint() * &u; // [l', l]
    for l in 0..rows {
        let (start, len) = e.row(l);
        let (bre, bim) = m1.column(l);
        for k in l..rows {
            let (start_k, len_k) = e.row(k);
            let (are, aim) = m1.column(k);
            let two: C64 = m3[(k, l)] * 2.0;
            for r in 0..len {
                let row = &mut sum[(start + r) * p + start_k..(start + r) * p + start_k + len_k];
                // Re(M1[r,k] M1[r',l] + M2[r,r'] M3[k,l]); M2 is Hermitian: column r holds conj of row r
                let (cre, cim) = m2.column(r);
                let (ar, ai) = (2.0 * are[r], 2.0 * aim[r]);
                let first = row.iter_mut().zip(bre).zip(bim);
                for (((s, br), bi), (cr, ci)) in first.zip(cre.iter().zip(cim)) {
                    *s += ar * br - ai * bi + cr * two.re + ci * two.im;
                }
            }
        }
    }
    // road and noise: dense derivatives
    let through = |sr: &CMat| inverse * (g.h.conjugate() * (sr * g.h.transpose())) * inverse.adjoint();
    let level = through(&g.road.s);
    let mut dense = vec![
        level.clone(),
        CMat::from_fn(n, n, |i, j| level[(i, j)] * -g.road.ln_nu),
        through(&g.road.by_mu),
        through(&g.road.by_delay),
    ];
    for c in 0..n {
        let floor = at.ln_noise[c].exp();
        dense.push(CMat::from_fn(n, n, |i, j| inverse[(i, c)] * inverse[(j, c)].conj() * floor));
    }
    let tail = e.len();
    for (m, v) in dense.iter().enumerate() {
        let cross = &right * (v * &u); // wide × rows
        for l in 0..rows {
            let (start, len) = e.row(l);
            for r in 0..len {
                let c: C64 = cross[(r, l)];
                sum[(start + r) * p + tail + m] += 2.0 * c.re;
            }
        }
        for (k, w) in dense.iter().enumerate().skip(m) {
            let mut trace = 0.0;
            for i in 0..n {
                for j in 0..n {
                    let t: C64 = v[(i, j)] * w[(j, i)];
                    trace += t.re;
                }
            }
            sum[(tail + m) * p + tail + k] += trace;
        }
    }
}

/// Slopes of one residual by some parameters.
type Slope = Vec<(usize, f64)>;

/// The misfit of H(0) over the planes 1, y, x of the road at the sensors, in standard deviations, and its slopes.
///
/// A vehicle follows the road statically: H(0)·(plane at the wheels) = (plane at the sensors), whatever its springs.
pub(super) fn plane(model: &FreeModel, at: &Point) -> Option<(Vec<f64>, Vec<Slope>)> {
    let e = Entries::of(&at.system);
    let (n, states) = (e.outputs, e.states);
    let negative = Mat::from_fn(states, states, |i, j| -at.system.a[(i, j)]);
    let x0 = crate::linalg::solve(&negative, &at.system.b).ok()?;
    let y0 =
        crate::linalg::solve(&negative.transpose().to_owned(), &at.system.c.transpose().to_owned()).ok()?;
    let (mut residuals, mut slopes) = (Vec::new(), Vec::new());
    for plane in 0..3 {
        let height = |w: usize| [1.0, model.at_m[w][1], model.at_m[w][0]][plane];
        let heights: Vec<f64> = (0..e.inputs).map(height).collect();
        // of the largest height, so that a plane of 1 m and one of 1 rad weigh alike; a plane that no wheel shows is none
        let middle = heights.iter().sum::<f64>() / heights.len() as f64;
        let size =
            if plane == 0 { 1.0 } else { heights.iter().map(|h| (h - middle).abs()).fold(0.0, f64::max) };
        if size < 1e-6 {
            continue;
        }
        let xp: Vec<f64> =
            (0..states).map(|i| heights.iter().enumerate().map(|(w, h)| x0[(i, w)] * h).sum()).collect();
        for c in 0..n {
            let unit = 1.0 / (size * PLANE_SD);
            let got: f64 = (0..states).map(|i| at.system.c[(c, i)] * xp[i]).sum();
            residuals.push((got - model.planes[c][plane]) * unit);
            let mut slope = Slope::new();
            for i in 0..states {
                for j in 0..states {
                    slope.push((e.at(i, j), unit * y0[(i, c)] * xp[j]));
                }
                for (w, h) in heights.iter().enumerate() {
                    slope.push((e.at(i, states + w), unit * y0[(i, c)] * h));
                }
                slope.push((e.at(states + c, i), unit * xp[i]));
            }
            slopes.push(slope);
        }
    }
    Some((residuals, slopes))
}
