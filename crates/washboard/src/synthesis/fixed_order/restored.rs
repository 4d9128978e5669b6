//! Back under the bounds: a search that ended above one of them goes on with the bounds alone, then with the goal again.

use super::problem::{Id, Problem};
use super::search::{MET, as_it_is, better, further};
use crate::optimize::{BundleResult, BundleSettings, Pieces, Role, SmoothPiece, minimize};
use rayon::prelude::*;

/// A problem without its goal.
struct Bounds<'a>(&'a Problem);

impl Pieces for Bounds<'_> {
    type Id = Id;

    fn dimension(&self) -> usize {
        self.0.dimension()
    }

    fn pieces(&self, x: &[f64]) -> Option<Vec<SmoothPiece<Id>>> {
        let mut all = self.0.pieces(x)?;
        all.retain(|p| p.role != Role::Goal);
        Some(all)
    }

    fn again(&self, ids: &[&Id], x: &[f64]) -> Vec<Option<SmoothPiece<Id>>> {
        self.0.again(ids, x)
    }

    fn apart(&self, one: &Id, other: &Id) -> Option<f64> {
        self.0.apart(one, other)
    }
}

/// The results; those that exceed a bound, and have a goal below all that don't, are searched from again where the bounds
/// alone lead, if they are met there. A penalty trades bounds for the goal as it goes, and may end between them.
pub(super) fn restored(
    problem: &Problem,
    results: Vec<BundleResult<Id>>,
    settings: &BundleSettings,
) -> Vec<BundleResult<Id>> {
    let met = |r: &&BundleResult<Id>| r.violation <= MET;
    let least = results.iter().filter(met).map(|r| r.goal).fold(f64::INFINITY, f64::min);
    results
        .into_par_iter()
        .map(|r| {
            if r.violation <= MET || r.goal >= least {
                return r;
            }
            match under_bounds(problem, &r, settings) {
                Some(again) if better(&again, &r, MET) => again,
                _ => r,
            }
        })
        .collect()
}

fn under_bounds(
    problem: &Problem,
    r: &BundleResult<Id>,
    settings: &BundleSettings,
) -> Option<BundleResult<Id>> {
    let within = minimize(&Bounds(problem), &r.x, settings)?;
    let begun = as_it_is(problem, &within.x, settings.penalty)?;
    Some(if begun.violation <= MET { further(problem, &begun, settings) } else { begun })
}
