//! The stabilisation diagram: poles of all orders over the singular values of the spectra.

use super::html::{Html, note, paragraph};
use super::numbers::fixed;
use super::plot::{Axis, Plot, Role, Series};
use super::{Plots, modes};
use crate::study::{IdentifyOutcome, SingularValues, StabilizationPole};
use std::collections::BTreeMap;

/// Singular values that are drawn: the first ones carry the modes.
const CURVES: usize = 4;
/// Room about the singular values, as a factor.
const ROOM: f64 = 1.5;

/// A point of the diagram's abscissa: a pole, or a bin of the singular values.
#[derive(Debug, Clone, Copy)]
enum At<'a> {
    Pole(&'a StabilizationPole),
    Bin(usize),
}

/// Order over frequency of all poles, one sign for each reason.
pub(super) fn diagram(outcome: &IdentifyOutcome, plots: &mut Plots) -> Option<Html> {
    let shown = |p: &&StabilizationPole| p.freq_hz.is_finite() && p.freq_hz >= 0.0;
    let poles: Vec<&StabilizationPole> = outcome.stabilization.iter().filter(shown).collect();
    if poles.is_empty() {
        return None;
    }
    let behind = outcome.singular_values.as_ref().filter(|s| usable(s));
    let mut along: Vec<(f64, At)> = poles.iter().map(|p| (p.freq_hz, At::Pole(p))).collect();
    along.extend(behind.iter().flat_map(|s| s.freq_hz.iter().enumerate().map(|(k, f)| (*f, At::Bin(k)))));
    along.sort_by(|a, b| a.0.total_cmp(&b.0));
    let x: Vec<f64> = along.iter().map(|(f, _)| *f).collect();
    let highest = poles.iter().map(|p| p.order).max().unwrap_or(0) as f64;
    let y_axis = Axis::new("model order", "", false).within(0.0, 1.05 * highest);
    let mut plot = Plot::new("Stabilisation diagram", &x, Axis::new("frequency", "Hz", false), y_axis);
    if let Some(s) = behind {
        plot.second_axis = second_axis(s);
        for (k, curve) in s.values.iter().take(CURVES).enumerate() {
            let y = along.iter().map(|(_, at)| match at {
                At::Bin(k) => curve.get(*k).copied(),
                At::Pole(_) => None,
            });
            let label = format!("singular value {}", k + 1);
            plot.push(Series {
                label,
                role: Role::Singular,
                y: y.collect(),
                second: true,
                ..Series::default()
            });
        }
    }
    let kinds = kinds(&poles);
    let stable = poles.iter().filter(|p| p.stable).count();
    for (sign, (reason, count)) in kinds.iter().enumerate() {
        let y = along.iter().map(|(_, at)| match at {
            At::Pole(p) if kind(p) == *reason => Some(p.order as f64),
            _ => None,
        });
        let label = format!("{reason} ({count})");
        // the first sign is kept for what is stable
        let sign = if stable == 0 { sign + 1 } else { sign };
        plot.push(Series { label, role: Role::Poles, y: y.collect(), sign, ..Series::default() });
    }
    plot.hover = along
        .iter()
        .map(|(_, at)| if let At::Pole(p) = at { pole_words(p) } else { String::new() })
        .collect();
    plot.marks = modes::marks(&outcome.modes);
    plot.wide = true;
    let words = format!("{stable} of {} poles are stable from one order to the next.", poles.len());
    let lines = if behind.is_some() {
        " The lines are the largest singular values of the spectra of channels scaled to an rms of 1: they peak at modes."
    } else {
        ""
    };
    Some(paragraph(words).and(plots.add(plot)).and(note(format!(
        "Point at a pole, or tap it, to read why it was judged as it was; a click on a reason below the diagram hides or \
         shows its poles.{lines}{}",
        modes::key(outcome)
    ))))
}

fn usable(s: &SingularValues) -> bool {
    !s.freq_hz.is_empty()
        && s.freq_hz.iter().all(|f| f.is_finite())
        && s.values.iter().all(|curve| curve.len() == s.freq_hz.len())
}

