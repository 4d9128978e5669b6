//! A vehicle driven by the velocities of the road under its wheels: tracks and forces to outputs.

use super::{CANCELLED, PlantError};
use crate::linalg::{LinalgError, Mat, solve};
use crate::lti::{Continuous, StateSpace};
use crate::vehicle::driven::resting;
use crate::vehicle::{Output, Vehicle};

impl Vehicle {
    /// From [ṙ of the tracks that lead; u] to outputs, `tracks` from those to ṙ of all wheels.
    ///
    /// Heights of wheels are r = C_t A_t⁻¹ x_t + P(0) g, with the tracks' delays P = C_t(sI − A_t)⁻¹B_t + D_t and ġ what drives them: only
    /// outputs that P(0) lets see a height that stands still have a state g, and a pole at 0. The twist of a car whose rear wheels
    /// follow the front ones comes back to none.
    pub(super) fn driven_by_velocity(
        &self,
        outputs: &[&Output],
        tracks: &StateSpace<Continuous>,
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
        let ahead = ahead(tracks)?;
        let (stands, follows) = standing(&heights, &ahead, tracks);
        let basis = row_basis(&stands)?;
        let (k, nt, nw) = (basis.nrows(), tracks.order(), tracks.inputs());
        // states q − T r, q̇, of the tracks, g
        let size = 2 * n + nt + k;
        let mut a = Mat::zeros(size, size);
        let mut b = Mat::zeros(size, nw + m);
        let (tc, td) = (&t * tracks.c(), &t * tracks.d());
        let (force_c, force_d) = (&mcw * tracks.c(), &mcw * tracks.d());
        for i in 0..n {
            a[(i, n + i)] = 1.0;
            for j in 0..n {
                a[(n + i, j)] = -mk[(i, j)];
                a[(n + i, n + j)] = -mc[(i, j)];
            }
            for j in 0..nt {
                a[(i, 2 * n + j)] = -tc[(i, j)];
                a[(n + i, 2 * n + j)] = force_c[(i, j)];
            }
            for j in 0..nw {
                b[(i, j)] = -td[(i, j)];
                b[(n + i, j)] = force_d[(i, j)];
            }
            for j in 0..m {
                b[(n + i, nw + j)] = mbu[(i, j)];
            }
        }
        for i in 0..nt {
            for j in 0..nt {
                a[(2 * n + i, 2 * n + j)] = tracks.a()[(i, j)];
            }
            for j in 0..nw {
                b[(2 * n + i, j)] = tracks.b()[(i, j)];
            }
        }
        for i in 0..k {
            for j in 0..nw {
                b[(2 * n + nt + i, j)] = basis[(i, j)];
            }
        }
        let on_heights = &stands * basis.transpose();
        // r[1] of an output is of wheels' velocities
        let rates = Mat::from_fn(p, w, |i, j| outputs[i].r[1].get(j).copied().unwrap_or(0.0));
        let (rates_c, rates_d) = (&rates * tracks.c(), &rates * tracks.d());
        let mut c = Mat::zeros(p, size);
        let mut d = Mat::zeros(p, nw + m);
        for (i, o) in outputs.iter().enumerate() {
            for l in 0..size {
                let own = |q: &Vec<f64>, from: usize| {
                    l.checked_sub(from).and_then(|l| q.get(l)).copied().unwrap_or(0.0)
                };
                let of_acceleration: f64 = o.q[2].iter().enumerate().map(|(r, v)| v * a[(n + r, l)]).sum();
                c[(i, l)] = of_acceleration
                    + if l < n { own(&o.q[0], 0) } else { 0.0 }
                    + if (n..2 * n).contains(&l) { own(&o.q[1], n) } else { 0.0 }
                    + if (2 * n..2 * n + nt).contains(&l) {
                        follows[(i, l - 2 * n)] + rates_c[(i, l - 2 * n)]
                    } else {
                        0.0
                    }
                    + if l >= 2 * n + nt { on_heights[(i, l - 2 * n - nt)] } else { 0.0 };
            }
            for j in 0..nw + m {
                let of_acceleration: f64 = o.q[2].iter().enumerate().map(|(r, v)| v * b[(n + r, j)]).sum();
                let direct = if j < nw { rates_d[(i, j)] } else { o.u.get(j - nw).copied().unwrap_or(0.0) };
                d[(i, j)] = of_acceleration + direct;
            }
        }
        Ok(StateSpace::continuous(a, b, c, d)?)
    }
}

/// C_t A_t⁻¹: the part of the wheels' heights that is in the tracks' states.
fn ahead(tracks: &StateSpace<Continuous>) -> Result<Mat, LinalgError> {
    if tracks.order() == 0 {
        return Ok(Mat::zeros(tracks.outputs(), 0));
    }
    let transposed = solve(&tracks.a().transpose().to_owned(), &tracks.c().transpose().to_owned())?;
    Ok(transposed.transpose().to_owned())
}

/// What outputs see of heights: H P(0) of those that stand still, where terms that cancel are none, and H C_t A_t⁻¹ of the tracks' states.
fn standing(heights: &Mat, ahead: &Mat, tracks: &StateSpace<Continuous>) -> (Mat, Mat) {
    // P(0) = D_t − C_t A_t⁻¹ B_t; a delay is 1 at rest
    let rest = if ahead.ncols() == 0 { tracks.d().clone() } else { tracks.d() - ahead * tracks.b() };
    let stands = Mat::from_fn(heights.nrows(), rest.ncols(), |i, x| {
        let terms = (0..rest.nrows()).map(|j| heights[(i, j)] * rest[(j, x)]);
        let (sum, size) = terms.fold((0.0, 0.0), |(s, a), v: f64| (s + v, a + v.abs()));
        if f64::abs(sum) <= CANCELLED * size { 0.0 } else { sum }
    });
    let follows = heights * ahead;
    (stands, follows)
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
