//! Exact rational functions of s: cancellation, stability and interpolation without rounding.

mod convert;
mod gcd;
mod hurwitz;
mod norm;
pub(crate) mod number;
mod operators;
mod polynomial;
pub(crate) mod series;

pub use number::{Rational, RationalError, decimal, exact_bits, to_f64};
pub use polynomial::Polynomial;

use std::fmt;
use std::ops::{Add, Mul, Neg, Sub};

/// G(s) = n(s)/d(s) with rational coefficients, in lowest terms, d monic: equal functions are equal values.
///
/// ```
/// use washboard::lti::{Polynomial, RationalFunction};
/// // (s² + 3s + 2)/(s² − 1) is (s + 2)/(s − 1)
/// let p = |c: &[i64]| Polynomial::integers(c);
/// let g = RationalFunction::new(p(&[2, 3, 1]), p(&[-1, 0, 1]))?;
/// assert_eq!(g, RationalFunction::new(p(&[2, 1]), p(&[-1, 1]))?);
/// assert!(g.is_proper() && !g.is_stable());
/// # Ok::<(), washboard::lti::RationalError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RationalFunction {
    numerator: Polynomial,
    denominator: Polynomial,
}

impl RationalFunction {
    /// n/d, cancelled.
    ///
    /// # Errors
    /// A denominator that is zero.
    pub fn new(numerator: Polynomial, denominator: Polynomial) -> Result<Self, RationalError> {
        if denominator.is_zero() {
            return Err(RationalError::DivisionByZero);
        }
        let common = numerator.gcd(&denominator);
        let (numerator, denominator) = (numerator.quotient(&common), denominator.quotient(&common));
        Ok(Self::coprime(numerator, denominator))
    }

    /// A polynomial.
    #[must_use]
    pub fn polynomial(p: Polynomial) -> Self {
        RationalFunction { numerator: p, denominator: Polynomial::one() }
    }

    /// A number.
    #[must_use]
    pub fn constant(value: Rational) -> Self {
        Self::polynomial(Polynomial::constant(value))
    }

    /// 0.
    #[must_use]
    pub fn zero() -> Self {
        Self::polynomial(Polynomial::zero())
    }

    /// 1.
    #[must_use]
    pub fn one() -> Self {
        Self::polynomial(Polynomial::one())
    }

    /// n, coprime to d.
    #[must_use]
    pub fn numerator(&self) -> &Polynomial {
        &self.numerator
    }

    /// d, monic.
    #[must_use]
    pub fn denominator(&self) -> &Polynomial {
        &self.denominator
    }

    /// Whether it is 0.
    #[must_use]
    pub fn is_zero(&self) -> bool {
        self.numerator.is_zero()
    }

    /// McMillan degree: the larger of the two degrees.
    #[must_use]
    pub fn degree(&self) -> usize {
        self.numerator.degree().max(self.denominator.degree())
    }

    /// deg d − deg n; none of 0.
    #[must_use]
    pub fn relative_degree(&self) -> Option<i64> {
        (!self.is_zero()).then(|| self.denominator.degree() as i64 - self.numerator.degree() as i64)
    }

    /// Finite at infinity.
    #[must_use]
    pub fn is_proper(&self) -> bool {
        self.relative_degree().is_none_or(|r| r >= 0)
    }

    /// Proper, and all poles in the open left half plane, by an exact test: an element of RH∞.
    #[must_use]
    pub fn is_stable(&self) -> bool {
        self.is_proper() && self.denominator.is_hurwitz()
    }

    /// 1/G.
    ///
    /// # Errors
    /// G = 0.
    pub fn inverse(&self) -> Result<Self, RationalError> {
        if self.is_zero() {
            return Err(RationalError::DivisionByZero);
        }
        Ok(Self::coprime(self.denominator.clone(), self.numerator.clone()))
    }

    /// G/other.
    ///
    /// # Errors
    /// other = 0.
    pub fn over(&self, other: &Self) -> Result<Self, RationalError> {
        Ok(self * &other.inverse()?)
    }

