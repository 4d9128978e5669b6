//! What is identified as one run: a whole recording, or the parts of one whose speed varies.

use super::drives::{segments, spectra_of_pieces};
use super::identify_operational::FDD_SEGMENTS;
use super::identify_outcome::Flag;
use super::{IdentifyMethod, IdentifySpec, StudyError};
use crate::signal::{CrossSpectra, Recording, SpeedClass, SpeedCutSettings, by_speed};
use std::ops::Range;

/// A speed that spreads more than this about its mean blurs delays and frequencies of the road.
const SPEED_SPREAD: f64 = 0.03;
/// Segments are a share of what is identified (see [`segments`]), within these lengths in s: long ones keep the fine
/// structure that delays give to spectra.
const SEGMENT_S: [f64; 2] = [5.0, 20.0];
/// A piece of steady speed holds so many segments, or is left out.
const SEGMENTS_A_PIECE: f64 = 3.0;
/// What estimates correlations wants a piece of so many of the shortest segments, in one: about 25 averages a bin.
const SEGMENTS_IN_ONE: f64 = 12.0;
/// Segments are shortened until the pieces that are long enough for them hold this share of a part.
const KEPT: f64 = 0.75;
/// Parts of one recording, at most.
const MOST_PARTS: usize = 6;
/// A segment has so many samples at least.
const FEWEST_SAMPLES: usize = 8;
/// Slower than this, in m/s, a vehicle stands or crawls: nothing of its suspension is seen.
const SLOWEST_M_S: f64 = 1.0;

/// What is identified as one run.
#[derive(Debug, Clone)]
pub(super) struct Part {
    /// The recording's, with the speed where it is a part.
    pub name: String,
    /// Detrended by piece, the pieces one after another.
    pub recording: Recording,
    /// Samples of each piece.
    pub pieces: Vec<Range<usize>>,
    pub spectra: CrossSpectra,
}

/// The parts of one recording, and what is to be said about them.
#[derive(Debug, Clone)]
pub(super) struct Parts {
    pub parts: Vec<Part>,
    pub flag: Option<Flag>,
    pub note: Option<Flag>,
}

/// The whole recording, or its parts where its speed varies; `among` is its name in texts where there are several.
///
/// # Errors
/// A recording too short for its segments.
pub(super) fn parts(
    recording: &Recording,
    name: &str,
    among: &str,
    spec: &IdentifySpec,
) -> Result<Parts, StudyError> {
    let of_name = if among.is_empty() { String::new() } else { format!("{among}: ") };
    let (Some(mean), Some(spread)) = (recording.speed_m_s(), recording.speed_spread_m_s()) else {
        return Ok(Parts { parts: vec![whole(recording, name, spec)?], flag: None, note: None });
    };
    if spread <= SPEED_SPREAD * mean {
        return Ok(Parts { parts: vec![whole(recording, name, spec)?], flag: None, note: None });
    }
    let varies = format!("{of_name}the speed varies by {spread:.2} m/s about {mean:.2} m/s");
    let note = |name: &str, text| Some(Flag { name: name.into(), text });
    match cut(recording, name, spec)? {
        Cut::Parts(parts, told) => {
            Ok(Parts { parts, flag: None, note: note("cut-by-speed", format!("{varies}: {told}")) })
        }
        Cut::Noise => {
            let text = format!(
                "{of_name}the recorded speed scatters by {spread:.2} m/s about {mean:.2} m/s, and smoothed stays within {} %: taken as constant",
                100.0 * SPEED_SPREAD
            );
            Ok(Parts {
                parts: vec![whole(recording, name, spec)?],
                flag: None,
                note: note("speed-noise", text),
            })
        }
        Cut::Impossible(why) => {
            let text = format!(
                "{varies}: delays and road frequencies are blurred; it cannot be cut into parts of steady speed: {why}"
            );
            let flag = Some(Flag { name: "speed-varies".into(), text });
            Ok(Parts { parts: vec![whole(recording, name, spec)?], flag, note: None })
        }
    }
}

