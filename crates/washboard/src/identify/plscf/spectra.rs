//! Half and full correlogram spectra at lines around the circle, and the exponential lag window.

use super::PlscfSettings;
use crate::identify::operational::{ModelPole, OperationalError, require};
use crate::linalg::{C64, CMat};
use crate::signal::Correlations;
use crate::units::rad_per_s;
use realfft::RealFftPlanner;
use serde::{Deserialize, Serialize};

/// Which spectra p-LSCF fits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Spectrum {
    /// S⁺, of the lags from zero: each pole once. Half the order, and no mirror images.
    #[default]
    Half,
    /// S, of positive and negative lags: each pole λ and its mirror image −λ*.
    Full,
}

/// Half spectra that are at hand, for [`plscf_poles`](crate::identify::plscf_poles).
#[derive(Debug, Clone)]
pub struct HalfSpectra {
    /// Samples per second of the record that they describe.
    pub rate_hz: f64,
    /// Lines from 0 to half the rate, in Hz.
    pub freq_hz: Vec<f64>,
    /// S⁺ = Λ₀/2 + Σ Λ_k e^{−iωk} at each line: outputs × references.
    pub values: Vec<CMat>,
}

/// w_k = e^{−βk}.
pub(super) struct LagWindow {
    /// β, per sample.
    pub beta: f64,
    /// L.
    pub lags: usize,
    spectrum_is_full: bool,
}

impl LagWindow {
    /// The window that falls to `end` at the longest lag.
    pub fn exponential(lags: usize, end: f64, spectrum: Spectrum) -> Self {
        Self { beta: -end.ln() / lags as f64, lags, spectrum_is_full: spectrum == Spectrum::Full }
    }

    /// Takes the window's damping out of a pole of windowed spectra: Λ_k = e^{βk} φ gᵀ μ'^{k−1}.
    ///
    /// A pole outside the circle has no part at positive lags; in full spectra it is a mirror image, which the window
    /// moved outwards, or a mathematical pole, which stays outside.
    pub fn correct(&self, pole: &mut ModelPole) {
        let grow = self.beta.exp();
        if pole.mu.norm() < 1.0 {
            pole.mu *= grow;
            if let Some(input) = &mut pole.input {
                input.iter_mut().for_each(|g| *g *= grow);
            }
        } else {
            pole.input = None;
            let size = pole.mu.norm();
            if self.spectrum_is_full {
                pole.mu *= (size / grow).max(1.0) / size;
            } else {
                pole.mu *= grow;
            }
        }
    }
}

/// Spectra at lines, with the weight of each: a line and its conjugate count two.
pub(super) struct Lines {
    /// e^{iω}.
    pub z: Vec<C64>,
    /// ½ at ω = 0 and π, 1 elsewhere.
    pub weight: Vec<f64>,
    /// Outputs × references, row by row, at each line.
    pub values: Vec<Vec<C64>>,
    /// Rows.
    pub outputs: usize,
    /// Columns.
    pub references: usize,
}

impl Lines {
    /// Lines all around the circle, dense enough that lags and order do not wrap.
    pub fn of_correlations(lambda: &Correlations, window: &LagWindow, settings: &PlscfSettings) -> Self {
        Self::around(lambda, window, settings.spectrum, settings.max_order)
    }

