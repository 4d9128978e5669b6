//! The half car's and the full car's matrix inequalities of the thesis (§6.2, §7.2).

use washboard::optimize::SdpSettings;
use washboard::study::lmi_cars::{
    COMFORT, HalfCar, NOISES, TIRE, TRAVEL, full_car, full_car_goals, gain, h2, norms,
};
use washboard::synthesis::{LyapunovScale, MixedController, MixedEnd, mixed_h2_hinf, robust_state_feedback};
use washboard::vehicle::{Disturbance, HalfCarVariant};

const FIXED: LyapunovScale = LyapunovScale::Fixed(1.0);
const PRINTED: HalfCar = HalfCar { variant: HalfCarVariant::AsPrinted, inertia: 1.0 };

fn found<T: std::fmt::Debug>(end: MixedEnd<T>) -> T {
    match end {
        MixedEnd::Found(found) => found,
        other => panic!("{other:?}"),
    }
}

fn close(found: f64, expected: f64, share: f64) {
    assert!((found / expected - 1.0).abs() < share, "{found} for {expected}");
}

/// Changes of rms values against the passive car in %: travel f r, tire f r, heave, pitch.
fn changes(car: &HalfCar, ct: f64, rho: [f64; 2]) -> ([f64; 6], MixedController) {
    let plant = car.plant([ct, ct], Disturbance::RoadVelocity).unwrap();
    let goals = HalfCar::goals(&plant, rho, FIXED).unwrap();
    let found = found(mixed_h2_hinf(&plant, &goals, &SdpSettings::default()).unwrap());
    let before = norms(&plant.passive()).unwrap();
    let after = norms(&plant.close(&found.controller).unwrap()).unwrap();
    (std::array::from_fn(|k| 100.0 * (after[k] / before[k] - 1.0)), found)
}

/// Notes on chapter 6: what the published designs do to the passive car. Their costs (.07239, 2.419) are 1 % above the least ones,
/// which are those of state feedback; where the optimum is flat, changes differ by up to a point.
#[test]
fn the_half_cars_output_feedback_does_what_is_printed() {
    for (rho, published, cost) in [
        ([0.1, 1.5], [58.0, 69.0, 2.5, 4.1, -91.0, -90.0], 0.07175),
        ([1.0, 1.0], [-12.0, -5.8, -2.8, -0.9, -48.7, -45.9], 2.3889),
    ] {
        let (changes, found) = changes(&PRINTED, 0.0, rho);
        for (ours, theirs) in changes.iter().zip(published) {
            assert!((ours - theirs).abs() < 1.0, "{changes:.2?} for {published:?}");
        }
        // nothing that is measured beats all states, and both travels reach them
        assert!((0.9999 * cost..1.001 * cost).contains(&found.optimum), "{} {cost}", found.optimum);
        assert!(found.claims.objective < 1.0011 * found.optimum, "{}", found.claims.objective);
    }
}

/// The text's "tire damping affects only road holding" is of the printed matrices; halved pitch inertia follows the same pattern.
#[test]
fn tire_damping_and_pitch_inertia_change_little_of_the_half_car() {
    let (none, _) = changes(&PRINTED, 0.0, [1.0, 1.0]);
    let (most, _) = changes(&PRINTED, 100.0, [1.0, 1.0]);
    let half = HalfCar { inertia: 0.5, ..PRINTED };
    let (light, _) = changes(&half, 0.0, [1.0, 1.0]);
    for k in 0..6 {
        assert!((none[k] - most[k]).abs() < 1.0, "{none:.2?} {most:.2?}");
        assert!(none[k] * light[k] > 0.0 || none[k].abs() < 3.0, "{none:.2?} {light:.2?}");
    }
    assert!(light[4] < -40.0 && light[5] < -40.0, "{light:.2?}");
}

/// Notes: guaranteed costs of the box of tire dampings and of none, and the heave that the two gains leave at c_t = 100.
#[test]
fn one_gain_for_a_box_of_tires_of_the_half_car() {
    let corners = [[0.0, 0.0], [0.0, 100.0], [100.0, 0.0], [100.0, 100.0]];
    let plants = corners.map(|c| PRINTED.plant(c, Disturbance::RoadVelocity).unwrap());
    for (rho, nominal, robust) in [([1.0, 1.0], 2.3889, 2.3899), ([0.1, 1.5], 0.07175, 0.07175)] {
        let goals = HalfCar::goals(&plants[0], rho, FIXED).unwrap();
        let gain =
            |vertices| found(robust_state_feedback(vertices, &goals, &SdpSettings::default()).unwrap());
        let (one, all) = (gain(&plants[..1]), gain(&plants[..]));
        close(one.claims.objective, nominal, 1e-4);
        close(all.claims.objective, robust, 1e-4);
        assert!(all.claims.objective > one.claims.objective * (1.0 - 1e-6));
        if rho == [1.0, 1.0] {
            let intensity: f64 = 0.0027 * 0.0027 * 20.0;
            let heave = |at: &washboard::synthesis::StateFeedback| {
                let p = &plants[3];
                let (a, c) = (p.a() + p.b2() * &at.gain, p.c1() + p.d12() * &at.gain);
                let closed = washboard::lti::StateSpace::continuous(a, p.b1(), c, p.d11()).unwrap();
                intensity.sqrt() * h2(&closed, &[4]).unwrap()
            };
            close(heave(&all), 0.100713, 2e-5);
            close(heave(&one), 0.100715, 2e-5);
        }
    }
}

/// §7.2.1: λ = μ = .6, poles in the rectangle of 200 rad/s.
#[test]
fn the_full_cars_design_with_a_pole_rectangle() {
    let plant = full_car().unwrap();
    let goals = full_car_goals(&plant, [0.6, 0.6], 0.2, NOISES).unwrap();
    let found = found(mixed_h2_hinf(&plant, &goals, &SdpSettings::default()).unwrap());
    let closed = plant.close(&found.controller).unwrap();
    // printed 3.5916, .0722, .0030; the notes allow 1.5 %
    close(h2(&closed, &COMFORT).unwrap(), 3.57, 0.015);
    close(h2(&closed, &TRAVEL).unwrap(), 0.0718, 0.015);
    close(gain(&closed, &TIRE).unwrap(), 0.00292, 0.015);
    for (row, published) in [(0, 1.6955), (1, 1.1437), (2, 2.9290)] {
        close(h2(&closed, &[row]).unwrap(), published, 0.015);
    }
    assert!(found.achieved.poles.iter().all(|p| p.re < -0.199 && p.re > -200.2 && p.im.abs() < 200.2));
    // balanced truncation keeps the performance of a controller whose poles are left of −.2 rad/s
    for order in [10, 8, 6] {
        let small = found.controller.balanced_truncation(order).unwrap().system;
        let closed = plant.close(&small).unwrap();
        assert!(h2(&closed, &COMFORT).unwrap() < 3.6 && h2(&closed, &TRAVEL).unwrap() < 0.0735, "{order}");
        assert!(gain(&closed, &TIRE).unwrap() < 0.00305, "{order}");
    }
}
