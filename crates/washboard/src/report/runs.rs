//! Several recordings: the poles of each over speed, beside what all of them share.

use super::Plots;
use super::fit::chi_text;
use super::html::{Html, classed, element, note, paragraph, table};
use super::numbers::{FACTOR_95, fixed, plain, with_sd, with_sd_in};
use super::plot::{Axis, Line, Plot, Role, Series};
use super::road::one_sided;
use crate::study::{IdentifiedMode, IdentifyOutcome, RunSummary};

/// Speeds that differ by less than this share are one speed.
const SAME_SPEED: f64 = 0.02;
/// Room beyond the first and last run, as a share of their distance.
const ROOM: f64 = 0.1;
/// Neighbours further apart than this ratio of frequencies have their own plots: body and wheels.
const APART: f64 = 1.7;

/// What the poles are drawn against.
struct Along {
    name: &'static str,
    unit: &'static str,
    log: bool,
    /// One a run.
    values: Vec<Option<f64>>,
}

/// Poles against speed, and the table of the runs.
pub(super) fn runs(outcome: &IdentifyOutcome, plots: &mut Plots) -> Option<Html> {
    if outcome.runs.is_empty() {
        return None;
    }
    let along = along(&outcome.runs);
    let drawn = along.values.iter().flatten().count();
    let mut body = paragraph(words(outcome, &along, drawn));
    let frequency = |m: &IdentifiedMode| (m.freq_hz, m.freq_sd_hz);
    let damping = |m: &IdentifiedMode| (100.0 * m.damping, m.damping_sd.map(|s| 100.0 * s));
    let grid: Html = groups(outcome)
        .iter()
        .flat_map(|labels| {
            [
                pole_map(outcome, &along, labels, Axis::new("frequency", "Hz", false), &frequency),
                pole_map(outcome, &along, labels, Axis::new("damping ratio", "%", false), &damping),
            ]
        })
        .flatten()
        .map(|plot| plots.add(plot))
        .collect();
    if grid != Html::default() {
        body.push(classed("div", "grid", grid));
        body.push(note(
            "Points: each recording’s own modes with 95 % intervals, one sign and colour a motion; those of one recording \
             stand side by side. Dashed lines of the same colour: the result above. A click on a motion below a plot \
             hides or shows it.",
        ));
    }
    body.push(run_table(&outcome.runs));
    body.push(flags(&outcome.runs));
    Some(body)
}

/// Speed; where all speeds are equal, roughness; where neither tells the runs apart, their order.
fn along(runs: &[RunSummary]) -> Along {
    let speeds: Vec<Option<f64>> = runs.iter().map(|r| r.speed_m_s.filter(|v| v.is_finite())).collect();
    let (low, high) = ends(&speeds);
    if high > low * (1.0 + SAME_SPEED) {
        return Along { name: "speed", unit: "m/s", log: false, values: speeds };
    }
    let roads = runs
        .iter()
        .map(|r| r.road.as_ref().map(|r| 1e6 * one_sided(r).0).filter(|s| s.is_finite() && *s > 0.0));
    let roads: Vec<Option<f64>> = roads.collect();
    let (low, high) = ends(&roads);
    if high > low {
        return Along { name: "roughness", unit: "10⁻⁶ m³", log: true, values: roads };
    }
    let order = (1..=runs.len()).map(|k| Some(k as f64)).collect();
    Along { name: "recording", unit: "", log: false, values: order }
}

fn ends(values: &[Option<f64>]) -> (f64, f64) {
    values.iter().flatten().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)))
}

fn words(outcome: &IdentifyOutcome, along: &Along, drawn: usize) -> String {
    let n = outcome.runs.len();
    let converged = outcome.runs.iter().filter(|r| r.converged).count();
    let recordings = if n == 1 { "1 recording".to_owned() } else { format!("{n} recordings") };
    let all = if converged == n { "all converged".to_owned() } else { format!("{converged} converged") };
    let over = match along.name {
        "speed" => String::new(),
        "roughness" => {
            " They were driven at one speed: poles are drawn over the roughness of their roads.".to_owned()
        }
        _ => " Neither speeds nor roads tell them apart: poles are drawn in the order of the recordings."
            .to_owned(),
    };
    let missing = if drawn < n {
        format!(" {} without a {} are not drawn.", n - drawn, along.name)
    } else {
        String::new()
    };
    format!("{recordings} by themselves, of which {all}.{over}{missing}")
}

