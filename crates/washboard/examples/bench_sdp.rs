//! The semidefinite solver on mixed H2/H∞ inequalities of output feedback for random plants, against the number of states:
//! `bench_sdp [states …]`, or
//! `bench_sdp write STATES` for the program in SDPA's sparse format, which other solvers read (`benches/peers/csdp.py`).
//! 18 states make 996 variables and blocks of 60, 42 and 48.

#![allow(clippy::print_stdout, clippy::unwrap_used)]

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::time::Instant;
use washboard::linalg::Mat;
use washboard::optimize::{Expr, Lmi, Sdp, SdpSettings};

fn main() {
    if std::env::args().nth(1).as_deref() == Some("write") {
        let states = std::env::args().nth(2).map_or(18, |a| a.parse().unwrap());
        return write(&inequalities(states).program().unwrap());
    }
    let asked: Vec<usize> = std::env::args().skip(1).map(|a| a.parse().unwrap()).collect();
    let states = if asked.is_empty() { vec![4, 8, 12, 18, 25, 32, 40] } else { asked };
    for n in states {
        let lmi = inequalities(n);
        let program = lmi.program().unwrap();
        let settings = SdpSettings { double_double: false, ..SdpSettings::default() };
        let mut best = f64::INFINITY;
        let mut last = None;
        for _ in 0..if n > 25 { 1 } else { 3 } {
            let begin = Instant::now();
            last = Some(program.solve(&settings));
            best = best.min(begin.elapsed().as_secs_f64());
        }
        let o = last.unwrap();
        println!(
            "{n} states, {} variables: {best:.3} s, {} iterations, {:?}, {:.8} ≥ {:.8}",
            lmi.variables(),
            o.iterations[0],
            o.status,
            o.objective,
            o.bound
        );
    }
}

/// min cᵀx with Σ x_iF_i − F₀ ⪰ 0, entry by entry.
fn write(program: &Sdp) {
    let (m, blocks) = (program.variables(), program.at(&vec![0.0; program.variables()]));
    let row = |values: &mut dyn Iterator<Item = String>| println!("{}", values.collect::<Vec<_>>().join(" "));
    println!("{m}\n{}", blocks.len());
    row(&mut blocks.iter().map(|b| b.nrows().to_string()));
    row(&mut program.objective().iter().map(|c| format!("{c:e}")));
    for i in 0..=m {
        let mut x = vec![0.0; m];
        if i > 0 {
            x[i - 1] = 1.0;
        }
        for (k, (at, zero)) in program.at(&x).iter().zip(&blocks).enumerate() {
            for column in 0..at.ncols() {
                for line in 0..=column {
                    let value = if i == 0 {
                        -zero[(line, column)]
                    } else {
                        at[(line, column)] - zero[(line, column)]
                    };
                    if value != 0.0 {
                        println!("{i} {} {} {} {value:e}", k + 1, line + 1, column + 1);
                    }
                }
            }
        }
    }
}

/// min γ + tr Z with γ above the H∞ norm and tr Z above the square of the H2 norm of two thirds of the outputs. Fewer measurements
/// than disturbances, all noisy; all controls weighted: the infimum is attained.
fn inequalities(n: usize) -> Lmi {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut random =
        |p: usize, q: usize, size: f64| Mat::from_fn(p, q, |_, _| size * rng.random_range(-1.0..1.0));
    let (nw, nu, ny, nz, nz2) = (6, 7, 5, 18, 12);
    let a = random(n, n, 1.0) - Mat::from_fn(n, n, |i, j| if i == j { 2.0 } else { 0.0 });
    let (b1, b2) = (random(n, nw, 1.0), random(n, nu, 1.0));
    let (c1, d11, d12) = (random(nz, n, 1.0), random(nz, nw, 0.1), random(nz, nu, 1.0));
    let (c2, d21) = (random(ny, n, 1.0), random(ny, nw, 1.0));
    let mut lmi = Lmi::new();
    let (x, y) = (lmi.symmetric(n), lmi.symmetric(n));
    let (ah, bh, ch, dh) = (lmi.matrix(n, n), lmi.matrix(n, ny), lmi.matrix(nu, n), lmi.matrix(nu, ny));
    let (gamma, z) = (lmi.scalar(), lmi.symmetric(nz2));
    let constant = |m: &Mat| Expr::constant(m.clone());
    let ax = (&(&a * x) + &(&b2 * ch)).he();
    let ya = (&(y * &a) + &(bh * &c2)).he();
    let cross = &ah.expr().t() + &(&constant(&a) + &(&(&b2 * dh) * &c2));
    let bx = &constant(&b1) + &(&(&b2 * dh) * &d21);
    let by = &(y * &b1) + &(bh * &d21);
    let cx = &(&c1 * x) + &(&d12 * ch);
    let cy = &constant(&c1) + &(&(&d12 * dh) * &c2);
    let few = |m: &Mat| m.subrows(0, nz2).to_owned();
    let cx2 = &(&few(&c1) * x) + &(&few(&d12) * ch);
    let cy2 = &constant(&few(&c1)) + &(&(&few(&d12) * dh) * &c2);
    let d = &constant(&d11) + &(&(&d12 * dh) * &d21);
    let (w, v) = (Mat::identity(nw, nw), Mat::identity(nz, nz));
    let bounded = Expr::symmetric(vec![
        vec![ax.clone(), cross.clone(), bx.clone(), cx.t()],
        vec![ya.clone(), by.clone(), cy.t()],
        vec![-gamma.times(&w), d.t()],
        vec![-gamma.times(&v)],
    ]);
    lmi.negative("H∞", &bounded);
    let covariance = vec![vec![ax, cross, bx], vec![ya, by], vec![Expr::identity(nw, -1.0)]];
    lmi.negative("H2", &Expr::symmetric(covariance));
    let outputs =
        vec![vec![x.expr(), Expr::identity(n, 1.0), cx2.t()], vec![y.expr(), cy2.t()], vec![z.expr()]];
    lmi.positive("Z", Expr::symmetric(outputs));
    lmi.minimize(&z.expr().trace() + &gamma.expr());
    lmi
}
