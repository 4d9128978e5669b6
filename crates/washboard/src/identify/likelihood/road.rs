//! The road under a vehicle's wheels and its derivatives, as the fits see it.

use crate::linalg::{C64, CMat};
use crate::units::Convention;
use std::f64::consts::TAU;

/// What is known of a drive besides its spectra.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Drive {
    pub speed_m_s: f64,
    pub convention: Convention,
}

/// ln S₀, e, μ and the logarithm of the delay's factor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RoadValues {
    pub ln_s0: f64,
    pub exponent: f64,
    pub mu: f64,
    pub ln_delay: f64,
}

/// The spectrum matrix under the wheels at one ω > 0 and its derivatives by ln μ and the logarithm of the delay's factor;
/// by ln S₀ it is itself, by e it is −ln(ω/V) times itself.
pub(crate) struct RoadAt {
    pub s: CMat,
    pub by_mu: CMat,
    pub by_delay: CMat,
    pub ln_nu: f64,
}

impl RoadAt {
    /// S_ij = S_d exp(−μ|y_i − y_j|ω/2πV) e^{−iω(x_i − x_j)/V}: the rear follows the front.
    pub fn new(drive: Drive, values: &RoadValues, at_m: &[[f64; 2]], omega: f64) -> Self {
        let v = drive.speed_m_s;
        let density = values.ln_s0.exp() * (omega / v).powf(-values.exponent);
        let level = drive.convention.two_sided_time(density, v);
        let factor = values.ln_delay.exp();
        let w = at_m.len();
        let decay = |i: usize, j: usize| values.mu * (at_m[i][1] - at_m[j][1]).abs() * omega / (TAU * v);
        let turn = |i: usize, j: usize| omega * factor * (at_m[i][0] - at_m[j][0]) / v;
        let s = CMat::from_fn(w, w, |i, j| C64::new(0.0, -turn(i, j)).exp() * (level * (-decay(i, j)).exp()));
        let by_mu = CMat::from_fn(w, w, |i, j| s[(i, j)] * -decay(i, j));
        let by_delay = CMat::from_fn(w, w, |i, j| s[(i, j)] * C64::new(0.0, -turn(i, j)));
        RoadAt { s, by_mu, by_delay, ln_nu: (omega / v).ln() }
    }
}
