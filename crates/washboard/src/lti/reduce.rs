//! Fewer states: balanced truncation with its error bound, and the split into what is stable and what is not.

use super::connect::cut;
use super::{Continuous, LtiError, StateSpace};
use crate::linalg::{LinalgError, Mat, RealSchur, lyapunov_factor, sylvester};

/// Hankel singular values below this share of the largest are not divided by: their states are not in the response.
const LEAST_HANKEL: f64 = 1e-14;

/// A system with fewer states, and what that costs.
#[derive(Debug, Clone, PartialEq)]
pub struct Reduced {
    /// The smaller system.
    pub system: StateSpace<Continuous>,
    /// Hankel singular values of the stable part, descending: all of them.
    pub hankel: Vec<f64>,
    /// ‖G − G_r‖∞ is at most this: twice the sum of the values left out.
    pub bound: f64,
}

impl StateSpace<Continuous> {
    /// Balanced truncation to `order` states: the states kept are the ones that inputs move most and outputs show most.
    ///
    /// Of a system that is not stable the unstable part is kept as it is, and counted. Feedthrough is kept. Where fewer
    /// states than asked for are in the response, the order is theirs.
    ///
    /// # Errors
    /// An order below the number of unstable poles; a pole on the axis.
    ///
    /// Source: Moore, IEEE Trans. Automat. Control 26 (1981) 17–32; Glover, Int. J. Control 39 (1984) 1115–1193 (bound);
    /// Laub, Heath, Paige, Ward, IEEE Trans. Automat. Control 32 (1987) 115–122 (square-root method).
    pub fn balanced_truncation(&self, order: usize) -> Result<Reduced, LtiError> {
        let (stable, unstable) = self.balanced_scales()?.0.split()?;
        let Some(left) = order.checked_sub(unstable.order()) else {
            let expected = "at least the number of unstable poles";
            return Err(LtiError::Field { field: "order", expected, found: order as f64 });
        };
        let Balanced { a, b, c, hankel } = balanced(stable.a(), stable.b(), stable.c(), left, LEAST_HANKEL)?;
        let bound = 2.0 * hankel.iter().skip(a.nrows()).sum::<f64>();
        let kept = StateSpace::continuous(a, b, c, stable.d().clone())?;
        Ok(Reduced { system: kept.parallel(&unstable)?, hankel, bound })
    }

    /// The stable part, with the feedthrough, and the rest: their sum is the system.
    ///
    /// # Errors
    /// Poles so near the axis, on both sides, that they can't be told apart.
    pub fn split(&self) -> Result<(Self, Self), LtiError> {
        let (n, m, p) = (self.order(), self.inputs(), self.outputs());
        let (schur, k) = RealSchur::new(self.a())?.reordered(|z| z.re < 0.0)?;
        let (b, c) = (schur.q.transpose() * self.b(), self.c() * &schur.q);
        let (a11, a12, a22) =
            (cut(&schur.t, 0, 0, k, k), cut(&schur.t, 0, k, k, n - k), cut(&schur.t, k, k, n - k, n - k));
        let (b1, b2) = (cut(&b, 0, 0, k, m), cut(&b, k, 0, n - k, m));
        let (c1, c2) = (cut(&c, 0, 0, p, k), cut(&c, 0, k, p, n - k));
        // z₁ = x₁ − X x₂ with A₁₁X − XA₂₂ + A₁₂ = 0
        let x = if k == 0 || k == n { Mat::zeros(k, n - k) } else { sylvester(&a11, &-&a22, &-a12)?.x };
        let stable = Self::continuous(a11, b1 - &x * &b2, c1.clone(), self.d().clone())?;
        let rest = Self::continuous(a22, b2, c2 + c1 * x, Mat::zeros(p, m))?;
        Ok((stable, rest))
    }
}

/// A balanced system, cut.
pub(super) struct Balanced {
    pub a: Mat,
    pub b: Mat,
    pub c: Mat,
    pub hankel: Vec<f64>,
}

