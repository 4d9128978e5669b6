//! §5.2: state feedback by matrix inequalities, of one tire damping and of a range; table 5.1, figures 5.3 and 5.4.

use super::ReproduceError;
use super::context::{Context, TRAVEL, three};
use super::item::{Axis, Curve, Relation, Sheet};
use crate::linalg::Mat;
use crate::lti::{Continuous, GeneralizedPlant, StateSpace};
use crate::optimize::SdpSettings;
use crate::synthesis::{
    H2Goal, HinfGoal, LyapunovScale, MixedEnd, MixedGoals, PoleRegion, StateFeedback, robust_state_feedback,
};

/// λ of all examples.
pub(super) const LAMBDA: f64 = 0.1;
/// Tire dampings of table 5.1, N s/m.
const TABLE: [f64; 3] = [25.0, 35.0, 50.0];
/// Steps of figures 5.3 and 5.4 to 100 N s/m.
const STEPS: usize = 20;

/// Problem 5.2.1: ρ₁ = 1/‖G₁‖₂, ρ₂ = λ/‖G₂‖₂ on the outputs, γ = μ‖G₃‖∞, the blocks of the H∞ inequality (−I, −γ²I).
pub(super) fn goals(
    scaled_by: &GeneralizedPlant,
    lambda: f64,
    mu: f64,
) -> Result<MixedGoals, ReproduceError> {
    let of = |row: usize| scaled_by.passive().select(&[row], &[0]);
    let outputs = vec![(0, 1.0 / of(0)?.h2_norm()?), (1, lambda / of(1)?.h2_norm()?)];
    let bound = Some(mu * of(2)?.hinf_norm()?.norm);
    Ok(MixedGoals {
        h2: vec![H2Goal { outputs, weight: 1.0, ..H2Goal::default() }],
        hinf: vec![HinfGoal { outputs: vec![(2, 1.0)], disturbances: vec![], weight: 0.0, bound }],
        region: PoleRegion::default(),
        scale: LyapunovScale::Fixed(1.0),
        back_off: 1e-3,
    })
}

pub(super) fn feedback(
    vertices: &[GeneralizedPlant],
    goals: &MixedGoals,
) -> Result<StateFeedback, ReproduceError> {
    match robust_state_feedback(vertices, goals, &SdpSettings::default())? {
        MixedEnd::Found(found) => Ok(found),
        other => Err(ReproduceError::unexpected("problem 5.2.1", "a state feedback", other)),
    }
}

/// From the road's velocity to z₁ z₂ z₃ and the force, with u = K x.
pub(super) fn closed(plant: &GeneralizedPlant, gain: &Mat) -> Result<StateSpace<Continuous>, ReproduceError> {
    let (a, z) = (plant.a() + plant.b2() * gain, plant.c1() + plant.d12() * gain);
    let c = Mat::from_fn(4, a.ncols(), |i, j| if i < 3 { z[(i, j)] } else { gain[(0, j)] });
    Ok(StateSpace::continuous(a, plant.b1(), c, Mat::zeros(4, 1))?)
}

/// rms of z₁ z₂ z₃ and of the force.
pub(super) fn rms(context: &Context, ct: f64, gain: &Mat) -> Result<[f64; 4], ReproduceError> {
    let system = closed(&context.plant(ct, &TRAVEL)?, gain)?;
    let mut all = [0.0; 4];
    for (k, value) in all.iter_mut().enumerate() {
        *value = context.intensity.sqrt() * system.select(&[k], &[0])?.h2_norm()?;
    }
    Ok(all)
}

/// §5.2.1: the scalings, and the order of chapter 4's controller.
pub(super) fn section(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let passive = context.plant(0.0, &TRAVEL)?.passive();
    let of = |row: usize| passive.select(&[row], &[0]);
    sheet.printed("‖G_z₁‖₂, c_t = 0", "44.57", of(0)?.h2_norm()?);
    sheet.printed("‖G_z₂‖₂, c_t = 0", "0.37", of(1)?.h2_norm()?);
    sheet.printed("‖G_z₃‖∞, c_t = 0, s", "0.0363", of(2)?.hinf_norm()?.norm);
    let hybrid = super::chapter_4_hybrid::design(context)?;
    sheet.count("order of §4.4's controller", 17, hybrid.controller.degree()).excused_by("E4.5");
    let unreduced = hybrid.q_hat.degree() + context.car(0.0)?.delta().degree();
    sheet.count("order of §4.4's controller, unreduced", 17, unreduced).noted("degrees of Q̂ and Δ");
    let over_s = hybrid.responses[0]
        .over(&crate::lti::RationalFunction::polynomial(crate::lti::Polynomial::power_of_s(1)))?;
    sheet.count("order of the loop's T_z₁V", 8, over_s.degree()).excused_by("E4.6");
    Ok(())
}

/// Table 5.1: the passive car, the gain for c_t = 0 and one gain for 25 to 50 N s/m; scalings at c_t = 0, λ = .1, μ = 1.
pub(super) fn table_1(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let (nominal, robust) = gains_of_table_1(context)?;
    let printed = [
        [["0.5379", "0.0046", "0.0017"], ["0.4951", "0.0044", "0.0016"], ["0.4881", "0.0045", "0.0016"]],
        [["0.5361", "0.0046", "0.0017"], ["0.4926", "0.0044", "0.0016"], ["0.4856", "0.0045", "0.0016"]],
        [["0.5336", "0.0046", "0.0017"], ["0.4889", "0.0044", "0.0016"], ["0.4818", "0.0045", "0.0016"]],
    ];
    for (ct, [passive, k0, kp]) in TABLE.into_iter().zip(printed) {
        three(sheet, &format!("passive, c_t = {ct}"), passive, context.passive_rms(ct)?);
        for (name, digits, gain) in [("K₀", k0, &nominal.gain), ("K_p", kp, &robust.gain)] {
            let [z1, z2, z3, _] = rms(context, ct, gain)?;
            let first = sheet.checks.len();
            three(sheet, &format!("{name}, c_t = {ct}"), digits, [z1, z2, z3]);
            if name == "K_p" {
                sheet.checks[first..].iter_mut().for_each(|c| {
                    c.excused_by("E5.10");
                });
            }
        }
    }
    Ok(())
}

