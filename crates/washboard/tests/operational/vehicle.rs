//! A vehicle on a road, for which these methods are not made: what they say of it is flagged.

use washboard::signal::{Channel, Direction, Place, Quantity};
use washboard::study::{IdentifyMethod, IdentifySpec, identify_recording};
use washboard::vehicle::{DriveSettings, Flaws, simulate};

#[test]
fn a_car_on_a_road_is_flagged() {
    let car = washboard::cases::vehicle("guiggiani-full-car").unwrap();
    let road = washboard::cases::road("iso8608-c").unwrap();
    let sensors: Vec<(Channel, Flaws)> = [Place::Body, Place::Hub]
        .into_iter()
        .flat_map(|place| (0..4).map(move |w| (place, w)))
        .map(|(place, w)| {
            let channel = Channel {
                name: format!("{place:?}{w}"),
                quantity: Quantity::Acceleration,
                direction: Direction::PlusZ,
                place,
                wheel: Some(w),
                at_m: None,
            };
            (channel, Flaws { noise_ratio: 0.02, ..Flaws::default() })
        })
        .collect();
    let settings = DriveSettings { speed_m_s: 20.0, duration_s: 300.0, rate_hz: 200.0, seed: 0 };
    let drive = simulate(&car, &road, &sensors, &settings).unwrap();
    for method in [IdentifyMethod::Ssi, IdentifyMethod::Plscf, IdentifyMethod::Fdd] {
        let spec: IdentifySpec =
            serde_json::from_value(serde_json::json!({"recording": "drive", "method": method.name()}))
                .unwrap();
        let (found, files) = identify_recording(&drive, "drive", None, &spec).unwrap();
        assert!(files.is_empty());
        assert_eq!(found.method, method.name());
        assert!(found.flags.iter().any(|f| f.name == "classical"), "{method:?}");
        assert_eq!(found.converged, !found.modes.is_empty());
        assert_eq!(found.stabilization.is_empty(), method == IdentifyMethod::Fdd);
        assert!(found.stabilization.iter().all(|p| p.stable == p.why.is_none()));
        assert!(!found.rejected.is_empty() && found.rejected.iter().all(|r| !r.why.is_empty()));
        assert!(found.singular_values.as_ref().is_some_and(|s| !s.values.is_empty()));
        assert!(found.road.is_none() && found.delay_s.is_none());
        assert_eq!(found.mac.len(), found.modes.len());
        for mode in &found.modes {
            assert!(mode.mpc.is_some() && mode.mean_phase_deg.is_some());
            assert!(mode.damping > 0.0 && mode.damping < 1.0, "{mode:?}");
        }
        let json = serde_json::to_string(&found).unwrap();
        let back: washboard::study::IdentifyOutcome = serde_json::from_str(&json).unwrap();
        assert_eq!(back.modes.len(), found.modes.len());
    }
}