/// The controllability and observability Gramians of (A, B, C) equal and diagonal, and the first states.
///
/// From the Gramians' factors, which are never multiplied out: small Hankel singular values keep their digits.
pub(super) fn balanced(a: &Mat, b: &Mat, c: &Mat, order: usize, least: f64) -> Result<Balanced, LinalgError> {
    if a.nrows() == 0 {
        return Ok(Balanced { a: a.clone(), b: b.clone(), c: c.clone(), hankel: Vec::new() });
    }
    let controllable = lyapunov_factor(a, b)?;
    let observable = lyapunov_factor(&a.transpose().to_owned(), &c.transpose().to_owned())?;
    let product = observable.transpose() * &controllable;
    let svd =
        product.svd().map_err(|_| LinalgError::NoConvergence { what: "the SVD", order: product.nrows() })?;
    let hankel: Vec<f64> = svd.S().column_vector().iter().copied().collect();
    let there = hankel.iter().filter(|h| **h > least * hankel[0]).count();
    let n = order.min(there);
    let (u, v) = (svd.U(), svd.V());
    let right = Mat::from_fn(v.nrows(), n, |i, j| v[(i, j)] / hankel[j].sqrt());
    let left = Mat::from_fn(u.nrows(), n, |i, j| u[(i, j)] / hankel[j].sqrt());
    let t = &controllable * right;
    let t_inverse = (&observable * left).transpose().to_owned();
    Ok(Balanced { a: &t_inverse * a * &t, b: &t_inverse * b, c: c * &t, hankel })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::C64;

    fn any(r: usize, c: usize, s: f64) -> Mat {
        Mat::from_fn(r, c, |i, j| ((5 * i * i + 7 * j + i * j) as f64 + s).sin())
    }

    fn stable(n: usize) -> StateSpace<Continuous> {
        let a = any(n, n, 0.2) - Mat::identity(n, n) * faer::Scale(3.0);
        StateSpace::continuous(a, any(n, 2, 1.0), any(2, n, 2.0), any(2, 2, 3.0)).unwrap()
    }

    #[test]
    fn the_error_is_between_the_first_value_left_out_and_the_bound() {
        let g = stable(8);
        for order in 0..=8 {
            let r = g.balanced_truncation(order).unwrap();
            assert_eq!(r.system.order(), order);
            let minus = StateSpace::continuous(
                r.system.a().clone(),
                r.system.b().clone(),
                -r.system.c(),
                -r.system.d(),
            );
            let error = g.parallel(&minus.unwrap()).unwrap().hinf_norm().unwrap().norm;
            assert!(error <= r.bound * (1.0 + 1e-9) + 1e-12, "{order}: {error} above {}", r.bound);
            let first = r.hankel.get(order).copied().unwrap_or(0.0);
            assert!(error >= first * (1.0 - 1e-9), "{order}: {error} below {first}");
        }
    }

    #[test]
    fn the_unstable_part_is_kept() {
        let one = |x: f64| Mat::from_fn(1, 1, |_, _| x);
        let rise = StateSpace::continuous(one(0.5), one(1.0), one(1.0), one(0.0)).unwrap();
        let g = stable(5).select(&[0], &[1]).unwrap().parallel(&rise).unwrap();
        let (s, u) = g.split().unwrap();
        assert_eq!((s.order(), u.order()), (5, 1));
        assert!((u.a()[(0, 0)] - 0.5).abs() < 1e-13);
        let at = C64::new(0.2, 1.3);
        let sum = s.at(at).unwrap() + u.at(at).unwrap();
        assert!((sum - g.at(at).unwrap()).norm_l2() < 1e-13);
        assert_eq!(g.balanced_truncation(3).unwrap().system.order(), 3);
        assert!(g.balanced_truncation(0).is_err());
    }

    #[test]
    fn small_hankel_values_keep_their_digits() {
        // of diag(1/(s + 1), 1e-11/(s + 1)) they are 1/2 and 1e-11/2; Gramians multiplied out would lose the second one's
        let two = |x: f64, y: f64| Mat::from_fn(2, 2, |i, j| if i == j { [x, y][i] } else { 0.0 });
        let turn = Mat::from_fn(2, 2, |i, j| [[0.6, -0.8], [0.8, 0.6]][i][j]);
        let (b, c) = (&turn * two(1.0, 1e-6), two(1.0, 1e-5) * turn.transpose());
        let hankel = balanced(&two(-1.0, -1.0), &b, &c, 2, LEAST_HANKEL).unwrap().hankel;
        assert!((hankel[0] / 0.5 - 1.0).abs() < 1e-14, "{hankel:?}");
        assert!((hankel[1] / 0.5e-11 - 1.0).abs() < 1e-4, "{hankel:?}");
    }
}