    /// G times a number.
    #[must_use]
    pub fn scaled(&self, by: &Rational) -> Self {
        RationalFunction { numerator: self.numerator.scaled(by), denominator: self.denominator.clone() }
    }

    /// Coprime n and d, d made monic.
    fn coprime(numerator: Polynomial, denominator: Polynomial) -> Self {
        if numerator.is_zero() {
            return Self::zero();
        }
        let over = denominator.leading().recip();
        RationalFunction { numerator: numerator.scaled(&over), denominator: denominator.scaled(&over) }
    }
}

impl Add for &RationalFunction {
    type Output = RationalFunction;
    /// n₁/d₁ + n₂/d₂ with g = gcd(d₁, d₂): what can cancel then divides g (Henrici's rule).
    fn add(self, other: &RationalFunction) -> RationalFunction {
        let g = self.denominator.gcd(&other.denominator);
        let (left, right) = (self.denominator.quotient(&g), other.denominator.quotient(&g));
        let n = &(&self.numerator * &right) + &(&other.numerator * &left);
        let common = n.gcd(&g);
        let d = &(&left * &right) * &g.quotient(&common);
        RationalFunction::coprime(n.quotient(&common), d)
    }
}

impl Neg for &RationalFunction {
    type Output = RationalFunction;
    fn neg(self) -> RationalFunction {
        RationalFunction { numerator: -&self.numerator, denominator: self.denominator.clone() }
    }
}

impl Sub for &RationalFunction {
    type Output = RationalFunction;
    fn sub(self, other: &RationalFunction) -> RationalFunction {
        self + &-other
    }
}

impl Mul for &RationalFunction {
    type Output = RationalFunction;
    fn mul(self, other: &RationalFunction) -> RationalFunction {
        let (g, h) = (self.numerator.gcd(&other.denominator), other.numerator.gcd(&self.denominator));
        let n = &self.numerator.quotient(&g) * &other.numerator.quotient(&h);
        let d = &self.denominator.quotient(&h) * &other.denominator.quotient(&g);
        RationalFunction::coprime(n, d)
    }
}

impl fmt::Display for RationalFunction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.denominator == Polynomial::one() {
            return write!(f, "{}", self.numerator);
        }
        write!(f, "({})/({})", self.numerator, self.denominator)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn r(n: &[i64], d: &[i64]) -> RationalFunction {
        RationalFunction::new(Polynomial::integers(n), Polynomial::integers(d)).unwrap()
    }

    #[test]
    fn a_field_it_is() {
        let (a, b, c) = (r(&[1, 2, 3], &[2, 1, 0, 4]), r(&[-1, 0, 5], &[2, 1]), r(&[7, 1], &[1, 0, 1]));
        assert_eq!(&(&a + &b) * &c, &(&a * &c) + &(&b * &c));
        assert_eq!(&(&a - &b) + &b, a);
        assert_eq!((&a * &b).over(&b).unwrap(), a);
        assert!((&a - &a).is_zero());
        assert_eq!(RationalFunction::zero().inverse().unwrap_err(), RationalError::DivisionByZero);
    }

    #[test]
    fn sums_cancel_what_they_share() {
        // 1/(s(s+1)) − 1/s = −1/(s+1)
        assert_eq!(&r(&[1], &[0, 1, 1]) - &r(&[1], &[0, 1]), r(&[-1], &[1, 1]));
        assert_eq!((&r(&[1], &[1, 1]) + &r(&[1], &[2, 1])).degree(), 2);
    }

    #[test]
    fn stability_and_properness_are_exact() {
        assert!(r(&[1, 1], &[1, 1, 1]).is_stable());
        assert!(!r(&[1], &[1, 0, 1]).is_stable(), "poles on the axis");
        assert!(!r(&[1, 0, 1], &[1, 1]).is_stable(), "improper");
        assert_eq!(r(&[1], &[1, 0, 1]).relative_degree(), Some(2));
    }
}
