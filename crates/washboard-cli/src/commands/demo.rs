//! `washboard demo`: the main job on a published car, and its report.

use crate::commands::identify::finish;
use crate::output::{Failure, Output};
use clap::Args;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use washboard::files::check_target_directory;
use washboard::study::{DemoSpec, demo, is_result_of};

/// Where the report goes unless told.
const DIRECTORY: &str = "washboard-demo";

/// Drive a published car, identify it and the road from what its sensors felt, and compare with the truth.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Of the simulated drive.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Where the report goes [default: washboard-demo, where an earlier demo is replaced].
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Replace a directory that is not empty.
    #[arg(long)]
    overwrite: bool,
}

/// Runs the demo.
pub fn run(a: Arguments, output: Output) -> Result<ExitCode, Failure> {
    let default = Path::new(DIRECTORY);
    let overwrite = a.overwrite || (a.output.is_none() && is_result_of(default, "demo"));
    let dir = a.output.as_deref().unwrap_or(default);
    check_target_directory(dir, overwrite)?;
    let progress = output.progress("driving and identifying a published car");
    let result = demo(&DemoSpec { seed: a.seed });
    drop(progress);
    finish("demo", result?, "washboard demo", Some(dir), overwrite, output)
}
