//! A chart of a sweep's points as drawn lines and dots: there without JavaScript, each dot with its point's number.

use super::html::{Html, element};
use super::numbers::plain;
use super::scene::coordinate;

const WIDTH: f64 = 460.0;
const HEIGHT: f64 = 330.0;
/// Left, right, top and bottom of the frame.
const FRAME: [f64; 4] = [62.0, 446.0, 14.0, 282.0];
/// A scale whose values span more than this, all positive, is logarithmic.
const LOG: f64 = 30.0;
/// Free room beside the outermost values, of the scale.
const ROOM: f64 = 0.06;

/// A dot.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Dot {
    /// Of the point.
    pub index: usize,
    pub x: f64,
    pub y: f64,
    /// Drawn strong.
    pub front: bool,
    /// What is said of it where one points at it.
    pub title: String,
}

/// Values joined by a line, without dots of their own.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Stroke {
    pub class: &'static str,
    /// What it is, written beside it; empty for none.
    pub label: &'static str,
    /// Its own; what the class says where it is empty.
    pub colour: String,
    pub points: Vec<[f64; 2]>,
}

/// A chart.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Chart {
    pub title: String,
    pub x_label: String,
    pub y_label: String,
    pub dots: Vec<Dot>,
    pub strokes: Vec<Stroke>,
    /// Dashed lines at the passive vehicle's values.
    pub passive: [Option<f64>; 2],
}

/// A scale: where a value is drawn.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scale {
    low: f64,
    high: f64,
    log: bool,
    from: f64,
    to: f64,
}

impl Scale {
    /// For values, drawn between two places.
    pub fn new(values: impl Iterator<Item = f64> + Clone, from: f64, to: f64) -> Option<Self> {
        let finite = values.filter(|v| v.is_finite());
        let low = finite.clone().fold(f64::INFINITY, f64::min);
        let high = finite.fold(f64::NEG_INFINITY, f64::max);
        let log = low > 0.0 && high / low > LOG;
        let of = |v: f64| if log { v.log10() } else { v };
        let (low, high) = (of(low), of(high));
        if !(low.is_finite() && high.is_finite()) {
            return None;
        }
        // a single value stands in the middle
        let room = if high > low { ROOM * (high - low) } else { high.abs().max(1.0) * ROOM };
        Some(Scale { low: low - room, high: high + room, log, from, to })
    }

    /// Where a value is.
    pub fn at(&self, value: f64) -> f64 {
        let v = if self.log { value.log10() } else { value };
        self.from + (v - self.low) / (self.high - self.low) * (self.to - self.from)
    }

    /// Round values within, about so many.
    pub fn ticks(&self, about: f64) -> Vec<f64> {
        let size = (self.high - self.low) / about;
        let decade = 10f64.powf(size.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|s| s * decade).into_iter().find(|s| *s >= size).unwrap_or(size);
        let step = if self.log { step.max(1.0).round() } else { step };
        let (first, last) = ((self.low / step).ceil() as i64, (self.high / step).floor() as i64);
        let values =
            (first..=last).map(|k| if self.log { 10f64.powf(k as f64 * step) } else { k as f64 * step });
        values.collect()
    }
}

/// A text of the chart.
pub(super) fn text(x: f64, y: f64, class: &'static str, inside: &str) -> Html {
    element("text", &[("x", &coordinate(x)), ("y", &coordinate(y)), ("class", class)], inside)
}

/// A straight line of the chart.
pub(super) fn line(a: [f64; 2], b: [f64; 2], class: &'static str) -> Html {
    let [x1, y1, x2, y2] = [a[0], a[1], b[0], b[1]].map(coordinate);
    element("line", &[("x1", &x1), ("y1", &y1), ("x2", &x2), ("y2", &y2), ("class", class)], "")
}

/// Places of a line with corners.
pub(super) fn joined(points: impl Iterator<Item = [f64; 2]>) -> String {
    points.map(|[x, y]| format!("{},{}", coordinate(x), coordinate(y))).collect::<Vec<_>>().join(" ")
}

