//! The full car (heave, pitch, roll and four wheels): De Filippis et al., section 4.1; Türkay, section 7.1.

use super::body::{BodyOnCorners, BodyPoint, Corner};
use super::values::{Axle, positive};
use super::{Vehicle, VehicleError};
use crate::linalg::Mat;
use serde::{Deserialize, Serialize};

/// A full car. Pitch is positive nose down and roll positive left side up: z(x, y) = z_G − xθ + yφ.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FullCar {
    /// m_s, kg.
    pub sprung_mass_kg: f64,
    /// J_x, kg·m².
    pub roll_inertia_kg_m2: f64,
    /// J_y, kg·m².
    pub pitch_inertia_kg_m2: f64,
    /// Front axle ahead of the c.g., m.
    pub front_axle_m: f64,
    /// Rear axle behind the c.g., m.
    pub rear_axle_m: f64,
    /// Front track width, m.
    pub front_track_m: f64,
    /// Rear track width, m.
    pub rear_track_m: f64,
    /// The c.g. left of the middle of both axles, m.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub cg_left_m: f64,
    /// The driver: forward and left of the c.g., m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub driver_m: Option<[f64; 2]>,
    /// Front axle.
    pub front: Axle,
    /// Rear axle.
    pub rear: Axle,
}

#[allow(clippy::trivially_copy_pass_by_ref)] // serde's signature
fn is_zero(v: &f64) -> bool {
    *v == 0.0
}

impl FullCar {
    /// The vehicle over (heave, pitch, roll, four unsprung masses).
    ///
    /// # Errors
    /// A mass, inertia, stiffness, distance or track that is not positive; a damping that is negative; a c.g. outside
    /// the wheels.
    pub fn assemble(&self) -> Result<Vehicle, VehicleError> {
        for (field, value) in [
            ("sprung_mass_kg", self.sprung_mass_kg),
            ("roll_inertia_kg_m2", self.roll_inertia_kg_m2),
            ("pitch_inertia_kg_m2", self.pitch_inertia_kg_m2),
            ("front_axle_m", self.front_axle_m),
            ("rear_axle_m", self.rear_axle_m),
            ("front_track_m", self.front_track_m),
            ("rear_track_m", self.rear_track_m),
        ] {
            positive(field, value)?;
        }
        self.front.check("front")?;
        self.rear.check("rear")?;
        let half = self.front_track_m.min(self.rear_track_m) / 2.0;
        if !(self.cg_left_m.abs() < half) {
            return Err(VehicleError::Field {
                field: "cg_left_m".into(),
                expected: "a c.g. between the left and right wheels",
                found: format!("{} with half a track of {half}", self.cg_left_m),
            });
        }
        let (f, r) = (&self.front, &self.rear);
        let mut spring = Mat::zeros(4, 4);
        for (i, axle, track) in [(0, f, self.front_track_m), (2, r, self.rear_track_m)] {
            let bar = axle.anti_roll_stiffness_n_m_per_rad / (track * track);
            for side in 0..2 {
                spring[(i + side, i + side)] = axle.suspension_stiffness_n_per_m.sides()[side] + bar;
                spring[(i + side, i + 1 - side)] = -bar;
            }
        }
        let corner = |name: &str, axle: &Axle, x: f64, track: f64, side: usize| {
            let y = (if side == 0 { 0.5 } else { -0.5 }) * track - self.cg_left_m;
            Corner {
                name: name.to_owned(),
                row: vec![1.0, -x, y],
                at_m: [x, y],
                damping: axle.suspension_damping_n_s_per_m.sides()[side],
                damper_curve: axle.damper_curve.clone(),
                unsprung_mass: axle.unsprung_mass_kg.sides()[side],
                tire_stiffness: axle.tire_stiffness_n_per_m.sides()[side],
                tire_damping: axle.tire_damping_n_s_per_m.sides()[side],
            }
        };
        let (xf, xr) = (self.front_axle_m, -self.rear_axle_m);
        let driver =
            self.driver_m.map(|[x, y]| BodyPoint { name: "driver_heave".into(), row: vec![1.0, -x, y] });
        let body = BodyOnCorners {
            coordinates: vec![("heave", "m"), ("pitch", "rad"), ("roll", "rad")],
            inertia: vec![self.sprung_mass_kg, self.pitch_inertia_kg_m2, self.roll_inertia_kg_m2],
            corners: vec![
                corner("front_left", f, xf, self.front_track_m, 0),
                corner("front_right", f, xf, self.front_track_m, 1),
                corner("rear_left", r, xr, self.rear_track_m, 0),
                corner("rear_right", r, xr, self.rear_track_m, 1),
            ],
            spring,
            points: driver.into_iter().collect(),
            body_feels_unsprung_velocity: true,
            patterns: patterns(),
        };
        Vehicle::new(body.assemble())
    }
}

fn patterns() -> Vec<(String, Vec<f64>)> {
    let unit = |i: usize| (0..7).map(|j| f64::from(u8::from(i == j))).collect::<Vec<_>>();
    let pair = |i: usize, sign: f64| {
        let mut p = unit(i);
        p[i + 1] = sign;
        p
    };
    vec![
        ("heave".into(), unit(0)),
        ("pitch".into(), unit(1)),
        ("roll".into(), unit(2)),
        ("front axle hop".into(), pair(3, 1.0)),
        ("front axle roll".into(), pair(3, -1.0)),
        ("rear axle hop".into(), pair(5, 1.0)),
        ("rear axle roll".into(), pair(5, -1.0)),
    ]
}
