//! A published H∞ example at its three weights, built from the case's parameters: MathWorks, "Robust Control of Active Suspension".

use crate::plants::{mathworks, names};
use washboard::cases;
use washboard::linalg::{C64, Mat};
use washboard::lti::{Continuous, GeneralizedPlant, Signals, StateSpace};
use washboard::road::{Coherence, Road, Spectrum};
use washboard::synthesis::{Certificate, HinfSettings, hinf};
use washboard::vehicle::{Disturbance, Output, PlantSettings};

type System = StateSpace<Continuous>;

/// gain (s/zero + 1)/(s/pole + 1).
fn lead(gain: f64, zero: f64, pole: f64) -> System {
    let one = |x: f64| Mat::from_fn(1, 1, |_, _| x);
    // gain·pole/zero·(1 + (zero − pole)/(s + pole))
    let through = gain * pole / zero;
    StateSpace::continuous(one(-pole), one(1.0), one(through * (zero - pole)), one(through)).unwrap()
}

fn gain(rows: &[&[f64]]) -> System {
    StateSpace::continuous_gain(Mat::from_fn(rows.len(), rows[0].len(), |i, j| rows[i][j])).unwrap()
}

fn side_by_side(systems: &[System]) -> System {
    systems.iter().skip(1).fold(systems[0].clone(), |all, one| all.append(one).unwrap())
}

/// d = [road, noise of sd, noise of ab], u in kN; e = [u weighted, ab weighted, sd weighted], y = [sd, ab] with noise.
///
/// The road is 7 cm high, the actuator 1/(s/60 + 1), noises 1 cm and 0.5 m/s²; the targets are 0.04(s/8 + 1)/(s/80 + 1) for
/// the travel and 0.4(s/0.45 + 1)/(s/150 + 1) for the body's acceleration, whose inverses are weighted by β and 1 − β.
fn example(beta: f64) -> GeneralizedPlant {
    let car = cases::vehicle("mathworks-quarter-car").unwrap();
    let road = Road::new(Spectrum::white_velocity(1.0).unwrap(), Coherence::Full);
    let outputs: Vec<&Output> =
        ["suspension_travel", "sprung_acceleration"].map(|name| car.output(name).unwrap()).into();
    let disturbance = Disturbance::RoadDisplacement;
    let settings = PlantSettings { road: (&road).into(), speed_m_s: 20.0, disturbance, delay_order: 0 };
    let bare = car.plant(&outputs, &[], &settings).unwrap().system().clone();
    // a positive force of the case's actuator pulls the body down: −1000 N a kN
    let lag = StateSpace::continuous(
        Mat::from_fn(1, 1, |_, _| -60.0),
        Mat::from_fn(1, 1, |_, _| 60.0),
        Mat::from_fn(1, 1, |_, _| -1000.0),
        Mat::zeros(1, 1),
    );
    // [d1 d2 d3 u] → [d1 u d2 d3 u] → [r f n2 n3 e1] → [sd ab n2 n3 e1] → [e1 ab sd y1 y2] → weighted
    let split: [&[f64]; 5] =
        [&[1., 0., 0., 0.], &[0., 0., 0., 1.], &[0., 1., 0., 0.], &[0., 0., 1., 0.], &[0., 0., 0., 1.]];
    let sum: [&[f64]; 5] = [
        &[0., 0., 0., 0., 1.],
        &[0., 1., 0., 0., 0.],
        &[1., 0., 0., 0., 0.],
        &[1., 0., 1., 0., 0.],
        &[0., 1., 0., 1., 0.],
    ];
    let pass = |n: usize| StateSpace::continuous_gain(Mat::identity(n, n)).unwrap();
    let chain = [
        side_by_side(&[
            gain(&[&[0.07]]),
            lag.unwrap(),
            gain(&[&[0.01]]),
            gain(&[&[0.5]]),
            lead(0.08, 50., 500.),
        ]),
        side_by_side(&[bare, pass(3)]),
        gain(&sum),
        side_by_side(&[pass(1), lead((1. - beta) / 0.4, 150., 0.45), lead(beta / 0.04, 80., 8.), pass(2)]),
    ];
    let system = chain.iter().fold(gain(&split), |all, next| all.series(next).unwrap());
    let signals = Signals {
        disturbances: names(&["road", "noise of sd", "noise of ab"]),
        controls: names(&["u"]),
        performances: names(&["force", "acceleration", "travel"]),
        measurements: names(&["sd", "ab"]),
    };
    GeneralizedPlant::new(system, signals).unwrap()
}

#[test]
fn the_plant_built_is_the_published_one() {
    let Some(data) = mathworks() else { return };
    let built = example(0.5);
    assert_eq!(built.order(), data.order());
    for omega in [0.0, 0.3, 7.0, 22.97, 56.27, 500.0] {
        let s = C64::new(0.0, omega);
        let (a, b) = (built.system().at(s).unwrap(), data.system().at(s).unwrap());
        assert!((&a - &b).norm_l2() < 1e-12 * b.norm_l2(), "{omega}: {a:?} {b:?}");
    }
}

#[test]
fn comfort_balanced_and_handling_levels_are_the_published_ones() {
    for (beta, published) in [(0.01, 0.94), (0.5, 0.67), (0.99, 0.89)] {
        let plant = example(beta);
        let found = hinf(&plant, &HinfSettings::default()).unwrap();
        // two digits are printed
        assert!((found.gamma - published).abs() <= 0.005, "β = {beta}: {} {published}", found.gamma);
        let certificate = Certificate::of(&plant, &found.controller).unwrap();
        assert!((certificate.hinf / found.gamma - 1.0).abs() < 1e-3, "{} {}", certificate.hinf, found.gamma);
        println!("β = {beta}: γ = {:.6}, the loop's own norm {:.6}", found.gamma, certificate.hinf);
    }
}
