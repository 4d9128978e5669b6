//! Two independent routes to every variance: Lyapunov equations with exact delays, and quadrature of spectra.

use std::f64::consts::PI;
use washboard::cases;
use washboard::linalg::C64;
use washboard::road::{Coherence, Road, Shapes, ShapingFilter, Spectrum};
use washboard::units::Convention;
use washboard::vehicle::{LeftRight, Output, Ride, Variance, Vehicle};

fn finite(v: &[Variance]) -> Vec<f64> {
    v.iter().filter_map(|v| v.rms()).collect()
}

fn both_routes(vehicle: &Vehicle, road: &Road, speed: f64) {
    let ride = Ride::new(vehicle, road, speed).unwrap();
    let all: Vec<&Output> = vehicle.outputs().iter().filter(|o| o.u.is_empty()).collect();
    let exact = ride.variances_by_lyapunov(&all).unwrap().unwrap();
    let known: Vec<usize> = (0..all.len()).filter(|i| exact[*i].is_some_and(|v| v.rms().is_some())).collect();
    assert!(known.len() > 3, "{} outputs to compare", known.len());
    let subset: Vec<&Output> = known.iter().map(|i| all[*i]).collect();
    let integrated = ride.variances_by_quadrature(&subset).unwrap();
    for (k, i) in known.iter().enumerate() {
        let (a, b) = (exact[*i].unwrap().rms().unwrap(), integrated[k].rms().unwrap());
        // the promise is 1e-6
        assert!(a == b || (a / b - 1.0).abs() < 1e-6, "{}: {a} by Lyapunov, {b} by quadrature", all[*i].name);
    }
}

#[test]
fn lyapunov_and_quadrature_agree_on_rational_roads() {
    let full = cases::vehicle("guiggiani-full-car").unwrap(); // damped tires, exact delays
    let half = cases::vehicle("turkay-half-car").unwrap();
    let quarter = cases::vehicle("turkay-quarter-car").unwrap();
    let white = Spectrum::white_velocity(1.4e-4).unwrap();
    let first = Spectrum::first_order(0.0195, 0.0572).unwrap();
    let second = Spectrum::Filter(
        ShapingFilter::from_zeros_poles(
            &[C64::new(-0.9, 0.0)],
            &[C64::new(-0.04, 0.1), C64::new(-0.04, -0.1), C64::new(-3.0, 0.0)],
            0.01,
            Shapes::Height,
            true,
        )
        .unwrap(),
    );
    for coherence in [Coherence::Independent, Coherence::Full, Coherence::None] {
        both_routes(&full, &Road::new(white.clone(), coherence), 20.0);
        both_routes(&half, &Road::new(first.clone(), coherence), 13.0);
    }
    both_routes(&full, &Road::new(first.clone(), Coherence::None), 31.0);
    both_routes(&full, &Road::new(second, Coherence::Full), 25.0);
    both_routes(&quarter, &Road::new(first, Coherence::Full), 20.0);
}

/// ẇ of intensity I on a tire so stiff that the body stands still beside it: m ë + c ė + k e = −m ẅ − c ẇ has E[e²] = I m/(2c) (1 + c²/(k m)),
/// whatever k is, and accelerations grow with √k. Displacements beside velocities are 1e-7 of them there.
#[test]
fn stiff_tires_keep_their_deflection() {
    let road = Road::new(Spectrum::white_velocity(1.0).unwrap(), Coherence::Full);
    let mut spec = cases::vehicle_spec("turkay-quarter-car").unwrap();
    let mut before: Option<f64> = None;
    for k in [1e10, 1e12, 1e14] {
        let car = spec.quarter_car.as_mut().unwrap();
        car.tire_stiffness_n_per_m = k;
        let expected = (car.unsprung_mass_kg / (2.0 * car.suspension_damping_n_s_per_m)).sqrt();
        let vehicle = spec.build_alone().unwrap();
        let outputs: Vec<&Output> =
            ["tire_deflection", "sprung_acceleration"].map(|n| vehicle.output(n).unwrap()).into();
        let found = finite(&Ride::new(&vehicle, &road, 20.0).unwrap().variances(&outputs).unwrap());
        assert!((found[0] / expected - 1.0).abs() < 1e-6, "{k:e}: {} for {expected}", found[0]);
        // what the body's own motion adds falls as 1/√k
        if let Some(before) = before {
            assert!((found[1] / before / 10.0 - 1.0).abs() < 1e-4, "{k:e}: {} after {before}", found[1]);
        }
        before = Some(found[1]);
    }
}

