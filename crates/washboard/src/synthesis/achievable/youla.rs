//! All stabilising controllers of a quarter car: T_zw affine in a stable, proper q.

use super::{AchievableError, Measurement, QuarterCar, Response};
use crate::lti::{Polynomial, Rational, RationalFunction, to_f64};
use num_traits::{One, Zero};

/// The parametrisation of (4.13)–(4.23) and (4.33)–(4.40), exactly.
///
/// T_k = G₁₁ + G₁₂ g Q̂_g, with g = G₂₁ of the leading measurement and Q̂_g = a + b q, q any function in RH∞:
///
/// | car | measurements | a | b | q |
/// |---|---|---|---|---|
/// | Δ Hurwitz | one | 0 | 1 | Q̂ of (4.20) |
/// | Δ Hurwitz | several | 0 | 1 | q̃ of (4.36): Q̂_g + Σ Q̂ⱼ G₂₁ⱼ/g |
/// | Δ not Hurwitz | one | Y M | −M² | Q of (4.15), G₂₂ = N/M, M X − N Y = 1 |
///
/// K = Q̂(1 + G₂₂Q̂)⁻¹, u = +K y.
#[derive(Debug, Clone)]
pub struct Youla {
    car: QuarterCar,
    measurements: Vec<Measurement>,
    leading: usize,
    offset: RationalFunction,
    factor: RationalFunction,
}

impl Youla {
    /// Of a car and what is measured on it.
    ///
    /// # Errors
    /// No measurement, one that is not proper, one that does not see an unstable mode, several of a car that is not
    /// stable, several of which none leads.
    pub fn new(car: &QuarterCar, measurements: &[Measurement]) -> Result<Self, AchievableError> {
        let found = || measurements.iter().map(|m| m.name()).collect::<Vec<_>>().join(", ");
        let twice = (0..measurements.len()).any(|i| measurements[..i].contains(&measurements[i]));
        if measurements.is_empty() || twice {
            return Err(AchievableError::Measurements { found: format!("[{}]", found()) });
        }
        for m in measurements {
            if !car.road_to(*m).is_proper() {
                return Err(AchievableError::ImproperMeasurement { measurement: m.name() });
            }
        }
        let (zero, one) = (RationalFunction::zero(), RationalFunction::one());
        let known = |leading, offset, factor| {
            Ok(Youla { car: car.clone(), measurements: measurements.to_vec(), leading, offset, factor })
        };
        if car.is_stable() {
            // the leading measurement: all others' responses to the road are stable multiples of its own
            for (i, m) in measurements.iter().enumerate() {
                let g = car.road_to(*m);
                let mut leads = true;
                for other in measurements {
                    leads &= car.road_to(*other).over(&g)?.is_stable();
                }
                if leads {
                    return known(i, zero, one);
                }
            }
            return Err(AchievableError::NoLeadingMeasurement { found: found() });
        }
        let [only] = measurements else {
            return Err(AchievableError::NotHurwitz { delta: car.delta().to_string() });
        };
        let (m, y) = factors(car, *only)?;
        known(0, &y * &m, -&(&m * &m))
    }

    /// The car.
    #[must_use]
    pub fn car(&self) -> &QuarterCar {
        &self.car
    }

    /// What is measured.
    #[must_use]
    pub fn measurements(&self) -> &[Measurement] {
        &self.measurements
    }

    /// The index of the measurement that q belongs to.
    #[must_use]
    pub fn leading(&self) -> usize {
        self.leading
    }

    /// T_k for q = 0, and what q is multiplied by: T_k = base + slope·q.
    #[must_use]
    pub fn affine(&self, response: Response) -> (RationalFunction, RationalFunction) {
        let reach = &self.car.forced(response) * &self.car.road_to(self.measurements[self.leading]);
        (&self.car.passive(response) + &(&reach * &self.offset), &reach * &self.factor)
    }

    /// T_k of a q, (4.20)–(4.22), (4.37)–(4.39).
    #[must_use]
    pub fn response(&self, response: Response, q: &RationalFunction) -> RationalFunction {
        let (base, slope) = self.affine(response);
        &base + &(&slope * q)
    }

    /// Q̂, one a measurement, from q and the free Q̂ⱼ of the other measurements (in their order; they do not change T).
    ///
    /// # Errors
    /// A wrong number of free ones; functions that are not in RH∞.
    pub fn q_hat(
        &self,
        q: &RationalFunction,
        free: &[RationalFunction],
    ) -> Result<Vec<RationalFunction>, AchievableError> {
        let (what, expected, found) = ("free Q", self.measurements.len() - 1, free.len());
        if expected != found {
            return Err(AchievableError::Count { what, expected, found });
        }
        for f in free.iter().chain([q]) {
            if !f.is_stable() {
                return Err(AchievableError::NotStable { what: "Q", found: f.to_string() });
            }
        }
        let g = self.car.road_to(self.measurements[self.leading]);
        let mut leading = &self.offset + &(&self.factor * q);
        let mut all = Vec::new();
        let mut rest = free.iter();
        for (i, m) in self.measurements.iter().enumerate() {
            if i == self.leading {
                continue;
            }
            let f = rest.next().cloned().unwrap_or_else(RationalFunction::zero);
            // eq. (4.36)
            leading = &leading - &(&f * &self.car.road_to(*m).over(&g)?);
            all.push(f);
        }
        all.insert(self.leading, leading);
        Ok(all)
    }

