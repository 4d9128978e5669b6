//! The job `road fit`: a shaping filter from a measured spectrum, a profile, or a road.

use super::identify_outcome::Flag;
use super::road_fit_cross::CrossError;
use super::road_fit_file::{check_name, filter_file, road_of};
use super::road_fit_filter::RoadFilter;
use super::road_fit_order::{Choice, choose};
use super::road_fit_settings::{check_lambda, check_points, check_settings, scale_of, settings, size};
use super::road_fit_source::{FitSamples, FitSource, read_source};
use super::road_fit_ways::{Feedthrough, fit_filter};
use super::road_fit_words::notes;
use super::spectrum_noise::Noise;
use super::{Input, RoadFitSpec, StudyError};
use crate::linalg::{C64, Mat};
use crate::road::{FilterOutput, FilterVariable};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Block rows beyond the least that noisy matrices are fitted with.
const SPARE_ROWS: usize = 4;
/// Errors of the logarithm (log₁₀, rms) under relative weights above which a filter is none: a factor of three.
const LOST: f64 = 0.5;

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
    /// Errors of a matrix's cross-spectra, which the trace does not show; none of one channel or without coherence.
    #[serde(default)]
    pub cross: Option<CrossError>,
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
    /// How many times the fit allows for it, given or as many as come nearest to the samples; 0 where a feedthrough stays.
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
    /// n that was asked for.
    pub order: usize,
    /// n of the fit, where a lower one comes nearest to the samples.
    pub lowered_to: Option<usize>,
    /// How many times its low-pass is passed; 0 where a feedthrough stays, none where the order can't be fitted.
    pub roll_off_order: Option<usize>,
    /// Whether this is the one that was taken.
    pub chosen: bool,
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
    fit_samples(spec, read_source(spec)?)
}

/// The same of samples that are at hand under the name that the spec has.
pub(super) fn fit_samples(spec: &RoadFitSpec, mut samples: FitSamples) -> Result<RoadFitRun, StudyError> {
    if let Some(output) = &spec.output {
        check_name(output)?;
    }
    check_points(&spec.points, size(&samples))?;
    let (mut settings, most, weight) = settings(spec, &samples)?;
    check_lambda(spec, &samples)?;
    let scale = scale_of(&mut samples);
    let feedthrough = match (samples.of, spec.proper, spec.roll_off_rad) {
        (_, true, _) | (FilterOutput::Velocity, _, None) => Feedthrough::Keep,
        (_, _, corner) => Feedthrough::RollOff(corner, spec.roll_off_order),
    };
    let fail = |source| StudyError::Shape { name: spec.source.clone(), source: Box::new(source) };
    let (omega, s) = (&samples.omega, &samples.s);
    // a profile's bands are too far apart for it, a road's samples are exact
    let noise = if samples.kind == FitSource::Spectrum { Noise::of(omega, s) } else { None };
    if let Some(noise) = &noise {
        settings.weights = noise.weights(&settings.weights);
        settings.spare_rows = (size(&samples) > 1).then_some(SPARE_ROWS);
    }
    let likely = noise.as_ref().filter(|_| weight.starts_with("relative"));
    let (filter, orders) = match spec.order {
        Some(_) => (fit_filter(omega, s, &settings, feedthrough).map_err(fail)?, Vec::new()),
        None => {
            let choice =
                if samples.kind == FitSource::Road { Choice::Accuracy } else { Choice::Criterion(likely) };
            choose(omega, s, &settings, feedthrough, most, choice).map_err(fail)?
        }
    };
    let filter = filter.times(scale).map_err(fail)?;
    samples
        .s
        .iter_mut()
        .for_each(|s| *s = &*s * faer::Scale(C64::new(scale, 0.0)) * faer::Scale(C64::new(scale, 0.0)));
    let spectrum = compared(&filter, &samples, &spec.source)?;
    let averages = noise.as_ref().map(|n| n.averages);
    let cross = CrossError::of(&filter, &samples.omega, &samples.s, averages).map_err(fail)?;
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
        log10_rms_error: filter.log10_rms_error,
        log10_max_error: filter.log10_max_error,
        cross,
        band: filter.fit.band_rad,
        unit: if over { "rad/m" } else { "rad/s" }.to_owned(),
        positivity_repaired: model.repair.is_some(),
        folded: model.summand.folded,
        lambda: filter.fit.lambda_rad,
        p: filter.fit.block_rows,
        weight: weight.to_owned(),
        roll_off_rad: filter.roll_off_rad,
        roll_off_order: filter.passes,
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
    outcome.notes.extend(outcome.cross.as_ref().and_then(|c| c.note(&outcome.unit)));
    let file = match &spec.output {
        Some(path) if outcome.usable => {
            Some((path.clone(), filter_file(path, &outcome, &samples, &spec.source)?))
        }
        _ => None,
    };
    Ok(RoadFitRun { outcome, file, inputs: samples.inputs })
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
