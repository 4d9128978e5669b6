//! §7.2: the full car's output feedback by matrix inequalities, its truncations, and the trade-off of figure 7.3.

use super::ReproduceError;
use super::context::Context;
use super::item::{Axis, Curve, Relation, Sheet};
use super::lmi_cars::{COMFORT, NOISES, TIRE, TRAVEL, full_car, full_car_goals, gain, h2};
use crate::lti::{Continuous, StateSpace};
use crate::optimize::SdpSettings;
use crate::synthesis::{MixedEnd, mixed_h2_hinf};
use rayon::prelude::*;
use std::sync::Arc;

/// λ and μ of §7.2.1.
pub(super) const EXAMPLE: [f64; 2] = [0.6, 0.6];
/// 1/s: what the poles are left of where the controller is truncated; without it, slow poles go with what they carry.
pub(super) const DECAY: f64 = 0.2;
/// The passive car's rms r₂₁, r₂₂ and ‖T_r∞ξ‖∞ as printed.
const PASSIVE: [&str; 3] = ["4.7347", "0.0752", "0.0090"];
const ACTIVE: [&str; 3] = ["3.5916", "0.0722", "0.0030"];
const QUANTITIES: [&str; 3] = ["rms r₂₁ (accelerations)", "rms r₂₂ (travels)", "‖T_r∞ξ‖∞ (tires)"];
const BODY: [&str; 3] = ["heave at the driver, m/s²", "pitch, rad/s²", "roll, rad/s²"];

/// A controller of problem 7.2.1, and its loop from the noises.
#[derive(Debug)]
pub(super) struct FullCarDesign {
    pub controller: StateSpace<Continuous>,
    pub closed: StateSpace<Continuous>,
    /// ‖Λ₂T_r₂ξ‖₂ and ‖Λ∞T_r∞ξ‖∞ of the loop.
    pub parts: [f64; 2],
}

/// The design of (λ, μ) with poles left of −`decay`.
pub(super) fn design(
    context: &Context,
    [lambda, mu]: [f64; 2],
    decay: f64,
) -> Result<Arc<FullCarDesign>, ReproduceError> {
    context.full_car_designs.get([lambda, mu, decay], || {
        let plant = full_car()?;
        let asked = full_car_goals(&plant, [lambda, mu], decay, NOISES)?;
        let found = match mixed_h2_hinf(&plant, &asked, &SdpSettings::default())? {
            MixedEnd::Found(found) => found,
            other => return Err(ReproduceError::unexpected("problem 7.2.1", "an output feedback", other)),
        };
        let first = |of: &[f64]| of.first().copied().unwrap_or(f64::NAN);
        let parts = [first(&found.achieved.h2), first(&found.achieved.hinf)];
        Ok(FullCarDesign { closed: plant.close(&found.controller)?, controller: found.controller, parts })
    })
}

/// rms r₂₁, r₂₂ and ‖T_r∞ξ‖∞.
pub(super) fn three(system: &StateSpace<Continuous>) -> Result<[f64; 3], ReproduceError> {
    Ok([h2(system, &COMFORT)?, h2(system, &TRAVEL)?, gain(system, &TIRE)?])
}

/// The passive car's numbers of §7.2.1.
pub(super) fn passive(_: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let passive = full_car()?.passive();
    for ((name, digits), found) in QUANTITIES.iter().zip(PASSIVE).zip(three(&passive)?) {
        sheet.printed(format!("passive, {name}"), digits, found);
    }
    for ((name, digits), row) in BODY.iter().zip(["2.17", "1.35", "3.98"]).zip(COMFORT) {
        sheet.printed(format!("passive, rms {name}"), digits, h2(&passive, &[row])?);
    }
    Ok(())
}

