//! The poly-reference least-squares complex frequency estimator (p-LSCF, PolyMAX): modes from half or full spectra.

mod fraction;
mod normal;
mod residues;
mod spectra;

use super::operational::{
    Mode, OperationalError, OrderModel, Record, Rejected, Resampling, StabilitySettings,
    StabilizationDiagram, Start, deviations, diagram, modes, require,
};
use crate::linalg::C64;
use crate::signal::{CorrelationError, Correlations};
use fraction::Denominator;
use normal::NormalEquations;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use spectra::{LagWindow, Lines};
use std::collections::BTreeMap;

pub use fraction::Constraint;
pub use spectra::{HalfSpectra, Spectrum};

/// Orders of a mode that are fitted again without each block: more tell little new of their median.
const REFITTED: usize = 8;

/// A pole that moved by so many frequency tolerances is another one.
const LOST: f64 = 5.0;

/// What p-LSCF is told beside the data. [`PlscfSettings::default`] suits a dozen modes or fewer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PlscfSettings {
    /// Longest lag L of the correlations that the spectra are made from.
    pub lags: usize,
    /// The exponential lag window's value at the longest lag, from above 0 to 1 (no window). Its damping is taken out of
    /// the poles.
    pub window_end: f64,
    /// Lowest order of the polynomials in z; a polynomial of order n has n poles a channel.
    pub min_order: usize,
    /// Highest order.
    pub max_order: usize,
    /// Which spectra are fitted.
    pub spectrum: Spectrum,
    /// Which coefficient is held.
    pub constraint: Constraint,
    /// When a pole is stable, and a cluster a mode.
    pub stability: StabilitySettings,
}

impl Default for PlscfSettings {
    fn default() -> Self {
        Self {
            lags: 256,
            window_end: 0.01,
            min_order: 1,
            max_order: 40,
            spectrum: Spectrum::Half,
            constraint: Constraint::Lowest,
            stability: StabilitySettings::default(),
        }
    }
}

/// What [`plscf`] found, and what it left out and why.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlscfOutcome {
    /// The modes, by ascending frequency.
    pub modes: Vec<Mode>,
    /// Every other pole, condensed by reason and place; `Σ modes.orders + Σ rejected.poles` is the number of poles.
    pub rejected: Vec<Rejected>,
    /// The poles of all orders.
    pub diagram: StabilizationDiagram,
    /// Matrices that were factorised for the diagram: one of the numerator for all orders, then for each order its
    /// normal matrix and its companion's eigenvalues.
    pub factorisations: usize,
}

/// Modes from channels recorded at one rate under broadband excitation, by the poly-reference least-squares complex
/// frequency estimator on correlogram spectra.
///
/// S⁺(ω) = Λ₀/2 + Σ_{k=1}^{L} w_k Λ_k e^{−iωk} ≈ B(z) A(z)⁻¹, z = e^{iω}, Λ_k = E[y(t+k) y(t)ᵀ], w_k = e^{−βk}
///
/// | symbol | shape | unit |
/// |---|---|---|
/// | `channels` | channels × samples | any, one unit a channel |
/// | `rate_hz` | | Hz |
/// | A_j, B_j | channels × channels, j = 0 … n | |
///
/// minimises Σ_ω ‖S⁺A − B‖² over real coefficients at every order n. B is eliminated, so that A solves the reduced
/// normal equations M α = 0 with one coefficient held at I ([`Constraint`]); poles are the eigenvalues of A's companion
/// matrix, μ → μ e^{β} takes the window's damping out, participations are rows of the inverse of its eigenvectors.
/// Shapes of the modes come from a least-squares fit of the spectra with poles and participations held and residuals of
/// modes below and above the lines (LSFD).
///
/// Assumes a linear time-invariant structure under stationary forces that are white in the band; a road is neither
/// white nor uncorrelated under four wheels: see the physical estimators. The mean of every channel is removed.
/// Channels are divided by their rms, so that the result does not depend on units.
///
/// # Errors
/// Settings without meaning, channels that differ in length, are constant, too short or not finite.
///
/// Numerical note: lines all around the circle make the monomials orthogonal, so that the normal equations are no worse
/// conditioned than the data; an order whose equations are singular has no poles. The numerator's Cholesky factor and
/// the sums over lines are made once, at the highest order, and their leading blocks are those of the lower orders.
///
/// Source: Guillaume, Verboven, Vanlanduit, Van der Auweraer and Peeters, *A poly-reference implementation of the
/// least-squares complex frequency-domain estimator*, IMAC XXI (2003); Peeters and Van der Auweraer, *PolyMAX: a
/// revolution in operational modal analysis*, IOMAC (2005); Cauberghe, Guillaume, Verboven, Vanlanduit and Parloo, *On
/// the influence of the parameter constraint on the stability of the poles and the discrimination capabilities of the
/// stabilisation diagrams*, MSSP 19 (2005).
pub fn plscf(
    channels: &[Vec<f64>],
    rate_hz: f64,
    settings: &PlscfSettings,
) -> Result<PlscfOutcome, OperationalError> {
    check(channels.len(), rate_hz, settings)?;
    let record = Record::new(channels, rate_hz, settings.lags)?;
    let window = LagWindow::exponential(settings.lags, settings.window_end, settings.spectrum);
    let lines = Lines::of_correlations(&record.lambda, &window, settings);
    let normal = NormalEquations::new(&lines, settings.max_order)?;
    let orders: Vec<usize> = (settings.min_order..=normal.max_order()).collect();
    // the largest first, so that no thread ends with the longest work
    let mut models: Vec<Option<OrderModel>> = orders
        .par_iter()
        .rev()
        .with_max_len(1)
        .map(|&order| order_model(&normal, order, settings, &window))
        .collect();
    models.reverse();
    let models: Vec<OrderModel> = models.into_iter().flatten().collect();
    let factorisations = 1 + 2 * models.len();
    let mut diagram = diagram(&models, &record, &settings.stability);
    if settings.spectrum == Spectrum::Full {
        diagram.name_mirrors(settings.stability.frequency_tolerance);
    }
    let (mut clusters, rejected) = modes(&diagram, &record.rms, &settings.stability);
    residues::reshape(&mut clusters, &models, &diagram, &record, &window, settings);
    let again = |lambda: &Correlations, starts: &[Start]| refit(lambda, starts, rate_hz, &window, settings);
    deviations(&mut clusters, &diagram, &record, REFITTED, Resampling::Jackknife, again)?;
    let modes = clusters.into_iter().map(|c| c.mode).collect();
    Ok(PlscfOutcome { modes, rejected, diagram: diagram.in_units(&record.rms), factorisations })
}

