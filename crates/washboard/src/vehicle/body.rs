//! A rigid body on corners: springs, dampers and wheels under points of it. Quarter, half and full cars are this.

use super::{Actuator, Damper, DamperCurve, Output, Parts, Wheel};
use crate::linalg::Mat;

/// One corner: the body's row (displacement of its top per body coordinate), the wheel under it.
pub(super) struct Corner {
    pub name: String,
    pub row: Vec<f64>,
    pub at_m: [f64; 2],
    pub damping: f64,
    pub damper_curve: Option<DamperCurve>,
    pub unsprung_mass: f64,
    pub tire_stiffness: f64,
    pub tire_damping: f64,
}

/// A point of the body with a name of its own, such as the driver's seat.
pub(super) struct BodyPoint {
    pub name: String,
    pub row: Vec<f64>,
}

/// What the body is made of.
pub(super) struct BodyOnCorners {
    /// Names of the body's coordinates.
    pub coordinates: Vec<(&'static str, &'static str)>,
    /// Their masses and inertias.
    pub inertia: Vec<f64>,
    pub corners: Vec<Corner>,
    /// Stiffness between corner travels, anti-roll bars included (corners × corners).
    pub spring: Mat,
    pub points: Vec<BodyPoint>,
    /// Whether damper forces see the velocities of the unsprung masses at the body's end (false: Türkay's (6.15) as
    /// printed).
    pub body_feels_unsprung_velocity: bool,
    pub patterns: Vec<(String, Vec<f64>)>,
}

impl BodyOnCorners {
    /// M, C, K over (body coordinates, wheels), wheel inputs, outputs and actuators.
    ///
    /// With Ψ the corner rows, travel Ψ q_b − z_u:
    /// K = [ΨᵀK_sΨ, −ΨᵀK_s; −K_sΨ, K_s + K_t], C alike with C_s, C_t.
    pub fn assemble(&self) -> Parts {
        let (nb, nc) = (self.inertia.len(), self.corners.len());
        let n = nb + nc;
        let psi = Mat::from_fn(nc, nb, |i, j| self.corners[i].row[j]);
        let damper = Mat::from_fn(nc, nc, |i, j| if i == j { self.corners[i].damping } else { 0.0 });
        let tire = |f: fn(&Corner) -> f64| {
            Mat::from_fn(nc, nc, |i, j| if i == j { f(&self.corners[i]) } else { 0.0 })
        };
        let m = Mat::from_fn(n, n, |i, j| match (i == j, i < nb) {
            (false, _) => 0.0,
            (true, true) => self.inertia[i],
            (true, false) => self.corners[i - nb].unsprung_mass,
        });
        let k = two_ends(&psi, &self.spring, &tire(|c| c.tire_stiffness));
        let mut c = two_ends(&psi, &damper, &tire(|c| c.tire_damping));
        if !self.body_feels_unsprung_velocity {
            for i in 0..nb {
                for j in nb..n {
                    c[(i, j)] = 0.0;
                }
            }
        }
        let under = |a: &Mat| Mat::from_fn(n, nc, |i, j| if i < nb { 0.0 } else { a[(i - nb, j)] });
        Parts {
            m,
            c,
            k,
            dofs: self.dofs(),
            wheel_stiffness: under(&tire(|c| c.tire_stiffness)),
            wheel_damping: under(&tire(|c| c.tire_damping)),
            wheels: self.corners.iter().map(|c| Wheel { name: c.name.clone(), at_m: c.at_m }).collect(),
            outputs: self.outputs(),
            actuators: self.actuators(),
            patterns: self.patterns.clone(),
            dampers: self.dampers(),
        }
    }

    /// The dampers with a curve: compression is the wheel towards the body.
    fn dampers(&self) -> Vec<Damper> {
        let with_curve = |(i, corner): (usize, &Corner)| {
            let curve = corner.damper_curve.clone()?;
            let body = corner.row.iter().map(|v| -v);
            let wheels = (0..self.corners.len()).map(|j| f64::from(u8::from(i == j)));
            let (name, linear) = (corner.name.clone(), corner.damping);
            Some(Damper { name, row: body.chain(wheels).collect(), linear, curve })
        };
        self.corners.iter().enumerate().filter_map(with_curve).collect()
    }

    fn dofs(&self) -> Vec<String> {
        let body = self.coordinates.iter().map(|(name, _)| (*name).to_owned());
        body.chain(self.corners.iter().map(|c| join("unsprung", &c.name))).collect()
    }

