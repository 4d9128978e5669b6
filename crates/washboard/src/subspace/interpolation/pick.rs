//! Nevanlinna–Pick: interpolation under a bound of the norm, by nodes mirrored in the circle.

use super::super::SubspaceError;
use super::conditions::{Condition, conditions};
use super::data::{Domain, InterpolationData, Node, Point};
use super::interpolate::{Interpolant, anywhere};
use super::plane::Mobius;
use crate::linalg::{C64, CMat, LinalgError, Mat, solve_complex};

/// Nodes nearer to the circle than this, or bounds nearer to the least one, cannot be told from those on it.
const TOUCHES: f64 = 1e-9;
/// Bounds above this many times the least: of values over the bound eight digits are left.
const LOOSE: f64 = 1e8;
/// Where a further node may lie, as 1/z; and values that may be moved to 0.
const PLACES: [f64; 7] = [0.0, 0.5, -0.5, 0.25, -0.25, 0.75, -0.75];

/// An interpolant of constant modulus on the circle or axis.
#[derive(Debug, Clone)]
pub struct Bounded {
    /// Its modulus there is `bound` everywhere; stable.
    pub interpolant: Interpolant,
    /// γ.
    pub bound: f64,
    /// The least bound that any stable function through the data has.
    pub least: f64,
}

/// A stable scalar function through the data whose modulus on the boundary is at most γ, by default the least one.
///
/// The Pick matrix P_ij = (γ² − w_i w̄_j)/(1 − 1/(z_i z̄_j)) is positive semidefinite for a bound that can be met; `least` is the
/// largest γ at which it is singular. There, adding the mirror nodes 1/z̄_k with the values γ²/w̄_k makes the minimal
/// interpolant unique: |G| = γ on the circle, and order N − 1 or less. For a larger γ one real node with a value on the edge of
/// what is possible makes the matrix singular again; the order is N.
///
/// Values are first moved by a Möbius map of the disk of values, so that none is 0 and every mirror value is finite.
///
/// # Errors
/// As [`interpolate`](super::interpolate); data with derivatives, directions, more than one input or output, or nodes on
/// the boundary; a bound below the least, with both.
///
/// Source: Türkay's thesis, end of §3.1.5; Antoulas and Anderson, *On the problem of stable rational interpolation* (1989).
pub fn interpolate_bounded(data: &InterpolationData, bound: Option<f64>) -> Result<Bounded, SubspaceError> {
    data.check()?;
    let map = Mobius::to_disk(data.domain);
    let mut nodes = scalar_nodes(data, map)?;
    let least = least_bound(&nodes)?;
    let gamma = bound.unwrap_or(least);
    if !(gamma >= least * (1.0 - TOUCHES) && gamma.is_finite()) {
        return Err(SubspaceError::Bound { bound: gamma, least });
    }
    if gamma > LOOSE * least && least > 0.0 {
        let expected =
            format!("at most {LOOSE:e} times the least, {least:e}: beyond it values are lost to rounding");
        return Err(SubspaceError::Field { field: "bound", expected, found: format!("{gamma:?}") });
    }
    let first = nodes.first().map_or(0.0, |(_, w)| w.re);
    // in units of the bound
    let unit = if gamma > 0.0 { gamma } else { 1.0 };
    nodes.iter_mut().for_each(|(_, w)| *w /= unit);
    let order = if gamma > least * (1.0 + TOUCHES) {
        nodes.push(edge(&nodes)?);
        nodes.len() - 1
    } else {
        rank_of_pick(&nodes)?
    };
    // all values are one, and its modulus the least bound
    if order == 0 || gamma == 0.0 {
        let (none, d) = (Mat::zeros(0, 0), Mat::from_fn(1, 1, |_, _| first));
        let interpolant = Interpolant::new(
            data,
            Mobius::ONE,
            [&none, &Mat::zeros(0, 1), &Mat::zeros(1, 0), &d],
            Vec::new(),
        )?;
        return Ok(Bounded { interpolant, bound: gamma, least });
    }
    let moved = |a: f64, w: C64| (w - a) / (C64::new(1.0, 0.0) - w * a);
    let nearest = |a: f64| nodes.iter().map(|(_, w)| moved(a, *w).norm()).fold(f64::INFINITY, f64::min);
    let a = PLACES.into_iter().fold(0.0, |best, a| if nearest(a) > nearest(best) { a } else { best });
    let one = |w: C64| vec![CMat::from_fn(1, 1, |_, _| w)];
    let mut doubled = Vec::with_capacity(2 * nodes.len());
    // one of each conjugate pair is enough
    for (x, w) in nodes.iter().filter(|(x, _)| x.im <= 0.0) {
        let h = moved(a, *w);
        let z = if x.norm() == 0.0 { Point::Infinity } else { Point::Finite(C64::new(1.0, 0.0) / x) };
        doubled.push(Node { z, values: one(h), side: super::Side::Full });
        doubled.push(Node::full(x.conj(), one(C64::new(1.0, 0.0) / h.conj())));
    }
    let disk = InterpolationData { domain: Domain::Disk, outputs: 1, inputs: 1, nodes: doubled };
    let found = anywhere(&disk, Some(order))?;
    let [ah, b, c, d] = found.system.matrices();
    // G = γ(h + a)/(1 + a h)
    let (d, loop_gain) = (d[(0, 0)], 1.0 / (1.0 + a * d[(0, 0)]));
    let system = [
        ah - b * c * faer::Scale(a * loop_gain),
        b * faer::Scale(loop_gain),
        c * faer::Scale(gamma * (1.0 - a * (d + a) * loop_gain)),
        Mat::from_fn(1, 1, |_, _| gamma * (d + a) * loop_gain),
    ];
    let interpolant = Interpolant::new(data, map, system.each_ref(), found.singular_values)?;
    Ok(Bounded { interpolant, bound: gamma, least })
}

