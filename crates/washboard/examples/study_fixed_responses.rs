//! What the fixed-order designs of the thesis do beyond the norms that they are made for: the quarter car's over a bump (figures
//! 5.9–5.12's designs, (5.21) and (5.22)), the full car's for heave, pitch, roll and warp of the road (figures 7.4 and 7.5).
//!
//! `cargo run --release -p washboard --example study_fixed_responses [bump|directions] [ORDER...]`

#![allow(clippy::print_stdout, clippy::indexing_slicing, dead_code)]

#[path = "common/fixed.rs"]
mod fixed;

use fixed::{Z, asked, full_targets, quarter, quarter_car, quarter_targets};
use std::error::Error;
use washboard::linalg::{C64, CMat};
use washboard::lti::{Continuous, StateSpace};
use washboard::study::lmi_cars::{COMFORT, TIRE, TRAVEL, full_car_on_heights};
use washboard::synthesis::{FixedOrder, FixedOrderEnd, FixedOrderSettings, fixed_order};
use washboard::units::hz;
use washboard::vehicle::{Bump, Control, Output};

/// (5.21): h, l and v.
const BUMP: [f64; 2] = [0.1, 2.0];
const BUMP_SPEED_M_S: f64 = 12.5;
const SECONDS: f64 = 2.0;
/// Heights of the wheels front left, front right, rear left, rear right, and the acceleration that each moves.
const DIRECTIONS: [(&str, [f64; 4], usize); 4] = [
    ("heave", [1.0, 1.0, 1.0, 1.0], COMFORT[0]),
    ("pitch", [1.0, 1.0, -1.0, -1.0], COMFORT[1]),
    ("roll", [1.0, -1.0, 1.0, -1.0], COMFORT[2]),
    ("warp", [1.0, -1.0, -1.0, 1.0], COMFORT[2]),
];

fn designed(
    of: &FixedOrder,
    settings: &FixedOrderSettings,
) -> Result<Option<StateSpace<Continuous>>, Box<dyn Error>> {
    Ok(match fixed_order(of, settings)? {
        FixedOrderEnd::Designed(d) => {
            println!("order {}: goal {:.5}", of.structure.order(), d.verified_goal.unwrap_or(f64::NAN));
            Some(d.controller)
        }
        FixedOrderEnd::BoundsNotMet(_) | FixedOrderEnd::NotStabilised { .. } => {
            println!("order {}: no design", of.structure.order());
            None
        }
    })
}

fn over_bump(orders: &[usize]) -> Result<(), Box<dyn Error>> {
    const CT: f64 = 98.0;
    let (car, plant) = (quarter_car(CT)?, quarter(CT)?);
    let outputs: Vec<&Output> =
        Z.iter().filter_map(|n| car.outputs().iter().find(|o| o.name == *n)).collect();
    let bump = Bump::new(BUMP[0], BUMP[1])?;
    let peaks = |control: Option<&Control>| -> Result<Vec<f64>, Box<dyn Error>> {
        let found = car.bump_response(&outputs, bump, BUMP_SPEED_M_S, SECONDS, control)?;
        Ok(found.peaks().iter().map(|p| p.0).collect())
    };
    let passive = peaks(None)?;
    println!("passive peaks {passive:.5?}");
    for order in orders {
        let of = asked(vec![plant.clone()], quarter_targets(0, &plant.passive(), [1.0, 1.0])?, *order);
        let Some(k) = designed(&of, &FixedOrderSettings::default())? else { continue };
        let control = Control::new(&car, k, &[Z[1].to_owned()], &[car.actuators()[0].name.clone()])?;
        let found = peaks(Some(&control))?;
        let less: Vec<f64> = found.iter().zip(&passive).map(|(a, p)| 100.0 * (1.0 - a / p)).collect();
        println!("    peaks {found:.5?}, less by {less:.1?} %");
    }
    Ok(())
}

fn directions(orders: &[usize]) -> Result<(), Box<dyn Error>> {
    let plant = full_car_on_heights()?;
    let passive = plant.passive();
    let targets = full_targets(&passive, &[0, 1, 2, 3])?;
    let omegas: Vec<f64> = (0..600).map(|k| 0.5 * 400f64.powf(f64::from(k) / 599.0)).collect();
    let of_passive = passive.frequency_response(&omegas)?;
    for order in orders {
        let of = asked(vec![plant.clone()], targets.clone(), *order);
        let settings = FixedOrderSettings { lower_orders: false, ..FixedOrderSettings::default() };
        let Some(k) = designed(&of, &settings)? else { continue };
        let closed = plant.close(&k)?.frequency_response(&omegas)?;
        for (name, delta, acceleration) in DIRECTIONS {
            let along = |g: &CMat, row: usize| -> C64 { (0..4).map(|j| g[(row, j)] * delta[j]).sum() };
            let folded = |g: &CMat, rows: &[usize]| -> f64 {
                rows.iter().zip(delta).map(|(row, d)| along(g, *row) * d).sum::<C64>().norm()
            };
            println!(
                "  {name}: largest over frequency, passive and active, and where the active one is above by most"
            );
            let tell = |what: &str, of: &dyn Fn(&CMat) -> f64| {
                let (p, a): (Vec<f64>, Vec<f64>) =
                    of_passive.iter().zip(&closed).map(|(p, a)| (of(p), of(a))).unzip();
                let most = |v: &[f64]| v.iter().copied().fold(0.0, f64::max);
                let size = most(&p);
                if size < 1e-9 {
                    println!("    {what:<13} none");
                    return;
                }
                let excess = |k: usize| (a[k] - p[k]) / size;
                let worst = (0..p.len()).max_by(|i, j| excess(*i).total_cmp(&excess(*j))).unwrap_or(0);
                println!(
                    "    {what:<13} {size:>10.4} {:>10.4}   {:+.1} % of the passive peak at {:.2} Hz",
                    most(&a),
                    100.0 * excess(worst),
                    hz(omegas[worst])
                );
            };
            tell("travel", &|g| folded(g, &TRAVEL));
            tell("tire", &|g| folded(g, &TIRE));
            tell("acceleration", &|g| along(g, acceleration).norm());
        }
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let orders: Vec<usize> = words.iter().filter_map(|w| w.parse().ok()).collect();
    let or = |default: &[usize]| if orders.is_empty() { default.to_vec() } else { orders.clone() };
    match words.first().map(String::as_str) {
        Some("directions") => directions(&or(&[6])),
        _ => over_bump(&or(&[1, 2, 3, 4])),
    }
}
