//! Controllers of given order: the quarter car's levels, a benchmark collection where it is present, independent routes
//! to full-order optima, structure, and what is refused.

#![allow(clippy::unwrap_used, clippy::print_stdout, clippy::print_stderr)]

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::Value;
use std::path::Path;
use washboard::cases;
use washboard::linalg::{C64, CMat, Mat};
use washboard::lti::{Continuous, GeneralizedPlant, LtiError, Signals, StateSpace};
use washboard::synthesis::{
    Aim, Channel, Entry, FixedOrder, FixedOrderDesign, FixedOrderEnd, FixedOrderSettings, HinfSettings,
    Local, Measure, Structure, SynthesisError, Target, fixed_order, h2, hinf,
};
use washboard::vehicle::{Disturbance, Output, PlantSettings};

/// Norms recomputed here and those reported: both are found to 1e-7 or better.
const NORMS: f64 = 1e-6;
/// A result above the best known one by more than this share is not as good.
const AS_GOOD: f64 = 1.005;

type System = StateSpace<Continuous>;

fn channel(rows: &[usize]) -> Channel {
    Channel { outputs: rows.iter().map(|r| (*r, 1.0)).collect(), disturbances: Vec::new() }
}

fn all_outputs(plant: &GeneralizedPlant) -> Channel {
    channel(&(0..plant.nz()).collect::<Vec<_>>())
}

fn target(plant: usize, measure: Measure, aim: Aim) -> Target {
    Target { plant, measure, aim, name: "a target".into() }
}

fn asked(plants: Vec<GeneralizedPlant>, targets: Vec<Target>, structure: Structure) -> FixedOrder {
    FixedOrder {
        structure,
        plants,
        targets,
        max_pole_rad_s: None,
        max_gain: None,
        margin_rad_s: 0.0,
        starts: Vec::new(),
        frequencies_rad_s: Vec::new(),
    }
}

fn designed(asked: &FixedOrder, settings: &FixedOrderSettings) -> FixedOrderDesign {
    match fixed_order(asked, settings).unwrap() {
        FixedOrderEnd::Designed(d) => *d,
        other => panic!("not designed: {other:?}"),
    }
}

fn few(tries: usize) -> FixedOrderSettings {
    FixedOrderSettings { tries, lower_orders: false, ..FixedOrderSettings::default() }
}

fn largest(response: &CMat) -> f64 {
    response.singular_values().unwrap()[0]
}

/// ‖T‖∞ of rows by the library's norm and by plain solves around every lightly damped pole, whichever is larger.
fn peak(closed: &System, rows: &[usize]) -> f64 {
    let columns: Vec<usize> = (0..closed.inputs()).collect();
    let one = closed.select(rows, &columns).unwrap();
    let mut norm = one.hinf_norm().unwrap().norm;
    for p in one.poles().unwrap().iter().filter(|p| p.im > 0.0 && -p.re < 0.3 * p.norm()) {
        for k in -100..=100 {
            let omega = p.im + 0.05 * f64::from(k) * p.re.abs();
            if omega > 0.0 {
                norm = norm.max(largest(&one.at(C64::new(0.0, omega)).unwrap()));
            }
        }
    }
    norm
}

// ---- the quarter car ----

/// Acceleration, travel and tire deflection of the quarter car on white road velocity; the travel is measured.
fn quarter(ct: f64) -> GeneralizedPlant {
    let spec = cases::vehicle_spec("turkay-quarter-car").unwrap();
    let car = spec.with_overrides(&[("tire_damping_n_s_per_m".into(), ct)]).unwrap().build_alone().unwrap();
    let of = |name: &str| car.outputs().iter().find(|o| o.name == name).unwrap();
    let z: Vec<&Output> = ["sprung_acceleration", "suspension_travel", "tire_deflection"].map(of).into();
    let road = cases::road("turkay-white-velocity").unwrap();
    let disturbance = Disturbance::RoadVelocity;
    let settings = PlantSettings { road: (&road).into(), speed_m_s: 20.0, disturbance, delay_order: 2 };
    car.plant(&z, &[z[1]], &settings).unwrap()
}

