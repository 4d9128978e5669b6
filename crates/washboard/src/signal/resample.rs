//! Samples taken at irregular instants, interpolated onto a uniform clock.

use super::clock::{check, median};
use super::time_base::{Laid, MAX_FILL_S, MAX_FILL_SAMPLES, longest, piece_used};
use super::{Repair, RepairKind, SignalError};

/// Columns whose stamps are the instants of sampling, by cubics through the four nearest samples, at the median rate.
///
/// # Errors
/// Stamps that are too few, decrease, or are equal: two samples cannot have one instant.
pub(super) fn lay_by_instants(stamps_s: &[f64], columns: &[Vec<f64>]) -> Result<Laid, SignalError> {
    check(stamps_s)?;
    if let Some(i) = stamps_s.windows(2).position(|w| w[1] <= w[0]) {
        let found = format!("{} twice", stamps_s[i]);
        let expected = "a different instant for each sample (stamps of delivery want stamps = \"clock\")";
        return Err(SignalError::Stamps { expected, found, index: i + 1 });
    }
    let steps: Vec<f64> = stamps_s.windows(2).map(|w| w[1] - w[0]).collect();
    let period = median(&steps);
    let gap = MAX_FILL_S.min(MAX_FILL_SAMPLES as f64 * period).max(2.0 * period);
    let mut pieces = vec![];
    let mut begin = 0;
    for i in 0..steps.len() {
        if steps[i] > gap {
            pieces.push((begin, i + 1));
            begin = i + 1;
        }
    }
    pieces.push((begin, stamps_s.len()));
    let (first, end) = longest(&pieces);
    if end - first < 4 {
        return Err(SignalError::TooShort { what: "a piece without gaps", needed: 4, found: end - first });
    }
    let t = &stamps_s[first..end];
    let count = ((t[t.len() - 1] - t[0]) / period).floor() as usize + 1;
    let mut repairs = vec![];
    if pieces.len() > 1 {
        repairs.push(piece_used(pieces.len(), stamps_s.len(), first, end, period, t[0] - stamps_s[0]));
    }
    let rms = (steps[first..end - 1].iter().map(|s| (s - period).powi(2)).sum::<f64>()
        / (end - first - 1) as f64)
        .sqrt();
    let text = format!(
        "{} samples at their own instants (rms deviation of the step {:.3} ms) interpolated by cubics at {:.4} Hz",
        t.len(),
        1e3 * rms,
        1.0 / period
    );
    repairs.push(Repair { channel: None, what: RepairKind::Resampled, text, count, start_s: Some(0.0) });
    let columns = columns.iter().map(|c| interpolated(t, &c[first..end], period, count)).collect();
    let end_s = t[0] + (count - 1) as f64 * period;
    Ok(Laid { columns, rate_hz: 1.0 / period, start_s: t[0], end_s, repairs })
}

/// Lagrange's cubic through the two samples before and the two after, at t₀ + k T.
fn interpolated(t: &[f64], x: &[f64], period: f64, count: usize) -> Vec<f64> {
    let mut before = 0;
    (0..count)
        .map(|k| {
            let now = t[0] + k as f64 * period;
            while before + 2 < t.len() && t[before + 1] <= now {
                before += 1;
            }
            let base = before.saturating_sub(1).min(t.len() - 4);
            let four = base..base + 4;
            four.clone()
                .map(|i| {
                    let weight: f64 =
                        four.clone().filter(|j| *j != i).map(|j| (now - t[j]) / (t[i] - t[j])).product();
                    weight * x[i]
                })
                .sum()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slow_sine_at_shaken_instants_is_recovered() {
        let t: Vec<f64> =
            (0..500).map(|k| 0.01 * (f64::from(k) + 0.3 * (7.0 * f64::from(k)).sin())).collect();
        let x: Vec<f64> = t.iter().map(|t| (12.0 * t).sin()).collect();
        let laid = lay_by_instants(&t, &[x]).unwrap();
        assert_eq!(laid.repairs[0].what, RepairKind::Resampled);
        for (k, y) in laid.columns[0].iter().enumerate() {
            let expected = (12.0 * (laid.start_s + k as f64 / laid.rate_hz)).sin();
            assert!((y - expected).abs() < 2e-4, "{k}: {y} against {expected}");
        }
    }

    #[test]
    fn equal_instants_are_refused_and_gaps_cut() {
        let mut t: Vec<f64> = (0..100).map(|k| 0.01 * f64::from(k)).collect();
        t[5] = t[4];
        assert!(lay_by_instants(&t, &[]).unwrap_err().to_string().contains("at sample 5"));
        let t: Vec<f64> = (0..100).map(|k| 0.01 * f64::from(k) + if k < 30 { 0.0 } else { 5.0 }).collect();
        let laid = lay_by_instants(&t, std::slice::from_ref(&t)).unwrap();
        assert_eq!(laid.repairs[0].what, RepairKind::PieceUsed);
        assert!((laid.start_s - 5.3).abs() < 1e-12 && laid.columns[0].len() >= 69);
    }
}
