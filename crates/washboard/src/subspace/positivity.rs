//! A fitted spectrum that falls below zero somewhere: found, and lifted by least squares under constraints.

use super::SubspaceError;
use super::samples::Samples;
use super::summand::{LeastSquares, Summand};
use crate::linalg::{C64, CMat, LinalgError, Mat, RealSchur};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Repaired spectra stay above this share of the smallest positive sample between the samples.
const FLOOR: f64 = 1e-2;
/// The same beyond the samples, the first with which a factor is found: a spectrum that falls to zero at infinite frequency
/// touches zero at π, and should not be lifted there by more than double precision asks for.
pub(super) const FLOORS_BEYOND: [f64; 4] = [1e-9, 1e-7, 1e-5, 1e-3];
/// Floors are no lower than this share of the largest sample: what double precision keeps of a factor.
const LEAST_FLOOR: f64 = 1e-13;
/// Rounds of cutting planes.
const ROUNDS: usize = 60;
/// After so many rounds constraints ask for as much more as is missing: little by then, and cuts end that would go on to creep.
const PATIENT: usize = 12;
/// Angles of the even grid on which minima are looked for.
const GRID: usize = 1024;
/// Samples that are looked at.
const MOST_SAMPLES: usize = 8 * GRID;
/// Steps of golden section at each minimum.
const GOLDEN: usize = 40;

/// What was done to a spectrum that was not positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Repair {
    /// Its smallest eigenvalue before.
    pub least_before: f64,
    /// Where that was, rad.
    pub theta_rad: f64,
    /// The floor that it was lifted to.
    pub floor: f64,
    /// Rounds of constraints.
    pub rounds: usize,
    /// Root of the weighted sum of squares before and after.
    pub misfit: [f64; 2],
}

/// Angles at which a spectrum is looked at: the samples', an even grid, and a fan about every pole.
pub(super) fn angles(samples: &Samples, a: &Mat) -> Result<Vec<f64>, LinalgError> {
    let mut all: Vec<f64> = (0..=GRID).map(|k| PI * k as f64 / GRID as f64).collect();
    // of very many samples some: what lies between is a function of few states
    all.extend(samples.theta_rad().iter().step_by(samples.count().div_ceil(MOST_SAMPLES).max(1)));
    for pole in RealSchur::new(a)?.eigenvalues() {
        let (angle, distance) = (pole.arg().abs(), (1.0 - pole.norm()).max(1e-9));
        for k in -8..=8 {
            all.push(angle + distance * f64::from(k) / 4.0);
        }
    }
    // fine towards 0, where road spectra are steep
    all.extend((1..60).map(|k| PI * 0.7f64.powi(k)));
    all.retain(|t| (0.0..=PI).contains(t));
    all.sort_by(f64::total_cmp);
    all.dedup();
    Ok(all)
}

/// χ at angles that are looked at again and again: of all summands that differ in E and F alone.
struct Seen<'a> {
    angles: &'a [f64],
    chi: Vec<CMat>,
}

impl<'a> Seen<'a> {
    fn of(s: &Summand, angles: &'a [f64]) -> Result<Self, LinalgError> {
        let chi = angles.par_iter().map(|t| s.chi(*t)).collect::<Result<_, _>>()?;
        Ok(Seen { angles, chi })
    }

    fn least(&self, s: &Summand) -> Result<Vec<f64>, LinalgError> {
        self.chi.par_iter().map(|chi| hermitian_least(&s.with_chi(chi))).collect()
    }
}

/// λ_min of S(θ).
fn least(s: &Summand, theta: f64) -> Result<f64, LinalgError> {
    let value = s.at(theta)?;
    hermitian_least(&value)
}

/// Smallest eigenvalue of a Hermitian matrix.
fn hermitian_least(s: &CMat) -> Result<f64, LinalgError> {
    let m = s.nrows();
    if m == 1 {
        return Ok(s[(0, 0)].re);
    }
    let values = s
        .self_adjoint_eigenvalues(faer::Side::Lower)
        .map_err(|_| LinalgError::NoConvergence { what: "the eigenvalues of S", order: m })?;
    Ok(values[0])
}

/// All, with their vectors.
fn hermitian(s: &CMat) -> Result<Vec<(f64, Vec<C64>)>, LinalgError> {
    let m = s.nrows();
    let eigen = s
        .self_adjoint_eigen(faer::Side::Lower)
        .map_err(|_| LinalgError::NoConvergence { what: "the eigenvalues of S", order: m })?;
    Ok((0..m).map(|k| (eigen.S()[k].re, (0..m).map(|i| eigen.U()[(i, k)]).collect())).collect())
}

