//! Where a profile's spectrum has content: both ends of a road made with a band, or of a profile that was filtered, leave bands of leakage.

use super::identify_outcome::Flag;
use crate::road::MeasuredSpectrum;
use std::ops::Range;

/// A fall of the slope's density by more than this from one third of an octave to the next is the upper end of a profile's content.
const EMPTY_ABOVE: f64 = 30.0;
/// The same of the lower end, where bands are single bins and the window's main lobe fills the first empty one: measured 8 to 30 there.
const EMPTY_BELOW: f64 = 5.0;
/// Standard deviations of a ratio of two bands that are its averages' doing.
const SCATTER: f64 = 3.0;
/// ν²S may fall as this power of ν towards 0, as that of white heights does, and be a road's.
const POWER: f64 = 2.0;
/// A step has this many bands above it, an octave: a peak has not.
const AFTER: usize = 3;
/// Bands that are kept in any case.
const LEAST_BANDS: usize = 4;

/// The bands with content, and what is to be said of those without. The band next to an empty one goes too: the end lies in it, or
/// within the window's main lobe of it, and its density is about half of the road's.
pub(super) fn with_content(found: &MeasuredSpectrum) -> (Range<usize>, Vec<Flag>) {
    let slope: Vec<f64> = found.nu_rad_per_m.iter().zip(&found.s).map(|(nu, s)| s * nu * nu).collect();
    let mut notes = Vec::new();
    let mut note = |name: &str, text: String| notes.push(Flag { name: name.to_owned(), text });
    let mut to = slope.len();
    if let Some(k) = (LEAST_BANDS..slope.len()).find(|k| slope[*k] * EMPTY_ABOVE < slope[k - 1]) {
        to = (k - 1).max(LEAST_BANDS);
        let text = format!(
            "above {:.3} rad/m the profile has nothing but leakage (its slope's density falls by more than a factor {EMPTY_ABOVE:.0} from one band to the next), or is cut by its end: left out",
            found.nu_rad_per_m[to - 1]
        );
        note("empty-above", text);
    }
    let mut from = 0;
    let last = to.saturating_sub(LEAST_BANDS);
    if let Some(k) = (0..last).rev().find(|k| is_empty_up_to(*k, &slope[..to], found)) {
        from = (k + 2).min(last);
        let text = format!(
            "below {:.4} rad/m the profile has nothing but leakage (its slope's density rises by more than a factor {EMPTY_BELOW:.0}, and more than the scatter of its averages explains, from one band to the next), or is cut by its end: left out",
            found.nu_rad_per_m[from]
        );
        note("empty-below", text);
    }
    (from..to, notes)
}

/// Whether all bands up to this one are below each of the octave above it by more than a shape and the averages explain.
fn is_empty_up_to(k: usize, slope: &[f64], found: &MeasuredSpectrum) -> bool {
    let (nu, averages) = (&found.nu_rad_per_m, &found.averages);
    let highest = slope[..=k].iter().copied().fold(0.0, f64::max);
    let after = k + 1..(k + 1 + AFTER).min(slope.len());
    let least = slope[after].iter().copied().fold(f64::INFINITY, f64::min);
    let scatter = SCATTER * (1.0 / averages[k] + 1.0 / averages[k + 1]).sqrt();
    let shape = (nu[k + 1] / nu[k]).powf(POWER);
    least > highest * EMPTY_BELOW.max(shape * scatter.exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bands(slope: &[f64], averages: f64) -> MeasuredSpectrum {
        let nu: Vec<f64> = (0..slope.len()).map(|k| 0.05 * 2f64.powf(k as f64 / 3.0)).collect();
        MeasuredSpectrum {
            s: slope.iter().zip(&nu).map(|(g, nu)| g / (nu * nu)).collect(),
            averages: vec![averages; nu.len()],
            nu_rad_per_m: nu,
            resolution_rad_per_m: 0.0157,
        }
    }

    /// A step is an end, with the band that it lies in; a slope of white heights, a peak and the scatter of few averages are the road's.
    #[test]
    fn ends_are_told_from_slopes_and_peaks() {
        let of = |slope: &[f64], averages| {
            let (kept, notes) = with_content(&bands(slope, averages));
            (kept, notes.iter().map(|n| n.name.clone()).collect::<Vec<_>>())
        };
        let both = [0.01, 0.02, 0.5, 1.0, 1.0, 1.0, 1.0, 1.0, 0.5, 0.01, 0.01];
        assert_eq!(of(&both, 20.0), (3..8, vec!["empty-above".to_owned(), "empty-below".to_owned()]));
        let white: Vec<f64> = (0..12).map(|k| 2f64.powf(2.0 * f64::from(k) / 3.0)).collect();
        assert_eq!(of(&white, 1e4), (0..12, Vec::new()));
        let peak = [1.0, 1.0, 1.0, 1.0, 20.0, 8.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0];
        assert_eq!(of(&peak, 1e4), (0..12, Vec::new()));
        let low = [0.15, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0];
        assert_eq!((of(&low, 100.0).0, of(&low, 3.0).0), (2..9, 0..9));
    }
}
