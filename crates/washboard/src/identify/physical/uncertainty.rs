//! Standard deviations of the modes of a fitted vehicle.

use super::model::Model;
use crate::identify::likelihood::Covariance;
use crate::lti::{Mode, ModeKind};

/// Step in the logarithms of parameters for the derivatives of poles.
const STEP: f64 = 1e-4;

/// Modes at θ with the standard deviations of f in Hz and of ζ, by the derivatives of the poles.
pub(super) fn modes(
    model: &Model<'_>,
    theta: &[f64],
    covariance: &Covariance,
) -> Result<Vec<(Mode, f64, f64)>, String> {
    let poles = |theta: &[f64]| -> Result<Vec<Mode>, String> {
        crate::lti::modes(model.system(theta)?.system()).map_err(|e| e.to_string())
    };
    let base = poles(theta)?;
    let n = model.layout.vehicle;
    let mut by_f = vec![vec![0.0; n]; base.len()];
    let mut by_zeta = vec![vec![0.0; n]; base.len()];
    for p in 0..n {
        let mut moved = theta.to_vec();
        moved[p] = theta[p] + STEP;
        let up = poles(&moved)?;
        moved[p] = theta[p] - STEP;
        let down = poles(&moved)?;
        for (m, mode) in base.iter().enumerate() {
            let near = |set: &[Mode]| -> Mode {
                let distance = |o: &&Mode| -> f64 { (o.pole - mode.pole).norm() };
                set.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(mode).clone()
            };
            let (a, b) = (near(&up), near(&down));
            by_f[m][p] = (a.freq_hz - b.freq_hz) / (2.0 * STEP);
            by_zeta[m][p] = (a.damping - b.damping) / (2.0 * STEP);
        }
    }
    Ok(base
        .into_iter()
        .enumerate()
        .map(|(m, mode)| {
            // a real pole has no damping ratio to be uncertain of
            let zeta =
                if mode.kind == ModeKind::Oscillatory { covariance.sd_along(&by_zeta[m]) } else { 0.0 };
            let f: f64 = covariance.sd_along(&by_f[m]);
            (mode, f, zeta)
        })
        .collect())
}
