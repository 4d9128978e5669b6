//! A controller's feedthrough that leaves the H2 norm finite.

use super::parts::Parts;
use crate::linalg::Mat;
use crate::optimize::{Expr, Lmi, Variable};

/// D̂ with D₁₁ + D₁₂D̂D₂₁ = 0 for all H2 goals together: the least one, and what may be added to it.
pub(super) fn feedthrough(
    lmi: &mut Lmi,
    parts: &Parts,
    nu: usize,
    ny: usize,
) -> (Expr, Mat, Vec<(Mat, Variable, Mat)>) {
    let whole = |lmi: &mut Lmi| {
        let v = lmi.matrix(nu, ny);
        (v.expr(), Mat::zeros(nu, ny), vec![(Mat::identity(nu, nu), v, Mat::identity(ny, ny))])
    };
    let Some(h2) = &parts.all_h2 else { return whole(lmi) };
    if h2.d12.norm_max() == 0.0 || h2.d21.norm_max() == 0.0 {
        return whole(lmi);
    }
    let (right, pinv12) = null_and_inverse(&h2.d12);
    let (left, pinv21) = null_and_inverse(&h2.d21.transpose().to_owned());
    let d0 = -(&pinv12 * &h2.d11 * pinv21.transpose());
    let mut d = Expr::constant(d0.clone());
    let mut free = Vec::new();
    if right.ncols() > 0 {
        let v = lmi.matrix(right.ncols(), ny);
        d = d + &right * v;
        free.push((right, v, Mat::identity(ny, ny)));
    }
    if left.ncols() > 0 {
        let v = lmi.matrix(nu, left.ncols());
        let turned = left.transpose().to_owned();
        d = d + v * &turned;
        free.push((Mat::identity(nu, nu), v, turned));
    }
    (d, d0, free)
}

/// A basis of the null space, and the pseudo-inverse.
fn null_and_inverse(m: &Mat) -> (Mat, Mat) {
    let (p, q) = m.shape();
    let Ok(svd) = m.svd() else { return (Mat::zeros(q, 0), Mat::zeros(q, p)) };
    let s: Vec<f64> = svd.S().column_vector().iter().copied().collect();
    let limit = 1e-12 * s.first().copied().unwrap_or(0.0);
    let rank = s.iter().filter(|v| **v > limit).count();
    let (u, v) = (svd.U(), svd.V());
    let null = Mat::from_fn(q, q - rank, |i, j| v[(i, rank + j)]);
    let inverse = Mat::from_fn(q, p, |i, j| (0..rank).map(|k| v[(i, k)] * u[(j, k)] / s[k]).sum());
    (null, inverse)
}