/// The design of λ = μ = .6.
pub(super) fn section(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let passive = three(&full_car()?.passive())?;
    let free = design(context, EXAMPLE, 0.0)?;
    let found = three(&free.closed)?;
    for ((name, digits), found) in QUANTITIES.iter().zip(ACTIVE).zip(found) {
        sheet.printed(format!("active, {name}"), digits, found).excused_by("E7.1");
    }
    for ((name, digits), row) in BODY.iter().zip(["1.69", "1.13", "2.95"]).zip(COMFORT) {
        sheet.printed(format!("active, rms {name}"), digits, h2(&free.closed, &[row])?).excused_by("E7.1");
    }
    let drop = |k: usize| 100.0 * (1.0 - found[k] / passive[k]);
    sheet.printed("reduction of rms accelerations, %", "24", drop(0));
    sheet.printed("reduction of ‖T_r∞ξ‖∞, %", "67", drop(2));
    let text = "\"without increasing\"";
    sheet.bound("rms travel over the passive one", Relation::AtMost, "1", found[1] / passive[1]).noted(text);
    let tires = h2(&free.closed, &TIRE)? / h2(&full_car()?.passive(), &TIRE)?;
    sheet.bound("rms tire deflection over the passive one", Relation::AtMost, "1", tires).noted(text);
    let slow = design(context, EXAMPLE, DECAY)?;
    let known = three(&slow.closed)?;
    for order in [10, 8, 6] {
        let closed = truncated(&slow, order)?;
        for ((name, found), known) in QUANTITIES.iter().zip(three(&closed)?).zip(known) {
            let reading =
                (0.05, "\"as good as\", taken as 5 %; of the design with poles left of −0.2/s (E7.3)");
            sheet.within(format!("order {order} over order 18, {name}"), "1", found / known, reading);
        }
    }
    Ok(())
}

/// The loop with the controller truncated to an order.
pub(super) fn truncated(of: &FullCarDesign, order: usize) -> Result<StateSpace<Continuous>, ReproduceError> {
    Ok(full_car()?.close(&of.controller.balanced_truncation(order)?.system)?)
}

/// The components without √(1 − λ) and √λ.
pub(super) fn unweighted(parts: [f64; 2], lambda: f64) -> [f64; 2] {
    [parts[0] / (1.0 - lambda).sqrt(), parts[1] / lambda.sqrt()]
}

/// Figure 7.3, and its boundary cases μ = 0 and 1.
pub(super) fn figure_3(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let all: Vec<f64> = (1..10).map(|k| 0.1 * f64::from(k)).collect();
    let ends: Vec<f64> = all.iter().copied().step_by(2).collect();
    for (panel, mu, lambdas) in [("a", 0.5, &all), ("b", 0.9, &all), ("c", 0.0, &ends), ("d", 1.0, &ends)] {
        let parts = lambdas
            .par_iter()
            .map(|lambda| Ok(design(context, [*lambda, mu], 0.0)?.parts))
            .collect::<Result<Vec<_>, ReproduceError>>()?;
        let free: Vec<[f64; 2]> = parts.iter().zip(lambdas).map(|(p, l)| unweighted(*p, *l)).collect();
        let curve = |label: &str, of: &[[f64; 2]], k: usize| Curve {
            label: label.to_owned(),
            y: of.iter().map(|p| p[k]).collect(),
        };
        let curves = vec![
            curve("‖Λ∞T‖∞", &parts, 1),
            curve("‖Λ₂T‖₂", &parts, 0),
            curve("‖Λ∞T‖∞/√λ", &free, 1),
            curve("‖Λ₂T‖₂/√(1 − λ)", &free, 0),
        ];
        let title = format!("Components of the optimal cost, μ = {mu}");
        sheet.figure(panel, &title, Axis::linear("λ").at(lambdas), Axis::linear("component"), curves);
        let steps = |k: usize| free.windows(2).map(move |w| w[1][k] - w[0][k]);
        let text = "\"one component increases while the other decreases\", without √(1 − λ), √λ (E7.4)";
        let least_rise = steps(0).fold(f64::INFINITY, f64::min);
        sheet
            .bound(format!("μ = {mu}: least rise of ‖Λ₂T‖₂/√(1 − λ)"), Relation::AtLeast, "0", least_rise)
            .noted(text);
        let least_fall = steps(1).fold(f64::NEG_INFINITY, f64::max);
        sheet
            .bound(format!("μ = {mu}: largest rise of ‖Λ∞T‖∞/√λ"), Relation::AtMost, "0", least_fall)
            .noted(text);
        if mu == 0.9 {
            let least = parts.windows(2).map(|w| w[1][1] - w[0][1]).fold(f64::INFINITY, f64::min);
            sheet
                .bound("μ = 0.9: least rise of ‖Λ∞T‖∞ as its caption has it", Relation::AtLeast, "0", least)
                .excused_by("E7.4");
        }
    }
    Ok(())
}
