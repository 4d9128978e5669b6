//! Frequency responses: one Schur form, then a triangular solve a frequency.

use super::{LtiError, StateSpace, Time};
use crate::linalg::{C64, CMat, Mat, RealSchur};

/// A system whose A is upper quasi-triangular: G(s) costs n² a column.
#[derive(Debug, Clone)]
pub struct Responder<T: Time> {
    t: Mat,
    b: Mat,
    /// Cᵀ.
    c: Mat,
    d: Mat,
    blocks: Vec<(usize, usize)>,
    time: T,
}

impl<T: Time> StateSpace<T> {
    /// The system made ready for responses at many points, in states balanced by powers of two: a Schur form's rounding is a
    /// share of A's largest entry, which in states of wild units is more than the smaller ones.
    ///
    /// # Errors
    /// A Schur form that does not converge.
    pub fn responder(&self) -> Result<Responder<T>, LtiError> {
        let (balanced, _) = self.balanced_scales()?;
        Ok(balanced.responder_on(RealSchur::new(balanced.a())?))
    }

    /// The same on the Schur form of A where that is at hand.
    pub(super) fn responder_on(&self, schur: RealSchur) -> Responder<T> {
        Responder {
            blocks: schur.blocks(),
            b: schur.q.transpose() * self.b(),
            c: schur.q.transpose() * self.c().transpose(),
            d: self.d().clone(),
            t: schur.t,
            time: self.time(),
        }
    }

    /// G at frequencies in rad/s (outputs × inputs each).
    ///
    /// # Errors
    /// A pole exactly at a frequency.
    pub fn frequency_response(&self, omega_rad_s: &[f64]) -> Result<Vec<CMat>, LtiError> {
        let responder = self.responder()?;
        omega_rad_s.iter().map(|w| responder.at_frequency(*w)).collect()
    }
}

impl<T: Time> Responder<T> {
    /// G at a frequency.
    ///
    /// # Errors
    /// A pole exactly there.
    pub fn at_frequency(&self, omega_rad_s: f64) -> Result<CMat, LtiError> {
        self.at(self.time.point(omega_rad_s))
    }

    /// G at a point of the complex plane.
    ///
    /// # Errors
    /// A pole exactly there.
    pub fn at(&self, s: C64) -> Result<CMat, LtiError> {
        let (n, m, p) = (self.t.nrows(), self.d.ncols(), self.d.nrows());
        let mut g = CMat::from_fn(p, m, |i, j| C64::new(self.d[(i, j)], 0.0));
        // x apart in its real and imaginary part: then T's columns are taken off four numbers at a time
        let (mut re, mut im) = (vec![0.0; n], vec![0.0; n]);
        for j in 0..m {
            re.copy_from_slice(self.b.col_as_slice(j));
            im.fill(0.0);
            for (k, size) in self.blocks.iter().rev().copied() {
                if size == 1 {
                    let x = C64::new(re[k], im[k]) / (s - self.t[(k, k)]);
                    (re[k], im[k]) = (x.re, x.im);
                } else {
                    let (r1, r2) = (C64::new(re[k], im[k]), C64::new(re[k + 1], im[k + 1]));
                    let (p, q) = (s - self.t[(k, k)], s - self.t[(k + 1, k + 1)]);
                    let (u, l) = (self.t[(k, k + 1)], self.t[(k + 1, k)]);
                    let det = p * q - u * l;
                    let (x, y) = ((q * r1 + r2 * u) / det, (p * r2 + r1 * l) / det);
                    (re[k], im[k], re[k + 1], im[k + 1]) = (x.re, x.im, y.re, y.im);
                }
                for l in k..k + size {
                    let column = &self.t.col_as_slice(l)[..k];
                    let (x, y) = (re[l], im[l]);
                    re[..k].iter_mut().zip(column).for_each(|(r, t)| *r += x * t);
                    im[..k].iter_mut().zip(column).for_each(|(r, t)| *r += y * t);
                }
            }
            for i in 0..p {
                let (mut x, mut y) = (0.0, 0.0);
                for ((c, r), v) in self.c.col_as_slice(i).iter().zip(&re).zip(&im) {
                    (x, y) = (x + c * r, y + c * v);
                }
                g[(i, j)] += C64::new(x, y);
            }
        }
        for j in 0..g.ncols() {
            for i in 0..g.nrows() {
                if !(g[(i, j)].re.is_finite() && g[(i, j)].im.is_finite()) {
                    let why = "a pole stands exactly at the point asked for";
                    let value = s.norm();
                    return Err(crate::linalg::LinalgError::Singular { what: "G(s)", why, value }.into());
                }
            }
        }
        Ok(g)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lti::Continuous;

    #[test]
    fn the_triangular_route_is_the_plain_solve() {
        let any = |r, c, s: f64| Mat::from_fn(r, c, |i, j| ((5 * i * i + 7 * j + i * j) as f64 + s).sin());
        let g =
            StateSpace::continuous(any(9, 9, 0.3), any(9, 2, 1.0), any(3, 9, 2.0), any(3, 2, 3.0)).unwrap();
        let omegas = [0.0, 0.1, 1.0, 3.3, 100.0, 1e9];
        for (w, fast) in omegas.iter().zip(g.frequency_response(&omegas).unwrap()) {
            let plain = g.at(C64::new(0.0, *w)).unwrap();
            assert!((&fast - &plain).norm_l2() < 1e-12 * plain.norm_l2(), "{w}");
        }
        let discrete =
            StateSpace::discrete(any(4, 4, 0.0), any(4, 1, 1.0), any(1, 4, 2.0), any(1, 1, 3.0), 0.1)
                .unwrap();
        let z = C64::new((0.5f64).cos(), (0.5f64).sin());
        let plain = discrete.at(z).unwrap();
        assert!((discrete.frequency_response(&[5.0]).unwrap()[0][(0, 0)] - plain[(0, 0)]).norm() < 1e-12);
    }

    #[test]
    fn the_units_of_states_do_not_matter() {
        let any = |r, c, s: f64| Mat::from_fn(r, c, |i, j| ((5 * i * i + 7 * j + i * j) as f64 + s).sin());
        let g =
            StateSpace::continuous(any(9, 9, 0.3), any(9, 2, 1.0), any(3, 9, 2.0), any(3, 2, 3.0)).unwrap();
        let units: Vec<f64> = (0..9).map(|k| 2f64.powi((17 * k) % 61 - 30)).collect();
        let wild = g.with_states_scaled(&units).unwrap();
        for w in [0.1, 1.0, 3.3, 100.0] {
            let plain = g.at(C64::new(0.0, w)).unwrap();
            let fast = wild.frequency_response(&[w]).unwrap();
            assert!((&fast[0] - &plain).norm_l2() < 1e-12 * plain.norm_l2(), "{w}");
        }
    }

    #[test]
    fn a_pole_on_the_way_is_said() {
        let a = Mat::from_fn(2, 2, |i, j| [[0.0, 2.0], [-2.0, 0.0]][i][j]);
        let one = Mat::from_fn(2, 1, |i, _| i as f64);
        let g: StateSpace<Continuous> =
            StateSpace::continuous(a, one.clone(), one.transpose().to_owned(), Mat::zeros(1, 1)).unwrap();
        assert!(g.frequency_response(&[2.0]).is_err() && g.frequency_response(&[2.1]).is_ok());
    }
}
