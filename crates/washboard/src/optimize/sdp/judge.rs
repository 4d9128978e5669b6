//! What an iterate is worth: how well it solves the program, what it proves, and whether it is inside.

use super::embedding::{Iterate, Residuals};
use super::outcome::{Measures, Status};
use super::scalar::{MatOf, Real, dot, inner, norm};
use super::schur::Operators;

/// A gap is relative to the objective's size, or to this share of the scaled program's where that is larger.
pub(super) const FLOOR: f64 = 0.01;

/// Norms of the data, for relative measures.
pub(super) struct Norms {
    objective: f64,
    constants: f64,
}

impl Norms {
    pub fn of<T: Real>(ops: &Operators<T>) -> Self {
        let square: f64 = ops.blocks.iter().map(|b| inner(&b.constant, &b.constant).double()).sum();
        Norms { objective: norm(&ops.objective), constants: square.sqrt() }
    }

    /// What a residual of the dual equation is relative to.
    pub fn of_dual(&self, tau: f64) -> f64 {
        tau * (1.0 + self.objective)
    }
}

/// How well an iterate solves the program, and how well it proves that there is no solution.
pub(super) fn judge<T: Real>(
    ops: &Operators<T>,
    at: &Iterate<T>,
    r: &Residuals<T>,
    norms: &Norms,
) -> (Measures, Option<(Status, f64)>) {
    let tau = at.tau.double();
    let frobenius = |blocks: &[MatOf<T>]| blocks.iter().map(|p| inner(p, p).double()).sum::<f64>().sqrt();
    let objective = dot(&ops.objective, &at.x).double();
    let mut bound = T::of(0.0);
    ops.blocks.iter().zip(&at.blocks).for_each(|(op, b)| bound += inner(&op.constant, &b.multiplier));
    let bound = bound.double();
    let mut complementarity = T::of(0.0);
    at.blocks.iter().for_each(|b| complementarity += dot(&b.lambda, &b.lambda));
    // cᵀx + F₀•Z without the cancellation of the two
    let gap = (r.gap - at.kappa).double();
    // what is reported is rounded to double precision: an x so large that this shows is no answer
    let off: Vec<T> = at.x.iter().map(|x| T::of((*x / at.tau).double()) - *x / at.tau).collect();
    let rounding = if off.iter().any(|v| v.double() != 0.0) {
        let moved: Vec<MatOf<T>> = ops.blocks.iter().map(|op| op.apply(&off)).collect();
        frobenius(&moved)
    } else {
        0.0
    };
    let measures = Measures {
        primal: (frobenius(&r.primal) / tau + rounding) / (1.0 + norms.constants),
        dual: norm(&r.dual) / tau / (1.0 + norms.objective),
        // where x or Z is large their equations' residuals hide a gap: complementarity shows it
        gap: gap.abs().max(complementarity.double() / tau) / (FLOOR * tau + objective.abs()),
    };
    let mut proof = None;
    if bound < 0.0 {
        let a: Vec<T> = r.dual.iter().zip(&ops.objective).map(|(r, c)| *c * at.tau - *r).collect();
        proof = Some((Status::Infeasible, norm(&a) / -bound));
    }
    if objective < 0.0 {
        let lack: f64 = r
            .primal
            .iter()
            .zip(&ops.blocks)
            .map(|(p, op)| {
                // S − A(x)
                let with =
                    MatOf::from_fn(p.nrows(), p.ncols(), |i, j| p[(i, j)] + op.constant[(i, j)] * at.tau);
                inner(&with, &with).double()
            })
            .sum::<f64>()
            .sqrt();
        let violation = lack / -objective;
        if proof.is_none_or(|(_, v)| violation < v) {
            proof = Some((Status::Unbounded, violation));
        }
    }
    (measures, proof)
}

/// x/τ where F(x/τ) is positive definite.
pub(super) fn inside<T: Real>(ops: &Operators<T>, at: &Iterate<T>) -> Option<Vec<f64>> {
    let x: Vec<T> = at.x.iter().map(|x| *x / at.tau).collect();
    let positive = ops.blocks.iter().all(|op| {
        let f = op.apply(&x);
        let sum = MatOf::from_fn(f.nrows(), f.ncols(), |i, j| f[(i, j)] + op.constant[(i, j)]);
        T::cholesky(sum).is_some()
    });
    positive.then(|| x.iter().map(|x| x.double()).collect())
}
