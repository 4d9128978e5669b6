//! Systems: what similarity, units, duality and the bilinear map leave as it is, connections as transfer functions, time
//! responses as integrals, and matrices of every kind.

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use washboard::linalg::{C64, CMat, Mat, solve, solve_complex};
use washboard::lti::{Continuous, Discrete, Hold, StateSpace};

type System = StateSpace<Continuous>;

/// Norms of systems of order eight, conditioned like 1e3 and changed by a similarity conditioned like 10.
const NORMS: f64 = 1e-9;
/// Poles and zeros of the same: simple ones, 1e-2 apart at the least.
const ROOTS: f64 = 1e-7;
/// Products of small matrices of entries below 1.
const ALGEBRA: f64 = 1e-11;

fn any(rng: &mut ChaCha8Rng, rows: usize, cols: usize) -> Mat {
    Mat::from_fn(rows, cols, |_, _| rng.random_range(-1.0..1.0))
}

fn random(rng: &mut ChaCha8Rng, [n, m, p]: [usize; 3], through: f64) -> System {
    let (a, b, c) = (any(rng, n, n), any(rng, n, m), any(rng, p, n));
    System::continuous(a, b, c, any(rng, p, m) * faer::Scale(through)).unwrap()
}

fn shifted(g: &System, by: f64) -> System {
    let n = g.order();
    let a = g.a() - Mat::identity(n, n) * faer::Scale(by);
    System::continuous(a, g.b().clone(), g.c().clone(), g.d().clone()).unwrap()
}

fn stable(rng: &mut ChaCha8Rng, shape: [usize; 3], through: f64) -> System {
    let g = random(rng, shape, through);
    let worst = g.least_stable_pole().unwrap().map_or(0.0, |(_, margin)| -margin);
    shifted(&g, worst + 0.1)
}

/// Largest distance of a value of one to its own nearest in the other, over the size of the largest.
fn distance(one: &[C64], other: &[C64]) -> f64 {
    assert_eq!(one.len(), other.len());
    let mut left = other.to_vec();
    let size = one.iter().map(|z| z.norm()).fold(1.0, f64::max);
    one.iter().fold(0.0, |worst: f64, z| {
        let near = |k: &usize| (left[*k] - z).norm();
        let k = (0..left.len()).min_by(|i, j| near(i).total_cmp(&near(j))).unwrap();
        worst.max((left.swap_remove(k) - z).norm() / size)
    })
}

/// Poles, zeros and both norms, of the strictly proper part for H2.
fn assert_alike(g: &System, other: &System, gain: f64, what: &str) {
    assert!(distance(&g.poles().unwrap(), &other.poles().unwrap()) < ROOTS, "poles: {what}");
    assert!(distance(&g.zeros().unwrap(), &other.zeros().unwrap()) < ROOTS, "zeros: {what}");
    let (one, two) = (g.hinf_norm().unwrap().norm, other.hinf_norm().unwrap().norm);
    assert!((two / one / gain - 1.0).abs() < NORMS, "H∞: {what}: {one} {two}");
    let proper = |g: &System| {
        let d = Mat::zeros(g.outputs(), g.inputs());
        System::continuous(g.a().clone(), g.b().clone(), g.c().clone(), d).unwrap().h2_norm().unwrap()
    };
    assert!((proper(other) / proper(g) / gain - 1.0).abs() < NORMS, "H2: {what}");
}

#[test]
fn similarity_units_and_duality_leave_poles_zeros_and_norms() {
    for seed in 0..24 {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let (n, m) = (rng.random_range(1..9), rng.random_range(1..4));
        let through = if seed % 2 == 0 { 1.0 } else { 0.0 };
        let g = stable(&mut rng, [n, m, m], through);
        let t = Mat::identity(n, n) + any(&mut rng, n, n) * faer::Scale(0.5 / n as f64);
        let over = |x: &Mat| solve(&t.transpose().to_owned(), &x.transpose().to_owned()).unwrap();
        let turned = System::continuous(
            over(&(&t * g.a())).transpose().to_owned(),
            &t * g.b(),
            over(g.c()).transpose().to_owned(),
            g.d().clone(),
        )
        .unwrap();
        assert_alike(&g, &turned, 1.0, &format!("similarity, seed {seed}"));
        let units: Vec<f64> = (0..n).map(|_| 10f64.powf(rng.random_range(-6.0..6.0))).collect();
        let scaled = g.with_states_scaled(&units).unwrap();
        assert_alike(&g, &scaled, 1.0, &format!("states, seed {seed}"));
        let (up, down) = (Mat::identity(m, m) * faer::Scale(1e6), Mat::identity(m, m) * faer::Scale(1e-9));
        let metres = System::continuous_gain(down).unwrap().series(&g).unwrap();
        let metres = metres.series(&System::continuous_gain(up).unwrap()).unwrap();
        assert_alike(&g, &metres, 1e-3, &format!("inputs and outputs, seed {seed}"));
        assert_alike(&g, &g.transposed(), 1.0, &format!("dual, seed {seed}"));
    }
}

