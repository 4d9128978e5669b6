//! The truck cabin on four suspension points, each on a bounce model of the truck: Türkay, sections 8.1 and 8.2.

use super::body::{join, motions};
use super::bounce_truck::{BounceTruck, CHAIN};
use super::values::{not_negative, positive};
use super::{Actuator, Output, Parts, Vehicle, VehicleError, Wheel};
use crate::linalg::Mat;
use serde::{Deserialize, Serialize};

/// One end of the cabin's suspension.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CabinAxle {
    /// Stiffness of each side, N/m.
    pub stiffness_n_per_m: f64,
    /// Damping of each side, N·s/m.
    pub damping_n_s_per_m: f64,
    /// Anti-roll bar, N·m/rad: it adds K/t² to the corners.
    #[serde(default)]
    pub anti_roll_n_m_per_rad: f64,
}

/// A cabin (heave, pitch, roll) on a chassis. The chassis moves the cabin and does not feel it: under each of the four
/// points stands a bounce model of the truck, driven by its own wheel input (the thesis's A_w = I₄ ⊗ Â_w).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TruckCabin {
    /// m_c, kg.
    pub cabin_mass_kg: f64,
    /// I_x in the thesis's axes (its x is lateral): pitch, kg·m².
    pub pitch_inertia_kg_m2: f64,
    /// I_y in the thesis's axes: roll, kg·m².
    pub roll_inertia_kg_m2: f64,
    /// l₂: front points ahead of the c.g., m.
    pub front_axle_m: f64,
    /// l₁: rear points behind the c.g., m.
    pub rear_axle_m: f64,
    /// n₃ = n₄: half the front width, m.
    pub front_half_width_m: f64,
    /// n₁ = n₂: half the rear width, m.
    pub rear_half_width_m: f64,
    /// Front suspension.
    pub front: CabinAxle,
    /// Rear suspension.
    pub rear: CabinAxle,
    /// A vehicle file or `case:NAME` of model `bounce-truck`.
    pub chassis: String,
}

const BODY: [&str; 3] = ["heave", "pitch", "roll"];
const CORNERS: [&str; 4] = ["front_left", "front_right", "rear_left", "rear_right"];

impl TruckCabin {
    /// The vehicle over (heave, pitch, roll) and four chains (cabin, sprung, unsprung).
    ///
    /// # Errors
    /// A mass, inertia, stiffness or distance that is not positive; a damping that is negative.
    pub fn assemble(&self, chassis: &BounceTruck) -> Result<Vehicle, VehicleError> {
        self.check()?;
        chassis.check()?;
        Vehicle::new(self.parts(chassis))
    }

    fn check(&self) -> Result<(), VehicleError> {
        for (field, value) in [
            ("cabin_mass_kg", self.cabin_mass_kg),
            ("pitch_inertia_kg_m2", self.pitch_inertia_kg_m2),
            ("roll_inertia_kg_m2", self.roll_inertia_kg_m2),
            ("front_axle_m", self.front_axle_m),
            ("rear_axle_m", self.rear_axle_m),
            ("front_half_width_m", self.front_half_width_m),
            ("rear_half_width_m", self.rear_half_width_m),
            ("front.stiffness_n_per_m", self.front.stiffness_n_per_m),
            ("rear.stiffness_n_per_m", self.rear.stiffness_n_per_m),
        ] {
            positive(field, value)?;
        }
        for (field, value) in [
            ("front.damping_n_s_per_m", self.front.damping_n_s_per_m),
            ("rear.damping_n_s_per_m", self.rear.damping_n_s_per_m),
            ("front.anti_roll_n_m_per_rad", self.front.anti_roll_n_m_per_rad),
            ("rear.anti_roll_n_m_per_rad", self.rear.anti_roll_n_m_per_rad),
        ] {
            not_negative(field, value)?;
        }
        Ok(())
    }

