//! Riccati equations: the benchmark collections CAREX and DAREX where they are present, and seeded properties.

#![allow(clippy::unwrap_used, clippy::print_stdout, clippy::print_stderr)]

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::Value;
use std::path::Path;
use washboard::linalg::{C64, Mat, RiccatiError, RiccatiSolution, care, care_g, dare, eigen};

/// What the collections' problems must leave.
const RESIDUAL: f64 = 1e-10;
/// A reference X must satisfy its equation to this.
const KNOWN: f64 = 1e-9;
/// Forward errors may exceed the condition number times ε by this: X of the collection is itself rounded data, and
/// norms of order n enter the rounding of products.
const FORWARD: f64 = 100.0;
/// Eigenvalues, duality and scalings: agreement over the condition number times ε.
const AGREEMENT: f64 = 1e3;

fn problems(file: &str) -> Vec<Value> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/riccati").join(file);
    if !path.exists() {
        eprintln!("skipped: {} is not here", path.display());
        return Vec::new();
    }
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn matrix(problem: &Value, name: &str) -> Option<Mat> {
    let rows = problem.get(name)?.as_array()?;
    let at = |i: usize, j: usize| rows[i].as_array().unwrap()[j].as_f64().unwrap();
    Some(Mat::from_fn(rows.len(), rows[0].as_array().unwrap().len(), at))
}

fn worst_margin(solution: &RiccatiSolution, size: impl Fn(&C64) -> f64) -> f64 {
    solution.closed_loop_eigenvalues.iter().map(size).fold(f64::NEG_INFINITY, f64::max)
}

/// One line of the table; asserts what a solution must satisfy.
///
/// A collection's X that leaves `left` of its own equation is no reference: DAREX 1.4 prints an A and an X that do not
/// belong together.
fn judge(
    id: &str,
    n: usize,
    solution: &RiccatiSolution,
    known: Option<Mat>,
    left: impl Fn(&Mat) -> f64,
    margin: f64,
) {
    let x = &solution.x;
    let known = known.filter(|k| {
        let sound = left(k) <= KNOWN;
        if !sound {
            println!("{id:>10} the collection's X leaves {:.1e} of its equation", left(k));
        }
        sound
    });
    let error = known.map(|k| (x - &k).norm_l2() / k.norm_l2());
    let shown = error.map_or("-".to_owned(), |e| format!("{e:.1e}"));
    println!(
        "{id:>10} {n:>4} residual {:.1e} condition {:.1e} bound {:.1e} error {shown} margin {margin:.1e} factorisations {}",
        solution.scaled_residual, solution.condition, solution.forward_error_bound, solution.factorisations
    );
    assert!(solution.scaled_residual <= RESIDUAL, "{id}");
    assert!(margin < 0.0, "{id}");
    assert_eq!((x - x.transpose()).norm_max(), 0.0, "{id}");
    if let Some(error) = error {
        // the condition number is that of structured perturbations; what rounding adds is in the bound
        let allowed = FORWARD * solution.condition * f64::EPSILON + solution.forward_error_bound;
        assert!(error <= allowed, "{id}: {error:e}");
    }
}

#[test]
fn carex() {
    for p in problems("carex.json") {
        let id = p["id"].as_str().unwrap();
        let [a, g, q] = ["A", "G", "Q"].map(|name| matrix(&p, name).unwrap());
        match care_g(&a, &g, &q) {
            Ok(solution) => {
                // the residual by this test
                let left = |x: &Mat| {
                    let rest = a.transpose() * x + x * &a - x * &g * x + &q;
                    let size = x.norm_l2();
                    let terms = 2.0 * a.norm_l2() * size + size * size * g.norm_l2() + q.norm_l2();
                    rest.norm_l2() / terms
                };
                assert!(left(&solution.x) <= RESIDUAL, "{id}");
                judge(id, a.nrows(), &solution, matrix(&p, "X"), left, worst_margin(&solution, |z| z.re));
            }
            // 2.2: G of the collection is indefinite, 2.5: A − GX has ±i; no solution stabilises either
            Err(RiccatiError::OnTheBoundary { frequency, .. }) => {
                let known: f64 = match id {
                    "carex-2.2" => 2828.4254,
                    "carex-2.5" => 1.0,
                    other => panic!("{other} is refused"),
                };
                assert!((frequency / known - 1.0).abs() < 1e-6, "{id}: {frequency}");
            }
            Err(e) => panic!("{id}: {e}"),
        }
    }
}

