//! Türkay's half car (section 6.1) and truck cabin (chapter 8).

use washboard::cases;
use washboard::lti::GeneralizedPlant;
use washboard::road::{Coherence, Road, Spectrum};
use washboard::synthesis::{Certificate, LqgWeights, full_information, h2_limit, lqg};
use washboard::vehicle::{Disturbance, Output, PlantSettings, Vehicle};

fn plant(car: &Vehicle, road: &Road, z: &[&str], y: &[&str], delay_order: usize) -> GeneralizedPlant {
    plant_of(car, road, z, y, delay_order, Disturbance::RoadNoise)
}

/// At 20 m/s.
pub fn plant_of(
    car: &Vehicle,
    road: &Road,
    z: &[&str],
    y: &[&str],
    delay_order: usize,
    disturbance: Disturbance,
) -> GeneralizedPlant {
    let find = |names: &[&str]| -> Vec<Output> {
        let of = |n: &&str| {
            car.outputs().iter().filter(|o| o.name == *n || o.base == *n).cloned().collect::<Vec<_>>()
        };
        names.iter().flat_map(of).collect()
    };
    let (z, y) = (find(z), find(y));
    let settings = PlantSettings { road: road.into(), speed_m_s: 20.0, disturbance, delay_order };
    car.plant(&z.iter().collect::<Vec<_>>(), &y.iter().collect::<Vec<_>>(), &settings).unwrap()
}

#[test]
fn the_half_cars_h2_index_is_the_notes() {
    // notes on chapter 6, corrected model, v = 20, c_t = 0, 100, 1000; the road of (7.2) under both wheels, 11 states
    let road = cases::road("turkay-first-order").unwrap().with_coherence(Coherence::Full);
    let z = ["suspension_travel", "tire_deflection", "heave_acceleration", "pitch_acceleration"];
    for (lambda, known) in [
        ([1.0, 1.0, 1.0, 1.0, 1.0, 1.0], [0.116088, 0.034781, 0.030482]),
        ([10.0, 10.0, 100.0, 100.0, 1.0, 1.0], [0.814387, 0.780011, 0.559402]),
    ] {
        for (ct, known) in [0.0, 100.0, 1000.0].into_iter().zip(known) {
            let spec: washboard::vehicle::VehicleSpec =
                toml::from_str(&cases::find("turkay-half-car", cases::CaseKind::Vehicle).unwrap().toml)
                    .unwrap();
            let car =
                spec.with_overrides(&[("tire_damping_n_s_per_m".into(), ct)]).unwrap().build_alone().unwrap();
            let p = plant(&car, &road, &z, &["suspension_travel"], 2).with_weights(&lambda).unwrap();
            assert_eq!(p.order(), 11);
            let (limit, _) = full_information(&p).unwrap();
            let index = limit / p.passive().h2_norm().unwrap();
            assert!((index - known).abs() < 1.5e-6, "c_t {ct}: {index} {known}");
            let closed = h2_limit(&p).unwrap().h2;
            assert!((closed / limit - 1.0).abs() < 1e-9, "{closed} {limit}");
        }
    }
}

#[test]
fn pades_order_converges() {
    let road = cases::road("turkay-first-order").unwrap().with_coherence(Coherence::Full);
    let car = cases::vehicle("turkay-half-car").unwrap();
    let z = ["suspension_travel", "tire_deflection", "heave_acceleration", "pitch_acceleration"];
    let limit = |order| full_information(&plant(&car, &road, &z, &["suspension_travel"], order)).unwrap().0;
    // the wheels hop at 67 rad/s, 13 rad within the delay of 0.2 s: orders below that see other interference
    let orders = [2, 8, 12, 16, 24, 36];
    let values: Vec<f64> = orders.into_iter().map(limit).collect();
    for (order, v) in orders.iter().zip(&values) {
        println!("Padé of order {order}: limit {v:.6}");
    }
    let off = |k: usize| (values[k] / values[5] - 1.0).abs();
    assert!(off(4) < 1e-5 && off(3) < 1e-3 && off(4) < off(3) && off(3) < off(2), "{values:?}");
}

/// Chassis displacements roll off below 0.1 rad/s, (8.6).
fn cabin_road() -> Road {
    let gain = std::f64::consts::TAU * 0.15708 * 0.76e-5f64.sqrt();
    Road::new(Spectrum::first_order(gain, 0.1 / 20.0).unwrap(), Coherence::Independent)
}

