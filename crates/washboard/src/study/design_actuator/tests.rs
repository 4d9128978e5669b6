use super::*;
use crate::study::design_problem::Norm;
use crate::study::{DesignOutcome, Goal, design};

/// Fifteen halvings of a quarter of the value, and the delay's approximation.
const BISECTED: f64 = 1e-3;

fn quarter(actuator: ActuatorSection) -> (DesignSpec, DesignOutcome) {
    let minimize = ["sprung_acceleration", "suspension_travel", "tire_deflection"];
    let spec = DesignSpec {
        vehicle: "case:turkay-quarter-car".into(),
        road: "case:turkay-white-velocity".into(),
        speed_m_s: 20.0,
        measurements: vec!["suspension_travel".into()],
        r#override: [("tire_damping_n_s_per_m".to_owned(), 98.0)].into_iter().collect(),
        input_weight: 1e-9,
        goal: Goal { minimize: minimize.iter().map(|n| ((*n).to_owned(), 1.0)).collect(), ..Goal::default() },
        actuator: Some(actuator),
        ..DesignSpec::default()
    };
    let outcome = design(&spec).unwrap().0;
    (spec, outcome)
}

/// Evenly in log ω, so near to each other that what is between them does not count.
fn omegas() -> Vec<f64> {
    (0..400_000).map(|k| 0.5 * (1e4f64.ln() * f64::from(k) / 4e5).exp()).collect()
}

/// K G a(s) over frequency, the delay left out.
fn open_loop(problem: &Problem, k: &StateSpace<Continuous>, a: &ActuatorSection, omegas: &[f64]) -> Vec<C64> {
    let car = &problem.vehicle;
    let back = car.actuated(&[car.output("suspension_travel").unwrap()], &[0]).unwrap();
    let open = back.series(k).unwrap().frequency_response(omegas).unwrap();
    let corner = rad_per_s(a.bandwidth_hz);
    let low_pass = |w: f64| {
        let x = C64::new(0.0, w / corner);
        if a.order == 1 { x + 1.0 } else { x * x + x * 2f64.sqrt() + 1.0 }
    };
    omegas.iter().zip(open).map(|(w, l)| l[(0, 0)] / low_pass(*w)).collect()
}

#[test]
fn the_largest_delay_is_the_delay_margin() {
    for order in [1, 2] {
        let actuator = ActuatorSection { bandwidth_hz: 60.0, delay_s: 0.0, order };
        let (spec, outcome) = quarter(actuator);
        let found = outcome.robustness.as_ref().unwrap().actuator.as_ref().unwrap();
        assert!(found.stable == Some(true) && found.stated && found.delay_order == 0, "{found:?}");
        let [none, largest] = found.delay_s.stable[0];
        assert_eq!(none, 0.0);
        // with u = +K y a pole crosses where K G a e^{−iωT} = 1: of all ω with |K G a| = 1 the least T
        let omegas = omegas();
        let problem = Problem::new(&spec, Norm::H2).unwrap();
        let k = outcome.controller.as_ref().unwrap().state_space().unwrap();
        let l = open_loop(&problem, &k, &actuator, &omegas);
        let crossing = |k: &usize| (l[*k].norm() - 1.0) * (l[*k + 1].norm() - 1.0) <= 0.0;
        let turn = |k: usize| l[k].arg().rem_euclid(std::f64::consts::TAU) / omegas[k];
        let margin = (0..l.len() - 1).filter(crossing).map(turn).fold(f64::INFINITY, f64::min);
        let ratio = largest / margin;
        assert!((ratio - 1.0).abs() < BISECTED, "order {order}: {largest} {margin}");
    }
}

/// A spring so many times as stiff as the car's own, by the actuator: late by 4 ms, it is a negative damper of 64 N s/m each.
fn stiff(times: f64, actuator: ActuatorSection) -> (Problem, StateSpace<Continuous>, ActuatorLoop) {
    let minimize = [("suspension_travel".to_owned(), 1.0)];
    let spec = DesignSpec {
        vehicle: "case:turkay-quarter-car".into(),
        road: "case:turkay-white-velocity".into(),
        speed_m_s: 20.0,
        measurements: vec!["suspension_travel".into()],
        r#override: [("tire_damping_n_s_per_m".to_owned(), 98.0)].into_iter().collect(),
        goal: Goal { minimize: minimize.into_iter().collect(), ..Goal::default() },
        actuator: Some(actuator),
        ..DesignSpec::default()
    };
    let problem = Problem::new(&spec, Norm::H2).unwrap();
    let k = StateSpace::continuous_gain(Mat::from_fn(1, 1, |_, _| times * 16000.0)).unwrap();
    let nominal = GoalNorms::of(&problem, &k).unwrap().unwrap();
    let found = with_actuator(&problem, &k, &nominal).unwrap();
    (problem, k, found)
}

