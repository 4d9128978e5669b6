//! The units that a description may name, and what one of each is in SI.

use super::Quantity;
use serde::{Deserialize, Serialize};

/// Standard gravity, by definition, in m/s².
const G: f64 = 9.806_65;

/// The unit of a channel in its file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Unit {
    /// m
    #[serde(rename = "m")]
    Metre,
    /// cm
    #[serde(rename = "cm")]
    Centimetre,
    /// mm
    #[serde(rename = "mm")]
    Millimetre,
    /// m/s
    #[serde(rename = "m/s")]
    MetrePerSecond,
    /// mm/s
    #[serde(rename = "mm/s")]
    MillimetrePerSecond,
    /// km/h
    #[serde(rename = "km/h")]
    KilometrePerHour,
    /// m/s²
    #[serde(rename = "m/s^2", alias = "m/s2", alias = "m/s²")]
    MetrePerSecondSquared,
    /// mm/s²
    #[serde(rename = "mm/s^2", alias = "mm/s2", alias = "mm/s²")]
    MillimetrePerSecondSquared,
    /// 9.80665 m/s²
    #[serde(rename = "g")]
    Gravity,
    /// g/1000
    #[serde(rename = "mg")]
    MilliGravity,
    /// rad/s
    #[serde(rename = "rad/s")]
    RadianPerSecond,
    /// deg/s
    #[serde(rename = "deg/s", alias = "°/s")]
    DegreePerSecond,
    /// A converter's counts, of which a scale or a calibration says the size.
    #[serde(rename = "counts")]
    Counts,
}

/// Every unit, its name, its quantity and one of it in SI.
const UNITS: [(Unit, &str, Quantity, f64); 12] = [
    (Unit::Metre, "m", Quantity::Displacement, 1.0),
    (Unit::Centimetre, "cm", Quantity::Displacement, 1e-2),
    (Unit::Millimetre, "mm", Quantity::Displacement, 1e-3),
    (Unit::MetrePerSecond, "m/s", Quantity::Velocity, 1.0),
    (Unit::MillimetrePerSecond, "mm/s", Quantity::Velocity, 1e-3),
    (Unit::KilometrePerHour, "km/h", Quantity::Velocity, 1.0 / 3.6),
    (Unit::MetrePerSecondSquared, "m/s^2", Quantity::Acceleration, 1.0),
    (Unit::MillimetrePerSecondSquared, "mm/s^2", Quantity::Acceleration, 1e-3),
    (Unit::Gravity, "g", Quantity::Acceleration, G),
    (Unit::MilliGravity, "mg", Quantity::Acceleration, 1e-3 * G),
    (Unit::RadianPerSecond, "rad/s", Quantity::AngularVelocity, 1.0),
    (Unit::DegreePerSecond, "deg/s", Quantity::AngularVelocity, std::f64::consts::PI / 180.0),
];

impl Unit {
    /// Its name in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.row().map_or("counts", |r| r.1)
    }

    /// What it measures and one of it in SI; none for counts.
    #[must_use]
    pub fn si(self) -> Option<(Quantity, f64)> {
        self.row().map(|r| (r.2, r.3))
    }

    /// The names of the units of a quantity, for messages.
    pub(super) fn names_of(quantity: Quantity) -> String {
        let names: Vec<&str> = UNITS.iter().filter(|r| r.2 == quantity).map(|r| r.1).collect();
        names.join(", ")
    }

    fn row(self) -> Option<&'static (Unit, &'static str, Quantity, f64)> {
        UNITS.iter().find(|r| r.0 == self)
    }
}

/// The unit of a speed column.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum SpeedUnit {
    /// m/s
    #[serde(rename = "m/s")]
    MetrePerSecond,
    /// km/h
    #[serde(rename = "km/h")]
    KilometrePerHour,
    /// Nautical miles (1852 m) per hour.
    #[serde(rename = "knots")]
    Knots,
    /// Miles (1609.344 m) per hour.
    #[serde(rename = "mph")]
    MilePerHour,
}

impl SpeedUnit {
    /// One of it in m/s.
    #[must_use]
    pub fn in_m_s(self) -> f64 {
        match self {
            SpeedUnit::MetrePerSecond => 1.0,
            SpeedUnit::KilometrePerHour => 1.0 / 3.6,
            SpeedUnit::Knots => 1852.0 / 3600.0,
            SpeedUnit::MilePerHour => 1609.344 / 3600.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_unit_has_one_row_and_its_file_name() {
        for (unit, name, _, _) in UNITS {
            assert_eq!(serde_json::to_string(&unit).unwrap(), format!("\"{name}\""));
            assert_eq!(serde_json::from_str::<Unit>(&format!("\"{name}\"")).unwrap(), unit);
        }
        assert!(Unit::Counts.si().is_none());
    }

    #[test]
    fn conversions_are_the_defined_ones() {
        assert_eq!(Unit::Gravity.si(), Some((Quantity::Acceleration, 9.80665)));
        assert!((Unit::DegreePerSecond.si().unwrap().1 * 180.0 - std::f64::consts::PI).abs() < 1e-15);
        assert!((SpeedUnit::Knots.in_m_s() - 0.514_444_444).abs() < 1e-9);
        assert!((SpeedUnit::KilometrePerHour.in_m_s() * 36.0 - 10.0).abs() < 1e-12);
        assert!((SpeedUnit::MilePerHour.in_m_s() - 0.44704).abs() < 1e-12);
    }
}
