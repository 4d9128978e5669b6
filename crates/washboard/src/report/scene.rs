//! The vehicle as the points of a mode show it: wheels, body, springs in oblique projection, every vertex with its own
//! complex displacement.
//!
//! A vertex at rest at (x, y) on the screen with the displacement (re, im) stands at y − a Re((re + i im) e^{iωt}) at the
//! time t and the amplitude a: the script does no more than that.

use super::html::{Html, element};
use super::numbers::fixed;
use crate::study::ShapePoint;

/// Of the projection: a metre to the left goes so far to the right and upwards on the screen.
const OBLIQUE: [f64; 2] = [0.42, 0.34];
/// In units of the vehicle's longest distance: radius of a wheel, height of the body, of a cab, displacement of 1.
const WHEEL: f64 = 0.12;
const BODY: f64 = 0.38;
const CAB: f64 = 0.62;
const UNIT: f64 = 0.13;
/// Wheels one behind the other keep clear: their radius as a share of the distance; nearer ones are on one axle.
const CLEAR: f64 = 0.46;
const LEAST_GAP: f64 = 0.05;
/// Half the sides of the mass that stands for a body with one point.
const BLOCK: [f64; 2] = [0.3, 0.2];
/// The drawing's size on the screen, and its margin.
const SIZE: [f64; 2] = [420.0, 270.0];
const MARGIN: f64 = 10.0;
/// Points nearer than this share of the longest distance stand above each other.
const SAME_PLACE: f64 = 0.1;
/// Corners of a spring between its ends, and half its width.
const ZIGZAG: usize = 7;
const ZIGZAG_WIDTH: f64 = 0.025;

/// A corner on the screen, and where it goes.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Vertex {
    at: [f64; 2],
    moves: [f64; 2],
}

#[derive(Debug)]
enum Kind {
    Polygon,
    Polyline,
    Circle(f64),
    Text(String),
}

#[derive(Debug)]
struct Element {
    kind: Kind,
    class: &'static str,
    vertices: Vec<Vertex>,
}

/// The points that can be drawn: all numbers finite. Their places in the list are their numbers in drawing and table.
pub(super) fn drawable(points: &[ShapePoint]) -> Vec<&ShapePoint> {
    let finite = |p: &&ShapePoint| [p.at_m[0], p.at_m[1], p.re, p.im].iter().all(|v| v.is_finite());
    points.iter().filter(finite).collect()
}

/// The drawing at the phase 0; none of no points.
pub(super) fn svg(points: &[ShapePoint], label: &str) -> Option<Html> {
    let points = drawable(points);
    if points.is_empty() {
        return None;
    }
    let frame = Frame::of(&points);
    let elements = fitted(elements(&points, frame), frame);
    let [w, h] = SIZE.map(|v| fixed(v, 0));
    let inside: Html = elements.iter().map(markup).collect();
    Some(element(
        "svg",
        &[("viewBox", &format!("0 0 {w} {h}")), ("class", "scene"), ("role", "img"), ("aria-label", label)],
        inside,
    ))
}

/// The longest distance between points along an axis, 1 m for a single place.
fn extent(points: &[&ShapePoint]) -> f64 {
    let along = |axis: usize| {
        let values = points.iter().map(|p| p.at_m[axis]);
        values.clone().fold(f64::NEG_INFINITY, f64::max) - values.fold(f64::INFINITY, f64::min)
    };
    let longest = along(0).max(along(1));
    if longest > 0.0 { longest } else { 1.0 }
}

/// The drawing's measures, m.
#[derive(Debug, Clone, Copy)]
struct Frame {
    /// The longest distance.
    size: f64,
    /// Radius of a wheel.
    wheel: f64,
}

