//! The choice of a road filter's order.

use super::FitOrder;
use super::road_fit_filter::RoadFilter;
use super::road_fit_ways::{Feedthrough, FilterProblem, Found};
use super::spectrum_noise::{Noise, unlikely};
use crate::linalg::{C64, CMat};
use crate::subspace::{Order, ShapeSettings, ShapeWeights, SubspaceError, Weights};

/// Relative errors below this are rounding: a higher order can't be better.
const EXACT: f64 = 1e-8;
/// Exact data are followed to this log₁₀ error (rms) by the order that singular values tell: none is better.
const FOLLOWED: f64 = 1e-6;
/// A road is followed to this log₁₀ error (rms), where an order is to be chosen.
pub(super) const ACCURATE: f64 = 0.02;

/// How an order is chosen.
#[derive(Debug, Clone, Copy)]
pub(super) enum Choice<'a> {
    /// Bayes' criterion is smallest: of samples whose noise is known that of their likelihood, D + k ln(dN), else N ln(Σ w r²/N) + k ln N of the
    /// relative errors r.
    Criterion(Option<&'a Noise>),
    /// The lowest order that is accurate, or else the most accurate: exact samples.
    Accuracy,
}

/// An order that was fitted.
struct Try {
    row: FitOrder,
    filter: RoadFilter,
    /// Σ of [`unlikely`] over the samples; of [`Choice::Criterion`] with noise.
    unlikely: f64,
}

/// Orders of one spectrum, one after another.
struct Tries<'a> {
    omega: &'a [f64],
    s: &'a [CMat],
    weights: &'a ShapeWeights,
    problem: FilterProblem<'a>,
    choice: Choice<'a>,
    fitted: Vec<Try>,
    failed: Vec<FitOrder>,
    failure: Option<SubspaceError>,
}

/// The filter of the best order from 1 to `most` (of a matrix: of the multiples of its size, and first of those that singular
/// values tell), and all that were tried. Where the noise is known orders end where even a fit without misfit would not be
/// worth its unknowns, of a matrix also where two in a row made the criterion larger.
pub(super) fn choose(
    omega: &[f64],
    s: &[CMat],
    settings: &ShapeSettings,
    feedthrough: Feedthrough,
    most: usize,
    choice: Choice<'_>,
) -> Result<(RoadFilter, Vec<FitOrder>), SubspaceError> {
    let m = s.first().map_or(1, |s| s.nrows());
    let problem = FilterProblem::new(omega, s, settings, feedthrough)?;
    let (fitted, failed, failure) = (Vec::new(), Vec::new(), None);
    let mut tries = Tries { omega, s, weights: &settings.weights, problem, choice, fitted, failed, failure };
    // as many states more for every channel, or one step after another
    'orders: for order in (m.min(most)..=most).step_by(m) {
        let told = tries.attempt(order)?;
        let error = tries.error(order);
        match choice {
            Choice::Accuracy if error < ACCURATE => break,
            Choice::Criterion(Some(noise)) if tries.enough(noise, m) || tries.risen(noise, m) => break,
            // of exact data singular values tell the order, 2n of them: a matrix's is beyond many that are slow to try
            Choice::Criterion(None) | Choice::Accuracy if m > 1 && order == m => {
                if error < FOLLOWED && told.contains(&order) {
                    break;
                }
                for n in told.into_iter().filter(|n| (m + 1..=most).contains(n)) {
                    tries.attempt(n)?;
                    if tries.error(n) < FOLLOWED {
                        break 'orders;
                    }
                }
            }
            _ => {}
        }
        if tries.settled() {
            break;
        }
    }
    tries.chosen()
}

