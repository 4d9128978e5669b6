//! ‖T‖₂ of a loop's channel, and what it gains from each entry of the controller.

use super::closed::{Closed, Open};
use super::targets::Channel;
use crate::linalg::{Mat, lyapunov};
use crate::lti::{blocks, cut};

/// Feedthrough below this share of what it is summed from is rounding.
const NO_FEEDTHROUGH: f64 = 1e-11;

/// h = ‖T‖₂ by h² = tr C P Cᵀ with A P + P Aᵀ + B Bᵀ = 0, and ∂ ln h/∂K = (1/h²) \[B₂ᵀ(Q P C₂ᵀ + Q B D₂₁ᵀ) + D₁₂ᵀ C P C₂ᵀ\]
/// with AᵀQ + Q A + CᵀC = 0, all of the extended plant. None where it is infinite.
pub(super) fn h2_norm(open: &Open, closed: &Closed, channel: &Channel, order: usize) -> Option<(f64, Mat)> {
    let all: Vec<usize> = (0..closed.b.ncols()).collect();
    let columns = if channel.disturbances.is_empty() { &all } else { &channel.disturbances };
    let rows = |m: &Mat| {
        Mat::from_fn(channel.outputs.len(), m.ncols(), |i, j| {
            let (row, weight) = channel.outputs[i];
            weight * m[(row, j)]
        })
    };
    let picked = |m: &Mat| Mat::from_fn(m.nrows(), columns.len(), |i, j| m[(i, columns[j])]);
    let (b, c, d) = (picked(&closed.b), rows(&closed.c), picked(&rows(&closed.d)));
    let d11 = picked(&rows(&open.d11));
    let d12 = rows(&open.d12);
    let size = d11.norm_max() + d12.norm_max() * open.d21.norm_max();
    if d.norm_max() > NO_FEEDTHROUGH * size {
        return None;
    }
    let symmetric = |m: Mat| (&m + m.transpose()) * faer::Scale(0.5);
    let p = lyapunov(&closed.a, &symmetric(&b * b.transpose())).ok()?.x;
    let at = closed.a.transpose().to_owned();
    let q = lyapunov(&at, &symmetric(c.transpose() * &c)).ok()?.x;
    let cp = &c * &p;
    let squared: f64 =
        (0..c.nrows()).map(|i| (0..c.ncols()).map(|j| cp[(i, j)] * c[(i, j)]).sum::<f64>()).sum();
    if !(squared > 0.0 && squared.is_finite()) {
        return None;
    }
    let (nu, ny) = (open.b2.ncols(), open.c2.nrows());
    let (b2, c2) = extended(open, order);
    // D₂₁ = [0; D₂₁], D₁₂ = [0 D₁₂]
    let zero = |r: usize, c: usize| Mat::zeros(r, c);
    let d21 = blocks(&[&[&zero(order, columns.len())], &[&picked(&open.d21)]]);
    let d12 = blocks(&[&[&zero(c.nrows(), order), &d12]]);
    let inner = &q * &p * c2.transpose() + &q * &b * d21.transpose();
    let g = b2.transpose() * inner + d12.transpose() * (&cp * c2.transpose());
    debug_assert_eq!((g.nrows(), g.ncols()), (order + nu, order + ny));
    let g = cut(&g, 0, 0, order + nu, order + ny) * faer::Scale(1.0 / squared);
    Some((squared.sqrt(), g))
}

/// Of the extended plant, B₂ = [0 B₂; I 0] and C₂ = [0 I; C₂ 0].
fn extended(open: &Open, order: usize) -> (Mat, Mat) {
    let (np, nu, ny) = (open.a.nrows(), open.b2.ncols(), open.c2.nrows());
    let one = Mat::identity(order, order);
    let zero = |r: usize, c: usize| Mat::zeros(r, c);
    (
        blocks(&[&[&zero(np, order), &open.b2], &[&one, &zero(order, nu)]]),
        blocks(&[&[&zero(order, np), &one], &[&open.c2, &zero(ny, order)]]),
    )
}

/// tr P with (A − γI)P + P(A − γI)ᵀ + I = 0, and what it gains from each entry of the block, 2 B₂ᵀQPC₂ᵀ with
/// (A − γI)ᵀQ + Q(A − γI) + I = 0. None where A − γI is not stable.
pub(super) fn moved_resolvent(open: &Open, closed: &Closed, order: usize, shift: f64) -> Option<(f64, Mat)> {
    let n = closed.a.nrows();
    let one = Mat::identity(n, n);
    let a = &closed.a - &one * faer::Scale(shift);
    let p = lyapunov(&a, &one).ok()?.x;
    let q = lyapunov(&a.transpose().to_owned(), &one).ok()?.x;
    let trace: f64 = (0..n).map(|i| p[(i, i)]).sum();
    if !((0..n).all(|i| p[(i, i)] > 0.0) && trace.is_finite()) {
        return None;
    }
    let (b2, c2) = extended(open, order);
    Some((trace, b2.transpose() * (&q * &p) * c2.transpose() * faer::Scale(2.0)))
}