impl Frame {
    fn of(points: &[&ShapePoint]) -> Self {
        let size = extent(points);
        let mut along: Vec<f64> = points.iter().filter(|p| is_wheel(p)).map(|p| p.at_m[0]).collect();
        along.sort_by(f64::total_cmp);
        let gaps = along.windows(2).map(|w| w[1] - w[0]).filter(|gap| *gap > LEAST_GAP * size);
        let nearest = gaps.fold(f64::INFINITY, f64::min);
        Frame { size, wheel: (WHEEL * size).min(CLEAR * nearest) }
    }

    /// At rest above the ground.
    fn height(self, place: &str) -> f64 {
        match place {
            "hub" | "axle" => self.wheel,
            "cab" => CAB * self.size,
            _ => BODY * self.size,
        }
    }
}

pub(super) fn is_wheel(p: &ShapePoint) -> bool {
    matches!(p.place.as_str(), "hub" | "axle")
}

/// At a place in the vehicle and a height, with a displacement.
fn vertex([x, y]: [f64; 2], z: f64, moves: [f64; 2]) -> Vertex {
    Vertex { at: [x + OBLIQUE[0] * y, z + OBLIQUE[1] * y], moves }
}

fn of(p: &ShapePoint, frame: Frame) -> Vertex {
    vertex(p.at_m, frame.height(&p.place), [p.re, p.im])
}

/// Everything from back to front; sizes in metres, upwards positive.
fn elements(points: &[&ShapePoint], frame: Frame) -> Vec<Element> {
    let middle = points.iter().map(|p| p.at_m[1]).sum::<f64>() / points.len() as f64;
    let (far, near): (Vec<&ShapePoint>, Vec<&ShapePoint>) =
        points.iter().copied().filter(|p| is_wheel(p)).partition(|p| p.at_m[1] > middle + 1e-9);
    let mut all = Vec::new();
    for place in ["body", "cab"] {
        let here = of_place(points, place);
        all.extend(sheet(&here, frame, true));
    }
    all.extend(axles(points, frame));
    all.extend(far.iter().flat_map(|p| wheel(p, points, frame)));
    for place in ["body", "cab"] {
        let here = of_place(points, place);
        if place == "cab" {
            all.extend(here.iter().filter_map(|p| spring(p, points, "body", frame)));
        }
        all.extend(sheet(&here, frame, false));
    }
    all.extend(near.iter().flat_map(|p| wheel(p, points, frame)));
    for (k, p) in points.iter().enumerate() {
        let v = of(p, frame);
        all.push(Element { kind: Kind::Circle(2.6), class: "dot", vertices: vec![v] });
        let beside = Vertex { at: [v.at[0] + 0.02 * frame.size, v.at[1] + 0.02 * frame.size], ..v };
        all.push(Element { kind: Kind::Text((k + 1).to_string()), class: "number", vertices: vec![beside] });
    }
    all
}

fn of_place<'a>(points: &[&'a ShapePoint], place: &str) -> Vec<&'a ShapePoint> {
    // whatever is neither wheel nor cab moves with the body
    let is = |p: &&ShapePoint| !is_wheel(p) && (p.place == "cab") == (place == "cab");
    points.iter().copied().filter(is).collect()
}

/// A plate through three points or more, a beam through points of a line, a mass for one; at rest it is an outline.
fn sheet(points: &[&ShapePoint], frame: Frame, rest: bool) -> Option<Element> {
    let cab = points.first()?.place == "cab";
    let z = frame.height(if cab { "cab" } else { "body" });
    let class = |moving: &'static str| if rest { "rest" } else { moving };
    let at = |at: [f64; 2], p: &ShapePoint| vertex(at, z, if rest { [0.0; 2] } else { [p.re, p.im] });
    let hull = hull(points);
    let (kind, class, vertices) = match hull.len() {
        1 => {
            let p = hull[0];
            let corner = |[x, y]: [f64; 2]| at([p.at_m[0] + frame.size * x, p.at_m[1] + frame.size * y], p);
            let [x, y] = BLOCK;
            (Kind::Polygon, class("plate"), [[-x, -y], [x, -y], [x, y], [-x, y]].map(corner).to_vec())
        }
        2 => {
            let mut line = points.to_vec();
            line.sort_by(|a, b| a.at_m[0].total_cmp(&b.at_m[0]).then(a.at_m[1].total_cmp(&b.at_m[1])));
            (Kind::Polyline, class("beam"), line.iter().map(|p| at(p.at_m, p)).collect())
        }
        _ => {
            let corners = hull.iter().map(|p| at(p.at_m, p)).collect();
            (Kind::Polygon, class(if cab { "plate cab" } else { "plate" }), corners)
        }
    };
    Some(Element { kind, class, vertices })
}

