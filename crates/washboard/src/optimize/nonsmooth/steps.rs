//! A step of the bundle method: models, tries, pieces learnt where one failed, curvature along what was gone.

use super::bfgs::identity;
use super::bundle::BundleSettings;
use super::model::{Step, step};
use super::pieces::{EDGE, Levels, Pieces, Role, SmoothPiece, merit};
use super::simplex::dot;
use learnt::Learnt;

mod curvature;
mod learnt;

/// The merit must lose this share of what the model says.
const ENOUGH: f64 = 1e-4;
/// A step that would lose more than this share is made longer.
const LONGER: f64 = 0.7;
/// Touching planes in a model at most.
const MOST_CUTS: usize = 8;
/// A plane from a failed step is this share of the promised decrease below the functions at x.
const DOWNSHIFT: f64 = 0.02;
/// The penalty grows by this while bounds are exceeded, to at most the next.
const STIFFER: f64 = 4.0;
const STIFFEST: f64 = 1e7;
/// A search that begins anew has a penalty of so many times what its bounds weigh.
const SPARE: f64 = 4.0;
/// A step must lower the bounds' excess by this share of what they could lower it to without the goal.
const STEERED: f64 = 0.1;
/// The bounds' excess that does not matter.
const MET: f64 = 1e-9;
/// After a failed step the model's matrix counts by this share.
const SHORTER: f64 = 0.5;
/// Failed steps in a row, at most.
const MOST_TRIES: usize = 30;

/// How a step ended.
pub(super) enum Advance<I> {
    Moved,
    /// The model says that there is nothing to gain: the pieces that hold, with their weights.
    Flat(Vec<(SmoothPiece<I>, f64)>),
    Stuck,
}

/// Where the search is, and what it knows.
pub(super) struct State<'a, P: Pieces> {
    problem: &'a P,
    settings: BundleSettings,
    /// The inverse matrix; empty where nothing is known.
    w: Vec<f64>,
    fresh: bool,
    learnt: Vec<Learnt<P::Id>>,
    /// The first so many of the learnt pieces at x.
    recalled: Vec<SmoothPiece<P::Id>>,
    recalled_of: usize,
    pub penalty: f64,
    /// What the bounds weigh in the last model: all of the penalty that was needed there.
    used: f64,
    radius: f64,
    /// The share of the matrix that the model uses: less after failures.
    trust: f64,
    pub evaluations: usize,
    pub x: Vec<f64>,
    pub pieces: Vec<SmoothPiece<P::Id>>,
}

impl<'a, P: Pieces> State<'a, P> {
    /// At x, with its pieces, nothing known.
    pub fn at(problem: &'a P, x: &[f64], pieces: Vec<SmoothPiece<P::Id>>, settings: BundleSettings) -> Self {
        State {
            problem,
            settings,
            w: Vec::new(),
            fresh: true,
            learnt: Vec::new(),
            recalled: Vec::new(),
            recalled_of: 0,
            penalty: settings.penalty,
            used: 0.0,
            radius: settings.longest * (1.0 + dot(x, x).sqrt()),
            trust: 1.0,
            evaluations: 1,
            x: x.to_vec(),
            pieces,
        }
    }

