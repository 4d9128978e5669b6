//! The Riccati equation from factors: against the squared one, near the axis, and where there is no solution.

#![allow(clippy::unwrap_used)]

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use washboard::linalg::{Mat, RiccatiError, care, care_of_output};

fn random(rows: usize, cols: usize, rng: &mut ChaCha8Rng) -> Mat {
    Mat::from_fn(rows, cols, |_, _| rng.random_range(-1.0..1.0))
}

fn one(v: f64) -> Mat {
    Mat::from_fn(1, 1, |_, _| v)
}

/// Q = CᵀC, R = DᵀD, S = CᵀD by the other route.
#[test]
fn factors_and_their_squares_have_one_solution() {
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    for trial in 0..200 {
        let n = rng.random_range(1..9);
        let m = rng.random_range(1..4);
        let p = m + rng.random_range(1..4);
        let (a, b) = (random(n, n, &mut rng), random(n, m, &mut rng));
        let (c, d) = (random(p, n, &mut rng), random(p, m, &mut rng));
        let even = |m: Mat| (&m + m.transpose()) * faer::Scale(0.5);
        let (q, r, s) = (even(c.transpose() * &c), even(d.transpose() * &d), c.transpose() * &d);
        let x = care_of_output(&a, &b, &c, &d).unwrap_or_else(|e| panic!("{trial}: {e}"));
        let y = care(&a, &b, &q, &r, Some(&s)).unwrap_or_else(|e| panic!("{trial}: {e}"));
        // the squares lose what the condition of R and of the equation allow
        let rank = r.singular_values().unwrap();
        let allowed = 1e3 * f64::EPSILON * (x.condition + 1.0) * rank[0] / rank[m - 1];
        let off = (&x.x - &y.x).norm_l2() / x.x.norm_l2();
        assert!(off <= allowed, "{trial}: X {off:e}, allowed {allowed:e}");
        let off = (&x.gain - &y.gain).norm_l2() / x.gain.norm_l2();
        assert!(off <= 10.0 * allowed, "{trial}: F {off:e}, allowed {allowed:e}");
    }
}

/// ẋ = x + u with |x + u|² + |δu|²: the closed loop's pole is −δ/√(1+δ²) and X = δ²(1 + …).
#[test]
fn a_closed_loop_almost_on_the_axis_is_found() {
    for delta in [1e-3, 1e-6, 1e-9] {
        let c = Mat::from_fn(2, 1, |i, _| [1.0, 0.0][i]);
        let d = Mat::from_fn(2, 1, |i, _| [1.0, delta][i]);
        let x = care_of_output(&one(1.0), &one(1.0), &c, &d).unwrap();
        // Ã = δ²/(1+δ²), G = 1/(1+δ²), Q = δ²/(1+δ²)
        let (r, q) = (1.0 + delta * delta, delta * delta / (1.0 + delta * delta));
        let pole = -(q * q + q / r).sqrt();
        let known = (q - pole) * r;
        // ε of A and B, over the pole
        let allowed = 8.0 * f64::EPSILON / delta;
        assert!((x.closed_loop_eigenvalues[0].re / pole - 1.0).abs() < allowed, "{delta}");
        assert!((x.x[(0, 0)] / known - 1.0).abs() < allowed, "{delta}: {:?} {known}", x.x);
        assert!((x.gain[(0, 0)] - (pole - 1.0)).abs() < 8.0 * f64::EPSILON, "{delta}: {:?}", x.gain);
    }
    // squared, 1 + δ² = 1 and nothing is left of the cost
    let refused = care(&one(1.0), &one(1.0), &one(1.0), &one(1.0 + 1e-18), Some(&one(1.0)));
    assert!(matches!(refused, Err(RiccatiError::OnTheBoundary { .. })), "{refused:?}");
}

#[test]
fn what_has_no_solution_says_why() {
    let two = |v: [[f64; 2]; 2]| Mat::from_fn(2, 2, |i, j| v[i][j]);
    let b = Mat::from_fn(2, 1, |i, _| i as f64);
    // an undamped mode at 3 rad/s that nothing sees
    let swing = two([[0.0, 1.0], [-9.0, 0.0]]);
    let d = Mat::from_fn(2, 1, |i, _| i as f64);
    match care_of_output(&swing, &b, &Mat::zeros(2, 2), &d) {
        Err(RiccatiError::OnTheBoundary { frequency, distance }) => {
            assert!((frequency - 3.0).abs() < 1e-9 && distance < 1e-14);
        }
        other => panic!("{other:?}"),
    }
    // a double integrator of which the cost sees the rate alone: x₁ is left where it is
    let chain = two([[0.0, 1.0], [0.0, 0.0]]);
    let rate = two([[0.0, 1.0], [0.0, 0.0]]);
    match care_of_output(&chain, &b, &rate, &d) {
        Err(RiccatiError::OnTheBoundary { frequency, .. }) => assert_eq!(frequency, 0.0),
        other => panic!("{other:?}"),
    }
    // the same chain with the position seen
    assert!(care_of_output(&chain, &b, &two([[1.0, 0.0], [0.0, 0.0]]), &d).is_ok());
    let apart = two([[-1.0, 0.0], [0.0, 2.0]]);
    let first = Mat::from_fn(2, 1, |i, _| 1.0 - i as f64);
    let refused = care_of_output(&apart, &first, &Mat::identity(2, 2), &d);
    assert!(matches!(refused, Err(RiccatiError::NotStabilisable { .. })), "{refused:?}");
    // D without full column rank: a zero column, two alike in other units, more inputs than outputs
    let wide = Mat::from_fn(2, 2, |_, j| [1.0, 1e-9][j]);
    let zero = Mat::from_fn(2, 2, |i, j| f64::from(u8::from(i == 0 && j == 0)));
    let i2 = Mat::identity(2, 2);
    for d in [&wide, &zero] {
        let refused = care_of_output(&apart, &i2, &i2, d);
        assert!(matches!(refused, Err(RiccatiError::SingularR { .. })), "{refused:?}");
    }
    // a column that is small in its unit is not singular
    let small = two([[1.0, 0.0], [0.0, 1e-12]]);
    let c = Mat::from_fn(4, 2, |i, j| f64::from(u8::from(i == j + 2)));
    let d = Mat::from_fn(4, 2, |i, j| if i < 2 { small[(i, j)] } else { 0.0 });
    assert!(care_of_output(&apart, &i2, &c, &d).is_ok());
    assert!(matches!(care_of_output(&apart, &b, &i2, &i2), Err(RiccatiError::Linalg(_))));
    let none = care_of_output(&apart, &i2, &Mat::zeros(1, 2), &Mat::zeros(1, 2));
    assert!(matches!(none, Err(RiccatiError::SingularR { ratio: 0.0 })), "{none:?}");
}
