//! The recordings of `examples/recordings`, read from the real data where it is present.

#![allow(clippy::unwrap_used, clippy::print_stderr)]

use std::path::{Path, PathBuf};
use washboard::signal::{
    CrossSpectra, Recording, RepairKind, Segment, SignalError, WelchSettings, read_recording, welch,
};

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/recordings").join(name)
}

/// The recording, or none with a word where `data` is not on this machine.
fn read(name: &str, data: &str) -> Option<Recording> {
    let place = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data").join(data);
    if !place.exists() {
        eprintln!("skipped: {} is not here", place.display());
        return None;
    }
    Some(read_recording(&example(name)).unwrap_or_else(|e| panic!("{name}: {e}")))
}

/// Four vertical accelerometers and the two steer rates of the 24 channels.
fn wobble(run: &str) -> Option<Recording> {
    let all = read(&format!("wobbletracker-{run}.toml"), &format!("wobbletracker/{run}_sensors.csv"))?;
    assert_eq!(all.channels().len(), 24);
    let vertical =
        ["knuckle-right", "knuckle-left", "axle-right", "axle-left"].map(|n| format!("{n}-vertical"));
    let steer = ["knuckle-right", "knuckle-left"].map(|n| format!("{n}-steer-rate"));
    let names: Vec<&str> = vertical.iter().chain(&steer).map(String::as_str).collect();
    Some(all.select(&names).unwrap())
}

fn mean(x: &[f64]) -> f64 {
    x.iter().sum::<f64>() / x.len() as f64
}

fn count_of(recording: &Recording, what: RepairKind) -> usize {
    recording.repairs().iter().filter(|r| r.what == what).map(|r| r.count).sum()
}

#[test]
fn every_example_has_its_data_or_says_which_is_missing() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data").exists();
    let mut seen = 0;
    for entry in std::fs::read_dir(example("")).unwrap() {
        let path = entry.unwrap().path();
        match read_recording(&path) {
            Ok(_) => assert!(here),
            // the description itself is sound: only the data may be absent
            Err(SignalError::File(washboard::files::FileError::Read { .. })) if !here => {}
            Err(e) => panic!("{}: {e}", path.display()),
        }
        seen += 1;
    }
    assert!(seen >= 5, "{seen}");
}

#[test]
fn wobbletrackers_bursts_become_one_clock() {
    for (run, samples, speed, lost) in
        [("20211027T145614", 3799, 5.2, 15..29), ("20211027T145815", 7039, 3.9, 15..29)]
    {
        let Some(r) = wobble(run) else { return };
        // two runs of one logger, one crystal: windows of 5 s without losses give 117.57 ± .02
        assert!((r.rate_hz() - 117.57).abs() < 0.06, "{run}: {}", r.rate_hz());
        let filled = count_of(&r, RepairKind::GapFilled);
        assert!(lost.contains(&filled), "{run}: {filled}");
        assert_eq!(r.len(), samples + filled);
        assert_eq!(count_of(&r, RepairKind::PieceUsed), 0);
        let clock = r.repairs().iter().find(|x| x.what == RepairKind::UniformClock).unwrap();
        assert!(clock.text.contains("rms jitter"), "{}", clock.text);
        // the second run's stall of 4.7 s was made up for by late delivery
        assert_eq!(clock.text.contains("late"), run == "20211027T145815", "{}", clock.text);
        assert!((r.speed_m_s().unwrap() - speed).abs() < 0.15, "{:?}", r.speed_m_s());
        assert!(r.speed_spread_m_s().unwrap() > 4.0);
        for (channel, x) in r.channels().iter().zip(r.samples()).take(4) {
            let at_rest = mean(&x[..100]) / 9.80665;
            assert!((0.84..1.04).contains(&at_rest), "{}: {at_rest} g", channel.name);
        }
        for x in &r.samples()[4..] {
            assert!(mean(&x[..100]).abs() < 0.04, "a gyro at rest: {} rad/s", mean(&x[..100]));
        }
    }
}

/// The largest density within half a hertz of a line over the median of the eight hertz about it: geometric mean of the
/// four vertical channels.
fn over_floor(s: &CrossSpectra, line_hz: f64) -> f64 {
    let of = |channel: usize| {
        let within = |half: f64| -> Vec<f64> {
            let near = (0..s.s.len()).filter(|&k| (s.freq_hz[k] - line_hz).abs() <= half);
            near.map(|k| s.s[k][(channel, channel)].re).collect()
        };
        let mut floor = within(4.0);
        floor.sort_by(f64::total_cmp);
        (within(0.5).into_iter().fold(0.0, f64::max) / floor[floor.len() / 2]).ln()
    };
    ((0..4).map(of).sum::<f64>() / 4.0).exp()
}

#[test]
fn the_wobble_and_its_harmonics_stand_out() {
    for run in ["20211027T145614", "20211027T145815"] {
        let Some(r) = wobble(run) else { return };
        let s = welch(&r, &WelchSettings::hann(Segment::Samples(512))).unwrap();
        let [wobble, others @ ..] = [5.9, 11.9, 17.6, 29.5].map(|line| over_floor(&s, line));
        assert!(wobble > 3.0, "{run}: {wobble}");
        assert!(others.iter().all(|o| *o > 1.6), "{run}: {others:?}");
        assert!(over_floor(&s, 40.0) < 1.6, "{run}: {}", over_floor(&s, 40.0));
        // the knuckles steer together at the wobble
        let k = s.freq_hz.iter().position(|f| *f >= 5.9).unwrap();
        let c = s.s[k][(4, 5)].norm_sqr() / (s.s[k][(4, 4)].re * s.s[k][(5, 5)].re);
        assert!(c > 0.9, "{run}: coherence of the knuckles {c}");
    }
}