/// Local minima of λ_min below a floor, refined: angle and value.
fn minima(
    s: &Summand,
    seen: &Seen<'_>,
    floor: &(dyn Fn(f64) -> f64 + Sync),
) -> Result<Vec<(f64, f64)>, LinalgError> {
    let (angles, values) = (seen.angles, seen.least(s)?);
    let last = angles.len() - 1;
    let low = |k: usize| -> Result<Option<(f64, f64)>, LinalgError> {
        let (before, after) = (k.saturating_sub(1), (k + 1).min(last));
        let rise = (values[before] - values[k]).abs().max((values[after] - values[k]).abs());
        // between two angles it may fall by about what it rises on either side
        if values[k] > values[before] || values[k] > values[after] || values[k] > floor(angles[k]) + rise {
            return Ok(None);
        }
        let (theta, value) = golden(s, angles[before], angles[after])?;
        let best = if value < values[k] { (theta, value) } else { (angles[k], values[k]) };
        Ok((best.1 < floor(best.0)).then_some(best))
    };
    let found: Vec<Option<(f64, f64)>> = (0..=last).into_par_iter().map(low).collect::<Result<_, _>>()?;
    Ok(found.into_iter().flatten().collect())
}

fn golden(s: &Summand, mut low: f64, mut high: f64) -> Result<(f64, f64), LinalgError> {
    let share = 0.5 * (5f64.sqrt() - 1.0);
    let (mut x, mut y) = (high - share * (high - low), low + share * (high - low));
    let (mut fx, mut fy) = (least(s, x)?, least(s, y)?);
    for _ in 0..GOLDEN {
        if fx < fy {
            (high, y, fy) = (y, x, fx);
            x = high - share * (high - low);
            fx = least(s, x)?;
        } else {
            (low, x, fx) = (x, y, fy);
            y = low + share * (high - low);
            fy = least(s, y)?;
        }
    }
    Ok(if fx < fy { (x, fx) } else { (y, fy) })
}

/// The least-squares fit under vᴴS(θ)v ≥ floor, constraints added at each minimum (with its v) until none is below; given up where its misfit
/// exceeds `limit`.
///
/// Source: cutting planes for the semi-infinite constraint; each round is a least-distance problem (Lawson and Hanson).
pub(super) fn lifted(
    samples: &Samples,
    fit: &LeastSquares,
    first: Summand,
    floor_beyond: f64,
    limit: f64,
) -> Result<(Summand, Option<Repair>), SubspaceError> {
    let sizes = samples.s().iter().map(hermitian_least).collect::<Result<Vec<_>, _>>()?;
    let largest = samples.s().iter().map(|s| s.norm_max()).fold(0.0, f64::max);
    let smallest = sizes.iter().copied().filter(|v| *v > 0.0).fold(f64::INFINITY, f64::min);
    let band = [samples.theta_rad()[0], samples.theta_rad()[samples.count() - 1]];
    let share = |theta: f64| if (band[0]..=band[1]).contains(&theta) { FLOOR } else { floor_beyond };
    let floor = |theta: f64| (share(theta) * smallest).max(LEAST_FLOOR * largest);
    let angles = angles(samples, &first.a)?;
    let touches = 0.1 * floor_beyond;
    let seen = Seen::of(&first, &angles)?;
    let mut below = minima(&first, &seen, &|_| (touches * smallest).max(0.1 * LEAST_FLOOR * largest))?;
    if below.is_empty() {
        return Ok((first, None));
    }
    let worst =
        |below: &[(f64, f64)]| below.iter().copied().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0.0, 0.0));
    let (theta_rad, least_before) = worst(&below);
    let (mut rows, mut aims, mut s): (Vec<Vec<f64>>, Vec<f64>, Summand) = (Vec::new(), Vec::new(), first);
    let mut multipliers = Vec::new();
    for rounds in 1..=ROUNDS {
        for (theta, _) in &below {
            // a little above the floor, so that a finite number of rounds ends there
            let aim = 1.5 * floor(*theta);
            for (k, (value, v)) in hermitian(&s.at(*theta)?)?.into_iter().enumerate() {
                if k == 0 || value < aim {
                    rows.push(fit.row(*theta, &v)?);
                    let over = if rounds > PATIENT { (-value).max(0.0) } else { 0.0 };
                    aims.push(aim + over);
                }
            }
        }
        let change = fit.constrained(&rows, &aims, &mut multipliers)?;
        s = fit.summand(&change);
        // constraints are only added: the misfit only grows
        if fit.misfit(Some(&change)) > limit {
            let (theta_rad, least) = worst(&below);
            return Err(SubspaceError::NotPositive { order: s.a.nrows(), least, theta_rad, rounds });
        }
        below = minima(&s, &seen, &floor)?;
        if below.is_empty() {
            let misfit = [fit.misfit(None), fit.misfit(Some(&change))];
            return Ok((
                s,
                Some(Repair { least_before, theta_rad, floor: floor(theta_rad), rounds, misfit }),
            ));
        }
    }
    let (theta_rad, least) = worst(&below);
    Err(SubspaceError::NotPositive { order: s.a.nrows(), least, theta_rad, rounds: ROUNDS })
}

