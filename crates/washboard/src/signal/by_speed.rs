//! A drive cut into stretches of steady speed, and stretches of nearly one speed put together.

use super::recording::mean_and_spread;
use super::{Recording, SignalError};
use std::ops::Range;

/// Faster changes of the recorded speed are its sensor's noise, in s: a car gains 3 m/s in a second at most, satellite
/// receivers scatter by 0.3 m/s from fix to fix, and Welch's segments are not shorter.
pub const SPEED_SMOOTHING_S: f64 = 5.0;
/// Cuts lie on multiples of this, in s.
const CELL_S: f64 = 0.5;

/// What counts as one speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpeedCutSettings {
    /// The smoothed speed stays within this share of its piece's mean; so do the pieces of a class with its longest.
    pub tolerance: f64,
    /// Shorter pieces are left out, in s.
    pub shortest_s: f64,
    /// Slower than this, in m/s, a vehicle stands or crawls: left out.
    pub slowest_m_s: f64,
}

/// Pieces of nearly one speed.
#[derive(Debug, Clone, PartialEq)]
pub struct SpeedClass {
    /// Mean of the recorded speed over all pieces.
    pub speed_m_s: f64,
    /// Its standard deviation there, the sensor's noise included.
    pub spread_m_s: f64,
    /// Samples of each piece, in the order of the drive.
    pub pieces: Vec<Range<usize>>,
    /// Of all pieces.
    pub duration_s: f64,
}

/// A drive cut by speed.
#[derive(Debug, Clone, PartialEq)]
pub struct SpeedCut {
    /// The longest first.
    pub classes: Vec<SpeedClass>,
    /// Of the whole drive.
    pub duration_s: f64,
    /// Of what belongs to no class.
    pub left_out_s: f64,
    /// The longest stretch of steady speed, also where it is too short for a piece.
    pub longest_s: f64,
}

/// Cuts a recording into pieces of steady speed.
///
/// The speed is smoothed by a moving mean over [`SPEED_SMOOTHING_S`]. The longest stretch in which all of it lies within
/// `tolerance` of the stretch's mean becomes a piece, then the longest of what is before and after it, and so on down to
/// `shortest_s`. Then the longest piece founds a class, which all pieces join whose mean is within `tolerance` of its
/// own; the longest of the others founds the next one. Samples whose speed is not known are in no piece.
///
/// # Errors
/// A recording without a speed at each sample; a tolerance outside (0, 1), a shortest piece or slowest speed that is not
/// positive.
pub fn by_speed(recording: &Recording, settings: &SpeedCutSettings) -> Result<SpeedCut, SignalError> {
    let SpeedCutSettings { tolerance, shortest_s, slowest_m_s } = *settings;
    for (name, found, most) in [
        ("tolerance", tolerance, 1.0),
        ("shortest_s", shortest_s, f64::INFINITY),
        ("slowest_m_s", slowest_m_s, f64::INFINITY),
    ] {
        if !(found > 0.0 && found < most) {
            return Err(SignalError::Value { name, expected: "a positive number (a share below 1)", found });
        }
    }
    let speed = recording.speed_series().ok_or(SignalError::NoSpeedSeries)?;
    let rate = recording.rate_hz();
    let cell = ((CELL_S * rate).round() as usize).max(1);
    let shortest = (shortest_s * rate).ceil() as usize;
    let smooth: Vec<f64> = smoothed(speed, cell, (SPEED_SMOOTHING_S * rate / 2.0).round() as usize)
        .into_iter()
        .map(|v| if v >= slowest_m_s { v } else { f64::NAN })
        .collect();
    // the last cell holds what is left of the drive
    let samples = |cells: &Range<usize>| {
        cells.start * cell..if cells.end == smooth.len() { speed.len() } else { cells.end * cell }
    };
    let table = Extremes::new(&smooth);
    let longest = steady(&table, 0..smooth.len(), tolerance).map_or(0..0, |cells| samples(&cells));
    let mut pieces = Vec::new();
    let mut open: Vec<Range<usize>> = std::iter::once(0..smooth.len()).collect();
    while let Some(range) = open.pop() {
        let Some(found) = steady(&table, range.clone(), tolerance) else { continue };
        let piece = samples(&found);
        if piece.len() >= shortest {
            open.extend([range.start..found.start, found.end..range.end]);
            pieces.push(piece);
        }
    }
    let classes = classes(speed, pieces, tolerance, rate);
    let duration_s = recording.duration_s();
    let used: f64 = classes.iter().map(|c| c.duration_s).sum();
    Ok(SpeedCut {
        classes,
        duration_s,
        left_out_s: duration_s - used,
        longest_s: longest.len() as f64 / rate,
    })
}

