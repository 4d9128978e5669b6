//! Shaping filters in continuous time (or over distance): spectra over the whole axis, mapped to the circle and back.

use super::SubspaceError;
use super::range::{Range, Route};
use super::samples::{Samples, Weights};
use super::shape_settings::{ShapeSettings, ShapeWeights};
use super::spectrum::{Known, SpectrumModel, check, fit_in_range};
use super::{Order, SpectrumSettings};
use crate::linalg::{C64, CMat, Mat};
use crate::lti::{Continuous, LtiError, StateSpace};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Poles and zeros nearer to the circle's −1 than this are at infinity.
const AT_INFINITY: f64 = 1e-9;

/// A shaping filter, and how near it comes to the samples.
#[derive(Debug, Clone)]
pub struct ShapeFit {
    /// G(s), stable, minimum phase: G(iω)G(iω)ᴴ is the spectrum under unit-intensity white noise.
    pub filter: StateSpace<Continuous>,
    /// Its poles.
    pub poles: Vec<C64>,
    /// Its zeros that are finite, of a scalar filter.
    pub zeros: Vec<C64>,
    /// Leading coefficient of numerator over denominator, of a scalar filter.
    pub gain: f64,
    /// λ that was used.
    pub lambda_rad: f64,
    /// p that was used.
    pub block_rows: usize,
    /// Root mean square of log₁₀ of fitted over given trace at the samples.
    pub log10_rms_error: f64,
    /// Its largest magnitude.
    pub log10_max_error: f64,
    /// Lowest and highest frequency of the samples: where the filter may be believed.
    pub band_rad: [f64; 2],
    /// The fit on the circle.
    pub model: SpectrumModel,
}

/// Fits a stable, minimum-phase filter of order n to samples of a spectrum S(ω) = G(iω)G(iω)ᴴ (two-sided, per rad).
///
/// `omega_rad`: N distinct frequencies above or at 0, ascending, in rad/s or rad/m; `s`: N Hermitian m × m matrices. They are
/// mapped to θ = 2 arctan(ω/λ) and fitted by [`fit_spectrum`]; the factor is mapped back.
///
/// # Errors
/// As [`fit_spectrum`]; a λ or roll-off that is not positive; zero densities with relative weights.
///
/// Source: Türkay's thesis, 2.3.2.
pub fn fit_shape(omega_rad: &[f64], s: &[CMat], settings: &ShapeSettings) -> Result<ShapeFit, SubspaceError> {
    ShapeProblem::new(omega_rad, s, settings)?.fit(settings.order)
}

/// Samples on the circle, to be fitted with one order after another: what does not depend on the order is done once.
#[derive(Debug)]
pub struct ShapeProblem<'a> {
    omega: &'a [f64],
    traces: Vec<f64>,
    samples: Samples,
    settings: ShapeSettings,
    lambda: f64,
    band_rad: [f64; 2],
    /// Of orthogonal factors, by p, with the orders that were fitted in it.
    range: Option<(usize, Range, Known)>,
}

