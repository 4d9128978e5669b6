//! A vehicle driven by the velocities of the road under its wheels: [ṙ; u] to outputs.

use super::{CANCELLED, PlantError};
use crate::linalg::{LinalgError, Mat, solve};
use crate::lti::{Continuous, StateSpace};
use crate::vehicle::driven::resting;
use crate::vehicle::{Output, Vehicle};

impl Vehicle {
    /// From [ṙ; u] to outputs.
    pub(super) fn driven_by_velocity(
        &self,
        outputs: &[&Output],
    ) -> Result<StateSpace<Continuous>, PlantError> {
        let (n, w, m) = (self.system().order(), self.wheels().len(), self.actuators().len());
        let over_m = |x: &Mat| solve(self.system().m(), x);
        let (mk, mc) = (over_m(self.system().k())?, over_m(self.system().c())?);
        let (mcw, mbu) =
            (over_m(self.wheel_damping())?, over_m(&self.actuator_columns(&(0..m).collect::<Vec<_>>()))?);
        let (t, t_size) = resting(self)?;
        // outputs' dependence on heights that stand still, and an orthonormal basis of it
        let p = outputs.len();
        let mut heights = Mat::zeros(p, w);
        for (i, o) in outputs.iter().enumerate() {
            for j in 0..w {
                let from_q =
                    o.q[0].iter().enumerate().map(|(k, v)| (v * t[(k, j)], v.abs() * t_size[(k, j)]));
                let terms = from_q.chain(o.r[0].get(j).map(|v| (*v, v.abs())));
                let (sum, size) = terms.fold((0.0, 0.0), |(s, a), (v, size)| (s + v, a + size));
                heights[(i, j)] = if f64::abs(sum) <= CANCELLED * size { 0.0 } else { sum };
            }
            if o.r[2].iter().any(|v| *v != 0.0) {
                let output = o.name.clone();
                return Err(PlantError::Improper { output, disturbance: "road's velocity" });
            }
        }
        let basis = row_basis(&heights)?;
        let k = basis.nrows();
        let size = 2 * n + k;
        let mut a = Mat::zeros(size, size);
        let mut b = Mat::zeros(size, w + m);
        for i in 0..n {
            a[(i, n + i)] = 1.0;
            for j in 0..n {
                a[(n + i, j)] = -mk[(i, j)];
                a[(n + i, n + j)] = -mc[(i, j)];
            }
            for j in 0..w {
                b[(i, j)] = -t[(i, j)];
                b[(n + i, j)] = mcw[(i, j)];
            }
            for j in 0..m {
                b[(n + i, w + j)] = mbu[(i, j)];
            }
        }
        for i in 0..k {
            for j in 0..w {
                b[(2 * n + i, j)] = basis[(i, j)];
            }
        }
        let on_heights = &heights * basis.transpose();
        let mut c = Mat::zeros(p, size);
        let mut d = Mat::zeros(p, w + m);
        for (i, o) in outputs.iter().enumerate() {
            for l in 0..size {
                let own = |q: &Vec<f64>, from: usize| {
                    l.checked_sub(from).and_then(|l| q.get(l)).copied().unwrap_or(0.0)
                };
                let of_acceleration: f64 = o.q[2].iter().enumerate().map(|(r, v)| v * a[(n + r, l)]).sum();
                c[(i, l)] = of_acceleration
                    + if l < n { own(&o.q[0], 0) } else { 0.0 }
                    + if (n..2 * n).contains(&l) { own(&o.q[1], n) } else { 0.0 }
                    + if l >= 2 * n { on_heights[(i, l - 2 * n)] } else { 0.0 };
            }
            for j in 0..w + m {
                let of_acceleration: f64 = o.q[2].iter().enumerate().map(|(r, v)| v * b[(n + r, j)]).sum();
                let direct = if j < w { o.r[1].get(j) } else { o.u.get(j - w) };
                d[(i, j)] = of_acceleration + direct.copied().unwrap_or(0.0);
            }
        }
        Ok(StateSpace::continuous(a, b, c, d)?)
    }
}

/// An orthonormal basis of a matrix's rows.
fn row_basis(m: &Mat) -> Result<Mat, LinalgError> {
    if m.norm_max() == 0.0 {
        return Ok(Mat::zeros(0, m.ncols()));
    }
    let svd = m.svd().map_err(|_| LinalgError::NoConvergence { what: "the SVD", order: m.ncols() })?;
    let rank = svd.S().column_vector().iter().filter(|s| **s > CANCELLED * svd.S()[0]).count();
    Ok(svd.V().subcols(0, rank).transpose().to_owned())
}
