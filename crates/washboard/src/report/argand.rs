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
    let degrees = [
        ([MIDDLE + RADIUS + 12.0, MIDDLE], "0°"),
        ([MIDDLE, MIDDLE - RADIUS - 12.0], "90°"),
        ([MIDDLE - RADIUS - 13.0, MIDDLE], "180°"),
        ([MIDDLE, MIDDLE + RADIUS + 12.0], "−90°"),
    ];
    for (at, word) in degrees {
        body.push(text(at, "degrees", word));
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
    // what a number is not to lie on: degrees, arrows, and the numbers before it
    let mut busy: Vec<Extent> = degrees.iter().map(|(at, word)| Extent::of(*at, word)).collect();
    for p in &points {
        let end = tip(p);
        let part = |k: usize| [0, 1].map(|c| MIDDLE + (end[c] - MIDDLE) * k as f64 / PARTS as f64);
        busy.extend((0..=PARTS).map(part).map(|at| Extent { at, half: [2.0, 2.0] }));
    }
    for (end, crowd) in crowds {
        let words = ranges(&crowd);
        let place = beside(end, [MIDDLE; 2], &words, &busy);
        body.push(text(place.at, "number", &words));
        busy.push(place);
    }
    let around = [
        ("viewBox", "0 0 220 220"),
        ("class", "argand"),
        ("role", "img"),
        ("aria-label", "Phases of the points"),
    ];
    classed("figure", "phases", element("svg", &around, body))
}

/// Parts of an arrow, each smaller than a letter.
const PARTS: usize = 30;

/// Where a text is: its middle, and half its width and height.
#[derive(Debug, Clone, Copy)]
struct Extent {
    at: [f64; 2],
    half: [f64; 2],
}

impl Extent {
    fn of(at: [f64; 2], words: &str) -> Self {
        Extent { at, half: [3.2 * words.chars().count() as f64, 6.0] }
    }

    fn meets(&self, other: &Extent) -> bool {
        (0..2).all(|c| (self.at[c] - other.at[c]).abs() < self.half[c] + other.half[c])
    }
}

/// The free place for a number beside an arrow's end, as far outwards as there is one.
fn beside(end: [f64; 2], middle: [f64; 2], words: &str, busy: &[Extent]) -> Extent {
    const TURNS: i32 = 12;
    let (dx, dy) = (end[0] - middle[0], end[1] - middle[1]);
    // upwards for what does not move
    let outwards = if dx.hypot(dy) > 1.0 { dy.atan2(dx) } else { -std::f64::consts::FRAC_PI_2 };
    let mut best: Option<(usize, Extent)> = None;
    for away in [10.0, 14.0, 18.0, 24.0] {
        for turn in 0..=TURNS {
            for side in [1.0, -1.0] {
                let angle = outwards + side * std::f64::consts::PI * f64::from(turn) / f64::from(TURNS);
                let wide = Extent::of(end, words).half[0] - 3.2;
                let at = [end[0] + (away + wide) * angle.cos(), end[1] + away * angle.sin()];
                let place = Extent::of(at, words);
                let met = busy.iter().filter(|b| b.meets(&place)).count();
                if best.is_none_or(|(least, _)| met < least) {
                    best = Some((met, place));
                }
            }
        }
    }
    best.map_or_else(|| Extent::of(end, words), |(_, place)| place)
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
    fn a_number_lies_on_no_degree_and_on_no_arrow() {
        let zero = Extent::of([206.0, 110.0], "0°");
        let arrow: Vec<Extent> =
            (0..=84).map(|k| Extent { at: [110.0 + f64::from(k), 110.0], half: [2.0, 2.0] }).collect();
        let mut busy = arrow;
        busy.push(zero);
        for words in ["1, 2", "3, 4"] {
            let place = beside([194.0, 110.0], [110.0; 2], words, &busy);
            assert!(busy.iter().all(|b| !b.meets(&place)), "{words} {place:?}");
            busy.push(place);
        }
    }

    #[test]
    fn numbers_in_a_row_are_a_range() {
        assert_eq!(ranges(&[1, 2, 3, 4, 7]), "1–4, 7");
        assert_eq!(ranges(&[5, 6]), "5, 6");
    }
}
