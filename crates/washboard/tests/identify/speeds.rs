//! A drive of several speeds, without a vehicle file: cut into its stretches, one vehicle.

use crate::common::{cars, sensors, settings};
use washboard::cases;
use washboard::signal::Recording;
use washboard::study::{IdentifyMethod, identify_recording};
use washboard::vehicle::{Stretch, drive_stretches};

/// An error of a seventh of the numbers lies beyond one standard deviation, none of so few beyond this many.
const SCORES: f64 = 4.0;

#[test]
fn three_stretches_are_one_vehicle() {
    let (_, spec) = &cars()[0];
    let vehicle = spec.build_alone().unwrap();
    let road = cases::road("iso8608-c").unwrap();
    let stretches = [(10.0, 200.0), (20.0, 300.0), (30.0, 250.0)]
        .map(|(speed_m_s, duration_s)| Stretch { speed_m_s, duration_s });
    let recording =
        drive_stretches(&vehicle, &road, &sensors("all", 0.02), &stretches, 100.0, 11).unwrap().recording;
    let found =
        identify_recording(&recording, "RUN.toml", None, &settings(IdentifyMethod::Physical)).unwrap().0;
    assert!(found.converged, "{:?}", found.flags);
    assert!(found.flags.iter().all(|f| f.name != "speed-varies"), "{:?}", found.flags);
    let names: Vec<&str> = found.runs.iter().map(|r| r.name.as_str()).collect();
    assert_eq!(names, ["RUN.toml at 20.0 m/s", "RUN.toml at 30.0 m/s", "RUN.toml at 10.0 m/s"]);
    assert_eq!(found.recording.name, names[0]);
    let truth = vehicle.modes().unwrap();
    assert_eq!(found.modes.len(), truth.len());
    let mut worst: f64 = 0.0;
    let mut score = |what: &str, value: f64, truth: f64, sd: f64| {
        let score = (value - truth).abs() / sd;
        worst = worst.max(score);
        assert!(sd > 0.0 && score < SCORES, "{what}: {value} ± {sd}, truth {truth}");
    };
    for (mode, (t, label)) in found.modes.iter().zip(&truth) {
        score(label, mode.freq_hz, t.freq_hz, mode.freq_sd_hz.unwrap());
        score(label, mode.damping, t.damping, mode.damping_sd.unwrap());
        // and not by wide intervals: a per cent, a point
        assert!((mode.freq_hz / t.freq_hz - 1.0).abs() < 0.01 && (mode.damping - t.damping).abs() < 0.01);
    }
    for (run, (speed, duration)) in found.runs.iter().zip([(20.0, 300.0), (30.0, 250.0), (10.0, 200.0)]) {
        let road = run.road.as_ref().unwrap();
        score("roughness", road.roughness_m3, 16e-6, road.roughness_sd_m3);
        score("exponent", road.exponent, 2.0, road.exponent_sd);
        assert!((run.speed_m_s.unwrap() / speed - 1.0).abs() < 2e-3, "{run:?}");
        // the ramps and what the smoothing sees of them: less than 5 s a joint and side
        assert!((0.0..10.0).contains(&(duration - run.duration_s)), "{}", run.duration_s);
        assert!((run.delay_s.unwrap() * speed / 2.66 - 1.0).abs() < 0.01, "{run:?}");
    }
    eprintln!("worst score {worst:.2}");
    // with the mean speed alone the same drive cannot be cut, and says so
    let r = &recording;
    let bare = Recording::new(
        100.0,
        r.speed_m_s(),
        r.wheels().to_vec(),
        r.channels().to_vec(),
        r.samples().to_vec(),
    );
    let bare = bare.unwrap().with_speed_spread(r.speed_spread_m_s().unwrap()).unwrap();
    let found = identify_recording(&bare, "", None, &settings(IdentifyMethod::Ssi)).unwrap().0;
    let flag = found.flags.iter().find(|f| f.name == "speed-varies").unwrap();
    assert!(
        flag.text.contains("varies by 7.7") && flag.text.contains("only its mean is known"),
        "{}",
        flag.text
    );
}
