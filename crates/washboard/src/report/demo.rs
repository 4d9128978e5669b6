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
    let warned = |d: &DemoDesigns| d.methods.iter().map(|m| m.warnings(&d.passive).len()).sum::<usize>();
    let warnings = outcome.designs.as_ref().map_or(0, warned);
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
                match m.warnings(&d.passive).len() {
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
        let warnings = m.warnings(&d.passive);
        if !warnings.is_empty() {
            let words = format!("Warnings of the design on the identified car, {}:", m.title);
            body.push(paragraph(words).and(headline::flags(&warnings)));
        }
    }
    if let Some(picture) = demo_svg_html(d) {
        body.push(classed("div", "scroll", classed("figure", "picture", picture)));
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
        let mut curve = |label: String, role: Role, sign: usize, values: Option<&Vec<f64>>| {
            let y = values.map(|v| v.iter().map(|v| Some(*v)).collect()).unwrap_or_default();
            plot.push(Series { label, role, y, sign, ..Series::default() });
        };
        curve("passive".to_owned(), Role::Passive, 0, Some(passive));
        let of = |c: &DemoController| c.ride.as_ref().and_then(|r| r.psd.get(name)).cloned();
        for (sign, m) in d.methods.iter().enumerate() {
            curve(m.title.clone(), Role::Designed, sign, of(&m.on_identified).as_ref());
        }
        // dotted, and so over the lines that they are like
        for (sign, m) in d.methods.iter().enumerate() {
            let label = format!("{}, with the truth", m.title);
            curve(label, Role::DesignedTrue, sign, of(&m.on_true).as_ref());
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
        .and(element("pre", &[("class", "lines")], lines.join("\n")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::demo_picture::demo_svg;
    use crate::study::{DemoBound, DesignStatus, Flag, Named};

    fn named<T>(value: T, name: &str) -> Named<T> {
        std::iter::once((name.to_owned(), value)).collect()
    }

    /// One method whose true car exceeds a bound, and whose spectrum is low.
    fn outcome() -> DemoOutcome {
        let ride = |share: f64, psd: f64| DemoRide {
            rms: OUTPUTS[..6].iter().map(|(n, _)| ((*n).to_owned(), Rms::Finite(share))).collect(),
            hinf: Named::default(),
            psd: named(vec![psd, psd], SPECTRA[0].0),
        };
        let controller = |share: f64, psd: f64| DemoController {
            status: DesignStatus::Designed,
            why: None,
            warnings: vec![Flag { name: "peak".into(), text: "a peak".into() }],
            bounds: vec![DemoBound {
                name: "tire_deflection".into(),
                bound: 1.1,
                kept: Some(1.1),
                with_exact_delay: Some(1.14),
            }],
            delay_order: 4,
            order: Some(2),
            expected: None,
            ride: Some(ride(share, psd)),
        };
        let method = |name: &str, psd: f64| DemoMethod {
            name: name.into(),
            title: name.into(),
            method: name.into(),
            minimized: "body_acceleration".into(),
            on_identified: controller(1.14, psd),
            on_true: controller(1.14, psd),
            difference: Named::default(),
        };
        let filter = DemoFilter {
            order: 1,
            states: 1,
            poles: Vec::new(),
            band_rad_per_m: [0.1, 1.0],
            rounded_below_rad_per_m: 0.02,
            log10_rms_error: 0.01,
            log10_max_error: 0.01,
            nu_rad_per_m: vec![0.1, 1.0],
            given: vec![1.0, 1.0],
            fitted: vec![1.0, 1.0],
        };
        let designs = DemoDesigns {
            speed_m_s: 20.0,
            filter: filter.clone(),
            true_filter: filter,
            passive: ride(1.0, 1.0),
            methods: vec![method("one", 1e-9), method("two", 0.5)],
            units: Named::default(),
            freq_hz: vec![1.0, 10.0],
        };
        DemoOutcome { designs: Some(designs), ..DemoOutcome::default() }
    }

    #[test]
    fn every_warning_is_counted_and_in_the_list() {
        let page = demo_page(&outcome(), "d");
        // one of the design and one of the bound, twice
        assert!(page.contains("Designs: 4 warnings, below") && page.contains("2 warnings, below."));
        assert_eq!(page.matches("<code>beyond-bound</code>").count(), 2);
        assert_eq!(page.matches("<code>peak</code>").count(), 2);
    }

    #[test]
    fn a_method_has_one_colour_in_picture_and_plots_and_the_picture_scrolls_by_itself() {
        let page = demo_page(&outcome(), "d");
        for role in ["passive", "designed", "designed-true"] {
            assert!(page.contains(&format!("\"role\":\"{role}\"")), "{role}");
        }
        assert!(page.contains("<div class=\"scroll\"><figure class=\"picture\"><svg "));
    }

    #[test]
    fn a_spectrum_below_the_frame_is_cut_and_no_line_at_its_end() {
        let svg = demo_svg(&outcome()).unwrap();
        let (_, low) = svg.split_once("clip-path=\"url(#frame)\"").unwrap();
        assert!(svg.contains("<clipPath id=\"frame\">"));
        // the flat spectrum of 10⁻⁹ lies below the frame's lower end
        assert!(low.contains(",332.0 ") && !low.contains(",320.0 "), "{low}");
    }
}
