//! The half car of section 6.2 by matrix inequalities: output feedback from both travels, and one state feedback for a box of tire
//! dampings.
//!
//! `cargo run --release -p washboard --example study_half_car_lmi [printed|corrected] [tire dampings] [pitch inertia share]`

#![allow(clippy::print_stdout, dead_code)]

use std::error::Error;
use std::time::Instant;
use washboard::optimize::SdpSettings;
use washboard::study::lmi_cars::{HalfCar, gain, norms};
use washboard::synthesis::{LyapunovScale, MixedEnd, mixed_h2_hinf, robust_state_feedback};
use washboard::vehicle::{Disturbance, HalfCarVariant};

/// μ_road²v of chapter 6, m²/s.
const INTENSITY: f64 = 0.0027 * 0.0027 * 20.0;
const RHOS: [[f64; 2]; 2] = [[0.1, 1.5], [1.0, 1.0]];
const MOST_DAMPING: f64 = 100.0;

/// The least cost of each damping, and what its design does to the passive car.
fn output_feedback(
    car: &HalfCar,
    rho: [f64; 2],
    scale: LyapunovScale,
    steps: usize,
) -> Result<(), Box<dyn Error>> {
    println!("output feedback from both travels, (ρ₁, ρ₂) = {rho:?}, scale {scale:?}");
    println!(
        "  c_t: least cost (of the controller) | travel f r, tire f r, heave, pitch, ‖T‖∞ from heights, % | forces, N"
    );
    for k in 0..steps {
        let ct = MOST_DAMPING * k as f64 / (steps - 1) as f64;
        let plant = car.plant([ct, ct], Disturbance::RoadVelocity)?;
        let goals = HalfCar::goals(&plant, rho, scale)?;
        let begin = Instant::now();
        let found = match mixed_h2_hinf(&plant, &goals, &SdpSettings::default())? {
            MixedEnd::Found(found) => found,
            other => {
                println!("  {ct}: {other:?}");
                continue;
            }
        };
        let took = begin.elapsed();
        let (before, after) = (norms(&plant.passive())?, norms(&plant.close(&found.controller)?)?);
        let heights = car.plant([ct, ct], Disturbance::RoadDisplacement)?;
        let gains = [gain(&heights.passive(), &[2, 3])?, gain(&heights.close(&found.controller)?, &[2, 3])?];
        print!("  {ct:>5}: {:.5} ({:.5}) |", found.optimum, found.claims.objective);
        for k in 0..6 {
            print!(" {:+.1}", 100.0 * (after[k] / before[k] - 1.0));
        }
        print!(" {:+.1}", 100.0 * (gains[1] / gains[0] - 1.0));
        let rms = |k: usize| INTENSITY.sqrt() * after[k];
        println!(" | {:.2} {:.2} | {:?} {took:.2?}", rms(6), rms(7), found.iterations);
    }
    Ok(())
}

/// One gain for the corners of a box, and for no damping.
fn state_feedback(car: &HalfCar, rho: [f64; 2]) -> Result<(), Box<dyn Error>> {
    println!("state feedback, (ρ₁, ρ₂) = {rho:?}, scales at c_t = 0; rms at c_t = 100 N·s/m, both");
    let most = MOST_DAMPING;
    let corners = [[0.0, 0.0], [0.0, most], [most, 0.0], [most, most]];
    let plants = corners.map(|c| car.plant(c, Disturbance::RoadVelocity));
    let plants = plants.into_iter().collect::<Result<Vec<_>, _>>()?;
    let goals = HalfCar::goals(&plants[0], rho, LyapunovScale::Fixed(1.0))?;
    for (name, vertices) in [("c_t = 0", &plants[..1]), ("the box", &plants[..])] {
        let begin = Instant::now();
        let MixedEnd::Found(found) = robust_state_feedback(vertices, &goals, &SdpSettings::default())? else {
            println!("  {name}: none");
            continue;
        };
        let took = begin.elapsed();
        let Some(last) = plants.last() else { continue };
        let a = last.a() + last.b2() * &found.gain;
        let c = last.c1() + last.d12() * &found.gain;
        let closed = washboard::lti::StateSpace::continuous(a, last.b1(), c, last.d11())?;
        let rms: Vec<f64> = norms(&closed)?.iter().map(|n| n * INTENSITY.sqrt()).collect();
        println!("  {name}: {:.5}; {rms:.6?} | {:?} {took:.2?}", found.claims.objective, found.iterations);
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let argument = |i: usize| std::env::args().nth(i);
    let printed = argument(1).as_deref() == Some("printed");
    let variant = if printed { HalfCarVariant::AsPrinted } else { HalfCarVariant::Corrected };
    let steps = argument(2).map_or(Ok(21), |a| a.parse::<usize>())?.max(2);
    let inertia = argument(3).map_or(Ok(1.0), |a| a.parse::<f64>())?;
    let car = HalfCar { variant, inertia };
    println!("{variant:?} half car, {inertia} of its pitch inertia");
    for scale in [LyapunovScale::Fixed(1.0), LyapunovScale::Searched] {
        for rho in RHOS {
            output_feedback(&car, rho, scale, steps)?;
        }
    }
    RHOS.into_iter().try_for_each(|rho| state_feedback(&car, rho))
}
