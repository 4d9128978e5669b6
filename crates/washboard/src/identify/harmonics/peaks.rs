//! Peaks of averaged spectra above their local floor, and how sharp each is.

use super::{Family, Line, LineSettings};

/// Bins beside a peak that the window's main lobe reaches: Hann's is two, a wandering line's one more.
const LOBE_BINS: usize = 3;
/// The floor is taken from at least so many bins on either side …
const FLOOR_BINS: usize = 12;
/// … or from this part of the peak's frequency.
const FLOOR_PART: f64 = 0.2;
/// A sharp peak is at most so wide at half power …
const SHARP_BINS: f64 = 5.0;
/// … or as a mode of this damping, whichever is more.
const SHARP_DAMPING: f64 = 0.02;
/// A mode's fall is looked at this many half-power half-widths beside its peak, or beyond the window's lobe.
const DROP_WIDTHS: f64 = 3.0;

/// A local maximum of the spectra over their floor.
#[derive(Debug, Clone)]
pub(super) struct Peak {
    pub freq_hz: f64,
    pub ratio: f64,
    /// Narrow enough to be a member of a family.
    pub sharp: bool,
    channels: Vec<usize>,
    width_hz: f64,
    drop: f64,
    mode_drop: f64,
}

impl Peak {
    /// Narrower than the least damped mode.
    pub fn narrow(&self) -> bool {
        self.drop > self.mode_drop
    }

    pub fn into_line(self, family: Option<Family>) -> Line {
        let Peak { freq_hz, ratio, channels, width_hz, drop, mode_drop, .. } = self;
        Line { freq_hz, channels, ratio, width_hz, drop, mode_drop, family }
    }
}

/// The peaks, by ascending frequency.
pub(super) fn peaks(freq_hz: &[f64], psd: &[Vec<f64>], averages: f64, settings: &LineSettings) -> Vec<Peak> {
    let (bins, bin_hz) = (freq_hz.len(), freq_hz[1] - freq_hz[0]);
    // a median lies below the mean of χ²
    let median_of_mean = (1.0 - 1.0 / (9.0 * averages)).powi(3);
    let ratios: Vec<Vec<f64>> = psd
        .iter()
        .map(|g| (0..bins).map(|k| g[k] / floor(g, k, freq_hz[k], bin_hz) * median_of_mean).collect())
        .collect();
    let tests = (bins * psd.len()).max(1) as f64;
    let chance = quantile(settings.false_alarm / tests, averages);
    let threshold = chance.max(settings.min_ratio);
    let largest: Vec<f64> = (0..bins).map(|k| ratios.iter().fold(0.0f64, |m, r| m.max(r[k]))).collect();
    let mut found = Vec::new();
    for k in LOBE_BINS + 1..bins.saturating_sub(LOBE_BINS + 1) {
        let around = &largest[k - LOBE_BINS..=k + LOBE_BINS];
        if largest[k] < threshold || around.iter().any(|v| *v > largest[k]) {
            continue;
        }
        // where the line wanders, another channel may peak a bin aside
        let near = |r: &Vec<f64>| r[k - 1].max(r[k]).max(r[k + 1]);
        let mut channels: Vec<usize> = (0..psd.len()).filter(|c| near(&ratios[*c]) >= threshold).collect();
        channels.sort_by(|a, b| ratios[*b][k].total_cmp(&ratios[*a][k]));
        let Some(&clearest) = channels.first() else { continue };
        let g = &psd[clearest];
        let weigh = |f: &dyn Fn(usize) -> f64| -> f64 { (k - 2..=k + 2).map(f).sum() };
        let centre = weigh(&|i| freq_hz[i] * largest[i]) / weigh(&|i| largest[i]);
        let width_hz = half_power_width(g, k) * bin_hz;
        let sharp = width_hz <= (SHARP_BINS * bin_hz).max(2.0 * SHARP_DAMPING * centre);
        let (drop, theory) = drop_beside(g, k, centre, bin_hz, settings.least_mode_damping);
        found.push(Peak {
            freq_hz: centre,
            ratio: largest[k],
            sharp,
            channels,
            width_hz,
            drop,
            mode_drop: theory * chance,
        });
    }
    found
}

