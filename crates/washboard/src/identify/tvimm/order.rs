//! How many modes: more where the residual asks for them, fewer where a pair of poles became real.

use super::model::{FreeModel, Point};
use super::outcome::FreeOrder;
use super::search::{self, Found};
use super::{SAME_COST, chi, extra};
use crate::identify::likelihood::CHI_LIMIT;
use crate::linalg::C64;

/// Noise is raised by these factors with a mode more, one after another: from the untouched starts 24 to 80 steps lead to
/// the answer where quieter ones end in local minima.
const ANNEALING: [f64; 3] = [300.0, 15.0, 1.0];
/// Modes that are added to the starts' at most.
const MOST_EXTRA: usize = 3;

/// The answer with as many modes as the data ask for.
pub(super) struct Chosen {
    pub found: Found,
    /// The numbers of modes that were tried, fewest first.
    pub orders: Vec<FreeOrder>,
    /// Whether two searches ended at the answer; None where no mode was added.
    pub confirmed: Option<bool>,
}

/// The first search with a mode more, from the first of the untouched starts: [`choose`] always makes it, whatever the
/// answer without that mode is.
pub(super) struct Ahead {
    from: Point,
    found: Option<Found>,
}

/// See [`Ahead`]; None where there is no room for a mode more.
pub(super) fn ahead(model: &FreeModel, bases: &[Point], band_hz: [f64; 2]) -> Option<Ahead> {
    let from = one_more(model, &search::look(model, bases.first()?)?, band_hz)?;
    let found = search::search(model, &from, &ANNEALING);
    Some(Ahead { from, found })
}

/// Tries a mode more, always once, and goes on while Bayes' criterion falls.
///
/// A mode more starts where the residual asks for it most, at the untouched starts before the best answer: an answer with
/// a mode too few bends the others to stand in for it, and its residual says little.
pub(super) fn choose(
    model: &FreeModel,
    first: Found,
    bases: &[Point],
    mut ahead: Option<Ahead>,
    band_hz: [f64; 2],
) -> Chosen {
    let mut orders = vec![order(model, &first)];
    let mut best = first;
    let mut confirmed = None;
    for extra in 0..MOST_EXTRA {
        let now = order(model, &best);
        let sound = now.chi <= CHI_LIMIT && now.converged && real_poles(&best) == 0;
        // the first of the untouched starts was searched ahead
        let from_bases =
            bases.iter().skip(1).filter(|_| extra == 0).filter_map(|base| search::look(model, base));
        let points = from_bases
            .filter_map(|here| one_more(model, &here, band_hz))
            .chain(one_more(model, &best, band_hz))
            .map(|from| Ahead { found: search::search(model, &from, &ANNEALING), from });
        let mut tried: Vec<Found> = Vec::new();
        for Ahead { from, found } in ahead.take().into_iter().chain(points) {
            let found = match found {
                Some(found) if !sound => search::search_on(model, &from, found),
                found => found,
            };
            let Some(found) = found else { continue };
            let better = order(model, &found).bic < now.bic;
            tried.push(found);
            tried.sort_by(|a, b| a.score.cost.total_cmp(&b.score.cost));
            if !better && sound || agree(&tried) {
                break;
            }
        }
        let agreed = agree(&tried);
        let Some(found) = tried.into_iter().next() else { break };
        let next = order(model, &found);
        let better = next.bic < now.bic;
        orders.push(next);
        if !better {
            break;
        }
        confirmed = Some(agreed);
        best = found;
    }
    while real_poles(&best) > 0 && best.at.system.order() > 2 {
        let Some(found) = without_a_mode(model, &best) else { break };
        let next = order(model, &found);
        let better = next.bic < order(model, &best).bic;
        match orders.iter_mut().find(|o| o.modes == next.modes) {
            Some(known) if known.bic <= next.bic => {}
            Some(known) => *known = next,
            None => orders.push(next),
        }
        if !better {
            break;
        }
        best = found;
    }
    orders.sort_by_key(|o| o.modes);
    let chosen = best.at.system.order() / 2;
    orders.iter_mut().for_each(|o| o.chosen = o.modes == chosen);
    Chosen { found: best, orders, confirmed }
}

fn one_more(model: &FreeModel, here: &Found, band_hz: [f64; 2]) -> Option<Point> {
    let candidate = extra::candidate(model, here, band_hz)?;
    Some(Point { system: candidate.system, ..here.at.clone() })
}

/// Whether the two best searches, sorted, ended at the same cost.
fn agree(tried: &[Found]) -> bool {
    matches!(tried, [a, b, ..] if b.score.cost - a.score.cost < SAME_COST)
}

/// The best answer with two states less, from its balanced truncation.
fn without_a_mode(model: &FreeModel, best: &Found) -> Option<Found> {
    let (system, _) = best.at.system.balanced(best.at.system.order() - 2).ok()?;
    search::search_patiently(model, &Point { system, ..best.at.clone() }, &ANNEALING)
}

fn real_poles(found: &Found) -> usize {
    let real = |p: &&C64| p.im == 0.0;
    found.at.system.poles().map_or(0, |poles| poles.iter().filter(real).count())
}

fn order(model: &FreeModel, found: &Found) -> FreeOrder {
    let parameters = found.score.gradient.len();
    // as many independent numbers as the band holds in all channels
    let numbers = model.data.averages * (model.data.omega.len() * model.derivatives.len()) as f64;
    FreeOrder {
        modes: found.at.system.order() / 2,
        parameters,
        cost: found.score.cost,
        bic: 2.0 * found.score.cost + parameters as f64 * numbers.ln(),
        chi: chi(model, found),
        converged: found.converged,
        chosen: false,
    }
}
