//! The search: predictor and corrector on the homogeneous embedding, in double, then in double-double where that stalls.

use super::embedding::{Direction, Iterate, Newton, Residuals};
use super::outcome::{Measures, SdpOutcome, Status};
use super::problem::Sdp;
use super::scalar::{MatOf, Real, dot, inner, norm, rounded};
use super::scales::Scales;
use super::scaling::Scaled;
use super::schur::Operators;

/// When a search ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SdpSettings {
    /// Relative infeasibilities and gap of an optimum; violation of a proof that there is none.
    pub tolerance: f64,
    /// Iterations in each precision.
    pub max_iterations: usize,
    /// Whether a search that stalls above the tolerance goes on in double-double.
    pub double_double: bool,
}

impl Default for SdpSettings {
    fn default() -> Self {
        SdpSettings { tolerance: 1e-8, max_iterations: 100, double_double: true }
    }
}

/// A step goes this far to the boundary, by how far the predictor went.
const NEAR: [f64; 2] = [0.9, 0.99];
/// Shorter steps, one after another, are a stall.
const SHORT: f64 = 1e-3;
const MOST_SHORT: usize = 3;
/// Iterations without a better iterate before a search counts as stalled: in double, where double-double comes next, and
/// there.
const PATIENCE: [usize; 2] = [6, 12];

impl Sdp {
    /// Solves the program.
    ///
    /// Homogeneous self-dual embedding, Nesterov and Todd's direction, Mehrotra's predictor and corrector; the Schur
    /// complement from Gram matrices of the coefficients' vectors.
    pub fn solve(&self, settings: &SdpSettings) -> SdpOutcome {
        let scaled = Scales::of(self);
        let program = scaled.program(self);
        let (first, mut end) = {
            let ops = Operators::<f64>::new(&program);
            let mut iterate = Iterate::start(&ops);
            let end = run(&ops, &mut iterate, settings, PATIENCE[0]);
            (iterate, end)
        };
        let mut best = first;
        if end.status == Status::Stalled
            && settings.double_double
            && let Some(mut iterate) = best.cast::<faer::fx128>()
        {
            let more = run(&Operators::new(&program), &mut iterate, settings, PATIENCE[1]);
            let better = more.status != Status::Stalled || more.measures.worst() < end.measures.worst();
            end.iterations[1] = more.iterations[0];
            if let (true, Some(rounded)) = (better, iterate.cast()) {
                best = rounded;
                end = Ended { iterations: end.iterations, ..more };
            }
        }
        scaled.outcome(self, &best, end)
    }
}

/// How a run ended.
pub(super) struct Ended {
    pub status: Status,
    pub measures: Measures,
    pub iterations: [usize; 2],
}

/// Norms of the data, for relative measures.
struct Norms {
    objective: f64,
    constants: f64,
}