/// The poles of half spectra that are at hand, at one order: λ in rad/s, those with Im λ ≥ 0, as the model has them
/// (growing ones included), ascending in |λ|.
///
/// Nothing is windowed or corrected: what S⁺ = B A⁻¹ of this order says. Exact for spectra of as many poles as the
/// order times the references.
///
/// # Errors
/// An order of 0 or too many for the lines; spectra whose normal equations are singular.
pub fn plscf_poles(
    spectra: &HalfSpectra,
    order: usize,
    constraint: Constraint,
) -> Result<Vec<C64>, OperationalError> {
    let lines = Lines::of_half_spectra(spectra)?;
    let normal = NormalEquations::new(&lines, order)?;
    require(order >= 1 && order <= normal.max_order(), "order", "one that the lines can tell", order as f64)?;
    let model = fraction::model(&normal, order, constraint)?;
    let rate_hz = spectra.rate_hz;
    let mut poles: Vec<C64> =
        model.poles.iter().filter(|p| !(p.mu.im < 0.0)).map(|p| p.lambda(rate_hz)).collect();
    poles.sort_by(|a, b| a.norm().total_cmp(&b.norm()));
    Ok(poles)
}

/// The model of one order, its window's damping taken out; none where the normal equations are singular.
fn order_model(
    normal: &NormalEquations,
    order: usize,
    settings: &PlscfSettings,
    window: &LagWindow,
) -> Option<OrderModel> {
    let mut model = fraction::model(normal, order, settings.constraint).ok()?;
    model.poles.iter_mut().for_each(|p| window.correct(p));
    Some(model)
}

/// The poles in other correlations of the same record, each at its order: the root of A nearest to where it was.
fn refit(
    lambda: &Correlations,
    starts: &[Start],
    rate_hz: f64,
    window: &LagWindow,
    settings: &PlscfSettings,
) -> Vec<Option<C64>> {
    let top = starts.iter().map(|s| s.0).max().unwrap_or(1);
    let lines = Lines::of_correlations(lambda, window, settings);
    let Ok(normal) = NormalEquations::new(&lines, top) else { return vec![None; starts.len()] };
    let mut denominators: BTreeMap<usize, Option<Denominator>> = BTreeMap::new();
    let find = |(order, pole): &Start| {
        let denominator = denominators.entry(*order).or_insert_with(|| {
            (*order <= normal.max_order())
                .then(|| Denominator::new(&normal, *order, settings.constraint).ok())?
        });
        let mu = denominator.as_ref()?.root_near((pole / rate_hz - window.beta).exp())?;
        let found = (mu.ln() + window.beta) * rate_hz;
        ((found - pole).norm() <= LOST * settings.stability.frequency_tolerance * pole.norm())
            .then_some(found)
    };
    starts.iter().map(find).collect()
}

fn check(channels: usize, rate_hz: f64, s: &PlscfSettings) -> Result<(), OperationalError> {
    if channels == 0 {
        return Err(CorrelationError::NoChannel.into());
    }
    // Λ_{k−j} for k > n are what is fitted: as many equations as unknowns and more
    let largest = s.lags / 3;
    require(s.lags >= 6, "lags", "at least 6", s.lags as f64)?;
    let sound = s.window_end > 0.0 && s.window_end <= 1.0;
    require(sound, "window_end", "a number above 0, at most 1", s.window_end)?;
    let sound = s.min_order >= 1 && s.min_order <= s.max_order;
    require(sound, "min_order", "a number from 1 to max_order", s.min_order as f64)?;
    let high = format!("a number up to lags/3 = {largest}");
    require(s.max_order <= largest, "max_order", high, s.max_order as f64)?;
    s.stability.check(rate_hz)
}