type Of<'a> = &'a dyn Fn(&IdentifiedMode) -> (f64, Option<f64>);

/// The labels of all modes, those of neighbouring frequencies together.
fn groups(outcome: &IdentifyOutcome) -> Vec<Vec<&str>> {
    let mut labels: Vec<(f64, &str)> = Vec::new();
    for mode in outcome.modes.iter().chain(outcome.runs.iter().flat_map(|r| &r.modes)) {
        if mode.freq_hz.is_finite() && !labels.iter().any(|(_, l)| *l == mode.label) {
            labels.push((mode.freq_hz, &mode.label));
        }
    }
    labels.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut groups: Vec<Vec<&str>> = Vec::new();
    let mut before = 0.0;
    for (freq_hz, label) in labels {
        match groups.last_mut() {
            Some(group) if freq_hz <= APART * before => group.push(label),
            _ => groups.push(vec![label]),
        }
        before = freq_hz;
    }
    groups
}

/// One curve of points a label, one line a shared mode.
fn pole_map(outcome: &IdentifyOutcome, along: &Along, labels: &[&str], y_axis: Axis, of: Of) -> Option<Plot> {
    let mut runs: Vec<(f64, &RunSummary)> =
        along.values.iter().zip(&outcome.runs).filter_map(|(x, r)| x.map(|x| (x, r))).collect();
    runs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (low, high) = (runs.first()?.0, runs.last()?.0);
    let [left, right] = if along.log {
        let room = (high / low).powf(ROOM);
        [low / room, high * room]
    } else {
        let room = ROOM * (high - low).max(0.1 * high.abs());
        [low - room, high + room]
    };
    let x: Vec<f64> = runs.iter().map(|(x, _)| *x).collect();
    let x_axis = Axis::new(along.name, along.unit, along.log).within(left, right);
    let title = if y_axis.unit == "Hz" { "Frequency" } else { "Damping" };
    let title = match labels {
        [one] => format!("{title} over {}: {one}", along.name),
        [first, .., last] => format!("{title} over {}: {first} to {last}", along.name),
        [] => return None,
    };
    let mut plot = Plot::new(title, &x, x_axis, y_axis);
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    let mut reach = |value: f64, error: f64| {
        if value.is_finite() {
            (least, most) = (least.min(value - error), most.max(value + error));
        }
    };
    for (sign, label) in labels.iter().enumerate() {
        let found: Vec<Option<(f64, Option<f64>)>> =
            runs.iter().map(|(_, r)| r.modes.iter().find(|m| m.label == *label).map(of)).collect();
        let error: Vec<Option<f64>> = found
            .iter()
            .map(|v| v.and_then(|(_, sd)| sd).filter(|s| s.is_finite()).map(|s| FACTOR_95 * s))
            .collect();
        for (v, e) in found.iter().zip(&error) {
            v.iter().for_each(|(v, _)| reach(*v, e.unwrap_or(0.0)));
        }
        let y = found.iter().map(|v| v.map(|(v, _)| v)).collect();
        plot.push(Series {
            label: (*label).to_owned(),
            role: Role::Estimates,
            y,
            error,
            sign,
            ..Series::default()
        });
        if let Some(shared) =
            outcome.modes.iter().find(|m| m.label == *label).map(|m| of(m).0).filter(|v| v.is_finite())
        {
            reach(shared, 0.0);
            let mut line = Line::new([left, right], [shared; 2], "");
            line.sign = Some(sign);
            plot.lines.push(line);
        }
    }
    let room = 0.05 * (most - least).max(0.02 * most.abs());
    plot.y_axis = plot.y_axis.within(least - room, most + room);
    (!plot.series.is_empty()).then_some(plot)
}

