//! Parts of a vehicle's sketch: springs, dampers, actuators, masses, the road, and numbered marks of what is measured.

use super::html::{Html, element};

/// Turns of a spring, and half its width.
const TURNS: usize = 6;
const SPRING_WIDTH: f64 = 7.0;
/// Straight ends of springs and dampers, as a share of their length.
const ENDS: f64 = 0.18;

/// A drawing in points: y is down.
#[derive(Debug, Default)]
pub(super) struct Sketch {
    inside: Html,
    marks: Html,
}

impl Sketch {
    /// The drawing of some size; marks are above all else.
    pub fn svg(self, size: [f64; 2], label: &str) -> Html {
        let view = format!("0 0 {} {}", point(size[0]), point(size[1]));
        let attributes =
            [("viewBox", view.as_str()), ("class", "sketch"), ("role", "img"), ("aria-label", label)];
        element("svg", &attributes, self.inside.and(self.marks))
    }

    fn path(&mut self, class: &str, points: &[[f64; 2]]) {
        let all: Vec<String> = points.iter().map(|p| format!("{},{}", point(p[0]), point(p[1]))).collect();
        self.inside.push(element("polyline", &[("class", class), ("points", &all.join(" "))], ""));
    }

    /// Upright, between two heights.
    pub fn spring(&mut self, x: f64, [top, bottom]: [f64; 2]) {
        let (end, length) = (ENDS * (bottom - top), (1.0 - 2.0 * ENDS) * (bottom - top));
        let mut points = vec![[x, top], [x, top + end]];
        for k in 0..TURNS {
            let side = if k % 2 == 0 { SPRING_WIDTH } else { -SPRING_WIDTH };
            points.push([x + side, top + end + length * (k as f64 + 0.5) / TURNS as f64]);
        }
        points.extend([[x, bottom - end], [x, bottom]]);
        self.path("part", &points);
    }

    /// Upright: a cup below, a piston above.
    pub fn damper(&mut self, x: f64, [top, bottom]: [f64; 2]) {
        let (w, length) = (7.0, bottom - top);
        let (head, cup, floor) = (top + 0.52 * length, top + 0.32 * length, top + 0.68 * length);
        self.path("part", &[[x, top], [x, head]]);
        self.path("part", &[[x - w + 2.0, head], [x + w - 2.0, head]]);
        self.path("part", &[[x - w, cup], [x - w, floor], [x + w, floor], [x + w, cup]]);
        self.path("part", &[[x, floor], [x, bottom]]);
    }

    /// Upright: a cylinder with its force.
    pub fn actuator(&mut self, x: f64, [top, bottom]: [f64; 2]) {
        let middle = 0.5 * (top + bottom);
        self.path("part", &[[x, top], [x, bottom]]);
        self.disc("actuator", [x, middle], 11.0);
        self.text("symbol", [x, middle + 4.0], "u");
    }

    /// A mass.
    pub fn block(&mut self, class: &str, [left, top]: [f64; 2], [width, height]: [f64; 2]) {
        let [x, y, w, h] = [left, top, width, height].map(point);
        let all = [
            ("class", class),
            ("x", x.as_str()),
            ("y", y.as_str()),
            ("width", w.as_str()),
            ("height", h.as_str()),
            ("rx", "4"),
        ];
        self.inside.push(element("rect", &all, ""));
    }

    /// A disc.
    pub fn disc(&mut self, class: &str, at: [f64; 2], radius: f64) {
        let [x, y, r] = [at[0], at[1], radius].map(point);
        let all = [("class", class), ("cx", x.as_str()), ("cy", y.as_str()), ("r", r.as_str())];
        self.inside.push(element("circle", &all, ""));
    }

    /// A straight line.
    pub fn line(&mut self, class: &str, from: [f64; 2], to: [f64; 2]) {
        self.path(class, &[from, to]);
    }

    /// The centre of gravity.
    pub fn centre(&mut self, [x, y]: [f64; 2]) {
        self.disc("centre", [x, y], 5.0);
        self.line("part", [x - 8.0, y], [x + 8.0, y]);
        self.line("part", [x, y - 8.0], [x, y + 8.0]);
    }

    /// A rough road.
    pub fn road(&mut self, [left, right]: [f64; 2], y: f64) {
        const STEPS: usize = 60;
        let at = |k: usize| {
            let x = left + (right - left) * k as f64 / STEPS as f64;
            // not one period alone
            [x, y + 3.0 + 1.6 * (x / 9.0).sin() + 1.4 * (x / 23.0).sin()]
        };
        self.path("road", &(0..=STEPS).map(at).collect::<Vec<_>>());
    }

    /// An arrow to the direction of travel.
    pub fn forward(&mut self, [x, y]: [f64; 2]) {
        self.path("forward", &[[x, y], [x + 34.0, y]]);
        self.path("forward", &[[x + 28.0, y - 4.0], [x + 34.0, y], [x + 28.0, y + 4.0]]);
        self.text("small middle", [x + 17.0, y - 7.0], "forward");
    }

    /// Text, at its left end unless its class says otherwise.
    pub fn text(&mut self, class: &str, [x, y]: [f64; 2], words: &str) {
        let [x, y] = [x, y].map(point);
        self.inside.push(element("text", &[("class", class), ("x", &x), ("y", &y)], words));
    }

    /// A number for what is measured there.
    pub fn mark(&mut self, number: usize, [x, y]: [f64; 2]) {
        let [cx, cy, below] = [x, y, y + 4.0].map(point);
        self.marks.push(element("circle", &[("class", "mark"), ("cx", &cx), ("cy", &cy), ("r", "9.5")], ""));
        self.marks.push(element(
            "text",
            &[("class", "number"), ("x", &cx), ("y", &below)],
            number.to_string(),
        ));
    }

    /// A distance upright between two heights, to which a mark belongs.
    pub fn span(&mut self, x: f64, [top, bottom]: [f64; 2]) {
        self.path("span", &[[x, top], [x, bottom]]);
        for (tip, way) in [(top, 5.0), (bottom, -5.0)] {
            self.path("span", &[[x - 3.5, tip + way], [x, tip], [x + 3.5, tip + way]]);
        }
    }
}

/// A tenth of a point is finer than any screen.
fn point(v: f64) -> String {
    let text = format!("{v:.1}");
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}
