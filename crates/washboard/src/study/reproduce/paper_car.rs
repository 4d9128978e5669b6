//! The paper's car: table 1, its modes (figure 5, §4.3), and the two coordinate sets of §4.1.

use super::ReproduceError;
use super::context::Context;
use super::item::{Axis, Curve, INPUT, Sheet};
use crate::cases;
use crate::linalg::{C64, Mat};
use crate::vehicle::{FullCar, LeftRight, Vehicle, VehicleSpec};

/// The case of table 1.
pub(super) const PAPER_CAR: &str = "guiggiani-full-car";
/// Our coordinates of the paper's wheels 1, 2, 3, 4: front right, front left, rear right, rear left.
pub(super) const WHEELS: [usize; 4] = [4, 3, 6, 5];
/// c/k of the dampers that table 1 rounds, s (erratum EP.9).
const DAMPERS_S: f64 = 0.0936;
/// "Approximately at 1 Hz", "8 Hz": what is read into them.
const ABOUT_1_HZ: (f64, &str) = (0.3, "\"approximately\", taken as 0.3 Hz");
const ABOUT_8_HZ: (f64, &str) = (0.5, "a rounded 8, taken as 0.5 Hz");

fn full_car(spec: &VehicleSpec) -> Result<&FullCar, ReproduceError> {
    spec.full_car.as_ref().ok_or_else(|| ReproduceError::unexpected("case", "a full car", PAPER_CAR))
}

/// The car as printed, or with the dampers that its table rounds.
pub(super) fn car(as_printed: bool) -> Result<Vehicle, ReproduceError> {
    let mut spec = cases::vehicle_spec(PAPER_CAR)?;
    if !as_printed {
        let table = full_car(&spec)?;
        let k = [&table.front, &table.rear].map(|axle| axle.suspension_stiffness_n_per_m.sides()[0]);
        if let Some(car) = spec.full_car.as_mut() {
            car.front.suspension_damping_n_s_per_m = LeftRight::Both(DAMPERS_S * k[0]);
            car.rear.suspension_damping_n_s_per_m = LeftRight::Both(DAMPERS_S * k[1]);
        }
    }
    Ok(spec.build_alone()?)
}

/// q₁ (heave, roll, pitch, wheels) and q₂ (three corners, wheels) as rows over our coordinates.
pub(super) fn coordinates(vehicle: &Vehicle) -> Result<[Mat; 2], ReproduceError> {
    let rows = |names: [&str; 3]| -> Result<Mat, ReproduceError> {
        let top = names.iter().map(|n| Ok(vehicle.output(n)?.q[0].clone()));
        let top: Vec<Vec<f64>> = top.collect::<Result<_, ReproduceError>>()?;
        Ok(Mat::from_fn(7, 7, |i, j| if i < 3 { top[i][j] } else { f64::from(u8::from(j == WHEELS[i - 3])) }))
    };
    Ok([
        rows(["heave_displacement", "roll_displacement", "pitch_displacement"])?,
        rows([
            "body_displacement_front_right",
            "body_displacement_front_left",
            "body_displacement_rear_right",
        ])?,
    ])
}

/// Table 1: what the case starts from.
pub(super) fn table_1(_: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let spec = cases::vehicle_spec(PAPER_CAR)?;
    let car = full_car(&spec)?;
    let (front, rear) = (&car.front, &car.rear);
    let [mu2, mu1] = front.unsprung_mass_kg.sides();
    let [mu4, mu3] = rear.unsprung_mass_kg.sides();
    let kilo = |of: LeftRight| of.sides()[0] / 1000.0;
    for (name, digits, found) in [
        ("W₁, m", "1.490", car.front_track_m),
        ("L₁f, m", "1.064", car.front_axle_m),
        ("L₁r, m", "1.596", car.rear_axle_m),
        ("m_s, kg", "1150", car.sprung_mass_kg),
        ("j_sx, kg m²", "530", car.roll_inertia_kg_m2),
        ("j_sy, kg m²", "1630", car.pitch_inertia_kg_m2),
        ("k_f, kN/m", "15.750", kilo(front.suspension_stiffness_n_per_m)),
        ("k_r, kN/m", "14", kilo(rear.suspension_stiffness_n_per_m)),
        ("c_f, kN s/m", "1.475", kilo(front.suspension_damping_n_s_per_m)),
        ("c_r, kN s/m", "1.310", kilo(rear.suspension_damping_n_s_per_m)),
        ("m_u1, kg", "57.500", mu1),
        ("m_u2, kg", "57.500", mu2),
        ("m_u3, kg", "57.500", mu3),
        ("m_u4, kg", "57.500", mu4),
        ("k_ft, kN/m", "140", kilo(front.tire_stiffness_n_per_m)),
        ("k_rt, kN/m", "140", kilo(rear.tire_stiffness_n_per_m)),
        ("c_ft, kN s/m", "0.150", kilo(front.tire_damping_n_s_per_m)),
        ("c_rt, kN s/m", "0.150", kilo(rear.tire_damping_n_s_per_m)),
    ] {
        sheet.within(name, digits, found, (0.0, INPUT));
    }
    Ok(())
}