impl Tries<'_> {
    /// Fits an order that was not fitted yet, and says which ones the singular values tell.
    fn attempt(&mut self, order: usize) -> Result<Vec<usize>, SubspaceError> {
        if self.fitted.iter().any(|t| t.row.order == order) {
            return Ok(Vec::new());
        }
        let mut row = FitOrder {
            order,
            lowered_to: None,
            roll_off_order: None,
            chosen: false,
            log10_rms_error: None,
            bic: None,
        };
        match self.problem.fit(Order::Given(order)) {
            Err(e) => {
                self.failed.push(row);
                self.failure = Some(e);
                Ok(Vec::new())
            }
            Ok(Found { filter, told }) => {
                let found = filter.fit.model.order;
                row.lowered_to = (found < order).then_some(found);
                row.roll_off_order = Some(filter.passes);
                row.log10_rms_error = Some(filter.log10_rms_error);
                let mut sum = 0.0;
                if let Choice::Criterion(Some(_)) = self.choice {
                    for (w, s) in self.omega.iter().zip(self.s) {
                        sum += unlikely(s, &spectrum(&filter, *w)?);
                    }
                } else {
                    row.bic = Some(criterion(&filter, self.omega, self.s, self.weights)?);
                }
                self.fitted.push(Try { row, filter, unlikely: sum });
                Ok(told)
            }
        }
    }

    fn error(&self, order: usize) -> f64 {
        let found = self.fitted.iter().find(|t| t.row.order == order);
        found.map_or(f64::INFINITY, |t| t.filter.log10_rms_error)
    }

    /// Numbers that samples are free in.
    fn observed(&self, noise: &Noise) -> f64 {
        noise.freedom * self.omega.len() as f64
    }

    /// Whether the two highest orders are one and the same lower one: more states would be noise.
    fn settled(&self) -> bool {
        let mut rows: Vec<FitOrder> = self.fitted.iter().map(|t| t.row).collect();
        rows.sort_by_key(|row| row.order);
        rows.len() > 1
            && matches!(rows[rows.len() - 2..], [a, b] if a.lowered_to.is_some() && a.lowered_to == b.lowered_to)
    }

    /// Whether the two highest orders of a matrix both have a larger criterion than a lower one.
    fn risen(&self, noise: &Noise, m: usize) -> bool {
        let price = self.observed(noise).ln();
        let value = |t: &Try| {
            noise.deviance(noise.averages, t.unlikely) + unknowns(t.filter.fit.model.order, m) * price
        };
        let least = self.fitted.iter().map(value).fold(f64::INFINITY, f64::min);
        m > 1 && self.fitted.len() > 2 && self.fitted.iter().rev().take(2).all(|t| value(t) > least)
    }

    /// Whether the next order could not be worth its unknowns even if it left as little as noise leaves, less two standard deviations.
    fn enough(&self, noise: &Noise, m: usize) -> bool {
        let observed = self.observed(noise);
        let least = observed - 2.0 * (2.0 * observed).sqrt();
        let price = observed.ln() - 1.0;
        let Some(last) = self.fitted.last() else { return false };
        let next = unknowns(last.row.order + m, m);
        self.fitted.iter().any(|t| {
            let excess = noise.deviance(noise.averages, t.unlikely) - least;
            excess < (next - unknowns(t.filter.fit.model.order, m)) * price
        })
    }

    /// The best, and every row.
    fn chosen(mut self) -> Result<(RoadFilter, Vec<FitOrder>), SubspaceError> {
        let m = self.s.first().map_or(1, |s| s.nrows());
        if let Choice::Criterion(Some(noise)) = self.choice {
            let observed = self.observed(noise);
            // no fit may leave more than noise does: neighbours that are related scatter less than they err
            let least = self.fitted.iter().map(|t| t.unlikely).fold(f64::INFINITY, f64::min);
            let averages = noise.averages.min(self.omega.len() as f64 / least);
            for t in &mut self.fitted {
                let unknowns = unknowns(t.filter.fit.model.order, m);
                t.row.bic = Some(noise.deviance(averages, t.unlikely) + unknowns * observed.ln());
            }
        }
        let value = |t: &Try| match self.choice {
            Choice::Criterion(_) => t.row.bic.unwrap_or(f64::INFINITY),
            Choice::Accuracy => t.filter.log10_rms_error,
        };
        self.fitted.sort_by_key(|t| t.row.order);
        // of equal ones the lowest order
        let best = (0..self.fitted.len())
            .reduce(|a, b| if value(&self.fitted[b]) < value(&self.fitted[a]) { b } else { a });
        let mut rows: Vec<FitOrder> = self.fitted.iter().map(|t| t.row).chain(self.failed).collect();
        match (best, self.failure) {
            (Some(best), _) => {
                rows[best].chosen = true;
                rows.sort_by_key(|row| row.order);
                Ok((self.fitted.swap_remove(best).filter, rows))
            }
            (None, Some(e)) => Err(e),
            (None, None) => {
                let (expected, found) = ("1 or more".to_owned(), "0".to_owned());
                Err(SubspaceError::Field { field: "max_order", expected, found })
            }
        }
    }
}

/// C, B and D of order n: what a spectrum of m channels has of numbers that tell it apart.
fn unknowns(n: usize, m: usize) -> f64 {
    (2 * n * m + m * (m + 1) / 2) as f64
}

/// G(iω)G(iω)ᴴ.
fn spectrum(filter: &RoadFilter, omega: f64) -> Result<CMat, SubspaceError> {
    let h = filter.system.at(C64::new(0.0, omega))?;
    Ok(&h * h.adjoint())
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
        let (found, size) = (spectrum(filter, *w)?, s.norm_l2());
        if size == 0.0 {
            continue;
        }
        let error = if m == 1 { (found[(0, 0)].re / size).ln() } else { (found - s).norm_l2() / size };
        // S²/R: how many times the error that is looked for the sample's own is not
        let weight = match weights {
            ShapeWeights::Equal => size * size,
            ShapeWeights::Relative => size,
            ShapeWeights::Like { level, squared: false } => size * size / level[k],
            ShapeWeights::Like { level, squared: true } => (size / level[k]).powi(2),
            ShapeWeights::Given(Weights::Variances(r)) => size * size / r[k],
            ShapeWeights::RelativeSquared | ShapeWeights::Given(_) => 1.0,
        };
        sum += weight * error * error;
        total += weight;
    }
    let observed = (omega.len() * m * m) as f64;
    Ok(observed * (sum / total).max(EXACT * EXACT).ln() + unknowns(filter.fit.model.order, m) * observed.ln())
}
