//! Whittle's likelihood of spectra: its cost, its pull on the spectra, and the whitening that its information needs.

use super::spectra::{Spectra, pack, unpack};
use crate::linalg::small::{ZERO, cholesky, lower_inverse, product};
use crate::linalg::{C64, Mat};
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

/// L⁻¹ of S = L Lᴴ at each bin, row after row.
pub(crate) struct Whitening {
    n: usize,
    inverses: Vec<C64>,
    /// Σ_k ln|S|.
    log_det: f64,
}

impl Whitening {
    /// Factors all bins; None where S is not positive definite.
    pub fn new(model: &Spectra) -> Option<Self> {
        let n = model.order();
        let mut inverses = vec![ZERO; model.len() * n * n];
        let shares: Option<Vec<f64>> = inverses
            .par_chunks_exact_mut(n * n)
            .enumerate()
            .map_init(|| vec![ZERO; n * n], |l, (k, inverse)| factor(model.block(k), l, inverse, n))
            .collect();
        Some(Whitening { n, inverses, log_det: shares?.into_iter().sum() })
    }

    /// L⁻¹ at a bin.
    pub fn inverse(&self, bin: usize) -> &[C64] {
        &self.inverses[bin * self.n * self.n..(bin + 1) * self.n * self.n]
    }

    /// n_avg S⁻¹ D S⁻¹ at each bin: the pull of a change D of the measured spectra, with its sign turned.
    pub fn metric_pull(&self, change: &Spectra, averages: f64) -> Spectra {
        self.each(change, |inverse, m, scratch, out| {
            back(inverse, m, scratch, out, averages, self.n);
            0.0
        })
        .0
    }

    /// n_avg Σ_k (ln|S| + tr S⁻¹Ŝ), and n_avg S⁻¹(S − Ŝ)S⁻¹ at each bin, by which dS changes it: tr(pull dS).
    pub fn pulls(&self, measured: &Spectra, averages: f64) -> (f64, Spectra) {
        let n = self.n;
        let (pulls, traces) = self.each(measured, |inverse, m, scratch, out| {
            let trace = (0..n).map(|i| m[i * n + i].re).sum();
            m.iter_mut().for_each(|v| *v = -*v);
            (0..n).for_each(|i| m[i * n + i] += 1.0);
            back(inverse, m, scratch, out, averages, n);
            trace
        });
        (averages * (self.log_det + traces.iter().sum::<f64>()), pulls)
    }

    /// n_avg · mean |L⁻¹ŜL⁻ᴴ − I|² of every bin: χ is its mean.
    pub fn residuals(&self, measured: &Spectra, averages: f64) -> Vec<f64> {
        let n = self.n;
        let (_, shares) = self.each(measured, |_, m, _, _| {
            (0..n).for_each(|i| m[i * n + i] -= 1.0);
            averages * m.iter().map(|v| v.norm_sqr()).sum::<f64>() / (n * n) as f64
        });
        shares
    }

    /// Does something with L⁻¹ŜL⁻ᴴ of each bin: what it writes, and what it returns.
    fn each(
        &self,
        measured: &Spectra,
        of_bin: impl Fn(&[C64], &mut [C64], &mut [C64], &mut [f64]) -> f64 + Sync,
    ) -> (Spectra, Vec<f64>) {
        let n = self.n;
        let mut out = vec![0.0; measured.len() * n * n];
        let shares = out
            .par_chunks_exact_mut(n * n)
            .enumerate()
            .map_init(
                || (vec![ZERO; n * n], vec![ZERO; n * n]),
                |(m, scratch), (k, out)| {
                    let inverse = self.inverse(k);
                    unpack(measured.block(k), m, n);
                    // (L⁻¹Ŝ)ᴴ = ŜL⁻ᴴ
                    product(scratch, [n, n, n], |i, j| inverse[i * n + j], m);
                    let half = |i: usize, j: usize| scratch[j * n + i].conj();
                    for i in 0..n {
                        for j in 0..n {
                            m[i * n + j] = half(i, j);
                        }
                    }
                    product(scratch, [n, n, n], |i, j| inverse[i * n + j], m);
                    m.copy_from_slice(scratch);
                    of_bin(inverse, m, scratch, out)
                },
            )
            .collect();
        (Spectra::new(n, out), shares)
    }
}

/// n_avg Σ_k (ln|S| + tr S⁻¹Ŝ); None where S is not positive definite.
pub(crate) fn cost(model: &Spectra, measured: &Spectra, averages: f64) -> Option<f64> {
    let n = model.order();
    let empty = || (vec![ZERO; n * n], vec![ZERO; n * n], vec![ZERO; n]);
    let shares: Option<Vec<f64>> = (0..model.len())
        .into_par_iter()
        .map_init(empty, |(m, inverse, row), k| {
            let log_det = factor(model.block(k), m, inverse, n)?;
            unpack(measured.block(k), m, n);
            // tr S⁻¹Ŝ = tr L⁻¹ŜL⁻ᴴ
            let mut trace = 0.0;
            for (i, l) in inverse.chunks_exact(n).enumerate() {
                row.fill(ZERO);
                for (j, of) in m.chunks_exact(n).take(i + 1).enumerate() {
                    row[..=i].iter_mut().zip(of).for_each(|(r, v)| *r += l[j] * v);
                }
                trace += row[..=i].iter().zip(l).map(|(r, x)| r.re * x.re + r.im * x.im).sum::<f64>();
            }
            let cost = log_det + trace;
            cost.is_finite().then_some(cost)
        })
        .collect();
    Some(averages * shares?.into_iter().sum::<f64>())
}

/// The bins over which the information is summed, and the weight of each.
pub(crate) fn information_bins(count: usize) -> (Vec<usize>, f64) {
    let stride = (count / INFORMATION_BINS).max(1);
    let bins: Vec<usize> = (0..count).skip(stride / 2).step_by(stride).collect();
    let weight = count as f64 / bins.len() as f64;
    (bins, weight)
}

/// L⁻¹ and ln|S| of a bin.
fn factor(block: &[f64], l: &mut [C64], inverse: &mut [C64], n: usize) -> Option<f64> {
    unpack(block, l, n);
    if !cholesky(l, n) {
        return None;
    }
    lower_inverse(l, inverse, n);
    Some((0..n).map(|i| 2.0 * l[i * n + i].re.ln()).sum())
}

/// `factor` L⁻ᴴ M L⁻¹ of a Hermitian M.
fn back(inverse: &[C64], m: &mut [C64], scratch: &mut [C64], out: &mut [f64], factor: f64, n: usize) {
    product(scratch, [n, n, n], |i, j| m[i * n + j], inverse);
    product(m, [n, n, n], |i, j| inverse[j * n + i].conj(), scratch);
    pack(out, n, |i, j| m[i * n + j] * factor);
}