fn whole(recording: &Recording, name: &str, spec: &IdentifySpec) -> Result<Part, StudyError> {
    // detrending takes drift out of displacements and slow sensors
    let recording = recording.detrended();
    let len = segment_len(&recording, segment_s(recording.duration_s(), spec));
    if let Some(asked) = spec.segment_s
        && !(FEWEST_SAMPLES..=recording.len()).contains(&len)
    {
        let shortest = FEWEST_SAMPLES as f64 / recording.rate_hz();
        let (longest, which) = match spec.method {
            IdentifyMethod::Fdd => {
                (recording.duration_s() / FDD_SEGMENTS as f64, "a quarter of the recording, for method fdd")
            }
            _ => (recording.duration_s(), "the recording"),
        };
        return Err(StudyError::Setting {
            field: "segment_s",
            expected: format!("from {shortest} s ({FEWEST_SAMPLES} samples) to {longest} s ({which})",),
            found: format!("{asked} s"),
        });
    }
    let pieces: Vec<Range<usize>> = std::iter::once(0..recording.len()).collect();
    let spectra = spectra_of_pieces(&recording, &pieces, len)?;
    Ok(Part { name: name.to_owned(), recording, pieces, spectra })
}

/// The segment asked for, or a share of what there is.
fn segment_s(duration_s: f64, spec: &IdentifySpec) -> f64 {
    let usual = || (duration_s / segments(spec.method)).clamp(SEGMENT_S[0], SEGMENT_S[1]);
    spec.segment_s.unwrap_or_else(usual)
}

/// As Welch's method rounds it.
fn segment_len(recording: &Recording, segment_s: f64) -> usize {
    (segment_s * recording.rate_hz()).round() as usize
}

/// What came of cutting.
enum Cut {
    /// The parts, and how they were made, in words.
    Parts(Vec<Part>, String),
    /// One piece is all of the drive: only the sensor varies.
    Noise,
    /// Why there are no parts.
    Impossible(String),
}

fn cut(recording: &Recording, name: &str, spec: &IdentifySpec) -> Result<Cut, StudyError> {
    if recording.speed_series().is_none() {
        return Ok(Cut::Impossible(
            "only its mean is known (a speed_column, or a speed_file with a time_column, tells it over time)"
                .into(),
        ));
    }
    let in_one = spec.method.is_operational();
    let shortest_s =
        spec.segment_s.unwrap_or(SEGMENT_S[0]) * if in_one { SEGMENTS_IN_ONE } else { SEGMENTS_A_PIECE };
    let settings = SpeedCutSettings { tolerance: SPEED_SPREAD, shortest_s, slowest_m_s: SLOWEST_M_S };
    let found = by_speed(recording, &settings)?;
    let percent = 100.0 * SPEED_SPREAD;
    if found.classes.is_empty() {
        return Ok(Cut::Impossible(format!(
            "the longest stretch within {percent} % of its mean speed (and above {SLOWEST_M_S} m/s) lasts {:.1} s, and {shortest_s:.1} s are needed",
            found.longest_s
        )));
    }
    if let [class] = found.classes.as_slice()
        && class.pieces.as_slice() == std::slice::from_ref(&(0..recording.len()))
    {
        return Ok(Cut::Noise);
    }
    let mut made = Vec::new();
    let mut most: f64 = 0.0;
    let needed = 2.0 * recording.channels().len() as f64;
    for class in &found.classes {
        let part = part(recording, name, class, in_one, spec)?;
        most = most.max(part.spectra.averages);
        // a likelihood wants twice as many averages as channels
        if in_one || part.spectra.averages >= needed {
            made.push(part);
        }
    }
    if made.is_empty() {
        return Ok(Cut::Impossible(format!(
            "its longest part at one speed gives {most:.1} averages a bin, and {needed:.0} are needed for {} channels",
            recording.channels().len()
        )));
    }
    made.sort_by_key(|part: &Part| std::cmp::Reverse(part.recording.len()));
    let beyond = made.len().saturating_sub(MOST_PARTS);
    made.truncate(MOST_PARTS);
    let told = told(&made, beyond, recording, shortest_s, in_one);
    Ok(Cut::Parts(made, told))
}

