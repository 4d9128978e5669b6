//! The shapes in motion: a panel a mode with the vehicle, the phases, and the table that says the same.

use super::Plots;
use super::html::{Html, classed, element, note, table};
use super::modes::dial;
use super::numbers::fixed;
use super::{argand, scene};
use crate::study::{IdentifiedMode, IdentifyOutcome, ShapePoint};

/// Components below this share of the largest have no phase worth a look.
const NO_PHASE: f64 = 0.005;

/// Whether a mode has a panel.
pub(super) fn has_panel(mode: &IdentifiedMode) -> bool {
    !scene::drawable(&mode.points).is_empty()
}

/// The panels of all modes that have points.
pub(super) fn shapes(outcome: &IdentifyOutcome, _: &mut Plots) -> Option<Html> {
    let panels: Html = outcome
        .modes
        .iter()
        .enumerate()
        .filter_map(|(k, mode)| {
            let title = title(k, mode);
            let drawing = scene::svg(&mode.points, &format!("Shape of mode {title}"))?;
            let both = classed(
                "div",
                "moving",
                classed("figure", "vehicle", drawing).and(argand::argand(&mode.points)),
            );
            let inside = element("h3", &[], title.as_str()).and(both).and(numbers(&mode.points));
            let tab = format!("{} {}", k + 1, mode.label);
            Some(element(
                "div",
                &[("class", "panel"), ("id", &format!("shape-{}", k + 1)), ("data-tab", &tab)],
                inside,
            ))
        })
        .collect();
    (panels != Html::default()).then(|| {
        element("div", &[("class", "player")], panels).and(note(
            "Vertical displacement at the wheels and sensors, seen from the right; the largest is 1. Every mode moves at \
             the same slow pace, without its decay. Dashed: at rest. In the circle each arrow is a point’s size and \
             phase; the turning hand points at what is at its highest. Arrows that do not lie on one line are a \
             travelling motion: points reach their heights one after another.",
        ))
    })
}

fn title(index: usize, mode: &IdentifiedMode) -> String {
    let (f, zeta) = (fixed(mode.freq_hz, 2), fixed(100.0 * mode.damping, 1));
    format!("{} · {} · {f} Hz, ζ {zeta} %", index + 1, mode.label)
}

/// Size and phase of every point.
pub(super) fn numbers(points: &[ShapePoint]) -> Html {
    let rows = scene::drawable(points).into_iter().enumerate().map(|(k, p)| {
        let (size, phase) = (p.re.hypot(p.im), p.im.atan2(p.re));
        let (words, hand) = if size < NO_PHASE {
            ("–".to_owned(), Html::default())
        } else {
            (fixed(phase.to_degrees(), 1), dial(phase))
        };
        vec![
            (k + 1).to_string().into(),
            p.name.as_str().into(),
            p.place.as_str().into(),
            fixed(p.at_m[0], 2).into(),
            fixed(p.at_m[1], 2).into(),
            fixed(size, 3).into(),
            words.into(),
            hand,
        ]
    });
    let heads = ["# no.", "point", "place", "# forward, m", "# left, m", "# size", "# phase, °", ""];
    table("", &heads, rows.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_and_phases_are_those_of_the_points() {
        let point =
            |re, im| ShapePoint { name: "a<b".into(), place: "hub".into(), at_m: [1.5, -0.7], re, im };
        let html = numbers(&[point(0.3, 0.4), point(-1.0, 0.0), point(0.001, 0.0)]);
        let text = html.as_str();
        assert!(text.contains(">0.500</td><td class=\"number\">53.1<"), "{text}");
        assert!(
            text.contains(">1.000</td><td class=\"number\">180.0<") && text.contains(">−0.70<"),
            "{text}"
        );
        assert!(text.contains(">0.001</td><td class=\"number\">–<") && text.contains("a&lt;b"), "{text}");
    }

    #[test]
    fn modes_without_points_have_no_panel_and_keep_their_numbers() {
        let point = ShapePoint { name: "p".into(), place: "body".into(), at_m: [0.0; 2], re: 1.0, im: 0.0 };
        let mut modes = vec![IdentifiedMode::default(); 2];
        let outcome = |modes: &[IdentifiedMode]| IdentifyOutcome {
            modes: modes.to_vec(),
            ..IdentifyOutcome::default()
        };
        assert!(shapes(&outcome(&modes), &mut Plots::default()).is_none());
        modes[1].points.push(point);
        let html = shapes(&outcome(&modes), &mut Plots::default()).unwrap();
        assert!(html.as_str().contains("id=\"shape-2\"") && !html.as_str().contains("id=\"shape-1\""));
    }
}
