//! A figure as SVG for print: axes, curves told apart without colour, a legend; no script, no fonts of its own.

use super::html::{Html, element};
use crate::study::Figure;

/// Size of the drawing and of the frame in it, in points.
const SIZE: [f64; 2] = [640.0, 440.0];
const FRAME: [[f64; 2]; 2] = [[74.0, 56.0], [622.0, 380.0]];
/// Colours and dashes of curves, in turn: those of `plots.js`.
const LINES: [(&str, &str); 5] =
    [("#0b4a72", ""), ("#c2470b", "7 4"), ("#3a7d44", "2 3"), ("#16202a", "9 3 2 3"), ("#7b4ea3", "4 2")];
/// Ticks that an axis has at most.
const TICKS: usize = 8;
/// Below so many decades a logarithmic axis has ticks at 2 and 5, too.
const FEW_DECADES: f64 = 2.5;
/// A tick this near beyond an end is the end, in decades or steps.
const NEAR: f64 = 1e-9;

/// The SVG file of a figure; values that an axis cannot show are gaps.
///
/// ```
/// use washboard::study::{Curve, Figure};
/// let figure = Figure {
///     name: "thesis.fig-4.3".into(), title: "a < b".into(), x_label: "f, Hz".into(), x_log: true, y_label: "|T|".into(), y_log: true,
///     x: vec![0.1, 1.0, 10.0], curves: vec![Curve { label: "passive".into(), y: vec![1.0, 0.0, 3.0] }],
/// };
/// let svg = washboard::report::figure_svg(&figure);
/// assert!(svg.starts_with("<svg xmlns=") && svg.contains("a &lt; b") && !svg.contains("NaN"));
/// ```
#[must_use]
pub fn figure_svg(figure: &Figure) -> String {
    let x = Scale::of(figure.x.iter(), figure.x_log, [FRAME[0][0], FRAME[1][0]]);
    let y = Scale::of(figure.curves.iter().flat_map(|c| &c.y), figure.y_log, [FRAME[1][1], FRAME[0][1]]);
    let mut inside = text([SIZE[0] / 2.0, 20.0], "middle", "14", &figure.title);
    inside.push(grid(&x, &y));
    for (k, curve) in figure.curves.iter().enumerate() {
        let (colour, dash) = LINES[k % LINES.len()];
        let path = path(&figure.x, &curve.y, &x, &y);
        let line = [
            ("d", path.as_str()),
            ("fill", "none"),
            ("stroke", colour),
            ("stroke-width", "1.6"),
            ("stroke-dasharray", dash),
        ];
        inside.push(element("path", &line, ""));
        inside.push(legend(k, figure.curves.len(), &curve.label));
    }
    let middle = [(FRAME[0][0] + FRAME[1][0]) / 2.0, (FRAME[0][1] + FRAME[1][1]) / 2.0];
    inside.push(text([middle[0], SIZE[1] - 22.0], "middle", "13", &figure.x_label));
    let upright = format!("rotate(-90 18 {})", middle[1]);
    inside.push(element(
        "g",
        &[("transform", &upright)],
        text([18.0, middle[1]], "middle", "13", &figure.y_label),
    ));
    let box_ = format!("0 0 {} {}", SIZE[0], SIZE[1]);
    let attributes = [
        ("xmlns", "http://www.w3.org/2000/svg"),
        ("viewBox", box_.as_str()),
        ("width", "640"),
        ("height", "440"),
        ("font-family", "sans-serif"),
        ("role", "img"),
        ("aria-label", figure.title.as_str()),
    ];
    let paper = element("rect", &[("width", "640"), ("height", "440"), ("fill", "#fff")], "");
    format!("{}\n", element("svg", &attributes, paper.and(inside)).as_str())
}

/// Values to points.
struct Scale {
    log: bool,
    ends: [f64; 2],
    at: [f64; 2],
}

impl Scale {
    fn of<'a>(values: impl Iterator<Item = &'a f64>, log: bool, at: [f64; 2]) -> Self {
        let shown = values.copied().filter(|v| v.is_finite() && (!log || *v > 0.0));
        let shown = shown.map(|v| if log { v.log10() } else { v });
        let (low, high) = shown.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        let ends = match high - low {
            d if d > 0.0 => [low, high],
            0.0 => [low - 0.5, high + 0.5],
            _ => [0.0, 1.0],
        };
        Scale { log, ends, at }
    }

    fn point(&self, value: f64) -> Option<f64> {
        let v = if self.log { (value > 0.0).then(|| value.log10())? } else { value };
        let share = (v - self.ends[0]) / (self.ends[1] - self.ends[0]);
        v.is_finite().then(|| self.at[0] + share * (self.at[1] - self.at[0]))
    }

    /// Round values, and what is written at them.
    fn ticks(&self) -> Vec<(f64, String)> {
        let [low, high] = self.ends;
        if self.log && high - low > 1.0 {
            let step = ((high - low) / TICKS as f64).ceil().max(1.0);
            let first = (low / step - 1.0).floor() as i64;
            let last = (high / step).floor() as i64;
            let between: &[f64] = if high - low < FEW_DECADES { &[1.0, 2.0, 5.0] } else { &[1.0] };
            let decade = |k: i64| between.iter().map(move |m| m * 10f64.powf(k as f64 * step));
            let inside = |v: &f64| (low - NEAR..=high + NEAR).contains(&v.log10());
            return (first..=last).flat_map(decade).filter(inside).map(|v| (v, written(v))).collect();
        }
        let [low, high] = if self.log { [10f64.powf(low), 10f64.powf(high)] } else { [low, high] };
        let raw = (high - low) / (TICKS - 2) as f64;
        let power = 10f64.powf(raw.log10().floor());
        let step = power * [1.0, 2.0, 5.0, 10.0].into_iter().find(|m| m * power >= raw).unwrap_or(10.0);
        let (first, last) = ((low / step - NEAR).ceil() as i64, (high / step + NEAR).floor() as i64);
        (first..=last).map(|k| k as f64 * step).map(|v| (v, written(v))).collect()
    }
}

