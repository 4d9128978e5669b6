//! How far a point is from being stationary: the distance of 0 from the gradients around it.

use super::bfgs::identity;
use super::model::step;
use super::pieces::{Levels, Pieces, SmoothPiece};
use super::simplex::dot;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Bounds are exceeded from here on.
const MET: f64 = 1e-6;

/// What the gradients in a ball around x say.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sampled {
    /// ‖Σ weight · gradient‖ at its least: goals' weights sum to 1; bounds' to ρ where they are exceeded, to at most ρ
    /// where they are just met, to 0 where they are met with room.
    pub distance: f64,
    /// The ball's radius.
    pub radius: f64,
    /// Points at which the functions are defined, x among them.
    pub points: usize,
}

/// The distance of 0 from the convex hull of the gradients of f + ρ max(0, c) at x and at random points within a radius:
/// 0 where x is stationary, and the steepest descent that all of them allow elsewhere. It is Goldstein's ε-subdifferential
/// as far as the points show it: a small distance is no proof that x is stationary, only that something within the
/// radius nearly is, and fewer points than n + 1 show part of it.
///
/// Pieces count that are within what the gradients let them change over the ball of the largest one.
/// None where the functions are not defined at x.
///
/// Source: Burke, Lewis and Overton, SIAM J. Optim. 15 (2005) 751–779.
pub fn sampled_subdifferential<P: Pieces>(
    problem: &P,
    x: &[f64],
    penalty: f64,
    radius: f64,
    points: usize,
    seed: u64,
) -> Option<Sampled> {
    let n = x.len();
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let here = problem.pieces(x)?;
    let exceeded = Levels::of(&here).bound > MET;
    let mut gathered: Vec<SmoothPiece<P::Id>> = near(here, radius);
    let mut counted = 1;
    for _ in 0..points {
        let direction: Vec<f64> = (0..n).map(|_| rng.random_range(-1.0..1.0)).collect();
        let length = dot(&direction, &direction).sqrt().max(f64::MIN_POSITIVE);
        let share = radius * rng.random_range(0.0f64..1.0).powf(1.0 / n.max(1) as f64) / length;
        let there: Vec<f64> = x.iter().zip(&direction).map(|(x, d)| x + share * d).collect();
        if let Some(pieces) = problem.pieces(&there) {
            counted += 1;
            gathered.extend(near(pieces, radius));
        }
    }
    // alike in height: they count as active, whichever is the largest
    for p in &mut gathered {
        p.value = 0.0;
    }
    let s = step(&gathered, &identity(n, 1.0), penalty, exceeded)?;
    Some(Sampled { distance: dot(&s.slope, &s.slope).sqrt(), radius, points: counted })
}

/// Pieces that are the largest somewhere within the radius, as far as their gradients say.
fn near<I>(pieces: Vec<SmoothPiece<I>>, radius: f64) -> Vec<SmoothPiece<I>> {
    let levels = Levels::of(&pieces);
    pieces
        .into_iter()
        .filter(|p| {
            let change = 2.0 * radius * dot(&p.gradient, &p.gradient).sqrt() + 1e-9;
            p.value >= levels.at(p.role) - change
        })
        .collect()
}
