//! What the page of a sweep shows of the point that is chosen, as data for its script.

use super::html::{Html, element, json_script};
use super::numbers::significant;
use super::sweep::place_text;
use crate::study::{ResponseGroup, SweepDetail, SweepOutcome};
use serde::Serialize;
use std::collections::BTreeMap;

/// Numbers of curves in a page: about 4 MB. With more, curves have fewer frequencies.
const MOST_NUMBERS: usize = 500_000;

/// Curves of one output.
#[derive(Debug, Serialize)]
struct Output {
    name: String,
    unit: String,
}

/// A point.
#[derive(Debug, Serialize)]
struct Chosen {
    title: String,
    text: Vec<String>,
    controller_poles: Vec<String>,
    loop_poles: Vec<String>,
    /// Which of the passive curves.
    #[serde(skip_serializing_if = "Option::is_none")]
    passive: Option<usize>,
    /// One an output, in thousandths of decades (log10) to be short.
    closed: Vec<Option<Vec<Option<i32>>>>,
}

/// All points.
#[derive(Debug, Serialize)]
struct Data {
    per: String,
    freq_hz: Vec<f64>,
    outputs: Vec<Output>,
    /// Different sets of passive curves.
    passive: Vec<Vec<Option<Vec<Option<i32>>>>>,
    points: BTreeMap<usize, Chosen>,
}

/// The place for what is chosen, and the data.
pub(super) fn chosen(o: &SweepOutcome, details: &[SweepDetail]) -> Html {
    let by_index: BTreeMap<usize, &SweepDetail> = details.iter().map(|d| (d.index, d)).collect();
    let outputs = outputs(o);
    let bins = details.first().map_or(0, |d| d.gains.freq_hz.len());
    let stride = (bins * outputs.len() * details.len()).div_ceil(MOST_NUMBERS).max(1);
    let thin = |values: &[f64]| -> Vec<Option<i32>> {
        // log10 in thousandths is 0.2 % of the gain: less than a line's width
        let of = |v: &f64| (*v > 0.0 && v.is_finite()).then(|| (1000.0 * v.log10()).round() as i32);
        values.iter().step_by(stride).map(of).collect()
    };
    let mut passive: Vec<Vec<Option<Vec<Option<i32>>>>> = Vec::new();
    let mut points = BTreeMap::new();
    for p in &o.points {
        let detail = by_index.get(&p.index);
        let mut curves = |d: &SweepDetail| {
            let own: Vec<_> = outputs.iter().map(|n| d.gains.passive.get(n).map(|v| thin(v))).collect();
            passive.iter().position(|known| *known == own).unwrap_or_else(|| {
                passive.push(own);
                passive.len() - 1
            })
        };
        let poles =
            |of: fn(&SweepDetail) -> &Vec<[f64; 2]>| detail.map_or_else(Vec::new, |d| pole_texts(of(d)));
        let mut text = vec![place_text(o, p)];
        text.extend(p.order.map(|n| {
            format!("controller of order {n}, in {}", p.controller.as_deref().unwrap_or("no file"))
        }));
        text.extend(p.why.clone());
        if !p.warnings.is_empty() {
            text.push(format!("warnings: {}", p.warnings.join(", ")));
        }
        let chosen = Chosen {
            title: format!("Point {}, {}", p.index, p.status.name()),
            text,
            controller_poles: poles(|d| &d.controller_poles),
            loop_poles: poles(|d| &d.loop_poles),
            passive: detail.map(|d| curves(d)),
            closed: detail.map_or_else(Vec::new, |d| {
                outputs.iter().map(|n| d.gains.closed.get(n).map(|v| thin(v))).collect()
            }),
        };
        points.insert(p.index, chosen);
    }
    let freq = details.first().map_or(&[][..], |d| &d.gains.freq_hz);
    let unit = |name: &str| details.iter().find_map(|d| d.units.get(name)).cloned().unwrap_or_default();
    let data = Data {
        per: details.first().map_or_else(String::new, |d| d.per.clone()),
        freq_hz: freq.iter().step_by(stride).map(|f| format!("{f:.5e}").parse().unwrap_or(*f)).collect(),
        outputs: outputs.iter().map(|n| Output { name: (*n).to_owned(), unit: unit(n) }).collect(),
        passive,
        points,
    };
    let place = element(
        "div",
        &[("id", "chosen"), ("aria-live", "polite")],
        "Choose a point in a plot, or a row of the table.",
    );
    place.and(json_script("sweep", &data))
}

/// What is drawn of a point: one output a kind, and the force.
fn outputs(o: &SweepOutcome) -> Vec<&str> {
    let mut names = o.trade_offs();
    let force = |n: &&str| ResponseGroup::of(n) == ResponseGroup::Force;
    names.extend(o.outputs().into_iter().find(force));
    names
}

/// A pair once, with ±; real ones as they are.
fn pole_texts(poles: &[[f64; 2]]) -> Vec<String> {
    let upper = poles.iter().filter(|p| p[1] >= 0.0);
    upper
        .map(|[re, im]| match *im {
            0.0 => significant(*re, 4),
            im => format!("{} ± {}i", significant(*re, 4), significant(im, 4)),
        })
        .collect()
}
