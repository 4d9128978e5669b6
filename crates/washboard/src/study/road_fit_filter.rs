//! A shaping filter that a road can be: strictly proper where it shapes height.

use crate::linalg::{C64, CMat, Mat};
use crate::lti::{Continuous, StateSpace};
use crate::subspace::{ShapeFit, ShapeSettings, ShapeWeights, SubspaceError, Weights, fit_shape};

/// A feedthrough below this share of the response at the band's upper end is rounding.
const NEGLIGIBLE: f64 = 1e-8;
/// Where the low-pass has its corner, over the band's upper end, where nothing is given.
const BEYOND: f64 = 2.0;
/// Zeros beyond this multiple of the band's upper end come of rounding.
const FAR: f64 = 1e6;

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

/// What is done with a feedthrough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Feedthrough {
    /// It stays.
    Keep,
    /// A low-pass at this corner, or twice the band's upper end, takes it away.
    RollOff(Option<f64>),
}

/// Fits the samples; a filter with feedthrough, where none may be, is fitted once more to S(1 + ω²/ω_r²) and followed by ω_r/(s + ω_r), so
/// that the low-pass bends nothing within the band.
pub(super) fn fit_filter(
    omega: &[f64],
    s: &[CMat],
    settings: &ShapeSettings,
    feedthrough: Feedthrough,
) -> Result<RoadFilter, SubspaceError> {
    let fit = fit_shape(omega, s, settings)?;
    let high = fit.band_rad[1];
    let size = fit.filter.at(C64::new(0.0, high))?.norm_l2();
    let proper = fit.filter.d().norm_l2() > NEGLIGIBLE * size;
    match feedthrough {
        Feedthrough::RollOff(corner) if proper || corner.is_some() => {
            let corner = corner.unwrap_or(BEYOND * high);
            let lift: Vec<f64> = omega.iter().map(|w| 1.0 + (w / corner).powi(2)).collect();
            let lifted: Vec<CMat> =
                s.iter().zip(&lift).map(|(s, l)| s * faer::Scale(C64::new(*l, 0.0))).collect();
            let squares =
                |r: &[f64]| Weights::Variances(r.iter().zip(&lift).map(|(r, l)| r * l * l).collect());
            // an error of S is one of S(1 + ω²/ω_r²) that is as many times larger
            let weights = match &settings.weights {
                ShapeWeights::Equal => ShapeWeights::Given(squares(&vec![1.0; omega.len()])),
                ShapeWeights::Given(Weights::Variances(r)) => ShapeWeights::Given(squares(r)),
                other => other.clone(),
            };
            let fit = fit_shape(omega, &lifted, &ShapeSettings { weights, ..settings.clone() })?;
            let m = fit.filter.outputs();
            let eye = |v: f64| Mat::from_fn(m, m, |i, j| if i == j { v } else { 0.0 });
            let low_pass = StateSpace::continuous(eye(-corner), eye(corner), eye(1.0), Mat::zeros(m, m))?;
            let system = fit.filter.series(&low_pass)?;
            let zeros = fit.zeros.clone();
            of(system, zeros, high, Some(corner), fit)
        }
        Feedthrough::RollOff(_) => {
            let g = &fit.filter;
            let (p, m) = (g.outputs(), g.inputs());
            let system =
                StateSpace::continuous(g.a().clone(), g.b().clone(), g.c().clone(), Mat::zeros(p, m))?;
            let zeros = fit.zeros.iter().copied().filter(|z| z.norm() < FAR * high).collect();
            of(system, zeros, high, None, fit)
        }
        Feedthrough::Keep => {
            let (system, zeros) = (fit.filter.clone(), fit.zeros.clone());
            of(system, zeros, high, None, fit)
        }
    }
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
