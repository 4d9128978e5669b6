//! `washboard report`: the page again from result.json.

use crate::commands::compare;
use crate::output::{Failure, Output};
use clap::Args;
use serde::Serialize;
use std::path::PathBuf;
use std::process::ExitCode;
use washboard::files::{FileError, write_whole};
use washboard::report::{compare_page, demo_page, design_page, identify_page, reproduce_page, sweep_page};
use washboard::study::{
    CompareOutcome, DemoOutcome, Envelope, ReproduceOutcome, StudyError, SweepDirectory, is_result_of,
    read_design, read_identification, read_result,
};

/// Write report.html again from result.json.
#[derive(Debug, Args)]
pub struct Arguments {
    /// What `identify -o DIR`, `demo -o DIR`, `compare -o DIR`, `design -o DIR`, `sweep -o DIR` or `reproduce -o DIR` wrote.
    #[arg(value_name = "DIR")]
    directory: PathBuf,
}

/// Commands whose results have a page.
const TAKEN: [&str; 6] = ["identify", "demo", "compare", "design", "sweep", "reproduce"];

#[derive(Serialize)]
struct Written {
    report: String,
}

/// Reads, writes, says where.
pub fn run(arguments: Arguments, output: Output) -> Result<ExitCode, Failure> {
    let (file, page) = (arguments.directory.join("result.json"), arguments.directory.join("report.html"));
    let (inputs, text) = if is_result_of(&arguments.directory, "compare") {
        let result = read_result::<CompareOutcome>(&file)?;
        (result.inputs, compare_page(&result.outcome, &compare::title(&result.outcome)))
    } else if is_result_of(&arguments.directory, "demo") {
        // its identification's numbers are checked as any other's
        read_identification(&file)?;
        let result = read_result::<DemoOutcome>(&file)?;
        (result.inputs, demo_page(&result.outcome, "washboard demo"))
    } else if is_result_of(&arguments.directory, "sweep") {
        let sweep = SweepDirectory::open(&arguments.directory)?;
        let (outcome, details) = sweep.outcome()?;
        let page = sweep_page(&outcome, &details, &sweep.file().file.path);
        (sweep.envelope(outcome).inputs, page)
    } else if is_result_of(&arguments.directory, "design") {
        let (_, result) = read_design(&file)?;
        let title = result.inputs.first().map(|i| i.path.clone()).unwrap_or_default();
        let title =
            PathBuf::from(title).file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        (result.inputs, design_page(&result.outcome, &title))
    } else if is_result_of(&arguments.directory, "reproduce") {
        let result = read_result::<ReproduceOutcome>(&file)?;
        (result.inputs, reproduce_page(&result.outcome))
    } else {
        let read = read_result::<serde_json::Value>(&file)?;
        if !TAKEN.contains(&read.command.as_str()) {
            let taken = TAKEN.map(|c| format!("`{c}`")).join(", ");
            let message = format!("command: expected one of {taken}, found `{}`", read.command);
            return Err(StudyError::from(FileError::content(&file, None, message)).into());
        }
        let (_, result) = read_identification(&file)?;
        let text = identify_page(&result.outcome, &result.outcome.recording.name);
        (result.inputs, text)
    };
    write_whole(&page, text.as_bytes())?;
    let written = Written { report: page.display().to_string() };
    output.print(&Envelope::new("report", inputs, written), |w| format!("wrote {}\n", w.report))?;
    Ok(ExitCode::SUCCESS)
}
