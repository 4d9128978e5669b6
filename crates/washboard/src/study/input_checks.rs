//! What is looked at before an identification: known values, recordings given twice, single wild samples.

use super::identify_outcome::Flag;
use super::{IdentifyMethod, IdentifySpec, StudyError};
use crate::signal::Recording;

/// A value so many times its channel's rms is no vibration: potholes reach about thirty.
const WILD: f64 = 60.0;

/// Known values belong to a vehicle model, and each name has one.
pub(super) fn known(spec: &IdentifySpec) -> Result<(), StudyError> {
    let refuse = |expected: &str, found: String| {
        Err(StudyError::Setting { field: "known", expected: expected.to_owned(), found })
    };
    if !spec.known.is_empty() && spec.method != IdentifyMethod::Physical {
        return refuse("method physical: the others have no masses", spec.method.name().into());
    }
    for (index, (name, value)) in spec.known.iter().enumerate() {
        if !(value.is_finite() && value.abs() <= 1e9) {
            return refuse(
                "a value that a vehicle can have",
                format!("{name} = {}", crate::units::plain(*value)),
            );
        }
        if spec.known[..index].iter().any(|(other, _)| other == name) {
            return refuse("each name once", format!("{name} twice"));
        }
    }
    Ok(())
}

/// The same recording twice is no second drive.
pub(super) fn different(recordings: &[(String, Recording)]) -> Result<(), StudyError> {
    for (index, (name, recording)) in recordings.iter().enumerate() {
        if let Some((other, _)) = recordings[..index].iter().find(|(_, r)| r.samples() == recording.samples())
        {
            return Err(StudyError::Setting {
                field: "recording",
                expected: "different recordings: the same one twice is no more evidence".into(),
                found: format!("{name} with the samples of {other}"),
            });
        }
    }
    Ok(())
}

/// Channels whose spectra a single sample makes, and channels that are copies of each other.
pub(super) fn suspicious(recordings: &[(String, Recording)]) -> Vec<Flag> {
    let mut flags = Vec::new();
    for (name, recording) in recordings {
        for (channel, samples) in recording.channels().iter().zip(recording.samples()) {
            let mean = samples.iter().sum::<f64>() / samples.len() as f64;
            let (at, largest) = samples
                .iter()
                .map(|x| (x - mean).abs())
                .enumerate()
                .fold((0, 0.0f64), |a, b| if b.1 > a.1 { b } else { a });
            // without the largest one itself, which may be all there is
            let rest = samples.iter().map(|x| (x - mean).abs()).filter(|d| *d < largest);
            let (sum, count) = rest.fold((0.0, 0usize), |(s, n), d| (s + (d / largest).powi(2), n + 1));
            let rms = largest * (sum / count.max(1) as f64).sqrt();
            if largest > WILD * rms && rms > 0.0 {
                let text = format!(
                    "`{}` of {name} has a sample of {largest:.3e} at {:.3} s, {:.0} times its rms: a fault of the sensor that bends its spectra; cut it out",
                    channel.name,
                    at as f64 / recording.rate_hz(),
                    largest / rms
                );
                flags.push(Flag { name: "wild-sample".into(), text });
            }
        }
        let n = recording.channels().len();
        for i in 0..n {
            for j in 0..i {
                if recording.samples()[i] == recording.samples()[j] {
                    let text = format!(
                        "`{}` and `{}` of {name} are the same samples: one of them is wired or named wrongly",
                        recording.channels()[j].name,
                        recording.channels()[i].name
                    );
                    flags.push(Flag { name: "same-channel".into(), text });
                }
            }
        }
    }
    flags
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::{Channel, Direction, Place, Quantity};

    fn recording(wild: f64) -> Recording {
        let channel = |name: &str| Channel {
            name: name.into(),
            quantity: Quantity::Acceleration,
            direction: Direction::PlusZ,
            place: Place::Body,
            wheel: None,
            at_m: None,
        };
        let wave =
            |phase: f64| -> Vec<f64> { (0..2000).map(|k| (0.1 * f64::from(k) + phase).sin()).collect() };
        let mut first = wave(0.0);
        first[777] = wild;
        let samples = vec![first, wave(1.0), wave(1.0)];
        Recording::new(100.0, None, vec![], vec![channel("a"), channel("b"), channel("c")], samples).unwrap()
    }

    #[test]
    fn wild_samples_and_copies_are_named() {
        let named = |wild: f64| suspicious(&[("RUN".to_owned(), recording(wild))]);
        let calm = named(1.0);
        assert_eq!(calm.len(), 1);
        assert!(calm[0].name == "same-channel" && calm[0].text.contains("`b` and `c`"));
        for wild in [1e3, -1e30, 1e300] {
            let flags = named(wild);
            assert!(flags[0].name == "wild-sample" && flags[0].text.contains("at 7.770 s"), "{flags:?}");
        }
    }

    #[test]
    fn the_same_recording_twice_and_a_name_twice_are_refused() {
        let one = ("A".to_owned(), recording(1.0));
        assert!(different(&[one.clone(), ("B".to_owned(), recording(2.0))]).is_ok());
        let e = different(&[one.clone(), ("B".to_owned(), one.1)]).unwrap_err().to_string();
        assert!(e.contains("B with the samples of A"), "{e}");
        let asked = |values: &[f64]| IdentifySpec {
            known: values.iter().map(|v| ("sprung_mass_kg".to_owned(), *v)).collect(),
            ..IdentifySpec::default()
        };
        assert!(known(&asked(&[1150.0])).is_ok());
        assert!(known(&asked(&[1150.0, 2000.0])).unwrap_err().to_string().contains("twice"));
        assert!(known(&asked(&[1e300])).is_err());
        let free = IdentifySpec { method: IdentifyMethod::Tvimm, ..asked(&[1150.0]) };
        assert!(known(&free).unwrap_err().to_string().contains("no masses"));
    }
}
