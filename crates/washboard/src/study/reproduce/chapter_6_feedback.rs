//! §6.2: the half car as printed, passive and with output feedback by matrix inequalities, over tire damping.

use super::ReproduceError;
use super::chapter_5_feedback::feedback;
use super::context::{Context, SPEED_M_S};
use super::item::{Check, INPUT, Relation, Sheet};
use super::lmi_cars::{HalfCar, gain, h2, norms};
use crate::cases;
use crate::lti::{GeneralizedPlant, StateSpace};
use crate::optimize::SdpSettings;
use crate::synthesis::{LyapunovScale, MixedEnd, MixedGoals, mixed_h2_hinf};
use crate::vehicle::{Disturbance, HalfCarVariant};

/// The car that the thesis's numbers come from.
pub(super) const PRINTED: HalfCar = HalfCar { variant: HalfCarVariant::AsPrinted, inertia: 1.0 };
pub(super) const CORRECTED: HalfCar = HalfCar { variant: HalfCarVariant::Corrected, inertia: 1.0 };
/// (ρ₁, ρ₂) of the two designs.
pub(super) const RHOS: [[f64; 2]; 2] = [[0.1, 1.5], [1.0, 1.0]];
/// Largest tire damping, N s/m.
pub(super) const UP_TO: f64 = 100.0;
const FIXED: LyapunovScale = LyapunovScale::Fixed(1.0);
/// Rows of the plant.
pub(super) const NAMES: [&str; 6] =
    ["travel, front", "travel, rear", "tire, front", "tire, rear", "heave", "pitch"];

/// √(μ²v) of (6.20), μ = .0027.
fn scale() -> Result<f64, ReproduceError> {
    let road = cases::road("turkay-white-velocity-rounded")?;
    Ok(road.spectrum().white_intensity(SPEED_M_S).unwrap_or(f64::NAN).sqrt())
}

/// rms values of travels, tire deflections, accelerations and forces, passive and active, and ‖WT_zw‖∞ from heights of both.
#[derive(Debug)]
pub(super) struct Design {
    pub passive: Vec<f64>,
    pub active: Vec<f64>,
    pub gains: [f64; 2],
}

impl Design {
    /// Of a row against the passive car, %.
    pub fn change(&self, row: usize) -> f64 {
        100.0 * (self.active[row] / self.passive[row] - 1.0)
    }
}

/// §6.2.2's design at a tire damping: Λ and γ are of that damping, the blocks of the H∞ inequality (−I, −γ²I).
pub(super) fn design(
    car: &HalfCar,
    ct: f64,
    rho: [f64; 2],
    back_off: Option<f64>,
) -> Result<Design, ReproduceError> {
    let plant = car.plant([ct; 2], Disturbance::RoadVelocity)?;
    let asked = HalfCar::goals(&plant, rho, FIXED)?;
    let asked = MixedGoals { back_off: back_off.unwrap_or(asked.back_off), ..asked };
    let found = match mixed_h2_hinf(&plant, &asked, &SdpSettings::default())? {
        MixedEnd::Found(found) => found,
        other => return Err(ReproduceError::unexpected("§6.2.2", "an output feedback", other)),
    };
    let heights = car.plant([ct; 2], Disturbance::RoadDisplacement)?;
    let scale = scale()?;
    let rms = |system| Ok::<_, ReproduceError>(norms(system)?.iter().map(|n| scale * n).collect());
    Ok(Design {
        passive: rms(&plant.passive())?,
        active: rms(&plant.close(&found.controller)?)?,
        gains: [gain(&heights.passive(), &[2, 3])?, gain(&heights.close(&found.controller)?, &[2, 3])?],
    })
}

/// Decrease from c_t = 0 to 100, %.
pub(super) fn decrease(before: f64, after: f64) -> f64 {
    100.0 * (1.0 - after / before)
}

/// rms values of the passive car.
pub(super) fn passive_rms(car: &HalfCar, ct: f64) -> Result<Vec<f64>, ReproduceError> {
    let scale = scale()?;
    let passive = car.plant([ct; 2], Disturbance::RoadVelocity)?.passive();
    Ok(norms(&passive)?.iter().take(6).map(|n| scale * n).collect())
}

/// ‖WT_zw‖∞ of the passive car's tire deflections.
pub(super) fn passive_gain(car: &HalfCar, ct: f64) -> Result<f64, ReproduceError> {
    Ok(gain(&car.plant([ct; 2], Disturbance::RoadDisplacement)?.passive(), &[2, 3])?)
}

/// §6.2: what tire damping does to the passive car, printed for figures 6.5–6.7 and again for 6.9–6.11.
pub(super) fn passive(_: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let mu = (scale()? * scale()? / SPEED_M_S).sqrt();
    sheet.within("μ of (6.20)", "0.0027", mu, (1e-15, INPUT));
    let (before, after) = (passive_rms(&PRINTED, 0.0)?, passive_rms(&PRINTED, UP_TO)?);
    let right = (passive_rms(&CORRECTED, 0.0)?, passive_rms(&CORRECTED, UP_TO)?);
    for (k, digits) in ["0.4", "0.6", "4.1", "4.2", "0.7", "0.6"].into_iter().enumerate() {
        let text =
            format!("by (6.15); {:.3} by the equations of motion (E6.1)", decrease(right.0[k], right.1[k]));
        sheet
            .printed(
                format!("decrease by c_t = 100, passive, rms {}, %", NAMES[k]),
                digits,
                decrease(before[k], after[k]),
            )
            .noted(&text);
    }
    let gains = [passive_gain(&PRINTED, 0.0)?, passive_gain(&PRINTED, UP_TO)?];
    sheet.printed("decrease by c_t = 100, passive, ‖WT_zw‖∞, %", "8.7", decrease(gains[0], gains[1]));
    Ok(())
}

