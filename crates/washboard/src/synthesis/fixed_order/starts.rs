//! Where a search begins: nothing, chance, what is given, and controllers of other orders made to fit.

use super::problem::Problem;
use super::structure::{block_of, controller_of};
use crate::linalg::Mat;
use crate::lti::{Continuous, LtiError, StateSpace};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Sizes of random starts.
const SIZES: [f64; 8] = [0.3, 1.0, 0.1, 3.0, 0.3, 10.0, 1.0, 30.0];

/// Where the pole of a state that is added stands, in decades above its usual place.
const ADDED: [f64; 3] = [0.0, 1.0, -1.0];
/// The same of a pair that oscillates: poles that are real hardly become one on the way.
const OSCILLATING: [f64; 2] = [0.0, 0.7];
/// Its damping.
const LIGHT: f64 = 0.3;
/// Decades, a standard deviation.
const SPREAD: f64 = 1.0;
/// How far a result is shaken, as a share of each number.
const SHAKES: [f64; 8] = [0.03, 0.1, 0.3, 1.0, 0.05, 0.2, 0.5, 2.0];

/// No gain at all; the controller's own poles at the pace of the plants, apart from each other.
pub(super) fn silent(problem: &Problem) -> Vec<f64> {
    let s = &problem.structure;
    let n = s.order();
    let block =
        Mat::from_fn(s.rows(), s.cols(), |i, j| if i == j && i < n { own_pole(problem, i) } else { 0.0 });
    problem.of_block(&block)
}

/// A number of random starts.
pub(super) fn random(problem: &Problem, count: usize, seed: u64) -> Vec<Vec<f64>> {
    (0..count)
        .map(|k| {
            let mut rng = ChaCha8Rng::seed_from_u64(seed.wrapping_mul(0x9e37_79b9).wrapping_add(k as u64));
            let mut x = silent(problem);
            let size = SIZES[k % SIZES.len()];
            // every other start has numbers of all sizes: of some plants the units say little
            let spread = if k % 8 < 4 { 0.0 } else { SPREAD };
            for v in &mut x {
                let z: f64 = StandardNormal.sample(&mut rng);
                let decades: f64 = StandardNormal.sample(&mut rng);
                *v += size * 10f64.powf(spread * decades) * z;
            }
            x
        })
        .collect()
}

/// Places around a result, from near to far.
pub(super) fn around(x: &[f64], seed: u64) -> Vec<Vec<f64>> {
    let size = (x.iter().map(|v| v * v).sum::<f64>() / x.len().max(1) as f64).sqrt();
    SHAKES
        .iter()
        .enumerate()
        .map(|(k, shake)| {
            let mut rng = ChaCha8Rng::seed_from_u64(seed.wrapping_mul(0x517c_c1b7).wrapping_add(k as u64));
            let moved = |v: &f64| {
                let z: f64 = StandardNormal.sample(&mut rng);
                v + shake * z * (v.abs() + 0.1 * size)
            };
            x.iter().map(moved).collect()
        })
        .collect()
}

/// A controller made to fit: one with more states truncated, one with fewer given states that nothing reads yet, slow ones,
/// and fast ones, where one more is as many as it gets.
pub(super) fn fitted(problem: &Problem, k: &StateSpace<Continuous>, seed: u64) -> Vec<Vec<f64>> {
    let s = &problem.structure;
    if (k.outputs(), k.inputs()) != (s.controls(), s.measurements()) {
        return Vec::new();
    }
    let n = s.order();
    if k.order() > n {
        let less = k.balanced_truncation(n);
        return less.map_or_else(|_| Vec::new(), |less| fitted(problem, &less.system, seed));
    }
    let Some(small) = balanced(problem, k) else { return Vec::new() };
    let usual = Added { decades: 0.0, damping: 1.0 };
    let added: Vec<Added> = match n - k.order() {
        1 => ADDED.map(|decades| Added { decades, ..usual }).to_vec(),
        2 => {
            OSCILLATING.map(|decades| Added { decades, damping: LIGHT }).into_iter().chain([usual]).collect()
        }
        _ => vec![usual],
    };
    added.iter().map(|added| extended(problem, &small, *added, seed)).collect()
}

