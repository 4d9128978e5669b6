//! `washboard respond`: a vehicle over a bump, or its gains for a pattern of the road.

use crate::output::{Failure, Output};
use crate::table::{Table, number, wrapped};
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use std::process::ExitCode;
use washboard::study::{self, Envelope, RespondOutcome, RespondSpec, respond};

/// Responses to a bump in time, or to heave, pitch, roll or warp of the road over frequency.
#[derive(Debug, Args)]
pub struct Arguments {
    /// A TOML file or case:NAME.
    vehicle: String,
    /// Forward speed in m/s.
    #[arg(long, value_name = "V", allow_negative_numbers = true)]
    speed_m_s: f64,
    /// A bump of height H and length L in m: w = H/2 (1 - cos(2 pi v t/L)).
    #[arg(long, value_name = "H,L", value_delimiter = ',', num_args = 1.., allow_negative_numbers = true)]
    bump: Vec<f64>,
    /// A pattern of the road under the wheels.
    #[arg(long, conflicts_with = "bump")]
    direction: Option<Direction>,
    /// A controller in the loop: what `design -o DIR` wrote, or a JSON file {a, b, c, d, inputs, outputs}.
    #[arg(long, value_name = "FILE")]
    controller: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Direction {
    Heave,
    Pitch,
    Roll,
    Warp,
}

/// Prints the responses.
pub fn run(a: Arguments, output: Output) -> Result<ExitCode, Failure> {
    let bump = match a.bump[..] {
        [] => None,
        [height, length] => Some([height, length]),
        _ => {
            let n = a.bump.len();
            let found = format!("{n} number{}", if n == 1 { "" } else { "s" });
            let expected = "a height and a length in m (--bump 0.1,2)".to_owned();
            return Err(study::StudyError::Setting { field: "bump", expected, found }.into());
        }
    };
    let direction = a.direction.map(|d| match d {
        Direction::Heave => study::Direction::Heave,
        Direction::Pitch => study::Direction::Pitch,
        Direction::Roll => study::Direction::Roll,
        Direction::Warp => study::Direction::Warp,
    });
    let spec =
        RespondSpec { vehicle: a.vehicle, speed_m_s: a.speed_m_s, bump, direction, controller: a.controller };
    let progress = output.progress("responding");
    let result = respond(&spec);
    drop(progress);
    let (outcome, inputs) = result?;
    output.print(&Envelope::new("respond", inputs, outcome), table)?;
    Ok(ExitCode::SUCCESS)
}

fn table(o: &RespondOutcome) -> String {
    o.notes.iter().fold(responses(o), |text, n| text + &wrapped(&format!("note: {}", n.text)))
}

fn responses(o: &RespondOutcome) -> String {
    let unit = |name: &str| o.units.get(name).cloned().unwrap_or_default();
    if let Some(b) = &o.bump {
        let title = format!("<bump of {} m over {} m at {} m/s", b.height_m, b.length_m, o.speed_m_s);
        let mut head = vec![title.as_str(), "<unit", "peak", "at, s"];
        if !b.reduction.is_empty() {
            head.push("change, %");
        }
        head.push("settled, s");
        let mut rows = Table::new(&head);
        for (name, peak) in b.peak.iter() {
            let at = b.peak_at_s.get(name).copied().unwrap_or(0.0);
            let settled = b.settling_s.get(name).copied().flatten();
            let settled = settled.map(|s| format!("{s:.2}")).unwrap_or_default();
            // the controller's peak over the passive one, less 1
            let change =
                b.reduction.get(name).map(|r| washboard::units::signed(-100.0 * r, 1)).unwrap_or_default();
            let change = (!b.reduction.is_empty()).then_some(change);
            let cells = [name.to_owned(), unit(name), number(*peak), format!("{at:.3}")];
            rows.row(cells.into_iter().chain(change).chain([settled]));
        }
        if !b.reduction.is_empty() {
            return rows.text() + "change: of the peak with the controller, from the peak without it\n";
        }
        return rows.text();
    }
    let Some(g) = &o.gains else { return String::new() };
    let title = format!("<{:?} of the road, gains per m", g.direction).to_lowercase();
    let mut rows = Table::new(&[title.as_str(), "<unit", "largest", "at, Hz", "at 1 Hz", "at 10 Hz"]);
    let near = |hz: f64| {
        let off = |k: &usize| (g.freq_hz[*k] / hz).ln().abs();
        (0..g.freq_hz.len()).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0)
    };
    for (name, m) in g.magnitude.iter() {
        let top = (0..m.len()).max_by(|a, b| m[*a].total_cmp(&m[*b])).unwrap_or(0);
        let cells = [number(m[top]), number(g.freq_hz[top]), number(m[near(1.0)]), number(m[near(10.0)])];
        rows.row([name.to_owned(), unit(name)].into_iter().chain(cells));
    }
    rows.text()
}