#[test]
fn darex() {
    for p in problems("darex.json") {
        let id = p["id"].as_str().unwrap();
        let [a, b, q, r, s] = ["A", "B", "Q", "R", "S"].map(|name| matrix(&p, name).unwrap());
        match dare(&a, &b, &q, &r, Some(&s)) {
            Ok(solution) => {
                let margin = worst_margin(&solution, |z| z.norm() - 1.0);
                let left = |x: &Mat| {
                    let cross = a.transpose() * x * &b + &s;
                    let f = washboard::linalg::solve(
                        &(&r + b.transpose() * x * &b),
                        &cross.transpose().to_owned(),
                    );
                    let rest = a.transpose() * x * &a - x - &cross * f.unwrap() + &q;
                    rest.norm_l2() / ((1.0 + a.norm_l2() * a.norm_l2()) * x.norm_l2() + q.norm_l2())
                };
                assert!(left(&solution.x) <= RESIDUAL, "{id}");
                judge(id, a.nrows(), &solution, matrix(&p, "X"), left, margin);
            }
            Err(e) => panic!("{id}: {e}"),
        }
    }
}

fn random(rows: usize, cols: usize, rng: &mut ChaCha8Rng) -> Mat {
    Mat::from_fn(rows, cols, |_, _| rng.random_range(-1.0..1.0))
}

/// Random plants of four kinds: stable, unstable, stiff (rates from 1e-1 to 1e4) and far from normal.
fn plants() -> Vec<(String, Mat)> {
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let mut list = Vec::new();
    for n in [1, 2, 3, 5, 8, 13, 20] {
        let base = random(n, n, &mut rng) * faer::Scale(1.0 / (n as f64).sqrt());
        let one = Mat::identity(n, n);
        list.push((format!("stable {n}"), &base - &one));
        list.push((format!("unstable {n}"), &base + &one * faer::Scale(0.3)));
        let turn = random(n, n, &mut rng).qr().compute_Q();
        let rate = |i: usize| -(10f64.powf(-1.0 + 5.0 * i as f64 / (n.max(2) - 1) as f64));
        let stiff = Mat::from_fn(n, n, |i, j| if i == j { rate(i) } else { 0.0 });
        list.push((format!("stiff {n}"), &turn * stiff * turn.transpose()));
        let shear = Mat::from_fn(n, n, |i, j| {
            if i == j {
                -1.0
            } else if i < j {
                3.0
            } else {
                0.0
            }
        });
        list.push((format!("non-normal {n}"), &turn * shear * turn.transpose()));
    }
    list
}

/// B, Q = CᵀC + small, R > 0 and a cross term that keeps the cost convex.
fn weights(n: usize, m: usize, seed: u64) -> [Mat; 4] {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let b = random(n, m, &mut rng);
    let root = random(n + m, n + m, &mut rng);
    let cost = &root * root.transpose();
    let even = |m: Mat| (&m + m.transpose()) * faer::Scale(0.5);
    let q = even(cost.submatrix(0, 0, n, n).to_owned());
    let r = even(cost.submatrix(n, n, m, m) + Mat::identity(m, m) * faer::Scale(0.1));
    [b, q, r, cost.submatrix(0, n, n, m).to_owned()]
}

fn inverse(a: &Mat) -> Mat {
    washboard::linalg::solve(a, &Mat::identity(a.nrows(), a.nrows())).unwrap()
}

