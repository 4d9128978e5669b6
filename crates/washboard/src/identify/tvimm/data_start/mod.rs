//! A start of free modes from the data alone: no vehicle, no fit.

mod phase;
#[cfg(test)]
mod tests;
mod tracks;
mod transfer;
mod vector_fit;

use super::model::RATE;
use super::{FreeDrive, FreeStart};
use crate::identify::likelihood::{BandData, Drive, FitError};
use crate::linalg::{C64, LinalgError, Mat};
use crate::lti::FirstOrder;
use crate::units::{Convention, rad_per_s};
use thiserror::Error;
use tracks::Tracks;
use transfer::{EXPONENT, Transfer};
use vector_fit::{Samples, Static, realization};

/// Poles start in these frequencies, Hz, as far as the band holds them.
const POLES_HZ: [f64; 2] = [0.7, 20.0];

/// Without a ridge, parts that nearly cancel, a thousand times larger than their sum, explain errors of the phase; twice as
/// much bends the poles. Scanned on five cars' sampled spectra.
const RIDGE: f64 = 0.15;
/// An input has no share of a plane whose heights under its wheels are below this: it is then not along this plane.
const LEAST_HEIGHT: f64 = 0.1;

/// Why the data alone give no start.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum NoDataStart {
    /// A front wheel carries no sensor.
    #[error("the front wheels do not all carry a vertical sensor")]
    NoFrontHub,
    /// Wheels whose road this start does not know.
    #[error(
        "the wheels are not one or two to the front axle, each followed by one at most on every other axle"
    )]
    Wheels,
    /// The hubs show nothing.
    #[error("the front wheels' sensors show no road")]
    NoSignal,
    /// The spectra cannot be used.
    #[error(transparent)]
    Spectra(#[from] FitError),
    /// The responses have no stable fit.
    #[error(transparent)]
    NoFit(#[from] LinalgError),
}

/// A start of free modes from the data alone.
///
/// `on_wheel[c]` is the wheel (of `drive.at_m`) whose carrier sensor c sits on, `states` the order asked for. The front hubs
/// give the road's spectrum the phase that it lacks: see `Transfer::new`; the responses to sum and difference of the front
/// wheels' tracks are fitted by poles of their own, each as a part of the front wheels and one of every axle behind, delayed
/// (vector fitting); all parts together are cut to `states` by balanced truncation. A car's sum has its heave, pitch and the
/// axles' hops, its difference roll and the hops. S₀ is then such that the sensors follow the road statically.
///
/// # Errors
/// [`NoDataStart`], with the reason.
pub fn data_start(
    drive: &FreeDrive<'_>,
    on_wheel: &[Option<usize>],
    states: usize,
    convention: Convention,
) -> Result<FreeStart, NoDataStart> {
    let data = BandData::new(drive.spectra, drive.band_hz)?;
    let drive_of = Drive { speed_m_s: drive.speed_m_s, convention };
    from_band(&data, drive_of, drive, on_wheel, states)
}

fn from_band(
    data: &BandData,
    known: Drive,
    drive: &FreeDrive<'_>,
    on_wheel: &[Option<usize>],
    states: usize,
) -> Result<FreeStart, NoDataStart> {
    let tracks = Tracks::new(drive.at_m)?;
    let front: Vec<usize> = tracks.wheels[0]
        .iter()
        .map(|w| (0..on_wheel.len()).find(|c| on_wheel[*c] == *w && drive.planes[*c][0] != 0.0))
        .collect::<Option<_>>()
        .ok_or(NoDataStart::NoFrontHub)?;
    let transfer = Transfer::new(data, known, drive.derivatives, &tracks, &front)?;
    let fitted = responses(data, known, &tracks, &transfer, drive, RIDGE)?;
    let (system, _) = assembled(&tracks, &fitted, drive.at_m.len()).balanced(states)?;
    let negative = Mat::from_fn(system.order(), system.order(), |i, j| -system.a[(i, j)]);
    let statically = crate::linalg::solve(&negative, &system.b)?;
    let gain = |c: usize| -> f64 {
        (0..system.order())
            .map(|i| system.c[(c, i)] * (0..drive.at_m.len()).map(|w| statically[(i, w)]).sum::<f64>())
            .sum::<f64>()
            / drive.planes[c][0]
    };
    let gains: Vec<f64> = (0..drive.planes.len()).filter(|c| drive.planes[*c][0] != 0.0).map(gain).collect();
    let mean = crate::identify::likelihood::mean(&gains);
    if !(mean > 0.1 && mean < 10.0) {
        return Err(NoDataStart::NoSignal);
    }
    let c = Mat::from_fn(system.c.nrows(), system.order(), |i, j| system.c[(i, j)] / mean);
    Ok(FreeStart {
        name: "the data alone".into(),
        far: true,
        base: false,
        system: FirstOrder { c, ..system }.in_time_of(1.0 / RATE),
        roughness_m3: transfer.s0 * mean * mean,
        exponent: EXPONENT,
        mu: (tracks.count() > 1).then_some(transfer.mu),
    })
}

/// The fits of each input, in scaled time.
fn responses(
    data: &BandData,
    known: Drive,
    tracks: &Tracks,
    transfer: &Transfer,
    drive: &FreeDrive<'_>,
    ridge: f64,
) -> Result<Vec<vector_fit::Fit>, LinalgError> {
    let omega: Vec<f64> = data.omega.iter().map(|o| o / RATE).collect();
    let parts: Vec<Vec<C64>> = tracks
        .behind_m
        .iter()
        .map(|d| data.omega.iter().map(|o| C64::new(0.0, -o * d / known.speed_m_s).exp()).collect())
        .collect();
    let ends = [data.omega[0], data.omega[data.omega.len() - 1]];
    let band = [rad_per_s(POLES_HZ[0]).max(ends[0]) / RATE, rad_per_s(POLES_HZ[1]).min(ends[1]) / RATE];
    (0..tracks.count())
        .map(|k| {
            let samples = Samples {
                omega: &omega,
                values: &transfer.response[k],
                weights: &transfer.shows[k],
                parts: &parts,
                statics: &statics(tracks, drive, k),
                ridge,
            };
            // heave, and pitch where there are several axles; roll for the difference; and a hop an axle
            let axles = tracks.behind_m.len();
            let pairs = axles + if k == 0 && axles > 1 { 2 } else { 1 };
            samples.fit(pairs, band)
        })
        .collect()
}

/// A plane's height at a wheel's place, and at a sensor by what it shows of 1, y and x.
type AtWheel<'a> = &'a dyn Fn([f64; 2]) -> f64;
type AtSensor<'a> = &'a dyn Fn([f64; 3]) -> f64;

/// The planes of the road that input k has a share of, and what the sensors show of them.
fn statics(tracks: &Tracks, drive: &FreeDrive<'_>, k: usize) -> Vec<Static> {
    let mean = |axis: usize| drive.at_m.iter().map(|p| p[axis]).sum::<f64>() / drive.at_m.len() as f64;
    let [x, y] = [mean(0), mean(1)];
    // height of a plane at a place, and at a sensor
    let planes: [(AtWheel<'_>, AtSensor<'_>); 3] = [
        (&|_| 1.0, &|p| p[0]),
        (&|at| at[1] - y, &|p| p[1] - y * p[0]),
        (&|at| at[0] - x, &|p| p[2] - x * p[0]),
    ];
    planes
        .iter()
        .filter_map(|(at_wheel, at_sensor)| {
            let height = |row: &Vec<Option<usize>>| -> f64 {
                let of = |(t, w): (usize, &Option<usize>)| {
                    w.map_or(0.0, |w| tracks.share(t, k) * at_wheel(drive.at_m[w]))
                };
                row.iter().enumerate().map(of).sum()
            };
            let heights: Vec<f64> = tracks.wheels.iter().map(height).collect();
            let size = heights.iter().map(|h| h * h).sum::<f64>().sqrt();
            (size > LEAST_HEIGHT).then(|| Static {
                heights: heights.iter().map(|h| h / size).collect(),
                values: drive.planes.iter().map(|p| at_sensor(*p) / size).collect(),
            })
        })
        .collect()
}

/// One state space of all inputs' parts: each part of each input is a copy of its poles' realization.
fn assembled(tracks: &Tracks, fitted: &[vector_fit::Fit], wheels: usize) -> FirstOrder {
    let sensors = fitted.first().map_or(0, |f| f.coefficients.len());
    let axles = tracks.behind_m.len();
    let total: usize = fitted.iter().map(|f| vector_fit::order(&f.poles) * axles).sum();
    let (mut a, mut b, mut c) =
        (Mat::zeros(total, total), Mat::zeros(total, wheels), Mat::zeros(sensors, total));
    let mut at = 0;
    for (k, fit) in fitted.iter().enumerate() {
        let (of_poles, inputs) = realization(&fit.poles);
        let n = inputs.len();
        for (axle, row) in tracks.wheels.iter().enumerate() {
            for i in 0..n {
                for j in 0..n {
                    a[(at + i, at + j)] = of_poles[(i, j)];
                }
                for (track, wheel) in row.iter().enumerate() {
                    if let Some(w) = wheel {
                        b[(at + i, *w)] = inputs[i] * tracks.share(track, k);
                    }
                }
                for (s, coefficients) in fit.coefficients.iter().enumerate() {
                    c[(s, at + i)] = coefficients[axle * n + i];
                }
            }
            at += n;
        }
    }
    FirstOrder { a, b, c }
}
