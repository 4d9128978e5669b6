//! Frequency responses: one Schur form, then a triangular solve a frequency.

use super::state_space::complex;
use super::{LtiError, StateSpace, Time};
use crate::linalg::{C64, CMat, Mat, RealSchur};

/// A system whose A is upper quasi-triangular: G(s) costs n² a column.
#[derive(Debug, Clone)]
pub struct Responder<T: Time> {
    t: Mat,
    b: CMat,
    c: CMat,
    d: CMat,
    blocks: Vec<(usize, usize)>,
    time: T,
}

impl<T: Time> StateSpace<T> {
    /// The system made ready for responses at many points.
    ///
    /// # Errors
    /// A Schur form that does not converge.
    pub fn responder(&self) -> Result<Responder<T>, LtiError> {
        let schur = RealSchur::new(self.a())?;
        Ok(Responder {
            blocks: schur.blocks(),
            b: complex(&(schur.q.transpose() * self.b())),
            c: complex(&(self.c() * &schur.q)),
            d: complex(self.d()),
            t: schur.t,
            time: self.time(),
        })
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
        let (n, m) = (self.t.nrows(), self.b.ncols());
        let mut x = self.b.clone();
        for j in 0..m {
            for (k, size) in self.blocks.iter().rev().copied() {
                let after = k + size;
                let rest = |x: &CMat, i: usize| {
                    (after..n).fold(x[(i, j)], |sum, l| sum + x[(l, j)] * self.t[(i, l)])
                };
                if size == 1 {
                    x[(k, j)] = rest(&x, k) / (s - self.t[(k, k)]);
                } else {
                    let (r1, r2) = (rest(&x, k), rest(&x, k + 1));
                    let (p, q) = (s - self.t[(k, k)], s - self.t[(k + 1, k + 1)]);
                    let (u, l) = (self.t[(k, k + 1)], self.t[(k + 1, k)]);
                    let det = p * q - u * l;
                    x[(k, j)] = (q * r1 + r2 * u) / det;
                    x[(k + 1, j)] = (p * r2 + r1 * l) / det;
                }
            }
        }
        let g = &self.c * x + &self.d;
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
    fn a_pole_on_the_way_is_said() {
        let a = Mat::from_fn(2, 2, |i, j| [[0.0, 2.0], [-2.0, 0.0]][i][j]);
        let one = Mat::from_fn(2, 1, |i, _| i as f64);
        let g: StateSpace<Continuous> =
            StateSpace::continuous(a, one.clone(), one.transpose().to_owned(), Mat::zeros(1, 1)).unwrap();
        assert!(g.frequency_response(&[2.0]).is_err() && g.frequency_response(&[2.1]).is_ok());
    }
}
