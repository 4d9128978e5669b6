//! The search: predictor and corrector on the homogeneous embedding, in double, then in double-double where that stalls.

use super::embedding::{Direction, Iterate};
use super::judge::{FLOOR, Norms, inside, judge};
use super::newton::Newton;
use super::outcome::{Measures, SdpOutcome, Status};
use super::problem::Sdp;
use super::scalar::{Real, cast, dot, rounded};
use super::scales::Scales;
use super::scaling::Scaled;
use super::schur::Operators;
use crate::linalg::Mat;

/// When a search ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SdpSettings {
    /// Relative infeasibilities and gap of an optimum; violation of a proof that there is none.
    pub tolerance: f64,
    /// Iterations in each precision.
    pub max_iterations: usize,
    /// Whether a search that stalls above the tolerance goes on in double-double: of at most 400 variables, where that takes seconds.
    pub double_double: bool,
    /// The first iterate whose F(x) is positive definite and whose cᵀx is within this share of the least is kept as
    /// `interior`: a point well inside, where optima themselves lie on the boundary and may be infinitely far.
    pub interior_gap: Option<f64>,
}

impl Default for SdpSettings {
    fn default() -> Self {
        SdpSettings { tolerance: 1e-8, max_iterations: 100, double_double: true, interior_gap: None }
    }
}

/// Variables of a program that is solved in double-double: Cholesky's factor of 400 takes .2 s there, and a search up to 100 of them.
const MOST_EXACT: usize = 400;
/// A step goes this far to the boundary, by how far the predictor went.
const NEAR: [f64; 2] = [0.9, 0.99];
/// Shorter steps, one after another, are a stall.
const SHORT: f64 = 1e-3;
const MOST_SHORT: usize = 3;
/// Iterates with a larger relative gap are not looked at as interior points.
const NEAR_INSIDE: f64 = 0.1;
/// Where a point well inside is asked for, the least value need be known to this gap only: it is often not attained, and
/// the way to it endless.
const KNOWN: f64 = 5e-5;
/// What that value's own x may lack of the tolerance: the point inside is the answer, not that one.
const LOOSE: f64 = 100.0;
/// A search that stalls at so many times the tolerance has found its optimum.
const NEARLY: f64 = 10.0;
/// A direction whose second order is the predictor's is made again with its own so many times, if it reaches less far than this and
/// each time so many times as far as before.
const CORRECTIONS: usize = 2;
const FAR: f64 = 0.95;
const GAIN: f64 = 1.02;
/// What a direction may leave of the dual equation: a share of the tolerance, or of what there is.
const FINE: f64 = 0.05;
const LESS: f64 = 0.01;
/// Iterations that do not halve the dual equation's residual, where all else is within the tolerance, before a search counts as stalled.
const MOST_FLAT: usize = 2;
/// Iterations without a better iterate before a search counts as stalled: in double, where double-double comes next, and
/// there.
const PATIENCE: [usize; 2] = [10, 30];

impl Sdp {
    /// Solves the program.
    ///
    /// Homogeneous self-dual embedding, Nesterov and Todd's direction, Mehrotra's predictor and corrector, the latter repeated; the
    /// Schur complement from Gram matrices of the coefficients' vectors, its factor before GMRES.
    pub fn solve(&self, settings: &SdpSettings) -> SdpOutcome {
        let scaled = Scales::of(self);
        let program = scaled.program(self);
        let ops = Operators::<f64>::new(&program);
        let mut iterate = Iterate::start(&ops);
        let mut end = run(&ops, &mut iterate, settings, PATIENCE[0]);
        end.accept(settings);
        let mut best = iterate.rounded();
        let inside = settings.interior_gap.is_some_and(|share| {
            let least = dot(&ops.objective, &best.x).abs() / best.tau;
            !end.interior.is_empty() && end.measures.gap * (FLOOR + least) <= share * least
        });
        if end.status == Status::Stalled
            && settings.double_double
            && self.variables() <= MOST_EXACT
            && !inside
            && let Some(mut iterate) = iterate.exact()
        {
            let more = run(&Operators::new(&program), &mut iterate, settings, PATIENCE[1]);
            let iterations = [end.iterations[0], more.iterations[0]];
            if more.status != Status::Stalled || more.measures.worst() < end.measures.worst() {
                best = iterate.rounded();
                let mut interior = std::mem::take(&mut end.interior);
                interior.extend(more.interior.iter().cloned());
                end = Ended { iterations, interior, ..more };
            }
            end.iterations = iterations;
        }
        end.accept(settings);
        scaled.outcome(self, &best, end, settings.interior_gap)
    }
}

/// How a run ended.
pub(super) struct Ended {
    pub status: Status,
    pub measures: Measures,
    pub iterations: [usize; 2],
    /// x of the iterates that were inside, in their order.
    pub interior: Vec<Vec<f64>>,
}

impl Ended {
    /// What stalls nearly at the tolerance is an optimum.
    fn accept(&mut self, settings: &SdpSettings) {
        if self.status == Status::Stalled && self.measures.worst() <= NEARLY * settings.tolerance {
            self.status = Status::Optimal;
        }
    }
}

