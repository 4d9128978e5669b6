//! Standard deviations from the Fisher information, carried to the modes.

use super::model::{Layout, Model};
use crate::linalg::{C64, Mat};
use crate::lti::{Mode, ModeKind};

/// An eigenvalue of the Jacobi-scaled information below this is a direction that the data do not see: sums over
/// 10⁴ squares of relative size 1 leave 1e-12 at best.
const NULL: f64 = 1e-11;
/// Step in the logarithms of parameters for the derivatives of poles.
const STEP: f64 = 1e-4;

/// What remains between reported and actual standard deviations of the road's parameters, measured over 80 simulated
/// drives of 5 and 20 minutes (`examples/study_physical.rs`: 1.1 to 1.35 without it; the vehicle's are 0.7 to 1.2).
const ROAD_EMPIRICAL: f64 = 1.3;
/// Blocks from which the spread of gradients is believed.
const LEAST_BLOCKS: usize = 8;

/// The inverse of the information, with a factor for the vehicle's and one for the road's standard deviations.
pub(super) struct Covariance {
    inverse: Mat,
    null: Option<(f64, Vec<f64>)>,
    /// Factors of standard deviations, ≥ 1: of the vehicle's parameters, of the road's.
    pub factors: [f64; 2],
    vehicle: usize,
    noise: usize,
    delay: Option<usize>,
}

impl Covariance {
    pub fn new(fisher: &Mat, layout: &Layout) -> Self {
        let n = fisher.nrows();
        let d: Vec<f64> = (0..n).map(|i| fisher[(i, i)].max(f64::MIN_POSITIVE).sqrt()).collect();
        let scaled = Mat::from_fn(n, n, |i, j| fisher[(i, j)] / (d[i] * d[j]));
        let mut inverse = Mat::from_fn(n, n, |i, j| if i == j { f64::INFINITY } else { 0.0 });
        let mut null = None;
        if let Ok(e) = scaled.self_adjoint_eigen(faer::Side::Lower) {
            let (u, s) = (e.U(), e.S().column_vector());
            if s[0] < NULL {
                // back to equal steps of the logarithms
                let raw: Vec<f64> = (0..n).map(|i| u[(i, 0)] / d[i]).collect();
                let largest = raw.iter().fold(0.0f64, |a, b| a.max(b.abs()));
                null = Some((s[0], raw.iter().map(|r| r / largest).collect()));
            }
            inverse = Mat::from_fn(n, n, |i, j| {
                (0..n).map(|k| u[(i, k)] * u[(j, k)] / s[k].max(f64::EPSILON * 1e-2)).sum::<f64>()
                    / (d[i] * d[j])
            });
        }
        Covariance {
            inverse,
            null,
            factors: [1.0, ROAD_EMPIRICAL],
            vehicle: layout.vehicle,
            noise: layout.noise,
            delay: layout.delay,
        }
    }

    /// Widens the standard deviations to what the gradients' spread over blocks of the recording shows.
    ///
    /// With G the covariance of the mean gradient, F⁻¹GF⁻¹ is that of θ whatever the likelihood's own belief F⁻¹
    /// (White, *Econometrica* 50, 1982). A few dozen blocks give single variances to 20 % only, so the factor is common
    /// to a group of parameters: f² = tr(C_F⁻¹C)/p over the group's own blocks C_F of F⁻¹ and C of F⁻¹GF⁻¹, not below 1.
    /// `share` is the variance of the whole recording's gradient as a share of one block's.
    pub fn widen(&mut self, gradients: &[Vec<f64>], share: f64) {
        let b = gradients.len();
        if b < LEAST_BLOCKS || self.null.is_some() {
            return;
        }
        let n = self.inverse.nrows();
        let mean: Vec<f64> = (0..n).map(|a| gradients.iter().map(|g| g[a]).sum::<f64>() / b as f64).collect();
        let deviation = Mat::from_fn(n, b, |a, k| gradients[k][a] - mean[a]);
        let moved = &self.inverse * deviation;
        for (group, range) in [0..self.vehicle, self.vehicle..self.noise].into_iter().enumerate() {
            let size = range.len();
            let first = range.start;
            let own = Mat::from_fn(size, size, |i, j| self.inverse[(first + i, first + j)]);
            let part = Mat::from_fn(size, b, |i, k| moved[(first + i, k)]);
            let Ok(whitened) = crate::linalg::solve(&own, &part) else { continue };
            let mut trace = 0.0;
            for k in 0..b {
                for i in 0..size {
                    trace += part[(i, k)] * whitened[(i, k)];
                }
            }
            let ratio = share * trace / (b as f64 - 1.0) / size as f64;
            self.factors[group] *= ratio.max(1.0).sqrt();
        }
    }

