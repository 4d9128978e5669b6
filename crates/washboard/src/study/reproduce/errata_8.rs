//! Evidence for the errata of chapter 8.

use super::ReproduceError;
use super::chapter_8_cabin::{CABIN, RHO, Reading, TRUCK, active, passive, plant, rms};
use super::chapter_8_figures::{PATTERN, answers, leaking, systems};
use super::context::Context;
use super::errata::shown;
use super::item::Evidence;
use crate::cases;
use crate::synthesis::{Certificate, LqgWeights, lqg};

type Shown = Result<Vec<Evidence>, ReproduceError>;

const BODY: [&str; 3] = ["heave", "pitch", "roll"];
const ACCELERATIONS: [&str; 3] = ["heave_acceleration", "pitch_acceleration", "roll_acceleration"];
const CORNERS: [&str; 4] = ["A", "B", "C", "D"];

fn beside(what: &str, printed: &[f64], right: &[f64]) -> Vec<Evidence> {
    let pairs = BODY.iter().zip(printed.iter().zip(right));
    pairs.map(|(name, (p, r))| shown(format!("{what}: rms {name}"), *p, *r)).collect()
}

/// Q on ẋ_S as printed, where its entries are inverses of the accelerations' covariances.
pub(super) fn velocities(context: &Context) -> Shown {
    let spec = cases::vehicle_spec(CABIN)?;
    let before = passive(context, &spec)?;
    let velocities = plant(context, &spec, &["heave_velocity", "pitch_velocity", "roll_velocity"])?;
    let weights: Vec<f64> = before.iter().map(|r| 1.0 / r).collect();
    let goal = velocities.with_weights(&weights)?;
    let settings = LqgWeights {
        sensor_noise: vec![1e-5; goal.ny()],
        input_weight: vec![RHO; goal.nu()],
        ..LqgWeights::default()
    };
    let k = lqg(&goal, &settings)?.controller;
    let found = rms(&Certificate::of(&plant(context, &spec, &ACCELERATIONS)?, &k)?);
    let right = active(context, &spec, Reading::printed(context))?;
    Ok(beside("active", &found, &right.accelerations))
}

pub(super) fn force_weight(context: &Context) -> Shown {
    let spec = cases::vehicle_spec(CABIN)?;
    let reading = Reading::printed(context);
    let printed = active(context, &spec, Reading { force: RHO, ..reading })?;
    let right = active(context, &spec, reading)?;
    let mut all = beside("active, R = ρI and ρ²I", &printed.accelerations, &right.accelerations);
    all.push(shown("rms u_A, N", printed.forces[0], right.forces[0]));
    Ok(all)
}

pub(super) fn cross_term(context: &Context) -> Shown {
    let spec = cases::vehicle_spec(CABIN)?;
    let reading = Reading::printed(context);
    let printed = active(context, &spec, reading)?;
    let right = active(context, &spec, Reading { cross_term: true, ..reading })?;
    let mut all = beside("active", &printed.accelerations, &right.accelerations);
    for (k, corner) in [(0, CORNERS[0]), (2, CORNERS[2])] {
        all.push(shown(format!("rms u_{corner}, N"), printed.forces[k], right.forces[k]));
    }
    Ok(all)
}

pub(super) fn leak(context: &Context) -> Shown {
    let at = |f: f64| Ok(shown(format!("approximation over (8.5) at {f} Hz"), 1.0, leaking(context, f)?));
    [0.02, 0.05, 0.1].into_iter().map(at).collect()
}

