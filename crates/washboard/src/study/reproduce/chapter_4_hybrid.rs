//! The hybrid design of §4.4: its degrees, what is said of it, figures 4.10–4.12.

use super::ReproduceError;
use super::context::{Context, DAMPED, OVERDAMPED, TRAVEL, frequencies, gains};
use super::item::{Axis, Curve, Relation, Sheet};
use crate::linalg::C64;
use crate::lti::{Polynomial, Rational, RationalFunction, decimal};
use crate::synthesis::achievable::{
    Hybrid, HybridCurve, Measurement, NotAchievable, Psi, QuarterCar, Response, hybrid,
    hybrid_over_tire_damping,
};
use std::f64::consts::TAU;

/// Dampings of figure 4.12.
const DAMPINGS: usize = 101;

/// The design as it is printed.
pub(super) fn design(context: &Context) -> Result<Hybrid, ReproduceError> {
    match hybrid(&context.car(DAMPED)?, &context.hybrid_settings())? {
        Ok(found) => Ok(found),
        Err(why) => Err(ReproduceError::unexpected("hybrid design", "one with the printed Ψ", why)),
    }
}

/// What §4.4 says of Ψ and of the design.
pub(super) fn claims(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let ratio = decimal(DAMPED)? / decimal(OVERDAMPED)?;
    let psi = Psi::PRINTED.function(&ratio)?;
    let whole = |n: i64| Rational::from_integer(n.into());
    sheet.exact("σ = α₁/α₂", &decimal(0.05)?, &ratio);
    let taylor = psi.taylor(2)?;
    sheet.exact("Ψ(0)", &whole(1), &taylor[0]);
    sheet.exact("Ψ′(0)", &whole(0), &taylor[1]);
    sheet.exact("Ψ(∞) = α₁/α₂", &ratio, &psi.at_infinity(1)?[0]);
    let found = design(context)?;
    let broken = match &found.exact_match {
        Some(NotAchievable::Violated(broken)) => broken.len(),
        _ => 0,
    };
    sheet.count("conditions that forbid H₁ of c_t = 2c_s exactly (α₁ = α₂)", 1, broken);
    let rms = &found.rms;
    let share = |k: usize| rms.hybrid[k] / rms.passive[k];
    let reading = "\"without sacrificing road holding\": hybrid over passive";
    sheet.bound("rms z₃ over passive", Relation::AtMost, "1", share(2)).excused_by("E4.4").noted(reading);
    sheet.bound("rms z₁ over passive", Relation::AtMost, "1", share(0)).noted("comfort is improved");
    let gains = actuators(context, &found)?;
    for (what, of, against) in [
        ("|K| over LQG of c_t = 0.1c_s", Quantity::Gain, Design::Own),
        ("|K| over LQG of c_t = 2c_s", Quantity::Gain, Design::Copied),
        ("|T_uV| over LQG of c_t = 0.1c_s", Quantity::Force, Design::Own),
        ("|T_uV| over LQG of c_t = 2c_s", Quantity::Force, Design::Copied),
    ] {
        let (_, decibels) = gains.largest_increase(of, against);
        sheet
            .bound(format!("increase of {what}, 0.1–100 Hz, dB"), Relation::AtMost, "30", decibels)
            .excused_by("E4.9")
            .noted("a reading of \"the increase in the actuator gain is less than 30 decibels\"");
    }
    Ok(())
}

/// (4.53) itself, and degrees.
pub(super) fn equation(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let (found, car) = (design(context)?, context.car(DAMPED)?);
    let printed = q_hat_as_printed(context, &car, &found.target)?;
    let same = usize::from(printed == found.q_hat);
    sheet.count("Q̂ of (4.53) is the derived one", 1, same).noted("1: equal as exact rational functions");
    let copied = found.target.over(&Psi::PRINTED.function(&(decimal(DAMPED)? / decimal(OVERDAMPED)?))?)?;
    let per_velocity = copied.over(&RationalFunction::polynomial(Polynomial::power_of_s(1)))?;
    sheet.count("degree of H₁ that is copied", 8, per_velocity.degree());
    sheet.count("degree of Q̂ (at most)", 13, found.q_hat.degree());
    Ok(())
}

