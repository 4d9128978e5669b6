//! Evidence for the errata of chapter 5.

use super::ReproduceError;
use super::chapter_5_feedback::{Sweep, gains_of_table_1, rms, sweep};
use super::chapter_5_fixed::{TABLE, design};
use super::context::{Context, DAMPED, TRAVEL};
use super::errata::shown;
use super::item::Evidence;
use crate::synthesis::Certificate;

type Shown = Result<Vec<Evidence>, ReproduceError>;

/// c_t = 0, 50, 100.
fn three_points(context: &Context, mu: f64) -> Result<Sweep, ReproduceError> {
    sweep(context, mu, 2)
}

pub(super) fn force(context: &Context) -> Shown {
    let mut all = Vec::new();
    for mu in [1.0, 2.0] {
        let found = three_points(context, mu)?;
        for (ct, r) in found.ct.iter().zip(&found.active) {
            all.push(shown(format!("μ = {mu}, c_t = {ct}: rms force, N"), 62.5, r[3]));
        }
    }
    Ok(all)
}

pub(super) fn ratio(context: &Context) -> Shown {
    let found = context.passive_rms(0.0)?;
    Ok(vec![
        shown("rms z₂/rms z₃, c_t = 0", 3.0, found[1] / found[2]),
        shown("rms z₂/rms z₃ of the printed .0046 and .0017", 3.0, 0.0046 / 0.0017),
    ])
}

pub(super) fn rising(context: &Context) -> Shown {
    let mut all = Vec::new();
    for mu in [1.0, 2.0] {
        let found = three_points(context, mu)?;
        let [first, .., last] = &found.active[..] else { continue };
        all.push(shown(format!("μ = {mu}: rms z₂ at c_t = 0 and 100, m"), first[1], last[1]));
    }
    Ok(all)
}

pub(super) fn norms(context: &Context) -> Shown {
    let passive = Certificate::passive(&context.plant(DAMPED, &TRAVEL)?)?;
    let printed = [("‖G_z₁‖∞, 1/s", 20.2380), ("‖G_z₂‖∞, s", 0.2739), ("‖G_z₃‖∞, s", 0.0331)];
    Ok(printed.iter().zip(&passive.channels).map(|((name, p), c)| shown(*name, *p, c.hinf)).collect())
}

pub(super) fn robust_gain(context: &Context) -> Shown {
    let (_, robust) = gains_of_table_1(context)?;
    let mut all = Vec::new();
    for (ct, z1) in [(25.0, 0.4881), (35.0, 0.4856), (50.0, 0.4818)] {
        let found = rms(context, ct, &robust.gain)?;
        all.push(shown(format!("rms z₁ of K_p, c_t = {ct}"), z1, found[0]));
        all.push(shown(format!("rms z₂ of K_p, c_t = {ct}"), 0.0045, found[1]));
    }
    Ok(all)
}

/// Problem 5.3.1's own designs: least ‖T_z₁V‖∞ over the passive one, and the rms z₁ that comes with it.
pub(super) fn fixed_order_rows(context: &Context) -> Shown {
    let plant = context.plant(DAMPED, &TRAVEL)?;
    let mut all = Vec::new();
    for (k, [z1, ..]) in TABLE.into_iter().enumerate() {
        let found = design(&plant, k + 1, None)?;
        let rms = context.rms(&Certificate::of(&plant, &found.controller)?);
        let of = format!("n_K = {}", k + 1);
        let goal = found.verified_goal.unwrap_or(f64::NAN);
        all.push(shown(format!("{of}: ‖T_z₁V‖∞ over the passive one, printed as at most 1"), 1.0, goal));
        // further places are the search's own
        let rounded = (100.0 * rms[0]).round() / 100.0;
        let text = format!("{of}: rms z₁ to two places, m/s²");
        all.push(shown(text, z1.parse().unwrap_or(f64::NAN), rounded));
    }
    Ok(all)
}
