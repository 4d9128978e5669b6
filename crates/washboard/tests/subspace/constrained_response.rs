//! Fits of noisy responses that have zeros, relative degree and static gain exactly, and tend to the truth.

use super::poles_and_residues::at;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use std::f64::consts::PI;
use washboard::linalg::{C64, CMat, Mat};
use washboard::subspace::{Domain, Interpolant, Measured, Node, SubspaceError, fit_response};

const HALF_PLANE: Domain = Domain::HalfPlane { lambda_rad_s: 10.0 };
/// For consistency: the weakest mode stands clear of it at 100 responses already.
const NOISE: f64 = 0.01;
/// A zero on the axis, as at an invariant frequency.
const OMEGA: f64 = 6.0;

/// 100·40 (s² + 36)/36 / ((s² + 2s + 100)(s² + 6s + 40)): static gain 1, relative degree 2, zeros at ±6i.
fn g(s: C64) -> C64 {
    (s * s + OMEGA * OMEGA) * (4000.0 / (OMEGA * OMEGA))
        / ((s * s + s * 2.0 + 100.0) * (s * s + s * 6.0 + 40.0))
}

fn one(x: C64) -> CMat {
    CMat::from_fn(1, 1, |_, _| x)
}

/// M responses at angles that fill the half circle, with noise of sd 0.05, twice that above 10 rad/s.
fn measured(count: usize, noise: f64, rng: &mut ChaCha8Rng) -> Vec<Measured> {
    (0..count)
        .map(|k| {
            let z = C64::new(0.0, 10.0 * (PI * (k as f64 + 0.5) / (2 * count) as f64).tan());
            let sd = noise * if z.im > 10.0 { 2.0 } else { 1.0 };
            let mut normal = || rng.sample::<f64, _>(StandardNormal) * sd / 2f64.sqrt();
            Measured {
                z,
                value: one(g(z) + C64::new(normal(), normal())),
                variance: if z.im > 10.0 { 4.0 } else { 1.0 },
            }
        })
        .collect()
}

fn constraints() -> Vec<Node> {
    vec![
        Node::relative_degree(2, (1, 1)),
        Node::static_gain(HALF_PLANE, one(C64::new(1.0, 0.0))),
        Node::zero(C64::new(0.0, OMEGA), 1, (1, 1)),
    ]
}

fn worst(found: &Interpolant) -> f64 {
    (0..400)
        .map(|k| C64::new(0.0, 10.0 * (PI * f64::from(k) / 800.0).tan()))
        .map(|s| (at(found.system.matrices(), s)[(0, 0)] - g(s)).norm())
        .fold(0.0, f64::max)
}

/// Without noise the function comes back; the constraints are met by D, C B and values of their own.
#[test]
fn constraints_hold_exactly() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let exact = fit_response(HALF_PLANE, &measured(40, 0.0, &mut rng), &constraints(), 4).unwrap();
    assert!(worst(&exact) < 1e-9 && exact.stable, "{:e}", worst(&exact));
    let data = measured(200, 0.05, &mut rng);
    let free = fit_response(HALF_PLANE, &data, &[], 4).unwrap();
    let found = fit_response(HALF_PLANE, &data, &constraints(), 4).unwrap();
    let defects = |f: &Interpolant| {
        let [a, b, c, d] = f.system.matrices();
        let size = (c.norm_l2() * b.norm_l2()).max(1.0);
        let value = |s: C64| at([a, b, c, d], s)[(0, 0)];
        [
            d.norm_l2(),
            (c * b).norm_l2() / size,
            (value(C64::new(0.0, 0.0)) - 1.0).norm(),
            value(C64::new(0.0, OMEGA)).norm(),
        ]
    };
    println!("free {:?}, constrained {:?}", defects(&free), defects(&found));
    assert!(defects(&free).iter().all(|d| *d > 1e-4), "{:?}", defects(&free));
    assert!(defects(&found).iter().all(|d| *d < 1e-9), "{:?}", defects(&found));
    assert!(found.max_error < 1e-9 && found.order == 4);
    // C A B is free: the relative degree is 2 and not 3
    let [a, b, c, _] = found.system.matrices();
    assert!((c * a * b).norm_l2() > 10.0, "{}", (c * a * b).norm_l2());
}

