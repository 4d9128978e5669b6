//! The job `road iri`: the International Roughness Index of a profile's segments.

use super::identify_outcome::Flag;
use super::profile_file::read_profile;
use super::{Input, RoadIriSpec, StudyError};
use crate::metrics::{COARSE_STEP_M, IriSettings, iri};
use serde::{Deserialize, Serialize};

/// Segments, where nothing else is asked for.
const SEGMENT_M: f64 = 20.0;

/// Roughness of a profile.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RoadIriOutcome {
    /// One entry a track.
    pub tracks: Vec<TrackIri>,
    /// Mean of the tracks' whole indices (of two tracks: the Mean Roughness Index), mm/m.
    pub mean_iri_mm_per_m: f64,
    /// Length of the segments.
    pub segment_m: f64,
    /// What is left after the last whole segment: in the whole, in no segment.
    pub left_over_m: f64,
    /// The moving average that was taken; 0 for none.
    pub moving_average_m: f64,
    /// Mean distance of the points.
    pub mean_step_m: f64,
    /// What is to be known.
    pub notes: Vec<Flag>,
}

/// Roughness of a track.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TrackIri {
    /// Its column.
    pub name: String,
    /// From end to end, mm/m.
    pub iri_mm_per_m: f64,
    /// In order.
    pub segments: Vec<SegmentIri>,
}

/// Roughness of a segment.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SegmentIri {
    /// Where it begins.
    pub start_m: f64,
    /// Where it ends.
    pub end_m: f64,
    /// mm/m, which is m/km.
    pub iri_mm_per_m: f64,
}

/// The index of the profile that a spec names, and the files read.
///
/// # Errors
/// A file that is no profile, with its line; a profile too short; a segment or moving average that can't be.
pub fn road_iri(spec: &RoadIriSpec) -> Result<(RoadIriOutcome, Vec<Input>), StudyError> {
    let profile = read_profile(&spec.profile, spec.no_header)?;
    let length = profile.x_m.last().copied().unwrap_or(0.0) - profile.x_m.first().copied().unwrap_or(0.0);
    // a profile that is shorter than the usual segment is one segment
    let segment_m = spec.segment_m.unwrap_or(if length > 0.0 { SEGMENT_M.min(length) } else { SEGMENT_M });
    let settings = IriSettings { segment_m: Some(segment_m), moving_average_m: spec.moving_average_m };
    let fail = |source| StudyError::Measure { name: spec.profile.display().to_string(), source };
    let found = profile
        .tracks
        .iter()
        .map(|heights| iri(&profile.x_m, heights, &settings).map_err(fail))
        .collect::<Result<Vec<_>, _>>()?;
    let tracks: Vec<TrackIri> = profile
        .names
        .iter()
        .zip(&found)
        .map(|(name, iri)| TrackIri {
            name: name.clone(),
            iri_mm_per_m: iri.whole.iri_mm_per_m,
            segments: iri
                .segments
                .iter()
                .map(|s| SegmentIri { start_m: s.start_m, end_m: s.end_m, iri_mm_per_m: s.iri_mm_per_m })
                .collect(),
        })
        .collect();
    let (moving_average_m, left_over_m, mean_step_m, largest) =
        found.first().map_or((0.0, 0.0, 0.0, 0.0), |i| {
            (i.moving_average_m, i.left_over_m, i.mean_step_m, i.largest_step_m)
        });
    let mut notes = Vec::new();
    let mut note = |name: &str, text: String| notes.push(Flag { name: name.to_owned(), text });
    if largest > COARSE_STEP_M {
        let text = format!(
            "neighbouring points are up to {largest:.3} m apart, where the standard asks for {COARSE_STEP_M} m at most: what lies between is taken as a straight line, and the index may be low"
        );
        note("coarse", text);
    }
    if moving_average_m > 0.0 && spec.moving_average_m.is_none() {
        let text = format!(
            "heights are averaged over {moving_average_m} m, as the standard asks where points are this dense"
        );
        note("averaged", text);
    }
    let mean_iri_mm_per_m = tracks.iter().map(|t| t.iri_mm_per_m).sum::<f64>() / tracks.len().max(1) as f64;
    let outcome = RoadIriOutcome {
        tracks,
        mean_iri_mm_per_m,
        segment_m,
        left_over_m,
        moving_average_m,
        mean_step_m,
        notes,
    };
    Ok((outcome, vec![profile.table.input]))
}
