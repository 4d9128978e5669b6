//! The classical model of operational modal analysis: white, uncorrelated forces. Eqs. (2)–(4), (47), (48).

use crate::linalg::{C64, CMat, Mat};
use crate::lti::{MechanicsError, ModalForm, SecondOrder};

/// S_q(ω) = Σₙ φₙψₙᵀ/(iω − λₙ) + ψₙφₙᵀ/(−iω − λₙ) with constant reference vectors φₙ.
#[derive(Debug, Clone)]
pub struct ClassicalModel {
    poles: Vec<C64>,
    psi: CMat,
    phi: CMat,
}

impl ClassicalModel {
    /// The model of a system whose coordinates bear white forces of two-sided densities `force_psd` (N²·s/rad, one a
    /// coordinate), for output rows over q.
    ///
    /// φ_in = −Σₘ ψ_im Σ_k S_k ℓ_km ℓ_kn/(λₙ + λₘ).
    ///
    /// # Errors
    /// A system without modal form; shapes that do not fit.
    pub fn new(system: &SecondOrder, rows: &Mat, force_psd: &[f64]) -> Result<Self, MechanicsError> {
        let n = system.order();
        if force_psd.len() != n || rows.ncols() != n {
            let found = (rows.ncols(), force_psd.len());
            return Err(MechanicsError::Shape { name: "rows and force_psd", expected: (n, n), found });
        }
        let form = ModalForm::new(system)?;
        let (poles, l) = (form.poles().to_vec(), form.l());
        let modes = poles.len();
        let psi = CMat::from_fn(rows.nrows(), modes, |i, m| {
            (0..n).map(|k| form.psi()[(k, m)] * rows[(i, k)]).sum::<C64>()
        });
        let phi = CMat::from_fn(rows.nrows(), modes, |i, nn| {
            -(0..modes)
                .map(|m| {
                    let force: C64 = (0..n).map(|k| l[(k, m)] * l[(k, nn)] * force_psd[k]).sum();
                    psi[(i, m)] * force / (poles[nn] + poles[m])
                })
                .sum::<C64>()
        });
        Ok(ClassicalModel { poles, psi, phi })
    }

    /// All 2N poles λₙ, 1/s.
    #[must_use]
    pub fn poles(&self) -> &[C64] {
        &self.poles
    }

    /// Reference vectors φₙ (outputs × 2N).
    #[must_use]
    pub fn phi(&self) -> &CMat {
        &self.phi
    }

    /// S_q(ω), eq. (4).
    #[must_use]
    pub fn spectrum(&self, omega_rad_s: f64) -> CMat {
        let half = self.half_spectrum(omega_rad_s);
        &half + self.half_spectrum(-omega_rad_s).transpose()
    }

    /// The half spectrum Σₙ φₙψₙᵀ/(iω − λₙ), eq. (47): the transform of the positive lags.
    #[must_use]
    pub fn half_spectrum(&self, omega_rad_s: f64) -> CMat {
        let weighted = CMat::from_fn(self.phi.nrows(), self.phi.ncols(), |i, n| {
            self.phi[(i, n)] / (C64::new(0.0, omega_rad_s) - self.poles[n])
        });
        &weighted * self.psi.transpose()
    }

    /// R_q(τ), eq. (3).
    #[must_use]
    pub fn correlation(&self, lag_s: f64) -> Mat {
        let (out, modes) = (self.phi.nrows(), self.phi.ncols());
        let entry = |i: usize, j: usize| -> f64 {
            (0..modes)
                .map(|n| (self.phi[(i, n)] * self.psi[(j, n)] * (self.poles[n] * lag_s.abs()).exp()).re)
                .sum()
        };
        Mat::from_fn(out, out, |i, j| if lag_s >= 0.0 { entry(i, j) } else { entry(j, i) })
    }
}
