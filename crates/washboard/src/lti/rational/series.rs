//! Values and expansions: at zero, at infinity, on the imaginary axis.

use super::{Polynomial, Rational, RationalError, RationalFunction, exact_bits, to_f64};
use crate::linalg::C64;
use num_traits::{One, Zero};

impl RationalFunction {
    /// The first `count` Taylor coefficients at s = 0, G(s) = t₀ + t₁s + …; G⁽ᵏ⁾(0) = k!·t_k.
    ///
    /// # Errors
    /// A pole at 0.
    pub fn taylor(&self, count: usize) -> Result<Vec<Rational>, RationalError> {
        let (n, d) = (self.numerator.coefficients(), self.denominator.coefficients());
        long_division(&n, &d, count).ok_or_else(|| RationalError::Pole { what: self.to_string(), at: "0" })
    }

    /// The first `count` coefficients at infinity, G(s) = m₀ + m₁/s + m₂/s² + … (Markov parameters).
    ///
    /// # Errors
    /// A function that is not proper.
    pub fn at_infinity(&self, count: usize) -> Result<Vec<Rational>, RationalError> {
        if !self.is_proper() {
            return Err(RationalError::Pole { what: self.to_string(), at: "infinity" });
        }
        let order = self.denominator.degree();
        let down = |p: &Polynomial| (0..=order).rev().map(|k| p.coefficient(k)).collect::<Vec<_>>();
        long_division(&down(&self.numerator), &down(&self.denominator), count)
            .ok_or(RationalError::DivisionByZero)
    }

    /// G(±jω) = a ± jω·b at a frequency whose square is rational: the function modulo s² + ω².
    ///
    /// # Errors
    /// A pole there.
    pub fn on_axis(&self, omega_squared: &Rational) -> Result<(Rational, Rational), RationalError> {
        let minus = -omega_squared;
        let at = |p: &Polynomial| {
            let (even, odd) = p.even_and_odd();
            (even.at(&minus), odd.at(&minus))
        };
        let ((a, b), (c, d)) = (at(&self.numerator), at(&self.denominator));
        // (a + jωb)/(c + jωd)
        let size = &c * &c + omega_squared * &d * &d;
        if size.is_zero() {
            return Err(RationalError::Pole { what: self.to_string(), at: "jω" });
        }
        Ok(((&a * &c + omega_squared * &b * &d) / &size, (b * c - a * d) / size))
    }

    /// G(jω), rounded once.
    ///
    /// # Errors
    /// A frequency that is not finite; a pole there.
    pub fn at_frequency(&self, omega_rad_s: f64) -> Result<C64, RationalError> {
        let omega = exact_bits(omega_rad_s)?;
        let (a, b) = self.on_axis(&(&omega * &omega))?;
        Ok(C64::new(to_f64(&a), to_f64(&(b * omega))))
    }
}

/// n/d as a power series, of coefficients ascending; none for d₀ = 0.
fn long_division(n: &[Rational], d: &[Rational], count: usize) -> Option<Vec<Rational>> {
    let over = d.first().filter(|d| !d.is_zero())?.recip();
    let mut series: Vec<Rational> = Vec::with_capacity(count);
    for k in 0..count {
        let known: Rational =
            (1..=k.min(d.len() - 1)).fold(Rational::zero(), |sum, j| sum + &d[j] * &series[k - j]);
        series.push((n.get(k).cloned().unwrap_or_else(Rational::zero) - known) * &over);
    }
    Some(series)
}

/// k!
pub(crate) fn factorial(k: usize) -> Rational {
    (1..=k).fold(Rational::one(), |f, j| f * Rational::from_integer(j.into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn r(n: &[i64], d: &[i64]) -> RationalFunction {
        RationalFunction::new(Polynomial::integers(n), Polynomial::integers(d)).unwrap()
    }
    fn q(n: i64, d: i64) -> Rational {
        Rational::new(n.into(), d.into())
    }

    #[test]
    fn series_of_a_geometric_kind() {
        // 1/(2 − s) = ½ + s/4 + s²/8 …; at infinity −1/s − 2/s² − 4/s³
        let g = r(&[1], &[2, -1]);
        assert_eq!(g.taylor(3).unwrap(), [q(1, 2), q(1, 4), q(1, 8)]);
        assert_eq!(g.at_infinity(4).unwrap(), [q(0, 1), q(-1, 1), q(-2, 1), q(-4, 1)]);
        assert!(r(&[1], &[0, 1]).taylor(1).is_err());
        assert!(r(&[0, 0, 1], &[1, 1]).at_infinity(1).is_err());
    }

    #[test]
    fn on_the_axis_both_ways_agree() {
        let g = r(&[1, 2, 3, 4], &[5, 6, 7, 8, 9]);
        // ω² = 9/4
        let (a, b) = g.on_axis(&q(9, 4)).unwrap();
        let there = g.at_frequency(1.5).unwrap();
        assert_eq!((to_f64(&a), 1.5 * to_f64(&b)), (there.re, there.im));
        let s = C64::new(0.0, 1.5);
        let known =
            (1.0 + s * (2.0 + s * (3.0 + s * 4.0))) / (5.0 + s * (6.0 + s * (7.0 + s * (8.0 + s * 9.0))));
        assert!((there - known).norm() < 1e-15);
        assert!(r(&[1], &[4, 0, 1]).at_frequency(2.0).is_err());
    }
}