    /// One step, with all its tries: where one fails, pieces are learnt, planes that touch the functions there join the
    /// model, and the matrix is trusted less.
    pub fn advance(&mut self) -> Advance<P::Id> {
        let size = 1.0 + dot(&self.x, &self.x).sqrt();
        let mut cuts: Vec<SmoothPiece<P::Id>> = Vec::new();
        let mut tries = 0;
        loop {
            let mut known = self.bundle();
            known.extend(cuts.iter().cloned());
            let Some(model) = self.model(&known) else { return Advance::Stuck };
            self.remember(&known, &model);
            // of a matrix that counts by a share, a share of the decrease
            let flat = |step: &Step, trust: f64| step.decrease <= self.settings.tolerance * trust;
            if flat(&model, self.trust) {
                // planes from where a step failed are no part of the functions at x: nearer, without them
                if !cuts.is_empty() {
                    cuts.clear();
                    tries += 1;
                    self.trust *= SHORTER;
                    if tries > MOST_TRIES {
                        return Advance::Stuck;
                    }
                    continue;
                }
                let weights = known.into_iter().zip(model.weights).filter(|(_, w)| *w > 1e-6).collect();
                return Advance::Flat(weights);
            }
            let length = dot(&model.direction, &model.direction).sqrt();
            if length > self.radius {
                self.trust *= 0.9 * self.radius / length;
                continue;
            }
            if length < 1e-13 * size || model.decrease < 1e-14 {
                return Advance::Stuck;
            }
            match self.tried(&model, 1.0) {
                Ok((next, pieces, t)) => {
                    self.move_to(&known, &model, t, next, pieces);
                    self.trust = if tries == 0 { (4.0 * self.trust).min(1.0) } else { self.trust };
                    return Advance::Moved;
                }
                Err(there) => {
                    tries += 1;
                    self.trust *= if there.is_none() { 0.1 } else { SHORTER };
                    if let Some(there) = there {
                        self.cut(&there, &model, &mut cuts);
                        self.learn(there);
                    }
                    if tries > MOST_TRIES || self.evaluations >= self.settings.evaluations {
                        return Advance::Stuck;
                    }
                }
            }
        }
    }

    /// The planes that touch the highest pieces at x + d, as they are at x; lower there than the functions by a share of
    /// the decrease that was promised (the downshift of Apkarian, Noll and Prot, SIAM J. Optim. 19 (2008) 281–306): a plane as high
    /// as f at x would make a kink of every x.
    fn cut(&self, there: &[SmoothPiece<P::Id>], model: &Step, cuts: &mut Vec<SmoothPiece<P::Id>>) {
        let (now, then) = (Levels::of(&self.pieces), Levels::of(there));
        let down = |role: Role| {
            let penalty = match role {
                Role::Goal => 1.0,
                Role::Bound(_) => self.penalty,
                Role::Edge => EDGE * self.penalty,
            };
            DOWNSHIFT * model.decrease / penalty
        };
        for p in there {
            let (top, here) = (then.at(p.role), now.at(p.role));
            if p.value < top - 1e-9 - 0.1 * (top - here).abs() {
                continue;
            }
            let value = (p.value - dot(&p.gradient, &model.direction)).min(here - down(p.role));
            cuts.push(SmoothPiece { value, ..p.clone() });
        }
        let excess = cuts.len().saturating_sub(MOST_CUTS);
        cuts.drain(..excess);
    }

    /// The step; with a penalty that is large enough.
    fn model(&mut self, known: &[SmoothPiece<P::Id>]) -> Option<Step> {
        if self.w.is_empty() {
            self.w = self.first_matrix(known)?;
        }
        let Levels { goal, bound: now, .. } = Levels::of(known);
        let w: Vec<f64> = self.w.iter().map(|v| self.trust * v).collect();
        loop {
            let model = step(known, &w, self.penalty, false)?;
            // all of the penalty is used, and bounds are still exceeded
            let exceeded = model.violation > MET && model.slack < 1e-6;
            self.used = known
                .iter()
                .zip(&model.weights)
                .map(|(p, w)| match p.role {
                    Role::Goal => 0.0,
                    Role::Bound(_) => *w,
                    Role::Edge => w / EDGE,
                })
                .fold(0.0, |sum, w| sum + w);
            if !exceeded || self.penalty * STIFFER > STIFFEST || goal == f64::NEG_INFINITY {
                return Some(model);
            }
            // steered: the goal may not take most of what the bounds could gain by a step as long
            let possible = now - self.least_violation(known, &w)?;
            if now - within(known, &model, self.radius) >= STEERED * possible {
                return Some(model);
            }
            self.penalty *= STIFFER;
        }
    }

