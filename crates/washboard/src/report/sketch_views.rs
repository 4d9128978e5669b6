//! Views of a vehicle for its sketch: a quarter car upright, wheels of one track from the side, of two tracks from above.

use super::design_sketch::{Measured, Place};
use super::numbers::plain;
use super::sketch_parts::Sketch;
use crate::study::DesignVehicle;

/// Marks side by side at one place are so far apart.
const APART: f64 = 21.0;

/// Marks of one place, side by side from a point on.
fn marks(s: &mut Sketch, measured: &[Measured], place: Place, [x, y]: [f64; 2]) -> bool {
    let own: Vec<&Measured> = measured.iter().filter(|m| m.place == Some(place)).collect();
    for (k, m) in own.iter().enumerate() {
        s.mark(m.number, [x + APART * k as f64, y]);
    }
    !own.is_empty()
}

/// A number of the vehicle in a unit that people use; nothing where it has none.
fn value(v: &DesignVehicle, name: &str, symbol: &str) -> Option<String> {
    let value = *v.parameters.get(name)?;
    let unit = [
        ("_kg_m2", 1.0, "kg m²"),
        ("_kg", 1.0, "kg"),
        ("_n_per_m", 1e-3, "kN/m"),
        ("_n_s_per_m", 1.0, "N s/m"),
        ("_m", 1.0, "m"),
    ];
    let (_, factor, unit) = unit.into_iter().find(|(end, _, _)| name.ends_with(end))?;
    Some(format!("{symbol} {} {unit}", plain(value * factor)))
}

/// One wheel below its part of the body.
pub(super) fn quarter(s: &mut Sketch, v: &DesignVehicle, measured: &[Measured]) -> [f64; 2] {
    let (body, wheel, ground) = ([44.0, 96.0], [186.0, 220.0], 300.0);
    let between = [body[1], wheel[0]];
    s.block("body", [74.0, body[0]], [190.0, body[1] - body[0]]);
    s.spring(111.0, between);
    s.damper(166.0, between);
    s.actuator(221.0, between);
    s.block("hub", [104.0, wheel[0]], [130.0, wheel[1] - wheel[0]]);
    s.spring(146.0, [wheel[1], ground]);
    if v.parameters.get("tire_damping_n_s_per_m").is_some() {
        s.damper(196.0, [wheel[1], ground]);
    }
    s.road([20.0, 340.0], ground);
    let texts = [
        ("sprung_mass_kg", "mₛ", "middle", [169.0, 75.0]),
        ("unsprung_mass_kg", "mᵤ", "middle", [169.0, 208.0]),
        ("suspension_stiffness_n_per_m", "kₛ", "end", [98.0, 135.0]),
        ("suspension_damping_n_s_per_m", "cₛ", "end", [98.0, 152.0]),
        ("tire_stiffness_n_per_m", "kₜ", "end", [132.0, 256.0]),
        ("tire_damping_n_s_per_m", "cₜ", "end", [132.0, 273.0]),
    ];
    for (name, symbol, class, at) in texts {
        if let Some(text) = value(v, name, symbol) {
            s.text(class, at, &text);
        }
    }
    let x = 282.0;
    if marks(s, measured, Place::Suspension(0), [x + 22.0, 141.0]) {
        s.span(x, between);
    }
    if marks(s, measured, Place::Tire(0), [x + 22.0, 262.0]) {
        s.span(x, [wheel[1], ground]);
    }
    marks(s, measured, Place::Wheel(0), [x - 32.0, 203.0]);
    marks(s, measured, Place::Body, [x + 4.0, 70.0]);
    [360.0, 318.0]
}

/// Wheels one behind the other, forward to the right.
pub(super) fn half(s: &mut Sketch, v: &DesignVehicle, measured: &[Measured]) -> [f64; 2] {
    let (body, wheel, ground) = ([62.0, 98.0], [168.0, 190.0], 238.0);
    let scale = Along::of(v, [95.0, 315.0]);
    s.block("body", [50.0, body[0]], [310.0, body[1] - body[0]]);
    let centre = scale.at(0.0).clamp(70.0, 340.0);
    s.centre([centre, 80.0]);
    let mass: Vec<String> = [("sprung_mass_kg", "mₛ"), ("pitch_inertia_kg_m2", "J")]
        .into_iter()
        .filter_map(|(name, symbol)| value(v, name, symbol))
        .collect();
    s.text("middle", [205.0, 52.0], &mass.join(", "));
    for (k, w) in v.wheels.iter().enumerate() {
        let (x, between) = (scale.at(w.at_m[0]), [body[1], wheel[0]]);
        s.spring(x - 24.0, between);
        s.damper(x, between);
        s.actuator(x + 24.0, between);
        s.block("hub", [x - 34.0, wheel[0]], [68.0, wheel[1] - wheel[0]]);
        s.spring(x, [wheel[1], ground]);
        let axle = w.name.as_str();
        s.text("middle strong", [x, 262.0], axle);
        let lines = [
            ("unsprung_mass_kg", "mᵤ"),
            ("suspension_stiffness_n_per_m", "kₛ"),
            ("suspension_damping_n_s_per_m", "cₛ"),
            ("tire_stiffness_n_per_m", "kₜ"),
        ];
        let values: Vec<String> = lines
            .into_iter()
            .filter_map(|(name, symbol)| value(v, &format!("{axle}.{name}"), symbol))
            .collect();
        for (row, pair) in values.chunks(2).enumerate() {
            s.text("middle small", [x, 278.0 + 15.0 * row as f64], &pair.join(", "));
        }
        if marks(s, measured, Place::Suspension(k), [x + 62.0, 132.0]) {
            s.span(x + 46.0, between);
        }
        if marks(s, measured, Place::Tire(k), [x + 62.0, 216.0]) {
            s.span(x + 46.0, [wheel[1], ground]);
        }
        marks(s, measured, Place::Wheel(k), [x - 46.0, 179.0]);
        marks(s, measured, Place::Corner(k), [x - 10.0, body[0] - 4.0]);
    }
    marks(s, measured, Place::Body, [centre + 22.0, 80.0]);
    marks(s, measured, Place::Driver, [centre + 22.0, 36.0]);
    s.road([20.0, 400.0], ground);
    s.forward([352.0, 24.0]);
    [420.0, 304.0]
}

