//! `washboard report`: the page again from result.json.

use crate::output::{Failure, Output};
use clap::Args;
use serde::Serialize;
use std::path::PathBuf;
use std::process::ExitCode;
use washboard::files::write_whole;
use washboard::report::identify_page;
use washboard::study::{Envelope, IdentifyOutcome, read_result};

/// Write report.html again from result.json.
#[derive(Debug, Args)]
pub struct Arguments {
    /// What `identify -o DIR` or `demo -o DIR` wrote.
    #[arg(value_name = "DIR")]
    directory: PathBuf,
}

#[derive(Serialize)]
struct Written {
    report: String,
}

/// Reads, writes, says where.
pub fn run(arguments: Arguments, output: Output) -> Result<ExitCode, Failure> {
    let result = read_result::<IdentifyOutcome>(&arguments.directory.join("result.json"))?;
    let page = arguments.directory.join("report.html");
    let title = match result.command.as_str() {
        "demo" => "washboard demo",
        _ => &result.outcome.recording.name,
    };
    write_whole(&page, identify_page(&result.outcome, title).as_bytes())?;
    let written = Written { report: page.display().to_string() };
    output.print(&Envelope::new("report", result.inputs, written), |w| format!("wrote {}\n", w.report))?;
    Ok(ExitCode::SUCCESS)
}