/// The passive car's norms.
fn passive(plant: &GeneralizedPlant) -> [f64; 3] {
    let passive = plant.passive();
    [0, 1, 2].map(|row| peak(&passive, &[row]))
}

/// ‖T₁‖∞ against the passive car's, under bounds as shares of the passive car's travel and tire deflection.
fn quarter_targets(plant: &GeneralizedPlant) -> Vec<Target> {
    let norms = passive(plant);
    let hinf = |row: usize| Measure::Hinf(channel(&[row]));
    vec![
        target(0, hinf(0), Aim::Goal(norms[0])),
        target(0, hinf(1), Aim::Bound(norms[1])),
        target(0, hinf(2), Aim::Bound(norms[2])),
    ]
}

fn quarter_design(order: usize, settings: &FixedOrderSettings) -> FixedOrderDesign {
    let plant = quarter(98.0);
    let targets = quarter_targets(&plant);
    let mut of = asked(vec![plant], targets, Structure::full(order, 1, 1));
    of.max_pole_rad_s = Some(5e3);
    designed(&of, settings)
}

#[test]
fn the_quarter_cars_levels_fall_with_the_order_to_what_no_controller_beats() {
    let plant = quarter(98.0);
    let norms = passive(&plant);
    let mut before = f64::INFINITY;
    for (order, level) in [(1, 0.4543), (2, 0.4515), (3, 0.4514)] {
        let d = quarter_design(order, &FixedOrderSettings::default());
        assert_eq!(d.controller.order(), order);
        let closed = plant.close(&d.controller).unwrap();
        assert!(closed.is_stable().unwrap());
        let goal = peak(&closed, &[0]) / norms[0];
        println!("order {order}: {goal:.6}, distance {:?}", d.stationarity);
        assert!(goal <= level, "order {order}: {goal}");
        // the least of any controller of any order
        assert!(goal >= 0.45012 - 1e-5, "order {order}: {goal}");
        assert!(goal <= before + 1e-6, "order {order}: {goal} after {before}");
        assert!((d.verified_goal.unwrap() / goal - 1.0).abs() < NORMS, "{d:?}");
        for row in [1, 2] {
            let norm = peak(&closed, &[row]);
            assert!(norm <= norms[row] * (1.0 + 1e-4), "order {order}, row {row}: {norm} {}", norms[row]);
            assert!((d.values[row].value / norm - 1.0).abs() < NORMS, "{d:?}");
        }
        for pole in d.controller.poles().unwrap() {
            assert!(pole.norm() <= 5e3, "order {order}: {pole}");
        }
        before = goal;
    }
}

#[test]
fn one_thread_and_two_give_the_same_bits() {
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| quarter_design(2, &few(4)))
    };
    let bits = |d: &FixedOrderDesign| {
        let k = &d.controller;
        let mut all: Vec<u64> = Vec::new();
        for m in [k.a(), k.b(), k.c(), k.d()] {
            all.extend((0..m.ncols()).flat_map(|j| (0..m.nrows()).map(move |i| m[(i, j)].to_bits())));
        }
        all.extend(d.values.iter().map(|v| v.value.to_bits()));
        all.extend(d.stationarity.map(|s| s.distance.to_bits()));
        all
    };
    let (one, two) = (on(1), on(2));
    assert_eq!(bits(&one), bits(&two));
    assert_eq!((one.values, one.work), (two.values, two.work));
}

