//! Minimising a cost by Levenberg–Marquardt on its Fisher information, over points that may live on a manifold.

use super::Score;
use crate::linalg::Mat;
use faer::linalg::solvers::Solve;

/// Damping's first value and smallest one, and how it moves.
const DAMPING: [f64; 2] = [1e-3, 1e-12];
const EASIER: f64 = 5.0;
const HARDER: f64 = 6.0;
/// Steps bend with the model where the Newton decrement is below this: further off, curvature there says little.
const BENT: f64 = 300.0;
/// A second-order step is taken up to this share of the first.
const LARGEST_BEND: f64 = 0.75;
/// Dampings tried for one step.
const MOST_TRIALS: usize = 12;

/// What is minimised. A step is a vector in local coordinates about a point.
pub(crate) trait Problem {
    /// Where a search stands.
    type Point: Clone;
    /// The local coordinates at a point.
    type Frame;
    /// Cost, gradient and information in local coordinates; None where the model has no likelihood.
    fn look(&self, at: &Self::Point) -> Option<(Score, Self::Frame)>;
    /// The cost alone.
    fn cost(&self, at: &Self::Point) -> Option<f64>;
    /// Coordinates that may move: those that do not press against a limit.
    fn free(&self, at: &Self::Point, score: &Score) -> Vec<usize>;
    /// What Levenberg and Marquardt's damping multiplies; the information's diagonal where None.
    fn metric(&self, _score: &Score, _frame: &Self::Frame) -> Option<Mat> {
        None
    }
    /// n_avg Σ tr(S⁻¹ S″ S⁻¹ ∂_aS), with S″ the model's second derivative along a step: what the step bends away from its
    /// tangent. None where that is not asked for.
    fn bend(&self, _at: &Self::Point, _frame: &Self::Frame, _step: &[f64]) -> Option<Vec<f64>> {
        None
    }
    /// Shortens what is too long.
    fn clip(&self, step: &mut [f64], frame: &Self::Frame);
    /// The point a step away.
    fn moved(&self, at: &Self::Point, frame: &Self::Frame, step: &[f64]) -> Self::Point;
}

/// When a search ends.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stop {
    pub max_steps: usize,
    /// Converged: a step gains less than this, and the Newton decrement is below that.
    pub gain: f64,
    pub decrement: f64,
}

/// Where a search ended.
pub(crate) struct End<P: Problem> {
    pub at: P::Point,
    pub score: Score,
    pub frame: P::Frame,
    /// gᵀF⁻¹g over the free coordinates.
    pub decrement: f64,
    pub converged: bool,
    pub steps: usize,
    pub evaluations: usize,
}

/// Descends from a start; None where the start has no likelihood.
pub(crate) fn descend<P: Problem>(problem: &P, start: P::Point, stop: Stop) -> Option<End<P>> {
    let (mut score, mut frame) = problem.look(&start)?;
    let mut at = start;
    let (mut evaluations, mut steps) = (1, 0);
    let mut damping = DAMPING[0];
    let mut decrement = f64::INFINITY;
    let mut converged = false;
    while steps < stop.max_steps {
        steps += 1;
        let free = problem.free(&at, &score);
        let metric = problem.metric(&score, &frame);
        let solver = |damping: f64| newton(&score.fisher, &score.gradient, &free, damping, &metric);
        decrement = solver(0.0).map_or(f64::INFINITY, |s| -dot(&s, &score.gradient));
        let mut gained = None;
        for _ in 0..MOST_TRIALS {
            let Some(mut step) = solver(damping) else {
                damping *= HARDER;
                continue;
            };
            problem.clip(&mut step, &frame);
            if decrement < BENT
                && let Some(bend) = problem.bend(&at, &frame, &step)
            {
                evaluations += 2;
                let second = newton(&score.fisher, &bend, &free, damping, &metric);
                accelerate(&mut step, second, &score.fisher);
            }
            let trial = problem.moved(&at, &frame, &step);
            evaluations += 1;
            match problem.cost(&trial) {
                Some(c) if c < score.cost => {
                    gained = Some((trial, score.cost - c));
                    damping = (damping / EASIER).max(DAMPING[1]);
                    break;
                }
                _ => damping *= HARDER,
            }
        }
        let Some((trial, gain)) = gained else {
            // no step gains: the minimum to rounding, where the decrement agrees
            converged = decrement < 1.0;
            break;
        };
        evaluations += 1;
        let Some((s, f)) = problem.look(&trial) else { break };
        (at, score, frame) = (trial, s, f);
        if gain < stop.gain && decrement < stop.decrement {
            converged = true;
            break;
        }
    }
    Some(End { at, score, frame, decrement, converged, steps, evaluations })
}

/// Adds half of a second-order step where it is the smaller one (Transtrum, Sethna, *Improvements to the
/// Levenberg–Marquardt algorithm*, arXiv:1201.5885: 2|a|/|v| below .75), in the information's diagonal.
fn accelerate(step: &mut [f64], second: Option<Vec<f64>>, fisher: &Mat) {
    let Some(second) = second else { return };
    let size = |v: &[f64]| v.iter().enumerate().map(|(i, v)| fisher[(i, i)] * v * v).sum::<f64>().sqrt();
    if 2.0 * size(&second) <= LARGEST_BEND * size(step) {
        step.iter_mut().zip(&second).for_each(|(s, a)| *s += 0.5 * a);
    }
}

/// −(F + λD)⁻¹ g over the free coordinates, Jacobi-scaled; None where that is not positive definite.
pub(crate) fn newton(
    fisher: &Mat,
    gradient: &[f64],
    free: &[usize],
    damping: f64,
    metric: &Option<Mat>,
) -> Option<Vec<f64>> {
    let d: Vec<f64> = free.iter().map(|i| fisher[(*i, *i)].max(f64::MIN_POSITIVE).sqrt()).collect();
    let n = free.len();
    let damped = |i: usize, j: usize| match metric {
        Some(m) => damping * m[(free[i], free[j])] / (d[i] * d[j]),
        None if i == j => damping,
        None => 0.0,
    };
    let a = Mat::from_fn(n, n, |i, j| fisher[(free[i], free[j])] / (d[i] * d[j]) + damped(i, j));
    let b = Mat::from_fn(n, 1, |i, _| -gradient[free[i]] / d[i]);
    let x = a.llt(faer::Side::Lower).ok()?.solve(&b);
    let mut step = vec![0.0; gradient.len()];
    for (k, i) in free.iter().enumerate() {
        step[*i] = x[(k, 0)] / d[k];
    }
    step.iter().all(|s| s.is_finite()).then_some(step)
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}
