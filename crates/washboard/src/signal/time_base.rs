//! Columns laid on a uniform clock: lost samples filled, long gaps cut out, each with its word.

use super::clock::ticks;
use super::{Clock, Repair, RepairKind, SignalError, Stamps};

/// Longer gaps are not filled, in s: a twentieth of a second's motion to either side is what a line may stand for.
pub const MAX_FILL_S: f64 = 0.1;
/// Nor are gaps of more samples than this.
pub const MAX_FILL_SAMPLES: usize = 16;
/// Jitter below this share of the period is the rounding of stamps, not worth a word.
const QUIET: f64 = 0.02;
/// Columns on a uniform clock.
#[derive(Debug, Clone)]
pub(super) struct Laid {
    pub columns: Vec<Vec<f64>>,
    pub rate_hz: f64,
    pub start_s: f64,
    pub end_s: f64,
    pub repairs: Vec<Repair>,
}

/// Columns whose stamps are given, on a uniform clock.
pub(super) fn lay_on_clock(
    stamps_s: &[f64],
    columns: Vec<Vec<f64>>,
    stamps: Stamps,
    span_s: Option<[f64; 2]>,
) -> Result<Laid, SignalError> {
    let (first, end) = match span_s {
        None => (0, stamps_s.len()),
        Some([a, b]) => (stamps_s.partition_point(|t| *t < a), stamps_s.partition_point(|t| *t <= b)),
    };
    let stamps_s = &stamps_s[first..end.max(first)];
    let columns: Vec<Vec<f64>> = columns.into_iter().map(|c| c[first..end.max(first)].to_vec()).collect();
    match stamps {
        Stamps::Clock => lay_by_clock(stamps_s, &columns),
        Stamps::Instants => super::resample::lay_by_instants(stamps_s, &columns),
    }
}

/// Columns whose rate is declared.
pub(super) fn lay_uniform(
    rate_hz: f64,
    columns: Vec<Vec<f64>>,
    span_s: Option<[f64; 2]>,
) -> Result<Laid, SignalError> {
    if !(rate_hz > 0.0 && rate_hz.is_finite()) {
        let expected = "a positive finite number";
        return Err(SignalError::Value { name: "rate_hz", expected, found: rate_hz });
    }
    let n = columns.first().map_or(0, Vec::len);
    let [a, b] = span_s.unwrap_or([0.0, n as f64 / rate_hz]);
    let first = ((a * rate_hz).ceil().max(0.0) as usize).min(n);
    let end = ((b * rate_hz).floor().max(0.0) as usize).saturating_add(1).min(n);
    if first >= end {
        return Err(SignalError::TooShort { what: "span_s", needed: 1, found: 0 });
    }
    let columns = columns.into_iter().map(|c| c[first..end].to_vec()).collect();
    let (start_s, end_s) = (first as f64 / rate_hz, (end - 1) as f64 / rate_hz);
    Ok(Laid { columns, rate_hz, start_s, end_s, repairs: Vec::new() })
}

fn lay_by_clock(stamps_s: &[f64], columns: &[Vec<f64>]) -> Result<Laid, SignalError> {
    let clock = Clock::from_stamps(stamps_s)?;
    let (n, period) = (stamps_s.len(), clock.period_s);
    let mut repairs = vec![];
    if clock.jitter_rms_s > QUIET * period || clock.backlog > 0 {
        repairs.push(clock.told(stamps_s));
    }
    let fillable = |count: usize| count <= MAX_FILL_SAMPLES && count as f64 * period <= MAX_FILL_S;
    // pieces between gaps that are too long, as ranges of samples
    let mut pieces = vec![];
    let mut begin = 0;
    for &(after, _) in clock.missing.iter().filter(|(_, count)| !fillable(*count)) {
        pieces.push((begin, after + 1));
        begin = after + 1;
    }
    pieces.push((begin, n));
    let (first, end) = longest(&pieces);
    let ticks = ticks(n, &clock.missing);
    let start_s = clock.start_s + period * ticks[first];
    if pieces.len() > 1 {
        repairs.push(piece_used(pieces.len(), n, first, end, period, ticks[first] * period));
    }
    let inside: Vec<(usize, usize)> =
        clock.missing.iter().copied().filter(|(after, _)| (first..end - 1).contains(after)).collect();
    let columns: Vec<Vec<f64>> = columns.iter().map(|c| filled(&c[first..end], first, &inside)).collect();
    if let Some((after, _)) = inside.first() {
        let count = inside.iter().map(|(_, c)| c).sum();
        let largest = inside.iter().map(|(_, c)| *c).max().unwrap_or(0);
        let text = format!(
            "{count} lost samples in {} gaps (at most {largest} in one) filled by straight lines",
            inside.len()
        );
        let start_s = Some((ticks[*after] - ticks[first] + 1.0) * period);
        repairs.push(Repair { channel: None, what: RepairKind::GapFilled, text, count, start_s });
    }
    let end_s = clock.start_s + period * ticks[end - 1];
    Ok(Laid { columns, rate_hz: 1.0 / period, start_s, end_s, repairs })
}

