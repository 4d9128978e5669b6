//! What rounding in the range has left of the data's digits, by Gauss–Newton steps on all four matrices.

use super::super::SubspaceError;
use super::conditions::Condition;
use crate::linalg::{C64, CMat, LinalgError, Mat, solve_complex};

/// Steps at most; each must halve the residual.
const STEPS: usize = 8;
/// Residuals of this share are rounding.
const ROUNDING: f64 = 1e-14;
/// Directions that change no condition by more than this share of the largest: similarity, and what the data do not see.
const UNSEEN: f64 = 1e-12;

/// A, B, C, D that meet the conditions better, near those given.
///
/// d g_l = Σ_{i+j=l} c_i dA b_j + c_l dB + dC b_l + δ_l0 dD with c_i and b_j the Taylor coefficients of C(w − A)⁻¹ and
/// (w − A)⁻¹B: least squares of least norm, for similarity moves nothing.
///
/// # Errors
/// A pole at a node, an SVD that does not converge.
pub(super) fn polished(all: &[Condition], start: [Mat; 4]) -> Result<[Mat; 4], SubspaceError> {
    let mut best = start;
    let (mut jacobian, mut residual, size) = linearised(all, &best)?;
    for _ in 0..STEPS {
        let before = residual.norm_l2();
        if !(before > ROUNDING * size) {
            break;
        }
        let next = step(&best, &jacobian, &residual)?;
        let Ok((j, r, _)) = linearised(all, &next) else { break };
        if !(r.norm_l2() < before) {
            break;
        }
        let slow = r.norm_l2() > 0.5 * before;
        (best, jacobian, residual) = (next, j, r);
        if slow {
            break;
        }
    }
    Ok(best)
}

/// The weighted residual's norm over the data's.
pub(super) fn residual(all: &[Condition], abcd: &[Mat; 4]) -> Result<f64, SubspaceError> {
    let (_, residual, size) = linearised(all, abcd)?;
    Ok(residual.norm_l2() / size.max(f64::MIN_POSITIVE))
}

/// Jacobian by (A, B, C, D) as one (n + p) × (n + m) matrix column by column, data less model, and the data's norm.
fn linearised(all: &[Condition], [a, b, c, d]: &[Mat; 4]) -> Result<(Mat, Mat, f64), SubspaceError> {
    let (n, m, p) = (a.nrows(), b.ncols(), c.nrows());
    let count: usize =
        all.iter().map(|c| c.series.len() * c.left.nrows() * c.right.ncols() * c.parts()).sum();
    let (mut jacobian, mut residual) = (Mat::zeros(count, (n + p) * (n + m)), Mat::zeros(count, 1));
    let (mut row, mut square) = (0, 0.0);
    let complex = |x: &Mat| CMat::from_fn(x.nrows(), x.ncols(), |i, j| C64::new(x[(i, j)], 0.0));
    for k in all {
        let of_b = resolvents(a, &(complex(b) * &k.right), k.w, k.series.len())?;
        let dual = &k.left * complex(c);
        let of_c = resolvents(&a.transpose().to_owned(), &dual.transpose().to_owned(), k.w, k.series.len())?;
        let through = &k.left * complex(d) * &k.right;
        for (l, weight) in k.weights.iter().enumerate() {
            let model = complex(c);
            let model = &k.left * model * &of_b[l];
            for x in 0..k.left.nrows() {
                for y in 0..k.right.ncols() {
                    let put = |to: &mut Mat, at: usize, v: C64| {
                        to[(row, at)] = weight * v.re;
                        if !k.real {
                            to[(row + 1, at)] = weight * v.im;
                        }
                    };
                    let zero = C64::new(0.0, 0.0);
                    for s in 0..n {
                        for t in 0..n {
                            let v = (0..=l).map(|i| of_c[i][(s, x)] * of_b[l - i][(t, y)]).sum();
                            put(&mut jacobian, t * (n + p) + s, v);
                        }
                        for t in 0..m {
                            put(&mut jacobian, (n + t) * (n + p) + s, of_c[l][(s, x)] * k.right[(t, y)]);
                        }
                        for t in 0..p {
                            put(&mut jacobian, s * (n + p) + n + t, k.left[(x, t)] * of_b[l][(s, y)]);
                        }
                    }
                    if l == 0 {
                        for s in 0..p {
                            for t in 0..m {
                                put(
                                    &mut jacobian,
                                    (n + t) * (n + p) + n + s,
                                    k.left[(x, s)] * k.right[(t, y)],
                                );
                            }
                        }
                    }
                    let own = model[(x, y)] + if l == 0 { through[(x, y)] } else { zero };
                    let value = k.series[l][(x, y)];
                    square += weight * weight * value.norm_sqr();
                    put(&mut residual, 0, value - own);
                    row += k.parts();
                }
            }
        }
    }
    Ok((jacobian, residual, square.sqrt()))
}

/// Taylor coefficients of (w + τ − A)⁻¹B: (−1)^l (w − A)^{−l−1}B.
fn resolvents(a: &Mat, b: &CMat, w: C64, count: usize) -> Result<Vec<CMat>, LinalgError> {
    let n = a.nrows();
    let pencil = CMat::from_fn(n, n, |i, j| if i == j { w } else { C64::new(0.0, 0.0) } - a[(i, j)]);
    let minus = faer::Scale(C64::new(-1.0, 0.0));
    let mut x = b * minus;
    (0..count)
        .map(|_| {
            if n > 0 {
                x = solve_complex(&pencil, &x)? * minus;
            }
            Ok(x.clone())
        })
        .collect()
}

fn step([a, b, c, d]: &[Mat; 4], jacobian: &Mat, residual: &Mat) -> Result<[Mat; 4], SubspaceError> {
    let (n, m, p) = (a.nrows(), b.ncols(), c.nrows());
    let failed = |_| LinalgError::NoConvergence { what: "the SVD", order: jacobian.ncols() };
    let svd = jacobian.thin_svd().map_err(failed)?;
    let turned = svd.U().transpose() * residual;
    let count = jacobian.nrows().min(jacobian.ncols());
    let largest = if count > 0 { svd.S()[0] } else { 0.0 };
    let short =
        Mat::from_fn(
            count,
            1,
            |i, _| {
                if svd.S()[i] > UNSEEN * largest { turned[(i, 0)] / svd.S()[i] } else { 0.0 }
            },
        );
    let x = svd.V() * short;
    let moved = |of: &Mat, row: usize, column: usize| {
        Mat::from_fn(of.nrows(), of.ncols(), |i, j| of[(i, j)] + x[((column + j) * (n + p) + row + i, 0)])
    };
    debug_assert!(d.ncols() == m);
    Ok([moved(a, 0, 0), moved(b, 0, n), moved(c, n, 0), moved(d, n, n)])
}
