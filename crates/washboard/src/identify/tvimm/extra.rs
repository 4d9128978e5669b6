//! One mode more: where the residual asks for it most, as a start for a fit of higher order.

use super::model::{FreeModel, Point, RATE};
use super::search::Found;
use crate::identify::likelihood::{Place, Whitening};
use crate::linalg::{C64, CMat, Mat};
use crate::lti::FirstOrder;
use crate::units::rad_per_s;
use rayon::prelude::*;

/// Frequencies looked at, a factor of this apart, and damping ratios at each.
const RATIO: f64 = 1.04;
const DAMPINGS: [f64; 4] = [0.03, 0.08, 0.2, 0.4];

/// A candidate.
pub(super) struct Candidate {
    /// What the cost may fall by.
    pub gain: f64,
    /// The system with the mode.
    pub system: FirstOrder,
}

/// The mode c bᵀ/(s − λ) + its conjugate whose addition lowers the cost most, by its slope and information.
///
/// The cost's slope along dH = R/(s − λ) + R*/(s − λ*) is 2 Re tr(R(M + M'*)), M = Σ_grid QW/(s − λ),
/// M' = Σ_grid QW/(s − λ*): steepest for the leading singular vectors of M + M'*. The step is the slope over the
/// information along it, and the gain half their product.
pub(super) fn candidate(model: &FreeModel, found: &Found, band_hz: [f64; 2]) -> Option<Candidate> {
    let evaluation = &found.frame.evaluation;
    let averages = model.data.averages;
    let shape = evaluation.grid.shape;
    let whitening = Whitening::new(&evaluation.s)?;
    let (_, pulls) = whitening.pulls(&model.data.measured, averages);
    // (s, QW) of each point of the grid
    let slopes: Vec<(C64, CMat)> = evaluation
        .grid
        .pulled(&model.data, &pulls, Vec::new, |slopes, place, pulled| {
            let n = shape.channels;
            let qw = CMat::from_fn(shape.wheels, n, |i, j| pulled.q[i * n + j] * place.weight[j]);
            slopes.push((C64::new(0.0, place.omega / RATE), qw));
        })
        .into_iter()
        .flatten()
        .collect();
    let mut places = Vec::new();
    let mut f = band_hz[0];
    while f <= band_hz[1] {
        places.extend(DAMPINGS.map(|zeta| (f, zeta)));
        f *= RATIO;
    }
    let matrix =
        |v: &[C64], rows: usize, columns: usize| CMat::from_fn(rows, columns, |i, j| v[i * columns + j]);
    // the middle, L⁻¹ and P of each bin
    let bins: Vec<(Place<'_>, CMat, CMat)> = (0..model.data.measured.len())
        .filter_map(|bin| {
            let (g, n) = (evaluation.grid.at(model.data.middle(bin))?, shape.channels);
            Some((g, matrix(whitening.inverse(bin), n, n), matrix(g.p, shape.wheels, n)))
        })
        .collect();
    let tried: Vec<Option<Candidate>> = places
        .into_par_iter()
        .map(|(freq_hz, zeta)| {
            let lambda = C64::new(-zeta, (1.0f64 - zeta * zeta).sqrt()) * (rad_per_s(freq_hz) / RATE);
            let (wheels, channels) = (model.at_m.len(), model.derivatives.len());
            let mut m = CMat::zeros(wheels, channels);
            for (s, qw) in &slopes {
                let (near, far) = ((s - lambda).inv(), (s - lambda.conj()).inv());
                for j in 0..channels {
                    for i in 0..wheels {
                        let q: C64 = qw[(i, j)];
                        m[(i, j)] += q * near + (q * far).conj();
                    }
                }
            }
            let svd = m.svd().ok()?;
            let sigma: C64 = svd.S().column_vector()[0];
            // tr(R M) is −σ for R = −v uᴴ: c = −v (channels), bᵀ = uᴴ (wheels)
            let c: Vec<C64> = (0..channels).map(|i| -svd.V()[(i, 0)]).collect();
            let b: Vec<C64> = (0..wheels).map(|i| svd.U()[(i, 0)].conj()).collect();
            let slope = -2.0 * sigma.re;
            let mut information = 0.0;
            for (g, l, p) in &bins {
                let s = C64::new(0.0, g.omega / RATE);
                let (near, far) = ((s - lambda).inv(), (s - lambda.conj()).inv());
                let dh = CMat::from_fn(channels, wheels, |i, j| {
                    let r = c[i] * b[j];
                    g.weight[i] * (r * near + r.conj() * far)
                });
                let half = dh.conjugate() * p;
                let ds = CMat::from_fn(channels, channels, |i, j| half[(i, j)] + half[(j, i)].conj());
                let v = l * ds * l.adjoint();
                information += averages * v.squared_norm_l2();
            }
            let step = -slope / information;
            let gain = 0.5 * step * -slope;
            let system = with_mode(&found.at, lambda, &c, &b, step);
            gain.is_finite().then_some(Candidate { gain, system })
        })
        .collect();
    tried.into_iter().flatten().max_by(|a, b| a.gain.total_cmp(&b.gain))
}

/// The system with two states more: x' = λx + √t b u, y += 2 Re(√t c x).
fn with_mode(at: &Point, lambda: C64, c: &[C64], b: &[C64], step: f64) -> FirstOrder {
    let (old, n) = (&at.system, at.system.order());
    let t = step.abs().sqrt();
    let sign = step.signum();
    FirstOrder {
        a: Mat::from_fn(n + 2, n + 2, |i, j| match (i < n, j < n) {
            (true, true) => old.a[(i, j)],
            (false, false) => [[lambda.re, -lambda.im], [lambda.im, lambda.re]][i - n][j - n],
            _ => 0.0,
        }),
        b: Mat::from_fn(
            n + 2,
            b.len(),
            |i, j| {
                if i < n { old.b[(i, j)] } else { t * [b[j].re, b[j].im][i - n] }
            },
        ),
        c: Mat::from_fn(c.len(), n + 2, |i, j| {
            if j < n { old.c[(i, j)] } else { 2.0 * sign * t * [c[i].re, -c[i].im][j - n] }
        }),
    }
}
