//! How often and how long a stationary Gaussian signal is beyond a limit: bottoming of a suspension.

use super::MetricsError;
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// What a Gaussian signal of zero mean does at a limit ±s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExceedanceRate {
    /// P(|x| > s) at any instant: the share of time beyond the limit.
    pub probability: f64,
    /// Expected times a second that |x| passes s upwards, on both sides together.
    pub per_s: f64,
}

/// A stationary Gaussian signal of zero mean at ±`limit`.
///
/// P(|x| > s) = erfc(s/(σ√2)); by Rice, ν = (1/2π)(σ̇/σ)e^{−s²/2σ²} upward crossings of s a second, and as many downward ones of −s:
/// (1/π)(σ̇/σ)e^{−s²/2σ²} of both.
///
/// | symbol | unit | |
/// |---|---|---|
/// | σ, `rms` | as the signal | not negative |
/// | σ̇, `rate_rms` | its unit a second | not negative |
/// | s, `limit` | as the signal | positive |
///
/// A signal that stands still (σ = 0) exceeds nothing. Crossings come in clumps where the signal is narrow-banded: ν is their mean
/// number all the same.
///
/// # Errors
/// Numbers that are not so.
///
/// Source: S. O. Rice, Bell System Technical Journal 24 (1945) 46–156, section 3.3.
///
/// ```
/// use washboard::metrics::exceedance;
/// let found = exceedance(0.02, 0.3, 0.06)?;
/// assert!((found.probability - 0.0027).abs() < 1e-5);
/// # Ok::<(), washboard::metrics::MetricsError>(())
/// ```
pub fn exceedance(rms: f64, rate_rms: f64, limit: f64) -> Result<ExceedanceRate, MetricsError> {
    for (field, value) in [("rms", rms), ("rate_rms", rate_rms)] {
        if !(value.is_finite() && value >= 0.0) {
            let expected = "a finite number, not negative".to_owned();
            return Err(MetricsError::Field { field, expected, found: value.to_string() });
        }
    }
    if !(limit.is_finite() && limit > 0.0) {
        let expected = "a positive number".to_owned();
        return Err(MetricsError::Field { field: "limit", expected, found: limit.to_string() });
    }
    if rms == 0.0 {
        return Ok(ExceedanceRate { probability: 0.0, per_s: 0.0 });
    }
    let ratio = limit / rms;
    Ok(ExceedanceRate {
        probability: libm::erfc(ratio * FRAC_1_SQRT_2),
        per_s: rate_rms / (PI * rms) * (-0.5 * ratio * ratio).exp(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn a_long_signal_is_beyond_its_limit_as_often_as_said() {
        // ẍ + 2ζωẋ + ω²x = noise: σ̇ = ωσ exactly; exact steps of its rotation in (x, ẋ/ω) with ζ → exact Gaussian chain
        let (omega, zeta, dt, samples) = (6.0_f64, 0.3_f64, 2e-3_f64, 4_000_000_usize);
        let damped = omega * (1.0 - zeta * zeta).sqrt();
        let (e, c, s) = ((-zeta * omega * dt).exp(), (damped * dt).cos(), (damped * dt).sin());
        // Φ of (x, y = ẋ/ω)
        let r = zeta * omega / damped;
        let phi = [[e * (c + r * s), e * omega / damped * s], [-e * omega / damped * s, e * (c - r * s)]];
        // stationary covariance is I: the noise of a step has I − ΦΦᵀ, by its Cholesky factor
        let q = |i: usize, j: usize| {
            f64::from(u8::from(i == j)) - (phi[i][0] * phi[j][0] + phi[i][1] * phi[j][1])
        };
        let l11 = q(0, 0).sqrt();
        let l21 = q(1, 0) / l11;
        let l22 = (q(1, 1) - l21 * l21).sqrt();
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(8);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let limit = 1.5;
        let (mut x, mut y) = (normal(), normal());
        let (mut beyond, mut crossings) = (0_u64, 0_u64);
        for _ in 0..samples {
            let (n1, n2) = (normal(), normal());
            let next = phi[0][0] * x + phi[0][1] * y + l11 * n1;
            y = phi[1][0] * x + phi[1][1] * y + l21 * n1 + l22 * n2;
            crossings += u64::from(x.abs() <= limit && next.abs() > limit);
            x = next;
            beyond += u64::from(x.abs() > limit);
        }
        let said = exceedance(1.0, omega, limit).unwrap();
        let (share, rate) = (beyond as f64 / samples as f64, crossings as f64 / (samples as f64 * dt));
        // 8000 s are about 8500 independent stretches (1/(ζω) of each) and 5000 crossings in clumps: 3 standard deviations are 5 %
        assert!((share / said.probability - 1.0).abs() < 0.05, "{share} {}", said.probability);
        assert!((rate / said.per_s - 1.0).abs() < 0.05, "{rate} {}", said.per_s);
    }

    #[test]
    fn known_values_and_refusals() {
        // two-sided normal tails
        for (sigmas, tail) in [(1.0, 0.317_310_507_862_914), (3.0, 2.699_796_063_260_19e-3)] {
            let found = exceedance(0.5, 1.0, 0.5 * sigmas).unwrap().probability;
            assert!((found / tail - 1.0).abs() < 1e-12, "{found}");
        }
        assert_eq!(exceedance(0.0, 1.0, 0.1).unwrap().per_s, 0.0);
        assert!(exceedance(-1.0, 1.0, 0.1).is_err() && exceedance(1.0, f64::NAN, 0.1).is_err());
        assert!(exceedance(1.0, 1.0, 0.0).unwrap_err().to_string().contains("limit"));
    }
}