/// Geometric mean of the medians left and right of a bin: a slope or a skirt leaves it alone.
fn floor(g: &[f64], k: usize, freq_hz: f64, bin_hz: f64) -> f64 {
    let reach = FLOOR_BINS.max((FLOOR_PART * freq_hz / bin_hz) as usize);
    let median = |range: std::ops::Range<usize>| {
        let mut v = g[range].to_vec();
        v.sort_by(f64::total_cmp);
        v.get(v.len() / 2).copied()
    };
    // bin 0 is the mean, not noise
    let left = k.saturating_sub(reach).max(1)..k.saturating_sub(LOBE_BINS).max(1);
    let right = (k + LOBE_BINS + 1).min(g.len())..(k + reach + 1).min(g.len());
    let enough = |r: &std::ops::Range<usize>| r.len() >= LOBE_BINS;
    let sides = [left, right].map(|r| if enough(&r) { median(r) } else { None });
    let floor = match sides {
        [Some(a), Some(b)] => (a * b).sqrt(),
        [Some(a), None] | [None, Some(a)] => a,
        [None, None] => f64::INFINITY,
    };
    floor.max(f64::MIN_POSITIVE)
}

/// Width in bins where the peak falls to one half, interpolated.
fn half_power_width(g: &[f64], k: usize) -> f64 {
    let half = 0.5 * g[k];
    let side = |step: isize| {
        let (mut at, mut before) = (k as isize, g[k]);
        loop {
            at += step;
            let Some(&here) = usize::try_from(at).ok().and_then(|i| g.get(i)) else {
                return (at - k as isize).abs() as f64;
            };
            if here <= half {
                let part = (before - half) / (before - here).max(f64::MIN_POSITIVE);
                return ((at - step - k as isize).abs() as f64) + part;
            }
            before = here;
        }
    };
    side(1) + side(-1)
}

/// Power at the peak over the larger mean of three bins at d Hz beside it; and what a mode would have there:
/// 1 + (d/ζf)² at the nearest of these bins' far edge.
fn drop_beside(g: &[f64], k: usize, freq_hz: f64, bin_hz: f64, least_damping: f64) -> (f64, f64) {
    let half_width = least_damping * freq_hz;
    let away = ((DROP_WIDTHS * half_width / bin_hz).ceil() as usize).max(LOBE_BINS + 1);
    let mean = |centre: Option<usize>| {
        let centre = centre.filter(|c| *c >= 1 && c + 1 < g.len())?;
        Some(g[centre - 1..=centre + 1].iter().sum::<f64>() / 3.0)
    };
    let beside = [mean(k.checked_sub(away)), mean(k.checked_add(away))];
    let beside = beside.into_iter().flatten().fold(f64::MIN_POSITIVE, f64::max);
    let edge = (away + 1) as f64 * bin_hz / half_width;
    (g[k] / beside, 1.0 + edge * edge)
}

/// x with P(χ²_{2K}/2K > x) = p, by Wilson and Hilferty.
fn quantile(p: f64, averages: f64) -> f64 {
    let c = 1.0 / (9.0 * averages);
    (1.0 - c + normal_quantile(p) * c.sqrt()).powi(3)
}

/// z with P(N(0, 1) > z) = p, p ≤ ½, to 4.5e-4: Abramowitz and Stegun 26.2.23.
fn normal_quantile(p: f64) -> f64 {
    let t = (-2.0 * p.min(0.5).ln()).sqrt();
    let up = 2.515_517 + t * (0.802_853 + t * 0.010_328);
    t - up / (1.0 + t * (1.432_788 + t * (0.189_269 + t * 0.001_308)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_tables() {
        assert!((normal_quantile(0.025) - 1.959_964).abs() < 5e-4);
        assert!((normal_quantile(1e-6) - 4.753_424).abs() < 5e-4);
        // χ²₂₀: 37.566 at 1 %, 45.315 at 0.1 %
        assert!((quantile(0.01, 10.0) * 20.0 - 37.566).abs() < 0.1);
        assert!((quantile(0.001, 10.0) * 20.0 - 45.315).abs() < 0.2);
    }

    #[test]
    fn a_slope_is_its_own_floor() {
        let g: Vec<f64> = (0..400).map(|k| (1.0 + k as f64).powi(-4)).collect();
        for k in 20..380 {
            let ratio = g[k] / floor(&g, k, 0.1 * k as f64, 0.1);
            assert!((0.4..1.3).contains(&ratio), "bin {k}: {ratio}");
        }
    }

    #[test]
    fn a_resonance_curve_has_its_half_power_width_and_its_drop() {
        let (f0, zeta, bin) = (10.0, 0.02, 0.05);
        let curve = |f: f64| 1.0 / (1.0 + ((f - f0) / (zeta * f0)).powi(2));
        let g: Vec<f64> = (0..400).map(|k| curve(bin * f64::from(k))).collect();
        assert!((half_power_width(&g, 200) * bin - 2.0 * zeta * f0).abs() < 0.01);
        let (drop, theory) = drop_beside(&g, 200, f0, bin, zeta);
        assert!(drop < theory && drop > 0.7 * theory, "{drop} of {theory}");
    }
}
