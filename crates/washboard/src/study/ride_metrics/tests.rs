use super::*;
use crate::cases;
use crate::lti::Hold;
use crate::road::{Coherence, Road};
use crate::signal::{Channel, Direction, Place, Quantity};
use crate::vehicle::{Control, DriveSettings, Flaws, GRAVITY_M_S2, simulate};

const SPEED: f64 = 20.0;

fn judged(vehicle: &Vehicle, stroke_m: Option<f64>, controlled: bool) -> Judged<'_> {
    Judged { vehicle, speed_m_s: SPEED, stroke_m, controlled }
}

fn road(name: &str) -> Road {
    cases::road(name).unwrap()
}

/// u = gain·(first measurement − second).
fn damper(vehicle: &Vehicle, measured: [&str; 2], actuator: &str, gain: f64) -> Control {
    let row = crate::linalg::Mat::from_fn(1, 2, |_, j| [gain, -gain][j]);
    let k = StateSpace::continuous_gain(row).unwrap();
    Control::new(vehicle, k, &measured.map(str::to_owned), &[actuator.to_owned()]).unwrap()
}

#[test]
fn a_recorded_drive_filtered_in_time_has_the_weighted_rms() {
    let car = cases::vehicle("turkay-quarter-car").unwrap();
    let road = road("turkay-white-velocity");
    let ride = Ride::new(&car, &road, SPEED).unwrap();
    let found = RideMetrics::of(&ride, &judged(&car, None, false)).unwrap();
    let weighted = found.weighted.get("sprung_acceleration").unwrap();
    assert_eq!((weighted.weighting.as_str(), weighted.unit.as_str()), ("W_k", "m/s²"));
    assert!(found.weighted.get("unsprung_acceleration").is_none());
    let channel = Channel {
        name: "body".into(),
        quantity: Quantity::Acceleration,
        direction: Direction::PlusZ,
        place: Place::Body,
        wheel: Some(0),
        at_m: None,
    };
    let settings = DriveSettings { speed_m_s: SPEED, duration_s: 900.0, rate_hz: 500.0, seed: 2631 };
    let drive = simulate(&car, &road, &[(channel, Flaws::default())], &settings).unwrap();
    let rows: Vec<Vec<f64>> = drive.samples()[0].iter().map(|v| vec![*v]).collect();
    let filter = Weighting::Wk.filter().unwrap();
    let y = filter.respond(&rows, 1.0 / settings.rate_hz, Hold::First).unwrap();
    // the filter forgets its start in a few periods of 0.4 Hz
    let rest = &y[5000..];
    let rms = (rest.iter().map(|v| v[0] * v[0]).sum::<f64>() / rest.len() as f64).sqrt();
    // 900 s of a band of a few Hz: 1/(2√(BT)) is 1 %
    assert!((rms / weighted.rms - 1.0).abs() < 0.03, "{rms} {}", weighted.rms);
    let whole = ride.variances(&[car.output("sprung_acceleration").unwrap()]).unwrap()[0].rms().unwrap();
    assert!(weighted.rms < 0.95 * whole, "{} {whole}", weighted.rms);
}

#[test]
fn roads_of_a_band_and_of_a_filter_have_weighted_accelerations_of_all_motions() {
    let car = cases::vehicle("chalasani-full-car").unwrap();
    for name in ["iso8608-c", "turkay-white-velocity"] {
        let road = road(name);
        let ride = Ride::new(&car, &road, SPEED).unwrap();
        let found = RideMetrics::of(&ride, &judged(&car, None, false)).unwrap();
        let of = |n: &str| found.weighted.get(n).unwrap();
        assert_eq!(of("pitch_acceleration").weighting, "W_e");
        assert!(of("heave_acceleration").rms > 0.0 && !of("heave_acceleration").reactions.is_empty());
        assert!(of("pitch_acceleration").reactions.is_empty() && of("pitch_acceleration").unit == "rad/s²");
        assert!(found.weighted.get("body_acceleration_front_left").is_some());
        // tracks that wander apart twist the car without bound, and a damped tire feels white noise: left out, and comfort is not
        let bounded = if name == "iso8608-c" { 4 } else { 0 };
        assert_eq!(found.tire_load.iter().count(), bounded);
        assert_eq!(found.travel.iter().count(), bounded);
        assert!(found.actuator.is_empty());
    }
}

