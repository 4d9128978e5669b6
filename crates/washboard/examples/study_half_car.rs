//! The half car of section 6.1 over speed and tire damping: what no controller beats, how Padé's order gets there, and controllers
//! near it.
//!
//! `cargo run --release -p washboard --example study_half_car`

#![allow(clippy::print_stdout)]

use std::error::Error;
use washboard::cases::{self, CaseKind};
use washboard::lti::GeneralizedPlant;
use washboard::road::Coherence;
use washboard::synthesis::{full_information, near_limit};
use washboard::vehicle::{Disturbance, Output, PlantSettings, VehicleSpec};

const SPEEDS_M_S: [f64; 8] = [5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0];
const TIRE_DAMPINGS: [f64; 5] = [0.0, 50.0, 100.0, 500.0, 1000.0];
const LAMBDAS: [(&str, [f64; 6]); 2] =
    [("I", [1.0; 6]), ("diag(10 I, 100 I, I)", [10.0, 10.0, 100.0, 100.0, 1.0, 1.0])];
/// From here on the limit does not change by more than 1e-3, above 5 m/s by 1e-9 (the second table).
const CONVERGED: usize = 40;

/// Travels, tire deflections, heave and pitch acceleration; both travels measured; one track on the road of (7.2).
fn plant(
    tire_damping: f64,
    speed_m_s: f64,
    delay_order: usize,
    lambda: &[f64; 6],
) -> Result<GeneralizedPlant, Box<dyn Error>> {
    let road = cases::road("turkay-first-order")?.with_coherence(Coherence::Full);
    let case = cases::find("turkay-half-car", CaseKind::Vehicle)?;
    let spec: VehicleSpec = toml::from_str(&case.toml)?;
    let car = spec.with_overrides(&[("tire_damping_n_s_per_m".into(), tire_damping)])?.build_alone()?;
    let of = |base: &str| -> Vec<&Output> { car.outputs().iter().filter(|o| o.base == base).collect() };
    let travels = of("suspension_travel");
    let mut z = travels.clone();
    z.extend(of("tire_deflection"));
    z.extend([car.output("heave_acceleration")?, car.output("pitch_acceleration")?]);
    let disturbance = Disturbance::RoadNoise;
    let settings = PlantSettings { road: (&road).into(), speed_m_s, disturbance, delay_order };
    Ok(car.plant(&z, &travels, &settings)?.with_weights(lambda)?)
}

/// μ: the limit over the passive car's cost, roots of both.
fn mu(plant: &GeneralizedPlant) -> Result<f64, Box<dyn Error>> {
    Ok(full_information(plant)?.0 / plant.passive().h2_norm()?)
}

fn main() -> Result<(), Box<dyn Error>> {
    for (name, lambda) in &LAMBDAS {
        for order in [2, CONVERGED] {
            println!("μ for Λ = {name}, Padé's order {order}; columns: v = {SPEEDS_M_S:?} m/s");
            for ct in TIRE_DAMPINGS {
                print!("  c_t = {ct:>6}");
                for v in SPEEDS_M_S {
                    print!("  {:.6}", mu(&plant(ct, v, order, lambda)?)?);
                }
                println!();
            }
        }
    }
    let orders = [1, 2, 4, 8, 12, 16, 20, 24, 32, 40];
    println!("limit at c_t = 100 by Padé's order over that of order 48, less 1; columns: orders {orders:?}");
    for (name, lambda) in &LAMBDAS {
        for v in [5.0, 10.0, 20.0, 40.0] {
            let last = full_information(&plant(100.0, v, 48, lambda)?)?.0;
            print!("  Λ = {name}, v = {v:>4}");
            for order in orders {
                print!("  {:.1e}", full_information(&plant(100.0, v, order, lambda)?)?.0 / last - 1.0);
            }
            println!();
        }
    }
    for (name, lambda) in &LAMBDAS {
        for ct in [0.0, 100.0, 1000.0] {
            // a share that no loop in double precision reaches: the whole ladder
            let found = near_limit(&plant(ct, 20.0, 2, lambda)?, 1e-12)?;
            println!(
                "a controller from both travels, Λ = {name}, c_t = {ct}, v = 20: ends as {:?}",
                found.end
            );
            for step in &found.steps {
                println!(
                    "  ε = {:.0e}: cost/limit − 1 = {:.3e} ± {:.0e}, fastest pole {:.1e} rad/s",
                    step.epsilon, step.excess, step.rounding, step.fastest_rad_s
                );
            }
        }
    }
    Ok(())
}
