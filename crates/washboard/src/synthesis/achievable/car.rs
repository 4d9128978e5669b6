//! The quarter car, exactly: its polynomials, its transfer functions and its plant.

use super::AchievableError;
use crate::lti::{Polynomial, Rational, RationalFunction, decimal, to_f64};
use num_traits::{One, Signed};

/// The numbers of a quarter car, SI; each is taken as the decimal that it is written as.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct QuarterCarNumbers {
    /// Sprung mass m_s, kg.
    pub ms: f64,
    /// Unsprung mass m_u, kg.
    pub mu: f64,
    /// Suspension stiffness k_s, N/m.
    pub ks: f64,
    /// Suspension damping c_s, N s/m.
    pub cs: f64,
    /// Tire stiffness k_t, N/m.
    pub kt: f64,
    /// Tire damping c_t, N s/m.
    pub ct: f64,
}

/// What is to be small, H₁ … H₃ from the road's height.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Response {
    /// z₁ = ẍ₁.
    Acceleration,
    /// z₂ = x₁ − x₂.
    Travel,
    /// z₃ = x₂ − w.
    TireDeflection,
}

/// What a controller may see.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measurement {
    /// y₁ = ẍ₁.
    Acceleration,
    /// y₂ = x₁ − x₂.
    Travel,
    /// ẍ₂.
    UnsprungAcceleration,
    /// x₂, from an inertial frame.
    UnsprungDisplacement,
    /// x₂ − w.
    TireDeflection,
}

impl Response {
    /// All three, in order.
    pub const ALL: [Response; 3] = [Response::Acceleration, Response::Travel, Response::TireDeflection];

    /// `H1`, `H2` or `H3`.
    #[must_use]
    pub fn symbol(self) -> &'static str {
        ["H1", "H2", "H3"][self as usize]
    }

    /// In words.
    #[must_use]
    pub fn name(self) -> &'static str {
        ["acceleration", "travel", "tire"][self as usize]
    }
}

impl Measurement {
    /// In words.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Measurement::Acceleration => "sprung acceleration",
            Measurement::Travel => "suspension travel",
            Measurement::UnsprungAcceleration => "unsprung acceleration",
            Measurement::UnsprungDisplacement => "unsprung displacement",
            Measurement::TireDeflection => "tire deflection",
        }
    }
}

/// The quarter car of (4.1) in exact numbers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct QuarterCar {
    /// m_s.
    pub(super) ms: Rational,
    pub(super) mu: Rational,
    pub(super) ks: Rational,
    pub(super) cs: Rational,
    pub(super) kt: Rational,
    pub(super) ct: Rational,
}

impl QuarterCar {
    /// From decimals.
    ///
    /// # Errors
    /// Masses or a tire stiffness that are not positive; other numbers that are negative or not finite.
    pub fn new(numbers: &QuarterCarNumbers) -> Result<Self, AchievableError> {
        let n = numbers;
        for (field, found) in [("ms", n.ms), ("mu", n.mu), ("kt", n.kt)] {
            if !(found > 0.0 && found.is_finite()) {
                return Err(AchievableError::Number { field, expected: "a positive, finite number", found });
            }
        }
        for (field, found) in [("ks", n.ks), ("cs", n.cs), ("ct", n.ct)] {
            if !(found >= 0.0 && found.is_finite()) {
                return Err(AchievableError::Number { field, expected: "a finite number ≥ 0", found });
            }
        }
        Ok(QuarterCar {
            ms: decimal(n.ms)?,
            mu: decimal(n.mu)?,
            ks: decimal(n.ks)?,
            cs: decimal(n.cs)?,
            kt: decimal(n.kt)?,
            ct: decimal(n.ct)?,
        })
    }

    /// The same car on a tire of another damping.
    ///
    /// # Errors
    /// A negative one.
    pub fn with_tire_damping(&self, ct: Rational) -> Result<Self, AchievableError> {
        if ct.is_negative() {
            let (field, expected, found) = ("ct", "a finite number ≥ 0", to_f64(&ct));
            return Err(AchievableError::Number { field, expected, found });
        }
        Ok(QuarterCar { ct, ..self.clone() })
    }

    /// The tire damping c_t.
    #[must_use]
    pub fn tire_damping(&self) -> &Rational {
        &self.ct
    }

    /// c_s s + k_s.
    #[must_use]
    pub fn suspension(&self) -> Polynomial {
        Polynomial::new(&[self.ks.clone(), self.cs.clone()])
    }

    /// c_t s + k_t.
    #[must_use]
    pub fn tire(&self) -> Polynomial {
        Polynomial::new(&[self.kt.clone(), self.ct.clone()])
    }

