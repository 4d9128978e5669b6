//! The job `road analytic`: algorithm 2.4.1, an analytic function from its real or imaginary part, phase or magnitude.

use super::identify_outcome::Flag;
use super::new_file::check_new_file;
use super::number_table::NumberTable;
use super::road_analytic_data::{AXES, angles, checked};
use super::road_fit::{pairs, rows};
use super::{Input, RoadAnalyticSpec, StudyError};
use crate::files::FileError;
use crate::linalg::{C64, Mat, RealSchur};
use crate::lti::StateSpace;
use crate::subspace::{
    AnalyticModel, AnalyticSettings, Part, SubspaceError, Unpaired, Weights, fit_analytic,
};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;
use std::fmt::Write;
use std::path::PathBuf;

/// A stable function, and what it has where only a part of it was given.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RoadAnalyticOutcome {
    /// The column that was given: `real`, `imag`, `phase_rad` or `magnitude`.
    pub given: String,
    /// What the system is: `f`, or `ln f` of a phase or magnitude.
    pub system: String,
    /// n.
    pub order: usize,
    /// p.
    pub p: usize,
    /// λ of s = λ(z − 1)/(z + 1), where the data is over frequency.
    pub lambda: Option<f64>,
    /// Root mean square of the given part less the fitted one.
    pub rms_error: f64,
    /// Root mean square of the given part.
    pub rms_given: f64,
    /// 2n of them stand out where there are n states.
    pub singular_values: Vec<f64>,
    /// Poles that were mirrored.
    pub folded: usize,
    /// Whether the real part fell below zero and was lifted.
    pub positivity_repaired: bool,
    /// In z, as \[re, im\].
    pub poles: Vec<[f64; 2]>,
    /// In z, rows.
    pub a: Vec<Vec<f64>>,
    /// Rows.
    pub b: Vec<Vec<f64>>,
    /// Rows.
    pub c: Vec<Vec<f64>>,
    /// Rows.
    pub d: Vec<Vec<f64>>,
    /// At the samples.
    pub samples: AnalyticSamples,
    /// What is to be known.
    pub notes: Vec<Flag>,
    /// The file that was written.
    pub file: Option<String>,
}

/// f at the samples.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct AnalyticSamples {
    /// Angles on the unit circle.
    pub theta_rad: Vec<f64>,
    /// As they were given.
    pub given: Vec<f64>,
    /// f (for a phase: up to a factor, with ln|f| of mean 0 over the circle).
    pub real: Vec<f64>,
    /// f.
    pub imag: Vec<f64>,
    /// |f|.
    pub magnitude: Vec<f64>,
    /// arg f, of a phase or magnitude continuous, otherwise from −π to π.
    pub phase_rad: Vec<f64>,
}

/// An outcome, the file to be written, and the files read.
#[derive(Debug)]
pub struct RoadAnalyticRun {
    /// What was found.
    pub outcome: RoadAnalyticOutcome,
    /// To be written, where that was asked for.
    pub file: Option<(PathBuf, Vec<u8>)>,
    /// Every file that was read.
    pub inputs: Vec<Input>,
}

