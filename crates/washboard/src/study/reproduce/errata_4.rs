//! Evidence for the errata of chapter 4.

use super::ReproduceError;
use super::chapter_4_hybrid::{Design, Quantity, actuators, design};
use super::context::{BOTH, Context, DAMPED, OVERDAMPED, TRAVEL};
use super::errata::shown;
use super::item::Evidence;
use crate::lti::{Polynomial, RationalFunction, decimal};
use crate::synthesis::achievable::{Constraint, Response, Youla, log_integral};
use std::f64::consts::TAU;

type Shown = Result<Vec<Evidence>, ReproduceError>;

/// rms z₁ of both measurement cases at c_t = 0.
pub(super) fn exchanged_labels(context: &Context) -> Shown {
    Ok(vec![
        shown("rms z₁ with y₂, m/s²", 0.5240, context.lqg_rms(0.0, &TRAVEL)?[0]),
        shown("rms z₁ with [y₁ y₂], m/s²", 0.5234, context.lqg_rms(0.0, &BOTH)?[0]),
    ])
}

/// Conditions at infinity on H₂ of both measurement cases: the printed list has two.
pub(super) fn proposition_8(context: &Context) -> Shown {
    let count = |y: &[_]| -> Result<f64, ReproduceError> {
        let list = Youla::new(&context.car(DAMPED)?, y)?.constraints(Response::Travel)?.list;
        Ok(list.iter().filter(|c| matches!(c, Constraint::AtInfinity { .. })).count() as f64)
    };
    Ok(vec![shown(
        "coefficients of H₂ at ∞ that are fixed: with y₂, with [y₁ y₂]",
        count(&TRAVEL)?,
        count(&BOTH)?,
    )])
}

/// q̃ = m_s: conditions that are printed and broken, and all that are broken.
pub(super) fn proper_controller(context: &Context) -> Shown {
    let youla = Youla::new(&context.car(DAMPED)?, &BOTH)?;
    let q = RationalFunction::constant(decimal(context.numbers.ms)?);
    let h1 = youla.response(Response::Acceleration, &q);
    let list = youla.constraints(Response::Acceleration)?.list;
    let (mut printed, mut all) = (0, 0);
    for c in &list {
        let (found, _) = c.measured(&h1)?;
        let (broken, is_printed) = match c {
            Constraint::NotAtInfinity { value, .. } => (found == *value, false),
            Constraint::AtZero { value, .. } | Constraint::AtInfinity { value, .. } => {
                (found != *value, true)
            }
            Constraint::OnAxis { re, .. } => (found != *re, true),
        };
        all += usize::from(broken);
        printed += usize::from(broken && is_printed);
    }
    Ok(vec![shown("q̃ = m_s, c_t = 98: conditions that H₁ breaks", printed as f64, all as f64)])
}

/// What the hybrid design does to travel and tire, and the mode that H₁ does not show.
pub(super) fn hidden_mode(context: &Context) -> Shown {
    let found = design(context)?;
    let rms = &found.rms;
    let mut all = vec![
        shown("rms z₁: copied design, hybrid, m/s²", rms.copied[0], rms.hybrid[0]),
        shown("rms z₂: copied design, hybrid, m", rms.copied[1], rms.hybrid[1]),
        shown("rms z₃: copied design, hybrid, m", rms.copied[2], rms.hybrid[2]),
        shown("rms z₃: passive, hybrid, m", rms.passive[2], rms.hybrid[2]),
        shown("|H₃(jω₂)| over that of the copied design", 1.0, found.tire_factor_at_wheel_hop),
    ];
    let hidden = found.hidden.iter().filter(|m| m.hidden_in == [Response::Acceleration]);
    let hop = hidden.min_by(|a, b| a.damping.total_cmp(&b.damping));
    if let Some(mode) = hop {
        let zeta = DAMPED / (2.0 * (context.numbers.kt * context.numbers.mu).sqrt());
        all.push(shown("damping ratio of the hidden mode: c_t/(2√(k_t m_u)), found", zeta, mode.damping));
        all.push(shown(
            "its frequency, Hz: ω₂, found",
            context.car(0.0)?.invariant_omegas_rad_s().1 / TAU,
            mode.freq_hz,
        ));
    }
    Ok(all)
}

