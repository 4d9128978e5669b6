//! What the data of a Riccati equation must satisfy before anything is computed.

use super::super::dense::{LinalgError, Mat, check_finite, symmetric_eigenvalues};
use super::error::RiccatiError;

/// How much a symmetric matrix may differ from its transpose, over its largest entry: products like CᵀWC round to
/// some n ε, anything larger is a mistake.
const ASYMMETRY: f64 = 1e-12;
/// R counts as singular below this many n ε of smallest over largest eigenvalue.
const SINGULAR_EPSILONS: f64 = 10.0;

/// Refuses a wrong shape or entries that are not finite.
pub(super) fn check(name: &'static str, a: &Mat, expected: (usize, usize)) -> Result<(), RiccatiError> {
    let found = (a.nrows(), a.ncols());
    if found != expected {
        return Err(LinalgError::Shape { name, expected, found }.into());
    }
    Ok(check_finite(name, a)?)
}

/// The n × n symmetric matrix, its rounding averaged away; refuses what is not symmetric.
pub(super) fn symmetric(name: &'static str, a: &Mat, n: usize) -> Result<Mat, RiccatiError> {
    check(name, a, (n, n))?;
    let (mut worst, mut row, mut col, mut largest) = (0.0, 0, 0, 0.0f64);
    for j in 0..n {
        for i in 0..=j {
            let difference = (a[(i, j)] - a[(j, i)]).abs();
            largest = largest.max(a[(i, j)].abs());
            if difference > worst {
                (worst, row, col) = (difference, i, j);
            }
        }
    }
    if worst > ASYMMETRY * largest {
        return Err(RiccatiError::Asymmetric { name, row, col, difference: worst });
    }
    let mut even = a.clone();
    average(&mut even);
    Ok(even)
}

/// ‖A‖_F: a plain sum of squares where that neither overflows nor loses, else faer's.
pub(super) fn norm(a: &Mat) -> f64 {
    const SAFE: std::ops::Range<f64> = 1e-250..1e250;
    let mut lanes = [0.0; 4];
    for j in 0..a.ncols() {
        let quads = a.col_as_slice(j).chunks_exact(4);
        for (lane, v) in lanes.iter_mut().zip(quads.remainder()) {
            *lane += v * v;
        }
        for quad in quads {
            for (lane, v) in lanes.iter_mut().zip(quad) {
                *lane += v * v;
            }
        }
    }
    let sum: f64 = lanes.iter().sum();
    if SAFE.contains(&sum) { sum.sqrt() } else { a.norm_l2() }
}

/// A ← (A + Aᵀ)/2.
pub(super) fn average(a: &mut Mat) {
    for j in 0..a.ncols() {
        for i in 0..j {
            let mean = 0.5 * (a[(i, j)] + a[(j, i)]);
            (a[(i, j)], a[(j, i)]) = (mean, mean);
        }
    }
}

/// Smallest over largest eigenvalue of a symmetric matrix: 1 where it is empty, 0 where it is zero.
pub(super) struct Definiteness {
    /// The smallest eigenvalue.
    pub smallest: f64,
    /// Smallest over largest magnitude.
    pub ratio: f64,
    /// Whether the ratio tells the matrix from a singular one.
    pub definite: bool,
}

/// How definite a symmetric matrix is.
pub(super) fn definiteness(r: &Mat) -> Result<Definiteness, RiccatiError> {
    let m = r.nrows();
    let values = if m == 1 { vec![r[(0, 0)]] } else { symmetric_eigenvalues(r)? };
    let (Some(smallest), Some(last)) = (values.first().copied(), values.last().copied()) else {
        return Ok(Definiteness { smallest: 1.0, ratio: 1.0, definite: true });
    };
    let largest = smallest.abs().max(last.abs());
    let ratio = if largest == 0.0 { 0.0 } else { smallest / largest };
    Ok(Definiteness { smallest, ratio, definite: ratio > singular_below(m) })
}

/// Refuses an R with a negative eigenvalue.
pub(super) fn semidefinite(r: &Mat) -> Result<Definiteness, RiccatiError> {
    let found = definiteness(r)?;
    if found.ratio < -singular_below(r.nrows()) {
        return Err(RiccatiError::IndefiniteR { eigenvalue: found.smallest });
    }
    Ok(found)
}

fn singular_below(m: usize) -> f64 {
    SINGULAR_EPSILONS * m as f64 * f64::EPSILON
}