/// Iterates from `iterate`, and leaves the best there.
fn run<T: Real>(
    ops: &Operators<T>,
    iterate: &mut Iterate<T>,
    settings: &SdpSettings,
    patience: usize,
) -> Ended {
    let square: f64 = ops.blocks.iter().map(|b| inner(&b.constant, &b.constant).double()).sum();
    let norms = Norms { objective: norm(&ops.objective), constants: square.sqrt() };
    let mut at = iterate.clone();
    let mut best = f64::INFINITY;
    let mut best_measures = Measures { primal: f64::INFINITY, dual: f64::INFINITY, gap: f64::INFINITY };
    let (mut since, mut short, mut count) = (0, 0, 0);
    let status = loop {
        let residuals = at.residuals(ops);
        let (measures, proof) = judge(ops, &at, &residuals, &norms);
        if measures.worst() < best {
            (best, best_measures, since) = (measures.worst(), measures, 0);
            *iterate = at.clone();
        } else {
            since += 1;
        }
        if measures.worst() <= settings.tolerance {
            break Status::Optimal;
        }
        if let Some((status, violation)) = proof
            && violation <= settings.tolerance
        {
            *iterate = at.clone();
            break status;
        }
        if since > patience || short > MOST_SHORT || count >= settings.max_iterations {
            break Status::Stalled;
        }
        let Some(newton) = Newton::new(ops, &at) else { break Status::Stalled };
        let mu = at.mu();
        let affine = newton.direction(&residuals, 0.0, mu, None);
        let reach = |d: &Direction<T>| {
            let scalars = [(at.tau, d.tau), (at.kappa, d.kappa)]
                .map(|(v, d)| if d.double() < 0.0 { (-(v / d)).double() } else { f64::INFINITY });
            at.blocks
                .iter()
                .enumerate()
                .flat_map(|(k, b)| d.scaled[k].each_ref().map(|d| b.longest(d)))
                .chain(scalars)
                .fold(f64::INFINITY, f64::min)
        };
        let free = reach(&affine).min(1.0);
        let sigma = (1.0 - free).powi(3).clamp(1e-6, 1.0);
        let d = newton.direction(&residuals, sigma, mu, Some(&affine));
        // closer to the boundary where the predictor went far: at the boundary too soon, iterates zigzag along it
        let near = NEAR[0] + (NEAR[1] - NEAR[0]) * free;
        let mut alpha = (near * reach(&d)).min(1.0);
        let next = (0..30).find_map(|_| {
            let moved = step(&at, &d, alpha);
            alpha *= if moved.is_none() { 0.5 } else { 1.0 };
            moved
        });
        count += 1;
        let Some(next) = next else { break Status::Stalled };
        short = if alpha < SHORT { short + 1 } else { 0 };
        at = next.normalised();
    };
    Ended { status, measures: best_measures, iterations: [count, 0] }
}

fn step<T: Real>(at: &Iterate<T>, d: &Direction<T>, alpha: f64) -> Option<Iterate<T>> {
    let a = T::of(alpha);
    let blocks: Vec<Scaled<T>> = at
        .blocks
        .iter()
        .enumerate()
        .map(|(k, b)| b.moved(&d.blocks[k][0], &d.blocks[k][1], a))
        .collect::<Option<_>>()?;
    let (tau, kappa) = (at.tau + a * d.tau, at.kappa + a * d.kappa);
    let x: Vec<T> = at.x.iter().zip(&d.x).map(|(x, d)| *x + a * *d).collect();
    (tau.double() > 0.0 && kappa.double() > 0.0 && x.iter().all(|v| v.double().is_finite()))
        .then_some(Iterate { x, blocks, tau, kappa })
}

impl<T: Real> Iterate<T> {
    /// The embedding is homogeneous: its iterates are kept at τ + κ of order one.
    fn normalised(mut self) -> Self {
        let size = self.tau.double().max(self.kappa.double());
        if (1e-3..1e3).contains(&size) {
            return self;
        }
        let size = T::of(size);
        self.x.iter_mut().for_each(|x| *x = *x / size);
        self.blocks = self.blocks.into_iter().map(|b| b.over(size)).collect();
        (self.tau, self.kappa) = (self.tau / size, self.kappa / size);
        self
    }

    fn cast<U: Real>(&self) -> Option<Iterate<U>> {
        let matrix = |a: &MatOf<T>| super::scalar::cast::<U>(&rounded(a));
        let of = |v: T| U::of(v.double());
        Some(Iterate {
            x: self.x.iter().map(|v| of(*v)).collect(),
            blocks: self
                .blocks
                .iter()
                .map(|b| Scaled::new(matrix(&b.slack), matrix(&b.multiplier)))
                .collect::<Option<_>>()?,
            tau: of(self.tau),
            kappa: of(self.kappa),
        })
    }
}

/// How well an iterate solves the program, and how well it proves that there is no solution.
fn judge<T: Real>(
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
    // cᵀx + F₀•Z without the cancellation of the two
    let gap = (r.gap - at.kappa).double();
    let measures = Measures {
        primal: frobenius(&r.primal) / tau / (1.0 + norms.constants),
        dual: norm(&r.dual) / tau / (1.0 + norms.objective),
        gap: gap.abs() / (tau + objective.abs()),
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
