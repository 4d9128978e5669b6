//! Where sensors look: rows against kinematics and matrices written down by hand.

use washboard::cases;
use washboard::linalg::Mat;
use washboard::signal::{Channel, Direction, Place, Quantity, WheelPlace};
use washboard::vehicle::{Vehicle, VehicleSpec};

fn channel(
    quantity: Quantity,
    direction: Direction,
    place: Place,
    wheel: Option<usize>,
    at_m: Option<[f64; 2]>,
) -> Channel {
    Channel { name: "x".into(), quantity, direction, place, wheel, at_m }
}

fn wheels(vehicle: &Vehicle) -> Vec<WheelPlace> {
    vehicle.wheels().iter().map(|w| WheelPlace { name: w.name.clone(), at_m: w.at_m }).collect()
}

/// z(x, y) = z_G − xθ + yφ; roll about +x, pitch about +y (nose down); suspension travel is hub less body.
#[test]
fn rows_of_a_full_car() {
    let vehicle = cases::vehicle("guiggiani-full-car").unwrap();
    let at = wheels(&vehicle);
    let row = |c: Channel| vehicle.sensor_row(&c, &at).unwrap();
    let z = Direction::PlusZ;
    let (seat, order) = row(channel(Quantity::Acceleration, z, Place::Body, None, Some([0.3, 0.4])));
    assert_eq!((seat, order), (vec![1.0, -0.3, 0.4, 0.0, 0.0, 0.0, 0.0], 2));
    let (roll, order) = row(channel(Quantity::AngularVelocity, Direction::PlusX, Place::Body, None, None));
    assert_eq!((roll, order), (vec![0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0], 1));
    let (pitch, _) = row(channel(Quantity::AngularVelocity, Direction::PlusY, Place::Body, None, None));
    assert_eq!(pitch, vec![0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    // rear right: body at (−1.596, −.745), wheel 4
    let (travel, order) = row(channel(Quantity::Displacement, z, Place::Suspension, Some(3), None));
    assert_eq!((travel, order), (vec![-1.0, -1.596, 0.745, 0.0, 0.0, 0.0, 1.0], 0));
    let (hub, _) = row(channel(Quantity::Acceleration, z, Place::Hub, Some(1), None));
    assert_eq!(hub, vec![0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
    // a frame whose origin is the front axle's middle is laid on the wheels
    let shifted: Vec<WheelPlace> = at
        .iter()
        .map(|w| WheelPlace { name: w.name.clone(), at_m: [w.at_m[0] - 1.064, w.at_m[1]] })
        .collect();
    let c = channel(Quantity::Acceleration, z, Place::Body, None, Some([0.3 - 1.064, 0.4]));
    let moved = vehicle.sensor_row(&c, &shifted).unwrap().0;
    assert!(moved.iter().zip([1.0, -0.3, 0.4]).all(|(a, b)| (a - b).abs() < 1e-12), "{moved:?}");
}

/// An asymmetric car, left and right different, both bars, c.g. off the middle: K and C against the second derivatives of
/// the potential (and dissipation) written element by element.
#[test]
fn an_asymmetric_car_is_its_energies() {
    let text = r#"
model = "full-car"
[full-car]
sprung_mass_kg = 1200.0
roll_inertia_kg_m2 = 500.0
pitch_inertia_kg_m2 = 1700.0
front_axle_m = 1.1
rear_axle_m = 1.5
front_track_m = 1.52
rear_track_m = 1.47
cg_left_m = 0.04
front = { unsprung_mass_kg = [40.0, 43.0], suspension_stiffness_n_per_m = [19e3, 21e3], suspension_damping_n_s_per_m = [1400.0, 1600.0], tire_stiffness_n_per_m = [190e3, 200e3], tire_damping_n_s_per_m = [100.0, 130.0], anti_roll_stiffness_n_m_per_rad = 9000.0 }
rear = { unsprung_mass_kg = [45.0, 47.0], suspension_stiffness_n_per_m = [22e3, 23e3], suspension_damping_n_s_per_m = [1500.0, 1550.0], tire_stiffness_n_per_m = [180e3, 185e3], tire_damping_n_s_per_m = [90.0, 95.0], anti_roll_stiffness_n_m_per_rad = 4000.0 }
"#;
    let spec: VehicleSpec = washboard::files::parse_toml(text, std::path::Path::new("car.toml")).unwrap();
    let vehicle = spec.build_alone().unwrap();
    // the c.g. is 4 cm left of the middle: left wheels are nearer to it
    let corners = [(1.1, 0.76 - 0.04), (1.1, -0.76 - 0.04), (-1.5, 0.735 - 0.04), (-1.5, -0.735 - 0.04)];
    let energy = |k: [f64; 4], t: [f64; 4], bars: [f64; 2]| -> Mat {
        let mut a = Mat::zeros(7, 7);
        let mut element = |row: [f64; 7], stiffness: f64| {
            for i in 0..7 {
                for j in 0..7 {
                    a[(i, j)] += stiffness * row[i] * row[j];
                }
            }
        };
        let travel = |c: usize| {
            let (x, y) = corners[c];
            let mut row = [1.0, -x, y, 0.0, 0.0, 0.0, 0.0];
            row[3 + c] = -1.0;
            row
        };
        for c in 0..4 {
            element(travel(c), k[c]);
            let mut wheel = [0.0; 7];
            wheel[3 + c] = 1.0;
            element(wheel, t[c]);
        }
        for (axle, track) in [(0, 1.52), (1, 1.47)] {
            let (l, r) = (travel(2 * axle), travel(2 * axle + 1));
            let angle: [f64; 7] = std::array::from_fn(|i| (l[i] - r[i]) / track);
            element(angle, bars[axle]);
        }
        a
    };
    let k = energy([19e3, 21e3, 22e3, 23e3], [190e3, 200e3, 180e3, 185e3], [9000.0, 4000.0]);
    let c = energy([1400.0, 1600.0, 1500.0, 1550.0], [100.0, 130.0, 90.0, 95.0], [0.0, 0.0]);
    for (name, ours, theirs) in [("K", vehicle.system().k(), &k), ("C", vehicle.system().c(), &c)] {
        let off = (ours - theirs).norm_max() / theirs.norm_max();
        assert!(off < 1e-14, "{name}: {off:e}");
    }
    for (wheel, (x, y)) in vehicle.wheels().iter().zip(corners) {
        assert!((wheel.at_m[0] - x).abs() < 1e-12 && (wheel.at_m[1] - y).abs() < 1e-12, "{wheel:?}");
    }
}
