//! `washboard road fit`: a shaping filter from a spectrum, a profile or a road.

use super::{roots, said, values, wrote};
use crate::args::{count, pair, word};
use crate::output::{Failure, Output};
use crate::table::{Table, number, wrapped};
use clap::Args;
use std::path::PathBuf;
use std::process::ExitCode;
use washboard::files::write_files;
use washboard::study::{DensityConvention, Envelope, FitWeight, RoadFitOutcome, RoadFitSpec, road_fit};

/// Fit a shaping filter to a spectrum, a profile or a road; written as FILTER.toml it is a ROAD.
#[derive(Debug, Args)]
pub struct Arguments {
    /// SPECTRUM.csv, PROFILE.csv (a column x_m), ROAD.toml, case:NAME, or what `identify -o DIR` wrote.
    #[arg(value_name = "SOURCE")]
    source: String,
    /// Order of the fit; chosen by Bayes' criterion without it.
    #[arg(long, value_name = "N", value_parser = count, allow_negative_numbers = true)]
    order: Option<usize>,
    /// The largest order that is tried where it is chosen.
    #[arg(long, value_name = "N", value_parser = count, allow_negative_numbers = true)]
    max_order: Option<usize>,
    /// Frequency that goes to the middle of the circle, rad/m or rad/s; the geometric mean of the band without it.
    #[arg(long, value_name = "RAD", allow_negative_numbers = true)]
    lambda: Option<f64>,
    /// Block rows of the subspace method.
    #[arg(long = "p", value_name = "P", value_parser = count, allow_negative_numbers = true)]
    block_rows: Option<usize>,
    /// none: large densities count; relative2: errors of the logarithm count (the default).
    #[arg(long, value_name = "none|relative|relative2", value_parser = word::<FitWeight>)]
    weight: Option<FitWeight>,
    /// What the densities are: one-sided-per-hz, two-sided-rad-per-m, … (the frequency column's own without it).
    #[arg(long, value_name = "C", value_parser = word::<DensityConvention>)]
    convention: Option<DensityConvention>,
    /// What the spectrum is of: displacement (the default) or velocity.
    #[arg(long, value_name = "WHAT", value_parser = word::<washboard::road::FilterOutput>)]
    of: Option<washboard::road::FilterOutput>,
    /// The part that is fitted, rad/m or rad/s.
    #[arg(long, value_name = "LOW,HIGH", value_parser = pair, allow_hyphen_values = true)]
    band: Option<[f64; 2]>,
    /// Corner of the low-pass that makes the filter strictly proper, rad/m or rad/s; below or beyond the band, whichever fits better, without it.
    #[arg(long, value_name = "RAD", allow_negative_numbers = true)]
    roll_off: Option<f64>,
    /// How many times that low-pass is passed, 1 or 2; without it 1, of a matrix spectrum 2 (so that velocities are not white) unless 1 comes nearer.
    #[arg(long, value_name = "K", value_parser = count, allow_negative_numbers = true)]
    roll_off_order: Option<usize>,
    /// Names of the vehicle's road inputs, one a channel of a matrix spectrum: chassis_front_left,… of a truck cabin, or its wheels'.
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    points: Vec<String>,
    /// Leave a filter's feedthrough as it is.
    #[arg(long)]
    proper: bool,
    /// Length of the segments of a profile's spectrum; an eighth of the profile, 400 m at most, without it.
    #[arg(long, value_name = "L", allow_negative_numbers = true)]
    segment_m: Option<f64>,
    /// Average a raw spectrum in bands, N an octave, before it is fitted
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    smooth: Option<f64>,
    /// The file is a profile without a header: distance in m, then heights in m.
    #[arg(long)]
    no_header: bool,
    /// FILTER.toml, a road file; or FILTER.json, a state space.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Replace the file that is there.
    #[arg(long)]
    overwrite: bool,
}

/// Fits and writes.
pub fn run(a: Arguments, output: Output) -> Result<ExitCode, Failure> {
    let progress = output.progress("fitting");
    let result = road_fit(&RoadFitSpec {
        source: a.source,
        no_header: a.no_header,
        order: a.order,
        max_order: a.max_order,
        lambda_rad: a.lambda,
        block_rows: a.block_rows,
        weight: a.weight,
        convention: a.convention,
        of: a.of,
        band_rad: a.band,
        roll_off_rad: a.roll_off,
        roll_off_order: a.roll_off_order,
        points: a.points,
        proper: a.proper,
        segment_m: a.segment_m,
        smooth_per_octave: a.smooth,
        output: a.output,
        overwrite: a.overwrite,
    });
    drop(progress);
    let run = result?;
    if let Some(file) = &run.file {
        write_files(std::slice::from_ref(file))?;
    }
    let usable = run.outcome.usable;
    output.print(&Envelope::new("road fit", run.inputs, run.outcome), table)?;
    Ok(if usable { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

/// The filter, how near it comes, and how its order was chosen.
fn table(o: &RoadFitOutcome) -> String {
    let mut table = Table::new(&["<filter", "<"]);
    let mut row = |name: &str, value: String| table.row([name.to_owned(), value]);
    row("order", format!("{}, {} states", o.order, o.states));
    row("poles", format!("{} {}", roots(&o.poles), o.unit));
    if let Some(gain) = o.gain {
        row("zeros", format!("{} {}", roots(&o.zeros), o.unit));
        row("gain", number(gain));
    }
    row("band", format!("{} to {} {}, {} samples", number(o.band[0]), number(o.band[1]), o.unit, o.samples));
    row("log10 error", format!("{} rms, {} at most", number(o.log10_rms_error), number(o.log10_max_error)));
    if let Some(c) = &o.cross {
        let ([i, j], at) = (c.phase_pair, number(c.phase_at_rad));
        let phase = format!("phase off by {:.0}° at most (psd_{i}{j}, {at} {})", c.phase_deg, o.unit);
        row("cross-spectra", format!("{} rms of coherent pairs, {phase}", number(c.rms)));
    }
    row("weight", o.weight.clone());
    row("lambda, p", format!("{} {}, {}", number(o.lambda), o.unit, o.p));
    let mut text = table.text();
    if !o.orders.is_empty() {
        let mut orders = Table::new(&["order", "log10 error", "Bayes' criterion", "low-pass", "<"]);
        for tried in &o.orders {
            let cell = |v: Option<f64>| v.map_or_else(|| "none".to_owned(), number);
            let lowered = tried.lowered_to.map(|n| format!("lowered to {n}"));
            let mark = tried.chosen.then(|| "chosen".to_owned());
            let said: Vec<String> = lowered.into_iter().chain(mark).collect();
            orders.row([
                tried.order.to_string(),
                cell(tried.log10_rms_error),
                cell(tried.bic),
                tried.roll_off_order.map_or_else(|| "none".to_owned(), |k| k.to_string()),
                said.join(", "),
            ]);
        }
        text += &format!("\n{}", orders.text());
    }
    text += "\n";
    text += &wrapped(&format!("singular values: {}", values(&o.singular_values, 24)));
    text + &said(&o.notes) + &wrote(o.file.as_ref())
}
