//! Numbers: from floating point to rationals and back.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive, Zero};
use thiserror::Error;

/// A ratio of integers of any size.
pub type Rational = BigRational;

/// What exact arithmetic refuses.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum RationalError {
    /// A number that is none.
    #[error("expected a finite number, found {found}")]
    NotFinite {
        /// What was given.
        found: f64,
    },
    /// By the zero polynomial or function.
    #[error("division by zero")]
    DivisionByZero,
    /// A polynomial that does not divide another one.
    #[error("{divisor} does not divide {dividend}: the remainder is {remainder}")]
    NotDivisible {
        /// What was to be divided.
        dividend: String,
        /// By what.
        divisor: String,
        /// What is left.
        remainder: String,
    },
    /// A pole where a value was asked for.
    #[error("{what} has a pole at s = {at}")]
    Pole {
        /// Which function.
        what: String,
        /// Where.
        at: &'static str,
    },
    /// State space is for proper functions.
    #[error(
        "a function with numerator degree {numerator} and denominator degree {denominator} has no state space"
    )]
    Improper {
        /// Degree of n.
        numerator: usize,
        /// Degree of d.
        denominator: usize,
    },
    /// An H2 norm is for what is stable and strictly proper.
    #[error("the H2 norm is for stable, strictly proper functions, found {what}")]
    NoNorm {
        /// Which function.
        what: String,
    },
    /// Linear algebra or a system refused.
    #[error(transparent)]
    Lti(#[from] crate::lti::LtiError),
}

/// The rational that a person means by a floating-point number: its shortest decimal that reads back as the same number.
///
/// 0.1 is 1/10 and 16000.0 is 16000. Vehicle data are decimals that people wrote; their binary neighbours would break
/// what holds exactly between them (0.1·980 = 98). For numbers that an algorithm made, [`exact_bits`] is as right.
///
/// # Errors
/// NaN, infinities.
///
/// ```
/// use washboard::lti::{Rational, decimal};
/// assert_eq!(decimal(0.1)?, Rational::new(1.into(), 10.into()));
/// assert_eq!(decimal(-1.6e4)?, Rational::from_integer((-16000).into()));
/// # Ok::<(), washboard::lti::RationalError>(())
/// ```
pub fn decimal(x: f64) -> Result<Rational, RationalError> {
    let refused = || RationalError::NotFinite { found: x };
    if !x.is_finite() {
        return Err(refused());
    }
    // shortest digits that round-trip, by the standard library
    let text = format!("{:e}", x.abs());
    let (mantissa, exponent) = text.split_once('e').ok_or_else(refused)?;
    let (whole, part) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let digits: BigInt = format!("{whole}{part}").parse().map_err(|_| refused())?;
    let exponent = exponent.parse::<i32>().map_err(|_| refused())? - part.len() as i32;
    let power = BigInt::from(10).pow(exponent.unsigned_abs());
    let size =
        if exponent < 0 { Rational::new(digits, power) } else { Rational::from_integer(digits * power) };
    Ok(if x < 0.0 { -size } else { size })
}

/// The rational that a floating-point number is, to the last bit.
///
/// # Errors
/// NaN, infinities.
pub fn exact_bits(x: f64) -> Result<Rational, RationalError> {
    Rational::from_float(x).ok_or(RationalError::NotFinite { found: x })
}

/// The nearest floating-point number; ±∞ beyond the largest.
#[must_use]
pub fn to_f64(x: &Rational) -> f64 {
    if x.is_zero() {
        return 0.0;
    }
    // 64 bits of quotient, of which the last one says whether anything was cut off, so that it is rounded once
    let (n, d) = (x.numer().abs(), x.denom());
    let shift = 66 - (n.bits() as i64 - d.bits() as i64);
    let (n, d) =
        if shift >= 0 { (n << shift.unsigned_abs(), d.clone()) } else { (n, d << shift.unsigned_abs()) };
    let quotient = &n / &d;
    let sticky = if (&quotient * &d) == n { BigInt::zero() } else { BigInt::one() };
    let size = ((quotient << 1u32) + sticky).to_f64().unwrap_or(f64::INFINITY);
    let exponent = -(shift + 1);
    // in two steps: 2^exponent may itself be out of range
    let half = exponent / 2;
    let two = |k: i64| 2f64.powi(k.clamp(-2000, 2000) as i32);
    let value = size * two(half) * two(exponent - half);
    if x.is_negative() { -value } else { value }
}

/// Seven significant digits, without an exponent where that is short.
pub(crate) fn short(x: f64) -> String {
    let size = x.abs();
    if size != 0.0 && !(1e-4..1e7).contains(&size) {
        return format!("{x:.6e}");
    }
    let decimals = if size == 0.0 { 0 } else { (6 - size.log10().floor() as i32).max(0) as usize };
    let text = format!("{x:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_are_what_people_write() {
        let q = |n: i64, d: i64| Rational::new(n.into(), d.into());
        for (x, n, d) in
            [(0.1, 1, 10), (16_000.0, 16_000, 1), (-2.5e-3, -1, 400), (0.0, 0, 1), (1e15, 10i64.pow(15), 1)]
        {
            assert_eq!(decimal(x).unwrap(), q(n, d));
        }
        assert!(decimal(f64::NAN).is_err() && exact_bits(f64::INFINITY).is_err());
        assert_ne!(exact_bits(0.1).unwrap(), q(1, 10));
    }

    #[test]
    fn both_ways_round_trip() {
        let mut x = 1.0e-7f64;
        for k in 0..400 {
            x = (x * 1.37 + f64::from(k)).sin() * 10f64.powi(k % 37 - 18);
            assert_eq!(to_f64(&decimal(x).unwrap()), x);
            assert_eq!(to_f64(&exact_bits(x).unwrap()), x);
        }
        assert_eq!(to_f64(&(decimal(1e300).unwrap() * decimal(1e300).unwrap())), f64::INFINITY);
        // 2/3 is rounded to the nearest
        assert_eq!(to_f64(&Rational::new(2.into(), 3.into())), 2.0 / 3.0);
    }
}
