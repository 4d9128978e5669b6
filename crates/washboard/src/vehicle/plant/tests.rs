use super::*;
use crate::linalg::{C64, CMat};
use crate::road::{Coherence, Road};
use crate::vehicle::Ride;
use crate::vehicle::test_cases as cases;

fn names<'a>(car: &'a Vehicle, names: &[&str]) -> Vec<&'a Output> {
    names.iter().map(|n| car.output(n).unwrap()).collect()
}

fn on<'a>(road: &'a Road, disturbance: Disturbance) -> PlantSettings<'a> {
    PlantSettings { road: road.into(), speed_m_s: 20.0, disturbance, delay_order: DELAY_ORDER }
}

/// The response to heights, by mechanics, must be that of the plant: a second route through M, C, K at one frequency.
#[test]
fn responses_are_the_vehicles_own() {
    for case in ["turkay-quarter-car", "turkay-half-car", "chalasani-full-car", "guiggiani-full-car"] {
        let car = cases::vehicle(case).unwrap();
        let road = cases::road("turkay-white-velocity").unwrap().with_coherence(Coherence::Independent);
        let outputs: Vec<&Output> = car.outputs().iter().collect();
        let omega = 9.3;
        let s = C64::new(0.0, omega);
        let known = car.output_response(&outputs, omega).unwrap();
        let mut tried = 0;
        for (disturbance, scale) in
            [(Disturbance::RoadVelocity, s), (Disturbance::RoadDisplacement, C64::new(1.0, 0.0))]
        {
            for (i, o) in outputs.iter().enumerate() {
                let Ok(plant) = car.plant(&[o], &[], &on(&road, disturbance)) else { continue };
                tried += 1;
                let g = plant.passive().at(s).unwrap();
                for j in 0..car.wheels().len() {
                    let found = g[(0, j)] * scale;
                    let size = known[(i, j)].norm().max(1e-6);
                    assert!(
                        (found - known[(i, j)]).norm() < 1e-9 * size,
                        "{case} {} {j}: {found} {}",
                        o.name,
                        known[(i, j)]
                    );
                }
            }
        }
        assert!(tried > outputs.len(), "{case}: {tried}");
    }
}

/// The response to a force: the same dynamic stiffness.
#[test]
fn forces_act_where_they_should() {
    let car = cases::vehicle("turkay-half-car").unwrap();
    let road = cases::road("turkay-white-velocity").unwrap();
    let z = names(&car, &["heave_acceleration", "suspension_travel_front", "actuator_force_rear"]);
    let plant = car.plant(&z, &z, &on(&road, Disturbance::RoadVelocity)).unwrap();
    let (omega, nw) = (7.0, plant.nw());
    let g = plant.system().at(C64::new(0.0, omega)).unwrap();
    let columns = car.actuator_columns(&[0, 1]);
    let forces = CMat::from_fn(columns.nrows(), 2, |i, j| C64::new(columns[(i, j)], 0.0));
    let q = crate::linalg::solve_complex(&car.system().dynamic_stiffness(omega), &forces).unwrap();
    for (i, o) in z.iter().enumerate() {
        for j in 0..2 {
            let mut known = C64::new(o.u.get(j).copied().unwrap_or(0.0), 0.0);
            for (d, power) in [1.0, omega, -omega * omega].into_iter().enumerate() {
                let unit = if d == 1 { C64::new(0.0, power) } else { C64::new(power, 0.0) };
                known += o.q[d].iter().enumerate().map(|(k, v)| q[(k, j)] * *v).sum::<C64>() * unit;
            }
            assert!((g[(i, nw + j)] - known).norm() < 1e-12 * known.norm().max(1e-9), "{} {j}", o.name);
        }
    }
}

#[test]
fn the_h2_norm_is_the_ride() {
    // delays exact in the ride, Padé's in the plant
    for (case, road, z) in [
        (
            "turkay-quarter-car",
            "turkay-white-velocity",
            ["sprung_acceleration", "suspension_travel", "tire_deflection"],
        ),
        (
            "turkay-half-car",
            "turkay-first-order",
            ["heave_acceleration", "suspension_travel_front", "tire_deflection_rear"],
        ),
        (
            "chalasani-full-car",
            "turkay-first-order",
            ["heave_acceleration", "pitch_acceleration", "tire_deflection_rear_left"],
        ),
    ] {
        let (car, road) = (cases::vehicle(case).unwrap(), cases::road(road).unwrap());
        for coherence in [Coherence::Independent, Coherence::None] {
            let road = road.with_coherence(coherence);
            let z = names(&car, &z);
            let settings = PlantSettings { delay_order: 12, ..on(&road, Disturbance::RoadNoise) };
            let plant = car.plant(&z, &[], &settings).unwrap();
            let rms = plant.passive().h2_of_outputs().unwrap();
            let exact = Ride::new(&car, &road, 20.0).unwrap().variances(&z).unwrap();
            let tolerance = if coherence == Coherence::Independent { 1e-9 } else { 2e-3 };
            for (found, known) in rms.iter().zip(&exact) {
                let known = known.rms().unwrap();
                assert!((found / known - 1.0).abs() < tolerance, "{case}: {found} {known}");
            }
        }
    }
}

#[test]
fn what_cannot_be_a_plant_is_said() {
    let car = cases::vehicle("guiggiani-full-car").unwrap();
    let z = names(&car, &["heave_acceleration"]);
    let iso = cases::road("iso8608-c").unwrap();
    let refused = |road: &Road, d| car.plant(&z, &z, &on(road, d)).unwrap_err().to_string();
    assert!(refused(&iso, Disturbance::RoadVelocity).contains("bogsjo"));
    let full = iso.with_coherence(Coherence::Full);
    assert!(refused(&full, Disturbance::RoadNoise).contains("no rational shaping filter"));
    let hub = names(&car, &["tire_force_front_left"]);
    let e = car.plant(&hub, &[], &on(&full, Disturbance::RoadDisplacement)).unwrap_err().to_string();
    assert!(e.contains("`tire_force_front_left` contains the derivative of the road's height"), "{e}");
    assert_eq!(
        car.plant(&z, &z, &on(&full, Disturbance::RoadVelocity)).unwrap().signals().disturbances,
        ["road"]
    );
}

#[test]
fn tires_follow_no_height_whatever_the_levers_are() {
    // 1.5 and 2.5 m come out round in K⁻¹K_w, 5 % less does not: no state for a height that rounding alone shows
    let road = cases::road("turkay-white-velocity").unwrap();
    let mut orders = Vec::new();
    for share in [1.0, 0.95, 0.87, 1.05] {
        let fields = [
            ("front_axle_m".to_owned(), 1.5 * share),
            ("front.suspension_stiffness_n_per_m".to_owned(), 16e3 * share),
        ];
        let car = cases::spec("turkay-half-car").with_overrides(&fields).unwrap().build_alone().unwrap();
        let z = names(&car, &["tire_deflection_front", "tire_deflection_rear", "suspension_travel_rear"]);
        orders.push(car.plant(&z, &[], &on(&road, Disturbance::RoadVelocity)).unwrap().order());
        let found = Ride::new(&car, &road, 20.0).unwrap().variances(&z).unwrap();
        assert!(found.iter().all(|v| v.rms().is_some()), "{share}: {found:?}");
    }
    assert!(orders.iter().all(|n| *n == orders[0]), "{orders:?}");
}
