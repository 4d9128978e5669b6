//! A drive as a test engineer would record it: a Gaussian road under exact delays, the exact response, imperfect sensors.

use super::driven::sources;
use super::{Ride, RideError, Vehicle, VehicleError};
use crate::linalg::{C64, CMat};
use crate::lti::ModalForm;
use crate::road::{Coherence, Road};
use crate::signal::{Channel, Recording, SignalError, WheelPlace};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;
use realfft::RealFftPlanner;
use std::f64::consts::TAU;
use thiserror::Error;

/// The synthesised drive is longer than the recorded one by this many s: it is periodic, and its ends must not know each
/// other. Vehicles forget in a few seconds.
const GUARD_S: f64 = 20.0;
/// The largest number of samples in all channels that one drive may have.
const MAX_SAMPLES: f64 = 2e9 / 8.0;

/// What is refused of a drive.
#[derive(Debug, Error)]
pub enum SimulateError {
    /// A setting has a value that it cannot have.
    #[error("{field}: expected {expected}, found {found}")]
    Setting {
        /// Which.
        field: &'static str,
        /// What it should be.
        expected: &'static str,
        /// What it is.
        found: String,
    },
    /// A response that is infinite on this road cannot be recorded.
    #[error("channel `{channel}` has no stationary response on this road: {why}")]
    Infinite {
        /// The channel.
        channel: String,
        /// Why.
        why: String,
    },
    /// The vehicle cannot ride.
    #[error(transparent)]
    Ride(#[from] RideError),
    /// A sensor's place is none.
    #[error(transparent)]
    Vehicle(#[from] VehicleError),
    /// The recording is impossible.
    #[error(transparent)]
    Signal(#[from] SignalError),
}

/// What a sensor does besides measuring.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Flaws {
    /// White noise, as a multiple of the channel's own rms.
    pub noise_ratio: f64,
    /// A constant, in the channel's unit.
    pub bias: f64,
    /// Values beyond ± this are held there.
    pub clip: Option<f64>,
    /// Values are rounded to multiples of this.
    pub quantum: Option<f64>,
}

/// How long, how fast, how often, and which throw of the dice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DriveSettings {
    /// V.
    pub speed_m_s: f64,
    /// T.
    pub duration_s: f64,
    /// Samples per second.
    pub rate_hz: f64,
    /// Same seed, same drive, on any number of threads.
    pub seed: u64,
}

/// A drive, with what no recording tells.
#[derive(Debug, Clone, PartialEq)]
pub struct Drive {
    /// As it was recorded.
    pub recording: Recording,
    /// rms of the noise that each sensor added, in its channel's unit.
    pub noise_rms: Vec<f64>,
}

/// Records a drive: see [`drive`].
///
/// # Errors
/// As [`drive`].
pub fn simulate(
    vehicle: &Vehicle,
    road: &Road,
    sensors: &[(Channel, Flaws)],
    settings: &DriveSettings,
) -> Result<Recording, SimulateError> {
    Ok(drive(vehicle, road, sensors, settings)?.recording)
}

/// Records a drive, and keeps what its sensors added.
///
/// Every frequency k/T' of a period T' longer than the drive carries complex normal amplitudes with
/// E\[X_a* X_b\] = Γ_ab S(ω) Δω/2π for tracks a, b; a wheel's input is its track's times e^{−iωδ}, and a channel is
/// (iω)^d H(ω) times that: no step size, no rounding of delays to samples. Above half the sampling rate nothing is
/// synthesised, as if behind an ideal anti-aliasing filter.
///
/// # Errors
/// Settings that are not positive, a channel that the model does not have or whose response is infinite on this road.
pub fn drive(
    vehicle: &Vehicle,
    road: &Road,
    sensors: &[(Channel, Flaws)],
    settings: &DriveSettings,
) -> Result<Drive, SimulateError> {
    for (field, value) in [
        ("speed_m_s", settings.speed_m_s),
        ("duration_s", settings.duration_s),
        ("rate_hz", settings.rate_hz),
    ] {
        if !(value.is_finite() && value > 0.0) {
            return Err(SimulateError::Setting {
                field,
                expected: "a positive number",
                found: value.to_string(),
            });
        }
    }
    let samples = settings.duration_s * settings.rate_hz;
    // what is synthesised counts, not only what is kept
    let made = samples + GUARD_S * settings.rate_hz;
    if !(samples >= 2.0 && made <= MAX_SAMPLES / sensors.len().max(1) as f64) {
        let found = format!("{samples} samples in each of {} channels", sensors.len());
        return Err(SimulateError::Setting {
            field: "duration_s",
            expected: "2 to 2.5e8 samples in all",
            found,
        });
    }
    let samples = samples.round() as usize;
    let wheels: Vec<WheelPlace> = vehicle
        .wheels()
        .iter()
        .map(|w| WheelPlace { name: w.name.replace('_', "-"), at_m: w.at_m })
        .collect();
    let looks = sensors
        .iter()
        .map(|(channel, _)| vehicle.sensor_row(channel, &wheels))
        .collect::<Result<Vec<_>, _>>()?;
    check_finite_response(vehicle, road, settings, sensors, &looks)?;
    let mut series = responses(vehicle, road, &looks, settings, samples);
    let mut noise_rms = Vec::with_capacity(sensors.len());
    for (index, (data, (_, flaws))) in series.iter_mut().zip(sensors).enumerate() {
        let mut rng = ChaCha8Rng::seed_from_u64(settings.seed);
        rng.set_stream(1 + index as u64);
        noise_rms.push(spoil(data, flaws, &mut rng));
    }
    let channels = sensors.iter().map(|(c, _)| c.clone()).collect();
    let recording = Recording::new(settings.rate_hz, Some(settings.speed_m_s), wheels, channels, series)?;
    Ok(Drive { recording, noise_rms })
}

/// Displacements of a road that wanders have no stationary record.
fn check_finite_response(
    vehicle: &Vehicle,
    road: &Road,
    settings: &DriveSettings,
    sensors: &[(Channel, Flaws)],
    looks: &[(Vec<f64>, usize)],
) -> Result<(), SimulateError> {
    let ride = Ride::new(vehicle, road, settings.speed_m_s)?;
    let outputs: Vec<super::Output> = looks
        .iter()
        .zip(sensors)
        .map(|((row, d), (channel, _))| {
            let mut q = [vec![], vec![], vec![]];
            q[*d].clone_from(row);
            let (name, base) = (channel.name.clone(), channel.name.clone());
            super::Output { name, base, unit: "", q, r: [vec![], vec![], vec![]], u: vec![] }
        })
        .collect();
    let references: Vec<&super::Output> = outputs.iter().collect();
    for (index, why) in ride.infinite(&references)?.into_iter().enumerate() {
        // white noise is cut off at half the sampling rate; what wanders off is not
        if let Some(why) = why.filter(|_| sensors[index].0.quantity == crate::signal::Quantity::Displacement)
        {
            return Err(SimulateError::Infinite {
                channel: sensors[index].0.name.clone(),
                why: why.to_owned(),
            });
        }
    }
    Ok(())
}

/// The channels without flaws.
fn responses(
    vehicle: &Vehicle,
    road: &Road,
    looks: &[(Vec<f64>, usize)],
    settings: &DriveSettings,
    samples: usize,
) -> Vec<Vec<f64>> {
    let period = even_smooth(samples + (GUARD_S * settings.rate_hz).ceil() as usize);
    let bins = period / 2;
    let step = TAU * settings.rate_hz / period as f64;
    let tracks = Tracks::new(vehicle, road, settings.speed_m_s);
    let mut rng = ChaCha8Rng::seed_from_u64(settings.seed);
    let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
    let throws: Vec<C64> = (0..bins * tracks.places.len())
        .map(|_| C64::new(normal(), normal()) * std::f64::consts::FRAC_1_SQRT_2)
        .collect();
    let [low, high] = road.spectrum().band_rad_s(settings.speed_m_s);
    let transfer = Transfer::new(vehicle, looks);
    let width = looks.len();
    let mut spectra = vec![vec![C64::new(0.0, 0.0); bins + 1]; width];
    // the bin at half the sampling rate stays empty
    let filled: Vec<Vec<C64>> = (1..bins)
        .into_par_iter()
        .map(|k| {
            let omega = step * k as f64;
            if omega < low || omega > high {
                return Vec::new();
            }
            let size = (road.spectrum().psd(omega, settings.speed_m_s) * step / TAU).sqrt();
            let z = &throws[k * tracks.places.len()..(k + 1) * tracks.places.len()];
            let inputs = tracks.wheel_inputs(road.coherence(), z, size, omega, settings.speed_m_s);
            let h = transfer.at(omega);
            (0..width).map(|i| (0..inputs.len()).map(|j| h[(i, j)] * inputs[j]).sum()).collect()
        })
        .collect();
    for (k, row) in filled.into_iter().enumerate() {
        for (i, value) in row.into_iter().enumerate() {
            spectra[i][k + 1] = value;
        }
    }
    let inverse = RealFftPlanner::<f64>::new().plan_fft_inverse(period);
    spectra
        .into_par_iter()
        .map(|mut spectrum| {
            let mut out = inverse.make_output_vec();
            // lengths are the plan's own and bins 0 and N/2 are real, so it cannot refuse
            let _ = inverse.process(&mut spectrum, &mut out);
            out.truncate(samples);
            out
        })
        .collect()
}

/// Which track each wheel is on, and how far behind the foremost wheel.
struct Tracks {
    places: Vec<f64>,
    of_wheel: Vec<usize>,
    delay_s: Vec<f64>,
}

impl Tracks {
    fn new(vehicle: &Vehicle, road: &Road, speed_m_s: f64) -> Self {
        let at = vehicle.wheel_places();
        let front = at.iter().map(|p| p[0]).fold(f64::NEG_INFINITY, f64::max);
        let independent = *road.coherence() == Coherence::Independent;
        let groups = sources(road.coherence(), &at);
        let places = groups.iter().map(|g| at[g[0]][1]).collect();
        let mut of_wheel = vec![0; at.len()];
        for (track, group) in groups.iter().enumerate() {
            group.iter().for_each(|w| of_wheel[*w] = track);
        }
        let delay_s = at.iter().map(|p| if independent { 0.0 } else { (front - p[0]) / speed_m_s }).collect();
        Tracks { places, of_wheel, delay_s }
    }

