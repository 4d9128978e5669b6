//! What a channel measures, in which direction, and where: declared, never guessed.

use serde::{Deserialize, Serialize};

/// What a sensor measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Quantity {
    /// m
    Displacement,
    /// m/s
    Velocity,
    /// m/s²; gravity, where the sensor feels it, is left in
    Acceleration,
    /// rad/s, about the axis of the direction, right-handed
    AngularVelocity,
}

impl Quantity {
    /// The SI unit in which a [`Recording`](super::Recording) holds it.
    #[must_use]
    pub fn si_unit(self) -> &'static str {
        match self {
            Quantity::Displacement => "m",
            Quantity::Velocity => "m/s",
            Quantity::Acceleration => "m/s^2",
            Quantity::AngularVelocity => "rad/s",
        }
    }

    /// Its name in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Quantity::Displacement => "displacement",
            Quantity::Velocity => "velocity",
            Quantity::Acceleration => "acceleration",
            Quantity::AngularVelocity => "angular-velocity",
        }
    }
}

/// Where a sensor sits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Place {
    /// The sprung mass.
    Body,
    /// A wheel carrier.
    Hub,
    /// A solid axle.
    Axle,
    /// The cab of a truck.
    Cab,
    /// Between hub and body: suspension travel, the hub's motion relative to the body (compression is +z).
    Suspension,
}

/// The axis that a channel measures along (or about), and its sign: x forward, y left, z up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Direction {
    /// Forward.
    #[serde(rename = "+x")]
    PlusX,
    /// Backward.
    #[serde(rename = "-x")]
    MinusX,
    /// Left.
    #[serde(rename = "+y")]
    PlusY,
    /// Right.
    #[serde(rename = "-y")]
    MinusY,
    /// Up.
    #[serde(rename = "+z")]
    PlusZ,
    /// Down.
    #[serde(rename = "-z")]
    MinusZ,
}

impl Direction {
    /// +1 or −1.
    #[must_use]
    pub fn sign(self) -> f64 {
        match self {
            Direction::PlusX | Direction::PlusY | Direction::PlusZ => 1.0,
            Direction::MinusX | Direction::MinusY | Direction::MinusZ => -1.0,
        }
    }

    /// The same axis with the sign +.
    #[must_use]
    pub fn positive(self) -> Self {
        match self {
            Direction::PlusX | Direction::MinusX => Direction::PlusX,
            Direction::PlusY | Direction::MinusY => Direction::PlusY,
            Direction::PlusZ | Direction::MinusZ => Direction::PlusZ,
        }
    }
}

/// A wheel's contact with the road, seen from above.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WheelPlace {
    /// Such as `front-left`.
    pub name: String,
    /// x forward, y left, in m, from any origin that all places share.
    pub at_m: [f64; 2],
}

/// One measured series: what, which way, where.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Channel {
    /// Unique in its recording.
    pub name: String,
    /// What is measured.
    pub quantity: Quantity,
    /// Along (or about) which axis; always of sign + inside a [`Recording`](super::Recording).
    pub direction: Direction,
    /// On which body.
    pub place: Place,
    /// At which wheel: an index into the recording's wheels.
    pub wheel: Option<usize>,
    /// x forward, y left, in m, where it is not at a wheel.
    pub at_m: Option<[f64; 2]>,
}
