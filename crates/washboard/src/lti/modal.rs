//! The modal form of a mechanical system: its receptance as a sum over all 2N poles.

use super::{MechanicsError, SecondOrder};
use crate::linalg::{C64, CMat, LinalgError, Mat, eigen, solve_complex};

/// The largest condition number of the (column-normalised) eigenvector matrix with which the modal form is believed:
/// its relative error is about ε times this.
const MAX_CONDITION: f64 = 1e8;

/// g(t) = Σₙ ψₙ ℓₙᵀ e^{λₙt}, or G(ω) = Σₙ ψₙ ℓₙᵀ/(iω − λₙ), over all 2N poles.
///
/// | symbol | shape | meaning |
/// |---|---|---|
/// | `poles` | 2N | λₙ, 1/s |
/// | `psi` | N × 2N | shapes ψₙ in the coordinates q |
/// | `l` | N × 2N | participation ℓₙ of each force |
///
/// For symmetric M, C, K: ℓₙ = ψₙ/m_an with *modal a* m_an = ψₙᵀ(C + 2λₙM)ψₙ. In general ℓₙ comes from the inverse of
/// the eigenvector matrix, so coordinates in which the equations are not symmetric are right too (the paper's eq. 57:
/// the output factor from the output coordinates, the input factor from the force coordinates).
///
/// Source: De Filippis et al., eqs. (12)–(28).
#[derive(Debug, Clone)]
pub struct ModalForm {
    poles: Vec<C64>,
    psi: CMat,
    l: CMat,
}

impl ModalForm {
    /// The modal form of a system.
    ///
    /// # Errors
    /// [`MechanicsError::Defective`] where poles repeat without independent shapes; an iteration that does not converge.
    pub fn new(system: &SecondOrder) -> Result<Self, MechanicsError> {
        let n = system.order();
        let (poles, v) = eigen(&system.state_matrix()?)?;
        // columns scaled to unit displacement-plus-scaled-velocity norm, rows to one frequency scale
        let speed = poles.iter().map(|p| p.norm()).fold(0.0, f64::max).max(f64::MIN_POSITIVE);
        let row = |i: usize| if i < n { 1.0 } else { 1.0 / speed };
        let norms: Vec<f64> = (0..2 * n)
            .map(|j| (0..2 * n).map(|i| (v[(i, j)] * row(i)).norm_sqr()).sum::<f64>().sqrt())
            .collect();
        let scaled = CMat::from_fn(2 * n, 2 * n, |i, j| v[(i, j)] * (row(i) / norms[j]));
        let s = scaled
            .singular_values()
            .map_err(|_| LinalgError::NoConvergence { what: "the SVD", order: 2 * n })?;
        let condition = s[0] / s[2 * n - 1];
        // NaN must be refused too
        if !(condition <= MAX_CONDITION) {
            return Err(MechanicsError::Defective { condition, limit: MAX_CONDITION });
        }
        // V ℓᵀ = [0; M⁻¹]
        let m_inverse = crate::linalg::solve(system.m(), &Mat::identity(n, n))?;
        let b = CMat::from_fn(2 * n, n, |i, j| {
            if i < n { C64::new(0.0, 0.0) } else { C64::new(m_inverse[(i - n, j)] / speed, 0.0) }
        });
        let lt = solve_complex(&scaled, &b)?;
        let psi = CMat::from_fn(n, 2 * n, |i, j| scaled[(i, j)]);
        Ok(ModalForm { poles, psi, l: lt.transpose().to_owned() })
    }

    /// All 2N poles λₙ, 1/s.
    #[must_use]
    pub fn poles(&self) -> &[C64] {
        &self.poles
    }

    /// Shapes ψₙ as columns (N × 2N).
    #[must_use]
    pub fn psi(&self) -> &CMat {
        &self.psi
    }

    /// Participation factors ℓₙ as columns (N × 2N).
    #[must_use]
    pub fn l(&self) -> &CMat {
        &self.l
    }

    /// The receptance G(ω) = Σₙ ψₙℓₙᵀ/(iω − λₙ) (N × N).
    #[must_use]
    pub fn receptance(&self, omega_rad_s: f64) -> CMat {
        let n = self.psi.nrows();
        let weighted =
            CMat::from_fn(n, 2 * n, |i, j| self.psi[(i, j)] / (C64::new(0.0, omega_rad_s) - self.poles[j]));
        &weighted * self.l.transpose()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn system(c01: f64) -> SecondOrder {
        let m = Mat::from_fn(2, 2, |i, j| if i == j { [240.0, 36.0][i] } else { 0.0 });
        let c = Mat::from_fn(2, 2, |i, j| [[980.0, c01], [-980.0, 1080.0]][i][j]);
        let k = Mat::from_fn(2, 2, |i, j| [[16e3, -16e3], [-16e3, 176e3]][i][j]);
        SecondOrder::new(m, c, k).unwrap()
    }

    #[test]
    fn the_sum_over_poles_is_the_inverse_dynamic_stiffness() {
        for c01 in [-980.0, 0.0] {
            let system = system(c01);
            let form = ModalForm::new(&system).unwrap();
            for omega in [0.0, 3.0, 8.0, 70.0, 400.0] {
                let product = system.dynamic_stiffness(omega) * form.receptance(omega);
                for i in 0..2 {
                    for j in 0..2 {
                        let expected = f64::from(u8::from(i == j));
                        assert!((product[(i, j)] - C64::new(expected, 0.0)).norm() < 1e-12);
                    }
                }
            }
        }
    }

    #[test]
    fn the_participation_is_the_shape_over_modal_a_where_the_matrices_are_symmetric() {
        let system = system(-980.0);
        let form = ModalForm::new(&system).unwrap();
        for n in 0..4 {
            let psi = |i: usize| form.psi()[(i, n)];
            let mut modal_a = C64::new(0.0, 0.0);
            for i in 0..2 {
                for j in 0..2 {
                    modal_a += psi(i)
                        * psi(j)
                        * (form.poles()[n] * 2.0 * system.m()[(i, j)] + C64::new(system.c()[(i, j)], 0.0));
                }
            }
            for i in 0..2 {
                let expected = psi(i) / modal_a;
                assert!((form.l()[(i, n)] - expected).norm() < 1e-12 * expected.norm());
            }
        }
    }

    #[test]
    fn a_free_mass_has_no_modal_form() {
        let one = |v: f64| Mat::from_fn(1, 1, |_, _| v);
        let free = SecondOrder::new(one(1.0), one(0.0), one(0.0)).unwrap();
        assert!(matches!(ModalForm::new(&free), Err(MechanicsError::Defective { .. })));
    }
}