    /// Heights under the wheels: the Cholesky factor of the tracks' coherence times independent throws, delayed.
    fn wheel_inputs(&self, coherence: &Coherence, z: &[C64], size: f64, omega: f64, speed: f64) -> Vec<C64> {
        let n = self.places.len();
        let mut l = vec![0.0; n * n];
        for i in 0..n {
            for j in 0..=i {
                let gamma = match coherence {
                    Coherence::Independent => f64::from(u8::from(i == j)),
                    _ => coherence.gamma((self.places[i] - self.places[j]).abs(), omega, speed),
                };
                let dot: f64 = (0..j).map(|k| l[i * n + k] * l[j * n + k]).sum();
                l[i * n + j] = if i == j {
                    (gamma - dot).max(0.0).sqrt()
                } else if l[j * n + j] > 0.0 {
                    (gamma - dot) / l[j * n + j]
                } else {
                    0.0
                };
            }
        }
        let heights: Vec<C64> =
            (0..n).map(|i| (0..=i).map(|j| z[j] * l[i * n + j]).sum::<C64>() * size).collect();
        self.of_wheel
            .iter()
            .zip(&self.delay_s)
            .map(|(track, delay)| heights[*track] * C64::new(0.0, -omega * delay).exp())
            .collect()
    }
}

/// (iω)^d R G(ω)(K_w + iωC_w): by modes where the system has them, else by solving.
struct Transfer<'a> {
    vehicle: &'a Vehicle,
    looks: &'a [(Vec<f64>, usize)],
    /// Poles, and residues per (channel, wheel).
    modal: Option<(Vec<C64>, Vec<CMat>)>,
}