    /// Corners, their rows Ψ over (heave, pitch, roll), and stiffness and damping between their travels.
    fn corners(&self) -> ([[f64; 2]; 4], Mat, Mat, Mat) {
        let (xf, xr) = (self.front_axle_m, -self.rear_axle_m);
        let (yf, yr) = (self.front_half_width_m, self.rear_half_width_m);
        let at = [[xf, yf], [xf, -yf], [xr, yr], [xr, -yr]];
        let psi = Mat::from_fn(4, 3, |i, j| [1.0, -at[i][0], at[i][1]][j]);
        let axle = |i: usize| if i < 2 { &self.front } else { &self.rear };
        let mut spring = Mat::from_fn(4, 4, |i, j| if i == j { axle(i).stiffness_n_per_m } else { 0.0 });
        for (i, y) in [(0, yf), (2, yr)] {
            let bar = axle(i).anti_roll_n_m_per_rad / (4.0 * y * y);
            for side in 0..2 {
                spring[(i + side, i + side)] += bar;
                spring[(i + side, i + 1 - side)] -= bar;
            }
        }
        let damper = Mat::from_fn(4, 4, |i, j| if i == j { axle(i).damping_n_s_per_m } else { 0.0 });
        (at, psi, spring, damper)
    }

    fn inertia(&self) -> [f64; 3] {
        [self.cabin_mass_kg, self.pitch_inertia_kg_m2, self.roll_inertia_kg_m2]
    }

    fn parts(&self, chassis: &BounceTruck) -> Parts {
        let (at, psi, spring, damper) = self.corners();
        let (cm, cc, ck) = chassis.chain();
        let n = 3 + 12;
        // the chassis point of corner i is the `sprung` mass of chain i
        let point = |i: usize| 3 + 3 * i + 1;
        let one_way = |s: &Mat, chain: &[[f64; 3]; 3]| {
            let mut a = Mat::zeros(n, n);
            let top = psi.transpose() * s;
            let bb = &top * &psi;
            for i in 0..3 {
                for j in 0..3 {
                    a[(i, j)] = bb[(i, j)];
                    for corner in 0..4 {
                        a[(3 + 3 * corner + i, 3 + 3 * corner + j)] = chain[i][j];
                    }
                }
                for corner in 0..4 {
                    a[(i, point(corner))] = -top[(i, corner)];
                }
            }
            a
        };
        let inertia = self.inertia();
        let m = Mat::from_fn(n, n, |i, j| match (i == j, i < 3) {
            (false, _) => 0.0,
            (true, true) => inertia[i],
            (true, false) => cm[(i - 3) % 3],
        });
        let under = |v: f64| Mat::from_fn(n, 4, |i, j| if i == 3 + 3 * j + 2 { v } else { 0.0 });
        let mut dofs: Vec<String> = BODY.map(str::to_owned).into();
        dofs.extend(CORNERS.iter().flat_map(|c| CHAIN.map(|d| format!("chassis_{d}_{c}"))));
        let unit = |i: usize| (0..n).map(|j| f64::from(u8::from(i == j))).collect::<Vec<_>>();
        Parts {
            m,
            c: one_way(&damper, &cc),
            k: one_way(&spring, &ck),
            dofs,
            wheel_stiffness: under(chassis.tire_stiffness_n_per_m),
            wheel_damping: under(chassis.tire_damping_n_s_per_m),
            wheels: (0..4).map(|i| Wheel { name: CORNERS[i].into(), at_m: at[i] }).collect(),
            outputs: outputs(&psi, n, Some(&point)),
            actuators: actuators(&psi, n),
            patterns: BODY.iter().enumerate().map(|(i, l)| ((*l).into(), unit(i))).collect(),
            dampers: vec![],
        }
    }

