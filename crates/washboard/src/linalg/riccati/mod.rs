//! Algebraic Riccati equations, continuous and discrete: structured doubling, refined by Newton's method, with the
//! ordered Schur form where doubling breaks down. The residual and the closed loop decide, never the route.

mod care;
mod condition;
mod dare;
mod diagnose;
mod doubling;
mod error;
mod input;
mod lu;
mod newton;
mod of_output;
mod scaling;
mod schur_route;

pub use care::{care, care_g};
pub use dare::dare;
pub use error::RiccatiError;
pub use of_output::care_of_output;

use super::dense::{C64, LinalgError, Mat};
use super::quasi_triangular::Equation;
use condition::{Errors, Norms, errors};
use diagnose::Nearness;
use doubling::Doubling;
use newton::{Problem, Refined, refine};
use scaling::Scaling;

/// A scaled residual above this is refused.
const REFUSED: f64 = 1e-8;
/// Above this many n ε of what rounding explains, or above this scaled residual, the other route is tried too.
const SUSPICIOUS_EPSILONS: f64 = 10.0;
const SUSPICIOUS: f64 = 1e-10;

/// The stabilising solution of a Riccati equation, with what proves it.
#[derive(Debug, Clone)]
pub struct RiccatiSolution {
    /// X, exactly symmetric.
    pub x: Mat,
    /// F with u = +F x: −R⁻¹(BᵀX + Sᵀ), or −(R + BᵀXB)⁻¹(BᵀXA + Sᵀ). Of [`care_g`], which knows no B: −X.
    pub gain: Mat,
    /// Eigenvalues of A + B F (of A − G X).
    pub closed_loop_eigenvalues: Vec<C64>,
    /// ‖equation at X‖ / (sum of the norms of its terms, each bounded by the norms of its factors with ‖XGX‖ and
    /// its like taken whole), Frobenius: of the order of ε for a sound solution.
    pub scaled_residual: f64,
    /// Relative condition number for perturbations of A, G and Q, an upper bound up to the estimate of its norms;
    /// infinite for X = 0.
    pub condition: f64,
    /// First-order bound of ‖X − X*‖ / ‖X‖, Frobenius, from the residual and its own rounding; infinite for X = 0.
    pub forward_error_bound: f64,
    /// LU and Schur factorisations of n × n matrices (of 2n × 2n ones counted 8) that it took.
    pub factorisations: usize,
}

/// An equation in A, G and Q alone, in scaled states.
struct Standard {
    equation: Equation,
    a: Mat,
    g: Mat,
    q: Mat,
    /// A matrix whose columns are what the input reaches.
    reach: Mat,
    /// H with Q = HᵀH, where G and Q are positive semidefinite by construction.
    seen: Option<Mat>,
}

impl Standard {
    /// X by doubling, and the factorisations that it took.
    fn doubling(&self) -> Option<(Mat, usize)> {
        match self.equation {
            Equation::Continuous => Doubling::cayley(&self.a, &self.g, &self.q)?.run(),
            Equation::Discrete => {
                let Self { a, g, q, .. } = self;
                Doubling { a: a.clone(), g: g.clone(), h: q.clone(), factorisations: 0 }.run()
            }
        }
    }

    /// What stands in the way of a stabilising solution, if it can be found.
    fn obstacle(&self, nearness: Nearness) -> Option<RiccatiError> {
        diagnose::unreachable(self.equation, &self.a, &self.reach).or_else(|| match &self.seen {
            Some(h) => diagnose::unseen(&self.a, h),
            None => diagnose::boundary(self.equation, &self.a, &self.g, &self.q, nearness),
        })
    }

    /// X by the ordered Schur form.
    fn schur(&self) -> Result<Mat, LinalgError> {
        match self.equation {
            Equation::Continuous => schur_route::continuous(&self.a, &self.g, &self.q),
            Equation::Discrete => schur_route::discrete(&self.a, &self.g, &self.q),
        }
    }
}

/// The stabilising solution of `problem`, of which `standard` is the form without B, for X − `shift`.
fn stabilising(
    problem: &Problem,
    standard: &Standard,
    shift: Option<&Mat>,
    scaling: &Scaling,
    norms: Norms,
) -> Result<RiccatiSolution, RiccatiError> {
    let n = standard.a.nrows();
    let rounding = SUSPICIOUS_EPSILONS * n as f64 * f64::EPSILON;
    let mut factorisations = 0;
    let from = |x: Mat| refine(problem, shift.map_or_else(|| x.clone(), |x0| &x + x0)).ok();
    let mut best = standard.doubling().and_then(|(x, work)| {
        factorisations += work;
        from(x)
    });
    if !best.as_ref().is_some_and(|b| sound(b, SUSPICIOUS) && b.at.over_rounding() <= rounding) {
        factorisations += 8;
        let other = standard.schur().ok().and_then(from);
        best = match (best, other) {
            (Some(one), Some(other)) => Some(if better(&other, &one) { other } else { one }),
            (one, other) => one.or(other),
        };
    }
    let unconfirmed = |scaled_residual, margin| {
        standard.obstacle(Nearness::Near).unwrap_or(RiccatiError::Unconfirmed { scaled_residual, margin })
    };
    let Some(best) = best else { return Err(unconfirmed(f64::INFINITY, f64::INFINITY)) };
    if !sound(&best, REFUSED) {
        return Err(unconfirmed(best.at.scaled(), best.linearised.margin));
    }
    let Errors { condition, forward, proven } = errors(&best, &standard.g, scaling, &norms);
    // too near to the boundary for the residual alone to say that there is a solution?
    if !proven && let Some(why) = standard.obstacle(Nearness::Indistinct) {
        return Err(why);
    }
    let scaled_residual = best.at.scaled();
    let x = scaling.g(&best.x);
    let values = best.linearised.eigenvalues;
    let gain = best.at.gain.map_or_else(|| Mat::zeros(0, n), |f| scaling.gain(&f));
    if !(x.norm_max().is_finite() && gain.norm_max().is_finite()) {
        return Err(LinalgError::NotFinite { name: "X", row: 0, col: 0, value: x.norm_max() }.into());
    }
    Ok(RiccatiSolution {
        x,
        gain,
        closed_loop_eigenvalues: values,
        scaled_residual,
        condition,
        forward_error_bound: forward,
        factorisations: factorisations + best.factorisations,
    })
}

fn sound(found: &Refined, residual: f64) -> bool {
    found.at.scaled() <= residual && (found.linearised.margin < 0.0)
}

/// A stable one before an unstable one, then the smaller residual.
fn better(one: &Refined, other: &Refined) -> bool {
    let stable = |r: &Refined| r.linearised.margin < 0.0;
    match (stable(one), stable(other)) {
        (true, false) => true,
        (false, true) => false,
        _ => one.at.scaled() < other.at.scaled(),
    }
}
