//! §5.3: fixed-order designs of the quarter car, table 5.2's active columns, figures 5.8–5.12.

use super::ReproduceError;
use super::context::{Context, DAMPED, TRAVEL, frequencies, gains, three};
use super::item::{Axis, Curve, Relation, Sheet};
use crate::lti::{Continuous, GeneralizedPlant, StateSpace};
use crate::synthesis::{
    Aim, Certificate, Channel, FixedOrder, FixedOrderDesign, FixedOrderEnd, FixedOrderSettings, Measure,
    Structure, Target, fixed_order,
};

/// rad/s: poles of controllers beyond it are of no use.
const FASTEST: f64 = 5e3;
/// Tire dampings of figures 5.9–5.12, in the order in which each begins from the one before.
const DAMPINGS: [f64; 5] = [DAMPED, 75.0, 50.0, 25.0, 1.0];
/// Table 5.2, n_K = 1…4.
pub(super) const TABLE: [[&str; 3]; 4] = [
    ["0.4627", "0.0040", "0.0016"],
    ["0.4746", "0.0041", "0.0016"],
    ["0.4763", "0.0041", "0.0016"],
    ["0.4748", "0.0040", "0.0016"],
];
/// What a bound may be exceeded by: what the search counts as met.
pub(super) const MET: (f64, &str) = (1e-6, "what counts as met");

/// Problem 5.3.1 with β₁ = β₂ = 1 of the passive norms.
pub(super) fn design(
    plant: &GeneralizedPlant,
    order: usize,
    start: Option<&StateSpace<Continuous>>,
) -> Result<Box<FixedOrderDesign>, ReproduceError> {
    let passive = Certificate::passive(plant)?;
    let target = |(row, channel): (usize, &crate::synthesis::ChannelNorms)| Target {
        plant: 0,
        measure: Measure::Hinf(Channel { outputs: vec![(row, 1.0)], disturbances: vec![] }),
        aim: if row == 0 { Aim::Goal(channel.hinf) } else { Aim::Bound(channel.hinf) },
        name: format!("z{}", row + 1),
    };
    let asked = FixedOrder {
        structure: Structure::full(order, plant.nu(), plant.ny()),
        plants: vec![plant.clone()],
        targets: passive.channels.iter().take(3).enumerate().map(target).collect(),
        max_pole_rad_s: Some(FASTEST),
        max_gain: None,
        margin_rad_s: 0.0,
        starts: start.into_iter().cloned().collect(),
        frequencies_rad_s: Vec::new(),
    };
    match fixed_order(&asked, &FixedOrderSettings::default())? {
        FixedOrderEnd::Designed(found) => Ok(found),
        other => Err(ReproduceError::unexpected("problem 5.3.1", "a design", other)),
    }
}

/// Table 5.2's active columns.
pub(super) fn table_2(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    super::chapter_5_limits::table_2(context, sheet)?;
    let plant = context.plant(DAMPED, &TRAVEL)?;
    for (k, digits) in TABLE.into_iter().enumerate() {
        let found = design(&plant, k + 1, None)?;
        let text = "the achieved minimum is \"less than or equal to one\"";
        let goal = found.verified_goal.unwrap_or(f64::NAN);
        sheet
            .bound(format!("n_K = {}: ‖T_z₁V‖∞ over the passive one", k + 1), Relation::AtMost, "1", goal)
            .noted(text);
        let rms = context.rms(&Certificate::of(&plant, &found.controller)?);
        let first = sheet.checks.len();
        three(sheet, &format!("n_K = {}", k + 1), digits, rms);
        sheet.checks[first..].iter_mut().for_each(|c| {
            c.excused_by("E5.8").noted("of washboard's own local optimum");
        });
    }
    Ok(())
}

/// Figure 5.8.
pub(super) fn f8(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let plant = context.plant(DAMPED, &TRAVEL)?;
    let (passive, active) = (plant.passive(), plant.close(&design(&plant, 1, None)?.controller)?);
    let freq_hz = frequencies(context)?;
    for (k, (panel, label)) in
        [("a", "|T_z₁V|, 1/s"), ("b", "|T_z₂V|, s"), ("c", "|T_z₃V|, s")].into_iter().enumerate()
    {
        let curves = vec![gains("passive", &passive, k, &freq_hz)?, gains("n_K = 1", &active, k, &freq_hz)?];
        let title = "First-order design of problem 5.3.1, c_t = 98 N s/m";
        sheet.figure(panel, title, Axis::log("frequency, Hz").at(&freq_hz), Axis::log(label), curves);
        if k > 0 {
            let norm =
                |s: &StateSpace<Continuous>| Ok::<_, ReproduceError>(s.select(&[k], &[0])?.hinf_norm()?.norm);
            let excess = (norm(&active)? / norm(&passive)? - 1.0).max(0.0);
            sheet.within(format!("‖T_z{}V‖∞ beyond its bound, share", k + 1), "0", excess, MET);
        }
    }
    Ok(())
}

/// Figures 5.9–5.12: rms values over tire damping; each design begins from that of the tire before.
fn over_damping(context: &Context, sheet: &mut Sheet, order: usize) -> Result<(), ReproduceError> {
    let mut at: Vec<(f64, [f64; 3], [f64; 3])> = Vec::new();
    let mut start = None;
    for ct in DAMPINGS {
        let plant = context.plant(ct, &TRAVEL)?;
        let found = design(&plant, order, start.as_ref())?;
        let rms = context.rms(&Certificate::of(&plant, &found.controller)?);
        at.push((ct, context.passive_rms(ct)?, rms));
        start = Some(found.controller);
    }
    at.reverse();
    let x: Vec<f64> = at.iter().map(|p| p.0).collect();
    for (k, (panel, label)) in
        [("a", "rms z₁, m/s²"), ("b", "rms z₂, m"), ("c", "rms z₃, m")].into_iter().enumerate()
    {
        let curves = vec![
            Curve { label: "passive".to_owned(), y: at.iter().map(|p| p.1[k]).collect() },
            Curve { label: format!("n_K = {order}"), y: at.iter().map(|p| p.2[k]).collect() },
        ];
        let title = format!("Fixed-order designs over tire damping, n_K = {order}");
        sheet.figure(panel, &title, Axis::linear("c_t, N s/m").at(&x), Axis::linear(label), curves);
    }
    let text = "\"for all n_K, the rms vertical acceleration decreases as tire damping increases\"";
    let rise = at.windows(2).map(|w| w[1].2[0] - w[0].2[0]).fold(f64::NEG_INFINITY, f64::max);
    sheet
        .bound("largest rise of rms z₁ between points", Relation::AtMost, "0", rise)
        .excused_by("E5.8")
        .noted(text);
    Ok(())
}

pub(super) fn f9(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    over_damping(context, sheet, 1)
}

pub(super) fn f10(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    over_damping(context, sheet, 2)
}

pub(super) fn f11(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    over_damping(context, sheet, 3)
}

pub(super) fn f12(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    over_damping(context, sheet, 4)
}
