//! Inequalities written as on paper, against equations and norms that say the same.

use washboard::linalg::{Mat, lyapunov};
use washboard::lti::StateSpace;
use washboard::optimize::{Expr, Lmi, SdpError, SdpSettings, Status};

fn plant() -> (Mat, Mat, Mat) {
    let a =
        Mat::from_fn(
            5,
            5,
            |i, j| {
                if i == j { -1.0 - i as f64 } else { 0.3 * ((7 * i + 3 * j) % 5) as f64 - 0.5 }
            },
        );
    let b = Mat::from_fn(5, 2, |i, j| ((i + 2 * j) % 3) as f64 - 0.5);
    let c = Mat::from_fn(2, 5, |i, j| ((2 * i + j) % 4) as f64 - 1.0);
    (a, b, c)
}

fn t(m: &Mat) -> Mat {
    m.transpose().to_owned()
}

/// min tr P with AᵀP + PA + CᵀC ⪯ 0 is the Lyapunov equation's P.
#[test]
fn the_smallest_lyapunov_matrix() {
    let (a, _, c) = plant();
    let mut lmi = Lmi::new();
    let p = lmi.symmetric(5);
    lmi.negative("Lyapunov", &(&(&t(&a) * p).he() + &Expr::constant(t(&c) * &c)));
    lmi.minimize(p.expr().trace());
    let s = lmi.solve(&SdpSettings::default()).unwrap();
    assert_eq!(s.outcome.status, Status::Optimal);
    let equation = lyapunov(&t(&a), &(t(&c) * &c)).unwrap();
    let off = (s.value(p) - &equation.x).norm_max() / equation.x.norm_max();
    // a trace that is right to 1e-8 leaves entries to its root
    assert!(off < 1e-5, "{off:e}");
}

/// [AᵀP + PA PB Cᵀ; · −γI 0; · · −γI] ⪯ 0: the least γ is the H∞ norm.
#[test]
fn the_bounded_real_lemma() {
    let (a, b, c) = plant();
    let mut lmi = Lmi::new();
    let (p, gamma) = (lmi.symmetric(5), lmi.scalar());
    let i = Mat::identity(2, 2);
    let bounded = Expr::symmetric(vec![
        vec![(&t(&a) * p).he(), p * &b, Expr::constant(t(&c))],
        vec![-gamma.times(&i), Expr::zero(2, 2)],
        vec![-gamma.times(&i)],
    ]);
    lmi.negative("bounded real", &bounded);
    lmi.positive("P", p.expr());
    lmi.minimize(gamma.expr());
    let s = lmi.solve(&SdpSettings::default()).unwrap();
    let system = StateSpace::continuous(a, b, c, Mat::zeros(2, 2)).unwrap();
    let norm = system.hinf_norm().unwrap().norm;
    assert_eq!(s.outcome.status, Status::Optimal);
    assert!((s.outcome.objective / norm - 1.0).abs() < 1e-6, "{} for {norm}", s.outcome.objective);
    assert!((s.value(gamma)[(0, 0)] - s.outcome.objective).abs() < 1e-14 * norm);
}

/// Rectangular variables, transposes, products from both sides: min ‖M − LVR − (RᵀVᵀLᵀ)ᵀ‖ as an LMI, by known V.
#[test]
fn expressions_are_what_they_say() {
    let mut lmi = Lmi::new();
    let (v, w, g) = (lmi.matrix(2, 3), lmi.symmetric(3), lmi.scalar());
    let l = Mat::from_fn(4, 2, |i, j| (i + 1) as f64 * 0.5 - j as f64);
    let r = Mat::from_fn(3, 4, |i, j| ((i * j) % 3) as f64 - 0.7);
    let k = Mat::from_fn(4, 3, |i, j| 0.2 * i as f64 - 0.3 * j as f64 + 0.1);
    let c = Mat::from_fn(4, 4, |i, j| 1.0 / (1 + i + j) as f64);
    let e = &(&(&(&l * v) * &r).he() + &(&(&k * w) * &t(&k))) - &Expr::constant(c.clone());
    let e = e + g.times(&Mat::identity(4, 4)).scaled(2.0);
    lmi.positive("all", e);
    lmi.minimize(g.expr());
    let program = lmi.program().unwrap();
    let x: Vec<f64> = (0..lmi.variables()).map(|i| ((i * i) as f64 * 0.37).sin()).collect();
    let vm = Mat::from_fn(2, 3, |i, j| x[2 * j + i]);
    let wm = Mat::from_fn(3, 3, |i, j| x[6 + i.max(j) * (i.max(j) + 1) / 2 + i.min(j)]);
    let lvr = &l * vm * &r;
    let expected = &lvr + lvr.transpose() + &k * wm * k.transpose() - c
        + Mat::from_fn(4, 4, |i, j| if i == j { 2.0 * x[12] } else { 0.0 });
    assert!((&program.at(&x)[0] - expected).norm_max() < 1e-13);
}

#[test]
fn slips_are_named() {
    let mut lmi = Lmi::new();
    let (p, v) = (lmi.symmetric(3), lmi.matrix(2, 3));
    let refused = |e: Expr| {
        let mut lmi = lmi.clone();
        lmi.positive("the inequality", e);
        lmi.minimize(p.expr().trace());
        match lmi.program() {
            Err(SdpError::Shape { what, found, .. }) => format!("{what}: {found}"),
            other => panic!("{other:?}"),
        }
    };
    assert!(refused(&Mat::identity(2, 2) * p).contains("the inequality: (2, 2) × (3, 3)"));
    assert!(refused(p.expr() + v.expr()).contains("(3, 3) + (2, 3)"));
    assert!(refused(v.expr()).contains("2 × 3"));
    let skew = Mat::from_fn(3, 3, |i, j| (i + 2 * j) as f64);
    assert!(refused(&skew * p).contains("differ from their mirrors"));
    assert!(refused(v.times(&Mat::identity(3, 3))).contains("expected 1 × 1"));
    assert!(
        refused(Expr::symmetric(vec![vec![p.expr(), v.expr()], vec![p.expr()]])).contains("block (0, 1)")
    );
}
