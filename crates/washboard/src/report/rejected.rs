//! What was found and left out: poles and narrow lines.

use super::Plots;
use super::html::{Html, classed, element, paragraph, table};
use super::numbers::{fixed, significant};
use crate::study::{IdentifyOutcome, RejectedMode, SpectralLine};
use std::collections::BTreeMap;

/// Rows of a table that are shown at once.
const ROWS: usize = 30;

/// Poles that are no modes, with the count of each reason.
pub(super) fn rejected(outcome: &IdentifyOutcome, _: &mut Plots) -> Option<Html> {
    let all = &outcome.rejected;
    if all.is_empty() {
        return None;
    }
    let row = |r: &RejectedMode| -> Vec<Html> {
        vec![fixed(r.freq_hz, 3).into(), fixed(100.0 * r.damping, 1).into(), r.why.as_str().into()]
    };
    let heads = ["# f, Hz", "# ζ, %", "why it is no mode"];
    let (first, more) = all.split_at(ROWS.min(all.len()));
    let mut body = Html::default();
    if !more.is_empty() {
        let counts = reasons(all).into_iter().map(|(why, n)| vec![n.to_string().into(), why.into()]);
        body.push(table("Reasons (numbers left out)", &["# poles", "reason"], counts.collect()));
    }
    let caption = if more.is_empty() { String::new() } else { format!("The first {ROWS} of {}", all.len()) };
    body.push(table(&caption, &heads, first.iter().map(row).collect()));
    if !more.is_empty() {
        let summary = element("summary", &[], format!("The other {}", more.len()));
        body.push(element("details", &[], summary.and(table("", &heads, more.iter().map(row).collect()))));
    }
    Some(body)
}

/// How often each reason was given, its numbers apart; the most frequent first.
fn reasons(all: &[RejectedMode]) -> Vec<(String, usize)> {
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    for r in all {
        *counts.entry(without_numbers(&r.why)).or_default() += 1;
    }
    let mut counts: Vec<_> = counts.into_iter().collect();
    counts.sort_by(|a, b| b.1.cmp(&a.1).then_with(|| a.0.cmp(&b.0)));
    counts
}

fn without_numbers(text: &str) -> String {
    let mut out = String::new();
    for word in text.split(' ') {
        let is_number = word.starts_with(|c: char| c.is_ascii_digit());
        if !out.is_empty() {
            out.push(' ');
        }
        let rest = word.trim_start_matches(|c: char| c.is_ascii_digit() || matches!(c, '.' | 'e' | '-'));
        out.push_str(&if is_number { format!("…{rest}") } else { word.to_owned() });
    }
    out
}

/// Narrow lines by their families of harmonics.
pub(super) fn lines(outcome: &IdentifyOutcome, _: &mut Plots) -> Option<Html> {
    if outcome.lines.is_empty() {
        return None;
    }
    let mut sorted: Vec<&SpectralLine> = outcome.lines.iter().collect();
    let key = |l: &SpectralLine| (l.fundamental_hz.unwrap_or(f64::INFINITY), l.freq_hz);
    sorted.sort_by(|a, b| key(a).0.total_cmp(&key(b).0).then(key(a).1.total_cmp(&key(b).1)));
    let rows = sorted.iter().map(|l| {
        let family = match (l.fundamental_hz, l.multiple) {
            (Some(f), Some(n)) => format!("{n} × {} Hz", fixed(f, 3)),
            (Some(f), None) => format!("of {} Hz", fixed(f, 3)),
            (None, _) => "alone".to_owned(),
        };
        let over = format!("{} ({} dB)", significant(l.over_floor, 3), fixed(10.0 * l.over_floor.log10(), 0));
        vec![fixed(l.freq_hz, 3).into(), family.into(), over.into(), l.text.as_str().into()]
    });
    let heads = ["# f, Hz", "harmonic", "# over the floor", "remark"];
    let words = "Lines too narrow for a mode: rotating parts, gears, engine orders, mains. They are no modes and were not \
                 taken for any.";
    Some(paragraph(words).and(classed("div", "lines", table("", &heads, rows.collect()))))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn out(n: usize) -> Vec<RejectedMode> {
        let why = |k: usize| format!("stable at {k} orders, 12 are needed");
        (0..n).map(|k| RejectedMode { freq_hz: k as f64, damping: 0.1, why: why(k) }).collect()
    }

    #[test]
    fn reasons_are_counted_apart_from_their_numbers() {
        let mut all = out(3);
        all.push(RejectedMode {
            freq_hz: 1.0,
            damping: 0.1,
            why: "the mode at 1.0640 Hz, seen at 3-4 orders".into(),
        });
        let counts = reasons(&all);
        assert_eq!(counts[0], ("stable at … orders, … are needed".to_owned(), 3));
        assert_eq!(counts[1].0, "the mode at … Hz, seen at … orders");
    }
}