#[test]
fn a_controller_of_two_plants_has_the_best_worst_case() {
    let plants = [quarter(0.0), quarter(98.0)];
    let norms = plants.each_ref().map(passive);
    let goals = |k: usize, plant: usize| -> Vec<Target> {
        let goal = |row: usize| target(plant, Measure::Hinf(channel(&[row])), Aim::Goal(norms[k][row]));
        (0..3).map(goal).collect()
    };
    let worst = |controller: &System| {
        let ratio = |k: usize| {
            let closed = plants[k].close(controller).unwrap();
            // a single plant's controller need not stabilise the other
            if !closed.is_stable().unwrap() {
                return f64::INFINITY;
            }
            (0..3).map(|row| peak(&closed, &[row]) / norms[k][row]).fold(0.0, f64::max)
        };
        ratio(0).max(ratio(1))
    };
    let design = |plants: Vec<GeneralizedPlant>, targets: Vec<Target>| {
        let mut of = asked(plants, targets, Structure::full(1, 1, 1));
        of.max_pole_rad_s = Some(5e3);
        designed(&of, &few(8))
    };
    let both = design(plants.to_vec(), [goals(0, 0), goals(1, 1)].concat());
    let of_both = worst(&both.controller);
    assert!((both.verified_goal.unwrap() / of_both - 1.0).abs() < NORMS, "{} {of_both}", both.goal.unwrap());
    for k in [0, 1] {
        let alone = design(vec![plants[k].clone()], goals(k, 0));
        let of_alone = worst(&alone.controller);
        println!("worst case: of both {of_both:.5}, of plant {k} alone {of_alone:.5}");
        assert!(of_both <= of_alone + 1e-6, "{of_both} {of_alone}");
        // and none is as good on a plant as that plant's own
        assert!(alone.verified_goal.unwrap() <= of_both + 1e-6, "{of_both} {:?}", alone.verified_goal);
    }
}

#[test]
fn bounds_that_no_controller_meets_are_reported_with_their_least_excess() {
    let plant = quarter(98.0);
    let norms = passive(&plant);
    // under the same travel and tire deflection no controller has less than 0.45012 of the acceleration
    let mut targets = quarter_targets(&plant);
    targets[0].aim = Aim::Bound(0.2 * norms[0]);
    for goal in [None, Some(target(0, Measure::Abscissa, Aim::Goal(1.0)))] {
        let mut all = targets.clone();
        all.extend(goal);
        let of = asked(vec![plant.clone()], all, Structure::full(1, 1, 1));
        let FixedOrderEnd::BoundsNotMet(d) = fixed_order(&of, &few(4)).unwrap() else {
            panic!("bounds that can't be met are met");
        };
        let closed = plant.close(&d.controller).unwrap();
        let limits = [0.2 * norms[0], norms[1], norms[2]];
        let excess =
            (0..3).map(|row| peak(&closed, &[row]) / limits[row] - 1.0).fold(f64::NEG_INFINITY, f64::max);
        println!("violation {}", d.violation);
        assert!(d.violation > 0.0 && (d.violation - excess).abs() < 1e-5, "{} {excess}", d.violation);
    }
}

// ---- a benchmark collection ----

/// The collection, where it is here.
fn collection() -> Option<Value> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/compleib/compleib_part.json");
    let Ok(text) = std::fs::read_to_string(&path) else {
        eprintln!("skipped: {} is not here", path.display());
        return None;
    };
    // facts beside the matrices hold infinities, which are no JSON
    Some(serde_json::from_str(&text.replace("Infinity", "null")).unwrap())
}

fn plant_of(v: &Value) -> GeneralizedPlant {
    let m = |name: &str| {
        let rows: Vec<Vec<f64>> = serde_json::from_value(v[name].clone()).unwrap();
        Mat::from_fn(rows.len(), rows[0].len(), |i, j| rows[i][j])
    };
    let [a, b1, b2, c1, c2] = ["A", "B1", "B", "C1", "C"].map(m);
    let [d11, d12, d21] = ["D11", "D12", "D21"].map(m);
    generalized(&a, [&b1, &b2], [&c1, &c2], [&d11, &d12, &d21])
}

/// Without D₂₂.
fn generalized(a: &Mat, b: [&Mat; 2], c: [&Mat; 2], d: [&Mat; 3]) -> GeneralizedPlant {
    let (n, nw, nu) = (a.nrows(), b[0].ncols(), b[1].ncols());
    let (nz, ny) = (c[0].nrows(), c[1].nrows());
    let system = StateSpace::continuous(
        a.clone(),
        Mat::from_fn(n, nw + nu, |i, j| if j < nw { b[0][(i, j)] } else { b[1][(i, j - nw)] }),
        Mat::from_fn(nz + ny, n, |i, j| if i < nz { c[0][(i, j)] } else { c[1][(i - nz, j)] }),
        Mat::from_fn(nz + ny, nw + nu, |i, j| match (i < nz, j < nw) {
            (true, true) => d[0][(i, j)],
            (true, false) => d[1][(i, j - nw)],
            (false, true) => d[2][(i - nz, j)],
            (false, false) => 0.0,
        }),
    )
    .unwrap();
    let names = |letter: &str, n: usize| (1..=n).map(|k| format!("{letter}{k}")).collect();
    let signals = Signals {
        disturbances: names("w", nw),
        controls: names("u", nu),
        performances: names("z", nz),
        measurements: names("y", ny),
    };
    GeneralizedPlant::new(system, signals).unwrap()
}

