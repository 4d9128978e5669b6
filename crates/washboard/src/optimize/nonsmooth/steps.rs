//! A step of the bundle method: models, tries, pieces learnt where one failed, curvature along what was gone.

use super::bfgs::{identity, update};
use super::bundle::BundleSettings;
use super::model::{Step, step};
use super::pieces::{EDGE, Levels, Pieces, Role, SmoothPiece, merit};
use super::simplex::dot;

/// The merit must lose this share of what the model says.
const ENOUGH: f64 = 1e-4;
/// A step that would lose more than this share is made longer.
const LONGER: f64 = 0.7;
/// Pieces learnt from one failed step, at most.
const LEARNT: usize = 6;
/// Learnt pieces are forgotten after so many steps without weight.
const FORGOTTEN: usize = 8;
/// Learnt pieces at most.
const MOST_LEARNT: usize = 30;
/// Pieces of the goal, and of the bounds, in a model at most.
const MOST_PIECES: usize = 12;
/// Touching planes in a model at most.
const MOST_CUTS: usize = 8;
/// A plane from a failed step is this share of the promised decrease below the functions at x.
const DOWNSHIFT: f64 = 0.02;
/// Pieces apart by more than this are not the same one after a step.
const SAME: f64 = 0.4;
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
/// The share of the matrix's curvature that a step must show, or it is mixed with the old one (Powell's damping).
const DAMPED: f64 = 0.2;

/// How a step ended.
pub(super) enum Advance<I> {
    Moved,
    /// The model says that there is nothing to gain: the pieces that hold, with their weights.
    Flat(Vec<(SmoothPiece<I>, f64)>),
    Stuck,
}

struct Learnt<I> {
    id: I,
    idle: usize,
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

    /// All pieces of the model.
    fn bundle(&mut self) -> Vec<SmoothPiece<P::Id>> {
        let ids: Vec<&P::Id> = self.learnt[self.recalled_of..].iter().map(|l| &l.id).collect();
        if !ids.is_empty() {
            let new = self.problem.again(&ids, &self.x);
            self.recalled.extend(new.into_iter().flatten());
            self.recalled_of = self.learnt.len();
        }
        let mut known = self.pieces.clone();
        known.extend(self.recalled.iter().cloned());
        self.highest(known)
    }

    /// The learnt pieces are others now, or x is.
    fn forget_recalled(&mut self) {
        self.recalled.clear();
        self.recalled_of = 0;
    }