/// The right-hand side of (4.53), for H₁ from the road's velocity.
pub(super) fn q_hat_as_printed(
    context: &Context,
    car: &QuarterCar,
    target: &RationalFunction,
) -> Result<RationalFunction, ReproduceError> {
    let f = RationalFunction::polynomial;
    let s = f(Polynomial::power_of_s(1));
    let (delta, l, p2) = (f(car.delta()), f(car.tire()), f(car.wheel_on_tire()));
    let above = &(&target.over(&s)? * &delta) - &(&(&s * &l) * &f(car.suspension()));
    let below = (&(&f(Polynomial::power_of_s(3)) * &l) * &p2).scaled(&decimal(context.numbers.ms)?);
    Ok((&above * &delta).over(&below)?)
}

/// What an actuator does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Quantity {
    /// |K|, N/m.
    Gain,
    /// |T_uV|, N s/m.
    Force,
}

/// Which LQG design.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Design {
    /// For the real tire.
    Own,
    /// For the fictitious one.
    Copied,
}

/// Figure 4.11 as data: \[gain, force\] of the hybrid design and of LQG on the real and on the fictitious tire.
#[derive(Debug)]
pub(super) struct Actuators {
    pub freq_hz: Vec<f64>,
    pub hybrid: [Vec<f64>; 2],
    pub own: [Vec<f64>; 2],
    pub copied: [Vec<f64>; 2],
}

impl Actuators {
    /// Where and by how many decibels the hybrid design has most above an LQG design.
    pub fn largest_increase(&self, of: Quantity, against: Design) -> (f64, f64) {
        let beside = if against == Design::Own { &self.own } else { &self.copied };
        let ratio =
            self.hybrid[of as usize].iter().zip(&beside[of as usize]).map(|(h, l)| 20.0 * (h / l).log10());
        self.freq_hz
            .iter()
            .copied()
            .zip(ratio)
            .fold((f64::NAN, f64::NEG_INFINITY), |most, at| if at.1 > most.1 { at } else { most })
    }

    /// Frequencies of the largest values of a curve that are above both neighbours.
    pub fn peaks(&self, curve: &[f64]) -> Vec<f64> {
        let inside = 1..curve.len().saturating_sub(1);
        inside
            .filter(|k| curve[*k] > curve[k - 1] && curve[*k] > curve[k + 1])
            .map(|k| self.freq_hz[k])
            .collect()
    }
}

/// Over the figures' frequencies, ω₁ and ω₂ among them: lightly damped peaks fall between points of a grid.
pub(super) fn actuators(context: &Context, found: &Hybrid) -> Result<Actuators, ReproduceError> {
    let freq_hz = frequencies(context)?;
    let of_lqg = |ct: f64| -> Result<[Vec<f64>; 2], ReproduceError> {
        let (car, k) = (context.car(ct)?, context.lqg(ct, &TRAVEL)?);
        curves(&car, &freq_hz, &|omega| Ok(k.at(C64::new(0.0, omega))?[(0, 0)]))
    };
    let (own, copied) = (of_lqg(DAMPED)?, of_lqg(OVERDAMPED)?);
    let of_hybrid = |omega: f64| Ok(found.controller.at_frequency(omega)?);
    let hybrid = curves(&context.car(DAMPED)?, &freq_hz, &of_hybrid)?;
    Ok(Actuators { hybrid, own, copied, freq_hz })
}

type Gain<'a> = &'a dyn Fn(f64) -> Result<C64, ReproduceError>;

/// |K| and |K (1 − G₂₂K)⁻¹ G₂₁/s|.
fn curves(car: &QuarterCar, freq_hz: &[f64], gain: Gain<'_>) -> Result<[Vec<f64>; 2], ReproduceError> {
    let (g22, g21) = (car.force_to(Measurement::Travel), car.road_to(Measurement::Travel));
    let mut all = [Vec::new(), Vec::new()];
    for omega in freq_hz.iter().map(|f| TAU * f) {
        let (k, p, d) = (gain(omega)?, g22.at_frequency(omega)?, g21.at_frequency(omega)?);
        all[0].push(k.norm());
        all[1].push((k / (1.0 - p * k) * d).norm() / omega);
    }
    Ok(all)
}