fn static_hinf(plant: &GeneralizedPlant) -> FixedOrder {
    let goal = target(0, Measure::Hinf(all_outputs(plant)), Aim::Goal(1.0));
    asked(vec![plant.clone()], vec![goal], Structure::full(0, plant.nu(), plant.ny()))
}

#[test]
fn static_gains_of_a_collection_are_as_good_as_the_best_known() {
    let Some(all) = collection() else { return };
    for name in ["AC7", "NN1", "EB1", "DLR1", "MFP", "NN5", "HE4", "AC16"] {
        let plant = plant_of(&all[name]);
        let best = all[name]["best_known_static_hinf_upper_bound"].as_f64().unwrap();
        let d = designed(&static_hinf(&plant), &few(12));
        let closed = plant.close(&d.controller).unwrap();
        assert!(closed.is_stable().unwrap(), "{name}");
        let norm = peak(&closed, &(0..plant.nz()).collect::<Vec<_>>());
        println!("{name}: {norm:.6} best known {best:.6} ratio {:.6}", norm / best);
        assert!(
            (d.verified_goal.unwrap() / norm - 1.0).abs() < NORMS,
            "{name}: {norm} {:?}",
            d.verified_goal
        );
        assert!(norm <= AS_GOOD * best, "{name}: {norm} {best}");
    }
}

#[test]
fn plants_without_a_stabilising_gain_are_said_to_be_so() {
    let Some(all) = collection() else { return };
    // one control and one measurement: the root locus says how far left a gain brings the rightmost pole
    for (name, known) in [("REA4", 0.6425), ("NN3", 2.1358)] {
        let plant = plant_of(&all[name]);
        let locus = |gain: f64| {
            let k = System::continuous_gain(Mat::from_fn(1, 1, |_, _| gain)).unwrap();
            let poles = plant.close(&k).unwrap().poles().unwrap();
            poles.iter().map(|p| p.re).fold(f64::NEG_INFINITY, f64::max)
        };
        let steps = (0..=4000).map(|k| 10f64.powf(-8.0 + 0.004 * f64::from(k)));
        let least = steps.flat_map(|g| [locus(g), locus(-g)]).fold(locus(0.0), f64::min);
        let FixedOrderEnd::NotStabilised { abscissa, .. } =
            fixed_order(&static_hinf(&plant), &few(4)).unwrap()
        else {
            panic!("{name} is stabilised");
        };
        println!("{name}: {abscissa} locus {least}");
        assert!(least > known - 1e-4, "{name}: {least}");
        // what is reported is a pole of some gain, and within 1e-3 of the least
        assert!(abscissa > least - 1e-4 && abscissa < least + 1e-3, "{name}: {abscissa} {least}");
    }
}

// ---- full order: Riccati equations are the independent route ----

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

// ---- structure ----

