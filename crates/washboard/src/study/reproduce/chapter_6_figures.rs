//! Figures 6.5–6.12: §6.2.2's two designs over tire damping.

use super::ReproduceError;
use super::chapter_6_feedback::{Design, PRINTED, RHOS, UP_TO, design};
use super::context::Context;
use super::item::{Axis, Curve, Sheet};
use std::sync::Arc;

/// Steps of tire damping.
const STEPS: usize = 10;

/// Designs over tire damping.
#[derive(Debug)]
pub(super) struct Sweep {
    pub ct: Vec<f64>,
    pub at: Vec<Design>,
}

fn sweep(context: &Context, rho: [f64; 2]) -> Result<Arc<Sweep>, ReproduceError> {
    context.half_car_sweeps.get(rho[0], || {
        let ct: Vec<f64> = (0..=STEPS).map(|k| UP_TO * k as f64 / STEPS as f64).collect();
        let at = ct.iter().map(|ct| design(&PRINTED, *ct, rho, None)).collect::<Result<_, _>>()?;
        Ok(Sweep { ct, at })
    })
}

type Of<'a> = (&'a str, &'a dyn Fn(&Design) -> f64);

fn panel(
    sheet: &mut Sheet,
    found: &Sweep,
    rho: [f64; 2],
    (panel, what, label): (&str, &str, &str),
    of: &[Of<'_>],
) {
    let curve = |(name, f): &Of<'_>| Curve { label: (*name).to_owned(), y: found.at.iter().map(f).collect() };
    let title = format!("{what} over tire damping, (ρ₁, ρ₂) = ({}, {})", rho[0], rho[1]);
    let (x, y) = (Axis::linear("c_t, N s/m").at(&found.ct), Axis::linear(label));
    sheet.figure(panel, &title, x, y, of.iter().map(curve).collect());
}

fn deflections(context: &Context, sheet: &mut Sheet, rho: [f64; 2]) -> Result<(), ReproduceError> {
    let found = sweep(context, rho)?;
    for (at, what, label, k) in
        [("a", "Travel", "rms travel, m", 0), ("b", "Tire deflection", "rms tire deflection, m", 2)]
    {
        let of: [Of<'_>; 4] = [
            ("passive, front", &|d| d.passive[k]),
            ("passive, rear", &|d| d.passive[k + 1]),
            ("active, front", &|d| d.active[k]),
            ("active, rear", &|d| d.active[k + 1]),
        ];
        panel(sheet, &found, rho, (at, what, label), &of);
    }
    Ok(())
}

fn accelerations(context: &Context, sheet: &mut Sheet, rho: [f64; 2]) -> Result<(), ReproduceError> {
    let found = sweep(context, rho)?;
    for (at, what, label, k) in [("a", "Heave", "rms heave, m/s²", 4), ("b", "Pitch", "rms pitch, rad/s²", 5)]
    {
        let of: [Of<'_>; 2] = [("passive", &|d| d.passive[k]), ("active", &|d| d.active[k])];
        panel(sheet, &found, rho, (at, what, label), &of);
    }
    Ok(())
}

fn tire_gain(context: &Context, sheet: &mut Sheet, rho: [f64; 2]) -> Result<(), ReproduceError> {
    let of: [Of<'_>; 2] = [("passive", &|d| d.gains[0]), ("active", &|d| d.gains[1])];
    let found = sweep(context, rho)?;
    panel(sheet, &found, rho, ("", "‖WT_zw‖∞", "‖WT_zw‖∞"), &of);
    Ok(())
}

fn forces(context: &Context, sheet: &mut Sheet, rho: [f64; 2]) -> Result<(), ReproduceError> {
    let of: [Of<'_>; 2] = [("u₁", &|d| d.active[6]), ("u₂", &|d| d.active[7])];
    let found = sweep(context, rho)?;
    panel(sheet, &found, rho, ("", "Forces", "rms force, N"), &of);
    Ok(())
}

pub(super) fn f5(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    deflections(context, sheet, RHOS[0])
}

pub(super) fn f6(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    accelerations(context, sheet, RHOS[0])
}

pub(super) fn f7(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    tire_gain(context, sheet, RHOS[0])
}

pub(super) fn f8(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    forces(context, sheet, RHOS[0])
}

pub(super) fn f9(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    deflections(context, sheet, RHOS[1])
}

pub(super) fn f10(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    accelerations(context, sheet, RHOS[1])
}

pub(super) fn f11(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    tire_gain(context, sheet, RHOS[1])
}

pub(super) fn f12(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    forces(context, sheet, RHOS[1])
}