/// Figure 4.10.
pub(super) fn figure_10(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let found = design(context)?;
    let freq_hz = frequencies(context)?;
    let copied = context.plant(OVERDAMPED, &TRAVEL)?.close(&context.lqg(OVERDAMPED, &TRAVEL)?)?;
    let lqg = gains("LQG, y₂, c_t = 2c_s", &copied, 0, &freq_hz)?;
    let h1 = &found.responses[Response::Acceleration as usize];
    let y = freq_hz.iter().map(|f| Ok(h1.at_frequency(TAU * f)?.norm() / (TAU * f)));
    let hybrid =
        Curve { label: "hybrid, c_t = 0.1c_s".to_owned(), y: y.collect::<Result<_, ReproduceError>>()? };
    let worst = freq_hz
        .iter()
        .zip(lqg.y.iter().zip(&hybrid.y))
        .filter(|(f, _)| **f <= 20.0)
        .map(|(_, (a, b))| (b / a - 1.0).abs())
        .fold(0.0, f64::max);
    let reading =
        (0.05, "\"very accurate in the bandwidth of interest\", taken as 5 % of the magnitude up to 20 Hz");
    sheet.within("largest relative difference of |H₁| to 20 Hz", "0", worst, reading);
    let (x, y) = (Axis::log("frequency, Hz").at(&freq_hz), Axis::log("|T_z₁V|, 1/s"));
    sheet.figure("", "Acceleration of the hybrid design and of what it copies", x, y, vec![lqg, hybrid]);
    Ok(())
}

/// Figure 4.11: gain and force.
pub(super) fn figure_11(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let all = actuators(context, &design(context)?)?;
    for (panel, k, label) in [("a", 0, "|K|, N/m"), ("b", 1, "|T_uV|, N s/m")] {
        let curve = |label: &str, y: &[Vec<f64>; 2]| Curve { label: label.to_owned(), y: y[k].clone() };
        let curves = vec![
            curve("LQG, c_t = 2c_s", &all.copied),
            curve("LQG, c_t = 0.1c_s", &all.own),
            curve("hybrid, c_t = 0.1c_s", &all.hybrid),
        ];
        let x = Axis::log("frequency, Hz").at(&all.freq_hz);
        sheet.figure(panel, "Actuator of the designs that measure the travel", x, Axis::log(label), curves);
    }
    Ok(())
}

/// Figure 4.12: what the curves of figure 4.11 do over 101 tire dampings, as the range that they fill.
pub(super) fn figure_12(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let dampings: Vec<f64> =
        (0..DAMPINGS).map(|k| 0.98 + (DAMPED - 0.98) * k as f64 / (DAMPINGS - 1) as f64).collect();
    let settings = context.hybrid_settings();
    let found = hybrid_over_tire_damping(&context.car(DAMPED)?, &settings, &dampings, (0.1, 100.0, 61))?;
    sheet.count("tire dampings", 101, found.at.len());
    let mut curves = vec![Curve { label: "LQG, c_t = 2c_s".to_owned(), y: found.copied.gain.clone() }];
    for (name, of) in [("LQG", Design::Own), ("hybrid", Design::Copied)] {
        let [low, high] = range(&found, of);
        curves.push(Curve { label: format!("{name}, least"), y: low });
        curves.push(Curve { label: format!("{name}, largest"), y: high });
    }
    let (x, y) = (Axis::log("frequency, Hz").at(&found.freq_hz), Axis::log("|K|, N/m"));
    sheet.figure("", "Actuator over 101 tire dampings from 0.001c_s to 0.1c_s", x, y, curves);
    Ok(())
}

fn range(found: &HybridCurve, of: Design) -> [Vec<f64>; 2] {
    let at = |k: usize| {
        let gains =
            found.at.iter().map(move |a| if of == Design::Own { a.lqg.gain[k] } else { a.hybrid.gain[k] });
        gains.fold((f64::INFINITY, 0.0f64), |(low, high), g| (low.min(g), high.max(g)))
    };
    let all: Vec<(f64, f64)> = (0..found.freq_hz.len()).map(at).collect();
    [all.iter().map(|a| a.0).collect(), all.iter().map(|a| a.1).collect()]
}
