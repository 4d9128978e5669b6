//! A shaping filter that a road can be: strictly proper where it shapes height.

use super::road_fit_words::drop;
use crate::linalg::{C64, CMat, Mat, eigen, solve, solve_complex};
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
/// How many times the low-pass of a matrix is passed where nothing is given: twice, as points move what stands on them by dampers too and
/// their velocities must not be white, unless once comes nearer, as to heights that fall as 1/ω² at the band's upper end.
const PASSES: [usize; 2] = [2, 1];
/// Poles beyond this many times the band's upper end are made of what a fit leaves: no sample shows them.
const FAR_POLE: f64 = 30.0;

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
    /// How many times the low-pass was allowed for; 0 where a feedthrough stays.
    pub passes: usize,
    /// Root mean square of log₁₀ of the filter's over the given trace at the samples: of what is written, its low-pass among it.
    pub log10_rms_error: f64,
    /// Its largest magnitude.
    pub log10_max_error: f64,
    pub fit: ShapeFit,
}

/// The filter of an order, and the orders that the singular values of each way to it tell.
pub(super) struct Found {
    pub filter: RoadFilter,
    pub told: Vec<usize>,
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

    /// Poles far beyond the band, by [`FAR_POLE`].
    pub fn far_poles(&self) -> Vec<C64> {
        let far = FAR_POLE * self.fit.band_rad[1];
        self.poles.iter().copied().filter(|p| p.norm() > far).collect()
    }

    /// The share of the variance that the filter's part of these poles has: Σ tr(Rᵢ Rⱼᴴ)/−(pᵢ + p̄ⱼ) of their residues over that of all. None
    /// where poles are repeated, or where the filter keeps a feedthrough.
    pub fn share_of(&self, poles: &[C64]) -> Option<f64> {
        let g = &self.system;
        if g.d().norm_l2() > 0.0 {
            return None;
        }
        let (values, vectors) = eigen(g.a()).ok()?;
        let complex = |m: &Mat| CMat::from_fn(m.nrows(), m.ncols(), |i, j| C64::new(m[(i, j)], 0.0));
        let (seen, driven) = (complex(g.c()) * &vectors, solve_complex(&vectors, &complex(g.b())).ok()?);
        let variance = |kept: &dyn Fn(C64) -> bool| -> f64 {
            let of: Vec<usize> = (0..values.len()).filter(|k| kept(values[*k])).collect();
            let pair = |i: usize, j: usize| {
                let left: C64 = (0..seen.nrows()).map(|k| seen[(k, i)] * seen[(k, j)].conj()).sum();
                let right: C64 = (0..driven.ncols()).map(|k| driven[(i, k)] * driven[(j, k)].conj()).sum();
                (left * right / -(values[i] + values[j].conj())).re
            };
            of.iter().flat_map(|i| of.iter().map(move |j| (*i, *j))).map(|(i, j)| pair(i, j)).sum()
        };
        let least = poles.iter().map(|p| p.norm()).fold(f64::INFINITY, f64::min) * (1.0 - 1e-6);
        let share = variance(&|p| p.norm() >= least) / variance(&|_| true);
        share.is_finite().then_some(share)
    }
}

/// What is done with a feedthrough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Feedthrough {
    /// It stays.
    Keep,
    /// A low-pass at this corner, or at one of [`CORNERS`], takes it away; passed this many times, or as many as the samples tell
    /// (see [`PASSES`]).
    RollOff(Option<f64>, Option<usize>),
}

/// Fits the samples, see [`FilterProblem`].
pub(super) fn fit_filter(
    omega: &[f64],
    s: &[CMat],
    settings: &ShapeSettings,
    feedthrough: Feedthrough,
) -> Result<RoadFilter, SubspaceError> {
    Ok(FilterProblem::new(omega, s, settings, feedthrough)?.fit(settings.order)?.filter)
}

