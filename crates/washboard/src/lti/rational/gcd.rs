//! Greatest common divisors of polynomials: a proof modulo a prime where there is none, Euclid's algorithm else.

use super::Polynomial;
use num_bigint::BigInt;
use num_traits::ToPrimitive;

/// A prime below 2⁶², for proofs that two polynomials are coprime.
const PRIME: u64 = 2_305_843_009_213_693_951;

impl Polynomial {
    /// The monic greatest common divisor; of 0 and p, p made monic; of 0 and 0, 1.
    ///
    /// Modulo a prime that divides no leading coefficient the divisor's degree can only grow: coprime there is coprime.
    /// Where it is not, by Euclid's algorithm with primitive remainders.
    #[must_use]
    pub fn gcd(&self, other: &Self) -> Self {
        let (mut a, mut b) = if self.degree() >= other.degree() { (self, other) } else { (other, self) };
        if a.is_zero() && !b.is_zero() {
            (a, b) = (b, a);
        }
        if b.is_zero() {
            return if a.is_zero() { Self::one() } else { a.monic() };
        }
        if b.degree() == 0 || coprime_modulo(a.integer_coefficients(), b.integer_coefficients()) {
            return Self::one();
        }
        let (mut a, mut b) = (a.primitive(), b.primitive());
        while !b.is_zero() {
            let r = a.divided_by(&b).map_or_else(|_| Self::zero(), |(_, r)| r.primitive());
            (a, b) = (b, r);
        }
        a.monic()
    }
}

/// Whether two polynomials are coprime modulo [`PRIME`], and therefore are; false where that says nothing.
fn coprime_modulo(a: &[BigInt], b: &[BigInt]) -> bool {
    let product = |x: u64, y: u64| (u128::from(x) * u128::from(y) % u128::from(PRIME)) as u64;
    let prime = BigInt::from(PRIME);
    let residue = |c: &BigInt| (((c % &prime) + &prime) % &prime).to_u64().unwrap_or(0);
    let mut a: Vec<u64> = a.iter().map(residue).collect();
    let mut b: Vec<u64> = b.iter().map(residue).collect();
    if a.last() == Some(&0) || b.last() == Some(&0) {
        return false;
    }
    let power = |mut x: u64, mut e: u64| {
        let mut y = 1;
        while e > 0 {
            if e & 1 == 1 {
                y = product(y, x);
            }
            x = product(x, x);
            e >>= 1;
        }
        y
    };
    while b.len() > 1 {
        let over = power(b[b.len() - 1], PRIME - 2);
        while a.len() >= b.len() {
            let (factor, shift) = (product(a[a.len() - 1], over), a.len() - b.len());
            for (j, c) in b.iter().enumerate() {
                a[shift + j] = (a[shift + j] + PRIME - product(factor, *c)) % PRIME;
            }
            a.pop();
        }
        while a.last() == Some(&0) {
            a.pop();
        }
        std::mem::swap(&mut a, &mut b);
    }
    b.len() == 1
}

#[cfg(test)]
mod tests {
    use super::*;

    fn p(c: &[i64]) -> Polynomial {
        Polynomial::integers(c)
    }

    #[test]
    fn the_gcd_is_what_was_put_in() {
        let common = p(&[5, 1, 2]);
        let (a, b) = (&p(&[1, 2, 0, 3]) * &common, &p(&[-7, 1]) * &common);
        assert_eq!(a.gcd(&b), common.monic());
        assert_eq!(p(&[1, 1]).gcd(&p(&[2, 1])), Polynomial::one());
        assert_eq!(p(&[]).gcd(&p(&[4, 2])), p(&[2, 1]));
        // a root that only exists modulo the prime is not shared
        assert_eq!(p(&[PRIME as i64, 1]).gcd(&p(&[0, 1])), Polynomial::one());
    }
}
