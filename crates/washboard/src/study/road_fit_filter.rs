//! A shaping filter that a road can be: strictly proper where it shapes height.

use crate::linalg::{C64, CMat, Mat, solve};
use crate::lti::{Continuous, StateSpace};
use crate::subspace::{
    Order, ShapeFit, ShapeProblem, ShapeSettings, ShapeWeights, SubspaceError, Weights, log10_errors,
};

/// A filter with fewer states for the low-pass is taken if its log₁₀ error is below this (rounding), or no more than this many times
/// the error of one with more.
const NEGLIGIBLE: f64 = 1e-7;
const AS_NEAR: f64 = 1.01;
/// The same where poles were moved: that alone changes the density nearest to a pole by 1e-4.
const MOVED: f64 = 5e-5;
/// Zeros beyond this many times the band's upper end are at infinity: they change the response by the inverse.
const FAR: f64 = 1e8;
/// Where the low-pass has its corner where nothing is given: half the band's lower end (heights fall over the whole band, as a road's), or
/// twice its upper end (they fall beyond it), whichever fits better.
const CORNERS: [f64; 2] = [0.5, 2.0];

/// A filter as it is written, and the fit that it came from.
#[derive(Debug)]
pub(super) struct RoadFilter {
    pub system: StateSpace<Continuous>,
    pub poles: Vec<C64>,
    /// Of a scalar filter.
    pub zeros: Vec<C64>,
    /// Of a scalar filter, above 0.
    pub gain: Option<f64>,
    pub roll_off_rad: Option<f64>,
    pub fit: ShapeFit,
}

impl RoadFilter {
    /// The filter of a spectrum `scale`² as large.
    pub fn times(mut self, scale: f64) -> Result<Self, SubspaceError> {
        if scale != 1.0 {
            let m = self.system.inputs();
            self.system = self.system.times(&Mat::from_fn(m, m, |i, j| if i == j { scale } else { 0.0 }))?;
            self.gain = self.gain.map(|k| k * scale);
        }
        Ok(self)
    }
}

/// What is done with a feedthrough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Feedthrough {
    /// It stays.
    Keep,
    /// A low-pass at this corner, or at one of [`CORNERS`], takes it away; passed this many times.
    RollOff(Option<f64>, usize),
}

/// Fits the samples, see [`FilterProblem`].
pub(super) fn fit_filter(
    omega: &[f64],
    s: &[CMat],
    settings: &ShapeSettings,
    feedthrough: Feedthrough,
) -> Result<RoadFilter, SubspaceError> {
    FilterProblem::new(omega, s, settings, feedthrough)?.fit(settings.order)
}

/// Where no feedthrough may be, S(1 + ω²/ω_r²)ᵏ is fitted and followed by (ω_r/(s + ω_r))ᵏ: the low-pass bends nothing within the
/// band, and a spectrum as steep as a road's becomes flat before it is fitted.
pub(super) struct FilterProblem<'a> {
    omega: &'a [f64],
    s: &'a [CMat],
    /// Upper end of the band.
    high: f64,
    /// k.
    times: usize,
    /// What is fitted, and with which ω_r.
    ways: Vec<(Option<f64>, ShapeProblem<'a>)>,
}

impl<'a> FilterProblem<'a> {
    pub fn new(
        omega: &'a [f64],
        s: &'a [CMat],
        settings: &ShapeSettings,
        feedthrough: Feedthrough,
    ) -> Result<Self, SubspaceError> {
        let low = omega.iter().copied().find(|w| *w > 0.0).unwrap_or(1.0);
        let high = omega.last().copied().filter(|w| *w > 0.0).unwrap_or(1.0);
        let (corners, times) = match feedthrough {
            Feedthrough::Keep => (vec![None], 0),
            Feedthrough::RollOff(Some(corner), times) => (vec![Some(corner)], times),
            Feedthrough::RollOff(None, times) => {
                (vec![Some(CORNERS[0] * low), Some(CORNERS[1] * high)], times)
            }
        };
        let way = |corner: Option<f64>| {
            let problem = match corner {
                None => ShapeProblem::new(omega, s, settings)?,
                Some(corner) => lifted(omega, s, settings, corner, times)?,
            };
            Ok((corner, problem))
        };
        let ways = corners.into_iter().map(way).collect::<Result<_, SubspaceError>>()?;
        Ok(FilterProblem { omega, s, high, times, ways })
    }