/// μ = .0027 for the rms values, and the unrounded road for the design.
pub(super) fn rounded_road(context: &Context) -> Shown {
    let spec = cases::vehicle_spec(CABIN)?;
    let reading = Reading::printed(context);
    let (before, after) = (passive(context, &spec)?, active(context, &spec, reading)?);
    let scaled = |of: &[f64]| of.iter().map(|r| r * reading.q.sqrt()).collect::<Vec<_>>();
    let mut all = beside("passive, rms on μ = 0.0027 and on 2πn₀√κ", &scaled(&before), &before);
    all.extend(beside("active, likewise", &scaled(&after.accelerations), &after.accelerations));
    let plain = active(context, &spec, Reading::unrounded())?;
    let what = "active, Q and filter of 2πn₀√κ and of μ = 0.0027";
    all.extend(beside(what, &plain.accelerations, &after.accelerations));
    all.push(shown("rms u_A, N, likewise", plain.forces[0], after.forces[0]));
    all.push(shown("rms u_C, N, likewise", plain.forces[2], after.forces[2]));
    Ok(all)
}

/// Ratios of figures 8.4–8.6 at the truck's own modes.
pub(super) fn unchanged(context: &Context) -> Shown {
    let [before, after] = systems(context)?;
    let mut all = Vec::new();
    for (mode, label) in cases::vehicle(TRUCK)?.modes()?.iter().skip(1) {
        let of = |system| answers(context, system, PATTERN, mode.freq_hz);
        let (before, after) = (of(&before)?, of(&after)?);
        for (k, name) in BODY.iter().enumerate() {
            let text = format!("{label}, {:.2} Hz: {name}, active over passive", mode.freq_hz);
            all.push(shown(text, 1.0, after[k] / before[k]));
        }
    }
    Ok(all)
}

pub(super) fn reduction(context: &Context) -> Shown {
    let spec = cases::vehicle_spec(CABIN)?;
    let (before, after) = (passive(context, &spec)?, active(context, &spec, Reading::printed(context))?);
    let found = 100.0 * (1.0 - after.accelerations[1] / before[1]);
    Ok(vec![shown("pitch, %: 1 − .455/.595, unrounded", 100.0 * (1.0 - 0.455 / 0.595), found)])
}

/// The filter with E(νν') = I as printed.
pub(super) fn unit_noise(context: &Context) -> Shown {
    let spec = cases::vehicle_spec(CABIN)?;
    let reading = Reading::printed(context);
    let printed = active(context, &spec, Reading { filter: 1.0 / context.intensity, ..reading })?;
    let right = active(context, &spec, reading)?;
    let mut all = beside("active", &printed.accelerations, &right.accelerations);
    all.push(shown("rms u_A, N", printed.forces[0], right.forces[0]));
    Ok(all)
}

/// Chapter 7's warp leaves heave and pitch alone, and has no share in the printed pattern.
pub(super) fn warp(context: &Context) -> Shown {
    const WARP: [f64; 4] = [1.0, -1.0, -1.0, 1.0];
    let [before, _] = systems(context)?;
    let printed = answers(context, &before, PATTERN, 1.5)?;
    let right = answers(context, &before, WARP, 1.5)?;
    // what is zero but for rounding
    let clean = |x: f64| (x * 1e9).round() / 1e9;
    let share = PATTERN.iter().zip(WARP).map(|(a, b)| a * b).sum::<f64>() / 4.0;
    let mut all = vec![shown("share of [1 −1 −1 1] in [1 0 0 −1]", 1.0, share)];
    for (name, (p, r)) in BODY.iter().zip(printed.iter().zip(right)) {
        all.push(shown(format!("passive at 1.5 Hz: {name} for [1 0 0 −1], [1 −1 −1 1]"), *p, clean(r)));
    }
    Ok(all)
}

/// K_F taken as a stiffness between the corners, N/m.
pub(super) fn unit_of_roll_stiffness(context: &Context) -> Shown {
    let mut spec = cases::vehicle_spec(CABIN)?;
    let right = passive(context, &spec)?;
    if let Some(cabin) = spec.truck_cabin.as_mut() {
        cabin.front.anti_roll_n_m_per_rad *= (2.0 * cabin.front_half_width_m).powi(2);
    }
    Ok(beside("passive", &passive(context, &spec)?, &right))
}