/// Iterates from `iterate`, and leaves the best there.
fn run<T: Real>(
    ops: &Operators<T>,
    iterate: &mut Iterate<T>,
    settings: &SdpSettings,
    patience: usize,
) -> Ended {
    let norms = Norms::of(ops);
    let mut at = iterate.clone();
    let mut best = f64::INFINITY;
    let mut best_measures = Measures { primal: f64::INFINITY, dual: f64::INFINITY, gap: f64::INFINITY };
    let (mut since, mut short, mut count) = (0, 0, 0);
    let (mut lowest, mut flat) = (f64::INFINITY, 0);
    let mut interior = Vec::new();
    let status = loop {
        let residuals = at.residuals(ops);
        let (measures, proof) = judge(ops, &at, &residuals, &norms);
        if measures.worst() < best {
            (best, best_measures, since) = (measures.worst(), measures, 0);
            *iterate = at.clone();
        } else {
            since += 1;
        }
        if settings.interior_gap.is_some() && measures.gap <= NEAR_INSIDE {
            interior.extend(inside(ops, &at));
        }
        let objective = dot(&ops.objective, &at.x).double() / at.tau.double();
        if measures.worst() <= settings.tolerance
            || settings.interior_gap.is_some_and(|share| {
                // the least value is known to a share of what is given up
                !interior.is_empty()
                    && measures.primal <= LOOSE * settings.tolerance
                    && measures.dual <= settings.tolerance
                    && measures.gap * (FLOOR + objective.abs()) <= KNOWN.min(share) * objective.abs()
            })
        {
            break Status::Optimal;
        }
        if let Some((status, violation)) = proof
            && violation <= settings.tolerance
        {
            *iterate = at.clone();
            break status;
        }
        if measures.dual < 0.5 * lowest {
            (lowest, flat) = (measures.dual, 0);
        } else {
            flat += 1;
        }
        // rounding's share of the dual equation is all that is left
        let floor = flat > MOST_FLAT && measures.gap.max(measures.primal) <= settings.tolerance;
        if floor || since > patience || short > MOST_SHORT || count >= settings.max_iterations {
            break Status::Stalled;
        }
        let Some(newton) = Newton::new(ops, &at) else { break Status::Stalled };
        let mu = at.mu();
        let enough = norms.of_dual(at.tau.double()) * (FINE * settings.tolerance).max(LESS * measures.dual);
        let affine = newton.direction(&residuals, 0.0, mu, None, enough);
        let free = at.reach(&affine).min(1.0);
        let sigma = (1.0 - free).powi(3).clamp(1e-6, 1.0);
        let mut d = newton.direction(&residuals, sigma, mu, Some(&affine), enough);
        let mut reach = at.reach(&d);
        for _ in 0..CORRECTIONS {
            if reach > FAR {
                break;
            }
            let more = newton.direction(&residuals, sigma, mu, Some(&d), enough);
            let further = at.reach(&more);
            if !(further > GAIN * reach) {
                break;
            }
            (d, reach) = (more, further);
        }
        // closer to the boundary where the predictor went far: at the boundary too soon, iterates zigzag along it
        let near = NEAR[0] + (NEAR[1] - NEAR[0]) * free;
        let mut alpha = (near * reach).min(1.0);
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
    Ended { status, measures: best_measures, iterations: [count, 0], interior }
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
    /// The longest step along a direction.
    fn reach(&self, d: &Direction<T>) -> f64 {
        let scalars = [(self.tau, d.tau), (self.kappa, d.kappa)]
            .map(|(v, d)| if d.double() < 0.0 { (-(v / d)).double() } else { f64::INFINITY });
        let blocks = self.blocks.iter().zip(&d.scaled);
        blocks
            .flat_map(|(b, d)| d.each_ref().map(|d| b.longest(d)))
            .chain(scalars)
            .fold(f64::INFINITY, f64::min)
    }

    /// The embedding is homogeneous: its iterates are kept at τ + κ of order one.
    fn normalised(mut self) -> Self {
        let size = self.tau.double().max(self.kappa.double());
        if (1e-3..1e3).contains(&size) {
            return self;
        }
        let size = T::of(size);
        self.x.iter_mut().for_each(|x| *x /= size);
        self.blocks = self.blocks.into_iter().map(|b| b.over(size)).collect();
        (self.tau, self.kappa) = (self.tau / size, self.kappa / size);
        self
    }

    fn rounded(&self) -> Rounded {
        Rounded {
            x: self.x.iter().map(|v| v.double()).collect(),
            multiplier: self.blocks.iter().map(|b| rounded(&b.multiplier)).collect(),
            tau: self.tau.double(),
        }
    }
}

impl Iterate<f64> {
    fn exact(&self) -> Option<Iterate<faer::fx128>> {
        let blocks = self.blocks.iter().map(|b| Scaled::new(cast(&b.slack), cast(&b.multiplier)));
        Some(Iterate {
            x: self.x.iter().map(|v| Real::of(*v)).collect(),
            blocks: blocks.collect::<Option<_>>()?,
            tau: Real::of(self.tau),
            kappa: Real::of(self.kappa),
        })
    }
}

/// What is reported of an iterate.
pub(super) struct Rounded {
    pub x: Vec<f64>,
    pub multiplier: Vec<Mat>,
    pub tau: f64,
}
