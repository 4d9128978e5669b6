//! Where a vehicle's mode shapes can be drawn: body corners and hubs.

use super::identify_outcome::ShapePoint;
use crate::linalg::C64;
use crate::signal::{Channel, Direction, Place, Quantity, WheelPlace};
use crate::vehicle::Vehicle;

/// The vertical displacements of body and hub at every wheel in a shape over the vehicle's degrees of freedom; the
/// largest is 1. Places that the model does not have are left out.
pub(super) fn of_vehicle(vehicle: &Vehicle, shape: &[C64]) -> Vec<ShapePoint> {
    let wheels: Vec<WheelPlace> = vehicle
        .wheels()
        .iter()
        .map(|w| WheelPlace { name: w.name.replace('_', "-"), at_m: w.at_m })
        .collect();
    let mut found = Vec::new();
    for (place, word) in [(Place::Body, "body"), (Place::Hub, "hub")] {
        for (index, wheel) in wheels.iter().enumerate() {
            let channel = Channel {
                name: format!("{word} {}", wheel.name),
                quantity: Quantity::Displacement,
                direction: Direction::PlusZ,
                place,
                wheel: Some(index),
                at_m: None,
            };
            let Ok((row, 0)) = vehicle.sensor_row(&channel, &wheels) else { continue };
            let z: C64 = row.iter().zip(shape).map(|(r, q)| q * *r).sum();
            found.push((channel.name, word, wheel.at_m, z));
        }
    }
    points(found)
}

/// Points of names, places, positions and displacements, scaled so that the largest is 1.
pub(super) fn points(found: Vec<(String, &str, [f64; 2], C64)>) -> Vec<ShapePoint> {
    let largest =
        found.iter().map(|p| p.3).fold(C64::new(0.0, 0.0), |a, b| if b.norm() > a.norm() { b } else { a });
    let scale = if largest.norm() > 0.0 { largest } else { C64::new(1.0, 0.0) };
    found
        .into_iter()
        .map(|(name, place, at_m, z)| {
            let z = z / scale;
            ShapePoint { name, place: place.to_owned(), at_m, re: z.re, im: z.im }
        })
        .collect()
}
