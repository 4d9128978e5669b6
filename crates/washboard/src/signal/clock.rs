//! The uniform clock behind time stamps: its period, and the samples that were lost.
//!
//! A logger's clock ticks evenly; what is written is often the time of *delivery*: several samples share one stamp, the
//! whole series comes late after a stall, and samples are lost. With period T, stamp t_j ≥ (tick of sample j), and from
//! sample i to sample j ≥ i at least j − i periods pass. So
//!
//! e_i = min_{j ≥ i} (t_j − j T)
//!
//! bounds the clock's offset at sample i from above, whatever the delays; it rises only where samples were lost, by T a
//! sample. A stall whose samples arrive later leaves it flat.

use super::SignalError;

/// Fewer stamps do not show a clock.
const MIN_STAMPS: usize = 16;
/// No clock shows more: thirty million years.
const LATEST_S: f64 = 1e15;
/// More lost samples are as many as these: a bound for the arithmetic.
const MOST_LOST: f64 = 1e12;
/// The passes: by which share the period is taken too small, so that the offset's steps at losses cannot be levelled, and
/// from which rise (in periods, within one cluster of steps) a loss is believed. The period is rough in the first.
const PASSES: [(f64, f64); 4] = [(3e-3, 1.5), (5e-4, 0.9), (1e-4, 0.75), (5e-5, 0.75)];

/// A uniform clock as estimated from stamps.
#[derive(Debug, Clone, PartialEq)]
pub struct Clock {
    /// 1/rate.
    pub period_s: f64,
    /// When the first sample was taken, on the clock of the stamps.
    pub start_s: f64,
    /// After which sample (counted from 0) how many are missing.
    pub missing: Vec<(usize, usize)>,
    /// Root mean square of the stamps about the clock, backlogs left out.
    pub jitter_rms_s: f64,
    /// How many samples were delivered so late that they tell nothing: more than ten times the median delay.
    pub backlog: usize,
    /// The largest delay of a stamp.
    pub largest_delay_s: f64,
}

impl Clock {
    /// The clock behind stamps in s, in the order of the samples.
    ///
    /// Where most samples share no stamp the period is the median step, refined by a line through the unwrapped
    /// stamps; otherwise the median slope of sixteenths of the recording, refined by a line through the earliest
    /// stamps between losses: fewer than half of the sixteenths may have lost samples. A stall that
    /// cost a broken number of periods is rounded to whole samples; the period does not suffer from it.
    ///
    /// # Errors
    /// Fewer than 16 stamps; stamps that run backwards or are not finite; stamps that are all equal.
    pub fn from_stamps(stamps_s: &[f64]) -> Result<Self, SignalError> {
        check(stamps_s)?;
        let n = stamps_s.len();
        let single = period_of_single_stamps(stamps_s);
        let mut period = single.unwrap_or_else(|| rough_period(stamps_s));
        let mut missing = Vec::new();
        for (margin, least) in PASSES.into_iter().skip(if single.is_some() { PASSES.len() - 1 } else { 0 }) {
            missing = losses(stamps_s, period * (1.0 - margin), least);
            if single.is_none() {
                period = slope_between_losses(stamps_s, &missing, period);
            }
        }
        let ticks = ticks(n, &missing);
        if single.is_some() {
            // whole ticks are sure here; behind bursts a stall may have cost a broken number of them
            period = earliest_slope(stamps_s, &ticks, period);
        }
        let offsets: Vec<f64> = (0..n).map(|i| stamps_s[i] - period * ticks[i]).collect();
        let earliest = quantile(&offsets, 0.01);
        let delays: Vec<f64> = offsets.iter().map(|o| o - earliest).collect();
        let late = 10.0 * median(&delays) + 2.0 * period;
        let usual: Vec<f64> = delays.iter().copied().filter(|d| *d <= late).collect();
        let mean = usual.iter().sum::<f64>() / usual.len() as f64;
        let square = usual.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / usual.len() as f64;
        Ok(Clock {
            period_s: period,
            start_s: earliest,
            missing,
            jitter_rms_s: square.sqrt(),
            backlog: n - usual.len(),
            largest_delay_s: delays.iter().copied().fold(0.0, f64::max),
        })
    }
}

