//! Simulated drives against the exact spectra.

use washboard::cases;
use washboard::linalg::C64;
use washboard::road::{Coherence, Road};
use washboard::signal::{Channel, Direction, Place, Quantity, Recording, Segment, WelchSettings, welch};
use washboard::vehicle::{DriveSettings, Flaws, Output, Ride, Vehicle, simulate};

pub fn sensors(noise_ratio: f64) -> Vec<(Channel, Flaws)> {
    ["body", "hub"]
        .iter()
        .flat_map(|place| (0..4).map(move |w| (place, w)))
        .map(|(place, w)| {
            let channel = Channel {
                name: format!("{place}_{w}"),
                quantity: Quantity::Acceleration,
                direction: Direction::PlusZ,
                place: if *place == "body" { Place::Body } else { Place::Hub },
                wheel: Some(w),
                at_m: None,
            };
            (channel, Flaws { noise_ratio, ..Flaws::default() })
        })
        .collect()
}

fn drive(vehicle: &Vehicle, road: &Road, speed_m_s: f64, seed: u64) -> Recording {
    let settings = DriveSettings { speed_m_s, duration_s: 120.0, rate_hz: 200.0, seed };
    simulate(vehicle, road, &sensors(0.0), &settings).unwrap()
}

/// Welch's spectra, averaged over many seeds, against S_q: within 5 standard deviations at every bin of the band, and
/// their mean deviation (over bins and entries) within 3 of its own.
#[test]
fn welch_spectra_of_many_drives_are_the_exact_ones() {
    let vehicle = cases::vehicle("guiggiani-full-car").unwrap();
    for (coherence, speed) in
        [(Coherence::bogsjo(3.8).unwrap(), 21.3), (Coherence::None, 13.0), (Coherence::Independent, 17.0)]
    {
        let road = cases::road("iso8608-c").unwrap().with_coherence(coherence);
        let ride = Ride::new(&vehicle, &road, speed).unwrap();
        let names: Vec<String> = ["body", "unsprung"]
            .iter()
            .flat_map(|b| vehicle.wheels().iter().map(move |w| format!("{b}_acceleration_{}", w.name)))
            .collect();
        let outputs: Vec<&Output> = names.iter().map(|n| vehicle.output(n).unwrap()).collect();
        let seeds = 24;
        let mut sum: Vec<washboard::linalg::CMat> = Vec::new();
        let mut averages = 0.0;
        let mut omega = Vec::new();
        for seed in 0..seeds {
            let found =
                welch(&drive(&vehicle, &road, speed, seed), &WelchSettings::hann(Segment::Samples(2048)))
                    .unwrap();
            averages += found.averages;
            omega = found.omega_rad_s.clone();
            if sum.is_empty() {
                sum = found.s;
            } else {
                sum.iter_mut().zip(found.s).for_each(|(a, b)| *a += b);
            }
        }
        let (mut total, mut count) = (0.0, 0.0);
        for (k, w) in omega.iter().enumerate().filter(|(k, _)| (8..200).contains(k)) {
            let exact = ride.spectrum(&outputs, *w).unwrap();
            for i in 0..8 {
                for j in 0..8 {
                    let size = (exact[(i, i)].re * exact[(j, j)].re).sqrt();
                    let d = (sum[k][(i, j)] / seeds as f64 - exact[(i, j)]) / size;
                    // window leakage bends steep cross-spectra by a few per cent of the size
                    let tolerance = 5.0 / averages.sqrt() + 0.03;
                    assert!(d.norm() < tolerance, "{coherence:?} bin {k} [{i}{j}]: {d} of {tolerance}");
                    if i == j {
                        total += d.re;
                        count += 1.0;
                    }
                }
            }
        }
        // 8 channels repeat two tracks: count bins only
        let mean: f64 = total / count;
        assert!(mean.abs() < 3.0 / (averages * 192.0 / 2.0_f64).sqrt() + 0.003, "{coherence:?}: mean {mean}");
    }
}

/// The delay is exact: with the front's spectrum known, the rear hub's phase is that of δ, not of a rounded one.
#[test]
fn delays_are_not_rounded_to_samples() {
    let vehicle = cases::vehicle("guiggiani-full-car").unwrap();
    let road = cases::road("iso8608-c").unwrap().with_coherence(Coherence::Full);
    // 2.66 m at 21.3 m/s is 24.977 samples; a rounded delay turns 20 Hz by 0.8°
    let speed = 21.3;
    let recording = drive(&vehicle, &road, speed, 3);
    let found = welch(&recording, &WelchSettings::hann(Segment::Samples(4096))).unwrap();
    let ride = Ride::new(&vehicle, &road, speed).unwrap();
    let names = ["unsprung_acceleration_front_left", "unsprung_acceleration_rear_left"];
    let outputs: Vec<&Output> = names.iter().map(|n| vehicle.output(n).unwrap()).collect();
    let mut slope = (0.0, 0.0);
    for (k, w) in found.omega_rad_s.iter().enumerate().filter(|(k, _)| (40..800).contains(k)) {
        let exact = ride.spectrum(&outputs, *w).unwrap()[(0, 1)];
        let phase: C64 = found.s[k][(4, 6)] * exact.conj();
        slope.0 += w * phase.im.atan2(phase.re);
        slope.1 += w * w;
    }
    let delay = slope.0 / slope.1;
    // rounding would be 1.1e-4 s
    assert!(delay.abs() < 1e-5, "a delay error of {delay} s");
}

