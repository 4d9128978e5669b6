//! Q̂ and K of the hybrid design a second time: from values, by subspace interpolation, not by polynomial division.

use crate::cars::{ROAD, car};
use washboard::linalg::{C64, CMat};
use washboard::lti::{Polynomial, Rational, RationalFunction, to_f64};
use washboard::subspace::{Domain, Interpolant, InterpolationData, Node, Point, interpolate};
use washboard::synthesis::achievable::{Hybrid, HybridSettings, Psi, hybrid};

/// Where both routes are compared, rad/s.
const HELD_OUT: [f64; 9] = [0.3, 1.7, 6.1, 13.0, 31.0, 66.0, 140.0, 420.0, 1700.0];

fn design() -> Hybrid {
    let settings = HybridSettings {
        fictitious_tire_damping: 1960.0,
        psi: Psi::PRINTED,
        sensor_noise: 1e-8,
        road_velocity_intensity: ROAD,
    };
    hybrid(&car(98.0), &settings).unwrap().unwrap()
}

fn one(x: C64) -> CMat {
    CMat::from_fn(1, 1, |_, _| x)
}

/// Values at `count` frequencies, at rest, and Markov parameters.
///
/// Not independent in all: the order and four coefficients (two Taylor's at rest, two Markov parameters) are those of the exact result;
/// the values at the frequencies are from the design's equations.
fn through(
    at: impl Fn(f64) -> C64,
    at_rest: &[Rational],
    at_infinity: &[Rational],
    count: usize,
    order: usize,
) -> Interpolant {
    let domain = Domain::HalfPlane { lambda_rad_s: 60.0 };
    let factorial = |k: usize| (1..=k).map(|i| i as f64).product::<f64>();
    let real = |x: f64| one(C64::new(x, 0.0));
    let rest = at_rest.iter().enumerate().map(|(k, t)| real(to_f64(t) * factorial(k))).collect();
    let mut nodes = vec![
        Node::full(C64::new(0.0, 0.0), rest),
        Node::at_infinity(at_infinity.iter().map(|m| real(to_f64(m))).collect()),
    ];
    for k in 0..count {
        let omega = 60.0 * (std::f64::consts::PI * (k as f64 + 0.5) / (2 * count) as f64).tan();
        nodes.push(Node {
            z: Point::Finite(C64::new(0.0, omega)),
            ..Node::full(C64::default(), vec![one(at(omega))])
        });
    }
    interpolate(&InterpolationData::new(domain, nodes).unwrap(), Some(order)).unwrap()
}

fn off(found: &Interpolant, expected: &RationalFunction) -> f64 {
    let mut worst = 0.0f64;
    for omega in HELD_OUT {
        let found = found.system.derivatives(Point::Finite(C64::new(0.0, omega)), 1).unwrap()[0][(0, 0)];
        let expected = expected.at_frequency(omega).unwrap();
        worst = worst.max((found - expected).norm() / expected.norm());
    }
    worst
}

/// (4.53) at nodes: Q̂ = (T Δ − s L (c_s s + k_s)) Δ/(m_s s³ L P₂), T = Ψ H₁/s, never reduced.
#[test]
fn q_hat_from_its_values_is_q_hat_from_its_polynomials() {
    let (found, car) = (design(), car(98.0));
    let f = RationalFunction::polynomial;
    let s = f(Polynomial::power_of_s(1));
    let (delta, l, p2) = (f(car.delta()), f(car.tire()), f(car.wheel_on_tire()));
    let suspension = f(car.suspension());
    let value = |omega: f64| {
        // each factor exactly at the node, rounded once after the difference that cancels
        let per_velocity = &found.target.over(&s).unwrap() * &delta;
        let above = &per_velocity - &(&(&s * &l) * &suspension);
        let at = |g: &RationalFunction| g.at_frequency(omega).unwrap();
        let s = C64::new(0.0, omega);
        at(&above) * at(&delta) / (s * s * s * 240.0 * at(&l) * at(&p2))
    };
    let degree = found.q_hat.degree();
    let (rest, infinity) = (found.q_hat.taylor(2).unwrap(), found.q_hat.at_infinity(2).unwrap());
    let again = through(value, &rest, &infinity, 20, degree);
    println!(
        "Q̂: order {}, nodes {:e}, held out {:e}",
        again.order,
        again.max_error,
        off(&again, &found.q_hat)
    );
    assert_eq!((again.order, again.stable), (13, true));
    assert!(again.max_error < 1e-9, "{:e}", again.max_error);
    assert!(off(&again, &found.q_hat) < 1e-7, "{:e}", off(&again, &found.q_hat));
}

/// K = −(c_s s + k_s) − m_s H₁/H₂ at nodes, from the responses.
#[test]
fn the_controller_from_its_values_is_the_controller() {
    let found = design();
    let value = |omega: f64| {
        let at = |k: usize| found.responses[k].at_frequency(omega).unwrap();
        -C64::new(16_000.0, 980.0 * omega) - at(0) / at(1) * 240.0
    };
    let (rest, infinity) = (found.controller.taylor(2).unwrap(), found.controller.at_infinity(2).unwrap());
    let again = through(value, &rest, &infinity, 16, 9);
    println!(
        "K: order {}, nodes {:e}, held out {:e}",
        again.order,
        again.max_error,
        off(&again, &found.controller)
    );
    assert_eq!(again.order, 9);
    assert!(again.max_error < 1e-9, "{:e}", again.max_error);
    assert!(off(&again, &found.controller) < 1e-7, "{:e}", off(&again, &found.controller));
}
