//! How near a fitted matrix comes to its cross-spectra: a trace knows nothing of the delays between points.

use super::identify_outcome::Flag;
use super::road_fit_filter::RoadFilter;
use crate::linalg::{C64, CMat};
use crate::subspace::SubspaceError;
use serde::{Deserialize, Serialize};

/// Pairs whose coherence is above this have a phase.
const COHERENT: f64 = 0.3;
/// Noisy samples are averaged with their neighbours to this many averages: .13 rad of phase at that coherence is one deviation.
const ENOUGH: f64 = 60.0;
/// A phase further off than this is told, degrees: a half-car's pitch is off by a quarter.
const OFF_DEG: f64 = 30.0;
/// The same of the relative error's root mean square.
const OFF: f64 = 0.3;

/// Errors of the cross-spectra, over samples and pairs whose coherence γ² = |S_ij|²/(S_ii S_jj) is above .3.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CrossError {
    /// How many there are.
    pub count: usize,
    /// Root mean square of |P_ij − S_ij|/√(S_ii S_jj) of fitted P and given S.
    pub rms: f64,
    /// The largest |arg P_ij/S_ij|, degrees.
    pub phase_deg: f64,
    /// Where, in the unit of the frequencies.
    pub phase_at_rad: f64,
    /// Of which channels, from 1.
    pub phase_pair: [usize; 2],
    /// The lowest frequency at which a phase is off by more than 30 degrees.
    pub off_from_rad: Option<f64>,
    /// Of which channels, from 1.
    pub off_pair: Option<[usize; 2]>,
    /// Neighbouring samples, weighted by the fit's conjugate phase, that each number is the mean of: 1 of exact data.
    pub samples_averaged: usize,
}

impl CrossError {
    /// None of one channel, or where nothing is coherent. `averages` are those that noisy samples are worth.
    ///
    /// # Errors
    /// A filter with a pole at a sample.
    pub(super) fn of(
        filter: &RoadFilter,
        omega: &[f64],
        s: &[CMat],
        averages: Option<f64>,
    ) -> Result<Option<Self>, SubspaceError> {
        let m = filter.system.outputs();
        let mut fitted = Vec::with_capacity(omega.len());
        for w in omega {
            let h = filter.system.at(C64::new(0.0, *w))?;
            fitted.push(&h * h.adjoint());
        }
        let either_side =
            averages.map_or(0, |k| (0.5 * (ENOUGH / k.max(1.0) - 1.0)).ceil().max(0.0) as usize);
        let mut found: Option<Self> = None;
        let mut squares = 0.0;
        for k in 0..omega.len() {
            let near = k.saturating_sub(either_side)..(k + either_side + 1).min(omega.len());
            for (i, j) in (0..m).flat_map(|i| (i + 1..m).map(move |j| (i, j))) {
                let [mut given, mut off] = [C64::new(0.0, 0.0); 2];
                for l in near.clone() {
                    let own = (s[l][(i, i)].re * s[l][(j, j)].re).sqrt();
                    let p: C64 = fitted[l][(i, j)];
                    if !(own > 0.0 && p.norm() > 0.0) {
                        continue;
                    }
                    let turn = p.conj() / p.norm() / (own * near.len() as f64);
                    given += s[l][(i, j)] * turn;
                    off += (p - s[l][(i, j)]) * turn;
                }
                if !(given.norm_sqr() > COHERENT) {
                    continue;
                }
                let phase_deg = given.arg().abs().to_degrees();
                let pair = [i + 1, j + 1];
                let sum = found.get_or_insert(CrossError {
                    count: 0,
                    rms: 0.0,
                    phase_deg,
                    phase_at_rad: omega[k],
                    phase_pair: pair,
                    off_from_rad: None,
                    off_pair: None,
                    samples_averaged: 2 * either_side + 1,
                });
                sum.count += 1;
                squares += off.norm_sqr();
                sum.rms = (squares / sum.count as f64).sqrt();
                if phase_deg > sum.phase_deg {
                    (sum.phase_deg, sum.phase_at_rad, sum.phase_pair) = (phase_deg, omega[k], pair);
                }
                if phase_deg > OFF_DEG && sum.off_from_rad.is_none() {
                    (sum.off_from_rad, sum.off_pair) = (Some(omega[k]), Some(pair));
                }
            }
        }
        Ok(found)
    }

    /// What is to be known of them, where they are off.
    pub(super) fn note(&self, unit: &str) -> Option<Flag> {
        if !(self.rms > OFF) && self.off_from_rad.is_none() {
            return None;
        }
        let [i, j] = self.phase_pair;
        let phase = match (self.off_from_rad, self.off_pair) {
            (Some(from), Some([a, b])) => format!(
                "; from {from:.4} {unit} on the phase of psd_{a}{b} is off by more than {OFF_DEG:.0} degrees (most: {:.0} of psd_{i}{j} at {:.4} {unit})",
                self.phase_deg, self.phase_at_rad
            ),
            _ => String::new(),
        };
        let text = format!(
            "cross-spectra of coherent channels are off by {:.2} of the root of their densities (rms){phase}. The log10 error is of the trace and does not show it: ride and design on this filter treat the delay between its points wrongly; a higher --order or --max-order follows it further",
            self.rms
        );
        Some(Flag { name: "cross-spectra".to_owned(), text })
    }
}
