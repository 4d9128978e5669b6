//! What the record says beside the poles: normalised channels, their correlations, and the spectrum at any frequency.

use super::OperationalError;
use crate::linalg::C64;
use crate::signal::{CorrelationError, Correlations, correlations};

/// A channel that departs from its mean by less is constant: the mean of a million samples is exact to 1e-13.
const CONSTANT: f64 = 1e-12;

/// A record as the estimators see it.
pub(in crate::identify) struct Record {
    /// Sample rate.
    pub rate_hz: f64,
    /// Samples a channel.
    pub samples: usize,
    /// Of the channels as they came.
    pub rms: Vec<f64>,
    /// Channels less their means over their rms.
    pub channels: Vec<Vec<f64>>,
    /// Of the normalised channels.
    pub lambda: Correlations,
}

impl Record {
    /// Normalised channels and their correlations at the lags 0 … `max_lag`.
    pub fn new(channels: &[Vec<f64>], rate_hz: f64, max_lag: usize) -> Result<Self, OperationalError> {
        let (channels, rms) = normalise(channels)?;
        let lambda = correlations(&channels, max_lag)?;
        let samples = channels.first().map_or(0, Vec::len);
        Ok(Self { rate_hz, samples, rms, channels, lambda })
    }

    /// The longest lag.
    pub fn lags(&self) -> usize {
        self.lambda.lags() - 1
    }

    /// ‖S(ω)‖_F² by the correlations under Hann's lag window: Λ₀ + Σ_{k=1}^{L} w_{k−1}(Λ_k e^{−iωk} + its transpose
    /// conjugate), ω in rad a sample.
    pub fn spectrum_square(&self, omega: f64) -> f64 {
        let (n, lags) = (self.lambda.channels(), self.lags());
        let back = C64::new(0.0, -omega).exp();
        let mut turned = Vec::with_capacity(lags);
        let mut turn = back;
        for k in 0..lags {
            turned.push(turn * lag_weight(k, lags));
            turn *= back;
        }
        // Λ_k[a, b] = R_ba(k)
        let half = |a: usize, b: usize| -> C64 {
            self.lambda.pair(b, a)[1..].iter().zip(&turned).map(|(r, t)| t * *r).sum()
        };
        let halves: Vec<C64> = (0..n * n).map(|ab| half(ab / n, ab % n)).collect();
        let entry = |a: usize, b: usize| {
            (halves[a * n + b] + halves[b * n + a].conj() + self.lambda.at(b, a, 0)).norm_sqr()
        };
        (0..n * n).map(|ab| entry(ab / n, ab % n)).sum()
    }
}

/// Hann's lag window w_k = (1 + cos(πk/L))/2, for the lag k + 1.
pub(super) fn lag_weight(k: usize, lags: usize) -> f64 {
    0.5 + 0.5 * (std::f64::consts::PI * k as f64 / lags as f64).cos()
}

/// Channels without their means and divided by their rms; and these rms.
pub(in crate::identify) fn normalise(
    channels: &[Vec<f64>],
) -> Result<(Vec<Vec<f64>>, Vec<f64>), OperationalError> {
    let (mut normalised, mut all_rms) = (Vec::new(), Vec::new());
    for (channel, data) in channels.iter().enumerate() {
        if let Some(sample) = data.iter().position(|v| !v.is_finite()) {
            let value = data[sample];
            return Err(CorrelationError::NotFinite { channel, sample, value }.into());
        }
        let count = data.len().max(1) as f64;
        let mean = data.iter().map(|v| v / count).sum::<f64>();
        // by the largest deviation first, so that no square overflows
        let largest = data.iter().fold(0.0f64, |m, v| m.max((v - mean).abs()));
        if largest <= CONSTANT * mean.abs() {
            return Err(OperationalError::Constant { channel, value: mean });
        }
        let square = data.iter().map(|v| ((v - mean) / largest).powi(2)).sum::<f64>() / count;
        let rms = largest * square.sqrt();
        normalised.push(data.iter().map(|v| (v - mean) / rms).collect());
        all_rms.push(rms);
    }
    Ok((normalised, all_rms))
}
