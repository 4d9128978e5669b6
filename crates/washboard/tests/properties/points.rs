//! A filter of all road inputs against the road of tracks that it is, against quadrature, and against the plant's H2 norm.

use washboard::cases;
use washboard::linalg::Mat;
use washboard::lti::{Continuous, StateSpace};
use washboard::road::{Coherence, MatrixFilter, Road, Shapes, Spectrum};
use washboard::vehicle::{Control, Disturbance, Output, PlantSettings, Ride, Variance, Vehicle};

fn names(n: &[&str]) -> Vec<String> {
    n.iter().map(|s| (*s).to_owned()).collect()
}

fn diagonal(n: usize, v: f64) -> Mat {
    Mat::from_fn(n, n, |i, j| if i == j { v } else { 0.0 })
}

/// Every input its own g/(s + a) of height over distance, or white noise d of velocity over time.
fn apart(count: usize, first: Option<(f64, f64)>, white: f64) -> MatrixFilter {
    let (system, of) = match first {
        Some((g, a)) => (
            StateSpace::continuous(
                diagonal(count, -a),
                diagonal(count, g),
                diagonal(count, 1.0),
                Mat::zeros(count, count),
            ),
            Shapes::Height,
        ),
        None => (StateSpace::continuous_gain(diagonal(count, white)), Shapes::Velocity),
    };
    MatrixFilter::new(system.unwrap(), of, first.is_some(), vec![], None).unwrap()
}

/// Inputs that are related in size and phase: two noises through a resonance, a real pole and delays of their own.
fn related(count: usize) -> MatrixFilter {
    let a = [
        [0.0, 1.0, 0.0, 0.0, 0.0],
        [-90.0, -4.0, 0.0, 0.0, 0.0],
        [1.0, 0.0, -6.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, -25.0, 0.0],
        [0.3, 0.0, 0.0, 0.5, -1.5],
    ];
    let a = Mat::from_fn(5, 5, |i, j| a[i][j]);
    let b = Mat::from_fn(5, 2, |i, j| if i == 1 { [0.4, 0.1][j] } else { 0.0 });
    // positions alone: velocities are no white noise
    let c = Mat::from_fn(count, 5, |i, j| if j == 1 { 0.0 } else { (1.0 + 2.0 * i as f64 + j as f64).sin() });
    let system = StateSpace::continuous(a, b, c, Mat::zeros(count, 2)).unwrap();
    MatrixFilter::new(system, Shapes::Height, false, vec![], None).unwrap()
}

fn same(vehicle: &Vehicle, points: &MatrixFilter, road: &Road) {
    let all: Vec<&Output> = vehicle.outputs().iter().collect();
    let (a, b) = (
        Ride::new(vehicle, points, 20.0).unwrap().variances(&all).unwrap(),
        Ride::new(vehicle, road, 20.0).unwrap().variances(&all).unwrap(),
    );
    let mut finite = 0;
    for (i, output) in all.iter().enumerate() {
        match (a[i].rms(), b[i].rms()) {
            (Some(a), Some(b)) => {
                finite += usize::from(b > 0.0);
                // one state space written in two ways
                assert!(a == b || (a / b - 1.0).abs() < 1e-9, "{}: {a} {b}", output.name);
            }
            (None, None) => assert_eq!(a[i], b[i], "{}", output.name),
            _ => panic!("{}: {:?} {:?}", output.name, a[i], b[i]),
        }
    }
    assert!(finite > 4, "{finite}");
}

#[test]
fn independent_points_are_a_road_of_independent_wheels() {
    let (g, a, w) = (0.0195, 0.0572, 1.4e-4);
    let first = Road::new(Spectrum::first_order(g, a).unwrap(), Coherence::Independent);
    let white = Road::new(Spectrum::white_velocity(w).unwrap(), Coherence::Independent);
    for case in ["turkay-quarter-car", "turkay-half-car", "guiggiani-full-car", "turkay-truck-cabin"] {
        let vehicle = cases::vehicle(case).unwrap();
        let count = vehicle.wheels().len();
        same(&vehicle, &apart(count, Some((g, a)), 0.0), &first);
        same(&vehicle, &apart(count, None, w.sqrt()), &white);
    }
}

