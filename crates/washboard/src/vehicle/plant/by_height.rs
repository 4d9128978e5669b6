//! A vehicle driven by the heights of the road under its wheels: [r; u] to outputs.

use super::{CANCELLED, PlantError};
use crate::linalg::{Mat, solve};
use crate::lti::{Continuous, StateSpace};
use crate::vehicle::{Output, Vehicle};

impl Vehicle {
    /// From [r; u] to outputs.
    pub(super) fn driven_by_height(&self, outputs: &[&Output]) -> Result<StateSpace<Continuous>, PlantError> {
        let (n, w, m) = (self.system().order(), self.wheels().len(), self.actuators().len());
        let over_m = |x: &Mat| solve(self.system().m(), x);
        let (mk, mc) = (over_m(self.system().k())?, over_m(self.system().c())?);
        let (mkw, mbu) =
            (over_m(self.wheel_stiffness())?, over_m(&self.actuator_columns(&(0..m).collect::<Vec<_>>()))?);
        // q̇ = p + J r
        let jump = over_m(self.wheel_damping())?;
        let slowed = &mc * &jump;
        let size = 2 * n;
        let a = Mat::from_fn(size, size, |i, j| match (i < n, j < n) {
            (true, true) => 0.0,
            (true, false) => f64::from(u8::from(j - n == i)),
            (false, true) => -mk[(i - n, j)],
            (false, false) => -mc[(i - n, j - n)],
        });
        let b = Mat::from_fn(size, w + m, |i, j| match (i < n, j < w) {
            (true, true) => jump[(i, j)],
            (true, false) => 0.0,
            (false, true) => mkw[(i - n, j)] - slowed[(i - n, j)],
            (false, false) => mbu[(i - n, j - w)],
        });
        let p = outputs.len();
        let mut c = Mat::zeros(p, size);
        let mut d = Mat::zeros(p, w + m);
        for (i, o) in outputs.iter().enumerate() {
            let row = |q: &Vec<f64>, m: &Mat, j: usize| -> f64 {
                q.iter().enumerate().map(|(k, v)| v * m[(k, j)]).sum()
            };
            for j in 0..w {
                let rates = [row(&o.q[2], &jump, j), o.r[1].get(j).copied().unwrap_or(0.0)];
                let size = rates.iter().map(|v| v.abs()).sum::<f64>();
                if rates.iter().sum::<f64>().abs() > CANCELLED * size || o.r[2].iter().any(|v| *v != 0.0) {
                    let output = o.name.clone();
                    return Err(PlantError::Improper { output, disturbance: "road's height" });
                }
                d[(i, j)] = o.r[0].get(j).copied().unwrap_or(0.0) + row(&o.q[1], &jump, j);
            }
            for (j, v) in o.u.iter().enumerate() {
                d[(i, w + j)] = *v;
            }
            for (k, v) in o.q[2].iter().enumerate() {
                (0..size).for_each(|l| c[(i, l)] += v * a[(n + k, l)]);
                (0..w + m).for_each(|j| d[(i, j)] += v * b[(n + k, j)]);
            }
            o.q[0].iter().enumerate().for_each(|(k, v)| c[(i, k)] += v);
            o.q[1].iter().enumerate().for_each(|(k, v)| c[(i, n + k)] += v);
        }
        Ok(StateSpace::continuous(a, b, c, d)?)
    }
}
