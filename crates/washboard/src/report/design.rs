//! The page of a design: what it buys, its certificate, gains over frequency, poles, and the controller.

use super::design_bode::bode;
use super::design_gains::gains;
use super::design_metrics::metrics;
use super::design_poles::poles;
use super::design_responses::responses;
use super::design_robustness::robustness;
use super::design_sketch::sketch;
use super::design_tables::{certificate, controller, goal, ride, truncated, vertices};
use super::design_targets::{search, targets};
use super::html::{Html, classed, element, note, paragraph};
use super::numbers::significant;
use super::page::{Page, Section};
use super::plot::Plots;
use crate::study::{DesignOutcome, DesignStatus};

type Draw = fn(&DesignOutcome, &mut Plots) -> Option<Html>;

/// Anchor, heading and body of each section, in the order of the page.
const SECTIONS: &[(&str, &str, Draw)] = &[
    ("vehicle", "The vehicle", |o, _| sketch(o)),
    ("ride", "What it buys", |o, _| o.verified.as_ref().and_then(|_| ride(o))),
    ("passive", "The vehicle without control", |o, _| o.no_loop().and_then(|_| ride(o))),
    ("metrics", "Metrics", |o, _| metrics(o)),
    ("goal", "The goal", |o, _| goal(o)),
    ("targets", "Goals and bounds", |o, _| targets(o)),
    ("vertices", "Every vehicle that it is for", |o, _| vertices(o)),
    ("gains", "Gains over frequency", gains),
    ("responses", "Responses in time", responses),
    ("robustness", "Robustness", |o, _| robustness(o)),
    ("certificate", "Claimed and recomputed", |o, _| certificate(o)),
    ("truncated", "Fewer states", |o, _| truncated(o)),
    ("search", "The search", |o, _| search(o)),
    ("poles", "Poles", poles),
    ("bode", "The controller over frequency", bode),
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
    paragraph(format!("{} · {} · {} m/s", d.vehicle, d.road, significant(d.speed_m_s, 4))).and(paragraph(
        format!("method {} · {} {}", d.method.name(), o.measures_words(), d.measurements.join(", ")),
    ))
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::{DesignMethod, DesignSpec, Goal, design};

    fn half_car(method: DesignMethod, input_weight: f64) -> DesignOutcome {
        let minimize = [("heave_acceleration".to_owned(), 1.0), ("suspension_travel".to_owned(), 1.0)];
        let spec = DesignSpec {
            vehicle: "case:turkay-half-car".into(),
            road: "case:turkay-white-velocity".into(),
            speed_m_s: 20.0,
            measurements: vec!["suspension_travel".into()],
            method,
            input_weight,
            delay_order: 2,
            goal: Goal { minimize: minimize.into_iter().collect(), ..Goal::default() },
            ..DesignSpec::default()
        };
        design(&spec).unwrap().0
    }

    fn headings(page: &str) -> Vec<&str> {
        let cells = page.split("<th scope=\"col\"").skip(1);
        cells.map(|c| c.split_once('>').unwrap().1.split_once('<').unwrap().0).collect()
    }

    #[test]
    fn a_design_shows_its_goal_first_and_the_rest_on_demand() {
        let outcome = half_car(DesignMethod::Lqg, 1e-9);
        assert_eq!(outcome.status, DesignStatus::Designed);
        let page = design_page(&outcome, "half");
        assert!(page.contains("id=\"ride\"") && !page.contains("id=\"passive\""));
        let shown = page.split("Gains over frequency</h2>").nth(1).unwrap();
        let (first, rest) = shown.split_once("<details>").unwrap();
        let plots = |part: &str| part.matches("data-plot").count();
        assert_eq!(plots(first), 3, "heave, travel and force");
        // what white road reaches at all frequencies alike, too: all outputs have a curve
        assert_eq!(plots(rest.split_once("</details>").unwrap().0), outcome.rows().len() - 3);
        assert!(rest.contains("<h3>Tire load</h3>") && rest.contains("<h3>Wheels</h3>"));
        assert!(page.contains("m/s² per m/s") && page.contains("Measures suspension_travel_front in m"));
        assert_eq!(headings(&page).iter().filter(|h| **h == "closed").count(), 7);
        let metrics = page.split("id=\"metrics\"").nth(1).unwrap();
        assert!(metrics.contains("Dynamic load coefficient, tire_force (worst)") && metrics.contains("W_k"));
    }

    #[test]
    fn without_a_loop_no_column_is_empty_and_words_say_why() {
        for (method, weight) in [(DesignMethod::H2Limit, 1e-9), (DesignMethod::Hinf, 0.0)] {
            let outcome = half_car(method, weight);
            assert!(outcome.verified.is_none(), "{:?}", outcome.status);
            let page = design_page(&outcome, "none");
            let top = page.split("<nav").next().unwrap();
            assert!(top.contains("there is no closed loop to show"), "{method:?}");
            assert!(page.contains("The vehicle without control") && !page.contains("What it buys"));
            let heads = headings(&page);
            assert!(!heads.contains(&"closed") && heads.contains(&"passive"), "{heads:?}");
            assert!(!page.contains("\"closed loop\""));
        }
    }
}
