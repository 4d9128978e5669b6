//! `washboard damping`: what linear dampers and modes roads make of dampers with curves.

use crate::output::{Failure, Output};
use crate::table::{Table, number, percent};
use clap::Args;
use std::process::ExitCode;
use washboard::study::{DampingOutcome, DampingSpec, Envelope, damping};

/// The equivalent linear damping of dampers with curves against roughness, and the modes that follow.
#[derive(Debug, Args)]
pub struct Arguments {
    /// A TOML file or case:NAME, with a damper_curve on some axle.
    vehicle: String,
    /// A TOML file or case:NAME; may be given several times. ISO classes A to E without it.
    #[arg(long = "road", value_name = "ROAD")]
    roads: Vec<String>,
    /// Forward speed in m/s.
    #[arg(long, value_name = "V", allow_negative_numbers = true)]
    speed_m_s: f64,
}

/// Prints the table.
pub fn run(a: Arguments, output: Output) -> Result<ExitCode, Failure> {
    let progress = output.progress("linearising");
    let result = damping(&DampingSpec { vehicle: a.vehicle, roads: a.roads, speed_m_s: a.speed_m_s });
    drop(progress);
    let (outcome, inputs) = result?;
    output.print(&Envelope::new("damping", inputs, outcome), table)?;
    Ok(ExitCode::SUCCESS)
}

/// One row a damper and one a mode, the roads side by side.
fn table(outcome: &DampingOutcome) -> String {
    let Some(first) = outcome.roads.first() else { return String::new() };
    let short = |name: &str| name.trim_start_matches("case:").to_owned();
    let header = |what: &str| -> Vec<String> {
        let roads = outcome.roads.iter().map(|r| short(&r.road));
        [format!("<{what} at {} m/s", outcome.speed_m_s), "<unit".to_owned()]
            .into_iter()
            .chain(roads)
            .collect()
    };
    let new = |what: &str| Table::new(&header(what).iter().map(String::as_str).collect::<Vec<_>>());
    let mut dampers = new("damper");
    for (i, damper) in first.dampers.iter().enumerate() {
        let name = damper.name.replace('_', " ");
        let all = || outcome.roads.iter().filter_map(|r| r.dampers.get(i));
        let row = |unit: &str, cells: Vec<String>| [name.clone(), unit.to_owned()].into_iter().chain(cells);
        dampers.row(row("N·s/m", all().map(|d| number(d.damping_n_s_per_m)).collect()));
        dampers.row(row("m/s rms", all().map(|d| number(d.velocity_m_s)).collect()));
    }
    let mut modes = new("mode");
    for (i, mode) in first.modes.iter().enumerate() {
        // a mode keeps its place where it keeps its name; a pair that has become two real poles shifts the rest
        let all = |cell: &dyn Fn(&washboard::study::VehicleMode) -> String| -> Vec<String> {
            let named = |m: &&washboard::study::VehicleMode| m.label == mode.label;
            outcome.roads.iter().map(|r| r.modes.iter().find(named).map_or_else(String::new, cell)).collect()
        };
        if first.modes[..i].iter().any(|m| m.label == mode.label) {
            continue;
        }
        let row = |unit: &str, cells: Vec<String>| {
            [mode.label.clone(), unit.to_owned()].into_iter().chain(cells).collect::<Vec<_>>()
        };
        modes.row(row("Hz", all(&|m| number(m.freq_hz))));
        modes.row(row("% damping", all(&|m| percent(m.damping))));
    }
    dampers.text() + "\n" + &modes.text()
}
