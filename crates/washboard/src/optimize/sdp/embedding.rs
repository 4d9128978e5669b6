//! The homogeneous embedding of a program with its dual.

use super::scalar::{MatOf, Real, dot, inner};
use super::scaling::Scaled;
use super::schur::{Operator, Operators};

/// 0 = cτ − A*(Z), S = A(x) + F₀τ, κ = −cᵀx − F₀•Z with S, Z ⪰ 0 and τ, κ ≥ 0: a solution with τ > 0 is an optimum, one
/// with κ > 0 a proof that there is none.
#[derive(Clone)]
pub(super) struct Iterate<T> {
    pub x: Vec<T>,
    pub blocks: Vec<Scaled<T>>,
    pub tau: T,
    pub kappa: T,
}

/// How far an iterate is from the three equations.
pub(super) struct Residuals<T> {
    /// cτ − A*(Z).
    pub dual: Vec<T>,
    /// S − A(x) − F₀τ.
    pub primal: Vec<MatOf<T>>,
    /// κ + cᵀx + F₀•Z.
    pub gap: T,
}

/// A direction.
pub(super) struct Direction<T> {
    pub x: Vec<T>,
    /// dS and dZ.
    pub blocks: Vec<[MatOf<T>; 2]>,
    /// HᵀdSH and GᵀdZG.
    pub scaled: Vec<[MatOf<T>; 2]>,
    pub tau: T,
    pub kappa: T,
}

impl<T: Real> Iterate<T> {
    pub fn start(ops: &Operators<T>) -> Self {
        let identity = |b: &Operator<T>| {
            let n = b.constant.nrows();
            Scaled::new(MatOf::identity(n, n), MatOf::identity(n, n))
        };
        let blocks = ops.blocks.iter().filter_map(identity).collect();
        Iterate { x: vec![T::of(0.0); ops.objective.len()], blocks, tau: T::of(1.0), kappa: T::of(1.0) }
    }

    /// (S•Z + τκ)/(N + 1).
    pub fn mu(&self) -> T {
        let mut sum = self.tau * self.kappa;
        let mut count = 1;
        for b in &self.blocks {
            sum += dot(&b.lambda, &b.lambda);
            count += b.lambda.len();
        }
        sum / T::of(count as f64)
    }

    pub fn residuals(&self, ops: &Operators<T>) -> Residuals<T> {
        let a = ops.adjoint(self.blocks.iter().map(|b| &b.multiplier));
        let mut gap = self.kappa + dot(&ops.objective, &self.x);
        let primal = ops
            .blocks
            .iter()
            .zip(&self.blocks)
            .map(|(op, b)| {
                gap += inner(&op.constant, &b.multiplier);
                let (s, f) = (&b.slack, op.apply(&self.x));
                MatOf::from_fn(s.nrows(), s.ncols(), |i, j| {
                    s[(i, j)] - f[(i, j)] - op.constant[(i, j)] * self.tau
                })
            })
            .collect();
        let dual = ops.objective.iter().zip(&a).map(|(c, a)| *c * self.tau - *a).collect();
        Residuals { dual, primal, gap }
    }
}

impl<T: Real> Direction<T> {
    /// d + t·other.
    pub fn plus(&self, other: &Self, t: T) -> Self {
        let times = |a: &MatOf<T>, b: &MatOf<T>| {
            MatOf::from_fn(a.nrows(), a.ncols(), |i, j| a[(i, j)] + b[(i, j)] * t)
        };
        let add = |a: &[[MatOf<T>; 2]], b: &[[MatOf<T>; 2]]| {
            a.iter().zip(b).map(|([a, c], [b, d])| [times(a, b), times(c, d)]).collect()
        };
        Direction {
            x: self.x.iter().zip(&other.x).map(|(a, b)| *a + *b * t).collect(),
            blocks: add(&self.blocks, &other.blocks),
            scaled: add(&self.scaled, &other.scaled),
            tau: self.tau + other.tau * t,
            kappa: self.kappa + other.kappa * t,
        }
    }
}
