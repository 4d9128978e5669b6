//! Achievable performance of the thesis's quarter car: constraints, the hybrid design over tire damping, near-optimal costs.
//!
//! `cargo run --release -p washboard --example study_achievable`

#![allow(clippy::print_stdout)]

use washboard::synthesis::achievable::{
    AchievableError, HybridSettings, Measurement, Psi, QuarterCar, QuarterCarNumbers, Regularisation,
    Response, Youla, hybrid, hybrid_over_tire_damping, near_optimal,
};

fn main() -> Result<(), AchievableError> {
    let car = |ct| {
        QuarterCar::new(&QuarterCarNumbers {
            ms: 240.0,
            mu: 36.0,
            ks: 16_000.0,
            cs: 980.0,
            kt: 160_000.0,
            ct,
        })
    };
    let both = [Measurement::Acceleration, Measurement::Travel];
    for ct in [0.0, 98.0] {
        for (name, measurements) in [("y2", &both[1..]), ("[y1 y2]", &both[..])] {
            println!("c_t = {ct}, y = {name}");
            for response in Response::ALL {
                for line in Youla::new(&car(ct)?, measurements)?.constraints(response)?.lines() {
                    println!("  {line}");
                }
            }
        }
    }
    let settings = HybridSettings {
        fictitious_tire_damping: 1960.0,
        psi: Psi::PRINTED,
        sensor_noise: 1e-8,
        road_velocity_intensity: 1.480625e-4,
    };
    match hybrid(&car(98.0)?, &settings)? {
        Ok(found) => {
            println!("hybrid: deg Q {} deg K {}", found.q_hat.degree(), found.controller.degree());
            println!("  H1 off by {:.1e}; {:?}", found.match_error, found.rms);
            found.warnings.iter().for_each(|w| println!("  {w}"));
        }
        Err(why) => println!("hybrid: {why}"),
    }
    // figures 4.11 and 4.12
    let dampings: Vec<f64> = (0..101).map(|k| 0.98 + f64::from(k) * (98.0 - 0.98) / 100.0).collect();
    let curve = hybrid_over_tire_damping(&car(98.0)?, &settings, &dampings, (0.1, 100.0, 61))?;
    for at in curve.at.iter().step_by(20) {
        println!("c_t = {:.3}: rms LQG {:.6?} hybrid {:.6?}", at.tire_damping, at.lqg.rms, at.hybrid.rms);
    }
    let db = |x: f64| 20.0 * x.log10();
    let range = |of: &dyn Fn(usize) -> Vec<f64>| {
        let over = |v: Vec<f64>| {
            db(v.iter().copied().fold(0.0, f64::max) / v.iter().copied().fold(f64::MAX, f64::min))
        };
        (0..curve.freq_hz.len()).map(|k| over(of(k))).fold(0.0, f64::max)
    };
    println!(
        "over the dampings |K| moves by at most {:.2} dB (LQG) and {:.2} dB (hybrid), |T_uV| by {:.2} and {:.2} dB",
        range(&|k| curve.at.iter().map(|a| a.lqg.gain[k]).collect()),
        range(&|k| curve.at.iter().map(|a| a.hybrid.gain[k]).collect()),
        range(&|k| curve.at.iter().map(|a| a.lqg.force[k]).collect()),
        range(&|k| curve.at.iter().map(|a| a.hybrid.force[k]).collect()),
    );
    if let Some(last) = curve.at.last() {
        let most = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| db(x / y)).fold(f64::MIN, f64::max);
        println!(
            "hybrid over LQG on the same tire: |K| by at most {:.2} dB, |T_uV| by {:.2} dB",
            most(&last.hybrid.gain, &last.lqg.gain),
            most(&last.hybrid.force, &last.lqg.force)
        );
    }
    for ct in [0.0, 98.0] {
        for weights in [[1.0, 1.0, 1.0], [1.0, 10.0, 100.0]] {
            for k in 2..8 {
                let small = 10f64.powi(-k);
                let found =
                    near_optimal(&car(ct)?, weights, Regularisation { epsilon_rad_s: small, tau_s: small })?;
                let held = match &found.certificate {
                    Ok(_) => "confirmed in double precision".to_owned(),
                    Err(why) => why.to_string(),
                };
                println!(
                    "c_t = {ct}, Λ = {weights:?}, τ = ε = {small:.0e}: cost/limit − 1 = {:.3e}; {held}",
                    found.h2 / found.limit - 1.0
                );
            }
        }
    }
    Ok(())
}
