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
    DesignMethod, DesignOutcome, DesignSpec, DesignStatus, Envelope, Input, Rms, StudyError,
    controller_files, design,
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
    let mut text = wrapped(&format!("{} on {} at {} m/s", d.vehicle, d.road, d.speed_m_s));
    text += &wrapped(&format!(
        "method {}, {} {}",
        d.method.name(),
        o.measures_words(),
        d.measurements.join(", ")
    ));
    text += &wrapped(&format!("{}: {}", status(o.status), o.verdict()));
    if let Some(why) = &o.why {
        text += &wrapped(&format!("! {why}"));
    }
    for w in &o.warnings {
        text += &wrapped(&format!("! {}: {}", w.name, w.text));
    }
    for n in &o.notes {
        text += &wrapped(&format!("note: {}", n.text));
    }
    if let Some(no_loop) = o.no_loop() {
        text += &wrapped(&format!("note: {no_loop}"));
    }
    let parts = [
        rms(o),
        peaks(o),
        metrics(o),
        goal(o),
        targets(o),
        vertices(o),
        claims(o),
        truncated(o),
        gains(o),
        robustness(o),
        search(o),
    ];
    parts.into_iter().filter(|p| !p.is_empty()).for_each(|p| text += &format!("\n{p}"));
    if let Some(v) = &o.verified {
        let margin = v.poles.iter().map(|p| -p[0]).fold(f64::INFINITY, f64::min);
        let slowest = number(margin);
        let _ = writeln!(text, "\nclosed loop: {} poles, the slowest decays at {slowest} 1/s", v.poles.len());
    }
    text
}

/// The word of the JSON.
fn status(status: DesignStatus) -> &'static str {
    match status {
        DesignStatus::Designed => "designed",
        DesignStatus::Limit => "limit",
        DesignStatus::Infeasible => "infeasible",
        DesignStatus::Stalled => "stalled",
        DesignStatus::Refused => "refused",
    }
}

/// Columns of passive, closed and change, or of the passive one alone where there is no loop.
fn columns<'a>(o: &DesignOutcome, first: &'a str) -> Vec<&'a str> {
    let all = [first, "<unit", "passive", "closed", "%"];
    all[..if o.verified.is_some() { 5 } else { 3 }].to_vec()
}

fn share(change: Option<f64>) -> String {
    change.map(|c| washboard::units::signed(100.0 * c, 1)).unwrap_or_default()
}

/// rms on the road: every output, by groups.
fn rms(o: &DesignOutcome) -> String {
    let show = |r: Option<Rms>| match r {
        Some(Rms::Finite(v)) => number(v),
        Some(Rms::Infinite(_)) => "infinite".to_owned(),
        None => String::new(),
    };
    let mut rows = Table::new(&columns(o, "<rms on the road"));
    let mut group = None;
    for r in o.rows() {
        if group != Some(r.group) {
            rows.row([r.group.heading().to_owned()]);
            group = Some(r.group);
        }
        let indent = if r.corner_of.is_some() { "    " } else { "  " };
        let name = format!("{indent}{}", r.short_name());
        let cells = [name, r.unit.to_owned(), show(r.rms[0]), show(r.rms[1]), share(r.rms_change())];
        rows.row(cells.into_iter().take(columns(o, "").len()));
    }
    if group.is_some() { rows.text() } else { String::new() }
}

/// Largest gains: whole vectors alone, since the page has the corners.
fn peaks(o: &DesignOutcome) -> String {
    let mut rows = Table::new(&columns(o, "<largest gain over frequency"));
    for r in o.rows().iter().filter(|r| r.corner_of.is_none()) {
        let show = |v: Option<f64>| v.map(number).unwrap_or_default();
        let unit = format!("{} per {}", r.unit, o.per());
        let cells = [r.name.to_owned(), unit, show(r.peak[0]), show(r.peak[1]), share(r.peak_change())];
        rows.row(cells.into_iter().take(columns(o, "").len()));
    }
    if rows.is_empty() { String::new() } else { rows.text() }
}

