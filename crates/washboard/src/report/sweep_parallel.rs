//! All points of a sweep as lines across parallel axes: the grid, the goal, and what became of every kind of response.

use super::html::{Html, element};
use super::numbers::plain;
use super::scene::coordinate;
use super::sweep::value_text;
use super::sweep_chart::{Scale, joined, line, text};
use super::sweep_keys::key_label;
use crate::study::{SweepOutcome, SweepPoint};
use serde_json::Value;

const HEIGHT: f64 = 300.0;
const TOP: f64 = 46.0;
const BOTTOM: f64 = 282.0;
/// Between two axes.
const STEP: f64 = 118.0;
const LEFT: f64 = 62.0;
/// Letters of a name beside an axis, and the width of one.
const LETTERS: usize = 15;
const LETTER: f64 = 6.2;

/// One axis.
struct Coordinate {
    /// In up to two lines.
    head: [String; 2],
    scale: Scale,
    /// Names at places, of an axis without numbers.
    names: Vec<String>,
    /// Of each point.
    values: Vec<Option<f64>>,
    /// The passive vehicle's.
    passive: Option<f64>,
    /// Of the values that none can beat.
    limit: Option<f64>,
}

fn coordinate_of(
    head: [String; 2],
    values: Vec<Option<f64>>,
    passive: Option<f64>,
    limit: Option<f64>,
) -> Option<Coordinate> {
    let all: Vec<f64> = values.iter().flatten().copied().chain(passive).chain(limit).collect();
    values.iter().any(Option::is_some).then_some(())?;
    let scale = Scale::new(all.into_iter(), BOTTOM, TOP)?;
    Some(Coordinate { head, scale, names: Vec::new(), values, passive, limit })
}

/// The plot; none where fewer than two axes have values.
pub(super) fn parallel(o: &SweepOutcome, front: &[bool]) -> Option<Html> {
    let mut axes: Vec<Coordinate> = o.grid.iter().filter_map(|a| grid_axis(o, &a.key, &a.values)).collect();
    let goal = |name: &'static str| move |p: &SweepPoint| p.objective.get(name).copied();
    let objective: Vec<Option<f64>> = o.points.iter().map(goal("verified")).collect();
    // one line for all: only where it is the same for all
    let same = |name: &'static str| {
        let all: Vec<f64> = o.points.iter().filter_map(goal(name)).collect();
        all.first().copied().filter(|first| all.iter().all(|v| v == first))
    };
    axes.extend(coordinate_of(["goal".into(), String::new()], objective, same("passive"), same("limit")));
    for name in shown(o) {
        let rms = o.points.iter().map(|p| p.rms_relative.get(name).copied()).collect();
        axes.extend(coordinate_of(head(name), rms, Some(1.0), None));
    }
    let orders: Vec<Option<f64>> = o.points.iter().map(|p| p.order.map(|n| n as f64)).collect();
    let asked = o.grid.iter().any(|a| a.key == "goal.order");
    if !asked && orders.iter().flatten().any(|n| Some(*n) != orders.iter().flatten().next().copied()) {
        axes.extend(coordinate_of(["order".into(), String::new()], orders, None, None));
    }
    (axes.len() > 1).then(|| draw(o, &axes, front))
}

/// The same of metrics, each in its unit; none without.
pub(super) fn parallel_metrics(o: &SweepOutcome, front: &[bool]) -> Option<Html> {
    let mut axes: Vec<Coordinate> = o.grid.iter().filter_map(|a| grid_axis(o, &a.key, &a.values)).collect();
    let grid = axes.len();
    for name in o.metric_names() {
        let values = o.points.iter().map(|p| p.metrics.get(name).copied()).collect();
        axes.extend(coordinate_of(halves(&name.replace('_', " ")), values, None, None));
    }
    (grid > 0 && axes.len() > grid).then(|| draw(o, &axes, front))
}

/// Whole vectors and single outputs with an rms over the passive one; no corners.
fn shown(o: &SweepOutcome) -> Vec<&str> {
    let names = o.outputs();
    let is_corner = |name: &str| {
        names.iter().any(|base| name.strip_prefix(base).is_some_and(|rest| rest.starts_with('_')))
    };
    let known = |name: &&str| o.points.iter().any(|p| p.rms_relative.get(name).is_some());
    names.iter().copied().filter(|n| !is_corner(n)).filter(known).collect()
}

