//! Hann's window: its samples, its spectral kernel, and how much overlapped segments share.

use std::f64::consts::{PI, TAU};

/// The kernel reaches this many half bins to either side.
pub const KERNEL_HALF_WIDTH: usize = 7;

/// Hann's window of N samples (periodic): w_n = (1 − cos(2πn/N))/2.
#[derive(Debug, Clone, PartialEq)]
pub struct HannWindow {
    samples: Vec<f64>,
    power: f64,
    blurs: bool,
}

impl HannWindow {
    /// The window of a segment of `len` samples.
    #[must_use]
    pub fn new(len: usize) -> Self {
        let samples: Vec<f64> = (0..len).map(|n| 0.5 - 0.5 * (TAU * n as f64 / len as f64).cos()).collect();
        let power = samples.iter().map(|w| w * w).sum();
        HannWindow { samples, power, blurs: true }
    }

    /// w_n.
    #[must_use]
    pub fn samples(&self) -> &[f64] {
        &self.samples
    }

    /// Σ w_n².
    #[must_use]
    pub fn power(&self) -> f64 {
        self.power
    }

    /// |W|² at −7, −6, …, 7 half bins, normalised to sum 1: with bins of Δf = rate/N,
    ///
    /// E Ŝ(f) = ∫ S(f − u) |W(u)|² du ≈ Σ_m kernel_m S(f − m Δf/2).
    ///
    /// Half bins are all that is needed: w ∗ w lasts 2N samples, so |W|² sampled at Δf/2 loses nothing.
    #[must_use]
    pub fn kernel(&self) -> Vec<f64> {
        let half = KERNEL_HALF_WIDTH as i32;
        if !self.blurs {
            return (-half..=half).map(|m| f64::from(u8::from(m == 0))).collect();
        }
        let n = self.samples.len() as f64;
        let mut kernel: Vec<f64> = (-half..=half)
            .map(|m| {
                let omega = PI * f64::from(m) / n;
                let (mut re, mut im) = (0.0, 0.0);
                for (k, w) in self.samples.iter().enumerate() {
                    let (sin, cos) = (omega * k as f64).sin_cos();
                    re += w * cos;
                    im -= w * sin;
                }
                re * re + im * im
            })
            .collect();
        let sum: f64 = kernel.iter().sum();
        kernel.iter_mut().for_each(|k| *k /= sum);
        kernel
    }

    /// The same window as if it saw single frequencies: to see fits fail that take it for one that does.
    #[doc(hidden)]
    #[must_use]
    pub fn without_kernel(self) -> Self {
        HannWindow { blurs: false, ..self }
    }

    /// How many independent segments as many overlapping ones are worth: with ρ(m) = Σ_n w_n w_{n+mD}/Σ w² at hop D,
    ///
    /// K² / Σ_{ij} ρ(i − j)² = K / (1 + 2 Σ_{m ≥ 1} (1 − m/K) ρ(m)²),
    ///
    /// so that the variance of an averaged periodogram of smooth Gaussian noise is S² over this number.
    /// P. D. Welch, IEEE Trans. Audio Electroacoust. 15 (1967) 70–73.
    #[must_use]
    pub fn independent_segments(&self, segments: usize, hop: usize) -> f64 {
        let k = segments as f64;
        let mut sum = 1.0;
        let mut m = 1;
        while m * hop < self.samples.len() && m < segments {
            let rho = self.correlation(m * hop);
            sum += 2.0 * (1.0 - m as f64 / k) * rho * rho;
            m += 1;
        }
        k / sum
    }

    /// How many independent periodograms a sum over *all* bins of as many overlapping segments is worth at each bin:
    ///
    /// K / Σ_m (1 − |m|/K) N Σ_n w_n² w_{n+mD}²/(Σ w²)²
    ///
    /// since bins of overlapping segments share more than bins of one segment times segments at one bin. At 75 % overlap
    /// Σ_m w²_{n+mD} is the same at every n, the divisor is 4, and the worth T/T_seg: what the samples hold.
    #[must_use]
    pub fn independent_over_bins(&self, segments: usize, hop: usize) -> f64 {
        let (n, k) = (self.samples.len(), segments as f64);
        let mut sum = 0.0;
        let mut m = 0;
        while m * hop < n && m < segments {
            let both: f64 =
                self.samples.iter().zip(&self.samples[m * hop..]).map(|(a, b)| a * a * b * b).sum();
            let count = if m == 0 { 1.0 } else { 2.0 * (1.0 - m as f64 / k) };
            sum += count * n as f64 * both / (self.power * self.power);
            m += 1;
        }
        k / sum
    }

    fn correlation(&self, shift: usize) -> f64 {
        self.samples.iter().zip(&self.samples[shift..]).map(|(a, b)| a * b).sum::<f64>() / self.power
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_kernel_is_hanns() {
        // |W(u)|² ∝ (sinc u/(1 − u²))², u in bins: 1, (8/3π)², 1/4, …
        let k = HannWindow::new(1024).kernel();
        assert_eq!(k.len(), 15);
        assert!((k.iter().sum::<f64>() - 1.0).abs() < 1e-14);
        assert!((k[6] / k[7] - (8.0 / (3.0 * PI)).powi(2)).abs() < 1e-5);
        assert!((k[5] / k[7] - 0.25).abs() < 1e-12 && (k[9] / k[7] - 0.25).abs() < 1e-12);
        assert!(k[3] < 1e-20 && k[11] < 1e-20);
    }

    #[test]
    fn overlap_is_worth_what_theory_says() {
        let w = HannWindow::new(4096);
        // without overlap every segment counts
        assert!((w.independent_segments(50, 4096) - 50.0).abs() < 1e-12);
        // two of them at half overlap: 2²/(2 + 2ρ²)
        assert!((w.independent_segments(2, 2048) - 4.0 / (2.0 + 2.0 / 36.0)).abs() < 1e-12);
        // half overlap: ρ = 1/6; three quarters: ρ = .6592, 1/6, .0075
        let many = 1_000_000;
        let half = many as f64 / w.independent_segments(many, 2048);
        assert!((half - (1.0 + 2.0 / 36.0)).abs() < 1e-5, "{half}");
        let three_quarters = many as f64 / w.independent_segments(many, 1024);
        assert!((three_quarters - 1.9249).abs() < 1e-3, "{three_quarters}");
        // one segment: Σ|γ|² = 1 + 2(4/9 + 1/36); many at 75 %: exactly 4
        assert!(
            (1.0 / w.independent_over_bins(1, 1024) - (1.0 + 2.0 * (4.0 / 9.0 + 1.0 / 36.0))).abs() < 1e-9
        );
        let joint = many as f64 / w.independent_over_bins(many, 1024);
        assert!((joint - 4.0).abs() < 1e-4, "{joint}");
    }
}
