//! A strictly proper state space from inputs to outputs, its balanced form, and how a wheeled system becomes one.

use super::WheeledSystem;
use super::reduce::{Balanced, balanced};
use crate::linalg::{C64, CMat, LinalgError, Mat, eigen, solve, solve_complex};

/// Hankel singular values below this share of the largest are not divided by: their states are not in the response.
const LEAST_HANKEL: f64 = 1e-10;

/// ẋ = A x + B u, y = C x: H(s) = C(sI − A)⁻¹B. A is n × n, B n × inputs, C outputs × n.
#[derive(Debug, Clone, PartialEq)]
pub struct FirstOrder {
    /// State matrix.
    pub a: Mat,
    /// Input matrix.
    pub b: Mat,
    /// Output matrix.
    pub c: Mat,
}

impl FirstOrder {
    /// The displacements y = R q of a wheeled system from road heights r.
    ///
    /// With x = [q; q̇ − M⁻¹C_w r]: q̇ = x₂ + M⁻¹C_w r, ẋ₂ = −M⁻¹K q − M⁻¹C q̇ + M⁻¹K_w r.
    ///
    /// # Errors
    /// A mass matrix that cannot be solved with.
    pub fn of_wheeled(wheeled: &WheeledSystem) -> Result<Self, LinalgError> {
        let system = wheeled.system();
        let n = system.order();
        let over_m = |x: &Mat| solve(system.m(), x);
        let (k, c) = (over_m(system.k())?, over_m(system.c())?);
        let (kw, cw) = (over_m(wheeled.wheel_stiffness())?, over_m(wheeled.wheel_damping())?);
        let damped = &c * &cw;
        let a = Mat::from_fn(2 * n, 2 * n, |i, j| match (i < n, j < n) {
            (true, true) => 0.0,
            (true, false) => f64::from(u8::from(j - n == i)),
            (false, true) => -k[(i - n, j)],
            (false, false) => -c[(i - n, j - n)],
        });
        let b = Mat::from_fn(2 * n, kw.ncols(), |i, j| {
            if i < n { cw[(i, j)] } else { kw[(i - n, j)] - damped[(i - n, j)] }
        });
        let rows = wheeled.rows();
        let c = Mat::from_fn(rows.nrows(), 2 * n, |i, j| if j < n { rows[(i, j)] } else { 0.0 });
        Ok(FirstOrder { a, b, c })
    }

    /// Number of states.
    #[must_use]
    pub fn order(&self) -> usize {
        self.a.nrows()
    }

    /// The same responses with time counted in units of 1/`rate` s: H'(s/rate) = H(s).
    #[must_use]
    pub fn in_time_of(&self, rate: f64) -> Self {
        let scaled = |m: &Mat| Mat::from_fn(m.nrows(), m.ncols(), |i, j| m[(i, j)] / rate);
        FirstOrder { a: scaled(&self.a), b: scaled(&self.b), c: self.c.clone() }
    }

    /// H at s (outputs × inputs).
    ///
    /// # Errors
    /// A pole at s.
    pub fn response(&self, s: C64) -> Result<CMat, LinalgError> {
        let n = self.order();
        let resolvent = CMat::from_fn(n, n, |i, j| {
            (if i == j { s } else { C64::new(0.0, 0.0) }) - C64::new(self.a[(i, j)], 0.0)
        });
        let complex = |m: &Mat| CMat::from_fn(m.nrows(), m.ncols(), |i, j| C64::new(m[(i, j)], 0.0));
        Ok(complex(&self.c) * solve_complex(&resolvent, &complex(&self.b))?)
    }

    /// The poles.
    ///
    /// # Errors
    /// An iteration that does not converge.
    pub fn poles(&self) -> Result<Vec<C64>, LinalgError> {
        Ok(eigen(&self.a)?.0)
    }

    /// Balanced and cut to `order` states: the controllability and observability Gramians are equal and diagonal, with
    /// the Hankel singular values, which are returned too (all of them, descending).
    ///
    /// Where fewer states than asked are in the response, the order is theirs.
    ///
    /// # Errors
    /// A system that is not stable (the Gramians do not exist).
    ///
    /// Source: Laub, Heath, Paige, Ward, IEEE Trans. Automat. Control 32 (1987) 115–122 (square-root method).
    pub fn balanced(&self, order: usize) -> Result<(Self, Vec<f64>), LinalgError> {
        let Balanced { a, b, c, hankel } = balanced(&self.a, &self.b, &self.c, order, LEAST_HANKEL)?;
        Ok((FirstOrder { a, b, c }, hankel))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lti::SecondOrder;

    fn quarter() -> WheeledSystem {
        let mat = |v: &[[f64; 2]; 2]| Mat::from_fn(2, 2, |i, j| v[i][j]);
        let system = SecondOrder::new(
            mat(&[[240.0, 0.0], [0.0, 36.0]]),
            mat(&[[980.0, -980.0], [-980.0, 1080.0]]),
            mat(&[[16e3, -16e3], [-16e3, 176e3]]),
        )
        .unwrap();
        let column = |v: f64| Mat::from_fn(2, 1, |i, _| if i == 1 { v } else { 0.0 });
        let rows = Mat::identity(2, 2);
        WheeledSystem::new(system, column(160e3), column(100.0), vec![[0.0, 0.0]], rows).unwrap()
    }

    #[test]
    fn the_state_space_has_the_mechanical_response() {
        let wheeled = quarter();
        let first = FirstOrder::of_wheeled(&wheeled).unwrap();
        let (balanced, hankel) = first.in_time_of(20.0).balanced(4).unwrap();
        assert_eq!((balanced.order(), hankel.len()), (4, 4));
        for omega in [0.0, 3.0, 8.0, 70.0, 400.0] {
            let b = CMat::from_fn(2, 1, |i, _| {
                C64::new(wheeled.wheel_stiffness()[(i, 0)], omega * wheeled.wheel_damping()[(i, 0)])
            });
            let expected = solve_complex(&wheeled.system().dynamic_stiffness(omega), &b).unwrap();
            let direct = first.response(C64::new(0.0, omega)).unwrap();
            let scaled = balanced.response(C64::new(0.0, omega / 20.0)).unwrap();
            for i in 0..2 {
                assert!((direct[(i, 0)] - expected[(i, 0)]).norm() < 1e-11);
                assert!((scaled[(i, 0)] - expected[(i, 0)]).norm() < 1e-9);
            }
        }
    }

    #[test]
    fn states_that_are_not_in_the_response_are_left_out() {
        let first = FirstOrder::of_wheeled(&quarter()).unwrap();
        // a second copy of the system that nothing looks at
        let n = first.order();
        let doubled = FirstOrder {
            a: Mat::from_fn(2 * n, 2 * n, |i, j| if i / n == j / n { first.a[(i % n, j % n)] } else { 0.0 }),
            b: Mat::from_fn(2 * n, 1, |i, _| first.b[(i % n, 0)]),
            c: Mat::from_fn(2, 2 * n, |i, j| if j < n { first.c[(i, j)] } else { 0.0 }),
        };
        let (cut, _) = doubled.in_time_of(20.0).balanced(8).unwrap();
        assert_eq!(cut.order(), n);
    }

    #[test]
    fn an_unstable_system_is_refused() {
        let one = |v: f64| Mat::from_fn(1, 1, |_, _| v);
        assert!(FirstOrder { a: one(1.0), b: one(1.0), c: one(1.0) }.balanced(1).is_err());
    }
}
