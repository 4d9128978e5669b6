//! The low-pass before decimation: a Kaiser-windowed sinc, applied where a sample is kept only.

use super::SignalError;
use std::f64::consts::PI;

/// Flat up to this share of the new Nyquist frequency.
pub const PASSBAND: f64 = 0.8;
/// Stopped from this share of the new Nyquist frequency on: what folds back lands above [`PASSBAND`].
pub const STOPBAND: f64 = 1.2;
/// Attenuation of the stop band in dB; a Kaiser window's pass band ripples as little (10⁻⁴).
const ATTENUATION_DB: f64 = 80.0;
/// A larger factor is a mistake, or wants stages.
const MAX_FACTOR: usize = 10_000;

/// The taps of the filter for a factor: odd in number, symmetric, of sum 1.
pub(super) fn filter(factor: usize) -> Result<Vec<f64>, SignalError> {
    if factor == 0 || factor > MAX_FACTOR {
        let expected = "a whole number from 1 to 10000";
        return Err(SignalError::Value { name: "factor", expected, found: factor as f64 });
    }
    // Kaiser's formulas for the window's β and the number of taps of a transition Δω.
    let beta = 0.1102 * (ATTENUATION_DB - 8.7);
    let nyquist = PI / factor as f64;
    let transition = (STOPBAND - PASSBAND) * nyquist;
    let half = ((ATTENUATION_DB - 7.95) / (2.285 * transition) / 2.0).ceil() as usize;
    // whole output samples, so that the first one kept is the filter's middle
    let half = half.div_ceil(factor) * factor;
    let cutoff = nyquist * (PASSBAND + STOPBAND) / 2.0;
    let mut taps: Vec<f64> = (0..=2 * half)
        .map(|k| {
            let t = k as f64 - half as f64;
            let sinc = if t == 0.0 { cutoff / PI } else { (cutoff * t).sin() / (PI * t) };
            sinc * bessel_i0(beta * (1.0 - (t / half as f64).powi(2)).max(0.0).sqrt())
        })
        .collect();
    let sum: f64 = taps.iter().sum();
    taps.iter_mut().for_each(|h| *h /= sum);
    Ok(taps)
}

/// Σ_k h_k x_{nM + k} for every n at which the filter lies inside x.
pub(super) fn apply(taps: &[f64], factor: usize, x: &[f64]) -> Vec<f64> {
    x.windows(taps.len())
        .step_by(factor)
        .map(|part| part.iter().zip(taps).map(|(x, h)| x * h).sum())
        .collect()
}

/// I₀(x) = Σ ((x/2)^k / k!)².
fn bessel_i0(x: f64) -> f64 {
    let (mut sum, mut term, mut k) = (1.0, 1.0, 1.0);
    while term > 1e-17 * sum {
        term *= (x / (2.0 * k)).powi(2);
        sum += term;
        k += 1.0;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// |H| at a frequency given as a share of the new Nyquist frequency.
    fn gain(taps: &[f64], factor: usize, share: f64) -> f64 {
        let omega = share * PI / factor as f64;
        let half = (taps.len() / 2) as f64;
        taps.iter().enumerate().map(|(k, h)| h * (omega * (k as f64 - half)).cos()).sum::<f64>()
    }

    #[test]
    fn the_pass_band_is_flat_and_what_folds_into_it_is_stopped() {
        for factor in [2, 5, 17] {
            let taps = filter(factor).unwrap();
            for i in 0..=200 {
                let share = PASSBAND * f64::from(i) / 200.0;
                assert!((gain(&taps, factor, share) - 1.0).abs() < 1.2e-4, "{factor} {share}");
            }
            let last = factor as f64;
            for i in 0..=500 {
                let share = STOPBAND + (last - STOPBAND) * f64::from(i) / 500.0;
                assert!(gain(&taps, factor, share).abs() < 1.2e-4, "{factor} {share}");
            }
            assert_eq!(taps.len() / 2, 13 * factor, "the ends that decimation leaves out");
        }
        assert!(filter(0).is_err());
    }

    #[test]
    fn a_sine_keeps_amplitude_and_phase() {
        let factor = 4;
        let omega: f64 = 0.5 * PI / 4.0;
        let x: Vec<f64> = (0..2000).map(|k| (omega * f64::from(k) + 0.3).sin()).collect();
        let taps = filter(factor).unwrap();
        for (n, y) in apply(&taps, factor, &x).iter().enumerate() {
            assert!((y - x[taps.len() / 2 + n * factor]).abs() < 1.2e-4, "{n}");
        }
    }
}
