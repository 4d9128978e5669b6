//! `washboard reproduce`: published numbers, figures and errors, computed again.

use crate::output::{Failure, Output};
use crate::table::{Table, wrapped};
use clap::Args;
use serde::Serialize;
use std::fmt::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use washboard::files::{check_target_directory, write_directory};
use washboard::report::{figure_svg, reproduce_page};
use washboard::study::{
    Check, Envelope, Listed, ReproduceOutcome, ReproduceSpec, errata_markdown, reproduce, reproducible_list,
};

/// Compute published numbers again, and say which agree, which are errors of the source, and why.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Items such as thesis.fig-4.3, or all of thesis.ch-4, thesis or paper; everything without.
    #[arg(value_name = "ITEM")]
    items: Vec<String>,
    /// Leave out long searches and simulations.
    #[arg(long)]
    quick: bool,
    /// List the names of sources, chapters and items, and compute nothing.
    #[arg(long, conflicts_with_all = ["items", "quick", "output", "overwrite"])]
    list: bool,
    /// Write result.json, report.html, errata.md and figures/*.svg here.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Replace a directory that is not empty.
    #[arg(long)]
    overwrite: bool,
}

#[derive(Serialize)]
struct List {
    list: Vec<Listed>,
}

/// Computes, writes, prints; 1 where a number neither agrees nor is excused.
pub fn run(a: Arguments, output: Output) -> Result<ExitCode, Failure> {
    if a.list {
        output.print(&Envelope::new("reproduce", vec![], List { list: reproducible_list() }), list)?;
        return Ok(ExitCode::SUCCESS);
    }
    if let Some(dir) = &a.output {
        check_target_directory(dir, a.overwrite)?;
    }
    let progress = output.progress("reproducing");
    let (outcome, inputs) = reproduce(&ReproduceSpec { items: a.items, quick: a.quick })?;
    drop(progress);
    let envelope = Envelope::new("reproduce", inputs, outcome);
    if let Some(dir) = &a.output {
        let o = &envelope.outcome;
        let figures: Vec<(String, Vec<u8>)> = o
            .figures
            .iter()
            .map(|f| (format!("figures/{}.svg", f.name), figure_svg(f).into_bytes()))
            .collect();
        let mut files = vec![
            ("result.json", envelope.to_json().into_bytes()),
            ("report.html", reproduce_page(o).into_bytes()),
            ("errata.md", errata_markdown(&o.errata, &o.skipped_errata).into_bytes()),
        ];
        files.extend(figures.iter().map(|(name, svg)| (name.as_str(), svg.clone())));
        write_directory(dir, &files, a.overwrite)?;
    }
    let place =
        a.output.map(|dir| format!("wrote {}\n", dir.join("report.html").display())).unwrap_or_default();
    output.print(&envelope, |o| table(o, place.is_empty()) + &place)?;
    Ok(if envelope.outcome.counts.open == 0 { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

/// A line a name; what `--quick` leaves out is marked.
fn list(all: &List) -> String {
    let mut rows = Table::new(&["<name", "<", "<what"]);
    for one in &all.list {
        rows.row([one.name.clone(), if one.slow { "long".into() } else { String::new() }, one.what.clone()]);
    }
    rows.text() + "long: a search or a simulation that --quick leaves out\n"
}

fn table(o: &ReproduceOutcome, written_nowhere: bool) -> String {
    let mut text = String::new();
    for titled in &o.titles {
        let own: Vec<&Check> = o.items.iter().filter(|c| c.item == titled.item).collect();
        if own.is_empty() {
            continue;
        }
        let _ = writeln!(text, "{}: {}", titled.item, titled.title);
        let mut rows = Table::new(&["<quantity", "published", "computed", "tolerance", "<agrees", "<note"]);
        for c in own {
            rows.row(cells(c));
        }
        text += &rows.text();
        text.push('\n');
    }
    for e in &o.errata {
        text += &wrapped(&format!("{}, {}: {}. Right: {}.", e.id, e.place, e.printed, e.right));
    }
    if !o.figures.is_empty() {
        let names: Vec<&str> = o.figures.iter().map(|f| f.name.as_str()).collect();
        let how = if written_nowhere { " (-o DIR writes them)" } else { "" };
        text += &wrapped(&format!("figures: {}{how}", names.join(", ")));
    }
    let left = |what: &str, names: &[String]| {
        if names.is_empty() {
            return String::new();
        }
        wrapped(&format!("left out by --quick, as they take long: {what}{}", names.join(", ")))
    };
    text += &left("", &o.skipped);
    text += &left("errata ", &o.skipped_errata);
    if o.titles.is_empty() {
        return text + "nothing was computed: run it again without --quick\n";
    }
    let c = &o.counts;
    text + &wrapped(&format!(
        "{}; {} are errors of the source, {} differ without an excuse",
        c.words(),
        c.excused,
        c.open
    ))
}

fn cells(c: &Check) -> Vec<String> {
    let agrees = match (c.agrees, &c.erratum) {
        (true, _) => "yes".to_owned(),
        (false, Some(id)) => format!("no, {id}"),
        (false, None) => "no".to_owned(),
    };
    let note = c.reference_note.clone().unwrap_or_default();
    let [published, computed, tolerance] = c.texts();
    vec![c.quantity.clone(), published, computed, tolerance, agrees, note]
}
