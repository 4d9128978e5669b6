//! The quarter car: Türkay, section 4.1.

use super::body::{BodyOnCorners, Corner};
use super::values::{not_negative, positive};
use super::{DamperCurve, Vehicle, VehicleError};
use crate::linalg::Mat;
use serde::{Deserialize, Serialize};

/// m_s z̈_s + c_s(ż_s − ż_u) + k_s(z_s − z_u) = −u, m_u z̈_u + … + k_t(z_u − r) + c_t(ż_u − ṙ) = u. Eqs. (4.1).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct QuarterCar {
    /// m_s, kg.
    pub sprung_mass_kg: f64,
    /// m_u, kg.
    pub unsprung_mass_kg: f64,
    /// k_s, N/m.
    pub suspension_stiffness_n_per_m: f64,
    /// c_s, N·s/m.
    pub suspension_damping_n_s_per_m: f64,
    /// k_t, N/m.
    pub tire_stiffness_n_per_m: f64,
    /// c_t, N·s/m.
    #[serde(default)]
    pub tire_damping_n_s_per_m: f64,
    /// What the damper does in a simulated drive; `suspension_damping_n_s_per_m` stands for it everywhere else.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub damper_curve: Option<DamperCurve>,
}

impl QuarterCar {
    /// The vehicle.
    ///
    /// # Errors
    /// A mass or stiffness that is not positive, a damping that is negative.
    pub fn assemble(&self) -> Result<Vehicle, VehicleError> {
        positive("sprung_mass_kg", self.sprung_mass_kg)?;
        positive("unsprung_mass_kg", self.unsprung_mass_kg)?;
        positive("suspension_stiffness_n_per_m", self.suspension_stiffness_n_per_m)?;
        not_negative("suspension_damping_n_s_per_m", self.suspension_damping_n_s_per_m)?;
        positive("tire_stiffness_n_per_m", self.tire_stiffness_n_per_m)?;
        not_negative("tire_damping_n_s_per_m", self.tire_damping_n_s_per_m)?;
        if let Some(curve) = &self.damper_curve {
            curve.check("damper_curve")?;
        }
        let body = BodyOnCorners {
            coordinates: vec![("sprung", "m")],
            inertia: vec![self.sprung_mass_kg],
            corners: vec![Corner {
                name: String::new(),
                row: vec![1.0],
                at_m: [0.0, 0.0],
                damping: self.suspension_damping_n_s_per_m,
                damper_curve: self.damper_curve.clone(),
                unsprung_mass: self.unsprung_mass_kg,
                tire_stiffness: self.tire_stiffness_n_per_m,
                tire_damping: self.tire_damping_n_s_per_m,
            }],
            spring: Mat::from_fn(1, 1, |_, _| self.suspension_stiffness_n_per_m),
            points: vec![],
            body_feels_unsprung_velocity: true,
            patterns: vec![("heave".into(), vec![1.0, 0.0]), ("wheel hop".into(), vec![0.0, 1.0])],
        };
        let mut parts = body.assemble();
        parts.wheels[0].name = "wheel".into();
        parts.actuators[0].name = "actuator".into();
        Vehicle::new(parts)
    }
}