impl<'a> Transfer<'a> {
    fn new(vehicle: &'a Vehicle, looks: &'a [(Vec<f64>, usize)]) -> Self {
        let n = vehicle.system().order();
        let wheels = vehicle.wheels().len();
        let modal = ModalForm::new(vehicle.system()).ok().map(|form| {
            let residues = (0..form.poles().len())
                .map(|m| {
                    let input = |j: usize| -> C64 {
                        (0..n)
                            .map(|k| {
                                let stiffness = C64::new(vehicle.wheel_stiffness()[(k, j)], 0.0);
                                (stiffness + form.poles()[m] * vehicle.wheel_damping()[(k, j)])
                                    * form.l()[(k, m)]
                            })
                            .sum()
                    };
                    CMat::from_fn(looks.len(), wheels, |i, j| {
                        (0..n).map(|k| form.psi()[(k, m)] * looks[i].0[k]).sum::<C64>() * input(j)
                    })
                })
                .collect();
            (form.poles().to_vec(), residues)
        });
        Transfer { vehicle, looks, modal }
    }

    fn at(&self, omega: f64) -> CMat {
        let wheels = self.vehicle.wheels().len();
        let iw = C64::new(0.0, omega);
        let powers = [C64::new(1.0, 0.0), iw, iw * iw];
        if let Some((poles, residues)) = &self.modal {
            let mut h = CMat::zeros(self.looks.len(), wheels);
            for (pole, residue) in poles.iter().zip(residues) {
                let factor = C64::new(1.0, 0.0) / (iw - pole);
                for j in 0..wheels {
                    for i in 0..self.looks.len() {
                        h[(i, j)] += residue[(i, j)] * factor;
                    }
                }
            }
            return CMat::from_fn(self.looks.len(), wheels, |i, j| h[(i, j)] * powers[self.looks[i].1]);
        }
        // a damped vehicle has no resonance on the axis, so that the solution exists
        let q = self
            .vehicle
            .road_response(omega)
            .unwrap_or_else(|_| CMat::zeros(self.vehicle.system().order(), wheels));
        CMat::from_fn(self.looks.len(), wheels, |i, j| {
            self.looks[i].0.iter().enumerate().map(|(k, v)| q[(k, j)] * *v).sum::<C64>()
                * powers[self.looks[i].1]
        })
    }
}

/// Adds what a sensor adds; the rms of the noise.
fn spoil(data: &mut [f64], flaws: &Flaws, rng: &mut ChaCha8Rng) -> f64 {
    let rms = (data.iter().map(|x| x * x).sum::<f64>() / data.len() as f64).sqrt();
    for x in data.iter_mut() {
        let z: f64 = StandardNormal.sample(rng);
        *x += flaws.noise_ratio * rms * z + flaws.bias;
        if let Some(limit) = flaws.clip {
            *x = x.clamp(-limit, limit);
        }
        if let Some(quantum) = flaws.quantum {
            *x = (*x / quantum).round() * quantum;
        }
    }
    flaws.noise_ratio * rms
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