fn run_table(runs: &[RunSummary]) -> Html {
    let has_road = runs.iter().any(|r| r.road.is_some());
    let has_mu = runs.iter().any(|r| r.coherence.is_some());
    let has_delay = runs.iter().any(|r| r.delay_s.is_some());
    let none = || Html::from("–");
    let rows = runs.iter().map(|r| {
        let mut row: Vec<Html> = vec![
            r.name.as_str().into(),
            r.speed_m_s.map_or_else(none, |v| plain(v).into()),
            plain(r.duration_s).into(),
            if r.converged { "yes".into() } else { element("strong", &[], "no") },
            r.chi.map_or_else(none, |c| chi_text(c).into()),
            r.modes.len().to_string().into(),
        ];
        if has_road {
            let road = r.road.as_ref();
            row.push(road.map_or_else(none, |r| format!("{:?}", r.class).into()));
            row.push(road.map_or_else(none, |r| {
                let (s0, sd) = one_sided(r);
                with_sd_in(s0, sd, -6).into()
            }));
            row.push(road.map_or_else(none, |r| with_sd(r.exponent, Some(r.exponent_sd)).into()));
        }
        if has_mu {
            row.push(r.coherence.as_ref().map_or_else(none, |c| with_sd(c.mu, Some(c.mu_sd)).into()));
        }
        if has_delay {
            row.push(r.delay_s.map_or_else(none, |d| fixed(1e3 * d, 2).into()));
        }
        row
    });
    let mut heads = vec!["recording", "# speed, m/s", "# length, s", "converged", "# χ", "# modes"];
    if has_road {
        heads.extend(["class", "# S₀, m³", "# exponent"]);
    }
    heads.extend(has_mu.then_some("# μ"));
    heads.extend(has_delay.then_some("# delay, ms"));
    table("The recordings", &heads, rows.collect())
}

/// The flags of each run, in its words.
fn flags(runs: &[RunSummary]) -> Html {
    let items: Html = runs
        .iter()
        .flat_map(|r| {
            r.flags.iter().map(|f| {
                let name = element("code", &[], f.name.as_str());
                element("li", &[], Html::from(format!("{}: {} ", r.name, f.text)).and(name))
            })
        })
        .collect();
    if items == Html::default() {
        return items;
    }
    element("h3", &[], "Flags of single recordings").and(classed("ul", "flags", items))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::Flag;

    fn run(speed_m_s: Option<f64>, freq_hz: f64) -> RunSummary {
        let mode = IdentifiedMode {
            freq_hz,
            freq_sd_hz: Some(0.1),
            damping: 0.3,
            label: "heave".into(),
            ..IdentifiedMode::default()
        };
        RunSummary {
            name: "a<b".into(),
            speed_m_s,
            duration_s: 600.0,
            converged: speed_m_s.is_some(),
            flags: vec![Flag { name: "misfit".into(), text: "in words".into() }],
            modes: vec![mode],
            road: None,
            coherence: None,
            delay_s: None,
            chi: Some(0.41),
        }
    }

    #[test]
    fn poles_stand_at_their_speeds_with_their_intervals() {
        let runs_of = vec![run(Some(30.0), 1.2), run(Some(10.0), 1.0), run(None, 9.0)];
        let modes = vec![runs_of[0].modes[0].clone()];
        let outcome = IdentifyOutcome { runs: runs_of, modes, ..IdentifyOutcome::default() };
        let mut plots = Plots::default();
        let html = runs(&outcome, &mut plots).unwrap();
        let plot = &plots.0[0];
        assert_eq!((&plot.x, &plot.series[0].y), (&vec![10.0, 30.0], &vec![Some(1.0), Some(1.2)]));
        assert_eq!(plot.series[0].error, [Some(0.196), Some(0.196)]);
        assert_eq!((plot.lines[0].y, plot.lines[0].sign), ([1.2; 2], Some(0)));
        assert!(plots.0[1].series[0].error.iter().all(Option::is_none), "damping has no deviation");
        let text = html.as_str();
        assert!(text.contains("of which 2 converged. 1 without a speed are not drawn."), "{text}");
        assert!(text.contains("a&lt;b: in words <code>misfit</code>"), "{text}");
    }

    #[test]
    fn equal_speeds_are_told_apart_by_their_order_where_there_are_no_roads() {
        let same = along(&[run(Some(20.0), 1.0), run(Some(20.1), 1.0)]);
        assert_eq!((same.name, same.values), ("recording", vec![Some(1.0), Some(2.0)]));
        assert_eq!(along(&[run(Some(20.0), 1.0), run(Some(21.0), 1.0)]).name, "speed");
    }
}
