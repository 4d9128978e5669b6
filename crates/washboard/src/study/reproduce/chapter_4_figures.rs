//! Figures 4.3–4.9: gains of the passive car and of its LQG designs, and where every one of them must cross.

use super::ReproduceError;
use super::context::{Context, DAMPED, OVERDAMPED, frequencies, gain, gains};
use super::item::{Axis, Sheet};
use std::f64::consts::TAU;

/// What every response at an invariant frequency may differ by: rounding of a loop in double precision.
const INVARIANT: (f64, &str) = (1e-6, "the same for every controller, but for rounding");

const NAMES: [(&str, &str); 3] = [
    ("Acceleration", "|T_z₁V|, 1/s"),
    ("Suspension travel", "|T_z₂V|, s"),
    ("Tire deflection", "|T_z₃V|, s"),
];

fn figure(context: &Context, sheet: &mut Sheet, output: usize, ct: f64) -> Result<(), ReproduceError> {
    let freq_hz = frequencies(context)?;
    let curves = context
        .loops(ct)?
        .iter()
        .map(|(name, system)| gains(name, system, output, &freq_hz))
        .collect::<Result<_, _>>()?;
    let (name, label) = NAMES[output];
    let title = format!("{name} of the passive car and of the LQG designs, c_t = {ct} N s/m");
    sheet.figure("", &title, Axis::log("frequency, Hz").at(&freq_hz), Axis::log(label), curves);
    Ok(())
}

/// Figures 4.3 and 4.4 with the heights of their invariant points, propositions 4.3.4 and 4.3.5.
fn invariant(context: &Context, sheet: &mut Sheet, output: usize) -> Result<(), ReproduceError> {
    figure(context, sheet, output, 0.0)?;
    let n = &context.numbers;
    let (w1, w2) = context.car(0.0)?.invariant_omegas_rad_s();
    let (name, omega, height) = match output {
        0 => ("|T_z₁V(jω₂)| over m_u ω₂/m_s", w2, n.mu * w2 / n.ms),
        _ => ("|T_z₂V(jω₁)| over (m_s + m_u)/(m_s ω₁)", w1, (n.ms + n.mu) / (n.ms * w1)),
    };
    for (of, system) in context.loops(0.0)? {
        sheet.within(format!("{name}: {of}"), "1", gain(&system, output, omega / TAU)? / height, INVARIANT);
    }
    Ok(())
}

pub(super) fn f3(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    invariant(context, sheet, 0)
}

pub(super) fn f4(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    invariant(context, sheet, 1)
}

pub(super) fn f5(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    figure(context, sheet, 2, 0.0)
}

pub(super) fn f6(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    figure(context, sheet, 0, OVERDAMPED)
}

pub(super) fn f7(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    figure(context, sheet, 1, OVERDAMPED)
}

pub(super) fn f8(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    figure(context, sheet, 2, OVERDAMPED)
}

pub(super) fn f9(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    figure(context, sheet, 0, DAMPED)
}
