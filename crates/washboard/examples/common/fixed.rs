//! The problems of sections 5.3 and 7.3 of the thesis, as goals and bounds of fixed-order controllers.

use std::error::Error;
use washboard::cases;
use washboard::lti::{Continuous, GeneralizedPlant, LtiError, StateSpace};
use washboard::study::lmi_cars::{COMFORT, NOISES, TIRE, TRAVEL, gain, h2};
use washboard::synthesis::{Aim, Channel, FixedOrder, Measure, Structure, Target};
use washboard::vehicle::{Disturbance, Output, PlantSettings, Vehicle};

pub const SPEED_M_S: f64 = 20.0;
/// W of (4.50).
pub const W: f64 = 1.480_625e-4;
/// The quarter car's outputs.
pub const Z: [&str; 3] = ["sprung_acceleration", "suspension_travel", "tire_deflection"];

/// The quarter car with a tire of this damping, N·s/m.
pub fn quarter_car(ct: f64) -> Result<Vehicle, Box<dyn Error>> {
    let spec = cases::vehicle_spec("turkay-quarter-car")?;
    Ok(spec.with_overrides(&[("tire_damping_n_s_per_m".into(), ct)])?.build_alone()?)
}

/// From the road's velocity to its outputs; the travel is measured.
pub fn quarter(ct: f64) -> Result<GeneralizedPlant, Box<dyn Error>> {
    let car = quarter_car(ct)?;
    let of = |name: &str| car.outputs().iter().find(|o| o.name == name);
    let z: Vec<&Output> = Z.iter().filter_map(|n| of(n)).collect();
    let y: Vec<&Output> = of(Z[1]).into_iter().collect();
    let road = cases::road("turkay-white-velocity")?;
    let disturbance = Disturbance::RoadVelocity;
    let settings = PlantSettings { road: (&road).into(), speed_m_s: SPEED_M_S, disturbance, delay_order: 2 };
    Ok(car.plant(&z, &y, &settings)?)
}

pub fn channel(rows: &[usize], disturbances: &[usize]) -> Channel {
    Channel { outputs: rows.iter().map(|r| (*r, 1.0)).collect(), disturbances: disturbances.to_vec() }
}

/// ‖T₁‖∞ against the passive car's under β of the passive car's travel and tire deflection.
pub fn quarter_targets(
    plant: usize,
    passive: &StateSpace<Continuous>,
    beta: [f64; 2],
) -> Result<Vec<Target>, LtiError> {
    let norm = |row: usize| gain(passive, &[row]);
    let target = |row: usize, aim: Aim| Target {
        plant,
        measure: Measure::Hinf(channel(&[row], &[])),
        aim,
        name: Z[row].into(),
    };
    Ok(vec![
        target(0, Aim::Goal(norm(0)?)),
        target(1, Aim::Bound(beta[0] * norm(1)?)),
        target(2, Aim::Bound(beta[1] * norm(2)?)),
    ])
}

pub fn asked(plants: Vec<GeneralizedPlant>, targets: Vec<Target>, order: usize) -> FixedOrder {
    let (nu, ny) = (plants[0].nu(), plants[0].ny());
    FixedOrder {
        structure: Structure::full(order, nu, ny),
        plants,
        targets,
        max_pole_rad_s: Some(5e3),
        max_gain: None,
        margin_rad_s: 0.0,
        starts: Vec::new(),
        frequencies_rad_s: Vec::new(),
    }
}

/// Λ₁, β₁ and β₂ of problem 7.3.1, in the rows of the full car from `heights`.
pub fn full_targets(passive: &StateSpace<Continuous>, heights: &[usize]) -> Result<Vec<Target>, LtiError> {
    let from =
        |rows: &[usize]| -> Result<f64, LtiError> { Ok(passive.select(rows, heights)?.hinf_norm()?.norm) };
    let mut comfort = channel(&COMFORT, heights);
    for (row, weight) in &mut comfort.outputs {
        *weight = 1.0 / from(&[*row])?;
    }
    let hinf = |c: Channel, aim: Aim, name: &str| Target {
        plant: 0,
        measure: Measure::Hinf(c),
        aim,
        name: name.into(),
    };
    Ok(vec![
        hinf(comfort, Aim::Goal(1.0), "accelerations"),
        hinf(channel(&TRAVEL, heights), Aim::Bound(1.1 * from(&TRAVEL)?), "travel"),
        hinf(channel(&TIRE, heights), Aim::Bound(1.2 * from(&TIRE)?), "tire"),
    ])
}

pub fn full_rms(with_noise: &GeneralizedPlant, k: &StateSpace<Continuous>) -> Result<[f64; 5], LtiError> {
    let closed = with_noise.close(k)?.select(&(0..15).collect::<Vec<_>>(), &NOISES)?;
    Ok([
        h2(&closed, &[0])?,
        h2(&closed, &[1])?,
        h2(&closed, &[2])?,
        h2(&closed, &TRAVEL)?,
        h2(&closed, &TIRE)?,
    ])
}