#[test]
fn same_seed_same_drive_on_any_number_of_threads() {
    let vehicle = cases::vehicle("turkay-half-car").unwrap();
    let road = cases::road("iso8608-b").unwrap();
    let one = |threads: usize| {
        let sensors = &sensors(0.02)[..2];
        let settings = DriveSettings { speed_m_s: 20.0, duration_s: 5.0, rate_hz: 100.0, seed: 7 };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| simulate(&vehicle, &road, sensors, &settings).unwrap())
    };
    assert_eq!(one(1), one(4));
    assert_eq!(one(1).len(), 500);
}

#[test]
fn sensors_clip_round_and_have_a_bias() {
    let vehicle = cases::vehicle("guiggiani-full-car").unwrap();
    let road = cases::road("iso8608-d").unwrap();
    let mut spoilt = sensors(0.0);
    spoilt[0].1 = Flaws { bias: 0.5, clip: Some(2.0), quantum: Some(0.25), ..Flaws::default() };
    let settings = DriveSettings { speed_m_s: 20.0, duration_s: 20.0, rate_hz: 100.0, seed: 1 };
    let clean = simulate(&vehicle, &road, &sensors(0.0), &settings).unwrap();
    let found = simulate(&vehicle, &road, &spoilt, &settings).unwrap();
    for (c, f) in clean.samples()[0].iter().zip(&found.samples()[0]) {
        assert_eq!(*f, ((c + 0.5).clamp(-2.0, 2.0) / 0.25).round() * 0.25);
    }
    assert_eq!(clean.samples()[1], found.samples()[1]);
}

/// A delay that is whole samples is the series moved; a delay of half a sample twice over is one of a whole sample.
#[test]
fn a_late_channel_is_the_same_channel_later() {
    let vehicle = cases::vehicle("guiggiani-full-car").unwrap();
    let road = cases::road("iso8608-c").unwrap();
    let settings = DriveSettings { speed_m_s: 20.0, duration_s: 20.0, rate_hz: 200.0, seed: 1 };
    let late = |delay_s: f64| {
        let mut channels = sensors(0.0)[4..5].to_vec();
        channels[0].1.delay_s = delay_s;
        simulate(&vehicle, &road, &channels, &settings).unwrap().samples()[0].clone()
    };
    let (now, moved, back) = (late(0.0), late(7.0 / 200.0), late(-7.0 / 200.0));
    let size = now.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    assert!(moved[7..].iter().zip(&now).all(|(a, b)| (a - b).abs() < 1e-9 * size));
    assert!(now[7..].iter().zip(&back).all(|(a, b)| (a - b).abs() < 1e-9 * size));
    let refused = |flaws: Flaws| {
        let channels = [(sensors(0.0)[4].0.clone(), flaws)];
        simulate(&vehicle, &road, &channels, &settings).unwrap_err().to_string()
    };
    assert!(refused(Flaws { delay_s: 7.0, ..Flaws::default() }).starts_with("delay_s: expected at most 5 s"));
    let e = refused(Flaws { clock_ppm: f64::NAN, ..Flaws::default() });
    assert!(e.starts_with("clock_ppm: expected"), "{e}");
}

/// A clock that is fast by p millionths takes its sample k early: what a right clock sees of a channel that looks back.
#[test]
fn a_fast_clock_samples_earlier() {
    let vehicle = cases::vehicle("guiggiani-full-car").unwrap();
    let road = cases::road("iso8608-c").unwrap();
    let record = |flaws: Flaws| {
        let settings = DriveSettings { speed_m_s: 20.0, duration_s: 20.0, rate_hz: 200.0, seed: 1 };
        let channels = [(sensors(0.0)[4].0.clone(), flaws)];
        simulate(&vehicle, &road, &channels, &settings).unwrap().samples()[0].clone()
    };
    let ppm = 200.0;
    let drifting = record(Flaws { clock_ppm: ppm, ..Flaws::default() });
    let size = drifting.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    // sample k is at k/200/(1 + ppm) s: the right clock's sample k of a channel that is late by the difference
    for k in [0, 1, 1000, 2500, 3999] {
        let true_s = k as f64 / 200.0 / (1.0 + ppm * 1e-6);
        let shifted = record(Flaws { delay_s: k as f64 / 200.0 - true_s, ..Flaws::default() });
        // the polynomial between dense samples is good for 1e-12
        assert!((drifting[k] - shifted[k]).abs() < 1e-10 * size, "sample {k}");
    }
    assert!((drifting[3999] - record(Flaws::default())[3999]).abs() > 1e-2 * size);
}
