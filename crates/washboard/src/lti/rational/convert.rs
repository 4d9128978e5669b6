//! Between exact functions and state space in floating point.

use super::hurwitz::companion;
use super::{Polynomial, Rational, RationalError, RationalFunction, exact_bits, to_f64};
use crate::linalg::Mat;
use crate::lti::{Continuous, StateSpace};
use num_traits::{One, Zero};

impl RationalFunction {
    /// A minimal state space: the controllable companion form in a time scale of the poles' own, with balanced scales.
    ///
    /// # Errors
    /// A function that is not proper; coefficients beyond floating point.
    pub fn state_space(&self) -> Result<StateSpace<Continuous>, RationalError> {
        let (numerator, denominator) = (self.numerator.degree(), self.denominator.degree());
        if !self.is_proper() {
            return Err(RationalError::Improper { numerator, denominator });
        }
        let n = denominator;
        let through = self.at_infinity(1)?.first().map_or(0.0, to_f64);
        let d = Mat::from_fn(1, 1, |_, _| through);
        if n == 0 {
            return Ok(StateSpace::continuous_gain(d)?);
        }
        let at_zero = self.denominator.zeros_at_origin().min(n - 1);
        let (rate, mut c) = self.denominator.monic_in_own_time(at_zero);
        // zeros at the origin come back as zero coefficients
        c.splice(0..0, std::iter::repeat_n(0.0, at_zero));
        let (_, rest) = self.numerator.divided_by(&self.denominator)?;
        // strictly proper part r(s)/d(s) with s = rate·σ: r_k rate^(k − n)
        let scale = exact_bits(rate)?;
        let output: Vec<f64> =
            (0..n).map(|k| to_f64(&(rest.coefficient(k) / power(&scale, n - k)))).collect();
        // x' = rate (A x + b u) in s
        let a = companion(&c);
        let system = StateSpace::continuous(
            Mat::from_fn(n, n, |i, j| a[(i, j)] * rate),
            Mat::from_fn(n, 1, |i, _| if i + 1 == n { rate } else { 0.0 }),
            Mat::from_fn(1, n, |_, j| output[j]),
            d,
        )?;
        Ok(system.balanced_scales()?.0)
    }

    /// The transfer functions of a system (outputs × inputs), exactly those of its floating-point matrices:
    /// C adj(sI − A) B/det(sI − A) + D by Faddeev and LeVerrier's recursion.
    ///
    /// # Errors
    /// None for a system that could be built.
    pub fn of_system(system: &StateSpace<Continuous>) -> Result<Vec<Vec<Self>>, RationalError> {
        let n = system.order();
        let exact = |m: &Mat| -> Result<Vec<Vec<Rational>>, RationalError> {
            (0..m.nrows()).map(|i| (0..m.ncols()).map(|j| exact_bits(m[(i, j)])).collect()).collect()
        };
        let (a, b, c, d) = (exact(system.a())?, exact(system.b())?, exact(system.c())?, exact(system.d())?);
        // M_k = A M_{k−1} + c_{n−k+1} I, c_{n−k} = −tr(A M_k)/k; adj = Σ M_k s^{n−k}
        let mut determinant = vec![Rational::zero(); n + 1];
        determinant[n] = Rational::one();
        let mut adjugate: Vec<Vec<Vec<Rational>>> = Vec::with_capacity(n);
        for k in 1..=n {
            let m = match adjugate.last() {
                None => identity(n),
                Some(last) => {
                    let mut next = product(&a, last);
                    for (i, row) in next.iter_mut().enumerate() {
                        row[i] += &determinant[n - k + 1];
                    }
                    next
                }
            };
            let am = product(&a, &m);
            let trace = (0..n).fold(Rational::zero(), |t, i| t + &am[i][i]);
            determinant[n - k] = -trace / Rational::from_integer(k.into());
            adjugate.push(m);
        }
        let determinant = Polynomial::new(&determinant);
        // C M_k B, one a power of s
        let terms: Vec<_> = adjugate.iter().map(|m| product(&product(&c, m), &b)).collect();
        (0..system.outputs())
            .map(|i| {
                (0..system.inputs())
                    .map(|j| {
                        let rest: Vec<Rational> = terms.iter().rev().map(|t| t[i][j].clone()).collect();
                        let n = &Polynomial::new(&rest) + &determinant.scaled(&d[i][j]);
                        Self::new(n, determinant.clone())
                    })
                    .collect()
            })
            .collect()
    }