    /// (m_s + m_u)s² + c_t s + k_t: zeros from the force to the travel, ±jω₁ for c_t = 0.
    #[must_use]
    pub fn whole_on_tire(&self) -> Polynomial {
        Polynomial::new(&[self.kt.clone(), self.ct.clone(), &self.ms + &self.mu])
    }

    /// m_u s² + c_t s + k_t: zeros from the force to the acceleration, ±jω₂ for c_t = 0.
    #[must_use]
    pub fn wheel_on_tire(&self) -> Polynomial {
        Polynomial::new(&[self.kt.clone(), self.ct.clone(), self.mu.clone()])
    }

    /// Δ(s) of (4.7).
    #[must_use]
    pub fn delta(&self) -> Polynomial {
        // m_s s²(m_u s² + c_t s + k_t) + (c_s s + k_s)((m_s + m_u)s² + c_t s + k_t)
        &(&self.ms_s2() * &self.wheel_on_tire()) + &(&self.suspension() * &self.whole_on_tire())
    }

    /// ω₁² = k_t/(m_s + m_u), (4.32).
    #[must_use]
    pub fn omega1_squared(&self) -> Rational {
        &self.kt / (&self.ms + &self.mu)
    }

    /// ω₂² = k_t/m_u, (4.32).
    #[must_use]
    pub fn omega2_squared(&self) -> Rational {
        &self.kt / &self.mu
    }

    /// ω₁ and ω₂, rad/s.
    #[must_use]
    pub fn invariant_omegas_rad_s(&self) -> (f64, f64) {
        (to_f64(&self.omega1_squared()).sqrt(), to_f64(&self.omega2_squared()).sqrt())
    }

    /// G₁₁ of (4.6): from the road's height, without control.
    #[must_use]
    pub fn passive(&self, response: Response) -> RationalFunction {
        self.over_delta(match response {
            Response::Acceleration => self.road_to_sprung(),
            Response::Travel => -&(&self.ms_s2() * &self.tire()),
            Response::TireDeflection => self.road_to_deflection(),
        })
    }

    /// G₁₂ of (4.6): from the force.
    #[must_use]
    pub fn forced(&self, response: Response) -> RationalFunction {
        self.over_delta(match response {
            Response::Acceleration => -&(&s2() * &self.wheel_on_tire()),
            Response::Travel => -&self.whole_on_tire(),
            Response::TireDeflection => self.ms_s2(),
        })
    }

    /// G₂₁ of (4.10): from the road's height to a measurement.
    #[must_use]
    pub fn road_to(&self, measurement: Measurement) -> RationalFunction {
        self.over_delta(match measurement {
            Measurement::Acceleration => self.road_to_sprung(),
            Measurement::Travel => -&(&self.ms_s2() * &self.tire()),
            Measurement::UnsprungAcceleration => &s2() * &self.road_to_unsprung(),
            Measurement::UnsprungDisplacement => self.road_to_unsprung(),
            Measurement::TireDeflection => self.road_to_deflection(),
        })
    }

    /// G₂₂ of (4.11): from the force to a measurement.
    #[must_use]
    pub fn force_to(&self, measurement: Measurement) -> RationalFunction {
        self.over_delta(match measurement {
            Measurement::Acceleration => -&(&s2() * &self.wheel_on_tire()),
            Measurement::Travel => -&self.whole_on_tire(),
            Measurement::UnsprungAcceleration => &s2() * &self.ms_s2(),
            Measurement::UnsprungDisplacement | Measurement::TireDeflection => self.ms_s2(),
        })
    }

    fn road_to_sprung(&self) -> Polynomial {
        &(&s2() * &self.suspension()) * &self.tire()
    }

    fn road_to_unsprung(&self) -> Polynomial {
        &(&self.ms_s2() + &self.suspension()) * &self.tire()
    }

    fn road_to_deflection(&self) -> Polynomial {
        let whole = &self.ms + &self.mu;
        let inner = &Polynomial::monomial(&self.ms * &self.mu, 2) + &self.suspension().scaled(&whole);
        -&(&s2() * &inner)
    }

    pub(super) fn ms_s2(&self) -> Polynomial {
        Polynomial::monomial(self.ms.clone(), 2)
    }

    pub(super) fn over_delta(&self, numerator: Polynomial) -> RationalFunction {
        // Δ has the leading coefficient m_s m_u > 0
        RationalFunction::new(numerator, self.delta()).unwrap_or_else(|_| RationalFunction::zero())
    }

    /// Whether k_s > 0 and one of the dampers is there, by Routh's test of Δ.
    #[must_use]
    pub fn is_stable(&self) -> bool {
        self.delta().is_hurwitz()
    }
}

pub(super) fn s2() -> Polynomial {
    Polynomial::monomial(Rational::one(), 2)
}
