//! Minimising the cost: Levenberg–Marquardt on the Fisher information, from loud noise to the real one.

use super::data::BandData;
use super::model::{Evaluation, LEAST_NOISE, Layout, Model};
use super::whittle::{Score, cost, score};
use crate::linalg::Mat;
use faer::linalg::solvers::Solve;

/// Noise is raised by these factors, one after another: a loud floor has a wide basin.
const ANNEALING: [f64; 3] = [1000.0, 30.0, 1.0];
/// While noise is raised, e stays within this of 2 and ln μ within that of its start.
const HELD_EXPONENT: f64 = 0.2;
const HELD_LN_MU: f64 = 0.25;
/// Longest steps of e and ln μ, of ln noise, of the logarithms of the vehicle's parameters and S₀.
const STEP_ROAD: f64 = 0.4;
const STEP_NOISE: f64 = 1.5;
const STEP_VEHICLE: f64 = 0.7;
/// e is refused outside.
const EXPONENTS: [f64; 2] = [0.3, 4.0];
/// ln μ is refused outside.
const LN_MU: [f64; 2] = [-4.6, 4.6];
/// ln of the delay's factor: the speed is not 20 % off.
const LN_DELAY: f64 = 0.2;
/// Converged: a step gains less than this, and the Newton decrement is below that.
const GAIN: f64 = 1e-3;
const DECREMENT: f64 = 0.01;
/// Steps at each noise level.
const MAX_STEPS: [usize; 3] = [40, 40, 120];

/// Where the search ended.
pub(super) struct Search {
    pub theta: Vec<f64>,
    pub score: Score,
    pub decrement: f64,
    pub converged: bool,
    /// Parameters that stand at their limit.
    pub at_limit: Vec<usize>,
    pub steps: usize,
    pub evaluations: usize,
}

pub(super) fn search(model: &Model<'_>, start: &[f64]) -> Result<Search, String> {
    let layout = &model.layout;
    let mut theta = start.to_vec();
    let mut evaluations = 0;
    let mut steps = 0;
    let mut last = None;
    for (stage, kappa) in ANNEALING.into_iter().enumerate() {
        let added: Vec<f64> = model.data.noise.iter().map(|n| (kappa - 1.0) * n).collect();
        // ln of (κ noise) at the start of a stage: what the real floor is found to be, and what was added
        for (c, t) in theta[layout.noise..].iter_mut().enumerate() {
            *t = (kappa * model.data.noise[c]).max(LEAST_NOISE).ln();
        }
        let limits = limits(model, start, kappa > 1.0);
        let end = descend(model, &theta, &added, &limits, MAX_STEPS[stage], kappa > 1.0)?;
        evaluations += end.evaluations;
        steps += end.steps;
        theta.clone_from(&end.theta);
        last = Some(end);
    }
    let mut end = last.ok_or("no stage")?;
    end.evaluations = evaluations;
    end.steps = steps;
    Ok(end)
}

fn limits(model: &Model<'_>, start: &[f64], held: bool) -> Vec<[f64; 2]> {
    let (layout, vehicle) = (&model.layout, model.vehicle.limits());
    (0..layout.len())
        .map(|i| {
            if i < layout.vehicle {
                vehicle[i].map(f64::ln)
            } else if i == layout.s0() {
                [start[i] - 8.0, start[i] + 8.0]
            } else if i == layout.exponent() {
                if held { [2.0 - HELD_EXPONENT, 2.0 + HELD_EXPONENT] } else { EXPONENTS }
            } else if Some(i) == layout.mu {
                if held { [start[i] - HELD_LN_MU, start[i] + HELD_LN_MU] } else { LN_MU }
            } else if Some(i) == layout.delay {
                [-LN_DELAY, LN_DELAY]
            } else {
                [LEAST_NOISE.ln(), 1e6f64.ln()]
            }
        })
        .collect()
}

