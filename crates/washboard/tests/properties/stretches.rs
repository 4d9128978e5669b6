//! Drives of several speeds: each stretch a drive of its own, one sensor over all of them.

use washboard::cases;
use washboard::signal::{Channel, Direction, Place, Quantity};
use washboard::vehicle::{Drive, DriveSettings, Flaws, SimulateError, Stretch, drive, drive_stretches};

fn sensors(noise_ratio: f64) -> Vec<(Channel, Flaws)> {
    let channel = Channel {
        name: "hub".into(),
        quantity: Quantity::Acceleration,
        direction: Direction::PlusZ,
        place: Place::Hub,
        wheel: Some(0),
        at_m: None,
    };
    vec![(channel, Flaws { noise_ratio, ..Flaws::default() })]
}

fn driven(of: &[(f64, f64)], noise: f64) -> Result<Drive, SimulateError> {
    let stretches: Vec<Stretch> = of
        .iter()
        .map(|(speed_m_s, duration_s)| Stretch { speed_m_s: *speed_m_s, duration_s: *duration_s })
        .collect();
    let (vehicle, road) = (cases::vehicle("turkay-quarter-car").unwrap(), cases::road("iso8608-c").unwrap());
    drive_stretches(&vehicle, &road, &sensors(noise), &stretches, 100.0, 3)
}

#[test]
fn stretches_are_drives_of_their_own_with_one_speed_record() {
    let got = driven(&[(10.0, 20.0), (20.0, 30.0), (10.0, 10.0)], 0.0).unwrap().recording;
    assert_eq!(got.len(), 6000);
    // the first is the drive that `drive` makes of the same seed; the third is another one of the same speed
    let (vehicle, road) = (cases::vehicle("turkay-quarter-car").unwrap(), cases::road("iso8608-c").unwrap());
    let alone = |seed, duration_s| {
        let settings = DriveSettings { speed_m_s: 10.0, duration_s, rate_hz: 100.0, seed };
        drive(&vehicle, &road, &sensors(0.0), &settings).unwrap().recording.samples()[0].clone()
    };
    assert_eq!(got.samples()[0][..2000], alone(3, 20.0)[..]);
    assert_ne!(got.samples()[0][5000..], alone(3, 10.0)[..]);
    let speed = got.speed_series().unwrap();
    assert_eq!(
        (speed[0], speed[1799], speed[2200], speed[4799], speed[5200]),
        (10.0, 10.0, 20.0, 20.0, 10.0)
    );
    // half-way where they meet, and a line there
    assert!((speed[1999] + speed[2000] - 30.0).abs() < 1e-12);
    assert!((1801..2198).all(|k| (speed[k + 1] - speed[k] - 10.0 / 400.0).abs() < 1e-12));
    assert!((got.speed_m_s().unwrap() - 15.0).abs() < 1e-12);
    assert!((got.speed_spread_m_s().unwrap() - 5.0).abs() < 1e-12);
}

#[test]
fn a_sensor_has_one_noise_over_all_stretches() {
    let of = [(5.0, 30.0), (40.0, 30.0)];
    let (clean, noisy) = (driven(&of, 0.0).unwrap(), driven(&of, 0.1).unwrap());
    let rms = |x: &[f64]| (x.iter().map(|v| v * v).sum::<f64>() / x.len() as f64).sqrt();
    let added: Vec<f64> =
        noisy.recording.samples()[0].iter().zip(&clean.recording.samples()[0]).map(|(a, b)| a - b).collect();
    // 3000 samples of noise have their rms within 4·1/√6000 = 5 %
    for part in added.chunks(3000) {
        assert!((rms(part) / noisy.noise_rms[0] - 1.0).abs() < 0.05, "{}", rms(part));
    }
    assert!((noisy.noise_rms[0] / (0.1 * rms(&clean.recording.samples()[0])) - 1.0).abs() < 1e-9);
}

#[test]
fn what_cannot_be_is_refused_with_its_numbers() {
    for (of, part) in [
        (vec![], "at least one stretch"),
        (vec![(10.0, 7.0)], "found 7 s"),
        (vec![(-1.0, 20.0)], "found -1 m/s"),
        (vec![(20.0, 20.0), (21.0, 20.0)], "20 m/s, then 21 m/s"),
    ] {
        let e = driven(&of, 0.0).unwrap_err().to_string();
        assert!(e.contains(part), "{e}");
    }
    let (vehicle, road) = (cases::vehicle("turkay-quarter-car").unwrap(), cases::road("iso8608-c").unwrap());
    let mut drifting = sensors(0.0);
    drifting[0].1.clock_ppm = 10.0;
    let stretch = Stretch { speed_m_s: 10.0, duration_s: 20.0 };
    let e = drive_stretches(&vehicle, &road, &drifting, &[stretch], 100.0, 0).unwrap_err().to_string();
    assert!(e.contains("clock_ppm") && e.contains("`hub`"), "{e}");
}
