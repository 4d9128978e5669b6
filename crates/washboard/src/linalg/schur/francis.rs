//! Householder reduction to Hessenberg form and Francis's double-shift QR iteration on it.

use super::block::standardise;
use super::flat::Flat;
use super::{LinalgError, Mat};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::evd::hessenberg::{hessenberg_in_place, hessenberg_in_place_scratch};
use faer::linalg::householder::{
    apply_block_householder_sequence_on_the_right_in_place_scratch as apply_scratch,
    apply_block_householder_sequence_on_the_right_in_place_with_conj,
};
use faer::{Conj, Par};

/// Householder block: faer's own for these sizes.
const BLOCK: usize = 16;

/// Q and H with A = Q H Qᵀ, H upper Hessenberg.
pub(super) fn hessenberg(a: &Mat) -> (Mat, Mat) {
    let mut q = Mat::identity(a.nrows(), a.nrows());
    let h = reduced(a, Some(&mut q));
    (q, h)
}

/// H of A = Q H Qᵀ, and an identity turned into Q where one is given.
fn reduced(a: &Mat, q: Option<&mut Mat>) -> Mat {
    let n = a.nrows();
    let mut h = a.clone();
    if n < 3 {
        return h;
    }
    let block = BLOCK.min(n - 1);
    let mut factors = Mat::zeros(block, n - 1);
    let memory = hessenberg_in_place_scratch::<f64>(n, block, Par::Seq, Default::default());
    let memory = memory.or(apply_scratch::<f64>(n - 1, block, n - 1));
    let mut memory = MemBuffer::new(memory);
    let stack = MemStack::new(&mut memory);
    hessenberg_in_place(h.as_mut(), factors.as_mut(), Par::Seq, stack, Default::default());
    if let Some(q) = q {
        apply_block_householder_sequence_on_the_right_in_place_with_conj(
            h.submatrix(1, 0, n - 1, n - 1),
            factors.as_ref(),
            Conj::No,
            q.submatrix_mut(1, 1, n - 1, n - 1),
            Par::Seq,
            stack,
        );
    }
    for j in 0..n {
        h.col_as_slice_mut(j)[(j + 2).min(n)..].fill(0.0);
    }
    h
}

/// Overwrites x by v, v₀ = 1, such that (I − τ v vᵀ) x = β e₁; τ = 0 where x already has that form.
pub(super) fn reflector(x: &mut [f64]) -> (f64, f64) {
    let scale = x.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    let alpha = x[0];
    let tail = x[1..].iter().map(|v| (v / scale) * (v / scale)).sum::<f64>();
    if x[1..].iter().all(|v| *v == 0.0) {
        x[0] = 1.0;
        return (alpha, 0.0);
    }
    let norm = scale * ((alpha / scale) * (alpha / scale) + tail).sqrt();
    let beta = -norm.copysign(alpha);
    let pivot = alpha - beta;
    x[0] = 1.0;
    for v in &mut x[1..] {
        *v /= pivot;
    }
    (beta, -pivot / beta)
}

/// Rows `at..at + v.len()` of a, columns `from..`, times I − τ v vᵀ from the left.
pub(super) fn reflect_rows(a: &mut Mat, v: &[f64], tau: f64, at: usize, from: usize) {
    for col in from..a.ncols() {
        let dot: f64 = v.iter().enumerate().map(|(i, v)| v * a[(at + i, col)]).sum();
        for (i, v) in v.iter().enumerate() {
            a[(at + i, col)] -= tau * dot * v;
        }
    }
}

/// Columns `at..at + v.len()` of a, rows `..to`, times I − τ v vᵀ from the right.
pub(super) fn reflect_cols(a: &mut Mat, v: &[f64], tau: f64, at: usize, to: usize) {
    for row in 0..to {
        let dot: f64 = v.iter().enumerate().map(|(j, v)| v * a[(row, at + j)]).sum();
        for (j, v) in v.iter().enumerate() {
            a[(row, at + j)] -= tau * dot * v;
        }
    }
}