    /// As [`Lines::of_correlations`], of this kind.
    pub fn around(lambda: &Correlations, window: &LagWindow, spectrum: Spectrum, order: usize) -> Self {
        let (n, sides) = (lambda.channels(), if spectrum == Spectrum::Full { 2 } else { 1 });
        let length = (sides * window.lags + order + 2).next_power_of_two();
        let transform = RealFftPlanner::<f64>::new().plan_fft_forward(length);
        let bins = length / 2 + 1;
        let mut values = vec![vec![C64::new(0.0, 0.0); n * n]; bins];
        let mut input = transform.make_input_vec();
        let mut output = transform.make_output_vec();
        for (a, b) in (0..n * n).map(|ab| (ab / n, ab % n)) {
            input.fill(0.0);
            // Λ_k[a, b] = R_ba(k)
            for (k, (x, r)) in input.iter_mut().zip(lambda.pair(b, a)).enumerate() {
                *x = r * (-window.beta * k as f64).exp();
            }
            input[0] *= 0.5;
            // lengths are those of the plan, so this can't fail
            let done = transform.process(&mut input, &mut output);
            debug_assert!(done.is_ok());
            values.iter_mut().zip(&output).for_each(|(v, s)| v[a * n + b] = *s);
        }
        if spectrum == Spectrum::Full {
            for v in &mut values {
                let half = v.clone();
                for (a, b) in (0..n * n).map(|ab| (ab / n, ab % n)) {
                    v[a * n + b] += half[b * n + a].conj();
                }
            }
        }
        let omega = |k: usize| std::f64::consts::TAU * k as f64 / length as f64;
        let z = (0..bins).map(|k| C64::new(0.0, omega(k)).exp()).collect();
        let weight = (0..bins).map(|k| if k == 0 || k == bins - 1 { 0.5 } else { 1.0 }).collect();
        Self { z, weight, values, outputs: n, references: n }
    }

    /// Spectra as they are given.
    pub fn of_half_spectra(spectra: &HalfSpectra) -> Result<Self, OperationalError> {
        let HalfSpectra { rate_hz, freq_hz, values } = spectra;
        require(rate_hz.is_finite() && *rate_hz > 0.0, "rate_hz", "a positive number", *rate_hz)?;
        let found = values.len() as f64;
        let expected = || format!("one matrix for each of {} lines, and one line at least", freq_hz.len());
        require(!values.is_empty() && values.len() == freq_hz.len(), "values", expected(), found)?;
        let (outputs, references) = (values[0].nrows(), values[0].ncols());
        let (mut z, mut weight, mut flat) = (Vec::new(), Vec::new(), Vec::new());
        for (f, s) in freq_hz.iter().zip(values) {
            let inside = (0.0..=rate_hz / 2.0).contains(f);
            require(inside, "freq_hz", format!("from 0 to {} Hz", rate_hz / 2.0), *f)?;
            let same = (s.nrows(), s.ncols()) == (outputs, references);
            require(same, "values", format!("{outputs} × {references} at every line"), s.nrows() as f64)?;
            let line: Vec<C64> =
                (0..outputs * references).map(|ab| s[(ab / references, ab % references)]).collect();
            if let Some(bad) = line.iter().find(|v| !(v.re.is_finite() && v.im.is_finite())) {
                require(false, "values", "finite numbers", if bad.re.is_finite() { bad.im } else { bad.re })?;
            }
            z.push(C64::new(0.0, rad_per_s(*f) / rate_hz).exp());
            weight.push(if *f == 0.0 || *f == rate_hz / 2.0 { 0.5 } else { 1.0 });
            flat.push(line);
        }
        Ok(Self { z, weight, values: flat, outputs, references })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pole(mu: C64) -> ModelPole {
        ModelPole { mu, shape: vec![C64::new(1.0, 0.0)], input: Some(vec![C64::new(1.0, 0.0)]) }
    }

    #[test]
    fn the_windows_damping_is_taken_out_of_both_images() {
        let window = LagWindow::exponential(100, 0.01, Spectrum::Full);
        let truth = C64::from_polar(0.99, 0.7);
        let mut decaying = pole(truth * (-window.beta).exp());
        let mut mirror = pole(truth.conj().inv() * window.beta.exp());
        window.correct(&mut decaying);
        window.correct(&mut mirror);
        assert!((decaying.mu - truth).norm() < 1e-15);
        assert!((mirror.mu - truth.conj().inv()).norm() < 1e-15);
        assert!(mirror.input.is_none());
        // a mathematical pole just outside the circle does not become a decaying one
        let mut mathematical = pole(C64::from_polar(1.0 + 1e-6, 0.7));
        window.correct(&mut mathematical);
        assert!(mathematical.mu.norm() >= 1.0 - 1e-15);
    }
}
