//! §5.1: what no controller beats in H2, figures 5.1 and 5.2; §5.3's passive norms.

use super::ReproduceError;
use super::context::{Context, DAMPED, TRAVEL, three};
use super::item::{Axis, Curve, Relation, Sheet};
use crate::synthesis::{Certificate, full_information, h2_limit};

/// Two routes to one optimum in double precision.
const TWO_ROUTES: (f64, &str) = (1e-9, "two routes to one number");
/// Λ of the two figures.
const WEIGHTS: [[f64; 3]; 2] = [[1.0, 1.0, 1.0], [1.0, 10.0, 100.0]];

/// Largest tire damping of the figures, N s/m (§5.1.1), and steps to it.
const UP_TO: f64 = 100.0;
const STEPS: usize = 50;

pub(super) fn dampings() -> Vec<f64> {
    (0..=STEPS).map(|k| UP_TO * k as f64 / STEPS as f64).collect()
}

/// μ(c_t; Λ): the least H2 norm of any controller over the passive one. The road's intensity, and so the speed, cancels.
pub(super) fn least_share(context: &Context, ct: f64, weights: &[f64; 3]) -> Result<f64, ReproduceError> {
    let plant = context.plant(ct, &TRAVEL)?.with_weights(weights)?;
    Ok(full_information(&plant)?.0 / plant.passive().h2_norm()?)
}

fn figure(
    context: &Context,
    sheet: &mut Sheet,
    weights: &[f64; 3],
    name: &str,
) -> Result<(), ReproduceError> {
    let x = dampings();
    let y: Vec<f64> = x.iter().map(|ct| least_share(context, *ct, weights)).collect::<Result<_, _>>()?;
    let largest = y.iter().copied().fold(0.0, f64::max);
    sheet.bound("(5.19): largest μ", Relation::AtMost, "1", largest);
    let rise = y.windows(2).map(|w| w[1] - w[0]).fold(f64::NEG_INFINITY, f64::max);
    sheet.bound("largest rise of μ between points", Relation::AtMost, "0", rise).noted("a decreasing curve");
    let curves = vec![Curve { label: format!("μ, Λ = {name}"), y }];
    let title = format!("What no controller beats, over the passive car, Λ = {name}");
    sheet.figure("", &title, Axis::linear("c_t, N s/m").at(&x), Axis::linear("μ"), curves);
    Ok(())
}

pub(super) fn f1(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    figure(context, sheet, &WEIGHTS[0], "I")
}

pub(super) fn f2(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    figure(context, sheet, &WEIGHTS[1], "diag(1, 10, 100)")
}

/// (5.18): by inner-outer factors what the Riccati equation of all states says.
pub(super) fn formula(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    for (weights, name) in WEIGHTS.iter().zip(["I", "diag(1, 10, 100)"]) {
        for ct in [0.0, 50.0, DAMPED] {
            let plant = context.plant(ct, &TRAVEL)?.with_weights(weights)?;
            let ratio = h2_limit(&plant)?.h2 / full_information(&plant)?.0;
            sheet.within(
                format!("(5.18) over the Riccati route, Λ = {name}, c_t = {ct}"),
                "1",
                ratio,
                TWO_ROUTES,
            );
        }
    }
    Ok(())
}

/// §5.1.1: the passive car on its road, and ratios of its rms values.
pub(super) fn passive(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let found = context.passive_rms(0.0)?;
    three(sheet, "passive, c_t = 0", ["0.5424", "0.0046", "0.0017"], found);
    let text = "\"more than one hundred times\"";
    sheet.bound("rms z₁ over rms z₂", Relation::AtLeast, "100", found[0] / found[1]).noted(text);
    let text = "\"more than three times\"";
    sheet
        .bound("rms z₂ over rms z₃", Relation::AtLeast, "3", found[1] / found[2])
        .excused_by("E5.5")
        .noted(text);
    Ok(())
}

/// §5.3: the scalings, H∞ norms of the passive car at c_t = 98.
pub(super) fn norms(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let passive = Certificate::passive(&context.plant(DAMPED, &TRAVEL)?)?;
    for ((name, digits), channel) in
        [("‖G_z₁‖∞, 1/s", "20.2380"), ("‖G_z₂‖∞, s", "0.2739"), ("‖G_z₃‖∞, s", "0.0331")]
            .iter()
            .zip(&passive.channels)
    {
        sheet.printed(format!("{name}, c_t = 98"), digits, channel.hinf).excused_by("E5.7");
    }
    Ok(())
}

/// Table 5.2, its passive column.
pub(super) fn table_2(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    three(sheet, "passive, c_t = 98", ["0.5259", "0.0045", "0.0017"], context.passive_rms(DAMPED)?);
    Ok(())
}
