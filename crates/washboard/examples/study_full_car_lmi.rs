//! The full car of section 7.2 by matrix inequalities: comfort, travel and tire load with all poles in a rectangle, truncated.
//!
//! `cargo run --release -p washboard --example study_full_car_lmi [trade-off]`

#![allow(clippy::print_stdout, dead_code)]

use std::error::Error;
use std::time::Instant;
use washboard::lti::{Continuous, GeneralizedPlant, LtiError, StateSpace};
use washboard::optimize::SdpSettings;
use washboard::study::lmi_cars::{
    COMFORT, HEIGHTS, NOISES, TIRE, TRAVEL, full_car, full_car_goals, full_car_with_heights, gain, h2,
};
use washboard::synthesis::{
    LyapunovScale, MixedController, MixedEnd, MixedGoals, lqr_of_output, mixed_h2_hinf,
};

fn say(name: &str, s: &StateSpace<Continuous>) -> Result<(), LtiError> {
    println!(
        "  {name}: accelerations {:.5} {:.5} {:.5} together {:.5}; travel {:.6}; tire {:.6}; ‖T∞‖ {:.8}; force {:.1} N",
        h2(s, &[0])?,
        h2(s, &[1])?,
        h2(s, &[2])?,
        h2(s, &COMFORT)?,
        h2(s, &TRAVEL)?,
        h2(s, &TIRE)?,
        gain(s, &TIRE)?,
        h2(s, &[11, 12, 13, 14])?
    );
    Ok(())
}

fn from_noises(system: &StateSpace<Continuous>) -> Result<StateSpace<Continuous>, LtiError> {
    system.select(&(0..system.outputs()).collect::<Vec<_>>(), &NOISES)
}

fn design(
    plant: &GeneralizedPlant,
    [lambda, mu]: [f64; 2],
    decay: f64,
    tire_inputs: [usize; 4],
    scale: LyapunovScale,
) -> Result<Option<MixedController>, Box<dyn Error>> {
    let begin = Instant::now();
    let goals = MixedGoals { scale, ..full_car_goals(plant, [lambda, mu], decay, tire_inputs)? };
    let end = mixed_h2_hinf(plant, &goals, &SdpSettings::default())?;
    let took = begin.elapsed();
    let MixedEnd::Found(found) = end else {
        println!("λ {lambda:.1} μ {mu}: {end:?}");
        return Ok(None);
    };
    let (Some(claimed), Some(h2)) = (found.claims.h2.first(), found.achieved.h2.first()) else {
        return Ok(None);
    };
    println!(
        "λ {lambda:.1} μ {mu}, poles left of −{decay}: least cost {:.6}, controller {:.6}; ‖T₂‖ claimed {claimed:.6} has {h2:.6}, ‖T∞‖ {:.6} {:.6}; without √(1 − λ), √λ {:.6} {:.6} | {:?} {took:.2?}",
        found.optimum,
        found.claims.objective,
        found.claims.hinf[0],
        found.achieved.hinf[0],
        h2 / (1.0 - lambda).sqrt(),
        found.achieved.hinf[0] / lambda.sqrt(),
        found.iterations
    );
    say("active", &from_noises(&plant.close(&found.controller)?)?)?;
    Ok(Some(found))
}

const FIXED: LyapunovScale = LyapunovScale::Fixed(1.0);
/// A regulator's force weight, 1/N: three accelerations do not weigh four forces.
const FORCE: f64 = 1e-5;

/// The regulator of all states with the weights of Λ₂, without and with tire deflections against the passive ones.
fn regulator(plant: &GeneralizedPlant, mu: f64) -> Result<(), Box<dyn Error>> {
    let passive = plant.passive();
    let (a2, a3) = (mu / h2(&passive, &COMFORT)?, (1.0 - mu) / h2(&passive, &TRAVEL)?);
    let tire = 1.0 / h2(&passive, &TIRE)?;
    for (name, a1) in [("Λ₂ alone", 0.0), ("Λ₂ and tires", 1.0)] {
        let mut weights = vec![0.0; plant.nz()];
        COMFORT.iter().for_each(|k| weights[*k] = a2);
        TRAVEL.iter().for_each(|k| weights[*k] = a3);
        TIRE.iter().for_each(|k| weights[*k] = a1 * tire);
        weights[11..].fill(FORCE);
        let weighted = plant.with_weights(&weights)?;
        let found = lqr_of_output(weighted.a(), &weighted.b2(), &weighted.c1(), &weighted.d12())?;
        let a = plant.a() + plant.b2() * &found.gain;
        let c = plant.c1() + plant.d12() * &found.gain;
        say(&format!("LQR, {name}"), &StateSpace::continuous(a, plant.b1(), c, plant.d11())?)?;
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let plant = full_car()?;
    println!("{} states, {} measurements", plant.order(), plant.ny());
    say("passive", &plant.passive())?;
    if std::env::args().nth(1).is_some() {
        for mu in [0.5, 0.9, 0.0, 1.0] {
            for k in 1..10 {
                design(&plant, [0.1 * f64::from(k), mu], 0.0, NOISES, FIXED)?;
            }
        }
        return Ok(());
    }
    regulator(&plant, 0.6)?;
    for decay in [0.0, 0.2] {
        let Some(found) = design(&plant, [0.6, 0.6], decay, NOISES, FIXED)? else { continue };
        for order in [10, 8, 6] {
            let reduced = found.controller.balanced_truncation(order).map(|r| plant.close(&r.system));
            match reduced {
                Ok(closed) => {
                    let closed = closed?;
                    match closed.check_stable("the loop") {
                        Ok(()) => say(&format!("order {order}"), &closed)?,
                        Err(e) => println!("  order {order}: {e}"),
                    }
                }
                Err(e) => println!("  order {order}: {e}"),
            }
        }
    }
    // heights in m beside noises of unit intensity: a fixed scale would be a choice of units
    println!("with the tires' norm from the wheels' heights");
    let plant = full_car_with_heights()?;
    say("passive", &from_noises(&plant.passive())?)?;
    design(&plant, [0.6, 0.6], 0.2, HEIGHTS, LyapunovScale::Searched)?;
    Ok(())
}
