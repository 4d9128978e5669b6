//! Families without a file: counted, written down and compared with each other.

use super::*;
use crate::linalg::C64;
use crate::lti::{Parametric, WheeledSystem};
use crate::signal::{Direction, Place, Quantity};

/// Rounding of eigenvalues and of a solve at condition numbers of 1e4.
const ROUNDING: f64 = 1e-10;

fn wheels(places: &[(&str, [f64; 2])]) -> Vec<WheelPlace> {
    places.iter().map(|(name, at_m)| WheelPlace { name: (*name).to_owned(), at_m: *at_m }).collect()
}

fn car() -> Vec<WheelPlace> {
    wheels(&[
        ("front-left", [2.7, 0.75]),
        ("front-right", [2.7, -0.75]),
        ("rear-left", [0.0, 0.7]),
        ("rear-right", [0.0, -0.7]),
    ])
}

fn truck() -> Vec<WheelPlace> {
    let axle = |x: f64| [(x, 1.0), (x, -1.0)];
    let at: Vec<_> = [5.0, 1.3, 0.0].into_iter().flat_map(axle).collect();
    (1..).zip(at).map(|(i, (x, y))| WheelPlace { name: format!("w{i}"), at_m: [x, y] }).collect()
}

fn channel(name: &str, place: Place, wheel: Option<usize>, at_m: Option<[f64; 2]>) -> Channel {
    let (quantity, direction) = (Quantity::Acceleration, Direction::PlusZ);
    Channel { name: name.to_owned(), quantity, direction, place, wheel, at_m }
}

/// All corners, all hubs, a seat, one travel and, with two tracks, a roll gyroscope.
fn sensors(count: usize, roll: bool) -> Vec<Channel> {
    let mut found: Vec<Channel> = (0..count)
        .flat_map(|w| {
            [("body", Place::Body), ("hub", Place::Hub)]
                .map(|(name, place)| channel(&format!("{name}_{w}"), place, Some(w), None))
        })
        .collect();
    if count > 1 {
        found.push(channel("seat", Place::Body, None, Some([1.0, 0.2])));
    }
    let mut travel = channel("travel", Place::Suspension, Some(0), None);
    travel.quantity = Quantity::Displacement;
    found.push(travel);
    if roll {
        let mut gyro = channel("gyro", Place::Body, None, None);
        (gyro.quantity, gyro.direction) = (Quantity::AngularVelocity, Direction::PlusX);
        found.push(gyro);
    }
    found
}

fn family(at: &[WheelPlace], symmetry: Symmetry, known: &[(String, f64)]) -> ParametricVehicle {
    let roll = at.iter().any(|w| (w.at_m[1] - at[0].at_m[1]).abs() > 0.1);
    let channels = sensors(at.len(), roll);
    let (family, d) =
        ParametricVehicle::generic(&GenericStart::ALL[0], symmetry, &channels, at, known).unwrap();
    assert_eq!(d.len(), channels.len());
    family
}

/// Sensors × wheels of the displacements at ω.
fn response(system: &WheeledSystem, omega: f64) -> crate::linalg::CMat {
    let (n, w) = (system.system().order(), system.at_m().len());
    let input = crate::linalg::CMat::from_fn(n, w, |i, j| {
        C64::new(system.wheel_stiffness()[(i, j)], omega * system.wheel_damping()[(i, j)])
    });
    let q = crate::linalg::solve_complex(&system.system().dynamic_stiffness(omega), &input).unwrap();
    crate::linalg::CMat::from_fn(system.rows().nrows(), w, |i, j| {
        (0..n).map(|k| q[(k, j)] * system.rows()[(i, k)]).sum()
    })
}

fn same(a: &WheeledSystem, b: &WheeledSystem, what: &str) {
    for omega in [0.0, 4.0, 9.0, 40.0, 70.0, 300.0] {
        let (x, y) = (response(a, omega), response(b, omega));
        let off = (&x - &y).norm_max() / x.norm_max();
        assert!(off < ROUNDING, "{what} at {omega} rad/s: {off:e}");
    }
    let poles = |s: &WheeledSystem| -> Vec<C64> {
        crate::lti::modes(s.system()).unwrap().iter().map(|m| m.pole).collect()
    };
    for (x, y) in poles(a).iter().zip(poles(b)) {
        assert!((x - y).norm() < ROUNDING * x.norm(), "{what}: {x} and {y}");
    }
}