/// 1/z and w of every node, conjugates beside their partners.
fn scalar_nodes(data: &InterpolationData, map: Mobius) -> Result<Vec<(C64, C64)>, SubspaceError> {
    for (field, found) in [("inputs of bounded data", data.inputs), ("outputs of bounded data", data.outputs)]
    {
        if found != 1 {
            return Err(SubspaceError::Count { what: field, expected: 1, found });
        }
    }
    if let Some(node) = data.nodes.iter().find(|n| n.values.len() > 1) {
        return Err(SubspaceError::Count {
            what: "values at a node of bounded data",
            expected: 1,
            found: node.values.len(),
        });
    }
    let mut nodes: Vec<(C64, C64)> = Vec::new();
    for (index, node) in data.nodes.iter().enumerate() {
        // 1/z: z may be infinite
        let turned = Mobius { alpha: map.gamma, beta: map.delta, gamma: map.alpha, delta: map.beta };
        let x = turned.point(node.z);
        let Some(x) = x.filter(|x| x.norm() < 1.0 - TOUCHES) else {
            let why =
                "on the boundary, expected inside the region without poles for data with a bound".to_owned();
            return Err(SubspaceError::Sample { what: "node", index, why });
        };
        let one: Vec<Condition> = conditions(Mobius::ONE, std::slice::from_ref(&plain(node)), (1, 1));
        let Some(w) = one.first().map(|c| c.series[0][(0, 0)] / (c.left[(0, 0)] * c.right[(0, 0)])) else {
            continue;
        };
        for (x, w) in [(x, w), (x.conj(), w.conj())] {
            if !nodes.iter().any(|(y, _)| *y == x) {
                nodes.push((x, w));
            }
        }
    }
    Ok(nodes)
}

/// The node at a real place: its value is all that matters.
fn plain(node: &Node) -> Node {
    Node { z: Point::Finite(C64::new(2.0, 1.0)), ..node.clone() }
}

