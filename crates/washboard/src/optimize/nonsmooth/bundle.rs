//! A goal under bounds, both the largest of smooth pieces: steps of a quadratic program over all pieces that matter, with
//! an exact penalty, a BFGS matrix of the Lagrangian, and pieces learnt where a step failed.

use super::pieces::{Levels, Pieces, SmoothPiece};
use super::steps::{Advance, State};

/// Steps over which the merit has to fall by more than the tolerance.
const PATIENCE: usize = 30;
/// This many times.
const SLOW: f64 = 30.0;

/// When to stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BundleSettings {
    /// Steps at most.
    pub iterations: usize,
    /// Evaluations at most.
    pub evaluations: usize,
    /// A decrease smaller than this, that the model says, is none.
    pub tolerance: f64,
    /// The first penalty.
    pub penalty: f64,
    /// The longest step, as a share of 1 + ‖x‖.
    pub longest: f64,
}

impl Default for BundleSettings {
    fn default() -> Self {
        BundleSettings { iterations: 300, evaluations: 1500, tolerance: 1e-8, penalty: 4.0, longest: 1.0 }
    }
}

/// How it ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BundleEnd {
    /// No model says that anything more is to be gained.
    Converged,
    /// Steps of rounding's size gain nothing.
    NoStep,
    /// All steps or evaluations are made.
    Budget,
}

/// The lowest point.
#[derive(Debug, Clone)]
pub struct BundleResult<I> {
    /// Where.
    pub x: Vec<f64>,
    /// The goal there.
    pub goal: f64,
    /// max(0, c) there.
    pub violation: f64,
    /// The pieces there that hold it, with their weights.
    pub active: Vec<(SmoothPiece<I>, f64)>,
    /// The penalty at the end.
    pub penalty: f64,
    /// Steps.
    pub iterations: usize,
    /// Points at which the pieces were asked for.
    pub evaluations: usize,
    /// Why it ended.
    pub end: BundleEnd,
}

/// Minimises the goal under the bounds from x, down a merit f + ρ (max(0, c) + 100 max(0, e)), e the edges', that every step lowers by a share of what the
/// model says: where no more is to be gained and the bounds are met, x is stationary.
///
/// A model holds every piece near the largest at x, and pieces that were the largest where a step failed (their values
/// and gradients taken at x: lower bounds that are exact there). ρ grows while bounds are exceeded and the model would
/// exceed them to gain. None where the functions are not defined at x.
///
/// Source: Fletcher, *Practical Methods of Optimization*, 2nd ed., ch. 14 (penalty, steps); Apkarian and Noll, IEEE Trans.
/// Automat. Control 51 (2006) 71–86 (bundles over frequencies); Nocedal and Wright, procedure 18.2 (damping).
pub fn minimize<P: Pieces>(problem: &P, x: &[f64], settings: &BundleSettings) -> Option<BundleResult<P::Id>> {
    let pieces = problem.pieces(x)?;
    let mut state = State::at(problem, x, pieces, settings);
    let (mut end, mut iterations, mut confirmed) = (BundleEnd::Budget, 0, 0);
    let mut last = None;
    // goal and violation: the penalty of then is not that of now
    let (mut history, mut slow) = (vec![Levels::of(&state.pieces)], 0);
    while iterations < settings.iterations && state.evaluations < settings.evaluations {
        iterations += 1;
        match state.advance() {
            Advance::Moved => {
                last = None;
                let now = Levels::of(&state.pieces);
                let gained = |before: Levels| before.merit(state.penalty) - now.merit(state.penalty);
                if history.last().is_some_and(|before| gained(*before) > settings.tolerance) {
                    confirmed = 0;
                }
                history.push(now);
                let before = history.len().checked_sub(PATIENCE).map(|k| gained(history[k]));
                match before {
                    Some(gained) if gained < SLOW * settings.tolerance => {
                        slow += 1;
                        if slow == 2 {
                            end = BundleEnd::NoStep;
                            break;
                        }
                        history = vec![now];
                        state.forget_curvature();
                    }
                    Some(_) => slow = 0,
                    None => {}
                }
            }
            Advance::Flat(weights) => {
                last = Some(weights);
                confirmed += 1;
                if confirmed == 2 {
                    end = BundleEnd::Converged;
                    break;
                }
                state.forget_curvature();
            }
            Advance::Stuck => {
                confirmed += 1;
                if confirmed == 2 {
                    end = BundleEnd::NoStep;
                    break;
                }
                state.forget_curvature();
            }
        }
    }
    let levels = Levels::of(&state.pieces);
    let active = match last {
        Some(active) => active,
        None => state.weighted(),
    };
    Some(BundleResult {
        goal: levels.goal,
        violation: levels.bound.max(levels.edge),
        active,
        penalty: state.penalty,
        iterations,
        evaluations: state.evaluations,
        end,
        x: state.x,
    })
}