impl Chart {
    /// Its figure; none without dots.
    pub fn draw(&self) -> Option<Html> {
        let [left, right, top, bottom] = FRAME;
        let along = |k: usize| {
            let strokes = self.strokes.iter().flat_map(move |s| s.points.iter().map(move |p| p[k]));
            let dots = self.dots.iter().map(move |d| if k == 0 { d.x } else { d.y });
            dots.chain(strokes).chain(self.passive[k])
        };
        if self.dots.is_empty() {
            return None;
        }
        let x = Scale::new(along(0), left, right)?;
        let y = Scale::new(along(1), bottom, top)?;
        let mut body = Html::default();
        for v in x.ticks(5.0) {
            body.push(line([x.at(v), top], [x.at(v), bottom], "mesh"));
            body.push(text(x.at(v), bottom + 16.0, "tick below", &plain(v)));
        }
        for v in y.ticks(5.0) {
            body.push(line([left, y.at(v)], [right, y.at(v)], "mesh"));
            body.push(text(left - 6.0, y.at(v), "tick beside", &plain(v)));
        }
        if let Some(v) = self.passive[0] {
            body.push(line([x.at(v), top], [x.at(v), bottom], "passive"));
        }
        if let Some(v) = self.passive[1] {
            body.push(line([left, y.at(v)], [right, y.at(v)], "passive"));
        }
        for s in &self.strokes {
            let places = joined(s.points.iter().map(|p| [x.at(p[0]), y.at(p[1])]));
            let mut around = vec![("points", places.as_str()), ("class", s.class)];
            // an attribute of its own: the page's policy forbids styles at elements
            around.extend((!s.colour.is_empty()).then_some(("stroke", s.colour.as_str())));
            body.push(element("polyline", &around, ""));
        }
        let mut dots = Html::default();
        // strong dots over the others
        for front in [false, true] {
            for d in self.dots.iter().filter(|d| d.front == front) {
                let (cx, cy) = (coordinate(x.at(d.x)), coordinate(y.at(d.y)));
                let class = if front { "dot front" } else { "dot" };
                let (index, r) = (d.index.to_string(), if front { "4.2" } else { "3.4" });
                let around =
                    [("cx", cx.as_str()), ("cy", &cy), ("r", r), ("class", class), ("data-point", &index)];
                dots.push(element("circle", &around, element("title", &[], d.title.as_str())));
            }
        }
        body.push(element("g", &[], dots));
        body.push(self.words(&x, &y));
        body.push(text(0.5 * (left + right), HEIGHT - 10.0, "label", &self.x_label));
        let turned = format!("rotate(-90 14 {})", coordinate(0.5 * (top + bottom)));
        let place = [
            ("x", "14"),
            ("y", &coordinate(0.5 * (top + bottom))),
            ("class", "label"),
            ("transform", &turned),
        ];
        body.push(element("text", &place, self.y_label.as_str()));
        let size = format!("0 0 {WIDTH} {HEIGHT}");
        let around =
            [("viewBox", size.as_str()), ("class", "chart"), ("role", "img"), ("aria-label", &self.title)];
        Some(element(
            "figure",
            &[],
            element("figcaption", &[], self.title.as_str()).and(element("svg", &around, body)),
        ))
    }

    /// Names of lines, each beside its own and where the fewest others are.
    fn words(&self, x: &Scale, y: &Scale) -> Html {
        let [left, right, top, bottom] = FRAME;
        let place = |p: &[f64; 2]| [x.at(p[0]), y.at(p[1])];
        let level = self.passive[1].map(|v| ("passive", vec![[left, y.at(v)], [right, y.at(v)]]));
        let named = self.strokes.iter().filter(|s| !s.label.is_empty());
        let named: Vec<(&str, Vec<[f64; 2]>)> =
            level.into_iter().chain(named.map(|s| (s.label, s.points.iter().map(place).collect()))).collect();
        let mut busy: Vec<[f64; 2]> = self.dots.iter().map(|d| [x.at(d.x), y.at(d.y)]).collect();
        for s in &self.strokes {
            busy.extend(trail(&s.points.iter().map(place).collect::<Vec<_>>()));
        }
        named.iter().filter(|n| n.1.len() == 2 && n.0 == "passive").for_each(|n| busy.extend(trail(&n.1)));
        let upright = self.passive[0].map(|v| trail(&[[x.at(v), top], [x.at(v), bottom]]));
        busy.extend(upright.unwrap_or_default());
        let mut all = Html::default();
        for (word, points) in &named {
            let half = 0.5 * LETTER * word.chars().count() as f64;
            let spots = trail(points).into_iter().flat_map(|[x, y]| ASIDE.map(|d| ([x, y + d], d)));
            let inside = spots.filter(|(s, _)| {
                s[0] - half > left && s[0] + half < right && s[1] - 6.0 > top && s[1] + 6.0 < bottom
            });
            let crowd = |s: &[f64; 2]| {
                let near = |b: &&[f64; 2]| (b[0] - s[0]).abs() < half + 4.0 && (b[1] - s[1]).abs() < 6.5;
                busy.iter().filter(near).count()
            };
            // of equally free ones the nearest to the line, and of these the one at the right
            let best = inside.min_by_key(|(s, d)| (crowd(s), d.abs() as i64, (right - s[0]) as i64));
            let Some((spot, _)) = best else { continue };
            all.push(text(spot[0], spot[1], "word", word));
            let taken = [-half, 0.0, half].map(|d| [spot[0] + d, spot[1]]);
            busy.extend(taken);
        }
        all
    }
}