    /// # Errors
    /// As [`ShapeProblem::fit`], of the first way where none succeeds.
    pub fn fit(&mut self, order: Order) -> Result<RoadFilter, SubspaceError> {
        let (omega, s, high, times) = (self.omega, self.s, self.high, self.times);
        let found: Vec<Result<RoadFilter, SubspaceError>> = self
            .ways
            .iter_mut()
            .map(|(corner, problem)| {
                let fit = problem.fit(order)?;
                match *corner {
                    None => of(fit.filter.clone(), fit.zeros.clone(), high, None, fit),
                    Some(corner) => rolled(fit, omega, s, corner, times, high),
                }
            })
            .collect();
        let (mut filters, mut failure) = (Vec::new(), None);
        for one in found {
            match one {
                Ok(filter) => filters.push(filter),
                Err(e) => failure = failure.or(Some(e)),
            }
        }
        let nearest = filters.iter().map(|f| f.fit.log10_rms_error).fold(f64::INFINITY, f64::min);
        let added = |f: &RoadFilter| f.system.order().saturating_sub(f.fit.model.order);
        // of those that are as near as the nearest the one with fewest states for the low-pass
        let best = filters
            .into_iter()
            .filter(|f| !(f.fit.log10_rms_error > as_near(&f.fit, nearest)))
            .min_by(|f, g| {
                let error = |f: &RoadFilter| f.fit.log10_rms_error;
                added(f).cmp(&added(g)).then(error(f).total_cmp(&error(g)))
            });
        match (best, failure) {
            (Some(filter), _) => Ok(filter),
            (None, Some(e)) => Err(e),
            (None, None) => Err(SubspaceError::NoSplit { order: 0, inside: 0 }),
        }
    }
}

/// The log₁₀ error up to which a filter of this fit is as near to the samples as one of error `nearest`.
fn as_near(fit: &ShapeFit, nearest: f64) -> f64 {
    let rounding = if fit.model.summand.folded > 0 { MOVED } else { NEGLIGIBLE };
    (AS_NEAR * nearest).max(rounding)
}

/// S(1 + ω²/ω_r²)ᵏ with the weights of S.
fn lifted<'a>(
    omega: &'a [f64],
    s: &[CMat],
    settings: &ShapeSettings,
    corner: f64,
    times: usize,
) -> Result<ShapeProblem<'a>, SubspaceError> {
    let lift: Vec<f64> =
        omega.iter().map(|w| (0..times).fold(1.0, |lift, _| lift * (1.0 + (w / corner).powi(2)))).collect();
    let lifted: Vec<CMat> = s.iter().zip(&lift).map(|(s, l)| s * faer::Scale(C64::new(*l, 0.0))).collect();
    let squares = |r: &[f64]| Weights::Variances(r.iter().zip(&lift).map(|(r, l)| r * l * l).collect());
    // an error of S is one of S(1 + ω²/ω_r²)ᵏ that is as many times larger
    let weights = match &settings.weights {
        ShapeWeights::Equal => ShapeWeights::Given(squares(&vec![1.0; omega.len()])),
        ShapeWeights::Given(Weights::Variances(r)) => ShapeWeights::Given(squares(r)),
        other => other.clone(),
    };
    ShapeProblem::new(omega, &lifted, &ShapeSettings { weights, ..settings.clone() })
}

/// The fit with the low-pass passed k times, once less where that can be.
fn rolled(
    fit: ShapeFit,
    omega: &[f64],
    s: &[CMat],
    corner: f64,
    times: usize,
    high: f64,
) -> Result<RoadFilter, SubspaceError> {
    if let Some((system, zeros)) = without_one(&fit, omega, s, corner, times)? {
        let appended = times > 1;
        return of(system, zeros, high, appended.then_some(corner), fit);
    }
    let (system, zeros) = (passed(fit.filter.clone(), corner, times)?, fit.zeros.clone());
    of(system, zeros, high, Some(corner), fit)
}

