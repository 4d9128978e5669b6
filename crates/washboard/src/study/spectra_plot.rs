//! Measured and fitted spectra for tables and pages.

use super::identify::Task;
use super::identify_evidence::{ChannelSpectrum, PairSpectrum, SingularValues, SpectraPlot};
use crate::linalg::CMat;
use crate::signal::{Place, Quantity};
use crate::units::per_hz_from_two_sided;

/// Points of a plot: more do not fit on a page.
const MOST_BINS: usize = 800;

/// Spectra in the band; `fitted` are the model's at ascending frequencies that are bins.
pub(super) fn plot(task: &Task<'_>, fitted: Option<(&[f64], &[CMat])>) -> SpectraPlot {
    let s = &task.spectra;
    let inside = |k: &usize| match fitted {
        Some((freq, _)) => freq.first() <= Some(&s.freq_hz[*k]) && Some(&s.freq_hz[*k]) <= freq.last(),
        None => *k >= 1 && s.freq_hz[*k] >= task.band_hz[0] && s.freq_hz[*k] <= task.band_hz[1],
    };
    // a bin that rounding leaves out at the band's edge would shift the model against the data
    let bins: Vec<usize> = match fitted {
        Some((freq, _)) => freq
            .iter()
            .filter_map(|f| {
                (0..s.freq_hz.len())
                    .min_by(|a, b| (s.freq_hz[*a] - f).abs().total_cmp(&(s.freq_hz[*b] - f).abs()))
            })
            .collect(),
        None => (0..s.freq_hz.len()).filter(inside).collect(),
    };
    let stride = bins.len().div_ceil(MOST_BINS).max(1);
    let shown: Vec<(usize, usize)> = bins.iter().copied().enumerate().step_by(stride).collect();
    let model = |i: usize| fitted.map(|(_, m)| &m[i]);
    let channels = task.recording.channels();
    let auto = |c: usize| ChannelSpectrum {
        channel: channels[c].name.clone(),
        unit: format!("({})²/Hz", channels[c].quantity.si_unit().replace("^2", "²")),
        measured: shown.iter().map(|(_, k)| per_hz_from_two_sided(s.s[*k][(c, c)].re)).collect(),
        fitted: shown
            .iter()
            .filter_map(|(i, _)| model(*i).map(|m| per_hz_from_two_sided(m[(c, c)].re)))
            .collect(),
    };
    let cross = |(a, b): (usize, usize)| {
        let coherence = |m: &CMat| m[(a, b)].norm_sqr() / (m[(a, a)].re * m[(b, b)].re);
        let phase = |m: &CMat| m[(a, b)].im.atan2(m[(a, b)].re);
        PairSpectrum {
            first: channels[a].name.clone(),
            second: channels[b].name.clone(),
            coherence: shown.iter().map(|(_, k)| coherence(&s.s[*k])).collect(),
            fitted_coherence: shown.iter().filter_map(|(i, _)| model(*i).map(coherence)).collect(),
            phase_rad: shown.iter().map(|(_, k)| phase(&s.s[*k])).collect(),
            fitted_phase_rad: shown.iter().filter_map(|(i, _)| model(*i).map(phase)).collect(),
        }
    };
    SpectraPlot {
        confidence: confidence(s.averages),
        freq_hz: shown.iter().map(|(_, k)| s.freq_hz[*k]).collect(),
        channels: (0..channels.len()).map(auto).collect(),
        pairs: telling_pairs(task).into_iter().map(cross).collect(),
    }
}

/// What a measured density is to be multiplied by for the ends of its 95 % interval: 2K/χ² of 2K degrees of freedom at K
/// averages, χ² by Wilson and Hilferty's cube (Proc. Natl. Acad. Sci. 17 (1931) 684).
fn confidence(averages: f64) -> Option<[f64; 2]> {
    let share = 2.0 / (9.0 * 2.0 * averages);
    let chi2_over_freedom = |z: f64| (1.0 - share + z * share.sqrt()).powi(3);
    let (low, high) = (1.0 / chi2_over_freedom(1.96), 1.0 / chi2_over_freedom(-1.96));
    (high.is_finite() && high > low && low > 0.0).then_some([low, high])
}

/// Singular values of the spectra of channels scaled to an rms of 1, one-sided per Hz, in the band with some room.
pub(super) fn singular_values(task: &Task<'_>) -> Option<SingularValues> {
    let s = &task.spectra;
    let n = s.channels.len();
    let width = per_hz_from_two_sided(1.0) * s.resolution_hz();
    let power: Vec<f64> =
        (0..n).map(|i| s.s.iter().skip(1).map(|m| m[(i, i)].re).sum::<f64>() * width).collect();
    if power.iter().any(|p| !(*p > 0.0 && p.is_finite())) {
        return None;
    }
    let inside = |k: &usize| *k >= 1 && s.freq_hz[*k] >= task.band_hz[0] && s.freq_hz[*k] <= task.band_hz[1];
    let bins: Vec<usize> = (0..s.freq_hz.len()).filter(inside).collect();
    let stride = bins.len().div_ceil(MOST_BINS).max(1);
    let shown: Vec<usize> = bins.into_iter().step_by(stride).collect();
    let mut values = vec![Vec::with_capacity(shown.len()); n];
    for k in &shown {
        let scaled = CMat::from_fn(n, n, |i, j| s.s[*k][(i, j)] / (power[i] * power[j]).sqrt());
        let found = scaled.self_adjoint_eigenvalues(faer::Side::Lower).ok()?;
        for (curve, value) in values.iter_mut().zip(found.into_iter().rev()) {
            curve.push(per_hz_from_two_sided(value.max(0.0)));
        }
    }
    Some(SingularValues { freq_hz: shown.iter().map(|k| s.freq_hz[*k]).collect(), values })
}

/// Front against rear of one side, left against right of one axle, body above hub: the first of each, hubs preferred.
fn telling_pairs(task: &Task<'_>) -> Vec<(usize, usize)> {
    let (channels, wheels) = (task.recording.channels(), task.recording.wheels());
    let at = |c: usize| channels[c].wheel.map(|w| wheels[w].at_m);
    let alike = |a: usize, b: usize| {
        channels[a].place == channels[b].place && channels[a].quantity == channels[b].quantity
    };
    let mut order: Vec<usize> =
        (0..channels.len()).filter(|c| channels[*c].quantity != Quantity::AngularVelocity).collect();
    order.sort_by_key(|c| channels[*c].place != Place::Hub);
    let first = |test: &dyn Fn(usize, usize) -> bool| -> Option<(usize, usize)> {
        order.iter().flat_map(|a| order.iter().map(move |b| (*a, *b))).find(|(a, b)| a != b && test(*a, *b))
    };
    let front_rear = first(&|a, b| match (at(a), at(b)) {
        (Some(p), Some(q)) => alike(a, b) && p[0] > q[0] && (p[1] - q[1]).abs() < 0.3,
        _ => false,
    });
    let left_right = first(&|a, b| match (at(a), at(b)) {
        (Some(p), Some(q)) => alike(a, b) && (p[0] - q[0]).abs() < 0.3 && p[1] > q[1],
        _ => false,
    });
    let body_hub = first(&|a, b| {
        channels[a].wheel.is_some()
            && channels[a].wheel == channels[b].wheel
            && channels[a].place == Place::Body
            && channels[b].place == Place::Hub
    });
    let mut pairs: Vec<(usize, usize)> = [front_rear, left_right, body_hub].into_iter().flatten().collect();
    if pairs.is_empty() && channels.len() > 1 {
        pairs.push((0, 1));
    }
    pairs
}
