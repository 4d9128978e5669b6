//! From the stabilisation diagram to modes: clusters of stable poles, and the reason of every pole left out.

use super::StabilitySettings;
use super::shape::{
    ShapeComponent, largest_one, mean_phase_deg, mean_phase_deviation_deg, modal_assurance as mac,
    phase_collinearity,
};
use super::stabilization::{Pole, PoleStatus, StabilizationDiagram, near_damping, near_frequency};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// A weaker cluster within so many tolerances of a mode, with its shape, at other orders, is that mode again.
const ECHO_TOLERANCES: f64 = 4.0;
/// The shape's criterion for that.
const ECHO_MAC: f64 = 0.8;
/// Two clusters that share at most this part of the weaker one's orders are one mode; more, and they are twins.
const ECHO_SHARED: f64 = 0.34;
/// A bump on a resonance has at most this part of its significance; another mode at the same place has more.
const PART_SIGNIFICANCE: f64 = 0.5;
/// Left-out poles of one reason further apart than this ratio are listed apart.
const LISTED_APART: f64 = 1.2;

/// A mode: one cluster of stable poles.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Mode {
    /// |λ|/2π in Hz: the median over the cluster.
    pub freq_hz: f64,
    /// −Re λ/|λ|: the median over the cluster.
    pub damping: f64,
    /// λ = 2πf(−ζ + i√(1 − ζ²)) in rad/s as [re, im].
    pub pole: [f64; 2],
    /// The shape of the pole nearest to the medians, its largest component 1, in the channels' units.
    pub shape: Vec<ShapeComponent>,
    /// At how many orders it was found.
    pub orders: usize,
    /// Median absolute deviation of the frequency over these orders: how well the orders agree, no confidence interval.
    pub freq_scatter_hz: f64,
    /// Median absolute deviation of the damping ratio over these orders.
    pub damping_scatter: f64,
    /// Standard deviations by which its part of the spectrum exceeds the spectrum's sampling error: the median.
    pub significance: f64,
    /// Modal phase collinearity of the shape at normalised channels: 1 for a real shape, 0 for a travelling wave.
    pub phase_collinearity: f64,
    /// Mean phase of the shape in degrees, against its largest component: see [`mean_phase_deg`].
    pub mean_phase_deg: f64,
    /// Mean phase deviation in degrees: see [`mean_phase_deviation_deg`].
    pub mean_phase_deviation_deg: f64,
    /// Standard deviation of the frequency, where the record has blocks enough to tell.
    pub freq_sd_hz: Option<f64>,
    /// Standard deviation of the damping ratio, likewise.
    pub damping_sd: Option<f64>,
}

/// A mode, and the poles of the diagram that it was made from.
pub(in crate::identify) struct Cluster {
    /// The mode.
    pub mode: Mode,
    /// Their positions among the diagram's poles, by order.
    pub members: Vec<usize>,
    /// The position of the pole nearest to their medians.
    pub middle: usize,
}

/// Poles that are no mode, and why.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Rejected {
    /// Their median |λ|/2π in Hz.
    pub freq_hz: f64,
    /// Their median −Re λ/|λ|.
    pub damping: f64,
    /// The reason in words, with its numbers.
    pub why: String,
    /// The reason for a program.
    pub reason: Reason,
    /// How many poles.
    pub poles: usize,
}

/// Why poles are left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Reason {
    /// Re λ ≥ 0.
    Growing,
    /// Re λ ≥ 0, the mirror image of a decaying pole in full spectra.
    Mirror,
    /// No oscillation.
    Real,
    /// Outside the band or near the Nyquist frequency.
    OutOfBand,
    /// At the lowest order, which has none before it.
    FirstOrder,
    /// Not found again at the order before.
    NotStable,
    /// Stable, but at too few orders.
    TooFewOrders,
    /// At enough orders, but not above the sampling error of the record's spectrum.
    Insignificant,
    /// A bump on a broader mode that is listed, with its shape.
    PartOfMode,
    /// A mode that is listed, seen at other orders with another bias.
    Echo,
    /// A peak that noise alone may leave in the spectrum (`fdd`).
    Noise,
    /// A peak narrower than any mode: a line (`fdd`).
    Line,
    /// A peak that is not the highest of its surroundings, or not of a resonance's form (`fdd`).
    NotAPeak,
    /// The shape at the peak does not hold over enough bins (`fdd`).
    NarrowDomain,
}

