//! `washboard ride`: rms and spectra of a vehicle's responses on a road.

use crate::output::{Failure, Output};
use crate::table::{Table, number, wrapped};
use clap::Args;
use std::path::PathBuf;
use std::process::ExitCode;
use washboard::study::{Envelope, RideOutcome, RideSpec, Rms, ride};

/// The rms of every response on a road (and, with --json, the spectra).
#[derive(Debug, Args)]
pub struct Arguments {
    /// A TOML file or case:NAME.
    vehicle: String,
    /// A TOML file or case:NAME.
    #[arg(long)]
    road: String,
    /// Forward speed in m/s.
    #[arg(long, value_name = "V", allow_negative_numbers = true)]
    speed_m_s: f64,
    /// A controller in the loop: what `design -o DIR` wrote, or a JSON file {a, b, c, d, inputs, outputs}.
    #[arg(long, value_name = "FILE")]
    controller: Option<PathBuf>,
    /// Stroke of every suspension in m, to either side of where it rests: how often it bottoms.
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    stroke_m: Option<f64>,
}

/// Prints the ride.
pub fn run(arguments: Arguments, output: Output) -> Result<ExitCode, Failure> {
    let Arguments { vehicle, road, speed_m_s, controller, stroke_m } = arguments;
    let progress = output.progress("riding");
    let result = ride(&RideSpec { vehicle, road, speed_m_s, controller, stroke_m });
    drop(progress);
    let (outcome, inputs) = result?;
    output.print(&Envelope::new("ride", inputs, outcome), table)?;
    Ok(ExitCode::SUCCESS)
}

/// One row an output, its places side by side: the names of one stacked vector differ in their ends.
fn table(outcome: &RideOutcome) -> String {
    let names: Vec<&str> = outcome.rms.iter().map(|(name, _)| name).collect();
    let mut rows: Vec<(&str, Vec<&str>)> = Vec::new();
    let mut places: Vec<&str> = Vec::new();
    for name in names {
        let place =
            rows.last().and_then(|(base, _)| name.strip_prefix(base)).and_then(|s| s.strip_prefix('_'));
        match place.filter(|p| PLACES.contains(p)) {
            Some(place) => {
                if !places.contains(&place) {
                    places.push(place);
                }
                if let Some((_, own)) = rows.last_mut() {
                    own.push(place);
                }
            }
            None => rows.push((name, vec![])),
        }
    }
    let header: Vec<String> = [format!("<rms at {} m/s", outcome.speed_m_s)]
        .into_iter()
        .chain(["<unit".to_owned(), "whole".to_owned()])
        .chain(places.iter().map(|p| p.replace('_', " ")))
        .collect();
    let mut table = Table::new(&header.iter().map(String::as_str).collect::<Vec<_>>());
    let cell = |name: &str| match outcome.rms.get(name) {
        Some(Rms::Finite(v)) => number(*v),
        Some(Rms::Infinite(_)) => "infinite".to_owned(),
        None => String::new(),
    };
    for (base, _) in &rows {
        let unit = outcome.units.get(base).cloned().unwrap_or_default();
        let own = places.iter().map(|place| cell(&format!("{base}_{place}")));
        table.row([(*base).to_owned(), unit, cell(base)].into_iter().chain(own));
    }
    let mut reasons: Vec<(&str, Vec<&str>)> = Vec::new();
    for (base, _) in &rows {
        if let Some(why) = outcome.infinite.get(base) {
            match reasons.iter_mut().find(|(w, _)| w == why) {
                Some((_, of)) => of.push(base),
                None => reasons.push((why, vec![base])),
            }
        }
    }
    let notes = reasons.iter().map(|(why, of)| wrapped(&format!("infinite: {}: {why}", of.join(", "))));
    let said = outcome.notes.iter().map(|n| wrapped(&format!("note: {}", n.text)));
    table.text() + &notes.chain(said).collect::<String>() + &metrics(outcome)
}

/// Worst corners: JSON has every corner.
fn metrics(outcome: &RideOutcome) -> String {
    let mut table = Table::new(&["<metrics", "<unit", "value", "<reaction"]);
    for r in outcome.metric_rows() {
        let [shown, _] = r.shown(number);
        let value = shown.unwrap_or_else(|| r.infinite(0).to_owned());
        let [words, _] = r.words;
        table.row([r.what, r.unit, value, words]);
    }
    if table.is_empty() { String::new() } else { format!("\n{}", table.text()) }
}

const PLACES: [&str; 6] = ["front", "rear", "front_left", "front_right", "rear_left", "rear_right"];
