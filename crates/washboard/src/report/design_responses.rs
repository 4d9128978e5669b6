//! Responses in time on a design's page: over the bump, and on a stretch of the road.

use super::html::{Html, classed, element, note, table};
use super::numbers::{signed, significant};
use super::plot::{Axis, Plot, Plots, Role};
use crate::study::{DesignOutcome, TimeResponses};

/// Both, as far as they are at hand.
pub(super) fn responses(o: &DesignOutcome, plots: &mut Plots) -> Option<Html> {
    let r = o.responses.as_ref()?;
    let bump = r.bump.as_ref().map(|t| {
        let title = element("h3", &[], "Over a bump");
        title.and(note(said(&t.what))).and(curves(o, t, "bump", plots)).and(peaks(o, t))
    });
    let road = r.road.as_ref().map(|t| {
        let title = element("h3", &[], "On the road");
        title.and(note(said(&t.what))).and(curves(o, t, "stretch", plots))
    });
    let all: Html = bump.into_iter().chain(road).collect();
    (!all.as_str().is_empty()).then_some(all)
}

fn said(what: &str) -> String {
    format!("{}.", super::design::capital(what))
}

/// One plot an output.
fn curves(o: &DesignOutcome, t: &TimeResponses, group: &str, plots: &mut Plots) -> Html {
    let (Some(first), Some(last)) = (t.time_s.first(), t.time_s.last()) else { return Html::default() };
    let values = |v: &[f64]| v.iter().map(|v| Some(*v)).collect::<Vec<_>>();
    // what stands still in both is a row of zeros alone
    let moves = |name: &str, closed: &[f64]| {
        let passive = t.passive.get(name).into_iter().flatten();
        passive.chain(closed).any(|v| *v != 0.0)
    };
    let drawn = t.closed.iter().filter(|(name, closed)| moves(name, closed)).map(|(name, closed)| {
        let unit = o.units.get(name).map_or("", String::as_str);
        let time = Axis::new("time", "s", false).within(*first, *last);
        let mut plot = Plot::new(name, &t.time_s, time, Axis::new("", unit, false));
        if let Some(passive) = t.passive.get(name).filter(|_| !name.starts_with("actuator_force")) {
            plot = plot.curve("passive", Role::Before, values(passive));
        }
        plot = plot.curve("closed loop", Role::After, values(closed));
        plot.group = group.to_owned();
        plots.add(plot)
    });
    classed("div", "grid", drawn.collect::<Html>())
}

/// Largest magnitudes, and by how much the loop makes them smaller.
fn peaks(o: &DesignOutcome, t: &TimeResponses) -> Html {
    let row = |(name, closed): (&str, &f64)| {
        let passive = t.passive_peak.get(name).copied();
        let change = passive
            .filter(|p| *p > 0.0)
            .map_or_else(|| "–".to_owned(), |p| format!("{} %", signed(100.0 * (closed / p - 1.0), 1)));
        let before = passive.map_or_else(|| "–".to_owned(), |p| significant(p, 4));
        let unit = o.units.get(name).map_or("", String::as_str);
        vec![name.into(), unit.into(), before.into(), significant(*closed, 4).into(), change.into()]
    };
    let rows = t.closed_peak.iter().map(row).collect();
    table("largest magnitude over the bump", &["output", "unit", "#passive", "#closed", "#change"], rows)
}
