//! The spectrum of a measured profile: Welch's, smoothed in bands of a fraction of an octave.

use crate::signal::{
    Channel, Direction, Place, Quantity, Recording, Segment, SignalError, WelchSettings, welch,
};

/// The first bins are bent by the means that are taken off and by the window.
const FIRST_BIN: usize = 3;

/// A road's spectrum as a profile shows it.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredSpectrum {
    /// Geometric means of the bands' bins, rad/m, ascending.
    pub nu_rad_per_m: Vec<f64>,
    /// Two-sided S(ν), m²·m/rad, with R(ξ) = (1/2π)∫S e^{iνξ}dν.
    pub s: Vec<f64>,
    /// How many independent averages each is worth: its variance is S²/averages.
    pub averages: Vec<f64>,
    /// The distance of the bins, rad/m.
    pub resolution_rad_per_m: f64,
}

/// The mean spectrum of tracks that are sampled evenly.
///
/// Each track is taken less its line of least squares; Welch's spectra (Hann's window, 75 % overlap) of segments are averaged over tracks and,
/// as ν²S, which is flat for a road, over bands of a third of an octave, from the third bin to half the sampling rate.
///
/// # Errors
/// Tracks of different length; a segment longer than the profile or below eight points.
pub fn spectrum_of_profile(
    tracks: &[Vec<f64>],
    step_m: f64,
    segment_m: f64,
    per_octave: f64,
) -> Result<MeasuredSpectrum, SignalError> {
    let channel = |name: String| Channel {
        name,
        quantity: Quantity::Displacement,
        direction: Direction::PlusZ,
        place: Place::Hub,
        wheel: None,
        at_m: None,
    };
    let channels = (0..tracks.len()).map(|k| channel(format!("track {k}"))).collect();
    let level: Vec<Vec<f64>> = tracks.iter().map(|t| detrended(t)).collect();
    // metres stand for seconds: rates are per metre
    let recording = Recording::new(1.0 / step_m, None, Vec::new(), channels, level)?;
    let spectra = welch(&recording, &WelchSettings::hann(Segment::Seconds(segment_m)))?;
    let mean =
        |k: usize| (0..tracks.len()).map(|i| spectra.s[k][(i, i)].re).sum::<f64>() / tracks.len() as f64;
    let resolution = spectra.omega_rad_s[1];
    let mut found = MeasuredSpectrum {
        nu_rad_per_m: Vec::new(),
        s: Vec::new(),
        averages: Vec::new(),
        resolution_rad_per_m: resolution,
    };
    let last = spectra.s.len() - 1;
    let mut from = FIRST_BIN;
    while from < last {
        let edge = from as f64 * 2f64.powf(1.0 / per_octave);
        let to = (edge.round() as usize).clamp(from + 1, last);
        let count = (to - from) as f64;
        let nu = (from..to).map(|k| spectra.omega_rad_s[k].ln()).sum::<f64>() / count;
        let nu = nu.exp();
        let slope = (from..to).map(|k| spectra.omega_rad_s[k].powi(2) * mean(k)).sum::<f64>() / count;
        found.nu_rad_per_m.push(nu);
        found.s.push(slope / (nu * nu));
        found.averages.push(spectra.averages.max(count * spectra.likelihood_averages()));
        from = to;
    }
    Ok(found)
}

/// Less the line of least squares.
pub(crate) fn detrended(y: &[f64]) -> Vec<f64> {
    let n = y.len() as f64;
    let (middle, mean) = ((n - 1.0) / 2.0, y.iter().sum::<f64>() / n);
    let (mut xy, mut xx) = (0.0, 0.0);
    for (k, y) in y.iter().enumerate() {
        let x = k as f64 - middle;
        xy += x * (y - mean);
        xx += x * x;
    }
    let slope = if xx > 0.0 { xy / xx } else { 0.0 };
    y.iter().enumerate().map(|(k, y)| y - mean - slope * (k as f64 - middle)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::road::{Coherence, ProfileSettings, Road, Spectrum, random_profile};
    use crate::units::Convention;
    use std::f64::consts::PI;

    /// Spectrum → profile → spectrum, and the variance: a factor of 2 or π would show.
    #[test]
    fn a_random_profile_has_its_roads_spectrum_and_variance() {
        let band = [0.05, 30.0];
        let law = Spectrum::power_law(16e-6, 1.0, 2.0, band, Convention::OneSidedRadPerM).unwrap();
        let road = Road::new(law.clone(), Coherence::None);
        let settings =
            ProfileSettings { length_m: 20_000.0, step_m: 0.1, apart_m: Some(1.5), speed_m_s: 1.0, seed: 5 };
        let mut tracks = random_profile(&road, &settings).unwrap();
        for track in &mut tracks {
            for (k, y) in track.iter_mut().enumerate() {
                *y += 583.0 + 0.003 * k as f64;
            }
        }
        let found = spectrum_of_profile(&tracks, 0.1, 200.0, 3.0).unwrap();
        assert!(found.nu_rad_per_m.len() > 20);
        let mut squares = 0.0;
        for (k, nu) in found.nu_rad_per_m.iter().enumerate() {
            let off = (found.s[k] / law.psd(*nu, 1.0)).log10();
            // averages are of one track: two halve the variance
            let sd = 1.0 / (2.0 * found.averages[k]).sqrt() / 10f64.ln();
            if *nu < 25.0 {
                squares += (off / sd).powi(2) / found.nu_rad_per_m.len() as f64;
                assert!(off.abs() < 0.1, "{nu}: {off}");
            }
        }
        assert!((0.4..2.2).contains(&squares), "{squares}");
        // (1/π)∫S dν by trapezia in ln ν, against the same of the law
        let area = |s: &dyn Fn(usize) -> f64| {
            let nu = &found.nu_rad_per_m;
            (1..nu.len() - 1)
                .map(|k| 0.5 * (s(k) * nu[k] + s(k - 1) * nu[k - 1]) * (nu[k] / nu[k - 1]).ln() / PI)
                .sum::<f64>()
        };
        let (measured, known) = (area(&|k| found.s[k]), area(&|k| law.psd(found.nu_rad_per_m[k], 1.0)));
        assert!((measured / known - 1.0).abs() < 0.15, "{}", measured / known);
    }

    #[test]
    fn a_line_is_taken_off_and_wrong_segments_are_refused() {
        let line: Vec<f64> = (0..100).map(|k| 583.0 + 0.1 * f64::from(k)).collect();
        assert!(detrended(&line).iter().all(|y| y.abs() < 1e-11));
        assert!(spectrum_of_profile(std::slice::from_ref(&line), 0.1, 20.0, 3.0).is_err());
        assert!(spectrum_of_profile(&[line], 0.1, 0.3, 3.0).is_err());
    }
}