/// Worst corners, and the power of all actuators: the page has every corner.
fn metrics(o: &DesignOutcome) -> String {
    let Some(m) = &o.metrics else { return String::new() };
    let mut rows = Table::new(&columns(o, "<metrics"));
    let mut group = None;
    for r in m.short_rows(&o.units) {
        if group != Some(r.group) {
            rows.row([r.group.heading().to_owned()]);
            group = Some(r.group);
        }
        let shown = r.shown(number);
        let show = |side: usize| shown[side].clone().unwrap_or_else(|| r.infinite(side).to_owned());
        let cells = [format!("  {}", r.what), r.unit.clone(), show(0), show(1), share(r.change())];
        rows.row(cells.into_iter().take(columns(o, "").len()));
    }
    if group.is_some() { rows.text() + &wrapped(&o.metrics_words()) } else { String::new() }
}

/// The value of the goal: passive, closed, and what none can beat, where these are known.
fn goal(o: &DesignOutcome) -> String {
    let value = |name: &str| o.objective.get(name).copied();
    let (passive, closed, limit) = (value("passive"), value("verified"), value("limit"));
    let (worst_passive, worst) = (value("worst_passive"), value("worst"));
    let change = |before: Option<f64>, after: Option<f64>| {
        before.zip(after).filter(|(p, _)| *p > 0.0).map(|(p, c)| share(Some(c / p - 1.0)))
    };
    let known = [
        ("passive", passive.map(number)),
        ("closed", closed.map(number)),
        ("%", change(passive, closed)),
        ("worst vehicle", worst.map(number)),
        ("passive ", worst_passive.map(number)),
        ("% ", change(worst_passive, worst)),
        ("limit", limit.map(number)),
    ];
    let mut head = vec!["<goal, of norms over passive ones"];
    head.extend(known.iter().filter(|(_, v)| v.is_some()).map(|(name, _)| *name));
    let mut rows = Table::new(&head);
    rows.row(std::iter::once(o.goal_words().to_owned()).chain(known.into_iter().filter_map(|(_, v)| v)));
    if head.len() > 1 { rows.text() } else { String::new() }
}

fn claims(o: &DesignOutcome) -> String {
    let mut rows = Table::new(&["<what is claimed", "claimed", "in the loop", "<unit"]);
    for r in o.claim_rows() {
        let shown = |v: f64| if r.is_count { format!("{v:.0}") } else { number(v) };
        rows.row([
            r.words.clone(),
            shown(r.claimed),
            r.recomputed.map(shown).unwrap_or_default(),
            r.unit.clone(),
        ]);
    }
    if let Some(gain) = o.endless_gain() {
        rows.row(["the controller's largest gain".to_owned(), gain.to_owned()]);
    }
    if rows.is_empty() { String::new() } else { rows.text() }
}

/// Goals and bounds, so many at most: the page has all.
const MOST_TARGETS: usize = 24;

/// Goals and bounds of a fixed-order design, and what holds its optimum.
fn targets(o: &DesignOutcome) -> String {
    let all = o.target_rows();
    let many = all.iter().any(|r| !r.vehicle.is_empty());
    let kept = o.controller.is_some();
    let value = if kept { "value" } else { "least violation" };
    let mut head = vec!["<goals and bounds, of norms over what is allowed", "<", value];
    head.extend(kept.then_some("multiplier"));
    head.push("<peaks, Hz");
    if many {
        head.insert(1, "vehicle");
    }
    let mut rows = Table::new(&head);
    let left = all.len().saturating_sub(MOST_TARGETS);
    for r in all.into_iter().take(MOST_TARGETS) {
        let vehicle = many.then_some(r.vehicle);
        let multiplier = kept.then(|| number(r.multiplier));
        let cells = [r.aim.to_owned(), number(r.relative)];
        rows.row(std::iter::once(r.name).chain(vehicle).chain(cells).chain(multiplier).chain([r.peaks]));
    }
    let more = if left > 0 { format!("  and {left} more (-o has them)\n") } else { String::new() };
    if rows.is_empty() { String::new() } else { rows.text() + &more }
}

