//! Welch's spectra of blocks of the recording, and the singular values and vectors of their mean.

use crate::identify::operational::OperationalError;
use crate::linalg::{C64, CMat, LinalgError};
use crate::signal::{HannWindow, averaged};
use rayon::prelude::*;

/// Blocks of segments: their number's root gives the standard deviation's own error.
const BLOCKS: usize = 24;
/// With fewer blocks no standard deviation is given.
pub(super) const FEWEST_BLOCKS: usize = 8;

/// Spectra of runs of segments.
pub(super) struct Blocks {
    /// Each run's mean spectra.
    spectra: Vec<Vec<CMat>>,
    /// Segments of each run.
    counts: Vec<usize>,
    /// Independent segments that a run is worth.
    pub averages_a_block: f64,
    /// Independent segments of all.
    pub averages: f64,
    /// Samples a segment.
    pub segment: usize,
    /// Samples per second.
    pub rate_hz: f64,
}

impl Blocks {
    /// Segments with Hann's window and 75 % overlap, in runs of nearly equal numbers.
    pub fn new(channels: &[Vec<f64>], rate_hz: f64, segment: usize) -> Self {
        let window = HannWindow::new(segment);
        let hop = (segment / 4).max(1);
        let samples = channels.first().map_or(0, Vec::len);
        let segments = (samples.saturating_sub(segment)) / hop + 1;
        let runs = BLOCKS.min(segments);
        let ends: Vec<usize> = (0..=runs).map(|b| b * segments / runs).collect();
        let spectra =
            ends.windows(2).map(|e| averaged(channels, rate_hz, &window, hop, e[0]..e[1])).collect();
        let counts: Vec<usize> = ends.windows(2).map(|e| e[1] - e[0]).collect();
        let typical = (segments / runs).max(1);
        let averages_a_block = window.independent_segments(typical, hop);
        let averages = window.independent_segments(segments, hop);
        Self { spectra, counts, averages_a_block, averages, segment, rate_hz }
    }

    /// How many runs.
    pub fn count(&self) -> usize {
        self.counts.len()
    }

    /// What runs whose ends overlap are to be multiplied by to scatter as independent ones: √(B K_block/K).
    pub fn overlap(&self) -> f64 {
        (self.count() as f64 * self.averages_a_block / self.averages).sqrt().max(1.0)
    }

    /// The runs' spectra at a bin.
    pub fn at(&self, bin: usize) -> impl Iterator<Item = &CMat> {
        self.spectra.iter().map(move |s| &s[bin])
    }

    /// The mean of all segments, or of all but one run's.
    pub fn mean(&self, without: Option<usize>) -> Mean<'_> {
        Mean { blocks: self, without }
    }
}

/// A mean of runs, at the bins that are asked for.
pub(super) struct Mean<'a> {
    blocks: &'a Blocks,
    without: Option<usize>,
}

impl Mean<'_> {
    /// The spectral matrix at a bin.
    pub fn at(&self, bin: usize) -> CMat {
        let used = || (0..self.blocks.count()).filter(|b| Some(*b) != self.without);
        let total: usize = used().map(|b| self.blocks.counts[b]).sum();
        let n = self.blocks.spectra[0][bin].nrows();
        let mut sum = CMat::zeros(n, n);
        for b in used() {
            let weight = self.blocks.counts[b] as f64 / total as f64;
            sum += &self.blocks.spectra[b][bin] * faer::Scale(C64::new(weight, 0.0));
        }
        sum
    }
}

/// Singular values and first vectors over the bins.
pub(super) struct Decomposition {
    /// Bins in Hz.
    pub freq_hz: Vec<f64>,
    /// One curve a value, the largest first.
    pub singular_values: Vec<Vec<f64>>,
    /// Independent segments.
    pub averages: f64,
    shapes: Vec<Vec<C64>>,
}

impl Decomposition {
    /// Of the mean at all bins.
    pub fn new(mean: &Mean<'_>, blocks: &Blocks) -> Result<Self, OperationalError> {
        let bins = blocks.segment / 2 + 1;
        let each: Vec<(Vec<f64>, Vec<C64>)> = (0..bins)
            .into_par_iter()
            .map(|k| {
                let s = mean.at(k);
                let n = s.nrows();
                let found = s.self_adjoint_eigen(faer::Side::Lower).map_err(|_| {
                    LinalgError::NoConvergence { what: "the Hermitian QR algorithm", order: n }
                })?;
                // ascending; S_ij = E[X_i* X_j] of one mode is φ* φᵀ, so its vector is the shape's conjugate
                let values = (0..n).rev().map(|i| found.S().column_vector()[i].re.max(0.0)).collect();
                Ok((values, (0..n).map(|i| found.U()[(i, n - 1)].conj()).collect()))
            })
            .collect::<Result<_, LinalgError>>()?;
        let n = each[0].0.len();
        let singular_values = (0..n).map(|i| each.iter().map(|e| e.0[i]).collect()).collect();
        let freq_hz = (0..bins).map(|k| k as f64 * blocks.rate_hz / blocks.segment as f64).collect();
        let shapes = each.into_iter().map(|e| e.1).collect();
        Ok(Self { freq_hz, singular_values, averages: blocks.averages, shapes })
    }

    /// σ₁ over the bins.
    pub fn first(&self) -> &[f64] {
        &self.singular_values[0]
    }

    /// u₁* at a bin: the shape, of norm one.
    pub fn shape(&self, bin: usize) -> &[C64] {
        &self.shapes[bin]
    }

    /// The criterion between the shapes at two bins.
    pub fn mac(&self, one: usize, other: usize) -> f64 {
        self.shapes[one].iter().zip(&self.shapes[other]).map(|(a, b)| a.conj() * b).sum::<C64>().norm_sqr()
    }
}
