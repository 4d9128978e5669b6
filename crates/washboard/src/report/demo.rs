//! The page of `demo`: from a drive to controllers, with the truth beside every step.

use super::demo_picture::{demo_svg_html, relative};
use super::design::capital;
use super::html::{Html, classed, element, note, paragraph, table};
use super::numbers::{fixed, signed, significant};
use super::page::{Page, Section};
use super::plot::{Axis, Plot, Plots, Role, Series};
use super::{foot, headline, identify_sections};
use crate::study::{DemoController, DemoDesigns, DemoFilter, DemoMethod, DemoOutcome, DemoRide, Rms};

/// The outputs of the table: stacked vectors of all corners, and forces.
pub(super) const OUTPUTS: [(&str, &str); 7] = [
    ("body_acceleration", "acceleration of the body's corners"),
    ("heave_acceleration", "heave acceleration"),
    ("pitch_acceleration", "pitch acceleration"),
    ("roll_acceleration", "roll acceleration"),
    ("suspension_travel", "suspension travel"),
    ("tire_deflection", "tire deflection"),
    ("actuator_force", "actuator force"),
];
/// Spectra: output, name, unit.
const SPECTRA: [(&str, &str, &str); 3] = [
    ("body_acceleration_front_left", "Body acceleration, front left", "(m/s²)²/Hz"),
    ("suspension_travel_front_left", "Suspension travel, front left", "m²/Hz"),
    ("tire_deflection_front_left", "Tire deflection, front left", "m²/Hz"),
];

/// The page of a demo, from its outcome alone: offline, and the same bytes for the same outcome.
///
/// ```
/// use washboard::study::DemoOutcome;
/// let page = washboard::report::demo_page(&DemoOutcome::default(), "A & B");
/// assert!(page.starts_with("<!doctype html>") && page.contains("<h1>A &amp; B</h1>") && !page.contains("id=\"buys\""));
/// ```
#[must_use]
pub fn demo_page(outcome: &DemoOutcome, title: &str) -> String {
    let mut plots = Plots::default();
    let found = &outcome.identified;
    let mut sections = identify_sections(found, &mut plots);
    if let Some(d) = &outcome.designs {
        // the story in its order, the evidence after it
        let after_truth = sections.iter().position(|s| s.id == "truth").map_or(0, |k| k + 1);
        let story = [
            Section { id: "filter", heading: "The road as a filter", body: filter(d, &mut plots) },
            Section {
                id: "buys",
                heading: "What controllers buy in the true car",
                body: buys(d, &mut plots),
            },
            Section { id: "further", heading: "Go on from here", body: further(d) },
        ];
        sections.splice(after_truth..after_truth, story);
    }
    let top = outcome.designs.as_ref().map_or_else(Html::default, story);
    let shown = outcome.designs.iter().flat_map(|d| &d.methods).map(|m| m.on_identified.warnings.len());
    let warnings = shown.sum();
    let page = Page {
        title,
        subtitle: headline::subtitle(found),
        top: headline::headline_beside(found, warnings).and(top),
        sections,
        foot: foot::foot(found),
        plots,
    };
    page.write()
}

/// What came of it, in a sentence a method.
fn story(d: &DemoDesigns) -> Html {
    let sentence = |m: &DemoMethod| {
        let change = |c: &DemoController| {
            c.ride.as_ref().and_then(|r| relative(r, &d.passive, &m.minimized)).map(|v| 100.0 * (v - 1.0))
        };
        let text = match (change(&m.on_identified), change(&m.on_true)) {
            (Some(a), Some(b)) => format!(
                "{}, designed on what the drive showed: {} % body acceleration in the true car; designed with the truth: {} %.{}",
                capital(&m.title),
                signed(a, 1),
                signed(b, 1),
                match m.on_identified.warnings.len() {
                    0 => String::new(),
                    1 => " Before it is built: one warning, below.".to_owned(),
                    n => format!(" Before it is built: {n} warnings, below."),
                }
            ),
            _ => format!("{}: {}", capital(&m.title), verdict(&m.on_identified)),
        };
        element("li", &[], text)
    };
    element("ul", &[("id", "story")], d.methods.iter().map(sentence).collect::<Html>())
}

fn verdict(c: &DemoController) -> String {
    c.why.clone().unwrap_or_else(|| "a controller that the true car holds".to_owned())
}

fn filter(d: &DemoDesigns, plots: &mut Plots) -> Html {
    let words = |name: &str, f: &DemoFilter| {
        format!(
            "The {name} road’s law, rounded below {} rad/m, is a filter of {}, with a log₁₀ error of {} \
             rms and {} at most over the band that the drive saw, {} to {} rad/m.",
            significant(f.rounded_below_rad_per_m, 2),
            f.order_words(),
            significant(f.log10_rms_error, 2),
            significant(f.log10_max_error, 2),
            significant(f.band_rad_per_m[0], 3),
            significant(f.band_rad_per_m[1], 3),
        )
    };
    let f = &d.filter;
    // a filter's is two-sided with var = (1/2π) ∫ S dν; a road's roughness, S₀, is one-sided per rad/m: G = S/π
    let law = |values: &[f64]| values.iter().map(|v| Some(*v / std::f64::consts::PI)).collect::<Vec<_>>();
    let plot = Plot::new(
        "Density of the road’s height, one-sided per rad/m, as S₀ is",
        &f.nu_rad_per_m,
        Axis::new("wavenumber ν", "rad/m", true),
        Axis::new("G", "m³", true),
    )
    .curve("filter", Role::Fitted, law(&f.fitted))
    .curve("identified law", Role::Measured, law(&f.given))
    .curve("true law", Role::Truth, law(&d.true_filter.given));
    let remark = "A design needs a rational model of the road: subspace identification of its spectrum makes one. Left and right tracks know \
                  nothing of each other in it, and the rear wheels follow the front ones by Padé’s approximation of the delay; the rides \
                  below have the true coherence and exact delays.";
    paragraph(words("identified", f))
        .and(paragraph(words("true", &d.true_filter)))
        .and(plots.add(plot))
        .and(note(remark))
}