/// The class's pieces as one recording at its speed; the longest alone where correlations are to be estimated.
fn part(
    recording: &Recording,
    name: &str,
    class: &SpeedClass,
    in_one: bool,
    spec: &IdentifySpec,
) -> Result<Part, StudyError> {
    let len = if in_one {
        None
    } else {
        // pieces that are long enough hold most of the part
        let most = (holding(&class.pieces, KEPT) as f64 / SEGMENTS_A_PIECE) as usize;
        let usual = segment_len(recording, segment_s(class.duration_s, spec));
        Some(if spec.segment_s.is_some() { usual } else { usual.min(most) })
    };
    let mut chosen = class.pieces.clone();
    let len = match len {
        // two samples are the rounding of three segments
        Some(len) => {
            chosen.retain(|p| (p.len() + 2) as f64 >= SEGMENTS_A_PIECE * len as f64);
            len
        }
        None => {
            // the first of the longest
            chosen.sort_by_key(|p| (std::cmp::Reverse(p.len()), p.start));
            chosen.truncate(1);
            let duration_s = chosen.iter().map(Range::len).sum::<usize>() as f64 / recording.rate_hz();
            segment_len(recording, segment_s(duration_s, spec))
        }
    };
    let cut = chosen
        .iter()
        .map(|p| Ok(recording.part(p.clone())?.detrended()))
        .collect::<Result<Vec<_>, StudyError>>()?;
    let joined = joined(recording, &cut)?;
    let mut start = 0;
    let mut pieces = Vec::new();
    for piece in &cut {
        pieces.push(start..start + piece.len());
        start += piece.len();
    }
    let speed = joined.speed_m_s().unwrap_or(class.speed_m_s);
    let name = format!("{name} at {} m/s", digits(speed)).trim().to_owned();
    let spectra = spectra_of_pieces(&joined, &pieces, len)?;
    Ok(Part { name, recording: joined, pieces, spectra })
}

/// The length of the piece at which those as long or longer hold a share of all.
fn holding(pieces: &[Range<usize>], share: f64) -> usize {
    let mut lengths: Vec<usize> = pieces.iter().map(Range::len).collect();
    lengths.sort_unstable_by_key(|length| std::cmp::Reverse(*length));
    let total: usize = lengths.iter().sum();
    let mut sum = 0;
    for length in lengths {
        sum += length;
        if sum as f64 >= share * total as f64 {
            return length;
        }
    }
    0
}

/// Pieces one after another, with the mean and spread of their speed.
fn joined(recording: &Recording, pieces: &[Recording]) -> Result<Recording, StudyError> {
    let samples = (0..recording.channels().len())
        .map(|i| pieces.iter().flat_map(|p| &p.samples()[i]).copied().collect())
        .collect();
    let speed: Vec<f64> = pieces.iter().filter_map(Recording::speed_series).flatten().copied().collect();
    let mean = speed.iter().sum::<f64>() / speed.len() as f64;
    let spread = (speed.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / speed.len() as f64).sqrt();
    let (wheels, channels) = (recording.wheels().to_vec(), recording.channels().to_vec());
    Ok(Recording::new(recording.rate_hz(), Some(mean), wheels, channels, samples)?
        .with_speed_spread(spread)?
        .with_speed_series(speed)?
        .with_repairs(recording.repairs().iter().cloned()))
}

fn digits(speed_m_s: f64) -> String {
    if speed_m_s < 5.0 { format!("{speed_m_s:.2}") } else { format!("{speed_m_s:.1}") }
}

/// The parts in words.
fn told(parts: &[Part], beyond: usize, recording: &Recording, shortest_s: f64, in_one: bool) -> String {
    let each: Vec<String> = parts
        .iter()
        .map(|part| {
            let speed = digits(part.recording.speed_m_s().unwrap_or_default());
            let pieces = match part.pieces.len() {
                1 => String::new(),
                n => format!(" in {n} pieces"),
            };
            format!("{speed} m/s for {:.1} s{pieces}", part.recording.duration_s())
        })
        .collect();
    let used: f64 = parts.iter().map(|p| p.recording.duration_s()).sum();
    let left_out = recording.duration_s() - used;
    let how = match (parts.len(), in_one) {
        (1, _) => "one part of steady speed is used",
        (_, true) => "cut into parts of steady speed, each identified by itself (the longest above)",
        (_, false) => "cut into parts of steady speed, identified as recordings of their own",
    };
    let beyond = match (beyond, in_one) {
        (0, false) => String::new(),
        (0, true) => ", or there is a longer piece of the same speed".into(),
        (n, _) => format!(", and in {n} shorter parts beyond the longest {MOST_PARTS}"),
    };
    format!(
        "{how}: {}; left out are {left_out:.1} s of {:.1} s ({:.1} %), where the speed leaves {} % of its mean within {shortest_s:.0} s{beyond}",
        each.join(", "),
        recording.duration_s(),
        100.0 * left_out / recording.duration_s(),
        100.0 * SPEED_SPREAD,
    )
}

