//! What a shaping filter is fitted to: samples of a spectrum, from a file of it, from a profile or from a road.

use super::identify_outcome::Flag;
use super::number_table::NumberTable;
use super::profile_file::{ProfileFile, hint, is_profile, profile_of};
use super::road_profile_ends::with_content;
use super::spectrum_file::spectrum_of;
use super::spectrum_smooth::smooth;
use super::{Input, RoadFitSpec, StudyError, load_road, read_result};
use crate::files::FileError;
use crate::linalg::{C64, CMat};
use crate::road::{CoherenceSpec, FilterOutput, FilterVariable, detrended, spectrum_of_profile};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Samples that are taken of a road.
const ROAD_SAMPLES: usize = 100;
/// Segments of a profile's spectrum are this share of it, where their length is not given: the fit wants averages more than long waves.
const SEGMENT_SHARE: f64 = 0.125;
/// And no longer than this, m: the longest wave is a third of it, which no vehicle feels.
const MOST_SEGMENT_M: f64 = 400.0;
/// Bands an octave of a profile's spectrum.
const PER_OCTAVE: f64 = 3.0;
/// Heights this near to a line, as a share of the largest height, are the line and rounding.
const STRAIGHT: f64 = 1e-12;
/// Heights beyond this have squares that a double may not hold, m.
const MOST_HEIGHT_M: f64 = 1e100;
/// A profile's steps may differ by this share before it is made even.
const EVEN: f64 = 1e-3;

/// Where samples come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FitSource {
    /// A file of densities.
    Spectrum,
    /// A file of heights.
    Profile,
    /// A road file, a case, or what `identify` found.
    Road,
}

/// Two-sided samples with S = G(iω)G(iω)ᴴ, and all that goes with them.
#[derive(Debug)]
pub(super) struct FitSamples {
    pub kind: FitSource,
    pub variable: FilterVariable,
    pub of: FilterOutput,
    /// rad/m or rad/s.
    pub omega: Vec<f64>,
    pub s: Vec<CMat>,
    /// R_k, where the source says.
    pub variances: Option<Vec<f64>>,
    pub coherence: Option<CoherenceSpec>,
    /// A spectrum of noisy data, whose order a criterion can choose.
    pub notes: Vec<Flag>,
    pub inputs: Vec<Input>,
}

/// `name`: `case:NAME`, a directory, a `.toml` file, or a CSV file whose header says what it is.
pub(super) fn read_source(spec: &RoadFitSpec) -> Result<FitSamples, StudyError> {
    let path = Path::new(&spec.source);
    let mut samples = if spec.source.starts_with("case:") || path.extension().is_some_and(|e| e == "toml") {
        of_road(&spec.source, spec)?
    } else if path.is_dir() {
        of_identified(path, spec)?
    } else {
        let table = NumberTable::read(path, spec.no_header).map_err(|e| hint(e, spec.no_header))?;
        if spec.no_header || is_profile(&table) {
            of_profile(profile_of(table)?, spec)?
        } else {
            stray(spec.segment_m.is_some(), "segment_m", "none, which belongs to profiles")?;
            spectrum_of(table, spec)?
        }
    };
    if let (Some([low, high]), true) = (spec.band_rad, samples.kind != FitSource::Road) {
        keep_band(&mut samples, low, high);
    }
    if let Some(per_octave) = spec.smooth_per_octave {
        stray(samples.kind != FitSource::Spectrum, "smooth", "none, which belongs to raw spectra")?;
        smooth(&mut samples, per_octave)?;
    }
    Ok(samples)
}

fn stray(found: bool, field: &'static str, expected: &str) -> Result<(), StudyError> {
    if found {
        let expected = expected.to_owned();
        return Err(StudyError::Setting { field, expected, found: "one".into() });
    }
    Ok(())
}

