//! Identification of simulated drives without a vehicle file: the physical fit from generic starts, and free modes.

use super::common::{Errors, cars, sensors, settings, with_engine};
use washboard::cases;
use washboard::signal::Recording;
use washboard::study::{
    IdentifyMethod, IdentifyOutcome, IdentifySpec, identify_recording, identify_recordings,
};
use washboard::vehicle::{DriveSettings, Flaws, VehicleSpec, simulate};

fn car(name: &str) -> VehicleSpec {
    cars().into_iter().find(|(n, _)| *n == name).unwrap().1
}

fn drive_at(spec: &VehicleSpec, which: &str, speed_m_s: f64, duration_s: f64, seed: u64) -> Recording {
    let road = cases::road("iso8608-c").unwrap();
    let settings = DriveSettings { speed_m_s, duration_s, rate_hz: 200.0, seed };
    simulate(&spec.build_alone().unwrap(), &road, &sensors(which, 0.02), &settings).unwrap()
}

fn identify(recording: &Recording, spec: &IdentifySpec) -> IdentifyOutcome {
    identify_recording(recording, "", None, spec).unwrap().0
}

fn flag(found: &IdentifyOutcome, name: &str) -> Option<String> {
    found.flags.iter().chain(&found.notes).find(|f| f.name == name).map(|f| f.text.clone())
}

/// Everything within four standard deviations and a tenth of a per cent of the truth.
fn assert_true(found: &IdentifyOutcome, spec: &VehicleSpec) {
    assert!(found.converged, "{:?}", found.flags);
    let truth = spec.build_alone().unwrap().modes().unwrap();
    assert_eq!(found.modes.len(), truth.len());
    let errors = Errors::of(found, &truth, 16e-6, 2.0, 3.8);
    for (kind, scores) in ["f", "zeta", "S0", "e", "mu"].iter().zip(&errors.by_kind) {
        assert!(scores.iter().all(|z| z.abs() < 4.0), "{kind}: {scores:.2?}");
    }
}

#[test]
fn a_symmetric_car_from_nothing() {
    let spec = car("suv");
    let found = identify(&drive_at(&spec, "all", 20.0, 600.0, 3), &settings(IdentifyMethod::Physical));
    assert_true(&found, &spec);
    assert_eq!(found.starts.len(), 3);
    assert!(flag(&found, "symmetric").is_some() && flag(&found, "scale-unidentifiable").is_some());
    // S₀ ≤ 3 %, f ≤ .4 % are asked of 20 minutes
    let errors = Errors::of(&found, &spec.build_alone().unwrap().modes().unwrap(), 16e-6, 2.0, 3.8);
    assert!(
        errors.f.iter().all(|e| e.abs() < 0.4) && errors.zeta.iter().all(|e| e.abs() < 0.4),
        "{}",
        errors.line()
    );
}

/// The symmetric car does not explain the asymmetric one; its own parameters do, and a known mass sets the scale.
#[test]
fn an_asymmetric_car_from_nothing_with_a_known_mass() {
    let spec = car("asymmetric");
    let mut asked = settings(IdentifyMethod::Physical);
    asked.known = vec![("sprung_mass_kg".to_owned(), 1150.0)];
    let found = identify(&drive_at(&spec, "all", 20.0, 600.0, 1), &asked);
    assert_true(&found, &spec);
    assert!(found.starts[0].chi > 5.0, "{:?}", found.starts);
    assert!(flag(&found, "asymmetric").is_some() && flag(&found, "scale-known").is_some());
    for (name, truth) in [
        ("front.suspension_stiffness_n_per_m.0", 19000.0 * 0.94),
        ("rear.tire_stiffness_n_per_m.1", 180e3 * 0.97),
        ("cg_left_m", 0.03),
    ] {
        let p = found.parameters.iter().find(|p| p.name == name).unwrap();
        assert!((p.value - truth).abs() < 4.0 * p.sd && p.sd < 0.1 * truth, "{p:?} for {truth}");
    }
}

