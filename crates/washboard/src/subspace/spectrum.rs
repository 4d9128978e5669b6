//! Algorithm 2.2.1: a minimum-phase rational filter from samples of a power spectrum at any frequencies.

use super::SubspaceError;
use super::factor::{SpectralFactor, spectral_factor};
use super::poles::poles;
use super::positivity::{self, Repair};
use super::range::{Range, Route};
use super::samples::Samples;
use super::spectrum_settings::{Order, OrderTried, SpectrumSettings, Unpaired};
use super::summand::{LeastSquares, Parity, Summand};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Residuals below this share of the samples are rounding: a higher order can't be better.
const EXACT: f64 = 1e-11;
/// Singular values below this share of the largest may be rounding, whose size depends on how near frequencies are: whether an
/// order is one too many is then told by its misfit.
const SURPLUS: f64 = 1e-6;
/// And below this they are.
const ROUNDING: f64 = 1e-13;

/// A rational power spectrum and its factor.
#[derive(Debug, Clone)]
pub struct SpectrumModel {
    /// n: the one asked for, or a lower one that comes nearer to the samples (see [`fit_spectrum`]).
    pub order: usize,
    /// S = H + H~ by its causal half.
    pub summand: Summand,
    /// G with G G~ = S, stable and minimum phase.
    pub factor: SpectralFactor,
    /// Singular values of K⁻¹ŜW⊥; 2n of them stand out where there are n states.
    pub singular_values: Vec<f64>,
    /// How the range was found.
    pub route: Route,
    /// The orders that were tried, where one was to be chosen.
    pub orders: Vec<OrderTried>,
    /// What was done where the fit was not positive.
    pub repair: Option<Repair>,
}

/// Fits a rational power spectrum and its minimum-phase factor.
///
/// From Ŝ = O_p X + Γ_p W + noise the range of O_p = \[C; CA; …\] and of its anticausal mirror image is found by projecting
/// the polynomials W out and weighting with K, KKᵀ = Re(W_C R W_Cᴴ); its shift has the poles and their inverses as
/// eigenvalues. E and F follow by weighted least squares, and the factor from a discrete Riccati equation, which is then
/// compared with the fit. Fits that fall below zero are lifted by least squares with constraints.
///
/// Exact for samples of a spectrum of order n (McMillan degree of G) as soon as 2N ≥ p + 2n (an angle of 0 or π counts for
/// one half), and consistent under noise of covariance R_k.
///
/// # Errors
/// Too few samples for p and n, an order too high for p; poles on the circle or without mirror images; a spectrum that can't
/// be made positive; a factor that does not give the spectrum back.
///
/// Source: Türkay's thesis, algorithm 2.2.1, (2.23)–(2.95), with the errata of `docs/`.
pub fn fit_spectrum(samples: &Samples, settings: &SpectrumSettings) -> Result<SpectrumModel, SubspaceError> {
    let p = settings.block_rows;
    let most = match settings.order {
        Order::Given(n) | Order::AtMost(n) => n,
    };
    check(samples, p, most)?;
    let given = match settings.order {
        Order::Given(n) => Some(n),
        Order::AtMost(_) => None,
    };
    fit_in_range(samples, settings, &Range::of(samples, p, given, settings.moments)?, &mut Known::default())
}

/// What is known of orders in one range: fits and models are the same for whoever asks.
#[derive(Debug, Default)]
pub(super) struct Known {
    fits: BTreeMap<usize, Result<Arc<LeastSquares>, SubspaceError>>,
    models: BTreeMap<usize, Result<SpectrumModel, SubspaceError>>,
}

/// The same in a range that is known, of as many block rows.
pub(super) fn fit_in_range(
    samples: &Samples,
    settings: &SpectrumSettings,
    range: &Range,
    known: &mut Known,
) -> Result<SpectrumModel, SubspaceError> {
    let mut problem = Problem { samples, settings, range, known };
    match settings.order {
        Order::Given(n) => problem.given(n),
        Order::AtMost(most) => problem.at_most(most),
    }
}

/// Samples with their range, from which any order is fitted.
struct Problem<'a> {
    samples: &'a Samples,
    settings: &'a SpectrumSettings,
    range: &'a Range,
    known: &'a mut Known,
}

