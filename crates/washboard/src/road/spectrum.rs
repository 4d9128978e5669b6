//! The spectrum of one track.

use super::{RoadError, ShapingFilter};
use crate::units::{Convention, plain};
use serde::{Deserialize, Serialize};

/// The classes of ISO 8608, by the geometric mean of G_d at Ω₀ = 1 rad/m: 1, 4, 16 … 16384 × 10⁻⁶ m³.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum IsoClass {
    /// Very good.
    A,
    /// Good.
    B,
    /// Average.
    C,
    /// Poor.
    D,
    /// Very poor.
    E,
    /// Class F.
    F,
    /// Class G.
    G,
    /// Class H.
    H,
}

impl IsoClass {
    /// All classes, best first.
    pub const ALL: [IsoClass; 8] = [Self::A, Self::B, Self::C, Self::D, Self::E, Self::F, Self::G, Self::H];

    /// The geometric mean of the class: one-sided G_d at 1 rad/m, m³.
    #[must_use]
    pub fn roughness_m3(self) -> f64 {
        1e-6 * 4f64.powi(self as i32)
    }

    /// The class of a one-sided G_d at 1 rad/m: limits lie a factor 2 about the geometric means.
    #[must_use]
    pub fn of(roughness_m3: f64) -> Self {
        Self::ALL.into_iter().find(|c| roughness_m3 < 2.0 * c.roughness_m3()).unwrap_or(Self::H)
    }
}

/// The spectrum of one track's height.
#[derive(Debug, Clone, PartialEq)]
pub enum Spectrum {
    /// G(ν) = S₀ (ν/ν₀)^−e in a band of ν, zero outside: ISO 8608 and De Filippis et al., eq. (59).
    PowerLaw {
        /// S₀ at ν₀, m³ in the convention below.
        roughness_m3: f64,
        /// ν₀, rad/m.
        reference_rad_per_m: f64,
        /// The undulation exponent e.
        exponent: f64,
        /// ν_a < ν_b, rad/m.
        band_rad_per_m: [f64; 2],
        /// What S₀ is a density of.
        convention: Convention,
    },
    /// Two power laws that meet at a corner: Türkay, section 2.3.2.
    SplitPowerLaw {
        /// The density at the corner, in the convention below.
        level: f64,
        /// The corner, rad/m.
        corner_rad_per_m: f64,
        /// Exponent below the corner.
        exponent_below: f64,
        /// Exponent above the corner.
        exponent_above: f64,
        /// Band, rad/m.
        band_rad_per_m: [f64; 2],
        /// What `level` is a density of.
        convention: Convention,
    },
    /// ẇ = −v a w + √v b ξ with unit-intensity ξ: S(ω) = v b²/(ω² + v²a²). Türkay, eq. (7.2).
    FirstOrder {
        /// b.
        gain: f64,
        /// a, rad/m.
        corner_rad_per_m: f64,
    },
    /// White velocity: S(ω) = W/ω² with W = (2πn₀)²κ v, or W given at the speed driven.
    WhiteVelocity {
        /// W (m²/s) is `intensity` × speed^`speed_power`: 0 where W itself was given, 1 for a road's own property.
        intensity: f64,
        /// 0 or 1.
        speed_power: i32,
    },
    /// Points of ν (rad/m, ascending) and density, joined by straight lines in logarithms; zero outside.
    Table {
        /// ν, rad/m.
        nu_rad_per_m: Vec<f64>,
        /// Densities > 0 in the convention below.
        density: Vec<f64>,
        /// What the densities are.
        convention: Convention,
    },
    /// The output of a rational filter driven by unit-intensity white noise.
    Filter(ShapingFilter),
}

impl Spectrum {
    /// A power law in a band.
    ///
    /// # Errors
    /// A roughness, reference or band that is not positive; a band that is not ascending; an exponent outside [0, 8].
    pub fn power_law(
        roughness_m3: f64,
        reference_rad_per_m: f64,
        exponent: f64,
        band_rad_per_m: [f64; 2],
        convention: Convention,
    ) -> Result<Self, RoadError> {
        roughness(roughness_m3)?;
        positive("reference_rad_per_m", reference_rad_per_m)?;
        check_exponent("exponent", exponent)?;
        check_band(band_rad_per_m)?;
        Ok(Spectrum::PowerLaw { roughness_m3, reference_rad_per_m, exponent, band_rad_per_m, convention })
    }

