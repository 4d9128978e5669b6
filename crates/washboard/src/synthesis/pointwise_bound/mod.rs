//! What no controller of any order beats: the least goal that any control reaches at one frequency, at the worst frequency.

mod discs;
mod matrices;
mod sweep;
mod terms;

use super::{SynthesisError, Target};
use crate::lti::GeneralizedPlant;
use sweep::Sweep;

/// Goals and bounds against what is possible at single frequencies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointwiseBound {
    /// The largest of all H∞ goals, value/unit, is at least this with every controller that keeps the H∞ bounds. `None`
    /// where there is no H∞ goal, or where `impossible` says that no controller keeps them.
    pub goal: Option<PointwiseLevel>,
    /// Where no control keeps all H∞ bounds of a plant: the least largest value/limit, above 1.
    pub impossible: Option<PointwiseLevel>,
}

/// A level that no controller goes below.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointwiseLevel {
    /// The level: a share of units or limits.
    pub level: f64,
    /// At which frequency.
    pub omega_rad_s: f64,
    /// For which plant.
    pub plant: usize,
}

/// A lower bound of the H∞ goals of every stabilising controller, of any order and structure.
///
/// At a frequency every loop is T = G_zw + G_zu V with V = K(I − G_yu K)⁻¹G_yw, so
///
///   min over all V ∈ C^(nu × nw) of max_i σ̄(W_i T)/unit_i  subject to  σ̄(W_j T) ≤ limit_j
///
/// is at most what any K reaches: what K cannot make of V, and that V(jω) belongs to one stable function, is left out. The
/// bound is its largest value over a grid, refined around the largest ones; every frequency alone gives a valid bound, a
/// denser grid only a better one. Plants share K and not V, so theirs are solved one by one. Measures other than H∞ norms
/// are left out, which leaves the bound valid.
///
/// | symbol | shape |
/// |---|---|
/// | `frequencies` | further frequencies, rad/s; 0 and those of the axis's poles are left out |
///
/// One control and one disturbance: each target is a disc of V, and the least level at which all discs meet is found by
/// bisection over their corners. Otherwise: a semidefinite program, of which only the dual solution is believed: for Z_i with
/// Σ B_iᴴ Z_i = 0, level ≥ (Σ Re⟨Z_i, A_i⟩ − Σ limit_j‖Z_j‖_*)/Σ unit_i‖Z_i‖_*, which is evaluated after projecting the Z_i
/// onto that condition. Levels are lowered for the responses' rounding, which grows towards the axis's poles (frequencies nearer to one
/// than 2·10⁻⁸ of the fastest are left out), and by 10⁻⁷; bounds may be exceeded by 10⁻⁶. So they hold as far as double precision tells; a zero of
/// G_zu within 3·10⁻¹⁵ of the axis is taken to be on it.
///
/// # Errors
/// A target that is not of the plants; matrices that are not finite.
pub fn pointwise_bound(
    plants: &[GeneralizedPlant],
    targets: &[Target],
    frequencies: &[f64],
) -> Result<PointwiseBound, SynthesisError> {
    for target in targets {
        target.check(plants)?;
    }
    let mut found = PointwiseBound { goal: None, impossible: None };
    let larger = |old: &mut Option<PointwiseLevel>, new: Option<PointwiseLevel>| {
        if let Some(new) = new
            && old.is_none_or(|o| new.level > o.level)
        {
            *old = Some(new);
        }
    };
    for (k, plant) in plants.iter().enumerate() {
        let of: Vec<&Target> = targets.iter().filter(|t| t.plant == k).collect();
        let Some(sweep) = Sweep::new(plant, &of)? else { continue };
        let [goal, impossible] = sweep.worst(frequencies)?;
        let here = |(omega_rad_s, level)| PointwiseLevel { level, omega_rad_s, plant: k };
        larger(&mut found.goal, goal.map(here));
        larger(&mut found.impossible, impossible.map(here));
    }
    if found.impossible.is_some() {
        found.goal = None;
    }
    Ok(found)
}

#[cfg(test)]
mod tests;
