//! The page of a sweep: what trades against what, and the point that is chosen.

use super::html::{Html, classed, element, note, paragraph};
use super::numbers::{plain, signed, significant};
use super::page::{Page, Section};
use super::plot::Plots;
use super::sweep_chart::{Chart, Dot, Stroke};
use super::sweep_detail::chosen;
use super::sweep_keys::{compared, key_label};
use super::sweep_parallel::{parallel, parallel_metrics};
use crate::study::{SweepDetail, SweepOutcome, SweepPoint, non_dominated};
use serde_json::Value;

/// Colours of the first and the last of several rows.
const FIRST: [f64; 3] = [11.0, 80.0, 119.0];
const LAST: [f64; 3] = [201.0, 120.0, 0.0];
/// Names of a legend.
const MOST_NAMES: usize = 8;

/// The page of a sweep, from its outcome and its points alone: offline, and the same bytes for the same points.
#[must_use]
pub fn sweep_page(outcome: &SweepOutcome, details: &[SweepDetail], title: &str) -> String {
    let trade = outcome.trade_offs();
    let front = fronts(outcome, &trade);
    let mut sections = Vec::new();
    let mut add = |id, heading, body: Option<Html>| {
        sections.extend(body.map(|body| Section { id, heading, body }));
    };
    add("pareto", "What trades against what", pareto(outcome, &trade, &front));
    add("axis", "Along the grid", along(outcome, &trade));
    add("all", "All points", all_points(outcome, &front));
    add("point", "The point that is chosen", Some(chosen(outcome, details)));
    add("table", "Points", Some(table(outcome, &trade, &front)));
    let foot = note(
        "Made by washboard from result.json and points/ alone. rms are of the road's part, over the passive ones of the same \
         vehicle; goals are as `design` has them. Plots of gains by uPlot, © Leon Sorokin, MIT licence.",
    );
    let top = headline(outcome, &trade, &front);
    Page { title, subtitle: subtitle(outcome), top, sections, foot, plots: Plots::default() }.write()
}

/// A value of the grid as people write it.
pub(super) fn value_text(value: &Value) -> String {
    match value {
        Value::Number(n) => n.as_f64().map(plain).unwrap_or_default(),
        Value::String(s) => s.clone(),
        Value::Array(list) => list.iter().map(value_text).collect::<Vec<_>>().join(", "),
        other => other.to_string(),
    }
}

/// Where a point is, in words.
pub(super) fn place_text(o: &SweepOutcome, p: &SweepPoint) -> String {
    let one = |key: &str| format!("{key} = {}", p.at.get(key).map(value_text).unwrap_or_default());
    o.grid.iter().map(|a| one(&a.key)).collect::<Vec<_>>().join(", ")
}

/// Which points none beats in all of the outputs.
fn fronts(o: &SweepOutcome, names: &[&str]) -> Vec<bool> {
    let row = |p: &SweepPoint| -> Vec<f64> {
        names.iter().map(|n| p.rms_relative.get(n).copied().unwrap_or(f64::NAN)).collect()
    };
    if names.is_empty() {
        return vec![false; o.points.len()];
    }
    non_dominated(&o.points.iter().map(row).collect::<Vec<_>>())
}

fn subtitle(o: &SweepOutcome) -> Html {
    let axis = |a: &crate::study::SweepAxis| {
        let ends = [a.values.first(), a.values.last()].map(|v| v.map(value_text).unwrap_or_default());
        let numbers = a.values.len() > 2 && a.values.iter().all(Value::is_number);
        let values = if numbers {
            format!("{} to {} in {} values", ends[0], ends[1], a.values.len())
        } else {
            a.values.iter().map(value_text).collect::<Vec<_>>().join(" | ")
        };
        paragraph(format!("{}: {values}", a.key))
    };
    o.grid.iter().map(axis).collect()
}

