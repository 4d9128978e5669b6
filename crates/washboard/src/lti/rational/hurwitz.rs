//! Is a polynomial Hurwitz? Routh's array in integers; and its zeros in floating point.

use super::{Polynomial, to_f64};
use crate::linalg::{C64, Mat};
use crate::lti::{LtiError, StateSpace};
use num_bigint::BigInt;
use num_traits::{Signed, Zero};

impl Polynomial {
    /// Whether all zeros are in the open left half plane, by Routh's array without rounding. Constants but 0 are.
    ///
    /// A new row is (b₀aⱼ₊₁ − a₀bⱼ₊₁) of the two rows above: Routh's times b₀ > 0, divided by the leading entry of the
    /// row above both where that leaves integers (it then keeps the entries minors, as in Bareiss's elimination).
    #[must_use]
    pub fn is_hurwitz(&self) -> bool {
        let c = self.integer_coefficients();
        let Some(lead) = c.last() else { return false };
        // all coefficients of one sign: necessary
        if c.iter().any(|x| x.sign() != lead.sign()) {
            return false;
        }
        let rows = |from: usize| c.iter().rev().skip(from).step_by(2).map(BigInt::abs).collect::<Vec<_>>();
        let (mut above, mut below, mut divisor) = (rows(0), rows(1), None::<BigInt>);
        while !below.is_empty() {
            if !below[0].is_positive() {
                return false;
            }
            let at = |row: &[BigInt], j: usize| row.get(j).cloned().unwrap_or_else(BigInt::zero);
            let mut next: Vec<BigInt> = (0..above.len() - 1)
                .map(|j| &below[0] * at(&above, j + 1) - &above[0] * at(&below, j + 1))
                .collect();
            if let Some(d) = &divisor
                && next.iter().all(|x| (x % d).is_zero())
            {
                for x in &mut next {
                    *x /= d;
                }
            }
            divisor = Some(above[0].clone());
            (above, below) = (below, next);
        }
        true
    }

    /// The zeros, in floating point: eigenvalues of the companion matrix in a time scale of the zeros' own, balanced.
    ///
    /// # Errors
    /// An iteration that does not converge; coefficients beyond floating point.
    pub fn roots(&self) -> Result<Vec<C64>, LtiError> {
        let at_zero = self.zeros_at_origin();
        let n = self.degree() - at_zero;
        let mut roots = vec![C64::new(0.0, 0.0); at_zero];
        if n == 0 {
            return Ok(roots);
        }
        let (rate, c) = self.monic_in_own_time(at_zero);
        let a = companion(&c);
        let system = StateSpace::continuous(a, Mat::zeros(n, 0), Mat::zeros(0, n), Mat::zeros(0, 0))?;
        roots.extend(system.balanced_scales()?.0.poles()?.into_iter().map(|p| p * rate));
        Ok(roots)
    }

    /// The power of two nearest to the zeros' geometric mean, and the monic coefficients c₀ … cₙ₋₁ in σ = s/rate of p/sᵏ.
    pub(super) fn monic_in_own_time(&self, skip: usize) -> (f64, Vec<f64>) {
        let lead = self.leading();
        let c: Vec<_> = self.coefficients().into_iter().skip(skip).collect();
        let n = c.len() - 1;
        let mean = to_f64(&(&c[0] / &lead)).abs().powf(1.0 / n as f64);
        let exponent = if mean.is_normal() { mean.log2().round() as i32 } else { 0 };
        let scaled = |k: usize| {
            let power = BigInt::from(1) << ((n - k) * exponent.unsigned_abs() as usize);
            let (value, power) = (&c[k] / &lead, num_rational::Ratio::from_integer(power));
            to_f64(&if exponent >= 0 { value / power } else { value * power })
        };
        (2f64.powi(exponent), (0..n).map(scaled).collect())
    }
}

/// The controllable companion matrix of σⁿ + cₙ₋₁σⁿ⁻¹ + … + c₀.
pub(super) fn companion(c: &[f64]) -> Mat {
    let n = c.len();
    Mat::from_fn(n, n, |i, j| match (i + 1 == n, i + 1 == j) {
        (true, _) => -c[j],
        (_, true) => 1.0,
        _ => 0.0,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn p(c: &[i64]) -> Polynomial {
        Polynomial::integers(c)
    }

    #[test]
    fn routh_agrees_with_the_zeros() {
        // products of factors whose zeros are known
        let stable = [p(&[1, 1]), p(&[5, 2, 1]), p(&[1, 1, 100]), p(&[1, 1_000_000])];
        let mut all = Polynomial::one();
        for f in &stable {
            all = &all * f;
            assert!(all.is_hurwitz(), "{all}");
            assert!((-&all).is_hurwitz());
            assert!(!(&all * &p(&[-1, 1_000_000])).is_hurwitz());
            assert!(!(&all * &p(&[2, 0, 3])).is_hurwitz(), "on the axis");
            assert!(!(&all * &p(&[2, -1, 3])).is_hurwitz());
            assert!(!(&all * &p(&[0, 1])).is_hurwitz(), "at zero");
            assert!(all.roots().unwrap().iter().all(|r| r.re < 0.0));
        }
        assert!(p(&[7]).is_hurwitz() && !p(&[]).is_hurwitz());
        // s⁴ + s³ + 2s² + 2s + 3: positive coefficients, zeros to the right
        assert!(!p(&[3, 2, 2, 1, 1]).is_hurwitz());
        // a vanishing entry in the first column
        assert!(!p(&[2, 2, 1, 1]).is_hurwitz());
    }

    #[test]
    fn a_margin_of_one_in_a_quintillion_is_seen() {
        let least = num_rational::Ratio::new(1.into(), 10i64.pow(18).into());
        let nearly = |sign: i64| {
            let bit = Polynomial::constant(&least * num_bigint::BigInt::from(sign));
            &(&p(&[1, 0, 1]) + &(&p(&[0, 1]) * &bit)) * &p(&[3, 1])
        };
        assert!(nearly(1).is_hurwitz() && !nearly(-1).is_hurwitz() && !nearly(0).is_hurwitz());
    }

    #[test]
    fn zeros_far_apart_are_found() {
        let poly = &(&p(&[1, 1000]) * &p(&[1_000_000, 1])) * &(&p(&[4, 0, 1]) * &p(&[0, 0, 1]));
        let mut sizes: Vec<f64> = poly.roots().unwrap().iter().map(|r| r.norm()).collect();
        sizes.sort_by(f64::total_cmp);
        for (found, known) in sizes.iter().zip([0.0, 0.0, 0.001, 2.0, 2.0, 1e6]) {
            assert!((found - known).abs() <= 1e-12 * known, "{found} {known}");
        }
    }
}
