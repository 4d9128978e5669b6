//! Figures 5.5–5.7: the state feedback of λ = .1, μ = 2 over frequency and over the bump (5.21).

use super::ReproduceError;
use super::chapter_5_feedback::{LAMBDA, closed, feedback, goals};
use super::context::{Context, TRAVEL, frequencies, gains};
use super::item::{Axis, Curve, Relation, Sheet};
use crate::linalg::Mat;
use crate::lti::{Continuous, Hold, StateSpace};
use std::f64::consts::{PI, TAU};

/// μ and c_t of figures 5.5 and 5.6.
const MU: f64 = 2.0;
const TIRE_DAMPING: f64 = 50.0;
/// h and l, m; 45 km/h in m/s.
const HEIGHT_M: f64 = 0.1;
const LENGTH_M: f64 = 2.0;
const SPEED_M_S: f64 = 12.5;
/// Steps over the bump, its lengths that are computed, and every so many steps a point of the figure.
const STEPS: usize = 400;
const LENGTHS: usize = 19;
const DRAWN: usize = 20;
const NAMES: [&str; 3] = ["z₁", "z₂", "z₃"];
const LABELS: [&str; 3] = ["z₁, m/s²", "z₂, m", "z₃, m"];

/// From V_i to z₁ z₂ z₃ of the passive car and of the state feedback.
fn systems(context: &Context, ct: f64) -> Result<[StateSpace<Continuous>; 2], ReproduceError> {
    let plant = context.plant(ct, &TRAVEL)?;
    let design = feedback(std::slice::from_ref(&plant), &goals(&plant, LAMBDA, MU)?)?;
    let three = |gain: &Mat| Ok::<_, ReproduceError>(closed(&plant, gain)?.select(&[0, 1, 2], &[0])?);
    Ok([three(&Mat::zeros(1, plant.order()))?, three(&design.gain)?])
}

/// Figure 5.5.
pub(super) fn f5(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let freq_hz = frequencies(context)?;
    let [passive, active] = systems(context, TIRE_DAMPING)?;
    for (k, (panel, label)) in
        [("a", "|T_z₁V|, 1/s"), ("b", "|T_z₂V|, s"), ("c", "|T_z₃V|, s")].into_iter().enumerate()
    {
        let curves = vec![
            gains("passive", &passive, k, &freq_hz)?,
            gains("state feedback, λ = 0.1, μ = 2", &active, k, &freq_hz)?,
        ];
        let title = format!("{} of λ = 0.1, μ = 2, c_t = {TIRE_DAMPING} N s/m", NAMES[k]);
        sheet.figure(panel, &title, Axis::log("frequency, Hz").at(&freq_hz), Axis::log(label), curves);
    }
    Ok(())
}

/// z₁ z₂ z₃ over the bump, one row a step: the road's velocity is straight between steps.
fn over_bump(system: &StateSpace<Continuous>) -> Result<Vec<Vec<f64>>, ReproduceError> {
    let dt = LENGTH_M / SPEED_M_S / STEPS as f64;
    let velocity = |k: usize| {
        let slope = PI * HEIGHT_M * SPEED_M_S / LENGTH_M;
        vec![if k <= STEPS { slope * (TAU * k as f64 / STEPS as f64).sin() } else { 0.0 }]
    };
    let inputs: Vec<Vec<f64>> = (0..=LENGTHS * STEPS).map(velocity).collect();
    Ok(system.respond(&inputs, dt, Hold::First)?)
}

fn peak(rows: &[Vec<f64>], k: usize) -> f64 {
    rows.iter().map(|z| z[k].abs()).fold(0.0, f64::max)
}

/// Figure 5.6.
pub(super) fn f6(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let [passive, active] = systems(context, TIRE_DAMPING)?;
    let (before, after) = (over_bump(&passive)?, over_bump(&active)?);
    let dt = LENGTH_M / SPEED_M_S / STEPS as f64;
    let drawn = |rows: &[Vec<f64>], k: usize| rows.iter().step_by(DRAWN).map(|z| z[k]).collect();
    let x: Vec<f64> = (0..before.len()).step_by(DRAWN).map(|k| dt * k as f64).collect();
    for (k, panel) in ["a", "b", "c"].into_iter().enumerate() {
        let curves = vec![
            Curve { label: "passive".to_owned(), y: drawn(&before, k) },
            Curve { label: "state feedback".to_owned(), y: drawn(&after, k) },
        ];
        let title = format!("{} over a bump of 0.1 m, 2 m long, at 45 km/h", NAMES[k]);
        sheet.figure(panel, &title, Axis::linear("time, s").at(&x), Axis::linear(LABELS[k]), curves);
    }
    let text = "\"the vertical acceleration amplitude is significantly reduced … while the suspension travel and the tire deflection amplitudes are increased\"";
    for (k, relation) in [Relation::AtMost, Relation::AtLeast, Relation::AtLeast].into_iter().enumerate() {
        let ratio = peak(&after, k) / peak(&before, k);
        sheet.bound(format!("peak of {} over the passive one", NAMES[k]), relation, "1", ratio).noted(text);
    }
    Ok(())
}

/// Figure 5.7: (5.22) over tire damping.
pub(super) fn f7(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let x: Vec<f64> = (0..=10).map(|k| 10.0 * f64::from(k)).collect();
    let mut curves: Vec<Curve> =
        ["δ₁", "δ₂", "δ₃"].iter().map(|l| Curve { label: (*l).to_owned(), y: Vec::new() }).collect();
    for ct in &x {
        let [passive, active] = systems(context, *ct)?;
        let (before, after) = (over_bump(&passive)?, over_bump(&active)?);
        for (k, curve) in curves.iter_mut().enumerate() {
            curve.y.push(1.0 - peak(&after, k) / peak(&before, k));
        }
    }
    let rise = curves[0].y.windows(2).map(|w| w[1] - w[0]).fold(f64::INFINITY, f64::min);
    let text = "\"change analogously to the rms values\": that of z₁ falls against the passive one";
    sheet.bound("least rise of δ₁ between points", Relation::AtLeast, "0", rise).noted(text);
    let title = "Relative improvement over the bump, λ = 0.1, μ = 2";
    sheet.figure("", title, Axis::linear("c_t, N s/m").at(&x), Axis::linear("δ"), curves);
    Ok(())
}