/// A tick's number, without the digits that binary adds.
fn written(v: f64) -> String {
    let kept: f64 = format!("{v:.5e}").parse().unwrap_or(v);
    if kept != 0.0 && !(1e-4..1e6).contains(&kept.abs()) {
        format!("{kept:e}")
    } else {
        format!("{}", kept + 0.0)
    }
}

fn text(at: [f64; 2], anchor: &str, size: &str, words: &str) -> Html {
    let [x, y] = at.map(|v| format!("{v:.1}"));
    element("text", &[("x", &x), ("y", &y), ("text-anchor", anchor), ("font-size", size)], words)
}

fn line(from: [f64; 2], to: [f64; 2], colour: &str) -> Html {
    let [x1, y1, x2, y2] = [from[0], from[1], to[0], to[1]].map(|v| format!("{v:.1}"));
    element("line", &[("x1", &x1), ("y1", &y1), ("x2", &x2), ("y2", &y2), ("stroke", colour)], "")
}

fn grid(x: &Scale, y: &Scale) -> Html {
    let mut all = Html::default();
    for (at, label) in x.ticks().iter().filter_map(|(v, l)| Some((x.point(*v)?, l))) {
        all.push(line([at, FRAME[0][1]], [at, FRAME[1][1]], "#d8dde2"));
        all.push(text([at, FRAME[1][1] + 17.0], "middle", "12", label));
    }
    for (at, label) in y.ticks().iter().filter_map(|(v, l)| Some((y.point(*v)?, l))) {
        all.push(line([FRAME[0][0], at], [FRAME[1][0], at], "#d8dde2"));
        all.push(text([FRAME[0][0] - 6.0, at + 4.0], "end", "12", label));
    }
    let [[left, top], [right, bottom]] = FRAME;
    all.push(line([left, bottom], [right, bottom], "#16202a"));
    all.push(line([left, top], [left, bottom], "#16202a"));
    all
}

fn path(x: &[f64], values: &[f64], across: &Scale, up: &Scale) -> String {
    let mut d = String::new();
    let mut drawing = false;
    for (x, y) in x.iter().zip(values) {
        match (across.point(*x), up.point(*y)) {
            (Some(x), Some(y)) => {
                d += &format!("{}{x:.2} {y:.2}", if drawing { "L" } else { "M" });
                drawing = true;
            }
            _ => drawing = false,
        }
    }
    d
}

/// Above the frame, side by side.
fn legend(k: usize, of: usize, label: &str) -> Html {
    let (colour, dash) = LINES[k % LINES.len()];
    let width = (FRAME[1][0] - FRAME[0][0]) / of.max(1) as f64;
    let x = FRAME[0][0] + k as f64 * width;
    let [x1, x2] = [x, x + 22.0].map(|v| format!("{v:.1}"));
    let attributes = [
        ("x1", x1.as_str()),
        ("x2", x2.as_str()),
        ("y1", "40"),
        ("y2", "40"),
        ("stroke", colour),
        ("stroke-width", "1.6"),
        ("stroke-dasharray", dash),
    ];
    element("line", &attributes, "").and(text([x + 26.0, 44.0], "start", "11", label))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_few() {
        let scale = |low: f64, high: f64, log| Scale::of([low, high].iter(), log, [0.0, 1.0]);
        let texts = |s: Scale| s.ticks().into_iter().map(|t| t.1).collect::<Vec<_>>();
        assert_eq!(texts(scale(0.1 + 1e-16, 100.0, true)), ["0.1", "1", "10", "100"]);
        assert_eq!(texts(scale(0.3, 25.0, true)), ["0.5", "1", "2", "5", "10", "20"]);
        assert_eq!(texts(scale(0.0, 100.0, false)), ["0", "20", "40", "60", "80", "100"]);
        assert_eq!(texts(scale(0.03, 0.09, true)), ["0.03", "0.04", "0.05", "0.06", "0.07", "0.08", "0.09"]);
        assert_eq!(texts(scale(2.0, 2.0, false)), ["1.6", "1.8", "2", "2.2", "2.4"]);
    }
}
