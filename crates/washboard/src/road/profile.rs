//! Random profiles of a road: heights over distance whose spectrum and coherence are the road's.

use super::{Road, RoadError};
use crate::linalg::C64;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use realfft::RealFftPlanner;
use std::f64::consts::{FRAC_1_SQRT_2, TAU};

/// Points of a profile, at most.
const MOST_POINTS: usize = 1 << 26;

/// What a random profile is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProfileSettings {
    /// Its length.
    pub length_m: f64,
    /// Distance of its points.
    pub step_m: f64,
    /// How far apart two tracks are; one track without it.
    pub apart_m: Option<f64>,
    /// The speed at which a road over time is driven; any, of a road over distance.
    pub speed_m_s: f64,
    /// Same seed, same profile.
    pub seed: u64,
}

/// Heights of one track or two at 0, step, 2 step …, m: a Gaussian field of the road's spectrum and coherence.
///
/// h(x) = 2 Re Σ_k √(S(ω_k)Δω/2π) ζ_k e^{iω_k x/v} with complex normal ζ_k, E|ζ|² = 1; the second track has
/// γζ_k + √(1 − γ²)ζ′_k. The period is twice the length or more, so that ends do not meet: longer waves than that, and
/// shorter ones than two steps, are absent. Two profiles of one seed that differ in their tracks share the first.
///
/// # Errors
/// A length, step, distance or speed that is not positive; more than 2²⁶ points; a length of less than eight steps.
pub fn random_profile(road: &Road, settings: &ProfileSettings) -> Result<Vec<Vec<f64>>, RoadError> {
    let ProfileSettings { length_m, step_m, apart_m, speed_m_s, seed } = *settings;
    for (field, value) in [
        ("length_m", length_m),
        ("step_m", step_m),
        ("track_width_m", apart_m.unwrap_or(1.0)),
        ("speed_m_s", speed_m_s),
    ] {
        super::spectrum::positive(field, value)?;
    }
    let steps = (length_m / step_m + 1e-9).floor();
    if !(8.0..MOST_POINTS as f64).contains(&steps) {
        let expected = "8 to 2^26 steps on the length";
        return Err(RoadError::Field { field: "step_m", expected, found: format!("{steps}") });
    }
    let points = steps as usize + 1;
    let period = (2 * points).next_power_of_two();
    let omega_step = TAU * speed_m_s / (period as f64 * step_m);
    let [low, high] = road.spectrum().band_rad_s(speed_m_s);
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let zero = C64::new(0.0, 0.0);
    let count = period / 2 + 1;
    let mut spectra = vec![vec![zero; count]; if apart_m.is_some() { 2 } else { 1 }];
    // the second track's throws come from a stream of their own
    let mut other = ChaCha8Rng::seed_from_u64(seed);
    other.set_stream(1);
    let throw = |rng: &mut ChaCha8Rng| {
        let mut one = || -> f64 { StandardNormal.sample(rng) };
        C64::new(one(), one()) * FRAC_1_SQRT_2
    };
    for k in 1..count - 1 {
        let omega = omega_step * k as f64;
        let (z, more) = (throw(&mut rng), throw(&mut other));
        if omega < low || omega > high {
            continue;
        }
        let size = (road.spectrum().psd(omega, speed_m_s) * omega_step / TAU).sqrt();
        spectra[0][k] = z * size;
        if let Some(apart) = apart_m {
            let gamma = road.coherence().gamma(apart, omega, speed_m_s);
            spectra[1][k] = (z * gamma + more * (1.0 - gamma * gamma).max(0.0).sqrt()) * size;
        }
    }
    let inverse = RealFftPlanner::<f64>::new().plan_fft_inverse(period);
    Ok(spectra
        .into_iter()
        .map(|mut spectrum| {
            let mut heights = inverse.make_output_vec();
            // lengths are the plan's own and the ends are real, so it cannot refuse
            let _ = inverse.process(&mut spectrum, &mut heights);
            heights.truncate(points);
            heights
        })
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::road::{Coherence, Spectrum};
    use crate::units::Convention;

    fn settings(seed: u64) -> ProfileSettings {
        ProfileSettings { length_m: 4000.0, step_m: 0.1, apart_m: Some(1.5), speed_m_s: 1.0, seed }
    }

    fn road(coherence: Coherence) -> Road {
        let band = [0.3, 12.0];
        let law = Spectrum::power_law(16e-6, 1.0, 2.0, band, Convention::OneSidedRadPerM).unwrap();
        Road::new(law, coherence)
    }

    fn product(a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>() / a.len() as f64
    }

    /// ∫ G dν over the band is the variance, whatever speed the road is looked at with.
    #[test]
    fn the_variance_is_the_roads() {
        let expected = 16e-6 * (1.0 / 0.3 - 1.0 / 12.0);
        for speed_m_s in [1.0, 20.0] {
            let variances: Vec<f64> = (0..12)
                .map(|seed| {
                    let one = ProfileSettings { speed_m_s, ..settings(seed) };
                    let tracks = random_profile(&road(Coherence::Full), &one).unwrap();
                    assert_eq!(tracks[0], tracks[1]);
                    product(&tracks[0], &tracks[0])
                })
                .collect();
            let mean = variances.iter().sum::<f64>() / 12.0;
            // 12 × 4 km of waves of some 20 m: about 2 % of scatter
            assert!((mean / expected - 1.0).abs() < 0.06, "{}", mean / expected);
        }
    }

    #[test]
    fn tracks_are_as_alike_as_their_coherence() {
        let correlation = |coherence| {
            let tracks = random_profile(&road(coherence), &settings(3)).unwrap();
            assert_eq!(tracks[0].len(), 40_001);
            product(&tracks[0], &tracks[1])
                / (product(&tracks[0], &tracks[0]) * product(&tracks[1], &tracks[1])).sqrt()
        };
        assert!(correlation(Coherence::None).abs() < 0.1 && correlation(Coherence::Independent).abs() < 0.1);
        // ∫ ν⁻² e^{−μWν/2π} over ∫ ν⁻² from .3 to 12, by hand: 0.655 at μ = 3.8, W = 1.5
        let (a, mut top, mut bottom) = (3.8 * 1.5 / TAU, 0.0, 0.0);
        for k in 0..20_000 {
            let nu = 0.3 + (12.0 - 0.3) * (f64::from(k) + 0.5) / 20_000.0;
            top += (-a * nu).exp() / (nu * nu);
            bottom += 1.0 / (nu * nu);
        }
        let found = correlation(Coherence::bogsjo(3.8).unwrap());
        assert!((found - top / bottom).abs() < 0.03, "{found} {}", top / bottom);
    }

    #[test]
    fn a_seed_is_a_profile_and_one_track_is_the_first_of_two() {
        let road = road(Coherence::None);
        let two = random_profile(&road, &settings(7)).unwrap();
        let one = random_profile(&road, &ProfileSettings { apart_m: None, ..settings(7) }).unwrap();
        assert_eq!(one, two[..1]);
        assert_ne!(one, random_profile(&road, &settings(8)).unwrap()[..1]);
        for (wrong, field) in [
            (ProfileSettings { step_m: 0.0, ..settings(0) }, "step_m"),
            (ProfileSettings { length_m: f64::NAN, ..settings(0) }, "length_m"),
            (ProfileSettings { length_m: 0.5, ..settings(0) }, "step_m: expected 8"),
            (ProfileSettings { length_m: 1e9, ..settings(0) }, "step_m: expected 8"),
            (ProfileSettings { apart_m: Some(-1.0), ..settings(0) }, "track_width_m"),
        ] {
            assert!(random_profile(&road, &wrong).unwrap_err().to_string().starts_with(field));
        }
    }
}
