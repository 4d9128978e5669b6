//! The job `road fit`: a shaping filter from a measured spectrum, a profile, or a road.

use super::identify_outcome::Flag;
use super::new_file::check_new_file;
use super::road_fit_file::{check_name, filter_file, road_of};
use super::road_fit_filter::{Feedthrough, RoadFilter, fit_filter};
use super::road_fit_order::{Choice, choose};
use super::road_fit_source::{FitSamples, FitSource, read_source};
use super::road_fit_words::notes;
use super::spectrum_smooth::averages;
use super::{FitWeight, Input, RoadFitSpec, StudyError};
use crate::linalg::{C64, Mat};
use crate::road::{FilterOutput, FilterVariable};
use crate::subspace::{Order, ShapeSettings, ShapeWeights, Unpaired, Weights};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// The largest order that is tried where none is given.
const MOST_ORDER: usize = 10;
/// Errors of the logarithm (log₁₀, rms) under relative weights above which a filter is none: a factor of three.
const LOST: f64 = 0.5;
/// Densities whose squares a double holds with room for a band.
const HELD: std::ops::RangeInclusive<f64> = 1e-60..=1e60;
/// Orders and block rows at most.
const MOST: usize = 40;

/// A shaping filter, and how near it comes to what it was fitted to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RoadFitOutcome {
    /// What the samples came from.
    pub source: FitSource,
    /// What it runs over.
    pub variable: FilterVariable,
    /// What its output is.
    pub of: FilterOutput,
    /// Samples that were fitted.
    pub samples: usize,
    /// n of the fit.
    pub order: usize,
    /// States of the filter, a roll-off's among them.
    pub states: usize,
    /// As \[re, im\].
    pub poles: Vec<[f64; 2]>,
    /// As \[re, im\]; of one track.
    pub zeros: Vec<[f64; 2]>,
    /// Leading coefficient of numerator over denominator; of one track.
    pub gain: Option<f64>,
    /// Rows of the state space.
    pub a: Vec<Vec<f64>>,
    /// Rows.
    pub b: Vec<Vec<f64>>,
    /// Rows.
    pub c: Vec<Vec<f64>>,
    /// Rows.
    pub d: Vec<Vec<f64>>,
    /// Root mean square of log₁₀ of fitted over given density (of a matrix: trace).
    pub log10_rms_error: f64,
    /// The largest one's magnitude.
    pub log10_max_error: f64,
    /// Lowest and highest frequency of the samples, rad/m or rad/s.
    pub band: [f64; 2],
    /// Unit of frequencies and poles.
    pub unit: String,
    /// Whether the fit fell below zero and was lifted.
    pub positivity_repaired: bool,
    /// Poles without a mirror image that were folded.
    pub folded: usize,
    /// λ.
    pub lambda: f64,
    /// p.
    pub p: usize,
    /// Whether the filter follows the samples; if not, no file is written.
    pub usable: bool,
    /// How noisy the samples were taken to be: `none`, `relative`, `relative2` or `given` (a column weight).
    pub weight: String,
    /// Corner of the low-pass that makes the filter strictly proper.
    pub roll_off_rad: Option<f64>,
    /// How many times it is passed.
    pub roll_off_order: usize,
    /// Names of the road inputs of a matrix.
    pub points: Vec<String>,
    /// 2n of them stand out where there are n states.
    pub singular_values: Vec<f64>,
    /// The orders that were tried, where one was to be chosen.
    pub orders: Vec<FitOrder>,
    /// The samples beside the fit (of a matrix: traces), two-sided with var = (1/2π) ∫ S.
    pub spectrum: FittedSpectrum,
    /// What is to be known.
    pub notes: Vec<Flag>,
    /// The file that was written.
    pub file: Option<String>,
}

/// An order that was tried.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FitOrder {
    /// n.
    pub order: usize,
    /// As the outcome's; none where the order can't be fitted.
    pub log10_rms_error: Option<f64>,
    /// Bayes' criterion, N ln(Σwr²/Σw) + k ln N of the relative errors r.
    pub bic: Option<f64>,
}

