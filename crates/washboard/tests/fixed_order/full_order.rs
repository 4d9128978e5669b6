//! At full order Riccati equations are the independent route.

use super::collection::generalized;
use super::*;

/// A random plant with D₁₂ and D₂₁ of full rank and D₁₁ = 0.
fn regular(seed: u64) -> GeneralizedPlant {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut drawn = |r: usize, c: usize| Mat::from_fn(r, c, |_, _| rng.random_range(-1.0..1.0));
    let (a, b1, b2, c1, c2) = (drawn(3, 3), drawn(3, 3), drawn(3, 1), drawn(3, 3), drawn(1, 3));
    let d12 = Mat::from_fn(3, 1, |i, _| if i == 2 { 0.5 } else { 0.1 });
    let d21 = Mat::from_fn(1, 3, |_, j| if j == 2 { 0.5 } else { 0.1 });
    generalized(&a, [&b1, &b2], [&c1, &c2], [&Mat::zeros(3, 3), &d12, &d21])
}

#[test]
fn at_full_order_the_h2_optimum_is_met_with_no_feedthrough() {
    for seed in [1, 2] {
        let plant = regular(seed);
        let known = h2(&plant).unwrap().claimed_h2;
        let goal = target(0, Measure::H2(all_outputs(&plant)), Aim::Goal(known));
        let of = asked(vec![plant.clone()], vec![goal], Structure::full(3, 1, 1));
        let d = designed(&of, &few(4));
        assert_eq!(d.controller.d().norm_max(), 0.0);
        let ratio = plant.close(&d.controller).unwrap().h2_norm().unwrap() / known;
        println!("H2 {seed}: {ratio:.8}");
        assert!((1.0 - 1e-8..1.005).contains(&ratio), "{seed}: {ratio}");
        assert!((d.verified_goal.unwrap() - ratio).abs() < 1e-9, "{:?}", d.verified_goal);
    }
}

#[test]
fn a_gain_alone_has_no_finite_h2_norm_but_0_where_noise_reaches_what_it_moves() {
    // A − 3I is stable: K = 0 is all that is left, and the norm is the passive plant's
    let plant = {
        let p = regular(3);
        let a = p.a() - Mat::identity(3, 3) * faer::Scale(3.0);
        generalized(&a, [&p.b1(), &p.b2()], [&p.c1(), &p.c2()], [&p.d11(), &p.d12(), &p.d21()])
    };
    let goal = target(0, Measure::H2(all_outputs(&plant)), Aim::Goal(1.0));
    let d = designed(&asked(vec![plant.clone()], vec![goal], Structure::full(0, 1, 1)), &few(2));
    assert_eq!(d.controller.d()[(0, 0)], 0.0);
    let own = plant.passive().h2_norm().unwrap();
    assert!((d.verified_goal.unwrap() / own - 1.0).abs() < 1e-9, "{own} {:?}", d.verified_goal);
}

#[test]
fn at_full_order_the_hinf_optimum_is_met_and_never_passed() {
    for seed in [1, 2] {
        let plant = regular(seed);
        let known = hinf(&plant, &HinfSettings::default()).unwrap();
        assert!(known.decided);
        let goal = target(0, Measure::Hinf(all_outputs(&plant)), Aim::Goal(known.gamma));
        let of = asked(vec![plant.clone()], vec![goal], Structure::full(3, 1, 1));
        let d = designed(&of, &few(8));
        let closed = plant.close(&d.controller).unwrap();
        let ratio = peak(&closed, &[0, 1, 2]) / known.gamma;
        println!("Hinf {seed}: {ratio:.8}");
        assert!((1.0 - 1e-6..1.01).contains(&ratio), "{seed}: {ratio}");
    }
}
