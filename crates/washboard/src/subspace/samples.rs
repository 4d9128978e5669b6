//! Samples of a spectrum on the unit circle, with how noisy each is.

use super::SubspaceError;
use crate::linalg::{C64, CMat};
use std::f64::consts::PI;

/// S_k may differ from its conjugate transpose by this share of its largest entry.
const HERMITIAN: f64 = 1e-9;

/// How noisy samples are: R_k of the algorithm, up to a common factor.
#[derive(Debug, Clone, PartialEq)]
pub enum Weights {
    /// All alike, R_k = I.
    Equal,
    /// A variance for each sample, R_k = r_k I.
    Variances(Vec<f64>),
    /// A covariance for each sample, m × m, Hermitian and positive definite.
    Covariances(Vec<CMat>),
}

/// Hermitian m × m samples S_k at angles θ_k of the unit circle.
#[derive(Debug, Clone)]
pub struct Samples {
    theta: Vec<f64>,
    s: Vec<CMat>,
    weights: Weights,
}

impl Samples {
    /// Samples of a power spectrum.
    ///
    /// `theta_rad`: N distinct angles in \[0, π\], ascending. `s`: N Hermitian m × m matrices with diagonals that are not negative.
    ///
    /// # Errors
    /// Numbers that do not fit, angles out of range, unordered or repeated; entries that are not finite, matrices that are
    /// not Hermitian, negative diagonals; variances that are not positive, covariances that are not positive definite.
    pub fn new(theta_rad: Vec<f64>, s: Vec<CMat>, weights: Weights) -> Result<Self, SubspaceError> {
        let samples = Self::of_any_sign(theta_rad, s, weights)?;
        for (index, s) in samples.s.iter().enumerate() {
            if let Some(i) = (0..s.nrows()).find(|i| s[(*i, *i)].re < 0.0) {
                return Err(SubspaceError::Negative { index, value: s[(i, i)].re });
            }
        }
        Ok(samples)
    }

    /// Samples of a scalar power spectrum; as [`Samples::new`].
    ///
    /// # Errors
    /// As [`Samples::new`].
    pub fn scalar(theta_rad: Vec<f64>, s: &[f64], weights: Weights) -> Result<Self, SubspaceError> {
        Self::new(theta_rad, scalars(s), weights)
    }

    /// Samples of a power spectrum with complex noise added, (2.5) to the letter: they need be neither Hermitian nor positive.
    ///
    /// # Errors
    /// As [`Samples::new`], but for symmetry and signs.
    pub fn with_complex_noise(
        theta_rad: Vec<f64>,
        s: Vec<CMat>,
        weights: Weights,
    ) -> Result<Self, SubspaceError> {
        Self::checked(theta_rad, s, weights, square)
    }

    /// Samples of a function that is real or Hermitian on the circle but no power spectrum: of the real part of a transfer
    /// function.
    ///
    /// # Errors
    /// As [`Samples::new`], but for signs.
    pub fn of_any_sign(theta_rad: Vec<f64>, s: Vec<CMat>, weights: Weights) -> Result<Self, SubspaceError> {
        Self::checked(theta_rad, s, weights, hermitian)
    }

    fn checked(
        theta_rad: Vec<f64>,
        s: Vec<CMat>,
        weights: Weights,
        check: fn(&CMat, usize) -> Result<(), String>,
    ) -> Result<Self, SubspaceError> {
        let n = theta_rad.len();
        if s.len() != n {
            return Err(SubspaceError::Count { what: "samples", expected: n, found: s.len() });
        }
        let m = s.first().map_or(0, |s| s.nrows());
        if m == 0 {
            return Err(SubspaceError::Count { what: "samples", expected: 1, found: 0 });
        }
        for (index, value) in theta_rad.iter().enumerate() {
            if !(0.0..=PI).contains(value) {
                return Err(SubspaceError::Angle { index, value: *value });
            }
            if let Some(before) = index.checked_sub(1).map(|k| theta_rad[k])
                && *value <= before
            {
                return Err(SubspaceError::Order { index, before, value: *value });
            }
        }
        for (index, s) in s.iter().enumerate() {
            check(s, m).map_err(|why| SubspaceError::Sample { what: "sample", index, why })?;
        }
        match &weights {
            Weights::Equal => {}
            Weights::Variances(r) => {
                if r.len() != n {
                    return Err(SubspaceError::Count { what: "variances", expected: n, found: r.len() });
                }
                if let Some(index) = r.iter().position(|r| !(*r > 0.0 && r.is_finite())) {
                    let why = format!("{:e}, expected a finite number above 0", r[index]);
                    return Err(SubspaceError::Sample { what: "variance", index, why });
                }
            }
            Weights::Covariances(r) => {
                if r.len() != n {
                    return Err(SubspaceError::Count { what: "covariances", expected: n, found: r.len() });
                }
                for (index, r) in r.iter().enumerate() {
                    let singular = |_| "not positive definite".to_owned();
                    hermitian(r, m)
                        .and_then(|()| r.llt(faer::Side::Lower).map(|_| ()).map_err(singular))
                        .map_err(|why| SubspaceError::Sample { what: "covariance", index, why })?;
                }
            }
        }
        Ok(Samples { theta: theta_rad, s, weights })
    }

    /// N.
    #[must_use]
    pub fn count(&self) -> usize {
        self.theta.len()
    }

    /// m.
    #[must_use]
    pub fn size(&self) -> usize {
        self.s.first().map_or(0, |s| s.nrows())
    }

    /// θ_k, rad.
    #[must_use]
    pub fn theta_rad(&self) -> &[f64] {
        &self.theta
    }

    /// S_k.
    #[must_use]
    pub fn s(&self) -> &[CMat] {
        &self.s
    }

    /// R_k.
    #[must_use]
    pub fn weights(&self) -> &Weights {
        &self.weights
    }

    /// Columns of real and imaginary parts that are independent, over m: 2N, less one for each of θ = 0 and θ = π.
    pub(super) fn independent(&self) -> usize {
        let ends = self.theta.iter().filter(|t| **t == 0.0 || **t == PI).count();
        2 * self.count() - ends
    }
}

/// 1 × 1 matrices.
pub(super) fn scalars(s: &[f64]) -> Vec<CMat> {
    s.iter().map(|s| CMat::from_fn(1, 1, |_, _| C64::new(*s, 0.0))).collect()
}

/// Refuses another shape and entries that are not finite.
fn square(s: &CMat, m: usize) -> Result<(), String> {
    if s.nrows() != m || s.ncols() != m {
        return Err(format!("{} × {}, expected {m} × {m}", s.nrows(), s.ncols()));
    }
    if !s.norm_max().is_finite() {
        return Err("an entry that is not finite".into());
    }
    Ok(())
}

/// Refuses what is not Hermitian.
fn hermitian(s: &CMat, m: usize) -> Result<(), String> {
    square(s, m)?;
    let largest = s.norm_max();
    for i in 0..m {
        for j in 0..=i {
            let off = (s[(i, j)] - s[(j, i)].conj()).norm();
            if off > HERMITIAN * largest {
                return Err(format!(
                    "entries ({i}, {j}) and ({j}, {i}) are {off:.3e} from being conjugate, expected a Hermitian matrix"
                ));
            }
        }
    }
    Ok(())
}