impl Problem<'_> {
    fn fitted(&mut self, n: usize) -> Result<Arc<LeastSquares>, SubspaceError> {
        if let Some(known) = self.known.fits.get(&n) {
            return known.clone();
        }
        let found = poles(self.range, self.samples, self.settings.block_rows, n, self.settings.unpaired)
            .and_then(|(a, c, folded)| LeastSquares::of(self.samples, Parity::Even, a, c, folded))
            .map(Arc::new);
        self.known.fits.insert(n, found.clone());
        found
    }

    /// The model of an order, given up where its misfit exceeds `limit`.
    fn model(
        &mut self,
        order: usize,
        fitted: &LeastSquares,
        limit: f64,
    ) -> Result<SpectrumModel, SubspaceError> {
        if let Some(known) = self.known.models.get(&order) {
            return known.clone();
        }
        let found = self.positive(order, fitted, limit);
        // another limit may let it through
        if found.is_ok() || limit.is_infinite() {
            self.known.models.insert(order, found.clone());
        }
        found
    }

    /// Order n where all is well with it. Where its last singular value may be rounding, poles had to be folded, or the fit be
    /// lifted: that of the orders up to n which comes nearest to the samples, for such poles may be anywhere.
    fn given(&mut self, n: usize) -> Result<SpectrumModel, SubspaceError> {
        let values = &self.range.singular_values;
        let largest = values.first().copied().unwrap_or(0.0);
        let above = |k: usize, share: f64| values.get(2 * k - 1).is_some_and(|v| *v > share * largest);
        if above(n, SURPLUS) {
            let found = self.fitted(n).and_then(|fit| self.model(n, &fit, f64::INFINITY));
            if self.settings.unpaired == Unpaired::Refuse
                || found.as_ref().is_ok_and(|m| m.summand.folded == 0 && m.repair.is_none())
            {
                return found;
            }
        }
        let (shown, rest): (Vec<usize>, Vec<usize>) = (1..=n).partition(|k| above(*k, ROUNDING));
        match self.nearest(&shown, n) {
            // of no order at all there is nothing to say
            Err(_) if shown.is_empty() => self.nearest(&rest, n),
            Err(e) => self.nearest(&rest, n).map_err(|_| e),
            found => found,
        }
    }

    /// The model of those orders that comes nearest to the samples, the lowest of those that meet them.
    fn nearest(&mut self, orders: &[usize], asked: usize) -> Result<SpectrumModel, SubspaceError> {
        let mut failure = None;
        let mut tries: Vec<(f64, usize, Arc<LeastSquares>)> = Vec::new();
        for k in orders.iter().copied() {
            match self.fitted(k) {
                Ok(fit) => tries.push((fit.misfit(None).max(EXACT * fit.size()), k, fit)),
                Err(e) => failure = Some(e),
            }
        }
        tries.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
        let mut best: Option<(f64, SpectrumModel)> = None;
        for (misfit, k, fit) in tries {
            // a repair only adds to it
            if best.as_ref().is_some_and(|b| b.0 <= misfit) {
                break;
            }
            let limit = best.as_ref().map_or(f64::INFINITY, |b| b.0);
            match self.model(k, &fit, limit) {
                Ok(model) => {
                    let misfit = model.repair.map_or(misfit, |r| r.misfit[1].max(misfit));
                    if best.as_ref().is_none_or(|b| misfit < b.0) {
                        best = Some((misfit, model));
                    }
                }
                Err(e) => failure = Some(e),
            }
        }
        match (best, failure) {
            (Some((_, model)), _) => Ok(model),
            (None, Some(e)) => Err(e),
            (None, None) => Err(SubspaceError::NoSplit { order: asked, inside: 0 }),
        }
    }

    /// The order with the smallest criterion.
    fn at_most(&mut self, most: usize) -> Result<SpectrumModel, SubspaceError> {
        let m = self.samples.size();
        let observed = (self.samples.independent() * m * m) as f64;
        let mut orders = Vec::new();
        let mut best: Option<(f64, usize, Arc<LeastSquares>)> = None;
        for n in 1..=most {
            let Ok(fitted) = self.fitted(n) else {
                orders.push(OrderTried { order: n, misfit: None, bic: None });
                continue;
            };
            let misfit = fitted.misfit(None);
            let unknowns = (2 * n * m + m * (m + 1) / 2) as f64;
            let bic = observed * ((misfit.max(EXACT * fitted.size())).powi(2) / observed).ln()
                + unknowns * observed.ln();
            orders.push(OrderTried { order: n, misfit: Some(misfit), bic: Some(bic) });
            if best.as_ref().is_none_or(|b| bic < b.0) {
                best = Some((bic, n, fitted));
            }
        }
        let Some((_, n, fitted)) = best else {
            return Err(self.fitted(most).err().unwrap_or(SubspaceError::NoSplit { order: most, inside: 0 }));
        };
        Ok(SpectrumModel { orders, ..self.model(n, &fitted, f64::INFINITY)? })
    }

    /// The fit made positive, and its factor.
    fn positive(
        &self,
        order: usize,
        fitted: &LeastSquares,
        limit: f64,
    ) -> Result<SpectrumModel, SubspaceError> {
        let angles = positivity::angles(self.samples, &fitted.best().a)?;
        let mut last = None;
        for floor in positivity::FLOORS_BEYOND {
            let (summand, repair) = positivity::lifted(self.samples, fitted, fitted.best(), floor, limit)?;
            match spectral_factor(&summand, self.settings.dt_s, &angles) {
                Ok(factor) => {
                    let Range { singular_values, route, .. } = self.range;
                    let (singular_values, route) = (singular_values.clone(), *route);
                    return Ok(SpectrumModel {
                        order,
                        summand,
                        factor,
                        singular_values,
                        route,
                        orders: Vec::new(),
                        repair,
                    });
                }
                Err(e) => last = Some(e),
            }
        }
        Err(last.unwrap_or(SubspaceError::NoSplit { order, inside: 0 }))
    }
}

/// Enough samples for p block rows and order n, enough block rows for the order.
pub(super) fn check(samples: &Samples, p: usize, n: usize) -> Result<(), SubspaceError> {
    let m = samples.size();
    if n == 0 {
        let (expected, found) = ("1 or more".to_owned(), n.to_string());
        return Err(SubspaceError::Field { field: "order", expected, found });
    }
    // the observability matrix must have more rows than columns after a block row is taken off
    let most = p.saturating_sub(1) * m / 2;
    if n > most {
        return Err(SubspaceError::OrderTooHigh { order: n, block_rows: p, size: m, most });
    }
    let (needed, found) = (p * m + 2 * n, samples.independent() * m);
    if found < needed {
        return Err(SubspaceError::TooFew { order: n, block_rows: p, needed, found });
    }
    Ok(())
}