impl Clock {
    fn told(&self, stamps_s: &[f64]) -> Repair {
        let shared = stamps_s.windows(2).filter(|w| w[0] == w[1]).count();
        let late = if self.backlog == 0 {
            String::new()
        } else {
            format!("; {} samples were delivered up to {:.2} s late", self.backlog, self.largest_delay_s)
        };
        let text = format!(
            "time stamps taken as the delivery of a uniform clock of {:.4} Hz: rms jitter {:.2} ms, {shared} of {} samples \
             share the stamp before{late} (if stamps are the instants of sampling, say stamps = \"instants\")",
            1.0 / self.period_s,
            1e3 * self.jitter_rms_s,
            stamps_s.len(),
        );
        let count = stamps_s.len();
        Repair { channel: None, what: RepairKind::UniformClock, text, count, start_s: Some(0.0) }
    }
}

/// Which piece was taken of several.
pub(super) fn piece_used(
    pieces: usize,
    n: usize,
    first: usize,
    end: usize,
    period: f64,
    start_s: f64,
) -> Repair {
    let used = end - first;
    let text = format!(
        "gaps of more than {MAX_FILL_S} s or {MAX_FILL_SAMPLES} samples: of {pieces} pieces the longest is used, {used} of {n} \
         samples ({:.1} s), from {start_s:.2} s after the first",
        used as f64 * period
    );
    Repair { channel: None, what: RepairKind::PieceUsed, text, count: n - used, start_s: Some(0.0) }
}

/// The longest of some ranges; the first of equals.
pub(super) fn longest(pieces: &[(usize, usize)]) -> (usize, usize) {
    pieces.iter().copied().fold((0, 0), |best, p| if p.1 - p.0 > best.1 - best.0 { p } else { best })
}

/// A column with straight lines where samples are missing; `first` is the file's index of its first sample.
fn filled(x: &[f64], first: usize, missing: &[(usize, usize)]) -> Vec<f64> {
    let mut y = Vec::with_capacity(x.len());
    let mut begin = 0;
    for &(after, count) in missing {
        let end = after + 1 - first;
        y.extend_from_slice(&x[begin..end]);
        let (a, b) = (x[end - 1], x[end]);
        y.extend((1..=count).map(|k| a + (b - a) * k as f64 / (count + 1) as f64));
        begin = end;
    }
    y.extend_from_slice(&x[begin..]);
    y
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 100 Hz with gaps after these samples; the column holds the true time.
    fn gappy(n: usize, lost: &[(usize, usize)]) -> (Vec<f64>, Vec<f64>) {
        let t: Vec<f64> = ticks(n, lost).iter().map(|k| k / 100.0).collect();
        (t.clone(), t)
    }

    #[test]
    fn short_gaps_are_bridged_by_lines() {
        let (t, x) = gappy(1000, &[(300, 4), (310, 1), (700, 9)]);
        let laid = lay_on_clock(&t, vec![x], Stamps::Clock, None).unwrap();
        assert_eq!(laid.columns[0].len(), 1014);
        assert!((laid.rate_hz - 100.0).abs() < 1e-9);
        for (k, x) in laid.columns[0].iter().enumerate() {
            assert!((x - k as f64 / 100.0).abs() < 1e-9, "{k}");
        }
        let [repair] = &laid.repairs[..] else { panic!("{:?}", laid.repairs) };
        assert_eq!((repair.what, repair.count), (RepairKind::GapFilled, 14));
        assert!((repair.start_s.unwrap() - 3.01).abs() < 1e-9);
    }

    #[test]
    fn a_long_gap_leaves_the_longest_piece() {
        let (t, x) = gappy(1000, &[(299, 11), (800, 3)]);
        let laid = lay_on_clock(&t, vec![x], Stamps::Clock, None).unwrap();
        assert_eq!(laid.columns[0].len(), 703);
        assert!((laid.columns[0][0] - 3.11).abs() < 1e-9 && (laid.start_s - 3.11).abs() < 1e-9);
        let kinds: Vec<RepairKind> = laid.repairs.iter().map(|r| r.what).collect();
        assert_eq!(kinds, [RepairKind::PieceUsed, RepairKind::GapFilled]);
        assert_eq!(laid.repairs[0].count, 300);
    }

    #[test]
    fn a_span_is_taken_on_the_files_clock() {
        let (t, x) = gappy(1000, &[]);
        let laid = lay_on_clock(&t, vec![x.clone()], Stamps::Clock, Some([2.0, 4.0])).unwrap();
        assert!((laid.columns[0][0] - 2.0).abs() < 1e-12 && (laid.end_s - 4.0).abs() < 0.011);
        assert!(laid.repairs.is_empty());
        let laid = lay_uniform(100.0, vec![x], Some([2.0, 4.0])).unwrap();
        assert_eq!((laid.columns[0].len(), laid.columns[0][0]), (201, 2.0));
        assert!(lay_uniform(100.0, vec![vec![1.0]], Some([2.0, 4.0])).is_err());
    }
}
