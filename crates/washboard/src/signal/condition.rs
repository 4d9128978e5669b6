//! Faults of a channel that can be seen in its samples, and how a repair is told.

use serde::{Deserialize, Serialize};

/// So many samples in a row at a channel's largest or smallest value look clipped.
pub const CLIPPED_RUN: usize = 3;
/// A smooth signal rests once at its extreme; a clipped one comes back to it.
const CLIPPED_RUNS: usize = 2;

/// The kind of a repair, or of a fault that was left as it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RepairKind {
    /// Irregular time stamps were taken for the delivery of a uniform clock's samples.
    UniformClock,
    /// Samples at irregular instants were interpolated onto a uniform clock.
    Resampled,
    /// Missing samples were interpolated.
    GapFilled,
    /// A long gap: only the longest piece without one is used.
    PieceUsed,
    /// A constant channel was left out.
    DeadChannel,
    /// A channel rests at its extreme value; its samples are kept.
    Clipped,
}

/// One thing that was done to the data, or that should have been and could not.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Repair {
    /// The channel concerned; none where all are.
    pub channel: Option<String>,
    /// The kind.
    pub what: RepairKind,
    /// In words, with the numbers.
    pub text: String,
    /// How many samples it concerns.
    pub count: usize,
    /// Where it first happened, in s from the first sample used.
    pub start_s: Option<f64>,
}

/// Whether all samples are one value.
pub(super) fn is_dead(samples: &[f64]) -> bool {
    samples.windows(2).all(|w| w[0] == w[1])
}

/// Samples that sit in runs of at least [`CLIPPED_RUN`] at the largest or smallest value, and the first one's index; none
/// where a value is reached by fewer than two such runs.
pub(super) fn clipped(samples: &[f64]) -> Option<(usize, usize)> {
    let low = samples.iter().copied().fold(f64::INFINITY, f64::min);
    let high = samples.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let (mut total, mut first) = (0, usize::MAX);
    for extreme in [low, high] {
        let (mut runs, mut count, mut start, mut run) = (0, 0, usize::MAX, 0);
        for k in 0..=samples.len() {
            if k < samples.len() && samples[k] == extreme {
                run += 1;
                continue;
            }
            if run >= CLIPPED_RUN {
                runs += 1;
                count += run;
                start = start.min(k - run);
            }
            run = 0;
        }
        if runs >= CLIPPED_RUNS {
            total += count;
            first = first.min(start);
        }
    }
    (total > 0).then_some((total, first))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clipped_sine_is_seen_and_a_whole_one_is_not() {
        let sine: Vec<f64> = (0..1000).map(|k| (0.1 * f64::from(k)).sin()).collect();
        assert_eq!(clipped(&sine), None);
        let cut: Vec<f64> = sine.iter().map(|x| x.min(0.8)).collect();
        let (count, first) = clipped(&cut).unwrap();
        assert_eq!(count, cut.iter().filter(|x| **x == 0.8).count());
        assert_eq!(first, cut.iter().position(|x| *x == 0.8).unwrap());
        // one rest at the top is a slow signal, not a clipped one
        assert_eq!(clipped(&[0.0, 1.0, 2.0, 2.0, 2.0, 1.0, -1.0]), None);
    }

    #[test]
    fn dead_is_constant() {
        assert!(is_dead(&[1.0, 1.0, 1.0]) && !is_dead(&[1.0, 1.0, 1.1]));
    }
}
