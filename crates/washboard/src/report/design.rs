//! The page of a design: what it buys, its certificate, gains over frequency, poles, and the controller.

use super::html::{Html, classed, element, note, paragraph, table};
use super::numbers::{fixed, significant};
use super::page::{Page, Section};
use super::plot::{Axis, Plot, Plots, Role};
use crate::study::{DesignOutcome, DesignStatus, Measured, Rms};

type Draw = fn(&DesignOutcome, &mut Plots) -> Option<Html>;

/// Anchor, heading and body of each section, in the order of the page.
const SECTIONS: &[(&str, &str, Draw)] = &[
    ("ride", "What it buys", |o, _| ride(o)),
    ("certificate", "Claimed and recomputed", |o, _| certificate(o)),
    ("gains", "Gains over frequency", gains),
    ("poles", "Poles of the loop", |o, _| poles(o)),
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
        "Control law u = +K y. Norms are from the design's disturbance; rms are of the road's part alone.",
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
    let (class, verdict) = match o.status {
        DesignStatus::Designed if o.warnings.is_empty() => {
            ("passed", format!("A controller of order {}, confirmed by its loop", o.order.unwrap_or(0)))
        }
        DesignStatus::Designed => (
            "warned",
            format!("A controller of order {}, confirmed by its loop, with a price", o.order.unwrap_or(0)),
        ),
        DesignStatus::Limit => ("passed", "What no controller can beat".to_owned()),
        DesignStatus::Infeasible => ("failed", "No controller: the problem is infeasible".to_owned()),
        DesignStatus::Stalled => ("failed", "No controller: the method stalled".to_owned()),
        DesignStatus::Refused => ("failed", "No controller: its loop contradicts the design".to_owned()),
    };
    let mut inside = element("h2", &[], verdict);
    if let Some(why) = &o.why {
        inside = inside.and(classed("p", "finding", why.as_str()));
    }
    inside = inside.and(super::headline::flags(&o.warnings));
    for n in &o.notes {
        inside = inside.and(note(n.text.as_str()));
    }
    element("section", &[("class", &format!("verdict {class}")), ("id", "result")], inside)
}

fn shown(r: Option<&Rms>) -> Html {
    match r {
        Some(Rms::Finite(v)) => significant(*v, 4).into(),
        Some(Rms::Infinite(_)) => "infinite".into(),
        None => "–".into(),
    }
}

fn change(before: Option<f64>, after: Option<f64>) -> Html {
    match (before, after) {
        (Some(b), Some(a)) if b > 0.0 && a.is_finite() => {
            let percent = 100.0 * (a / b - 1.0);
            let sign = if percent > 0.0 { "+" } else { "" };
            format!("{sign}{} %", fixed(percent, 1)).into()
        }
        _ => "–".into(),
    }
}

fn ride(o: &DesignOutcome) -> Option<Html> {
    let closed = o.verified.as_ref();
    let row = |(name, before): (&str, &Rms)| {
        let after = closed.and_then(|c| c.rms.get(name));
        let peaks = (o.passive.hinf.get(name).copied(), closed.and_then(|c| c.hinf.get(name)).copied());
        let number = |v: Option<f64>| v.map_or_else(|| "–".into(), |v| Html::from(significant(v, 4)));
        vec![
            name.into(),
            shown(Some(before)),
            shown(after),
            change(before.finite(), after.and_then(|r| r.finite())),
            number(peaks.0),
            number(peaks.1),
            change(peaks.0, peaks.1),
        ]
    };
    let rows: Vec<Vec<Html>> = o.passive.rms.iter().map(row).collect();
    let head =
        ["output", "rms passive", "rms closed", "change", "peak gain passive", "peak gain closed", "change"];
    (!rows.is_empty()).then(|| {
        table("rms and peak gains, passive and closed", &head, rows).and(note(
            "rms in SI units on the road at the speed given; peak gains are H∞ norms from the design's disturbance. A name without its corner is the stacked vector.",
        ))
    })
}

fn certificate(o: &DesignOutcome) -> Option<Html> {
    let claims = o.claimed.iter().map(|(name, v)| (format!("claimed {}", name.replace('_', " ")), *v));
    let goals = o.objective.iter().map(|(name, v)| (format!("objective, {name}"), *v));
    let rows: Vec<Vec<Html>> =
        goals.chain(claims).map(|(name, v)| vec![name.into(), significant(v, 7).into()]).collect();
    (!rows.is_empty())
        .then(|| table("what is claimed, and what the loop itself shows", &["number", "value"], rows))
}

fn gains(o: &DesignOutcome, plots: &mut Plots) -> Option<Html> {
    if o.gains.freq_hz.is_empty() {
        return None;
    }
    let mut body = Html::default();
    for (name, passive) in o.gains.passive.iter() {
        let values =
            |v: &[f64]| v.iter().map(|v| (v.is_finite() && *v > 0.0).then_some(*v)).collect::<Vec<_>>();
        let frequency = Axis::new("frequency", "Hz", true);
        let mut plot = Plot::new(name, &o.gains.freq_hz, frequency, Axis::new("gain", "SI", true)).curve(
            "passive",
            Role::Before,
            values(passive),
        );
        if let Some(closed) = o.gains.closed.get(name) {
            plot = plot.curve("closed loop", Role::After, values(closed));
        }
        plot.group = "frequency".to_owned();
        body.push(plots.add(plot));
    }
    let what = "Largest singular value from the design's disturbance. Point to read values at one frequency in all plots; drag \
                to zoom, double-click to go back.";
    Some(classed("div", "grid", body).and(note(what)))
}

fn poles(o: &DesignOutcome) -> Option<Html> {
    let of = |m: &Measured, which: &str| -> Vec<Vec<Html>> {
        m.poles
            .iter()
            .filter(|p| p[1] >= 0.0)
            .map(|p| {
                let size = p[0].hypot(p[1]);
                let hz = significant(size / std::f64::consts::TAU, 4);
                vec![
                    which.into(),
                    significant(p[0], 4).into(),
                    significant(p[1], 4).into(),
                    hz.into(),
                    fixed(-100.0 * p[0] / size, 1).into(),
                ]
            })
            .collect()
    };
    let mut rows = of(&o.passive, "passive");
    if let Some(closed) = &o.verified {
        rows.extend(of(closed, "closed"));
    }
    (!rows.is_empty()).then(|| {
        table("poles with Im ≥ 0", &["loop", "Re, 1/s", "Im, 1/s", "|λ|/2π, Hz", "damping, %"], rows)
    })
}

fn controller(o: &DesignOutcome) -> Option<Html> {
    let k = o.controller.as_ref()?;
    let matrix = |name: &str, rows: &[Vec<f64>]| {
        let text: Vec<String> = rows
            .iter()
            .map(|r| r.iter().map(|v| format!("{v:.9e}")).collect::<Vec<_>>().join("  "))
            .collect();
        element("h3", &[], name).and(element("pre", &[], text.join("\n")))
    };
    let names = paragraph(format!("measures {}; drives {}", k.inputs.join(", "), k.outputs.join(", ")));
    Some(names.and(matrix("A", &k.a)).and(matrix("B", &k.b)).and(matrix("C", &k.c)).and(matrix("D", &k.d)))
}