    /// Two power laws that meet at a corner.
    ///
    /// # Errors
    /// A level, corner or band that is not positive; exponents outside [0, 8].
    pub fn split_power_law(
        level: f64,
        corner_rad_per_m: f64,
        exponents: [f64; 2],
        band_rad_per_m: [f64; 2],
        convention: Convention,
    ) -> Result<Self, RoadError> {
        positive("level", level)?;
        positive("corner_cycles_per_m", corner_rad_per_m)?;
        check_exponent("exponent_below", exponents[0])?;
        check_exponent("exponent_above", exponents[1])?;
        check_band(band_rad_per_m)?;
        let [exponent_below, exponent_above] = exponents;
        Ok(Spectrum::SplitPowerLaw {
            level,
            corner_rad_per_m,
            exponent_below,
            exponent_above,
            band_rad_per_m,
            convention,
        })
    }

    /// A first-order shaping filter b/(s + a) over distance.
    ///
    /// # Errors
    /// A gain or corner that is not positive.
    pub fn first_order(gain: f64, corner_rad_per_m: f64) -> Result<Self, RoadError> {
        positive("gain", gain)?;
        positive("corner_rad_per_m", corner_rad_per_m)?;
        Ok(Spectrum::FirstOrder { gain, corner_rad_per_m })
    }

    /// White velocity of intensity W (m²/s), whatever the speed.
    ///
    /// # Errors
    /// An intensity that is not positive.
    pub fn white_velocity(intensity_m2_per_s: f64) -> Result<Self, RoadError> {
        positive("intensity_m2_per_s", intensity_m2_per_s)?;
        Ok(Spectrum::WhiteVelocity { intensity: intensity_m2_per_s, speed_power: 0 })
    }

    /// White velocity of a road: W = (2πn₀)²κ v.
    ///
    /// # Errors
    /// An n₀ or κ that is not positive.
    pub fn white_velocity_road(roughness_m3: f64, reference_cycles_per_m: f64) -> Result<Self, RoadError> {
        roughness(roughness_m3)?;
        positive("reference_cycles_per_m", reference_cycles_per_m)?;
        let nu0 = crate::units::rad_per_s(reference_cycles_per_m);
        Ok(Spectrum::WhiteVelocity { intensity: nu0 * nu0 * roughness_m3, speed_power: 1 })
    }

    /// A tabulated spectrum.
    ///
    /// # Errors
    /// Fewer than two points, unequal lengths, frequencies that are not positive and ascending, densities not positive.
    pub fn table(
        nu_rad_per_m: Vec<f64>,
        density: Vec<f64>,
        convention: Convention,
    ) -> Result<Self, RoadError> {
        if nu_rad_per_m.len() < 2 || nu_rad_per_m.len() != density.len() {
            return Err(RoadError::Field {
                field: "data",
                expected: "at least two points, as many densities as frequencies",
                found: format!("{} frequencies and {} densities", nu_rad_per_m.len(), density.len()),
            });
        }
        for pair in nu_rad_per_m.windows(2) {
            if !(pair[0] > 0.0 && pair[1] > pair[0] && pair[1].is_finite()) {
                let found = format!("{} before {}", pair[0], pair[1]);
                return Err(RoadError::Field {
                    field: "data",
                    expected: "positive ascending frequencies",
                    found,
                });
            }
        }
        for d in &density {
            positive("data", *d)?;
        }
        Ok(Spectrum::Table { nu_rad_per_m, density, convention })
    }

