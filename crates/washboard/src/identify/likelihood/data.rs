//! Measured spectra as the likelihood sees them: a band of bins, channels scaled to a mean density of 1.

use super::{FitError, Spectra};
use crate::linalg::{C64, CMat, solve_complex};
use crate::signal::CrossSpectra;
use crate::units::rad_per_s;
use rayon::prelude::*;

/// This much (of channels scaled to a mean density of 1) is added to the measured spectra's diagonals and is the least of
/// the model's floors: two tracks give spectra of rank two, and without any noise the rest is leakage that no model
/// knows. Sensors that are 0.7 % noisy at 200 Hz have as much of their own.
pub(crate) const LEAST_NOISE: f64 = 1e-5;
/// Bins that the band must have.
const LEAST_BINS: usize = 12;
/// Noise floors start from the median of these frequencies, Hz.
const NOISE_BAND_HZ: [f64; 2] = [0.5, 40.0];

/// The band of a fit.
pub(crate) struct BandData {
    /// Index of the first bin.
    pub first: usize,
    /// Bins in rad/s.
    pub omega: Vec<f64>,
    /// Distance of bins, rad/s.
    pub step: f64,
    /// Scaled spectra.
    pub measured: Spectra,
    /// S = scaled · scaleᵢ scaleⱼ.
    pub scale: Vec<f64>,
    /// Averages that a likelihood over all bins may count.
    pub averages: f64,
    /// |W|² on half bins, −7 … 7.
    pub kernel: Vec<f64>,
    /// Starting noise floors, scaled.
    pub noise: Vec<f64>,
}

impl BandData {
    pub fn new(spectra: &CrossSpectra, band_hz: [f64; 2]) -> Result<Self, FitError> {
        let n = spectra.channels.len();
        // bins 0 and 1 are lowered by the removal of means
        let inside = |k: &usize| *k >= 2 && (band_hz[0]..=band_hz[1]).contains(&spectra.freq_hz[*k]);
        let bins: Vec<usize> = (0..spectra.freq_hz.len()).filter(inside).collect();
        if bins.len() < LEAST_BINS {
            return Err(FitError::FewBins { band_hz, bins: bins.len(), least: LEAST_BINS });
        }
        if spectra.averages < 2.0 * n as f64 {
            return Err(FitError::FewAverages { averages: spectra.averages, channels: n });
        }
        let mean = |i: usize| bins.iter().map(|k| spectra.s[*k][(i, i)].re).sum::<f64>() / bins.len() as f64;
        let scale: Vec<f64> = (0..n).map(|i| mean(i).sqrt()).collect();
        if let Some(i) = scale.iter().position(|s| !(*s > 0.0 && s.is_finite())) {
            return Err(FitError::DeadChannel { channel: spectra.channels[i].clone() });
        }
        let scaled = |k: usize| loaded(&spectra.s[k], &scale);
        Ok(BandData {
            first: bins[0],
            omega: bins.iter().map(|k| spectra.omega_rad_s[*k]).collect(),
            step: rad_per_s(spectra.resolution_hz()),
            measured: Spectra::of(n, bins.iter().map(|k| scaled(*k))),
            noise: noise_floors(spectra, &scaled, n),
            scale,
            averages: spectra.likelihood_averages(),
            kernel: spectra.kernel(),
        })
    }
}

/// Scaled, and never without any noise.
fn loaded(s: &CMat, scale: &[f64]) -> CMat {
    CMat::from_fn(s.nrows(), s.ncols(), |i, j| {
        let least = if i == j { LEAST_NOISE } else { 0.0 };
        s[(i, j)] / (scale[i] * scale[j]) + C64::new(least, 0.0)
    })
}

impl BandData {
    /// The same bins of another estimate of the same channels, scaled alike.
    pub fn scaled(&self, spectra: &CrossSpectra) -> Spectra {
        let bins = self.first..self.first + self.omega.len();
        Spectra::of(self.scale.len(), bins.map(|k| loaded(&spectra.s[k], &self.scale)))
    }

