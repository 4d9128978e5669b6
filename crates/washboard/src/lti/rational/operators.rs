//! Sums and products of polynomials.

use super::Polynomial;
use num_bigint::BigInt;
use num_traits::Zero;
use std::ops::{Add, Mul, Neg, Sub};

impl Add for &Polynomial {
    type Output = Polynomial;
    #[allow(clippy::suspicious_arithmetic_impl, reason = "over a common denominator")]
    fn add(self, other: &Polynomial) -> Polynomial {
        let n = self.coefficients.len().max(other.coefficients.len());
        let term = |p: &Polynomial, k: usize, by: &BigInt| {
            p.coefficients.get(k).map_or_else(BigInt::zero, |c| c * by)
        };
        let c = (0..n).map(|k| term(self, k, &other.over) + term(other, k, &self.over)).collect();
        Polynomial::reduced(c, &self.over * &other.over)
    }
}

impl Neg for &Polynomial {
    type Output = Polynomial;
    fn neg(self) -> Polynomial {
        Polynomial { coefficients: self.coefficients.iter().map(|c| -c).collect(), over: self.over.clone() }
    }
}

impl Sub for &Polynomial {
    type Output = Polynomial;
    fn sub(self, other: &Polynomial) -> Polynomial {
        self + &-other
    }
}

impl Mul for &Polynomial {
    type Output = Polynomial;
    fn mul(self, other: &Polynomial) -> Polynomial {
        if self.is_zero() || other.is_zero() {
            return Polynomial::zero();
        }
        let mut c = vec![BigInt::zero(); self.coefficients.len() + other.coefficients.len() - 1];
        for (i, a) in self.coefficients.iter().enumerate() {
            for (j, b) in other.coefficients.iter().enumerate() {
                c[i + j] += a * b;
            }
        }
        Polynomial::reduced(c, &self.over * &other.over)
    }
}
