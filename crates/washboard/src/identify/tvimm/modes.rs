//! Modes of a free state space, with the derivatives of their frequencies and dampings.

use super::model::RATE;
use super::orbit::Entries;
use crate::identify::likelihood::Covariance;
use crate::linalg::{C64, CMat, LinalgError, Mat, eigen, solve_complex};
use crate::lti::{FirstOrder, Mode, ModeKind};
use std::f64::consts::TAU;

/// An imaginary part below this share of |λ| is rounding.
const REAL_TOLERANCE: f64 = 1e-9;

/// All modes of a system in scaled time, shapes at the sensors (displacements), ascending in frequency, with the standard
/// deviations of f (Hz) and ζ. dλ = wᵀ dA v with wᵀv = 1; `basis` are the coordinates of the covariance's first entries.
pub(super) fn modes(
    system: &FirstOrder,
    basis: &Mat,
    covariance: &Covariance,
) -> Result<Vec<(Mode, f64, f64)>, LinalgError> {
    let e = Entries::of(system);
    let n = e.states;
    let (poles, v) = eigen(&system.a)?;
    let w = solve_complex(&v, &CMat::identity(n, n))?;
    let mut found = Vec::new();
    for (k, scaled) in poles.iter().enumerate() {
        let oscillatory = scaled.im.abs() > REAL_TOLERANCE * scaled.norm();
        if oscillatory && scaled.im < 0.0 {
            continue;
        }
        let kind = if oscillatory { ModeKind::Oscillatory } else { ModeKind::Overdamped };
        let pole = *scaled * RATE;
        let shape =
            (0..e.outputs).map(|c| (0..n).map(|j| v[(j, k)] * system.c[(c, j)]).sum::<C64>()).collect();
        let (mut by_f, mut by_zeta) = (vec![0.0; e.len()], vec![0.0; e.len()]);
        let size = pole.norm();
        for i in 0..n {
            for j in 0..n {
                let d: C64 = w[(k, i)] * v[(j, k)] * RATE;
                let along = (pole.conj() * d).re / size;
                by_f[e.at(i, j)] = along / TAU;
                by_zeta[e.at(i, j)] = -d.re / size + pole.re * along / (size * size);
            }
        }
        let sd = |by: Vec<f64>| {
            let g = basis.transpose() * Mat::from_fn(e.len(), 1, |i, _| by[i]);
            covariance.sd_along(&(0..g.nrows()).map(|i| g[(i, 0)]).collect::<Vec<_>>())
        };
        let (f_sd, zeta_sd) = (sd(by_f), if oscillatory { sd(by_zeta) } else { 0.0 });
        found.push((Mode::new(pole, kind, shape), f_sd, zeta_sd));
    }
    found.sort_by(|a, b| a.0.freq_hz.total_cmp(&b.0.freq_hz));
    Ok(found)
}