/// (1 − w_i w̄_j)/(1 − x_i x̄_j), values over γ.
fn pick(nodes: &[(C64, C64)]) -> CMat {
    let one = C64::new(1.0, 0.0);
    CMat::from_fn(nodes.len(), nodes.len(), |i, j| {
        let ((x, w), (y, v)) = (nodes[i], nodes[j]);
        (one - w * v.conj()) / (one - x * y.conj())
    })
}

fn eigenvalues(m: &CMat) -> Result<Vec<f64>, LinalgError> {
    let order = m.nrows();
    m.self_adjoint_eigenvalues(faer::Side::Lower)
        .map_err(|_| LinalgError::NoConvergence { what: "the Hermitian QR algorithm", order })
}

/// √ of the largest eigenvalue of w_i w̄_j/(1 − x_i x̄_j) against 1/(1 − x_i x̄_j).
fn least_bound(nodes: &[(C64, C64)]) -> Result<f64, SubspaceError> {
    let ones: Vec<(C64, C64)> = nodes.iter().map(|(x, _)| (*x, C64::new(0.0, 0.0))).collect();
    let kernel = pick(&ones);
    let singular = |_| LinalgError::Singular {
        what: "the Pick matrix of ones",
        why: "nodes that can't be told apart",
        value: 0.0,
    };
    let factor = kernel.llt(faer::Side::Lower).map_err(singular)?;
    // L⁻¹ W K Wᴴ L⁻ᴴ = X Xᴴ with X = L⁻¹ W L
    let weighted = CMat::from_fn(nodes.len(), nodes.len(), |i, j| nodes[i].1 * factor.L()[(i, j)]);
    let x = solve_complex(&factor.L().to_owned(), &weighted)?;
    let values = x
        .singular_values()
        .map_err(|_| LinalgError::NoConvergence { what: "the SVD", order: nodes.len() })?;
    Ok(values.first().copied().unwrap_or(0.0))
}

/// N less the eigenvalues that are 0, beside those of 1/(1 − x_i x̄_j).
fn rank_of_pick(nodes: &[(C64, C64)]) -> Result<usize, SubspaceError> {
    let values = eigenvalues(&pick(nodes))?;
    let largest = nodes.iter().map(|(x, _)| 1.0 / (1.0 - x.norm_sqr())).fold(0.0, f64::max);
    Ok(values.iter().filter(|v| v.abs() > TOUCHES * largest).count().min(nodes.len().saturating_sub(1)))
}

/// A further real node with a value that makes the Pick matrix singular.
fn edge(nodes: &[(C64, C64)]) -> Result<(C64, C64), SubspaceError> {
    let far = |t: f64| nodes.iter().map(|(x, _)| (x - t).norm()).fold(f64::INFINITY, f64::min);
    let t = PLACES.into_iter().fold(0.0, |best, t| if far(t) > far(best) { t } else { best });
    let n = nodes.len();
    // b = b₀ + v b₁ of the value v
    let sides = CMat::from_fn(n, 2, |i, k| {
        let (x, w) = nodes[i];
        (if k == 0 { C64::new(1.0, 0.0) } else { -w }) / (C64::new(1.0, 0.0) - x * t)
    });
    let solved = solve_complex(&pick(nodes), &sides)?;
    let q = |i: usize, j: usize| (0..n).map(|k| (sides[(k, i)].conj() * solved[(k, j)]).re).sum::<f64>();
    let corner = 1.0 / (1.0 - t * t);
    // (1 − v²) corner = q₀₀ + 2 v q₀₁ + v² q₁₁
    let (a, b, c) = (corner + q(1, 1), q(0, 1), q(0, 0) - corner);
    let root = (b * b - a * c).max(0.0).sqrt();
    let v = if b > 0.0 { -c / (b + root) } else { (root - b) / a };
    Ok((C64::new(t, 0.0), C64::new(v, 0.0)))
}