/// §6.2.2: what the two designs change, and what tire damping does to them.
pub(super) fn section(_: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let both = |rho| {
        Ok::<_, ReproduceError>([design(&PRINTED, 0.0, rho, None)?, design(&PRINTED, UP_TO, rho, None)?])
    };
    let [first, second] = [both(RHOS[0])?, both(RHOS[1])?];
    let of = "(0.1, 1.5)";
    let about = (10.0, "\"about 60 %\", taken as 10");
    for k in [0, 1] {
        sheet.within(format!("{of}: rms {} against passive, %", NAMES[k]), "60", first[0].change(k), about);
    }
    let about = (2.0, "\"slightly … about 4 %\", taken as 2");
    for k in [2, 3] {
        sheet.within(format!("{of}: rms {} against passive, %", NAMES[k]), "4", first[0].change(k), about);
    }
    for k in [4, 5] {
        let text = format!("{of}: rms {} against passive, %", NAMES[k]);
        let reading = "\"dramatically reduced\", taken as by more than half";
        sheet.bound(text, Relation::AtMost, "-50", first[0].change(k)).noted(reading);
    }
    decreases(sheet, of, &first, ["0.15", "0.2", "4.7", "4.9", "0.2", "0.07"], "9.0");
    let of = "(1, 1)";
    for (k, digits, within) in
        [(0, "-12", 1.0), (1, "-12", 1.0), (2, "-3", 1.0), (3, "-3", 1.0), (4, "-50", 2.0), (5, "-45", 2.0)]
    {
        let text = format!("{of}: rms {} against passive, %", NAMES[k]);
        let reading = format!("\"about\", taken as {within}");
        sheet.within(text, digits, second[0].change(k), (within, &reading)).excused_by("E6.9");
    }
    let drop = 100.0 * (second[0].gains[1] / second[0].gains[0] - 1.0);
    sheet.within(format!("{of}: ‖WT_zw‖∞ against passive, %"), "-4", drop, (1.0, "\"about\", taken as 1"));
    for (k, wheel) in [(6, "front"), (7, "rear")] {
        let share = 100.0 * second[0].active[k] / first[0].active[k];
        let text = format!("rms force, {wheel}: of (1, 1) over (0.1, 1.5), %");
        sheet.within(text, "40", share, (3.0, "\"about\", taken as 3"));
    }
    decreases(sheet, of, &second, ["0.5", "0.7", "4.0", "4.0", "0.6", "0.45"], "8.0");
    for k in [4, 5] {
        let half = HalfCar { inertia: 0.5, ..PRINTED };
        let reading = (15.0, "\"found to follow the patterns\" of −50 % and −45 %, taken as 15");
        let found = design(&half, 0.0, RHOS[1], None)?.change(k);
        let digits = if k == 4 { "-50" } else { "-45" };
        sheet.within(format!("{of}, half I_p: rms {} against passive, %", NAMES[k]), digits, found, reading);
    }
    Ok(())
}

fn decreases(sheet: &mut Sheet, of: &str, [none, most]: &[Design; 2], printed: [&str; 6], gain: &str) {
    let settle = |check: &mut Check| {
        check.excused_by("E6.9");
    };
    for (k, digits) in printed.into_iter().enumerate() {
        let text = format!("{of}: decrease by c_t = 100, active, rms {}, %", NAMES[k]);
        settle(sheet.printed(text, digits, decrease(none.active[k], most.active[k])));
    }
    let text = format!("{of}: decrease by c_t = 100, active, ‖WT_zw‖∞, %");
    settle(sheet.printed(text, gain, decrease(none.gains[1], most.gains[1])));
}

/// Gains of no tire damping and of the box 0…100 N s/m for both tires, and the plants of the box's corners.
pub(super) fn box_of_tires(rho: [f64; 2]) -> Result<[f64; 2], ReproduceError> {
    let corners = [[0.0, 0.0], [0.0, UP_TO], [UP_TO, 0.0], [UP_TO, UP_TO]];
    let plants = corners.map(|c| PRINTED.plant(c, Disturbance::RoadVelocity));
    let plants: Vec<GeneralizedPlant> = plants.into_iter().collect::<Result<_, _>>()?;
    let asked = HalfCar::goals(&plants[0], rho, FIXED)?;
    let most = &plants[3];
    let heave = |vertices: &[GeneralizedPlant]| -> Result<f64, ReproduceError> {
        let k = feedback(vertices, &asked)?.gain;
        let (a, c) = (most.a() + most.b2() * &k, most.c1() + most.d12() * &k);
        Ok(scale()? * h2(&StateSpace::continuous(a, most.b1(), c, most.d11())?, &[4])?)
    };
    Ok([heave(&plants)?, heave(&plants[..1])?])
}

/// §6.2.3: one gain for a box of tire dampings, and one for none.
pub(super) fn polytopic(_: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let [robust, nominal] = box_of_tires(RHOS[1])?;
    sheet.printed("rms heave at c_t = 100 with K₀, m/s²", "0.10145", robust).excused_by("E6.10");
    sheet.printed("rms heave at c_t = 100 with K̄₀, m/s²", "0.10160", nominal).excused_by("E6.10");
    let reading = "\"almost identical\": the printed two differ by 0.15 %";
    let apart = 100.0 * (nominal / robust - 1.0);
    sheet.bound("difference of the two, %", Relation::AtMost, "0.15", apart.abs()).noted(reading);
    Ok(())
}
