//! Measured spectra as the likelihood sees them: a band of bins, channels scaled to a mean density of 1.

use super::PhysicalError;
use super::model::LEAST_NOISE;
use crate::linalg::{C64, CMat, solve_complex};
use crate::signal::CrossSpectra;
use crate::units::rad_per_s;

/// Bins that the band must have.
const LEAST_BINS: usize = 12;
/// Noise floors start from the median of these frequencies, Hz.
const NOISE_BAND_HZ: [f64; 2] = [0.5, 40.0];

/// The band of a fit.
pub(super) struct BandData {
    /// Index of the first bin.
    pub first: usize,
    /// Bins in rad/s.
    pub omega: Vec<f64>,
    /// Distance of bins, rad/s.
    pub step: f64,
    /// Scaled spectra.
    pub measured: Vec<CMat>,
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
    pub fn new(spectra: &CrossSpectra, band_hz: [f64; 2]) -> Result<Self, PhysicalError> {
        let n = spectra.channels.len();
        // bins 0 and 1 are lowered by the removal of means
        let inside = |k: &usize| *k >= 2 && (band_hz[0]..=band_hz[1]).contains(&spectra.freq_hz[*k]);
        let bins: Vec<usize> = (0..spectra.freq_hz.len()).filter(inside).collect();
        if bins.len() < LEAST_BINS {
            return Err(PhysicalError::FewBins { band_hz, bins: bins.len(), least: LEAST_BINS });
        }
        if spectra.averages < 2.0 * n as f64 {
            return Err(PhysicalError::FewAverages { averages: spectra.averages, channels: n });
        }
        let mean = |i: usize| bins.iter().map(|k| spectra.s[*k][(i, i)].re).sum::<f64>() / bins.len() as f64;
        let scale: Vec<f64> = (0..n).map(|i| mean(i).sqrt()).collect();
        if let Some(i) = scale.iter().position(|s| !(*s > 0.0 && s.is_finite())) {
            return Err(PhysicalError::DeadChannel { channel: spectra.channels[i].clone() });
        }
        let scaled = |k: usize| loaded(&spectra.s[k], &scale);
        Ok(BandData {
            first: bins[0],
            omega: bins.iter().map(|k| spectra.omega_rad_s[*k]).collect(),
            step: rad_per_s(spectra.resolution_hz()),
            measured: bins.iter().map(|k| scaled(*k)).collect(),
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
    pub fn scaled(&self, spectra: &CrossSpectra) -> Vec<CMat> {
        (self.first..self.first + self.omega.len()).map(|k| loaded(&spectra.s[k], &self.scale)).collect()
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
