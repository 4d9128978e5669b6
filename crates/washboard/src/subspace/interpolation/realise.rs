//! Stage two: A and C from the range, (3.50); B and D from all conditions, (3.58), some of them exactly, (3.73).

use super::super::SubspaceError;
use super::conditions::Condition;
use super::projection::Range;
use crate::linalg::{C64, CMat, LinalgError, Mat, solve_complex};
use faer::linalg::solvers::SolveLstsq;

/// Unknowns whose columns are dependent to this share are not determined.
const DEPENDENT: f64 = 1e-13;
/// Constraints count as met to this share of their size.
const MET: f64 = 1e-9;

/// A and C of order n, up to similarity.
///
/// # Errors
/// Fewer rows than the order takes.
pub(super) fn poles(range: &Range, p: usize, n: usize) -> Result<(Mat, Mat), SubspaceError> {
    let q = range.basis.len();
    let most = ((q - 1) * p).min(range.singular_values.len());
    if n > most {
        return Err(SubspaceError::TooLittleData { rank: most, most, missing: n - most });
    }
    let observed = range.u.subcols(0, n);
    let down = observed.subrows(0, (q - 1) * p).to_owned();
    // w φ_i = Σ_j h_ji φ_j, so C φ_i(A) A = Σ_j h_ji C φ_j(A)
    let h = &range.basis.recurrence;
    let up = Mat::from_fn((q - 1) * p, n, |row, x| {
        let (i, a) = (row / p, row % p);
        (0..=i + 1).map(|j| h[(j, i)] * observed[(j * p + a, x)]).sum()
    });
    let a = if n == 0 { Mat::zeros(0, 0) } else { down.qr().solve_lstsq(&up) };
    Ok((a, Mat::from_fn(p, n, |i, j| observed[(i, j)] / range.basis.first)))
}

/// Rows of Υ_k of (3.61) over l!: C(wI − A)^{−l−1}(−1)^l, p × n each.
fn resolvents(a: &Mat, c: &Mat, w: C64, count: usize) -> Result<Vec<CMat>, LinalgError> {
    let (n, p) = (a.nrows(), c.nrows());
    let pencil = CMat::from_fn(n, n, |i, j| if i == j { w } else { C64::new(0.0, 0.0) } - a[(j, i)]);
    let mut x = CMat::from_fn(n, p, |i, j| C64::new(-c[(j, i)], 0.0));
    (0..count)
        .map(|_| {
            if n > 0 {
                x = solve_complex(&pencil, &x)? * faer::Scale(C64::new(-1.0, 0.0));
            }
            Ok(x.transpose().to_owned())
        })
        .collect()
}

/// Linear equations in the entries of B and D, column by column: rows and right-hand sides.
struct Equations {
    rows: Mat,
    right: Mat,
}

impl Equations {
    fn new(conditions: &[Condition], a: &Mat, c: &Mat, m: usize) -> Result<Self, SubspaceError> {
        let (n, p) = (a.nrows(), c.nrows());
        let count: usize =
            conditions.iter().map(|c| c.series.len() * c.left.nrows() * c.right.ncols() * c.parts()).sum();
        let (mut rows, mut right) = (Mat::zeros(count, (n + p) * m), Mat::zeros(count, 1));
        let mut row = 0;
        for condition in conditions {
            let chi = resolvents(a, c, condition.w, condition.series.len())?;
            for (l, weight) in condition.weights.iter().enumerate() {
                let of_b = &condition.left * &chi[l];
                for i in 0..condition.left.nrows() {
                    for j in 0..condition.right.ncols() {
                        let put = |to: &mut Mat, at: usize, x: C64| {
                            to[(row, at)] = weight * x.re;
                            if !condition.real {
                                to[(row + 1, at)] = weight * x.im;
                            }
                        };
                        for y in 0..m {
                            let u = condition.right[(y, j)];
                            (0..n).for_each(|x| put(&mut rows, y * (n + p) + x, of_b[(i, x)] * u));
                            if l == 0 {
                                let d = |x: usize| condition.left[(i, x)] * u;
                                (0..p).for_each(|x| put(&mut rows, y * (n + p) + n + x, d(x)));
                            }
                        }
                        put(&mut right, 0, condition.series[l][(i, j)]);
                        row += condition.parts();
                    }
                }
            }
        }
        Ok(Equations { rows, right })
    }
}