#[cfg(test)]
mod tests {
    use super::super::Unpaired;
    use super::super::poles::poles;
    use super::super::range::Range;
    use super::super::samples::Weights;
    use super::super::summand::Parity;
    use super::*;
    use rand::{Rng, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// Noisy samples of |1 + z|² on one channel, and of the same turned into two.
    fn noisy(m: usize, seed: u64) -> Samples {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let theta: Vec<f64> = (0..150).map(|k| PI * (f64::from(k) + 0.5) / 150.0).collect();
        let s = theta
            .iter()
            .map(|t| {
                let mut noise = || 0.15 * rng.random_range(-1.0..1.0);
                let (one, two) = (2.0 + 2.0 * t.cos() + noise(), 3.0 + noise());
                let turn = 0.6f64;
                let (c, d) = (turn.cos(), turn.sin());
                let full = [
                    [c * c * one + d * d * two, c * d * (one - two)],
                    [c * d * (one - two), d * d * one + c * c * two],
                ];
                CMat::from_fn(m, m, |i, j| C64::new(if m == 1 { one } else { full[i][j] }, 0.0))
            })
            .collect();
        Samples::of_any_sign(theta, s, Weights::Equal).unwrap()
    }

    fn fitted(samples: &Samples) -> LeastSquares {
        let p = 12;
        let range = Range::of(samples, p, Some(1), false).unwrap();
        let (a, c, folded) = poles(&range, samples, p, 1, Unpaired::Fold).unwrap();
        LeastSquares::of(samples, Parity::Even, a, c, folded).unwrap()
    }

    /// The cutting planes' optimum against one solve with a constraint at every angle of a fine grid.
    #[test]
    fn few_constraints_are_as_good_as_all() {
        let mut lifted_ones = 0;
        for seed in 0..12 {
            let samples = noisy(1, seed);
            let fit = fitted(&samples);
            let (s, repair) = lifted(&samples, &fit, fit.best(), FLOORS_BEYOND[0], f64::INFINITY).unwrap();
            let Some(repair) = repair else { continue };
            lifted_ones += 1;
            let grid: Vec<f64> = (0..=800).map(|k| PI * f64::from(k) / 800.0).collect();
            assert!(grid.iter().all(|t| least(&s, *t).unwrap() > 0.0), "{seed}");
            let one = [C64::new(1.0, 0.0)];
            let rows: Vec<Vec<f64>> = grid.iter().map(|t| fit.row(*t, &one).unwrap()).collect();
            let all = fit.constrained(&rows, &vec![0.0; rows.len()], &mut Vec::new()).unwrap();
            let best = fit.misfit(Some(&all));
            // the floor costs a little, the grid's gaps save a little
            assert!((repair.misfit[1] / best - 1.0).abs() < 3e-4, "{seed}: {repair:?} {best}");
            assert!(repair.misfit[0] <= repair.misfit[1]);
        }
        assert!(lifted_ones >= 3, "{lifted_ones}");
    }

    #[test]
    fn matrices_are_lifted_along_their_smallest_direction() {
        let mut lifted_ones = 0;
        for seed in 0..12 {
            let samples = noisy(2, seed);
            let fit = fitted(&samples);
            let (s, repair) = lifted(&samples, &fit, fit.best(), FLOORS_BEYOND[0], f64::INFINITY).unwrap();
            lifted_ones += usize::from(repair.is_some());
            for k in 0..=800 {
                let value = least(&s, PI * f64::from(k) / 800.0).unwrap();
                assert!(value > 0.0, "{seed}: {value:e}");
            }
        }
        assert!(lifted_ones >= 3, "{lifted_ones}");
    }

    /// Four wheels, the rear behind the front: a spectrum of rank 2, which every fit without all of the delay makes negative along an arc.
    #[test]
    fn delays_take_few_rounds() {
        let omega: Vec<f64> = (0..120).map(|k| 0.5 * 300f64.powf(f64::from(k) / 119.0)).collect();
        let (lambda, corner) = ((0.5f64 * 150.0).sqrt(), 300.0);
        let s: Vec<CMat> = omega
            .iter()
            .map(|w| {
                let size = (1.0 + (w / corner).powi(2)).powi(2) / (9.0 + w * w);
                let behind = [C64::new(1.0, 0.0), C64::from_polar(1.0, -0.13 * w)];
                let side = |i: usize, j: usize| if i % 2 == j % 2 { 1.0 } else { 0.6 };
                CMat::from_fn(4, 4, |i, j| behind[i / 2] * behind[j / 2].conj() * (size * side(i, j)))
            })
            .collect();
        let variances = s.iter().map(|s| s[(0, 0)].re.powi(2)).collect();
        let theta = omega.iter().map(|w| 2.0 * (w / lambda).atan()).collect();
        let samples = Samples::of_any_sign(theta, s, Weights::Variances(variances)).unwrap();
        let mut rounds = Vec::new();
        for order in [12, 16, 20, 22] {
            let (p, fold) = (64, Unpaired::Fold);
            let range = Range::of(&samples, p, Some(order), true).unwrap();
            let (a, c, folded) = poles(&range, &samples, p, order, fold).unwrap();
            let fit = LeastSquares::of(&samples, Parity::Even, a, c, folded).unwrap();
            let (_, repair) = lifted(&samples, &fit, fit.best(), FLOORS_BEYOND[0], f64::INFINITY).unwrap();
            rounds.push(repair.unwrap().rounds);
        }
        // up to 36 where constraints never ask for more than the floor
        assert!(rounds.iter().all(|r| *r <= 24), "{rounds:?}");
    }
}
