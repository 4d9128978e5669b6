//! From the results of all starts to the one that is verified: shaken, searched to the end, its norms by other routes.

use super::asked::{FixedOrder, FixedOrderSettings};
use super::problem::{Id, Problem};
use super::search::{KEPT, Led, MET, as_it_is, better, from, further, race, sort};
use super::starts;
use super::structure::controller_of;
use super::targets::Measure;
use super::verify::{self, Values};
use crate::lti::{Continuous, StateSpace};
use crate::optimize::{BundleResult, BundleSettings, Pieces};
use crate::synthesis::SynthesisError;
use rayon::prelude::*;

/// With so many random starts every start is stabilised by all means, and results are shaken longer.
pub(super) const PATIENT: usize = 16;
/// A relative gain below this is none until the best of all is known.
pub(super) const MIDDLE: f64 = 1e-6;
/// The search's value of a norm may be below the verified one by this share, or its frequency is added and the search
/// goes on.
const SEEN: f64 = 1e-6;
/// Rounds of that.
const ROUNDS: usize = 6;
/// Steps of a search from a shaken result.
const MEDIUM: usize = 25;
/// What is above the best by less than this (in ln) after these is searched to the end.
const PROMISING: f64 = 1e-3;
/// So many of a round's are.
const FOLLOWED: usize = 2;
/// Rounds of shaking without a gain of [`GAIN`] (in ln) that end it.
const VAIN: usize = 2;
const GAIN: f64 = 2e-5;

/// A result, verified; whether the search has no frequency left where its norms are lower than they are.
pub(super) type Settled = (BundleResult<Id>, StateSpace<Continuous>, Values, bool);

/// The best of the results, shaken, whose norms are what independent ones are: where these are higher, their frequencies
/// are looked at from then on, and all results are compared again. None where no loop is stable by them.
pub(super) fn settled(
    asked: &FixedOrder,
    problem: &mut Problem,
    mut results: Vec<BundleResult<Id>>,
    settings: &FixedOrderSettings,
    long: &BundleSettings,
) -> Result<Option<Settled>, SynthesisError> {
    let Some(first) = results.first().cloned() else { return Ok(None) };
    let alike = |r: &&BundleResult<Id>| r.violation <= MET && (r.goal - first.goal).abs() < GAIN;
    let agreed = results.len() >= KEPT && results.iter().all(|r| alike(&r));
    let middle = BundleSettings { tolerance: settings.tolerance.max(MIDDLE), ..*long };
    let best = shaken(problem, first.clone(), settings, &middle, agreed);
    results.insert(0, further(problem, &best, long));
    let mut last = None;
    let mut round = 0;
    while let Some(best) = results.first().cloned() {
        let Ok((controller, values)) = verified(asked, problem, &best) else {
            // a pole on the axis but for rounding, a loop that is hardly well posed: no candidate
            results.remove(0);
            continue;
        };
        round += 1;
        let missed = missed(asked, problem, &best, &values);
        last = Some((best, controller, values, missed.is_empty()));
        // what is searched after the last round would be verified by nothing
        if missed.is_empty() || round == ROUNDS {
            break;
        }
        problem.frequencies.extend(missed);
        results = results.iter().filter_map(|r| as_it_is(problem, &r.x, r.penalty)).collect();
        sort(&mut results);
        if let Some(first) = results.first() {
            let again = further(problem, first, long);
            results.insert(0, again);
        }
    }
    Ok(last)
}

/// A result shaken and searched from again, for as long as that gains.
fn shaken(
    problem: &Problem,
    mut best: BundleResult<Id>,
    settings: &FixedOrderSettings,
    long: &BundleSettings,
    agreed: bool,
) -> BundleResult<Id> {
    let patient = settings.tries >= PATIENT;
    let (steps, most) = match (patient, agreed) {
        (true, _) => (4 * MEDIUM, 3 * VAIN),
        // starts that are far apart led to it
        (false, true) => (MEDIUM, 1),
        (false, false) => (MEDIUM, VAIN),
    };
    let mut vain = 0;
    for round in 0..settings.tries {
        let places = starts::around(&best.x, settings.seed.wrapping_add(7919 * (round as u64 + 1)));
        let medium = BundleSettings {
            iterations: steps.min(long.iterations),
            evaluations: 4 * steps,
            tolerance: 1e-5,
            penalty: best.penalty,
            ..BundleSettings::default()
        };
        let led: Vec<Led> = if patient {
            places.par_iter().map(|x| from(problem, x, &medium, true)).collect()
        } else {
            race(problem, &places, 0, &medium, &[(8, 3)])
        };
        let mut new: Vec<BundleResult<Id>> =
            led.into_iter().filter_map(|l| if let Led::To(r) = l { Some(*r) } else { None }).collect();
        sort(&mut new);
        let before = best.goal;
        let promising = |r: &BundleResult<Id>| {
            let near =
                r.goal < best.goal + PROMISING && r.violation <= MET + PROMISING * best.violation.max(MET);
            better(r, &best, MET) || (near && (r.goal - best.goal).abs() > GAIN)
        };
        // the next one too: it costs no time where there is a second core
        let next: Vec<BundleResult<Id>> = new.into_iter().filter(promising).take(FOLLOWED).collect();
        let led: Vec<BundleResult<Id>> = next.par_iter().map(|r| further(problem, r, long)).collect();
        for r in led {
            if better(&r, &best, MET) {
                best = r;
            }
        }
        vain = if before - best.goal > GAIN { 0 } else { vain + 1 };
        if vain == most {
            break;
        }
    }
    best
}

fn verified(
    asked: &FixedOrder,
    problem: &Problem,
    best: &BundleResult<Id>,
) -> Result<(StateSpace<Continuous>, Values), SynthesisError> {
    let controller = controller_of(&problem.block(&best.x), problem.structure.order())?;
    let mut values = verify::values(&asked.plants, &asked.targets, &controller)?;
    // a gain at any frequency is no more than the norm: the higher of both is nearer to it
    if let Some(pieces) = problem.pieces(&best.x) {
        let seen = problem.values(&pieces);
        for ((t, value), (w, seen)) in
            asked.targets.iter().zip(&mut values).zip(problem.wanted.iter().zip(seen))
        {
            let norm = (seen + w.unit).exp();
            if matches!(t.measure, Measure::Hinf(_)) && norm > value.0 {
                value.0 = norm;
            }
        }
    }
    Ok((controller, values))
}

/// Frequencies of norms that the search has lower than they are.
fn missed(asked: &FixedOrder, problem: &Problem, best: &BundleResult<Id>, values: &Values) -> Vec<f64> {
    let Some(pieces) = problem.pieces(&best.x) else { return Vec::new() };
    let seen = problem.values(&pieces);
    (0..asked.targets.len())
        .filter_map(|k| {
            let omega = values[k].1.filter(|w| w.is_finite() && *w > 0.0)?;
            let claimed = (seen[k] + problem.wanted[k].unit).exp();
            let new = problem.frequencies.iter().all(|w| (w / omega - 1.0).abs() > 1e-9);
            (values[k].0 > claimed * (1.0 + SEEN) && new).then_some(omega)
        })
        .collect()
}
