//! Against the sum over modes, and against the cars that the modes were taken from.

use super::*;
use crate::files::parse_toml;
use crate::road::RoadSpec;
use crate::vehicle::{QuarterCar, Ride, VehicleSpec};
use std::path::Path;

/// Rounding of a solve against a sum of a few terms.
const ROUNDING: f64 = 1e-12;

const CAR: &str = r#"
model = "full-car"
[full-car]
sprung_mass_kg = 1150.0
roll_inertia_kg_m2 = 530.0
pitch_inertia_kg_m2 = 1630.0
front_axle_m = 1.064
rear_axle_m = 1.596
front_track_m = 1.49
rear_track_m = 1.45
cg_left_m = 0.03
front = { unsprung_mass_kg = 57.5, suspension_stiffness_n_per_m = [15750.0, 16000.0], suspension_damping_n_s_per_m = 1475.0, tire_stiffness_n_per_m = 140000.0, tire_damping_n_s_per_m = 150.0, anti_roll_stiffness_n_m_per_rad = 8000.0 }
rear  = { unsprung_mass_kg = 51.5, suspension_stiffness_n_per_m = 14000.0, suspension_damping_n_s_per_m = [1310.0, 1500.0], tire_stiffness_n_per_m = 150000.0, tire_damping_n_s_per_m = 120.0 }
"#;

fn spec(text: &str) -> VehicleSpec {
    parse_toml(text, Path::new("v.toml")).unwrap()
}

fn car() -> Vehicle {
    spec(CAR).build_alone().unwrap()
}

/// A damper that is strong enough for two real poles.
fn overdamped() -> Vehicle {
    let car = QuarterCar {
        sprung_mass_kg: 240.0,
        unsprung_mass_kg: 36.0,
        suspension_stiffness_n_per_m: 16e3,
        suspension_damping_n_s_per_m: 9000.0,
        tire_stiffness_n_per_m: 160e3,
        tire_damping_n_s_per_m: 100.0,
        damper_curve: None,
    };
    VehicleSpec::from(car).build_alone().unwrap()
}

fn road(text: &str) -> crate::road::Road {
    parse_toml::<RoadSpec>(text, Path::new("r.toml")).unwrap().build_in(Path::new("r.toml")).unwrap()
}

#[test]
fn the_transfer_function_is_the_sum_over_modes() {
    for vehicle in [car(), overdamped()] {
        let response = Response::of(&vehicle).unwrap();
        let realised = response.assemble().unwrap();
        let outputs: Vec<&Output> =
            response.output.iter().map(|o| realised.output(&o.name).unwrap()).collect();
        let theirs: Vec<&Output> = response.output.iter().map(|o| vehicle.output(&o.name).unwrap()).collect();
        for omega in [0.0, 1.0, 9.0, 60.0, 75.0, 400.0] {
            let h = realised.output_response(&outputs, omega).unwrap();
            let iw = C64::new(0.0, omega);
            let sum = CMat::from_fn(outputs.len(), response.wheel.len(), |o, j| {
                let mut total = C64::new(0.0, 0.0);
                for m in &response.mode {
                    let [psi, l] = [m.shape[o], m.participation[j]].map(|[a, b]| C64::new(a, b));
                    let pole = m.pole();
                    total += psi * l / (iw - pole) + (psi * l).conj() / (iw - pole.conj());
                }
                for m in &response.real {
                    total += C64::new(m.shape[o] * m.participation[j], 0.0) / (iw - m.pole);
                }
                total
            });
            let off = (&h - &sum).norm_max() / sum.norm_max();
            assert!(off < ROUNDING, "{omega} rad/s: {off:e}");
            // and the car's own, by its dynamic stiffness; the modal form costs the digits of its condition number
            let own = vehicle.output_response(&theirs, omega).unwrap();
            let off = (&h - &own).norm_max() / own.norm_max();
            assert!(off < 1e-11, "{omega} rad/s: {off:e} from the car");
        }
    }
}

#[test]
fn every_pair_is_listed_once() {
    for (vehicle, pairs, reals) in [(car(), 7, 0), (overdamped(), 1, 2)] {
        let response = Response::of(&vehicle).unwrap();
        assert_eq!((response.mode.len(), response.real.len()), (pairs, reals));
        let realised = response.assemble().unwrap();
        let (ours, theirs) = (realised.modes().unwrap(), vehicle.modes().unwrap());
        assert_eq!(ours.len(), theirs.len());
        for ((a, _), (b, _)) in ours.iter().zip(&theirs) {
            assert!((a.pole - b.pole).norm() < ROUNDING * b.pole.norm(), "{} and {}", a.pole, b.pole);
            assert_eq!(a.shape.len(), realised.shape_places().len());
        }
    }
}