/// The modes and what is left out; `rms` of the channels restores the shapes' units.
pub(in crate::identify) fn modes(
    diagram: &StabilizationDiagram,
    rms: &[f64],
    settings: &StabilitySettings,
) -> (Vec<Cluster>, Vec<Rejected>) {
    let poles = &diagram.poles;
    let needed = ((settings.min_order_fraction * diagram.orders.len() as f64).ceil() as usize).max(2);
    let mut left: Vec<usize> = (0..poles.len()).filter(|k| poles[*k].stable()).collect();
    let mut clusters = Vec::new();
    while let Some(cluster) = strongest(poles, &left, settings) {
        left.retain(|k| !cluster.contains(k));
        clusters.push(cluster);
    }
    // the most significant first: a weaker one may turn out to be a part of it
    clusters.sort_by(|a, b| significance(poles, b).total_cmp(&significance(poles, a)));
    let (mut kept, mut rejected): (Vec<Vec<usize>>, Vec<Rejected>) = (Vec::new(), Vec::new());
    for cluster in clusters {
        match refused(poles, &cluster, &kept, needed, settings) {
            Some((reason, why)) => rejected.push(left_out(poles, &cluster, reason, why)),
            None => kept.push(cluster),
        }
    }
    let mut modes: Vec<Cluster> = kept
        .iter()
        .map(|c| Cluster {
            mode: mode(poles, c, rms),
            members: c.clone(),
            middle: c[nearest_to_medians(poles, c)],
        })
        .collect();
    modes.sort_by(|a, b| a.mode.freq_hz.total_cmp(&b.mode.freq_hz));
    rejected.extend(never_stable(poles));
    rejected.sort_by(|a, b| a.freq_hz.total_cmp(&b.freq_hz));
    (modes, rejected)
}

/// Of the poles `left`, the cluster with most orders: at each order the nearest pole within tolerance of its centre.
fn strongest(poles: &[Pole], left: &[usize], settings: &StabilitySettings) -> Option<Vec<usize>> {
    let around = |centre: usize| {
        let mut best: BTreeMap<usize, (f64, usize)> = BTreeMap::new();
        for &k in left {
            let (a, b) = (&poles[centre], &poles[k]);
            let near = near_frequency(a, b, settings) && near_damping(a, b, settings);
            if near && mac(&a.shape, &b.shape) >= settings.min_mac {
                let d = distance(a, b);
                let entry = best.entry(b.order).or_insert((d, k));
                if d < entry.0 {
                    *entry = (d, k);
                }
            }
        }
        best.into_values().map(|(_, k)| k).collect::<Vec<_>>()
    };
    let mut cluster: Vec<usize> = Vec::new();
    for &k in left {
        let candidate = around(k);
        if candidate.len() > cluster.len() {
            cluster = candidate;
        }
    }
    // once more around its own middle, which the densest pole need not be
    if let Some(&centre) = cluster.get(nearest_to_medians(poles, &cluster)) {
        let again = around(centre);
        if again.len() >= cluster.len() {
            cluster = again;
        }
    }
    if cluster.is_empty() { None } else { Some(cluster) }
}

/// |λ − λ'|/|λ|.
fn distance(a: &Pole, b: &Pole) -> f64 {
    (a.pole[0] - b.pole[0]).hypot(a.pole[1] - b.pole[1]) / (TAU * a.freq_hz)
}

