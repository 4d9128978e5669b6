//! The road under the wheels of a moving vehicle: delay from the longitudinal distance, coherence from the lateral one.

use super::{Coherence, Road};
use crate::linalg::{C64, CMat};

/// Wheels whose tracks are less than this apart (m) run on one track where left and right are unrelated: half a tyre's
/// width. (Front and rear track widths of a car differ by centimetres.)
pub const SAME_TRACK_M: f64 = 0.1;

/// The spectrum matrix of road height under wheels at `[x, y]` (x forward, y left), S_r(ω):
///
/// (S_r)ᵢⱼ = S(ω) Γ(|yᵢ − yⱼ|, ω) e^{−iω(xᵢ − xⱼ)/V}
///
/// with S_ij = E\[dᵢ* dⱼ\]: a wheel behind repeats the input later. `averaged_delays` drops the entries with a delay: the
/// value that an integral over many periods of e^{iωτ} sees.
///
/// Source: De Filippis et al., eq. (9).
#[must_use]
pub fn wheel_spectrum(road: &Road, at_m: &[[f64; 2]], omega_rad_s: f64, speed_m_s: f64) -> CMat {
    let s = road.spectrum().psd(omega_rad_s, speed_m_s);
    relation(road.coherence(), at_m, omega_rad_s, speed_m_s, |tau| {
        C64::new(s, 0.0) * C64::new(0.0, -omega_rad_s * tau).exp()
    })
}

/// [`wheel_spectrum`] with delayed pairs left out.
pub(crate) fn wheel_spectrum_without_delayed(
    road: &Road,
    at_m: &[[f64; 2]],
    omega_rad_s: f64,
    speed_m_s: f64,
) -> CMat {
    let s = road.spectrum().psd(omega_rad_s, speed_m_s);
    relation(road.coherence(), at_m, omega_rad_s, speed_m_s, |tau| {
        C64::new(if tau == 0.0 { s } else { 0.0 }, 0.0)
    })
}

fn relation(
    coherence: &Coherence,
    at_m: &[[f64; 2]],
    omega: f64,
    speed: f64,
    of_delay: impl Fn(f64) -> C64,
) -> CMat {
    CMat::from_fn(at_m.len(), at_m.len(), |i, j| {
        let delay = (at_m[i][0] - at_m[j][0]) / speed;
        let mut distance = (at_m[i][1] - at_m[j][1]).abs();
        match coherence {
            Coherence::Independent => return if i == j { of_delay(0.0) } else { C64::new(0.0, 0.0) },
            Coherence::None if distance < SAME_TRACK_M => distance = 0.0,
            _ => {}
        }
        of_delay(delay) * coherence.gamma(distance, omega, speed)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::road::Spectrum;

    /// The rhombic layout of the paper's figure 1 and eq. (9): A, B, C, D with τ_AB = −τ₁, τ_AC = τ₂, τ_AD = 0 …
    #[test]
    fn the_rhombic_layout_of_equation_9() {
        // A and D lie side by side; B ahead on a second track; C behind on the track of B; as eq. (9)'s signs say
        let (l1, l2, v, omega) = (1.2, 0.9, 15.0, 11.0);
        let at = [[0.0, 0.0], [l1, 0.8], [-l2, 0.8], [0.0, 1.9]];
        let road = Road::new(Spectrum::white_velocity(1.0).unwrap(), Coherence::bogsjo(3.0).unwrap());
        let s = wheel_spectrum(&road, &at, omega, v);
        let g = |w: f64| road.coherence().gamma(w, omega, v) / (omega * omega);
        let e = |t: f64| C64::new(0.0, omega * t).exp();
        let (t1, t2) = (l1 / v, l2 / v);
        let near = |a: C64, b: C64| assert!((a - b).norm() < 1e-16, "{a} {b}");
        near(s[(0, 1)], e(t1) * g(0.8)); // Γ₁ e^{+iωτ₁}
        near(s[(0, 2)], e(-t2) * g(0.8)); // Γ₁ e^{−iωτ₂}
        near(s[(0, 3)], C64::new(g(1.9), 0.0)); // Γ₂
        near(s[(1, 2)], e(-(t1 + t2)) * g(0.0)); // e^{−iωτ₃}
        near(s[(1, 3)], e(-t1) * g(1.1)); // Γ₃ e^{−iωτ₁}
        near(s[(2, 3)], e(t2) * g(1.1)); // Γ₃ e^{+iωτ₂}
        for i in 0..4 {
            for j in 0..4 {
                near(s[(i, j)], s[(j, i)].conj());
            }
        }
    }

    #[test]
    fn unrelated_tracks_keep_the_delay_of_each_side_although_track_widths_differ() {
        let at = [[1.0, 0.761], [1.0, -0.761], [-1.8, 0.755], [-1.8, -0.755]];
        let road = Road::new(Spectrum::white_velocity(1.0).unwrap(), Coherence::None);
        let s = wheel_spectrum(&road, &at, 2.0, 20.0);
        assert!((s[(0, 2)].norm() - 0.25).abs() < 1e-15);
        assert_eq!(s[(0, 1)].norm() + s[(0, 3)].norm(), 0.0);
        let independent = wheel_spectrum(&road.with_coherence(Coherence::Independent), &at, 2.0, 20.0);
        assert_eq!(independent[(0, 2)].norm(), 0.0);
        assert_eq!(independent[(2, 2)].re, 0.25);
    }
}
