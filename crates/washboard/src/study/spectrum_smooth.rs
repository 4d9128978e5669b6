//! Raw spectra made fit to be fitted: means in bands of a fraction of an octave.

use super::StudyError;
use super::road_fit_source::FitSamples;
use crate::linalg::{C64, CMat};

/// The most bands an octave.
const MOST_BANDS: f64 = 48.0;
/// Means over bands, `per_octave` an octave: of ω²S over the mean of ω², at the geometric mean of ω. Zero frequency is left out.
///
/// # Errors
/// A number of bands that is none; a weight beside it, which is one of the samples themselves.
pub(super) fn smooth(samples: &mut FitSamples, per_octave: f64) -> Result<(), StudyError> {
    if !(per_octave > 0.0 && per_octave <= MOST_BANDS) {
        let expected = format!("a number of bands an octave, above 0 and up to {MOST_BANDS}");
        return Err(StudyError::Setting { field: "smooth", expected, found: per_octave.to_string() });
    }
    if samples.variances.is_some() {
        let expected = "no smoothing beside a column weight".to_owned();
        return Err(StudyError::Setting { field: "smooth", expected, found: "both".into() });
    }
    let (mut omega, mut s) = (Vec::new(), Vec::new());
    let mut from = samples.omega.partition_point(|w| !(*w > 0.0));
    while let Some(first) = samples.omega.get(from) {
        let edge = first * 2f64.powf(1.0 / per_octave);
        let to = samples.omega.partition_point(|w| *w < edge).max(from + 1);
        let (band, values) = (&samples.omega[from..to], &samples.s[from..to]);
        let m = values.first().map_or(0, |s| s.nrows());
        let squares: f64 = band.iter().map(|w| w * w).sum();
        let mut mean = CMat::zeros(m, m);
        for (w, s) in band.iter().zip(values) {
            mean += s * faer::Scale(C64::new(w * w / squares, 0.0));
        }
        // ω²S is flat in a band of a road
        let centre = (band.iter().map(|w| w.ln()).sum::<f64>() / band.len() as f64).exp();
        let flat = squares / (band.len() as f64 * centre * centre);
        omega.push(centre);
        s.push(mean * faer::Scale(C64::new(flat, 0.0)));
        from = to;
    }
    (samples.omega, samples.s) = (omega, s);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::road_fit_source::{FitSource, one};
    use super::*;
    use crate::road::{FilterOutput, FilterVariable};
    use rand::{Rng, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// Densities of 1/ω², each times the mean of `k` exponential variables.
    fn raw(k: usize) -> FitSamples {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let omega: Vec<f64> = (1..=4000).map(|k| 0.01 * f64::from(k)).collect();
        let mut noise =
            || (0..k).map(|_| -rng.random_range(f64::MIN_POSITIVE..1.0f64).ln()).sum::<f64>() / k as f64;
        let s = omega.iter().map(|w| one(noise() / (w * w))).collect();
        FitSamples {
            kind: FitSource::Spectrum,
            variable: FilterVariable::Time,
            of: FilterOutput::Displacement,
            omega,
            s,
            variances: None,
            coherence: None,
            notes: Vec::new(),
            inputs: Vec::new(),
        }
    }

    /// The mean of many exponential variables is the density: no bias of the logarithm is left.
    #[test]
    fn means_over_bands_are_the_density() {
        let mut samples = raw(1);
        smooth(&mut samples, 3.0).unwrap();
        let last = samples.omega.len() - 2;
        assert!((20..40).contains(&last), "{last}");
        for k in last - 6..=last {
            let ratio = samples.s[k][(0, 0)].re * samples.omega[k].powi(2);
            // bands of 100 bins and more: 4 standard deviations are below 0.4
            assert!((ratio - 1.0).abs() < 0.4, "{}: {ratio}", samples.omega[k]);
        }
        let mean: f64 = (last - 6..=last).map(|k| samples.s[k][(0, 0)].re * samples.omega[k].powi(2)).sum();
        assert!((mean / 7.0 - 1.0).abs() < 0.08, "{mean}");
        assert!(smooth(&mut raw(1), 0.0).is_err() && smooth(&mut raw(1), f64::NAN).is_err());
    }
}
