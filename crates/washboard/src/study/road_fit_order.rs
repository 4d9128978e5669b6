//! The choice of a road filter's order.

use super::FitOrder;
use super::road_fit_filter::{Feedthrough, FilterProblem, Found, RoadFilter};
use crate::linalg::{C64, CMat};
use crate::subspace::{Order, ShapeSettings, ShapeWeights, SubspaceError, Weights};

/// Relative errors below this are rounding: a higher order can't be better.
const EXACT: f64 = 1e-8;
/// Exact data are followed to this log₁₀ error (rms) by the order that singular values tell: none is better.
const FOLLOWED: f64 = 1e-6;
/// A road is followed to this log₁₀ error (rms), where an order is to be chosen.
pub(super) const ACCURATE: f64 = 0.02;

/// How an order is chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Choice {
    /// N ln(Σ w r²/N) + k ln N of the relative errors r is smallest: noisy samples.
    Criterion,
    /// The lowest order that is accurate, or else the most accurate: exact samples.
    Accuracy,
}

/// What one order gave: its error, and the orders that singular values tell.
struct Attempt {
    error: f64,
    told: Vec<usize>,
}

/// The filter of the best order from 1 to `most` (of a matrix: of the multiples of its size, and first of the one that singular
/// values tell), and all that were tried.
pub(super) fn choose(
    omega: &[f64],
    s: &[CMat],
    settings: &ShapeSettings,
    feedthrough: Feedthrough,
    most: usize,
    choice: Choice,
) -> Result<(RoadFilter, Vec<FitOrder>), SubspaceError> {
    let m = s.first().map_or(1, |s| s.nrows());
    let mut tried: Vec<FitOrder> = Vec::new();
    let mut best: Option<(f64, RoadFilter)> = None;
    let mut failure = None;
    let mut problem = FilterProblem::new(omega, s, settings, feedthrough)?;
    let mut attempt =
        |order: usize, best: &mut Option<(f64, RoadFilter)>| -> Result<Attempt, SubspaceError> {
            match problem.fit(Order::Given(order)) {
                Err(e) => {
                    tried.push(failed(order));
                    failure = Some(e);
                    Ok(Attempt { error: f64::INFINITY, told: Vec::new() })
                }
                Ok(Found { filter, told }) => {
                    let (error, found) = (filter.log10_rms_error, filter.fit.model.order);
                    let bic = criterion(&filter, omega, s, &settings.weights)?;
                    let lowered_to = (found < order).then_some(found);
                    let mut row = FitOrder {
                        order,
                        lowered_to,
                        roll_off_order: Some(filter.passes),
                        chosen: false,
                        log10_rms_error: Some(error),
                        bic: Some(bic),
                    };
                    let value = if choice == Choice::Criterion { bic } else { error };
                    if best.as_ref().is_none_or(|b| value < b.0) {
                        tried.iter_mut().for_each(|t| t.chosen = false);
                        row.chosen = true;
                        *best = Some((value, filter));
                    }
                    tried.push(row);
                    Ok(Attempt { error, told })
                }
            }
        };
    // as many states more for every channel, or one step after another
    'orders: for order in (m.min(most)..=most).step_by(m) {
        let found = attempt(order, &mut best)?;
        if choice == Choice::Accuracy && found.error < ACCURATE {
            break;
        }
        // of exact data singular values tell the order, 2n of them: a matrix's is beyond many that are slow to try
        if m > 1 && order == m {
            if found.error < FOLLOWED && found.told.contains(&order) {
                break;
            }
            for n in found.told.into_iter().filter(|n| (m + 1..=most).contains(n)) {
                if attempt(n, &mut best)?.error < FOLLOWED {
                    break 'orders;
                }
            }
        }
    }
    // an order that was tried twice stands once
    tried.sort_by_key(|t| (t.order, !t.chosen));
    tried.dedup_by_key(|t| t.order);
    match (best, failure) {
        (Some((_, filter)), _) => Ok((filter, tried)),
        (None, Some(e)) => Err(e),
        (None, None) => {
            let (expected, found) = ("1 or more".to_owned(), most.to_string());
            Err(SubspaceError::Field { field: "max_order", expected, found })
        }
    }
}

fn failed(order: usize) -> FitOrder {
    FitOrder {
        order,
        lowered_to: None,
        roll_off_order: None,
        chosen: false,
        log10_rms_error: None,
        bic: None,
    }
}

/// Bayes' criterion of the relative errors of the filter, weighted as they were fitted.
fn criterion(
    filter: &RoadFilter,
    omega: &[f64],
    s: &[CMat],
    weights: &ShapeWeights,
) -> Result<f64, SubspaceError> {
    let m = filter.system.outputs();
    let (mut sum, mut total) = (0.0, 0.0);
    for (k, (w, s)) in omega.iter().zip(s).enumerate() {
        let h = filter.system.at(C64::new(0.0, *w))?;
        let (found, size) = (&h * h.adjoint(), s.norm_l2());
        if size == 0.0 {
            continue;
        }
        let error = if m == 1 { (found[(0, 0)].re / size).ln() } else { (found - s).norm_l2() / size };
        // S²/R: how many times the error that is looked for the sample's own is not
        let weight = match weights {
            ShapeWeights::Equal => size * size,
            ShapeWeights::Relative => size,
            ShapeWeights::Given(Weights::Variances(r)) => size * size / r[k],
            ShapeWeights::RelativeSquared | ShapeWeights::Given(_) => 1.0,
        };
        sum += weight * error * error;
        total += weight;
    }
    let observed = (omega.len() * m * m) as f64;
    let unknowns = (2 * filter.fit.model.order * m + m * (m + 1) / 2) as f64;
    Ok(observed * (sum / total).max(EXACT * EXACT).ln() + unknowns * observed.ln())
}
