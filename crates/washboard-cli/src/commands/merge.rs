//! `washboard merge`: shards of one sweep put together, as if it had been run at once.

use super::sweep::{finish, table};
use crate::output::{Failure, Output};
use crate::table::wrapped;
use clap::Args;
use std::path::PathBuf;
use std::process::ExitCode;
use washboard::files::build_directory;
use washboard::study::{SweepDirectory, SweepOutcome, merge, point_list};

/// Put the parts of a sweep together.
#[derive(Debug, Args)]
pub struct Arguments {
    /// What `sweep --shard I/N -o DIR` wrote, each part once.
    #[arg(value_name = "DIR", required = true)]
    parts: Vec<PathBuf>,
    /// Where the whole is written.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Replace a directory that holds a sweep.
    #[arg(long)]
    overwrite: bool,
}

/// Gathers, writes; 1 where points are missing (nothing is written then), or none has what was asked.
pub fn run(a: Arguments, output: Output) -> Result<ExitCode, Failure> {
    SweepDirectory::check_target(&a.output, a.overwrite)?;
    let merged = merge(&a.parts)?;
    let mut said = String::new();
    if !merged.duplicates.is_empty() {
        let (n, list) = (merged.duplicates.len(), point_list(&merged.duplicates));
        said +=
            &wrapped(&format!("note: {n} points are in several directories, alike to the last byte: {list}"));
    }
    if !merged.missing.is_empty() {
        let (n, total) = (merged.missing.len(), merged.sweep.total());
        said += &wrapped(&format!("! missing {n} of {total} points: {}", point_list(&merged.missing)));
        let sweep = &merged.sweep.file().sweep;
        let outcome = SweepOutcome {
            grid: sweep.grid.clone(),
            warm_start: sweep.warm_start,
            goal: None,
            counts: Default::default(),
            missing: merged.missing.clone(),
            points: Vec::new(),
        };
        output.print(&merged.sweep.envelope(outcome), |_| said)?;
        return Ok(ExitCode::from(1));
    }
    let mut made = None;
    build_directory::<Failure>(&a.output, |building| {
        made = Some(finish(&SweepDirectory::gather(building, &merged)?)?);
        Ok(())
    })?;
    let Some(outcome) = made else { return Ok(ExitCode::from(1)) };
    let good = outcome.any_good();
    let place = format!("wrote {}\n", a.output.join("report.html").display());
    output.print(&merged.sweep.envelope(outcome), |o| said + &table(o) + &place)?;
    Ok(if good { ExitCode::SUCCESS } else { ExitCode::from(1) })
}