    /// An actuator pulls the body down and pushes the wheel up, as Türkay's u: [−Ψᵀ; I].
    fn actuators(&self) -> Vec<Actuator> {
        let nb = self.inertia.len();
        (0..self.corners.len())
            .map(|i| {
                let body = self.corners[i].row.iter().map(|v| -v);
                let wheels = (0..self.corners.len()).map(|j| f64::from(u8::from(i == j)));
                debug_assert_eq!(body.len(), nb);
                Actuator { name: self.corners[i].name.clone(), column: body.chain(wheels).collect() }
            })
            .collect()
    }

    fn outputs(&self) -> Vec<Output> {
        let (nb, nc) = (self.inertia.len(), self.corners.len());
        let n = nb + nc;
        let mut out = Vec::new();
        let body = |row: &[f64]| row.iter().copied().chain(vec![0.0; nc]).collect::<Vec<_>>();
        let wheel = |i: usize, v: f64| (0..n).map(|j| if j == nb + i { v } else { 0.0 }).collect::<Vec<_>>();
        let road = |i: usize, v: f64| (0..nc).map(|j| if j == i { v } else { 0.0 }).collect::<Vec<_>>();
        for (i, (name, unit)) in self.coordinates.iter().enumerate() {
            let row: Vec<f64> = (0..n).map(|j| f64::from(u8::from(i == j))).collect();
            motions(&mut out, name, "", &row, unit);
        }
        for point in &self.points {
            motions(&mut out, &point.name, "", &body(&point.row), "m");
        }
        for corner in self.corners.iter().filter(|c| !c.name.is_empty()) {
            motions(&mut out, "body", &corner.name, &body(&corner.row), "m");
        }
        for (i, corner) in self.corners.iter().enumerate() {
            motions(&mut out, "unsprung", &corner.name, &wheel(i, 1.0), "m");
        }
        for (i, corner) in self.corners.iter().enumerate() {
            let mut travel = body(&corner.row);
            travel[nb + i] = -1.0;
            let mut push = |base: &str, unit, q: [Vec<f64>; 3], r: [Vec<f64>; 3], u: Vec<f64>| {
                out.push(Output { name: join(base, &corner.name), base: base.to_owned(), unit, q, r, u });
            };
            let none = || [vec![], vec![], vec![]];
            push("suspension_travel", "m", [travel, vec![], vec![]], none(), vec![]);
            push(
                "tire_deflection",
                "m",
                [wheel(i, 1.0), vec![], vec![]],
                [road(i, -1.0), vec![], vec![]],
                vec![],
            );
            let (k, c) = (corner.tire_stiffness, corner.tire_damping);
            let damped = c != 0.0;
            let velocity = |row: Vec<f64>| if damped { row } else { vec![] };
            push(
                "tire_force",
                "N",
                [wheel(i, k), velocity(wheel(i, c)), vec![]],
                [road(i, -k), velocity(road(i, -c)), vec![]],
                vec![],
            );
            push("actuator_force", "N", none(), none(), road(i, 1.0));
        }
        out
    }
}

/// [ΨᵀSΨ, −ΨᵀS; −SΨ, S + T]: an element S between body corners and wheels, and T between wheels and road.
fn two_ends(psi: &Mat, s: &Mat, t: &Mat) -> Mat {
    let (nc, nb) = (psi.nrows(), psi.ncols());
    let top = psi.transpose() * s;
    let bb = &top * psi;
    let down = s * psi;
    Mat::from_fn(nb + nc, nb + nc, |i, j| match (i < nb, j < nb) {
        (true, true) => bb[(i, j)],
        (true, false) => -top[(i, j - nb)],
        (false, true) => -down[(i - nb, j)],
        (false, false) => s[(i - nb, j - nb)] + t[(i - nb, j - nb)],
    })
}

/// Displacement, velocity and acceleration of a row over q.
pub(super) fn motions(out: &mut Vec<Output>, what: &str, place: &str, row: &[f64], unit: &str) {
    let units: [&'static str; 3] =
        if unit == "rad" { ["rad", "rad/s", "rad/s²"] } else { ["m", "m/s", "m/s²"] };
    for (d, suffix) in ["displacement", "velocity", "acceleration"].into_iter().enumerate() {
        let base = join(what, suffix);
        let mut q = [vec![], vec![], vec![]];
        q[d] = row.to_vec();
        let r = [vec![], vec![], vec![]];
        out.push(Output { name: join(&base, place), base, unit: units[d], q, r, u: vec![] });
    }
}

/// `a_b`, or `a` where b is empty.
pub(super) fn join(a: &str, b: &str) -> String {
    if b.is_empty() { a.to_owned() } else { format!("{a}_{b}") }
}
