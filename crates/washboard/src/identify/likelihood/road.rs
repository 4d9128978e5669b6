//! The road under a vehicle's wheels and its derivatives, as the fits see it.

use crate::linalg::C64;
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

/// The spectrum matrix under the wheels,
/// S_ij = S_d exp(−μ|y_i − y_j|ω/2πV) e^{−iω(x_i − x_j)/V}: the rear follows the front.
pub(crate) struct Road<'a> {
    drive: Drive,
    values: RoadValues,
    /// The delay's factor, and S₀.
    factors: [f64; 2],
    at_m: &'a [[f64; 2]],
}

impl<'a> Road<'a> {
    pub fn new(drive: Drive, values: RoadValues, at_m: &'a [[f64; 2]]) -> Self {
        Road { drive, values, factors: [values.ln_delay.exp(), values.ln_s0.exp()], at_m }
    }

    /// S at one ω > 0, row after row.
    pub fn fill(&self, omega: f64, s: &mut [C64]) {
        let v = self.drive.speed_m_s;
        let density = self.factors[1] * (omega / v).powf(-self.values.exponent);
        let level = self.drive.convention.two_sided_time(density, v);
        let w = self.at_m.len();
        for i in 0..w {
            s[i * w + i] = C64::new(level, 0.0);
            for j in i + 1..w {
                let [decay, turn] = self.exponents(omega, i, j);
                let (sin, cos) = if turn == 0.0 { (0.0, 1.0) } else { turn.sin_cos() };
                let value = C64::new(cos, -sin) * (level * (-decay).exp());
                (s[i * w + j], s[j * w + i]) = (value, value.conj());
            }
        }
    }

    /// tr(T S), and its derivatives by e, ln μ and the logarithm of the delay's factor; by ln S₀ it is itself.
    ///
    /// S_ij moves by −ln(ω/V), by minus its decay, and by −i its turn, times itself.
    pub fn slopes(&self, omega: f64, s: &[C64], t: &[C64]) -> [f64; 4] {
        let w = self.at_m.len();
        let (mut level, mut by_mu, mut by_delay) = (0.0, 0.0, 0.0);
        for i in 0..w {
            for j in 0..w {
                let z: C64 = t[j * w + i] * s[i * w + j];
                let [decay, turn] = self.exponents(omega, i, j);
                level += z.re;
                by_mu -= decay * z.re;
                by_delay += turn * z.im;
            }
        }
        [level, -self.ln_nu(omega) * level, by_mu, by_delay]
    }

    /// The derivatives of S by ln μ and by the logarithm of the delay's factor.
    pub fn derivatives(&self, omega: f64, s: &[C64]) -> [Vec<C64>; 2] {
        let w = self.at_m.len();
        let of = |factor: &dyn Fn([f64; 2]) -> C64| {
            (0..w * w).map(|k| s[k] * factor(self.exponents(omega, k / w, k % w))).collect()
        };
        [of(&|[decay, _]| C64::new(-decay, 0.0)), of(&|[_, turn]| C64::new(0.0, -turn))]
    }

    /// ln(ω/V).
    pub fn ln_nu(&self, omega: f64) -> f64 {
        (omega / self.drive.speed_m_s).ln()
    }

    /// Decay and turn of S_ij: the exponent is −decay − i turn.
    fn exponents(&self, omega: f64, i: usize, j: usize) -> [f64; 2] {
        let ([xi, yi], [xj, yj], v) = (self.at_m[i], self.at_m[j], self.drive.speed_m_s);
        let decay = self.values.mu * (yi - yj).abs() * omega / (TAU * v);
        [decay, omega * self.factors[0] * (xi - xj) / v]
    }
}
