//! A mixed design's closed loop, measured: what the inequalities promise beside what is so.

use super::goals::MixedGoals;
use super::state_feedback::MixedClaims;
use crate::linalg::{C64, Mat};
use crate::lti::{Continuous, GeneralizedPlant, LtiError, StateSpace};
use crate::synthesis::SynthesisError;

/// A norm may exceed its promise by this share: rounding of the solver and of the way back.
const EXCESS: f64 = 1e-4;
/// A pole may be outside its region by this share of its size.
const OUTSIDE: f64 = 1e-3;

/// What a closed loop has, recomputed from plant and controller alone.
#[derive(Debug, Clone, PartialEq)]
pub struct MixedAchieved {
    /// ‖T₂‖ of each H2 goal.
    pub h2: Vec<f64>,
    /// ‖T∞‖ of each H∞ goal.
    pub hinf: Vec<f64>,
    /// Poles.
    pub poles: Vec<C64>,
}

/// Measures a closed loop, and refuses what contradicts the claims.
pub(super) fn achieved(
    closed: &StateSpace<Continuous>,
    goals: &MixedGoals,
    claims: &MixedClaims,
) -> Result<MixedAchieved, SynthesisError> {
    closed.check_stable("the closed loop")?;
    let hinf = goals
        .hinf
        .iter()
        .map(|g| Ok(channel(closed, &g.outputs, &g.disturbances)?.hinf_norm()?.norm))
        .collect::<Result<Vec<f64>, LtiError>>()?;
    let h2 = goals
        .h2
        .iter()
        .map(|g| channel(closed, &g.outputs, &g.disturbances)?.h2_norm())
        .collect::<Result<Vec<f64>, LtiError>>()?;
    let refuse = |what: &'static str, claimed: f64, found: f64| {
        if found <= claimed * (1.0 + EXCESS) {
            return Ok(());
        }
        Err(SynthesisError::Refused { what, claimed, found })
    };
    for (claimed, found) in claims.hinf.iter().zip(&hinf) {
        refuse("an H∞ norm's bound", *claimed, *found)?;
    }
    for (claimed, found) in claims.h2.iter().zip(&h2) {
        refuse("an H2 norm's bound", *claimed, *found)?;
    }
    let poles = closed.poles()?;
    let (worst, size) = poles
        .iter()
        .map(|p| (goals.region.outside(*p), p.norm()))
        .fold((f64::NEG_INFINITY, 1.0), |a, b| if b.0 > a.0 { b } else { a });
    refuse("the distance of a pole from its region", OUTSIDE * size, worst.max(0.0))?;
    Ok(MixedAchieved { h2, hinf, poles })
}

/// Rows and columns of a goal, weighted.
fn channel(
    closed: &StateSpace<Continuous>,
    outputs: &[(usize, f64)],
    disturbances: &[usize],
) -> Result<StateSpace<Continuous>, LtiError> {
    let rows: Vec<usize> = outputs.iter().map(|o| o.0).collect();
    let all: Vec<usize> = (0..closed.inputs()).collect();
    let one = closed.select(&rows, if disturbances.is_empty() { &all } else { disturbances })?;
    let weighted = |m: &Mat| Mat::from_fn(m.nrows(), m.ncols(), |i, j| outputs[i].1 * m[(i, j)]);
    StateSpace::continuous(one.a().clone(), one.b().clone(), weighted(one.c()), weighted(one.d()))
}

/// A plant under u = Kx: from w to z.
pub(super) fn with_feedback(plant: &GeneralizedPlant, k: &Mat) -> Result<StateSpace<Continuous>, LtiError> {
    let a = plant.a() + plant.b2() * k;
    let c = plant.c1() + plant.d12() * k;
    StateSpace::continuous(a, plant.b1(), c, plant.d11())
}
