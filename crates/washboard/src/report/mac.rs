//! The modal assurance criteria as a table whose colours are as dark as the shapes are alike.

use super::Plots;
use super::html::{Html, classed, element, note};
use super::numbers::fixed;
use crate::study::IdentifyOutcome;

/// Shades from white to dark; each has a class of the style sheet, with text that stands out on it.
const SHADES: f64 = 10.0;

/// All modes against all modes.
pub(super) fn mac(outcome: &IdentifyOutcome, _: &mut Plots) -> Option<Html> {
    let (mac, modes) = (&outcome.mac, &outcome.modes);
    let square =
        !mac.is_empty() && mac.len() == modes.len() && mac.iter().all(|row| row.len() == modes.len());
    if !square {
        return None;
    }
    let number = |k: usize| (k + 1).to_string();
    let head: Html = (0..modes.len())
        .map(|k| element("th", &[("scope", "col"), ("title", modes[k].label.as_str())], number(k)))
        .collect();
    let head = element("tr", &[], element("th", &[("scope", "col")], "mode").and(head));
    let rows: Html = mac
        .iter()
        .enumerate()
        .map(|(i, row)| {
            let name = format!("{} {}", number(i), modes[i].label);
            let cells: Html = row.iter().enumerate().map(|(j, v)| cell(*v, i == j)).collect();
            element("tr", &[], element("th", &[("scope", "row")], name).and(cells))
        })
        .collect();
    let inside = element("thead", &[], head).and(element("tbody", &[], rows));
    let table = element("div", &[("class", "scroll")], element("table", &[("class", "mac")], inside));
    Some(table.and(note(
        "The modal assurance criterion |aᴴb|²/(aᴴa · bᴴb) of two shapes: 1 for shapes that are alike, 0 for shapes that \
         have nothing in common. A value near 1 off the diagonal says that these sensors do not tell two modes apart.",
    )))
}

fn cell(value: f64, diagonal: bool) -> Html {
    if !value.is_finite() {
        return classed("td", "number", "–");
    }
    let shade = (value.clamp(0.0, 1.0) * SHADES).round();
    let class = format!("number shade-{shade:.0}{}", if diagonal { " diagonal" } else { "" });
    classed("td", &class, fixed(value, 2))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::IdentifiedMode;

    #[test]
    fn numbers_are_the_outcomes_and_a_table_of_another_size_is_left_out() {
        let modes = vec![IdentifiedMode { label: "a<b".into(), ..IdentifiedMode::default() }; 2];
        let mut outcome = IdentifyOutcome { modes, ..IdentifyOutcome::default() };
        assert!(mac(&outcome, &mut Plots::default()).is_none());
        outcome.mac = vec![vec![1.0, 0.254], vec![0.254, f64::NAN]];
        let html = mac(&outcome, &mut Plots::default()).unwrap();
        assert!(html.as_str().contains("class=\"number shade-10 diagonal\">1.00<"), "{html:?}");
        assert_eq!(html.as_str().matches("class=\"number shade-3\">0.25<").count(), 2, "{html:?}");
        assert!(html.as_str().contains("a&lt;b") && html.as_str().contains(">–<"));
        outcome.mac.pop();
        assert!(mac(&outcome, &mut Plots::default()).is_none());
    }
}