/// Brings the Hessenberg matrix H to real Schur form, and carries every step into Q.
pub(super) fn iterate(q: Mat, h: Mat) -> Result<(Mat, Mat), LinalgError> {
    let (mut q, mut h) = (Flat::from(&q), Flat::from(&h));
    deflate_all(Some(&mut q), &mut h)?;
    Ok((q.into_mat(), h.into_mat()))
}

/// The diagonal blocks of A's Schur form alone, in a matrix whose other entries mean nothing: no step is carried
/// beyond the active block, a third of the work.
pub(super) fn diagonal_blocks(a: &Mat) -> Result<Mat, LinalgError> {
    diagonal_blocks_of_hessenberg(&reduced(a, None))
}

/// The same of a Hessenberg matrix.
pub(super) fn diagonal_blocks_of_hessenberg(h: &Mat) -> Result<Mat, LinalgError> {
    let mut h = Flat::from(h);
    deflate_all(None, &mut h)?;
    Ok(h.into_mat())
}

/// The iteration on a Hessenberg matrix; without a Q the blocks of the result only.
fn deflate_all(mut q: Option<&mut Flat>, h: &mut Flat) -> Result<(), LinalgError> {
    const SWEEPS_PER_EIGENVALUE: usize = 30; // LAPACK's limit; three are usual
    const EXCEPTIONAL: usize = 10; // an exceptional shift after so many sweeps without deflation
    let n = h.order();
    let limit = SWEEPS_PER_EIGENVALUE * n.max(10);
    let (mut end, mut stuck, mut total) = (n, 0usize, 0usize);
    // h[..end] is still to be done; the active block is start..end
    while end > 0 {
        let start = deflate(h, end);
        if start + 1 == end {
            (end, stuck) = (start, 0);
            continue;
        }
        if start + 2 == end {
            standardise_at(q.as_deref_mut(), h, start);
            (end, stuck) = (start, 0);
            continue;
        }
        if total >= limit {
            return Err(LinalgError::NoConvergence { what: "the real Schur iteration", order: n });
        }
        total += 1;
        stuck += 1;
        let last = end - 1;
        let shifts = if stuck % (2 * EXCEPTIONAL) == 0 {
            exceptional(h[(last, last)], h[(last, last - 1)].abs() + h[(last - 1, last - 2)].abs())
        } else if stuck % EXCEPTIONAL == 0 {
            let s = h[(start + 1, start)].abs() + h[(start + 2, start + 1)].abs();
            exceptional(h[(start, start)], s)
        } else {
            Shifts::of(h[(last - 1, last - 1)], h[(last - 1, last)], h[(last, last - 1)], h[(last, last)])
        };
        sweep(q.as_deref_mut(), h, start, end, &shifts);
    }
    Ok(())
}

/// Standardises the block of H at (k, k) and carries the rotation through H and Q.
fn standardise_at(q: Option<&mut Flat>, h: &mut Flat, k: usize) {
    let ([a, b, c, d], turn) = standardise(h[(k, k)], h[(k, k + 1)], h[(k + 1, k)], h[(k + 1, k + 1)]);
    if let Some(q) = q {
        h.rotate_rows(turn, k, k + 2);
        h.rotate_cols(turn, k, k);
        let n = q.order();
        q.rotate_cols(turn, k, n);
    }
    (h[(k, k)], h[(k, k + 1)], h[(k + 1, k)], h[(k + 1, k + 1)]) = (a, b, c, d);
}

/// Sets the lowest negligible subdiagonal entry above `end` to zero and returns the first row of the active block.
fn deflate(h: &mut Flat, end: usize) -> usize {
    let small = f64::MIN_POSITIVE * (h.order() as f64 / f64::EPSILON);
    for k in (1..end).rev() {
        let sub = h[(k, k - 1)].abs();
        if sub <= small {
            h[(k, k - 1)] = 0.0;
            return k;
        }
        let mut size = h[(k - 1, k - 1)].abs() + h[(k, k)].abs();
        if size == 0.0 {
            if k >= 2 {
                size += h[(k - 1, k - 2)].abs();
            }
            if k + 1 < end {
                size += h[(k + 1, k)].abs();
            }
        }
        if sub <= f64::EPSILON * size {
            // Ahues and Tisseur: what is dropped must not move an eigenvalue of a graded matrix
            let up = h[(k - 1, k)].abs();
            let (ab, ba) = (sub.max(up), sub.min(up));
            let (here, gap) = (h[(k, k)].abs(), (h[(k - 1, k - 1)] - h[(k, k)]).abs());
            let (aa, bb) = (here.max(gap), here.min(gap));
            let s = aa + ab;
            if ba * (ab / s) <= small.max(f64::EPSILON * (bb * (aa / s))) {
                h[(k, k - 1)] = 0.0;
                return k;
            }
        }
    }
    0
}

