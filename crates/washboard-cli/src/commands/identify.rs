//! `washboard identify`: from a recording to modes and the road.

use crate::args::{assignment, pair, word};
use crate::output::{Failure, Output};
use crate::table::{Table, number, percent, with_sd, wrapped};
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use washboard::files::{check_target_directory, write_directory};
use washboard::report::identify_page;
use washboard::study::{Envelope, IdentifyMethod, IdentifyOutcome, IdentifyRun, IdentifySpec, identify};
use washboard::units::Convention;

/// Find the modes and the road of a recording.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The recording's description; several are of one vehicle at other speeds or on other roads.
    #[arg(value_name = "RUN.toml", required = true, num_args = 1..)]
    recordings: Vec<PathBuf>,
    /// What the vehicle is like: a TOML file or case:NAME; without it a generic vehicle on the recording's wheels.
    #[arg(long)]
    vehicle: Option<String>,
    /// A value that is known, such as sprung_mass_kg=1150: it sets the scale of masses and stiffnesses.
    #[arg(long, value_name = "NAME=VALUE", value_parser = assignment)]
    known: Vec<(String, f64)>,
    /// How.
    #[arg(long, default_value = "physical", value_parser = methods())]
    method: IdentifyMethod,
    /// The band that is fitted.
    #[arg(long, value_name = "A,B", value_parser = pair)]
    band_hz: Option<[f64; 2]>,
    /// Length of a segment of the spectra in s.
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    segment_s: Option<f64>,
    /// What the road's roughness is a density of (one-sided-rad-per-m, paper, …).
    #[arg(long, value_name = "C", value_parser = word::<Convention>)]
    convention: Option<Convention>,
    /// Write result.json, vehicle.toml, road.toml and report.html here.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Replace a directory that is not empty.
    #[arg(long)]
    overwrite: bool,
}

fn methods() -> impl TypedValueParser<Value = IdentifyMethod> {
    PossibleValuesParser::new(IdentifyMethod::ALL.map(IdentifyMethod::name))
        .try_map(|name| word::<IdentifyMethod>(&name))
}

/// Identifies, writes, prints; 1 where it did not converge.
pub fn run(a: Arguments, output: Output) -> Result<ExitCode, Failure> {
    if let Some(dir) = &a.output {
        check_target_directory(dir, a.overwrite)?;
    }
    let name = |p: &Path| p.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
    let title = a.recordings.iter().map(|p| name(p)).collect::<Vec<_>>().join(", ");
    let mut recordings = a.recordings.into_iter();
    let progress = output.progress("identifying");
    let result = identify(&IdentifySpec {
        recording: recordings.next().unwrap_or_default(),
        more: recordings.collect(),
        vehicle: a.vehicle,
        known: a.known,
        method: a.method,
        band_hz: a.band_hz,
        segment_s: a.segment_s,
        convention: a.convention,
    });
    drop(progress);
    finish(result?, &title, a.output.as_deref(), a.overwrite, output)
}

/// Writes and prints what an identification found.
fn finish(
    run: IdentifyRun,
    title: &str,
    dir: Option<&Path>,
    overwrite: bool,
    output: Output,
) -> Result<ExitCode, Failure> {
    let envelope = Envelope::new("identify", run.inputs, run.outcome);
    if let Some(dir) = dir {
        let page = identify_page(&envelope.outcome, title);
        let mut files =
            vec![("result.json", envelope.to_json().into_bytes()), ("report.html", page.into_bytes())];
        files.extend(run.files.iter().map(|(name, bytes)| (name.as_str(), bytes.clone())));
        write_directory(dir, &files, overwrite)?;
    }
    let place = dir.map(|d| format!("wrote {}\n", d.join("report.html").display())).unwrap_or_default();
    output.print(&envelope, |o| table(o) + &place)?;
    Ok(if envelope.outcome.converged { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

/// What was found, as it is printed.
pub fn table(o: &IdentifyOutcome) -> String {
    let mut text = recording(o);
    for flag in &o.flags {
        text += &wrapped(&format!("! {}: {}", flag.name, flag.text));
    }
    for note in &o.notes {
        text += &wrapped(&format!("note: {}", note.text));
    }
    text += "\n";
    text += &modes(o);
    text += "\n";
    if let Some(road) = &o.road {
        let convention = serde_json::to_value(road.convention).ok();
        let _ = writeln!(
            text,
            "road       roughness {} m³ ({}), exponent {}, class {:?}",
            with_sd(road.roughness_m3, Some(road.roughness_sd_m3)),
            convention.as_ref().and_then(|c| c.as_str()).unwrap_or_default(),
            with_sd(road.exponent, Some(road.exponent_sd)),
            road.class,
        );
    }
    if let Some(c) = &o.coherence {
        let _ = writeln!(text, "coherence  μ = {}", with_sd(c.mu, Some(c.mu_sd)));
    }
    if let Some(d) = o.delay_s {
        let sd_ms = o.delay_sd_s.map(|s| 1e3 * s);
        let _ = writeln!(text, "delay      {} ms from front to rear", with_sd(1e3 * d, sd_ms));
    }
    if let Some(fit) = &o.fit {
        let _ = writeln!(
            text,
            "fit        χ = {:.2} (0.6 at most where the model explains the data), {} steps, {} evaluations",
            fit.chi, fit.iterations, fit.evaluations
        );
    }
    for line in &o.lines {
        let _ = writeln!(text, "line       {} Hz: {}", number(line.freq_hz), line.text);
    }
    if !o.rejected.is_empty() {
        let _ = writeln!(text, "left out   {} candidates; --json says why each", o.rejected.len());
    }
    if !o.converged {
        let _ = writeln!(text, "this is no result to rely on: see the flags above");
    }
    text
}

fn recording(o: &IdentifyOutcome) -> String {
    let r = &o.recording;
    let speed = r.speed_m_s.map_or_else(|| "speed unknown".to_owned(), |v| format!("{} m/s", number(v)));
    let mut text = format!(
        "{}: {} s at {} Hz, {speed}, {} channels; method {}, {} to {} Hz, segments of {} s ({:.0} averages)\n",
        r.name,
        number(r.duration_s),
        number(r.rate_hz),
        r.channels.len(),
        o.method,
        number(r.band_hz[0]),
        number(r.band_hz[1]),
        number(r.segment_s),
        r.averages
    );
    for repair in &r.repairs {
        let _ = writeln!(text, "repaired: {}", repair.text);
    }
    text
}

fn modes(o: &IdentifyOutcome) -> String {
    let mut header = vec!["<mode", "frequency (Hz)", "damping (%)"];
    if o.truth.is_some() {
        header.extend(["true (Hz)", "true (%)"]);
    }
    let mut table = Table::new(&header);
    for m in &o.modes {
        let mut row = vec![
            m.label.clone(),
            with_sd(m.freq_hz, m.freq_sd_hz),
            with_sd(100.0 * m.damping, m.damping_sd.map(|s| 100.0 * s)),
        ];
        if let Some(truth) = &o.truth {
            let known = truth.modes.iter().find(|t| t.label == m.label);
            row.push(known.map(|t| number(t.freq_hz)).unwrap_or_default());
            row.push(known.map(|t| percent(t.damping)).unwrap_or_default());
        }
        table.row(row);
    }
    if table.is_empty() { "no modes\n".to_owned() } else { table.text() }
}
