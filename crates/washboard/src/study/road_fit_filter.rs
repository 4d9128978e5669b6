//! A shaping filter that a road can be (strictly proper where it shapes height), and the choice of its order.

use super::FitOrder;
use super::road_fit_words::drop;
use crate::linalg::{C64, CMat, Mat, solve};
use crate::lti::{Continuous, StateSpace};
use crate::subspace::{Order, ShapeFit, ShapeSettings, ShapeWeights, SubspaceError, Weights, fit_shape};

/// A rest of the low-pass below this share of the smallest response in the band is rounding.
const NEGLIGIBLE: f64 = 1e-8;
/// Where the low-pass has its corner where nothing is given: half the band's lower end (heights fall over the whole band, as a road's), or
/// twice its upper end (they fall beyond it), whichever fits better.
const CORNERS: [f64; 2] = [0.5, 2.0];
/// Relative errors below this are rounding: a higher order can't be better.
const EXACT: f64 = 1e-8;
/// Exact data are followed to this log₁₀ error (rms) by the order that singular values tell: none is better.
const FOLLOWED: f64 = 1e-6;
/// A road is followed to this log₁₀ error (rms), where an order is to be chosen.
pub(super) const ACCURATE: f64 = 0.02;

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
    /// A low-pass at this corner, or at one of [`CORNERS`], takes it away; passed this many times.
    RollOff(Option<f64>, usize),
}

/// How an order is chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Choice {
    /// N ln(Σ w r²/N) + k ln N of the relative errors r is smallest: noisy samples.
    Criterion,
    /// The lowest order that is accurate, or else the most accurate: exact samples.
    Accuracy,
}

/// What one order gave: its error, and how many singular values stand out.
struct Attempt {
    error: f64,
    told: Option<usize>,
}

/// The filter of the best order from 1 to `most` (of a matrix: of the multiples of its size, and first of the one that singular
/// values tell), and all that were tried.
pub(super) fn choose(
    omega: &[f64],
    s: &[CMat],
    settings: &ShapeSettings,
    feedthrough: Feedthrough,
    most: usize,
    choice: Choice,
) -> Result<(RoadFilter, Vec<FitOrder>), SubspaceError> {
    let m = s.first().map_or(1, |s| s.nrows());
    let mut tried: Vec<FitOrder> = Vec::new();
    let mut best: Option<(f64, RoadFilter)> = None;
    let mut failure = None;
    let mut attempt =
        |order: usize, best: &mut Option<(f64, RoadFilter)>| -> Result<Attempt, SubspaceError> {
            let one = ShapeSettings { order: Order::Given(order), ..settings.clone() };
            match fit_filter(omega, s, &one, feedthrough) {
                Err(e) => {
                    tried.push(FitOrder { order, log10_rms_error: None, bic: None });
                    failure = Some(e);
                    Ok(Attempt { error: f64::INFINITY, told: None })
                }
                Ok(filter) => {
                    let error = filter.fit.log10_rms_error;
                    let told = drop(&filter.fit.model.singular_values);
                    let bic = criterion(&filter, omega, s, &settings.weights)?;
                    tried.push(FitOrder { order, log10_rms_error: Some(error), bic: Some(bic) });
                    let value = if choice == Choice::Criterion { bic } else { error };
                    if best.as_ref().is_none_or(|b| value < b.0) {
                        *best = Some((value, filter));
                    }
                    Ok(Attempt { error, told })
                }
            }
        };
    // as many states more for every channel, or one step after another
    for order in (m..=most).step_by(m) {
        let found = attempt(order, &mut best)?;
        if choice == Choice::Accuracy && found.error < ACCURATE {
            break;
        }
        // of exact data singular values tell the order, 2n of them: a matrix's is beyond many that are slow to try
        let told = found.told.map(|k| k / 2).filter(|n| m > 1 && order == m && (m + 1..=most).contains(n));
        if let Some(n) = told
            && attempt(n, &mut best)?.error < FOLLOWED
        {
            break;
        }
    }
    tried.sort_by_key(|t| t.order);
    tried.dedup_by_key(|t| t.order);
    match (best, failure) {
        (Some((_, filter)), _) => Ok((filter, tried)),
        (None, Some(e)) => Err(e),
        (None, None) => {
            let (expected, found) = ("1 or more".to_owned(), most.to_string());
            Err(SubspaceError::Field { field: "max_order", expected, found })
        }
    }
}

