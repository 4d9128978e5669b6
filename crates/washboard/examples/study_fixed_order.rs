//! Fixed-order controllers of the thesis's quarter car (section 5.3) and full car (section 7.3).
//!
//! `cargo run --release -p washboard --example study_fixed_order [quarter|damping|robust|h2|full|full-h2] [ORDER...]`

#![allow(clippy::print_stdout, clippy::indexing_slicing, dead_code)]

#[path = "common/lmi_cars.rs"]
mod lmi_cars;

use lmi_cars::{COMFORT, HEIGHTS, NOISES, TIRE, TRAVEL, full_car_with_heights, gain, h2};
use std::error::Error;
use std::time::Instant;
use washboard::cases;
use washboard::lti::{Continuous, GeneralizedPlant, LtiError, StateSpace};
use washboard::synthesis::{
    Aim, Channel, FixedOrder, FixedOrderDesign, FixedOrderEnd, FixedOrderSettings, Measure, Structure,
    Target, fixed_order,
};
use washboard::vehicle::{Disturbance, Output, PlantSettings};

const SPEED_M_S: f64 = 20.0;
/// W of (4.50).
const W: f64 = 1.480_625e-4;
/// The quarter car's outputs.
const Z: [&str; 3] = ["sprung_acceleration", "suspension_travel", "tire_deflection"];

fn quarter(ct: f64) -> Result<GeneralizedPlant, Box<dyn Error>> {
    let spec = cases::vehicle_spec("turkay-quarter-car")?;
    let car = spec.with_overrides(&[("tire_damping_n_s_per_m".into(), ct)])?.build_alone()?;
    let of = |name: &str| car.outputs().iter().find(|o| o.name == name);
    let z: Vec<&Output> = Z.iter().filter_map(|n| of(n)).collect();
    let y: Vec<&Output> = of(Z[1]).into_iter().collect();
    let road = cases::road("turkay-white-velocity")?;
    let disturbance = Disturbance::RoadVelocity;
    let settings = PlantSettings { road: (&road).into(), speed_m_s: SPEED_M_S, disturbance, delay_order: 2 };
    Ok(car.plant(&z, &y, &settings)?)
}

fn channel(rows: &[usize], disturbances: &[usize]) -> Channel {
    Channel { outputs: rows.iter().map(|r| (*r, 1.0)).collect(), disturbances: disturbances.to_vec() }
}

/// ‖T₁‖∞ against the passive car's under β of the passive car's travel and tire deflection.
fn quarter_targets(
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

fn asked(plants: Vec<GeneralizedPlant>, targets: Vec<Target>, order: usize) -> FixedOrder {
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

fn design(
    of: &FixedOrder,
    settings: &FixedOrderSettings,
) -> Result<Option<FixedOrderDesign>, Box<dyn Error>> {
    let begun = Instant::now();
    let end = fixed_order(of, settings)?;
    let took = begun.elapsed().as_secs_f64();
    let (d, how) = match end {
        FixedOrderEnd::NotStabilised { abscissa } => {
            println!("order {}: not stabilised, {abscissa:e}, {took:.2} s", of.structure.order());
            return Ok(None);
        }
        FixedOrderEnd::Designed(d) => (d, "met"),
        FixedOrderEnd::BoundsNotMet(d) => (d, "not met"),
    };
    let poles: Vec<f64> = d.controller.poles()?.iter().map(|p| p.norm()).collect();
    println!(
        "order {}: goal {:.6} bounds {how} (violation {:.1e}); distance {:.1e}, converged {}; controller poles {:?}; {took:.2} s, {:?}",
        of.structure.order(),
        d.verified_goal.unwrap_or(f64::NAN),
        d.violation,
        d.stationarity.map_or(f64::NAN, |s| s.distance),
        d.converged,
        poles.iter().map(|p| format!("{p:.3}")).collect::<Vec<_>>(),
        d.work,
    );
    Ok(Some(*d))
}

fn rms(plant: &GeneralizedPlant, k: &StateSpace<Continuous>) -> Result<[f64; 3], LtiError> {
    let closed = plant.close(k)?;
    let of = |row: usize| Ok::<f64, LtiError>(W.sqrt() * h2(&closed, &[row])?);
    Ok([of(0)?, of(1)?, of(2)?])
}

fn quarter_table(orders: &[usize]) -> Result<(), Box<dyn Error>> {
    let plant = quarter(98.0)?;
    let passive = plant.passive();
    for order in orders {
        let of = asked(vec![plant.clone()], quarter_targets(0, &passive, [1.0, 1.0])?, *order);
        let tries = std::env::var("TRIES").ok().and_then(|t| t.parse().ok()).unwrap_or(8);
        let settings = FixedOrderSettings { tries, ..FixedOrderSettings::default() };
        if let Some(d) = design(&of, &settings)? {
            println!("    rms {:?}; {:?}", rms(&plant, &d.controller)?, d.values);
        }
    }
    Ok(())
}

fn full(orders: &[usize]) -> Result<(), Box<dyn Error>> {
    let plant = full_car_with_heights()?;
    let passive = plant.passive();
    let from =
        |rows: &[usize]| -> Result<f64, LtiError> { Ok(passive.select(rows, &HEIGHTS)?.hinf_norm()?.norm) };
    let mut comfort = channel(&COMFORT, &HEIGHTS);
    for (row, weight) in &mut comfort.outputs {
        *weight = 1.0 / from(&[*row])?;
    }
    let hinf = |c: Channel, aim: Aim, name: &str| Target {
        plant: 0,
        measure: Measure::Hinf(c),
        aim,
        name: name.into(),
    };
    let targets = vec![
        hinf(comfort, Aim::Goal(1.0), "accelerations"),
        hinf(channel(&TRAVEL, &HEIGHTS), Aim::Bound(1.1 * from(&TRAVEL)?), "travel"),
        hinf(channel(&TIRE, &HEIGHTS), Aim::Bound(1.2 * from(&TIRE)?), "tire"),
    ];
    for order in orders {
        let of = asked(vec![plant.clone()], targets.clone(), *order);
        let settings = FixedOrderSettings { lower_orders: false, ..FixedOrderSettings::default() };
        if let Some(d) = design(&of, &settings)? {
            let closed = plant.close(&d.controller)?.select(&(0..15).collect::<Vec<_>>(), &NOISES)?;
            println!(
                "    rms {:.5} {:.5} {:.5}; travel {:.5}, tire {:.5}",
                h2(&closed, &[0])?,
                h2(&closed, &[1])?,
                h2(&closed, &[2])?,
                h2(&closed, &TRAVEL)?,
                h2(&closed, &TIRE)?
            );
        }
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let orders: Vec<usize> = words.iter().filter_map(|w| w.parse().ok()).collect();
    let or = |default: &[usize]| if orders.is_empty() { default.to_vec() } else { orders.clone() };
    match words.first().map_or("quarter", String::as_str) {
        "full" => full(&or(&[2, 4, 6])),
        _ => quarter_table(&or(&[1, 2, 3, 4])),
    }
}
