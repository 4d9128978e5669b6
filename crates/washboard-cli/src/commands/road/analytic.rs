//! `washboard road analytic`: algorithm 2.4.1.

use super::{roots, said, values, wrote};
use crate::output::{Failure, Output};
use crate::table::{Table, number, wrapped};
use clap::Args;
use std::path::PathBuf;
use std::process::ExitCode;
use washboard::files::write_files;
use washboard::study::{Envelope, RoadAnalyticOutcome, RoadAnalyticSpec, road_analytic};

/// A stable function from samples of its real or imaginary part, its phase or its magnitude (algorithm 2.4.1).
#[derive(Debug, Args)]
pub struct Arguments {
    /// A frequency column (theta_rad on the unit circle, or omega_rad_s, freq_hz, nu_rad_per_m, n_cycles_per_m) and one of
    /// real, imag, phase_rad, magnitude.
    #[arg(value_name = "DATA.csv")]
    data: PathBuf,
    /// Order of the function (of its logarithm, for a phase or magnitude).
    #[arg(long, value_name = "N")]
    order: usize,
    /// Block rows of the subspace method.
    #[arg(long = "p", value_name = "P")]
    block_rows: Option<usize>,
    /// Frequency that goes to the middle of the circle; the geometric mean of the band without it.
    #[arg(long, value_name = "RAD", allow_negative_numbers = true)]
    lambda: Option<f64>,
    /// The function is positive real: its real part is kept above 0 everywhere.
    #[arg(long)]
    positive: bool,
    /// A CSV file of the samples: given, real, imag, magnitude, phase_rad.
    #[arg(short, long, value_name = "FILE.csv")]
    output: Option<PathBuf>,
    /// Replace the file that is there.
    #[arg(long)]
    overwrite: bool,
}

/// Fits and writes.
pub fn run(a: Arguments, output: Output) -> Result<ExitCode, Failure> {
    let progress = output.progress("fitting");
    let result = road_analytic(&RoadAnalyticSpec {
        data: a.data,
        order: a.order,
        block_rows: a.block_rows,
        lambda_rad: a.lambda,
        positive: a.positive,
        output: a.output,
        overwrite: a.overwrite,
    });
    drop(progress);
    let run = result?;
    if let Some(file) = &run.file {
        write_files(std::slice::from_ref(file))?;
    }
    output.print(&Envelope::new("road analytic", run.inputs, run.outcome), table)?;
    Ok(ExitCode::SUCCESS)
}

fn table(o: &RoadAnalyticOutcome) -> String {
    let mut table = Table::new(&[&format!("<{} of {}", o.system, o.given), "<"]);
    let mut row = |name: &str, value: String| table.row([name.to_owned(), value]);
    row("order", o.order.to_string());
    row("poles (z)", roots(&o.poles));
    let of = if o.system == "f" {
        o.given.clone()
    } else {
        format!("{} of ln f", if o.given == "magnitude" { "real part" } else { "imaginary part" })
    };
    row("rms error", format!("{} beside {} ({of})", number(o.rms_error), number(o.rms_given)));
    row("samples", o.samples.theta_rad.len().to_string());
    if let Some(lambda) = o.lambda {
        row("lambda", number(lambda));
    }
    row("p", o.p.to_string());
    let singular = wrapped(&format!("singular values: {}", values(&o.singular_values, 24)));
    table.text() + &singular + &said(&o.notes) + &wrote(o.file.as_ref())
}
