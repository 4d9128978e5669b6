//! Matrices that every factorisation of this module is tested on.

use super::Mat;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Entries uniform on (−1, 1), seeded.
pub(super) fn random(rows: usize, cols: usize, seed: u64) -> Mat {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    Mat::from_fn(rows, cols, |_, _| rng.random_range(-1.0..1.0))
}

/// A matrix with eigenvalues well inside the left half plane, of 2-norm about one.
pub(super) fn stable(n: usize, seed: u64) -> Mat {
    let a = random(n, n, seed) * faer::Scale(1.0 / (n as f64).sqrt());
    a - Mat::identity(n, n) * faer::Scale(1.5)
}

/// Named matrices: random, companion, defective, stiff, triangular, zero, 1 × 1 and empty.
pub(super) fn all() -> Vec<(String, Mat)> {
    let mut list: Vec<(String, Mat)> =
        [2, 3, 4, 7, 12, 25, 60].map(|n| (format!("random {n}"), random(n, n, n as u64))).into();
    for n in [3, 6, 10] {
        // λⁿ + 2λ^{n−1} + … : coefficients that alternate in size
        let companion = |i: usize, j: usize| {
            if i == 0 {
                -(1.0 + ((j * 5) % 7) as f64)
            } else if i == j + 1 {
                1.0
            } else {
                0.0
            }
        };
        list.push((format!("companion {n}"), Mat::from_fn(n, n, companion)));
    }
    for n in [2, 5, 9] {
        let jordan = Mat::from_fn(n, n, |i, j| {
            if i == j {
                -1.0
            } else if j == i + 1 {
                1.0
            } else {
                0.0
            }
        });
        let turn = random(n, n, 77).qr().compute_Q();
        list.push((format!("jordan {n}"), jordan.clone()));
        list.push((format!("jordan turned {n}"), &turn * jordan * turn.transpose()));
    }
    for n in [6, 20] {
        // rates from 1e-1 to 1e4 in a random orthogonal basis, as oscillators and real poles by turns
        let mut d = Mat::zeros(n, n);
        for k in (0..n).step_by(2) {
            let rate = 10f64.powf(-1.0 + 5.0 * k as f64 / (n - 2) as f64);
            let swing = if k % 4 == 0 { 2.0 * rate } else { 0.0 };
            (d[(k, k)], d[(k + 1, k + 1)]) = (-rate, if k % 4 == 0 { -rate } else { 0.7 * rate });
            (d[(k, k + 1)], d[(k + 1, k)]) = (swing, -swing);
        }
        let turn = random(n, n, 5).qr().compute_Q();
        list.push((format!("stiff {n}"), &turn * d * turn.transpose()));
    }
    let upper = random(8, 8, 3);
    list.push((
        "triangular".into(),
        Mat::from_fn(8, 8, |i, j| if i <= j { upper[(i, j)] + i as f64 } else { 0.0 }),
    ));
    list.push(("symmetric".into(), &upper + upper.transpose()));
    list.push(("skew".into(), &upper - upper.transpose()));
    list.push(("permutation".into(), Mat::from_fn(7, 7, |i, j| f64::from((j + 1) % 7 == i))));
    list.push(("zero".into(), Mat::zeros(5, 5)));
    list.push(("one by one".into(), Mat::from_fn(1, 1, |_, _| -3.0)));
    list.push(("empty".into(), Mat::zeros(0, 0)));
    list
}
