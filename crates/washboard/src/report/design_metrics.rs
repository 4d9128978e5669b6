//! The metrics of a design's page: passive, closed and the change, and what they mean.

use super::design::capital;
use super::html::{Html, element, note, table};
use super::numbers::{signed, significant};
use crate::study::{DesignOutcome, MetricGroup, MetricRow};

/// Worst corners first, every corner on demand.
pub(super) fn metrics(o: &DesignOutcome) -> Option<Html> {
    let m = o.metrics.as_ref()?;
    let (short, all) = (m.short_rows(&o.units), m.rows(&o.units));
    if short.is_empty() {
        return None;
    }
    let mut body = rows(o, &short).and(note(o.metrics_words()));
    if all.len() > short.len() {
        let summary = element("summary", &[], "Every corner");
        body.push(element("details", &[], summary.and(rows(o, &all))));
    }
    Some(body)
}

fn rows(o: &DesignOutcome, all: &[MetricRow]) -> Html {
    let reaction = if o.metrics.as_ref().is_some_and(|m| m.closed.is_some()) {
        "reaction: passive → closed"
    } else {
        "reaction"
    };
    let head = ["metric", "unit", "#passive", "#closed", "#change", reaction];
    let closed = o.metrics.as_ref().is_some_and(|m| m.closed.is_some());
    let mut body: Vec<Vec<Html>> = Vec::new();
    for group in MetricGroup::ALL {
        let own: Vec<&MetricRow> = all.iter().filter(|r| r.group == group).collect();
        if own.is_empty() {
            continue;
        }
        let mut heading = vec![Html::default(); if closed { 6 } else { 4 }];
        heading[0] = element("strong", &[], capital(group.heading()));
        body.push(heading);
        body.extend(own.into_iter().map(|r| cells(r, closed)));
    }
    let head: Vec<&str> =
        head.into_iter().filter(|h| closed || !["#closed", "#change"].contains(h)).collect();
    table("metrics on the road and over the bump", &head, body)
}

fn cells(r: &MetricRow, closed: bool) -> Vec<Html> {
    let [passive, after] =
        r.shown(|v| significant(v, 4)).map(|v| v.map_or_else(|| Html::from("–"), Html::from));
    let mut cells: Vec<Html> = vec![capital(&r.what).into(), r.unit.as_str().into(), passive];
    if closed {
        let change =
            r.change().map_or_else(|| "–".into(), |c| Html::from(format!("{} %", signed(100.0 * c, 1))));
        cells.extend([after, change]);
    }
    let [before, after] = &r.words;
    let words = match (before.is_empty(), after.is_empty()) {
        _ if before == after && !before.is_empty() && closed => format!("{before} (both)"),
        _ if before == after => before.clone(),
        (false, false) => format!("{before} → {after}"),
        (true, _) => after.clone(),
        (_, true) => before.clone(),
    };
    cells.push(words.into());
    cells
}
