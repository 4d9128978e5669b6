//! `washboard sweep`: a design at every point of a grid, all cores, and what trades against what.

use crate::args::shard;
use crate::output::{Failure, Output};
use crate::table::{Table, number, wrapped};
use clap::Args;
use std::path::PathBuf;
use std::process::ExitCode;
use washboard::files::{FileError, write_files};
use washboard::report::sweep_page;
use washboard::study::{
    Input, Shard, StudyError, SweepDirectory, SweepOutcome, SweepPlan, SweepPoint, SweepSpec, point_list,
    sweep,
};
use washboard::units::signed;

/// Design at every point of a grid; a run that was ended goes on where it was.
#[derive(Debug, Args)]
pub struct Arguments {
    /// A design with a [grid].
    #[arg(value_name = "SWEEP.toml")]
    sweep: PathBuf,
    /// Every point as soon as it is computed; at the end result.json, table.csv and report.html.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Points at once; all cores where it is left out.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
    /// This part of the points alone, such as 2/3; `merge` puts them together.
    #[arg(long, value_name = "I/N", value_parser = shard)]
    shard: Option<Shard>,
    /// Begin anew in a directory that holds a sweep.
    #[arg(long)]
    overwrite: bool,
}

/// Computes what is missing, and writes the whole where nothing is; 1 where no point has what was asked.
pub fn run(a: Arguments, output: Output) -> Result<ExitCode, Failure> {
    // whatever is wrong stands in the sweep, or in a file that it names
    let in_file = |e: StudyError| match e {
        StudyError::File(e) => StudyError::from(e),
        e if e.is_wrong_input() => FileError::content(&a.sweep, None, e.to_string()).into(),
        e => e,
    };
    let plan = SweepPlan::new(&SweepSpec::read(&a.sweep)?).map_err(in_file)?;
    let name = a.sweep.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let own = Input { path: name, ..Input::of_file(&a.sweep)? };
    let directory = SweepDirectory::begin(&a.output, &plan, own, a.overwrite)?;
    let jobs = a.jobs.map(usize::from);
    let jobs = jobs.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from));
    let bar = output.bar();
    let progress = |p: washboard::study::SweepProgress| bar.show(p.done, p.found, p.total);
    sweep(&plan, &directory, jobs, a.shard.unwrap_or_default(), &progress).map_err(in_file)?;
    drop(bar);
    let outcome = finish(&directory)?;
    // a part of an array of jobs may have no points of its own: nothing is wrong with that
    let good = outcome.any_good() || (a.shard.is_some() && outcome.points.is_empty());
    let part = a.shard.map(|s| format!("part {} of {}: ", s.number, s.of)).unwrap_or_default();
    let place = if outcome.missing.is_empty() {
        format!("wrote {}\n", a.output.join("report.html").display())
    } else {
        let (n, list) = (outcome.missing.len(), point_list(&outcome.missing));
        wrapped(&format!("{part}{n} points are not in {} yet ({list}): washboard merge", a.output.display()))
    };
    output.print(&directory.envelope(outcome), |o| table(o) + &place)?;
    Ok(if good { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

/// Reads all points; where none is missing, writes the result, the table and the page.
pub fn finish(directory: &SweepDirectory) -> Result<SweepOutcome, Failure> {
    let (outcome, details) = directory.outcome()?;
    if outcome.missing.is_empty() {
        directory.sweep_up()?;
        let page = sweep_page(&outcome, &details, &directory.file().file.path);
        let envelope = directory.envelope(outcome.clone());
        let table = outcome.table();
        let files = [
            ("table.csv", table.csv()),
            #[cfg(feature = "parquet")]
            ("table.parquet", crate::table_parquet::bytes(&table)?),
            ("report.html", page.into_bytes()),
            // the last: where it is, all are
            ("result.json", envelope.to_json().into_bytes()),
        ];
        write_files(&files.map(|(name, bytes)| (directory.path().join(name), bytes)))?;
    }
    Ok(outcome)
}

/// Rows of a terminal: `table.csv` has all.
const MOST_ROWS: usize = 60;

/// One row a point: where, how it ended, the goal, and each kind of response.
pub fn table(o: &SweepOutcome) -> String {
    let counts: Vec<String> = o.counts.iter().map(|(name, n)| format!("{n} {name}")).collect();
    let mut text = wrapped(&format!("{} points: {}", o.points.len(), counts.join(", ")));
    let responses = o.trade_offs();
    let mut head: Vec<String> = vec!["point".into()];
    head.extend(o.grid.iter().map(|a| format!("<{}", a.key)));
    head.extend(["<status".into(), "goal".into()]);
    head.extend(responses.iter().map(|name| format!("{name} rms, to passive, %")));
    let head: Vec<&str> = head.iter().map(String::as_str).collect();
    let mut rows = Table::new(&head);
    for p in o.points.iter().take(MOST_ROWS) {
        let at = o.grid.iter().map(|a| p.at.get(&a.key).map(place).unwrap_or_default());
        let goal = ["verified", "limit"].iter().find_map(|n| p.objective.get(n)).copied();
        let change =
            |name: &&str| p.rms_relative.get(name).map(|r| signed(100.0 * (r - 1.0), 1)).unwrap_or_default();
        rows.row(
            std::iter::once(p.index.to_string())
                .chain(at)
                .chain([p.status.name().to_owned(), goal.map(number).unwrap_or_default()])
                .chain(responses.iter().map(change)),
        );
    }
    text += &rows.text();
    if o.points.len() > MOST_ROWS {
        text += &format!("and {} more (table.csv)\n", o.points.len() - MOST_ROWS);
    }
    let failed = o.points.iter().filter(|p| !p.status.is_good());
    for SweepPoint { index, why, .. } in failed.take(3) {
        text += &wrapped(&format!("! point {index}: {}", why.as_deref().unwrap_or("no reason given")));
    }
    text
}

fn place(value: &serde_json::Value) -> String {
    match value {
        serde_json::Value::Number(n) => n.as_f64().map(number).map(|t| short(&t)).unwrap_or_default(),
        serde_json::Value::String(s) => s.clone(),
        other => other.to_string(),
    }
}

/// Without zeros at its end: what was asked is not a measurement.
fn short(text: &str) -> String {
    if text.contains('.') && !text.contains('e') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text.to_owned()
    }
}
