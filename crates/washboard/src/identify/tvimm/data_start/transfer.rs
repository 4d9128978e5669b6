//! Every sensor's response to the front wheels' road, from spectra and the front hubs' minimum phase.

use super::NoDataStart;
use super::phase::minimum_phase;
use super::tracks::Tracks;
use crate::identify::likelihood::{BandData, Drive, Road, RoadValues};
use crate::linalg::{C64, CMat};
use crate::units::hz;
use std::f64::consts::TAU;

/// The exponent of a road that is not known.
pub(super) const EXPONENT: f64 = 2.0;
/// Hubs follow the road below this, Hz.
const FOLLOWS_HZ: f64 = 0.9;
/// The least number of bins that a level or a coherence is the median of.
const LEAST_BINS: usize = 5;
/// A hub's spectrum less its noise is at least this share of it.
const LEAST_SIGNAL: f64 = 0.05;
/// Hub pairs show μ in this band, Hz, where they are this coherent; they read 20–35 % low.
const MU_BAND_HZ: [f64; 2] = [0.6, 12.0];
const LEAST_COHERENCE: f64 = 0.05;
const HUBS_READ_LOW: f64 = 1.25;
/// μ is taken within these, and as this where the hubs do not show it.
const MU: [f64; 2] = [0.3, 30.0];
const MU_START: f64 = 4.0;

/// The responses T, by input (a track, or the sum and the difference of two over √2).
pub(super) struct Transfer {
    /// \[input\]\[sensor\]\[bin\]: displacement a road height under the front wheels, its delayed rear part included.
    pub response: Vec<Vec<Vec<C64>>>,
    /// The same in units of the sensors' spectra: by how much a response of 1 shows.
    pub shows: Vec<Vec<Vec<f64>>>,
    /// Phases of the front hubs, rad.
    #[cfg(test)]
    pub phases: Vec<Vec<f64>>,
    pub s0: f64,
    pub mu: f64,
}