fn second_axis(s: &SingularValues) -> Option<Axis> {
    let drawn = s.values.iter().take(CURVES).flatten().copied().filter(|v| v.is_finite() && *v > 0.0);
    let (low, high) = drawn.fold((f64::INFINITY, 0.0_f64), |(l, h), v| (l.min(v), h.max(v)));
    (high > 0.0).then(|| Axis::new("singular value", "1/Hz", true).within(low / ROOM, high * ROOM))
}

/// What a pole is counted as.
fn kind(p: &StabilizationPole) -> &str {
    match (&p.why, p.stable) {
        (_, true) => "stable",
        (Some(why), false) => why,
        (None, false) => "not stable",
    }
}

/// Each kind with its count: stable ones first, then the most frequent.
fn kinds<'a>(poles: &[&'a StabilizationPole]) -> Vec<(&'a str, usize)> {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for p in poles {
        *counts.entry(kind(p)).or_default() += 1;
    }
    let mut counts: Vec<_> = counts.into_iter().collect();
    counts.sort_by(|a, b| (b.0 == "stable").cmp(&(a.0 == "stable")).then(b.1.cmp(&a.1)).then(a.0.cmp(b.0)));
    counts
}

fn pole_words(p: &StabilizationPole) -> String {
    format!("order {}: {} Hz, ζ {} %; {}", p.order, fixed(p.freq_hz, 3), fixed(100.0 * p.damping, 1), kind(p))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pole(order: usize, freq_hz: f64, why: Option<&str>) -> StabilizationPole {
        StabilizationPole { order, freq_hz, damping: 0.3, stable: why.is_none(), why: why.map(str::to_owned) }
    }

    #[test]
    fn every_pole_is_drawn_once_under_its_reason_and_counted() {
        let stabilization = vec![
            pole(4, 2.0, Some("new damping")),
            pole(6, 1.0, None),
            pole(6, 3.0, Some("new damping")),
            pole(8, 1.5, Some("grows")),
            pole(8, f64::NAN, Some("grows")),
        ];
        let values = vec![vec![1.0, 2.0, 0.5], vec![0.1, 0.0, 0.2]];
        let singular_values = Some(SingularValues { freq_hz: vec![0.5, 1.5, 2.5], values });
        let outcome = IdentifyOutcome { stabilization, singular_values, ..IdentifyOutcome::default() };
        let mut plots = Plots::default();
        diagram(&outcome, &mut plots).unwrap();
        let plot = &plots.0[0];
        let labels: Vec<&str> = plot.series.iter().map(|s| s.label.as_str()).collect();
        assert_eq!(
            labels,
            ["singular value 1", "singular value 2", "stable (1)", "new damping (2)", "grows (1)"]
        );
        assert!(plot.x.windows(2).all(|w| w[0] <= w[1]) && plot.x.len() == 7);
        let drawn = |k: usize| plot.series[k].y.iter().flatten().copied().collect::<Vec<_>>();
        assert_eq!(
            [drawn(0), drawn(1), drawn(2), drawn(3)],
            [vec![1.0, 2.0, 0.5], vec![0.1, 0.2], vec![6.0], vec![4.0, 6.0]]
        );
        assert_eq!(plot.hover.iter().filter(|h| !h.is_empty()).count(), 4);
        assert!(plot.hover.contains(&"order 4: 2.000 Hz, ζ 30.0 %; new damping".to_owned()));
        assert_eq!(plot.series[2].sign, 0);
    }

    #[test]
    fn singular_values_of_other_lengths_are_left_out() {
        let singular_values = Some(SingularValues { freq_hz: vec![0.5], values: vec![vec![1.0, 2.0]] });
        let stabilization = vec![pole(4, 2.0, Some("x"))];
        let outcome = IdentifyOutcome { stabilization, singular_values, ..IdentifyOutcome::default() };
        let mut plots = Plots::default();
        diagram(&outcome, &mut plots).unwrap();
        assert_eq!((plots.0[0].series.len(), plots.0[0].series[0].sign), (1, 1));
        assert!(plots.0[0].second_axis.is_none());
    }
}