fn headline(o: &SweepOutcome, names: &[&str], front: &[bool]) -> Html {
    let good = o.points.iter().filter(|p| p.status.is_good()).count();
    let class = match good {
        0 => "failed",
        n if n == o.points.len() => "passed",
        _ => "warned",
    };
    let counts: Vec<String> = o.counts.iter().map(|(name, n)| format!("{n} {name}")).collect();
    let verdict = format!("{} points: {}", o.points.len(), counts.join(", "));
    let mut inside = element("h2", &[], verdict);
    let best = front.iter().filter(|f| **f).count();
    if names.len() > 1 && best > 0 {
        let words = format!("{best} of them are beaten by no other in all of {}", names.join(", "));
        inside = inside.and(classed("p", "finding", words));
    }
    let better = |p: &&SweepPoint| names.iter().all(|n| p.rms_relative.get(n).is_some_and(|r| *r < 1.0));
    if !names.is_empty() {
        let n = o.points.iter().filter(better).count();
        let are = if n == 1 { "is" } else { "are" };
        inside = inside.and(paragraph(format!("{n} {are} better than the passive vehicle in all of these.")));
    }
    inside = inside.and(compared(o).map(paragraph).unwrap_or_default());
    element("section", &[("class", &format!("verdict {class}")), ("id", "result")], inside)
}

/// Each pair of comfort, travel and tire load; what no point beats in a pair is joined.
fn pareto(o: &SweepOutcome, names: &[&str], front: &[bool]) -> Option<Html> {
    let mut grid = Html::default();
    for (i, a) in names.iter().enumerate() {
        for b in &names[i + 1..] {
            let pair = fronts(o, &[*a, *b]);
            let place = |p: &SweepPoint| Some([*p.rms_relative.get(a)?, *p.rms_relative.get(b)?]);
            let dot = |(k, p): (usize, &SweepPoint)| {
                let [x, y] = place(p)?;
                let title = format!("point {}: {}\n{a} {x:.3}, {b} {y:.3}", p.index, place_text(o, p));
                Some(Dot { index: p.index, x, y, front: front[k], title })
            };
            let mut edge: Vec<[f64; 2]> =
                o.points.iter().zip(&pair).filter(|(_, f)| **f).filter_map(|(p, _)| place(p)).collect();
            edge.sort_by(|p, q| p[0].total_cmp(&q[0]).then(q[1].total_cmp(&p[1])));
            let chart = Chart {
                title: format!("{a} against {b}"),
                x_label: format!("rms of {a} over passive"),
                y_label: format!("rms of {b} over passive"),
                dots: o.points.iter().enumerate().filter_map(dot).collect(),
                strokes: vec![Stroke { class: "edge", label: "", colour: String::new(), points: edge }],
                passive: [Some(1.0), Some(1.0)],
            };
            grid.push(chart.draw().unwrap_or_default());
        }
    }
    let passive =
        if compared(o).is_some() { "each point's own passive vehicle" } else { "the passive vehicle" };
    let remark = note(format!(
        "Smaller is better. The line joins points that no other beats in both; dark dots are beaten by none in all outputs \
         shown. Dashed: {passive}. Orange: the point that is chosen, which is the first of the dark ones until you click a dot, a \
         line or a row."
    ));
    (grid != Html::default()).then(|| classed("div", "grid", grid).and(remark))
}

