//! §7.3: problem 7.3.1, a full car's controller of order 6 under bounds on travel and tire deflection; figure 7.5.

use super::ReproduceError;
use super::chapter_5_fixed::MET;
use super::chapter_7_figures::{HOP, roll_figure};
use super::context::Context;
use super::item::{Relation, Sheet};
use super::lmi_cars::{COMFORT, TIRE, TRAVEL, full_car_on_heights, gain};
use crate::synthesis::{
    Aim, Channel, FixedOrder, FixedOrderEnd, FixedOrderSettings, Measure, Structure, Target, fixed_order,
};

/// n_K of figure 7.5.
const ORDER: usize = 6;
/// β₁ and β₂.
const BETA: [f64; 2] = [1.1, 1.2];
/// rad/s: poles of controllers beyond it are of no use.
const FASTEST: f64 = 5e3;

/// Figure 7.5, by a design of washboard's own: the printed controller's numbers are not given.
pub(super) fn figure_5(_: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let plant = full_car_on_heights()?;
    let passive = plant.passive();
    let channel = |outputs: Vec<(usize, f64)>| Measure::Hinf(Channel { outputs, disturbances: vec![] });
    let target =
        |measure: Measure, aim: Aim, name: &str| Target { plant: 0, measure, aim, name: name.to_owned() };
    let comfort = COMFORT.iter().map(|row| Ok((*row, 1.0 / gain(&passive, &[*row])?)));
    let comfort: Vec<(usize, f64)> = comfort.collect::<Result<_, ReproduceError>>()?;
    let whole = |rows: &[usize]| rows.iter().map(|row| (*row, 1.0)).collect::<Vec<_>>();
    let limits = [BETA[0] * gain(&passive, &TRAVEL)?, BETA[1] * gain(&passive, &TIRE)?];
    let asked = FixedOrder {
        structure: Structure::full(ORDER, plant.nu(), plant.ny()),
        targets: vec![
            target(channel(comfort.clone()), Aim::Goal(1.0), "accelerations"),
            target(channel(whole(&TRAVEL)), Aim::Bound(limits[0]), "travel"),
            target(channel(whole(&TIRE)), Aim::Bound(limits[1]), "tire"),
        ],
        plants: vec![plant.clone()],
        max_pole_rad_s: Some(FASTEST),
        max_gain: None,
        margin_rad_s: 0.0,
        starts: Vec::new(),
        frequencies_rad_s: Vec::new(),
    };
    let settings = FixedOrderSettings { lower_orders: false, ..FixedOrderSettings::default() };
    let found = match fixed_order(&asked, &settings)? {
        FixedOrderEnd::Designed(found) => found,
        other => return Err(ReproduceError::unexpected("problem 7.3.1", "a design", other)),
    };
    let closed = plant.close(&found.controller)?;
    for (name, rows, limit) in [("travel", TRAVEL, limits[0]), ("tire", TIRE, limits[1])] {
        let excess = (gain(&closed, &rows)? / limit - 1.0).max(0.0);
        sheet.within(format!("{name}: ‖T‖∞ beyond its bound, share"), "0", excess, MET);
    }
    // Λ₁: each acceleration over its own passive norm
    let weights: Vec<f64> = (0..plant.nz())
        .map(|row| comfort.iter().find(|(r, _)| *r == row).map_or(0.0, |(_, weight)| *weight))
        .collect();
    let before = gain(&plant.with_weights(&weights)?.passive(), &COMFORT)?;
    let goal = found.verified_goal.unwrap_or(f64::NAN);
    sheet
        .bound("‖Λ₁T_r₂₁w‖∞ over that of the passive car", Relation::AtMost, "1", goal / before)
        .noted("the objective falls; a local optimum of problem 7.3.1 (E7.7)");
    let ratio = roll_figure(sheet, "fixed order, n_K = 6", &found.controller)?;
    let reading = (0.1, "\"figures 7.4 and 7.5 are nearly the same\", taken as 10 % of the frequency");
    sheet.within(HOP, "1", ratio, reading).excused_by("E7.7");
    Ok(())
}
