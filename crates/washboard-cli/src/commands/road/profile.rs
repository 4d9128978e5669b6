//! `washboard road profile`: a random profile of a road.

use super::said;
use crate::output::{Failure, Output};
use crate::table::{Table, number};
use clap::Args;
use std::path::PathBuf;
use std::process::ExitCode;
use washboard::files::write_files;
use washboard::study::{Envelope, RoadProfileOutcome, RoadProfileSpec, road_profile};

/// Write a random profile of a road: heights over distance with its spectrum and coherence.
#[derive(Debug, Args)]
pub struct Arguments {
    /// A TOML file or case:NAME.
    road: String,
    /// Length in m.
    #[arg(long, value_name = "L", allow_negative_numbers = true)]
    length_m: f64,
    /// Distance of the points in m.
    #[arg(long, value_name = "DX", allow_negative_numbers = true)]
    step_m: f64,
    /// Two tracks, this far apart in m.
    #[arg(long, value_name = "W", allow_negative_numbers = true)]
    track_width_m: Option<f64>,
    /// Speed in m/s, which a road that is written over time needs.
    #[arg(long, value_name = "V", allow_negative_numbers = true)]
    speed_m_s: Option<f64>,
    /// Same seed, same profile.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// The file: columns x_m and height_m, or x_m, left_m, right_m.
    #[arg(short, long, value_name = "PROFILE.csv")]
    output: PathBuf,
    /// Replace the file that is there.
    #[arg(long)]
    overwrite: bool,
}

/// Makes and writes.
pub fn run(a: Arguments, output: Output) -> Result<ExitCode, Failure> {
    let progress = output.progress("rolling");
    let result = road_profile(&RoadProfileSpec {
        road: a.road,
        length_m: a.length_m,
        step_m: a.step_m,
        track_width_m: a.track_width_m,
        speed_m_s: a.speed_m_s,
        seed: a.seed,
        output: a.output,
        overwrite: a.overwrite,
    });
    let run = result.map_err(Failure::from).and_then(|run| {
        write_files(std::slice::from_ref(&run.file))?;
        Ok(run)
    });
    drop(progress);
    let run = run?;
    output.print(&Envelope::new("road profile", run.inputs, run.outcome), table)?;
    Ok(ExitCode::SUCCESS)
}

fn table(o: &RoadProfileOutcome) -> String {
    let mut table = Table::new(&["<track", "rms (m)", "range (m)"]);
    for t in &o.tracks {
        table.row([t.name.clone(), number(t.rms_m), number(t.range_m)]);
    }
    let made = format!("{} points, {} m apart, over {} m, seed {}\n", o.points, o.step_m, o.length_m, o.seed);
    table.text() + &made + &said(&o.notes) + &format!("wrote {}\n", o.file)
}
