//! Norms of a system: H2, by Lyapunov's equation, and H∞, by level sets of the largest singular value.

mod hinf;
pub(crate) mod peak;

pub use hinf::HinfNorm;

use super::{Continuous, Discrete, LtiError, StateSpace, Time};
use crate::linalg::{LinalgError, Mat, discrete_lyapunov_factor, lyapunov_factor};

/// A feedthrough below this share of the largest entry of C and B is rounding.
const ROUNDING_OF_D: f64 = 1e-13;

impl StateSpace<Continuous> {
    /// ‖G‖₂ = √(tr C P Cᵀ) = ‖C L‖ with A P + P Aᵀ + B Bᵀ = 0, P = L Lᵀ never formed: the rms of the outputs under unit white noise, and the root of
    /// (1/2π)∫ tr G^H G dω.
    ///
    /// # Errors
    /// A system that is not stable, feedthrough (the norm is infinite), a norm that overflows.
    pub fn h2_norm(&self) -> Result<f64, LtiError> {
        let norm = self.h2_of_outputs()?.into_iter().fold(0.0, f64::hypot);
        finite(norm).map(|()| norm)
    }

    /// The H2 norm of each output by itself: its rms under unit white noise at all inputs.
    ///
    /// # Errors
    /// As [`StateSpace::h2_norm`].
    pub fn h2_of_outputs(&self) -> Result<Vec<f64>, LtiError> {
        let norm = self.d().norm_max();
        if norm > ROUNDING_OF_D * self.b().norm_max() * self.c().norm_max() {
            return Err(LtiError::NotStrictlyProper { what: "the H2 norm", norm });
        }
        let g = self.balanced_scales()?.0;
        let all = lengths(g.c(), &stable(&g, lyapunov_factor(g.a(), g.b()))?);
        all.iter().try_for_each(|v| finite(*v))?;
        Ok(all)
    }
}

impl StateSpace<Discrete> {
    /// ‖G‖₂ = √(tr(C P Cᵀ + D Dᵀ)) with A P Aᵀ − P + B Bᵀ = 0: the rms of the outputs under unit white noise.
    ///
    /// # Errors
    /// A system that is not stable.
    pub fn h2_norm(&self) -> Result<f64, LtiError> {
        let g = self.balanced_scales()?.0;
        let factor = stable(&g, discrete_lyapunov_factor(g.a(), g.b()))?;
        let norm = (g.c() * factor).norm_l2().hypot(g.d().norm_l2());
        finite(norm).map(|()| norm)
    }
}

/// Refuses a norm that overflowed.
fn finite(value: f64) -> Result<(), LtiError> {
    if value.is_finite() {
        return Ok(());
    }
    Err(LinalgError::NotFinite { name: "the H2 norm", row: 0, col: 0, value }.into())
}

/// The factor of the Gramian, or why there is none.
fn stable<T: Time>(g: &StateSpace<T>, factor: Result<Mat, LinalgError>) -> Result<Mat, LtiError> {
    match factor {
        // the equation's refusal says less than the pole
        Err(e) => Err(g.check_stable("the H2 norm").err().unwrap_or(e.into())),
        Ok(l) => Ok(l),
    }
}

/// √(c P cᵀ) = ‖c L‖ of each row c, P = L Lᵀ.
fn lengths(c: &Mat, l: &Mat) -> Vec<f64> {
    let cl = c * l;
    (0..c.nrows()).map(|i| cl.row(i).norm_l2()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::{integrate, lyapunov};

    fn oscillator(zeta: f64, omega: f64) -> StateSpace<Continuous> {
        let a = Mat::from_fn(2, 2, |i, j| [[0.0, 1.0], [-omega * omega, -2.0 * zeta * omega]][i][j]);
        let b = Mat::from_fn(2, 1, |i, _| i as f64);
        StateSpace::continuous(a, b, Mat::identity(2, 2), Mat::zeros(2, 1)).unwrap()
    }

    #[test]
    fn an_oscillators_rms_is_known() {
        let (zeta, omega) = (0.07, 9.0);
        let rms = oscillator(zeta, omega).h2_of_outputs().unwrap();
        assert!((rms[0] / (4.0 * zeta * omega.powi(3)).powf(-0.5) - 1.0).abs() < 1e-13);
        assert!((rms[1] / (4.0 * zeta * omega).powf(-0.5) - 1.0).abs() < 1e-13);
    }

    #[test]
    fn the_norm_is_the_integral_over_frequency_and_that_of_the_dual() {
        let any = |r, c, s: f64| {
            Mat::from_fn(r, c, |i, j| {
                ((5 * i * i + 7 * j + i * j) as f64 + s).sin() - f64::from(u8::from(i == j)) * 2.5
            })
        };
        let g =
            StateSpace::continuous(any(5, 5, 0.3), any(5, 2, 1.0), any(3, 5, 2.0), Mat::zeros(3, 2)).unwrap();
        let h2 = g.h2_norm().unwrap();
        assert!((h2 / g.transposed().h2_norm().unwrap() - 1.0).abs() < 1e-12);
        // the other Gramian, formed: tr BᵀQB with AᵀQ + QA + CᵀC = 0
        let q = lyapunov(&g.a().transpose().to_owned(), &(g.c().transpose() * g.c())).unwrap().x;
        let trace: f64 = (0..2).map(|j| (g.b().transpose() * &q * g.b())[(j, j)]).sum();
        assert!((h2 / trace.sqrt() - 1.0).abs() < 1e-13);
        // ω = tan θ covers the whole axis
        let responder = g.responder().unwrap();
        let density = |theta: f64, out: &mut [f64]| {
            let w = theta.tan();
            out[0] = responder.at_frequency(w).map_or(0.0, |m| m.norm_l2().powi(2)) * (1.0 + w * w);
        };
        let half = std::f64::consts::FRAC_PI_2 * (1.0 - 1e-9);
        let found = integrate(density, 1, &[0.0, half], 1e-10, &[0.0], 100_000).values[0];
        assert!((h2 * h2 - found / std::f64::consts::PI).abs() < 1e-6 * h2 * h2);
        let d = g.bilinear(1.0, 1.0).unwrap();
        let power: f64 = (0..4000)
            .map(|k| {
                let w = (f64::from(k) + 0.5) * std::f64::consts::PI / 4000.0;
                d.frequency_response(&[w]).unwrap()[0].norm_l2().powi(2) / 4000.0
            })
            .sum();
        assert!((d.h2_norm().unwrap().powi(2) / power - 1.0).abs() < 1e-9);
    }

    #[test]
    fn infinite_norms_are_errors() {
        let g = oscillator(0.1, 1.0);
        let mut d = Mat::zeros(2, 1);
        d[(0, 0)] = 1e-3;
        let through = StateSpace::continuous(g.a().clone(), g.b().clone(), g.c().clone(), d).unwrap();
        assert!(matches!(through.h2_norm(), Err(LtiError::NotStrictlyProper { norm, .. }) if norm == 1e-3));
        assert!(matches!(oscillator(-0.1, 1.0).h2_norm(), Err(LtiError::NotStable { .. })));
        assert!(matches!(oscillator(0.0, 1.0).h2_norm(), Err(LtiError::NotStable { .. })));
    }
}