    /// Standard deviation of parameter i of θ.
    pub fn sd(&self, i: usize) -> f64 {
        let factor = match i {
            i if i < self.vehicle => self.factors[0],
            // the phase that shows the delay has nothing to do with the road's level
            i if Some(i) == self.delay => 1.0,
            i if i < self.noise => self.factors[1],
            _ => 1.0,
        };
        factor * self.inverse[(i, i)].max(0.0).sqrt()
    }

    /// Correlation of parameters i and j of θ.
    pub fn correlation(&self, i: usize, j: usize) -> f64 {
        self.inverse[(i, j)] / (self.inverse[(i, i)] * self.inverse[(j, j)]).sqrt()
    }

    /// √(gᵀ F⁻¹ g) over the first parameters.
    fn sd_along(&self, g: &[f64]) -> f64 {
        let mut sum = 0.0;
        for i in 0..g.len() {
            for j in 0..g.len() {
                sum += g[i] * self.inverse[(i, j)] * g[j];
            }
        }
        self.factors[0] * sum.max(0.0).sqrt()
    }

    /// The smallest eigenvalue and its direction, where the information is singular.
    pub fn null_direction(&self) -> Option<(f64, Vec<f64>)> {
        self.null.clone()
    }
}

/// Modes at θ with the standard deviations of f in Hz and of ζ, by the derivatives of the poles.
pub(super) fn modes(
    model: &Model<'_>,
    theta: &[f64],
    covariance: &Covariance,
) -> Result<Vec<(Mode, f64, f64)>, String> {
    let poles = |theta: &[f64]| -> Result<Vec<Mode>, String> {
        crate::lti::modes(model.system(theta)?.system()).map_err(|e| e.to_string())
    };
    let base = poles(theta)?;
    let n = model.layout.vehicle;
    let mut by_f = vec![vec![0.0; n]; base.len()];
    let mut by_zeta = vec![vec![0.0; n]; base.len()];
    for p in 0..n {
        let mut moved = theta.to_vec();
        moved[p] = theta[p] + STEP;
        let up = poles(&moved)?;
        moved[p] = theta[p] - STEP;
        let down = poles(&moved)?;
        for (m, mode) in base.iter().enumerate() {
            let near = |set: &[Mode]| -> Mode {
                let distance = |o: &&Mode| -> f64 { (o.pole - mode.pole).norm() };
                set.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(mode).clone()
            };
            let (a, b) = (near(&up), near(&down));
            by_f[m][p] = (a.freq_hz - b.freq_hz) / (2.0 * STEP);
            by_zeta[m][p] = (a.damping - b.damping) / (2.0 * STEP);
        }
    }
    Ok(base
        .into_iter()
        .enumerate()
        .map(|(m, mode)| {
            // a real pole has no damping ratio to be uncertain of
            let zeta =
                if mode.kind == ModeKind::Oscillatory { covariance.sd_along(&by_zeta[m]) } else { 0.0 };
            let f: f64 = covariance.sd_along(&by_f[m]);
            debug_assert!(C64::norm(mode.pole) >= 0.0);
            (mode, f, zeta)
        })
        .collect())
}
