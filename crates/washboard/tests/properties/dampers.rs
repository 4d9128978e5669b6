//! Dampers with curves in simulated drives: a straight line is the linear vehicle, and every curve obeys Newton.

use washboard::cases;
use washboard::road::{Coherence, Road};
use washboard::signal::{Channel, Direction, Place, Quantity, Recording};
use washboard::vehicle::{
    DamperCurve, DriveSettings, Flaws, LeftRight, Output, QuarterCar, Ride, Vehicle, VehicleSpec, drive,
    linearise, simulate,
};

pub fn channel(quantity: Quantity, place: Place, wheel: usize) -> (Channel, Flaws) {
    let name = format!("{}_{}_{wheel}", quantity.name(), if place == Place::Body { "b" } else { "u" });
    let (direction, wheel) = (Direction::PlusZ, Some(wheel));
    (Channel { name, quantity, direction, place, wheel, at_m: None }, Flaws::default())
}

/// Digressive, and stiffer in rebound.
pub fn curve() -> DamperCurve {
    DamperCurve::new(vec![[-0.5, -1500.0], [-0.1, -700.0], [0.0, 0.0], [0.1, 350.0], [0.5, 750.0]]).unwrap()
}

fn record(vehicle: &Vehicle, road: &Road, sensors: &[(Channel, Flaws)], rate_hz: f64) -> Recording {
    let settings = DriveSettings { speed_m_s: 20.0, duration_s: 20.0, rate_hz, seed: 5 };
    simulate(vehicle, road, sensors, &settings).unwrap()
}

/// Curves that are straight lines of another slope than the file's damping, against the linear car of that slope: left
/// and right, two axles, delays and coherence in it.
#[test]
fn a_straight_line_is_the_linear_vehicle() {
    let mut spec = cases::vehicle_spec("guiggiani-full-car").unwrap();
    let road = cases::road("iso8608-c").unwrap().with_coherence(Coherence::bogsjo(3.8).unwrap());
    let line = |c: f64| DamperCurve::new(vec![[-1.0, -c], [0.1, 0.1 * c], [0.2, 0.2 * c]]).unwrap();
    let car = spec.full_car.as_mut().unwrap();
    car.front.damper_curve = Some(line(1900.0));
    car.rear.damper_curve = Some(line(900.0));
    let curved = spec.build_alone().unwrap();
    let car = spec.full_car.as_mut().unwrap();
    (car.front.damper_curve, car.rear.damper_curve) = (None, None);
    car.front.suspension_damping_n_s_per_m = LeftRight::Both(1900.0);
    car.rear.suspension_damping_n_s_per_m = LeftRight::Both(900.0);
    let linear = spec.build_alone().unwrap();
    assert!(linear.dampers().is_empty() && curved.dampers().len() == 4);
    let mut sensors: Vec<_> = (0..4)
        .flat_map(|w| [Place::Body, Place::Hub].map(|p| channel(Quantity::Acceleration, p, w)))
        .collect();
    sensors.push(channel(Quantity::Displacement, Place::Suspension, 2));
    let (a, b) = (record(&curved, &road, &sensors, 200.0), record(&linear, &road, &sensors, 200.0));
    for ((x, y), (c, _)) in a.samples().iter().zip(b.samples()).zip(&sensors) {
        let sum = |f: &dyn Fn(f64, f64) -> f64| -> f64 { x.iter().zip(y).map(|(p, q)| f(*p, *q)).sum() };
        let off = (sum(&|p, q| (p - q) * (p - q)) / sum(&|_, q| q * q)).sqrt();
        assert!(off < 1e-6, "{}: {off:e}", c.name);
    }
    // with_damping is that linear vehicle too
    let (same, n) = (curved.with_damping(&[1900.0, 1900.0, 900.0, 900.0]).unwrap(), 7);
    for i in 0..n {
        for j in 0..n {
            let (p, q) = (same.system().c()[(i, j)], linear.system().c()[(i, j)]);
            assert!((p - q).abs() < 1e-9, "C[{i}{j}] {p} {q}");
        }
    }
}

pub fn quarter() -> QuarterCar {
    QuarterCar {
        sprung_mass_kg: 240.0,
        unsprung_mass_kg: 36.0,
        suspension_stiffness_n_per_m: 16e3,
        suspension_damping_n_s_per_m: 1400.0,
        tire_stiffness_n_per_m: 160e3,
        tire_damping_n_s_per_m: 50.0,
        damper_curve: Some(curve()),
    }
}

