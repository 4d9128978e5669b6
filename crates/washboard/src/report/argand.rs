//! A mode's points in the complex plane: who moves first.

use super::html::{Html, classed, element};
use super::scene::{coordinate, drawable, is_wheel};
use crate::study::ShapePoint;

/// The components in the complex plane: an arrow a point, and the hand that turns with time. What stands in the
/// hand's direction is at its highest.
pub(super) fn argand(points: &[ShapePoint]) -> Html {
    const MIDDLE: f64 = 110.0;
    const RADIUS: f64 = 84.0;
    const TOGETHER: f64 = 13.0;
    let points = drawable(points);
    let n = coordinate;
    let m = n(MIDDLE);
    let circle = |r: f64, class: &str| {
        element("circle", &[("cx", &m), ("cy", &m), ("r", &n(r)), ("class", class)], "")
    };
    let line = |[x, y]: [f64; 2], class: &str| {
        element("line", &[("x1", &m), ("y1", &m), ("x2", &n(x)), ("y2", &n(y)), ("class", class)], "")
    };
    let text = |[x, y]: [f64; 2], class: &str, inside: &str| {
        element("text", &[("x", &n(x)), ("y", &n(y)), ("class", class)], inside)
    };
    let tip = |p: &ShapePoint| [MIDDLE + RADIUS * p.re, MIDDLE - RADIUS * p.im];
    let mut body = circle(RADIUS, "rim").and(circle(RADIUS / 2.0, "rim"));
    for end in [
        [MIDDLE - RADIUS, MIDDLE],
        [MIDDLE + RADIUS, MIDDLE],
        [MIDDLE, MIDDLE - RADIUS],
        [MIDDLE, MIDDLE + RADIUS],
    ] {
        body.push(line(end, "rim"));
    }
    for ([x, y], word) in [
        ([MIDDLE + RADIUS + 12.0, MIDDLE], "0°"),
        ([MIDDLE, MIDDLE - RADIUS - 12.0], "90°"),
        ([MIDDLE - RADIUS - 13.0, MIDDLE], "180°"),
        ([MIDDLE, MIDDLE + RADIUS + 12.0], "−90°"),
    ] {
        body.push(text([x, y], "degrees", word));
    }
    body.push(line([MIDDLE + RADIUS, MIDDLE], "hand"));
    let mut crowds: Vec<([f64; 2], Vec<usize>)> = Vec::new();
    for (k, p) in points.iter().enumerate() {
        let end = tip(p);
        let class = if is_wheel(p) { "arrow of-wheel" } else { "arrow" };
        body.push(line(end, class));
        body.push(element(
            "circle",
            &[("cx", &n(end[0])), ("cy", &n(end[1])), ("r", "3.2"), ("class", class)],
            "",
        ));
        match crowds.iter_mut().find(|(c, _)| (c[0] - end[0]).hypot(c[1] - end[1]) < TOGETHER) {
            Some((_, crowd)) => crowd.push(k + 1),
            None => crowds.push((end, vec![k + 1])),
        }
    }
    for (end, crowd) in crowds {
        let (dx, dy) = (end[0] - MIDDLE, end[1] - MIDDLE);
        let far = dx.hypot(dy);
        // outwards, and above the middle for what does not move
        let [dx, dy] = if far > TOGETHER { [dx / far, dy / far] } else { [0.0, -1.0] };
        let away = 9.0 + 3.0 * (crowd.len() as f64 - 1.0) * dx.abs();
        body.push(text([end[0] + away * dx, end[1] - 5.0 + away * dy], "number", &ranges(&crowd)));
    }
    let around = [
        ("viewBox", "0 0 220 220"),
        ("class", "argand"),
        ("role", "img"),
        ("aria-label", "Phases of the points"),
    ];
    classed("figure", "phases", element("svg", &around, body))
}

/// 1–4, 7.
fn ranges(numbers: &[usize]) -> String {
    let mut runs: Vec<(usize, usize)> = Vec::new();
    for n in numbers {
        match runs.last_mut() {
            Some((_, last)) if *last + 1 == *n => *last = *n,
            _ => runs.push((*n, *n)),
        }
    }
    let words = runs.iter().map(|(a, b)| match b - a {
        0 => a.to_string(),
        1 => format!("{a}, {b}"),
        _ => format!("{a}–{b}"),
    });
    words.collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_a_row_are_a_range() {
        assert_eq!(ranges(&[1, 2, 3, 4, 7]), "1–4, 7");
        assert_eq!(ranges(&[5, 6]), "5, 6");
    }
}