#[test]
fn the_truck_cabin_comes_out_as_printed_and_as_it_should() {
    let cabin = cases::vehicle("turkay-truck-cabin").unwrap();
    let z = ["heave_acceleration", "pitch_acceleration", "roll_acceleration"];
    let p = plant(&cabin, &cabin_road(), &z, &["body_acceleration", "suspension_travel"], 0);
    assert_eq!(p.order(), 34);
    let rms = |c: &Certificate| -> Vec<f64> { c.channels.iter().map(|c| c.h2.unwrap()).collect() };
    let passive = rms(&Certificate::passive(&p).unwrap());
    let near = |found: &[f64], known: &[f64], digits: f64| {
        for (a, b) in found.iter().zip(known) {
            assert!((a - b).abs() <= digits, "{found:?} {known:?}");
        }
    };
    near(&passive, &[0.7102, 0.5950, 1.3389], 1e-4);
    let weighted = p.with_weights(&passive.iter().map(|r| 1.0 / r).collect::<Vec<_>>()).unwrap();
    // ρ = 1e-3 squared, ε = 1e-5; forces are performances of the same plant
    let forces =
        plant(&cabin, &cabin_road(), &["actuator_force"], &["body_acceleration", "suspension_travel"], 0);
    for (cross_term, accelerations, known_forces, digits) in [
        (false, [0.5201, 0.4559, 0.8432], [113.05, 82.41], 0.06),
        (true, [0.0830, 0.0586, 0.2266], [271.0, 192.0], 0.6),
    ] {
        let weights = LqgWeights {
            sensor_noise: vec![1e-5; 8],
            input_weight: vec![1e-6; 4],
            cross_term,
            ..LqgWeights::default()
        };
        let found = lqg(&weighted, &weights).unwrap();
        let recomputed = washboard::synthesis::lqg_plant(&weighted, &weights).unwrap();
        let h2 = recomputed.close(&found.controller).unwrap().h2_norm().unwrap();
        assert!((h2 / found.claimed_h2 - 1.0).abs() < 1e-7, "{h2} {}", found.claimed_h2);
        near(&rms(&Certificate::of(&p, &found.controller).unwrap()), &accelerations, 1.5e-4);
        let u = forces.close(&found.controller).unwrap().h2_of_outputs().unwrap();
        near(&[u[0], u[2]], &known_forces, digits);
        assert!((u[0] / u[1] - 1.0).abs() < 1e-6 && (u[2] / u[3] - 1.0).abs() < 1e-6, "{u:?}");
    }
}

#[test]
fn the_cabins_shaping_filter_is_figure_8_3() {
    // the chassis on white road velocity, and behind the leak of (8.6), λ = 0.1: alike above 0.02 Hz
    let truck = cases::vehicle("turkay-bounce-truck").unwrap();
    let white = cases::road("turkay-white-velocity").unwrap();
    let chassis = truck.output("sprung_displacement").unwrap();
    let psd = |road: &Road, omega: f64| {
        washboard::vehicle::Ride::new(&truck, road, 20.0).unwrap().spectrum(&[chassis], omega).unwrap()
            [(0, 0)]
            .re
    };
    for hz in [0.02, 0.05, 0.1, 1.0, 1.6, 3.0, 10.0, 18.0] {
        let omega = std::f64::consts::TAU * hz;
        let (exact, leaking) = (psd(&white, omega), psd(&cabin_road(), omega));
        // |ω/(iω + λ)|²
        let known = omega * omega / (omega * omega + 0.01);
        assert!((leaking / exact - known).abs() < 1e-9, "{hz} Hz: {} {known}", leaking / exact);
        assert!(hz < 0.05 || known > 0.9);
    }
}

#[test]
fn a_cabin_may_be_held_in_pitch_alone() {
    let cabin = cases::vehicle("turkay-truck-cabin").unwrap();
    let z = ["heave_acceleration", "pitch_acceleration", "roll_acceleration"];
    let y = ["body_acceleration", "suspension_travel"];
    let p = plant(&cabin, &cabin_road(), &z, &y, 0);
    let rms = |c: &Certificate| -> Vec<f64> { c.channels.iter().map(|c| c.h2.unwrap()).collect() };
    let passive = rms(&Certificate::passive(&p).unwrap());
    let goal = plant(&cabin, &cabin_road(), &z[1..2], &y, 0).with_weights(&[1.0 / passive[1]]).unwrap();
    let weights =
        LqgWeights { sensor_noise: vec![1e-5; 8], input_weight: vec![1e-6; 4], ..LqgWeights::default() };
    let found = rms(&Certificate::of(&p, &lqg(&goal, &weights).unwrap().controller).unwrap());
    // front and rear push against each other: pitch is held, roll is left alone by symmetry
    assert!(found[1] < 0.2 * passive[1], "{found:?} {passive:?}");
    assert!((found[2] / passive[2] - 1.0).abs() < 1e-6, "{found:?} {passive:?}");
}

/// Delays of high order beside 34 states: the inner factor's complement would lose all digits.
#[test]
fn the_cabins_limit_has_two_routes_at_every_delay_order() {
    let cabin = cases::vehicle("turkay-truck-cabin").unwrap();
    let road = cabin_road().with_coherence(Coherence::Full);
    let z = ["heave_acceleration", "suspension_travel"];
    let mut first = None;
    for order in [4, 12, 20] {
        let p = plant(&cabin, &road, &z, &["suspension_travel"], order);
        let weights = LqgWeights {
            sensor_noise: vec![0.0; p.ny()],
            input_weight: vec![1e-8; p.nu()],
            ..LqgWeights::default()
        };
        let p = washboard::synthesis::lqg_plant(&p, &weights).unwrap();
        let (riccati, _) = full_information(&p).unwrap();
        let closed = h2_limit(&p).unwrap().h2;
        assert!((closed / riccati - 1.0).abs() < 1e-9, "order {order}: {closed} {riccati}");
        let known = *first.get_or_insert(riccati);
        assert!((riccati / known - 1.0).abs() < 1e-3, "order {order}: {riccati} {known}");
    }
}