/// Samples and fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FittedSpectrum {
    /// rad/m or rad/s.
    pub omega_rad: Vec<f64>,
    /// As they were given.
    pub given: Vec<f64>,
    /// As the written filter has them.
    pub fitted: Vec<f64>,
}

/// An outcome, the file to be written, and the files read.
#[derive(Debug)]
pub struct RoadFitRun {
    /// What was found.
    pub outcome: RoadFitOutcome,
    /// To be written, where that was asked for.
    pub file: Option<(PathBuf, Vec<u8>)>,
    /// Every file that was read.
    pub inputs: Vec<Input>,
}

/// The filter of the source that a spec names; the caller writes its file.
///
/// # Errors
/// A source that is none, with file and line; settings that can't be; too few samples for the order; a fit that fails.
pub fn road_fit(spec: &RoadFitSpec) -> Result<RoadFitRun, StudyError> {
    check_settings(spec)?;
    let mut samples = read_source(spec)?;
    if let Some(output) = &spec.output {
        check_name(output)?;
    }
    check_points(&spec.points, size(&samples))?;
    let (settings, most, weight) = settings(spec, &samples)?;
    let scale = scale_of(&mut samples);
    // points move what stands on them by dampers too: their velocities must not be white
    let roll_off_order = spec.roll_off_order.unwrap_or(if size(&samples) > 1 { 2 } else { 1 });
    let feedthrough = match (samples.of, spec.proper, spec.roll_off_rad) {
        (_, true, _) | (FilterOutput::Velocity, _, None) => Feedthrough::Keep,
        (_, _, corner) => Feedthrough::RollOff(corner, roll_off_order),
    };
    let fail = |source| StudyError::Shape { name: spec.source.clone(), source: Box::new(source) };
    let (omega, s) = (&samples.omega, &samples.s);
    let averages = averages(omega, s);
    let (filter, orders) = match spec.order {
        Some(_) => (fit_filter(omega, s, &settings, feedthrough).map_err(fail)?, Vec::new()),
        None => {
            let choice = if samples.kind == FitSource::Road { Choice::Accuracy } else { Choice::Criterion };
            choose(omega, s, &settings, feedthrough, most, choice).map_err(fail)?
        }
    };
    let filter = filter.times(scale).map_err(fail)?;
    samples
        .s
        .iter_mut()
        .for_each(|s| *s = &*s * faer::Scale(C64::new(scale, 0.0)) * faer::Scale(C64::new(scale, 0.0)));
    let spectrum = compared(&filter, &samples, &spec.source)?;
    let errors: Vec<f64> = spectrum
        .given
        .iter()
        .zip(&spectrum.fitted)
        .filter(|(given, _)| **given > 0.0)
        .map(|(given, fitted)| (fitted / given).log10())
        .collect();
    let model = &filter.fit.model;
    let over = samples.variable == FilterVariable::Distance;
    let mut outcome = RoadFitOutcome {
        source: samples.kind,
        variable: samples.variable,
        of: samples.of,
        samples: samples.omega.len(),
        order: model.order,
        states: filter.system.order(),
        poles: pairs(&filter.poles),
        zeros: pairs(&filter.zeros),
        gain: filter.gain,
        a: rows(filter.system.a()),
        b: rows(filter.system.b()),
        c: rows(filter.system.c()),
        d: rows(filter.system.d()),
        log10_rms_error: (errors.iter().map(|e| e * e).sum::<f64>() / errors.len().max(1) as f64).sqrt(),
        log10_max_error: errors.iter().map(|e| e.abs()).fold(0.0, f64::max),
        band: filter.fit.band_rad,
        unit: if over { "rad/m" } else { "rad/s" }.to_owned(),
        positivity_repaired: model.repair.is_some(),
        folded: model.summand.folded,
        lambda: filter.fit.lambda_rad,
        p: filter.fit.block_rows,
        weight: weight.to_owned(),
        roll_off_rad: filter.roll_off_rad,
        roll_off_order,
        points: spec.points.clone(),
        singular_values: model.singular_values.clone(),
        orders,
        spectrum,
        notes: std::mem::take(&mut samples.notes),
        usable: true,
        file: spec.output.as_ref().map(|p| p.display().to_string()),
    };
    // equal and given weights may leave small densities aside on purpose
    outcome.usable = weight != "relative2" || outcome.log10_rms_error <= LOST;
    if !outcome.usable {
        outcome.file = None;
    }
    outcome.notes.extend(notes(&outcome, &filter, spec.order, averages));
    let file = match &spec.output {
        Some(path) if outcome.usable => {
            Some((path.clone(), filter_file(path, &outcome, &samples, &spec.source)?))
        }
        _ => None,
    };
    Ok(RoadFitRun { outcome, file, inputs: samples.inputs })
}

