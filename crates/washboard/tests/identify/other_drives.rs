//! Five of the 200 drives of `examples/study_other_drives.rs`: right within 3 standard deviations + 1 %, or flagged.

use crate::common::{cars, perturbed, sensors, settings};
use washboard::cases;
use washboard::study::{IdentifyMethod, identify_recording};
use washboard::vehicle::{DriveSettings, simulate};

#[test]
fn right_or_flagged() {
    let cars = cars();
    let mut right = 0;
    for (seed, (car, class, which, speed_m_s, minutes, share)) in [
        ("suv", "b", "body", 33.0, 10.0, 0.5),
        ("light", "e", "hub", 12.0, 10.0, 0.5),
        ("sports", "a", "all", 27.0, 5.0, 0.5),
        ("van", "d", "side", 20.0, 20.0, 0.3),
        ("asymmetric", "c", "all", 38.0, 5.0, 0.5),
    ]
    .into_iter()
    .enumerate()
    {
        let spec = &cars.iter().find(|(name, _)| *name == car).unwrap().1;
        let vehicle = spec.build_alone().unwrap();
        let road = cases::road(&format!("iso8608-{class}")).unwrap();
        let drive =
            DriveSettings { speed_m_s, duration_s: 60.0 * minutes, rate_hz: 200.0, seed: seed as u64 };
        let recording = simulate(&vehicle, &road, &sensors(which, 0.02), &drive).unwrap();
        let start = perturbed(spec, recording.channels(), recording.wheels(), seed as u64, share);
        let settings = settings(IdentifyMethod::Physical);
        let found = identify_recording(&recording, "", Some(("", &start)), &settings).unwrap().0;
        if !found.converged {
            assert!(!found.flags.is_empty());
            continue;
        }
        right += 1;
        for (mode, (t, label)) in found.modes.iter().zip(vehicle.modes().unwrap()) {
            let (f, zeta) = ((mode.freq_hz - t.freq_hz).abs(), (mode.damping - t.damping).abs());
            assert!(
                f < 3.0 * mode.freq_sd_hz.unwrap() + 0.01 * t.freq_hz,
                "{car} {label}: {} Hz",
                mode.freq_hz
            );
            assert!(zeta < 3.0 * mode.damping_sd.unwrap() + 0.01, "{car} {label}: {}", mode.damping);
        }
    }
    assert!(right >= 4, "{right} of 5 were right, the others flagged");
}