/// Where no feedthrough may be, S(1 + ω²/ω_r²)ᵏ is fitted and followed by (ω_r/(s + ω_r))ᵏ: the low-pass bends nothing within the
/// band, and a spectrum as steep as a road's becomes flat before it is fitted.
pub(super) struct FilterProblem<'a> {
    omega: &'a [f64],
    s: &'a [CMat],
    /// Upper end of the band.
    high: f64,
    ways: Vec<Way<'a>>,
}

/// What is fitted, and with which low-pass.
struct Way<'a> {
    /// ω_r.
    corner: Option<f64>,
    /// k.
    passes: usize,
    problem: ShapeProblem<'a>,
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
        let m = s.first().map_or(1, |s| s.nrows());
        let ways: Vec<(Option<f64>, usize)> = match feedthrough {
            Feedthrough::Keep => vec![(None, 0)],
            Feedthrough::RollOff(corner, passes) => {
                let corners = corner.map_or_else(|| vec![CORNERS[0] * low, CORNERS[1] * high], |c| vec![c]);
                let all = match passes {
                    Some(k) => vec![k],
                    None if m > 1 => PASSES.to_vec(),
                    None => vec![1],
                };
                all.iter().flat_map(|k| corners.iter().map(|c| (Some(*c), *k))).collect()
            }
        };
        let way = |(corner, passes): (Option<f64>, usize)| {
            let problem = match corner {
                None => ShapeProblem::new(omega, s, settings)?,
                Some(corner) => lifted(omega, s, settings, corner, passes)?,
            };
            Ok(Way { corner, passes, problem })
        };
        let ways = ways.into_iter().map(way).collect::<Result<_, SubspaceError>>()?;
        Ok(FilterProblem { omega, s, high, ways })
    }

    /// # Errors
    /// As [`ShapeProblem::fit`], of the first way where none succeeds.
    pub fn fit(&mut self, order: Order) -> Result<Found, SubspaceError> {
        let (omega, s, high) = (self.omega, self.s, self.high);
        let found: Vec<Result<RoadFilter, SubspaceError>> = self
            .ways
            .iter_mut()
            .map(|way| {
                let fit = way.problem.fit(order)?;
                let band = Band { omega, s, high };
                match way.corner {
                    None => band.finished(fit.filter.clone(), fit.zeros.clone(), None, 0, fit),
                    Some(corner) => band.rolled(fit, corner, way.passes),
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
        let mut told: Vec<usize> =
            filters.iter().filter_map(|f| drop(&f.fit.model.singular_values)).map(|k| k / 2).collect();
        told.sort_unstable();
        told.dedup();
        let nearest = filters.iter().map(|f| f.log10_rms_error).fold(f64::INFINITY, f64::min);
        let added = |f: &RoadFilter| f.system.order().saturating_sub(f.fit.model.order);
        // of those that are as near as the nearest: no pole far beyond the band, the smoothest, fewest states for the low-pass
        let best =
            filters.into_iter().filter(|f| !(f.log10_rms_error > as_near(&f.fit, nearest))).min_by(|f, g| {
                let far = |f: &RoadFilter| !f.far_poles().is_empty();
                far(f)
                    .cmp(&far(g))
                    .then(g.passes.cmp(&f.passes))
                    .then(added(f).cmp(&added(g)))
                    .then(f.log10_rms_error.total_cmp(&g.log10_rms_error))
            });
        match (best, failure) {
            (Some(filter), _) => Ok(Found { filter, told }),
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
    passes: usize,
) -> Result<ShapeProblem<'a>, SubspaceError> {
    let lift: Vec<f64> =
        omega.iter().map(|w| (0..passes).fold(1.0, |lift, _| lift * (1.0 + (w / corner).powi(2)))).collect();
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

/// G(s)(ω_r/(s + ω_r))ᵏ.
fn passed(
    mut g: StateSpace<Continuous>,
    corner: f64,
    passes: usize,
) -> Result<StateSpace<Continuous>, SubspaceError> {
    let m = g.outputs();
    let eye = |v: f64| Mat::from_fn(m, m, |i, j| if i == j { v } else { 0.0 });
    let low_pass = StateSpace::continuous(eye(-corner), eye(corner), eye(1.0), Mat::zeros(m, m))?;
    for _ in 0..passes {
        g = g.series(&low_pass)?;
    }
    Ok(g)
}

/// A system and, of a scalar one, its finite zeros.
type WithZeros = (StateSpace<Continuous>, Vec<C64>);

/// The samples that filters are held against.
struct Band<'a> {
    omega: &'a [f64],
    s: &'a [CMat],
    high: f64,
}

impl Band<'_> {
    /// The fit with the low-pass passed k times, once less where that can be.
    fn rolled(&self, fit: ShapeFit, corner: f64, passes: usize) -> Result<RoadFilter, SubspaceError> {
        if let Some((system, zeros)) = self.without_one(&fit, corner, passes)? {
            let appended = passes > 1;
            return self.finished(system, zeros, appended.then_some(corner), passes, fit);
        }
        let (system, zeros) = (passed(fit.filter.clone(), corner, passes)?, fit.zeros.clone());
        self.finished(system, zeros, Some(corner), passes, fit)
    }

    /// G(s) c/(s + c) = C(sI − A)⁻¹B′ + c G(−c)/(s + c) with B′ = c(A + cI)⁻¹B: strictly proper without another state where G(−c) is rounding, as it
    /// is where the samples are of a strictly proper filter. Taken where it follows the samples as well and is minimum phase. The other k − 1
    /// low-passes stay: behind a strictly proper filter they make C B exactly 0, and no velocity is white.
    fn without_one(&self, fit: &ShapeFit, c: f64, passes: usize) -> Result<Option<WithZeros>, SubspaceError> {
        let g = &fit.filter;
        let n = g.order();
        let shifted = Mat::from_fn(n, n, |i, j| g.a()[(i, j)] + if i == j { c } else { 0.0 });
        // a pole at −c itself
        let Ok(b) = solve(&shifted, g.b()) else { return Ok(None) };
        let none = Mat::zeros(g.outputs(), g.inputs());
        let proper = StateSpace::continuous(g.a().clone(), b * faer::Scale(c), g.c().clone(), none)?;
        let system = passed(proper, c, passes.saturating_sub(1))?;
        if !(self.log10_errors(&system)?[0] <= as_near(fit, fit.log10_rms_error)) {
            return Ok(None);
        }
        let far = FAR * self.high;
        let zeros: Vec<C64> = system.zeros()?.into_iter().filter(|z| z.norm() < far).collect();
        if !zeros.iter().all(|z| z.re < 0.0) {
            return Ok(None);
        }
        Ok(Some((system, if g.outputs() == 1 { zeros } else { Vec::new() })))
    }

    /// Root mean square and largest magnitude of log₁₀ of fitted over given trace.
    fn log10_errors(&self, g: &StateSpace<Continuous>) -> Result<[f64; 2], SubspaceError> {
        let traces: Vec<f64> = self.s.iter().map(|s| (0..s.nrows()).map(|i| s[(i, i)].re).sum()).collect();
        let errors = log10_errors(g, self.omega, &traces)?;
        let rms = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len().max(1) as f64).sqrt();
        Ok([rms, errors.iter().map(|e| e.abs()).fold(0.0, f64::max)])
    }

    /// States scaled, roots sorted, the gain made positive.
    fn finished(
        &self,
        system: StateSpace<Continuous>,
        zeros: Vec<C64>,
        roll_off_rad: Option<f64>,
        passes: usize,
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
            let s = C64::new(0.0, self.high);
            let product = |roots: &[C64]| roots.iter().map(|r| s - r).product::<C64>();
            let found = (system.at(s)?[(0, 0)] * product(&poles) / product(&zeros)).re;
            if found < 0.0 {
                system = system.times(&Mat::from_fn(1, 1, |_, _| -1.0))?;
            }
            gain = Some(found.abs());
        }
        let [log10_rms_error, log10_max_error] = self.log10_errors(&system)?;
        Ok(RoadFilter {
            system,
            poles,
            zeros,
            gain,
            roll_off_rad,
            passes,
            log10_rms_error,
            log10_max_error,
            fit,
        })
    }
}
