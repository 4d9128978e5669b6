//! What a sensor does besides measuring: a late filter, a clock of its own, noise, bias, clipping, rounding.

use super::synthesis::{RoadInput, between, series};
use super::{GUARD_S, SimulateError};
use crate::linalg::C64;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// A series is made this much denser before it is read between its samples: see [`between`].
const DENSER: usize = 8;

/// What a sensor does besides measuring.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Flaws {
    /// White noise, as a multiple of the channel's own rms.
    pub noise_ratio: f64,
    /// A constant, in the channel's unit.
    pub bias: f64,
    /// Values beyond ± this are held there.
    pub clip: Option<f64>,
    /// Values are rounded to multiples of this.
    pub quantum: Option<f64>,
    /// The channel shows what was this many s ago: a filter's lag, or a clock that is set wrong.
    pub delay_s: f64,
    /// The channel's clock is this many millionths fast: sample k is taken at k/(rate (1 + ppm 10⁻⁶)).
    pub clock_ppm: f64,
}

impl Flaws {
    /// Refuses a delay or a drift that leaves what is synthesised.
    pub(super) fn check(&self, duration_s: f64) -> Result<(), SimulateError> {
        let room = GUARD_S / 4.0;
        let drift = self.clock_ppm * 1e-6 * duration_s;
        for (field, value, expected, found) in [
            ("delay_s", self.delay_s, "at most 5 s either way", format!("{} s", self.delay_s)),
            (
                "clock_ppm",
                drift,
                "a clock that is wrong by 5 s at most in the end",
                format!("{} ppm, {drift} s", self.clock_ppm),
            ),
        ] {
            // NaN must be refused too
            if !(value.abs() <= room) {
                return Err(SimulateError::Setting { field, expected, found });
            }
        }
        Ok(())
    }

    /// A channel's samples from its spectrum, at the instants of its own clock.
    pub(super) fn sample(&self, mut spectrum: Vec<C64>, input: &RoadInput<'_>, samples: usize) -> Vec<f64> {
        if self.delay_s != 0.0 {
            for (k, value) in spectrum.iter_mut().enumerate() {
                *value *= C64::new(0.0, -input.omega(k) * self.delay_s).exp();
            }
        }
        if self.clock_ppm == 0.0 {
            let mut data = series(spectrum, input.period());
            data.truncate(samples);
            return data;
        }
        let dense = series(spectrum, DENSER * input.period());
        let pace = DENSER as f64 / (1.0 + self.clock_ppm * 1e-6);
        (0..samples).map(|k| between(&dense, pace * k as f64)).collect()
    }

    /// Adds noise and bias, clips and rounds; the rms of the noise.
    pub(super) fn spoil(&self, data: &mut [f64], rng: &mut ChaCha8Rng) -> f64 {
        let rms = (data.iter().map(|x| x * x).sum::<f64>() / data.len() as f64).sqrt();
        for x in data.iter_mut() {
            let z: f64 = StandardNormal.sample(rng);
            *x += self.noise_ratio * rms * z + self.bias;
            if let Some(limit) = self.clip {
                *x = x.clamp(-limit, limit);
            }
            if let Some(quantum) = self.quantum {
                *x = (*x / quantum).round() * quantum;
            }
        }
        self.noise_ratio * rms
    }
}
