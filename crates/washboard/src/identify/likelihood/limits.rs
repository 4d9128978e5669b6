//! Within what the road's values and the noise are searched, and how far a step may go.

use super::LEAST_NOISE;

/// While noise is raised, e stays within this of 2 and ln μ within that of its start.
const HELD_EXPONENT: f64 = 0.2;
const HELD_LN_MU: f64 = 0.25;
/// e is refused outside.
const EXPONENTS: [f64; 2] = [0.3, 4.0];
/// ln μ is refused outside.
const LN_MU: [f64; 2] = [-4.6, 4.6];
/// ln S₀ from its start.
const LN_S0: f64 = 8.0;
/// ln of the delay's factor: the speed is not 20 % off.
pub(crate) const LN_DELAY: [f64; 2] = [-0.2, 0.2];
/// Converged: a step gains less than this, and the Newton decrement is below that (a fifth of a standard deviation).
pub(crate) const GAIN: f64 = 1e-3;
pub(crate) const DECREMENT: f64 = 0.05;
/// Longest steps: of e and ln μ, of ln S₀ and other logarithms, of ln noise.
pub(crate) const STEP_ROAD: f64 = 0.4;
pub(crate) const STEP_LEVEL: f64 = 0.7;
pub(crate) const STEP_NOISE: f64 = 1.5;

/// Of ln S₀.
pub(crate) fn ln_s0(start: f64) -> [f64; 2] {
    [start - LN_S0, start + LN_S0]
}

/// Of e, `held` while noise is raised.
pub(crate) fn exponent(held: bool) -> [f64; 2] {
    if held { [2.0 - HELD_EXPONENT, 2.0 + HELD_EXPONENT] } else { EXPONENTS }
}

/// Of ln μ, `held` while noise is raised.
pub(crate) fn ln_mu(start: f64, held: bool) -> [f64; 2] {
    if held { [start - HELD_LN_MU, start + HELD_LN_MU] } else { LN_MU }
}

/// Of ln noise, in units of a channel's mean density.
pub(crate) fn ln_noise() -> [f64; 2] {
    [LEAST_NOISE.ln(), 1e6f64.ln()]
}