fn keep_band(samples: &mut FitSamples, low: f64, high: f64) {
    let keep: Vec<bool> = samples.omega.iter().map(|w| (low..=high).contains(w)).collect();
    let mut k = 0;
    samples.s.retain(|_| {
        k += 1;
        keep[k - 1]
    });
    if let Some(r) = &mut samples.variances {
        let mut k = 0;
        r.retain(|_| {
            k += 1;
            keep[k - 1]
        });
    }
    samples.omega.retain(|w| (low..=high).contains(w));
}

/// What `identify -o` wrote.
fn of_identified(dir: &Path, spec: &RoadFitSpec) -> Result<FitSamples, StudyError> {
    let road = dir.join("road.toml");
    if !road.is_file() {
        let message = "expected a directory with a road.toml, as `identify -o` writes it, found none";
        return Err(FileError::content(dir, None, message).into());
    }
    let mut samples = of_road(&road.display().to_string(), spec)?;
    let result = read_result::<serde_json::Value>(&dir.join("result.json"));
    if result.is_ok_and(|r| r.outcome["converged"] == false) {
        let text = "the identification that found this road did not converge".to_owned();
        samples.notes.push(Flag { name: "not-converged".into(), text });
    }
    Ok(samples)
}

/// Even samples in ln ν over the road's band.
fn of_road(name: &str, spec: &RoadFitSpec) -> Result<FitSamples, StudyError> {
    stray(spec.segment_m.is_some(), "segment_m", "none, which belongs to profiles")?;
    stray(spec.convention.is_some(), "convention", "none: a road file has its own")?;
    stray(spec.of == Some(FilterOutput::Velocity), "of", "displacement: a road is one of height")?;
    let loaded = load_road(name)?;
    let spectrum = loaded.road.spectrum();
    let over_time = spectrum.is_over_time();
    let unit = if over_time { "rad/s" } else { "rad/m" };
    let [least, most] = spectrum.band_rad_s(1.0);
    let [low, high] = match spec.band_rad {
        Some([low, high]) if low < least * (1.0 - 1e-9) || high > most * (1.0 + 1e-9) => {
            let expected = format!("a part of the road's own band, {least} to {most} {unit}");
            return Err(StudyError::Setting { field: "band", expected, found: format!("{low},{high}") });
        }
        Some(band) => band,
        None if least > 0.0 && most.is_finite() => [least, most],
        None => {
            let expected = format!("--band LOW,HIGH in {unit}, as this road has no band of its own");
            return Err(StudyError::Setting { field: "band", expected, found: "none".into() });
        }
    };
    let omega: Vec<f64> = (0..ROAD_SAMPLES)
        .map(|k| low * (high / low).powf(k as f64 / (ROAD_SAMPLES - 1) as f64))
        .map(|w| w.clamp(low, high))
        .collect();
    Ok(FitSamples {
        kind: FitSource::Road,
        variable: if over_time { FilterVariable::Time } else { FilterVariable::Distance },
        of: FilterOutput::Displacement,
        s: omega.iter().map(|w| one(spectrum.psd(*w, 1.0))).collect(),
        omega,
        variances: None,
        coherence: loaded.spec.coherence,
        notes: Vec::new(),
        inputs: loaded.inputs,
    })
}

