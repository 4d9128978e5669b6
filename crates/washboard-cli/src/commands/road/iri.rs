//! `washboard road iri`: the International Roughness Index of a profile.

use super::said;
use crate::output::{Failure, Output};
use crate::table::{Table, number};
use clap::Args;
use std::path::PathBuf;
use std::process::ExitCode;
use washboard::study::{Envelope, RoadIriOutcome, RoadIriSpec, road_iri};

/// The International Roughness Index of a profile and of its segments (ASTM E1926).
#[derive(Debug, Args)]
pub struct Arguments {
    /// Columns x_m and one of heights in m a track.
    #[arg(value_name = "PROFILE.csv")]
    profile: PathBuf,
    /// Length of the segments in m; 20 without it.
    #[arg(long, value_name = "L", allow_negative_numbers = true)]
    segment_m: Option<f64>,
    /// Length of the moving average in m, 0 for none; 0.25 without it where points are denser than a sixth of a metre.
    #[arg(long, value_name = "L", allow_negative_numbers = true)]
    moving_average_m: Option<f64>,
    /// The file has no header: distance in m, then heights in m.
    #[arg(long)]
    no_header: bool,
}

/// Prints the indices.
pub fn run(a: Arguments, output: Output) -> Result<ExitCode, Failure> {
    let progress = output.progress("driving");
    let result = road_iri(&RoadIriSpec {
        profile: a.profile,
        no_header: a.no_header,
        segment_m: a.segment_m,
        moving_average_m: a.moving_average_m,
    });
    drop(progress);
    let (outcome, inputs) = result?;
    output.print(&Envelope::new("road iri", inputs, outcome), table)?;
    Ok(ExitCode::SUCCESS)
}

/// One row a segment, tracks side by side, the whole last.
fn table(o: &RoadIriOutcome) -> String {
    let names: Vec<String> = o.tracks.iter().map(|t| format!("{} (mm/m)", t.name)).collect();
    let header: Vec<&str> =
        ["from (m)", "to (m)"].into_iter().chain(names.iter().map(String::as_str)).collect();
    let mut table = Table::new(&header);
    let place = |x: f64| {
        let text = format!("{x:.3}");
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    };
    let Some(first) = o.tracks.first() else { return String::new() };
    for (k, segment) in first.segments.iter().enumerate() {
        let cells =
            o.tracks.iter().map(|t| t.segments.get(k).map_or(String::new(), |s| number(s.iri_mm_per_m)));
        table.row([place(segment.start_m), place(segment.end_m)].into_iter().chain(cells));
    }
    let cells = o.tracks.iter().map(|t| number(t.iri_mm_per_m));
    table.row(["whole".to_owned(), String::new()].into_iter().chain(cells));
    let mut text = table.text();
    if o.tracks.len() > 1 {
        text += &format!("mean of the tracks: {} mm/m\n", number(o.mean_iri_mm_per_m));
    }
    if o.left_over_m > 1e-6 {
        text += &format!("the last {} m are in no segment, and in the whole\n", place(o.left_over_m));
    }
    text + &said(&o.notes)
}
