//! Frequency-domain decomposition (FDD) with enhanced damping (EFDD): modes from the singular values of Welch's spectra.

mod bell;
mod decomposition;
mod peaks;

use super::operational::{
    OperationalError, Rejected, ShapeComponent, jackknife, largest_one, mean_phase_deg,
    mean_phase_deviation_deg, normalise, phase_collinearity, require,
};
use crate::signal::CorrelationError;
use crate::units::per_hz_from_two_sided;
use bell::{Bell, Range};
use decomposition::{Blocks, Decomposition};
use peaks::{Peak, judge};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Without a segment length, a segment is this part of the recording …
const SEGMENTS: usize = 40;
/// … and no longer than this many samples: more bins cost time and tell little.
const LONGEST: usize = 8192;
/// A segment has at least so many samples.
const SHORTEST: usize = 32;

/// What FDD is told beside the data. [`FddSettings::default`] suits modes that are apart.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct FddSettings {
    /// Samples in a segment of Welch's spectra; a fortieth of the recording without it.
    pub segment: Option<usize>,
    /// A peak stands by so many standard deviations of ln Ŝ (1/√averages) above the ground about it: the highest of some
    /// hundred chance bumps on level ground stands by about six above the deepest dip.
    pub min_prominence: f64,
    /// The shape at a bin of a mode's bell has at least this modal assurance criterion with the shape at its peak.
    pub min_mac: f64,
    /// Peaks outside this band are left out, with that reason.
    pub band_hz: Option<[f64; 2]>,
}

impl Default for FddSettings {
    fn default() -> Self {
        Self { segment: None, min_prominence: 7.0, min_mac: 0.8, band_hz: None }
    }
}

/// What [`fdd`] found, and what it left out and why.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FddOutcome {
    /// The modes, by ascending frequency.
    pub modes: Vec<FddMode>,
    /// Every other peak of the first singular value, condensed by reason and place.
    pub rejected: Vec<Rejected>,
    /// Bins in Hz.
    pub freq_hz: Vec<f64>,
    /// Singular values of the spectra of normalised channels over the bins, one curve a value, the largest first,
    /// one-sided in 1/Hz.
    pub singular_values: Vec<Vec<f64>>,
    /// How many independent segments the spectra average.
    pub averages: f64,
    /// Samples in a segment.
    pub segment: usize,
}

/// A mode: one peak and its bell.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FddMode {
    /// |λ|/2π in Hz, from the phase of the bell's correlation; the peak's place where the bell has none to tell.
    pub freq_hz: f64,
    /// Its standard deviation, where the recording has blocks enough to tell.
    pub freq_sd_hz: Option<f64>,
    /// −Re λ/|λ| from the bell's decay; none where it cannot be had.
    pub damping: Option<f64>,
    /// Why it cannot be had.
    pub damping_why: Option<String>,
    /// Its standard deviation.
    pub damping_sd: Option<f64>,
    /// Half the peak's relative width at half power, the window's own taken off: a coarse damping ratio.
    pub width_damping: f64,
    /// The first singular vector at the peak, its largest component 1, in the channels' units.
    pub shape: Vec<ShapeComponent>,
    /// Modal phase collinearity of the shape at normalised channels.
    pub phase_collinearity: f64,
    /// Mean phase of the shape in degrees, against its largest component.
    pub mean_phase_deg: f64,
    /// Mean phase deviation in degrees.
    pub mean_phase_deviation_deg: f64,
    /// The ends of the bell.
    pub bell_hz: [f64; 2],
    /// Standard deviations of ln Ŝ by which the peak stands above the ground about it.
    pub prominence: f64,
}

/// Modes from channels recorded at one rate under broadband excitation, by FDD and EFDD.
///
/// Ŝ(ω) = U Σ Uᴴ of Welch's spectra;  a peak of σ₁ is a mode, u₁ there its shape;  its bell b(ω) = aᵀŜa\* over the bins
/// where u₁ keeps that shape;  R(τ) = Σ_bell taper · b e^{iωτ}/ρ(τ), with ρ Hann's window correlated with itself;
/// ln |R| falls by ζω₀ a second and the phase of R grows by ω₀√(1 − ζ²)
///
/// | symbol | shape | unit |
/// |---|---|---|
/// | `channels` | channels × samples | any, one unit a channel |
/// | `rate_hz` | | Hz |
/// | a | the modal filter: aᵀφ = 1, aᵀφ_s = 0 for the other modes found, where the shapes allow | |
///
/// Both slopes are weighted regressions (weights |R|²), which zero crossings and a logarithmic decrement are at single
/// lags. What the bell's ends and the window do to them is taken out: f and ζ are those of the resonance whose own
/// spectrum under the same window, bell and taper has the same two slopes.
///
/// Assumes forces that are white in each bell, lightly damped modes that are apart; the damping of one that dies within a
/// cycle cannot be had. The mean of every channel is removed. Channels are divided by their rms, so that the result does
/// not depend on units.
///
/// # Errors
/// Settings without meaning, channels that differ in length, are constant, too short or not finite.
///
/// Numerical note: Hermitian eigenvalues at each bin; standard deviations are the jackknife's over blocks of segments,
/// the bell and the lags held.
///
/// Source: Brincker, Zhang and Andersen, *Modal identification of output-only systems using frequency domain
/// decomposition*, Smart Materials and Structures 10 (2001); Brincker, Ventura and Andersen, *Damping estimation by
/// frequency domain decomposition*, IMAC XIX (2001); Zhang, Wang and Tamura, *A frequency-spatial domain decomposition
/// (FSDD) method for operational modal analysis*, MSSP 24 (2010).
pub fn fdd(
    channels: &[Vec<f64>],
    rate_hz: f64,
    settings: &FddSettings,
) -> Result<FddOutcome, OperationalError> {
    let segment = check(channels, rate_hz, settings)?;
    let (normalised, rms) = normalise(channels)?;
    let blocks = Blocks::new(&normalised, rate_hz, segment);
    let whole = Decomposition::new(&blocks.mean(None), &blocks)?;
    let (found, rejected) = judge(&whole, &blocks, settings);
    let shapes: Vec<&[crate::linalg::C64]> = found.iter().map(|p| whole.shape(p.bin)).collect();
    let modes =
        found.par_iter().enumerate().map(|(k, peak)| mode(peak, k, &shapes, &blocks, &whole, &rms)).collect();
    let one_sided = |curve: &Vec<f64>| curve.iter().map(|v| per_hz_from_two_sided(*v)).collect();
    Ok(FddOutcome {
        modes,
        rejected,
        singular_values: whole.singular_values.iter().map(one_sided).collect(),
        freq_hz: whole.freq_hz,
        averages: whole.averages,
        segment,
    })
}

