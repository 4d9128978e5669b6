//! The peaks of the first singular value: which are modes, and the reason of every other.

use super::FddSettings;
use super::decomposition::{Blocks, Decomposition};
use crate::identify::operational::{Reason, Rejected};

/// The lowest bins hold what is left of the segments' means.
const FIRST_BIN: usize = 2;
/// A bell has at least so many bins: the window alone makes four of one line.
const FEWEST_BINS: usize = 6;
/// Hann's window makes a line so many bins wide at half power.
const WINDOW_WIDTH: f64 = 1.44;
/// A peak less than this many of the window's widths wide may be a line.
const NARROW: f64 = 1.3;
/// A Gaussian resonance's periodogram varies from block to block by its mean over the averages; a line's does not. Below
/// this part of that variance a narrow peak is a line.
const STEADY: f64 = 0.25;
/// Peaks of one reason further apart than this ratio are listed apart.
const LISTED_APART: f64 = 1.2;

/// The bin of a peak that is no mode, and why.
type LeftOut = (usize, Reason, String);

/// A peak and its bell.
pub(super) struct Peak {
    /// Where it is highest.
    pub bin: usize,
    /// Standard deviations above the ground about it.
    pub prominence: f64,
    /// First bin of the bell.
    pub first: usize,
    /// Last bin of the bell.
    pub last: usize,
    /// Width at half power in Hz, the window's taken off.
    pub width_hz: f64,
}

/// The peaks that are modes, ascending, and the others.
pub(super) fn judge(
    whole: &Decomposition,
    blocks: &Blocks,
    settings: &FddSettings,
) -> (Vec<Peak>, Vec<Rejected>) {
    let curve: Vec<f64> = whole.first().iter().map(|s| s.max(f64::MIN_POSITIVE).ln()).collect();
    let sigma = 1.0 / whole.averages.sqrt();
    let maxima: Vec<usize> = (FIRST_BIN..curve.len() - 1)
        .filter(|&k| curve[k] > curve[k - 1] && curve[k] >= curve[k + 1])
        .collect();
    let (mut clear, mut left_out): (Vec<(usize, f64)>, Vec<LeftOut>) = Default::default();
    for k in maxima {
        let prominence = prominence(&curve, k) / sigma;
        let f = whole.freq_hz[k];
        let inside = settings.band_hz.is_none_or(|[low, high]| (low..=high).contains(&f));
        if !inside {
            left_out.push((k, Reason::OutOfBand, "outside the band".into()));
        } else if prominence < settings.min_prominence {
            let why = format!(
                "below noise: less than {} standard deviations of the spectrum above the ground about it",
                settings.min_prominence
            );
            left_out.push((k, Reason::Noise, why));
        } else {
            clear.push((k, prominence));
        }
    }
    let mut peaks = Vec::new();
    for (i, &(bin, prominence)) in clear.iter().enumerate() {
        // the bell ends at the latest in the valleys to the next clear peaks
        let valley = |from: usize, to: usize| {
            (from..=to).min_by(|a, b| curve[*a].total_cmp(&curve[*b])).unwrap_or(from)
        };
        let low = if i > 0 { valley(clear[i - 1].0, bin) } else { FIRST_BIN };
        let high = clear.get(i + 1).map_or(curve.len() - 2, |next| valley(bin, next.0));
        let alike = |k: &usize| whole.mac(*k, bin) >= settings.min_mac;
        let first = (low..=bin).rev().take_while(alike).last().unwrap_or(bin);
        let last = (bin..=high).take_while(alike).last().unwrap_or(bin);
        let peak = Peak { bin, prominence, first, last, width_hz: width(&curve, bin, whole) };
        match refused(&peak, whole, blocks, &curve) {
            Some((reason, why)) => left_out.push((bin, reason, why)),
            None => peaks.push(peak),
        }
    }
    (peaks, condensed(left_out, whole, &curve))
}

/// Height of a peak over the higher of the two deepest points between it and higher ground, or the ends.
fn prominence(curve: &[f64], peak: usize) -> f64 {
    let ground = |side: &mut dyn Iterator<Item = usize>| {
        let mut least = curve[peak];
        for k in side {
            if curve[k] > curve[peak] {
                return least;
            }
            least = least.min(curve[k]);
        }
        least
    };
    let left = ground(&mut (1..peak).rev());
    let right = ground(&mut (peak + 1..curve.len()));
    curve[peak] - left.max(right)
}

