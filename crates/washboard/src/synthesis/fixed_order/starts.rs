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

/// A controller made to fit: one with more states truncated, one with fewer given states that nothing reads yet.
pub(super) fn fitted(problem: &Problem, k: &StateSpace<Continuous>, seed: u64) -> Option<Vec<f64>> {
    let s = &problem.structure;
    if (k.outputs(), k.inputs()) != (s.controls(), s.measurements()) {
        return None;
    }
    let n = s.order();
    if k.order() > n {
        let less = k.balanced_truncation(n).ok()?.system;
        return fitted(problem, &less, seed);
    }
    let mut rng = ChaCha8Rng::seed_from_u64(seed ^ 0xf17);
    let small = block_of(&balanced(problem, k)?);
    let (own, order) = (k.order(), n);
    // states of the smaller first, then the new ones, then signals
    let old = |i: usize| {
        if i < own { Some(i) } else { i.checked_sub(order).map(|i| i + own) }
    };
    let mut block = Mat::from_fn(s.rows(), s.cols(), |i, j| match (old(i), old(j)) {
        (Some(i), Some(j)) => small[(i, j)],
        _ => 0.0,
    });
    for i in own..order {
        block[(i, i)] = own_pole(problem, i);
        for j in order..s.cols() {
            let z: f64 = StandardNormal.sample(&mut rng);
            block[(i, j)] = 0.5 * z * problem.scales.unit(order, i, j);
        }
    }
    Some(problem.of_block(&block))
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
    let (slowest, fastest) = problem.own_poles;
    -(problem.scales.pace * 10f64.powf(place)).max(slowest).min(fastest)
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
