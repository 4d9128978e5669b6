//! Ψ: a second-order filter that is 1 where the design is copied and σ at infinity, where tire damping decides.

use super::AchievableError;
use crate::lti::{Polynomial, Rational, RationalFunction, decimal, to_f64};
use num_traits::One;

/// Ψ(s) = (σs² + a s + b)/(s² + a s + b): Ψ(0) = 1, Ψ'(0) = 0, Ψ(∞) = σ, conditions (iv)–(vi) of §4.4.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Psi {
    /// a and b as given; σ the ratio of the tire dampings.
    Given {
        /// rad/s.
        a: f64,
        /// (rad/s)².
        b: f64,
    },
    /// All three as given; another σ than the ratio of the tire dampings is answered with the constraint that it breaks.
    GivenWithSigma {
        /// rad/s.
        a: f64,
        /// (rad/s)².
        b: f64,
        /// Ψ(∞).
        sigma: f64,
    },
    /// |Ψ(jω) − 1| ≤ tolerance for ω ≤ Ω by a double pole: a = 2p, b = p², p = Ω√((1 − σ)/tolerance − 1).
    ForBand {
        /// Ω, rad/s.
        omega_rad_s: f64,
        /// In (0, 1).
        tolerance: f64,
    },
}

impl Psi {
    /// The thesis's: a = 500, b = 10.
    pub const PRINTED: Psi = Psi::Given { a: 500.0, b: 10.0 };

    /// Ψ for a ratio of tire dampings.
    ///
    /// # Errors
    /// Numbers that are not positive; a tolerance that is not below 1.
    pub fn function(&self, ratio: &Rational) -> Result<RationalFunction, AchievableError> {
        let positive = |field: &'static str, found: f64| {
            if found > 0.0 && found.is_finite() {
                return Ok(decimal(found)?);
            }
            Err(AchievableError::Number { field, expected: "a positive, finite number", found })
        };
        let (a, b, sigma) = match *self {
            Psi::Given { a, b } => (positive("a", a)?, positive("b", b)?, ratio.clone()),
            Psi::GivenWithSigma { a, b, sigma } => {
                (positive("a", a)?, positive("b", b)?, positive("sigma", sigma)?)
            }
            Psi::ForBand { omega_rad_s, tolerance } => {
                if !(tolerance > 0.0 && tolerance < 1.0) {
                    let (field, expected) = ("tolerance", "a number between 0 and 1");
                    return Err(AchievableError::Number { field, expected, found: tolerance });
                }
                positive("omega_rad_s", omega_rad_s)?;
                let distance = (1.0 - to_f64(ratio)).abs();
                let p = decimal(omega_rad_s * (distance / tolerance - 1.0).max(1.0).sqrt())?;
                (&p + &p, &p * &p, ratio.clone())
            }
        };
        let over = |lead: Rational| Polynomial::new(&[b.clone(), a.clone(), lead]);
        Ok(RationalFunction::new(over(sigma), over(Rational::one()))?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_psi_keeps_the_three_conditions_and_its_band() {
        let ratio = Rational::new(1.into(), 20.into());
        for psi in [Psi::PRINTED, Psi::ForBand { omega_rad_s: 200.0, tolerance: 0.01 }] {
            let f = psi.function(&ratio).unwrap();
            assert!(f.is_stable());
            assert_eq!(f.taylor(2).unwrap(), [Rational::one(), Rational::new(0.into(), 1.into())]);
            assert_eq!(f.at_infinity(1).unwrap(), std::slice::from_ref(&ratio));
        }
        let f = Psi::ForBand { omega_rad_s: 200.0, tolerance: 0.01 }.function(&ratio).unwrap();
        let off = |omega: f64| (f.at_frequency(omega).unwrap() - 1.0).norm();
        assert!(off(200.0) < 0.01 * (1.0 + 1e-9) && off(200.0) > 0.0099 && off(100.0) < off(200.0));
        assert!(Psi::ForBand { omega_rad_s: 1.0, tolerance: 1.0 }.function(&ratio).is_err());
        assert!(Psi::Given { a: 0.0, b: 1.0 }.function(&ratio).is_err());
    }
}