impl<'a> ShapeProblem<'a> {
    /// As [`fit_shape`]; the order of `settings` is not asked for.
    ///
    /// # Errors
    /// As [`fit_shape`].
    pub fn new(omega_rad: &'a [f64], s: &[CMat], settings: &ShapeSettings) -> Result<Self, SubspaceError> {
        let positive = |field: &'static str, value: f64| {
            if value > 0.0 && value.is_finite() {
                return Ok(());
            }
            let (expected, found) = ("a positive, finite number".to_owned(), value.to_string());
            Err(SubspaceError::Field { field, expected, found })
        };
        check_frequencies(omega_rad)?;
        let low = omega_rad.iter().copied().find(|w| *w > 0.0).unwrap_or(1.0);
        let high = omega_rad.last().copied().filter(|w| *w > 0.0).unwrap_or(1.0);
        let lambda = settings.lambda_rad.unwrap_or((low * high).sqrt());
        positive("lambda", lambda)?;
        if let Some(corner) = settings.roll_off_rad {
            positive("roll_off", corner)?;
        }
        let theta: Vec<f64> = omega_rad.iter().map(|w| 2.0 * (w / lambda).atan()).collect();
        let traces: Vec<f64> = s.iter().map(|s| (0..s.nrows()).map(|i| s[(i, i)].re).sum()).collect();
        let relative = |power: i32| {
            if let Some(index) = traces.iter().position(|t| !(*t > 0.0)) {
                let why =
                    format!("a density of {:e}: relative weights need densities above 0", traces[index]);
                return Err(SubspaceError::Sample { what: "sample", index, why });
            }
            Ok(Weights::Variances(traces.iter().map(|t| t.powi(power)).collect()))
        };
        let weights = match &settings.weights {
            ShapeWeights::Equal => Weights::Equal,
            ShapeWeights::Relative => relative(1)?,
            ShapeWeights::RelativeSquared => relative(2)?,
            ShapeWeights::Like { level, squared } => {
                let power = if *squared { 2 } else { 1 };
                Weights::Variances(level.iter().map(|l| l.powi(power)).collect())
            }
            ShapeWeights::Given(weights) => weights.clone(),
        };
        let samples = Samples::new(theta, s.to_vec(), weights)?;
        let (omega, band_rad, settings) = (omega_rad, [low, high], settings.clone());
        Ok(ShapeProblem { omega, traces, samples, settings, lambda, band_rad, range: None })
    }

    /// The filter of an order.
    ///
    /// # Errors
    /// As [`fit_shape`].
    pub fn fit(&mut self, order: Order) -> Result<ShapeFit, SubspaceError> {
        let most = match order {
            Order::Given(n) | Order::AtMost(n) => n,
        };
        let m = self.samples.size();
        let given = self.settings.block_rows;
        let mut block_rows = given.unwrap_or_else(|| {
            let all = default_rows(&self.samples, most, m);
            self.settings.spare_rows.map_or(all, |spare| all.min(least_rows(most, m) + spare))
        });
        let model = loop {
            match self.model(order, most, block_rows) {
                // frequencies so close on the circle that fewer rows are told apart
                Err(SubspaceError::Field { field: "p", .. })
                    if given.is_none() && block_rows > least_rows(most, m) =>
                {
                    block_rows = (block_rows * 2 / 3).max(least_rows(most, m));
                }
                other => break other?,
            }
        };
        self.shaped(model, block_rows)
    }

    fn model(&mut self, order: Order, most: usize, p: usize) -> Result<SpectrumModel, SubspaceError> {
        let (unpaired, moments) = (self.settings.unpaired, true);
        let on_circle = SpectrumSettings { order, block_rows: p, unpaired, moments, dt_s: 1.0 };
        check(&self.samples, p, most)?;
        if let Some((_, range, known)) = self.range.as_mut().filter(|(q, _, _)| *q == p) {
            return fit_in_range(&self.samples, &on_circle, range, known);
        }
        let given = if let Order::Given(n) = order { Some(n) } else { None };
        let range = Range::of(&self.samples, p, given, moments)?;
        let mut known = Known::default();
        let found = fit_in_range(&self.samples, &on_circle, &range, &mut known);
        if range.route == Route::Orthogonal {
            self.range = Some((p, range, known));
        }
        found
    }

    fn shaped(&self, model: SpectrumModel, block_rows: usize) -> Result<ShapeFit, SubspaceError> {
        let (m, lambda, settings) = (self.samples.size(), self.lambda, &self.settings);
        let plain = model.factor.system.inverse_bilinear(lambda)?;
        let filter = match settings.roll_off_rad {
            Some(corner) => plain.series(&low_pass(m, corner)?)?,
            None => plain,
        };
        let poles = filter.poles()?;
        let (zeros, gain) = if m == 1 {
            let back = |z: &C64| (*z - 1.0) / (*z + 1.0) * lambda;
            let finite = model.factor.zeros.iter().filter(|z| (**z + 1.0).norm() > AT_INFINITY);
            let zeros: Vec<C64> = finite.map(back).collect();
            let gain = leading(&filter, &zeros, &poles, lambda)?;
            (zeros, gain)
        } else {
            (Vec::new(), f64::NAN)
        };
        let errors = log10_errors(&filter, self.omega, &self.traces)?;
        let count = errors.len().max(1) as f64;
        let log10_rms_error = (errors.iter().map(|e| e * e).sum::<f64>() / count).sqrt();
        let log10_max_error = errors.iter().map(|e| e.abs()).fold(0.0, f64::max);
        let band_rad = self.band_rad;
        Ok(ShapeFit {
            filter,
            poles,
            zeros,
            gain,
            lambda_rad: lambda,
            block_rows,
            log10_rms_error,
            log10_max_error,
            band_rad,
            model,
        })
    }
}

/// log₁₀ of fitted over given trace, where that is above 0.
pub(crate) fn log10_errors(
    g: &StateSpace<Continuous>,
    omega: &[f64],
    traces: &[f64],
) -> Result<Vec<f64>, LtiError> {
    let kept: Vec<(f64, f64)> =
        omega.iter().copied().zip(traces.iter().copied()).filter(|(_, t)| *t > 0.0).collect();
    let one = |(w, t): &(f64, f64)| Ok((g.at(C64::new(0.0, *w))?.norm_l2().powi(2) / t).log10());
    kept.par_iter().map(one).collect()
}

fn check_frequencies(omega: &[f64]) -> Result<(), SubspaceError> {
    for (index, value) in omega.iter().enumerate() {
        if !(*value >= 0.0 && value.is_finite()) {
            let why = format!("{value}, expected a finite frequency at or above 0");
            return Err(SubspaceError::Sample { what: "frequency", index, why });
        }
        if let Some(before) = index.checked_sub(1).map(|k| omega[k])
            && *value <= before
        {
            return Err(SubspaceError::Order { index, before, value: *value });
        }
    }
    Ok(())
}

/// Half of the block rows that the samples allow, so that as many equations are left over; 64 at most, enough for the order.
fn default_rows(samples: &Samples, order: usize, m: usize) -> usize {
    let most = samples.independent().saturating_sub((2 * order).div_ceil(m));
    (most / 2).min(64).max(least_rows(order, m)).min(most.max(1))
}

fn least_rows(order: usize, m: usize) -> usize {
    (2 * order).div_ceil(m) + 1
}

/// ω_r/(s + ω_r) on every channel.
fn low_pass(m: usize, corner: f64) -> Result<StateSpace<Continuous>, SubspaceError> {
    let diagonal = |v: f64| Mat::from_fn(m, m, |i, j| if i == j { v } else { 0.0 });
    Ok(StateSpace::continuous(diagonal(-corner), diagonal(corner), diagonal(1.0), Mat::zeros(m, m))?)
}

/// k of k Π(s − zᵢ)/Π(s − pᵢ), from the response at a frequency of its own size.
fn leading(
    g: &StateSpace<Continuous>,
    zeros: &[C64],
    poles: &[C64],
    omega: f64,
) -> Result<f64, SubspaceError> {
    let s = C64::new(0.0, omega * PI);
    let product = |roots: &[C64]| roots.iter().map(|r| s - r).product::<C64>();
    Ok((g.at(s)?[(0, 0)] * product(poles) / product(zeros)).re)
}