/// B and D: least squares of the conditions, with the constraints met exactly, by their null space.
///
/// # Errors
/// Conditions that do not determine B and D, with the rank that is missing; constraints that no B and D meet; a pole at a node.
pub(super) fn inputs(
    conditions: &[Condition],
    constraints: &[Condition],
    (a, c): (&Mat, &Mat),
    m: usize,
) -> Result<(Mat, Mat), SubspaceError> {
    let (n, p) = (a.nrows(), c.nrows());
    let free = Equations::new(conditions, a, c, m)?;
    let exact = Equations::new(constraints, a, c, m)?;
    let unknowns = (n + p) * m;
    // columns alike in size
    let scale: Vec<f64> = (0..unknowns)
        .map(|j| {
            free.rows.subcols(j, 1).norm_l2().hypot(exact.rows.subcols(j, 1).norm_l2()).max(f64::MIN_POSITIVE)
        })
        .collect();
    let scaled = |x: &Mat| Mat::from_fn(x.nrows(), unknowns, |i, j| x[(i, j)] / scale[j]);
    let (y, e) = (scaled(&free.rows), scaled(&exact.rows));
    let (start, null) = null_space(&e, &exact.right)?;
    let left = &free.right - &y * &start;
    let step = determined(&(&y * &null), &left, unknowns - null.ncols())?;
    let x = start + &null * step;
    let at = |r: usize, y: usize| x[(y * (n + p) + r, 0)] / scale[y * (n + p) + r];
    Ok((Mat::from_fn(n, m, at), Mat::from_fn(p, m, |i, j| at(n + i, j))))
}

/// A solution of E x = e and a basis of the null space of E.
fn null_space(e: &Mat, right: &Mat) -> Result<(Mat, Mat), SubspaceError> {
    let (count, unknowns) = (e.nrows(), e.ncols());
    if count == 0 {
        return Ok((Mat::zeros(unknowns, 1), Mat::identity(unknowns, unknowns)));
    }
    // rows alike in size
    let size: Vec<f64> = (0..count).map(|i| e.subrows(i, 1).norm_l2().max(f64::MIN_POSITIVE)).collect();
    let e = Mat::from_fn(count, unknowns, |i, j| e[(i, j)] / size[i]);
    let right = Mat::from_fn(count, 1, |i, _| right[(i, 0)] / size[i]);
    let svd = e.svd().map_err(|_| LinalgError::NoConvergence { what: "the SVD", order: unknowns })?;
    let largest = svd.S()[0];
    let rank = (0..count.min(unknowns)).filter(|i| svd.S()[*i] > MET * largest).count();
    let turned = svd.U().subcols(0, rank).transpose() * &right;
    let short = Mat::from_fn(rank, 1, |i, _| turned[(i, 0)] / svd.S()[i]);
    let start = svd.V().subcols(0, rank) * short;
    let off = (&e * &start - &right).norm_max();
    if off > MET * right.norm_max() {
        return Err(SubspaceError::Constraints { count, rank, off: off / right.norm_max() });
    }
    Ok((start, svd.V().subcols(rank, unknowns - rank).to_owned()))
}

/// min ‖Y x − g‖ where Y has full column rank; `met` unknowns have their values from constraints.
fn determined(y: &Mat, g: &Mat, met: usize) -> Result<Mat, SubspaceError> {
    let unknowns = y.ncols();
    if unknowns == 0 {
        return Ok(Mat::zeros(0, 1));
    }
    let values =
        y.singular_values().map_err(|_| LinalgError::NoConvergence { what: "the SVD", order: unknowns })?;
    let largest = values.first().copied().unwrap_or(0.0);
    let rank = values.iter().filter(|s| **s > DEPENDENT * largest).count();
    if rank < unknowns {
        return Err(SubspaceError::MissingRank { unknowns: unknowns + met, rank: rank + met });
    }
    Ok(y.qr().solve_lstsq(g))
}