/// Values off the start, every one by another factor.
fn elsewhere(family: &ParametricVehicle) -> Vec<f64> {
    let spread = |(i, v): (usize, &f64)| v * (1.0 + 0.04 * ((i * 7 % 5) as f64 - 1.5));
    let moved: Vec<f64> = family.start().iter().enumerate().map(spread).collect();
    moved.iter().zip(family.limits()).map(|(v, [low, high])| v.clamp(low, high)).collect()
}

#[test]
fn the_number_of_parameters_is_that_of_the_parts() {
    let inline = wheels(&[("front", [1.4, 0.0]), ("rear", [0.0, 0.0])]);
    let bike = wheels(&[("a", [2.0, 0.0]), ("b", [1.0, 0.0]), ("c", [0.0, 0.0])]);
    let three = wheels(&[("front", [1.8, 0.0]), ("left", [0.0, 0.5]), ("right", [0.0, -0.5])]);
    for (at, model, symmetric, asymmetric) in [
        // J_x, J_y, c.g. and (m, k, c, k_t, c_t, bar) an axle; y and (m, k, c, k_t, c_t) a corner more
        (car(), "full-car", 3 + 2 * 6, 4 + 2 * 11),
        (truck(), "matrices", 3 + 3 * 6, 4 + 3 * 11),
        (three, "matrices", 3 + 6 + 5, 4 + 11 + 5),
        (inline, "half-car", 2 + 2 * 5, 2 + 2 * 5),
        (bike, "matrices", 2 + 3 * 5, 2 + 3 * 5),
        (wheels(&[("wheel", [0.3, 0.2])]), "quarter-car", 5, 5),
    ] {
        for (symmetry, count) in [(Symmetry::Symmetric, symmetric), (Symmetry::Asymmetric, asymmetric)] {
            let family = family(&at, symmetry, &[]);
            assert_eq!(family.names().len(), count, "{model} {symmetry:?}: {:?}", family.names());
            assert_eq!(family.spec_at(&family.start()).unwrap().model.name(), model);
            assert!(!family.names().contains(&"sprung_mass_kg".to_owned()));
            let inside = family.start().iter().zip(family.limits()).all(|(v, [a, b])| a < *v && *v < b);
            assert!(inside, "{model}: {:?} in {:?}", family.start(), family.limits());
        }
    }
}

/// The generic numbers do what they are named for: with k/m = ω_b² and (k + k_t)/m_u = ω_h², heave and hop of a corner
/// solve ω⁴ − (ω_b² + ω_h²)ω² + ω_b²(ω_h² − ω_b²/.18) = 0 (no damping).
#[test]
fn a_generic_vehicle_has_the_frequencies_asked_for() {
    let inline = wheels(&[("front", [1.4, 0.0]), ("rear", [0.0, 0.0])]);
    for start in GenericStart::ALL {
        let undamped = GenericStart { damping: 1e-9, ..start };
        let [body, hop] = [start.body_hz, start.hop_hz].map(|f| f * f);
        let (sum, product) = (body + hop, body * (hop - body / 0.18));
        let root = (sum * sum - 4.0 * product).sqrt();
        let expected = [((sum - root) / 2.0).sqrt(), f64::midpoint(sum, root).sqrt()];
        for at in [car(), inline.clone(), wheels(&[("wheel", [0.0, 0.0])])] {
            let none = [("tire_damping_n_s_per_m".to_owned(), 0.0)];
            let (family, _) =
                ParametricVehicle::generic(&undamped, Symmetry::Symmetric, &[], &at, &none).unwrap();
            let vehicle = family.vehicle_at(&family.start()).unwrap();
            for f in expected {
                let modes = vehicle.modes().unwrap();
                let off = modes.iter().map(|(m, _)| (m.freq_hz / f - 1.0).abs()).fold(1.0, f64::min);
                assert!(off < 1e-9, "{start:?} on {} wheels: {f} Hz", at.len());
            }
        }
        let (family, _) = ParametricVehicle::generic(
            &start,
            Symmetry::Symmetric,
            &[],
            &wheels(&[("wheel", [0.0, 0.0])]),
            &[],
        )
        .unwrap();
        let car = family.spec_at(&family.start()).unwrap().quarter_car.unwrap();
        let c = 2.0 * start.damping * (TAU * start.body_hz) * car.sprung_mass_kg;
        assert!((car.suspension_damping_n_s_per_m / c - 1.0).abs() < 1e-12);
    }
}

