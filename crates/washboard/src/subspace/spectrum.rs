//! Algorithm 2.2.1: a minimum-phase rational filter from samples of a power spectrum at any frequencies.

use super::SubspaceError;
use super::factor::{SpectralFactor, spectral_factor};
use super::positivity::{self, Repair};
use super::range::{Range, Route};
use super::samples::Samples;
use super::summand::{LeastSquares, Parity, Summand, poles};

/// Residuals below this share of the samples are rounding: a higher order can't be better.
const EXACT: f64 = 1e-11;

/// Which order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// This one.
    Given(usize),
    /// The one with the smallest Bayesian information criterion, up to this one.
    AtMost(usize),
}

/// What is done where eigenvalues do not part into n inside the unit circle and n outside.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Unpaired {
    /// An error with their number.
    #[default]
    Refuse,
    /// The n smallest are taken, those outside mirrored; the result says so.
    Fold,
}

/// How a spectrum is fitted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpectrumSettings {
    /// n.
    pub order: Order,
    /// p: block rows of the data matrices. For scalar spectra above 2n.
    pub block_rows: usize,
    /// Poles that have no mirror image.
    pub unpaired: Unpaired,
    /// Whether moments may be used where they are accurate enough: scalar spectra of a given order.
    pub moments: bool,
    /// The sampling interval that the filter is labelled with, s.
    pub dt_s: f64,
}

impl SpectrumSettings {
    /// A given order and number of block rows.
    #[must_use]
    pub fn new(order: usize, block_rows: usize) -> Self {
        let order = Order::Given(order);
        SpectrumSettings { order, block_rows, unpaired: Unpaired::Refuse, moments: true, dt_s: 1.0 }
    }
}

/// An order, and how well it explains the samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OrderTried {
    /// n.
    pub order: usize,
    /// Root of the weighted sum of squares of the fitted spectrum less the samples; none where the order can't be fitted.
    pub misfit: Option<f64>,
    /// N_obs ln(misfit²/N_obs) + k ln N_obs.
    pub bic: Option<f64>,
}

/// A rational power spectrum and its factor.
#[derive(Debug, Clone)]
pub struct SpectrumModel {
    /// n.
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
    let (p, m) = (settings.block_rows, samples.size());
    let most = match settings.order {
        Order::Given(n) | Order::AtMost(n) => n,
    };
    check(samples, p, most)?;
    let given = match settings.order {
        Order::Given(n) => Some(n),
        Order::AtMost(_) => None,
    };
    let range = Range::of(samples, p, given, settings.moments)?;
    let fit = |n: usize| -> Result<LeastSquares, SubspaceError> {
        let (a, c, folded) = poles(&range, p, n, settings.unpaired)?;
        LeastSquares::of(samples, Parity::Even, a, c, folded)
    };
    let mut orders = Vec::new();
    let (order, fitted) = match settings.order {
        Order::Given(n) => (n, fit(n)?),
        Order::AtMost(most) => {
            let observed = (samples.independent() * m * m) as f64;
            let size = samples.s().iter().map(|s| s.norm_l2().powi(2)).sum::<f64>().sqrt();
            let mut best: Option<(f64, usize, LeastSquares)> = None;
            for n in 1..=most {
                let Ok(fitted) = fit(n) else {
                    orders.push(OrderTried { order: n, misfit: None, bic: None });
                    continue;
                };
                let misfit = fitted.misfit(None);
                let unknowns = (2 * n * m + m * (m + 1) / 2) as f64;
                let bic = observed * ((misfit.max(EXACT * size)).powi(2) / observed).ln()
                    + unknowns * observed.ln();
                orders.push(OrderTried { order: n, misfit: Some(misfit), bic: Some(bic) });
                if best.as_ref().is_none_or(|b| bic < b.0) {
                    best = Some((bic, n, fitted));
                }
            }
            let Some((_, n, fitted)) = best else {
                return Err(fit(most).err().unwrap_or(SubspaceError::NoSplit { order: most, inside: 0 }));
            };
            (n, fitted)
        }
    };
    let angles = positivity::angles(samples, &fitted.best().a)?;
    let mut last = None;
    let mut found = None;
    for floor in positivity::FLOORS_BEYOND {
        let (summand, repair) = positivity::lifted(samples, &fitted, fitted.best(), floor)?;
        match spectral_factor(&summand, settings.dt_s, &angles) {
            Ok(factor) => {
                found = Some((summand, repair, factor));
                break;
            }
            Err(e) => last = Some(e),
        }
    }
    let Some((summand, repair, factor)) = found else {
        return Err(last.unwrap_or(SubspaceError::NoSplit { order, inside: 0 }));
    };
    let Range { singular_values, route, .. } = range;
    Ok(SpectrumModel { order, summand, factor, singular_values, route, orders, repair })
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