/// Two speeds, one vehicle, two roads; each recording's own poles beside.
#[test]
fn two_recordings_share_a_vehicle() {
    let spec = car("sports");
    let recordings =
        [(12.0, 5), (25.0, 6)].map(|(v, seed)| (format!("at {v}"), drive_at(&spec, "all", v, 400.0, seed)));
    let asked = settings(IdentifyMethod::Physical);
    let both = identify_recordings(&recordings, None, &asked).unwrap().0;
    assert_true(&both, &spec);
    assert_eq!(both.runs.len(), 2);
    assert_eq!(both.runs[1].speed_m_s, Some(25.0));
    assert!((both.runs[0].delay_s.unwrap() / both.runs[1].delay_s.unwrap() - 25.0 / 12.0).abs() < 0.01);
    // two recordings know more than one
    let one = identify(&recordings[0].1, &asked);
    let sd = |o: &IdentifyOutcome| o.modes.iter().map(|m| m.freq_sd_hz.unwrap() / m.freq_hz).sum::<f64>();
    assert!(sd(&both) < sd(&one), "{} {}", sd(&both), sd(&one));
    assert!(both.runs.iter().all(|r| r.modes.len() == 7 && r.chi.unwrap() < 0.6));
}

/// A sensor that is 4 ms late is found and allowed for.
#[test]
fn a_late_sensor_is_found() {
    let spec = car("published");
    let road = cases::road("iso8608-c").unwrap();
    let mut all = sensors("all", 0.02);
    all[5].1 = Flaws { delay_s: 0.004, ..all[5].1 };
    let drive = DriveSettings { speed_m_s: 20.0, duration_s: 600.0, rate_hz: 200.0, seed: 2 };
    let recording = simulate(&spec.build_alone().unwrap(), &road, &all, &drive).unwrap();
    let found = identify(&recording, &settings(IdentifyMethod::Physical));
    assert_true(&found, &spec);
    assert_eq!(found.clocks.len(), 1, "{:?}", found.clocks);
    let clock = &found.clocks[0];
    assert!(clock.channel == "hub_1" && (clock.offset_s - 0.004).abs() < 4.0 * clock.sd_s, "{clock:?}");
    assert!(flag(&found, "clock-off").unwrap().contains("hub_1"));
}

/// A speed that is 8 % off shows in the delay, and makes the road's level wrong: said, by both methods.
#[test]
fn a_wrong_speed_is_found() {
    let drive = drive_at(&car("published"), "all", 20.0, 300.0, 7);
    let (wheels, channels) = (drive.wheels().to_vec(), drive.channels().to_vec());
    let said = Recording::new(200.0, Some(21.6), wheels, channels, drive.samples().to_vec()).unwrap();
    for method in [IdentifyMethod::Physical, IdentifyMethod::Tvimm] {
        let found = identify(&said, &settings(method));
        assert!(!found.converged);
        let text = flag(&found, "speed").unwrap();
        assert!(text.contains("speed and wheelbase say 123.1 ms: one of them is wrong by"), "{text}");
        // 2.66 m at the true speed; 5 minutes know the delay to a few tenths of a per cent
        assert!((found.delay_s.unwrap() / (2.66 / 20.0) - 1.0).abs() < 0.005, "{:?}", found.delay_s);
    }
}