/// rms on a banded road by quadrature, on a rational one by Lyapunov's equation; the response knows no mass.
#[test]
fn the_ride_is_the_cars_own() {
    let vehicle = car();
    let realised = Response::of(&vehicle).unwrap().assemble().unwrap();
    for text in [
        "kind = \"iso8608\"\nclass = \"C\"\nband_rad_per_m = [0.063, 17.77]\n[coherence]\nkind = \"bogsjo\"\nmu = 3.8\n",
        "kind = \"first-order\"\ngain = 0.005\ncorner_rad_per_m = 0.2\n",
    ] {
        let road = road(text);
        let names: Vec<String> = ["front_left", "front_right", "rear_left", "rear_right"]
            .iter()
            .flat_map(|w| [format!("body_acceleration_{w}"), format!("suspension_travel_{w}")])
            .collect();
        let rms = |v: &Vehicle| -> Vec<f64> {
            let outputs: Vec<&Output> = names.iter().map(|n| v.output(n).unwrap()).collect();
            let ride = Ride::new(v, &road, 20.0).unwrap();
            ride.variances(&outputs).unwrap().iter().map(|x| x.rms().unwrap()).collect()
        };
        for ((a, b), name) in rms(&realised).iter().zip(rms(&vehicle)).zip(&names) {
            assert!((a / b - 1.0).abs() < 1e-9, "{name}: {a} and {b}");
        }
    }
}

/// Sensors look at the same outputs, and a drive on the same seed is the same drive.
#[test]
fn the_drive_is_the_cars_own() {
    use crate::signal::{Channel, Direction, Place, Quantity};
    use crate::vehicle::{DriveSettings, Flaws, simulate};
    let vehicle = car();
    let realised = Response::of(&vehicle).unwrap().assemble().unwrap();
    let road = road("kind = \"iso8608\"\nclass = \"C\"\nband_rad_per_m = [0.063, 17.77]\n");
    let channel = |(i, place): (usize, Place)| Channel {
        name: format!("c{i}"),
        quantity: Quantity::Acceleration,
        direction: Direction::PlusZ,
        place,
        wheel: Some(i),
        at_m: None,
    };
    let sensors: Vec<_> = [Place::Body, Place::Hub, Place::Body, Place::Hub]
        .into_iter()
        .enumerate()
        .map(|x| (channel(x), Flaws::default()))
        .collect();
    let settings = DriveSettings { speed_m_s: 20.0, duration_s: 5.0, rate_hz: 200.0, seed: 3 };
    let record = |v: &Vehicle| simulate(v, &road, &sensors, &settings).unwrap();
    let (a, b) = (record(&realised), record(&vehicle));
    for (x, y) in a.samples().iter().zip(b.samples()) {
        let size = y.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        assert!(x.iter().zip(y).all(|(p, q)| (p - q).abs() < 1e-9 * size));
    }
}

#[test]
fn the_file_comes_back() {
    for vehicle in [car(), overdamped()] {
        let mut response = Response::of(&vehicle).unwrap();
        response.mode[0].label = Some("heave".into());
        let file = VehicleSpec::from(response);
        let text = toml::to_string(&file).unwrap();
        assert!(text.contains("model = \"response\"") && text.contains("[[response.mode]]"), "{text}");
        let back = spec(&text);
        assert_eq!(back, file);
        let vehicle = back.build_alone().unwrap();
        assert!(vehicle.modes().unwrap().iter().any(|(_, label)| label == "heave"));
    }
}

#[test]
fn what_is_no_response_is_refused() {
    let good = Response::of(&car()).unwrap();
    let message = |change: &dyn Fn(&mut Response)| {
        let mut r = good.clone();
        change(&mut r);
        VehicleSpec::from(r).build_alone().unwrap_err().to_string()
    };
    let e = message(&|r| r.mode[2].damping = -0.1);
    assert!(e.starts_with("response.mode 3.damping: expected a number between 0 and 1"), "{e}");
    let e = message(&|r| r.mode[1].participation.truncate(3));
    assert!(e.contains("mode 2.participation") && e.contains("3 values for 4"), "{e}");
    let e = message(&|r| r.mode[0].freq_hz = 0.0);
    assert!(e.contains("mode 1.freq_hz: expected a positive number"), "{e}");
    let poles = [C64::new(-1.0, 5.0)];
    let one = CMat::from_fn(1, 1, |_, _| C64::new(1.0, 0.0));
    let wheel = vec![WheelRow { name: "wheel".into(), at_m: [0.0, 0.0] }];
    let e = Response::new(wheel, &["body_displacement".into()], &poles, &one, &one).unwrap_err();
    assert!(e.to_string().contains("conjugate"), "{e}");
}
