//! Algorithm 2.4.1: a stable rational function from samples of its real or imaginary part.

use super::SubspaceError;
use super::Unpaired;
use super::poles::poles;
use super::positivity::{self, Repair};
use super::range::{Range, Route};
use super::samples::{Samples, Weights, scalars};
use super::spectrum::check;
use super::summand::{LeastSquares, Parity};
use crate::linalg::{C64, CMat};
use crate::lti::{Discrete, StateSpace};

/// Which part of f(e^{iθ}) = u(θ) + i v(θ) is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// u.
    Real,
    /// u, of an f that is positive real: u > 0 everywhere, which is made so where noise leaves it below.
    PositiveReal,
    /// v. It does not show f's constant: f(∞) = 0, so that u has no mean over the circle, as conjugation (2.97) has it.
    Imaginary,
}

/// What is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AnalyticSettings {
    /// n.
    pub order: usize,
    /// p > 2n.
    pub block_rows: usize,
    /// Poles that have no mirror image.
    pub unpaired: Unpaired,
    /// The sampling interval that f is labelled with, s.
    pub dt_s: f64,
}

impl AnalyticSettings {
    /// A given order and number of block rows.
    #[must_use]
    pub fn new(order: usize, block_rows: usize) -> Self {
        AnalyticSettings { order, block_rows, unpaired: Unpaired::Refuse, dt_s: 1.0 }
    }
}

/// A stable rational f and what it was found from.
#[derive(Debug, Clone)]
pub struct AnalyticModel {
    /// f(z) = C(zI − A)⁻¹B + D.
    pub system: StateSpace<Discrete>,
    /// Singular values; 2n of them stand out.
    pub singular_values: Vec<f64>,
    /// Root of the weighted sum of squares of the given part less f's.
    pub misfit: f64,
    /// Poles that were mirrored.
    pub folded: usize,
    /// How the range was found.
    pub route: Route,
    /// What was done where the real part was not positive but had to be.
    pub repair: Option<Repair>,
}

/// Fits f of order n, stable, to samples of its real or imaginary part on the unit circle.
///
/// Re f = h + h~ and i Im f = h − h~ with h = D/2 + C/2 (zI − A)⁻¹B: poles come from the same range as a power spectrum's, h
/// from least squares; no factor is taken, so that samples may have any sign. Exact for samples of an f of order n with 2N ≥ p + 2n.
///
/// `theta_rad`: N distinct angles in \[0, π\], ascending; `values`: N numbers; `weights`: [`Weights::Equal`] or variances.
///
/// # Errors
/// As [`fit_spectrum`](super::fit_spectrum), positivity only where it is asked for.
///
/// Source: Türkay's thesis, algorithm 2.4.1, (2.97)–(2.103).
pub fn fit_analytic(
    theta_rad: &[f64],
    values: &[f64],
    weights: Weights,
    part: Part,
    settings: &AnalyticSettings,
) -> Result<AnalyticModel, SubspaceError> {
    let (parity, s) = match part {
        Part::Real | Part::PositiveReal => (Parity::Even, scalars(values)),
        Part::Imaginary => {
            let turned = |v: &f64| CMat::from_fn(1, 1, |_, _| C64::new(0.0, *v));
            (Parity::Odd, values.iter().map(turned).collect())
        }
    };
    let samples = Samples::with_complex_noise(theta_rad.to_vec(), s, weights)?;
    let (n, p) = (settings.order, settings.block_rows);
    check(&samples, p, n)?;
    let range = Range::of(&samples, p, Some(n), true)?;
    let (a, c, folded) = poles(&range, &samples, p, n, settings.unpaired)?;
    let fitted = LeastSquares::of(&samples, parity, a, c, folded)?;
    let (s, repair) = match part {
        Part::PositiveReal => {
            positivity::lifted(&samples, &fitted, fitted.best(), positivity::FLOORS_BEYOND[0], f64::INFINITY)?
        }
        Part::Real | Part::Imaginary => (fitted.best(), None),
    };
    let misfit = repair.map_or(fitted.misfit(None), |r| r.misfit[1]);
    let system = StateSpace::discrete(s.a, s.f, s.c * faer::Scale(2.0), s.e, settings.dt_s)?;
    let Range { singular_values, route, .. } = range;
    Ok(AnalyticModel { system, singular_values, misfit, folded, route, repair })
}

/// |f(e^{iθ})| of a minimum-phase f from samples of its phase, up to a factor: ln|f| has no mean over the circle.
///
/// ln f is analytic where f is stable and minimum phase, and arg f (continuous, 0 at θ = 0, rad) its imaginary part. It is not
/// rational: the order is that of an approximation, and grows with the accuracy wanted. Values are those at `theta_rad`.
///
/// # Errors
/// As [`fit_analytic`].
///
/// Source: Türkay's thesis, 2.4.2, after theorem 2.4.1.
pub fn magnitude_of_phase(
    theta_rad: &[f64],
    phase_rad: &[f64],
    settings: &AnalyticSettings,
) -> Result<Vec<f64>, SubspaceError> {
    let model = fit_analytic(theta_rad, phase_rad, Weights::Equal, Part::Imaginary, settings)?;
    theta_rad.iter().map(|t| Ok(model.system.at(C64::from_polar(1.0, *t))?[(0, 0)].re.exp())).collect()
}
