//! The coherence of parallel tracks.

use super::RoadError;
use std::f64::consts::TAU;

/// How the roughness of one track is related to that of another, and of one axle to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Coherence {
    /// Bogsjö's exponential model Γ = e^{−μ W |ω|/(2πV)} of tracks W apart; rear wheels repeat the front's input.
    ///
    /// Source: De Filippis et al., eq. (61), made even in ω.
    Bogsjo {
        /// μ ≥ 0, dimensionless: the decay per wavelength of distance.
        mu: f64,
    },
    /// All tracks alike (Γ = 1); rear wheels repeat the front's input.
    Full,
    /// Left and right unrelated (Γ = 0 across tracks); rear wheels repeat the front's input.
    None,
    /// Every wheel on a road of its own: neither coherence nor delay.
    Independent,
}

impl Coherence {
    /// Bogsjö's model.
    ///
    /// # Errors
    /// A μ that is negative or not finite.
    pub fn bogsjo(mu: f64) -> Result<Self, RoadError> {
        if mu.is_finite() && mu >= 0.0 {
            Ok(Coherence::Bogsjo { mu })
        } else {
            Err(RoadError::Field { field: "mu", expected: "a number ≥ 0", found: mu.to_string() })
        }
    }

    /// Γ(ω) of two tracks `distance_m` apart at a speed; an even function of ω with values in [0, 1].
    ///
    /// For [`Coherence::None`] and [`Coherence::Independent`] that is 1 at distance 0 and 0 elsewhere.
    #[must_use]
    pub fn gamma(&self, distance_m: f64, omega_rad_s: f64, speed_m_s: f64) -> f64 {
        match self {
            Coherence::Bogsjo { mu } => (-mu * distance_m * omega_rad_s.abs() / (TAU * speed_m_s)).exp(),
            Coherence::Full => 1.0,
            Coherence::None | Coherence::Independent => f64::from(u8::from(distance_m == 0.0)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bogsjo_halves_where_its_exponent_says_and_is_even() {
        let c = Coherence::bogsjo(3.8).unwrap();
        let omega = 2f64.ln() * TAU * 20.0 / (3.8 * 1.49);
        assert!((c.gamma(1.49, omega, 20.0) - 0.5).abs() < 1e-14);
        assert_eq!(c.gamma(1.49, omega, 20.0), c.gamma(1.49, -omega, 20.0));
        assert_eq!(c.gamma(0.0, omega, 20.0), 1.0);
        assert!(Coherence::bogsjo(-1.0).is_err() && Coherence::bogsjo(f64::NAN).is_err());
    }
}