pub(super) fn order(context: &Context) -> Shown {
    Ok(vec![shown("order of K", 17.0, design(context)?.controller.degree() as f64)])
}

pub(super) fn loop_order(context: &Context) -> Shown {
    let found = design(context)?;
    let s = RationalFunction::polynomial(Polynomial::power_of_s(1));
    let states = context.car(DAMPED)?.delta().degree() + found.controller.degree();
    Ok(vec![
        shown("order of T_z₁V", 8.0, found.responses[0].over(&s)?.degree() as f64),
        shown("poles of the loop", 8.0, states as f64),
    ])
}

/// Degree of the numerator of (4.53) over the denominators' product, before anything cancels, and what Ψ(∞) saves.
pub(super) fn numerator(context: &Context) -> Shown {
    let (found, car) = (design(context)?, context.car(DAMPED)?);
    let s = RationalFunction::polynomial(Polynomial::power_of_s(1));
    let h = found.target.over(&s)?;
    let (n, d) = (h.numerator(), h.denominator());
    let passive = &(&Polynomial::power_of_s(1) * &car.tire()) * &car.suspension();
    let first = n * &car.delta();
    let second = &passive * d;
    let above = &first - &second;
    let delta = car.delta().degree();
    let before = first.degree().max(second.degree()) + delta;
    let after = above.degree() + delta;
    Ok(vec![
        shown("order of the numerator before cancellations", 18.0, before as f64),
        shown("orders that Ψ(∞) saves", 2.0, (before - after) as f64),
        shown("degree of Q̂", 13.0, found.q_hat.degree() as f64),
    ])
}

pub(super) fn decibels(context: &Context) -> Shown {
    let found = actuators(context, &design(context)?)?;
    let mut all = Vec::new();
    for (what, of) in [("|K|", Quantity::Gain), ("|T_uV|", Quantity::Force)] {
        for (name, against) in [("0.1c_s", Design::Own), ("2c_s", Design::Copied)] {
            let (freq, db) = found.largest_increase(of, against);
            all.push(shown(format!("{what} over LQG of c_t = {name}, dB, at {freq:.2} Hz"), 30.0, db));
        }
    }
    Ok(all)
}

/// Peaks of the force between 0.1 and 100 Hz.
pub(super) fn peaks(context: &Context) -> Shown {
    let found = actuators(context, &design(context)?)?;
    let mut all = Vec::new();
    for (name, curves) in [("hybrid", &found.hybrid), ("LQG of c_t = 0.1c_s", &found.own)] {
        let gains = found.peaks(&curves[Quantity::Gain as usize]).len();
        all.push(shown(format!("{name}: peaks of |K|"), 2.0, gains as f64));
        let force = found.peaks(&curves[Quantity::Force as usize]);
        all.push(shown(format!("{name}: peaks of |T_uV|"), 2.0, force.len() as f64));
        for f in force {
            let near = if f < 4.0 { 1.25 } else { 11.03 };
            all.push(shown(format!("{name}: frequency of a peak of |T_uV|, Hz"), near, f));
        }
    }
    Ok(all)
}

pub(super) fn drop(context: &Context) -> Shown {
    let passive = context.passive_rms(DAMPED)?[0];
    let drop = |active: f64| 100.0 * (1.0 - active / passive);
    Ok(vec![
        shown(
            "with [y₁ y₂], %: 1 − .4900/.5259, unrounded",
            100.0 * (1.0 - 0.4900 / 0.5259),
            drop(context.lqg_rms(DAMPED, &BOTH)?[0]),
        ),
        shown(
            "with y₂, %: 1 − .4895/.5259, unrounded",
            100.0 * (1.0 - 0.4895 / 0.5259),
            drop(context.lqg_rms(DAMPED, &TRAVEL)?[0]),
        ),
    ])
}

/// The integral by quadrature, passive.
pub(super) fn integral(context: &Context) -> Shown {
    let mut all = Vec::new();
    for ct in [DAMPED, OVERDAMPED] {
        let car = context.car(ct)?;
        let found = log_integral(&car, &car.passive(Response::TireDeflection))?;
        all.push(shown(format!("∫ ln|T_z₃w| dω, passive, c_t = {ct}, by quadrature"), 0.0, found.quadrature));
        all.push(shown(format!("the same by −(π/2)c_t/m_u, c_t = {ct}"), 0.0, found.formula));
    }
    Ok(all)
}