fn distance(one: &[C64], other: &[C64]) -> f64 {
    let mut left = other.to_vec();
    let mut worst: f64 = 0.0;
    for a in one {
        let nearest = |x: &(usize, f64), y: &(usize, f64)| x.1.total_cmp(&y.1);
        let (k, d) = left.iter().map(|b| (a - b).norm()).enumerate().min_by(nearest).unwrap();
        worst = worst.max(d);
        left.swap_remove(k);
    }
    worst
}

#[test]
fn continuous_equations_are_satisfied_with_their_cross_term() {
    for (k, (name, a)) in plants().into_iter().enumerate() {
        let n = a.nrows();
        let [b, q, r, s] = weights(n, n.div_ceil(2), k as u64);
        let solution = care(&a, &b, &q, &r, Some(&s)).unwrap_or_else(|e| panic!("{name}: {e}"));
        let (x, f) = (&solution.x, &solution.gain);
        let cross = x * &b + &s;
        let rest = a.transpose() * x + x * &a - &cross * inverse(&r) * cross.transpose() + &q;
        let terms = 2.0 * a.norm_l2() * x.norm_l2() + cross.norm_l2() * f.norm_l2() + q.norm_l2();
        assert!(rest.norm_l2() <= 1e-12 * n as f64 * terms, "{name}: {:e}", rest.norm_l2() / terms);
        assert!((f + inverse(&r) * cross.transpose()).norm_l2() <= 1e-10 * f.norm_l2(), "{name}");
        // another algorithm's eigenvalues of A + B F
        let closed = eigen(&(&a + &b * f)).unwrap().0;
        assert!(closed.iter().all(|z| z.re < 0.0), "{name}");
        let far = distance(&closed, &solution.closed_loop_eigenvalues);
        let tolerance = if name.starts_with("non-normal") { 1e-4 } else { 1e-9 };
        assert!(far <= tolerance * a.norm_l2().max(1.0), "{name}: {far:e}");
        assert!(solution.condition >= 0.5 && solution.condition.is_finite(), "{name}");
    }
}

#[test]
fn discrete_equations_are_satisfied_with_their_cross_term() {
    for (k, (name, a)) in plants().into_iter().enumerate() {
        let n = a.nrows();
        let a = a * faer::Scale(if name.starts_with("stiff") { 1e-4 } else { 0.8 });
        let [b, q, r, s] = weights(n, n.div_ceil(2), k as u64);
        let singular = Mat::zeros(r.nrows(), r.nrows());
        let none = Mat::zeros(n, r.nrows());
        for (r, s) in [(&r, &s), (&singular, &none)] {
            let solution = dare(&a, &b, &q, r, Some(s));
            let solution = solution.unwrap_or_else(|e| panic!("{name}: {e}"));
            let (x, f) = (&solution.x, &solution.gain);
            let cross = a.transpose() * x * &b + s;
            let rest = a.transpose() * x * &a - x + &cross * f + &q;
            let size = a.norm_l2();
            let terms = (size * size + 1.0) * x.norm_l2() + cross.norm_l2() * f.norm_l2() + q.norm_l2();
            assert!(rest.norm_l2() <= 1e-12 * n as f64 * terms, "{name}: {:e}", rest.norm_l2() / terms);
            let weight = r + b.transpose() * x * &b;
            assert!((&weight * f + cross.transpose()).norm_l2() <= 1e-10 * cross.norm_l2(), "{name}");
            let closed = eigen(&(&a + &b * f)).unwrap().0;
            assert!(closed.iter().all(|z| z.norm() < 1.0), "{name}");
        }
    }
}