#[test]
fn the_file_at_given_values_is_the_system() {
    for at in [car(), truck()] {
        for symmetry in [Symmetry::Symmetric, Symmetry::Asymmetric] {
            let family = family(&at, symmetry, &[]);
            let values = elsewhere(&family);
            let spec = family.spec_at(&values).unwrap();
            let text = toml::to_string(&spec).unwrap();
            let back: VehicleSpec = crate::files::parse_toml(&text, std::path::Path::new("v.toml")).unwrap();
            let vehicle = back.build_alone().unwrap();
            let system = family.system(&values).unwrap();
            assert_eq!(vehicle.system(), system.system());
            assert_eq!(vehicle.wheel_places(), system.at_m());
            // wheels in the frame of the recording, shifted by the c.g.
            for (ours, theirs) in vehicle.wheels().iter().zip(&at) {
                let back = vehicle.in_frame(theirs.at_m, &at);
                let off = (back[0] - ours.at_m[0]).hypot(back[1] - ours.at_m[1]);
                assert!(off < 1e-12, "{} at {:?} and {back:?}", ours.name, ours.at_m);
            }
        }
    }
}

#[test]
fn the_asymmetric_family_starts_as_the_symmetric_one_ends() {
    for at in [car(), truck()] {
        let symmetric = family(&at, Symmetry::Symmetric, &[]);
        let values = elsewhere(&symmetric);
        let asymmetric = symmetric.asymmetric_at(&values).unwrap();
        assert_eq!(asymmetric.names(), family(&at, Symmetry::Asymmetric, &[]).names());
        let (a, b) = (symmetric.system(&values).unwrap(), asymmetric.system(&asymmetric.start()).unwrap());
        same(&a, &b, "start");
        // and every parameter of it moves something
        for i in 0..asymmetric.names().len() {
            let mut moved = asymmetric.start();
            moved[i] *= 1.05;
            let c = asymmetric.system(&moved).unwrap();
            let off = (&response(&b, 9.0) - &response(&c, 9.0)).norm_max();
            assert!(off > 1e-7, "{} moves nothing", asymmetric.names()[i]);
        }
    }
}

/// The body on axles with two of them is the full car.
#[test]
fn two_axles_are_the_full_car() {
    let at = car();
    let channels = sensors(4, true);
    let layout = Layout::new(&at).unwrap();
    for symmetry in [Symmetry::Symmetric, Symmetry::Asymmetric] {
        let car = family(&at, symmetry, &[]);
        let template = on_axles(&Numbers::new(&GenericStart::ALL[0], 4).unwrap(), &layout);
        let (axles, _) = ParametricVehicle::of_layout(template, symmetry, &channels, &at, &[]).unwrap();
        let by_name = |name: &str| name.replace("front.", "axle_1.").replace("rear.", "axle_2.");
        let values = elsewhere(&car);
        let same_values: Vec<f64> = axles
            .names()
            .iter()
            .map(|n| values[car.names().iter().position(|c| by_name(c) == *n).unwrap()])
            .collect();
        assert_eq!(axles.names().len(), car.names().len());
        same(&car.system(&values).unwrap(), &axles.system(&same_values).unwrap(), "two axles");
    }
}

/// The c.g. left of the middle is a number of any sign, and back again.
#[test]
fn the_lateral_place_has_a_sign() {
    for at in [car(), truck()] {
        let family = family(&at, Symmetry::Asymmetric, &[]);
        let i = family.names().iter().position(|n| n == "cg_left_ratio").unwrap();
        let width = if at.len() == 4 { 1.4 } else { 2.0 };
        for y in [-0.07, 0.0, 0.05] {
            let mut values = family.start();
            values[i] = f64::exp(y / width);
            let vehicle = family.vehicle_at(&values).unwrap();
            let left = vehicle.wheels()[0].at_m[1];
            assert!((left - (at[0].at_m[1] - y)).abs() < 1e-12, "{left} for {y}");
            let (name, value, slope) = family.physical(i, values[i]).unwrap();
            let near = family.physical(i, values[i] + 1e-6).unwrap().1;
            assert_eq!(name, "cg_left_m");
            assert!((value - y).abs() < 1e-15 && ((near - value) / 1e-6 - slope).abs() < 1e-5);
        }
    }
}

