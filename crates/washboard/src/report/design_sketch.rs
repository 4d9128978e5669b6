//! The vehicle of a design as a sketch: masses, springs, wheels, actuators, and numbers for what is measured.

use super::html::{Html, classed, element, note, table};
use super::numbers::plain;
use super::sketch_parts::Sketch;
use super::sketch_views::{half, plan, quarter};
use crate::study::{DesignOutcome, DesignVehicle};

/// Where something is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Place {
    /// Between body and wheel.
    Suspension(usize),
    /// Between wheel and road.
    Tire(usize),
    /// On the wheel.
    Wheel(usize),
    /// On the body above a wheel.
    Corner(usize),
    /// On the body, at its centre of gravity.
    Body,
    /// At the driver.
    Driver,
}

/// Something measured: its number in the drawing, its name, where it is.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Measured {
    pub number: usize,
    pub name: String,
    pub place: Option<Place>,
}

/// The drawing, what its numbers mean, and the vehicle's numbers.
pub(super) fn sketch(o: &DesignOutcome) -> Option<Html> {
    let vehicle = o.vehicle.as_ref()?;
    let measured = measured(o, vehicle);
    let drawing = drawing(vehicle, &measured)?;
    let item = |m: &Measured| {
        let number = classed("span", "mark-number", m.number.to_string());
        let unit = o.units.get(&m.name).map_or_else(String::new, |u| format!(" ({u})"));
        let absent = if m.place.is_none() { ", not in the drawing" } else { "" };
        element("li", &[], number.and(format!(" {}{unit}{absent}", m.name)))
    };
    let list = classed("ul", "marks", measured.iter().map(item).collect::<Html>());
    let force = match vehicle.actuators.as_slice() {
        [] => String::new(),
        [one] if one == "actuator" => "u is the actuator's force.".to_owned(),
        [one] => format!("u is the force of the actuator {one}."),
        all => format!("u are the forces of the actuators {}.", all.join(", ")),
    };
    let heading = element("h3", &[], "Measured");
    let words = heading.and(list).and(note(force)).and(numbers(vehicle));
    Some(classed("div", "drawn", drawing.and(element("div", &[], words))))
}

fn drawing(v: &DesignVehicle, measured: &[Measured]) -> Option<Html> {
    let label = format!("the {} with its actuators and what is measured", v.model.replace('-', " "));
    let two_tracks = v.wheels.iter().any(|w| w.at_m[1] * v.wheels[0].at_m[1] < 0.0);
    let mut sketch = Sketch::default();
    let size = match (v.model.as_str(), v.wheels.len()) {
        (_, 0) => return None,
        ("quarter-car", _) => quarter(&mut sketch, v, measured),
        (_, _) if two_tracks => plan(&mut sketch, v, measured),
        _ => half(&mut sketch, v, measured),
    };
    Some(sketch.svg(size, &label))
}

/// The vehicle's numbers, on demand.
fn numbers(v: &DesignVehicle) -> Html {
    if v.parameters.is_empty() {
        return Html::default();
    }
    let row = |(name, value): (&str, &f64)| vec![name.into(), plain(*value).into()];
    let rows = v.parameters.iter().map(row).collect();
    let summary = element("summary", &[], "The vehicle's numbers");
    element("details", &[], summary.and(table("", &["number, unit at its end", "#value"], rows)))
}

/// What is measured, one number each, stacked names by their corners.
fn measured(o: &DesignOutcome, v: &DesignVehicle) -> Vec<Measured> {
    let asked = &o.design.measurements;
    let names: Vec<String> = match &o.controller {
        Some(k) => k.inputs.clone(),
        None => asked.iter().flat_map(|name| expanded(name, v)).collect(),
    };
    let one = |(k, name): (usize, String)| {
        let place = place(&name, v);
        Measured { number: k + 1, name, place }
    };
    names.into_iter().enumerate().map(one).collect()
}

const OF_WHEELS: [&str; 5] = ["suspension_", "tire_", "unsprung_", "body_", "damper_"];

fn expanded(name: &str, v: &DesignVehicle) -> Vec<String> {
    let of_wheels = OF_WHEELS.iter().any(|head| name.starts_with(head));
    let corner = v.wheels.iter().any(|w| name.ends_with(&format!("_{}", w.name)));
    if !of_wheels || corner || v.model == "quarter-car" {
        return vec![name.to_owned()];
    }
    v.wheels.iter().map(|w| format!("{name}_{}", w.name)).collect()
}

fn place(name: &str, v: &DesignVehicle) -> Option<Place> {
    let wheel = v.wheels.iter().position(|w| name.ends_with(&format!("_{}", w.name)));
    let wheel = wheel.or((v.wheels.len() == 1).then_some(0));
    let begins = |heads: &[&str]| heads.iter().any(|h| name.starts_with(h));
    match wheel {
        Some(w) if begins(&["suspension_", "damper_"]) => Some(Place::Suspension(w)),
        Some(w) if begins(&["tire_"]) => Some(Place::Tire(w)),
        Some(w) if begins(&["unsprung_"]) => Some(Place::Wheel(w)),
        Some(w) if begins(&["body_"]) => Some(Place::Corner(w)),
        _ if begins(&["driver_"]) => Some(Place::Driver),
        _ if begins(&["sprung_", "heave_", "pitch_", "roll_", "cabin_"]) => Some(Place::Body),
        _ => None,
    }
}
