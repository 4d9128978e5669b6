//! What a step says of the curvature: BFGS on the Lagrangian of the pieces that held it.

use super::super::bfgs::{identity, update};
use super::super::model::Step;
use super::super::pieces::{Pieces, SmoothPiece};
use super::super::simplex::dot;
use super::State;

/// Pieces apart by more than this are not the same one after a step.
const SAME: f64 = 0.4;
/// The share of the matrix's curvature that a step must show, or it is mixed with the old one (Powell's damping).
const DAMPED: f64 = 0.2;

/// A piece's gradient before a step and after it.
type Change = Option<(Vec<f64>, Vec<f64>)>;

impl<P: Pieces> State<'_, P> {
    /// Curvature of the Lagrangian along the step, then the step.
    pub(super) fn move_to(
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
        let mut changes: Vec<(usize, Change)> = held.iter().copied().zip(moving).collect();
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
}
