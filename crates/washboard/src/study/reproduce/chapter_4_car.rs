//! Chapter 4: the car of table 4.1, its modes, its invariant frequencies and its road.

use super::ReproduceError;
use super::context::{Context, DAMPED, OVERDAMPED, three};
use super::item::Sheet;
use std::f64::consts::TAU;

/// Table 4.1, in the order in which it is printed: what the case starts from.
pub(super) fn parameters(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let n = &context.numbers;
    for (name, digits, found) in [
        ("m_s, kg", "240", n.ms),
        ("m_u, kg", "36", n.mu),
        ("c_s, N s/m", "980", n.cs),
        ("k_s, N/m", "16000", n.ks),
        ("k_t, N/m", "160000", n.kt),
    ] {
        sheet.within(name, digits, found, (0.0, "an input"));
    }
    Ok(())
}

/// (4.32).
pub(super) fn invariant_frequencies(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let (w1, w2) = context.car(0.0)?.invariant_omegas_rad_s();
    sheet.printed("ω₁, Hz", "3.832", w1 / TAU);
    sheet.printed("ω₂, Hz", "10.610", w2 / TAU);
    Ok(())
}

/// (4.50): 2πn₀√κ, printed in chapter 6 as 0.0027.
pub(super) fn road(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let scale = (context.intensity / super::context::SPEED_M_S).sqrt();
    sheet.printed("2πn₀√κ", "0.0027", scale);
    Ok(())
}

/// Modes and passive rms values of §4.4.
pub(super) fn modes_and_rms(context: &Context, sheet: &mut Sheet) -> Result<(), ReproduceError> {
    let modes = [
        (0.0, ["1.2507", "0.2178", "11.0247", "0.2013"]),
        (DAMPED, ["1.2504", "0.2180", "11.0267", "0.2209"]),
        (OVERDAMPED, ["1.2463", "0.2211", "11.0628", "0.5919"]),
    ];
    for (ct, printed) in modes {
        let mut spec = context.spec.clone();
        if let Some(car) = spec.quarter_car.as_mut() {
            car.tire_damping_n_s_per_m = ct;
        }
        let found = spec.build_alone()?.modes()?;
        let [heave, hop] = &found[..] else {
            return Err(ReproduceError::unexpected("modes", "two oscillatory modes", found.len()));
        };
        for (name, mode, [hz, zeta]) in
            [("heave", &heave.0, [printed[0], printed[1]]), ("wheel hop", &hop.0, [printed[2], printed[3]])]
        {
            sheet.printed(format!("{name}, Hz, c_t = {ct}"), hz, mode.freq_hz);
            sheet.printed(format!("{name}, damping ratio, c_t = {ct}"), zeta, mode.damping);
        }
    }
    for (ct, printed) in [
        (0.0, ["0.5424", "0.0046", "0.0017"]),
        (DAMPED, ["0.5259", "0.0045", "0.0017"]),
        (OVERDAMPED, ["0.4513", "0.0043", "0.0011"]),
    ] {
        three(sheet, &format!("passive, c_t = {ct}"), printed, context.passive_rms(ct)?);
    }
    Ok(())
}
