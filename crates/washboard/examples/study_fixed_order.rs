//! Fixed-order controllers of the thesis's quarter car (section 5.3) and full car (section 7.3).
//!
//! `cargo run --release -p washboard --example study_fixed_order [quarter|damping|robust|beaten|full|full-h2] [ORDER...]`

#![allow(clippy::print_stdout, clippy::indexing_slicing, dead_code)]

#[path = "common/fixed.rs"]
mod fixed;

use fixed::{W, Z, asked, channel, full_rms, full_targets, quarter, quarter_targets};
use std::error::Error;
use std::time::Instant;
use washboard::lti::{Continuous, GeneralizedPlant, LtiError, StateSpace};
use washboard::study::lmi_cars::{
    COMFORT, HEIGHTS, NOISES, TIRE, TRAVEL, full_car_on_heights, full_car_with_heights, gain, h2,
};
use washboard::synthesis::{
    Aim, FixedOrder, FixedOrderDesign, FixedOrderEnd, FixedOrderSettings, Measure, Target, fixed_order,
    full_information,
};

fn design(
    of: &FixedOrder,
    settings: &FixedOrderSettings,
) -> Result<Option<FixedOrderDesign>, Box<dyn Error>> {
    let begun = Instant::now();
    let end = fixed_order(of, settings)?;
    let took = begun.elapsed().as_secs_f64();
    let (d, how) = match end {
        FixedOrderEnd::NotStabilised { abscissa, .. } => {
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

/// The dependence on tire damping (figures 5.9–5.12): each point begun from the one before.
fn damping(orders: &[usize]) -> Result<(), Box<dyn Error>> {
    const CT: [f64; 7] = [98.0, 75.0, 50.0, 25.0, 10.0, 5.0, 1.0];
    // of each tire the order before
    let mut lower: Vec<Option<StateSpace<Continuous>>> = vec![None; CT.len()];
    for order in orders {
        let mut start: Vec<StateSpace<Continuous>> = Vec::new();
        for (ct, lower) in CT.into_iter().zip(&mut lower) {
            let plant = quarter(ct)?;
            let passive = plant.passive();
            let mut of = asked(vec![plant.clone()], quarter_targets(0, &passive, [1.0, 1.0])?, *order);
            of.starts.extend(start.iter().chain(lower.as_ref()).cloned());
            let FixedOrderEnd::Designed(d) = fixed_order(&of, &FixedOrderSettings::default())? else {
                println!("order {order}, c_t {ct}: bounds not met");
                continue;
            };
            let [z1, z2, z3] = rms(&plant, &d.controller)?;
            let p: Vec<f64> =
                (0..3).map(|r| Ok(W.sqrt() * h2(&passive, &[r])?)).collect::<Result<_, LtiError>>()?;
            println!(
                "order {order}, c_t {ct}: goal {:.5}; rms {z1:.5} {z2:.6} {z3:.6} (passive {:.5} {:.6} {:.6})",
                d.verified_goal.unwrap_or(f64::NAN),
                p[0],
                p[1],
                p[2]
            );
            *lower = Some(d.controller.clone());
            start = vec![d.controller];
        }
    }
    Ok(())
}

/// One controller for several tires, beside a controller for each alone, under each of them.
fn robust(orders: &[usize]) -> Result<(), Box<dyn Error>> {
    const CT: [f64; 4] = [0.0, 25.0, 50.0, 98.0];
    let plants = CT.iter().map(|ct| quarter(*ct)).collect::<Result<Vec<_>, _>>()?;
    let mut targets = Vec::new();
    for (k, p) in plants.iter().enumerate() {
        targets.extend(quarter_targets(k, &p.passive(), [1.0, 1.0])?);
    }
    let worst = |k: &StateSpace<Continuous>| -> Result<(f64, f64), Box<dyn Error>> {
        let (mut goal, mut excess) = (0.0f64, 0.0f64);
        for (i, p) in plants.iter().enumerate() {
            let closed = p.close(k)?;
            for t in targets.iter().filter(|t| t.plant == i) {
                let Measure::Hinf(c) = &t.measure else { continue };
                let norm =
                    if closed.is_stable()? { gain(&closed, &[c.outputs[0].0])? } else { f64::INFINITY };
                match t.aim {
                    Aim::Goal(unit) => goal = goal.max(norm / unit),
                    Aim::Bound(limit) => excess = excess.max(norm / limit - 1.0),
                }
            }
        }
        Ok((goal, excess))
    };
    for order in orders {
        println!("one controller for c_t = {CT:?}");
        let mut starts = Vec::new();
        for (k, ct) in CT.iter().enumerate() {
            let alone: Vec<Target> =
                targets.iter().filter(|t| t.plant == k).map(|t| Target { plant: 0, ..t.clone() }).collect();
            if let FixedOrderEnd::Designed(d) =
                fixed_order(&asked(vec![plants[k].clone()], alone, *order), &FixedOrderSettings::default())?
            {
                let (goal, excess) = worst(&d.controller)?;
                println!(
                    "  for c_t = {ct} alone: {:.5} there; worst of all four {goal:.5}, bounds exceeded by {excess:.2e}",
                    d.verified_goal.unwrap_or(f64::NAN)
                );
                starts.push(d.controller.clone());
            }
        }
        let mut of = asked(plants.clone(), targets.clone(), *order);
        of.starts = starts;
        if let Some(d) = design(&of, &FixedOrderSettings::default())? {
            println!("  worst of all four {:?}", worst(&d.controller)?);
            for v in d.values.iter().zip(&targets).filter(|(_, t)| matches!(t.aim, Aim::Goal(_))) {
                if let Aim::Goal(unit) = v.1.aim {
                    println!("    c_t = {}: {:.5}", CT[v.1.plant], v.0.value / unit);
                }
            }
        }
    }
    Ok(())
}

/// Table 5.2's first row, which has the least of every column: are there controllers below it in all three rms?
///
/// The largest rms over the row's is minimised. Of weights λ that sum to 1, max(zᵢ/rᵢ)² ≥ Σλᵢ(zᵢ/rᵢ)², and no controller
/// makes that less than the regulator of full information does: a bound that holds for every order. The printed digits are
/// truncated, so that .0040 stands for all below .0041: with rms of travel and tire below that, how far does z₁ fall?
fn beaten(orders: &[usize]) -> Result<(), Box<dyn Error>> {
    const ROW: [f64; 3] = [0.4627, 0.0040, 0.0016];
    let plant = quarter(98.0)?;
    let passive = plant.passive();
    let rms_of = |z: usize, aim: Aim| Target {
        plant: 0,
        measure: Measure::H2(channel(&[z], &[])),
        aim,
        name: format!("rms of {}", Z[z]),
    };
    let unit = |z: usize, value: f64| (z, value / W.sqrt());
    let as_printed: Vec<Target> =
        (0..3).map(|z| unit(z, ROW[z])).map(|(z, u)| rms_of(z, Aim::Goal(u))).collect();
    let below = |travel: f64, tire: f64| {
        let (z1, z2, z3) = (unit(0, ROW[0]), unit(1, travel), unit(2, tire));
        vec![rms_of(z1.0, Aim::Goal(z1.1)), rms_of(z2.0, Aim::Bound(z2.1)), rms_of(z3.0, Aim::Bound(z3.1))]
    };
    let readings = [
        ("the row to the last digit", as_printed),
        ("rounded: travel < .00405, tire < .00165", below(0.00405, 0.00165)),
        ("truncated, as the thesis does: travel < .0041, tire < .0017", below(0.0041, 0.0017)),
    ];
    for (what, targets) in readings {
        println!("{what}");
        for order in orders {
            // the norms' bounds of problem 5.3.1 besides, the peak of the acceleration included
            let mut all = targets.clone();
            let mut norms = quarter_targets(0, &passive, [1.0, 1.0])?;
            norms[0].aim = Aim::Bound(gain(&passive, &[0])?);
            all.extend(norms);
            let of = asked(vec![plant.clone()], all, *order);
            let Some(d) = design(&of, &FixedOrderSettings::default())? else { continue };
            println!("    rms {:?}", rms(&plant, &d.controller)?);
            let goals = d.values.iter().zip(&of.targets).filter(|(_, t)| matches!(t.aim, Aim::Goal(_)));
            let held: Vec<(f64, f64)> = goals
                .filter_map(|(v, t)| match t.aim {
                    Aim::Goal(unit) => Some((v.multiplier, unit)),
                    Aim::Bound(_) => None,
                })
                .collect();
            if let [_, _, _] = held[..] {
                let sum: f64 = held.iter().map(|h| h.0).sum();
                let weights: Vec<f64> = held.iter().map(|(l, unit)| (l / sum).sqrt() / unit).collect();
                let (least, _) = full_information(&plant.with_weights(&weights)?)?;
                println!("    no controller of any order has less than {least:.6}");
            }
        }
    }
    Ok(())
}

/// Table 7.2's problem.
fn full(orders: &[usize]) -> Result<(), Box<dyn Error>> {
    let (plant, with_noise) = (full_car_on_heights()?, full_car_with_heights()?);
    let targets = full_targets(&plant.passive(), &[0, 1, 2, 3])?;
    let mut starts = Vec::new();
    for order in orders {
        let mut of = asked(vec![plant.clone()], targets.clone(), *order);
        of.starts.clone_from(&starts);
        let settings = FixedOrderSettings { lower_orders: false, ..FixedOrderSettings::default() };
        if let Some(d) = design(&of, &settings)? {
            println!("    rms {:.5?}", full_rms(&with_noise, &d.controller)?);
            starts.push(d.controller.clone());
        }
    }
    Ok(())
}

/// The same with an H2 goal: every rms below the printed row of order 6.
fn full_h2(orders: &[usize]) -> Result<(), Box<dyn Error>> {
    // accelerations, travel, tire
    const ROW: [f64; 5] = [1.8795, 1.3157, 3.0871, 0.0765, 0.0237];
    let plant = full_car_with_heights()?;
    let bounds = full_targets(&plant.passive(), &HEIGHTS)?;
    let parts: [(&[usize], f64, &str); 5] = [
        (&COMFORT[..1], ROW[0], "heave"),
        (&COMFORT[1..2], ROW[1], "pitch"),
        (&COMFORT[2..3], ROW[2], "roll"),
        (&TRAVEL, ROW[3], "travel"),
        (&TIRE, ROW[4], "tire"),
    ];
    let rms: Vec<Target> = parts
        .iter()
        .map(|(rows, unit, name)| Target {
            plant: 0,
            measure: Measure::H2(channel(rows, &NOISES)),
            aim: Aim::Goal(*unit),
            name: format!("rms of {name}"),
        })
        .collect();
    for with_bounds in [false, true] {
        let mut targets = rms.clone();
        if with_bounds {
            targets.extend(bounds[1..].iter().cloned());
        }
        println!("largest rms over the printed row of order 6, norms bounded: {with_bounds}");
        for order in orders {
            let of = asked(vec![plant.clone()], targets.clone(), *order);
            let settings =
                FixedOrderSettings { lower_orders: false, tries: 4, ..FixedOrderSettings::default() };
            if let Some(d) = design(&of, &settings)? {
                println!("    rms {:.5?}", full_rms(&plant, &d.controller)?);
            }
        }
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let orders: Vec<usize> = words.iter().filter_map(|w| w.parse().ok()).collect();
    let or = |default: &[usize]| if orders.is_empty() { default.to_vec() } else { orders.clone() };
    match words.first().map_or("quarter", String::as_str) {
        "damping" => damping(&or(&[1, 2, 3, 4])),
        "robust" => robust(&or(&[1, 2])),
        "beaten" => beaten(&or(&[1, 2])),
        "full" => full(&or(&[2, 4, 6, 8, 10])),
        "full-h2" => full_h2(&or(&[2, 4, 6])),
        _ => quarter_table(&or(&[1, 2, 3, 4])),
    }
}
