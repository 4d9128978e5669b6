//! What the studies share: the cars of the notes, sensors, starts that are off.

#![allow(dead_code, clippy::unwrap_used)]

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use washboard::cases;
use washboard::lti::Parametric;
use washboard::signal::{Channel, Direction, Place, Quantity, WheelPlace};
use washboard::study::{IdentifyMethod, IdentifySpec};
use washboard::vehicle::{Axle, Flaws, FullCar, LeftRight, ParametricVehicle, VehicleSpec};

/// Published, light, SUV, sports, van, asymmetric.
pub fn cars() -> Vec<(&'static str, VehicleSpec)> {
    let axle = |m: f64, k: f64, c: f64, kt: f64, ct: f64, bar: f64| Axle {
        unsprung_mass_kg: LeftRight::Both(m),
        suspension_stiffness_n_per_m: LeftRight::Both(k),
        suspension_damping_n_s_per_m: LeftRight::Both(c),
        tire_stiffness_n_per_m: LeftRight::Both(kt),
        tire_damping_n_s_per_m: LeftRight::Both(ct),
        anti_roll_stiffness_n_m_per_rad: bar,
        damper_curve: None,
    };
    let car = |w: f64, a: f64, b: f64, m: f64, jx: f64, jy: f64, front: Axle, rear: Axle| FullCar {
        sprung_mass_kg: m,
        roll_inertia_kg_m2: jx,
        pitch_inertia_kg_m2: jy,
        front_axle_m: a,
        rear_axle_m: b,
        front_track_m: w,
        rear_track_m: w,
        cg_left_m: 0.0,
        driver_m: None,
        front,
        rear,
    };
    let light = car(
        1.40,
        0.90,
        1.40,
        750.0,
        280.0,
        850.0,
        axle(32.0, 17000.0, 1150.0, 150e3, 80.0, 3000.0),
        axle(28.0, 15500.0, 1050.0, 150e3, 80.0, 0.0),
    );
    let suv = car(
        1.62,
        1.35,
        1.45,
        1900.0,
        850.0,
        3100.0,
        axle(60.0, 32000.0, 3000.0, 260e3, 200.0, 14000.0),
        axle(65.0, 34000.0, 2900.0, 270e3, 200.0, 8000.0),
    );
    let sports = car(
        1.58,
        1.20,
        1.25,
        1250.0,
        380.0,
        1400.0,
        axle(38.0, 45000.0, 2700.0, 280e3, 120.0, 20000.0),
        axle(42.0, 52000.0, 2900.0, 300e3, 120.0, 12000.0),
    );
    let van = car(
        1.70,
        1.25,
        1.95,
        2300.0,
        1300.0,
        5600.0,
        axle(60.0, 38000.0, 2800.0, 240e3, 150.0, 12000.0),
        axle(110.0, 60000.0, 3600.0, 330e3, 200.0, 0.0),
    );
    // corners (front right, front left, rear right, rear left) × (1.06, .94, .97, 1.042), c.g. 3 cm off centre
    let pair = |v: f64, left: f64, right: f64| LeftRight::Each([v * left, v * right]);
    let uneven = |m: f64, k: f64, c: f64, kt: f64, ct: f64, bar: f64, l: f64, r: f64| Axle {
        unsprung_mass_kg: pair(m, l, r),
        suspension_stiffness_n_per_m: pair(k, l, r),
        suspension_damping_n_s_per_m: pair(c, l, r),
        tire_stiffness_n_per_m: pair(kt, l, r),
        tire_damping_n_s_per_m: pair(ct, l, r),
        anti_roll_stiffness_n_m_per_rad: bar,
        damper_curve: None,
    };
    let mut asymmetric = car(
        1.49,
        1.20,
        1.46,
        1150.0,
        530.0,
        1630.0,
        uneven(40.0, 19000.0, 1500.0, 190e3, 150.0, 9000.0, 0.94, 1.06),
        uneven(45.0, 22000.0, 1500.0, 180e3, 150.0, 4000.0, 1.042, 0.97),
    );
    asymmetric.cg_left_m = 0.03;
    vec![
        ("published", cases::vehicle_spec("guiggiani-full-car").unwrap()),
        ("light", light.into()),
        ("suv", suv.into()),
        ("sports", sports.into()),
        ("van", van.into()),
        ("asymmetric", asymmetric.into()),
    ]
}

/// Vertical accelerometers: `all`, `body`, `hub`, or `side` (front hub and rear body of each side).
pub fn sensors(which: &str, noise_ratio: f64) -> Vec<(Channel, Flaws)> {
    [(Place::Body, "body"), (Place::Hub, "hub")]
        .into_iter()
        .flat_map(|(place, name)| (0..4).map(move |w| (place, name, w)))
        .filter(|(_, name, w)| match which {
            "all" => true,
            "side" => (*name == "hub") == (*w < 2),
            other => *name == other,
        })
        .map(|(place, name, w)| {
            let channel = Channel {
                name: format!("{name}_{w}"),
                quantity: Quantity::Acceleration,
                direction: Direction::PlusZ,
                place,
                wheel: Some(w),
                at_m: None,
            };
            (channel, Flaws { noise_ratio, ..Flaws::default() })
        })
        .collect()
}

/// Every free parameter off by up to `share`.
pub fn perturbed(
    spec: &VehicleSpec,
    channels: &[Channel],
    wheels: &[WheelPlace],
    seed: u64,
    share: f64,
) -> VehicleSpec {
    let (family, _) = ParametricVehicle::new(spec, channels, wheels, &[]).unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(1000 + seed);
    let values: Vec<f64> =
        family.start().iter().map(|v| v * (1.0 + share * rng.random_range(-1.0..=1.0))).collect();
    family.spec_at(&values).unwrap()
}

/// The settings of `identify` without options.
pub fn settings(method: IdentifyMethod) -> IdentifySpec {
    IdentifySpec {
        recording: "simulated".into(),
        vehicle: None,
        method,
        band_hz: None,
        segment_s: None,
        convention: None,
    }
}