/// What a fixed-order search did.
fn search(o: &DesignOutcome) -> String {
    let mut rows = Table::new(&["<the search", ""]);
    for r in o.search_rows() {
        rows.row([r.words.to_owned(), r.value]);
    }
    if rows.is_empty() { String::new() } else { rows.text() }
}

/// Vehicles of a range, so many at most: the page has all.
const MOST_VERTICES: usize = 9;

/// Numbers of the vehicles first: their fields do not fit beside numbers.
fn vertices(o: &DesignOutcome) -> String {
    let shown = |v: Option<f64>| v.map(number).unwrap_or_default();
    let tables = o.vertex_tables();
    let Some(first) = tables.first() else { return String::new() };
    let many = first.rows.len();
    // only a gain for a range has a nominal one beside it
    let range = o.design.method == DesignMethod::RobustStateFeedback;
    let mut text = if range { "vehicles of the range\n" } else { "vehicles\n" }.to_owned();
    for (k, r) in first.rows.iter().enumerate().take(MOST_VERTICES) {
        text += &wrapped(&format!("  {}: {}", k + 1, r.place));
    }
    if many > MOST_VERTICES {
        let _ = writeln!(text, "  and {} more (-o has them)", many - MOST_VERTICES);
    }
    for t in tables {
        let unit = if t.unit.is_empty() { String::new() } else { format!(", {}", t.unit) };
        let first = format!("<{}{unit}", t.quantity);
        let head: &[&str] =
            if range { &[&first, "passive", "nominal", "robust"] } else { &[&first, "passive", "closed"] };
        let mut rows = Table::new(head);
        for (k, r) in t.rows.iter().enumerate().take(MOST_VERTICES) {
            let nominal = range.then(|| shown(r.nominal));
            let cells = [format!("  {}", k + 1), shown(r.passive)];
            rows.row(cells.into_iter().chain(nominal).chain([shown(r.robust)]));
        }
        text += &rows.text();
    }
    text
}

fn truncated(o: &DesignOutcome) -> String {
    let shown = |v: Option<f64>| v.map(number).unwrap_or_default();
    let mut rows = Table::new(&["states", "<loop", "goal", "largest gain over its bound"]);
    for r in o.truncated_rows() {
        let stable = if r.stable { "stable" } else { "not stable" };
        rows.row([r.order.to_string(), stable.to_owned(), shown(r.objective), shown(r.over_bound)]);
    }
    if rows.is_empty() { String::new() } else { rows.text() }
}

/// A gain without states.
fn gains(o: &DesignOutcome) -> String {
    let names = o.controller.as_ref().map(|k| k.outputs.clone()).unwrap_or_default();
    let mut head = vec!["<gain from", "<unit"];
    head.extend(names.iter().map(String::as_str));
    let mut rows = Table::new(&head);
    for r in o.gain_rows() {
        let values = r.values.iter().map(|v| number(*v));
        rows.row([r.name.to_owned(), r.unit.clone()].into_iter().chain(values));
    }
    if rows.is_empty() { String::new() } else { rows.text() }
}

/// One number changed by itself, by kinds of numbers; and an actuator in the loop.
fn robustness(o: &DesignOutcome) -> String {
    let Some(all) = &o.robustness else { return String::new() };
    let mut text = String::new();
    let rows = o.robustness_rows();
    if !rows.is_empty() {
        text += &format!("one number by ±{:.0} %: the loop, and the goal at worst\n", 100.0 * all.share);
    }
    for r in rows {
        let goal =
            r.goal.map(|g| format!(", {} %", washboard::units::signed(100.0 * g, 1))).unwrap_or_default();
        let worst = if r.worst.is_empty() { String::new() } else { format!(" ({})", r.worst) };
        text += &wrapped(&format!("{}, {} looked at: {}{goal}{worst}", r.what, r.count, r.stable_words()));
    }
    let rows = o.actuator_rows();
    if !rows.is_empty() {
        text += if text.is_empty() { "with an actuator\n" } else { "\nwith an actuator\n" };
    }
    rows.into_iter().for_each(|(what, answer)| text += &wrapped(&format!("{what}: {answer}")));
    text
}