/// m_s z̈_s = k_s d + F(ḋ) with the hub's travel d towards the body, sample by sample.
#[test]
fn the_body_obeys_newton() {
    let car = quarter();
    let vehicle = VehicleSpec::from(car.clone()).build_alone().unwrap();
    let road = cases::road("iso8608-d").unwrap();
    let sensors = [
        channel(Quantity::Acceleration, Place::Body, 0),
        channel(Quantity::Displacement, Place::Suspension, 0),
        channel(Quantity::Velocity, Place::Suspension, 0),
    ];
    // anti-aliasing rounds the force's kinks within a sample: a share that falls as rate^(-3/2), 8e-4 at 2 kHz
    let settings = DriveSettings { speed_m_s: 20.0, duration_s: 5.0, rate_hz: 8000.0, seed: 2 };
    let found = drive(&vehicle, &road, &sensors, &settings).unwrap();
    assert!(found.step_error.unwrap() < 1e-5);
    let [acceleration, travel, velocity] = [0, 1, 2].map(|i| &found.recording.samples()[i]);
    let (mut off, mut size, mut linear) = (0.0, 0.0, 0.0);
    for ((a, d), v) in acceleration.iter().zip(travel).zip(velocity) {
        let force = car.suspension_stiffness_n_per_m * d + curve().force(*v);
        off += (car.sprung_mass_kg * a - force).powi(2);
        size += force * force;
        linear += (force - car.suspension_stiffness_n_per_m * d - 1400.0 * v).powi(2);
    }
    assert!((off / size).sqrt() < 2e-4, "{:e} of the force", (off / size).sqrt());
    // and the curve matters here
    assert!((linear / size).sqrt() > 0.3, "{:e}", (linear / size).sqrt());
}

/// The same bits on any number of threads, and a last halving that changed less than it may.
#[test]
fn threads_change_no_bit_of_a_curve() {
    let vehicle = VehicleSpec::from(quarter()).build_alone().unwrap();
    let road = cases::road("iso8608-d").unwrap();
    let sensors = [channel(Quantity::Acceleration, Place::Hub, 0)];
    let one = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let settings = DriveSettings { speed_m_s: 20.0, duration_s: 10.0, rate_hz: 200.0, seed: 2 };
        pool.install(|| drive(&vehicle, &road, &sensors, &settings).unwrap())
    };
    let found = one(1);
    assert_eq!(found, one(3));
    assert!(found.step_error.unwrap() < 1e-5);
}

#[test]
fn a_curve_that_is_none_is_refused_with_its_field() {
    let text = |curve: &str| {
        let text = format!(
            "model = \"quarter-car\"\n[quarter-car]\nsprung_mass_kg = 240.0\nunsprung_mass_kg = 36.0\n\
             suspension_stiffness_n_per_m = 16e3\nsuspension_damping_n_s_per_m = 980.0\n\
             tire_stiffness_n_per_m = 160e3\ndamper_curve = {curve}\n"
        );
        washboard::files::parse_toml::<VehicleSpec>(&text, std::path::Path::new("v.toml")).unwrap()
    };
    let good = text("[[-1.0, -900.0], [1.0, 500.0]]");
    assert_eq!(good.build_alone().unwrap().dampers().len(), 1);
    let e = text("[[1.0, -900.0], [-1.0, 500.0]]").build_alone().unwrap_err().to_string();
    assert!(e.starts_with("quarter-car.damper_curve: expected velocities that ascend"), "{e}");
    let mut half = cases::vehicle_spec("turkay-half-car").unwrap();
    let car = half.half_car.as_mut().unwrap();
    car.rear.damper_curve = Some(curve());
    assert_eq!(half.build_alone().unwrap().dampers().len(), 1);
    half.half_car.as_mut().unwrap().variant = washboard::vehicle::HalfCarVariant::AsPrinted;
    let e = half.build_alone().unwrap_err().to_string();
    assert!(e.contains("rear.damper_curve: expected variant = \"corrected\""), "{e}");
}

