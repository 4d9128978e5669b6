//! Newton's equation of the homogeneous embedding, by its Schur complement.

use super::embedding::{Direction, Iterate, Residuals};
use super::scalar::{MatOf, Real, dot, inner, norm, symmetric};
use super::scaling::Scaled;
use super::schur::Operators;

/// Newton's equation at an iterate, factorised.
pub(super) struct Newton<'a, T: Real> {
    ops: &'a Operators<T>,
    at: &'a Iterate<T>,
    factor: MatOf<T>,
    /// −B⁻¹(c + f), f = A*(M F₀ M).
    by_tau: Vec<T>,
    f: Vec<T>,
    /// κ/τ + F₀•MF₀M + (f − c)ᵀby_tau.
    pivot: T,
}

/// What a direction is to mend: the residuals' part and the complementarity's.
pub(super) struct Rhs<T> {
    pub dual: Vec<T>,
    pub primal: Vec<MatOf<T>>,
    pub gap: T,
    /// T with dS̃ + dZ̃ = T.
    pub scaled: Vec<MatOf<T>>,
    /// κ dτ + τ dκ.
    pub kappa: T,
}

/// B's diagonal is raised by this share of itself where B is not positive definite in rounding, ever more.
const RAISE: f64 = 64.0;
const MOST_RAISES: usize = 5;
impl<'a, T: Real> Newton<'a, T> {
    /// None where the Schur complement cannot be factorised.
    pub fn new(ops: &'a Operators<T>, at: &'a Iterate<T>) -> Option<Self> {
        let metric: Vec<MatOf<T>> = at.blocks.iter().map(Scaled::metric).collect();
        let factor = (0..MOST_RAISES).find_map(|k| {
            let mut schur = ops.schur(&metric);
            if k > 0 {
                let n = schur.nrows();
                let largest = (0..n).map(|i| schur[(i, i)].double()).fold(0.0, f64::max);
                let more = T::EPSILON * RAISE.powi(k as i32);
                for i in 0..n {
                    let d = schur[(i, i)];
                    // 1 + more would be 1 in double precision
                    schur[(i, i)] = d + d * T::of(more) + T::of(more * more * largest);
                }
            }
            T::cholesky(schur)
        })?;
        let carried: Vec<MatOf<T>> = ops
            .blocks
            .iter()
            .zip(&metric)
            .map(|(op, m)| {
                symmetric(&T::product(T::product(m.as_ref(), op.constant.as_ref()).as_ref(), m.as_ref()))
            })
            .collect();
        let f = ops.adjoint(carried.iter());
        let mut pivot = at.kappa / at.tau;
        ops.blocks.iter().zip(&carried).for_each(|(op, c)| pivot += inner(&op.constant, c));
        let sum: Vec<T> = ops.objective.iter().zip(&f).map(|(c, f)| -(*c + *f)).collect();
        let by_tau = T::solve(&factor, &sum);
        let slope: Vec<T> = f.iter().zip(&ops.objective).map(|(f, c)| *f - *c).collect();
        pivot += dot(&slope, &by_tau);
        // φ − fᵀB⁻¹f ≥ 0 is a small difference of large numbers: what rounding leaves of it may be negative
        let least = at.kappa / at.tau;
        if !(pivot.double() > least.double()) {
            pivot = least;
        }
        (pivot.double().is_finite() && pivot.double() > 0.0).then_some(Newton {
            ops,
            at,
            factor,
            by_tau,
            f,
            pivot,
        })
    }

