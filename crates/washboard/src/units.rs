//! The conversions that confuse people, once: rad/s and Hz, rad/m and cycles/m, one- and two-sided densities.
//!
//! Inside washboard a power spectral density of time is **two-sided over ω** with
//!
//! R(τ) = (1/2π) ∫ S(ω) e^{iωτ} dω,  so that  var = (1/π) ∫₀^∞ S(ω) dω.
//!
//! A road's roughness is written by people as a density over a spatial frequency; which one is a [`Convention`].

use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};

/// A number as people write it: with an exponent only where it would be zeros otherwise.
#[must_use]
pub fn plain(value: f64) -> String {
    if value == 0.0 || !value.is_finite() || (1e-6..1e7).contains(&value.abs()) {
        (value + 0.0).to_string()
    } else {
        format!("{value:e}")
    }
}

/// So many decimals and the sign, which nothing has that is 0 when it is rounded.
///
/// ```
/// use washboard::units::signed;
/// assert_eq!([signed(12.34, 1), signed(-0.26, 1), signed(-0.04, 1), signed(0.001, 2)], ["+12.3", "-0.3", "0.0", "0.00"]);
/// ```
#[must_use]
pub fn signed(value: f64, decimals: usize) -> String {
    let text = format!("{value:+.decimals$}");
    match text.get(1..) {
        Some(size) if size.chars().all(|c| matches!(c, '0' | '.')) => size.to_owned(),
        _ => text,
    }
}

/// ω in rad/s of a frequency in Hz.
#[must_use]
pub fn rad_per_s(freq_hz: f64) -> f64 {
    TAU * freq_hz
}

/// Frequency in Hz of an ω in rad/s.
#[must_use]
pub fn hz(omega_rad_s: f64) -> f64 {
    omega_rad_s / TAU
}

/// Two-sided S(ω) in unit²·s/rad of a one-sided density per Hz, G(f): var = ∫₀^∞ G df = (1/π) ∫₀^∞ S dω, so S = G/2.
#[must_use]
pub fn two_sided_from_per_hz(one_sided_per_hz: f64) -> f64 {
    one_sided_per_hz / 2.0
}

/// One-sided density per Hz of a two-sided S(ω): the inverse of [`two_sided_from_per_hz`].
#[must_use]
pub fn per_hz_from_two_sided(s: f64) -> f64 {
    2.0 * s
}

/// How a spatial density of road height is written.
///
/// `value` below is the density at the spatial angular frequency ν (rad/m), or at n = ν/2π (cycles/m); V is the speed.
/// [`Convention::two_sided_time`] gives S(ω = νV) in m²·s/rad:
///
/// | convention | var of height | S(ω) |
/// |---|---|---|
/// | `one-sided-rad-per-m` | ∫₀^∞ G dν | π G/V |
/// | `two-sided-rad-per-m` | ∫_{−∞}^{∞} G dν | 2π G/V |
/// | `one-sided-cycles-per-m` | ∫₀^∞ G dn | G/(2V) |
/// | `two-sided-cycles-per-m` | ∫_{−∞}^{∞} G dn | G/V |
/// | `paper` | (1/π) ∫₀^∞ G dν | G/V |
///
/// `paper` is Eq. (60) of De Filippis et al., which takes a one-sided density for S(ω) itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Convention {
    /// One-sided, per rad/m: ISO 8608's G_d(Ω), and washboard's default.
    #[default]
    OneSidedRadPerM,
    /// Two-sided, per rad/m.
    TwoSidedRadPerM,
    /// One-sided, per cycle/m: ISO 8608's G_d(n).
    OneSidedCyclesPerM,
    /// Two-sided, per cycle/m.
    TwoSidedCyclesPerM,
    /// De Filippis et al., Eq. (60) as printed.
    Paper,
}

impl Convention {
    /// S(ω) in m²·s/rad of a density written in this convention, at speed V: the one place where 2 and π enter.
    #[must_use]
    pub fn two_sided_time(self, density: f64, speed_m_s: f64) -> f64 {
        density * self.factor() / speed_m_s
    }

    /// The density in this convention of an S(ω): the inverse of [`Convention::two_sided_time`].
    #[must_use]
    pub fn density(self, s: f64, speed_m_s: f64) -> f64 {
        s * speed_m_s / self.factor()
    }

    fn factor(self) -> f64 {
        match self {
            Convention::OneSidedRadPerM => PI,
            Convention::TwoSidedRadPerM => TAU,
            Convention::OneSidedCyclesPerM => 0.5,
            Convention::TwoSidedCyclesPerM | Convention::Paper => 1.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_without_exponents_where_people_do() {
        let cases =
            [(0.0, "0"), (-0.0, "0"), (-1.0, "-1"), (0.05, "0.05"), (1e-8, "1e-8"), (-2.5e9, "-2.5e9")];
        for (value, text) in cases.into_iter().chain([(f64::INFINITY, "inf"), (123_456.5, "123456.5")]) {
            assert_eq!(plain(value), text);
        }
    }

    /// Variance of a band [a, b] in rad/m of G = 1/ν², from each convention's own definition of variance.
    #[test]
    fn every_convention_keeps_the_variance_by_its_own_definition() {
        let (a, b, v): (f64, f64, f64) = (0.1, 20.0, 17.0);
        let variance = 1.0 / a - 1.0 / b; // ∫ dν/ν²
        // the same height variance, written per convention
        let cases = [
            (Convention::OneSidedRadPerM, 1.0),
            (Convention::TwoSidedRadPerM, 0.5),
            (Convention::OneSidedCyclesPerM, TAU),
            (Convention::TwoSidedCyclesPerM, PI),
            (Convention::Paper, PI),
        ];
        for (convention, scale) in cases {
            // (1/π) ∫ S dω by Simpson's rule in ln ω
            let n = 4000;
            let (la, lb) = ((a * v).ln(), (b * v).ln());
            let h = (lb - la) / f64::from(n);
            let mut sum = 0.0;
            for i in 0..=n {
                let omega = (la + h * f64::from(i)).exp();
                let nu = omega / v;
                let s = convention.two_sided_time(scale / (nu * nu), v);
                let w = if i == 0 || i == n {
                    1.0
                } else if i % 2 == 1 {
                    4.0
                } else {
                    2.0
                };
                sum += w * s * omega;
            }
            let got = sum * h / 3.0 / PI;
            assert!((got / variance - 1.0).abs() < 1e-9, "{convention:?}: {got} against {variance}");
        }
    }
}
