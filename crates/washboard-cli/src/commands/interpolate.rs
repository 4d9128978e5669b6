//! `washboard interpolate`: a rational function through values, or near measurements.

use crate::output::{Failure, Output};
use crate::table::wrapped;
use clap::Args;
use std::fmt::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use washboard::files::write_whole;
use washboard::study::{
    Envelope, InterpolateOutcome, InterpolateSpec, InterpolateStatus, check_interpolation_target,
    interpolate_file,
};

/// Singular values that a table shows past the order.
const SHOWN_PAST: usize = 3;

/// A rational function of least order through values and derivatives, or near measured responses with constraints.
#[derive(Debug, Args)]
pub struct Arguments {
    /// JSON with domain, nodes or measured values, constraints, order, bound.
    #[arg(value_name = "DATA.json")]
    data: PathBuf,
    /// Write the result as JSON here; an earlier result is replaced.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// Interpolates, writes, prints; 1 where the function is not what was asked for.
pub fn run(a: Arguments, output: Output) -> Result<ExitCode, Failure> {
    if let Some(to) = &a.output {
        check_interpolation_target(&a.data, to)?;
    }
    let (outcome, inputs) = interpolate_file(&InterpolateSpec { data: a.data })?;
    let envelope = Envelope::new("interpolate", inputs, outcome);
    let mut place = String::new();
    if let Some(to) = &a.output {
        write_whole(to, envelope.to_json().as_bytes())?;
        place = format!("wrote {}\n", to.display());
    }
    output.print(&envelope, |o| table(o) + &place)?;
    let found = envelope.outcome.status == InterpolateStatus::Found;
    Ok(if found { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

fn table(o: &InterpolateOutcome) -> String {
    let mut text = String::new();
    if let Some(why) = &o.why {
        text += &wrapped(&format!("! {why}"));
    }
    let size = format!("{} × {}", o.d.len(), o.d.first().map_or(0, Vec::len));
    let _ = writeln!(text, "order {}, {size}, {}", o.order, if o.stable { "stable" } else { "not stable" });
    if let Some(error) = o.max_error {
        let _ = writeln!(text, "largest error {error:.1e} of the values' size");
    }
    if let Some(rms) = o.measured_rms_error {
        let _ = writeln!(text, "rms residual of the measured values {rms:.1e} of their size");
    }
    if let Some([bound, least]) = o.bound {
        let _ = writeln!(text, "modulus on the boundary {bound:.6}; the least there can be is {least:.6}");
    }
    let shown = o.singular_values.iter().take(o.order + SHOWN_PAST);
    let values: Vec<String> = shown.map(|s| format!("{s:.3e}")).collect();
    let more = o.singular_values.len().saturating_sub(o.order + SHOWN_PAST);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    text += &wrapped(&format!("singular values {}{more}", values.join(", ")));
    for (name, rows) in [("A", &o.a), ("B", &o.b), ("C", &o.c), ("D", &o.d)] {
        let _ = writeln!(text, "{name}");
        for row in rows {
            let cells: Vec<String> = row.iter().map(|x| format!("{x:>13.6e}")).collect();
            let _ = writeln!(text, "  {}", cells.join("  "));
        }
    }
    text
}