/// Width at half power in Hz by straight lines between bins, the window's width taken off as of squares.
fn width(curve: &[f64], peak: usize, whole: &Decomposition) -> f64 {
    let level = curve[peak] - std::f64::consts::LN_2;
    let reach = |side: &mut dyn Iterator<Item = usize>| {
        let mut before = peak;
        for k in side {
            if curve[k] <= level {
                let part = (curve[before] - level) / (curve[before] - curve[k]).max(f64::MIN_POSITIVE);
                return (before as f64 - peak as f64).abs() + part;
            }
            before = k;
        }
        (before as f64 - peak as f64).abs()
    };
    let bins = reach(&mut (1..peak).rev()) + reach(&mut (peak + 1..curve.len()));
    (bins * bins - WINDOW_WIDTH * WINDOW_WIDTH).max(0.0).sqrt() * (whole.freq_hz[1] - whole.freq_hz[0])
}

/// Why a clear peak is no mode.
fn refused(peak: &Peak, whole: &Decomposition, blocks: &Blocks, curve: &[f64]) -> Option<(Reason, String)> {
    let bin_hz = whole.freq_hz[1] - whole.freq_hz[0];
    let bins = (peak.width_hz / bin_hz).hypot(WINDOW_WIDTH);
    if bins < NARROW * WINDOW_WIDTH {
        let steadiness = steadiness(peak.bin, whole, blocks);
        if steadiness < STEADY {
            let why = format!(
                "a line: no wider than the window, and its power varies from block to block by {steadiness:.2} of what a \
                 random vibration's does"
            );
            return Some((Reason::Line, why));
        }
    }
    if peak.last - peak.first + 1 < FEWEST_BINS {
        let why =
            format!("its shape holds over {} bins, {FEWEST_BINS} are needed", peak.last - peak.first + 1);
        return Some((Reason::NarrowDomain, why));
    }
    // a resonance falls to both sides of its peak within its bell, by half at least
    let half = |k: usize| curve[k] <= curve[peak.bin] - std::f64::consts::LN_2;
    let (left, right) = ((peak.first..peak.bin).any(half), (peak.bin + 1..=peak.last).any(half));
    if !(left && right) {
        let side = if left { "above" } else { "below" };
        let why =
            format!("not the form of a resonance: with its shape it does not fall to half {side} its peak");
        return Some((Reason::NotAPeak, why));
    }
    None
}

/// Variance over the blocks of the power at a bin, over what it is for Gaussian vibration (mean² over averages).
fn steadiness(bin: usize, whole: &Decomposition, blocks: &Blocks) -> f64 {
    let shape = whole.shape(bin);
    let power: Vec<f64> = blocks
        .at(bin)
        .map(|s| {
            let n = shape.len();
            let entry = |ij: usize| (shape[ij / n] * s[(ij / n, ij % n)] * shape[ij % n].conj()).re;
            (0..n * n).map(entry).sum()
        })
        .collect();
    let count = power.len() as f64;
    let mean = power.iter().sum::<f64>() / count;
    let variance = power.iter().map(|p| (p - mean).powi(2)).sum::<f64>() / (count - 1.0).max(1.0);
    variance * blocks.averages_a_block / (mean * mean).max(f64::MIN_POSITIVE)
}

/// Left-out peaks by reason and place.
fn condensed(mut left_out: Vec<LeftOut>, whole: &Decomposition, curve: &[f64]) -> Vec<Rejected> {
    left_out.sort_by(|a, b| (a.1, &a.2, a.0).cmp(&(b.1, &b.2, b.0)));
    let together = |a: &LeftOut, b: &LeftOut| {
        a.1 == b.1 && a.2 == b.2 && whole.freq_hz[b.0] <= LISTED_APART * whole.freq_hz[a.0]
    };
    let mut rejected: Vec<Rejected> = left_out
        .chunk_by(together)
        .map(|run| {
            let middle = run[run.len() / 2].0;
            let freq_hz = whole.freq_hz[middle];
            let damping = width(curve, middle, whole) / (2.0 * freq_hz);
            Rejected { freq_hz, damping, why: run[0].2.clone(), reason: run[0].1, poles: run.len() }
        })
        .collect();
    rejected.sort_by(|a, b| a.freq_hz.total_cmp(&b.freq_hz));
    rejected
}