/// Channels of the spectrum.
fn size(samples: &FitSamples) -> usize {
    samples.s.first().map_or(1, |s| s.nrows())
}

/// Names of road inputs are as many as the spectrum has channels, each once.
fn check_points(points: &[String], m: usize) -> Result<(), StudyError> {
    let setting =
        |expected: String, found: String| Err(StudyError::Setting { field: "points", expected, found });
    if points.is_empty() {
        return Ok(());
    }
    if m == 1 {
        return setting("none: they name the channels of a matrix spectrum".into(), points.join(","));
    }
    if points.len() != m {
        return setting(
            format!("{m} names, one a channel of the spectrum"),
            format!("{} names", points.len()),
        );
    }
    if let Some(i) = (1..m).find(|i| points[..*i].contains(&points[*i])) {
        return setting("every name once".into(), format!("`{}` twice", points[i]));
    }
    if points.iter().any(|p| p.trim().is_empty()) {
        return setting("names".into(), "an empty one".into());
    }
    Ok(())
}

fn check_settings(spec: &RoadFitSpec) -> Result<(), StudyError> {
    let setting = |field, expected: &str, found: String| {
        Err(StudyError::Setting { field, expected: expected.to_owned(), found })
    };
    if let Some(output) = &spec.output {
        check_new_file(output, spec.overwrite)?;
    }
    for (field, value) in
        [("lambda", spec.lambda_rad), ("roll_off", spec.roll_off_rad), ("segment_m", spec.segment_m)]
    {
        if let Some(v) = value.filter(|v| !(*v > 0.0 && v.is_finite())) {
            return setting(field, "a positive number", v.to_string());
        }
    }
    for (field, value, most) in
        [("order", spec.order, MOST), ("max_order", spec.max_order, MOST), ("p", spec.block_rows, 5 * MOST)]
    {
        if value.is_some_and(|v| !(1..=most).contains(&v)) {
            return setting(field, &format!("a number from 1 to {most}"), value.unwrap_or(0).to_string());
        }
    }
    if let Some(times) = spec.roll_off_order.filter(|k| !(1..=2).contains(k)) {
        return setting("roll_off_order", "1 or 2", times.to_string());
    }
    if spec.order.is_some() && spec.max_order.is_some() {
        return setting("max_order", "either order or max_order", "both".into());
    }
    if spec.proper && (spec.roll_off_rad.is_some() || spec.roll_off_order.is_some()) {
        return setting("proper", "either a roll-off or a filter that keeps its feedthrough", "both".into());
    }
    if let Some([low, high]) = spec.band_rad
        && !(low > 0.0 && high > low && high.is_finite())
    {
        return setting("band", "two ascending frequencies above 0", format!("{low},{high}"));
    }
    Ok(())
}

