//! What every stabilising controller must leave as it is: the complete interpolation constraints of a response.

mod text;

use super::{AchievableError, Response, Youla};
use crate::lti::rational::series::factorial;
use crate::lti::{Polynomial, Rational, RationalFunction};
use num_traits::{One, Zero};

/// One condition on a response H.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Constraint {
    /// H⁽ᵏ⁾(0) = value.
    AtZero {
        /// k.
        derivative: usize,
        /// What it has to be.
        value: Rational,
    },
    /// The coefficient of s⁻ᵏ at infinity is value.
    AtInfinity {
        /// k.
        power: usize,
        /// What it has to be.
        value: Rational,
    },
    /// H(±jω) = re ± jω·im.
    OnAxis {
        /// ω², (rad/s)².
        omega_squared: Rational,
        /// Real part.
        re: Rational,
        /// Imaginary part over ω.
        im: Rational,
    },
    /// The coefficient of s⁻ᵏ at infinity is not value: there K would be improper (the thesis omits this).
    NotAtInfinity {
        /// k.
        power: usize,
        /// What it must not be.
        value: Rational,
    },
}

/// The complete list for one response: H = T_zw of some stabilising controller if and only if H is in RH∞ and all hold.
#[derive(Debug, Clone)]
pub struct Constraints {
    /// Of which response.
    pub response: Response,
    /// One by one.
    pub list: Vec<Constraint>,
    youla: Youla,
    base: RationalFunction,
    slope: RationalFunction,
}

/// A constraint that a function breaks.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Violation {
    /// Which one.
    pub constraint: Constraint,
    /// What was found instead: the value, or re and im/ω.
    pub found: (Rational, Rational),
}

/// Why a function is no closed-loop response.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum NotAchievable {
    /// It is not in RH∞.
    NotStable {
        /// Whether it is proper.
        proper: bool,
        /// The denominator.
        denominator: Polynomial,
    },
    /// It breaks constraints.
    Violated(Vec<Violation>),
}

/// That a function is achievable: the controller that does it.
#[derive(Debug, Clone, PartialEq)]
pub struct Proof {
    /// The parameter of [`Youla`].
    pub q: RationalFunction,
    /// Q̂, one a measurement (the free ones 0).
    pub q_hat: Vec<RationalFunction>,
    /// K, one entry a measurement: u = +K y.
    pub controller: Vec<RationalFunction>,
    /// H₁, H₂, H₃ of that controller, the function asked for among them.
    pub responses: [RationalFunction; 3],
}

impl Youla {
    /// The complete interpolation constraints of a response, from T_k = base + slope·q: values and derivatives of base at
    /// the zeros of slope in the closed right half plane and at infinity. Propositions 4.3.1–4.3.12 for those cars and
    /// measurements, with the condition that K is proper, which they omit.
    ///
    /// # Errors
    /// Zeros where no constraint is known (none for the cars and measurements of the thesis).
    pub fn constraints(&self, response: Response) -> Result<Constraints, AchievableError> {
        let (base, slope) = self.affine(response);
        let at_zero = slope.numerator().zeros_at_origin();
        let power = slope.relative_degree().unwrap_or(0).max(0) as usize;
        let mut list = Vec::new();
        for (k, value) in base.at_infinity(power)?.into_iter().enumerate() {
            list.push(Constraint::AtInfinity { power: k, value });
        }
        for (k, t) in base.taylor(at_zero)?.into_iter().enumerate() {
            list.push(Constraint::AtZero { derivative: k, value: t * factorial(k) });
        }
        let mut rest = slope.numerator().exactly_over(&Polynomial::power_of_s(at_zero))?;
        for omega_squared in [self.car().omega1_squared(), self.car().omega2_squared()] {
            let factor = Polynomial::new(&[omega_squared.clone(), Rational::zero(), Rational::one()]);
            if let Ok(without) = rest.exactly_over(&factor) {
                rest = without;
                let (re, im) = base.on_axis(&omega_squared)?;
                list.push(Constraint::OnAxis { omega_squared, re, im });
            }
        }
        if !rest.is_hurwitz() {
            return Err(AchievableError::OtherZeros { factor: rest.to_string() });
        }
        if let Some(q) = self.ill_posed_q()? {
            let coefficient = |f: &RationalFunction| -> Result<Rational, AchievableError> {
                Ok(f.at_infinity(power + 1)?.pop().unwrap_or_else(Rational::zero))
            };
            let value = coefficient(&base)? + coefficient(&slope)? * q;
            list.push(Constraint::NotAtInfinity { power, value });
        }
        Ok(Constraints { response, list, youla: self.clone(), base, slope })
    }
}

impl Constraints {
    /// Is H the closed-loop response of some stabilising controller? The controller, or each constraint that H breaks.
    ///
    /// q = (H − base)/slope is in RH∞ if all hold, and K follows; it is put back and must give H exactly.
    ///
    /// # Errors
    /// None for constraints that could be built.
    pub fn check(&self, h: &RationalFunction) -> Result<Result<Proof, NotAchievable>, AchievableError> {
        if !h.is_stable() {
            let (proper, denominator) = (h.is_proper(), h.denominator().clone());
            return Ok(Err(NotAchievable::NotStable { proper, denominator }));
        }
        let mut broken = Vec::new();
        for constraint in &self.list {
            let found = constraint.measured(h)?;
            if !constraint.holds(&found) {
                broken.push(Violation { constraint: constraint.clone(), found });
            }
        }
        if !broken.is_empty() {
            return Ok(Err(NotAchievable::Violated(broken)));
        }
        let q = (h - &self.base).over(&self.slope)?;
        if !q.is_stable() {
            return Err(AchievableError::NotStable {
                what: "q of constraints that hold",
                found: q.to_string(),
            });
        }
        let free = vec![RationalFunction::zero(); self.youla.measurements().len() - 1];
        let controller = self.youla.controller(&q, &free)?;
        let responses = Response::ALL.map(|r| self.youla.response(r, &q));
        if responses[self.response as usize] != *h {
            return Err(AchievableError::NotStable { what: "the response put back", found: h.to_string() });
        }
        let q_hat = self.youla.q_hat(&q, &free)?;
        Ok(Ok(Proof { q, q_hat, controller, responses }))
    }
}

impl Constraint {
    /// The value of H that this constraint is about.
    ///
    /// # Errors
    /// A pole there.
    pub fn measured(&self, h: &RationalFunction) -> Result<(Rational, Rational), AchievableError> {
        let last = |v: Vec<Rational>| (v.into_iter().last().unwrap_or_else(Rational::zero), Rational::zero());
        Ok(match self {
            Constraint::AtZero { derivative: k, .. } => {
                let (t, zero) = last(h.taylor(k + 1)?);
                (t * factorial(*k), zero)
            }
            Constraint::AtInfinity { power, .. } | Constraint::NotAtInfinity { power, .. } => {
                last(h.at_infinity(power + 1)?)
            }
            Constraint::OnAxis { omega_squared, .. } => h.on_axis(omega_squared)?,
        })
    }

    fn holds(&self, (re, im): &(Rational, Rational)) -> bool {
        match self {
            Constraint::AtZero { value, .. } | Constraint::AtInfinity { value, .. } => re == value,
            Constraint::OnAxis { re: a, im: b, .. } => re == a && im == b,
            Constraint::NotAtInfinity { value, .. } => re != value,
        }
    }
}