#[test]
fn at_the_least_fast_bandwidth_the_loop_swings_on_with_the_exact_delay() {
    let actuator = ActuatorSection { bandwidth_hz: 200.0, delay_s: 0.004, order: 1 };
    let (problem, k, found) = stiff(8.0, actuator);
    assert_eq!(found.stable, Some(true), "{found:?}");
    let [least, _] = *found.bandwidth_hz.stable.last().unwrap();
    let omegas = omegas();
    let nearest = |bandwidth_hz: f64| {
        let l = open_loop(&problem, &k, &ActuatorSection { bandwidth_hz, ..actuator }, &omegas);
        let turned = l.iter().zip(&omegas).map(|(l, w)| l * C64::from_polar(1.0, -w * actuator.delay_s));
        turned.map(|l| (l - 1.0).norm()).fold(f64::INFINITY, f64::min)
    };
    // K G a e^{−iωT} = 1 there, and not at twice that
    assert!(nearest(least) < 5.0 * BISECTED, "{} at {least}", nearest(least));
    assert!(nearest(2.0 * least) > 20.0 * BISECTED, "{}", nearest(2.0 * least));
}

#[test]
fn stable_bandwidths_are_those_that_nyquist_counts_with_the_exact_delay() {
    let actuator = ActuatorSection { bandwidth_hz: 5.0, delay_s: 0.004, order: 1 };
    let (problem, k, found) = stiff(3.0, actuator);
    let omegas = omegas();
    // vehicle, gain and low-pass are stable: −π of the phase of 1 − K G a e^{−iωT} for every unstable pole of the loop
    let unstable = |bandwidth_hz: f64| {
        let l = open_loop(&problem, &k, &ActuatorSection { bandwidth_hz, ..actuator }, &omegas);
        let f: Vec<C64> = l
            .iter()
            .zip(&omegas)
            .map(|(l, w)| C64::new(1.0, 0.0) - l * C64::from_polar(1.0, -w * actuator.delay_s))
            .collect();
        let turned: f64 = f.windows(2).map(|f| (f[1] / f[0]).arg()).sum();
        (-turned / std::f64::consts::PI).round() as i32
    };
    // a slow low-pass hardly does a thing, a fast one is a spring, one between them is a negative damper
    let [slow, fast] = found.bandwidth_hz.stable[..] else { panic!("{found:?}") };
    assert_eq!(found.stable, Some(false), "{found:?}");
    let [low, high] = found.bandwidth_hz.looked_at.unwrap();
    assert!(slow[0] == low && fast[1] == high && low == 0.1, "{found:?}");
    for (bandwidth_hz, stable) in [
        (low, true),
        (0.9 * slow[1], true),
        (1.1 * slow[1], false),
        (actuator.bandwidth_hz, false),
        (0.9 * fast[0], false),
        (1.1 * fast[0], true),
    ] {
        let count = unstable(bandwidth_hz);
        assert_eq!(count == 0, stable, "{bandwidth_hz} Hz: {count} {found:?}");
    }
    let words = found.bandwidth_hz.words(|v| format!("{v:.1} Hz"));
    assert!(
        words.starts_with("up to ")
            && words.contains(" and from ")
            && words.contains("looked at: 0.1 Hz to "),
        "{words}"
    );
}

#[test]
fn a_delay_that_cannot_be_approximated_is_told() {
    let (_, _, found) = stiff(8.0, ActuatorSection { bandwidth_hz: 1e4, delay_s: 0.5, order: 1 });
    assert!(found.stable.is_none() && found.delay_error > DELAY_ERROR, "{found:?}");
    // less of either could be looked at
    assert!(found.delay_s.looked_at.is_some_and(|[none, most]| none == 0.0 && most < 0.5), "{found:?}");
}

#[test]
fn a_delay_that_nothing_notices_is_none() {
    let goal = |delay_s: f64| {
        let (_, outcome) = quarter(ActuatorSection { bandwidth_hz: 10.0, delay_s, order: 1 });
        let found = outcome.robustness.unwrap().actuator.unwrap();
        assert_eq!(found.stable, Some(true), "{delay_s:e}");
        (found.goal.unwrap(), found.delay_order)
    };
    let none = goal(0.0);
    for delay in [1e-300, 1e-20, 1e-15] {
        assert_eq!(goal(delay), none, "{delay:e}");
    }
    let (short, order) = goal(1e-6);
    assert!(order > 0 && (short / none.0 - 1.0).abs() < 1e-4, "{short} {none:?}");
}

#[test]
fn the_error_of_a_delay_is_the_one_of_its_system() {
    for order in [2, 3, 7, 12] {
        for x in [0.3, 1.0, 2.5] {
            let g = pade_delay(0.1, order).unwrap().frequency_response(&[x / 0.1]).unwrap()[0][(0, 0)];
            let known = (g - C64::from_polar(1.0, -x)).norm();
            assert!((pade_error(x, order) - known).abs() < 1e-9, "{order} {x}");
        }
    }
}

#[test]
fn actuators_that_are_none_are_refused() {
    let wrong = |actuator| {
        let spec = DesignSpec { actuator: Some(actuator), ..DesignSpec::default() };
        spec.check_actuator().unwrap_err().to_string()
    };
    let good = ActuatorSection { bandwidth_hz: 20.0, delay_s: 0.005, order: 1 };
    assert!(wrong(ActuatorSection { bandwidth_hz: 0.0, ..good }).contains("actuator.bandwidth_hz"));
    assert!(wrong(ActuatorSection { delay_s: -1.0, ..good }).contains("actuator.delay_s"));
    assert!(wrong(ActuatorSection { order: 3, ..good }).contains("Butterworth"));
}