/// How far a name may be from its line.
const ASIDE: [f64; 4] = [-8.0, 9.0, -15.0, 17.0];
/// Width of a letter of a name.
const LETTER: f64 = 6.0;

/// Places along a line, near enough that no word fits between two.
fn trail(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    const STEP: f64 = 4.0;
    let part = |w: &[[f64; 2]]| {
        let ([a, b], n) =
            ([w[0], w[1]], ((w[1][0] - w[0][0]).hypot(w[1][1] - w[0][1]) / STEP).ceil().max(1.0));
        let at = move |k: usize| [0, 1].map(|c| a[c] + (b[c] - a[c]) * k as f64 / n);
        (0..=n as usize).map(at).collect::<Vec<_>>()
    };
    points.windows(2).flat_map(part).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scale_has_round_marks_and_keeps_its_ends() {
        let s = Scale::new([0.0, 100.0].into_iter(), 0.0, 1.0).unwrap();
        assert_eq!(s.ticks(5.0), [0.0, 50.0, 100.0]);
        assert!(s.at(0.0) > 0.0 && s.at(100.0) < 1.0 && (s.at(50.0) - 0.5).abs() < 1e-12);
        let decades = Scale::new([1e-9, 1e-6].into_iter(), 0.0, 1.0).unwrap();
        assert_eq!(decades.ticks(5.0).len(), 4);
        assert!((decades.at(1e-8) - decades.at(1e-9) - (decades.at(1e-6) - decades.at(1e-7))).abs() < 1e-12);
        let one = Scale::new([3.0].into_iter(), 0.0, 1.0).unwrap();
        assert!((one.at(3.0) - 0.5).abs() < 1e-12);
        assert!(Scale::new([f64::NAN].into_iter(), 0.0, 1.0).is_none());
    }

    #[test]
    fn a_word_stands_where_no_line_is() {
        // a stroke climbs over the right end of the passive line: its name goes to the left
        let stroke = |label, points: &[[f64; 2]]| Stroke {
            class: "row",
            label,
            colour: String::new(),
            points: points.to_vec(),
        };
        let dots = [0.0, 1.0].map(|v| Dot { index: 0, x: v, y: 2.0 * v, front: true, title: String::new() });
        let chart = Chart {
            dots: dots.to_vec(),
            strokes: vec![stroke("", &[[0.6, 0.9], [1.0, 1.1]]), stroke("", &[[0.6, 1.1], [1.0, 0.9]])],
            passive: [None, Some(1.0)],
            ..Chart::default()
        };
        let drawn = chart.draw().unwrap();
        let (_, rest) = drawn
            .as_str()
            .split_once("passive</text>")
            .map_or(("", ""), |(a, _)| a.rsplit_once("<text x=\"").unwrap());
        let at: f64 = rest.split_once('"').unwrap().0.parse().unwrap();
        let begin = Scale::new([0.0, 1.0].into_iter(), FRAME[0], FRAME[1]).unwrap().at(0.6);
        assert!(at + 0.5 * LETTER * 7.0 < begin, "{at} {begin}");
        // after the lines that it is beside
        assert!(drawn.as_str().rfind("<polyline") < drawn.as_str().rfind("passive</text>"));
    }

    #[test]
    fn names_are_escaped_and_a_chart_of_nothing_is_none() {
        assert!(Chart::default().draw().is_none());
        let dot = Dot { index: 3, x: 1.0, y: 2.0, front: true, title: "</svg><script>".into() };
        let chart = Chart { x_label: "<b>".into(), dots: vec![dot], ..Chart::default() };
        let drawn = chart.draw().unwrap();
        assert!(!drawn.as_str().contains("<script>") && !drawn.as_str().contains("<b>"));
        assert!(drawn.as_str().contains("data-point=\"3\""));
    }
}