fn descend(
    model: &Model<'_>,
    start: &[f64],
    added: &[f64],
    limits: &[[f64; 2]],
    max_steps: usize,
    rough: bool,
) -> Result<Search, String> {
    let (layout, data) = (&model.layout, model.data);
    let mut theta: Vec<f64> = start.iter().zip(limits).map(|(t, l)| t.clamp(l[0], l[1])).collect();
    let mut evaluations = 1;
    let at = |theta: &[f64]| -> Result<Option<Score>, String> {
        let e: Evaluation = model.evaluate(theta, true)?;
        Ok(score(&e, data, layout, theta, added))
    };
    let mut here = at(&theta)?.ok_or("the model's spectrum is not positive definite at the start")?;
    let mut damping = 1e-3;
    let mut converged = false;
    let mut decrement = f64::INFINITY;
    let mut steps = 0;
    while steps < max_steps {
        steps += 1;
        let free = free_parameters(&theta, &here, limits);
        decrement = newton(&here, &free, 0.0).map_or(f64::INFINITY, |s| -dot(&s, &here.gradient));
        let mut gained = None;
        for _ in 0..12 {
            let Some(mut step) = newton(&here, &free, damping) else {
                damping *= 6.0;
                continue;
            };
            clip(layout, &mut step);
            let trial: Vec<f64> =
                theta.iter().zip(&step).zip(limits).map(|((t, s), l)| (t + s).clamp(l[0], l[1])).collect();
            evaluations += 1;
            let value = match model.evaluate(&trial, false) {
                Ok(e) => cost(&e, data, added),
                Err(_) => None,
            };
            match value {
                Some(c) if c < here.cost => {
                    gained = Some((trial, here.cost - c));
                    damping = (damping / 5.0).max(1e-12);
                    break;
                }
                _ => damping *= 6.0,
            }
        }
        let Some((trial, gain)) = gained else {
            // no step gains: the minimum to rounding, where the decrement agrees
            converged = decrement < 1.0;
            break;
        };
        theta = trial;
        evaluations += 1;
        here = at(&theta)?.ok_or("the model's spectrum lost its definiteness")?;
        let done = if rough { gain < 0.1 && decrement < 1.0 } else { gain < GAIN && decrement < DECREMENT };
        if done {
            converged = true;
            break;
        }
    }
    let at_limit = (0..theta.len())
        .filter(|i| *i < layout.noise && (theta[*i] <= limits[*i][0] || theta[*i] >= limits[*i][1]))
        .collect();
    Ok(Search { theta, score: here, decrement, converged, at_limit, steps, evaluations })
}

/// Parameters that do not stand at a limit with the cost falling outwards.
fn free_parameters(theta: &[f64], here: &Score, limits: &[[f64; 2]]) -> Vec<usize> {
    (0..theta.len())
        .filter(|i| {
            let (low, high) = (theta[*i] <= limits[*i][0], theta[*i] >= limits[*i][1]);
            !(low && here.gradient[*i] > 0.0 || high && here.gradient[*i] < 0.0)
        })
        .collect()
}

/// −(F + λ diag F)⁻¹ g over the free parameters, Jacobi-scaled; None where that is not positive definite.
fn newton(here: &Score, free: &[usize], damping: f64) -> Option<Vec<f64>> {
    let d: Vec<f64> = free.iter().map(|i| here.fisher[(*i, *i)].max(f64::MIN_POSITIVE).sqrt()).collect();
    let n = free.len();
    let a = Mat::from_fn(n, n, |i, j| {
        here.fisher[(free[i], free[j])] / (d[i] * d[j]) + if i == j { damping } else { 0.0 }
    });
    let b = Mat::from_fn(n, 1, |i, _| -here.gradient[free[i]] / d[i]);
    let x = a.llt(faer::Side::Lower).ok()?.solve(&b);
    let mut step = vec![0.0; here.gradient.len()];
    for (k, i) in free.iter().enumerate() {
        step[*i] = x[(k, 0)] / d[k];
    }
    step.iter().all(|s| s.is_finite()).then_some(step)
}

fn clip(layout: &Layout, step: &mut [f64]) {
    for (i, s) in step.iter_mut().enumerate() {
        let limit = if i >= layout.noise {
            STEP_NOISE
        } else if i == layout.exponent() || Some(i) == layout.mu {
            STEP_ROAD
        } else {
            STEP_VEHICLE
        };
        *s = s.clamp(-limit, limit);
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Starting S₀: the level at which the model's spectra are the measured ones, in the median over bins and channels.
pub(super) fn level(model: &Model<'_>, theta: &[f64], data: &BandData) -> Result<f64, String> {
    let mut quiet = theta.to_vec();
    quiet[model.layout.noise..].iter_mut().for_each(|t| *t = f64::MIN_POSITIVE.ln());
    let e = model.evaluate(&quiet, false)?;
    let mut ratios: Vec<f64> = Vec::new();
    for (s, m) in e.s.iter().zip(&data.measured) {
        ratios.extend((0..s.nrows()).map(|i| (m[(i, i)].re / s[(i, i)].re).ln()));
    }
    ratios.sort_by(f64::total_cmp);
    Ok(ratios.get(ratios.len() / 2).copied().unwrap_or(0.0))
}