const FIGURE_5: [(&str, &str, &str); 7] = [
    ("heave", "1.064", "27.954"),
    ("roll", "1.221", "32.189"),
    ("pitch", "1.295", "34.295"),
    ("rear axle hop", "8.044", "26.031"),
    ("front axle roll", "8.129", "27.794"),
    ("front axle hop", "8.134", "28.372"),
    ("rear axle roll", "8.207", "25.354"),
];

/// Figure 5: frequencies, damping ratios, names and shapes.
pub(super) fn figure_5(_: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let car = car(false)?;
    let modes = car.modes()?;
    let mut named = 0;
    for ((name, hz, zeta), (mode, label)) in FIGURE_5.into_iter().zip(&modes) {
        sheet.printed(format!("{name}, Hz"), hz, mode.freq_hz);
        sheet
            .printed(format!("{name}, damping ratio, %"), zeta, 100.0 * mode.damping)
            .noted("c = 0.0936 k, which table 1 rounds (EP.9)");
        named += usize::from(label == name);
    }
    sheet.count("modes that the shapes give these names", 7, named);
    let names = |part: &str| {
        ["front_right", "front_left", "rear_right", "rear_left"].map(|at| format!("{part}_displacement_{at}"))
    };
    let rows = [names("body"), names("unsprung")].concat();
    let rows: Vec<&Vec<f64>> =
        rows.iter().map(|n| Ok(&car.output(n)?.q[0])).collect::<Result<_, ReproduceError>>()?;
    let places: Vec<f64> = (1..=8).map(f64::from).collect();
    for (panel, group, title) in [("a", 0..3, "Chassis modes"), ("b", 3..7, "Wheel modes")] {
        let curve = |(mode, label): &(crate::lti::Mode, String)| {
            let at = |row: &Vec<f64>| row.iter().zip(&mode.shape).map(|(r, q)| *q * *r).sum();
            let shape: Vec<C64> = rows.iter().map(|row| at(row)).collect();
            // turned and scaled so that its largest place is 1
            let largest =
                shape.iter().copied().fold(C64::from(0.0), |m, v| if v.norm() > m.norm() { v } else { m });
            Curve { label: label.clone(), y: shape.iter().map(|v| (v / largest).re).collect() }
        };
        let curves = modes.get(group).unwrap_or_default().iter().map(curve).collect();
        let x = "1–4: body above, 5–8: wheel at front right, front left, rear right, rear left";
        sheet.figure(panel, title, Axis::linear(x).at(&places), Axis::linear("displacement"), curves);
    }
    Ok(())
}

/// §4.3: where the modes lie, for table 1 as printed.
pub(super) fn section_4_3(_: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let modes = car(true)?.modes()?;
    sheet.count("modes from 0 to 20 Hz", 7, modes.iter().filter(|(m, _)| m.freq_hz < 20.0).count());
    for (k, (mode, label)) in modes.iter().enumerate() {
        let (digits, about) = if k < 3 { ("1", ABOUT_1_HZ) } else { ("8", ABOUT_8_HZ) };
        sheet.within(format!("{label}, Hz"), digits, mode.freq_hz, about);
    }
    Ok(())
}
