//! The half car (heave and pitch on two wheels of one track): Türkay, sections 6.1 and 6.2.

use super::body::{BodyOnCorners, Corner};
use super::values::{Axle, positive};
use super::{Vehicle, VehicleError};
use crate::linalg::Mat;
use serde::{Deserialize, Serialize};

/// Which equations.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum HalfCarVariant {
    /// The equations of motion (6.1)–(6.4).
    #[default]
    Corrected,
    /// The matrices (6.15) and (6.18) as printed, which leave the unsprung velocities out of the damper forces on the
    /// body and so damp it to the ground.
    AsPrinted,
}

/// A half car.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HalfCar {
    /// m_s, kg.
    pub sprung_mass_kg: f64,
    /// I_p, kg·m².
    pub pitch_inertia_kg_m2: f64,
    /// l₁: front axle ahead of the c.g., m.
    pub front_axle_m: f64,
    /// l₂: rear axle behind the c.g., m.
    pub rear_axle_m: f64,
    /// Front axle.
    pub front: Axle,
    /// Rear axle.
    pub rear: Axle,
    /// `corrected` (the default) or `as-printed`.
    #[serde(default)]
    pub variant: HalfCarVariant,
}

impl HalfCar {
    /// The vehicle over (heave, pitch, unsprung front, unsprung rear); pitch is positive nose down.
    ///
    /// # Errors
    /// A mass, stiffness or distance that is not positive; a damping that is negative; left and right that differ.
    pub fn assemble(&self) -> Result<Vehicle, VehicleError> {
        positive("sprung_mass_kg", self.sprung_mass_kg)?;
        positive("pitch_inertia_kg_m2", self.pitch_inertia_kg_m2)?;
        positive("front_axle_m", self.front_axle_m)?;
        positive("rear_axle_m", self.rear_axle_m)?;
        let axles = [("front", &self.front, self.front_axle_m), ("rear", &self.rear, -self.rear_axle_m)];
        for (name, axle, _) in axles {
            axle.check(name)?;
            axle.check_single_track(name)?;
            if axle.damper_curve.is_some() && self.variant == HalfCarVariant::AsPrinted {
                return Err(VehicleError::Field {
                    field: format!("{name}.damper_curve"),
                    expected: "variant = \"corrected\": as printed a damper has no velocity of its own",
                    found: "variant = \"as-printed\"".into(),
                });
            }
        }
        let springs = axles.map(|(_, a, _)| a.suspension_stiffness_n_per_m.sides()[0]);
        let body = BodyOnCorners {
            coordinates: vec![("heave", "m"), ("pitch", "rad")],
            inertia: vec![self.sprung_mass_kg, self.pitch_inertia_kg_m2],
            corners: axles
                .map(|(name, axle, x)| Corner {
                    name: name.to_owned(),
                    row: vec![1.0, -x],
                    at_m: [x, 0.0],
                    damping: axle.suspension_damping_n_s_per_m.sides()[0],
                    damper_curve: axle.damper_curve.clone(),
                    unsprung_mass: axle.unsprung_mass_kg.sides()[0],
                    tire_stiffness: axle.tire_stiffness_n_per_m.sides()[0],
                    tire_damping: axle.tire_damping_n_s_per_m.sides()[0],
                })
                .into(),
            spring: Mat::from_fn(2, 2, |i, j| if i == j { springs[i] } else { 0.0 }),
            points: vec![],
            body_feels_unsprung_velocity: self.variant == HalfCarVariant::Corrected,
            patterns: vec![
                ("heave".into(), vec![1.0, 0.0, 0.0, 0.0]),
                ("pitch".into(), vec![0.0, 1.0, 0.0, 0.0]),
                ("front wheel hop".into(), vec![0.0, 0.0, 1.0, 0.0]),
                ("rear wheel hop".into(), vec![0.0, 0.0, 0.0, 1.0]),
            ],
        };
        Vehicle::new(body.assemble())
    }
}