    /// K = Q̂(1 + G₂₂Q̂)⁻¹, one entry a measurement: (4.23), (4.40).
    ///
    /// # Errors
    /// As [`Youla::q_hat`]; a loop that is not well posed.
    pub fn controller(
        &self,
        q: &RationalFunction,
        free: &[RationalFunction],
    ) -> Result<Vec<RationalFunction>, AchievableError> {
        let q_hat = self.q_hat(q, free)?;
        let mut difference = RationalFunction::one();
        for (q, m) in q_hat.iter().zip(&self.measurements) {
            difference = &difference + &(&self.car.force_to(*m) * q);
        }
        if difference.relative_degree() != Some(0) {
            return Err(AchievableError::ImproperController);
        }
        q_hat.iter().map(|q| Ok(q.over(&difference)?)).collect()
    }

    /// q of a controller, one entry a measurement (and the free Q̂ⱼ): the way back.
    ///
    /// # Errors
    /// A wrong number of entries; a controller that does not stabilise the car, or a loop that is not well posed.
    pub fn q_of(
        &self,
        controller: &[RationalFunction],
    ) -> Result<(RationalFunction, Vec<RationalFunction>), AchievableError> {
        let (what, expected, found) = ("controller entries", self.measurements.len(), controller.len());
        if expected != found {
            return Err(AchievableError::Count { what, expected, found });
        }
        // Q̂ = K(1 − G₂₂K)⁻¹
        let mut difference = RationalFunction::one();
        for (k, m) in controller.iter().zip(&self.measurements) {
            difference = &difference - &(&self.car.force_to(*m) * k);
        }
        let g = self.car.road_to(self.measurements[self.leading]);
        let mut q = -&self.offset;
        let mut free = Vec::new();
        for (i, (k, m)) in controller.iter().zip(&self.measurements).enumerate() {
            let q_hat = k.over(&difference)?;
            q = &q + &(&q_hat * &self.car.road_to(*m).over(&g)?);
            if i != self.leading {
                free.push(q_hat);
            }
        }
        let q = q.over(&self.factor)?;
        if let Some(f) = free.iter().chain([&q]).find(|f| !f.is_stable()) {
            return Err(AchievableError::NotStable { what: "Q of the controller", found: f.to_string() });
        }
        Ok((q, free))
    }

    /// The q(∞) at which K would not be proper, where there is one: 1 + G₂₂Q̂ = 0 at infinity.
    ///
    /// # Errors
    /// None for a parametrisation that could be built.
    pub fn ill_posed_q(&self) -> Result<Option<Rational>, AchievableError> {
        let first = |f: &RationalFunction| -> Result<Rational, AchievableError> {
            Ok(f.at_infinity(1)?.into_iter().next().unwrap_or_else(Rational::zero))
        };
        let leading = self.measurements[self.leading];
        let (through, g) = (first(&self.car.force_to(leading))?, self.car.road_to(leading));
        let (a, b) = (first(&self.offset)?, first(&self.factor)?);
        if through.is_zero() || b.is_zero() {
            return Ok(None);
        }
        for (i, m) in self.measurements.iter().enumerate().filter(|(i, _)| *i != self.leading) {
            // a free Q̂ᵢ that moves 1 + G₂₂Q̂ at infinity avoids it
            let share = first(&self.car.road_to(*m).over(&g)?)?;
            let moved = first(&self.car.force_to(self.measurements[i]))? - share * &through;
            if !moved.is_zero() {
                return Ok(None);
            }
        }
        Ok(Some((-through.recip() - a) / b))
    }
}

/// M and Y of (4.13)–(4.14) for G₂₂ = n/d that is not stable: M = d/h, N = n/h, Y = y/h, X = x/h with
/// d x − n y = h², h = (s + ω)ʳ, r = deg d, deg y < r.
fn factors(
    car: &QuarterCar,
    measurement: Measurement,
) -> Result<(RationalFunction, RationalFunction), AchievableError> {
    let g22 = car.force_to(measurement);
    let (n, d) = (g22.numerator().clone(), g22.denominator().clone());
    // modes that the measurement or the force does not see must be stable: G and G₂₂ share the unstable ones
    let unseen = car.delta().exactly_over(&d)?;
    if !unseen.is_hurwitz() {
        let roots = unseen.roots()?;
        let omega_rad_s = roots.iter().filter(|r| !(r.re < 0.0)).map(|r| r.norm()).collect();
        return Err(AchievableError::NotParametrisable { measurement: measurement.name(), omega_rad_s });
    }
    let rate = Rational::from_integer((to_f64(&car.omega1_squared()).sqrt().ceil() as i64).into());
    let shift = Polynomial::new(&[rate, Rational::one()]);
    let h = (0..d.degree()).fold(Polynomial::one(), |h, _| &h * &shift);
    let inverse = inverse_modulo(&n, &d)?;
    let (_, y) = (&-&(&h * &h) * &inverse).divided_by(&d)?;
    Ok((RationalFunction::new(d, h.clone())?, RationalFunction::new(y, h)?))
}

/// p⁻¹ modulo d, for coprime p and d, by Euclid's extended algorithm.
fn inverse_modulo(p: &Polynomial, d: &Polynomial) -> Result<Polynomial, AchievableError> {
    let (mut a, mut b) = (d.clone(), p.divided_by(d)?.1);
    let (mut u, mut v) = (Polynomial::zero(), Polynomial::one());
    while b.degree() > 0 {
        let (q, r) = a.divided_by(&b)?;
        (u, v) = (v.clone(), &u - &(&q * &v));
        (a, b) = (b, r);
    }
    Ok(v.scaled(&b.leading().recip()))
}
