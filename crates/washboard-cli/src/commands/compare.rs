//! `washboard compare`: what changed between two results.

use crate::output::{Failure, Output};
use crate::table::{Table, number, with_sd, wrapped};
use clap::Args;
use std::fmt::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use washboard::files::{check_target_directory, write_directory};
use washboard::report::compare_page;
use washboard::study::{Change, CompareOutcome, CompareSpec, Envelope, compare};

/// Compare two results: which modes, parameters and roads changed by more than their scatter.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The earlier result of identify or demo: its directory, or its result.json.
    #[arg(value_name = "BEFORE")]
    before: PathBuf,
    /// The later one.
    #[arg(value_name = "AFTER")]
    after: PathBuf,
    /// Write result.json and report.html here.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Replace a directory that is not empty.
    #[arg(long)]
    overwrite: bool,
}

/// The heading of the page.
pub fn title(o: &CompareOutcome) -> String {
    format!("{} and {}", o.before.recording, o.after.recording)
}

/// Compares, writes, prints; 1 where there is nothing to rely on.
pub fn run(a: Arguments, output: Output) -> Result<ExitCode, Failure> {
    if let Some(dir) = &a.output {
        check_target_directory(dir, a.overwrite)?;
    }
    let (outcome, inputs) = compare(&CompareSpec { before: a.before, after: a.after })?;
    let envelope = Envelope::new("compare", inputs, outcome);
    if let Some(dir) = &a.output {
        let page = compare_page(&envelope.outcome, &title(&envelope.outcome));
        let files = [("result.json", envelope.to_json().into_bytes()), ("report.html", page.into_bytes())];
        write_directory(dir, &files, a.overwrite)?;
    }
    let place =
        a.output.map(|dir| format!("wrote {}\n", dir.join("report.html").display())).unwrap_or_default();
    output.print(&envelope, |o| table(o) + &place)?;
    Ok(if envelope.outcome.comparable { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

fn table(o: &CompareOutcome) -> String {
    let side = |word: &str, r: &washboard::study::ComparedResult| {
        format!("{word:6}  {}: {}, method {}\n", r.path, r.recording, r.method)
    };
    let mut text = side("before", &o.before) + &side("after", &o.after);
    for flag in &o.flags {
        text += &wrapped(&format!("! {}: {}", flag.name, flag.text));
    }
    text += "\n";
    let mut rows = Table::new(&["<", "before", "after", "difference", "<at 95 %"]);
    for m in &o.modes {
        let name = if m.label_before == m.label_after {
            m.label_before.clone()
        } else {
            format!("{} -> {}", m.label_before, m.label_after)
        };
        rows.row(cells(format!("{name}, Hz"), &m.freq_hz, 1.0));
        rows.row(cells(format!("{name}, damping in %"), &m.damping, 100.0));
    }
    for n in o.quantities.iter().chain(&o.parameters) {
        rows.row(cells(n.name.clone(), &n.change, 1.0));
    }
    if !rows.is_empty() {
        text += &rows.text();
        text += "\n";
    }
    let u = &o.unmatched;
    for (which, modes) in [("before", &u.modes_before), ("after", &u.modes_after)] {
        for m in modes {
            let _ = writeln!(text, "only {which}: mode {} ({}), {} Hz", m.number, m.label, number(m.freq_hz));
        }
    }
    for (which, names) in [("before", &u.names_before), ("after", &u.names_after)] {
        if !names.is_empty() {
            text += &wrapped(&format!("only {which}: {}", names.join(", ")));
        }
    }
    if o.comparable && o.judged > 0 {
        let _ = writeln!(
            text,
            "{} of {} numbers changed significantly; up to about {:.1} would by chance if nothing had changed",
            o.significant,
            o.judged,
            0.05 * o.judged as f64
        );
    }
    text
}

fn cells(name: String, c: &Change, scale: f64) -> Vec<String> {
    let times = |sd: Option<f64>| sd.map(|s| scale * s);
    let verdict = match (&c.not_judged, c.significant) {
        (Some(why), _) => format!("not judged: {why}"),
        (None, true) => "changed".to_owned(),
        (None, false) => "within the scatter".to_owned(),
    };
    vec![
        name,
        with_sd(scale * c.before, times(c.before_sd)),
        with_sd(scale * c.after, times(c.after_sd)),
        with_sd(scale * c.difference, times(c.difference_sd)),
        verdict,
    ]
}