fn close(found: &CMat, expected: &CMat) -> bool {
    (found - expected).norm_l2() <= ALGEBRA * expected.norm_l2().max(1.0)
}

#[test]
fn connections_of_any_shape_are_the_algebra_of_transfer_functions() {
    let s = C64::new(0.4, 2.3);
    for seed in 0..300 {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let [n, k, m, p, q] = [0; 5].map(|_| rng.random_range(0..4));
        let (g, h) = (random(&mut rng, [n, m, p], 0.3), random(&mut rng, [k, p, q], 0.3));
        let (gs, hs) = (g.at(s).unwrap(), h.at(s).unwrap());
        assert!(close(&g.series(&h).unwrap().at(s).unwrap(), &(&hs * &gs)), "series {seed}");
        let f = random(&mut rng, [k, m, p], 0.3);
        let fs = f.at(s).unwrap();
        assert!(close(&g.parallel(&f).unwrap().at(s).unwrap(), &(&gs + &fs)), "parallel {seed}");
        let back = random(&mut rng, [k, p, m], 0.3);
        let loop_ = CMat::identity(p, p) - &gs * back.at(s).unwrap();
        let closed = if p == 0 { gs.clone() } else { solve_complex(&loop_, &gs).unwrap() };
        let found = g.feedback(&back).unwrap().at(s).unwrap();
        // a loop that is nearly singular at s loses digits
        assert!((&found - &closed).norm_l2() <= 1e-9 * closed.norm_l2().max(1.0), "feedback {seed}");
        assert!(close(&g.transposed().at(s).unwrap(), &gs.transpose().to_owned()), "dual {seed}");
    }
}

#[test]
fn the_bilinear_map_keeps_the_hinf_norm_and_the_gramian() {
    for seed in 0..20 {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let shape = [rng.random_range(1..8), rng.random_range(1..4), rng.random_range(1..4)];
        let g = stable(&mut rng, shape, 0.5);
        for lambda in [0.01, 1.0, 100.0] {
            let d = g.bilinear(lambda, 0.2).unwrap();
            let (one, two) = (g.hinf_norm().unwrap(), d.hinf_norm().unwrap());
            // each is within 1e-7 below its supremum
            assert!((two.norm / one.norm - 1.0).abs() < 1e-7, "{seed} {lambda}: {one:?} {two:?}");
            // A P + P Aᵀ + B Bᵀ = 0 has the same P as A_d P A_dᵀ − P + B_d B_dᵀ = 0
            let p = washboard::linalg::lyapunov(g.a(), &(g.b() * g.b().transpose())).unwrap().x;
            let left = d.a() * &p * d.a().transpose() - &p + d.b() * d.b().transpose();
            assert!(left.norm_l2() < 1e-11 * p.norm_l2(), "{seed} {lambda}: {:e}", left.norm_l2());
        }
    }
}

#[test]
fn responses_add_up_and_a_step_is_the_integral_of_an_impulse() {
    for seed in 0..20 {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let (n, m, p) = (rng.random_range(0..6), rng.random_range(1..4), rng.random_range(1..4));
        let g = stable(&mut rng, [n, m, p], 0.0);
        let signal = |rng: &mut ChaCha8Rng| -> Vec<Vec<f64>> {
            (0..60).map(|_| (0..m).map(|_| rng.random_range(-1.0..1.0)).collect()).collect()
        };
        let (u, v) = (signal(&mut rng), signal(&mut rng));
        let both: Vec<Vec<f64>> = u
            .iter()
            .zip(&v)
            .map(|(u, v)| u.iter().zip(v).map(|(u, v)| 2.0 * u - 3.0 * v).collect())
            .collect();
        for hold in [Hold::Zero, Hold::First] {
            let of = |u: &[Vec<f64>]| g.respond(u, 0.05, hold).unwrap();
            let (yu, yv, y) = (of(&u), of(&v), of(&both));
            for i in 0..p {
                for k in 0..60 {
                    assert!((2.0 * yu[k][i] - 3.0 * yv[k][i] - y[k][i]).abs() < 1e-12, "{seed}");
                }
            }
        }
        // G/s from an impulse is G from a step
        let integrators =
            System::continuous(Mat::zeros(m, m), Mat::identity(m, m), Mat::identity(m, m), Mat::zeros(m, m));
        let integrated = integrators.unwrap().series(&g).unwrap();
        for j in 0..m {
            let (step, of_impulse) = (g.step(j, 0.05, 60).unwrap(), integrated.impulse(j, 0.05, 60).unwrap());
            for i in 0..p {
                for k in 0..60 {
                    assert!((step[k][i] - of_impulse[k][i]).abs() < 1e-12, "{seed}: {i} {k}");
                }
            }
        }
    }
}