    /// The violation after a step of the bounds alone.
    fn least_violation(&self, known: &[SmoothPiece<P::Id>], w: &[f64]) -> Option<f64> {
        let bounds: Vec<SmoothPiece<P::Id>> =
            known.iter().filter(|p| p.role != Role::Goal).cloned().collect();
        Some(within(&bounds, &step(&bounds, w, self.penalty, false)?, self.radius))
    }

    /// A matrix of which the first step gains a tenth, or goes a tenth of x's length.
    fn first_matrix(&self, known: &[SmoothPiece<P::Id>]) -> Option<Vec<f64>> {
        let n = self.x.len();
        let s = step(known, &identity(n, 1.0), self.penalty, false)?;
        let length = dot(&s.slope, &s.slope).sqrt();
        let size = (0.1 * self.radius / self.settings.longest / length).min(0.2 / (length * length));
        Some(identity(n, if size.is_finite() && size > 0.0 { size } else { 1.0 }))
    }

    /// The merit at x + t d, and on from there while it falls as said; what was found where it does not fall.
    #[allow(
        clippy::type_complexity,
        reason = "the point, its pieces and the step, or the pieces where it failed"
    )]
    fn tried(
        &mut self,
        model: &Step,
        t: f64,
    ) -> Result<(Vec<f64>, Vec<SmoothPiece<P::Id>>, f64), Option<Vec<SmoothPiece<P::Id>>>> {
        let now = merit(&self.pieces, self.penalty);
        let at = |t: f64, evaluations: &mut usize| {
            let next: Vec<f64> = self.x.iter().zip(&model.direction).map(|(x, d)| x + t * d).collect();
            *evaluations += 1;
            self.problem.pieces(&next).map(|p| (next, p))
        };
        let Some((next, pieces)) = at(t, &mut self.evaluations) else { return Err(None) };
        let loss = now - merit(&pieces, self.penalty);
        if !(loss >= ENOUGH * t * model.decrease) {
            return Err(Some(pieces));
        }
        let (mut best, mut best_loss) = ((next, pieces, t), loss);
        // a matrix that knows little makes steps that are too short
        let length = dot(&model.direction, &model.direction).sqrt();
        for _ in 0..4 {
            let longer = 2.0 * best.2;
            if !self.fresh || best_loss < LONGER * best.2 * model.decrease || longer * length > self.radius {
                break;
            }
            let Some((next, pieces)) = at(longer, &mut self.evaluations) else { break };
            let loss = now - merit(&pieces, self.penalty);
            if loss <= 1.2 * best_loss {
                break;
            }
            (best, best_loss) = ((next, pieces, longer), loss);
        }
        Ok(best)
    }

    pub fn begin_anew(&mut self) {
        self.trust = 1.0;
        // what raised it may be long past, and rounding times a penalty is what no step gets below
        self.penalty = (SPARE * self.used).max(BundleSettings::default().penalty).min(self.penalty);
        self.w = Vec::new();
        self.fresh = true;
    }

    /// The pieces that hold x.
    pub fn weighted(&mut self) -> Vec<(SmoothPiece<P::Id>, f64)> {
        let known = self.bundle();
        self.trust = 1.0;
        let Some(model) = self.model(&known) else { return Vec::new() };
        known.into_iter().zip(model.weights).filter(|(_, w)| *w > 1e-6).collect()
    }
}

/// max(0, c + ∇cᵀd) after as much of a step as the radius allows.
fn within<I>(known: &[SmoothPiece<I>], model: &Step, radius: f64) -> f64 {
    let length = dot(&model.direction, &model.direction).sqrt();
    let share = if length > radius { radius / length } else { 1.0 };
    known
        .iter()
        .filter(|p| matches!(p.role, Role::Bound(_)))
        .map(|p| p.value + share * dot(&p.gradient, &model.direction))
        .fold(0.0, f64::max)
}