/// Means over windows about the middles of cells; NaN where a sample of the cell is not known.
fn smoothed(speed: &[f64], cell: usize, half: usize) -> Vec<f64> {
    let mut sums = vec![(0.0, 0usize)];
    let (mut sum, mut count) = (0.0, 0);
    for v in speed {
        if v.is_finite() {
            sum += v;
            count += 1;
        }
        sums.push((sum, count));
    }
    let mean = |range: Range<usize>| {
        let count = sums[range.end].1 - sums[range.start].1;
        (count, (sums[range.end].0 - sums[range.start].0) / count as f64)
    };
    (0..(speed.len() / cell).max(1))
        .map(|c| {
            let own = c * cell..((c + 1) * cell).min(speed.len());
            let middle = (own.start + own.end) / 2;
            let half = half.max(cell);
            if mean(own.clone()).0 < own.len() {
                return f64::NAN;
            }
            mean(middle.saturating_sub(half)..(middle + half).min(speed.len())).1
        })
        .collect()
}

/// The first of the longest stretches within `range` whose values are all within a share of their mean.
fn steady(table: &Extremes, range: Range<usize>, tolerance: f64) -> Option<Range<usize>> {
    // values within a tolerance of any mean are within this ratio of each other: that bound moves on with its start
    let ratio = (1.0 + tolerance) / (1.0 - tolerance);
    let (mut best, mut far) = (0..0, range.start);
    for start in range.clone() {
        far = far.max(start);
        while far < range.end {
            let (low, high) = table.of(start..far + 1);
            if !(high <= ratio * low) {
                break;
            }
            far += 1;
        }
        let inside = |end: &usize| {
            let (low, high) = table.of(start..*end);
            let mean = table.mean(start..*end);
            high <= (1.0 + tolerance) * mean && low >= (1.0 - tolerance) * mean
        };
        if let Some(end) = (start + best.len() + 1..=far).rev().find(inside) {
            best = start..end;
        }
    }
    (!best.is_empty()).then_some(best)
}

/// Least and largest value of any stretch by one look (a sparse table), and its mean; NaN where a value is.
struct Extremes {
    levels: Vec<Vec<(f64, f64)>>,
    sums: Vec<f64>,
}

impl Extremes {
    fn new(values: &[f64]) -> Self {
        let mut levels = vec![values.iter().map(|v| (*v, *v)).collect::<Vec<_>>()];
        let mut width = 1;
        while 2 * width <= values.len() {
            let below = &levels[levels.len() - 1];
            let level =
                (0..=values.len() - 2 * width).map(|i| Self::both(below[i], below[i + width])).collect();
            levels.push(level);
            width *= 2;
        }
        let mut sums = vec![0.0];
        let mut sum = 0.0;
        for v in values {
            // a stretch with a NaN is refused by its extremes
            sum += if v.is_nan() { 0.0 } else { *v };
            sums.push(sum);
        }
        Extremes { levels, sums }
    }

    fn both(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
        if a.0.is_nan() || b.0.is_nan() {
            return (f64::NAN, f64::NAN);
        }
        (a.0.min(b.0), a.1.max(b.1))
    }

    fn of(&self, range: Range<usize>) -> (f64, f64) {
        let level = range.len().ilog2();
        let table = &self.levels[level as usize];
        Self::both(table[range.start], table[range.end - (1 << level)])
    }

    fn mean(&self, range: Range<usize>) -> f64 {
        (self.sums[range.end] - self.sums[range.start]) / range.len() as f64
    }
}