/// X must not depend on coordinates or units beyond what its condition number allows.
#[test]
fn coordinates_and_units_do_not_matter() {
    let mut rng = ChaCha8Rng::seed_from_u64(9);
    for (k, (name, a)) in plants().into_iter().enumerate() {
        let n = a.nrows();
        let [b, q, r, _] = weights(n, n.div_ceil(2), k as u64);
        let x = care(&a, &b, &q, &r, None).unwrap();
        let d = dare(&(&a * faer::Scale(0.3 / a.norm_l2())), &b, &q, &r, None).unwrap();
        let turn = random(n, n, &mut rng).qr().compute_Q();
        let units = Mat::from_fn(n, n, |i, j| if i == j { [1.0, 1e6, 1e-6][i % 3] } else { 0.0 });
        for (what, t) in [("turned", turn), ("units", units)] {
            // x = T z: A → T⁻¹AT, B → T⁻¹B, Q → TᵀQT, X → TᵀXT
            let back = inverse(&t);
            let even = |m: Mat| (&m + m.transpose()) * faer::Scale(0.5);
            let (ta, tb, tq) = (&back * &a * &t, &back * &b, even(t.transpose() * &q * &t));
            let y = care(&ta, &tb, &tq, &r, None).unwrap_or_else(|e| panic!("{name} {what}: {e}"));
            let undone = back.transpose() * &y.x * &back;
            let error = (&undone - &x.x).norm_l2() / x.x.norm_l2();
            assert!(error <= AGREEMENT * f64::EPSILON * x.condition, "{name} {what}: {error:e}");
            let ta = &ta * faer::Scale(0.3 / a.norm_l2());
            let y = dare(&ta, &tb, &tq, &r, None).unwrap_or_else(|e| panic!("{name} {what}: {e}"));
            let error = (back.transpose() * &y.x * &back - &d.x).norm_l2() / d.x.norm_l2();
            assert!(error <= AGREEMENT * f64::EPSILON * d.condition, "discrete {name} {what}: {error:e}");
        }
        // the unit of the cost: X goes with it, F stays
        let (cq, cr) = (&q * faer::Scale(1e9), &r * faer::Scale(1e9));
        let y = care(&a, &b, &cq, &cr, None).unwrap();
        let error = (&y.x * faer::Scale(1e-9) - &x.x).norm_l2() / x.x.norm_l2();
        assert!(error <= AGREEMENT * f64::EPSILON * x.condition, "{name}: {error:e}");
    }
}

/// X of the filter's equation is the inverse of the regulator's anti-stabilising solution, and the forward error that
/// the data's perturbation makes is within the condition number.
#[test]
fn the_condition_number_covers_perturbed_data() {
    let mut rng = ChaCha8Rng::seed_from_u64(21);
    for (k, (name, a)) in plants().into_iter().enumerate() {
        let n = a.nrows();
        let [b, q, _, _] = weights(n, n.div_ceil(2), k as u64);
        let even = |m: Mat| (&m + m.transpose()) * faer::Scale(0.5);
        let g = even(&b * b.transpose());
        let x = care_g(&a, &g, &q).unwrap();
        for _ in 0..3 {
            let tiny = 1e-9f64.min(1e-4 / x.condition);
            let nudge = |m: &Mat, e: Mat| m + &e * faer::Scale(tiny * m.norm_l2() / e.norm_l2());
            let (pa, pg) = (nudge(&a, random(n, n, &mut rng)), nudge(&g, even(random(n, n, &mut rng))));
            let pq = nudge(&q, even(random(n, n, &mut rng)));
            let y = care_g(&pa, &pg, &pq).unwrap();
            let moved = (&y.x - &x.x).norm_l2() / x.x.norm_l2();
            let own = x.forward_error_bound + y.forward_error_bound;
            assert!(moved <= 1.5 * (n as f64).sqrt() * tiny * x.condition + own, "{name}: {moved:e}");
        }
    }
}

/// −X of the reversed time and the dual: the stabilising Y of (Aᵀ, Q, G) and X satisfy that Y⁻¹ is the negative of
/// the other solution, so the closed-loop spectra of both are the Hamiltonian's stable half.
#[test]
fn regulator_and_filter_share_the_hamiltonian() {
    for (k, (name, a)) in plants().into_iter().enumerate() {
        if name.starts_with("non-normal") {
            continue; // eigenvalues too sensitive to compare
        }
        let n = a.nrows();
        let [b, q, _, _] = weights(n, n.div_ceil(2), k as u64);
        let g = &b * b.transpose();
        let (x, y) = (care_g(&a, &g, &q).unwrap(), care_g(&a.transpose().to_owned(), &q, &g).unwrap());
        let far = distance(&x.closed_loop_eigenvalues, &y.closed_loop_eigenvalues);
        assert!(far <= 1e-8 * (a.norm_l2() + g.norm_l2()), "{name}: {far:e}");
    }
}