/// Why a cluster of stable poles is no mode, beside the modes that are more significant.
fn refused(
    poles: &[Pole],
    cluster: &[usize],
    kept: &[Vec<usize>],
    needed: usize,
    settings: &StabilitySettings,
) -> Option<(Reason, String)> {
    for mode in kept {
        let f = median(mode.iter().map(|k| poles[*k].freq_hz));
        if is_echo(poles, cluster, mode, settings) {
            return Some((Reason::Echo, format!("the mode at {f:.4} Hz, seen at other orders")));
        }
        if is_part(poles, cluster, mode) {
            let why = format!("a part of the mode at {f:.4} Hz: in its half-power band, with its shape");
            return Some((Reason::PartOfMode, why));
        }
    }
    if cluster.len() < needed {
        let why = format!("stable at {} orders, {needed} are needed", cluster.len());
        return Some((Reason::TooFewOrders, why));
    }
    let (sigmas, least) = (significance(poles, cluster), settings.min_significance);
    let why =
        || format!("{sigmas:.1} standard deviations of the spectrum's sampling error, {least} are needed");
    (sigmas < least).then(|| (Reason::Insignificant, why()))
}

fn significance(poles: &[Pole], cluster: &[usize]) -> f64 {
    median(cluster.iter().map(|k| poles[*k].significance))
}

/// The same mode with another bias: near it, of its shape, and at other orders than it.
fn is_echo(poles: &[Pole], weak: &[usize], mode: &[usize], settings: &StabilitySettings) -> bool {
    let (w, m) = (centre(poles, weak), centre(poles, mode));
    let wide = StabilitySettings {
        frequency_tolerance: ECHO_TOLERANCES * settings.frequency_tolerance,
        damping_tolerance: ECHO_TOLERANCES * settings.damping_tolerance,
        damping_tolerance_relative: ECHO_TOLERANCES * settings.damping_tolerance_relative,
        ..settings.clone()
    };
    let at = |k: &usize| poles[*k].order;
    let shared = weak.iter().filter(|k| mode.iter().any(|j| at(j) == at(k))).count();
    near_frequency(w, m, &wide)
        && near_damping(w, m, &wide)
        && mac(&w.shape, &m.shape) >= ECHO_MAC
        && shared as f64 <= ECHO_SHARED * weak.len() as f64
}

/// A narrow bump that sampling left on a broader resonance: inside its half-power band, of its shape, much weaker.
fn is_part(poles: &[Pole], weak: &[usize], mode: &[usize]) -> bool {
    let (w, m) = (centre(poles, weak), centre(poles, mode));
    w.damping < m.damping
        && (w.freq_hz - m.freq_hz).abs() <= m.damping * m.freq_hz
        && mac(&w.shape, &m.shape) >= ECHO_MAC
        && significance(poles, weak) <= PART_SIGNIFICANCE * significance(poles, mode)
}

fn centre<'a>(poles: &'a [Pole], cluster: &[usize]) -> &'a Pole {
    &poles[cluster[nearest_to_medians(poles, cluster)]]
}

/// Position in `cluster` of the pole nearest to its medians.
fn nearest_to_medians(poles: &[Pole], cluster: &[usize]) -> usize {
    let f = median(cluster.iter().map(|k| poles[*k].freq_hz));
    let zeta = median(cluster.iter().map(|k| poles[*k].damping));
    let away = |k: usize| (poles[k].freq_hz / f - 1.0).hypot(poles[k].damping - zeta);
    (0..cluster.len()).min_by(|a, b| away(cluster[*a]).total_cmp(&away(cluster[*b]))).unwrap_or(0)
}

fn mode(poles: &[Pole], cluster: &[usize], rms: &[f64]) -> Mode {
    let f = || cluster.iter().map(|k| poles[*k].freq_hz);
    let zeta = || cluster.iter().map(|k| poles[*k].damping);
    let (freq_hz, damping) = (median(f()), median(zeta()));
    let nearest = centre(poles, cluster);
    let omega = TAU * freq_hz;
    let (shape, turned) = largest_one(&nearest.shape, rms);
    Mode {
        freq_hz,
        damping,
        pole: [-omega * damping, omega * (1.0 - damping * damping).max(0.0).sqrt()],
        shape,
        orders: cluster.len(),
        freq_scatter_hz: median(f().map(|x| (x - freq_hz).abs())),
        damping_scatter: median(zeta().map(|x| (x - damping).abs())),
        significance: significance(poles, cluster),
        phase_collinearity: phase_collinearity(&turned),
        mean_phase_deg: mean_phase_deg(&turned),
        mean_phase_deviation_deg: mean_phase_deviation_deg(&turned),
        freq_sd_hz: None,
        damping_sd: None,
    }
}