/// Fits the samples. Where no feedthrough may be, S(1 + ω²/ω_r²)ᵏ is fitted and followed by (ω_r/(s + ω_r))ᵏ: the low-pass bends nothing within the
/// band, and a spectrum as steep as a road's becomes flat before it is fitted.
pub(super) fn fit_filter(
    omega: &[f64],
    s: &[CMat],
    settings: &ShapeSettings,
    feedthrough: Feedthrough,
) -> Result<RoadFilter, SubspaceError> {
    let low = omega.iter().copied().find(|w| *w > 0.0).unwrap_or(1.0);
    let high = omega.last().copied().filter(|w| *w > 0.0).unwrap_or(1.0);
    let times = match feedthrough {
        Feedthrough::RollOff(Some(corner), times) => {
            return rolled(omega, s, settings, corner, times, high);
        }
        Feedthrough::Keep => {
            let fit = fit_shape(omega, s, settings)?;
            return of(fit.filter.clone(), fit.zeros.clone(), high, None, fit);
        }
        Feedthrough::RollOff(None, times) => times,
    };
    let [below, beyond] =
        [CORNERS[0] * low, CORNERS[1] * high].map(|c| rolled(omega, s, settings, c, times, high));
    match (below, beyond) {
        // without a state for the low-pass, if one can
        (Ok(a), Ok(b)) if a.roll_off_rad.is_none() != b.roll_off_rad.is_none() => {
            Ok(if a.roll_off_rad.is_none() { a } else { b })
        }
        (Ok(a), Ok(b)) => Ok(if a.fit.log10_rms_error <= b.fit.log10_rms_error { a } else { b }),
        (Ok(one), Err(_)) | (Err(_), Ok(one)) => Ok(one),
        (Err(e), Err(_)) => Err(e),
    }
}

fn rolled(
    omega: &[f64],
    s: &[CMat],
    settings: &ShapeSettings,
    corner: f64,
    times: usize,
    high: f64,
) -> Result<RoadFilter, SubspaceError> {
    let lift: Vec<f64> =
        omega.iter().map(|w| (0..times).fold(1.0, |lift, _| lift * (1.0 + (w / corner).powi(2)))).collect();
    let lifted: Vec<CMat> = s.iter().zip(&lift).map(|(s, l)| s * faer::Scale(C64::new(*l, 0.0))).collect();
    let squares = |r: &[f64]| Weights::Variances(r.iter().zip(&lift).map(|(r, l)| r * l * l).collect());
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
    let mut zeros = fit.zeros.clone();
    let mut system = fit.filter.clone();
    let mut appended = false;
    for pass in 1..=times {
        // the last of several stays: behind a strictly proper filter it makes C B exactly 0, and no velocity is white
        let without =
            if pass == times && times > 1 { None } else { without_low_pass(&system, omega, corner)? };
        if let Some(without) = without {
            // the zero that the low-pass's pole meets
            let off = |z: &C64| (*z + corner).norm();
            let nearest = (0..zeros.len()).min_by(|a, b| off(&zeros[*a]).total_cmp(&off(&zeros[*b])));
            nearest.map(|k| zeros.remove(k));
            system = without;
        } else {
            system = system.series(&low_pass)?;
            appended = true;
        }
    }
    of(system, zeros, high, appended.then_some(corner), fit)
}

/// G(s) c/(s + c) = C(sI − A)⁻¹B′ + c G(−c)/(s + c) with B′ = c(A + cI)⁻¹B: strictly proper without another state where G(−c) is rounding, as it
/// is where the samples are of a strictly proper filter.
fn without_low_pass(
    g: &StateSpace<Continuous>,
    omega: &[f64],
    c: f64,
) -> Result<Option<StateSpace<Continuous>>, SubspaceError> {
    let n = g.order();
    let shifted = Mat::from_fn(n, n, |i, j| g.a()[(i, j)] + if i == j { c } else { 0.0 });
    // a pole at −c itself
    let Ok(b) = solve(&shifted, g.b()) else { return Ok(None) };
    let rest = (g.d() - g.c() * &b).norm_l2();
    let mut least = f64::INFINITY;
    for w in omega {
        least = least.min(g.at(C64::new(0.0, *w))?.norm_l2());
    }
    if !(rest <= NEGLIGIBLE * least) {
        return Ok(None);
    }
    let none = Mat::zeros(g.outputs(), g.inputs());
    Ok(Some(StateSpace::continuous(g.a().clone(), b * faer::Scale(c), g.c().clone(), none)?))
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
        let h = filter.system.at(C64::new(0.0, *w))?;
        let (found, size) = (&h * h.adjoint(), s.norm_l2());
        if size == 0.0 {
            continue;
        }
        let error = if m == 1 { (found[(0, 0)].re / size).ln() } else { (found - s).norm_l2() / size };
        // S²/R: how many times the error that is looked for the sample's own is not
        let weight = match weights {
            ShapeWeights::Equal => size * size,
            ShapeWeights::Relative => size,
            ShapeWeights::Given(Weights::Variances(r)) => size * size / r[k],
            ShapeWeights::RelativeSquared | ShapeWeights::Given(_) => 1.0,
        };
        sum += weight * error * error;
        total += weight;
    }
    let observed = (omega.len() * m * m) as f64;
    let unknowns = (2 * filter.fit.model.order * m + m * (m + 1) / 2) as f64;
    Ok(observed * (sum / total).max(EXACT * EXACT).ln() + unknowns * observed.ln())
}