#[cfg(test)]
mod tests {
    use super::super::IdentifyMethod;
    use super::*;
    use crate::signal::{Channel, Direction, Place, Quantity, Segment, WelchSettings, welch};
    use rand::{Rng, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::StandardNormal;

    const RATE: f64 = 20.0;

    /// White noise under this speed; its mean and spread as a reader has them.
    fn drive(channels: usize, speed: &[f64]) -> Recording {
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        let channel = |i: usize| Channel {
            name: format!("c{i}"),
            quantity: Quantity::Acceleration,
            direction: Direction::PlusZ,
            place: Place::Body,
            wheel: None,
            at_m: None,
        };
        let samples = (0..channels)
            .map(|_| speed.iter().map(|_| rng.sample::<f64, _>(StandardNormal)).collect())
            .collect();
        let mean = speed.iter().sum::<f64>() / speed.len() as f64;
        let spread = (speed.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / speed.len() as f64).sqrt();
        let channels = (0..channels).map(channel).collect();
        let r = Recording::new(RATE, Some(mean), vec![], channels, samples).unwrap();
        r.with_speed_spread(spread).unwrap()
    }

    fn timed(channels: usize, speed: Vec<f64>) -> Recording {
        drive(channels, &speed).with_speed_series(speed).unwrap()
    }

    fn steps(of: &[(f64, f64)]) -> Vec<f64> {
        of.iter().flat_map(|(v, s)| vec![*v; (s * RATE) as usize]).collect()
    }

    fn parts_of(recording: &Recording, method: IdentifyMethod) -> Parts {
        let spec = IdentifySpec { method, ..IdentifySpec::default() };
        parts(recording, "RUN.toml", "", &spec).unwrap()
    }

    fn physical(recording: &Recording) -> Parts {
        parts_of(recording, IdentifyMethod::Physical)
    }

    #[test]
    fn a_drive_of_constant_speed_is_untouched() {
        let speed = steps(&[(20.0, 290.0), (20.5, 310.0)]);
        for r in [drive(2, &speed), timed(2, speed.clone())] {
            let got = physical(&r);
            assert!(got.flag.is_none() && got.note.is_none());
            let [part] = got.parts.as_slice() else { panic!("{} parts", got.parts.len()) };
            assert_eq!((part.name.as_str(), &part.recording), ("RUN.toml", &r.detrended()));
            // a segment of 20 s at 600 s, as Welch has it of the whole
            let direct = welch(&r.detrended(), &WelchSettings::hann(Segment::Seconds(20.0))).unwrap();
            assert_eq!(part.spectra.averages.to_bits(), direct.averages.to_bits());
            assert!(
                part.spectra.s.iter().zip(&direct.s).all(|(a, b)| (0..2).all(|i| a[(i, 1)] == b[(i, 1)]))
            );
        }
    }

    #[test]
    fn a_drive_of_two_speeds_is_cut_and_told() {
        let r = timed(2, steps(&[(10.0, 100.0), (20.0, 300.0), (10.0, 60.0), (20.0, 20.0), (10.0, 12.0)]));
        let got = physical(&r);
        assert!(got.flag.is_none());
        let [long, short] = got.parts.as_slice() else { panic!("{:?}", got.note) };
        assert_eq!(
            (long.name.as_str(), short.name.as_str()),
            ("RUN.toml at 20.0 m/s", "RUN.toml at 10.0 m/s")
        );
        // 20 m/s: two pieces, but segments of a fifteenth leave the short one out; 10 m/s: both
        assert_eq!((long.pieces.len(), short.pieces.len()), (1, 2));
        assert_eq!(long.pieces[0], 0..long.recording.len());
        assert_eq!(short.pieces[0].end, short.pieces[1].start);
        assert!((long.recording.duration_s() - 295.0).abs() < 3.0);
        assert!((short.recording.duration_s() - 154.0).abs() < 3.0, "{}", short.recording.duration_s());
        for (part, speed) in [(long, 20.0), (short, 10.0)] {
            assert!((part.recording.speed_m_s().unwrap() / speed - 1.0).abs() < 2e-3);
            let each = SEGMENTS_A_PIECE * part.spectra.segment_len as f64;
            assert!(part.pieces.iter().all(|p| (p.len() + 2) as f64 >= each));
            assert_eq!(part.spectra.pieces.len(), part.pieces.len());
            // each piece without its own mean
            for p in &part.pieces {
                let sum: f64 = part.recording.samples()[0][p.clone()].iter().sum();
                assert!(sum.abs() < 1e-9);
            }
        }
        // the words have the drive's numbers
        let text = got.note.unwrap().text;
        let left_out = r.duration_s() - long.recording.duration_s() - short.recording.duration_s();
        for part in
            ["20.0 m/s for 29", "10.0 m/s for 15", "in 2 pieces", &format!("{left_out:.1} s of 492.0 s")]
        {
            assert!(text.contains(part), "{text}");
        }
        // correlations are of one piece
        let got = parts_of(&r, IdentifyMethod::Ssi);
        assert!(got.parts.iter().all(|p| p.pieces.len() == 1));
        assert!((got.parts[1].recording.duration_s() - 97.5).abs() < 2.0, "{:?}", got.note);
    }

    #[test]
    fn where_cutting_is_impossible_the_flag_says_why() {
        let words = |r: &Recording| {
            let got = physical(r);
            assert!(got.note.is_none() && got.parts.len() == 1 && got.parts[0].name == "RUN.toml");
            let flag = got.flag.unwrap();
            assert_eq!(flag.name, "speed-varies");
            flag.text
        };
        let two = steps(&[(10.0, 100.0), (20.0, 100.0)]);
        let text = words(&drive(2, &two));
        assert!(
            text.contains("varies by 5.00 m/s about 15.00 m/s") && text.contains("only its mean"),
            "{text}"
        );
        let rising: Vec<f64> = (0..2400).map(|k| 10.0 + f64::from(k) / 120.0).collect();
        let text = words(&timed(2, rising));
        // ±3 % of 29 m/s are passed in 10.5 s, and the moving mean is flatter at the end; cuts are on halves of a second
        assert!(text.contains("lasts 11.0 s, and 15.0 s are needed"), "{text}");
        // 30 s in segments of 5 s: 11 averages, for 8 channels
        let text = words(&timed(8, steps(&[(10.0, 30.0), (20.0, 30.0), (30.0, 30.0)])));
        assert!(text.contains("averages a bin, and 16 are needed for 8 channels"), "{text}");
    }

    #[test]
    fn a_speed_sensors_noise_is_no_varying_speed() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let speed = (0..6000).map(|_| 20.0 + rng.sample::<f64, _>(StandardNormal)).collect();
        let got = physical(&timed(2, speed));
        assert_eq!((got.parts.len(), got.flag), (1, None));
        let note = got.note.unwrap();
        assert!(note.name == "speed-noise" && note.text.contains("about 20.0"), "{note:?}");
    }

    #[test]
    fn at_most_six_parts_the_longest() {
        let r = timed(2, steps(&[5.0, 7.0, 9.0, 12.0, 15.0, 18.0, 22.0, 26.0].map(|v| (v, 30.0 + v))));
        let got = physical(&r);
        let speeds: Vec<f64> = got.parts.iter().map(|p| p.recording.speed_m_s().unwrap().round()).collect();
        assert_eq!(speeds, [26.0, 22.0, 18.0, 15.0, 12.0, 9.0]);
        assert!(got.note.unwrap().text.contains("in 2 shorter parts beyond the longest 6"));
    }
}
