//! The bounce model of a truck (cabin, chassis, axle): Türkay, section 8.2.

use super::body::motions;
use super::values::{not_negative, positive};
use super::{Output, Parts, Vehicle, VehicleError, Wheel};
use crate::linalg::Mat;
use serde::{Deserialize, Serialize};

/// m_c ẍ₂ = −k_c(x₂ − w) − c_c(ẋ₂ − ẇ); m_s ẅ = … ; m_u ẍ₁ = … − k_T(x₁ − r), over (cabin, sprung, unsprung).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BounceTruck {
    /// m_c, kg.
    pub cabin_mass_kg: f64,
    /// m_s, kg.
    pub sprung_mass_kg: f64,
    /// m_u, kg.
    pub unsprung_mass_kg: f64,
    /// k_s between axle and chassis, N/m.
    pub primary_stiffness_n_per_m: f64,
    /// c_s, N·s/m.
    pub primary_damping_n_s_per_m: f64,
    /// k_c between chassis and cabin, N/m.
    pub secondary_stiffness_n_per_m: f64,
    /// c_c, N·s/m.
    pub secondary_damping_n_s_per_m: f64,
    /// k_T, N/m.
    pub tire_stiffness_n_per_m: f64,
    /// c_T, N·s/m (the thesis has none).
    #[serde(default)]
    pub tire_damping_n_s_per_m: f64,
}

/// Degrees of freedom of the chain, top first.
pub(super) const CHAIN: [&str; 3] = ["cabin", "sprung", "unsprung"];

impl BounceTruck {
    pub(super) fn check(&self) -> Result<(), VehicleError> {
        positive("cabin_mass_kg", self.cabin_mass_kg)?;
        positive("sprung_mass_kg", self.sprung_mass_kg)?;
        positive("unsprung_mass_kg", self.unsprung_mass_kg)?;
        positive("primary_stiffness_n_per_m", self.primary_stiffness_n_per_m)?;
        positive("secondary_stiffness_n_per_m", self.secondary_stiffness_n_per_m)?;
        positive("tire_stiffness_n_per_m", self.tire_stiffness_n_per_m)?;
        not_negative("primary_damping_n_s_per_m", self.primary_damping_n_s_per_m)?;
        not_negative("secondary_damping_n_s_per_m", self.secondary_damping_n_s_per_m)?;
        not_negative("tire_damping_n_s_per_m", self.tire_damping_n_s_per_m)
    }

    /// Diagonal of M, and C and K of the chain to ground.
    pub(super) fn chain(&self) -> ([f64; 3], [[f64; 3]; 3], [[f64; 3]; 3]) {
        let chain = |a: f64, b: f64, c: f64| [[a, -a, 0.0], [-a, a + b, -b], [0.0, -b, b + c]];
        (
            [self.cabin_mass_kg, self.sprung_mass_kg, self.unsprung_mass_kg],
            chain(
                self.secondary_damping_n_s_per_m,
                self.primary_damping_n_s_per_m,
                self.tire_damping_n_s_per_m,
            ),
            chain(
                self.secondary_stiffness_n_per_m,
                self.primary_stiffness_n_per_m,
                self.tire_stiffness_n_per_m,
            ),
        )
    }

    /// The vehicle.
    ///
    /// # Errors
    /// A mass or stiffness that is not positive, a damping that is negative.
    pub fn assemble(&self) -> Result<Vehicle, VehicleError> {
        self.check()?;
        let (m, c, k) = self.chain();
        let unit = |i: usize| (0..3).map(|j| f64::from(u8::from(i == j))).collect::<Vec<_>>();
        let mut outputs = Vec::new();
        for (i, name) in CHAIN.iter().enumerate() {
            motions(&mut outputs, name, "", &unit(i), "m");
        }
        let mut push = |name: &str, unit, q: [Vec<f64>; 3], r: [Vec<f64>; 3]| {
            outputs.push(Output { name: name.into(), base: name.into(), unit, q, r, u: vec![] });
        };
        let none = || [vec![], vec![], vec![]];
        push("cabin_suspension_travel", "m", [vec![1.0, -1.0, 0.0], vec![], vec![]], none());
        push("suspension_travel", "m", [vec![0.0, 1.0, -1.0], vec![], vec![]], none());
        push("tire_deflection", "m", [unit(2), vec![], vec![]], [vec![-1.0], vec![], vec![]]);
        let (kt, ct) = (self.tire_stiffness_n_per_m, self.tire_damping_n_s_per_m);
        let damped = |row: Vec<f64>| if ct == 0.0 { vec![] } else { row };
        push(
            "tire_force",
            "N",
            [vec![0.0, 0.0, kt], damped(vec![0.0, 0.0, ct]), vec![]],
            [vec![-kt], damped(vec![-ct]), vec![]],
        );
        Vehicle::new(Parts {
            m: Mat::from_fn(3, 3, |i, j| if i == j { m[i] } else { 0.0 }),
            c: Mat::from_fn(3, 3, |i, j| c[i][j]),
            k: Mat::from_fn(3, 3, |i, j| k[i][j]),
            dofs: CHAIN.map(str::to_owned).into(),
            wheel_stiffness: Mat::from_fn(3, 1, |i, _| if i == 2 { kt } else { 0.0 }),
            wheel_damping: Mat::from_fn(3, 1, |i, _| if i == 2 { ct } else { 0.0 }),
            wheels: vec![Wheel { name: "wheel".into(), at_m: [0.0, 0.0] }],
            outputs,
            actuators: vec![],
            patterns: vec![
                ("cabin bounce".into(), unit(0)),
                ("chassis bounce".into(), unit(1)),
                ("wheel hop".into(), unit(2)),
            ],
            dampers: vec![],
        })
    }
}