/// At least 16 finite stamps that never run backwards and span some time.
pub(super) fn check(stamps_s: &[f64]) -> Result<(), SignalError> {
    if stamps_s.len() < MIN_STAMPS {
        return Err(SignalError::TooShort { what: "a time base", needed: MIN_STAMPS, found: stamps_s.len() });
    }
    if let Some(index) = stamps_s.iter().position(|t| t.is_nan() || t.abs() > LATEST_S) {
        let found = stamps_s[index].to_string();
        return Err(SignalError::Stamps { expected: "finite numbers up to 1e15 s", found, index });
    }
    if let Some(i) = stamps_s.windows(2).position(|w| w[1] < w[0]) {
        let found = format!("{} after {}", stamps_s[i + 1], stamps_s[i]);
        return Err(SignalError::Stamps { expected: "times that never decrease", found, index: i + 1 });
    }
    let (first, last) = (stamps_s[0], stamps_s[stamps_s.len() - 1]);
    let span = last - first;
    // a period that the stamps' own digits can show
    if span <= 0.0 || !span.is_finite() || span / stamps_s.len() as f64 <= 1e-15 * first.abs().max(last.abs())
    {
        let found = format!("{first} to {last}");
        return Err(SignalError::Stamps { expected: "times that advance", found, index: stamps_s.len() - 1 });
    }
    Ok(())
}

/// The tick of each sample: its index and the samples lost before it.
pub(super) fn ticks(n: usize, missing: &[(usize, usize)]) -> Vec<f64> {
    let mut lost = missing.iter().peekable();
    let mut sum = 0;
    (0..n)
        .map(|i| {
            while let Some((_, count)) = lost.next_if(|(after, _)| *after < i) {
                sum += count;
            }
            (i + sum) as f64
        })
        .collect()
}

/// Where almost all steps are whole multiples of the median one: the slope over the ticks that they make.
fn period_of_single_stamps(stamps: &[f64]) -> Option<f64> {
    let steps: Vec<f64> = stamps.windows(2).map(|w| w[1] - w[0]).collect();
    let middle = median(&steps);
    let whole = |s: &f64| (s / middle).round();
    let near = steps.iter().filter(|s| whole(s) >= 1.0 && (*s / middle - whole(s)).abs() < 0.25).count();
    let single = steps.iter().filter(|s| whole(s) == 1.0).count();
    if middle > 0.0 && near * 20 >= steps.len() * 19 && single * 2 >= steps.len() {
        let mut tick = 0.0;
        let mut unwrapped = vec![0.0];
        for s in &steps {
            tick += whole(s);
            unwrapped.push(tick);
        }
        return line_slope(&unwrapped, stamps, |_| true).filter(|s| *s > 0.0);
    }
    None
}

/// The median slope of sixteenths.
fn rough_period(stamps: &[f64]) -> f64 {
    let index: Vec<f64> = (0..stamps.len()).map(|i| i as f64).collect();
    let size = (stamps.len() / 16).max(MIN_STAMPS);
    let slopes: Vec<f64> = (0..stamps.len() / size)
        .filter_map(|b| {
            let (from, to) = (b * size, (b + 1) * size);
            line_slope(&index[from..to], &stamps[from..to], |_| true)
        })
        .filter(|s| *s > 0.0)
        .collect();
    let mean = (stamps[stamps.len() - 1] - stamps[0]) / (stamps.len() - 1) as f64;
    if slopes.is_empty() { mean } else { median(&slopes) }
}

/// e_i = min_{j ≥ i} (t_j − j T).
fn earliest_offsets(stamps: &[f64], period: f64) -> Vec<f64> {
    let mut e: Vec<f64> = stamps.iter().enumerate().map(|(j, t)| t - j as f64 * period).collect();
    for i in (1..e.len()).rev() {
        e[i - 1] = e[i - 1].min(e[i]);
    }
    e
}