/// H∞: G = B₂B₂ᵀ − γ⁻²B₁B₁ᵀ. ẋ = a x + b₁w + b₂u: X = (a + √(a² + g q))/g while a² + g q > 0.
#[test]
fn an_indefinite_g_ends_where_gamma_ends() {
    let one = |v: f64| Mat::from_fn(1, 1, |_, _| v);
    let (a, q) = (-1.0, 4.0);
    for g in [0.5, -0.1, -0.2, -0.249] {
        let x = care_g(&one(a), &one(g), &one(q)).unwrap_or_else(|e| panic!("{g}: {e}")).x[(0, 0)];
        let root = (a * a + g * q).sqrt();
        assert!((x - q / (root - a)).abs() < 1e-10 * x, "{g}: {x}");
    }
    for g in [-0.25, -0.26, -1.0] {
        let refused = care_g(&one(a), &one(g), &one(q));
        let omega = (-(a * a + g * q)).sqrt();
        match refused {
            Err(RiccatiError::OnTheBoundary { frequency, distance }) => {
                assert!((frequency - omega).abs() < 1e-7 && distance < 1e-7, "{g}: {frequency}");
            }
            other => panic!("{g}: {other:?}"),
        }
    }
}

#[test]
fn what_has_no_solution_says_why() {
    let two = |v: [[f64; 2]; 2]| Mat::from_fn(2, 2, |i, j| v[i][j]);
    let (one, i2) = (Mat::identity(1, 1), Mat::identity(2, 2));
    let b = Mat::from_fn(2, 1, |i, _| if i == 0 { 1.0 } else { 0.0 });
    // the second state is unstable and out of reach
    let a = two([[-1.0, 0.0], [0.0, 2.0]]);
    let refused = care(&a, &b, &i2, &one, None);
    assert!(
        matches!(&refused, Err(RiccatiError::NotStabilisable { eigenvalue, distance })
            if (eigenvalue.re - 2.0).abs() < 1e-12 && *distance < 1e-14),
        "{refused:?}"
    );
    let refused = dare(&a, &b, &i2, &one, None);
    assert!(matches!(refused, Err(RiccatiError::NotStabilisable { .. })), "{refused:?}");
    // an undamped mode at 3 rad/s that the cost does not see
    let swing = two([[0.0, 1.0], [-9.0, 0.0]]);
    let b2 = Mat::from_fn(2, 1, |i, _| i as f64);
    match care(&swing, &b2, &Mat::zeros(2, 2), &one, None) {
        Err(RiccatiError::OnTheBoundary { frequency, .. }) => assert!((frequency - 3.0).abs() < 1e-9),
        other => panic!("{other:?}"),
    }
    let turn = two([[0.6, 0.8], [-0.8, 0.6]]);
    match dare(&turn, &b2, &Mat::zeros(2, 2), &one, None) {
        Err(RiccatiError::OnTheBoundary { frequency, .. }) => {
            assert!((frequency - 0.8f64.atan2(0.6)).abs() < 1e-9);
        }
        other => panic!("{other:?}"),
    }
    let skew = two([[1.0, 0.5], [0.0, 1.0]]);
    assert!(matches!(
        care(&a, &i2, &skew, &i2, None),
        Err(RiccatiError::Asymmetric { name: "Q", row: 0, col: 1, difference }) if difference == 0.5
    ));
    assert!(matches!(care(&a, &i2, &i2, &skew, None), Err(RiccatiError::Asymmetric { name: "R", .. })));
    assert!(matches!(care_g(&a, &skew, &i2), Err(RiccatiError::Asymmetric { name: "G", .. })));
    let saddle = two([[1.0, 0.0], [0.0, -2.0]]);
    assert!(matches!(
        care(&a, &i2, &i2, &saddle, None),
        Err(RiccatiError::IndefiniteR { eigenvalue }) if (eigenvalue + 2.0).abs() < 1e-14
    ));
    assert!(matches!(dare(&a, &i2, &i2, &saddle, None), Err(RiccatiError::IndefiniteR { .. })));
    let flat = two([[1.0, 0.0], [0.0, 0.0]]);
    assert!(matches!(care(&a, &i2, &i2, &flat, None), Err(RiccatiError::SingularR { .. })));
    assert!(matches!(care(&a, &b, &one, &one, None), Err(RiccatiError::Linalg(_))));
    assert!(matches!(care(&a, &b, &i2, &i2, None), Err(RiccatiError::Linalg(_))));
    let mut broken = i2.clone();
    broken[(0, 1)] = f64::INFINITY;
    assert!(matches!(care(&broken, &b, &i2, &one, None), Err(RiccatiError::Linalg(_))));
    // an input that moves nothing and costs nothing
    let refused = dare(&two([[0.5, 0.0], [0.0, 0.5]]), &Mat::zeros(2, 1), &i2, &Mat::zeros(1, 1), None);
    assert!(matches!(refused, Err(RiccatiError::SingularInput { .. })), "{refused:?}");
}

