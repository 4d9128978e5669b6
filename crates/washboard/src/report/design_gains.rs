//! Gains over frequency on a design's page: what the goal asks for at first, the others by groups on demand.

use super::design::capital;
use super::html::{Html, classed, element, note};
use super::plot::{Axis, Line, Mark, Plot, Plots, Role};
use crate::study::{DesignOutcome, ResponseGroup, ResponseRow};

/// Colour and dashes of bounds.
const BOUND: usize = 2;

/// Plots of outputs of the goal and of the force; then, behind a click, of all others.
pub(super) fn gains(o: &DesignOutcome, plots: &mut Plots) -> Option<Html> {
    let goals = o.design.weights().unwrap_or_default();
    let rows = o.rows();
    let first = |r: &&ResponseRow<'_>| {
        let bounds = [
            &o.design.goal.minimize,
            &o.design.goal.bound,
            &o.design.goal.bound_hinf,
            &o.design.goal.minimize_hinf,
            &o.design.goal.bound_h2,
        ];
        goals.get(r.name).is_some()
            || (o.design.method.takes_bounds() && bounds.iter().any(|b| b.get(r.name).is_some()))
            || (r.group == ResponseGroup::Force && r.corner_of.is_none())
    };
    let (asked, others): (Vec<&ResponseRow<'_>>, Vec<_>) = rows.iter().partition(first);
    let asked = grid(o, &asked, plots)?;
    let unit = o.per();
    let what = format!(
        "Largest singular value from the design's disturbance to the outputs of the goal and to the forces, per {unit}. Point \
         to read values at one frequency in all plots; drag to zoom, double-click to go back."
    );
    let mut more = Html::default();
    let mut count = 0;
    for group in ResponseGroup::ALL {
        let of_group: Vec<&ResponseRow<'_>> = others.iter().filter(|r| r.group == group).copied().collect();
        let before = plots.0.len();
        if let Some(grid) = grid(o, &of_group, plots) {
            more.push(element("h3", &[], capital(group.heading())).and(grid));
            count += plots.0.len() - before;
        }
    }
    let mut body = asked.and(note(what)).and(constraints(o));
    if count > 0 {
        let summary = element("summary", &[], format!("The other {count} outputs, by groups"));
        body.push(element("details", &[], summary.and(more)));
    }
    Some(body)
}

/// Plots side by side; none where there is nothing to draw.
fn grid(o: &DesignOutcome, rows: &[&ResponseRow<'_>], plots: &mut Plots) -> Option<Html> {
    let drawn: Vec<Html> = rows.iter().filter_map(|r| plot(o, r)).map(|p| plots.add(p)).collect();
    (!drawn.is_empty()).then(|| classed("div", "grid", drawn.into_iter().collect::<Html>()))
}

fn plot(o: &DesignOutcome, r: &ResponseRow<'_>) -> Option<Plot> {
    let values = |v: &[f64]| v.iter().map(|v| Some(*v)).collect::<Vec<_>>();
    let unit = format!("{} per {}", r.unit, o.per());
    let (low, high) = (*o.gains.freq_hz.first()?, *o.gains.freq_hz.last()?);
    let mut plot = Plot::new(
        r.name,
        &o.gains.freq_hz,
        Axis::new("frequency", "Hz", true).within(low, high),
        Axis::new("gain", &unit, true),
    );
    for (label, role, of) in
        [("passive", Role::Before, &o.gains.passive), ("closed loop", Role::After, &o.gains.closed)]
    {
        if let Some(v) = of.get(r.name) {
            plot = plot.curve(label, role, values(v));
        }
    }
    if let Some(bound) = o.gain_bounds().get(r.name) {
        let line = Line::new([low, high], [*bound, *bound], "bound");
        plot.lines.push(Line { sign: Some(BOUND), ..line });
    }
    let here = o.invariant.iter().filter(|p| p.output == r.name && !plot.series.is_empty());
    plot.marks = here.map(|p| Mark::new(p.freq_hz, p.symbol.as_str())).collect();
    plot.group = "frequency".to_owned();
    (!plot.series.is_empty()).then_some(plot)
}

/// What the lines and marks in the plots are.
fn constraints(o: &DesignOutcome) -> Html {
    let mut text = Vec::new();
    if !o.gain_bounds().is_empty() {
        text.push("Dashed lines are bounds of the goal.".to_owned());
    }
    if let Some(first) = o.invariant.first() {
        let how = if first.exact {
            "no controller changes the response"
        } else {
            "controllers change the response little, and not at all were the tire without damping"
        };
        text.push(format!(
            "Marks are frequencies at which {how}: ω₁ of the travel, where body and wheel together swing on the tire, and ω₂ of the \
             body's acceleration, where the wheel alone does."
        ));
    }
    if text.is_empty() { Html::default() } else { note(text.join(" ")) }
}