/// The poles that were never stable, by reason and place.
fn never_stable(poles: &[Pole]) -> Vec<Rejected> {
    let mut by_status: BTreeMap<PoleStatus, Vec<usize>> = BTreeMap::new();
    for (k, pole) in poles.iter().enumerate().filter(|p| !p.1.stable()) {
        by_status.entry(pole.status).or_default().push(k);
    }
    let mut rejected = Vec::new();
    for (status, mut members) in by_status {
        let reason = match status {
            PoleStatus::Stable => continue,
            PoleStatus::Growing => Reason::Growing,
            PoleStatus::Mirror => Reason::Mirror,
            PoleStatus::Real => Reason::Real,
            PoleStatus::OutOfBand => Reason::OutOfBand,
            PoleStatus::FirstOrder => Reason::FirstOrder,
            PoleStatus::NewFrequency | PoleStatus::NewDamping | PoleStatus::NewShape => Reason::NotStable,
        };
        members.sort_by(|a, b| poles[*a].freq_hz.total_cmp(&poles[*b].freq_hz));
        let apart = |a: &usize, b: &usize| poles[*b].freq_hz <= LISTED_APART * poles[*a].freq_hz;
        rejected.extend(
            members.chunk_by(apart).map(|run| left_out(poles, run, reason, status.words().to_owned())),
        );
    }
    rejected
}

fn left_out(poles: &[Pole], members: &[usize], reason: Reason, why: String) -> Rejected {
    Rejected {
        freq_hz: median(members.iter().map(|k| poles[*k].freq_hz)),
        damping: median(members.iter().map(|k| poles[*k].damping)),
        why,
        reason,
        poles: members.len(),
    }
}

pub(super) fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut v: Vec<f64> = values.collect();
    if v.is_empty() {
        return 0.0;
    }
    v.sort_by(f64::total_cmp);
    let half = v.len() / 2;
    if v.len() % 2 == 1 { v[half] } else { 0.5 * (v[half - 1] + v[half]) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pole(order: usize, f: f64, shape: [f64; 2], significance: f64) -> Pole {
        let (damping, omega) = (0.05, TAU * f);
        let shape = shape.map(|s| [s, 0.0]).to_vec();
        let pole = [-damping * omega, omega];
        Pole { order, freq_hz: f, damping, pole, shape, significance, status: PoleStatus::Stable }
    }

    fn frequencies(poles: Vec<Pole>) -> (Vec<f64>, Vec<Reason>) {
        let orders = (2..=40).step_by(2).collect();
        let diagram = StabilizationDiagram { orders, poles };
        let (modes, rejected) = modes(&diagram, &[1.0, 1.0], &StabilitySettings::default());
        (modes.iter().map(|m| m.mode.freq_hz).collect(), rejected.iter().map(|r| r.reason).collect())
    }

    #[test]
    fn a_mode_that_moves_with_the_order_is_one_mode() {
        let moved =
            |n: usize| if n <= 20 { pole(n, 5.0, [1.0, 0.5], 40.0) } else { pole(n, 5.2, [1.0, 0.5], 50.0) };
        let (found, why) = frequencies((2..=40).step_by(2).map(moved).collect());
        assert_eq!((found, why), (vec![5.2], vec![Reason::Echo]));
    }

    #[test]
    fn twins_at_the_same_orders_are_two_modes() {
        let twins = |n: usize| [pole(n, 5.0, [1.0, 1.0], 40.0), pole(n, 5.02, [1.0, -1.0], 10.0)];
        let (found, why) = frequencies((2..=40).step_by(2).flat_map(twins).collect());
        assert_eq!((found, why), (vec![5.0, 5.02], vec![]));
    }
}