/// The observable, stabilising solution although doubling's limit from Q = 0 would be X = 0.
#[test]
fn a_free_unstable_mode_is_mirrored() {
    let one = |v: f64| Mat::from_fn(1, 1, |_, _| v);
    // −X² + 2·3X = 0: X = 6 stabilises (−3), X = 0 does not
    let solution = care(&one(3.0), &one(1.0), &one(0.0), &one(1.0), None).unwrap();
    assert!((solution.x[(0, 0)] - 6.0).abs() < 1e-13, "{:?}", solution.x);
    // (a²−1)X = a²X²/(1+X): X = a² − 1 = 3, closed loop 1/a
    let solution = dare(&one(2.0), &one(1.0), &one(0.0), &one(1.0), None).unwrap();
    assert!((solution.x[(0, 0)] - 3.0).abs() < 1e-13, "{:?}", solution.x);
    assert!((solution.closed_loop_eigenvalues[0].re - 0.5).abs() < 1e-13);
}

#[test]
fn nothing_panics_and_nothing_is_unproven() {
    let mut rng = ChaCha8Rng::seed_from_u64(13);
    let sizes = [0.0, 1.0, 1e-300, 1e300, 1e-160, 1e160, 1e-8, 1e8];
    let mut solved = 0;
    for trial in 0..1500 {
        let (n, m) = (rng.random_range(0..6), rng.random_range(0..4));
        let mut pick = |rows: usize, cols: usize| {
            let size = sizes[rng.random_range(0..sizes.len())];
            let integers = rng.random_bool(0.5);
            Mat::from_fn(rows, cols, |_, _| {
                let v: f64 =
                    if integers { f64::from(rng.random_range(-1..=1)) } else { rng.random_range(-1.0..1.0) };
                v * size
            })
        };
        let (a, b, s, q, r) = (pick(n, n), pick(n, m), pick(n, m), pick(n, n), pick(m, m));
        let even = |m: &Mat| (m + m.transpose()) * faer::Scale(0.5);
        let (q, r) = (even(&q), r.transpose() * &r);
        let (g, s) = (even(&pick(n, n)), if trial % 2 == 0 { None } else { Some(&s) });
        for found in [care(&a, &b, &q, &r, s), dare(&a, &b, &q, &r, s), care_g(&a, &g, &q)] {
            let Ok(solution) = found else { continue };
            solved += 1;
            assert!(solution.scaled_residual <= 1e-8 && solution.x.norm_max().is_finite());
            assert!(!solution.condition.is_nan() && !solution.forward_error_bound.is_nan());
            assert_eq!(solution.closed_loop_eigenvalues.len(), n);
        }
    }
    assert!(solved > 200, "{solved}");
}
