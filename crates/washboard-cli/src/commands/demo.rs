//! `washboard demo`: from a drive of a published car to controllers for it, and the report.

use crate::commands::identify::table as identified;
use crate::output::{Failure, Output};
use crate::table::{Table, number, wrapped};
use clap::Args;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;
use washboard::files::{check_target_directory, write_directory};
use washboard::report::{demo_page, demo_svg};
use washboard::study::{
    DemoController, DemoDesigns, DemoMethod, DemoOutcome, DemoSpec, Envelope, demo, is_result_of,
};
use washboard::units::signed;

/// Where the report goes unless told.
const DIRECTORY: &str = "washboard-demo";
/// What is printed of a ride.
const SHOWN: [&str; 4] = ["body_acceleration", "suspension_travel", "tire_deflection", "actuator_force"];

/// Drive a published car, identify it and the road from what its sensors felt, design controllers for what was found, and see what the true
/// car makes of them.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Of the simulated drive.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Where the report goes [default: washboard-demo, where an earlier demo is replaced].
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Replace a directory that is not empty.
    #[arg(long)]
    overwrite: bool,
}

/// Runs the demo.
pub fn run(a: Arguments, output: Output) -> Result<ExitCode, Failure> {
    let default = Path::new(DIRECTORY);
    let overwrite = a.overwrite || (a.output.is_none() && is_result_of(default, "demo"));
    let dir = a.output.as_deref().unwrap_or(default);
    check_target_directory(dir, overwrite)?;
    let progress =
        output.progress("driving and identifying a published car, and designing controllers for it");
    let result = demo(&DemoSpec { seed: a.seed });
    drop(progress);
    let run = result?;
    let envelope = Envelope::new("demo", run.inputs, run.outcome);
    let page = demo_page(&envelope.outcome, "washboard demo");
    let mut files =
        vec![("result.json", envelope.to_json().into_bytes()), ("report.html", page.into_bytes())];
    files.extend(demo_svg(&envelope.outcome).map(|svg| ("demo.svg", svg.into_bytes())));
    files.extend(run.files.iter().map(|(name, bytes)| (name.as_str(), bytes.clone())));
    write_directory(dir, &files, overwrite)?;
    let place = format!("wrote {}\n", dir.join("report.html").display());
    output.print(&envelope, |o| table(o) + &times(&run.times) + &place)?;
    let designed = envelope.outcome.designs.as_ref().is_some_and(|d| {
        d.methods.iter().all(|m| m.on_identified.ride.is_some() && m.on_true.ride.is_some())
    });
    Ok(if envelope.outcome.identified.converged && designed { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

fn table(o: &DemoOutcome) -> String {
    let mut text = identified(&o.identified);
    let Some(d) = &o.designs else { return text };
    let f = &d.filter;
    let _ = writeln!(
        text,
        "\nfilter     {}; log10 error {} rms, {} at most, from {} to {} rad/m",
        f.order_words(),
        number(f.log10_rms_error),
        number(f.log10_max_error),
        number(f.band_rad_per_m[0]),
        number(f.band_rad_per_m[1])
    );
    d.methods.iter().for_each(|m| text += &method(d, m));
    text
}

fn method(d: &DemoDesigns, m: &DemoMethod) -> String {
    let head = format!("<{}: rms in the true car", m.title);
    let mut rows = Table::new(&[&head, "<unit", "passive", "on identified", "on true", "apart, %"]);
    for name in SHOWN {
        let rms = |c: &DemoController| c.ride.as_ref().and_then(|r| r.rms.get(name)?.finite());
        let show = |v: Option<f64>| v.map(number).unwrap_or_default();
        rows.row([
            name.to_owned(),
            d.units.get(name).cloned().unwrap_or_default(),
            show(d.passive.rms.get(name).and_then(|r| r.finite())),
            show(rms(&m.on_identified)),
            show(rms(&m.on_true)),
            m.difference.get(name).map(|v| signed(100.0 * v, 2)).unwrap_or_default(),
        ]);
    }
    let mut text = format!("\n{}", rows.text());
    for w in &m.warnings(&d.passive) {
        text += &wrapped(&format!("! {} ({})", w.text, w.name));
    }
    for (whose, c) in [("identified", &m.on_identified), ("true", &m.on_true)] {
        if let Some(why) = &c.why {
            text += &wrapped(&format!("! on {whose}: {why}"));
        }
    }
    text
}

/// How long each part took, in the order of its first time.
fn times(all: &[(&'static str, Duration)]) -> String {
    let mut parts: Vec<(&str, Duration)> = Vec::new();
    for (name, time) in all {
        match parts.iter_mut().find(|(n, _)| n == name) {
            Some((_, sum)) => *sum += *time,
            None => parts.push((name, *time)),
        }
    }
    let total: Duration = all.iter().map(|(_, t)| *t).sum();
    let list: Vec<String> = parts.iter().map(|(n, t)| format!("{n} {:.1} s", t.as_secs_f64())).collect();
    wrapped(&format!("time       {:.1} s: {}", total.as_secs_f64(), list.join(", ")))
}
