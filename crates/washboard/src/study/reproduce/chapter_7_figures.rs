//! Figure 7.4, and the panels of 7.5: what the full car answers to heights of opposite signs left and right.

use super::ReproduceError;
use super::chapter_7_design::{EXAMPLE, design};
use super::context::Context;
use super::item::{Axis, Curve, Sheet};
use super::lmi_cars::{TIRE, TRAVEL, full_car_on_heights};
use crate::linalg::{C64, CMat};
use crate::lti::{Continuous, StateSpace};
use std::f64::consts::TAU;

/// δ_r, wheels front left, front right, rear left, rear right.
const ROLL: [f64; 4] = [1.0, -1.0, 1.0, -1.0];
/// Row of the roll acceleration.
const ROLL_ACCELERATION: usize = 2;
/// Where the wheels hop, Hz.
const HOP_HZ: [f64; 2] = [9.0, 14.0];

/// What [`roll_figure`] returns.
pub(super) const HOP: &str = "wheel hop in roll: frequency of the tires' peak over the passive one";

/// |δ_rᵀr₂₂|, |δ_rᵀr∞| and |φ̈| over frequency.
fn answers(system: &StateSpace<Continuous>, freq_hz: &[f64]) -> Result<[Vec<f64>; 3], ReproduceError> {
    let mut all = [Vec::new(), Vec::new(), Vec::new()];
    let omega: Vec<f64> = freq_hz.iter().map(|f| TAU * f).collect();
    for g in system.frequency_response(&omega)? {
        let of = |g: &CMat, row: usize| (0..4).map(|j| g[(row, j)] * ROLL[j]).sum::<C64>();
        let folded =
            |rows: [usize; 4]| rows.iter().zip(ROLL).map(|(row, sign)| of(&g, *row) * sign).sum::<C64>();
        for (k, value) in [folded(TRAVEL), folded(TIRE), of(&g, ROLL_ACCELERATION)].into_iter().enumerate() {
            all[k].push(value.norm());
        }
    }
    Ok(all)
}

/// The three panels of the passive car and of a controller's loop; the frequency of the tires' peak where the wheels hop, over the
/// passive one.
pub(super) fn roll_figure(
    sheet: &mut Sheet,
    name: &str,
    controller: &StateSpace<Continuous>,
) -> Result<f64, ReproduceError> {
    let plant = full_car_on_heights()?;
    let freq_hz: Vec<f64> = (0..=300).map(|k| 0.1 * 1000f64.powf(f64::from(k) / 300.0)).collect();
    let passive = answers(&plant.passive(), &freq_hz)?;
    let active = answers(&plant.close(controller)?, &freq_hz)?;
    for (k, (panel, what, label)) in [
        ("a", "Roll-suspension travel", "|δᵣᵀr₂₂|"),
        ("b", "Roll-tire deflection", "|δᵣᵀr∞|"),
        ("c", "Roll acceleration", "|φ̈|, rad/s² for 1 m"),
    ]
    .into_iter()
    .enumerate()
    {
        let curves = vec![
            Curve { label: "passive".to_owned(), y: passive[k].clone() },
            Curve { label: name.to_owned(), y: active[k].clone() },
        ];
        let x = Axis::log("frequency, Hz").at(&freq_hz);
        sheet.figure(panel, &format!("{what} for roll heights of 1 m"), x, Axis::log(label), curves);
    }
    let hop = |of: &[f64]| {
        let inside = freq_hz.iter().zip(of).filter(|(f, _)| (HOP_HZ[0]..=HOP_HZ[1]).contains(*f));
        inside.fold((f64::NAN, 0.0f64), |best, (f, v)| if *v > best.1 { (*f, *v) } else { best })
    };
    Ok(hop(&active[1]).0 / hop(&passive[1]).0)
}

/// Figure 7.4.
pub(super) fn f4(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let found = design(context, EXAMPLE, 0.0)?;
    let ratio = roll_figure(sheet, "LMI design, order 18", &found.controller)?;
    let reading =
        (0.1, "\"the wheel-hop modes are not essentially affected\", taken as 10 % of the frequency");
    sheet.within(HOP, "1", ratio, reading);
    Ok(())
}
