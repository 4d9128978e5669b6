//! The cabin by its printed matrices, with the corner D of S as printed (z_G + l₁θ) and as derived (z_G − l₁θ): a second route to the
//! library's cabin.

use super::ReproduceError;
use super::chapter_8_cabin::{CABIN, LEAK, TRUCK};
use super::context::Context;
use super::errata::shown;
use super::item::Evidence;
use crate::cases;
use crate::linalg::Mat;
use crate::lti::StateSpace;

/// States of a corner's filter: (8.3) and 1/(s + λ).
const FILTER: usize = 7;

fn diagonal(values: &[f64]) -> Mat {
    Mat::from_fn(values.len(), values.len(), |i, j| if i == j { values[i] } else { 0.0 })
}

/// Ã, B̃, C̃ of (8.3) in series with 1/(s + λ): states × (states + 1), the last column the input.
fn corner() -> Result<Mat, ReproduceError> {
    let spec = cases::vehicle_spec(TRUCK)?;
    let Some(t) = spec.bounce_truck.as_ref() else {
        return Err(ReproduceError::unexpected("case", "a bounce model", TRUCK));
    };
    let (mc, ms, mu) = (t.cabin_mass_kg, t.sprung_mass_kg, t.unsprung_mass_kg);
    let (ks, kc, kt) = (t.primary_stiffness_n_per_m, t.secondary_stiffness_n_per_m, t.tire_stiffness_n_per_m);
    let (cs, cc) = (t.primary_damping_n_s_per_m, t.secondary_damping_n_s_per_m);
    let rows = [
        [0.0, 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 0.0, 1.0, -1.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0],
        [-kc / mc, 0.0, 0.0, -cc / mc, cc / mc, 0.0, 0.0, 0.0],
        [kc / ms, -ks / ms, 0.0, cc / ms, -(cc + cs) / ms, cs / ms, 0.0, 0.0],
        [0.0, ks / mu, -kt / mu, 0.0, cs / mu, -cs / mu, 0.0, 0.0],
        [0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -LEAK, 0.0],
    ];
    Ok(Mat::from_fn(FILTER, FILTER + 1, |i, j| rows[i][j]))
}

/// rms of the passive accelerations with l₁ of corner D in S times `sign`.
fn passive(context: &Context, sign: f64) -> Result<Vec<f64>, ReproduceError> {
    let spec = cases::vehicle_spec(CABIN)?;
    let Some(c) = spec.truck_cabin.as_ref() else {
        return Err(ReproduceError::unexpected("case", "a truck cabin", CABIN));
    };
    let (l1, l2) = (c.rear_axle_m, c.front_axle_m);
    let (nf, nr) = (c.front_half_width_m, c.rear_half_width_m);
    let kinematics = |corner_d: f64| {
        let rows = [[1.0, l2, -nf], [1.0, l2, nf], [1.0, -l1, -nr], [1.0, corner_d * l1, nr]];
        Mat::from_fn(4, 3, |i, j| rows[i][j])
    };
    let (s, forces) = (kinematics(sign), kinematics(-1.0).transpose().to_owned());
    let both = |of: [f64; 2]| diagonal(&[of[0], of[0], of[1], of[1]]);
    let bar = c.front.anti_roll_n_m_per_rad / (2.0 * nf).powi(2);
    let k = both([c.front.stiffness_n_per_m, c.rear.stiffness_n_per_m])
        + Mat::from_fn(4, 4, |i, j| match (i, j) {
            (0, 0) | (1, 1) => bar,
            (0, 1) | (1, 0) => -bar,
            _ => 0.0,
        });
    let d = both([c.front.damping_n_s_per_m, c.rear.damping_n_s_per_m]);
    let inverse = diagonal(&[1.0 / c.cabin_mass_kg, 1.0 / c.pitch_inertia_kg_m2, 1.0 / c.roll_inertia_kg_m2]);
    let (k, d) = (&inverse * &forces * k, &inverse * &forces * d);
    let filter = corner()?;
    // heights and velocities of the corners out of the filters' states
    let heights = Mat::from_fn(4, 4 * FILTER, |i, j| f64::from(u8::from(j == FILTER * i + FILTER - 1)));
    let block =
        |i: usize, j: usize| if i / FILTER == j / FILTER { filter[(i % FILTER, j % FILTER)] } else { 0.0 };
    let states = Mat::from_fn(4 * FILTER, 4 * FILTER, block);
    let speeds = &heights * &states;
    let (on_body, on_rates) = (&k * &s, &d * &s);
    let from_road = &k * &heights + &d * &speeds;
    let n = 6 + 4 * FILTER;
    let acceleration = |i: usize, j: usize| match j {
        0..3 => -on_body[(i, j)],
        3..6 => -on_rates[(i, j - 3)],
        _ => from_road[(i, j - 6)],
    };
    let a = Mat::from_fn(n, n, |i, j| match (i, j) {
        (0..3, _) => f64::from(u8::from(j == i + 3)),
        (3..6, _) => acceleration(i - 3, j),
        (_, 6..) => states[(i - 6, j - 6)],
        _ => 0.0,
    });
    let scale = context.intensity.sqrt();
    let b = Mat::from_fn(n, 4, |i, j| match i.checked_sub(6) {
        Some(i) if i / FILTER == j => scale * filter[(i % FILTER, FILTER)],
        _ => 0.0,
    });
    let c = Mat::from_fn(3, n, acceleration);
    Ok(StateSpace::continuous(a, b, c, Mat::zeros(3, 4))?.h2_of_outputs()?)
}

pub(super) fn corner_d(context: &Context) -> Result<Vec<Evidence>, ReproduceError> {
    let (printed, right) = (passive(context, 1.0)?, passive(context, -1.0)?);
    let pairs = ["heave", "pitch", "roll"].iter().zip(printed.iter().zip(right));
    Ok(pairs.map(|(name, (p, r))| shown(format!("passive, rms {name}"), *p, r)).collect())
}
