//! Structures and limits are kept.

use super::collection::generalized;
use super::quarter::{quarter, quarter_targets};
use super::*;

/// Two controls and two measurements.
pub fn square(seed: u64) -> GeneralizedPlant {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut drawn = |r: usize, c: usize| Mat::from_fn(r, c, |_, _| rng.random_range(-1.0..1.0));
    let (a, b1, b2, c1, c2) = (drawn(4, 4), drawn(4, 2), drawn(4, 2), drawn(2, 4), drawn(2, 4));
    let d12 = Mat::from_fn(4, 2, |i, j| if i == 2 + j { 0.5 } else { 0.0 });
    let c1 = Mat::from_fn(4, 4, |i, j| if i < 2 { c1[(i, j)] } else { 0.0 });
    // stable by itself, so that 0 is a controller
    let a = a - Mat::identity(4, 4) * faer::Scale(1.8);
    generalized(&a, [&b1, &b2], [&c1, &c2], [&Mat::zeros(4, 2), &d12, &Mat::zeros(2, 2)])
}

/// [A_K, B_K; C_K, D_K].
fn entry(k: &System, i: usize, j: usize) -> f64 {
    let n = k.order();
    match (i < n, j < n) {
        (true, true) => k.a()[(i, j)],
        (true, false) => k.b()[(i, j - n)],
        (false, true) => k.c()[(i - n, j)],
        (false, false) => k.d()[(i - n, j - n)],
    }
}

/// Fixed entries to the bit, and free ones that are used.
fn kept(structure: &Structure, k: &System) {
    let n = structure.order();
    let mut used = 0;
    for i in 0..n + structure.controls() {
        for j in 0..n + structure.measurements() {
            match structure.entry(i, j) {
                Entry::Fixed(v) => assert_eq!(entry(k, i, j), v, "({i}, {j})"),
                Entry::Free => used += usize::from(entry(k, i, j) != 0.0),
            }
        }
    }
    assert!(used > 0);
}

#[test]
fn fixed_entries_are_kept_to_the_bit_and_cost_no_less() {
    let plant = square(5);
    let goal = target(0, Measure::Hinf(all_outputs(&plant)), Aim::Goal(1.0));
    let design = |structure: Structure| {
        let d = designed(&asked(vec![plant.clone()], vec![goal.clone()], structure.clone()), &few(6));
        kept(&structure, &d.controller);
        d
    };
    let full = design(Structure::full(2, 2, 2)).verified_goal.unwrap();
    let own = peak(&plant.passive(), &[0, 1, 2, 3]);

    let part = |k: usize| Local { order: 1, measurements: vec![k], controls: vec![k] };
    let apart = design(Structure::decentralised(2, 2, &[part(0), part(1)]).unwrap());
    // neither sees the other's measurement, at any frequency
    for omega in [0.0, 1.0, 30.0] {
        let response = apart.controller.at(C64::new(0.0, omega)).unwrap();
        assert_eq!((response[(0, 1)].norm(), response[(1, 0)].norm()), (0.0, 0.0));
    }

    let proper = Structure::full(2, 2, 2).strictly_proper();
    let no_feedthrough = design(proper);
    assert_eq!(no_feedthrough.controller.d().norm_max(), 0.0);

    let mut entries = vec![Entry::Free; 16];
    entries[0] = Entry::Fixed(-2.5);
    entries[7] = Entry::Fixed(0.125);
    let some = design(Structure::of_entries(2, 2, 2, entries).unwrap());

    for d in [&apart, &no_feedthrough, &some] {
        let goal = d.verified_goal.unwrap();
        println!("full {full:.6}, structured {goal:.6}, passive {own:.6}");
        // every one of them is a full one too; the search of that is held to 1.5 %: of this plant it ends in a local optimum
        // at .4451 to .4455 with 6, 12 and 24 tries, and the best of the others is .4405
        assert!(goal >= 0.985 * full && goal < own, "{goal} {full} {own}");
    }
}