#[test]
fn lyapunov_and_quadrature_agree_on_related_points() {
    for case in ["turkay-half-car", "guiggiani-full-car", "turkay-truck-cabin"] {
        let vehicle = cases::vehicle(case).unwrap();
        let filter = related(vehicle.wheels().len());
        let ride = Ride::new(&vehicle, &filter, 20.0).unwrap();
        let all: Vec<&Output> = vehicle.outputs().iter().filter(|o| o.u.is_empty()).collect();
        let exact = ride.variances_by_lyapunov(&all).unwrap().unwrap();
        let integrated = ride.variances_by_quadrature(&all).unwrap();
        for (i, output) in all.iter().enumerate() {
            let (Some(Variance::Finite(a)), Variance::Finite(b)) = (exact[i], integrated[i]) else {
                panic!("{case} {}: {:?} {:?}", output.name, exact[i], integrated[i]);
            };
            // the promise of quadrature is 1e-6 of an rms
            assert!((a / b - 1.0).abs() < 2e-6, "{case} {}: {a} {b}", output.name);
        }
        // the parts of two bands that share an edge are the whole
        let low = ride.variances_in_band(&all, [0.0, 12.0]).unwrap();
        let high = ride.variances_in_band(&all, [12.0, 1e5]).unwrap();
        for (i, output) in all.iter().enumerate() {
            let whole = integrated[i].rms().unwrap().powi(2);
            // beyond 1e5 rad/s an acceleration has less than 1e-5 of its own
            assert!(((low[i] + high[i]) / whole - 1.0).abs() < 1e-5, "{case} {}", output.name);
        }
    }
}

/// Lyapunov, quadrature of mechanics and K, and the H2 norm of the generalised plant.
#[test]
fn related_points_in_a_loop_agree_with_the_plants_norm() {
    let car = cases::vehicle("guiggiani-full-car").unwrap();
    let filter = related(4);
    let (y, u) = (["heave_velocity", "suspension_travel_front_left"], ["front_left", "rear_right"]);
    let law = StateSpace::continuous(
        Mat::from_fn(1, 1, |_, _| -40.0),
        Mat::from_fn(1, 2, |_, j| [1.0, -2.0][j]),
        Mat::from_fn(2, 1, |i, _| [700.0, 300.0][i]),
        Mat::from_fn(2, 2, |i, j| [[120.0, 15.0], [-40.0, 60.0]][i][j]),
    )
    .unwrap();
    let k = Control::new(&car, law, &names(&y), &names(&u)).unwrap();
    let z = ["heave_acceleration", "roll_acceleration", "tire_force_rear_left", "actuator_force_front_left"];
    let outputs: Vec<&Output> = z.iter().map(|n| car.output(n).unwrap()).collect();
    let ride = Ride::controlled(&car, &filter, 20.0, &k).unwrap();
    let exact = ride.variances_by_lyapunov(&outputs).unwrap().unwrap();
    let integral = ride.variances_by_quadrature(&outputs).unwrap();
    let settings = PlantSettings {
        road: (&filter).into(),
        speed_m_s: 20.0,
        disturbance: Disturbance::RoadNoise,
        delay_order: 4,
    };
    let measured: Vec<&Output> = y.iter().map(|n| car.output(n).unwrap()).collect();
    let plant = car.plant(&outputs, &measured, &settings).unwrap();
    assert_eq!((plant.nw(), plant.nu()), (2, 4));
    // the controller drives two of the four actuators
    let law = k.controller();
    let onto = Mat::from_fn(4, 2, |i, j| f64::from(u8::from((i, j) == (0, 0) || (i, j) == (3, 1))));
    let all: StateSpace<Continuous> =
        StateSpace::continuous(law.a().clone(), law.b().clone(), &onto * law.c(), &onto * law.d()).unwrap();
    let h2 = plant.close(&all).unwrap().h2_of_outputs().unwrap();
    for i in 0..z.len() {
        let (a, b) = (exact[i].unwrap().rms().unwrap(), integral[i].rms().unwrap());
        assert!((a / b - 1.0).abs() < 1e-6, "{}: {a} {b}", z[i]);
        assert!((a / h2[i] - 1.0).abs() < 1e-8, "{}: {a} {}", z[i], h2[i]);
    }
}