/// K₀ and K_p.
pub(super) fn gains_of_table_1(context: &Context) -> Result<(StateFeedback, StateFeedback), ReproduceError> {
    let car = |ct: f64| context.plant(ct, &TRAVEL);
    let asked = goals(&car(0.0)?, LAMBDA, 1.0)?;
    Ok((feedback(&[car(0.0)?], &asked)?, feedback(&[car(TABLE[0])?, car(TABLE[2])?], &asked)?))
}

/// rms values, force and ‖T_z₃‖∞ of the optimal gain at each tire damping.
pub(super) struct Sweep {
    pub ct: Vec<f64>,
    pub passive: Vec<[f64; 4]>,
    pub active: Vec<[f64; 4]>,
    pub tire_peak: [Vec<f64>; 2],
    pub cost: Vec<f64>,
}

pub(super) fn sweep(context: &Context, mu: f64, steps: usize) -> Result<Sweep, ReproduceError> {
    let ct: Vec<f64> = (0..=steps).map(|k| 100.0 * k as f64 / steps as f64).collect();
    let mut found =
        Sweep { ct: ct.clone(), passive: vec![], active: vec![], tire_peak: [vec![], vec![]], cost: vec![] };
    for ct in ct {
        let plant = context.plant(ct, &TRAVEL)?;
        let design = feedback(std::slice::from_ref(&plant), &goals(&plant, LAMBDA, mu)?)?;
        let none = Mat::zeros(1, plant.order());
        found.passive.push(rms(context, ct, &none)?);
        found.active.push(rms(context, ct, &design.gain)?);
        for (k, gain) in [&none, &design.gain].into_iter().enumerate() {
            found.tire_peak[k].push(closed(&plant, gain)?.select(&[2], &[0])?.hinf_norm()?.norm);
        }
        found.cost.push(design.claims.objective);
    }
    Ok(found)
}

/// Four panels: rms of z₁ z₂ z₃, and ‖T_z₃V‖∞.
fn figure(sheet: &mut Sheet, found: &Sweep, mu: f64) {
    for (k, (panel, label)) in
        [("a", "rms z₁, m/s²"), ("b", "rms z₂, m"), ("c", "rms z₃, m")].into_iter().enumerate()
    {
        let of = |all: &[[f64; 4]]| all.iter().map(|r| r[k]).collect();
        let curves = vec![
            Curve { label: "passive".to_owned(), y: of(&found.passive) },
            Curve { label: "state feedback".to_owned(), y: of(&found.active) },
        ];
        let title = format!("State feedback of λ = 0.1, μ = {mu} over tire damping");
        sheet.figure(panel, &title, Axis::linear("c_t, N s/m").at(&found.ct), Axis::linear(label), curves);
    }
    let curves = ["passive", "state feedback"].into_iter().zip(&found.tire_peak);
    let curves = curves.map(|(label, y)| Curve { label: label.to_owned(), y: y.clone() }).collect();
    let title = format!("Tire bound of λ = 0.1, μ = {mu} over tire damping");
    sheet.figure("d", &title, Axis::linear("c_t, N s/m").at(&found.ct), Axis::linear("‖T_z₃V‖∞, s"), curves);
}

/// Figure 5.3, by state feedback: the limit of the output feedback, whose inequalities are singular without sensor noise.
pub(super) fn f3(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let found = sweep(context, 1.0, STEPS)?;
    let force = found.active.iter().map(|r| r[3]);
    let (least, most) = force.fold((f64::INFINITY, 0.0f64), |(l, m), f| (l.min(f), m.max(f)));
    let text = "\"between 59.5 and 62.5 N for all\" tire dampings; by state feedback";
    sheet.bound("least rms force, N", Relation::AtLeast, "59.5", least).noted(text);
    sheet.bound("largest rms force, N", Relation::AtMost, "62.5", most).noted(text);
    let rise = found.active.windows(2).map(|w| w[1][0] - w[0][0]).fold(f64::NEG_INFINITY, f64::max);
    sheet.bound("largest rise of rms z₁ between points", Relation::AtMost, "0", rise).noted("\"declining\"");
    let rise = found.active.windows(2).map(|w| w[1][1] - w[0][1]).fold(f64::NEG_INFINITY, f64::max);
    sheet
        .bound("largest rise of rms z₂ between points", Relation::AtMost, "0", rise)
        .excused_by("E5.6")
        .noted("\"declining responses\"");
    figure(sheet, &found, 1.0);
    Ok(())
}

/// Figure 5.4, likewise.
pub(super) fn f4(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let found = sweep(context, 2.0, STEPS)?;
    let force = found.active.iter().map(|r| r[3]).fold(0.0, f64::max);
    let text = "the same sentence read for μ = 2";
    sheet.bound("largest rms force, N", Relation::AtMost, "62.5", force).excused_by("E5.4").noted(text);
    let rise = found.active.windows(2).map(|w| w[1][0] - w[0][0]).fold(f64::NEG_INFINITY, f64::max);
    sheet.bound("largest rise of rms z₁ between points", Relation::AtMost, "0", rise).noted("\"declining\"");
    figure(sheet, &found, 2.0);
    Ok(())
}
