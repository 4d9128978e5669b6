//! The power of an actuator whose force and velocity are jointly Gaussian.

use super::MetricsError;
use std::f64::consts::{FRAC_PI_2, PI};

/// Mean powers of an actuator, W; what it gives is positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ActuatorPower {
    /// E\[Fv\]: given less taken.
    pub net_w: f64,
    /// E\[|Fv|\]: given and taken.
    pub absolute_w: f64,
    /// E\[max(Fv, 0)\]: given alone, where nothing that is taken is stored.
    pub given_w: f64,
}

impl ActuatorPower {
    /// Of a force and the velocity that it works on, of zero mean and jointly Gaussian with these second moments.
    ///
    /// With ρ = E\[Fv\]/(σ_F σ_v): E\[|Fv|\] = (2σ_Fσ_v/π)(√(1 − ρ²) + ρ asin ρ), and E\[max(Fv, 0)\] is half the sum of it and E\[Fv\]:
    /// (σ_Fσ_v/π)(√(1 − ρ²) + ρ(π/2 + asin ρ)).
    ///
    /// # Errors
    /// Rms that are negative or not finite, a covariance beyond σ_Fσ_v by more than rounding (10⁻⁶ of it).
    ///
    /// Source: the moments of a bivariate normal: S. Nabeya, Annals of the Institute of Statistical Mathematics 3 (1951) 2–6.
    ///
    /// ```
    /// use washboard::metrics::ActuatorPower;
    /// // a damper takes all that it moves: v = −F/c
    /// let p = ActuatorPower::gaussian(100.0, 0.2, -20.0)?;
    /// assert!((p.net_w + 20.0).abs() < 1e-12 && (p.absolute_w - 20.0).abs() < 1e-12 && p.given_w.abs() < 1e-12);
    /// # Ok::<(), washboard::metrics::MetricsError>(())
    /// ```
    pub fn gaussian(force_rms_n: f64, velocity_rms_m_s: f64, net_w: f64) -> Result<Self, MetricsError> {
        const ROUNDING: f64 = 1e-6;
        for (field, value) in [("force_rms_n", force_rms_n), ("velocity_rms_m_s", velocity_rms_m_s)] {
            if !(value.is_finite() && value >= 0.0) {
                let expected = "a finite number, not negative".to_owned();
                return Err(MetricsError::Field { field, expected, found: value.to_string() });
            }
        }
        let size = force_rms_n * velocity_rms_m_s;
        if !(net_w.abs() <= (1.0 + ROUNDING) * size) {
            let expected = format!("a covariance of force and velocity within ±{size} W");
            return Err(MetricsError::Field { field: "net_w", expected, found: net_w.to_string() });
        }
        if size == 0.0 {
            return Ok(ActuatorPower { net_w: 0.0, absolute_w: 0.0, given_w: 0.0 });
        }
        let rho = (net_w / size).clamp(-1.0, 1.0);
        let root = ((1.0 - rho) * (1.0 + rho)).sqrt();
        Ok(ActuatorPower {
            net_w,
            absolute_w: 2.0 * size / PI * (root + rho * rho.asin()),
            given_w: size / PI * (root + rho * (FRAC_PI_2 + rho.asin())),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn a_million_draws_have_the_powers_of_the_formula() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(2631);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let (sf, sv, draws) = (800.0, 0.25, 1_000_000);
        for rho in [-0.95, -0.4, 0.0, 0.3, 0.8] {
            let (mut net, mut absolute, mut given) = (0.0, 0.0, 0.0);
            for _ in 0..draws {
                let (a, b) = (normal(), normal());
                let p = sf * a * sv * (rho * a + f64::sqrt(1.0 - rho * rho) * b);
                net += p;
                absolute += p.abs();
                given += p.max(0.0);
            }
            let said = ActuatorPower::gaussian(sf, sv, rho * sf * sv).unwrap();
            let pairs = [(net, said.net_w), (absolute, said.absolute_w), (given, said.given_w)];
            for (sum, formula) in pairs {
                // the product's standard deviation is √(1 + ρ²) σ_Fσ_v at most: four of its mean's are 1.2 W of 200
                assert!((sum / f64::from(draws) - formula).abs() < 1.2, "ρ {rho}: {} {formula}", sum / 1e6);
            }
        }
    }

    #[test]
    fn the_parts_belong_together_and_contradictions_are_refused() {
        for rho in [-1.0, -0.5, 0.0, 0.5, 1.0] {
            let p = ActuatorPower::gaussian(3.0, 2.0, 6.0 * rho).unwrap();
            assert!((2.0 * p.given_w - p.absolute_w - p.net_w).abs() < 1e-12, "{p:?}");
            assert!(p.given_w >= -1e-15 && p.absolute_w >= p.net_w.abs() - 1e-12);
        }
        assert!(ActuatorPower::gaussian(3.0, 2.0, 6.1).is_err());
        assert!(ActuatorPower::gaussian(-3.0, 2.0, 0.0).is_err());
        assert_eq!(ActuatorPower::gaussian(0.0, 2.0, 0.0).unwrap().absolute_w, 0.0);
    }
}
