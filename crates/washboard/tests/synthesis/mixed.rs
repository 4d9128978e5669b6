//! Mixed H2/H∞ designs by matrix inequalities: the quarter car of the thesis (§5.2) and an example that solvers failed at.

use washboard::linalg::Mat;
use washboard::lti::{GeneralizedPlant, Signals, StateSpace};
use washboard::optimize::SdpSettings;
use washboard::synthesis::{
    H2Goal, HinfGoal, LyapunovScale, MixedController, MixedEnd, MixedGoals, PoleRegion, StateFeedback,
    SynthesisError, h2, hinf, mixed_h2_hinf, robust_state_feedback,
};

fn m(rows: usize, cols: usize, v: &[f64]) -> Mat {
    Mat::from_fn(rows, cols, |i, j| v[i * cols + j])
}

/// x = (body velocity, travel, wheel velocity, tire deflection), w the road's velocity; z = acceleration, travel, tire
/// deflection, y of these. Written down here from the equations of motion of table 4.1.
fn quarter_car(ct: f64, y: &[usize]) -> GeneralizedPlant {
    let (ms, mu, ks, cs, kt) = (240.0, 36.0, 16000.0, 980.0, 160e3);
    let a = [
        [-cs / ms, -ks / ms, cs / ms, 0.0],
        [1.0, 0.0, -1.0, 0.0],
        [cs / mu, ks / mu, -(cs + ct) / mu, -kt / mu],
        [0.0, 0.0, 1.0, 0.0],
    ]
    .concat();
    let b = m(4, 2, &[0.0, 1.0 / ms, 0.0, 0.0, ct / mu, -1.0 / mu, -1.0, 0.0]);
    let z = [[-cs / ms, -ks / ms, cs / ms, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
    let d = [[0.0, 1.0 / ms], [0.0, 0.0], [0.0, 0.0]];
    let rows: Vec<usize> = [0, 1, 2].iter().chain(y).copied().collect();
    let c = Mat::from_fn(rows.len(), 4, |i, j| z[rows[i]][j]);
    let d = Mat::from_fn(rows.len(), 2, |i, j| d[rows[i]][j]);
    let names = |v: &[&str]| v.iter().map(|n| (*n).to_owned()).collect::<Vec<_>>();
    let signals = Signals {
        disturbances: names(&["w"]),
        controls: names(&["u"]),
        performances: names(&["acceleration", "travel", "tire"]),
        measurements: y.iter().map(|k| format!("y{k}")).collect(),
    };
    GeneralizedPlant::new(StateSpace::continuous(m(4, 4, &a), b, c, d).unwrap(), signals).unwrap()
}

/// ρ₁ = 1/‖G₁‖₂, ρ₂ = λ/‖G₂‖₂ and γ = μ‖G₃‖∞ of the passive car.
fn goals(passive: &GeneralizedPlant, lambda: f64, mu: f64, scale: LyapunovScale) -> MixedGoals {
    let of = |row: usize| passive.passive().select(&[row], &[0]).unwrap();
    let outputs = vec![(0, 1.0 / of(0).h2_norm().unwrap()), (1, lambda / of(1).h2_norm().unwrap())];
    let bound = Some(mu * of(2).hinf_norm().unwrap().norm);
    MixedGoals {
        h2: vec![H2Goal { outputs, weight: 1.0, ..H2Goal::default() }],
        hinf: vec![HinfGoal { outputs: vec![(2, 1.0)], disturbances: vec![], weight: 0.0, bound }],
        region: PoleRegion::default(),
        scale,
        back_off: 1e-3,
    }
}

const FIXED: LyapunovScale = LyapunovScale::Fixed(1.0);

fn feedback(vertices: &[GeneralizedPlant], goals: &MixedGoals) -> StateFeedback {
    match robust_state_feedback(vertices, goals, &SdpSettings::default()).unwrap() {
        MixedEnd::Found(found) => found,
        other => panic!("{other:?}"),
    }
}

fn controller(plant: &GeneralizedPlant, goals: &MixedGoals) -> MixedController {
    match mixed_h2_hinf(plant, goals, &SdpSettings::default()).unwrap() {
        MixedEnd::Found(found) => found,
        other => panic!("{other:?}"),
    }
}

/// Notes on §5.2.1: the guaranteed cost with the blocks (−I, −γ²I); a free scale of the common Lyapunov matrix is 12 to 22 %
/// better. The promise is tight in neither: true norms are .87 to .94 γ.
#[test]
fn the_quarter_cars_guaranteed_cost_is_the_notes() {
    for (mu, ct, published) in [
        (1.0, 0.0, 1.30523),
        (1.0, 50.0, 1.30914),
        (1.0, 100.0, 1.31127),
        (2.0, 0.0, 0.57442),
        (2.0, 50.0, 0.52389),
        (2.0, 100.0, 0.47419),
    ] {
        let car = quarter_car(ct, &[0]);
        let fixed = feedback(std::slice::from_ref(&car), &goals(&car, 0.1, mu, FIXED));
        assert!((fixed.claims.objective - published).abs() < 1e-5, "{mu} {ct}: {}", fixed.claims.objective);
        let free = feedback(std::slice::from_ref(&car), &goals(&car, 0.1, mu, LyapunovScale::Searched));
        println!(
            "mu {mu}, c_t {ct}: {:.5} fixed, {:.5} free at s = {:.3}, iterations {:?}",
            fixed.claims.objective, free.claims.objective, free.claims.scales[0], free.iterations
        );
        assert!(free.claims.objective < 0.89 * fixed.claims.objective);
        // the same program with the scale that was found
        let again = feedback(
            std::slice::from_ref(&car),
            &goals(&car, 0.1, mu, LyapunovScale::Fixed(free.claims.scales[0])),
        );
        assert!((again.claims.objective / free.claims.objective - 1.0).abs() < 1e-6);
        if ct == 50.0 {
            assert!(free.claims.objective <= if mu == 1.0 { 1.155 } else { 0.417 });
        }
        for found in [fixed, free] {
            let (bound, norm) = (found.claims.hinf[0], found.achieved[0].hinf[0]);
            assert!(norm < bound && norm > 0.85 * bound, "{norm} of {bound}");
        }
    }
}

/// Several H2 norms: two channels cost what they cost stacked, and a bound at a point of their trade-off gives that point
/// (for H2 norms alone one Lyapunov matrix, the covariance, is exact).
#[test]
fn a_bounded_h2_norm_is_the_trade_offs_point() {
    let car = quarter_car(50.0, &[0]);
    let stacked = MixedGoals { hinf: vec![], ..goals(&car, 0.5, 1.0, FIXED) };
    let outputs = stacked.h2[0].outputs.clone();
    let channel = |k: usize, weight: f64, bound: Option<f64>| H2Goal {
        outputs: vec![outputs[k]],
        weight,
        bound,
        ..H2Goal::default()
    };
    let apart = MixedGoals { h2: vec![channel(0, 1.0, None), channel(1, 1.0, None)], ..stacked.clone() };
    let cars = std::slice::from_ref(&car);
    let (one, two) = (feedback(cars, &stacked), feedback(cars, &apart));
    assert!((one.claims.objective / two.claims.objective - 1.0).abs() < 1e-6);
    let [comfort, travel] = two.achieved[0].h2[..] else { panic!("{:?}", two.achieved) };
    assert!((comfort.hypot(travel) / one.achieved[0].h2[0] - 1.0).abs() < 1e-4);
    let bounded =
        MixedGoals { h2: vec![channel(0, 1.0, None), channel(1, 0.0, Some(travel))], ..stacked.clone() };
    let found = feedback(cars, &bounded);
    let [a, t] = found.achieved[0].h2[..] else { panic!("{:?}", found.achieved) };
    assert!((a / comfort - 1.0).abs() < 1e-4 && t <= travel * (1.0 + 1e-6), "{a} {comfort}, {t} {travel}");
    assert!((found.claims.objective.sqrt() / comfort - 1.0).abs() < 1e-4);
    // by output feedback, which has all states but for noise
    let seen = quarter_car(50.0, &[0, 1, 2]);
    let wide = controller(&seen, &apart);
    let [comfort, travel] = wide.achieved.h2[..] else { panic!("{:?}", wide.achieved) };
    let bounded = MixedGoals { h2: vec![channel(0, 1.0, None), channel(1, 0.0, Some(travel))], ..stacked };
    let found = controller(&seen, &bounded);
    // both give up `back_off` of their own cost
    assert!((found.achieved.h2[0] / comfort - 1.0).abs() < 5e-3 && found.achieved.h2[1] <= travel * 1.0001);
}

/// Where γ² is minimised too, the program is not linear in the scale, and the scale is searched: no number does better.
#[test]
fn the_scale_that_is_searched_is_the_best() {
    let car = quarter_car(50.0, &[0]);
    let mut asked = goals(&car, 0.1, 1.0, LyapunovScale::Searched);
    asked.hinf[0].weight = asked.hinf[0].bound.take().unwrap().powi(-2);
    let found = feedback(std::slice::from_ref(&car), &asked);
    let mut at = |s: f64| {
        asked.scale = LyapunovScale::Fixed(s);
        feedback(std::slice::from_ref(&car), &asked).claims.objective
    };
    let scanned: Vec<f64> = [0.1, 0.2, 0.35, 0.5, 0.6, 0.7, 0.85, 1.0, 1.5, 3.0].map(&mut at).to_vec();
    println!("{:.5} at s = {:.3}; {scanned:.5?}", found.claims.objective, found.claims.scales[0]);
    let best = scanned.iter().copied().fold(f64::INFINITY, f64::min);
    assert!(found.claims.objective <= best * (1.0 + 1e-5), "{} {best}", found.claims.objective);
    assert!(found.claims.objective < 0.99 * scanned[7], "s = 1 is as good");
}

/// Output feedback approaches state feedback, by one measurement or two; D₂₂ is there.
#[test]
fn the_quarter_cars_output_feedback_comes_near_its_state_feedback() {
    for y in [vec![1], vec![0, 1]] {
        let car = quarter_car(50.0, &y);
        let asked = MixedGoals { back_off: 0.01, ..goals(&car, 0.1, 1.0, FIXED) };
        let full = feedback(std::slice::from_ref(&car), &asked);
        let found = controller(&car, &asked);
        println!(
            "{y:?}: {:.5} for {:.5}, condition {:.1e}, iterations {:?}",
            found.claims.objective, full.claims.objective, found.condition, found.iterations
        );
        // nothing that is measured beats all states, and these measurements reach them
        let share = found.optimum / full.claims.objective;
        assert!((-1e-6..1e-3).contains(&(share - 1.0)), "{share}");
        assert!(found.claims.objective <= 1.02 * full.claims.objective && found.condition < 1e6);
        assert!(found.achieved.hinf[0] <= found.claims.hinf[0]);
    }
}

/// A gain from well inside is within its share of the least value and not the least one; where the solver passed no such
/// point there is none.
#[test]
fn a_state_feedback_from_well_inside_gives_up_its_share() {
    let car = quarter_car(50.0, &[0]);
    let asked = goals(&car, 0.1, 1.0, FIXED);
    let least = feedback(std::slice::from_ref(&car), &asked);
    for share in [0.05, 0.2, 0.5] {
        let settings = SdpSettings { interior_gap: Some(share), ..SdpSettings::default() };
        match robust_state_feedback(std::slice::from_ref(&car), &asked, &settings).unwrap() {
            MixedEnd::Found(inside) => {
                let more = inside.claims.objective / least.claims.objective - 1.0;
                println!("{share}: {more:e}");
                assert!(more > 0.0 && more <= share && inside.gain != least.gain, "{share}: {more}");
                assert!(inside.achieved[0].hinf[0] <= inside.claims.hinf[0]);
            }
            MixedEnd::Stalled(measures) => assert!(measures.worst() < 1e-7, "{share}"),
            MixedEnd::Infeasible { .. } => panic!("{share}"),
        }
    }
}

/// Table 5.1, rms of white road velocity of intensity (2π n₀)²κv, κ = .76e-5 m³, n₀ = .15708 cycles/m, v = 20 m/s: one gain for c_t from 25 to 50, and the gain for c_t = 0, at c_t = 25, 35, 50. Of the
/// robust gain the printed accelerations .4881, .4856, .4818 are a little worse than the optimum of the stated problem.
#[test]
fn one_gain_for_a_range_of_tires() {
    let asked = goals(&quarter_car(0.0, &[0]), 0.1, 1.0, FIXED);
    let robust = feedback(&[quarter_car(25.0, &[0]), quarter_car(50.0, &[0])], &asked);
    let nominal = feedback(&[quarter_car(0.0, &[0])], &asked);
    let rms = |gain: &Mat, ct: f64, row: usize| {
        let car = quarter_car(ct, &[0]);
        let (a, c) = (car.a() + car.b2() * gain, car.c1() + car.d12() * gain);
        let closed = StateSpace::continuous(a, car.b1(), c, car.d11()).unwrap();
        (std::f64::consts::TAU * 0.15708)
            * (0.76e-5 * 20f64).sqrt()
            * closed.select(&[row], &[0]).unwrap().h2_norm().unwrap()
    };
    for (ct, passive, k0, kp) in
        [(25.0, 0.5379, 0.4951, 0.48789), (35.0, 0.5361, 0.4926, 0.48536), (50.0, 0.5336, 0.4889, 0.48162)]
    {
        let (found0, foundp) = (rms(&nominal.gain, ct, 0), rms(&robust.gain, ct, 0));
        println!("c_t {ct}: {found0:.5} {foundp:.5}");
        assert!((found0 - k0).abs() < 0.6e-4, "{ct}: {found0}");
        assert!((rms(&Mat::zeros(1, 4), ct, 0) - passive).abs() < 0.6e-4);
        assert!((foundp - kp).abs() < 2e-5, "{ct}: {foundp}");
        assert!((rms(&nominal.gain, ct, 1) - 0.0044).abs() < 0.5e-4);
    }
    // a promise for both vertices is not below one for each alone
    for ct in [25.0, 50.0] {
        let alone = feedback(&[quarter_car(ct, &[0])], &asked);
        assert!(alone.claims.objective <= robust.claims.objective * (1.0 + 1e-7));
    }
    assert_eq!(robust.achieved.len(), 2);
}

/// Scherer, Gahinet and Chilali 1997, example 7.
fn example_7() -> GeneralizedPlant {
    let b = m(3, 2, &[1.0, 0.0, 0.0, 1.0, 1.0, 0.0]);
    let mut c = Mat::zeros(6, 3);
    (c[(0, 0)], c[(2, 1)], c[(3, 2)], c[(5, 1)]) = (1.0, 1.0, 1.0, 1.0);
    let mut d = Mat::zeros(6, 2);
    (d[(1, 1)], d[(4, 1)], d[(5, 0)]) = (1.0, 1.0, 2.0);
    let a = m(3, 3, &[0.0, 10.0, 2.0, -1.0, 1.0, 0.0, 0.0, 2.0, -5.0]);
    let names = |n: usize, letter: &str| (0..n).map(|i| format!("{letter}{i}")).collect();
    let signals = Signals {
        disturbances: names(1, "w"),
        controls: names(1, "u"),
        performances: names(5, "z"),
        measurements: names(1, "y"),
    };
    GeneralizedPlant::new(StateSpace::continuous(a, b, c, d).unwrap(), signals).unwrap()
}

fn seventh(bound: Option<f64>, minimised: [f64; 2], scale: LyapunovScale) -> MixedGoals {
    let outputs = vec![(2, 1.0), (3, 1.0), (4, 1.0)];
    MixedGoals {
        h2: (minimised[0] > 0.0)
            .then(|| H2Goal { outputs, weight: minimised[0], ..H2Goal::default() })
            .into_iter()
            .collect(),
        hinf: (bound.is_some() || minimised[1] > 0.0)
            .then(|| HinfGoal {
                outputs: vec![(0, 1.0), (1, 1.0)],
                disturbances: vec![],
                weight: minimised[1],
                bound,
            })
            .into_iter()
            .collect(),
        region: PoleRegion::default(),
        scale,
        back_off: 1e-3,
    }
}

/// The whole trade-off, from the H2 optimum to the H∞ optimum, each by Riccati equations too.
#[test]
fn the_trade_off_of_example_7() {
    let plant = example_7();
    let part = |rows: &[&str]| plant.select(rows, &["y0"]).unwrap();
    let least = h2(&part(&["z2", "z3", "z4"])).unwrap().claimed_h2;
    assert!((least - 7.748).abs() < 5e-4, "{least}");
    let lowest = hinf(&part(&["z0", "z1"]), &Default::default()).unwrap().gamma;
    assert!((lowest - 9.508).abs() < 5e-4, "{lowest}");
    let alone = controller(&plant, &seventh(None, [1.0, 0.0], FIXED));
    assert!((alone.optimum.sqrt() / least - 1.0).abs() < 1e-6, "{}", alone.optimum.sqrt());
    assert!((alone.achieved.h2[0] / least - 1.0).abs() < 2e-3);
    let mut last = 0.0;
    for (bound, most) in
        [(1000.0, 7.76), (100.0, 7.82), (50.0, 8.01), (23.6, 8.96), (15.0, 11.41), (10.0, 24.22)]
    {
        let fixed = controller(&plant, &seventh(Some(bound), [1.0, 0.0], FIXED));
        let free = controller(&plant, &seventh(Some(bound), [1.0, 0.0], LyapunovScale::Searched));
        let (claimed, found) = (free.claims.h2[0], free.achieved.h2[0]);
        println!(
            "γ {bound}: ‖T₂‖ ≤ {claimed:.4} (is {found:.4}), ‖T∞‖ {:.3}, s {:.3}, fixed {:.4}",
            free.achieved.hinf[0], free.claims.scales[0], fixed.claims.h2[0]
        );
        assert!(free.optimum <= fixed.optimum * (1.0 + 1e-7) && claimed <= most, "{bound}: {claimed}");
        assert!(found >= least * (1.0 - 1e-9) && found <= claimed * (1.0 + 1e-4));
        assert!(claimed >= last, "not monotone at {bound}");
        last = claimed;
    }
}

/// Below the H∞ optimum there is a proof that nothing is feasible, and the bound that would be.
#[test]
fn a_bound_below_the_optimum_is_refused_with_the_one_that_is_not() {
    let asked = seventh(Some(8.0), [1.0, 0.0], FIXED);
    match mixed_h2_hinf(&example_7(), &asked, &SdpSettings::default()).unwrap() {
        MixedEnd::Infeasible { violation, bounds_times: Some(times) } => {
            assert!(violation < 1e-7, "{violation:e}");
            assert!((8.0 * times / 9.508 - 1.0).abs() < 1e-3, "{}", 8.0 * times);
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn poles_stay_in_their_region() {
    let car = quarter_car(50.0, &[0]);
    let mut asked = goals(&car, 0.1, 2.0, FIXED);
    let free = feedback(std::slice::from_ref(&car), &asked);
    asked.region = PoleRegion {
        faster_than: Some(3.0),
        slower_than: Some(120.0),
        below_frequency: Some(60.0),
        within: Some(110.0),
        cone: Some(1.2),
    };
    let found = feedback(std::slice::from_ref(&car), &asked);
    let inside = |p: &washboard::linalg::C64| {
        p.re < -3.0
            && p.re > -120.0
            && p.im.abs() < 60.0
            && p.norm() < 110.0
            && p.im.abs() < -p.re * 1.2f64.tan()
    };
    assert!(found.achieved[0].poles.iter().all(inside), "{:?}", found.achieved[0].poles);
    assert!(!free.achieved[0].poles.iter().all(inside), "the region asks for nothing");
    assert!(found.claims.objective > free.claims.objective);
    asked.back_off = 0.01;
    let output = controller(&quarter_car(50.0, &[0, 1]), &asked);
    assert!(output.achieved.poles.iter().all(inside), "{:?}", output.achieved.poles);
}

#[test]
fn wrong_goals_are_named() {
    let car = quarter_car(50.0, &[0]);
    let asked = goals(&car, 0.1, 1.0, FIXED);
    let refused = |change: &dyn Fn(&mut MixedGoals)| {
        let mut wrong = asked.clone();
        change(&mut wrong);
        robust_state_feedback(std::slice::from_ref(&car), &wrong, &SdpSettings::default())
            .unwrap_err()
            .to_string()
    };
    let text = refused(&|g| g.hinf[0].outputs = vec![(7, 1.0)]);
    assert!(text.contains("a goal's output") && text.contains("below 3"), "{text}");
    let text = refused(&|g| g.hinf[0].bound = Some(-1.0));
    assert!(text.contains("bound") && text.contains("-1"), "{text}");
    let text = refused(&|g| g.h2[0].outputs = vec![(0, 0.0)]);
    assert!(text.contains("a weight above 0"), "{text}");
    let text = refused(&|g| (g.region.faster_than, g.region.within) = (Some(9.0), Some(8.0)));
    assert!(text.contains("no pole is in this region") && text.contains('9'), "{text}");
}

/// An unstable mode that the control does not reach is named.
#[test]
fn a_vertex_that_cannot_be_stabilised_is_named() {
    let b = m(2, 2, &[1.0, 1.0, 1.0, 0.0]);
    let system =
        StateSpace::continuous(m(2, 2, &[-1.0, 0.0, 0.0, 0.5]), b, Mat::identity(2, 2), Mat::zeros(2, 2));
    let names = |v: &[&str]| v.iter().map(|n| (*n).to_owned()).collect::<Vec<_>>();
    let signals = Signals {
        disturbances: names(&["w"]),
        controls: names(&["u"]),
        performances: names(&["z"]),
        measurements: names(&["y"]),
    };
    let plant = GeneralizedPlant::new(system.unwrap(), signals).unwrap();
    let goals = MixedGoals {
        h2: Vec::new(),
        hinf: vec![HinfGoal {
            outputs: vec![(0, 1.0)],
            disturbances: vec![],
            weight: 0.0,
            bound: Some(100.0),
        }],
        region: PoleRegion::default(),
        scale: FIXED,
        back_off: 1e-3,
    };
    let end = robust_state_feedback(&[plant], &goals, &SdpSettings::default());
    assert!(matches!(&end, Err(SynthesisError::Assumptions(b)) if b.len() == 1), "{end:?}");
}