/// The corners of the convex hull, round (Andrew's monotone chain); the two ends of points on a line.
fn hull<'a>(points: &[&'a ShapePoint]) -> Vec<&'a ShapePoint> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.at_m[0].total_cmp(&b.at_m[0]).then(a.at_m[1].total_cmp(&b.at_m[1])));
    sorted.dedup_by(|a, b| a.at_m == b.at_m);
    if sorted.len() < 3 {
        return sorted;
    }
    let half = |points: &mut dyn Iterator<Item = &&'a ShapePoint>| {
        let mut chain: Vec<&'a ShapePoint> = Vec::new();
        for p in points {
            while let [.., o, a] = chain[..] {
                let (u, v) = (
                    [a.at_m[0] - o.at_m[0], a.at_m[1] - o.at_m[1]],
                    [p.at_m[0] - o.at_m[0], p.at_m[1] - o.at_m[1]],
                );
                if u[0] * v[1] - u[1] * v[0] > 1e-9 {
                    break;
                }
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut round = half(&mut sorted.iter());
    round.extend(half(&mut sorted.iter().rev()));
    round
}

/// Wheels of one axle are joined by a thin line, for the eye.
fn axles(points: &[&ShapePoint], frame: Frame) -> Vec<Element> {
    let wheels: Vec<_> = points.iter().filter(|p| is_wheel(p)).collect();
    let mut lines = Vec::new();
    for (k, a) in wheels.iter().enumerate() {
        let mates =
            wheels[k + 1..].iter().filter(|b| (a.at_m[0] - b.at_m[0]).abs() < SAME_PLACE * frame.size);
        if let Some(b) =
            mates.min_by(|p, q| (p.at_m[1] - a.at_m[1]).abs().total_cmp(&(q.at_m[1] - a.at_m[1]).abs()))
        {
            lines.push(Element {
                kind: Kind::Polyline,
                class: "axle",
                vertices: vec![of(a, frame), of(b, frame)],
            });
        }
    }
    lines
}

/// Where it stands, where it rests, itself, and its spring.
fn wheel(p: &ShapePoint, points: &[&ShapePoint], frame: Frame) -> Vec<Element> {
    let [x, y] = p.at_m;
    let ends = [-0.8, 0.8].map(|side| vertex([x + side * frame.wheel, y], 0.0, [0.0; 2]));
    let radius = frame.wheel;
    let rest = vertex(p.at_m, radius, [0.0; 2]);
    let mut all = vec![
        Element { kind: Kind::Polyline, class: "ground", vertices: ends.to_vec() },
        Element { kind: Kind::Circle(radius), class: "rest", vertices: vec![rest] },
        Element { kind: Kind::Circle(radius), class: "wheel", vertices: vec![of(p, frame)] },
    ];
    all.extend(spring(p, points, "body", frame));
    all
}

/// From a point to the one of the body at the same place; none where none is there.
fn spring(p: &ShapePoint, points: &[&ShapePoint], to: &str, frame: Frame) -> Option<Element> {
    let far = |q: &&ShapePoint| (q.at_m[0] - p.at_m[0]).hypot(q.at_m[1] - p.at_m[1]);
    let body = of_place(points, to);
    let mate = body.into_iter().min_by(|a, b| far(a).total_cmp(&far(b)))?;
    if far(&mate) > SAME_PLACE * frame.size {
        return None;
    }
    let (a, b) = (of(p, frame), of(mate, frame));
    let corner = |k: usize| {
        let share = k as f64 / ZIGZAG as f64;
        let between = |u: [f64; 2], v: [f64; 2]| [0, 1].map(|i| (1.0 - share) * u[i] + share * v[i]);
        let side = match (k, k % 2) {
            (0 | ZIGZAG, _) => 0.0,
            (_, 0) => ZIGZAG_WIDTH,
            _ => -ZIGZAG_WIDTH,
        };
        let [x, y] = between(a.at, b.at);
        Vertex { at: [x + side * frame.size, y], moves: between(a.moves, b.moves) }
    };
    Some(Element { kind: Kind::Polyline, class: "spring", vertices: (0..=ZIGZAG).map(corner).collect() })
}

/// From metres, upwards, to the screen.
fn fitted(mut elements: Vec<Element>, frame: Frame) -> Vec<Element> {
    let mut ends = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    for e in &elements {
        let radius = if let (Kind::Circle(r), "wheel" | "rest") = (&e.kind, e.class) { *r } else { 0.0 };
        for v in &e.vertices {
            for (axis, room) in [(0, radius), (1, radius.max(UNIT * frame.size))] {
                ends[axis][0] = ends[axis][0].min(v.at[axis] - room);
                ends[axis][1] = ends[axis][1].max(v.at[axis] + room);
            }
        }
    }
    let scales = [0, 1].map(|i| (SIZE[i] - 2.0 * MARGIN) / (ends[i][1] - ends[i][0]).max(f64::MIN_POSITIVE));
    let scale = scales[0].min(scales[1]);
    for e in &mut elements {
        if let (Kind::Circle(r), "wheel" | "rest") = (&mut e.kind, e.class) {
            *r *= scale;
        }
        for v in &mut e.vertices {
            v.at = [0, 1].map(|i| {
                let from_middle = scale * (v.at[i] - (ends[i][0] + ends[i][1]) / 2.0);
                SIZE[i] / 2.0 + if i == 0 { from_middle } else { -from_middle }
            });
            v.moves = v.moves.map(|m| m * UNIT * frame.size * scale);
        }
    }
    elements
}

/// A number of an attribute: a true minus sign is for people.
pub(super) fn coordinate(v: f64) -> String {
    fixed(v, 1).replace('−', "-")
}

fn markup(e: &Element) -> Html {
    let data = e.vertices.iter().map(|v| {
        let [x, y] = v.at.map(coordinate);
        let [re, im] = v.moves.map(coordinate);
        format!("{x} {y} {re} {im}")
    });
    let data = data.collect::<Vec<_>>().join(" ");
    let now = |v: &Vertex| [coordinate(v.at[0]), coordinate(v.at[1] - v.moves[0])];
    let moving = e.vertices.iter().any(|v| v.moves != [0.0; 2]);
    let (tag, mut attributes, inside): (_, Vec<(&str, String)>, Html) = match &e.kind {
        Kind::Polygon | Kind::Polyline => {
            let corners: Vec<String> = e.vertices.iter().map(|v| now(v).join(",")).collect();
            let tag = if matches!(e.kind, Kind::Polygon) { "polygon" } else { "polyline" };
            (tag, vec![("points", corners.join(" "))], Html::default())
        }
        Kind::Circle(radius) => {
            let [x, y] = e.vertices.first().map(now).unwrap_or_default();
            ("circle", vec![("cx", x), ("cy", y), ("r", coordinate(*radius))], Html::default())
        }
        Kind::Text(text) => {
            let [x, y] = e.vertices.first().map(now).unwrap_or_default();
            ("text", vec![("x", x), ("y", y)], text.as_str().into())
        }
    };
    attributes.push(("class", e.class.to_owned()));
    if moving {
        attributes.push(("data-v", data));
    }
    let attributes: Vec<(&str, &str)> = attributes.iter().map(|(k, v)| (*k, v.as_str())).collect();
    element(tag, &attributes, inside)
}

#[cfg(test)]
mod tests;
