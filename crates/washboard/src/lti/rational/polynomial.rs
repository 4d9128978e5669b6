//! Polynomials in s with rational coefficients: integers over one common denominator.

use super::{Rational, RationalError, to_f64};
use num_bigint::{BigInt, Sign};
use num_rational::Ratio;
use num_traits::{One, Signed, Zero};
use std::fmt;

/// p(s) = (c₀ + c₁s + … + cₙsⁿ)/q with integers c and q > 0 that share no factor: equal polynomials are equal values.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Polynomial {
    /// Ascending; the last one is not zero; empty for 0.
    pub(super) coefficients: Vec<BigInt>,
    pub(super) over: BigInt,
}

impl Polynomial {
    /// From coefficients, ascending.
    #[must_use]
    pub fn new(coefficients: &[Rational]) -> Self {
        let over = coefficients.iter().fold(BigInt::one(), |l, c| {
            let g = gcd(&l, c.denom());
            l / g * c.denom()
        });
        Self::reduced(coefficients.iter().map(|c| c.numer() * (&over / c.denom())).collect(), over)
    }

    /// From integers, ascending.
    #[must_use]
    pub fn integers(coefficients: &[i64]) -> Self {
        Self::reduced(coefficients.iter().map(|c| BigInt::from(*c)).collect(), BigInt::one())
    }

    /// A number.
    #[must_use]
    pub fn constant(value: Rational) -> Self {
        Self::new(&[value])
    }

    /// c sᵏ.
    #[must_use]
    pub fn monomial(value: Rational, k: usize) -> Self {
        let mut coefficients = vec![Rational::zero(); k];
        coefficients.push(value);
        Self::new(&coefficients)
    }

    /// sᵏ.
    #[must_use]
    pub fn power_of_s(k: usize) -> Self {
        Self::monomial(Rational::one(), k)
    }

    /// 0.
    #[must_use]
    pub fn zero() -> Self {
        Polynomial { coefficients: Vec::new(), over: BigInt::one() }
    }

    /// 1.
    #[must_use]
    pub fn one() -> Self {
        Self::integers(&[1])
    }

    /// Whether it is 0.
    #[must_use]
    pub fn is_zero(&self) -> bool {
        self.coefficients.is_empty()
    }

    /// The degree; 0 also for 0.
    #[must_use]
    pub fn degree(&self) -> usize {
        self.coefficients.len().saturating_sub(1)
    }

    /// The coefficient of sᵏ.
    #[must_use]
    pub fn coefficient(&self, k: usize) -> Rational {
        self.coefficients.get(k).map_or_else(Rational::zero, |c| Ratio::new(c.clone(), self.over.clone()))
    }

    /// All coefficients, ascending.
    #[must_use]
    pub fn coefficients(&self) -> Vec<Rational> {
        (0..self.coefficients.len()).map(|k| self.coefficient(k)).collect()
    }

    /// The coefficient of the highest power; 0 of 0.
    #[must_use]
    pub fn leading(&self) -> Rational {
        self.coefficient(self.degree())
    }

    /// The multiplicity of the zero at s = 0 (0 for the zero polynomial).
    #[must_use]
    pub fn zeros_at_origin(&self) -> usize {
        self.coefficients.iter().position(|c| !c.is_zero()).unwrap_or(0)
    }

    /// p times a number.
    #[must_use]
    pub fn scaled(&self, by: &Rational) -> Self {
        Self::reduced(self.coefficients.iter().map(|c| c * by.numer()).collect(), &self.over * by.denom())
    }

    /// p divided by its leading coefficient; 0 stays.
    #[must_use]
    pub fn monic(&self) -> Self {
        if self.is_zero() { Self::zero() } else { self.scaled(&self.leading().recip()) }
    }

    /// Quotient and remainder, deg r < deg d.
    ///
    /// # Errors
    /// d = 0.
    pub fn divided_by(&self, d: &Self) -> Result<(Self, Self), RationalError> {
        let Some(lead) = d.coefficients.last() else { return Err(RationalError::DivisionByZero) };
        let n = d.degree();
        let Some(steps) = self.coefficients.len().checked_sub(n).filter(|_| !self.is_zero()) else {
            return Ok((Self::zero(), self.clone()));
        };
        // lead^steps·p = q·d + r in integers
        let mut rest = self.coefficients.clone();
        let mut q = vec![BigInt::zero(); steps];
        for k in (0..steps).rev() {
            let top = rest[k + n].clone();
            for c in q.iter_mut().chain(rest.iter_mut()) {
                *c *= lead;
            }
            for (j, c) in d.coefficients.iter().enumerate() {
                rest[k + j] -= &top * c;
            }
            q[k] += top;
        }
        rest.truncate(n);
        let scale = lead.pow(steps as u32) * &self.over;
        let quotient = Self::reduced(q.into_iter().map(|c| c * &d.over).collect(), scale.clone());
        Ok((quotient, Self::reduced(rest, scale)))
    }

