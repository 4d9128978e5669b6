//! Tests of the bound: published, solved in closed form, and beside controllers.

#![allow(clippy::unwrap_used)]

use super::pointwise_bound;
use super::terms::Term;
use super::{discs, matrices};
use crate::linalg::{C64, CMat, Mat};
use crate::lti::{Continuous, GeneralizedPlant, Signals, StateSpace};
use crate::synthesis::{Aim, Channel, HinfSettings, Measure, Target, hinf};

/// m_s, m_u, k_s, k_t, c_s of the thesis's quarter car.
const CAR: [f64; 5] = [240.0, 36.0, 16_000.0, 160_000.0, 980.0];

/// From road velocity and force to sprung acceleration, travel and tire deflection; the travel is measured.
fn quarter(ct: f64) -> GeneralizedPlant {
    let [ms, mu, ks, kt, cs] = CAR;
    // x = [travel, sprung velocity, tire deflection, unsprung velocity]
    let spring = [ks, cs, 0.0, -cs];
    let sprung: Vec<f64> = spring.iter().map(|v| -v / ms).collect();
    let tire = [0.0, 0.0, kt, ct];
    let wheel: Vec<f64> = (0..4).map(|j| (spring[j] - tire[j]) / mu).collect();
    let rows = [vec![0.0, 1.0, 0.0, -1.0], sprung.clone(), vec![0.0, 0.0, 0.0, 1.0], wheel];
    let a = Mat::from_fn(4, 4, |i, j| rows[i][j]);
    let into = [[0.0, 0.0], [0.0, -1.0 / ms], [-1.0, 0.0], [ct / mu, 1.0 / mu]];
    let b = Mat::from_fn(4, 2, |i, j| into[i][j]);
    let outputs = [sprung, vec![1.0, 0.0, 0.0, 0.0], vec![0.0, 0.0, 1.0, 0.0], vec![1.0, 0.0, 0.0, 0.0]];
    let c = Mat::from_fn(4, 4, |i, j| outputs[i][j]);
    let d = Mat::from_fn(4, 2, |i, j| if (i, j) == (0, 1) { -1.0 / ms } else { 0.0 });
    plant(StateSpace::continuous(a, b, c, d).unwrap(), 1, 3)
}

fn plant(system: StateSpace<Continuous>, nw: usize, nz: usize) -> GeneralizedPlant {
    let names = |of: &str, n: usize| (0..n).map(|k| format!("{of}{k}")).collect();
    let signals = Signals {
        disturbances: names("w", nw),
        controls: names("u", system.inputs() - nw),
        performances: names("z", nz),
        measurements: names("y", system.outputs() - nz),
    };
    GeneralizedPlant::new(system, signals).unwrap()
}

fn target(rows: &[usize], aim: Aim) -> Target {
    let channel = Channel { outputs: rows.iter().map(|r| (*r, 1.0)).collect(), disturbances: Vec::new() };
    Target { plant: 0, measure: Measure::Hinf(channel), aim, name: format!("{rows:?}") }
}

fn passive(plant: &GeneralizedPlant, row: usize) -> f64 {
    plant.passive().select(&[row], &[0]).unwrap().hinf_norm().unwrap().norm
}

