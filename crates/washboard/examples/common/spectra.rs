//! Systems to sample.

#![allow(dead_code, clippy::unwrap_used)]

use rand::Rng;
use rand_chacha::ChaCha8Rng;
use washboard::linalg::{C64, CMat, Mat};
use washboard::lti::{Discrete, StateSpace};

/// Poles of moduli `radius` and spread angles, in real blocks, turned at random.
pub fn random_system(n: usize, m: usize, radius: [f64; 2], rng: &mut ChaCha8Rng) -> StateSpace<Discrete> {
    let mut a = Mat::zeros(n, n);
    let pairs = n / 2;
    for k in 0..pairs {
        let angle = std::f64::consts::PI * (k as f64 + rng.random_range(0.3..0.7)) / pairs as f64;
        let r = rng.random_range(radius[0]..radius[1]);
        let (i, z) = (2 * k, C64::from_polar(r, angle));
        (a[(i, i)], a[(i, i + 1)], a[(i + 1, i)], a[(i + 1, i + 1)]) = (z.re, z.im, -z.im, z.re);
    }
    if n % 2 == 1 {
        a[(n - 1, n - 1)] = rng.random_range(-radius[1]..radius[1]);
    }
    let mut any = |r: usize, c: usize| Mat::from_fn(r, c, |_, _| rng.random_range(-1.0..1.0));
    let (b, c) = (any(n, m), any(m, n));
    let d = Mat::identity(m, m) + any(m, m) * faer::Scale(0.3);
    StateSpace::discrete(a, b, c, d, 1.0).unwrap()
}

/// G Gᴴ at e^{iθ}.
pub fn spectrum(g: &StateSpace<Discrete>, theta: f64) -> CMat {
    let h = g.at(C64::from_polar(1.0, theta)).unwrap();
    &h * h.adjoint()
}

/// The system of examples 2.3.1 and 2.4.3.
pub fn example() -> StateSpace<Discrete> {
    let a = [
        [0.8876, 0.4494, 0.0, 0.0],
        [-0.4494, 0.7978, 0.0, 0.0],
        [0.0, 0.0, -0.6129, 0.0645],
        [0.0, 0.0, -6.4516, -0.7419],
    ];
    let (b, c) = ([0.2247, 0.8989, 0.0323, 0.1290], [0.4719, 0.1124, 9.6774, 1.6129]);
    StateSpace::discrete(
        Mat::from_fn(4, 4, |i, j| a[i][j]),
        Mat::from_fn(4, 1, |i, _| b[i]),
        Mat::from_fn(1, 4, |_, j| c[j]),
        Mat::from_fn(1, 1, |_, _| 0.9626),
        1.0,
    )
    .unwrap()
}

/// Its noise's shape.
pub fn example_noise() -> StateSpace<Discrete> {
    let a = [[0.6296, 0.0741], [-7.4074, 0.4815]];
    StateSpace::discrete(
        Mat::from_fn(2, 2, |i, j| a[i][j]),
        Mat::from_fn(2, 1, |i, _| [0.04, 0.9][i]),
        Mat::from_fn(1, 2, |_, j| [1.63, 0.074][j]),
        Mat::from_fn(1, 1, |_, _| 0.2),
        1.0,
    )
    .unwrap()
}
