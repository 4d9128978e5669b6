//! The picture of `demo`: what controllers from a drive buy in the true car, beside those that knew the truth.

use super::html::{Html, element};
use super::numbers::fixed;
use super::scene::coordinate;
use crate::study::{DemoController, DemoDesigns, DemoOutcome, DemoRide};

const SIZE: [f64; 2] = [900.0, 400.0];
/// Left, right, top, bottom of spectra and bars.
const SPECTRA: [f64; 4] = [70.0, 430.0, 66.0, 320.0];
const BARS: [f64; 4] = [520.0, 880.0, 66.0, 320.0];
/// Colours of methods, those of the page's plots.
const COLOURS: [&str; 2] = ["#0b4a72", "#c2470b"];
const INK: &str = "#16202a";
/// Of what the designs bound.
const BOUND: &str = "#6d4aa8";
const SOFT: &str = "#52606d";
/// What the bars are of.
const SHOWN: [(&str, &str); 3] = [
    ("body_acceleration", "body acceleration"),
    ("suspension_travel", "suspension travel"),
    ("tire_deflection", "tire deflection"),
];
/// Whose spectrum is drawn.
const SPECTRUM: &str = "body_acceleration_front_left";
/// Decades of the spectrum below its largest value that are drawn.
const DECADES: f64 = 4.0;
/// A curve goes so far below the frame, where nobody sees it.
const BELOW: f64 = 12.0;

/// rms over the passive one, where both are finite.
pub(super) fn relative(ride: &DemoRide, passive: &DemoRide, name: &str) -> Option<f64> {
    let of = |r: &DemoRide| r.rms.get(name).and_then(|v| v.finite());
    of(ride).zip(of(passive)).filter(|(_, p)| *p > 0.0).map(|(v, p)| v / p)
}

/// The picture as an SVG file; none without designs.
#[must_use]
pub fn demo_svg(outcome: &DemoOutcome) -> Option<String> {
    Some(format!("{}\n", demo_svg_html(outcome.designs.as_ref()?)?.as_str()))
}

/// The same as a part of the page.
pub(super) fn demo_svg_html(d: &DemoDesigns) -> Option<Html> {
    (!d.methods.is_empty()).then_some(())?;
    let title = "From a drive to controllers, in the true car";
    let mut inside = element("rect", &[("width", "900"), ("height", "400"), ("fill", "#fff")], "");
    inside.push(text([20.0, 26.0], "start", "16", INK, title));
    inside.push(spectra(d));
    inside.push(bars(d));
    inside.push(legend(d));
    let view = format!("0 0 {} {}", SIZE[0], SIZE[1]);
    let attributes = [
        ("xmlns", "http://www.w3.org/2000/svg"),
        ("viewBox", view.as_str()),
        ("width", "900"),
        ("height", "400"),
        ("font-family", "sans-serif"),
        ("role", "img"),
        ("aria-label", title),
    ];
    Some(element("svg", &attributes, inside))
}

fn text(at: [f64; 2], anchor: &str, size: &str, colour: &str, words: &str) -> Html {
    let [x, y] = at.map(coordinate);
    let attributes =
        [("x", x.as_str()), ("y", &y), ("text-anchor", anchor), ("font-size", size), ("fill", colour)];
    element("text", &attributes, words)
}

fn line(a: [f64; 2], b: [f64; 2], colour: &str, dash: &str) -> Html {
    let [x1, y1, x2, y2] = [a[0], a[1], b[0], b[1]].map(coordinate);
    let places = [("x1", x1.as_str()), ("y1", &y1), ("x2", &x2), ("y2", &y2)];
    let look = [("stroke", colour), ("stroke-width", "1"), ("stroke-dasharray", dash)];
    element("line", &[places.as_slice(), look.as_slice()].concat(), "")
}