/// Numbers of no pattern in −1..1, from a seed.
fn numbers(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// (4.30) and |T₃| at its bound give .45012 on the true passive norms.
#[test]
fn the_quarter_car_has_the_published_bound() {
    let car = quarter(98.0);
    let norms = [0, 1, 2].map(|row| passive(&car, row));
    for (found, known) in norms.iter().zip([20.2570, 0.27351, 0.033104]) {
        assert!((found / known - 1.0).abs() < 2e-5, "{norms:?}");
    }
    let targets = [
        target(&[0], Aim::Goal(norms[0])),
        target(&[1], Aim::Bound(norms[1])),
        target(&[2], Aim::Bound(norms[2])),
    ];
    let found = pointwise_bound(&[car], &targets, &[]).unwrap();
    let goal = found.goal.unwrap();
    assert!((goal.level - 0.45012).abs() < 2e-5 && found.impossible.is_none(), "{found:?}");
    // next to √(k_t/m_u), where the acceleration is all but invariant
    assert!((goal.omega_rad_s / (CAR[3] / CAR[1]).sqrt() - 1.0).abs() < 0.02, "{goal:?}");
}

/// Without tire damping m_s|T₁| = m_u√(k_t/m_u) at √(k_t/m_u) whatever the control does.
#[test]
fn an_invariant_response_is_the_bound() {
    let car = quarter(0.0);
    let wheel = (CAR[3] / CAR[1]).sqrt();
    let invariant = CAR[1] * wheel / CAR[0];
    let targets = [target(&[0], Aim::Goal(1.0))];
    for given in [vec![], vec![wheel]] {
        let goal = pointwise_bound(std::slice::from_ref(&car), &targets, &given).unwrap().goal.unwrap();
        assert!((goal.level / invariant - 1.0).abs() < 1e-6, "{goal:?} {invariant}");
        assert!((goal.omega_rad_s / wheel - 1.0).abs() < 1e-6);
    }
    let tight = [target(&[0], Aim::Bound(0.5 * invariant)), target(&[1], Aim::Goal(1.0))];
    let found = pointwise_bound(&[car], &tight, &[]).unwrap();
    let lacks = found.impossible.unwrap();
    // less the 10⁻⁶ by which a bound may be exceeded, and 10⁻⁷
    assert!(found.goal.is_none() && (lacks.level - 2.0 * (1.0 - 1.1e-6)).abs() < 1e-7, "{found:?}");
}

/// What the force alone makes of one output can be made 0, and every program has nothing to hold.
#[test]
fn an_output_that_the_control_reaches_has_no_bound() {
    let car = quarter(98.0);
    let found = pointwise_bound(&[car], &[target(&[1], Aim::Goal(1.0))], &[]).unwrap();
    assert!(found.goal.unwrap().level < 1e-9, "{found:?}");
}

fn random_matrix(p: usize, q: usize, next: &mut impl FnMut() -> f64) -> CMat {
    CMat::from_fn(p, q, |_, _| C64::new(next(), next()))
}

/// Two routes to one number: discs, and the semidefinite program's dual.
#[test]
fn discs_and_the_program_agree() {
    let mut next = numbers(5);
    let mut contradictions = 0;
    for case in 0..30 {
        let terms: Vec<Term> = (0..2 + case % 3)
            .map(|k| {
                let p = 1 + (case + k) % 2;
                let a = random_matrix(p, 1, &mut next);
                Term { a, b: random_matrix(p, 1, &mut next), columns: vec![0], goal: k == 0 || k == 3 }
            })
            .collect();
        let (one, other) = (discs::least_level(&terms, 0.0), matrices::proven_level(&terms, 1, 0.0).unwrap());
        match (one, other) {
            (Some(x), Some(y)) => assert!((x - y).abs() < 1e-6 * (1.0 + x), "{case}: {x} {y}"),
            (x, y) => {
                assert!(x.is_none() && y.is_none(), "{case}: {x:?} {y:?}");
                contradictions += 1;
            }
        }
    }
    assert!((1..25).contains(&contradictions), "{contradictions}");
}

/// V reaches the last row alone: what it cannot better is the norm of the others, and with V there that is reached.
#[test]
fn the_program_leaves_the_norm_of_the_rows_that_no_control_reaches() {
    let mut next = numbers(11);
    for _ in 0..5 {
        let whole = random_matrix(4, 4, &mut next);
        let b = CMat::from_fn(4, 1, |i, _| C64::new(if i == 3 { 1.0 } else { 0.0 }, 0.0));
        let rest = CMat::from_fn(3, 4, |i, j| whole[(i, j)]).singular_values().unwrap()[0];
        let term = Term { a: whole, b, columns: vec![0, 1, 2, 3], goal: true };
        let found = matrices::proven_level(&[term], 4, 0.0).unwrap().unwrap();
        assert!((found / rest - 1.0).abs() < 1e-6, "{found} {rest}");
    }
}

/// The H∞ design reaches its least norm over all controllers: never below the bound.
#[test]
fn no_full_order_design_is_below_the_bound() {
    for seed in 1..=4 {
        let mut next = numbers(seed);
        let (n, nw, nu, nz, ny) = (4, 2, 1 + (seed % 2) as usize, 3, 2);
        let a = Mat::from_fn(n, n, |i, j| next() - if i == j { 0.8 } else { 0.0 });
        let b = Mat::from_fn(n, nw + nu, |_, _| next());
        let c = Mat::from_fn(nz + ny, n, |_, _| next());
        // D₁₂ and D₂₁ of full rank
        let d = Mat::from_fn(nz + ny, nw + nu, |i, j| {
            let control = i < nz && j >= nw && i + nu - nz == j - nw;
            let noise = i >= nz && j < nw && i - nz == j;
            if control || noise { 1.0 } else { 0.0 }
        });
        let plant = plant(StateSpace::continuous(a, b, c, d).unwrap(), nw, nz);
        let best = hinf(&plant, &HinfSettings::default()).unwrap();
        let found = pointwise_bound(std::slice::from_ref(&plant), &[target(&[0, 1, 2], Aim::Goal(1.0))], &[]);
        let level = found.unwrap().goal.unwrap().level;
        assert!(level <= best.achieved && level > 0.1 * best.achieved, "{level} {}", best.achieved);
    }
}

/// An undamped mode whose responses are all parallel to what the control makes of it: the truth is 0 at every frequency, and next to
/// the pole the responses are 1e15 with nothing left of their digits.
#[test]
fn rounding_next_to_a_pole_on_the_axis_proves_nothing() {
    for damping in [0.0, 1e-14, 1e-10, 1e-6] {
        for controls in [1, 2] {
            let a = Mat::from_fn(2, 2, |i, j| [[0.0, 1.0], [-2.0, -damping]][i][j]);
            // x in z's two rows by factors of no short binary form; the same force for the road and the control
            let b = Mat::from_fn(2, 1 + controls, |i, j| if i == 1 { [1.3, 0.7, 0.9][j] } else { 0.0 });
            let c = Mat::from_fn(3, 2, |i, j| if j == 0 { [0.37, 0.91, 1.0][i] } else { 0.0 });
            let d = Mat::zeros(3, 1 + controls);
            let plant = plant(StateSpace::continuous(a, b, c, d).unwrap(), 1, 2);
            let whole = |aim: Aim| target(&[0, 1], aim);
            let goal = pointwise_bound(std::slice::from_ref(&plant), &[whole(Aim::Goal(1.0))], &[]).unwrap();
            assert!(goal.goal.is_none_or(|g| g.level < 1e-6), "{damping} {controls}: {goal:?}");
            let bound = pointwise_bound(&[plant], &[whole(Aim::Bound(0.1))], &[]).unwrap();
            assert!(bound.impossible.is_none(), "{damping} {controls}: {bound:?}");
        }
    }
}

/// A zero of G_zu that is 1e-10 of the frequency away from the axis is none on it: a large control makes the output 0 there.
#[test]
fn a_zero_beside_the_axis_is_reached() {
    for ct in [1e-9, 3e-9, 1e-6] {
        let found = pointwise_bound(&[quarter(ct)], &[target(&[0], Aim::Goal(1.0))], &[]).unwrap();
        assert!(found.goal.is_none_or(|g| g.level < 1e-3), "{ct}: {found:?}");
    }
}

#[test]
fn a_disturbance_twice_is_refused() {
    let mut twice = target(&[0], Aim::Goal(1.0));
    twice.measure = Measure::Hinf(Channel { outputs: vec![(0, 1.0)], disturbances: vec![0, 0] });
    let said = pointwise_bound(&[quarter(98.0)], &[twice], &[]).unwrap_err().to_string();
    assert!(said.contains("0 twice"), "{said}");
}