    /// Two-sided S(ω) of height in m²·s/rad, with R(τ) = (1/2π)∫S e^{iωτ}dω, at a speed. Even in ω.
    #[must_use]
    pub fn psd(&self, omega_rad_s: f64, speed_m_s: f64) -> f64 {
        let omega = omega_rad_s.abs();
        let nu = omega / speed_m_s;
        match self {
            Spectrum::PowerLaw {
                roughness_m3,
                reference_rad_per_m,
                exponent,
                band_rad_per_m,
                convention,
            } => {
                if !inside(nu, band_rad_per_m) {
                    return 0.0;
                }
                let density = roughness_m3 * (nu / reference_rad_per_m).powf(-exponent);
                convention.two_sided_time(density, speed_m_s)
            }
            Spectrum::SplitPowerLaw {
                level,
                corner_rad_per_m,
                exponent_below,
                exponent_above,
                band_rad_per_m,
                convention,
            } => {
                if !inside(nu, band_rad_per_m) {
                    return 0.0;
                }
                let e = if nu < *corner_rad_per_m { exponent_below } else { exponent_above };
                convention.two_sided_time(level * (nu / corner_rad_per_m).powf(-e), speed_m_s)
            }
            Spectrum::FirstOrder { gain, corner_rad_per_m } => {
                let a = speed_m_s * corner_rad_per_m;
                speed_m_s * gain * gain / (omega * omega + a * a)
            }
            Spectrum::WhiteVelocity { .. } => {
                self.white_intensity(speed_m_s).unwrap_or(0.0) / (omega * omega)
            }
            Spectrum::Table { nu_rad_per_m, density, convention } => {
                convention.two_sided_time(interpolate(nu_rad_per_m, density, nu), speed_m_s)
            }
            Spectrum::Filter(filter) => filter.height_psd(omega, speed_m_s),
        }
    }

    /// W in m²/s where the velocity of the road is white.
    #[must_use]
    pub fn white_intensity(&self, speed_m_s: f64) -> Option<f64> {
        match self {
            Spectrum::WhiteVelocity { intensity, speed_power } => {
                Some(intensity * speed_m_s.powi(*speed_power))
            }
            _ => None,
        }
    }

    /// The band of ω outside which the spectrum is zero; unbounded ones have (0, ∞).
    #[must_use]
    pub fn band_rad_s(&self, speed_m_s: f64) -> [f64; 2] {
        match self {
            Spectrum::PowerLaw { band_rad_per_m: [a, b], .. }
            | Spectrum::SplitPowerLaw { band_rad_per_m: [a, b], .. } => [a * speed_m_s, b * speed_m_s],
            Spectrum::Table { nu_rad_per_m, .. } => {
                [nu_rad_per_m[0] * speed_m_s, nu_rad_per_m[nu_rad_per_m.len() - 1] * speed_m_s]
            }
            Spectrum::FirstOrder { .. } | Spectrum::WhiteVelocity { .. } | Spectrum::Filter(_) => {
                [0.0, f64::INFINITY]
            }
        }
    }

    /// Whether it is written over time, for one speed: a filter over time, a white velocity of given intensity.
    #[must_use]
    pub fn is_over_time(&self) -> bool {
        match self {
            Spectrum::WhiteVelocity { speed_power, .. } => *speed_power == 0,
            Spectrum::Filter(filter) => !filter.is_over_distance(),
            _ => false,
        }
    }

    /// The rational shaping filter over time, driven by unit-intensity white noise, where the spectrum has one.
    #[must_use]
    pub fn shaping_filter(&self, speed_m_s: f64) -> Option<ShapingFilter> {
        match self {
            Spectrum::FirstOrder { gain, corner_rad_per_m } => {
                Some(ShapingFilter::first_order(speed_m_s * corner_rad_per_m, speed_m_s.sqrt() * gain))
            }
            Spectrum::WhiteVelocity { .. } => {
                self.white_intensity(speed_m_s).map(ShapingFilter::white_velocity)
            }
            Spectrum::Filter(filter) => Some(filter.over_time(speed_m_s).as_height()),
            _ => None,
        }
    }

    /// Frequencies in rad/s at which the spectrum bends, for quadrature.
    pub(crate) fn corners_rad_s(&self, speed_m_s: f64) -> Vec<f64> {
        match self {
            Spectrum::SplitPowerLaw { corner_rad_per_m, .. }
            | Spectrum::FirstOrder { corner_rad_per_m, .. } => {
                vec![corner_rad_per_m * speed_m_s]
            }
            Spectrum::Table { nu_rad_per_m, .. } => nu_rad_per_m.iter().map(|nu| nu * speed_m_s).collect(),
            Spectrum::Filter(f) => f.over_time(speed_m_s).corner_frequencies(),
            _ => Vec::new(),
        }
    }
}

fn inside(nu: f64, band: &[f64; 2]) -> bool {
    // the edges belong to the band, whatever rounding ω/V brings
    nu >= band[0] * (1.0 - 1e-12) && nu <= band[1] * (1.0 + 1e-12)
}