fn classes(speed: &[f64], mut pieces: Vec<Range<usize>>, tolerance: f64, rate_hz: f64) -> Vec<SpeedClass> {
    let mean = |p: &Range<usize>| mean_and_spread(&speed[p.clone()]).map_or(f64::NAN, |(mean, _)| mean);
    pieces.sort_by_key(|p| (std::cmp::Reverse(p.len()), p.start));
    let mut classes: Vec<(f64, Vec<Range<usize>>)> = Vec::new();
    for piece in pieces {
        let own = mean(&piece);
        match classes.iter_mut().find(|(of_longest, _)| (own / *of_longest - 1.0).abs() <= tolerance) {
            Some((_, joined)) => joined.push(piece),
            None => classes.push((own, vec![piece])),
        }
    }
    let mut classes: Vec<SpeedClass> = classes
        .into_iter()
        .map(|(own, mut pieces)| {
            pieces.sort_by_key(|p| p.start);
            let all: Vec<f64> = pieces.iter().flat_map(|p| &speed[p.clone()]).copied().collect();
            let (speed_m_s, spread_m_s) = mean_and_spread(&all).unwrap_or((own, 0.0));
            SpeedClass { speed_m_s, spread_m_s, duration_s: all.len() as f64 / rate_hz, pieces }
        })
        .collect();
    classes.sort_by(|a, b| b.duration_s.total_cmp(&a.duration_s));
    classes
}

#[cfg(test)]
mod tests {
    use super::super::{Channel, Direction, Place, Quantity};
    use super::*;
    use rand::{Rng, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::StandardNormal;

    const RATE: f64 = 20.0;
    const SETTINGS: SpeedCutSettings =
        SpeedCutSettings { tolerance: 0.03, shortest_s: 15.0, slowest_m_s: 1.0 };

    fn drive(speed: Vec<f64>) -> Recording {
        let channel = Channel {
            name: "a".into(),
            quantity: Quantity::Acceleration,
            direction: Direction::PlusZ,
            place: Place::Body,
            wheel: None,
            at_m: None,
        };
        let series = (0..speed.len()).map(|k| f64::from(k as u32 % 7)).collect();
        let r = Recording::new(RATE, Some(10.0), vec![], vec![channel], vec![series]).unwrap();
        r.with_speed_series(speed).unwrap()
    }

    /// Stretches of (speed, s), one after another.
    fn steps(of: &[(f64, f64)]) -> Vec<f64> {
        of.iter().flat_map(|(v, s)| vec![*v; (s * RATE) as usize]).collect()
    }

    fn cut(speed: Vec<f64>) -> SpeedCut {
        by_speed(&drive(speed), &SETTINGS).unwrap()
    }

    /// How many s of the moving mean about a jump by `share` of the speed lie beyond 3 % of it: of the window, 5 s wide,
    /// a part x/5 sees the other side, so that x = 5·0.03/share; beyond it the cell (centre within) is cut.
    fn lost_s(share: f64) -> f64 {
        2.5 - SPEED_SMOOTHING_S * 0.03 / share
    }

    #[test]
    fn steps_are_cut_where_the_smoothed_speed_leaves_them() {
        let got = cut(steps(&[(10.0, 100.0), (20.0, 60.0), (10.1, 30.0), (30.0, 5.0), (20.0, 50.0)]));
        // 10 and 10.1 are one speed; 30 m/s for 5 s is too short
        assert_eq!(got.classes.len(), 2, "{got:?}");
        let [ten, twenty] = [&got.classes[0], &got.classes[1]];
        assert_eq!((ten.pieces.len(), twenty.pieces.len()), (2, 2));
        let expected = [
            (&ten.pieces[0], 0.0, 100.0 - lost_s(1.0)),
            (&twenty.pieces[0], 100.0 + lost_s(0.5), 160.0 - lost_s(0.495)),
            (&ten.pieces[1], 160.0 + lost_s(1.0), 190.0 - lost_s(2.0)),
            (&twenty.pieces[1], 195.0 + lost_s(0.5), 245.0),
        ];
        for (piece, from, to) in expected {
            let (start, end) = (piece.start as f64 / RATE, piece.end as f64 / RATE);
            // means lie a little off the steps' speeds, and cuts on a grid of half a second
            assert!((start - from).abs() <= 0.5 && (end - to).abs() <= 0.5, "{start}–{end}: {from}–{to}");
        }
        assert!((ten.speed_m_s - (10.0 * 97.65 + 10.1 * 25.4) / 123.05).abs() < 0.01, "{}", ten.speed_m_s);
        assert!((twenty.speed_m_s - 20.0).abs() < 0.03);
        let used: f64 = got.classes.iter().map(|c| c.duration_s).sum();
        assert!((got.left_out_s - (245.0 - used)).abs() < 1e-9 && (got.duration_s - 245.0).abs() < 1e-9);
        assert!((got.longest_s - ten.pieces[0].len() as f64 / RATE).abs() < 1e-9);
    }

    /// What a piece promises, on a drive that was not made to be cut.
    #[test]
    fn every_piece_is_steady_and_none_could_be_longer() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let (mut v, mut wanted) = (15.0, 15.0);
        let speed: Vec<f64> = (0..(1800.0 * RATE) as usize)
            .map(|k| {
                if k % 900 == 0 {
                    wanted = rng.random_range(0.0..30.0);
                }
                v += (wanted - v) * 0.002;
                v
            })
            .collect();
        let got = cut(speed.clone());
        assert!(got.classes.len() > 2, "{got:?}");
        let smooth = smoothed(&speed, 10, 50);
        let within = |cells: Range<usize>| {
            let mean = smooth[cells.clone()].iter().sum::<f64>() / cells.len() as f64;
            smooth[cells].iter().all(|v| (v / mean - 1.0).abs() <= 0.03 * (1.0 + 1e-9))
        };
        let mut all: Vec<Range<usize>> = got.classes.iter().flat_map(|c| c.pieces.clone()).collect();
        all.sort_by_key(|p| p.start);
        assert!(all.windows(2).all(|w| w[0].end <= w[1].start), "pieces lie apart");
        for p in &all {
            let cells = p.start / 10..p.end / 10;
            assert!(within(cells.clone()) && p.len() as f64 >= 15.0 * RATE);
        }
        // by trying them all: no stretch is longer than the longest
        let longest = all.iter().map(|p| p.len() / 10).max().unwrap();
        for start in 0..smooth.len() - longest - 1 {
            assert!(!within(start..start + longest + 1), "{start}");
        }
        for class in &got.classes {
            assert!(class.spread_m_s <= 0.045 * class.speed_m_s && class.speed_m_s > 1.0);
        }
    }

