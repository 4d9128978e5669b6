//! Equations of §4.2–4.3 as identities of exact rational functions, at table 4.1 and for a parameter Q of degree 3.

use super::ReproduceError;
use super::context::{BOTH, Context, DAMPED, OVERDAMPED, TRAVEL};
use super::item::Sheet;
use crate::lti::{Polynomial, Rational, RationalFunction, decimal, to_f64};
use crate::synthesis::achievable::{
    ByTravelAlone, Measurement, QuarterCar, QuarterCarNumbers, Response, Youla, by_travel_alone,
    log_integral, unimodular,
};

/// Rounding of a quadrature beside ω₂, which is its scale.
const QUADRATURE: (f64, &str) = (1e-5, "by quadrature");

/// A stable parameter, no better than others: (s³ + 90s² − 700s + 4000)/((s + 10)(s² + 20s + 500)).
pub(super) fn parameter() -> Result<RationalFunction, ReproduceError> {
    let d = &Polynomial::integers(&[10, 1]) * &Polynomial::integers(&[500, 20, 1]);
    Ok(RationalFunction::new(Polynomial::integers(&[4000, -700, 90, 1]), d)?)
}

/// Degree of the numerator of a − b, and so 0 where both are the same and above where not.
fn apart(a: &RationalFunction, b: &RationalFunction) -> Rational {
    let difference = a - b;
    if difference.is_zero() {
        return Rational::from_integer(0.into());
    }
    Rational::from_integer((difference.numerator().degree() + 1).into())
}

fn identity(sheet: &mut Sheet, what: &str, printed: &RationalFunction, derived: &RationalFunction) {
    let none = Rational::from_integer(0.into());
    let found = apart(printed, derived);
    sheet
        .exact(format!("{what}: printed less derived"), &none, &found)
        .noted("0 as exact rational functions");
}

fn product(factors: &[&RationalFunction]) -> RationalFunction {
    factors.iter().fold(RationalFunction::one(), |p, x| &p * x)
}

/// (4.7): Δ coefficient by coefficient.
pub(super) fn delta(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let n = &context.numbers;
    let [ms, mu, ks, cs, kt, ct] = [n.ms, n.mu, n.ks, n.cs, n.kt, DAMPED].map(decimal);
    let (ms, mu, ks, cs, kt, ct) = (ms?, mu?, ks?, cs?, kt?, ct?);
    let whole = &ms + &mu;
    let printed = [
        &ks * &kt,
        &cs * &kt + &ct * &ks,
        &whole * &ks + &ms * &kt + &cs * &ct,
        &whole * &cs + &ms * &ct,
        &ms * &mu,
    ];
    let found = context.car(DAMPED)?.delta();
    for (k, value) in printed.iter().enumerate() {
        sheet.exact(format!("Δ(s): coefficient of s^{k}, c_t = 98"), value, &found.coefficient(k));
    }
    Ok(())
}

/// (4.20): H₁ by Q̂ where y₂ is measured.
pub(super) fn travel_measured(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let car = context.car(DAMPED)?;
    let (f, q) = (RationalFunction::polynomial, parameter()?);
    let (delta, s2) = (f(car.delta()), f(Polynomial::power_of_s(2)));
    let (l, s, p2) = (f(car.tire()), f(car.suspension()), f(car.wheel_on_tire()));
    let inner = &s + &product(&[&q, &s2, &p2]).over(&delta)?.scaled(&decimal(context.numbers.ms)?);
    let printed = product(&[&s2, &l, &inner]).over(&delta)?;
    identity(sheet, "H₁", &printed, &Youla::new(&car, &TRAVEL)?.response(Response::Acceleration, &q));
    Ok(())
}

/// (4.37) and (4.38): H₁ and H₂ by q̃ where both are measured.
pub(super) fn both_measured(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let car = context.car(DAMPED)?;
    let (f, q) = (RationalFunction::polynomial, parameter()?);
    let (delta, s2) = (f(car.delta()), f(Polynomial::power_of_s(2)));
    let (l, s) = (f(car.tire()), f(car.suspension()));
    let both = Youla::new(&car, &BOTH)?;
    let of_wheel = product(&[&q, &s2, &f(car.wheel_on_tire())]).over(&delta)?;
    let inner = &RationalFunction::one() - &of_wheel;
    let printed = product(&[&s2, &l, &s, &inner]).over(&delta)?;
    identity(sheet, "(4.37), H₁", &printed, &both.response(Response::Acceleration, &q));
    let of_whole = product(&[&q, &f(car.whole_on_tire()), &s]).over(&delta)?;
    let inner = &RationalFunction::constant(decimal(context.numbers.ms)?) + &of_whole;
    let printed = -&product(&[&s2, &l, &inner]).over(&delta)?;
    identity(sheet, "(4.38), H₂", &printed, &both.response(Response::Travel, &q));
    Ok(())
}