/// Heights that wander together move a car that anti-roll bars hold: its travels settle. The same road with a corner far below
/// all modes has them by Lyapunov's equation.
#[test]
fn travels_on_one_wandering_track_are_those_of_a_slow_corner() {
    let car = cases::vehicle("chalasani-full-car").unwrap();
    let (w, v, a) = (1e-4, 20.0, 1e-6);
    let white = Road::new(Spectrum::white_velocity(w).unwrap(), Coherence::Full);
    let slow = Road::new(Spectrum::first_order(f64::sqrt(w / v), a).unwrap(), Coherence::Full);
    for name in ["suspension_travel_front_left", "tire_force_rear_right"] {
        let output = [car.output(name).unwrap()];
        let of =
            |road: &Road| Ride::new(&car, road, v).unwrap().variances(&output).unwrap()[0].rms().unwrap();
        let (a, b) = (of(&white), of(&slow));
        // the corner is at 2e-5 rad/s, the slowest mode at 5
        assert!(a > 0.0 && (a / b - 1.0).abs() < 1e-5, "{name}: {a} {b}");
    }
    let roll = [car.output("roll_displacement").unwrap()];
    assert_eq!(Ride::new(&car, &white, v).unwrap().variances(&roll).unwrap(), [Variance::Finite(0.0)]);
}

/// Levels against an independent quadrature of the quarter car's textbook transfer functions, in both conventions:
/// Simpson's rule over ν with the convention's own definition of variance.
#[test]
fn absolute_levels_hold_in_both_conventions() {
    let vehicle = cases::vehicle("turkay-quarter-car").unwrap();
    let (ms, mu, ks, cs, kt) = (240.0, 36.0, 16e3, 980.0, 160e3);
    let (s0, v, band, e) = (16e-6, 20.0, [0.063, 17.77], 2.2);
    let acceleration = |omega: f64| {
        let s = C64::new(0.0, omega);
        let k = s * cs + C64::new(ks, 0.0);
        let det = (s * s * ms + k) * (s * s * mu + k + C64::new(kt, 0.0)) - k * k;
        (s * s * k * kt / det).norm_sqr()
    };
    // var = ∫ G |H|² dν for one-sided-rad-per-m
    let n = 400_000;
    let h = (band[1] - band[0]) / f64::from(n);
    let mut one_sided = 0.0;
    for i in 0..=n {
        let nu = band[0] + h * f64::from(i);
        let weight = if i == 0 || i == n {
            1.0
        } else if i % 2 == 1 {
            4.0
        } else {
            2.0
        };
        one_sided += weight * s0 * nu.powf(-e) * acceleration(nu * v);
    }
    one_sided *= h / 3.0;
    let rms = |convention| {
        let road = Road::new(Spectrum::power_law(s0, 1.0, e, band, convention).unwrap(), Coherence::Full);
        let ride = Ride::new(&vehicle, &road, v).unwrap();
        finite(&ride.variances(&[vehicle.output("sprung_acceleration").unwrap()]).unwrap())[0]
    };
    assert!((rms(Convention::OneSidedRadPerM) / one_sided.sqrt() - 1.0).abs() < 1e-8);
    // "paper": S(ω) = G/V itself, var = (1/π)∫S dω = (1/π)∫G dν
    assert!((rms(Convention::Paper) / (one_sided / PI).sqrt() - 1.0).abs() < 1e-8);
}

#[test]
fn the_covariance_function_is_that_of_its_spectrum() {
    let vehicle = cases::vehicle("guiggiani-full-car").unwrap();
    let names = ["heave_acceleration", "suspension_travel_rear_left", "body_acceleration_front_right"];
    let outputs: Vec<&Output> = names.iter().map(|n| vehicle.output(n).unwrap()).collect();
    // rational with delays: e^{Aτ}P against the integral of the same road entered as a table of many points
    let first = Spectrum::first_order(0.0195, 0.0572).unwrap();
    let road = Road::new(first.clone(), Coherence::Full);
    let nu: Vec<f64> = (0..4000).map(|i| 1e-4 * 1.004_f64.powi(i)).collect();
    let density = nu.iter().map(|nu| first.psd(nu * 20.0, 20.0) * 20.0).collect();
    let table = Spectrum::table(nu, density, Convention::Paper).unwrap();
    let tabulated = Road::new(table, Coherence::Full);
    let exact = Ride::new(&vehicle, &road, 20.0).unwrap();
    let direct = Ride::new(&vehicle, &tabulated, 20.0).unwrap();
    let size = exact.covariance(&outputs, 0.0).unwrap();
    for lag in [0.0, 0.07, 0.133, -0.4, 1.5] {
        let (a, b) = (exact.covariance(&outputs, lag).unwrap(), direct.covariance(&outputs, lag).unwrap());
        for i in 0..3 {
            for j in 0..3 {
                let scale = (size[(i, i)] * size[(j, j)]).sqrt();
                assert!(
                    (a[(i, j)] - b[(i, j)]).abs() < 3e-5 * scale,
                    "lag {lag} [{i}{j}] {} {}",
                    a[(i, j)],
                    b[(i, j)]
                );
            }
        }
    }
    // R_ij(τ) = R_ji(−τ)
    let (plus, minus) = (exact.covariance(&outputs, 0.2).unwrap(), exact.covariance(&outputs, -0.2).unwrap());
    assert!((plus[(0, 1)] - minus[(1, 0)]).abs() < 1e-12 * size[(0, 0)].sqrt());
}

