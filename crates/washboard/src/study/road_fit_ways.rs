//! The ways to a road's filter of an order: corners of the low-pass and how often it is passed; the nearest is taken.

use super::road_fit_filter::{Band, RoadFilter, as_near};
use super::road_fit_words::drop;
use crate::linalg::{C64, CMat};
use crate::subspace::{Order, ShapeProblem, ShapeSettings, ShapeWeights, SubspaceError, Weights};

/// Where the low-pass has its corner where nothing is given: half the band's lower end (heights fall over the whole band, as a road's), or
/// twice its upper end (they fall beyond it), whichever fits better.
const CORNERS: [f64; 2] = [0.5, 2.0];
/// How many times the low-pass of a matrix is passed where nothing is given: twice, as points move what stands on them by dampers too and
/// their velocities must not be white, unless once comes nearer, as to heights that fall as 1/ω² at the band's upper end.
const PASSES: [usize; 2] = [2, 1];
/// The filter of an order, and the orders that the singular values of each way to it tell.
pub(super) struct Found {
    pub filter: RoadFilter,
    pub told: Vec<usize>,
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
        // and a level is one of what is fitted, as the samples are
        ShapeWeights::Like { level, squared } => {
            let level = level.iter().zip(&lift).map(|(d, l)| d * l).collect();
            ShapeWeights::Like { level, squared: *squared }
        }
        other => other.clone(),
    };
    ShapeProblem::new(omega, &lifted, &ShapeSettings { weights, ..settings.clone() })
}