/// Values that differ by less than this share of the largest are one value.
const CONSTANT: f64 = 1e-13;
/// Values below this have no digits left.
const LEAST: f64 = 1e-290;
/// Values whose squares a double holds.
const HELD: std::ops::RangeInclusive<f64> = 1e-100..=1e100;
/// The columns that may be given.
const GIVEN: [&str; 4] = ["real", "imag", "phase_rad", "magnitude"];
/// The function of the samples that a spec names; the caller writes its file.
///
/// # Errors
/// A file that is none, with its line; an order too high for the samples; a fit that fails.
pub fn road_analytic(spec: &RoadAnalyticSpec) -> Result<RoadAnalyticRun, StudyError> {
    if let Some(output) = &spec.output {
        check_new_file(output, spec.overwrite)?;
    }
    let table = NumberTable::read(&spec.data, false)?;
    let mut notes = Vec::new();
    let mut note = |name: &str, text: String| notes.push(Flag { name: name.to_owned(), text });
    let known: Vec<&str> = AXES.iter().map(|a| a.0).chain(GIVEN).collect();
    table.only(&known)?;
    let (theta, lambda, chosen) = angles(&table, spec)?;
    if chosen {
        let text =
            "lambda is the geometric mean of the lowest and highest frequency (--lambda gives another)";
        note("lambda-chosen", text.into());
    }
    let found: Vec<&str> = GIVEN.into_iter().filter(|g| table.index(g).is_some()).collect();
    let [given] = found.as_slice() else {
        return Err(table.header_error("one of the columns real, imag, phase_rad, magnitude"));
    };
    let raw = table.index(given).map(|k| table.columns[k].clone()).unwrap_or_default();
    let logarithm = matches!(*given, "phase_rad" | "magnitude");
    let values = checked(&table, given, raw.clone())?;
    let largest = values.iter().map(|v| v.abs()).fold(0.0, f64::max);
    let varies = values.iter().any(|v| (v - values[0]).abs() > CONSTANT * largest);
    if !varies || largest < LEAST {
        let found = format!("{:?} in all {} rows", raw.first().copied().unwrap_or(0.0), raw.len());
        let message = format!(
            "column {given}: expected values that vary, above {LEAST:e}, found {found}: there is no function to find"
        );
        return Err(FileError::content(&table.path, None, message).into());
    }
    // numbers whose squares a double does not hold
    let scale = if HELD.contains(&largest) { 1.0 } else { largest };
    let values: Vec<f64> = values.iter().map(|v| v / scale).collect();
    let part = match (*given, spec.positive) {
        ("real", true) => Part::PositiveReal,
        ("real" | "magnitude", false) => Part::Real,
        ("imag" | "phase_rad", false) => Part::Imaginary,
        _ => {
            let expected = "--positive only with a column real".to_owned();
            return Err(StudyError::Setting { field: "positive", expected, found: (*given).to_owned() });
        }
    };
    let n = spec.order;
    let independent = 2 * theta.len() - theta.iter().filter(|t| **t == 0.0 || **t == PI).count();
    let least = 2 * n + 1;
    let p = spec.block_rows.unwrap_or_else(|| (independent.saturating_sub(2 * n) / 2).min(64).max(least));
    let settings = AnalyticSettings { unpaired: Unpaired::Fold, ..AnalyticSettings::new(n, p) };
    let fail =
        |e: SubspaceError| StudyError::Shape { name: spec.data.display().to_string(), source: Box::new(e) };
    let mut model = fit_analytic(&theta, &values, Weights::Equal, part, &settings).map_err(fail)?;
    if scale != 1.0 {
        let by = |m: &Mat| m * faer::Scale(scale);
        let f = &model.system;
        let scaled = StateSpace::discrete(f.a().clone(), f.b().clone(), by(f.c()), by(f.d()), settings.dt_s);
        model.system = scaled.map_err(|e| fail(e.into()))?;
        model.singular_values.iter_mut().for_each(|s| *s *= scale);
    }
    let values: Vec<f64> = values.iter().map(|v| v * scale).collect();
    let (samples, errors) = evaluated(&model, theta, raw, &values, logarithm, part).map_err(fail)?;
    if model.folded > 0 {
        note(
            "folded",
            format!(
                "poles without a mirror image that were folded into the circle: {}; another order may fit better",
                model.folded
            ),
        );
    }
    if let Some(repair) = &model.repair {
        note(
            "positivity-repaired",
            format!("the real part fell below zero and was lifted, in {} rounds", repair.rounds),
        );
    }
    match *given {
        "imag" => note(
            "no-constant",
            "an imaginary part does not show f's constant: f is 0 at z = infinity (s = lambda)".into(),
        ),
        "phase_rad" => {
            note("no-scale", "a phase does not show f's size: ln|f| has mean 0 over the circle".into())
        }
        "magnitude" => {
            note("minimum-phase", "the phase is that of a stable, minimum-phase f of this magnitude".into())
        }
        _ => {}
    }
    if logarithm {
        note(
            "of-ln-f",
            "ln f is not rational: the order is that of an approximation, whose error is given".into(),
        );
    }
    let rms = |x: &[f64]| {
        (x.iter().map(|x| (x / scale).powi(2)).sum::<f64>() / x.len().max(1) as f64).sqrt() * scale
    };
    let a = model.system.a();
    let mut poles = if a.nrows() == 0 {
        Vec::new()
    } else {
        RealSchur::new(a).map_err(|e| fail(e.into()))?.eigenvalues().to_vec()
    };
    poles.sort_by(|x: &C64, y| x.norm().total_cmp(&y.norm()).then(x.im.total_cmp(&y.im)));
    let file = spec.output.as_ref().map(|path| (path.clone(), csv(&samples, given)));
    let outcome = RoadAnalyticOutcome {
        given: (*given).to_owned(),
        system: if logarithm { "ln f" } else { "f" }.to_owned(),
        order: n,
        p,
        lambda,
        rms_error: rms(&errors),
        rms_given: rms(&values),
        singular_values: model.singular_values.clone(),
        folded: model.folded,
        positivity_repaired: model.repair.is_some(),
        poles: pairs(&poles),
        a: rows(model.system.a()),
        b: rows(model.system.b()),
        c: rows(model.system.c()),
        d: rows(model.system.d()),
        samples,
        notes,
        file: spec.output.as_ref().map(|p| p.display().to_string()),
    };
    Ok(RoadAnalyticRun { outcome, file, inputs: vec![table.input] })
}

/// f at the samples, and the given part less the fitted one.
fn evaluated(
    model: &AnalyticModel,
    theta: Vec<f64>,
    given: Vec<f64>,
    values: &[f64],
    logarithm: bool,
    part: Part,
) -> Result<(AnalyticSamples, Vec<f64>), SubspaceError> {
    let mut s = AnalyticSamples { given, ..AnalyticSamples::default() };
    let mut errors = Vec::with_capacity(theta.len());
    for (t, value) in theta.iter().zip(values) {
        let z = model.system.at(C64::from_polar(1.0, *t))?[(0, 0)];
        errors.push(value - if part == Part::Imaginary { z.im } else { z.re });
        let f = if logarithm { z.exp() } else { z };
        s.real.push(f.re);
        s.imag.push(f.im);
        s.magnitude.push(f.norm());
        s.phase_rad.push(if logarithm { z.im } else { f.arg() });
    }
    s.theta_rad = theta;
    Ok((s, errors))
}

fn csv(s: &AnalyticSamples, given: &str) -> Vec<u8> {
    let mut text = format!("theta_rad,given_{given},real,imag,magnitude,phase_rad\n");
    for k in 0..s.theta_rad.len() {
        let row = [s.theta_rad[k], s.given[k], s.real[k], s.imag[k], s.magnitude[k], s.phase_rad[k]];
        let fields: Vec<String> = row.iter().map(|v| format!("{v:.12e}")).collect();
        let _ = writeln!(text, "{}", fields.join(","));
    }
    text.into_bytes()
}