    #[test]
    fn a_sensors_noise_does_not_cut() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        // 10 % a sample; a satellite receiver's 0.3 m/s once a second
        let white = (0..12_000).map(|_| 20.0 + 2.0 * rng.sample::<f64, _>(StandardNormal)).collect();
        let mut fix = 0.0;
        let held = (0..12_000)
            .map(|k| {
                if k % 20 == 0 {
                    fix = 20.0 + 0.3 * rng.sample::<f64, _>(StandardNormal);
                }
                fix
            })
            .collect();
        for speed in [white, held] {
            let got = cut(speed);
            assert_eq!((got.classes.len(), got.left_out_s), (1, 0.0));
            assert_eq!(got.classes[0].pieces, std::iter::once(0..12_000).collect::<Vec<_>>());
        }
    }

    #[test]
    fn what_accelerates_stands_or_is_not_known_gives_no_piece() {
        // 10 to 30 m/s in 120 s: ±3 % of 29 m/s are passed in 1.74/(1/6) = 10 s
        let got = cut((0..2400).map(|k| 10.0 + f64::from(k) / 120.0).collect());
        assert!(got.classes.is_empty() && (got.left_out_s - 120.0).abs() < 1e-9);
        assert!((got.longest_s - 10.4).abs() < 0.8, "{}", got.longest_s);
        assert!(cut(steps(&[(0.3, 100.0)])).classes.is_empty());
        let mut gap = steps(&[(10.0, 100.0)]);
        gap[800..1000].fill(f64::NAN);
        let got = cut(gap);
        assert_eq!(got.classes[0].pieces, [0..800, 1000..2000]);
        assert!((got.left_out_s - 10.0).abs() < 1e-9);
    }

    #[test]
    fn what_is_missing_is_said() {
        let bare = drive(vec![10.0; 400]);
        let r = Recording::new(RATE, Some(10.0), vec![], bare.channels().to_vec(), bare.samples().to_vec());
        assert!(matches!(by_speed(&r.unwrap(), &SETTINGS), Err(SignalError::NoSpeedSeries)));
        for wrong in [
            SpeedCutSettings { tolerance: 1.0, ..SETTINGS },
            SpeedCutSettings { shortest_s: f64::NAN, ..SETTINGS },
            SpeedCutSettings { slowest_m_s: 0.0, ..SETTINGS },
        ] {
            assert!(by_speed(&bare, &wrong).is_err());
        }
    }
}
