//! Evidence for the errata of chapter 7.

use super::ReproduceError;
use super::chapter_7_design::{DECAY, EXAMPLE, design, three, truncated, unweighted};
use super::context::Context;
use super::errata::shown;
use super::item::Evidence;
use super::lmi_cars::{COMFORT, TIRE, TRAVEL, full_car, h2};
use crate::cases;
use crate::vehicle::{Ride, Vehicle};

type Shown = Result<Vec<Evidence>, ReproduceError>;

const CASE: &str = "chalasani-full-car";

/// The design without and with a decay rate, beside what is printed.
pub(super) fn above_the_optimum(context: &Context) -> Shown {
    let mut all = Vec::new();
    for (decay, of) in [(0.0, ""), (DECAY, ", poles left of −0.2/s")] {
        let found = design(context, EXAMPLE, decay)?;
        let [comfort, travel, tire] = three(&found.closed)?;
        all.extend([
            shown(format!("rms r₂₁{of}"), 3.5916, comfort),
            shown(format!("rms r₂₂{of}, m"), 0.0722, travel),
            shown(format!("‖T_r∞ξ‖∞{of}"), 0.0030, tire),
        ]);
        for ((name, printed), row) in [("heave", 1.69), ("pitch", 1.13), ("roll", 2.95)].iter().zip(COMFORT) {
            all.push(shown(format!("rms {name}{of}"), *printed, h2(&found.closed, &[row])?));
        }
    }
    Ok(all)
}

fn roll(car: &Vehicle) -> Result<[f64; 2], ReproduceError> {
    let modes = car.modes()?;
    let hz = modes.iter().find(|(_, label)| label == "roll").map_or(f64::NAN, |(m, _)| m.damped_hz);
    let road = cases::road("turkay-first-order")?;
    let ride = Ride::new(car, &road, super::context::SPEED_M_S)?;
    let variance = ride.variances(&[car.output("roll_acceleration")?])?;
    Ok([hz, variance.first().and_then(|v| v.rms()).unwrap_or(f64::NAN)])
}

/// K_F taken as a stiffness between the wheels, N/m: K_F t_f² about the roll axis.
pub(super) fn unit_of_roll_stiffness(_: &Context) -> Shown {
    let mut spec = cases::vehicle_spec(CASE)?;
    let right = roll(&spec.build_alone()?)?;
    if let Some(car) = spec.full_car.as_mut() {
        car.front.anti_roll_stiffness_n_m_per_rad *= car.front_track_m.powi(2);
    }
    let printed = roll(&spec.build_alone()?)?;
    Ok(vec![
        shown("roll mode, Hz (1.69 is printed)", printed[0], right[0]),
        shown("passive rms roll, rad/s² (3.98 is printed)", printed[1], right[1]),
    ])
}

/// Unstable poles of the loop with the controller truncated to order 6.
pub(super) fn truncation(context: &Context) -> Shown {
    let unstable = |decay: f64| -> Result<f64, ReproduceError> {
        let found = design(context, EXAMPLE, decay)?;
        let closed = truncated(&found, 6)?;
        Ok(closed.poles()?.iter().filter(|p| p.re >= 0.0).count() as f64)
    };
    Ok(vec![shown(
        "order 6: unstable poles of the loop, without a decay rate and with 0.2/s",
        unstable(0.0)?,
        unstable(DECAY)?,
    )])
}

/// μ = .9: components as the caption has them, and without √(1 − λ) and √λ.
pub(super) fn weighted(context: &Context) -> Shown {
    let mut all = Vec::new();
    for lambda in [0.1, 0.5, 0.9] {
        let parts = design(context, [lambda, 0.9], 0.0)?.parts;
        let free = unweighted(parts, lambda);
        all.push(shown(format!("λ = {lambda}, μ = 0.9: ‖Λ₂T‖₂; over √(1 − λ)"), parts[0], free[0]));
        all.push(shown(format!("λ = {lambda}, μ = 0.9: ‖Λ∞T‖∞; over √λ"), parts[1], free[1]));
    }
    Ok(all)
}

/// Rows of y with ẋ, and with the velocities that C₂ takes.
pub(super) fn measurements(_: &Context) -> Shown {
    let plant = full_car()?;
    // the car's 14 states, without the road's four
    let printed = 4 + plant.order() - plant.nw();
    Ok(vec![shown("rows of y", printed as f64, plant.ny() as f64)])
}

/// Row n_K = 6 beside the truncated LMI design, which is better in all five.
pub(super) fn fixed_order_rows(context: &Context) -> Shown {
    let found = design(context, EXAMPLE, DECAY)?;
    let closed = truncated(&found, 6)?;
    let mut all = vec![
        shown("n_K = 6: ‖T_r∞ξ‖₂", 0.0237, h2(&closed, &TIRE)?),
        shown("n_K = 6: ‖T_r₂₂ξ‖₂", 0.0765, h2(&closed, &TRAVEL)?),
    ];
    for ((name, printed), row) in [("heave", 1.8795), ("pitch", 1.3157), ("roll", 3.0871)].iter().zip(COMFORT)
    {
        all.push(shown(format!("n_K = 6: rms {name}"), *printed, h2(&closed, &[row])?));
    }
    Ok(all)
}

pub(super) fn natural_frequencies(_: &Context) -> Shown {
    let modes = cases::vehicle(CASE)?.modes()?;
    Ok(modes
        .iter()
        .take(3)
        .map(|(m, label)| shown(format!("{label}: damped, natural frequency, Hz"), m.damped_hz, m.freq_hz))
        .collect())
}

pub(super) fn appended_zeros(_: &Context) -> Shown {
    let passive = full_car()?.passive();
    let printed = [("heave", 2.17), ("pitch", 1.35), ("roll", 3.98)];
    printed
        .iter()
        .zip(COMFORT)
        .map(|((name, p), row)| Ok(shown(format!("passive, rms {name}"), *p, h2(&passive, &[row])?)))
        .collect()
}