    /// p/d where d divides p.
    ///
    /// # Errors
    /// d = 0; a remainder.
    pub fn exactly_over(&self, d: &Self) -> Result<Self, RationalError> {
        let (quotient, remainder) = self.divided_by(d)?;
        if remainder.is_zero() {
            return Ok(quotient);
        }
        let (dividend, divisor, remainder) = (self.to_string(), d.to_string(), remainder.to_string());
        Err(RationalError::NotDivisible { dividend, divisor, remainder })
    }

    /// The quotient by a divisor that is known to divide.
    pub(super) fn quotient(&self, d: &Self) -> Self {
        if d.degree() == 0 && d.leading().is_one() {
            return self.clone();
        }
        self.divided_by(d).map_or_else(|_| self.clone(), |(q, _)| q)
    }

    /// dp/ds.
    #[must_use]
    pub fn derivative(&self) -> Self {
        let c = self.coefficients.iter().enumerate().skip(1).map(|(k, c)| c * BigInt::from(k)).collect();
        Self::reduced(c, self.over.clone())
    }

    /// p at a rational point.
    #[must_use]
    pub fn at(&self, s: &Rational) -> Rational {
        self.coefficients.iter().rev().fold(Rational::zero(), |v, c| v * s + Ratio::from_integer(c.clone()))
            / Ratio::from_integer(self.over.clone())
    }

    /// Even and odd part: p(s) = e(s²) + s·o(s²).
    #[must_use]
    pub fn even_and_odd(&self) -> (Self, Self) {
        let part = |from: usize| {
            let c = self.coefficients.iter().skip(from).step_by(2).cloned().collect();
            Self::reduced(c, self.over.clone())
        };
        (part(0), part(1))
    }

    /// The integers c₀ … cₙ.
    pub(super) fn integer_coefficients(&self) -> &[BigInt] {
        &self.coefficients
    }

    pub(super) fn primitive(&self) -> Self {
        Self::reduced(self.coefficients.clone(), BigInt::zero())
    }

    /// In lowest terms; over zero: the primitive part.
    pub(super) fn reduced(mut coefficients: Vec<BigInt>, over: BigInt) -> Self {
        while coefficients.last().is_some_and(Zero::is_zero) {
            coefficients.pop();
        }
        if coefficients.is_empty() {
            return Self::zero();
        }
        let mut common = over.abs();
        for c in &coefficients {
            if common.is_one() {
                break;
            }
            common = gcd(&common, c);
        }
        if over.sign() == Sign::Minus {
            common = -common;
        }
        if !common.is_one() {
            for c in &mut coefficients {
                *c /= &common;
            }
        }
        let over = if over.is_zero() { BigInt::one() } else { over / common };
        Polynomial { coefficients, over }
    }
}

/// Euclid's algorithm with division for numbers of unequal size; the binary one is slow there.
fn gcd(a: &BigInt, b: &BigInt) -> BigInt {
    let (mut a, mut b) = (a.abs(), b.abs());
    while !b.is_zero() {
        let r = &a % &b;
        (a, b) = (b, r);
    }
    a
}

impl fmt::Display for Polynomial {
    /// Six digits a coefficient, descending powers.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_zero() {
            return write!(f, "0");
        }
        let mut first = true;
        for k in (0..=self.degree()).rev() {
            let c = self.coefficient(k);
            if c.is_zero() {
                continue;
            }
            let sign = match (first, c.is_negative()) {
                (true, true) => "−",
                (true, false) => "",
                (false, true) => " − ",
                (false, false) => " + ",
            };
            let size = crate::lti::rational::number::short(to_f64(&c.abs()));
            let power = match k {
                0 => String::new(),
                1 => " s".to_owned(),
                _ => format!(" s^{k}"),
            };
            let text =
                if size == "1" && k > 0 { power.trim_start().to_owned() } else { format!("{size}{power}") };
            write!(f, "{sign}{text}")?;
            first = false;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn p(c: &[i64]) -> Polynomial {
        Polynomial::integers(c)
    }

    #[test]
    fn division_gives_back_what_was_multiplied() {
        let (a, b) = (p(&[3, -1, 4, 1, -5]), p(&[2, 7, 3]).scaled(&Rational::new(1.into(), 6.into())));
        let (q, r) = a.divided_by(&b).unwrap();
        assert_eq!(&(&q * &b) + &r, a);
        assert!(r.degree() < b.degree());
        assert_eq!((&a * &b).exactly_over(&b).unwrap(), a);
        assert!(matches!(a.exactly_over(&b), Err(RationalError::NotDivisible { .. })));
        assert_eq!(a.divided_by(&p(&[])).unwrap_err(), RationalError::DivisionByZero);
        assert_eq!(b.divided_by(&a).unwrap().1, b);
    }

    #[test]
    fn parts_and_values() {
        let a = p(&[1, 2, 3, 4]);
        assert_eq!(a.even_and_odd(), (p(&[1, 3]), p(&[2, 4])));
        assert_eq!(a.derivative(), p(&[2, 6, 12]));
        assert_eq!(a.at(&Rational::new(1.into(), 2.into())), Rational::new(13.into(), 4.into()));
        assert_eq!(p(&[0, 0, 3]).zeros_at_origin(), 2);
        assert_eq!(p(&[-2, 0, 1]).to_string(), "s^2 − 2");
    }
}