/// The fixed point is one: c_eq of the velocity that the linear ride at c_eq has; a straight line is its slope.
#[test]
fn equivalent_damping_is_a_fixed_point() {
    let vehicle = VehicleSpec::from(quarter()).build_alone().unwrap();
    let mut before = f64::INFINITY;
    for class in ["a", "b", "c", "d", "e"] {
        let road = cases::road(&format!("iso8608-{class}")).unwrap();
        let found = linearise(&vehicle, &road, 20.0).unwrap();
        let ride = Ride::new(&found.vehicle, &road, 20.0).unwrap();
        let (up, down): (Vec<&Output>, Vec<&Output>) = (
            vec![found.vehicle.output("unsprung_velocity").unwrap()],
            vec![found.vehicle.output("sprung_velocity").unwrap()],
        );
        let travel = Output {
            q: std::array::from_fn(|d| up[0].q[d].iter().zip(&down[0].q[d]).map(|(a, b)| a - b).collect()),
            ..up[0].clone()
        };
        let sigma = ride.variances(&[&travel]).unwrap()[0].rms().unwrap();
        let c = found.damping_n_s_per_m[0];
        assert!((found.velocity_m_s[0] / sigma - 1.0).abs() < 1e-8, "{class}");
        assert!((curve().equivalent(sigma) / c - 1.0).abs() < 1e-8, "{class}");
        // digressive: rougher is softer
        assert!(c < before, "{class}: {c} after {before}");
        before = c;
    }
    let mut car = quarter();
    car.damper_curve = Some(DamperCurve::new(vec![[-0.3, -360.0], [0.1, 120.0], [0.9, 1080.0]]).unwrap());
    let line = VehicleSpec::from(car).build_alone().unwrap();
    let road = cases::road("iso8608-c").unwrap();
    let found = linearise(&line, &road, 20.0).unwrap();
    assert!((found.damping_n_s_per_m[0] / 1200.0 - 1.0).abs() < 1e-13);
}

/// E[Fv]/E[v²] of the velocities of drives with the curve, against the Gaussian closure: what is left is the sampling
/// error and that the velocity is not Gaussian.
#[test]
fn drives_have_the_equivalent_damping() {
    // as a car's damper is built: two knees, rebound twice compression
    let usual = vec![[-0.6, -1100.0], [-0.15, -400.0], [0.0, 0.0], [0.15, 220.0], [0.6, 550.0]];
    // nearly straight: the velocity stays Gaussian, and the closure is exact to the second order of 3 %
    let faint = vec![[-1.0, -1430.0], [-0.1, -143.0], [0.0, 0.0], [0.1, 137.0], [1.0, 1370.0]];
    for (points, closure) in [(usual, CLOSURE), (faint, 5e-4)] {
        let curve = DamperCurve::new(points).unwrap();
        let car = QuarterCar { damper_curve: Some(curve.clone()), ..quarter() };
        let vehicle = VehicleSpec::from(car).build_alone().unwrap();
        for class in ["a", "b", "c", "d", "e"] {
            let road = cases::road(&format!("iso8608-{class}")).unwrap();
            let found = linearise(&vehicle, &road, 20.0).unwrap();
            let (off, sd) = measured(&vehicle, &road, &curve, found.damping_n_s_per_m[0]);
            println!(
                "class {class}: {:+.2} % ± {:.2} of {:.0}",
                100.0 * off,
                100.0 * sd,
                found.damping_n_s_per_m[0]
            );
            assert!(off.abs() < closure + 4.0 * sd, "class {class}: {off} with {sd}");
        }
    }
}

/// How far E[Fv]/E[v²] of eight drives is from c, relatively, and its standard deviation.
fn measured(vehicle: &Vehicle, road: &Road, curve: &DamperCurve, c: f64) -> (f64, f64) {
    let sensors = [channel(Quantity::Velocity, Place::Suspension, 0)];
    let ratios: Vec<f64> = (0..8)
        .map(|seed| {
            let settings = DriveSettings { speed_m_s: 20.0, duration_s: 60.0, rate_hz: 200.0, seed };
            let drive = simulate(vehicle, road, &sensors, &settings).unwrap();
            let sums = |(a, b): (f64, f64), v: &f64| (a + curve.force(*v) * v, b + v * v);
            let (fv, vv) = drive.samples()[0].iter().fold((0.0, 0.0), sums);
            fv / vv / c
        })
        .collect();
    let mean = ratios.iter().sum::<f64>() / 8.0;
    let variance = ratios.iter().map(|r| (r - mean).powi(2)).sum::<f64>() / 7.0;
    (mean - 1.0, (variance / 8.0).sqrt())
}

/// The Gaussian closure's error of the usual curve, as the test above prints it with --nocapture.
const CLOSURE: f64 = 0.04;