fn spectra(d: &DemoDesigns) -> Html {
    let [left, right, top, bottom] = SPECTRA;
    let Some(passive) = d.passive.psd.get(SPECTRUM) else { return Html::default() };
    let (Some(first), Some(last)) = (d.freq_hz.first(), d.freq_hz.last()) else { return Html::default() };
    let most = passive.iter().copied().fold(f64::MIN_POSITIVE, f64::max).log10().ceil();
    let x = |f: f64| left + (f / first).ln() / (last / first).ln() * (right - left);
    // what is below the frame is cut off, and not drawn along its end
    let y = |s: f64| (top + (most - s.log10()) / DECADES * (bottom - top)).clamp(top, bottom + BELOW);
    let mut all =
        text([left, 54.0], "start", "13", INK, "Spectrum of the body’s acceleration, front left, (m/s²)²/Hz");
    for k in 0..=DECADES as i32 {
        let at = top + f64::from(k) / DECADES * (bottom - top);
        all.push(line([left, at], [right, at], "#e3e7eb", ""));
        all.push(text([left - 8.0, at + 4.0], "end", "12", SOFT, &format!("10{}", raised(most as i32 - k))));
    }
    for f in [0.1, 1.0, 10.0] {
        if f >= *first && f <= *last {
            all.push(line([x(f), top], [x(f), bottom], "#e3e7eb", ""));
            all.push(text([x(f), bottom + 18.0], "middle", "12", SOFT, &f.to_string()));
        }
    }
    all.push(text([(left + right) / 2.0, bottom + 36.0], "middle", "12", SOFT, "frequency, Hz"));
    let mut curves = Html::default();
    let mut curve = |values: &[f64], colour: &str, dash: &str, width: &str| {
        let at = d.freq_hz.iter().zip(values).filter(|(_, s)| **s > 0.0);
        let at: Vec<String> =
            at.map(|(f, s)| format!("{},{}", coordinate(x(*f)), coordinate(y(*s)))).collect();
        let attributes = [
            ("points", at.join(" ")),
            ("fill", "none".to_owned()),
            ("stroke", colour.to_owned()),
            ("stroke-width", width.to_owned()),
            ("stroke-dasharray", dash.to_owned()),
        ];
        let attributes: Vec<(&str, &str)> = attributes.iter().map(|(k, v)| (*k, v.as_str())).collect();
        curves.push(element("polyline", &attributes, ""));
    };
    curve(passive, SOFT, "", "2");
    for (m, colour) in d.methods.iter().zip(COLOURS) {
        let of = |c: &DemoController| c.ride.as_ref().and_then(|r| r.psd.get(SPECTRUM)).cloned();
        if let Some(values) = of(&m.on_identified) {
            curve(&values, colour, "", "2");
        }
        if let Some(values) = of(&m.on_true) {
            curve(&values, INK, "3 4", "1.2");
        }
    }
    let [x, y, width, height] = [left, top, right - left, bottom - top].map(coordinate);
    let frame = [("x", x.as_str()), ("y", &y), ("width", &width), ("height", &height)];
    all.push(element("clipPath", &[("id", "frame")], element("rect", &frame, "")));
    all.and(element("g", &[("clip-path", "url(#frame)")], curves))
}

