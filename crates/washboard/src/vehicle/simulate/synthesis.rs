//! A road as complex amplitudes at the frequencies of a period, and series from spectra.

use super::super::Vehicle;
use super::tracks::Tracks;
use super::transfer::Transfer;
use super::{DriveSettings, GUARD_S};
use crate::linalg::C64;
use crate::road::Road;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;
use realfft::RealFftPlanner;
use std::f64::consts::TAU;

/// A vehicle whose dampers have curves mixes frequencies: its road reaches up to this multiple of half the sampling rate.
const ROAD_REACH: usize = 4;

/// Points of the polynomial between samples: it reads what is below an eighth of half the sampling rate to 1e-12.
const POINTS: usize = 16;

/// The road of one drive.
pub(super) struct RoadInput<'a> {
    pub vehicle: &'a Vehicle,
    road: &'a Road,
    pub settings: DriveSettings,
    tracks: Tracks,
    /// Complex normal, one a frequency and track.
    throws: Vec<C64>,
    period: usize,
    bins: usize,
}

impl<'a> RoadInput<'a> {
    /// The throws of a drive of this many samples.
    pub fn new(vehicle: &'a Vehicle, road: &'a Road, settings: &DriveSettings, samples: usize) -> Self {
        let period = even_smooth(samples + (GUARD_S * settings.rate_hz).ceil() as usize);
        let step = TAU * settings.rate_hz / period as f64;
        let [_, high] = road.spectrum().band_rad_s(settings.speed_m_s);
        let mut bins = period / 2;
        if !vehicle.dampers().is_empty() {
            // more throws after those of a linear vehicle: the same seed is the same road
            bins = bins.max((high / step).ceil().min((ROAD_REACH * bins) as f64) as usize + 1);
        }
        let tracks = Tracks::new(vehicle, road, settings.speed_m_s);
        let mut rng = ChaCha8Rng::seed_from_u64(settings.seed);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let throws = (0..bins * tracks.count())
            .map(|_| C64::new(normal(), normal()) * std::f64::consts::FRAC_1_SQRT_2)
            .collect();
        RoadInput { vehicle, road, settings: *settings, tracks, throws, period, bins }
    }

    /// Samples in the period.
    pub fn period(&self) -> usize {
        self.period
    }

    /// Frequencies below half the sampling rate, 0 included; the one at half stays empty.
    pub fn recorded(&self) -> usize {
        self.period / 2
    }

    /// Frequencies of the road, 0 included.
    pub fn bins(&self) -> usize {
        self.bins
    }

    /// ω of frequency k.
    pub fn omega(&self, k: usize) -> f64 {
        TAU * self.settings.rate_hz / self.period as f64 * k as f64
    }

    /// Spectra of the linear vehicle's responses at the first `bins` frequencies.
    pub fn responses(&self, looks: &[(Vec<f64>, usize)], bins: usize) -> Vec<Vec<C64>> {
        let speed = self.settings.speed_m_s;
        let [low, high] = self.road.spectrum().band_rad_s(speed);
        let transfer = Transfer::new(self.vehicle, looks);
        let (width, tracks) = (looks.len(), self.tracks.count());
        let step = self.omega(1);
        let filled: Vec<Vec<C64>> = (0..bins)
            .into_par_iter()
            .map(|k| {
                let omega = step * k as f64;
                if k == 0 || omega < low || omega > high {
                    return Vec::new();
                }
                let size = (self.road.spectrum().psd(omega, speed) * step / TAU).sqrt();
                let z = &self.throws[k * tracks..(k + 1) * tracks];
                let inputs = self.tracks.wheel_inputs(self.road.coherence(), z, size, omega, speed);
                let h = transfer.at(omega);
                (0..width).map(|i| (0..inputs.len()).map(|j| h[(i, j)] * inputs[j]).sum()).collect()
            })
            .collect();
        let mut spectra = vec![vec![C64::new(0.0, 0.0); bins]; width];
        for (k, row) in filled.into_iter().enumerate() {
            for (i, value) in row.into_iter().enumerate() {
                spectra[i][k] = value;
            }
        }
        spectra
    }
}

/// x_n = Y_0 + 2 Re Σ_{k>0} Y_k e^{2πi kn/len}, with fewer frequencies than len/2.
pub(super) fn series(mut spectrum: Vec<C64>, len: usize) -> Vec<f64> {
    let inverse = RealFftPlanner::<f64>::new().plan_fft_inverse(len);
    spectrum.resize(len / 2 + 1, C64::new(0.0, 0.0));
    let mut out = inverse.make_output_vec();
    // lengths are the plan's own and bins 0 and len/2 are real, so it cannot refuse
    let _ = inverse.process(&mut spectrum, &mut out);
    out
}

/// The first `bins` frequencies of a periodic series, as [`series`] takes them.
pub(super) fn spectrum(mut data: Vec<f64>, bins: usize) -> Vec<C64> {
    let forward = RealFftPlanner::<f64>::new().plan_fft_forward(data.len());
    let mut out = forward.make_output_vec();
    let scale = 1.0 / data.len() as f64;
    // lengths are the plan's own
    let _ = forward.process(&mut data, &mut out);
    out.truncate(bins);
    out.iter_mut().for_each(|z| *z *= scale);
    out
}

/// A periodic series at a place between its samples: Lagrange's polynomial through the nearest ones, barycentric.
pub(super) fn between(x: &[f64], at: f64) -> f64 {
    let first = at.floor() - (POINTS / 2 - 1) as f64;
    let (mut above, mut below, mut weight) = (0.0, 0.0, 1.0);
    for j in 0..POINTS {
        let value = x[(first as isize + j as isize).rem_euclid(x.len() as isize) as usize];
        let distance = at - (first + j as f64);
        if distance == 0.0 {
            return value;
        }
        above += weight / distance * value;
        below += weight / distance;
        // (−1)^j times binomial coefficients
        weight *= -((POINTS - 1 - j) as f64) / (j + 1) as f64;
    }
    above / below
}

/// The next even number with no prime factor above 7.
fn even_smooth(at_least: usize) -> usize {
    let smooth = |mut n: usize| {
        for p in [2, 3, 5, 7] {
            while n.is_multiple_of(p) {
                n /= p;
            }
        }
        n == 1
    };
    (at_least.max(2)..).find(|n| n.is_multiple_of(2) && smooth(*n)).unwrap_or(at_least)
}