/// Where the poles of added states stand: above their usual places, and of a pair its damping.
#[derive(Debug, Clone, Copy)]
struct Added {
    decades: f64,
    damping: f64,
}

/// A controller with states more than it has, which nothing reads yet.
fn extended(problem: &Problem, k: &StateSpace<Continuous>, added: Added, seed: u64) -> Vec<f64> {
    let s = &problem.structure;
    let mut rng = ChaCha8Rng::seed_from_u64(seed ^ 0xf17);
    let small = block_of(k);
    let (own, order) = (k.order(), s.order());
    // states of the smaller first, then the new ones, then signals
    let old = |i: usize| {
        if i < own { Some(i) } else { i.checked_sub(order).map(|i| i + own) }
    };
    let mut block = Mat::from_fn(s.rows(), s.cols(), |i, j| match (old(i), old(j)) {
        (Some(i), Some(j)) => small[(i, j)],
        _ => 0.0,
    });
    for i in own..order {
        block[(i, i)] = within(problem, own_pole(problem, i) * 10f64.powf(added.decades));
        for j in order..s.cols() {
            let z: f64 = StandardNormal.sample(&mut rng);
            block[(i, j)] = 0.5 * z * problem.scales.unit(order, i, j);
        }
    }
    if added.damping < 1.0 && order == own + 2 {
        // one frequency for both: −ζω ± iω√(1 − ζ²)
        let (i, j) = (own, own + 1);
        let omega = block[(i, i)].abs();
        let across = omega * (1.0 - added.damping * added.damping).sqrt();
        (block[(i, i)], block[(j, j)]) = (-added.damping * omega, -added.damping * omega);
        (block[(i, j)], block[(j, i)]) = (across, -across);
    }
    problem.of_block(&block)
}

/// States of like size in B and C, as the units see them.
fn balanced(problem: &Problem, k: &StateSpace<Continuous>) -> Option<StateSpace<Continuous>> {
    let n = k.order();
    if n == 0 {
        return Some(k.clone());
    }
    let units = &problem.scales;
    let block = block_of(k);
    let scaled = Mat::from_fn(block.nrows(), block.ncols(), |i, j| block[(i, j)] / units.unit(n, i, j));
    let (_, t) = controller_of(&scaled, n).ok()?.balanced_scales().ok()?;
    k.with_states_scaled(&t).ok()
}

/// Poles of new states: around the pace, two a decade, where controllers and loops may have poles.
fn own_pole(problem: &Problem, i: usize) -> f64 {
    let place = [0.0, 0.5, -0.5, 1.0, -1.0, 0.25, -0.25, 0.75][i % 8] + 0.05 * (i / 8) as f64;
    within(problem, -problem.scales.pace * 10f64.powf(place))
}

/// A pole where controllers may have theirs.
fn within(problem: &Problem, pole: f64) -> f64 {
    let (slowest, fastest) = problem.own_poles;
    -pole.abs().max(slowest).min(fastest)
}

/// A controller with more states that nothing reaches and nothing reads.
pub(super) fn padded(
    k: &StateSpace<Continuous>,
    order: usize,
    pole: f64,
) -> Result<StateSpace<Continuous>, LtiError> {
    let own = k.order();
    let a = Mat::from_fn(order, order, |i, j| match (i < own, j < own) {
        (true, true) => k.a()[(i, j)],
        (false, false) if i == j => -pole,
        _ => 0.0,
    });
    let b = Mat::from_fn(order, k.inputs(), |i, j| if i < own { k.b()[(i, j)] } else { 0.0 });
    let c = Mat::from_fn(k.outputs(), order, |i, j| if j < own { k.c()[(i, j)] } else { 0.0 });
    StateSpace::continuous(a, b, c, k.d().clone())
}