/// One known number sets the scale: it is held, the sprung mass is free, and nothing that is seen depends on it.
#[test]
fn what_is_known_is_held_and_sets_the_scale() {
    for (at, name) in
        [(car(), "front.suspension_stiffness_n_per_m"), (truck(), "axle_1.suspension_stiffness_n_per_m")]
    {
        for symmetry in [Symmetry::Symmetric, Symmetry::Asymmetric] {
            let plain = family(&at, symmetry, &[]);
            let known = family(&at, symmetry, &[(name.to_owned(), 31_500.0)]);
            assert!(known.names().contains(&"sprung_mass_kg".to_owned()));
            assert!(!known.names().iter().any(|n| n.starts_with(name)), "{:?}", known.names());
            let text = toml::to_string(&known.spec_at(&known.start()).unwrap()).unwrap();
            assert!(at.len() > 4 || text.contains("31500"), "{text}");
            same(
                &plain.system(&plain.start()).unwrap(),
                &known.system(&known.start()).unwrap(),
                "another scale",
            );
            let heavier = family(&at, symmetry, &[("sprung_mass_kg".to_owned(), 1150.0)]);
            assert_eq!(heavier.names(), plain.names());
            same(&plain.system(&plain.start()).unwrap(), &heavier.system(&heavier.start()).unwrap(), "mass");
        }
    }
    // a field without its axle is every axle's; one side alone may be known of an asymmetric family
    let both = family(&car(), Symmetry::Symmetric, &[("tire_damping_n_s_per_m".to_owned(), 0.0)]);
    // what is absent sets no scale
    assert_eq!(both.names().len(), 15 - 2);
    assert!(!both.names().contains(&"sprung_mass_kg".to_owned()));
    let side = [("rear.unsprung_mass_kg.1".to_owned(), 50.0)];
    let one = family(&car(), Symmetry::Asymmetric, &side);
    assert!(one.names().contains(&"rear.unsprung_mass_kg.0".to_owned()) && one.names().len() == 26);
    // a distance sets no scale
    let placed = family(&car(), Symmetry::Symmetric, &[("front_axle_m".to_owned(), 1.2)]);
    assert_eq!(placed.names().len(), 14);
    let car = placed.spec_at(&placed.start()).unwrap().full_car.unwrap();
    assert!((car.front_axle_m - 1.2).abs() < 1e-15 && (car.rear_axle_m - 1.5).abs() < 1e-12);
    // what is known of a symmetric family is known of the asymmetric one after it
    let known = family(&truck(), Symmetry::Symmetric, &[("axle_2.tire_stiffness_n_per_m".to_owned(), 2e5)]);
    let after = known.asymmetric_at(&known.start()).unwrap();
    assert_eq!(after.names().len(), 34 + 3 - 2 + 1);
}

#[test]
fn wrong_names_wheels_and_values_are_refused() {
    let make = |at: &[WheelPlace], known: &[(String, f64)]| {
        ParametricVehicle::generic(&GenericStart::ALL[0], Symmetry::Symmetric, &[], at, known)
            .unwrap_err()
            .to_string()
    };
    let known = |name: &str, v: f64| [(name.to_owned(), v)];
    let e = make(&car(), &known("front.suspension_stifness_n_per_m", 1e4));
    assert!(e.contains("did you mean `front.suspension_stiffness_n_per_m`?"), "{e}");
    let e = make(&car(), &known("rear_track_m", 1.4));
    assert!(e.contains("the places of the wheels"), "{e}");
    let e = make(&car(), &known("roll_inertia_kg_m2", -4.0));
    assert!(e.contains("roll_inertia_kg_m2: expected a positive number, found -4"), "{e}");
    let e = make(&truck(), &known("axle_2.unsprung_mass_kg", -4.0));
    assert!(e.contains("axle_2.unsprung_mass_kg: expected a positive number, found -4"), "{e}");
    assert!(make(&[], &[]).contains("found none"));
    let twins = wheels(&[("a", [0.0, 1.0]), ("b", [0.0, 0.7]), ("c", [0.05, -1.0])]);
    assert!(make(&twins, &[]).contains("side by side: a, b, c"));
    let diagonal = wheels(&[("a", [2.0, 1.0]), ("b", [0.0, -1.0])]);
    assert!(make(&diagonal, &[]).contains("hold a body upright"));
}
