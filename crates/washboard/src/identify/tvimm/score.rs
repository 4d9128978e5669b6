//! Cost, gradient and Fisher information of free modes, by the structure of the response's derivatives.

use super::information::information;
use super::model::{Evaluation, FreeModel, Point};
use super::orbit::Entries;
use crate::identify::likelihood::{SPEED_SD, Spectra, Whitening};
use crate::linalg::Mat;

/// The static gain over a road's plane is the plane at the sensors to this.
pub(super) const PLANE_SD: f64 = 0.01;

/// Cost, gradient and information over the entries of [A B; C 0], ln S₀, e, ln μ, ln delay, ln noise.
pub(super) struct Full {
    pub cost: f64,
    pub gradient: Vec<f64>,
    pub fisher: Mat,
}

/// n_avg Σ (ln|S| + tr S⁻¹Ŝ) and half the squares of what is known beforehand.
pub(super) fn cost(model: &FreeModel, s: &Spectra, measured: &Spectra, at: &Point) -> Option<f64> {
    let fit = crate::identify::likelihood::cost(s, measured, model.data.averages)?;
    let (residual, ..) = known(model, at)?;
    Some(fit + 0.5 * residual.iter().map(|r| r * r).sum::<f64>())
}

/// All that scoring needs.
///
/// The gradient is exact: the pull n_avg S⁻¹(S − Ŝ)S⁻¹ on each bin goes back through the window to the grid and there to
/// the entries. The information takes each bin's derivative as at its middle (the window moves it by a few per cent at
/// most).
pub(super) fn full(
    model: &FreeModel,
    evaluation: &Evaluation,
    measured: &Spectra,
    at: &Point,
) -> Option<Full> {
    let whitening = Whitening::new(&evaluation.s)?;
    let (mut total, pulls) = whitening.pulls(measured, model.data.averages);
    let mut gradient = model.pull(evaluation, at, &pulls);
    let mut fisher = information(model, evaluation, &whitening, at);
    let (residual, slopes) = known(model, at)?;
    total += 0.5 * residual.iter().map(|r| r * r).sum::<f64>();
    for (r, slope) in residual.iter().zip(&slopes) {
        for (a, va) in slope {
            gradient[*a] += r * va;
            for (b, vb) in slope {
                fisher[(*a, *b)] += va * vb;
            }
        }
    }
    total.is_finite().then_some(Full { cost: total, gradient, fisher })
}

/// Slopes of one residual by some parameters.
type Slope = Vec<(usize, f64)>;

/// What is known before any data, in standard deviations, and its slopes: the static plane, and the delay of the rear
/// wheels, which is wheelbase over speed as well as these were stated. Data with sensors on all wheels know the delay to
/// 10⁻⁴; with few sensors it is free to bend other modes and μ by as much as it may move.
pub(super) fn known(model: &FreeModel, at: &Point) -> Option<(Vec<f64>, Vec<Slope>)> {
    let (mut residuals, mut slopes) = plane(model, at)?;
    residuals.push(at.road.ln_delay / SPEED_SD);
    slopes.push(vec![(Entries::of(&at.system).len() + 3, 1.0 / SPEED_SD)]);
    Some((residuals, slopes))
}

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
