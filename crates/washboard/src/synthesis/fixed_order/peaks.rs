//! Where a loop's responses are the largest: looked for at its poles' frequencies, between them and at the ends, then
//! climbed.

use super::resolvent::Resolvent;
use super::targets::Channel;
use crate::linalg::{C64, CMat};
use crate::lti::norms::peak::{Gain, largest_singular_value};
use std::sync::Arc;

/// Peaks count that are within this of the highest, in ln.
const NEAR: f64 = 0.4;
/// Peaks are climbed that are within this of the highest, in ln; others count as they were met.
const CLIMBED: f64 = 0.15;
/// A bound farther below its limit than this, in ln, is looked at at its highest place alone.
const ROOM: f64 = 0.4;
/// A climb ends where it gains less than this share.
const LEVEL: f64 = 1e-9;
/// Peaks of one channel at most.
const MOST: usize = 8;
/// Places beside the peaks that are as high, within this in ln: a flat top has no peaks.
const FLAT: f64 = 0.02;
/// These at most.
const MOST_FLAT: usize = 4;
/// Singular values within this share of the largest count.
const COALESCED: f64 = 0.97;
/// Frequencies farther apart than this factor get others between.
const WIDE: f64 = 1.6;

/// A place on a channel's response, with a direction.
#[derive(Debug, Clone)]
pub(super) struct Peak {
    pub omega: f64,
    /// As long as all outputs, weights in it.
    pub u: Vec<C64>,
    /// As long as all disturbances.
    pub v: Vec<C64>,
}

/// Of each channel (target, channel, ln of its unit, whether that is a bound) the places that matter. None where a pole stands on the axis.
pub(super) fn find(
    resolvent: &mut Resolvent,
    channels: &[(usize, &Channel, f64, bool)],
    poles: &[C64],
    more: &[f64],
) -> Option<Vec<(usize, Vec<Arc<Peak>>)>> {
    let omegas = places(poles, more);
    let mut t = Vec::new();
    let mut heights = vec![vec![0.0; omegas.len()]; channels.len()];
    let m = resolvent.disturbances();
    for (k, omega) in omegas.iter().enumerate() {
        if !resolvent.response(*omega, &mut t) {
            return None;
        }
        for (c, (_, channel, unit, _)) in channels.iter().enumerate() {
            heights[c][k] = gain(&t, m, channel).ln() - unit;
        }
    }
    if heights.iter().flatten().any(|h| h.is_nan() || *h == f64::INFINITY) {
        return None;
    }
    let mut found = Vec::new();
    for (c, (target, channel, unit, is_bound)) in channels.iter().enumerate() {
        let h = &heights[c];
        // a bound counts near its limit, a goal near the highest
        let own = h.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if own == f64::NEG_INFINITY {
            // nothing comes through: no place is higher than another, and there is nothing to lower
            found.push((*target, Vec::new()));
            continue;
        }
        let enough = own - NEAR;
        let mut tops: Vec<usize> = (0..h.len())
            .filter(|k| {
                h[*k] >= enough && (*k == 0 || h[*k] >= h[k - 1]) && (*k + 1 == h.len() || h[*k] > h[k + 1])
            })
            .collect();
        tops.sort_by(|a, b| h[*b].total_cmp(&h[*a]));
        // far below its limit a bound needs no more than to be seen
        let seen = *is_bound && own < -ROOM;
        tops.truncate(if seen { 1 } else { MOST });
        let mut places: Vec<(f64, f64)> = Vec::new();
        for k in &tops {
            let as_met = seen || h[*k] < own - CLIMBED;
            places.push(if as_met {
                (omegas[*k], (h[*k] + unit).exp())
            } else {
                climb(resolvent, channel, m, &omegas, *k)
            });
        }
        let highest = places.iter().map(|p| p.1).fold(f64::NEG_INFINITY, f64::max);
        let mut flat: Vec<usize> = (0..h.len())
            .filter(|k| {
                let value = (h[*k] + unit).exp();
                value >= highest * (-FLAT).exp() && !places.iter().any(|(w, _)| near(*w, omegas[*k]))
            })
            .collect();
        flat.sort_by(|a, b| h[*b].total_cmp(&h[*a]));
        flat.truncate(MOST_FLAT);
        places.extend(flat.iter().map(|k| (omegas[*k], 0.0)));
        let mut peaks = Vec::new();
        for (omega, _) in places {
            if !resolvent.response(omega, &mut t) {
                continue;
            }
            directions(&t, omega, channel, resolvent.outputs(), m, &mut peaks);
        }
        found.push((*target, peaks));
    }
    Some(found)
}

fn near(a: f64, b: f64) -> bool {
    a == b || (a > 0.0 && b > 0.0 && a.is_finite() && b.is_finite() && (a / b).ln().abs() < 0.02)
}

/// A channel's largest singular value: of one output the length of its row.
fn gain(t: &[C64], m: usize, channel: &Channel) -> f64 {
    if let [(row, weight)] = channel.outputs[..] {
        let row = &t[row * m..(row + 1) * m];
        let squared: f64 = if channel.disturbances.is_empty() {
            row.iter().map(|z| z.norm_sqr()).sum()
        } else {
            channel.disturbances.iter().map(|j| row[*j].norm_sqr()).sum()
        };
        return weight * squared.sqrt();
    }
    largest_singular_value(&part(t, m, channel))
}

/// A channel's part of a response, weighted.
fn part(t: &[C64], m: usize, channel: &Channel) -> CMat {
    let columns = if channel.disturbances.is_empty() { m } else { channel.disturbances.len() };
    let column = |j: usize| if channel.disturbances.is_empty() { j } else { channel.disturbances[j] };
    CMat::from_fn(channel.outputs.len(), columns, |i, j| {
        let (row, weight) = channel.outputs[i];
        t[row * m + column(j)] * weight
    })
}

