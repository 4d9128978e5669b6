//! Poles from the range of the observability matrix: eigenvalues of its shift, those inside the unit circle.

use super::range::Range;
use super::samples::Samples;
use super::{SubspaceError, Unpaired};
use crate::linalg::{C64, LinalgError, Mat, RealSchur, eigen, solve};

/// Above this condition of the observability matrix without its last block row a pole is at 0 or near it, and the shift is
/// taken in the bilinear plane.
const POLE_AT_ZERO: f64 = 1e8;
/// An eigenvalue this near to the circle is on it: a pole there is double (itself and its inverse), and rounding parts a
/// double one by its root (1e-12 where moments are used).
const ON_CIRCLE: f64 = 1e-6;
/// Stands for a pole at infinity, with an inverse.
const INFINITE: f64 = 1e100;
/// A pole on the circle is put inside by this share of its distance from the nearest sample: the density there changes by its
/// square, 1e-4.
const INSIDE: f64 = 1e-2;

/// The poles and C of order n from a range, eq. (2.84)–(2.87), and how many were moved.
pub(super) fn poles(
    range: &Range,
    samples: &Samples,
    p: usize,
    n: usize,
    unpaired: Unpaired,
) -> Result<(Mat, Mat, usize), SubspaceError> {
    let m = range.size;
    let observed = range.ku.subcols(0, 2 * n);
    let (down, up) = (observed.subrows(0, (p - 1) * m), observed.subrows(m, (p - 1) * m));
    // columns alike in size, so that the condition is that of the poles
    let scale: Vec<f64> = (0..2 * n).map(|j| observed.subcols(j, 1).norm_l2()).collect();
    let scaled = |x: faer::MatRef<'_, f64>| Mat::from_fn(x.nrows(), 2 * n, |i, j| x[(i, j)] / scale[j]);
    let (down, up, first) = (scaled(down), scaled(up), scaled(observed.subrows(0, m)));
    let values = down.singular_values().map_err(|_| svd(2 * n))?;
    let shift = if values.last().is_some_and(|least| POLE_AT_ZERO * least > values[0]) {
        Shift::plain(&down, &up)?
    } else {
        Shift::bilinear(&down, &up)?
    };
    let schur = RealSchur::new(&shift.matrix)?;
    let clear = |v: &C64| unpaired == Unpaired::Refuse || !((shift.pole(*v).norm() - 1.0).abs() < ON_CIRCLE);
    let all_clear = schur.eigenvalues().iter().all(clear);
    let (ordered, inside) = schur.reordered(|v| shift.size(v) < 1.0)?;
    let (t, q) = (&ordered.t, &ordered.q);
    if inside == n && all_clear {
        let block = t.submatrix(0, 0, n, n).to_owned();
        return Ok((shift.to_disk(&block)?, &first * q.subcols(0, n), 0));
    }
    match unpaired {
        Unpaired::Refuse => Err(SubspaceError::NoSplit { order: n, inside }),
        Unpaired::Fold => folded(&shift, &first, samples, n),
    }
}

fn svd(order: usize) -> LinalgError {
    LinalgError::NoConvergence { what: "the SVD", order }
}

/// The shift of the observability matrix: its eigenvalues are the poles and their inverses, or images of them.
struct Shift {
    matrix: Mat,
    bilinear: bool,
}

impl Shift {
    fn plain(down: &Mat, up: &Mat) -> Result<Self, LinalgError> {
        Ok(Self { matrix: least_squares(down, up), bilinear: false })
    }

    /// (λ − 1)/(λ + 1) in place of λ: finite for poles at 0 and their inverses.
    fn bilinear(down: &Mat, up: &Mat) -> Result<Self, LinalgError> {
        Ok(Self { matrix: least_squares(&(up + down), &(up - down)), bilinear: true })
    }

    /// Something below 1 inside the circle, above 1 outside.
    fn size(&self, value: C64) -> f64 {
        if self.bilinear { 1.0 + value.re } else { value.norm() }
    }

    /// The block as a matrix with the poles themselves.
    fn to_disk(&self, block: &Mat) -> Result<Mat, LinalgError> {
        if !self.bilinear {
            return Ok(block.clone());
        }
        let one = Mat::identity(block.nrows(), block.nrows());
        solve(&(&one - block), &(&one + block))
    }

    fn pole(&self, value: C64) -> C64 {
        let one = C64::new(1.0, 0.0);
        if !self.bilinear {
            return value;
        }
        // the mirror image of a pole at 0
        if value == one { C64::new(INFINITE, 0.0) } else { (one + value) / (one - value) }
    }
}

