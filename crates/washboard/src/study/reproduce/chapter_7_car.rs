//! §7.1: the full car of table 7.1, its modes, and the sizes of problem 7.2.1; table 7.2.

use super::ReproduceError;
use super::chapter_7_design::{DECAY, EXAMPLE, design, truncated};
use super::context::{Context, SPEED_M_S};
use super::item::{INPUT, Relation, Sheet};
use super::lmi_cars::{COMFORT, TIRE, TRAVEL, full_car, h2};
use crate::cases;
use crate::road::Spectrum;
use crate::units::hz;
use crate::vehicle::LeftRight;

const CASE: &str = "chalasani-full-car";

/// Table 7.1: what the case starts from.
pub(super) fn table_1(_: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let spec = cases::vehicle_spec(CASE)?;
    let Some(car) = spec.full_car.as_ref() else {
        return Err(ReproduceError::unexpected("case", "a full car", CASE));
    };
    let (front, rear) = (&car.front, &car.rear);
    let [x_d, y_d] = car.driver_m.unwrap_or([f64::NAN; 2]);
    let one = |of: LeftRight| of.sides()[0];
    for (name, digits, found) in [
        ("m_s, kg", "1460", car.sprung_mass_kg),
        ("J_x, kg m²", "460", car.roll_inertia_kg_m2),
        ("J_y, kg m²", "2460", car.pitch_inertia_kg_m2),
        ("m_u1, m_u2, kg", "40", one(front.unsprung_mass_kg)),
        ("m_u3, m_u4, kg", "35.5", one(rear.unsprung_mass_kg)),
        ("c_A, c_B, N s/m", "1290", one(front.suspension_damping_n_s_per_m)),
        ("c_C, c_D, N s/m", "1620", one(rear.suspension_damping_n_s_per_m)),
        ("k_A, k_B, N/m", "19960", one(front.suspension_stiffness_n_per_m)),
        ("k_C, k_D, N/m", "17500", one(rear.suspension_stiffness_n_per_m)),
        ("K_F, N m/rad", "19200", front.anti_roll_stiffness_n_m_per_rad),
        ("K_R, N m/rad", "0", rear.anti_roll_stiffness_n_m_per_rad),
        ("k_T, N/m", "175500", one(front.tire_stiffness_n_per_m)),
        ("l_f, m", "1.011", car.front_axle_m),
        ("l_r, m", "1.803", car.rear_axle_m),
        ("t_f, m", "1.522", car.front_track_m),
        ("t_r, m", "1.510", car.rear_track_m),
        ("x_d, m", "0.32", x_d),
        ("y_d, m", "0.38", y_d),
    ] {
        sheet.within(name, digits, found, (0.0, INPUT));
    }
    Ok(())
}

/// §7.1.1 and the sizes of §7.2: the road, the modes, states and unknowns.
pub(super) fn section(_: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    if let Spectrum::FirstOrder { gain, corner_rad_per_m } = cases::road("turkay-first-order")?.spectrum() {
        sheet.within("b_w", "0.0195", *gain, (0.0, INPUT));
        sheet.within("a_w, rad/m", "0.0572", *corner_rad_per_m, (0.0, INPUT));
        let text = "\"integrated white-noise, in particular for frequencies larger than 0.2 Hertz\"";
        sheet.printed("corner of (7.2) at 20 m/s, Hz", "0.2", hz(SPEED_M_S * corner_rad_per_m)).noted(text);
    }
    let modes = cases::vehicle(CASE)?.modes()?;
    for ((mode, label), digits) in modes.iter().zip(["0.99", "1.23", "1.69"]) {
        let text = format!("damped frequency: |λ|/2π is {:.4} Hz", mode.freq_hz);
        sheet.printed(format!("{label}, Hz"), digits, mode.damped_hz).noted(&text);
    }
    let plant = full_car()?;
    let n = plant.order();
    sheet.count("order of the controller of §7.2", 18, n).noted("14 states of the car, 4 of the road");
    sheet
        .count("unknowns of the positive definite 18 × 18 matrix", 171, n * (n + 1) / 2)
        .noted("printed as the number of inequalities (E7.5)");
    sheet
        .count("measurements of §7.2: travels and velocities", 11, plant.ny())
        .noted("4 and 7 rows of C₂ (E7.6)");
    Ok(())
}

/// Table 7.2's active rows of orders 6, 8 and 10: accelerations.
const HIFOO: [(usize, [&str; 3]); 3] = [
    (6, ["1.8795", "1.3157", "3.0871"]),
    (8, ["1.8815", "1.3157", "3.0938"]),
    (10, ["1.7619", "1.2023", "3.0332"]),
];
const BODY: [&str; 3] = ["heave at the driver", "pitch", "roll"];

/// Table 7.2, its passive row.
pub(super) fn table_2(_: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let passive = full_car()?.passive();
    sheet.printed("passive, ‖T_r∞ξ‖₂", "0.0233", h2(&passive, &TIRE)?);
    sheet.printed("passive, ‖T_r₂₂ξ‖₂", "0.0752", h2(&passive, &TRAVEL)?);
    for ((name, digits), row) in BODY.iter().zip(["2.1700", "1.3500", "3.9800"]).zip(COMFORT) {
        let reading = (0.01, "§7.2.1 prints it with two places; zeros are appended here");
        sheet.within(format!("passive, {name}"), digits, h2(&passive, &[row])?, reading);
    }
    Ok(())
}

/// §7.3: truncations of the design by inequalities beside the fixed-order rows of table 7.2.
pub(super) fn section_3(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let found = design(context, EXAMPLE, DECAY)?;
    for (order, printed) in HIFOO {
        let closed = truncated(&found, order)?;
        for ((name, digits), row) in BODY.iter().zip(printed).zip(COMFORT) {
            let text = format!("order {order}, truncated LMI design: rms {name}");
            sheet
                .bound(text, Relation::AtMost, digits, h2(&closed, &[row])?)
                .noted("\"slightly less than those of the HIFOO controllers\": table 7.2's row (E7.7)");
        }
    }
    Ok(())
}
