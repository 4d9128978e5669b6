//! Time of `care` and what it leaves, on random plants: `cargo run --release --example bench_riccati [plants.csv]`.
//!
//! With a file name the plants are written there, for `benches/peers/slycot_riccati.py` to time slycot on.

#![allow(clippy::print_stdout, clippy::unwrap_used)]

use std::fmt::Write;
use std::time::Instant;
use washboard::linalg::{Mat, care};

const ORDERS: [usize; 4] = [8, 14, 36, 100];
const INPUTS: usize = 2;

/// A plant of n states with some unstable modes: a linear congruential generator, so that it is the same everywhere.
fn plant(n: usize) -> [Mat; 4] {
    let mut state = n as u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    let spread = 1.7 / (n as f64).sqrt();
    let a = Mat::from_fn(n, n, |i, j| spread * next() - if i == j { 0.8 } else { 0.0 });
    let b = Mat::from_fn(n, INPUTS, |_, _| next());
    let c = Mat::from_fn(INPUTS, n, |_, _| next());
    [a, b, c.transpose() * &c, Mat::identity(INPUTS, INPUTS)]
}

/// ‖AᵀX + XA − XGX + Q‖ over the sum of the products of norms: the same number as in the script.
fn residual(a: &Mat, g: &Mat, q: &Mat, x: &Mat) -> f64 {
    let rest = a.transpose() * x + x * a - x * g * x + q;
    let size = x.norm_l2();
    rest.norm_l2() / (2.0 * a.norm_l2() * size + size * size * g.norm_l2() + q.norm_l2())
}

fn main() {
    let mut file = String::new();
    println!(
        "{:>5} {:>12} {:>12} {:>12} {:>14} {:>12}",
        "n", "best µs", "median µs", "residual", "factorisations", "condition"
    );
    for n in ORDERS {
        let [a, b, q, r] = plant(n);
        let solution = care(&a, &b, &q, &r, None).unwrap();
        let runs = (200_000 / (n * n)).clamp(100, 2000);
        let mut times: Vec<f64> = (0..runs)
            .map(|_| {
                let start = Instant::now();
                std::hint::black_box(care(&a, &b, &q, &r, None).unwrap());
                1e6 * start.elapsed().as_secs_f64()
            })
            .collect();
        times.sort_by(f64::total_cmp);
        let left = residual(&a, &(&b * b.transpose()), &q, &solution.x);
        println!(
            "{n:>5} {:>12.1} {:>12.1} {left:>12.1e} {:>14} {:>12.1e}",
            times[0],
            times[runs / 2],
            solution.factorisations,
            solution.condition
        );
        for (name, m) in [("A", &a), ("B", &b), ("Q", &q), ("X", &solution.x)] {
            let values: Vec<String> =
                (0..m.nrows()).flat_map(|i| (0..m.ncols()).map(move |j| m[(i, j)].to_string())).collect();
            writeln!(file, "{n},{name},{},{},{}", m.nrows(), m.ncols(), values.join(",")).unwrap();
        }
        writeln!(file, "{n},median_us,1,1,{}", times[runs / 2]).unwrap();
    }
    if let Some(path) = std::env::args().nth(1) {
        std::fs::write(path, file).unwrap();
    }
}
