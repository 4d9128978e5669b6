//! The modes: their intervals in a table, their shapes as bars.

use super::Plots;
use super::html::{Html, classed, element, note, table};
use super::numbers::{fixed, interval, with_sd};
use super::plot::Mark;
use crate::study::{IdentifiedMode, IdentifyOutcome, ShapeValue};

/// Neighbours closer than this ratio of frequencies share one label on a plot.
const LABEL_RATIO: f64 = 1.2;
/// Components below this share of the largest have no phase worth a look.
const NO_PHASE: f64 = 0.02;
/// A shape's drawing: height of a row, where bars begin, the longest bar, where the clock's middle is.
const ROW: f64 = 19.0;
const LEFT: f64 = 128.0;
const BAR: f64 = 120.0;
const CLOCK: f64 = 270.0;
/// Letters of a name that stand beside a bar.
const NAME_LETTERS: usize = 21;

/// Table of all modes, then each shape.
pub(super) fn modes(outcome: &IdentifyOutcome, _: &mut Plots) -> Option<Html> {
    if outcome.modes.is_empty() {
        return None;
    }
    let known = outcome.modes.iter().any(|m| m.freq_sd_hz.is_some() || m.damping_sd.is_some());
    let heads = if known {
        &["# no.", "motion", "# f ± sd, Hz", "# 95 % interval, Hz", "# ζ ± sd, %", "# 95 % interval, %"][..]
    } else {
        &["# no.", "motion", "# f, Hz", "# ζ, %"][..]
    };
    let rows = outcome.modes.iter().enumerate().map(|(k, m)| {
        let (zeta, zeta_sd) = (100.0 * m.damping, m.damping_sd.map(|s| 100.0 * s));
        let mut row: Vec<Html> = vec![(k + 1).to_string().into(), m.label.as_str().into()];
        row.push(with_sd(m.freq_hz, m.freq_sd_hz).into());
        if known {
            row.push(interval(m.freq_hz, m.freq_sd_hz).unwrap_or_else(|| "–".into()).into());
        }
        row.push(with_sd(zeta, zeta_sd).into());
        if known {
            row.push(interval(zeta, zeta_sd).unwrap_or_else(|| "–".into()).into());
        }
        row
    });
    let mut body = table("f = |λ|/2π and ζ = −Re λ/|λ| of each mode’s pole λ", heads, rows.collect());
    if outcome.modes.iter().any(|m| !m.shape.is_empty()) {
        let cards = outcome.modes.iter().enumerate().filter(|(_, m)| !m.shape.is_empty());
        body.push(element("h3", &[], "Shapes"));
        body.push(classed("div", "shapes", cards.map(|(k, m)| card(k, m)).collect::<Html>()));
        body.push(note(words(outcome)));
    }
    Some(body)
}

fn words(outcome: &IdentifyOutcome) -> String {
    let rotates = |s: &ShapeValue| matches!(s.dof.as_str(), "pitch" | "roll");
    let units = if outcome.modes.iter().any(|m| m.shape.iter().any(rotates)) {
        " Pitch and roll are in rad beside displacements in m: compare like with like."
    } else {
        ""
    };
    format!(
        "A bar is the size of a component, the largest being 1; the hand of its clock is the phase, to the right in phase \
         with the largest, to the left against it.{units}"
    )
}

/// A shape: a bar and a clock a component.
fn card(index: usize, mode: &IdentifiedMode) -> Html {
    let largest = mode.shape.iter().max_by(|a, b| size(a).total_cmp(&size(b)));
    let (scale, reference) =
        largest.map_or((1.0, 0.0), |l| (size(l).max(f64::MIN_POSITIVE), l.im.atan2(l.re)));
    let rows = mode.shape.iter().enumerate().map(|(k, s)| {
        let middle = ROW * (k as f64 + 0.5);
        let share = size(s) / scale;
        let angle = s.im.atan2(s.re) - reference;
        let name = text("name", LEFT - 8.0, middle, short_name(&s.dof));
        let number = |v: f64| fixed(v, 1);
        let (y, width) = (number(middle - 5.0), number((BAR * share).max(0.5)));
        let bar = element(
            "rect",
            &[("x", &number(LEFT)), ("y", &y), ("width", &width), ("height", "10")],
            element(
                "title",
                &[],
                format!("{}: {} at {}°", s.dof, fixed(share, 3), fixed(angle.to_degrees(), 0)),
            ),
        );
        let clock = if share < NO_PHASE { Html::default() } else { clock(CLOCK, middle, angle) };
        name.and(bar).and(clock)
    });
    let height = ROW * mode.shape.len() as f64;
    let title = format!("{} · {} · {} Hz", index + 1, mode.label, fixed(mode.freq_hz, 2));
    let drawing = element(
        "svg",
        &[
            ("viewBox", &format!("0 0 290 {height}")),
            ("role", "img"),
            ("aria-label", &format!("Shape of mode {title}")),
        ],
        rows.collect::<Html>(),
    );
    classed("figure", "shape", element("figcaption", &[], title).and(drawing))
}

