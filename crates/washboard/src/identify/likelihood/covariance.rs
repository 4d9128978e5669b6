//! Covariances from the Fisher information, widened where the data scatter more than it believes.

use crate::linalg::Mat;

/// An eigenvalue of the Jacobi-scaled information below this is a direction that the data do not see: sums over
/// 10⁴ squares of relative size 1 leave 1e-12 at best.
const NULL: f64 = 1e-11;
/// Blocks from which the spread of gradients is believed.
const LEAST_BLOCKS: usize = 8;

/// Parameters whose standard deviations are widened together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Group {
    /// The vehicle's.
    Vehicle,
    /// Levels and shapes of roads.
    Road,
    /// Delays, clocks, noise: the information alone.
    Sure,
    /// Not free: known.
    Fixed,
}

/// The inverse of the information, with a factor for each group's standard deviations.
pub(crate) struct Covariance {
    inverse: Mat,
    null: Option<(f64, Vec<f64>)>,
    groups: Vec<Group>,
    /// Factors of standard deviations: of the vehicle's parameters, of the roads'.
    pub factors: [f64; 2],
}

impl Covariance {
    /// `empirical`: factors that remain between reported and actual standard deviations, as measured in studies.
    pub fn new(fisher: &Mat, groups: Vec<Group>, empirical: [f64; 2]) -> Self {
        let free: Vec<usize> = (0..groups.len()).filter(|i| groups[*i] != Group::Fixed).collect();
        let (n, all) = (free.len(), groups.len());
        let d: Vec<f64> = free.iter().map(|i| fisher[(*i, *i)].max(f64::MIN_POSITIVE).sqrt()).collect();
        let scaled = Mat::from_fn(n, n, |i, j| fisher[(free[i], free[j])] / (d[i] * d[j]));
        let mut inverse = Mat::zeros(all, all);
        free.iter().for_each(|i| inverse[(*i, *i)] = f64::INFINITY);
        let mut null = None;
        if let Ok(e) = scaled.self_adjoint_eigen(faer::Side::Lower) {
            let (u, s) = (e.U(), e.S().column_vector());
            if n > 0 && s[0] < NULL {
                // back to equal steps of the parameters
                let mut raw = vec![0.0; all];
                free.iter().enumerate().for_each(|(k, i)| raw[*i] = u[(k, 0)] / d[k]);
                let largest = raw.iter().fold(0.0f64, |a, b| a.max(b.abs()));
                null = Some((s[0], raw.iter().map(|r| r / largest).collect()));
            }
            let weighted = Mat::from_fn(n, n, |i, k| u[(i, k)] / s[k].max(f64::EPSILON * 1e-2).sqrt() / d[i]);
            let product = &weighted * weighted.transpose();
            for (a, i) in free.iter().enumerate() {
                for (b, j) in free.iter().enumerate() {
                    inverse[(*i, *j)] = product[(a, b)];
                }
            }
        }
        Covariance { inverse, null, groups, factors: empirical }
    }

    /// Widens the standard deviations to what the gradients' spread over blocks of the recordings shows.
    ///
    /// With G the covariance of the mean gradient, F⁻¹GF⁻¹ is that of θ whatever the likelihood's own belief F⁻¹
    /// (White, *Econometrica* 50, 1982). A few dozen blocks give single variances to 20 % only, so the factor is common
    /// to a group of parameters: f² = tr(C_F⁻¹C)/p over the group's own blocks C_F of F⁻¹ and C of F⁻¹GF⁻¹, not below 1.
    /// Each set is the gradients of one recording's blocks, and the variance of the whole recording's gradient as a share
    /// of one block's.
    pub fn widen(&mut self, sets: &[(Vec<Vec<f64>>, f64)]) {
        if self.null.is_some() || sets.iter().any(|(g, _)| g.len() < LEAST_BLOCKS) || sets.is_empty() {
            return;
        }
        let n = self.inverse.nrows();
        let mut columns: Vec<Vec<f64>> = Vec::new();
        for (gradients, share) in sets {
            let b = gradients.len() as f64;
            let mean: Vec<f64> = (0..n).map(|a| gradients.iter().map(|g| g[a]).sum::<f64>() / b).collect();
            let scale = (share / (b - 1.0)).sqrt();
            columns.extend(
                gradients.iter().map(|g| g.iter().zip(&mean).map(|(x, m)| scale * (x - m)).collect()),
            );
        }
        let moved = &self.inverse * Mat::from_fn(n, columns.len(), |a, k| columns[k][a]);
        for (factor, group) in [Group::Vehicle, Group::Road].into_iter().enumerate() {
            let own: Vec<usize> = (0..n).filter(|i| self.groups[*i] == group).collect();
            if own.is_empty() {
                continue;
            }
            let block = Mat::from_fn(own.len(), own.len(), |i, j| self.inverse[(own[i], own[j])]);
            let part = Mat::from_fn(own.len(), columns.len(), |i, k| moved[(own[i], k)]);
            let Ok(whitened) = crate::linalg::solve(&block, &part) else { continue };
            let mut trace = 0.0;
            for k in 0..columns.len() {
                for i in 0..own.len() {
                    trace += part[(i, k)] * whitened[(i, k)];
                }
            }
            self.factors[factor] *= (trace / own.len() as f64).max(1.0).sqrt();
        }
    }

    /// Standard deviation of parameter i.
    pub fn sd(&self, i: usize) -> f64 {
        let factor = match self.groups[i] {
            Group::Vehicle => self.factors[0],
            Group::Road => self.factors[1],
            Group::Sure | Group::Fixed => 1.0,
        };
        factor * self.inverse[(i, i)].max(0.0).sqrt()
    }

    /// Correlation of parameters i and j.
    pub fn correlation(&self, i: usize, j: usize) -> f64 {
        self.inverse[(i, j)] / (self.inverse[(i, i)] * self.inverse[(j, j)]).sqrt()
    }

    /// √(gᵀ F⁻¹ g) over the first parameters, which are the vehicle's.
    pub fn sd_along(&self, g: &[f64]) -> f64 {
        let mut sum = 0.0;
        for j in 0..g.len() {
            for i in 0..g.len() {
                sum += g[i] * self.inverse[(i, j)] * g[j];
            }
        }
        self.factors[0] * sum.max(0.0).sqrt()
    }

    /// The smallest eigenvalue and its direction, where the information is singular.
    pub fn null_direction(&self) -> Option<&(f64, Vec<f64>)> {
        self.null.as_ref()
    }
}