    /// The first and the last half bin that the window reaches from the band, mirrored at zero.
    pub fn grid(&self) -> [usize; 2] {
        let half = self.kernel.len() / 2;
        let last = 2 * (self.first + self.omega.len() - 1) + half;
        [(2 * self.first).saturating_sub(half) * usize::from(2 * self.first >= half), last]
    }

    /// ω of half bin `index`.
    pub fn half_omega(&self, index: usize) -> f64 {
        0.5 * self.step * index as f64
    }

    /// Place in the grid of the middle of a bin.
    pub fn middle(&self, bin: usize) -> usize {
        2 * (self.first + bin) - self.grid()[0]
    }

    /// Spectra on the grid seen through the window at every bin, with noise: S(−ω) = S(ω)*.
    pub fn convolve(&self, grid: &Spectra, noise: &[f64]) -> Spectra {
        let (n, half, from) = (grid.order(), self.kernel.len() as i64 / 2, self.grid()[0]);
        let mut bins = vec![0.0; self.omega.len() * n * n];
        bins.par_chunks_exact_mut(n * n).enumerate().for_each(|(bin, sum)| {
            let middle = 2 * (self.first + bin) as i64;
            for (offset, weight) in self.kernel.iter().enumerate() {
                let index = middle + offset as i64 - half;
                add(sum, grid.block(index.unsigned_abs() as usize - from), *weight, index < 0, n);
            }
            noise.iter().enumerate().for_each(|(i, v)| sum[i * n + i] += v);
        });
        Spectra::new(n, bins)
    }

    /// The adjoint of [`BandData::convolve`] at one place of the grid:
    /// Σ_bins Re⟨G, W * S⟩ = Σ_grid Re⟨W' G, S⟩ for ⟨G, S⟩ = tr(G S).
    pub fn spread(&self, bins: &Spectra, place: usize, sum: &mut [f64]) {
        sum.fill(0.0);
        let (n, half) = (bins.order(), self.kernel.len() as i64 / 2);
        let index = (self.grid()[0] + place) as i64;
        let mut gather = |index: i64, mirrored: bool| {
            // bins whose middle is at most half a kernel away, middles being two half bins apart
            let lowest = (index - half + 1).div_euclid(2).max(self.first as i64);
            let highest = (index + half).div_euclid(2).min((self.first + self.omega.len()) as i64 - 1);
            for bin in lowest..=highest {
                let weight = self.kernel[(index - 2 * bin + half) as usize];
                add(sum, bins.block(bin as usize - self.first), weight, mirrored, n);
            }
        };
        gather(index, false);
        if index > 0 {
            gather(-index, true);
        }
    }
}

/// Adds a weighted block, or its conjugate.
fn add(sum: &mut [f64], block: &[f64], weight: f64, mirrored: bool, n: usize) {
    sum.iter_mut().zip(block).for_each(|(s, v)| *s += weight * v);
    if mirrored {
        for i in 0..n {
            (0..i).for_each(|j| sum[i * n + j] -= 2.0 * weight * block[i * n + j]);
        }
    }
}

/// Median over frequency of 1/[Ŝ⁻¹]ᵢᵢ, what the other channels cannot explain, freed of its bias K/(K − n + 1).
fn noise_floors(spectra: &CrossSpectra, scaled: &dyn Fn(usize) -> CMat, n: usize) -> Vec<f64> {
    let k = spectra.averages;
    let bias = k / (k - n as f64 + 1.0);
    let mut unexplained: Vec<Vec<f64>> = vec![Vec::new(); n];
    for (bin, f) in spectra.freq_hz.iter().enumerate() {
        if !(NOISE_BAND_HZ[0]..=NOISE_BAND_HZ[1]).contains(f) {
            continue;
        }
        if let Ok(inverse) = solve_complex(&scaled(bin), &CMat::identity(n, n)) {
            for (i, values) in unexplained.iter_mut().enumerate() {
                let v: C64 = inverse[(i, i)];
                if v.re > 0.0 {
                    values.push(bias / v.re);
                }
            }
        }
    }
    unexplained
        .into_iter()
        .map(|mut v| {
            v.sort_by(f64::total_cmp);
            v.get(v.len() / 2).copied().unwrap_or(1e-3).max(LEAST_NOISE)
        })
        .collect()
}