/// (4.34), (4.35): the unimodular matrix of the two measurements.
pub(super) fn unimodular_matrix(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let car = context.car(DAMPED)?;
    let delta = RationalFunction::polynomial(car.delta());
    let row = BOTH.map(|m| (&car.road_to(m) * &delta).numerator().clone());
    let found = unimodular(&row);
    let f = |p: &Polynomial| RationalFunction::polynomial(p.clone());
    let share = car.suspension().scaled(&decimal(context.numbers.ms)?.recip());
    for (what, printed, derived) in [
        ("Π₁₁ = 1", Polynomial::one(), &found.pi[0][0]),
        ("Π₁₂ = 0", Polynomial::zero(), &found.pi[0][1]),
        ("Π₂₁ = (c_s s + k_s)/m_s", share, &found.pi[1][0]),
        ("Π₂₂ = 1", Polynomial::one(), &found.pi[1][1]),
        ("g = −m_s s²(c_t s + k_t)", row[1].clone(), &found.g),
    ] {
        identity(sheet, what, &f(&printed), &f(derived));
    }
    Ok(())
}

/// (4.29)–(4.31): one response gives the others.
pub(super) fn trade_offs(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let q = parameter()?;
    for ct in [0.0, DAMPED, OVERDAMPED] {
        let car = context.car(ct)?;
        let youla = Youla::new(&car, &TRAVEL)?;
        let [h1, h2, h3] = Response::ALL.map(|r| youla.response(r, &q));
        identity(sheet, &format!("(4.29), H₂ of H₁, c_t = {ct}"), &car.travel_of_acceleration(&h1)?, &h2);
        identity(sheet, &format!("(4.30), H₃ of H₁, c_t = {ct}"), &car.tire_of_acceleration(&h1)?, &h3);
        identity(sheet, &format!("(4.31), H₃ of H₂, c_t = {ct}"), &car.tire_of_travel(&h2)?, &h3);
    }
    Ok(())
}

/// (4.41) at infinity: what y₂ alone cannot do with tire damping.
pub(super) fn gap_at_infinity(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let (car, q) = (context.car(DAMPED)?, parameter()?);
    let first = |f: &RationalFunction| -> Result<f64, ReproduceError> {
        Ok(f.at_infinity(1)?.first().map_or(0.0, to_f64))
    };
    let n = &context.numbers;
    let printed = n.cs * DAMPED * first(&q)? / (n.ms * n.ms * n.mu);
    let alone =
        first(&Youla::new(&car, &TRAVEL)?.response(Response::Acceleration, &RationalFunction::zero()))?;
    let both = first(&Youla::new(&car, &BOTH)?.response(Response::Acceleration, &q))?;
    let rounding = (1e-12, "but for rounding");
    sheet.within("H₁(∞) − H̄₁(∞) less c_s c_t q̃(∞)/(m_s² m_u)", "0", alone - both - printed, rounding);
    let ByTravelAlone::Impossible { gap } = by_travel_alone(&car, &q, 1.0)? else {
        return Err(ReproduceError::unexpected("(4.41)", "a gap that no controller of y₂ closes", "none"));
    };
    sheet.within("the library's gap less the printed one", "0", gap - printed.abs(), rounding);
    Ok(())
}

/// After proposition 4.3.13, and the remark on cars without springs and dampers.
pub(super) fn section(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let car = context.car(0.0)?;
    let passive = log_integral(&car, &car.passive(Response::TireDeflection))?;
    sheet.within("∫ ln|T_z₃w| dω, passive, c_t = 0, rad/s", "0", passive.quadrature, QUADRATURE);
    let bare = QuarterCarNumbers { ks: 0.0, cs: 0.0, ..context.numbers };
    let refused = Youla::new(&QuarterCar::new(&bare)?, &[Measurement::Acceleration]).is_err();
    sheet
        .count("c_s = c_t = k_s = 0 cannot be parametrised by y₁: refused", 1, usize::from(refused))
        .noted("1: refused");
    Ok(())
}