impl Transfer {
    /// With S the spectra at all sensors and F the front hubs, in inputs k (two tracks: sum and difference):
    ///
    /// |t_k|² = S_F,kk/(S_d λ_k), λ = 1 ± Γ, arg t_k of minimum phase; conj(T_ik) = S_i,Fk/(S_d λ_k t_k)
    ///
    /// exact where the vehicle is symmetric. S_d λ_k is seen through the window as the spectra are. S₀ is such that the hubs
    /// follow the road in the first bins, μ what their coherence shows.
    pub fn new(
        data: &BandData,
        drive: Drive,
        derivatives: &[usize],
        tracks: &Tracks,
        front: &[usize],
    ) -> Result<Self, NoDataStart> {
        let (n, count, bins) = (derivatives.len(), tracks.count(), data.omega.len());
        let measured = data.measured.matrices(&vec![1.0; n]);
        let low = data.omega.iter().filter(|o| hz(**o) < FOLLOWS_HZ).count().max(LEAST_BINS).min(bins);
        // the hubs' spectra over inputs, less their noise
        let hub = |s: &CMat, k: usize| -> f64 {
            let raw = |noise: f64| -> f64 {
                (0..count)
                    .flat_map(|a| (0..count).map(move |b| (a, b)))
                    .map(|(a, b)| {
                        let floor = if a == b { noise * data.noise[front[a]] } else { 0.0 };
                        let scale = data.scale[front[a]] * data.scale[front[b]];
                        tracks.share(a, k) * tracks.share(b, k) * (s[(front[a], front[b])].re - floor) * scale
                    })
                    .sum()
            };
            raw(1.0).max(LEAST_SIGNAL * raw(0.0))
        };
        let mu = if count == 2 {
            // −ln Re γ = μWω/2πV
            let mut values: Vec<f64> = (0..bins)
                .filter(|bin| (MU_BAND_HZ[0]..=MU_BAND_HZ[1]).contains(&hz(data.omega[*bin])))
                .filter_map(|bin| {
                    let (s, [a, b]) = (&measured[bin], [front[0], front[1]]);
                    let gamma = s[(a, b)].re / (s[(a, a)].re * s[(b, b)].re).sqrt();
                    let way = tracks.width_m * data.omega[bin] / (TAU * drive.speed_m_s);
                    (gamma > LEAST_COHERENCE).then(|| -gamma.ln() / way)
                })
                .collect();
            let found = HUBS_READ_LOW * median(&mut values);
            if found.is_finite() { found.clamp(MU[0], MU[1]) } else { MU_START }
        } else {
            0.0
        };
        // the road's spectrum for S₀ = 1 in input k, weighted by two sensors and seen through the window
        let at_m = [[0.0, 0.0], [0.0, tracks.width_m]];
        let values = RoadValues { ln_s0: 0.0, exponent: EXPONENT, mu, ln_delay: 0.0 };
        let road = Road::new(drive, values, &at_m[..count]);
        let weight = |omega: f64, i: usize| C64::new(0.0, omega).powu(derivatives[i] as u32);
        let [from, last] = data.grid();
        let level: Vec<Vec<f64>> = (from..=last)
            .map(|index| {
                let omega = data.half_omega(index);
                let mut s = vec![C64::new(0.0, 0.0); count * count];
                if omega > 0.0 {
                    road.fill(omega, &mut s);
                }
                (0..count)
                    .map(|k| {
                        s[0].re
                            + if k == 0 { 1.0 } else { -1.0 } * s[1 % s.len()].re * f64::from(count as u8 - 1)
                    })
                    .collect()
            })
            .collect();
        let seen = |bin: usize, k: usize, i: usize, j: usize| -> C64 {
            let (middle, half) = (2 * (data.first + bin) as i64, data.kernel.len() as i64 / 2);
            data.kernel
                .iter()
                .enumerate()
                .map(|(offset, share)| {
                    let index = middle + offset as i64 - half;
                    let omega = data.half_omega(index.unsigned_abs() as usize);
                    let z: C64 = weight(omega, i).conj() * weight(omega, j);
                    let z = if index < 0 { z.conj() } else { z };
                    z * level[index.unsigned_abs() as usize - from][k] * *share
                })
                .sum()
        };
        let gains: Vec<Vec<f64>> = (0..count)
            .map(|k| {
                (0..bins).map(|bin| hub(&measured[bin], k) / seen(bin, k, front[0], front[0]).re).collect()
            })
            .collect();
        let s0 = median(&mut gains[0][..low].to_vec());
        if !(s0 > 0.0 && s0.is_finite()) {
            return Err(NoDataStart::NoSignal);
        }
        let ln: Vec<Vec<f64>> =
            gains.iter().map(|g| g.iter().map(|g| 0.5 * (g / s0).ln()).collect()).collect();
        let phases: Vec<Vec<f64>> = ln.iter().map(|a| minimum_phase(&data.omega, a)).collect();
        let (mut response, mut shows) = (Vec::new(), Vec::new());
        for k in 0..count {
            let t: Vec<C64> =
                ln[k].iter().zip(&phases[k]).map(|(a, phase)| C64::new(*a, *phase).exp()).collect();
            let mut of_input = Vec::new();
            let mut weights = Vec::new();
            for i in 0..n {
                let value = |bin: usize| -> C64 {
                    let s = &measured[bin];
                    let cross: C64 = (0..count)
                        .map(|a| {
                            let floor = if front[a] == i { data.noise[i] } else { 0.0 };
                            (s[(i, front[a])] - floor)
                                * (tracks.share(a, k) * data.scale[i] * data.scale[front[a]])
                        })
                        .sum();
                    (cross / (seen(bin, k, i, front[0]) * t[bin] * s0)).conj()
                };
                of_input.push((0..bins).map(value).collect());
                let shown = |bin: usize| {
                    (seen(bin, k, i, i).re * s0 / measured[bin][(i, i)].re).sqrt() / data.scale[i]
                };
                weights.push((0..bins).map(shown).collect());
            }
            response.push(of_input);
            shows.push(weights);
        }
        Ok(Transfer {
            response,
            shows,
            #[cfg(test)]
            phases,
            s0,
            mu,
        })
    }
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}
