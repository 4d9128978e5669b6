//! Fitting spectral models to measured spectra: what the physical fit and the free modes share.

#[cfg(test)]
pub(crate) mod checks;
mod covariance;
mod data;
mod descent;
pub(crate) mod limits;
mod response;
mod road;
mod spectra;
mod whittle;

pub(crate) use covariance::{Covariance, Group};
pub(crate) use data::{BandData, LEAST_NOISE};
pub(crate) use descent::{End, Problem, Stop, descend, newton};
pub(crate) use response::{Place, PlaceMut, Pulled, Response, Shape};
pub(crate) use road::{Drive, Road, RoadValues};
pub(crate) use spectra::Spectra;
pub(crate) use whittle::{Score, Whitening, cost, information_bins};

use thiserror::Error;

/// χ above this says that the model does not explain the data: right answers have .33–.44, wrong ones ≥ 1.3.
pub const CHI_LIMIT: f64 = 0.6;
/// The same for an eighth of the band, whose mean scatters more.
pub(crate) const PART_CHI_LIMIT: f64 = 0.9;

/// Speed and wheelbase are what the user says to this share.
pub(crate) const SPEED_SD: f64 = 0.03;

/// What is refused before a fit starts.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum FitError {
    /// The band holds too few bins.
    #[error(
        "the band {band_hz:?} Hz holds {bins} bins of the spectra, expected at least {least}: a wider band or longer segments"
    )]
    FewBins {
        /// The band.
        band_hz: [f64; 2],
        /// Bins in it.
        bins: usize,
        /// Bins needed.
        least: usize,
    },
    /// The recording is too short for its channels.
    #[error(
        "{averages:.1} independent averages for {channels} channels, expected at least twice as many: a longer recording or shorter segments"
    )]
    FewAverages {
        /// Averages.
        averages: f64,
        /// Channels.
        channels: usize,
    },
    /// A channel has no power in the band.
    #[error("channel `{channel}` has no power in the band, or more than a number can hold")]
    DeadChannel {
        /// Its name.
        channel: String,
    },
    /// One sensor cannot tell a vehicle from its road.
    #[error("one channel (`{channel}`) cannot tell the vehicle from its road: expected at least two")]
    OneChannel {
        /// Its name.
        channel: String,
    },
    /// The vehicle at its start cannot be used.
    #[error("the vehicle cannot be fitted from its start: {0}")]
    Start(String),
    /// No recording was given.
    #[error("no recording to fit")]
    NoDrive,
}

/// A value and its standard deviation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Value.
    pub value: f64,
    /// Standard deviation: Fisher information, widened by the spread over blocks.
    pub sd: f64,
}

/// A reason in words with a name to script against.
pub type Reason = (&'static str, String);

/// What the residual says: the model does not explain the whole band, or a part of it.
pub(crate) fn misfit(residual: &[f64], omega: &[f64]) -> Option<Reason> {
    let chi = mean(residual);
    if !(chi <= CHI_LIMIT) {
        let text = format!(
            "the model does not explain the spectra: residual statistic {chi:.2}, expected below {CHI_LIMIT}"
        );
        return Some(("misfit", text));
    }
    let hz = |bin: usize| crate::units::hz(omega[bin]);
    worst_part(residual).filter(|p| p.2 > PART_CHI_LIMIT).map(|(from, to, worst)| {
        let text = format!(
            "the model does not explain the spectra from {:.2} to {:.2} Hz: residual statistic {worst:.2} there, expected below {PART_CHI_LIMIT}; leave that band out",
            hz(from),
            hz(to)
        );
        ("misfit", text)
    })
}

/// What the delay of the rear wheels says about the speed: a road's level is as wrong as the speed, and the poles of a
/// vehicle are its own.
pub(crate) fn speed_off(delay: Option<Estimate>, ln_delay: f64) -> Option<Reason> {
    let Estimate { value, sd } = delay?;
    (ln_delay.abs() > SPEED_SD + 3.0 * sd / value).then(|| {
        let text = format!(
            "the rear wheels follow the front ones after {:.1} ms; speed and wheelbase say {:.1} ms: one of them is wrong by {:.1} %, and the road's level with it",
            1e3 * value,
            1e3 * value / ln_delay.exp(),
            100.0 * (ln_delay.exp() - 1.0).abs()
        );
        ("speed", text)
    })
}

pub(crate) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// The eighth of the band with the largest mean residual: first bin, last bin, mean.
fn worst_part(residual: &[f64]) -> Option<(usize, usize, f64)> {
    let size = (residual.len() / 8).max(1);
    residual
        .chunks(size)
        .enumerate()
        .filter(|(_, part)| part.len() == size)
        .map(|(i, part)| (i * size, (i + 1) * size - 1, mean(part)))
        .max_by(|a, b| a.2.total_cmp(&b.2))
}
