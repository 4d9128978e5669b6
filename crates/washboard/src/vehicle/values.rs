//! Values of vehicle files: one axle's parameters, and values that may differ from left to right.

use super::{DamperCurve, VehicleError};
use serde::{Deserialize, Serialize};

/// One value for both sides, or `[left, right]`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum LeftRight {
    /// Both sides alike.
    Both(f64),
    /// Left, right.
    Each([f64; 2]),
}

impl LeftRight {
    /// [left, right].
    #[must_use]
    pub fn sides(self) -> [f64; 2] {
        match self {
            LeftRight::Both(v) => [v, v],
            LeftRight::Each(v) => v,
        }
    }
}

impl Default for LeftRight {
    fn default() -> Self {
        LeftRight::Both(0.0)
    }
}

/// One axle: unsprung masses, suspension, tires, anti-roll bar.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Axle {
    /// Mass of one wheel with its part of the suspension, kg.
    pub unsprung_mass_kg: LeftRight,
    /// Spring rate at the wheel, N/m.
    pub suspension_stiffness_n_per_m: LeftRight,
    /// Damper rate at the wheel, N·s/m.
    pub suspension_damping_n_s_per_m: LeftRight,
    /// Vertical tire rate, N/m.
    pub tire_stiffness_n_per_m: LeftRight,
    /// Vertical tire damping, N·s/m.
    #[serde(default)]
    pub tire_damping_n_s_per_m: LeftRight,
    /// Anti-roll bar: moment per difference angle of the axle, N·m/rad; it adds K/t² to the corners.
    #[serde(default)]
    pub anti_roll_stiffness_n_m_per_rad: f64,
    /// What the dampers do in a simulated drive; `suspension_damping_n_s_per_m` stands for it everywhere else.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub damper_curve: Option<DamperCurve>,
}

impl Axle {
    /// Checks signs; `name` is `front` or `rear`.
    pub(super) fn check(&self, name: &str) -> Result<(), VehicleError> {
        for side in 0..2 {
            positive(&format!("{name}.unsprung_mass_kg"), self.unsprung_mass_kg.sides()[side])?;
            positive(&format!("{name}.tire_stiffness_n_per_m"), self.tire_stiffness_n_per_m.sides()[side])?;
            for (field, value) in [
                ("suspension_stiffness_n_per_m", self.suspension_stiffness_n_per_m),
                ("suspension_damping_n_s_per_m", self.suspension_damping_n_s_per_m),
                ("tire_damping_n_s_per_m", self.tire_damping_n_s_per_m),
            ] {
                not_negative(&format!("{name}.{field}"), value.sides()[side])?;
            }
            positive(
                &format!("{name}.suspension_stiffness_n_per_m"),
                self.suspension_stiffness_n_per_m.sides()[side],
            )?;
        }
        if let Some(curve) = &self.damper_curve {
            curve.check(&format!("{name}.damper_curve"))?;
        }
        not_negative(&format!("{name}.anti_roll_stiffness_n_m_per_rad"), self.anti_roll_stiffness_n_m_per_rad)
    }

    /// Refuses left and right that differ, and an anti-roll bar: for models of one track.
    pub(super) fn check_single_track(&self, name: &str) -> Result<(), VehicleError> {
        for (field, value) in [
            ("unsprung_mass_kg", self.unsprung_mass_kg),
            ("suspension_stiffness_n_per_m", self.suspension_stiffness_n_per_m),
            ("suspension_damping_n_s_per_m", self.suspension_damping_n_s_per_m),
            ("tire_stiffness_n_per_m", self.tire_stiffness_n_per_m),
            ("tire_damping_n_s_per_m", self.tire_damping_n_s_per_m),
        ] {
            if let LeftRight::Each(v) = value {
                return Err(VehicleError::Field {
                    field: format!("{name}.{field}"),
                    expected: "one value: a half car has one track",
                    found: format!("{v:?}"),
                });
            }
        }
        if self.anti_roll_stiffness_n_m_per_rad != 0.0 {
            return Err(VehicleError::Field {
                field: format!("{name}.anti_roll_stiffness_n_m_per_rad"),
                expected: "0: a half car does not roll",
                found: self.anti_roll_stiffness_n_m_per_rad.to_string(),
            });
        }
        Ok(())
    }
}

pub(super) fn positive(field: &str, value: f64) -> Result<(), VehicleError> {
    if value.is_finite() && value > 0.0 {
        Ok(())
    } else {
        Err(VehicleError::Field {
            field: field.to_owned(),
            expected: "a positive number",
            found: value.to_string(),
        })
    }
}

pub(super) fn not_negative(field: &str, value: f64) -> Result<(), VehicleError> {
    if value.is_finite() && value >= 0.0 {
        Ok(())
    } else {
        Err(VehicleError::Field {
            field: field.to_owned(),
            expected: "a number ≥ 0",
            found: value.to_string(),
        })
    }
}
