//! Nodes as conditions on Taylor coefficients in the plane of work: left · G(w₀ + τ) · right = Σ g_l τ^l.

use super::agreement::conjugate;
use super::data::{Node, Point, Side, largest};
use super::plane::Mobius;
use crate::linalg::{C64, CMat};

/// One node in one direction; a conjugate pair is the one with Im z ≥ 0.
#[derive(Debug, Clone)]
pub(super) struct Condition {
    pub w: C64,
    /// r × p.
    pub left: CMat,
    /// m × c.
    pub right: CMat,
    /// r × c each.
    pub series: Vec<CMat>,
    /// Whether imaginary parts say nothing.
    pub real: bool,
    /// How much coefficient l counts, and so what is noisy.
    pub weights: Vec<f64>,
    /// Whether it is all of G from the left, and from the right.
    pub whole: [bool; 2],
}

impl Condition {
    /// Numbers that it says: 2 a coefficient and column, or 1 where all is real.
    pub fn parts(&self) -> usize {
        if self.real { 1 } else { 2 }
    }

    /// The same for Gᵀ.
    pub fn transposed(&self) -> Self {
        let turn = |m: &CMat| m.transpose().to_owned();
        Condition {
            w: self.w,
            left: turn(&self.right),
            right: turn(&self.left),
            series: self.series.iter().map(turn).collect(),
            real: self.real,
            weights: self.weights.clone(),
            whole: [self.whole[1], self.whole[0]],
        }
    }
}

/// Distinct conditions of nodes that agree: conjugates folded, repetitions taken once, derivatives over factorials.
pub(super) fn conditions(map: Mobius, nodes: &[Node], (p, m): (usize, usize)) -> Vec<Condition> {
    let mut distinct: Vec<Node> = Vec::new();
    for node in nodes {
        let below = matches!(node.z, Point::Finite(z) if z.im < 0.0);
        let node = if below { conjugate(node) } else { node.clone() };
        match distinct.iter_mut().find(|d| d.z == node.z && d.side == node.side) {
            Some(d) if d.values.len() < node.values.len() => *d = node,
            Some(_) => {}
            None => distinct.push(node),
        }
    }
    distinct.iter().filter_map(|node| condition(map, node, (p, m))).collect()
}

fn condition(map: Mobius, node: &Node, (p, m): (usize, usize)) -> Option<Condition> {
    let w = map.point(node.z)?;
    let mut factorial = 1.0;
    let mut series = Vec::with_capacity(node.values.len());
    for (l, value) in node.values.iter().enumerate() {
        factorial *= l.max(1) as f64;
        let scale = if node.z == Point::Infinity { 1.0 } else { 1.0 / factorial };
        series.push(value * faer::Scale(C64::new(scale, 0.0)));
    }
    let mut series = map.series(node.z, &series);
    let identity = |n: usize| CMat::from_fn(n, n, |i, j| C64::new(f64::from(u8::from(i == j)), 0.0));
    let mut unit = |v: &[C64]| {
        let length = v.iter().map(|x| x.norm_sqr()).sum::<f64>().sqrt();
        series.iter_mut().for_each(|g| *g = &*g * faer::Scale(C64::new(1.0 / length, 0.0)));
        v.iter().map(|x| x / length).collect::<Vec<_>>()
    };
    let (left, right, whole, straight) = match &node.side {
        Side::Full => (identity(p), identity(m), [true, true], true),
        Side::Left(v) => {
            let v = unit(v);
            let straight = v.iter().all(|x| x.im == 0.0);
            (CMat::from_fn(1, p, |_, j| v[j]), identity(m), [false, true], straight)
        }
        Side::Right(u) => {
            let u = unit(u);
            let straight = u.iter().all(|x| x.im == 0.0);
            (identity(p), CMat::from_fn(m, 1, |i, _| u[i]), [true, false], straight)
        }
    };
    let real = straight && w.im == 0.0;
    let weights = weights(&series);
    Some(Condition { w, left, right, series, real, weights, whole })
}

/// ρ^l, ρ ≤ 1, so that no coefficient weighs more than the value: derivatives near a pole would drown the rest.
fn weights(series: &[CMat]) -> Vec<f64> {
    let size = |g: &CMat| largest(g, |x| x.norm());
    let first = series.first().map_or(0.0, size);
    let rho = series.iter().enumerate().skip(1).fold(1.0f64, |rho, (l, g)| {
        let ratio = (first / size(g)).powf(1.0 / l as f64);
        if first > 0.0 && ratio > 0.0 { rho.min(ratio) } else { rho }
    });
    (0..series.len()).map(|l| rho.powi(l as i32)).collect()
}