#[test]
fn a_load_coefficient_is_over_the_weight_and_bottoming_over_the_stroke() {
    let car = cases::vehicle("turkay-quarter-car").unwrap();
    let spec = crate::study::load_vehicle("case:turkay-quarter-car").unwrap().spec.quarter_car.unwrap();
    let road = road("turkay-first-order");
    let ride = Ride::new(&car, &road, SPEED).unwrap();
    let travel = car.output("suspension_travel").unwrap();
    let force = car.output("tire_force").unwrap();
    let rms =
        ride.variances(&[travel, force]).unwrap().into_iter().map(|v| v.rms().unwrap()).collect::<Vec<_>>();
    let stroke = 3.5 * rms[0];
    let found = RideMetrics::of(&ride, &judged(&car, Some(stroke), false)).unwrap();
    let load = found.tire_load.get("tire_force").unwrap();
    let weight = GRAVITY_M_S2 * (spec.sprung_mass_kg + spec.unsprung_mass_kg);
    assert!((load.coefficient * weight / rms[1] - 1.0).abs() < 1e-9, "{load:?}");
    let used = found.travel.get("suspension_travel").unwrap();
    // erfc(3.5/√2)
    assert!((used.beyond_stroke.unwrap() / 4.652_581_580_710_5e-4 - 1.0).abs() < 1e-9, "{used:?}");
    assert!((used.three_sigma_m / (3.0 * rms[0]) - 1.0).abs() < 1e-12);
    // σ̇² = −R″(0), by the covariance a short time apart
    let h = 1e-4;
    let r = |lag: f64| ride.covariance(&[travel], lag).unwrap()[(0, 0)];
    let rate = (2.0 * (r(0.0) - r(h)) / (h * h)).sqrt();
    let per_s = rate / (std::f64::consts::PI * rms[0]) * f64::exp(-0.5 * 3.5 * 3.5);
    // −R″(0) by a difference of h is off by what R has of |h|³: velocities of this road are not smooth
    assert!((used.bottoming_per_hour.unwrap() / (3600.0 * per_s) - 1.0).abs() < 5e-3, "{used:?} {per_s}");
    let per_km = used.bottoming_per_hour.unwrap() / 3600.0 * 1000.0 / SPEED;
    assert!((used.bottoming_per_km.unwrap() / per_km - 1.0).abs() < 1e-12);
    let unknown = RideMetrics::of(&ride, &judged(&car, None, false)).unwrap();
    assert_eq!(unknown.travel.get("suspension_travel").unwrap().bottoming_per_km, None);
    assert!(
        check_stroke("stroke_m", Some(0.0)).is_err() && check_stroke("stroke_m", Some(f64::NAN)).is_err()
    );
}

#[test]
fn an_actuator_that_is_a_damper_gives_nothing_and_takes_all_that_it_moves() {
    // u = c(v_above − v_below) pulls together what moves apart; of a cabin what is below is the chassis, which does not feel it
    let c = 400.0;
    for (case, measured, actuator) in [
        ("turkay-quarter-car", ["sprung_velocity", "unsprung_velocity"], "actuator"),
        ("turkay-truck-cabin", ["body_velocity_front_left", "chassis_velocity_front_left"], "front_left"),
    ] {
        let car = cases::vehicle(case).unwrap();
        let road = road("turkay-first-order").with_coherence(Coherence::Independent);
        let k = damper(&car, measured, actuator, c);
        let ride = Ride::controlled(&car, &road, SPEED, &k).unwrap();
        let found = RideMetrics::of(&ride, &judged(&car, None, true)).unwrap();
        let used = found.actuator.get(actuator).unwrap();
        let taken = c * used.velocity_rms_m_s.powi(2);
        assert!((used.net_w / -taken - 1.0).abs() < 1e-9, "{case} {used:?} {taken}");
        assert!(
            (used.absolute_w / taken - 1.0).abs() < 1e-6 && used.given_w.abs() < 1e-6 * taken,
            "{used:?}"
        );
        assert!((used.force_three_sigma_n / (3.0 * c * used.velocity_rms_m_s) - 1.0).abs() < 1e-9);
        // the velocity between its ends, by the covariance of the two velocities
        let ends = measured.map(|n| car.output(n).unwrap());
        let v = ride.covariance(&ends, 0.0).unwrap();
        let between = (v[(0, 0)] + v[(1, 1)] - 2.0 * v[(0, 1)]).sqrt();
        assert!((used.velocity_rms_m_s / between - 1.0).abs() < 1e-6, "{case} {used:?} {between}");
    }
}
