//! Whittle's likelihood of spectra: its cost, its pull on the spectra, and the whitening that its information needs.

use crate::linalg::{C64, CMat, Mat};
use rayon::prelude::*;

/// The information is summed over every so manyth bin that about this many are left: it is smooth, and they tell as much.
const INFORMATION_BINS: usize = 130;

/// Cost, and what a step needs of it.
#[derive(Debug, Clone)]
pub(crate) struct Score {
    pub cost: f64,
    /// Gradient of the cost.
    pub gradient: Vec<f64>,
    /// Fisher information, expectation of the cost's Hessian.
    pub fisher: Mat,
}

/// A bin's share of the cost, L⁻¹ of S = L Lᴴ, and S⁻¹(S − Ŝ)S⁻¹, by which dS changes the cost: tr(pull dS).
pub(crate) struct Whitened {
    pub cost: f64,
    pub inverse: CMat,
    pub pull: CMat,
}

/// Whitens a bin; None where S is not positive definite.
pub(crate) fn whiten(s: &CMat, measured: &CMat) -> Option<Whitened> {
    let n = s.nrows();
    let inverse = inverse_factor(s)?;
    let log_det: f64 = (0..n).map(|i| -2.0 * inverse[(i, i)].re.ln()).sum();
    let m = &inverse * measured * inverse.adjoint();
    let trace: f64 = (0..n).map(|i| m[(i, i)].re).sum();
    let residual = CMat::from_fn(n, n, |i, j| C64::new(f64::from(u8::from(i == j)), 0.0) - m[(i, j)]);
    let pull = inverse.adjoint() * residual * &inverse;
    let cost = log_det + trace;
    cost.is_finite().then_some(Whitened { cost, inverse, pull })
}

/// All bins whitened.
pub(crate) fn whiten_all(model: &[CMat], measured: &[CMat]) -> Option<Vec<Whitened>> {
    model.par_iter().zip(measured).map(|(s, m)| whiten(s, m)).collect()
}

/// n_avg Σ_k (ln|S| + tr S⁻¹Ŝ); None where S is not positive definite.
pub(crate) fn cost(model: &[CMat], measured: &[CMat], averages: f64) -> Option<f64> {
    let of_bin = |(s, m): (&CMat, &CMat)| -> Option<f64> {
        let n = s.nrows();
        let factor = s.llt(faer::Side::Lower).ok()?;
        let l = factor.L();
        let log_det: f64 = (0..n).map(|i| 2.0 * l[(i, i)].re.ln()).sum();
        // tr S⁻¹Ŝ = tr L⁻¹ŜL⁻ᴴ
        let mut half = m.clone();
        l.solve_lower_triangular_in_place(half.as_mut());
        let mut whole = half.adjoint().to_owned();
        l.solve_lower_triangular_in_place(whole.as_mut());
        let cost = log_det + (0..n).map(|i| whole[(i, i)].re).sum::<f64>();
        cost.is_finite().then_some(cost)
    };
    let shares: Option<Vec<f64>> = model.par_iter().zip(measured).map(of_bin).collect();
    Some(averages * shares?.into_iter().sum::<f64>())
}

/// n_avg · mean |L⁻¹ŜL⁻ᴴ − I|² of every bin: χ is its mean.
pub(crate) fn residuals(model: &[CMat], measured: &[CMat], averages: f64) -> Option<Vec<f64>> {
    let of_bin = |(s, m): (&CMat, &CMat)| -> Option<f64> {
        let n = s.nrows();
        let inverse = inverse_factor(s)?;
        let r = &inverse * m * inverse.adjoint() - CMat::identity(n, n);
        Some(averages * r.squared_norm_l2() / (n * n) as f64)
    };
    model.iter().zip(measured).map(of_bin).collect()
}

/// n_avg S⁻¹ D S⁻¹ at each bin: the pull of a change D of the measured spectra, with its sign turned.
pub(crate) fn metric_pull(model: &[CMat], change: &[CMat], averages: f64) -> Option<Vec<CMat>> {
    model
        .iter()
        .zip(change)
        .map(|(s, d)| {
            let inverse = inverse_factor(s)?;
            let si = inverse.adjoint() * &inverse;
            let g = &si * d * &si;
            Some(CMat::from_fn(g.nrows(), g.ncols(), |i, j| g[(i, j)] * averages))
        })
        .collect()
}

/// The bins over which the information is summed, and the weight of each.
pub(crate) fn information_bins(count: usize) -> (Vec<usize>, f64) {
    let stride = (count / INFORMATION_BINS).max(1);
    let bins: Vec<usize> = (0..count).skip(stride / 2).step_by(stride).collect();
    let weight = count as f64 / bins.len() as f64;
    (bins, weight)
}

/// L⁻¹ of S = L Lᴴ.
pub(crate) fn inverse_factor(s: &CMat) -> Option<CMat> {
    let n = s.nrows();
    let factor = s.llt(faer::Side::Lower).ok()?;
    let mut inverse = CMat::identity(n, n);
    factor.L().solve_lower_triangular_in_place(inverse.as_mut());
    Some(inverse)
}