/// How the fit is done, the largest order to try, and what its weights are called.
fn settings(
    spec: &RoadFitSpec,
    samples: &FitSamples,
) -> Result<(ShapeSettings, usize, &'static str), StudyError> {
    let m = samples.s.first().map_or(1, |s| s.nrows());
    let count = samples.omega.len();
    // p ≥ 2n/m + 1 block rows, p m + 2n equations of (2N − 1) m at least
    let most = (2 * count).saturating_sub(1) * m / 4;
    if most == 0 {
        let expected = "3 frequencies or more to fit".to_owned();
        let field = if spec.band_rad.is_some() { "band" } else { "samples" };
        return Err(StudyError::Setting { field, expected, found: format!("{count} in {}", spec.source) });
    }
    let order = match spec.order {
        Some(n) if n > most => {
            let expected = format!("at most {most} of {count} frequencies");
            return Err(StudyError::Setting { field: "order", expected, found: n.to_string() });
        }
        Some(n) => Order::Given(n),
        None => Order::Given(1),
    };
    let (weights, name) = match (spec.weight, &samples.variances) {
        (Some(FitWeight::None), _) => (ShapeWeights::Equal, "none"),
        (Some(FitWeight::Relative), _) => (ShapeWeights::Relative, "relative"),
        (None, Some(r)) => (ShapeWeights::Given(Weights::Variances(r.clone())), "given"),
        (Some(FitWeight::Relative2), _) | (None, None) => (ShapeWeights::RelativeSquared, "relative2"),
    };
    let allowed = spec.block_rows.map_or(most, |p| most.min(p.saturating_sub(1) * m / 2));
    if allowed < spec.order.unwrap_or(1) {
        let n = spec.order.unwrap_or(1);
        let expected = format!("{} or more, (2 order)/{m} + 1 of order {n}", (2 * n).div_ceil(m) + 1);
        let found = spec.block_rows.unwrap_or(0).to_string();
        return Err(StudyError::Setting { field: "p", expected, found });
    }
    let settings = ShapeSettings {
        order,
        block_rows: spec.block_rows,
        lambda_rad: spec.lambda_rad,
        weights,
        unpaired: Unpaired::Fold,
        roll_off_rad: None,
    };
    Ok((settings, spec.max_order.unwrap_or((MOST_ORDER * m).min(MOST)).min(allowed), name))
}

/// A power of two by which a filter is larger than that of the samples as they are now, where densities were too large or too small for
/// their squares; else 1.
fn scale_of(samples: &mut FitSamples) -> f64 {
    let largest = samples.s.iter().map(|s| s.norm_max()).fold(0.0, f64::max);
    if HELD.contains(&largest) || !(largest > 0.0) {
        return 1.0;
    }
    let scale = 2f64.powi((0.5 * largest.log2()).round() as i32);
    samples.s.iter_mut().for_each(|s| {
        *s = &*s * faer::Scale(C64::new(1.0 / scale, 0.0)) * faer::Scale(C64::new(1.0 / scale, 0.0))
    });
    scale
}

/// Samples beside the filter that will be written: of one track through the road that its file makes.
fn compared(filter: &RoadFilter, samples: &FitSamples, name: &str) -> Result<FittedSpectrum, StudyError> {
    let given = samples.s.iter().map(|s| (0..s.nrows()).map(|i| s[(i, i)].re).sum()).collect();
    let fitted = if filter.system.outputs() == 1 {
        let road = road_of(filter, samples)
            .build()
            .map_err(|source| StudyError::Road { name: name.to_owned(), source })?;
        let velocity = samples.of == FilterOutput::Velocity;
        let of = |w: &f64| road.spectrum().psd(*w, 1.0) * if velocity { w * w } else { 1.0 };
        samples.omega.iter().map(of).collect()
    } else {
        let fail =
            |e: crate::lti::LtiError| StudyError::Shape { name: name.to_owned(), source: Box::new(e.into()) };
        let trace = |w: &f64| filter.system.at(C64::new(0.0, *w)).map(|h| h.norm_l2().powi(2)).map_err(fail);
        samples.omega.iter().map(trace).collect::<Result<_, _>>()?
    };
    Ok(FittedSpectrum { omega_rad: samples.omega.clone(), given, fitted })
}

pub(super) fn pairs(z: &[C64]) -> Vec<[f64; 2]> {
    z.iter().map(|z| [z.re, z.im]).collect()
}

pub(super) fn rows(m: &Mat) -> Vec<Vec<f64>> {
    (0..m.nrows()).map(|i| (0..m.ncols()).map(|j| m[(i, j)]).collect()).collect()
}