/// Least squares on the affine set: along every direction of B and D in it the weighted misfit, a parabola, is lowest where they are.
#[test]
fn the_constrained_fit_is_the_best_that_meets_its_constraints() {
    /// Rounding of the three misfits that a parabola's lowest point is had from, as a share of the step.
    const ROUNDING: f64 = 1e-9;
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    let data = measured(150, 0.05, &mut rng);
    let only = [Node::static_gain(HALF_PLANE, one(C64::new(1.0, 0.0)))];
    let found = fit_response(HALF_PLANE, &data, &only, 4).unwrap();
    let [a, b, c, d] = found.system.matrices();
    let misfit = |b: &Mat, d: &Mat| -> f64 {
        data.iter().map(|x| (at([a, b, c, d], x.z)[(0, 0)] - x.value[(0, 0)]).norm_sqr() / x.variance).sum()
    };
    let least = misfit(b, d);
    let gain_of_b = |k: usize| {
        let unit = Mat::from_fn(4, 1, |i, _| f64::from(u8::from(i == k)));
        at([a, &unit, c, &Mat::zeros(1, 1)], C64::new(0.0, 0.0))[(0, 0)].re
    };
    let step = b.norm_max();
    for k in 0..4 {
        let [more, less] = [step, -step].map(|step| {
            // D takes back what the entry of B adds to the gain
            let moved = Mat::from_fn(4, 1, |i, _| b[(i, 0)] + if i == k { step } else { 0.0 });
            misfit(&moved, &Mat::from_fn(1, 1, |_, _| d[(0, 0)] - step * gain_of_b(k)))
        });
        let lowest = 0.5 * (less - more) / (more + less - 2.0 * least);
        assert!(more > least && less > least && lowest.abs() < ROUNDING, "{k}: {lowest:e}");
    }
}

/// Strongly consistent: sixteen times the data, a quarter of the error, on every path of noise that is tried.
#[test]
fn the_error_goes_with_the_root_of_the_data() {
    let counts = [100, 400, 1600, 6400];
    let mut means = [0.0f64; 4];
    for seed in 0..6 {
        let mut rng = ChaCha8Rng::seed_from_u64(100 + seed);
        let errors = counts.map(|count| {
            let found =
                fit_response(HALF_PLANE, &measured(count, NOISE, &mut rng), &constraints(), 4).unwrap();
            assert!(found.stable && found.max_error < 1e-9, "{seed} {count}: {:e}", found.max_error);
            worst(&found)
        });
        println!("{seed}: {errors:?}");
        assert!(errors[3] < errors[0] / 2.0, "{seed}: {errors:?}");
        means.iter_mut().zip(errors).for_each(|(m, e)| *m += e / 6.0);
    }
    println!("sup error at {counts:?}: {means:.4?}");
    // 1/8 expected, twice that allowed for six paths
    assert!(means[3] < means[0] / 4.0, "{means:?}");
}

#[test]
fn what_cannot_be_fitted_is_said() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let data = measured(40, 0.05, &mut rng);
    // order 2 has 3 unknowns: these are 5 real constraints
    let refused = fit_response(HALF_PLANE, &data, &constraints(), 2).unwrap_err();
    assert!(matches!(refused, SubspaceError::Constraints { count: 5, .. }), "{refused}");
    let refused = fit_response(HALF_PLANE, &data[..4], &[], 6).unwrap_err();
    assert!(matches!(refused, SubspaceError::TooLittleData { missing, .. } if missing >= 1), "{refused}");
    let mut wrong = data.clone();
    wrong[7].variance = 0.0;
    let refused = fit_response(HALF_PLANE, &wrong, &[], 4).unwrap_err();
    assert!(matches!(refused, SubspaceError::Sample { what: "variance", index: 7, .. }), "{refused}");
    let mut wrong = data.clone();
    wrong[3].z.re = -0.5;
    let refused = fit_response(HALF_PLANE, &wrong, &[], 4).unwrap_err();
    assert!(
        matches!(&refused, SubspaceError::Sample { what: "measured value", index: 3, why } if why.contains("inside the left half plane") || why.contains("inside the unit disk")),
        "{refused}"
    );
    let mut wrong = data;
    wrong[5].value = CMat::zeros(2, 1);
    let refused = fit_response(HALF_PLANE, &wrong, &[], 4).unwrap_err();
    assert!(
        matches!(refused, SubspaceError::NodeShape { index: 5, expected: (1, 1), found: (2, 1), .. }),
        "{refused}"
    );
    assert!(fit_response(HALF_PLANE, &[], &[], 4).is_err());
}