/// Points that all do the same cannot roll a symmetric car, and what they cannot do is 0 and not rounding.
#[test]
fn what_cancels_is_zero() {
    let car = cases::vehicle("chalasani-full-car").unwrap();
    let one = |c: f64| Mat::from_fn(4, 1, |_, _| c);
    let system = StateSpace::continuous(
        Mat::from_fn(1, 1, |_, _| -2.0),
        Mat::from_fn(1, 1, |_, _| 0.01),
        one(1.0),
        Mat::zeros(4, 1),
    );
    let together = MatrixFilter::new(system.unwrap(), Shapes::Height, false, vec![], None).unwrap();
    let outputs = [car.output("roll_displacement").unwrap(), car.output("heave_displacement").unwrap()];
    let ride = Ride::new(&car, &together, 20.0).unwrap();
    for v in [ride.variances(&outputs).unwrap(), ride.variances_by_quadrature(&outputs).unwrap()] {
        assert_eq!(v[0], Variance::Finite(0.0));
        assert!(v[1].rms().unwrap() > 1e-3);
    }
    // white velocities that are one: travels settle, though heights wander; the roll stands still
    let white = MatrixFilter::new(
        StateSpace::continuous_gain(one(0.01)).unwrap(),
        Shapes::Velocity,
        false,
        vec![],
        None,
    )
    .unwrap();
    let outputs = [car.output("heave_displacement").unwrap(), car.output("tire_force_front_left").unwrap()];
    let v = Ride::new(&car, &white, 20.0).unwrap().variances(&outputs).unwrap();
    assert!(matches!(v[0], Variance::Infinite(_)), "{:?}", v[0]);
    assert!(v[1].rms().is_some_and(|r| r > 0.0), "{:?}", v[1]);
}

#[test]
fn a_wrong_number_of_points_is_refused_with_both() {
    let half = cases::vehicle("turkay-half-car").unwrap();
    let e = Ride::new(&half, &related(4), 20.0).unwrap_err().to_string();
    assert!(e.contains("expected a filter of 2 points") && e.contains("found 4"), "{e}");
    let z = [half.output("heave_acceleration").unwrap()];
    for disturbance in [Disturbance::RoadNoise, Disturbance::RoadVelocity, Disturbance::RoadDisplacement] {
        let filter = related(4);
        let settings = PlantSettings { road: (&filter).into(), speed_m_s: 20.0, disturbance, delay_order: 4 };
        let e = half.plant(&z, &[], &settings).unwrap_err().to_string();
        assert!(e.contains("expected a filter of 2 points") && e.contains("found 4"), "{e}");
    }
}

#[test]
fn a_plant_says_which_output_is_white_or_wanders() {
    let car = cases::vehicle("guiggiani-full-car").unwrap(); // damped tires
    let refused = |filter: &MatrixFilter, name: &str| {
        let settings = PlantSettings {
            road: filter.into(),
            speed_m_s: 20.0,
            disturbance: Disturbance::RoadNoise,
            delay_order: 4,
        };
        car.plant(&[car.output(name).unwrap()], &[], &settings).unwrap_err().to_string()
    };
    let e = refused(&apart(4, Some((0.0195, 0.0572)), 0.0), "unsprung_acceleration_rear_left");
    assert!(e.contains("`unsprung_acceleration_rear_left` contains white noise"), "{e}");
    let e = refused(&apart(4, None, 0.01), "heave_displacement");
    assert!(e.contains("`heave_displacement` follows a road height that wanders off"), "{e}");
}