#[test]
fn the_shear_frame_has_its_storeys_and_its_first_mode() {
    let Some(r) = read("koma-shear.toml", "koma_shear/data_shearframe.npy") else { return };
    assert_eq!((r.len(), r.channels().len(), r.rate_hz()), (14400, 5, 12.0));
    assert!(r.repairs().is_empty() && r.speed_m_s().is_none());
    let s = welch(&r.detrended(), &WelchSettings::hann(Segment::Samples(2048))).unwrap();
    let peak = (2..s.s.len()).max_by(|a, b| s.s[*a][(0, 0)].re.total_cmp(&s.s[*b][(0, 0)].re)).unwrap();
    assert!((s.freq_hz[peak] - 0.1812).abs() < 0.015, "{}", s.freq_hz[peak]);
}

#[test]
fn the_mountain_bikes_travel_is_in_metres() {
    for (run, samples, fork, shock) in
        [("00643", 103_886, 0.148_4, 0.040_1), ("00646", 520_241, 0.136_3, 0.023_4)]
    {
        let Some(r) = read(&format!("mtb-{run}.toml"), &format!("mtb_sst/{run}.SST")) else { return };
        assert_eq!((r.len(), r.rate_hz()), (samples, 1000.0));
        let largest = |x: &[f64]| x.iter().copied().fold(0.0, f64::max);
        assert!((largest(&r.samples()[0]) - fork).abs() < 1e-4, "{}", largest(&r.samples()[0]));
        assert!((largest(&r.samples()[1]) - shock).abs() < 1e-4, "{}", largest(&r.samples()[1]));
        assert!(r.speed_m_s().is_none());
        // the shock tops out: it rests at zero for a share of the ride
        let stop = r.repairs().iter().find(|x| x.channel.as_deref() == Some("shock")).unwrap();
        assert_eq!(stop.what, RepairKind::Clipped);
        let slow = r.decimated(5).unwrap();
        assert!((slow.rate_hz() - 200.0).abs() < 1e-12 && slow.len() > samples / 5 - 30);
    }
}

fn classical(name: &str) -> washboard::study::IdentifyRun {
    washboard::study::identify(&washboard::study::IdentifySpec {
        recording: example(name),
        method: washboard::study::IdentifyMethod::Ssi,
        ..washboard::study::IdentifySpec::default()
    })
    .unwrap()
}

/// The wobble's lines are one family, and none of them is called a mode.
#[test]
fn the_wobble_is_harmonics_and_not_modes() {
    for run in ["20211027T145614", "20211027T145815"] {
        if wobble(run).is_none() {
            return;
        }
        let found = classical(&format!("wobbletracker-{run}.toml")).outcome;
        for (hz, multiple) in [(5.9, 1), (11.9, 2), (17.6, 3), (29.5, 5)] {
            let line = found.lines.iter().find(|l| (l.freq_hz - hz).abs() < 0.35);
            let line = line.unwrap_or_else(|| panic!("{run}: {hz} Hz in {:?}", found.lines));
            assert_eq!(line.multiple, Some(multiple), "{run}: {line:?}");
            assert!((line.fundamental_hz.unwrap() - 5.9).abs() < 0.1, "{run}: {line:?}");
            let called = found.modes.iter().find(|m| (m.freq_hz / hz - 1.0).abs() < 0.02);
            assert!(called.is_none(), "{run}: {called:?}");
        }
        assert!(found.delay_s.is_none() && found.flags.iter().any(|f| f.name == "speed-varies"));
        assert!(!found.recording.repairs.is_empty());
    }
}

/// No speed: spectra, but no delay, and that is said.
#[test]
fn the_mountain_bike_has_spectra_and_no_delay() {
    if read("mtb-00643.toml", "mtb_sst/00643.SST").is_none() {
        return;
    }
    let found = classical("mtb-00643.toml").outcome;
    assert!(found.delay_s.is_none() && found.road.is_none());
    assert!(found.flags.iter().any(|f| f.name == "no-speed" && f.text.contains("delay")));
    assert_eq!(found.spectra.channels.len(), 2);
    assert!(found.spectra.channels[0].measured.iter().all(|v| *v > 0.0));
}

/// Through `identify`, as recorded: five modes, at the poles of the record. The generator integrated by the trapezoidal
/// rule at 12 Hz, which moves f to tan⁻¹(πf/12)·12/π; the record's own spectral peaks stand there too.
#[test]
fn the_shear_frame_through_identify() {
    if read("koma-shear.toml", "koma_shear/data_shearframe.npy").is_none() {
        return;
    }
    let found = classical("koma-shear.toml").outcome;
    // omega_n.npy/2π, xi_ref.npy
    let truth = [
        (0.181_200_88, 0.043_916_7),
        (0.528_922_82, 0.015_045_2),
        (0.833_794_58, 0.009_544_0),
        (1.071_117_27, 0.007_429_4),
        (1.221_664_40, 0.006_513_9),
    ];
    assert_eq!(found.modes.len(), 5);
    let pi = std::f64::consts::PI;
    for (mode, (f, zeta)) in found.modes.iter().zip(truth) {
        let moved = (pi * f / 12.0f64).atan() * 12.0 / pi;
        assert!((mode.freq_hz / moved - 1.0).abs() < 0.01, "{} Hz for {moved}", mode.freq_hz);
        assert!((mode.damping - zeta).abs() < 0.01, "{} for {zeta}", mode.damping);
    }
}
