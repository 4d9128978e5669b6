//! The job `road profile`: a random profile of a road, as CSV.

use super::identify_outcome::Flag;
use super::new_file::check_new_file;
use super::{Input, RoadProfileSpec, StudyError, load_road};
use crate::road::{ProfileSettings, RoadError, random_profile};
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};
use std::fmt::Write;
use std::path::PathBuf;

/// A random profile, in short.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RoadProfileOutcome {
    /// The file.
    pub file: String,
    /// Points of each track.
    pub points: usize,
    /// Distance of the points.
    pub step_m: f64,
    /// Distance from first to last.
    pub length_m: f64,
    /// Same seed, same profile.
    pub seed: u64,
    /// One entry a track.
    pub tracks: Vec<ProfileTrack>,
    /// What is to be known.
    pub notes: Vec<Flag>,
}

/// A track of a profile.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ProfileTrack {
    /// Its column.
    pub name: String,
    /// rms of its height.
    pub rms_m: f64,
    /// Largest height less smallest.
    pub range_m: f64,
}

/// An outcome, the CSV to be written, and the files read.
#[derive(Debug)]
pub struct RoadProfileRun {
    /// What was made.
    pub outcome: RoadProfileOutcome,
    /// To be written.
    pub file: (PathBuf, Vec<u8>),
    /// Every file that was read.
    pub inputs: Vec<Input>,
}

/// The profile that a spec asks for; the caller writes it.
///
/// # Errors
/// A road that cannot be built, one over time without a speed, a length or step that can't be, a file in the way.
pub fn road_profile(spec: &RoadProfileSpec) -> Result<RoadProfileRun, StudyError> {
    check_new_file(&spec.output, spec.overwrite)?;
    let loaded = load_road(&spec.road)?;
    let spectrum = loaded.road.spectrum();
    let fail = |source: RoadError| StudyError::Road { name: spec.road.clone(), source };
    let speed_m_s = match (spectrum.is_over_time(), spec.speed_m_s) {
        (true, None) => {
            let expected = "a speed (--speed-m-s): this road is written over time".to_owned();
            return Err(StudyError::Setting { field: "speed_m_s", expected, found: "none".into() });
        }
        (_, speed) => speed.unwrap_or(1.0),
    };
    super::ride::check_speed(speed_m_s)?;
    let two = spec.track_width_m.is_some();
    let settings = ProfileSettings {
        length_m: spec.length_m,
        step_m: spec.step_m,
        apart_m: spec.track_width_m,
        speed_m_s,
        seed: spec.seed,
    };
    let tracks = random_profile(&loaded.road, &settings).map_err(fail)?;
    let names: &[&str] = if two { &["left_m", "right_m"] } else { &["height_m"] };
    let points = tracks.first().map_or(0, Vec::len);
    let mut text = format!("x_m,{}\n", names.join(","));
    for k in 0..points {
        let _ = write!(text, "{}", nine_digits(spec.step_m * k as f64));
        for track in &tracks {
            let _ = write!(text, ",{:.8e}", track[k]);
        }
        text.push('\n');
    }
    let about = |(name, y): (&&str, &Vec<f64>)| {
        let n = y.len() as f64;
        let mean = y.iter().sum::<f64>() / n;
        let least = y.iter().copied().fold(f64::INFINITY, f64::min);
        ProfileTrack {
            name: (*name).to_owned(),
            rms_m: (y.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / n).sqrt(),
            range_m: y.iter().copied().fold(f64::NEG_INFINITY, f64::max) - least,
        }
    };
    let mut notes = Vec::new();
    let mut note = |name: &str, text: String| notes.push(Flag { name: name.to_owned(), text });
    let [low, high] = spectrum.band_rad_s(speed_m_s).map(|w| w / speed_m_s);
    let length_m = spec.step_m * (points.max(1) - 1) as f64;
    if high > PI / spec.step_m {
        let reach = if high.is_finite() {
            format!(" (the road has them down to {:.3} m)", TAU / high)
        } else {
            String::new()
        };
        note(
            "no-short-waves",
            format!("waves shorter than two steps, {:.3} m, are absent{reach}", 2.0 * spec.step_m),
        );
    }
    if low < PI / length_m {
        note(
            "no-long-waves",
            format!("waves longer than about twice the length, {:.1} m, are absent", 2.0 * length_m),
        );
    }
    let outcome = RoadProfileOutcome {
        file: spec.output.display().to_string(),
        points,
        step_m: spec.step_m,
        length_m,
        seed: spec.seed,
        tracks: names.iter().zip(&tracks).map(about).collect(),
        notes,
    };
    Ok(RoadProfileRun { outcome, file: (spec.output.clone(), text.into_bytes()), inputs: loaded.inputs })
}

/// A distance without the dust of k × 0.1.
fn nine_digits(x: f64) -> String {
    let text = format!("{x:.9}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
