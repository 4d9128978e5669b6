//! Where a physical fit starts: the vehicle's own values, μ from hub pairs, the level at which the spectra agree.

use super::joint::Joint;
use super::model::Model;
use super::{PhysicalDrive, RoadStart};
use crate::identify::likelihood::FitError;
use crate::linalg::{C64, CMat};
use std::f64::consts::TAU;

/// Start of μ where no pair of hubs shows it.
const MU_START: f64 = 4.0;
/// Band in which hub pairs show μ, Hz.
const MU_BAND_HZ: [f64; 2] = [0.6, 12.0];

/// The start of all parameters.
pub(super) fn theta(
    joint: &Joint<'_>,
    drives: &[PhysicalDrive<'_>],
    roads: Option<&[RoadStart]>,
) -> Result<Vec<f64>, FitError> {
    let mut theta = vec![0.0; joint.len()];
    for (r, (model, drive)) in joint.models.iter().zip(drives).enumerate() {
        let layout = &model.layout;
        let mut local = vec![0.0; layout.len()];
        drive.vehicle.start().iter().enumerate().for_each(|(i, v)| local[i] = v.ln());
        let known = roads.and_then(|k| k.get(r));
        local[layout.exponent()] = known.map_or(2.0, |k| k.exponent);
        if let Some(i) = layout.mu {
            local[i] = match known.and_then(|k| k.mu) {
                Some(mu) => mu.ln(),
                None => starting_mu(model, drive)?.ln(),
            };
        }
        for (c, noise) in model.data.noise.iter().enumerate() {
            local[layout.noise + c] = noise.ln();
        }
        local[layout.s0()] = level(model, &local).map_err(FitError::Start)?;
        local.iter().enumerate().for_each(|(i, v)| theta[joint.place(r, i)] = *v);
    }
    Ok(theta)
}

/// Starting S₀: the level at which the model's spectra are the measured ones, in the median over bins and channels.
fn level(model: &Model<'_>, theta: &[f64]) -> Result<f64, String> {
    let mut quiet = theta.to_vec();
    quiet[model.layout.noise..].iter_mut().for_each(|t| *t = f64::MIN_POSITIVE.ln());
    let model_s = model.spectra(&quiet)?;
    let mut ratios: Vec<f64> = Vec::new();
    let n = model.layout.channels;
    for (s, m) in model_s.blocks().zip(model.data.measured.blocks()) {
        ratios.extend((0..n).map(|i| (m[i * n + i] / s[i * n + i]).ln()));
    }
    ratios.sort_by(f64::total_cmp);
    Ok(ratios.get(ratios.len() / 2).copied().unwrap_or(0.0))
}

/// −ln Re γ = μWω/(2πV) of channel pairs at wheels side by side (their own dynamics cancel in a symmetric car); the
/// median over pairs and band, or a typical value where no pair shows it.
fn starting_mu(model: &Model<'_>, drive: &PhysicalDrive<'_>) -> Result<f64, FitError> {
    let base = drive.vehicle.system(&drive.vehicle.start()).map_err(FitError::Start)?;
    let spectra = drive.spectra;
    // channels whose row looks at one unsprung mass only, and the wheel that pushes it
    let wheel_of = |channel: usize| -> Option<usize> {
        let row: Vec<usize> =
            (0..base.rows().ncols()).filter(|j| base.rows()[(channel, *j)] != 0.0).collect();
        let [dof] = row[..] else { return None };
        (0..base.at_m().len()).find(|w| base.wheel_stiffness()[(dof, *w)] != 0.0)
    };
    let at = base.at_m();
    let mut found: Vec<f64> = Vec::new();
    for i in 0..model.layout.channels {
        for j in 0..i {
            let (Some(a), Some(b)) = (wheel_of(i), wheel_of(j)) else { continue };
            let width = (at[a][1] - at[b][1]).abs();
            if at[a][0] != at[b][0] || width == 0.0 {
                continue;
            }
            for (k, f) in spectra.freq_hz.iter().enumerate() {
                if !(MU_BAND_HZ[0]..=MU_BAND_HZ[1]).contains(f) {
                    continue;
                }
                let s: &CMat = &spectra.s[k];
                let gamma: C64 = s[(i, j)] / (s[(i, i)].re * s[(j, j)].re).sqrt();
                if gamma.re > 0.05 {
                    found.push(-gamma.re.ln() * TAU * drive.speed_m_s / (width * spectra.omega_rad_s[k]));
                }
            }
        }
    }
    found.sort_by(f64::total_cmp);
    Ok(match found.get(found.len() / 2) {
        // hub pairs read 20–35 % low
        Some(mu) if found.len() > 10 => (1.25 * mu).clamp(0.3, 30.0),
        _ => MU_START,
    })
}