#[test]
fn free_modes_from_nothing() {
    let spec = car("published");
    let found = identify(&drive_at(&spec, "all", 20.0, 600.0, 4), &settings(IdentifyMethod::Tvimm));
    assert_true(&found, &spec);
    assert!(
        found.orders.iter().any(|o| o.chosen && o.modes == 7) && found.orders.len() == 2,
        "{:?}",
        found.orders
    );
    assert!((found.starts[0].cost - found.starts[1].cost).abs() < 1.0, "{:?}", found.starts);
    let truth = spec.build_alone().unwrap().modes().unwrap();
    let errors = Errors::of(&found, &truth, 16e-6, 2.0, 3.8);
    // twice the rms that is asked of 20 minutes
    assert!(
        errors.f.iter().all(|e| e.abs() < 2.5) && errors.zeta.iter().all(|e| e.abs() < 2.5),
        "{}",
        errors.line()
    );
    // labels are the car's
    let labels = |names: Vec<&str>| {
        let mut n = names;
        n.sort_unstable();
        n.into_iter().map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(
        labels(found.modes.iter().map(|m| m.label.as_str()).collect()),
        labels(truth.iter().map(|(_, l)| l.as_str()).collect())
    );
    assert!(found.modes.iter().all(|m| m.points.len() == 8 && m.mpc.is_some()) && found.mac.len() == 7);
}

/// Fourteen states do not explain a car whose engine moves on its mounts, and it is said; sixteen do.
#[test]
fn an_engine_on_its_mounts_is_an_eighth_mode() {
    let spec = with_engine(&car("suv"), 160.0, 14.9, [1.1, 0.15]);
    let found = identify(&drive_at(&spec, "all", 20.0, 600.0, 0), &settings(IdentifyMethod::Tvimm));
    let seven = found.orders.iter().find(|o| o.modes == 7).unwrap();
    assert!(seven.chi > 1.0 && !seven.chosen, "{seven:?}");
    assert!(flag(&found, "more-modes").unwrap().starts_with("7 modes do not suffice"));
    assert_true(&found, &spec);
    let truth = spec.build_alone().unwrap().modes().unwrap();
    let engine = &truth.last().unwrap().0;
    let mode = found.modes.iter().find(|m| m.label.starts_with("extra mode")).unwrap();
    assert!((mode.freq_hz / engine.freq_hz - 1.0).abs() < 0.01, "{mode:?}");
}

#[test]
fn free_modes_refuse_bodies_alone_and_report_hops_from_hubs_alone() {
    let spec = car("published");
    let bodies = identify(&drive_at(&spec, "body", 20.0, 300.0, 1), &settings(IdentifyMethod::Tvimm));
    assert!(!bodies.converged && bodies.modes.is_empty() && bodies.road.is_none());
    assert!(flag(&bodies, "not-identifiable").unwrap().contains("bodies alone"));
    let hubs = identify(&drive_at(&spec, "hub", 20.0, 600.0, 1), &settings(IdentifyMethod::Tvimm));
    assert!(hubs.modes.iter().all(|m| m.freq_hz > 4.0), "{:?}", hubs.modes);
    assert!(flag(&hubs, "wheels-only").is_some());
    assert!(hubs.rejected.iter().any(|r| r.why.contains("wheels alone")), "{:?}", hubs.rejected);
}

/// What free modes write is a vehicle that rides as the true one does.
#[test]
fn a_response_model_goes_on_to_ride() {
    use washboard::vehicle::Ride;
    let spec = car("published");
    let recording = drive_at(&spec, "all", 20.0, 600.0, 4);
    let files = identify_recording(&recording, "", None, &settings(IdentifyMethod::Tvimm)).unwrap().1;
    let text =
        |name: &str| String::from_utf8(files.iter().find(|(n, _)| n == name).unwrap().1.clone()).unwrap();
    let response: VehicleSpec = toml::from_str(&text("vehicle.toml")).unwrap();
    let road = cases::road("iso8608-c").unwrap();
    let rms = |spec: &VehicleSpec| {
        let vehicle = spec.build_alone().unwrap();
        let ride = Ride::new(&vehicle, &road, 20.0).unwrap();
        let output = vehicle.output("body_acceleration_front_left").unwrap();
        ride.variances(&[output]).unwrap()[0].rms().unwrap()
    };
    let (found, truth) = (rms(&response), rms(&spec));
    assert!((found / truth - 1.0).abs() < 0.02, "{found} for {truth}");
    assert!(text("road.toml").contains("bogsjo"));
}