#[test]
fn a_pid_controller_keeps_its_integrator_and_leaves_no_offset() {
    // ẋ = −x + w + u, z = [x; u], y = x: without an offset T(0) of x is 0
    let one = |v: f64| Mat::from_fn(1, 1, |_, _| v);
    let c1 = Mat::from_fn(2, 1, |i, _| if i == 0 { 1.0 } else { 0.0 });
    let d12 = Mat::from_fn(2, 1, |i, _| if i == 1 { 0.1 } else { 0.0 });
    let plant = generalized(
        &one(-1.0),
        [&one(1.0), &one(1.0)],
        [&c1, &one(1.0)],
        [&Mat::zeros(2, 1), &d12, &Mat::zeros(1, 1)],
    );
    let structure = Structure::pid(0.01).unwrap();
    let goal = target(0, Measure::Hinf(channel(&[0])), Aim::Goal(1.0));
    let bound = target(0, Measure::Hinf(channel(&[1])), Aim::Bound(0.2));
    let of = asked(vec![plant.clone()], vec![goal, bound], structure.clone());
    let d = designed(&of, &few(6));
    kept(&structure, &d.controller);
    let poles = d.controller.poles().unwrap();
    assert!(poles.iter().any(|p| p.norm() < 1e-12), "{poles:?}");
    assert!(d.controller.c()[(0, 0)].abs() > 1e-6, "the integrator does something");
    let closed = plant.close(&d.controller).unwrap();
    let offset = closed.at(C64::new(0.0, 0.0)).unwrap()[(0, 0)].norm();
    assert!(offset < 1e-9, "{offset:e}");
    assert!(peak(&closed, &[1]) <= 0.2 * (1.0 + 1e-4));
}

#[test]
fn limits_of_the_controller_are_kept() {
    let plant = square(5);
    let goal = target(0, Measure::Hinf(all_outputs(&plant)), Aim::Goal(1.0));
    let mut of = asked(vec![plant.clone()], vec![goal], Structure::full(2, 2, 2));
    let free = designed(&of, &few(4));
    of.max_gain = Some(0.3);
    of.max_pole_rad_s = Some(3.0);
    of.margin_rad_s = 0.05;
    let d = designed(&of, &few(4));
    let gain = peak(&d.controller, &[0, 1]);
    assert!(gain <= 0.3 * (1.0 + 1e-4), "{gain}");
    assert!(d.controller.poles().unwrap().iter().all(|p| p.norm() <= 3.0 * (1.0 + 1e-6)));
    let margin = plant.close(&d.controller).unwrap().least_stable_pole().unwrap().unwrap().1;
    assert!(margin >= 0.05, "{margin}");
    // the limits cost something, or this tests nothing
    assert!(free.verified_goal.unwrap() < 0.999 * d.verified_goal.unwrap(), "{gain} {d:?}");
}

/// A PID controller has three numbers: other starts end at the same optimum, and it is one. Norms fall right up to the edge of the
/// stable set, where the integrator's mode hardly shows in them; a search that the edge stops ends anywhere between .50 and 1.
#[test]
fn pid_controllers_from_other_starts_are_the_same() {
    let plant = quarter(0.0);
    let mut goals = Vec::new();
    for seed in 1..=3 {
        let of = asked(vec![plant.clone()], quarter_targets(&plant), Structure::pid(0.001).unwrap());
        let d = designed(&of, &FixedOrderSettings { seed, ..few(4) });
        assert!(d.stationarity.unwrap().distance < 0.2, "{:?}", d.stationarity);
        goals.push(d.verified_goal.unwrap());
    }
    assert!(goals.iter().all(|g| (g / goals[0] - 1.0).abs() < 1e-4 && *g < 0.501), "{goals:?}");
}

/// No gain keeps every limit of the gain, and is the least that a result is.
#[test]
fn a_limit_of_the_gain_that_allows_next_to_nothing_is_kept() {
    let plant = quarter(98.0);
    for order in [0, 1] {
        for most in [1e-4, 1e-2] {
            let mut of = asked(vec![plant.clone()], quarter_targets(&plant), Structure::full(order, 1, 1));
            of.max_gain = Some(most);
            let d = designed(&of, &few(2));
            assert!(d.violation <= 1e-6 && d.verified_goal.unwrap() <= 1.0 + 1e-6, "{order} {most}: {d:?}");
            assert!(peak(&d.controller, &[0]) <= most * (1.0 + 1e-5), "{order} {most}");
        }
    }
}

/// A margin and a limit of poles that new states at the car's own pace (25 rad/s) would not keep.
#[test]
fn more_states_are_never_worse_under_a_margin_and_a_limit_of_poles() {
    let plant = quarter(98.0);
    let mut before = f64::INFINITY;
    for order in 0..=2 {
        let mut of = asked(vec![plant.clone()], quarter_targets(&plant), Structure::full(order, 1, 1));
        of.margin_rad_s = 1.0;
        of.max_pole_rad_s = Some(3.0);
        let d = designed(&of, &few(4));
        let goal = d.verified_goal.unwrap();
        assert!(
            d.violation <= 1e-6 && goal <= before * (1.0 + 1e-9),
            "order {order}: {goal} after {before}, {d:?}"
        );
        let closed = plant.close(&d.controller).unwrap();
        assert!(closed.least_stable_pole().unwrap().unwrap().1 >= 1.0, "order {order}");
        before = goal;
    }
    assert!(before < 1.0, "{before}");
}