fn least_squares(a: &Mat, b: &Mat) -> Mat {
    use faer::linalg::solvers::SolveLstsq;
    a.qr().solve_lstsq(b)
}

/// A pole of Im z ≥ 0 with its column of C.
struct Pole {
    z: C64,
    c: Vec<C64>,
    real: bool,
}

/// The n eigenvalues that are smallest, those that are outside the circle mirrored and double ones on it taken once, inside,
/// as real blocks.
fn folded(
    shift: &Shift,
    first: &Mat,
    samples: &Samples,
    n: usize,
) -> Result<(Mat, Mat, usize), SubspaceError> {
    let (values, vectors) = eigen(&shift.matrix)?;
    let m = first.nrows();
    let mut upper: Vec<Pole> = (0..values.len())
        .filter(|k| values[*k].im >= 0.0)
        .map(|k| {
            let row = |i: usize| (0..vectors.nrows()).map(|j| vectors[(j, k)] * first[(i, j)]).sum();
            Pole { z: shift.pole(values[k]), c: (0..m).map(row).collect(), real: values[k].im == 0.0 }
        })
        .collect();
    // those inside first, slowest decay last; then those on the circle
    upper.sort_by(|x, y| x.z.norm().total_cmp(&y.z.norm()).then(x.z.arg().total_cmp(&y.z.arg())));
    let on = |pole: &Pole| (pole.z.norm() - 1.0).abs() < ON_CIRCLE;
    let (on_circle, mut all): (Vec<Pole>, Vec<Pole>) = upper.into_iter().partition(on);
    let single = once(on_circle, samples);
    let mut moved = single.len();
    let at = all.partition_point(|pole| pole.z.norm() < 1.0);
    all.splice(at..at, single);
    let (mut a, mut c) = (Mat::zeros(n, n), Mat::zeros(m, n));
    let mut at = 0;
    for mut pole in all {
        if at + if pole.real { 1 } else { 2 } > n {
            continue;
        }
        if pole.z.norm() > 1.0 {
            pole.z = C64::new(1.0, 0.0) / pole.z.conj();
            moved += 1;
        }
        let z = pole.z;
        a[(at, at)] = z.re;
        if pole.real {
            (0..m).for_each(|i| c[(i, at)] = pole.c[i].re);
            at += 1;
            continue;
        }
        (a[(at, at + 1)], a[(at + 1, at)], a[(at + 1, at + 1)]) = (z.im, -z.im, z.re);
        for (i, v) in pole.c.iter().enumerate() {
            (c[(i, at)], c[(i, at + 1)]) = (v.re, v.im);
        }
        at += 2;
    }
    if at < n {
        return Err(SubspaceError::NoSplit { order: n, inside: at });
    }
    Ok((a, c, moved.max(1)))
}

/// Double eigenvalues on the circle, one pole for each two of them, moved inside.
fn once(mut on_circle: Vec<Pole>, samples: &Samples) -> Vec<Pole> {
    on_circle.sort_by(|x, y| x.z.arg().abs().total_cmp(&y.z.arg().abs()));
    let near_axis = |pole: &Pole| pole.z.im.abs() < ON_CIRCLE;
    let mut kept: Vec<Pole> = Vec::new();
    let mut waiting: Option<Pole> = None;
    for mut pole in on_circle {
        if near_axis(&pole) && !pole.real {
            // z and its conjugate are the two
            pole.real = true;
            let largest = pole
                .c
                .iter()
                .copied()
                .fold(C64::new(0.0, 0.0), |l, v| if v.norm() > l.norm() { v } else { l });
            let turn = largest.conj() / largest.norm().max(f64::MIN_POSITIVE);
            pole.c.iter_mut().for_each(|v| *v *= turn);
            kept.push(pole);
            continue;
        }
        match waiting.take() {
            Some(first) if (first.z - pole.z).norm() < 4.0 * ON_CIRCLE => kept.push(first),
            _ => waiting = Some(pole),
        }
    }
    for pole in &mut kept {
        let angle = if pole.real && pole.z.re > 0.0 {
            0.0
        } else if pole.real {
            std::f64::consts::PI
        } else {
            pole.z.arg().abs()
        };
        let far =
            samples.theta_rad().iter().map(|t| (t - angle).abs()).filter(|d| *d > 0.0).fold(1.0, f64::min);
        pole.z = C64::from_polar(1.0 - INSIDE * far, angle);
    }
    kept
}