fn clock(x: f64, y: f64, angle: f64) -> Html {
    const RADIUS: f64 = 7.0;
    let n = |v: f64| fixed(v, 1).replace('−', "-");
    let face = element("circle", &[("cx", &n(x)), ("cy", &n(y)), ("r", &n(RADIUS))], "");
    // y grows downwards on a screen
    let end = [n(x + RADIUS * angle.cos()), n(y - RADIUS * angle.sin())];
    face.and(element("line", &[("x1", &n(x)), ("y1", &n(y)), ("x2", &end[0]), ("y2", &end[1])], ""))
}

fn text(class: &str, x: f64, middle: f64, inside: String) -> Html {
    let (x, y) = (fixed(x, 1), fixed(middle + 4.0, 1));
    element("text", &[("class", class), ("x", &x), ("y", &y)], inside)
}

fn size(s: &ShapeValue) -> f64 {
    s.re.hypot(s.im)
}

fn short_name(name: &str) -> String {
    let words = name.replace('_', " ");
    if words.chars().count() <= NAME_LETTERS {
        return words;
    }
    words.chars().take(NAME_LETTERS - 1).chain(['…']).collect()
}

/// The modes as vertical lines of a plot; a run of close neighbours has one label, as `4–7`.
pub(super) fn marks(modes: &[IdentifiedMode]) -> Vec<Mark> {
    if modes.iter().any(|m| !m.freq_hz.is_finite()) {
        return Vec::new();
    }
    let mut marks = Vec::with_capacity(modes.len());
    let mut first = 0;
    for (k, mode) in modes.iter().enumerate() {
        let ends = modes.get(k + 1).is_none_or(|next| next.freq_hz > LABEL_RATIO * mode.freq_hz);
        let label = match (ends, first == k) {
            (false, _) => String::new(),
            (true, true) => (k + 1).to_string(),
            (true, false) => format!("{}–{}", first + 1, k + 1),
        };
        if ends {
            first = k + 1;
        }
        marks.push(Mark::new(mode.freq_hz, label));
    }
    marks
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mode(freq_hz: f64) -> IdentifiedMode {
        let shape = vec![ShapeValue { dof: "<b>".into(), re: 0.0, im: -1.0 }];
        IdentifiedMode {
            freq_hz,
            freq_sd_hz: None,
            damping: 0.1,
            damping_sd: None,
            pole: [0.0, 1.0],
            shape,
            label: "x".into(),
            ..IdentifiedMode::default()
        }
    }

    #[test]
    fn close_modes_share_a_label() {
        let labels = |f: &[f64]| -> Vec<String> {
            marks(&f.iter().map(|f| mode(*f)).collect::<Vec<_>>()).into_iter().map(|m| m.label).collect()
        };
        assert_eq!(labels(&[1.06, 1.52, 1.69, 8.04, 8.13, 8.2]), ["1", "", "2–3", "", "", "4–6"]);
        assert!(labels(&[]).is_empty());
    }

    #[test]
    fn the_largest_component_points_to_the_right_whatever_its_phase() {
        let svg = card(0, &mode(1.0));
        assert!(svg.as_str().contains("x1=\"270.0\" y1=\"9.5\" x2=\"277.0\" y2=\"9.5\""), "{svg:?}");
        assert!(svg.as_str().contains("&lt;b&gt;") && !svg.as_str().contains("<b>"));
    }
}
