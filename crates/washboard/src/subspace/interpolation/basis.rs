//! Polynomials φ₀ … φ_{q−1} at the nodes, as Taylor coefficients: powers as printed, or orthogonal over the nodes.

use super::conditions::Condition;
use crate::linalg::{C64, Mat};

/// A next polynomial that keeps less than this of its length is one of those before it.
const DEPENDENT: f64 = 1e-13;

/// Which polynomials.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// φ_i = w^i, Z_q of (3.18).
    Powers,
    /// Orthonormal over the weighted nodes, by Arnoldi's process on multiplication by w.
    Orthogonal,
    /// Orthonormal over the nodes alone: noise that weights have made alike then is alike in every block row.
    White,
}

/// φ_i at condition k: Taylor coefficients, and w φ_i = Σ_j h_ji φ_j.
pub(super) struct Basis {
    /// \[i\]\[k\]\[l\].
    pub phi: Vec<Vec<Vec<C64>>>,
    /// q × (q − 1).
    pub recurrence: Mat,
    /// φ₀.
    pub first: f64,
}

impl Basis {
    /// At most q polynomials; fewer where the nodes tell no more apart.
    pub fn new(conditions: &[Condition], q: usize, kind: Kind) -> Self {
        let one: Vec<Vec<C64>> = conditions
            .iter()
            .map(|c| (0..c.series.len()).map(|l| C64::new(f64::from(u8::from(l == 0)), 0.0)).collect())
            .collect();
        let product = |phi: &[Vec<C64>], psi: &[Vec<C64>]| product(conditions, phi, psi, kind);
        let length = |phi: &Vec<Vec<C64>>| product(phi, phi).sqrt();
        let first = if kind == Kind::Powers { 1.0 } else { 1.0 / length(&one) };
        let mut phi = vec![scaled(&one, first)];
        let mut recurrence = Mat::zeros(q, q.max(1) - 1);
        for i in 0..q.max(1) - 1 {
            let mut next = times_w(conditions, &phi[i]);
            if kind != Kind::Powers {
                let before = length(&next);
                // twice is enough
                for _ in 0..2 {
                    for (j, phi) in phi.iter().enumerate() {
                        let h = product(phi, &next);
                        recurrence[(j, i)] += h;
                        subtract(&mut next, h, phi);
                    }
                }
                let left = length(&next);
                if !(left > DEPENDENT * before) {
                    recurrence = recurrence.submatrix(0, 0, i + 1, i).to_owned();
                    return Basis { phi, recurrence, first };
                }
                recurrence[(i + 1, i)] = left;
                next = scaled(&next, 1.0 / left);
            } else {
                recurrence[(i + 1, i)] = 1.0;
            }
            phi.push(next);
        }
        Basis { phi, recurrence, first }
    }

    /// q.
    pub fn len(&self) -> usize {
        self.phi.len()
    }
}

fn times_w(conditions: &[Condition], phi: &[Vec<C64>]) -> Vec<Vec<C64>> {
    let one = |(c, f): (&Condition, &Vec<C64>)| {
        (0..f.len()).map(|l| c.w * f[l] + if l > 0 { f[l - 1] } else { C64::new(0.0, 0.0) }).collect()
    };
    conditions.iter().zip(phi).map(one).collect()
}

fn scaled(phi: &[Vec<C64>], by: f64) -> Vec<Vec<C64>> {
    phi.iter().map(|f| f.iter().map(|x| x * by).collect()).collect()
}

fn subtract(from: &mut [Vec<C64>], h: f64, phi: &[Vec<C64>]) {
    for (f, g) in from.iter_mut().zip(phi) {
        f.iter_mut().zip(g).for_each(|(f, g)| *f -= g * h);
    }
}

/// Re Σ s² φ̄ ψ; s = 1 for white noise.
fn product(conditions: &[Condition], phi: &[Vec<C64>], psi: &[Vec<C64>], kind: Kind) -> f64 {
    let mut sum = 0.0;
    for ((c, f), g) in conditions.iter().zip(phi).zip(psi) {
        for ((f, g), s) in f.iter().zip(g).zip(&c.weights) {
            let s = if kind == Kind::White { 1.0 } else { *s };
            sum += s * s * (f.re * g.re + f.im * g.im);
        }
    }
    sum
}