    /// The function whose coefficients are these, rounded to floating point (d monic): what one would write down of it.
    ///
    /// # Errors
    /// Coefficients beyond floating point.
    pub fn rounded(&self) -> Result<Self, RationalError> {
        let round = |p: &Polynomial| -> Result<Polynomial, RationalError> {
            let c = p.coefficients().iter().map(|c| exact_bits(to_f64(c))).collect::<Result<Vec<_>, _>>()?;
            Ok(Polynomial::new(&c))
        };
        Self::new(round(&self.numerator)?, round(&self.denominator)?)
    }
}

fn power(x: &Rational, k: usize) -> Rational {
    (0..k).fold(Rational::one(), |p, _| p * x)
}

fn identity(n: usize) -> Vec<Vec<Rational>> {
    (0..n)
        .map(|i| (0..n).map(|j| if i == j { Rational::one() } else { Rational::zero() }).collect())
        .collect()
}

fn product(a: &[Vec<Rational>], b: &[Vec<Rational>]) -> Vec<Vec<Rational>> {
    let columns = b.first().map_or(0, Vec::len);
    a.iter()
        .map(|row| {
            (0..columns)
                .map(|j| row.iter().zip(b).fold(Rational::zero(), |sum, (x, r)| sum + x * &r[j]))
                .collect()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::C64;

    #[test]
    fn there_and_back() {
        let p = |c: &[i64]| Polynomial::integers(c);
        // poles 0.02 to 2000 rad/s, feedthrough, and one at zero
        let d = &(&p(&[1, 50]) * &p(&[4000, 6, 1])) * &(&p(&[2000, 1]) * &p(&[0, 1]));
        let g = RationalFunction::new(p(&[5, 4, 3, 2, 1, 7]), d).unwrap();
        let system = g.state_space().unwrap();
        assert_eq!(system.order(), 5);
        for omega in [1e-3, 0.02, 1.0, 63.0, 1e3, 1e5] {
            let (found, known) =
                (system.at(C64::new(0.0, omega)).unwrap()[(0, 0)], g.at_frequency(omega).unwrap());
            // the fastest pole over the slowest one, times rounding; feedthrough is cancelled where the response is small
            let size = known.norm() + system.d()[(0, 0)].abs();
            assert!((found - known).norm() < 1e5 * f64::EPSILON * size, "{omega}: {found} {known}");
        }
        let back = &RationalFunction::of_system(&system).unwrap()[0][0];
        assert_eq!(back.degree(), 5);
        let (found, known) = (back.at_frequency(1.0).unwrap(), g.at_frequency(1.0).unwrap());
        assert!((found - known).norm() < 1e-13 * system.d()[(0, 0)]);
        assert!(matches!(
            RationalFunction::polynomial(p(&[0, 1])).state_space(),
            Err(RationalError::Improper { numerator: 1, denominator: 0 })
        ));
    }

    #[test]
    fn two_inputs_two_outputs_are_exact() {
        let any = |r, c, s: f64| Mat::from_fn(r, c, |i, j| ((3 * i + 7 * j) as f64 + s).sin());
        let g =
            StateSpace::continuous(any(3, 3, 1.0), any(3, 2, 2.0), any(2, 3, 3.0), any(2, 2, 4.0)).unwrap();
        let exact = RationalFunction::of_system(&g).unwrap();
        let known = g.at(C64::new(0.0, 0.7)).unwrap();
        for i in 0..2 {
            for j in 0..2 {
                assert!((exact[i][j].at_frequency(0.7).unwrap() - known[(i, j)]).norm() < 1e-14);
            }
        }
        let gain = StateSpace::continuous_gain(any(1, 1, 0.5)).unwrap();
        assert_eq!(RationalFunction::of_system(&gain).unwrap()[0][0].degree(), 0);
    }
}
