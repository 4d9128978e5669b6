//! Structures that are simulated exactly: modes under white forces of their own, seen by channels.

#![allow(dead_code, clippy::unwrap_used)]

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::TAU;
use washboard::linalg::{C64, CMat, Mat, expm, lyapunov};

/// Modes with (Hz, damping ratio), and the displacement of every channel in each.
pub struct Structure {
    pub rate_hz: f64,
    pub modes: Vec<(f64, f64)>,
    /// Channels × modes.
    pub shapes: Vec<Vec<f64>>,
}

impl Structure {
    /// Light and medium modes, a damped one: four channels.
    pub fn mixed() -> Self {
        let shapes =
            [[1.0, 0.5, 1.0, -0.7], [0.8, -1.0, -0.6, 1.0], [-0.3, 0.9, -1.0, 0.2], [-0.9, -0.7, 0.4, -0.5]];
        Self {
            rate_hz: 40.0,
            modes: vec![(1.5, 0.02), (3.1, 0.01), (6.0, 0.03), (10.0, 0.10)],
            shapes: shapes.iter().map(|r| r.to_vec()).collect(),
        }
    }

    /// The exact step of mode k at its unit variance of displacement: x⁺ = F x + L w, and L of the stationary state.
    fn step(&self, k: usize) -> (Mat, Mat, Mat) {
        let (f, zeta) = self.modes[k];
        let omega = TAU * f;
        let (mut a, mut q) = (Mat::zeros(2, 2), Mat::zeros(2, 2));
        a[(0, 1)] = 1.0;
        a[(1, 0)] = -omega * omega;
        a[(1, 1)] = -2.0 * zeta * omega;
        q[(1, 1)] = 4.0 * zeta * omega.powi(3);
        let p = lyapunov(&a, &q).unwrap().x;
        let step = expm(&(&a * faer::Scale(1.0 / self.rate_hz))).unwrap();
        let noise = &p - &step * &p * step.transpose();
        let root = noise.llt(faer::Side::Lower).unwrap().L().to_owned();
        (step, root, p.llt(faer::Side::Lower).unwrap().L().to_owned())
    }

    /// Channels with white sensor noise of this part of a mode's rms.
    pub fn simulate(&self, seed: u64, samples: usize, noise: f64) -> Vec<Vec<f64>> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let mut channels = vec![vec![0.0; samples]; self.shapes.len()];
        for k in 0..self.modes.len() {
            let (step, root, start) = self.step(k);
            let draw = |l: &Mat, w: [f64; 2]| [l[(0, 0)] * w[0], l[(1, 0)] * w[0] + l[(1, 1)] * w[1]];
            let mut x = draw(&start, [normal(), normal()]);
            for t in 0..samples {
                for (channel, shape) in channels.iter_mut().zip(&self.shapes) {
                    channel[t] += shape[k] * x[0];
                }
                let w = draw(&root, [normal(), normal()]);
                x = [
                    step[(0, 0)] * x[0] + step[(0, 1)] * x[1] + w[0],
                    step[(1, 0)] * x[0] + step[(1, 1)] * x[1] + w[1],
                ];
            }
        }
        for channel in &mut channels {
            channel.iter_mut().for_each(|v| *v += noise * normal());
        }
        channels
    }

    /// λ of mode k.
    pub fn pole(&self, k: usize) -> C64 {
        let (f, zeta) = self.modes[k];
        C64::new(-zeta, (1.0 - zeta * zeta).sqrt()) * TAU * f
    }

    /// Λ_k = E[y(t + k) yᵀ(t)] of the structure without sensor noise, windowed by e^{−βk}, summed to the half spectrum in
    /// closed form: Σ_k' w Λ e^{−iωk} with Λ₀ halved.
    pub fn half_spectrum(&self, freq_hz: f64, beta: f64) -> CMat {
        let z = C64::new(0.0, TAU * freq_hz / self.rate_hz).exp();
        let n = self.shapes.len();
        let mut sum = CMat::zeros(n, n);
        for (k, (_, zeta)) in self.modes.iter().enumerate() {
            // R(τ) = Re[(1 − iζ/√(1−ζ²)) e^{λτ}] of a mode of unit variance
            let c = C64::new(0.5, -0.5 * zeta / (1.0 - zeta * zeta).sqrt());
            let lambda = self.pole(k);
            let mu = (lambda / self.rate_hz - beta).exp();
            let one = C64::new(1.0, 0.0);
            let geometric = |c: C64, mu: C64| c * (one / (one - mu / z)) - c * 0.5;
            let h = geometric(c, mu) + geometric(c.conj(), mu.conj());
            for (i, j) in (0..n * n).map(|ij| (ij / n, ij % n)) {
                sum[(i, j)] += h * self.shapes[i][k] * self.shapes[j][k];
            }
        }
        sum
    }

    /// The criterion between a found shape as (channel, re, im) and mode k's.
    pub fn mac(&self, k: usize, shape: &[washboard::identify::ShapeComponent]) -> f64 {
        let found: Vec<[f64; 2]> = shape.iter().map(|s| [s.re, s.im]).collect();
        let truth: Vec<[f64; 2]> = shape.iter().map(|s| [self.shapes[s.channel][k], 0.0]).collect();
        washboard::identify::operational::modal_assurance(&found, &truth)
    }
}
