//! The H∞ controller of full order: bisection on the level, two Riccati equations a level.

mod equations;

use super::{SynthesisError, broken_assumptions};
use crate::lti::{Continuous, GeneralizedPlant, StateSpace};
use equations::{Normal, Refused, Solved};

/// Halvings of the level, at most.
const MOST_LEVELS: usize = 80;
/// The controller is taken this far above the least level, then further, until its own norm confirms it.
const BACK_OFF: [f64; 6] = [1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1];

/// Stretches of levels where rounding breaks the equations, that are searched below, at most.
const MOST_HOLES: usize = 6;
/// Levels that are tried below such a stretch, as shares of its upper end.
const BELOW: [f64; 6] = [0.97, 0.9, 0.7, 0.5, 0.3, 0.1];
/// At a level's end the closed loop's slowest pole vanishes (or a solution grows) by more than this against the level
/// [`AWAY`] above; by the root of the tolerance over that.
const VANISHES: f64 = 0.05;
const AWAY: f64 = 1.1;

/// What the search is to do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HinfSettings {
    /// The level is found to this share.
    pub tolerance: f64,
    /// Where to start: a level that is surely enough is found from here by doubling.
    pub first_level: f64,
}

impl Default for HinfSettings {
    fn default() -> Self {
        HinfSettings { tolerance: 1e-7, first_level: 1.0 }
    }
}

/// An H∞ controller.
#[derive(Debug, Clone)]
pub struct HinfDesign {
    /// K, of the plant's order.
    pub controller: StateSpace<Continuous>,
    /// The least level: no controller has a smaller norm, to the tolerance (where `decided`).
    pub gamma: f64,
    /// Whether levels below `gamma` are refused by theory; false where the equations there are too ill-conditioned to be
    /// solved, so that a smaller level may exist.
    pub decided: bool,
    /// The level that the controller was made for, a little above.
    pub level: f64,
    /// The closed loop's own norm, recomputed from plant and controller.
    pub achieved: f64,
    /// Levels that were looked at.
    pub levels: usize,
}

/// The controller whose ‖T_zw‖∞ is as small as can be, to a tolerance.
///
/// At a level γ there is one exactly where the two Riccati equations of Glover and Doyle have stabilising solutions
/// X ≥ 0 and Y ≥ 0 with ρ(XY) < γ²; γ is bisected, the central controller is taken just above the least level and its
/// closed loop measured: what its own norm does not confirm is not returned.
///
/// D₁₁ and D₂₂ may be any; D₁₂ and D₂₁ are brought to [0; I] and [0 I] by orthogonal matrices and scalings.
///
/// # Errors
/// Every assumption that the plant breaks (see [`broken_assumptions`]); no level up to 1e12 of the first one; a closed
/// loop that contradicts its level.
///
/// Source: Glover and Doyle, Syst. Control Lett. 11 (1988) 167–172; Zhou, Doyle, Glover, *Robust and Optimal Control*,
/// theorem 17.1.
pub fn hinf(plant: &GeneralizedPlant, settings: &HinfSettings) -> Result<HinfDesign, SynthesisError> {
    let broken = broken_assumptions(plant)?;
    if !broken.is_empty() {
        return Err(SynthesisError::Assumptions(broken));
    }
    let normal = Normal::of(plant)?;
    let mut levels = 0;
    let mut feasible = |gamma: f64| {
        levels += 1;
        normal.solve(gamma)
    };
    let mut high = settings.first_level.max(f64::MIN_POSITIVE);
    let (mut low, mut why) = (0.0, String::new());
    let mut at = None;
    for _ in 0..MOST_LEVELS {
        match feasible(high) {
            Ok(solved) => {
                at = Some(solved);
                break;
            }
            Err(e) => {
                why = e.why;
                low = high;
                high *= 4.0;
            }
        }
        if high > 1e12 * settings.first_level {
            break;
        }
    }
    let Some(mut at) = at else { return Err(SynthesisError::NoLevel { level: low, why }) };
    let mut decided = true;
    for _ in 0..MOST_HOLES {
        let refused = bisect(&mut at, low, settings, &mut feasible);
        decided = refused.is_none_or(|r| r.by_theory) || at_its_end(&at, &mut feasible);
        if decided {
            break;
        }
        // no boundary is near, so the equations failed by rounding: is a level below the hole feasible?
        let Some(below) = BELOW.iter().find_map(|share| feasible(at.gamma * share).ok()) else { break };
        (at, low) = (below, 0.0);
    }
    let gamma = at.gamma;
    let mut last = SynthesisError::NoLevel { level: gamma, why: "no controller near it is confirmed".into() };
    for more in BACK_OFF {
        let level = gamma * (1.0 + more);
        levels += 1;
        let Ok(solved) = normal.solve(level) else { continue };
        let Ok(controller) = normal.controller(&solved) else { continue };
        let measured = plant.close(&controller).and_then(|closed| closed.hinf_norm());
        match measured {
            Ok(norm) if norm.norm <= level * (1.0 + settings.tolerance.max(1e-6)) => {
                return Ok(HinfDesign { controller, gamma, decided, level, achieved: norm.norm, levels });
            }
            Ok(norm) => {
                last = SynthesisError::Refused { what: "the H∞ norm", claimed: level, found: norm.norm };
            }
            Err(e) => last = e.into(),
        }
    }
    Err(last)
}

/// Lowers `at` to the least feasible level above `low`; why the level just below is not.
fn bisect(
    at: &mut Solved,
    mut low: f64,
    settings: &HinfSettings,
    feasible: &mut impl FnMut(f64) -> Result<Solved, Refused>,
) -> Option<Refused> {
    let mut refused = None;
    for _ in 0..MOST_LEVELS {
        let high = at.gamma;
        if high - low <= settings.tolerance * high || high < 1e-12 * settings.first_level {
            break;
        }
        // levels are scale-free: the geometric mean, once there is a lower one
        let middle = if low > 0.0 { (low * high).sqrt() } else { high / 16.0 };
        match feasible(middle) {
            Ok(solved) => *at = solved,
            Err(e) => {
                refused = Some(e);
                low = middle;
            }
        }
    }
    refused
}

/// Whether the equations themselves end at this level: a closed loop's pole reaches the axis, or a solution grows without
/// bound, against a level a little higher.
fn at_its_end(at: &Solved, feasible: &mut impl FnMut(f64) -> Result<Solved, Refused>) -> bool {
    let Ok(above) = feasible(at.gamma * AWAY) else { return false };
    (0..2).any(|k| at.margins[k] < VANISHES * above.margins[k] || at.sizes[k] * VANISHES > above.sizes[k])
}