    /// As many of the pieces as a model is worth, the highest of goal and of bounds.
    fn highest(&self, mut known: Vec<SmoothPiece<P::Id>>) -> Vec<SmoothPiece<P::Id>> {
        let kind = |p: &SmoothPiece<P::Id>| match p.role {
            Role::Goal => 0,
            Role::Bound(_) => 1,
            Role::Edge => 2,
        };
        for of in 0..3 {
            let is_of = |p: &SmoothPiece<P::Id>| kind(p) == of;
            let mut values: Vec<f64> = known.iter().filter(|p| is_of(p)).map(|p| p.value).collect();
            if values.len() > MOST_PIECES {
                values.sort_by(|a, b| b.total_cmp(a));
                let least = values[MOST_PIECES - 1];
                known.retain(|p| !is_of(p) || p.value >= least);
            }
        }
        known
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

    /// Curvature of the Lagrangian along the step, then the step.
    fn move_to(
        &mut self,
        known: &[SmoothPiece<P::Id>],
        model: &Step,
        t: f64,
        next: Vec<f64>,
        pieces: Vec<SmoothPiece<P::Id>>,
    ) {
        let n = self.x.len();
        let held: Vec<usize> = (0..known.len()).filter(|i| model.weights[*i] > 1e-6).collect();
        let nearest = |i: usize, among: &[SmoothPiece<P::Id>]| -> Option<Vec<f64>> {
            among
                .iter()
                .filter(|p| p.role == known[i].role)
                .filter_map(|p| Some((self.problem.apart(&known[i].id, &p.id)?, p)))
                .filter(|(d, _)| *d < SAME)
                .min_by(|a, b| a.0.total_cmp(&b.0))
                .map(|(_, p)| p.gradient.clone())
        };
        // the peak that moves with x; pieces that are near none by themselves
        let moving = held.iter().map(|i| nearest(*i, &self.pieces).zip(nearest(*i, &pieces)));
        let mut changes: Vec<(usize, Option<(Vec<f64>, Vec<f64>)>)> =
            held.iter().copied().zip(moving).collect();
        let alone: Vec<&P::Id> =
            changes.iter().filter(|(_, c)| c.is_none()).map(|(i, _)| &known[*i].id).collect();
        if !alone.is_empty() {
            let [before, after] = [&self.x, &next].map(|x| self.problem.again(&alone, x));
            let pairs = before.into_iter().zip(after);
            for ((_, change), (b, a)) in changes.iter_mut().filter(|(_, c)| c.is_none()).zip(pairs) {
                *change = b.map(|p| p.gradient).zip(a.map(|p| p.gradient));
            }
        }
        let mut y = vec![0.0; n];
        for (i, change) in changes {
            let Some((before, after)) = change else { continue };
            let weight = model.weights[i];
            y.iter_mut().zip(after.iter().zip(&before)).for_each(|(y, (a, b))| *y += weight * (a - b));
        }
        let s: Vec<f64> = next.iter().zip(&self.x).map(|(a, b)| a - b).collect();
        // d = −trust W Σ weight · gradient: W⁻¹s of a step t d is −t trust Σ weight · gradient
        let hs: Vec<f64> = model.slope.iter().map(|v| -t * v * self.trust).collect();
        let (shs, sy) = (dot(&s, &hs), dot(&s, &y));
        if self.fresh && sy > DAMPED * 1e-3 * shs {
            let scale = sy / dot(&y, &y);
            if scale.is_finite() && scale > 0.0 {
                self.w = identity(n, scale);
            }
            update(&mut self.w, &s, &y);
            self.fresh = false;
        } else {
            if sy < DAMPED * shs {
                let theta = (1.0 - DAMPED) * shs / (shs - sy);
                y.iter_mut().zip(&hs).for_each(|(y, h)| *y = theta * *y + (1.0 - theta) * h);
            }
            update(&mut self.w, &s, &y);
        }
        let moved = dot(&s, &s).sqrt();
        let size = 1.0 + dot(&next, &next).sqrt();
        self.radius =
            (self.radius.max(3.0 * moved)).min(self.settings.longest * size).max(3.0 * moved.min(size));
        (self.x, self.pieces) = (next, pieces);
        self.forget_recalled();
    }

    /// Pieces where a step failed: the highest there.
    fn learn(&mut self, mut there: Vec<SmoothPiece<P::Id>>) {
        let now = merit(&self.pieces, self.penalty);
        let height = |p: &SmoothPiece<P::Id>| match p.role {
            Role::Goal => p.value,
            Role::Bound(_) => now + self.penalty * p.value,
            Role::Edge => now + EDGE * self.penalty * p.value,
        };
        there.sort_by(|a, b| height(b).total_cmp(&height(a)));
        for p in there.into_iter().take(LEARNT) {
            let known = |id: &P::Id| self.problem.apart(id, &p.id).is_some_and(|d| d < 1e-6);
            if self.pieces.iter().any(|q| known(&q.id)) || self.learnt.iter().any(|l| known(&l.id)) {
                continue;
            }
            self.learnt.push(Learnt { id: p.id, idle: 0 });
        }
        let excess = self.learnt.len().saturating_sub(MOST_LEARNT);
        if excess > 0 {
            self.learnt.drain(..excess);
            self.forget_recalled();
        }
    }

    /// Learnt pieces without weight are forgotten after a while.
    fn remember(&mut self, known: &[SmoothPiece<P::Id>], model: &Step) {
        for l in &mut self.learnt {
            l.idle += 1;
        }
        for (p, w) in known.iter().zip(&model.weights) {
            if *w > 1e-8 {
                for l in &mut self.learnt {
                    if self.problem.apart(&l.id, &p.id) == Some(0.0) {
                        l.idle = 0;
                    }
                }
            }
        }
        let before = self.learnt.len();
        self.learnt.retain(|l| l.idle < FORGOTTEN);
        if self.learnt.len() < before {
            self.forget_recalled();
        }
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