/// G(s)(ω_r/(s + ω_r))ᵏ.
fn passed(
    mut g: StateSpace<Continuous>,
    corner: f64,
    times: usize,
) -> Result<StateSpace<Continuous>, SubspaceError> {
    let m = g.outputs();
    let eye = |v: f64| Mat::from_fn(m, m, |i, j| if i == j { v } else { 0.0 });
    let low_pass = StateSpace::continuous(eye(-corner), eye(corner), eye(1.0), Mat::zeros(m, m))?;
    for _ in 0..times {
        g = g.series(&low_pass)?;
    }
    Ok(g)
}

/// A system and, of a scalar one, its finite zeros.
type WithZeros = (StateSpace<Continuous>, Vec<C64>);

/// G(s) c/(s + c) = C(sI − A)⁻¹B′ + c G(−c)/(s + c) with B′ = c(A + cI)⁻¹B: strictly proper without another state where G(−c) is rounding, as it
/// is where the samples are of a strictly proper filter. Taken where it follows the samples as well and is minimum phase. The other k − 1
/// low-passes stay: behind a strictly proper filter they make C B exactly 0, and no velocity is white.
fn without_one(
    fit: &ShapeFit,
    omega: &[f64],
    s: &[CMat],
    c: f64,
    times: usize,
) -> Result<Option<WithZeros>, SubspaceError> {
    let g = &fit.filter;
    let n = g.order();
    let shifted = Mat::from_fn(n, n, |i, j| g.a()[(i, j)] + if i == j { c } else { 0.0 });
    // a pole at −c itself
    let Ok(b) = solve(&shifted, g.b()) else { return Ok(None) };
    let none = Mat::zeros(g.outputs(), g.inputs());
    let proper = StateSpace::continuous(g.a().clone(), b * faer::Scale(c), g.c().clone(), none)?;
    let system = passed(proper, c, times.saturating_sub(1))?;
    if !(log10_rms_error(&system, omega, s)? <= as_near(fit, fit.log10_rms_error)) {
        return Ok(None);
    }
    let far = FAR * omega.last().copied().unwrap_or(1.0);
    let zeros: Vec<C64> = system.zeros()?.into_iter().filter(|z| z.norm() < far).collect();
    if !zeros.iter().all(|z| z.re < 0.0) {
        return Ok(None);
    }
    Ok(Some((system, if g.outputs() == 1 { zeros } else { Vec::new() })))
}

/// Root mean square of log₁₀ of fitted over given trace.
fn log10_rms_error(g: &StateSpace<Continuous>, omega: &[f64], s: &[CMat]) -> Result<f64, SubspaceError> {
    let traces: Vec<f64> = s.iter().map(|s| (0..s.nrows()).map(|i| s[(i, i)].re).sum()).collect();
    let errors = log10_errors(g, omega, &traces)?;
    Ok((errors.iter().map(|e| e * e).sum::<f64>() / errors.len().max(1) as f64).sqrt())
}

/// States scaled, roots sorted, the gain made positive.
fn of(
    system: StateSpace<Continuous>,
    zeros: Vec<C64>,
    high: f64,
    roll_off_rad: Option<f64>,
    fit: ShapeFit,
) -> Result<RoadFilter, SubspaceError> {
    let (mut system, _) = system.balanced_scales()?;
    let sorted = |mut roots: Vec<C64>| {
        roots.sort_by(|a, b| a.norm().total_cmp(&b.norm()).then(a.im.total_cmp(&b.im)));
        roots
    };
    let (poles, zeros) = (sorted(system.poles()?), sorted(zeros));
    let mut gain = None;
    if system.outputs() == 1 {
        let s = C64::new(0.0, high);
        let product = |roots: &[C64]| roots.iter().map(|r| s - r).product::<C64>();
        let found = (system.at(s)?[(0, 0)] * product(&poles) / product(&zeros)).re;
        if found < 0.0 {
            system = system.times(&Mat::from_fn(1, 1, |_, _| -1.0))?;
        }
        gain = Some(found.abs());
    }
    Ok(RoadFilter { system, poles, zeros, gain, roll_off_rad, fit })
}
