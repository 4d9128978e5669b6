//! The page of a design: what it buys, its certificate, gains over frequency, poles, and the controller.

use super::design_gains::gains;
use super::design_tables::{certificate, controller, goal, poles, ride};
use super::html::{Html, classed, element, note, paragraph};
use super::numbers::significant;
use super::page::{Page, Section};
use super::plot::Plots;
use crate::study::{DesignOutcome, DesignStatus};

type Draw = fn(&DesignOutcome, &mut Plots) -> Option<Html>;

/// Anchor, heading and body of each section, in the order of the page.
const SECTIONS: &[(&str, &str, Draw)] = &[
    ("ride", "What it buys", |o, _| o.verified.as_ref().and_then(|_| ride(o))),
    ("passive", "The vehicle without control", |o, _| o.no_loop().and_then(|_| ride(o))),
    ("goal", "The goal", |o, _| goal(o)),
    ("gains", "Gains over frequency", gains),
    ("certificate", "Claimed and recomputed", |o, _| certificate(o)),
    ("poles", "Poles", |o, _| poles(o)),
    ("controller", "The controller", |o, _| controller(o)),
];

/// The page of a design, from its outcome alone: offline, and the same bytes for the same outcome.
#[must_use]
pub fn design_page(outcome: &DesignOutcome, title: &str) -> String {
    let mut plots = Plots::default();
    let section = |(id, heading, draw): &(&'static str, &'static str, Draw)| {
        draw(outcome, &mut plots).map(|body| Section { id, heading, body })
    };
    let sections = SECTIONS.iter().filter_map(section).collect();
    let foot = note(
        "Control law u = +K y; a positive force pulls body and wheel together. Norms are from the design's disturbance; rms \
         are of the road's part alone.",
    );
    let page = Page { title, subtitle: subtitle(outcome), top: headline(outcome), sections, foot, plots };
    page.write()
}

fn subtitle(o: &DesignOutcome) -> Html {
    let d = &o.design;
    paragraph(format!("{} · {} · {} m/s", d.vehicle, d.road, significant(d.speed_m_s, 4)))
        .and(paragraph(format!("method {} · measuring {}", d.method.name(), d.measurements.join(", "))))
}

fn headline(o: &DesignOutcome) -> Html {
    let class = match o.status {
        DesignStatus::Designed if o.warnings.is_empty() => "passed",
        DesignStatus::Designed => "warned",
        DesignStatus::Limit => "passed",
        DesignStatus::Infeasible | DesignStatus::Stalled | DesignStatus::Refused => "failed",
    };
    let mut inside = element("h2", &[], capital(&o.verdict()));
    if let Some(why) = &o.why {
        inside = inside.and(classed("p", "finding", capital(why)));
    }
    if let Some(no_loop) = o.no_loop() {
        inside = inside.and(paragraph(no_loop));
    }
    inside = inside.and(super::headline::flags(&o.warnings));
    for n in &o.notes {
        inside = inside.and(note(n.text.as_str()));
    }
    element("section", &[("class", &format!("verdict {class}")), ("id", "result")], inside)
}

/// The same with a capital at its head.
pub(super) fn capital(text: &str) -> String {
    let mut all = text.chars();
    all.next().map_or_else(String::new, |first| first.to_uppercase().chain(all).collect())
}
