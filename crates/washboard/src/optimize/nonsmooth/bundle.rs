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
    let mut descent = Descent::from(problem, x, settings)?;
    descent.to(settings.iterations);
    Some(descent.result())
}

/// The way down of [`minimize`], which can be stopped and gone on with: nothing is forgotten between.
pub struct Descent<'a, P: Pieces> {
    state: State<'a, P>,
    settings: BundleSettings,
    iterations: usize,
    end: Option<BundleEnd>,
    /// Steps in a row that said that nothing is to be gained.
    confirmed: usize,
    /// What the last of them said holds x.
    last: Option<Vec<(SmoothPiece<P::Id>, f64)>>,
    /// Levels and not merits: the penalty of then is not that of now.
    history: Vec<Levels>,
    slow: usize,
}

impl<'a, P: Pieces> Descent<'a, P> {
    /// At x, no step made; none where the functions are not defined there.
    pub fn from(problem: &'a P, x: &[f64], settings: &BundleSettings) -> Option<Self> {
        let state = State::at(problem, x, problem.pieces(x)?, *settings);
        Some(Descent {
            history: vec![Levels::of(&state.pieces)],
            state,
            settings: *settings,
            iterations: 0,
            end: None,
            confirmed: 0,
            last: None,
            slow: 0,
        })
    }

    /// The goal and how far the bounds are exceeded, where it stands.
    pub fn stands(&self) -> (f64, f64) {
        let levels = Levels::of(&self.state.pieces);
        (levels.goal, levels.bound.max(levels.edge))
    }

    /// On, until so many steps are made in all or there is nothing more to gain.
    pub fn to(&mut self, iterations: usize) {
        let most = iterations.min(self.settings.iterations);
        while self.end.is_none()
            && self.iterations < most
            && self.state.evaluations < self.settings.evaluations
        {
            self.iterations += 1;
            match self.state.advance() {
                Advance::Moved => self.moved(),
                Advance::Flat(weights) => {
                    self.last = Some(weights);
                    self.nothing(BundleEnd::Converged);
                }
                Advance::Stuck => self.nothing(BundleEnd::NoStep),
            }
        }
    }

    /// After a step: whether the last many of them gained anything.
    fn moved(&mut self) {
        self.last = None;
        let now = Levels::of(&self.state.pieces);
        let penalty = self.state.penalty;
        let gained = |before: &Levels| before.merit(penalty) - now.merit(penalty);
        if self.history.last().is_some_and(|before| gained(before) > self.settings.tolerance) {
            self.confirmed = 0;
        }
        self.history.push(now);
        let before = self.history.len().checked_sub(PATIENCE).map(|k| gained(&self.history[k]));
        match before {
            Some(gained) if gained < SLOW * self.settings.tolerance => {
                self.slow += 1;
                if self.slow == 2 {
                    self.end = Some(BundleEnd::NoStep);
                    return;
                }
                self.history = vec![now];
                self.state.begin_anew();
            }
            Some(_) => self.slow = 0,
            None => {}
        }
    }

    /// Nothing to gain; said twice, the second time with all curvature forgotten, it is the end.
    fn nothing(&mut self, end: BundleEnd) {
        self.confirmed += 1;
        if self.confirmed == 2 {
            self.end = Some(end);
        } else {
            self.state.begin_anew();
        }
    }

    /// Where it stands, with what holds it.
    pub fn result(mut self) -> BundleResult<P::Id> {
        let (goal, violation) = self.stands();
        let active = match self.last.take() {
            Some(active) => active,
            None => self.state.weighted(),
        };
        BundleResult {
            goal,
            violation,
            active,
            penalty: self.state.penalty,
            iterations: self.iterations,
            evaluations: self.state.evaluations,
            end: self.end.unwrap_or(BundleEnd::Budget),
            x: self.state.x,
        }
    }
}