/// Two controls and two measurements.
fn square(seed: u64) -> GeneralizedPlant {
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
        // every one of them is a full one too; the search of that is held to 1 %
        assert!(goal >= 0.99 * full && goal < own, "{goal} {full} {own}");
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

// ---- what is refused ----

#[test]
fn wrong_calls_are_typed_errors() {
    let plant = square(5);
    let good = || target(0, Measure::Hinf(all_outputs(&plant)), Aim::Goal(1.0));
    let ask = || asked(vec![plant.clone()], vec![good()], Structure::full(1, 2, 2));
    let refused = |of: &FixedOrder| match fixed_order(of, &few(1)) {
        Err(SynthesisError::Lti(e)) => e,
        other => panic!("not refused: {other:?}"),
    };
    let joins = |of: FixedOrder, which: &str| match refused(&of) {
        LtiError::Join { what, .. } => assert_eq!(what, which),
        other => panic!("{which}: {other:?}"),
    };
    joins(FixedOrder { plants: Vec::new(), ..ask() }, "a fixed-order design");
    joins(FixedOrder { targets: Vec::new(), ..ask() }, "a fixed-order design");
    joins(FixedOrder { structure: Structure::full(1, 1, 2), ..ask() }, "a controller's structure");
    joins(FixedOrder { plants: vec![plant.clone(), quarter(98.0)], ..ask() }, "a controller's structure");
    let fewer = plant.select(&["z1"], &["y1", "y2"]).unwrap();
    joins(FixedOrder { plants: vec![plant.clone(), fewer], ..ask() }, "plants of one design");
    joins(FixedOrder { targets: vec![Target { plant: 1, ..good() }], ..ask() }, "a target's plant");
    let of_channel = |outputs: Vec<(usize, f64)>, disturbances: Vec<usize>| {
        let measure = Measure::Hinf(Channel { outputs, disturbances });
        FixedOrder { targets: vec![Target { measure, ..good() }], ..ask() }
    };
    joins(of_channel(vec![], vec![]), "a target's outputs");
    joins(of_channel(vec![(0, 0.0)], vec![]), "a target's outputs");
    joins(of_channel(vec![(4, 1.0)], vec![]), "a target's output");
    joins(of_channel(vec![(0, 1.0)], vec![2]), "a target's disturbance");

    let fields = |of: FixedOrder, which: &str, value: f64| match refused(&of) {
        LtiError::Field { field, found, .. } => {
            assert_eq!((field, found.to_bits()), (which, value.to_bits()));
        }
        other => panic!("{which}: {other:?}"),
    };
    fields(of_channel(vec![(0, 1.0), (1, -1.0)], vec![]), "a target's weight", -1.0);
    for number in [0.0, -1.0, f64::INFINITY, f64::NAN] {
        for aim in [Aim::Goal(number), Aim::Bound(number)] {
            let targets = vec![Target { aim, ..good() }];
            fields(FixedOrder { targets, ..ask() }, "a target's unit or bound", number);
        }
        fields(FixedOrder { max_pole_rad_s: Some(number), ..ask() }, "max_pole", number);
        fields(FixedOrder { max_gain: Some(number), ..ask() }, "max_gain", number);
    }
    for number in [-1.0, f64::INFINITY, f64::NAN] {
        fields(FixedOrder { margin_rad_s: number, ..ask() }, "margin", number);
    }
    // an abscissa's bound may be negative, its unit may not
    let abscissa = |aim: Aim| FixedOrder { targets: vec![target(0, Measure::Abscissa, aim)], ..ask() };
    fields(abscissa(Aim::Goal(-1.0)), "a target's unit or bound", -1.0);
    assert!(fixed_order(&abscissa(Aim::Bound(-0.01)), &few(1)).is_ok());
}

#[test]
fn structures_that_are_none_are_typed_errors() {
    let join = |r: Result<Structure, LtiError>, which: &str| match r {
        Err(LtiError::Join { what, .. }) => assert_eq!(what, which),
        other => panic!("{which}: {other:?}"),
    };
    join(Structure::of_entries(1, 1, 1, vec![Entry::Free; 3]), "a controller's structure");
    let part =
        |controls: &[usize], y: usize| Local { order: 1, measurements: vec![y], controls: controls.to_vec() };
    for parts in [vec![part(&[0], 0)], vec![part(&[0, 1], 0), part(&[1], 1)], vec![part(&[0, 1, 2], 0)]] {
        join(Structure::decentralised(2, 2, &parts), "a decentralised structure");
    }
    join(Structure::decentralised(2, 2, &[part(&[0, 1], 2)]), "a decentralised structure");
    let field = |r: Result<Structure, LtiError>, value: f64| match r {
        Err(LtiError::Field { found, .. }) => assert_eq!(found.to_bits(), value.to_bits()),
        other => panic!("{other:?}"),
    };
    field(Structure::of_entries(0, 1, 1, vec![Entry::Fixed(f64::NAN)]), f64::NAN);
    for filter in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        field(Structure::pid(filter), filter);
    }
}
