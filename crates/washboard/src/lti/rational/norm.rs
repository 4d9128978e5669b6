//! The H2 norm without rounding.

use super::{Rational, RationalError, RationalFunction, to_f64};
use num_bigint::BigInt;
use num_integer::Integer;
use num_rational::Ratio;
use num_traits::{One, Zero};

impl RationalFunction {
    /// ‖G‖₂² = (1/2π)∫|G(jω)|² dω, exactly.
    ///
    /// G(s)G(−s) = x(s)/d(s) + x(−s)/d(−s) with deg x < n = deg d: n linear equations for x, and ‖G‖₂² = xₙ₋₁/dₙ. They
    /// are solved in integers by Bareiss's elimination. Loops with poles of 10⁻⁵ and 10⁵ rad/s have no other exact norm.
    ///
    /// # Errors
    /// A function that is not strictly proper and stable.
    ///
    /// ```
    /// use washboard::lti::{Polynomial, Rational, RationalFunction};
    /// // 1/(s + 3): 1/6
    /// let g = RationalFunction::new(Polynomial::integers(&[1]), Polynomial::integers(&[3, 1]))?;
    /// assert_eq!(g.h2_norm_squared()?, Rational::new(1.into(), 6.into()));
    /// # Ok::<(), washboard::lti::RationalError>(())
    /// ```
    pub fn h2_norm_squared(&self) -> Result<Rational, RationalError> {
        let n = self.denominator.degree();
        if self.is_zero() {
            return Ok(Rational::zero());
        }
        if self.relative_degree().is_none_or(|r| r < 1) || !self.is_stable() {
            return Err(RationalError::NoNorm { what: self.to_string() });
        }
        // even coefficients of n(s)n(−s) and of 2 d(−s)x(s), one row a power s^(2i)
        let (above, d) = (self.numerator.coefficients(), self.denominator.coefficients());
        let of = |c: &[Rational], k: usize| c.get(k).cloned().unwrap_or_else(Rational::zero);
        let signed = |x: Rational, odd: usize| if odd % 2 == 1 { -x } else { x };
        let mut rows: Vec<Vec<BigInt>> = Vec::with_capacity(n);
        for i in 0..n {
            let mut row: Vec<Rational> = (0..n)
                .map(|k| {
                    let c = if 2 * i >= k { of(&d, 2 * i - k) } else { Rational::zero() };
                    signed(c, k) * Rational::from_integer(2.into())
                })
                .collect();
            row.push(
                (0..=2 * i)
                    .fold(Rational::zero(), |sum, k| sum + signed(of(&above, k) * of(&above, 2 * i - k), k)),
            );
            let common = row.iter().fold(BigInt::one(), |l, x| l.lcm(x.denom()));
            rows.push(row.iter().map(|x| x.numer() * (&common / x.denom())).collect());
        }
        // Bareiss: every entry stays a minor; Hurwitz's matrix has no vanishing pivots, rows are exchanged all the same
        let mut before = BigInt::one();
        for k in 0..n {
            let Some(pivot) = (k..n).find(|i| !rows[*i][k].is_zero()) else {
                return Err(RationalError::NoNorm { what: self.to_string() });
            };
            rows.swap(k, pivot);
            let (done, rest) = rows.split_at_mut(k + 1);
            let top = &done[k];
            for row in rest {
                let factor = row[k].clone();
                for (x, t) in row.iter_mut().zip(top).skip(k) {
                    *x = (&*x * &top[k] - &factor * t) / &before;
                }
            }
            before = rows[k][k].clone();
        }
        let last = &rows[n - 1];
        Ok(Ratio::new(last[n].clone(), last[n - 1].clone()) / self.denominator.leading())
    }

    /// ‖G‖₂, rounded.
    ///
    /// # Errors
    /// As [`RationalFunction::h2_norm_squared`].
    pub fn h2_norm(&self) -> Result<f64, RationalError> {
        Ok(to_f64(&self.h2_norm_squared()?).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::super::Polynomial;
    use super::*;

    #[test]
    fn it_is_lyapunovs() {
        let p = |c: &[i64]| Polynomial::integers(c);
        let d = &(&p(&[4, 1, 1]) * &p(&[7, 1])) * &(&p(&[90, 3, 1]) * &p(&[20, 1]));
        let g = RationalFunction::new(p(&[5, -4, 3, 2, -1, 7]), d).unwrap();
        let (exact, lyapunov) = (g.h2_norm().unwrap(), g.state_space().unwrap().h2_norm().unwrap());
        assert!((exact / lyapunov - 1.0).abs() < 1e-12, "{exact} {lyapunov}");
        // as + b over s² + cs + e: (a²e + b²)/(2ce)
        let g = RationalFunction::new(p(&[3, 2]), p(&[5, 7, 1])).unwrap();
        assert_eq!(g.h2_norm_squared().unwrap(), Rational::new(29.into(), 70.into()));
        for bad in [RationalFunction::one(), RationalFunction::new(p(&[1]), p(&[-1, 1])).unwrap()] {
            assert!(matches!(bad.h2_norm_squared(), Err(RationalError::NoNorm { .. })));
        }
    }
}