    /// The direction that takes residuals to σ of themselves and complementarity to σμ less the second-order part of
    /// an earlier direction.
    pub fn direction(
        &self,
        residuals: &Residuals<T>,
        sigma: f64,
        mu: T,
        earlier: Option<&Direction<T>>,
        enough: f64,
    ) -> Direction<T> {
        let (less, target) = (T::of(sigma - 1.0), T::of(sigma) * mu);
        let times = |a: &MatOf<T>, s: T| MatOf::from_fn(a.nrows(), a.ncols(), |i, j| a[(i, j)] * s);
        let mut kappa = target - self.at.tau * self.at.kappa;
        if let Some(e) = earlier {
            kappa -= e.tau * e.kappa;
        }
        let scaled = self
            .at
            .blocks
            .iter()
            .enumerate()
            .map(|(k, b)| {
                let n = b.lambda.len();
                let second = earlier.map(|e| {
                    let [s, z] = &e.scaled[k];
                    symmetric(&T::product(s.as_ref(), z.as_ref()))
                });
                MatOf::from_fn(n, n, |i, j| {
                    let mut r = T::of(0.0);
                    if i == j {
                        r = target - b.lambda[i] * b.lambda[i];
                    }
                    if let Some(s) = &second {
                        r -= s[(i, j)];
                    }
                    T::of(2.0) * r / (b.lambda[i] + b.lambda[j])
                })
            })
            .collect();
        let rhs = Rhs {
            dual: residuals.dual.iter().map(|r| *r * less).collect(),
            primal: residuals.primal.iter().map(|r| times(r, less)).collect(),
            gap: residuals.gap * less,
            scaled,
            kappa,
        };
        let found = self.solve(&rhs);
        let (dual, gap) = self.left(&found, &rhs);
        self.refined(
            found,
            dual,
            gap,
            enough.max(4.0 * T::EPSILON * (norm(&rhs.dual) + rhs.gap.double().abs())),
        )
    }

    /// c dτ − A*(dZ) = dual, dS − A(dx) − F₀dτ = primal, dκ + cᵀdx + F₀•dZ = gap, dS̃ + dZ̃ = scaled, κ dτ + τ dκ = kappa.
    pub(super) fn solve(&self, rhs: &Rhs<T>) -> Direction<T> {
        let (ops, at) = (self.ops, self.at);
        // H (T − HᵀP H) Hᵀ: dZ of dx = 0, dτ = 0
        let fixed: Vec<MatOf<T>> = at
            .blocks
            .iter()
            .zip(rhs.primal.iter().zip(&rhs.scaled))
            .map(|(b, (p, t))| b.outward(&(t - b.inward(p))))
            .collect();
        let mut constant = T::of(0.0);
        ops.blocks.iter().zip(&fixed).for_each(|(op, z)| constant += inner(&op.constant, z));
        let right: Vec<T> = ops.adjoint(fixed.iter()).iter().zip(&rhs.dual).map(|(a, d)| *a + *d).collect();
        let p = T::solve(&self.factor, &right);
        // dκ = (kappa − κ dτ)/τ into the third equation
        let slope: Vec<T> = self.f.iter().zip(&ops.objective).map(|(f, c)| *f - *c).collect();
        let tau = (rhs.kappa / at.tau - rhs.gap + constant - dot(&slope, &p)) / self.pivot;
        let x: Vec<T> = p.iter().zip(&self.by_tau).map(|(p, q)| *p + tau * *q).collect();
        let kappa = (rhs.kappa - at.kappa * tau) / at.tau;
        let (blocks, scaled) = at
            .blocks
            .iter()
            .enumerate()
            .map(|(k, b)| {
                let (op, p) = (&ops.blocks[k], &rhs.primal[k]);
                let f = op.apply(&x);
                let ds = MatOf::from_fn(f.nrows(), f.ncols(), |i, j| {
                    f[(i, j)] + op.constant[(i, j)] * tau + p[(i, j)]
                });
                let inward = b.inward(&ds);
                let other = &rhs.scaled[k] - &inward;
                ([ds, b.outward(&other)], [inward, other])
            })
            .unzip();
        Direction { x, blocks, scaled, tau, kappa }
    }

    /// What is left of the first and the third equation.
    pub(super) fn left(&self, d: &Direction<T>, rhs: &Rhs<T>) -> (Vec<T>, T) {
        let a = self.ops.adjoint(d.blocks.iter().map(|[_, z]| z));
        let dual = (0..a.len()).map(|i| rhs.dual[i] - self.ops.objective[i] * d.tau + a[i]).collect();
        let mut gap = rhs.gap - d.kappa - dot(&self.ops.objective, &d.x);
        self.ops.blocks.iter().zip(&d.blocks).for_each(|(op, [_, z])| gap -= inner(&op.constant, z));
        (dual, gap)
    }
}