/// Frequencies worth a look, ascending: 0, the poles' and others between them, ∞.
fn places(poles: &[C64], more: &[f64]) -> Vec<f64> {
    let mut at: Vec<f64> = Vec::new();
    for p in poles.iter().filter(|p| p.im >= 0.0) {
        at.push(p.norm());
        if p.im > 0.0 {
            at.push(p.im);
            // where 1/|s² + 2ζωs + ω²| is the largest
            let peak = p.im * p.im - p.re * p.re;
            if peak > 0.0 {
                at.push(peak.sqrt());
            }
        }
    }
    at.extend_from_slice(more);
    at.retain(|w| *w > 0.0 && w.is_finite());
    at.sort_by(f64::total_cmp);
    at.dedup_by(|a, b| (*a - *b).abs() <= 1e-9 * *b);
    let mut all = vec![0.0];
    if let (Some(low), Some(high)) = (at.first().copied(), at.last().copied()) {
        all.extend([0.03 * low, 0.1 * low, 0.3 * low]);
        for (k, w) in at.iter().enumerate() {
            all.push(*w);
            if let Some(next) = at.get(k + 1) {
                let ratio = next / w;
                if ratio > 1.02 {
                    let parts = (ratio.ln() / WIDE.ln()).ceil().clamp(2.0, 8.0);
                    let step = ratio.powf(1.0 / parts);
                    all.extend((1..parts as usize).map(|i| w * step.powi(i as i32)));
                }
            }
        }
        all.extend([3.0 * high, 10.0 * high, 30.0 * high]);
    }
    all.push(f64::INFINITY);
    all
}

/// From a place that stands above its neighbours to the peak: frequency and height.
fn climb(resolvent: &mut Resolvent, channel: &Channel, m: usize, omegas: &[f64], k: usize) -> (f64, f64) {
    let cell = std::cell::RefCell::new((resolvent, Vec::new()));
    let mut along = Gain::new(|w: f64| {
        let (resolvent, t) = &mut *cell.borrow_mut();
        if resolvent.response(w, t) {
            Ok(gain(t, m, channel))
        } else {
            let why = "a pole stands there";
            Err(crate::linalg::LinalgError::Singular { what: "G(s)", why, value: w }.into())
        }
    });
    along.flat = LEVEL;
    let here = (omegas[k], along.at(omegas[k]));
    if k == 0 || k + 1 == omegas.len() {
        return here;
    }
    let high = if omegas[k + 1].is_finite() { omegas[k + 1] } else { 10.0 * omegas[k] };
    along.climb(omegas[k - 1], here, high, 0.0)
}

/// The direction of one output's response: its own row's.
fn along_the_row(t: &[C64], omega: f64, channel: &Channel, outputs: usize, inputs: usize) -> Option<Peak> {
    let (row, weight) = channel.outputs[0];
    let t = &t[row * inputs..(row + 1) * inputs];
    let all: Vec<usize>;
    let columns = if channel.disturbances.is_empty() {
        all = (0..inputs).collect();
        &all
    } else {
        &channel.disturbances
    };
    let length = columns.iter().map(|j| t[*j].norm_sqr()).sum::<f64>().sqrt();
    if !(length > 0.0) {
        return None;
    }
    let mut u = vec![C64::new(0.0, 0.0); outputs];
    let mut v = vec![C64::new(0.0, 0.0); inputs];
    u[row] = C64::new(weight, 0.0);
    columns.iter().for_each(|j| v[*j] = t[*j].conj() / length);
    Some(Peak { omega, u, v })
}

/// The largest singular values' directions, and mixtures of those that are alike.
fn directions(
    t: &[C64],
    omega: f64,
    channel: &Channel,
    outputs: usize,
    inputs: usize,
    out: &mut Vec<Arc<Peak>>,
) {
    if channel.outputs.len() == 1 {
        out.extend(along_the_row(t, omega, channel, outputs, inputs).map(Arc::new));
        return;
    }
    let g = part(t, inputs, channel);
    let Ok(svd) = g.thin_svd() else { return };
    let (u, v, s) = (svd.U(), svd.V(), svd.S().column_vector());
    let count = s.nrows();
    if count == 0 || !(s[0].re > 0.0) {
        return;
    }
    let mut push = |weights: &[(usize, C64)]| {
        let mut full_u = vec![C64::new(0.0, 0.0); outputs];
        let mut full_v = vec![C64::new(0.0, 0.0); inputs];
        for (k, z) in weights {
            for (i, (row, weight)) in channel.outputs.iter().enumerate() {
                full_u[*row] += u[(i, *k)] * *z * *weight;
            }
            for j in 0..v.nrows() {
                let column = if channel.disturbances.is_empty() { j } else { channel.disturbances[j] };
                full_v[column] += v[(j, *k)] * *z;
            }
        }
        out.push(Arc::new(Peak { omega, u: full_u, v: full_v }));
    };
    let one = C64::new(1.0, 0.0);
    push(&[(0, one)]);
    let half = std::f64::consts::FRAC_1_SQRT_2;
    for k in 1..count.min(4) {
        if s[k].re < COALESCED * s[0].re {
            break;
        }
        push(&[(k, one)]);
        for z in [C64::new(half, 0.0), C64::new(-half, 0.0), C64::new(0.0, half), C64::new(0.0, -half)] {
            push(&[(0, C64::new(half, 0.0)), (k, z)]);
        }
    }
}