/// Distances of the vehicle to points of the drawing.
struct Along {
    zero: f64,
    scale: f64,
}

impl Along {
    /// From the rearmost wheel to the foremost one.
    fn of(v: &DesignVehicle, [left, right]: [f64; 2]) -> Self {
        let x = v.wheels.iter().map(|w| w.at_m[0]);
        let (low, high) = (x.clone().fold(f64::INFINITY, f64::min), x.fold(f64::NEG_INFINITY, f64::max));
        if high > low {
            let scale = (right - left) / (high - low);
            Along { zero: left - scale * low, scale }
        } else {
            Along { zero: 0.5 * (left + right), scale: 0.0 }
        }
    }

    fn at(&self, x_m: f64) -> f64 {
        self.zero + self.scale * x_m
    }
}

/// From above, forward to the right, left upwards.
pub(super) fn plan(s: &mut Sketch, v: &DesignVehicle, measured: &[Measured]) -> [f64; 2] {
    let along = Along::of(v, [92.0, 318.0]);
    let across = v.wheels.iter().map(|w| w.at_m[1].abs()).fold(0.0, f64::max);
    // true to scale, unless the vehicle is too wide or too narrow to be read
    let scale = (along.scale * across).clamp(62.0, 92.0) / across;
    let reach = scale * across;
    let middle = reach + 42.0;
    let at = |p: [f64; 2]| [along.at(p[0]), middle - scale * p[1]];
    s.block("body", [52.0, middle - reach + 14.0], [306.0, 2.0 * reach - 28.0]);
    for w in &v.wheels {
        s.line("axle", at([w.at_m[0], 0.0]), at(w.at_m));
    }
    let centre = at([0.0, 0.0]);
    s.centre(centre);
    let driver = v.parameters.get("driver_m.0").zip(v.parameters.get("driver_m.1"));
    if let Some((x, y)) = driver {
        let p = at([*x, *y]);
        s.disc("driver", p, 6.0);
        s.text("small", [p[0] + 9.0, p[1] - 5.0], "driver");
        marks(s, measured, Place::Driver, [p[0] + 18.0, p[1] + 9.0]);
    } else {
        marks(s, measured, Place::Driver, [centre[0] + 24.0, centre[1] - 24.0]);
    }
    for (k, w) in v.wheels.iter().enumerate() {
        let [x, y] = at(w.at_m);
        let out = if w.at_m[1] > 0.0 { -1.0 } else { 1.0 };
        s.block("tire", [x - 25.0, y - 9.0], [50.0, 18.0]);
        if v.actuators.contains(&w.name) {
            s.disc("actuator", [x, y - 30.0 * out], 10.0);
            s.text("symbol", [x, y - 30.0 * out + 4.0], "u");
        }
        s.text("middle small", [x, y + if out < 0.0 { -14.0 } else { 21.0 }], &w.name.replace('_', " "));
        marks(s, measured, Place::Suspension(k), [x + 24.0, y - 30.0 * out]);
        marks(s, measured, Place::Corner(k), [x - 24.0 - APART, y - 30.0 * out]);
        marks(s, measured, Place::Wheel(k), [x - 38.0, y]);
        marks(s, measured, Place::Tire(k), [x + 38.0, y]);
    }
    let mass: Vec<String> = [
        ("sprung_mass_kg", "mₛ"),
        ("cabin_mass_kg", "m"),
        ("pitch_inertia_kg_m2", "J pitch"),
        ("roll_inertia_kg_m2", "J roll"),
    ]
    .into_iter()
    .filter_map(|(name, symbol)| value(v, name, symbol))
    .collect();
    marks(s, measured, Place::Body, [centre[0] + 20.0, centre[1] + 16.0]);
    let bottom = middle + reach + 46.0;
    s.text("middle small", [205.0, bottom], &mass.join(", "));
    s.forward([366.0, middle]);
    [420.0, bottom + 14.0]
}
