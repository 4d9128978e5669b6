//! What `road fit` is told, checked, and turned into the settings of a fit.

use super::new_file::check_new_file;
use super::road_fit_source::FitSamples;
use super::{FitWeight, RoadFitSpec, StudyError};
use crate::linalg::C64;
use crate::subspace::{Order, ShapeSettings, ShapeWeights, Unpaired, Weights};

/// The largest order that is tried where none is given.
const MOST_ORDER: usize = 10;
/// Densities whose squares a double holds with room for a band.
const HELD: std::ops::RangeInclusive<f64> = 1e-60..=1e60;
/// λ may be this many times beyond either end of the band.
const LAMBDA_SPAN: f64 = 1e3;
/// Orders and block rows at most.
const MOST: usize = 40;

/// Channels of the spectrum.
pub(super) fn size(samples: &FitSamples) -> usize {
    samples.s.first().map_or(1, |s| s.nrows())
}

/// Names of road inputs are as many as the spectrum has channels, each once.
pub(super) fn check_points(points: &[String], m: usize) -> Result<(), StudyError> {
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

/// Refuses what can't be, before a file is read.
pub(super) fn check_settings(spec: &RoadFitSpec) -> Result<(), StudyError> {
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

/// Refuses a λ so far from the band that all of it is one point of the circle.
pub(super) fn check_lambda(spec: &RoadFitSpec, samples: &FitSamples) -> Result<(), StudyError> {
    let Some(lambda) = spec.lambda_rad else { return Ok(()) };
    let ends = (samples.omega.iter().find(|w| **w > 0.0), samples.omega.last());
    let (Some(low), Some(high)) = ends else { return Ok(()) };
    let (least, most) = (low / LAMBDA_SPAN, high * LAMBDA_SPAN);
    if !(least..=most).contains(&lambda) {
        let expected = format!(
            "a frequency from {least:.3e} to {most:.3e}, a thousandth of the band's lower end to a thousand times its upper one"
        );
        return Err(StudyError::Setting { field: "lambda", expected, found: lambda.to_string() });
    }
    Ok(())
}

/// How the fit is done, the largest order to try, and what its weights are called.
pub(super) fn settings(
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
        spare_rows: None,
        lambda_rad: spec.lambda_rad,
        weights,
        unpaired: Unpaired::Fold,
        roll_off_rad: None,
    };
    Ok((settings, spec.max_order.unwrap_or((MOST_ORDER * m).min(MOST)).min(allowed), name))
}

/// A power of two by which a filter is larger than that of the samples as they are now, where densities were too large or too small for
/// their squares; else 1.
pub(super) fn scale_of(samples: &mut FitSamples) -> f64 {
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
