//! One response gives the others: (4.29)–(4.31), whatever the controller.

use super::QuarterCar;
use super::car::s2;
use crate::lti::{Polynomial, RationalError, RationalFunction};

impl QuarterCar {
    /// H₂ of H₁, (4.29):
    ///
    /// H₂ = −(c_t s + k_t)/(m_u s² + c_t s + k_t) + ((m_s + m_u)s² + c_t s + k_t)/(s²(m_u s² + c_t s + k_t))·H₁.
    ///
    /// # Errors
    /// None: its denominators are not 0.
    pub fn travel_of_acceleration(&self, h1: &RationalFunction) -> Result<RationalFunction, RationalError> {
        let wheel = self.wheel_on_tire();
        let alone = RationalFunction::new(-&self.tire(), wheel.clone())?;
        let share = RationalFunction::new(self.whole_on_tire(), &s2() * &wheel)?;
        Ok(&alone + &(&share * h1))
    }

    /// H₃ of H₁, (4.30): H₃ = −(m_u s² + m_s H₁)/(m_u s² + c_t s + k_t).
    ///
    /// # Errors
    /// None: its denominator is not 0.
    pub fn tire_of_acceleration(&self, h1: &RationalFunction) -> Result<RationalFunction, RationalError> {
        let own = RationalFunction::polynomial(Polynomial::monomial(self.mu.clone(), 2));
        let sum = -&(&own + &h1.scaled(&self.ms));
        sum.over(&RationalFunction::polynomial(self.wheel_on_tire()))
    }

    /// H₃ of H₂, (4.31): H₃ = −((m_s + m_u)s² + m_s s² H₂)/((m_s + m_u)s² + c_t s + k_t).
    ///
    /// # Errors
    /// None: its denominator is not 0.
    pub fn tire_of_travel(&self, h2: &RationalFunction) -> Result<RationalFunction, RationalError> {
        let own = RationalFunction::polynomial(Polynomial::monomial(&self.ms + &self.mu, 2));
        let sum = -&(&own + &(&RationalFunction::polynomial(self.ms_s2()) * h2));
        sum.over(&RationalFunction::polynomial(self.whole_on_tire()))
    }
}