    /// The cabin alone over (heave, pitch, roll), its road inputs the displacements w of the four chassis points
    /// (`chassis_front_left` …), as the thesis has it before it takes a chassis:
    /// M ẍ_S + ΨᵀC(Ψ ẋ_S − ẇ) + ΨᵀK(Ψ x_S − w) + Ψᵀu = 0.
    ///
    /// # Errors
    /// As [`TruckCabin::assemble`].
    ///
    /// Source: Türkay's thesis, section 8.1.
    pub fn at_points(&self) -> Result<Vehicle, VehicleError> {
        self.check()?;
        let (at, psi, spring, damper) = self.corners();
        let inertia = self.inertia();
        let (under_spring, under_damper) = (psi.transpose() * &spring, psi.transpose() * &damper);
        let unit = |i: usize| (0..3).map(|j| f64::from(u8::from(i == j))).collect::<Vec<_>>();
        let mut outputs = outputs(&psi, 3, None);
        for (i, corner) in CORNERS.iter().enumerate() {
            let row: Vec<f64> = (0..4).map(|j| f64::from(u8::from(i == j))).collect();
            for (d, (what, unit)) in
                [("displacement", "m"), ("velocity", "m/s"), ("acceleration", "m/s²")].into_iter().enumerate()
            {
                let base = format!("chassis_{what}");
                let mut r = [vec![], vec![], vec![]];
                r[d].clone_from(&row);
                let q = [vec![], vec![], vec![]];
                outputs.push(Output { name: join(&base, corner), base, unit, q, r, u: vec![] });
            }
        }
        Vehicle::new(Parts {
            m: Mat::from_fn(3, 3, |i, j| if i == j { inertia[i] } else { 0.0 }),
            c: &under_damper * &psi,
            k: &under_spring * &psi,
            dofs: BODY.map(str::to_owned).into(),
            wheel_stiffness: under_spring,
            wheel_damping: under_damper,
            wheels: CORNERS
                .iter()
                .zip(at)
                .map(|(c, at_m)| Wheel { name: format!("chassis_{c}"), at_m })
                .collect(),
            outputs,
            actuators: actuators(&psi, 3),
            patterns: BODY.iter().enumerate().map(|(i, l)| ((*l).into(), unit(i))).collect(),
            dampers: vec![],
        })
    }
}

fn actuators(psi: &Mat, n: usize) -> Vec<Actuator> {
    let column = |i: usize| (0..n).map(|j| if j < 3 { -psi[(i, j)] } else { 0.0 }).collect();
    CORNERS.iter().enumerate().map(|(i, c)| Actuator { name: (*c).into(), column: column(i) }).collect()
}

/// `point` is the degree of freedom that is a chassis point; without it the points are road inputs.
fn outputs(psi: &Mat, n: usize, point: Option<&dyn Fn(usize) -> usize>) -> Vec<Output> {
    let mut out = Vec::new();
    let row = |f: &dyn Fn(usize) -> f64| (0..n).map(f).collect::<Vec<_>>();
    for (i, (name, unit)) in [("heave", "m"), ("pitch", "rad"), ("roll", "rad")].into_iter().enumerate() {
        motions(&mut out, name, "", &row(&|j| f64::from(u8::from(i == j))), unit);
    }
    for (i, corner) in CORNERS.iter().enumerate() {
        let body = row(&|j| if j < 3 { psi[(i, j)] } else { 0.0 });
        motions(&mut out, "body", corner, &body, "m");
        if let Some(point) = point {
            motions(&mut out, "chassis", corner, &row(&|j| f64::from(u8::from(j == point(i)))), "m");
        }
    }
    for (i, corner) in CORNERS.iter().enumerate() {
        let below = |j: usize| point.is_some_and(|point| j == point(i));
        let travel = row(&|j| if j < 3 { psi[(i, j)] } else { -f64::from(u8::from(below(j))) });
        let none = || [vec![], vec![], vec![]];
        let base = "suspension_travel".to_owned();
        let q = [travel, vec![], vec![]];
        let own = (0..4).map(|j| -f64::from(u8::from(i == j))).collect();
        let r = if point.is_none() { [own, vec![], vec![]] } else { none() };
        out.push(Output { name: join(&base, corner), base, unit: "m", q, r, u: vec![] });
        let base = "actuator_force".to_owned();
        let u = (0..4).map(|j| f64::from(u8::from(i == j))).collect();
        out.push(Output { name: join(&base, corner), base, unit: "N", q: none(), r: none(), u });
    }
    out
}