/// Two shifts: a conjugate pair, or one real shift twice.
struct Shifts {
    re: [f64; 2],
    im: [f64; 2],
}

impl Shifts {
    /// The eigenvalues of a 2 × 2 block; of two real ones the nearer to the last entry, twice.
    fn of(h11: f64, h12: f64, h21: f64, h22: f64) -> Self {
        let s = h11.abs() + h12.abs() + h21.abs() + h22.abs();
        if s == 0.0 {
            return Self { re: [0.0; 2], im: [0.0; 2] };
        }
        let (h11, h12, h21, h22) = (h11 / s, h12 / s, h21 / s, h22 / s);
        let mean = 0.5 * (h11 + h22);
        let det = (h11 - mean) * (h22 - mean) - h12 * h21;
        let root = det.abs().sqrt();
        if det >= 0.0 {
            Self { re: [mean * s; 2], im: [root * s, -root * s] }
        } else {
            let (one, other) = (mean + root, mean - root);
            let near = if (one - h22).abs() <= (other - h22).abs() { one } else { other };
            Self { re: [near * s; 2], im: [0.0; 2] }
        }
    }
}

fn exceptional(corner: f64, s: f64) -> Shifts {
    let h11 = 0.75 * s + corner;
    Shifts::of(h11, -0.4375 * s, s, h11)
}

/// One implicit double-shift QR sweep over the active block.
fn sweep(mut q: Option<&mut Flat>, h: &mut Flat, start: usize, end: usize, shifts: &Shifts) {
    let n = h.order();
    let ([r1, r2], [i1, i2]) = (shifts.re, shifts.im);
    // start lower where two consecutive subdiagonal entries are small
    let mut at = end - 3;
    let mut v = [0.0; 3];
    loop {
        let (h00, below) = (h[(at, at)], h[(at + 1, at)]);
        let s = (h00 - r2).abs() + i2.abs() + below.abs();
        let b = below / s;
        v = if s == 0.0 {
            v
        } else {
            [
                b * h[(at, at + 1)] + (h00 - r1) * ((h00 - r2) / s) - i1 * (i2 / s),
                b * (h00 + h[(at + 1, at + 1)] - r1 - r2),
                b * h[(at + 2, at + 1)],
            ]
        };
        let s = v.iter().map(|x| x.abs()).sum::<f64>();
        if s > 0.0 {
            v = v.map(|x| x / s);
        }
        if at == start {
            break;
        }
        let size = h[(at - 1, at - 1)].abs() + h00.abs() + h[(at + 1, at + 1)].abs();
        if h[(at, at - 1)].abs() * (v[1].abs() + v[2].abs()) <= f64::EPSILON * v[0].abs() * size {
            break;
        }
        at -= 1;
    }
    let (first, last) = if q.is_some() { (0, n) } else { (start, end) };
    for k in at..end - 1 {
        let rows = 3.min(end - k);
        if k > at {
            for (i, x) in v.iter_mut().enumerate().take(rows) {
                *x = h[(k + i, k - 1)];
            }
        }
        let (beta, tau) = reflector(&mut v[..rows]);
        if k > at {
            h[(k, k - 1)] = beta;
            for i in 1..rows {
                h[(k + i, k - 1)] = 0.0;
            }
        } else if at > start {
            h[(k, k - 1)] *= 1.0 - tau;
        }
        h.reflect_rows(&v[..rows], tau, k, last);
        h.reflect_cols(&v[..rows], tau, k, first..(k + 4).min(end));
        if let Some(q) = &mut q {
            q.reflect_cols(&v[..rows], tau, k, 0..n);
        }
    }
}
