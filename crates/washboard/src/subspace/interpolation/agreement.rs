//! Values that are given twice: at one node, or at a node and its conjugate.

use super::super::SubspaceError;
use super::data::{Node, Point, SAME, Side, largest};
use crate::linalg::C64;
use crate::linalg::CMat;

/// Refuses values of two nodes at one place, or at conjugate places, that no function has.
pub(super) fn agree(first: usize, a: &Node, second: usize, b: &Node) -> Result<(), SubspaceError> {
    let turned;
    let b = if a.z == b.z {
        b
    } else {
        turned = conjugate(b);
        if a.z != turned.z {
            return Ok(());
        }
        &turned
    };
    for (derivative, (x, y)) in a.values.iter().zip(&b.values).enumerate() {
        let Some((x, y)) = comparable(x, &a.side, y, &b.side) else { return Ok(()) };
        let difference = largest(&(&x - &y), |x| x.norm());
        if difference > SAME * largest(&x, |x| x.norm()).max(largest(&y, |x| x.norm())) {
            return Err(SubspaceError::Contradiction { first, second, derivative, difference });
        }
    }
    Ok(())
}

/// The values at the conjugate node.
pub(super) fn conjugate(node: &Node) -> Node {
    let turn = |v: &[C64]| v.iter().map(|x| x.conj()).collect();
    Node {
        z: match node.z {
            Point::Finite(z) => Point::Finite(z.conj()),
            Point::Infinity => Point::Infinity,
        },
        values: node
            .values
            .iter()
            .map(|g| CMat::from_fn(g.nrows(), g.ncols(), |i, j| g[(i, j)].conj()))
            .collect(),
        side: match &node.side {
            Side::Full => Side::Full,
            Side::Left(v) => Side::Left(turn(v)),
            Side::Right(v) => Side::Right(turn(v)),
        },
    }
}

/// Two values as one and the same part of G, where they have one in common.
fn comparable(x: &CMat, a: &Side, y: &CMat, b: &Side) -> Option<(CMat, CMat)> {
    let row = |v: &[C64]| CMat::from_fn(1, v.len(), |_, j| v[j]);
    let column = |v: &[C64]| CMat::from_fn(v.len(), 1, |i, _| v[i]);
    let parallel = |v: &[C64], w: &[C64]| {
        let k = (0..v.len()).fold(0, |k, i| if v[i].norm() > v[k].norm() { i } else { k });
        let ratio = w[k] / v[k];
        let off = v.iter().zip(w).map(|(v, w)| (v * ratio - w).norm()).fold(0.0, f64::max);
        (off <= 1e-14 * w[k].norm()).then_some(ratio)
    };
    Some(match (a, b) {
        (Side::Full, Side::Full) => (x.clone(), y.clone()),
        (Side::Full, Side::Right(u)) => (x * column(u), y.clone()),
        (Side::Full, Side::Left(v)) => (row(v) * x, y.clone()),
        (Side::Left(_) | Side::Right(_), Side::Full) => return comparable(y, b, x, a),
        (Side::Left(v), Side::Right(u)) => (x * column(u), row(v) * y),
        (Side::Right(_), Side::Left(_)) => return comparable(y, b, x, a),
        (Side::Left(v), Side::Left(w)) | (Side::Right(v), Side::Right(w)) => {
            (x * faer::Scale(parallel(v, w)?), y.clone())
        }
    })
}