/// A matrix of some kind: zeros, ones, huge, tiny, mixed, defective, integers, random.
fn of_kind(kind: usize, rng: &mut ChaCha8Rng, rows: usize, cols: usize) -> Mat {
    Mat::from_fn(rows, cols, |i, j| match kind {
        0 => 0.0,
        1 => 1.0,
        2 => 1e300 * rng.random_range(-1.0..1.0),
        3 => 1e-300 * rng.random_range(-1.0..1.0),
        4 => 10f64.powf(rng.random_range(-300.0..300.0)),
        5 => f64::from(u8::from(j == i + 1)) - f64::from(u8::from(i == j)),
        6 => f64::from(rng.random_range(-1..=1)),
        7 => 5e-324,
        8 => f64::MAX,
        _ => rng.random_range(-1.0..1.0),
    })
}

/// What every verb says of a system: values that are numbers, or errors. A panic is neither.
fn ask_everything(g: &System, what: &str, wrong: &mut Vec<String>) {
    let mut number = |found: Result<f64, washboard::lti::LtiError>, name: &str| {
        if found.is_ok_and(|v| !v.is_finite()) {
            wrong.push(format!("{name} of {what}"));
        }
    };
    number(g.hinf_norm().map(|h| h.norm), "H∞ norm");
    number(g.h2_norm(), "H2 norm");
    let _ = (g.poles(), g.zeros(), g.controllability(), g.observability());
    let _ = (g.split(), g.minimal(1e-9), g.balanced_scales(), g.inverse());
    let _ = (g.feedback(&g.transposed()), g.series(&g.transposed()), g.append(g), g.stack(g));
    let _ = (g.frequency_response(&[0.0, 1.0, 1e300]), g.dc_gain(), g.at(C64::new(0.0, 0.0)));
    let _ = (g.step(0, 0.1, 5), g.impulse(0, 0.1, 5), g.sampled(0.1));
    for order in 0..=g.order() {
        if let Ok(reduced) = g.balanced_truncation(order) {
            assert!(reduced.system.order() <= order.max(g.order()), "{what}");
        }
    }
    if let Ok(d) = g.bilinear(1.0, 0.1) {
        number(d.hinf_norm().map(|h| h.norm), "H∞ norm of the disk");
        number(d.h2_norm(), "H2 norm of the disk");
        let _ = (d.zeros(), d.inverse_bilinear(1.0));
    }
    let discrete =
        StateSpace::<Discrete>::discrete(g.a().clone(), g.b().clone(), g.c().clone(), g.d().clone(), 0.1);
    let discrete = discrete.unwrap();
    number(discrete.hinf_norm().map(|h| h.norm), "discrete H∞ norm");
    number(discrete.h2_norm(), "discrete H2 norm");
}

#[test]
fn no_matrix_panics() {
    let mut wrong = Vec::new();
    for seed in 0..600 {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let [n, m, p] = [rng.random_range(0..6), rng.random_range(0..4), rng.random_range(0..4)];
        let kinds = [0; 4].map(|_| rng.random_range(0..10));
        let a = of_kind(kinds[0], &mut rng, n, n);
        let b = of_kind(kinds[1], &mut rng, n, m);
        let c = of_kind(kinds[2], &mut rng, p, n);
        let d = of_kind(kinds[3], &mut rng, p, m);
        let g = System::continuous(a, b, c, d).unwrap();
        let what = format!("seed {seed}, shape {n} {m} {p}, kinds {kinds:?}");
        ask_everything(&g, &what, &mut wrong);
        // a margin, so that the norms exist
        ask_everything(&shifted(&g, 4.0), &format!("{what}, shifted"), &mut wrong);
    }
    assert!(wrong.is_empty(), "{} numbers are not finite: {wrong:#?}", wrong.len());
}
