//! The modes: their intervals in a table, their shapes as bars.

use super::Plots;
use super::html::{Html, classed, element, note, table};
use super::numbers::{fixed, interval, with_sd};
use super::plot::Mark;
use super::shapes::has_panel;
use crate::study::{IdentifiedMode, IdentifyOutcome, ShapeValue};

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
    let collinear = outcome.modes.iter().any(|m| m.mpc.is_some());
    let turned = outcome.modes.iter().any(|m| m.mean_phase_deg.is_some());
    let mut heads = vec!["# no.", "motion"];
    heads.extend(if known {
        &["# f ± sd, Hz", "# 95 % interval, Hz", "# ζ ± sd, %", "# 95 % interval, %"][..]
    } else {
        &["# f, Hz", "# ζ, %"][..]
    });
    heads.extend(collinear.then_some("# MPC"));
    heads.extend(turned.then_some("# mean phase, °"));
    let rows = outcome.modes.iter().enumerate().map(|(k, m)| {
        let (zeta, zeta_sd) = (100.0 * m.damping, m.damping_sd.map(|s| 100.0 * s));
        let mut row: Vec<Html> = vec![(k + 1).to_string().into(), name(k, m)];
        row.push(with_sd(m.freq_hz, m.freq_sd_hz).into());
        if known {
            row.push(interval(m.freq_hz, m.freq_sd_hz).unwrap_or_else(|| "–".into()).into());
        }
        row.push(with_sd(zeta, zeta_sd).into());
        if known {
            row.push(interval(zeta, zeta_sd).unwrap_or_else(|| "–".into()).into());
        }
        let cell = |v: Option<f64>, decimals| v.map_or_else(|| "–".to_owned(), |v| fixed(v, decimals)).into();
        row.extend(collinear.then(|| cell(m.mpc, 3)));
        row.extend(turned.then(|| cell(m.mean_phase_deg, 1)));
        row
    });
    let mut body = table("f = |λ|/2π and ζ = −Re λ/|λ| of each mode’s pole λ", &heads, rows.collect());
    if collinear {
        body.push(note(
            "MPC, the modal phase collinearity, is 1 for a standing motion and 0 for a travelling one. Strongly damped \
             vehicles have complex shapes: a low value is no fault.",
        ));
    }
    if outcome.modes.iter().any(|m| !m.shape.is_empty()) {
        let cards = outcome.modes.iter().enumerate().filter(|(_, m)| !m.shape.is_empty());
        let cards = classed("div", "shapes", cards.map(|(k, m)| card(k, m)).collect::<Html>());
        // where the vehicle itself is drawn, the components are for those who look for them
        if outcome.modes.iter().all(has_panel) {
            let summary = element("summary", &[], "Components of each shape");
            body.push(element("details", &[], summary.and(cards).and(note(words(outcome)))));
        } else {
            body.push(element("h3", &[], "Components of each shape"));
            body.push(cards.and(note(words(outcome))));
        }
    }
    Some(body)
}

/// The label; a link where there is a drawing to look at.
fn name(index: usize, mode: &IdentifiedMode) -> Html {
    if has_panel(mode) {
        element("a", &[("href", &format!("#shape-{}", index + 1))], mode.label.as_str())
    } else {
        mode.label.as_str().into()
    }
}

/// What the numbers on the plots stand for.
pub(super) fn key(outcome: &IdentifyOutcome) -> String {
    let name = |(k, m): (usize, &IdentifiedMode)| {
        let (number, f) = (k + 1, fixed(m.freq_hz, 2));
        // a label that only counts says nothing beside the number
        let counts = m.label == format!("mode {number}");
        if counts { format!("{number} at {f} Hz") } else { format!("{number} {} ({f} Hz)", m.label) }
    };
    let names: Vec<String> = outcome.modes.iter().enumerate().map(name).collect();
    if names.is_empty() {
        String::new()
    } else {
        format!(" Dashed verticals are the modes: {}.", names.join(", "))
    }
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

/// The phase as the hand of a clock: to the right at 0, upwards at a quarter turn.
pub(super) fn dial(angle: f64) -> Html {
    element(
        "svg",
        &[("viewBox", "0 0 18 18"), ("class", "dial"), ("aria-hidden", "true")],
        clock(9.0, 9.0, angle),
    )
}

/// The modes as vertical lines of a plot, each with its number.
pub(super) fn marks(modes: &[IdentifiedMode]) -> Vec<Mark> {
    let finite = modes.iter().enumerate().filter(|(_, m)| m.freq_hz.is_finite());
    finite.map(|(k, m)| Mark::new(m.freq_hz, (k + 1).to_string())).collect()
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
    fn every_mode_has_its_own_mark_and_its_name_stands_in_the_key() {
        let modes: Vec<_> = [1.06, 8.13, 8.14].map(mode).to_vec();
        let labels: Vec<String> = marks(&modes).into_iter().map(|m| m.label).collect();
        assert_eq!(labels, ["1", "2", "3"]);
        let outcome = IdentifyOutcome { modes, ..IdentifyOutcome::default() };
        assert_eq!(
            key(&outcome),
            " Dashed verticals are the modes: 1 x (1.06 Hz), 2 x (8.13 Hz), 3 x (8.14 Hz)."
        );
        assert!(marks(&[]).is_empty() && key(&IdentifyOutcome::default()).is_empty());
    }

    #[test]
    fn the_largest_component_points_to_the_right_whatever_its_phase() {
        let svg = card(0, &mode(1.0));
        assert!(svg.as_str().contains("x1=\"270.0\" y1=\"9.5\" x2=\"277.0\" y2=\"9.5\""), "{svg:?}");
        assert!(svg.as_str().contains("&lt;b&gt;") && !svg.as_str().contains("<b>"));
    }
}
