//! `washboard design`: a controller for a vehicle on a road, what it buys, and the proof.

use crate::output::{Failure, Output};
use crate::table::{Table, number, wrapped};
use clap::Args;
use std::fmt::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use washboard::files::{FileError, check_target_directory, write_directory};
use washboard::report::design_page;
use washboard::study::{
    DesignOutcome, DesignSpec, DesignStatus, Envelope, Input, Measured, Rms, StudyError, controller_files,
    design,
};

/// Design a controller, and certify it.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The design: vehicle, road, measurements, method, goal.
    #[arg(value_name = "DESIGN.toml")]
    design: PathBuf,
    /// Write result.json, report.html and the controller's files here.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Replace a directory that is not empty.
    #[arg(long)]
    overwrite: bool,
}

/// Designs, writes, prints; 1 where there is no controller (and no limit) to show.
pub fn run(a: Arguments, output: Output) -> Result<ExitCode, Failure> {
    if let Some(dir) = &a.output {
        check_target_directory(dir, a.overwrite)?;
    }
    let spec = DesignSpec::read(&a.design)?;
    let progress = output.progress("designing");
    let result = design(&spec);
    drop(progress);
    // whatever is wrong stands in the design, or in a file that it names
    let (outcome, inputs) = result.map_err(|e: StudyError| match e {
        e if e.is_wrong_input() => FileError::content(&a.design, None, e.to_string()).into(),
        e => e,
    })?;
    let own = Input::of_file(&a.design)?;
    let envelope = Envelope::new("design", std::iter::once(own).chain(inputs).collect(), outcome);
    if let Some(dir) = &a.output {
        let title = a.design.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        let page = design_page(&envelope.outcome, &title);
        let made = controller_files(&envelope.outcome)?;
        let mut files =
            vec![("result.json", envelope.to_json().into_bytes()), ("report.html", page.into_bytes())];
        files.extend(made.iter().map(|(name, bytes)| (name.as_str(), bytes.clone())));
        write_directory(dir, &files, a.overwrite)?;
    }
    let place =
        a.output.map(|dir| format!("wrote {}\n", dir.join("report.html").display())).unwrap_or_default();
    output.print(&envelope, |o| table(o) + &place)?;
    let good = matches!(envelope.outcome.status, DesignStatus::Designed | DesignStatus::Limit);
    Ok(if good { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

fn table(o: &DesignOutcome) -> String {
    let d = &o.design;
    let mut text = wrapped(&format!(
        "{} on {} at {} m/s, method {}, measuring {}",
        d.vehicle,
        d.road,
        d.speed_m_s,
        d.method.name(),
        d.measurements.join(", ")
    ));
    let status = match o.status {
        DesignStatus::Designed => format!("designed: order {}", o.order.unwrap_or(0)),
        DesignStatus::Limit => "the limit of what any controller can reach".to_owned(),
        DesignStatus::Infeasible => "infeasible".to_owned(),
        DesignStatus::Stalled => "stalled".to_owned(),
        DesignStatus::Refused => "refused".to_owned(),
    };
    let _ = writeln!(text, "{status}");
    if let Some(why) = &o.why {
        text += &wrapped(&format!("! {why}"));
    }
    for w in &o.warnings {
        text += &wrapped(&format!("! {}: {}", w.name, w.text));
    }
    for n in &o.notes {
        text += &wrapped(&format!("note: {}", n.text));
    }
    text += "\n";
    text += &norms(&o.passive, o.verified.as_ref());
    text += "\n";
    for (name, value) in o.objective.iter() {
        let _ = writeln!(text, "objective, {name}: {}", number(*value));
    }
    for (name, value) in o.claimed.iter() {
        let _ = writeln!(text, "claimed {name}: {}", number(*value));
    }
    if let Some(v) = &o.verified {
        let margin = v.poles.iter().map(|p| -p[0]).fold(f64::INFINITY, f64::min);
        let _ = writeln!(
            text,
            "closed loop: {} poles, the slowest decays at {} 1/s",
            v.poles.len(),
            number(margin)
        );
    }
    text
}

/// rms on the road and H∞ norms, passive and closed, with the change in percent.
fn norms(passive: &Measured, closed: Option<&Measured>) -> String {
    let mut rows = Table::new(&["<", "rms passive", "rms closed", "%", "peak gain passive", "closed", "%"]);
    let show = |r: Option<&Rms>| match r {
        Some(Rms::Finite(v)) => number(*v),
        Some(Rms::Infinite(_)) => "infinite".to_owned(),
        None => String::new(),
    };
    let change = |before: Option<f64>, after: Option<f64>| match (before, after) {
        (Some(b), Some(a)) if b > 0.0 => format!("{:+.1}", 100.0 * (a / b - 1.0)),
        _ => String::new(),
    };
    for (name, before) in passive.rms.iter() {
        let after = closed.and_then(|c| c.rms.get(name));
        let peaks = (passive.hinf.get(name).copied(), closed.and_then(|c| c.hinf.get(name)).copied());
        rows.row([
            name.to_owned(),
            show(Some(before)),
            show(after),
            change(before.finite(), after.and_then(|r| r.finite())),
            peaks.0.map(number).unwrap_or_default(),
            peaks.1.map(number).unwrap_or_default(),
            change(peaks.0, peaks.1),
        ]);
    }
    rows.text()
}
