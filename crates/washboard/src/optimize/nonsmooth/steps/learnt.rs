//! What a search learns where steps fail: pieces that are kept, asked about again at x, and forgotten.

use super::super::model::Step;
use super::super::pieces::{EDGE, Pieces, Role, SmoothPiece, merit};
use super::State;

/// Pieces learnt from one failed step, at most.
const LEARNT: usize = 6;
/// Learnt pieces are forgotten after so many steps without weight.
const FORGOTTEN: usize = 8;
/// Learnt pieces at most.
const MOST_LEARNT: usize = 30;
/// Pieces of the goal, and of the bounds, in a model at most.
const MOST_PIECES: usize = 12;

pub(super) struct Learnt<I> {
    pub id: I,
    pub idle: usize,
}

impl<P: Pieces> State<'_, P> {
    /// All pieces of the model.
    pub(super) fn bundle(&mut self) -> Vec<SmoothPiece<P::Id>> {
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
    pub(super) fn forget_recalled(&mut self) {
        self.recalled.clear();
        self.recalled_of = 0;
    }

    /// As many of the pieces as a model is worth, the highest of goal and of bounds.
    pub(super) fn highest(&self, mut known: Vec<SmoothPiece<P::Id>>) -> Vec<SmoothPiece<P::Id>> {
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

    /// Pieces where a step failed: the highest there.
    pub(super) fn learn(&mut self, mut there: Vec<SmoothPiece<P::Id>>) {
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
    pub(super) fn remember(&mut self, known: &[SmoothPiece<P::Id>], model: &Step) {
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
}