/// The goal and the outputs along the last axis of numbers, a line for each place on the others.
fn along(o: &SweepOutcome, names: &[&str]) -> Option<Html> {
    let axis = o.grid.iter().rev().find(|a| a.values.len() > 1 && a.values.iter().all(Value::is_number))?;
    let mut rows: Vec<(String, Vec<&SweepPoint>)> = Vec::new();
    for p in &o.points {
        let others: Vec<String> = o
            .grid
            .iter()
            .filter(|a| a.key != axis.key)
            .map(|a| format!("{} = {}", a.key, p.at.get(&a.key).map(value_text).unwrap_or_default()))
            .collect();
        let others = others.join(", ");
        match rows.iter_mut().find(|(name, _)| *name == others) {
            Some((_, row)) => row.push(p),
            None => rows.push((others, vec![p])),
        }
    }
    let x = |p: &SweepPoint| p.at.get(&axis.key).and_then(Value::as_f64);
    type Take<'a> = Box<dyn Fn(&SweepPoint) -> Option<f64> + 'a>;
    let chart = |title: String,
                 label: String,
                 of: Take<'_>,
                 beside: Vec<(&'static str, &'static str, Take<'_>)>,
                 passive: Option<f64>| {
        let mut strokes = Vec::new();
        for (class, label, take) in beside.iter().map(|(c, l, t)| (*c, *l, t)).chain([("row", "", &of)]) {
            for (k, (_, row)) in rows.iter().enumerate() {
                let mut points: Vec<[f64; 2]> = row.iter().filter_map(|p| Some([x(p)?, take(p)?])).collect();
                points.sort_by(|a, b| a[0].total_cmp(&b[0]));
                if points.len() > 1 {
                    let colour = if class == "row" { shade(k, rows.len()) } else { String::new() };
                    strokes.push(Stroke { class, label, colour, points });
                }
            }
        }
        // equal lines of several rows once, and one name for all of a kind
        strokes.dedup();
        for k in 1..strokes.len() {
            if strokes[..k].iter().any(|s| s.class == strokes[k].class && s.label == strokes[k].label) {
                strokes[k].label = "";
            }
        }
        let dot = |p: &SweepPoint| {
            let (x, y) = (x(p)?, of(p)?);
            let title = format!("point {}: {}\n{y:.5}", p.index, place_text(o, p));
            Some(Dot { index: p.index, x, y, front: true, title })
        };
        let dots = o.points.iter().filter_map(dot).collect();
        Chart {
            title,
            x_label: key_label(&axis.key),
            y_label: label,
            dots,
            strokes,
            passive: [None, passive],
        }
        .draw()
    };
    let goal = |name: &'static str| -> Take<'_> { Box::new(move |p| p.objective.get(name).copied()) };
    let value: Take<'_> =
        Box::new(|p| ["verified", "limit"].iter().find_map(|n| p.objective.get(n)).copied());
    let proven: Take<'_> = Box::new(|p| p.lower_bound);
    let beside = vec![
        ("passive", "passive", goal("passive")),
        ("limit", "limit", goal("limit")),
        ("limit", "lower bound", proven),
    ];
    let mut grid = chart("The goal".into(), "goal".into(), value, beside, None).unwrap_or_default();
    for name in names {
        let of: Take<'_> = Box::new(move |p| p.rms_relative.get(name).copied());
        grid.push(
            chart((*name).to_owned(), "rms over passive".into(), of, Vec::new(), Some(1.0))
                .unwrap_or_default(),
        );
    }
    let mut words = vec!["Dashed: the passive vehicle.".to_owned()];
    if o.points.iter().any(|p| p.objective.get("limit").is_some() || p.lower_bound.is_some()) {
        words.push("Green: what no controller goes below.".to_owned());
    }
    words.extend(goal_words(o));
    let words = words.join(" ");
    let names: Vec<&str> = rows.iter().map(|(name, _)| name.as_str()).collect();
    (grid != Html::default()).then(|| legend(&names).and(classed("div", "grid", grid)).and(note(words)))
}

/// What the goal is; nothing where no point says it.
fn goal_words(o: &SweepOutcome) -> Option<String> {
    let words = o.goal.as_ref()?;
    Some(format!("The goal: {words}; norms are over the passive ones, so that it has no unit."))
}

/// The colour of a row of so many, from the first to the last.
fn shade(k: usize, of: usize) -> String {
    if of < 2 {
        return String::new();
    }
    let t = k as f64 / (of - 1) as f64;
    let [r, g, b] = [0, 1, 2].map(|c| (FIRST[c] + t * (LAST[c] - FIRST[c])).round());
    format!("rgb({r}, {g}, {b})")
}

/// What the lines are of; of many rows some, evenly.
fn legend(names: &[&str]) -> Html {
    let n = names.len();
    if n < 2 {
        return Html::default();
    }
    let shown: Vec<usize> = if n <= MOST_NAMES {
        (0..n).collect()
    } else {
        (0..MOST_NAMES).map(|i| i * (n - 1) / (MOST_NAMES - 1)).collect()
    };
    let entry = |k: &usize| {
        let bar = element("rect", &[("width", "16"), ("height", "4"), ("fill", &shade(*k, n))], "");
        let mark = element("svg", &[("class", "key"), ("viewBox", "0 0 16 4"), ("aria-hidden", "true")], bar);
        classed("span", "entry", mark.and(names[*k]).and("\u{2003}"))
    };
    let rest = if shown.len() < n { "the others between them" } else { "" };
    let inside = Html::from("Lines: ").and(shown.iter().map(entry).collect::<Html>()).and(rest);
    classed("p", "legend", inside)
}

fn all_points(o: &SweepOutcome, front: &[bool]) -> Option<Html> {
    let words = "Each line is a point; rms are over the passive ones. Dark lines are points that none beats.";
    let metrics = parallel_metrics(o, front).map(|m| {
        let summary = element("summary", &[], "Metrics: the loop’s, in their units");
        element("details", &[], summary.and(classed("div", "scroll", m)))
    });
    Some(classed("div", "scroll", parallel(o, front)?).and(note(words)).and(metrics.unwrap_or_default()))
}

/// A row a point; the files have every number.
fn table(o: &SweepOutcome, names: &[&str], front: &[bool]) -> Html {
    let mut heads = vec!["#point".to_owned()];
    heads.extend(
        o.grid.iter().map(|a| {
            if a.values.iter().all(Value::is_number) { format!("#{}", a.key) } else { a.key.clone() }
        }),
    );
    heads.extend(["status".to_owned(), "#goal".to_owned()]);
    let bounded = o.points.iter().any(|p| p.lower_bound.is_some());
    heads.extend(bounded.then(|| "#none below".to_owned()));
    heads.push("#order".to_owned());
    heads.extend(names.iter().map(|n| format!("#{n} rms, %")));
    let metrics = o.metric_names();
    heads.extend(metrics.iter().map(|n| format!("#{}", n.replace('_', " "))));
    heads.push("warnings, or why there is no controller".to_owned());
    let head = heads.iter().map(|h| {
        let class = if h.starts_with('#') { "number" } else { "" };
        classed_head(class, h.trim_start_matches('#'))
    });
    let row = |(k, p): (usize, &SweepPoint)| {
        let goal = ["verified", "limit"].iter().find_map(|n| p.objective.get(n)).copied();
        let mut cells: Vec<String> = vec![p.index.to_string()];
        cells.extend(o.grid.iter().map(|a| p.at.get(&a.key).map(value_text).unwrap_or_default()));
        cells.push(p.status.name().to_owned());
        cells.push(goal.map(|v| significant(v, 4)).unwrap_or_default());
        cells.extend(bounded.then(|| p.lower_bound.map(|v| significant(v, 4)).unwrap_or_default()));
        cells.push(p.order.map(|n| n.to_string()).unwrap_or_default());
        let change =
            |n: &&str| p.rms_relative.get(n).map(|r| signed(100.0 * (r - 1.0), 1)).unwrap_or_default();
        cells.extend(names.iter().map(change));
        let metric = |n: &&str| p.metrics.get(n).map(|v| significant(*v, 4)).unwrap_or_default();
        cells.extend(metrics.iter().map(metric));
        cells.push(p.why.clone().unwrap_or_else(|| p.warnings.join(", ")));
        let cells: Html = cells
            .into_iter()
            .zip(&heads)
            .map(|(cell, h)| classed("td", if h.starts_with('#') { "number" } else { "" }, cell))
            .collect();
        let class = if front[k] { "leads front" } else { "leads" };
        element("tr", &[("class", class), ("tabindex", "0"), ("data-point", &p.index.to_string())], cells)
    };
    let body = o.points.iter().enumerate().map(row).collect::<Html>();
    let head = element("thead", &[], element("tr", &[], head.collect::<Html>()));
    let inside = classed("table", "points", head.and(element("tbody", &[], body)));
    let all = if names.is_empty() { String::new() } else { format!(" in all of {}", names.join(", ")) };
    let empty = if metrics.is_empty() {
        ""
    } else {
        " Metrics are the loop's, in SI units; an empty cell is infinite, or has not settled."
    };
    let proven =
        if bounded { " None below: what no controller of any order goes below, of the goal." } else { "" };
    let words = format!(
        "Bold: on the Pareto front, beaten by no other point{all}. rms are changes to the passive vehicle's.{empty}{proven} table.csv has every \
         output, points/ every design."
    );
    classed("div", "scroll", inside).and(note(words))
}

fn classed_head(class: &str, title: &str) -> Html {
    let mut attributes = vec![("scope", "col")];
    if !class.is_empty() {
        attributes.push(("class", class));
    }
    // long keys may be broken behind a dot or a dash
    let pieces = title.split_inclusive(['.', '_']).map(Html::from);
    let inside = pieces.reduce(|all, piece| all.and(Html::own("<wbr>")).and(piece)).unwrap_or_default();
    element("th", &attributes, inside)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::fixture::NASTY;
    use crate::study::{Gains, Named, SweepAxis, SweepStatus};

    fn point(index: usize, at: Value, rms: Option<[f64; 3]>) -> SweepPoint {
        let names = ["sprung_acceleration", "suspension_travel", "tire_deflection"];
        let pairs = rms.map(|r| names.iter().zip(r).map(|(n, v)| ((*n).to_owned(), v)).collect());
        let relative: Named<f64> = pairs.unwrap_or_default();
        SweepPoint {
            index,
            at: [(NASTY.to_owned(), at)].into_iter().collect(),
            status: if rms.is_some() { SweepStatus::Designed } else { SweepStatus::Stalled },
            why: rms.is_none().then(|| NASTY.to_owned()),
            order: rms.map(|_| 2),
            objective: rms.iter().map(|r| ("verified".to_owned(), r.iter().sum())).collect(),
            rms: relative.iter().map(|(n, v)| (n.to_owned(), crate::study::Rms::Finite(*v))).collect(),
            rms_relative: relative,
            h2: Named::default(),
            h2_relative: Named::default(),
            hinf: Named::default(),
            hinf_relative: Named::default(),
            metrics: Named::default(),
            warnings: vec![NASTY.to_owned()],
            lower_bound: None,
            controller: rms.map(|_| NASTY.to_owned()),
        }
    }

    fn outcome() -> SweepOutcome {
        let values = vec![Value::from(1.0), Value::from(2.0), Value::from(3.0), Value::from(4.0)];
        let rms = [Some([0.5, 0.9, 0.8]), Some([0.6, 0.8, 1.2]), Some([0.7, 0.9, 1.3]), None];
        let points = values.iter().zip(rms).enumerate().map(|(k, (at, r))| point(k, at.clone(), r)).collect();
        SweepOutcome {
            grid: vec![SweepAxis { key: NASTY.into(), values }],
            warm_start: false,
            goal: None,
            counts: [("designed".to_owned(), 3), ("stalled".to_owned(), 1)].into_iter().collect(),
            missing: Vec::new(),
            points,
        }
    }

    #[test]
    fn no_name_becomes_markup_and_every_point_is_everywhere() {
        let detail = SweepDetail {
            index: 1,
            controller_poles: vec![[-1.0, 2.0], [-1.0, -2.0]],
            loop_poles: vec![[-3.0, 0.0]],
            units: Named::default(),
            per: NASTY.into(),
            gains: Gains::default(),
        };
        let page = sweep_page(&outcome(), &[detail], NASTY);
        assert!(!page.contains("<img") && page.contains("&lt;img"));
        assert!(page.contains("-1.000 ± 2.000i") || page.contains("−1.000 ± 2.000i"), "a pair of poles once");
        // three trade-offs, the goal and three outputs along the grid, all points, and the table
        assert_eq!(page.matches("data-point=\"0\"").count(), 3 + 4 + 1 + 1);
        // a point without a loop is in the table and among all points
        assert_eq!(page.matches("data-point=\"3\"").count(), 2);
        assert!(page.contains("1 is better than the passive vehicle in all"));
        assert!(page.contains("2 of them are beaten by no other"), "point 2 is beaten by point 1");
    }
    /// Two axes, the first of the vehicle.
    fn plane() -> SweepOutcome {
        let mut o = outcome();
        let keys = ["override.tire_damping_n_s_per_m", "goal.order"];
        for (k, p) in o.points.iter_mut().enumerate() {
            p.at =
                keys.iter().zip([k / 2, k % 2]).map(|(key, v)| ((*key).to_owned(), Value::from(v))).collect();
        }
        let axis =
            |key: &&str| SweepAxis { key: (*key).to_owned(), values: vec![Value::from(0), Value::from(1)] };
        o.grid = keys.iter().map(axis).collect();
        o
    }

    #[test]
    fn colours_are_attributes_as_the_policy_forbids_styles() {
        let page = sweep_page(&plane(), &[], "s");
        assert!(page.contains(" stroke=\"rgb(") && page.contains(" fill=\"rgb("));
        assert!(!page.contains(" style=\""));
    }

    #[test]
    fn what_points_are_compared_with_and_what_the_goal_is_are_said() {
        let mut o = plane();
        let page = sweep_page(&o, &[], "s");
        assert!(page.contains("override.tire_damping_n_s_per_m changes it"));
        assert!(page.contains("override.<wbr>tire_<wbr>damping_<wbr>n_"));
        // nothing is green, and no goal is known
        assert!(!page.contains("Green:") && !page.contains("The goal:") && !page.contains("none below"));
        o.goal = Some("largest of the weighted peak gains".into());
        o.points[0].lower_bound = Some(0.42);
        o.points[1].lower_bound = Some(0.41);
        let page = sweep_page(&o, &[], "s");
        assert!(page.contains("Green:") && page.contains("The goal: largest of the weighted peak gains;"));
        assert!(
            page.contains("none below") && page.contains(">0.4200<") && page.contains(">lower bound</text>")
        );
        assert!(!sweep_page(&outcome(), &[], "s").contains("own passive"));
    }
}
