//! What no controller can beat: the infimum of ‖T_zw‖₂ as sensor noise vanishes, by two routes that share only A, B, C, D.

use super::h2::{symmetric, trace};
use super::{Regulator, SynthesisError, lqr_of_output};
use crate::linalg::{Mat, lyapunov, solve, sylvester};
use crate::lti::{GeneralizedPlant, LtiError, StateSpace};

/// The infimum of ‖T_zw‖₂², split as the closed form has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct H2Limit {
    /// inf ‖T_zw‖₂: the root of the two terms' sum.
    pub h2: f64,
    /// ‖N⊥~F‖₂² = ‖F‖₂² − ‖Hᵢ~F‖₂², both projections of it: what is orthogonal to all that controls reach.
    pub orthogonal: f64,
    /// ‖Π⊥ Hᵢ~F‖₂²: what no causal controller cancels.
    pub anticipated: f64,
}

/// The regulator that sees all states and disturbances, and its ‖T_zw‖₂ = √tr(B₁ᵀX B₁): the infimum over all
/// controllers whose measurements lose nothing as their noise vanishes (no zeros from w to y in the open right half
/// plane, at least as many measurements as disturbances).
///
/// # Errors
/// As [`lqr`]; D₁₁ that is not zero.
pub fn full_information(plant: &GeneralizedPlant) -> Result<(f64, Regulator), SynthesisError> {
    let norm = plant.d11().norm_max();
    if norm > 0.0 {
        return Err(LtiError::NotStrictlyProper { what: "the H2 norm", norm }.into());
    }
    let (c1, d12, b1) = (plant.c1(), plant.d12(), plant.b1());
    let regulator = lqr_of_output(plant.a(), &plant.b2(), &c1, &d12)?;
    let value = trace(&(b1.transpose() * &regulator.solution.x * &b1));
    Ok((value.max(0.0).sqrt(), regulator))
}

/// inf over stable Q of ‖F − H Q‖₂ with F = (A, B₁, C₁, 0) and H = (A, B₂, C₁, D₁₂), by an inner-outer factorisation
/// H = Hᵢ H_o and the complementary inner factor N⊥, [Hᵢ N⊥] square and inner:
///
/// ‖Π N⊥~F‖₂² + ‖Π⊥ N⊥~F‖₂² + ‖Π⊥ Hᵢ~F‖₂² = ‖F‖₂² − ‖Π Hᵢ~F‖₂²,
///
/// Π the projection onto what is stable; the right side needs no N⊥, whose Gramian is singular where delays are many. A must
/// be stable.
///
/// # Errors
/// A plant that is not stable, D₁₁ that is not zero; a D₁₂ without full column rank; a zero of H on the axis.
///
/// Source: Türkay's thesis, (5.8)–(5.18) and (6.8)–(6.12); Zhou, Doyle, Glover, *Robust and Optimal Control*, 13.31.
pub fn h2_limit(plant: &GeneralizedPlant) -> Result<H2Limit, SynthesisError> {
    plant.passive().check_stable("the closed form of the H2 limit")?;
    let norm = plant.d11().norm_max();
    if norm > 0.0 {
        return Err(LtiError::NotStrictlyProper { what: "the H2 norm", norm }.into());
    }
    let balanced = plant.system().balanced_scales()?.0;
    let plant = GeneralizedPlant::new(balanced, plant.signals().clone())?;
    let (a, b1, b2, c1, d12) = (plant.a(), plant.b1(), plant.b2(), plant.c1(), plant.d12());
    let m = plant.nu();
    // H = Hᵢ H_o: Hᵢ = (A + B₂F, B₂R^-½, C₁ + D₁₂F, D₁₂R^-½), R = D₁₂ᵀD₁₂ = UᵀU
    let (_, regulator) = full_information(&plant)?;
    let f = &regulator.gain;
    let qr = d12.qr();
    let upper = qr.thin_R().to_owned();
    let over = solve(&upper, &Mat::identity(m, m))?;
    let (ai, ci) = (a + &b2 * f, &c1 + &d12 * f);
    let bi = &b2 * &over;
    // M~F for M = (Aᵢ, B, Cᵢ, D) is (DᵀC₁ + BᵀZ)(sI − A)⁻¹B₁ + Bᵀ(−sI − Aᵢᵀ)⁻¹Z B₁ with AᵢᵀZ + Z A + CᵢᵀC₁ = 0
    let z = sylvester(&ai.transpose().to_owned(), a, &-(ci.transpose() * &c1))?.x;
    // the antistable part's square is tr(Bᵀ P B) with AᵢᵀP + P Aᵢ + Z B₁B₁ᵀZᵀ = 0
    let driven = &z * &b1;
    let p_anti = lyapunov(&ai.transpose().to_owned(), &symmetric(&(&driven * driven.transpose())))?.x;
    let anticipated = trace(&(bi.transpose() * &p_anti * &bi)).max(0.0);
    // the stable part is what a causal controller cancels
    let inner = bi.transpose() * &z + (&d12 * &over).transpose() * &c1;
    let cancelled = StateSpace::continuous(a.clone(), b1.clone(), inner, Mat::zeros(m, plant.nw()))?;
    let cancelled = cancelled.h2_norm()?.powi(2);
    let orthogonal = (plant.passive().h2_norm()?.powi(2) - cancelled - anticipated).max(0.0);
    let h2 = (orthogonal + anticipated).sqrt();
    Ok(H2Limit { h2, orthogonal, anticipated })
}