/// Welch's spectrum of a profile in bands of a third of an octave.
fn of_profile(profile: ProfileFile, spec: &RoadFitSpec) -> Result<FitSamples, StudyError> {
    stray(spec.convention.is_some(), "convention", "none, which belongs to spectra")?;
    stray(spec.of == Some(FilterOutput::Velocity), "of", "displacement: a profile is one of height")?;
    let mut notes = Vec::new();
    let mut note = |name: &str, text: String| notes.push(Flag { name: name.to_owned(), text });
    let (x, count) = (&profile.x_m, profile.x_m.len());
    let length = x.last().copied().unwrap_or(0.0) - x.first().copied().unwrap_or(0.0);
    if count < 32 {
        let message = format!("expected a profile of 32 points or more, found {count}");
        return Err(FileError::content(&profile.table.path, None, message).into());
    }
    let step = length / (count - 1) as f64;
    let steps = x.windows(2).map(|p| p[1] - p[0]);
    let (least, most) = steps.fold((f64::INFINITY, 0.0f64), |a, d| (a.0.min(d), a.1.max(d)));
    let uneven = most - least > EVEN * step;
    let tracks = if uneven {
        let text = format!(
            "points are {least:.4} to {most:.4} m apart: heights were put on an even grid of {step:.4} m by straight lines, and waves shorter than {:.3} m left out",
            4.0 * most
        );
        note("made-even", text);
        profile.tracks.iter().map(|y| even(x, y, step, count)).collect()
    } else {
        profile.tracks.clone()
    };
    check_heights(&profile, &tracks)?;
    let segment = spec.segment_m.unwrap_or((SEGMENT_SHARE * length).min(MOST_SEGMENT_M));
    if segment > length + step {
        let expected = format!("at most the profile's length, {length} m");
        return Err(StudyError::Setting { field: "segment_m", expected, found: segment.to_string() });
    }
    let found = spectrum_of_profile(&tracks, step, segment, PER_OCTAVE)?;
    if tracks.len() > 1 {
        let all = profile.names.join(", ");
        note(
            "tracks",
            format!(
                "the mean spectrum of the tracks {all}; how alike they are is not fitted (the filter's coherence is full)"
            ),
        );
    }
    note(
        "profile-spectrum",
        format!(
            "{} bands of a third of an octave from segments of {segment:.1} m; the longest wave is {:.1} m",
            found.s.len(),
            std::f64::consts::TAU / found.nu_rad_per_m.first().copied().unwrap_or(f64::NAN)
        ),
    );
    let high = if uneven { std::f64::consts::TAU / (4.0 * most) } else { f64::INFINITY };
    let (full, ends) = with_content(&found);
    notes.extend(ends);
    let kept: Vec<usize> = full.filter(|k| found.nu_rad_per_m[*k] <= high).collect();
    Ok(FitSamples {
        kind: FitSource::Profile,
        variable: FilterVariable::Distance,
        of: FilterOutput::Displacement,
        omega: kept.iter().map(|k| found.nu_rad_per_m[*k]).collect(),
        s: kept.iter().map(|k| one(found.s[*k])).collect(),
        variances: None,
        coherence: None,
        notes,
        inputs: vec![profile.table.input],
    })
}

/// Refuses heights that no spectrum can be had of: a straight line, or numbers without squares.
fn check_heights(profile: &ProfileFile, tracks: &[Vec<f64>]) -> Result<(), StudyError> {
    let largest = |y: &[f64]| y.iter().map(|y| y.abs()).fold(0.0, f64::max);
    for (y, name) in tracks.iter().zip(&profile.names) {
        let (size, rough) = (largest(y), largest(&detrended(y)));
        let message = if size > MOST_HEIGHT_M {
            format!("column {name}: expected heights below {MOST_HEIGHT_M:e} m, found {size:e}")
        } else if rough <= STRAIGHT * size {
            format!(
                "column {name}: expected heights that leave a straight line, found one ({rough:.1e} m off it): it has no spectrum"
            )
        } else {
            continue;
        };
        return Err(FileError::content(&profile.table.path, None, message).into());
    }
    Ok(())
}

fn even(x: &[f64], y: &[f64], step: f64, count: usize) -> Vec<f64> {
    (0..count)
        .map(|k| {
            let at = x[0] + step * k as f64;
            let i = x.partition_point(|x| *x <= at).clamp(1, x.len() - 1);
            let t = ((at - x[i - 1]) / (x[i] - x[i - 1])).clamp(0.0, 1.0);
            y[i - 1] + t * (y[i] - y[i - 1])
        })
        .collect()
}

pub(super) fn one(value: f64) -> CMat {
    CMat::from_fn(1, 1, |_, _| C64::new(value, 0.0))
}
