//! `washboard simulate`: a drive as a test engineer would record it.

use crate::args::stretch;
use crate::output::{Failure, Output};
use crate::table::{Table, number};
use clap::Args;
use std::path::PathBuf;
use std::process::ExitCode;
use washboard::files::write_files;
use washboard::study::{Envelope, SimulateOutcome, SimulateSpec, Stretch, simulate};

/// Record a drive of a model: RUN.csv, its description RUN.toml, and RUN.truth.json.
///
/// Without --sensors: vertical accelerometers at every body corner and hub.
#[derive(Debug, Args)]
pub struct Arguments {
    /// A TOML file or case:NAME.
    vehicle: String,
    /// A TOML file or case:NAME.
    #[arg(long)]
    road: String,
    /// Forward speed in m/s.
    #[arg(long, value_name = "V", allow_negative_numbers = true, required_unless_present = "speeds")]
    speed_m_s: Option<f64>,
    /// Length of the recording in s.
    #[arg(long, value_name = "T", allow_negative_numbers = true, required_unless_present = "speeds")]
    duration_s: Option<f64>,
    /// Instead of both: stretches in m/s : s, one after another with jumps between, such as 10:300,20:600.
    #[arg(long, value_name = "V:T,…", value_delimiter = ',', value_parser = stretch,
        allow_hyphen_values = true, conflicts_with_all = ["speed_m_s", "duration_s"])]
    speeds: Vec<Stretch>,
    /// Samples per second.
    #[arg(long, value_name = "F", allow_negative_numbers = true)]
    rate_hz: f64,
    /// White noise as a multiple of each channel's rms.
    #[arg(long, value_name = "R", default_value_t = 0.0, allow_negative_numbers = true)]
    noise: f64,
    /// A TOML file with one [[sensor]] a channel.
    #[arg(long, value_name = "FILE")]
    sensors: Option<PathBuf>,
    /// Same seed, same drive.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// The data file; an earlier simulated drive of this name is replaced.
    #[arg(short, long, value_name = "RUN.csv")]
    output: PathBuf,
}

/// Records and writes.
pub fn run(a: Arguments, output: Output) -> Result<ExitCode, Failure> {
    let progress = output.progress("driving");
    let result = simulate(&SimulateSpec {
        vehicle: a.vehicle,
        road: a.road,
        speed_m_s: a.speed_m_s,
        duration_s: a.duration_s,
        speeds: a.speeds,
        rate_hz: a.rate_hz,
        noise: a.noise,
        sensors: a.sensors,
        seed: a.seed,
        output: a.output,
    });
    let run = result.and_then(|run| write_files(&run.files).map(|()| run).map_err(Into::into));
    drop(progress);
    let run = run?;
    output.print(&Envelope::new("simulate", run.inputs, run.outcome), table)?;
    Ok(ExitCode::SUCCESS)
}

fn table(o: &SimulateOutcome) -> String {
    let mut table = Table::new(&["<channel", "<quantity", "<unit", "rms", "noise rms"]);
    for c in &o.channels {
        let (quantity, unit) = (c.quantity.name().to_owned(), c.unit.clone());
        table.row([c.name.clone(), quantity, unit, number(c.rms), number(c.noise_rms)]);
    }
    let seconds = o.samples as f64 / o.rate_hz;
    let delay = o.delay_s.map_or_else(String::new, |d| format!(", rear axle {} s behind", number(d)));
    let speed = if o.stretches.is_empty() {
        format!("{} m/s", o.speed_m_s)
    } else {
        let each: Vec<String> =
            o.stretches.iter().map(|s| format!("{} m/s for {} s", s.speed_m_s, s.duration_s)).collect();
        each.join(", then at ")
    };
    let drive = format!(
        "{} samples at {} Hz ({seconds} s) at {speed}{delay}, seed {}\n",
        o.samples, o.rate_hz, o.seed
    );
    table.text() + &drive + &format!("wrote {}\n", o.files.join(", "))
}