fn head(name: &str) -> [String; 2] {
    match name.rsplit_once('_') {
        Some((a, b)) => [a.replace('_', " "), b.to_owned()],
        None => [name.to_owned(), String::new()],
    }
}

/// Words in two lines of about the same length.
fn halves(words: &str) -> [String; 2] {
    let least = (words.len() / 2).saturating_sub(3);
    let cut = words.char_indices().filter(|(_, c)| *c == ' ').map(|(k, _)| k).find(|k| *k >= least);
    cut.map_or([words.to_owned(), String::new()], |k| [words[..k].to_owned(), words[k + 1..].to_owned()])
}

/// Numbers by size, anything else by its place in the list.
fn grid_axis(o: &SweepOutcome, key: &str, values: &[Value]) -> Option<Coordinate> {
    let head = halves(&key_label(key));
    if values.iter().all(Value::is_number) {
        let own = o.points.iter().map(|p| p.at.get(key).and_then(Value::as_f64)).collect();
        return coordinate_of(head, own, None, None);
    }
    let place = |p: &SweepPoint| Some(values.iter().position(|v| Some(v) == p.at.get(key))? as f64);
    let mut axis = coordinate_of(head, o.points.iter().map(place).collect(), None, None)?;
    axis.names = values.iter().map(|v| cut_off(&value_text(v))).collect();
    Some(axis)
}

/// The end of a name is what tells it from its neighbours.
fn cut_off(name: &str) -> String {
    let left = name.chars().count().saturating_sub(LETTERS);
    if left == 0 {
        name.to_owned()
    } else {
        std::iter::once('…').chain(name.chars().skip(left + 1)).collect()
    }
}

fn draw(o: &SweepOutcome, axes: &[Coordinate], front: &[bool]) -> Html {
    let longest = axes.first().into_iter().flat_map(|a| &a.names).map(|n| n.chars().count()).max();
    let left = LEFT.max(12.0 + LETTER * longest.unwrap_or(0) as f64);
    let x = |k: usize| left + STEP * k as f64;
    let mut body = Html::default();
    for (k, a) in axes.iter().enumerate() {
        body.push(text(x(k), 14.0, "label", &a.head[0]));
        body.push(text(x(k), 28.0, "label", &a.head[1]));
        body.push(line([x(k), TOP], [x(k), BOTTOM], "axis"));
    }
    let mut ways = Html::default();
    for (n, p) in o.points.iter().enumerate() {
        let places = axes.iter().enumerate().filter_map(|(k, a)| Some([x(k), a.scale.at(a.values[n]?)]));
        // a line over the axes that it has values on
        let class = if front[n] { "way front" } else { "way" };
        let (index, places) = (p.index.to_string(), joined(places));
        let title = element("title", &[], format!("point {}, {}", p.index, p.status.name()));
        ways.push(element(
            "polyline",
            &[("points", &places), ("class", class), ("data-point", &index)],
            title,
        ));
    }
    body.push(element("g", &[], ways));
    for (k, a) in axes.iter().enumerate() {
        let mark = |v: f64, words: &str| text(x(k) - 6.0, a.scale.at(v), "tick beside", words);
        if a.names.is_empty() {
            a.scale.ticks(4.0).into_iter().for_each(|v| body.push(mark(v, &plain(v))));
        } else {
            a.names.iter().enumerate().for_each(|(i, name)| body.push(mark(i as f64, name)));
        }
        for (v, class, word) in [(a.passive, "passive", "passive"), (a.limit, "limit", "limit")] {
            if let Some(v) = v {
                let y = a.scale.at(v);
                body.push(line([x(k) - 5.0, y], [x(k) + 24.0, y], class));
                body.push(text(x(k) + 27.0, y, "word after", word));
            }
        }
    }
    let size = format!("0 0 {} {HEIGHT}", coordinate(x(axes.len() - 1) + 70.0));
    let around = [
        ("viewBox", size.as_str()),
        ("class", "chart ways"),
        ("role", "img"),
        ("aria-label", "All points across parallel axes"),
    ];
    element("figure", &[("class", "wide")], element("svg", &around, body))
}