/// The mode of a peak.
fn mode(
    peak: &Peak,
    k: usize,
    shapes: &[&[crate::linalg::C64]],
    blocks: &Blocks,
    whole: &Decomposition,
    rms: &[f64],
) -> FddMode {
    let pairs: Vec<[f64; 2]> = shapes[k].iter().map(|s| [s.re, s.im]).collect();
    let (shape, turned) = largest_one(&pairs, rms);
    let bell = Bell::new(peak.first..=peak.last, shapes, k, blocks);
    let spectrum = bell.of(&blocks.mean(None));
    let peak_hz = whole.freq_hz[peak.bin];
    let damped = Range::new(&bell, &spectrum, peak_hz, peak.width_hz).and_then(|range| {
        let value = bell.resonance(&spectrum, &range)?;
        let without: Option<Vec<[f64; 2]>> = (0..blocks.count())
            .map(|b| bell.resonance(&bell.of(&blocks.mean(Some(b))), &range).ok())
            .collect();
        Ok((value, without.filter(|w| w.len() >= decomposition::FEWEST_BLOCKS)))
    });
    let of = |without: &Option<Vec<[f64; 2]>>, i: usize| {
        without.as_ref().map(|w| blocks.overlap() * jackknife(w.iter().map(|v| v[i])))
    };
    let (freq_hz, damping, why, freq_sd_hz, damping_sd) = match &damped {
        Ok((value, without)) => (value[0], Some(value[1]), None, of(without, 0), of(without, 1)),
        Err(why) => (peak_hz, None, Some(why.clone()), None, None),
    };
    FddMode {
        freq_hz,
        freq_sd_hz,
        damping,
        damping_why: why,
        damping_sd,
        width_damping: peak.width_hz / (2.0 * peak_hz),
        shape,
        phase_collinearity: phase_collinearity(&turned),
        mean_phase_deg: mean_phase_deg(&turned),
        mean_phase_deviation_deg: mean_phase_deviation_deg(&turned),
        bell_hz: [whole.freq_hz[peak.first], whole.freq_hz[peak.last]],
        prominence: peak.prominence,
    }
}

/// The segment's length, where everything else is in order.
fn check(channels: &[Vec<f64>], rate_hz: f64, s: &FddSettings) -> Result<usize, OperationalError> {
    let Some(first) = channels.first() else { return Err(CorrelationError::NoChannel.into()) };
    let expected = first.len();
    if let Some(channel) = channels.iter().position(|c| c.len() != expected) {
        let found = channels[channel].len();
        return Err(CorrelationError::Lengths { channel, expected, found }.into());
    }
    require(rate_hz.is_finite() && rate_hz > 0.0, "rate_hz", "a positive number", rate_hz)?;
    require((0.0..=1.0).contains(&s.min_mac), "min_mac", "a number from 0 to 1", s.min_mac)?;
    let least = s.min_prominence;
    require(least >= 0.0 && least.is_finite(), "min_prominence", "a number from 0", least)?;
    if let Some([low, high]) = s.band_hz {
        let sound = low >= 0.0 && high > low && high <= rate_hz / 2.0;
        let text = format!("0 ≤ low < high ≤ {} Hz", rate_hz / 2.0);
        require(sound, "band_hz", text, if low >= 0.0 { high } else { low })?;
    }
    let segment = s.segment.unwrap_or_else(|| (expected / SEGMENTS).clamp(SHORTEST, LONGEST) / 4 * 4);
    require(segment >= SHORTEST, "segment", format!("at least {SHORTEST} samples"), segment as f64)?;
    // two segments' spectra of many channels have singular values that say nothing
    if expected < 4 * segment {
        return Err(CorrelationError::TooShort { max_lag: 4 * segment, samples: expected }.into());
    }
    Ok(segment)
}