#[test]
fn an_undamped_vehicle_and_a_standing_one_are_refused() {
    let mut spec = cases::vehicle_spec("turkay-quarter-car").unwrap();
    let road = cases::road("iso8608-c").unwrap();
    let vehicle = spec.build_alone().unwrap();
    assert!(Ride::new(&vehicle, &road, 0.0).is_err() && Ride::new(&vehicle, &road, f64::NAN).is_err());
    spec.quarter_car.as_mut().unwrap().suspension_damping_n_s_per_m = 0.0;
    let undamped = spec.build_alone().unwrap();
    assert!(Ride::new(&undamped, &road, 20.0).is_err());
}

/// White road height through damped tires, and velocity with a zero at s = 0: what is finite is found so, by both routes.
#[test]
fn proper_height_and_differentiated_velocity() {
    let vehicle = cases::vehicle("guiggiani-full-car").unwrap();
    let pole = |v: f64| C64::new(v, 0.0);
    let filter = |zeros: &[C64], poles: &[C64], gain, of| {
        Spectrum::Filter(ShapingFilter::from_zeros_poles(zeros, poles, gain, of, false).unwrap())
    };
    let height = Road::new(filter(&[pole(-2.0)], &[pole(-1.0)], 0.001, Shapes::Height), Coherence::Full);
    let rms = |road: &Road, name: &str| -> Option<f64> {
        let ride = Ride::new(&vehicle, road, 20.0).unwrap();
        ride.variances(&[vehicle.output(name).unwrap()]).unwrap()[0].rms()
    };
    // figures of an independent NumPy integration
    for (name, value) in [
        ("heave_displacement", 0.003_059_50),
        ("unsprung_displacement_front_left", 0.006_443_8),
        ("heave_velocity", 0.029_557_9),
    ] {
        let found = rms(&height, name).unwrap();
        assert!((found / value - 1.0).abs() < 1e-5, "{name}: {found}");
    }
    assert!(rms(&height, "unsprung_velocity_front_left").is_none());
    assert!(rms(&height, "tire_deflection_front_left").is_none());
    both_routes(&vehicle, &height, 20.0);

    let poles = [pole(-1.0), pole(-5.0)];
    let velocity = Road::new(filter(&[pole(0.0)], &poles, 0.05, Shapes::Velocity), Coherence::Independent);
    let same = Road::new(filter(&[], &poles, 0.05, Shapes::Height), Coherence::Independent);
    for name in ["heave_displacement", "suspension_travel_rear_left", "roll_acceleration"] {
        let (a, b) = (rms(&velocity, name).unwrap(), rms(&same, name).unwrap());
        assert!((a / b - 1.0).abs() < 1e-10, "{name}: {a} {b}");
    }
    assert!((rms(&velocity, "heave_displacement").unwrap() / 0.003_585_18 - 1.0).abs() < 1e-5);
}

/// A tire's deflection z_u − w rests at zero whatever the heights are, so that no stiffness may make it wander: what elimination leaves
/// of the other wheel's height is rounding.
#[test]
fn no_stiffness_lets_a_tires_deflection_wander() {
    let road = cases::road("turkay-white-velocity").unwrap();
    let spec = cases::vehicle_spec("turkay-half-car").unwrap();
    let mut before: Option<Vec<f64>> = None;
    for k in 0..200 {
        let mut spec = spec.clone();
        let half = spec.half_car.as_mut().unwrap();
        half.front.suspension_stiffness_n_per_m = LeftRight::Both(15_000.0 + 10.05 * f64::from(k));
        let car = spec.build_alone().unwrap();
        let names =
            ["tire_deflection_front", "tire_deflection_rear", "tire_force_front", "suspension_travel_rear"];
        let outputs = names.map(|n| car.output(n).unwrap());
        let ride = Ride::new(&car, &road, 20.0).unwrap();
        let rms = finite(&ride.variances(&outputs).unwrap());
        assert_eq!(rms.len(), names.len(), "{} N/m", 15_000.0 + 10.05 * f64::from(k));
        // .067 % of one stiffness moves no rms by more
        if let Some(before) = before {
            assert!(rms.iter().zip(&before).all(|(a, b)| (a / b - 1.0).abs() < 1e-3), "{rms:?} {before:?}");
        }
        before = Some(rms);
    }
}