fn rms(ride: &DemoRide, name: &str) -> Option<f64> {
    ride.rms.get(name).and_then(|r: &Rms| r.finite())
}

fn buys(d: &DemoDesigns, plots: &mut Plots) -> Html {
    let mut body = paragraph(format!(
        "The true car on the true road at {} m/s, with the controllers that were designed on the identified car and, for comparison, on the \
         true one.",
        fixed(d.speed_m_s, 0)
    ));
    for m in &d.methods {
        let rows = OUTPUTS.iter().filter_map(|(name, title)| {
            let passive = rms(&d.passive, name)?;
            let unit = d.units.get(name).map_or("", String::as_str);
            let of = |c: &DemoController| c.ride.as_ref().and_then(|r| rms(r, name));
            let cell = |v: Option<f64>| Html::from(v.map_or_else(|| "–".to_owned(), |v| significant(v, 4)));
            let change = |v: Option<f64>| {
                let share = v.filter(|_| passive > 0.0).map(|v| 100.0 * (v / passive - 1.0));
                Html::from(share.map_or_else(String::new, |s| signed(s, 1)))
            };
            let (a, b) = (of(&m.on_identified), of(&m.on_true));
            let apart = m.difference.get(name).map_or_else(String::new, |v| signed(100.0 * v, 2));
            let title = if unit.is_empty() { (*title).to_owned() } else { format!("{title}, {unit}") };
            Some(vec![
                title.into(),
                cell(Some(passive)),
                cell(a),
                change(a),
                cell(b),
                change(b),
                apart.into(),
            ])
        });
        let heads = [
            "rms on the true road",
            "# passive",
            "# designed on identified",
            "# %",
            "# designed on true",
            "# %",
            "# apart, %",
        ];
        body.push(table(&capital(&m.title), &heads, rows.collect()));
        for (whose, c) in [("identified", &m.on_identified), ("true", &m.on_true)] {
            body.push(note(told(whose, c)));
        }
        m.beyond_bounds(&d.passive).into_iter().for_each(|words| body.push(note(capital(&words) + ".")));
        if !m.on_identified.warnings.is_empty() {
            let words = format!("Warnings of the design on the identified car, {}:", m.title);
            body.push(paragraph(words).and(headline::flags(&m.on_identified.warnings)));
        }
    }
    if let Some(picture) = demo_svg_html(d) {
        body.push(element("figure", &[("class", "wide")], picture));
    }
    let mut grid = Html::default();
    for (name, title, unit) in SPECTRA {
        let Some(passive) = d.passive.psd.get(name) else { continue };
        let mut plot = Plot::new(
            title,
            &d.freq_hz,
            Axis::new("frequency", "Hz", true),
            Axis::new("spectral density", unit, true),
        );
        plot.group = "demo".to_owned();
        let curves =
            std::iter::once(("passive".to_owned(), Some(passive))).chain(d.methods.iter().flat_map(|m| {
                [("identified", &m.on_identified), ("true", &m.on_true)].map(|(whose, c)| {
                    (format!("{}, {whose}", m.title), c.ride.as_ref().and_then(|r| r.psd.get(name)))
                })
            }));
        for (sign, (label, values)) in curves.enumerate() {
            let y = values.map(|v| v.iter().map(|v| Some(*v)).collect()).unwrap_or_default();
            plot.push(Series { label, role: Role::Line, y, sign, ..Series::default() });
        }
        grid.push(plots.add(plot));
    }
    body.and(classed("div", "grid", grid))
}

/// One controller in words.
fn told(whose: &str, c: &DemoController) -> String {
    let order = c.order.map_or_else(|| "no controller".to_owned(), |n| format!("a controller of {n} states"));
    let expected = c.expected.map_or_else(String::new, |e| {
        format!("; its own design expected {} % body acceleration", signed(100.0 * (e - 1.0), 1))
    });
    let why = c.why.as_ref().map_or_else(String::new, |w| format!("; {w}"));
    format!("On the {whose} car: {order}{expected}{why}.")
}

fn further(d: &DemoDesigns) -> Html {
    let mut lines = vec!["washboard ride vehicle.toml --road road.toml --speed-m-s 25".to_owned()];
    for m in &d.methods {
        lines.push(format!("washboard design {}.toml -o {}", m.name, m.name));
        if m.on_identified.order.is_some() {
            lines.push(format!(
                "washboard ride case:guiggiani-full-car --road case:iso8608-c --speed-m-s {} --controller {}-controller.json",
                fixed(d.speed_m_s, 0),
                m.name
            ));
        }
    }
    paragraph("Beside this page stand vehicle.toml, road.toml, filter.toml, and a design file and its controller a method. In this folder:")
        .and(element("pre", &[], lines.join("\n")))
}