/// Straight lines in logarithms; zero outside.
fn interpolate(x: &[f64], y: &[f64], at: f64) -> f64 {
    if !inside(at, &[x[0], x[x.len() - 1]]) {
        return 0.0;
    }
    let i = x.partition_point(|v| *v <= at).clamp(1, x.len() - 1);
    let t = (at / x[i - 1]).ln() / (x[i] / x[i - 1]).ln();
    (y[i - 1].ln() * (1.0 - t) + y[i].ln() * t).exp()
}

/// Smoother than 1e-15 m³ is no road, and rougher than 1e3 m³ none either: their squares and products leave the doubles.
fn roughness(value: f64) -> Result<(), RoadError> {
    if (1e-15..=1e3).contains(&value) {
        return Ok(());
    }
    let expected = "a positive number, 1e-15 to 1e3 m^3 (class A to H: 1e-6 to 0.016)";
    Err(RoadError::Field { field: "roughness_m3", expected, found: plain(value) })
}

pub(super) fn positive(field: &'static str, value: f64) -> Result<(), RoadError> {
    // squares and products of roads beyond these leave the doubles
    if (1e-60..=1e60).contains(&value) {
        Ok(())
    } else if value.is_finite() && value > 0.0 {
        Err(RoadError::Field { field, expected: "a positive number, 1e-60 to 1e60", found: plain(value) })
    } else {
        Err(RoadError::Field { field, expected: "a positive number", found: value.to_string() })
    }
}

fn check_exponent(field: &'static str, value: f64) -> Result<(), RoadError> {
    if (0.0..=8.0).contains(&value) {
        Ok(())
    } else {
        Err(RoadError::Field { field, expected: "an exponent from 0 to 8", found: value.to_string() })
    }
}

fn check_band(band: [f64; 2]) -> Result<(), RoadError> {
    if band[0] > 0.0 && band[1] > band[0] && band[1].is_finite() {
        Ok(())
    } else {
        Err(RoadError::Field {
            field: "band_rad_per_m",
            expected: "two positive ascending spatial frequencies in rad/m",
            found: format!("{band:?}"),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn iso_classes_are_a_factor_four_apart_and_found_again() {
        assert_eq!(IsoClass::C.roughness_m3(), 16e-6);
        assert_eq!(IsoClass::H.roughness_m3(), 16384e-6);
        for class in IsoClass::ALL {
            assert_eq!(IsoClass::of(class.roughness_m3()), class);
            assert_eq!(IsoClass::of(1.99 * class.roughness_m3()), class);
        }
        assert_eq!(IsoClass::of(1.0), IsoClass::H);
    }

    #[test]
    fn the_paper_convention_is_pi_below_the_physical_one() {
        let road = |c| Spectrum::power_law(16e-6, 1.0, 2.0, [0.063, 17.77], c).unwrap();
        let (omega, v) = (6.0, 20.0);
        let physical = road(Convention::OneSidedRadPerM).psd(omega, v);
        let paper = road(Convention::Paper).psd(omega, v);
        assert!((physical / paper - PI).abs() < 1e-14);
        // Eq. (60) as printed
        assert!((paper - 16e-6 / v * (omega / v).powi(-2)).abs() < 1e-20);
    }

    #[test]
    fn thesis_road_has_its_intensity() {
        let road = Spectrum::white_velocity_road(0.76e-5, 0.15708).unwrap();
        assert!((road.white_intensity(20.0).unwrap() - 1.480625e-4).abs() < 5e-11);
    }

    #[test]
    fn a_table_of_a_power_law_is_that_power_law() {
        let nu: Vec<f64> = (0..20).map(|i| 0.1 * 1.4f64.powi(i)).collect();
        let density = nu.iter().map(|v| 3e-6 * v.powf(-2.3)).collect();
        let table = Spectrum::table(nu, density, Convention::TwoSidedCyclesPerM).unwrap();
        let law = Spectrum::power_law(3e-6, 1.0, 2.3, [0.1, 50.0], Convention::TwoSidedCyclesPerM).unwrap();
        for omega in [3.0, 7.7, 100.0] {
            assert!((table.psd(omega, 10.0) / law.psd(omega, 10.0) - 1.0).abs() < 1e-12);
        }
        assert_eq!(table.psd(0.9, 10.0), 0.0);
    }
}