fn raised(n: i32) -> String {
    let digit = |c: char| match c {
        '-' => '⁻',
        c => c.to_digit(10).and_then(|d| "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().nth(d as usize)).unwrap_or(c),
    };
    n.to_string().chars().map(digit).collect()
}

fn bars(d: &DemoDesigns) -> Html {
    let [left, right, top, bottom] = BARS;
    let rides: Vec<(&str, bool, &DemoRide)> = d
        .methods
        .iter()
        .zip(COLOURS)
        .flat_map(|(m, colour)| {
            [(&m.on_identified, true), (&m.on_true, false)]
                .into_iter()
                .filter_map(move |(c, filled)| c.ride.as_ref().map(|r| (colour, filled, r)))
        })
        .collect();
    let values =
        SHOWN.map(|(name, _)| rides.iter().map(|r| relative(r.2, &d.passive, name)).collect::<Vec<_>>());
    let bounds = d.methods.iter().flat_map(|m| &m.on_identified.bounds).map(|b| b.bound);
    let most = values.iter().flatten().flatten().copied().chain(bounds).fold(1.0, f64::max);
    let steps = (most / 0.25).ceil() as i32;
    let y = |v: f64| bottom - v / (0.25 * f64::from(steps)) * (bottom - top);
    let mut all = text([left, 54.0], "start", "13", INK, "rms in the true car, as a share of passive");
    for k in 0..=steps {
        let v = 0.25 * f64::from(k);
        let dash = if k == 4 { "5 4" } else { "" };
        all.push(line([left, y(v)], [right, y(v)], if k == 4 { SOFT } else { "#e3e7eb" }, dash));
        all.push(text([left - 8.0, y(v) + 4.0], "end", "12", SOFT, &format!("{} %", 25 * k)));
    }
    let group = (right - left) / SHOWN.len() as f64;
    let width = 0.8 * group / rides.len().max(1) as f64;
    for (g, ((name, title), of)) in SHOWN.iter().zip(&values).enumerate() {
        let begin = left + group * (g as f64 + 0.1);
        for (k, (value, (colour, filled, _))) in of.iter().zip(&rides).enumerate() {
            let Some(v) = value else { continue };
            let at = begin + width * k as f64;
            let places = [at + 1.0, y(*v), width - 2.0, bottom - y(*v)].map(coordinate);
            let fill = if *filled { *colour } else { "#fff" };
            let attributes = [
                ("x", places[0].as_str()),
                ("y", &places[1]),
                ("width", &places[2]),
                ("height", &places[3]),
                ("fill", fill),
                ("stroke", colour),
            ];
            all.push(element("rect", &attributes, ""));
            let share = fixed(100.0 * v, 0);
            all.push(text([at + width / 2.0, y(*v) - 4.0], "middle", "11", INK, &share));
        }
        all.push(text([left + group * (g as f64 + 0.5), bottom + 18.0], "middle", "12", SOFT, title));
        let bound = d.methods.iter().flat_map(|m| &m.on_identified.bounds).find(|b| b.name == *name);
        if let Some(b) = bound {
            let ends = [left + group * (g as f64 + 0.02), left + group * (g as f64 + 0.98)];
            all.push(line([ends[0], y(b.bound)], [ends[1], y(b.bound)], BOUND, "7 3"));
            // once, above the bars' numbers
            if g + 1 == SHOWN.len() {
                let words = format!("bound {} %", fixed(100.0 * b.bound, 0));
                all.push(text([ends[1], top - 4.0], "end", "11", BOUND, &words));
            }
        }
    }
    all
}

/// Below both: what colours and outlines are.
fn legend(d: &DemoDesigns) -> Html {
    let mut all = Html::default();
    let mut x = SPECTRA[0];
    let y = 388.0;
    let mut entry = |words: &str, mark: Html| {
        all.push(mark);
        all.push(text([x + 22.0, y], "start", "12", INK, words));
        x += 40.0 + 6.6 * words.chars().count() as f64;
        x
    };
    let stroke = |x: f64, colour: &str, dash: &str| line([x, y - 4.0], [x + 16.0, y - 4.0], colour, dash);
    let mut at = entry("passive", stroke(SPECTRA[0], SOFT, ""));
    for (m, colour) in d.methods.iter().zip(COLOURS) {
        let [bx, by] = [at, y - 10.0].map(coordinate);
        let attributes =
            [("x", bx.as_str()), ("y", &by), ("width", "16"), ("height", "11"), ("fill", colour)];
        at = entry(&m.title, element("rect", &attributes, ""));
    }
    entry("dotted, outlined: designed with the truth", stroke(at, INK, "3 4"));
    all
}