/// Where e rises by at least `least` periods within a cluster of steps, so many samples are missing.
fn losses(stamps: &[f64], period: f64, least: f64) -> Vec<(usize, usize)> {
    let e = earliest_offsets(stamps, period);
    let steps: Vec<f64> = stamps.windows(2).map(|w| w[1] - w[0]).filter(|s| *s > 0.0).collect();
    let together = 2.5 * median(&steps);
    // the last deliveries have no later ones to be measured by
    let last = stamps[stamps.len() - 1] - together;
    let mut found = Vec::new();
    let mut cluster: Vec<(usize, f64)> = Vec::new();
    let mut close = |cluster: &mut Vec<(usize, f64)>| {
        let total: f64 = cluster.iter().map(|(_, rise)| rise).sum();
        if total >= least {
            let (mut sum, mut placed) = (0.0, 0.0);
            for (after, rise) in cluster.iter() {
                sum += rise;
                // whole samples as the rise goes on, all of them by its end
                let count = f64::round(sum) - placed;
                if count >= 1.0 {
                    placed += count;
                    found.push((*after, count.min(MOST_LOST) as usize));
                }
            }
        }
        cluster.clear();
    };
    for i in 0..e.len() - 1 {
        let rise = (e[i + 1] - e[i]) / period;
        if rise < 0.25 || stamps[i] > last {
            continue;
        }
        if cluster.last().is_some_and(|(before, _)| stamps[i] - stamps[before + 1] > together) {
            close(&mut cluster);
        }
        cluster.push((i, rise));
    }
    close(&mut cluster);
    found
}

/// One slope for all pieces between losses, each with its own offset, through the earlier half of the stamps.
fn slope_between_losses(stamps: &[f64], missing: &[(usize, usize)], period: f64) -> f64 {
    let e = earliest_offsets(stamps, period);
    let delays: Vec<f64> = (0..e.len()).map(|i| stamps[i] - i as f64 * period - e[i]).collect();
    let early = median(&delays);
    let ends = missing.iter().map(|(after, _)| after + 1).chain([stamps.len()]);
    let (mut begin, mut moment, mut square) = (0, 0.0, 0.0);
    for end in ends {
        let chosen: Vec<usize> = (begin..end).filter(|&i| delays[i] <= early).collect();
        let n = chosen.len() as f64;
        let x = chosen.iter().map(|&i| i as f64).sum::<f64>() / n;
        let y = chosen.iter().map(|&i| stamps[i]).sum::<f64>() / n;
        for &i in &chosen {
            moment += (i as f64 - x) * (stamps[i] - y);
            square += (i as f64 - x).powi(2);
        }
        begin = end;
    }
    let slope = moment / square;
    if slope > 0.0 && slope.is_finite() { slope } else { period }
}

/// A line through the earlier half of the stamps over their ticks.
fn earliest_slope(stamps: &[f64], ticks: &[f64], period: f64) -> f64 {
    let offsets: Vec<f64> = stamps.iter().zip(ticks).map(|(t, k)| t - k * period).collect();
    let middle = median(&offsets);
    line_slope(ticks, stamps, |i| offsets[i] <= middle).filter(|s| *s > 0.0).unwrap_or(period)
}

/// Least-squares slope of y over x, where `chosen`.
fn line_slope(x: &[f64], y: &[f64], chosen: impl Fn(usize) -> bool) -> Option<f64> {
    let points: Vec<usize> = (0..x.len()).filter(|&i| chosen(i)).collect();
    let n = points.len() as f64;
    let mx = points.iter().map(|&i| x[i]).sum::<f64>() / n;
    let my = points.iter().map(|&i| y[i]).sum::<f64>() / n;
    let moment: f64 = points.iter().map(|&i| (x[i] - mx) * (y[i] - my)).sum();
    let square: f64 = points.iter().map(|&i| (x[i] - mx).powi(2)).sum();
    Some(moment / square).filter(|s| s.is_finite())
}

/// The middle value; 0 of nothing.
pub(super) fn median(values: &[f64]) -> f64 {
    quantile(values, 0.5)
}

fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted.get((share * (sorted.len().max(1) - 1) as f64).round() as usize).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Deterministic numbers in [0, 1).
    fn shake(k: usize) -> f64 {
        ((k as f64 * 12.9898).sin() * 43_758.545).rem_euclid(1.0)
    }

    /// When each sample was taken at 117.6 Hz with samples lost after these indices.
    fn taken(n: usize, lost: &[(usize, usize)]) -> Vec<f64> {
        ticks(n, lost).iter().map(|k| 0.26 + k / 117.6).collect()
    }

    /// What a reader that polls at uneven intervals of 50 to 75 ms writes.
    fn delivered(taken: &[f64]) -> Vec<f64> {
        let (mut poll, mut k) = (0.3, 0);
        taken
            .iter()
            .map(|t| {
                while poll < *t {
                    poll += 0.05 + 0.025 * shake(k);
                    k += 1;
                }
                poll
            })
            .collect()
    }

    #[test]
    fn bursts_do_not_bend_the_clock() {
        let clock = Clock::from_stamps(&delivered(&taken(4000, &[]))).unwrap();
        assert!((clock.period_s * 117.6 - 1.0).abs() < 5e-5, "{}", 1.0 / clock.period_s);
        assert_eq!(clock.missing, []);
        assert!((clock.jitter_rms_s - 0.019).abs() < 0.005, "{}", clock.jitter_rms_s);
        assert!((clock.start_s - 0.26).abs() < 0.005);
    }

    #[test]
    fn lost_samples_show_through_bursts() {
        let lost = [(700, 5), (1900, 4), (2600, 300), (3100, 5)];
        let clock = Clock::from_stamps(&delivered(&taken(4000, &lost))).unwrap();
        assert!((clock.period_s * 117.6 - 1.0).abs() < 2e-4, "{}", 1.0 / clock.period_s);
        let total: usize = clock.missing.iter().map(|m| m.1).sum();
        assert!(total.abs_diff(314) <= 1, "{:?}", clock.missing);
        for (after, count) in lost {
            let near: usize = clock.missing.iter().filter(|m| m.0.abs_diff(after) < 20).map(|m| m.1).sum();
            assert!(near.abs_diff(count) <= 1, "{after}: {:?}", clock.missing);
        }
    }

    #[test]
    fn a_stall_that_is_made_up_for_loses_nothing() {
        let mut stamps = delivered(&taken(4000, &[]));
        // nothing arrives for five seconds, then all of it at once
        let until = stamps[150] + 5.0;
        stamps.iter_mut().skip(150).for_each(|t| *t = t.max(until));
        let clock = Clock::from_stamps(&stamps).unwrap();
        assert_eq!(clock.missing, []);
        assert!((clock.period_s * 117.6 - 1.0).abs() < 2e-4);
        assert!(clock.backlog > 500 && (clock.largest_delay_s - 5.0).abs() < 0.1, "{clock:?}");
    }

    #[test]
    fn single_samples_missing_between_good_stamps_are_all_found() {
        let lost: Vec<(usize, usize)> = (0..60).map(|k| (20 + 31 * k, 1 + k % 2)).collect();
        // stamps with three digits, as many loggers write them
        let stamps: Vec<f64> = taken(2000, &lost).iter().map(|t| (t * 1e3).round() / 1e3).collect();
        let clock = Clock::from_stamps(&stamps).unwrap();
        assert_eq!(clock.missing, lost);
        // the rounding of a stamp over the whole length, 1 ms in 17 s, is 6e-5
        assert!((clock.period_s * 117.6 - 1.0).abs() < 2e-5);
        assert!(clock.jitter_rms_s < 0.4e-3 && clock.backlog == 0);
    }

    #[test]
    fn stamps_that_are_no_time_are_refused() {
        let good: Vec<f64> = (0..100).map(f64::from).collect();
        let fails = |stamps: &[f64]| Clock::from_stamps(stamps).unwrap_err().to_string();
        assert!(fails(&good[..10]).contains("at least 16 samples, found 10"));
        assert!(fails(&[1.0; 100]).contains("times that advance"));
        let mut back = good.clone();
        back[7] = 5.5;
        assert!(fails(&back).contains("5.5 after 6 at sample 7"));
        back[7] = f64::NAN;
        assert!(fails(&back).contains("finite"));
    }
}
