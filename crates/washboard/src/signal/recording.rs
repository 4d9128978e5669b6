//! A drive as data: channels of equal length on one uniform clock, in SI, along positive axes.

use super::error::suggest;
use super::{Channel, Repair, SignalError, WheelPlace, decimate};

/// Samples of every channel, with what is needed to read them right.
///
/// | what | unit |
/// |---|---|
/// | `samples()[i][k]` | channel i at time k/rate: m, m/s, m/s² or rad/s by the channel's quantity |
/// | direction | always +x, +y or +z: a channel declared `-z` is stored with its sign turned |
/// | `rate_hz` | samples per second, the same for all channels |
/// | `speed_m_s` | mean forward speed, where it is known |
/// | `speed_series()[k]` | forward speed at time k/rate, where it was recorded; NaN where the record has a gap |
///
/// Values that break these rules cannot be built: see [`Recording::new`].
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    rate_hz: f64,
    speed_m_s: Option<f64>,
    speed_spread_m_s: Option<f64>,
    speed_series: Option<Vec<f64>>,
    wheels: Vec<WheelPlace>,
    channels: Vec<Channel>,
    samples: Vec<Vec<f64>>,
    repairs: Vec<Repair>,
}

impl Recording {
    /// A recording from samples as measured: in SI, along each channel's declared direction (the sign of a `-z` channel
    /// is turned here, and its direction becomes `+z`).
    ///
    /// # Errors
    /// A rate or speed that is not positive and finite; no channel; numbers of channels and series, or lengths of
    /// series, that differ; a sample that is not finite; a name used twice; a wheel that does not exist.
    pub fn new(
        rate_hz: f64,
        speed_m_s: Option<f64>,
        wheels: Vec<WheelPlace>,
        mut channels: Vec<Channel>,
        mut samples: Vec<Vec<f64>>,
    ) -> Result<Self, SignalError> {
        positive("rate_hz", rate_hz)?;
        if let Some(speed) = speed_m_s {
            positive("speed_m_s", speed)?;
        }
        check_channels(&wheels, &channels)?;
        check_samples(&channels, &samples)?;
        for (channel, series) in channels.iter_mut().zip(&mut samples) {
            if channel.direction.sign() < 0.0 {
                series.iter_mut().for_each(|x| *x = -*x);
            }
            channel.direction = channel.direction.positive();
        }
        Ok(Recording {
            rate_hz,
            speed_m_s,
            speed_spread_m_s: None,
            speed_series: None,
            wheels,
            channels,
            samples,
            repairs: Vec::new(),
        })
    }

    /// The same recording with the standard deviation of its speed, in m/s.
    ///
    /// # Errors
    /// A spread that is negative or not finite.
    pub fn with_speed_spread(mut self, spread_m_s: f64) -> Result<Self, SignalError> {
        if !(spread_m_s >= 0.0 && spread_m_s.is_finite()) {
            let expected = "a finite number that is not negative";
            return Err(SignalError::Value { name: "speed_spread_m_s", expected, found: spread_m_s });
        }
        self.speed_spread_m_s = Some(spread_m_s);
        Ok(self)
    }

    /// The same recording with its speed at each sample, in m/s; NaN where it is not known. Mean and spread stay as they
    /// are.
    ///
    /// # Errors
    /// A series of another length than the channels'; a speed that is infinite.
    pub fn with_speed_series(mut self, series_m_s: Vec<f64>) -> Result<Self, SignalError> {
        if series_m_s.len() != self.len() {
            let what = "samples of the speed".to_owned();
            return Err(SignalError::Length { what, expected: self.len(), found: series_m_s.len() });
        }
        if let Some(found) = series_m_s.iter().copied().find(|v| v.is_infinite()) {
            let expected = "finite speeds, or NaN where there is none";
            return Err(SignalError::Value { name: "speed_series", expected, found });
        }
        self.speed_series = Some(series_m_s);
        Ok(self)
    }

    /// The same recording with more repairs noted.
    #[must_use]
    pub fn with_repairs(mut self, repairs: impl IntoIterator<Item = Repair>) -> Self {
        self.repairs.extend(repairs);
        self
    }

    /// Samples per second.
    #[must_use]
    pub fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// Mean forward speed in m/s, where known.
    #[must_use]
    pub fn speed_m_s(&self) -> Option<f64> {
        self.speed_m_s
    }

    /// Standard deviation of the speed in m/s, where it was measured.
    #[must_use]
    pub fn speed_spread_m_s(&self) -> Option<f64> {
        self.speed_spread_m_s
    }

    /// The speed at each sample in m/s, where it was recorded; NaN where that record has a gap.
    #[must_use]
    pub fn speed_series(&self) -> Option<&[f64]> {
        self.speed_series.as_deref()
    }

    /// The wheels that channels refer to.
    #[must_use]
    pub fn wheels(&self) -> &[WheelPlace] {
        &self.wheels
    }

    /// What each series is.
    #[must_use]
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// One series a channel.
    #[must_use]
    pub fn samples(&self) -> &[Vec<f64>] {
        &self.samples
    }

    /// What was done to the file's data on the way here.
    #[must_use]
    pub fn repairs(&self) -> &[Repair] {
        &self.repairs
    }

    /// Samples in each channel.
    #[must_use]
    pub fn len(&self) -> usize {
        self.samples[0].len()
    }

    /// Never true: a recording without samples cannot be built.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Number of samples over rate, in s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.len() as f64 / self.rate_hz
    }

    /// Where a channel sits among the channels.
    ///
    /// # Errors
    /// A name that no channel has, with the nearest one.
    pub fn channel_index(&self, name: &str) -> Result<usize, SignalError> {
        self.channels.iter().position(|c| c.name == name).ok_or_else(|| SignalError::UnknownChannel {
            name: name.to_owned(),
            nearest: suggest(name, self.channels.iter().map(|c| c.name.as_str())),
        })
    }

    /// The recording with these channels only, in this order.
    ///
    /// # Errors
    /// A name that no channel has; a name given twice; no name.
    pub fn select(&self, names: &[&str]) -> Result<Self, SignalError> {
        let indices = names.iter().map(|n| self.channel_index(n)).collect::<Result<Vec<_>, _>>()?;
        let chosen = self.with_indices(&indices);
        check_channels(&chosen.wheels, &chosen.channels)?;
        Ok(chosen)
    }

    /// The recording with the channels that satisfy a condition.
    ///
    /// # Errors
    /// No channel satisfies it.
    pub fn select_where(&self, keep: impl Fn(&Channel) -> bool) -> Result<Self, SignalError> {
        let indices: Vec<usize> = (0..self.channels.len()).filter(|&i| keep(&self.channels[i])).collect();
        let chosen = self.with_indices(&indices);
        check_channels(&chosen.wheels, &chosen.channels)?;
        Ok(chosen)
    }

    /// The part from `start_s` to `end_s`, both counted from the first sample. Where the speed at each sample is known
    /// and positive on average, mean and spread are the part's; else they stay the whole recording's.
    ///
    /// # Errors
    /// A part that holds no sample.
    pub fn between(&self, start_s: f64, end_s: f64) -> Result<Self, SignalError> {
        let index = |t: f64| ((t * self.rate_hz).ceil().max(0.0) as usize).min(self.len());
        let (first, end) = (index(start_s), index(end_s));
        if first >= end {
            return Err(SignalError::TooShort { what: "a part of a recording", needed: 1, found: 0 });
        }
        self.part(first..end)
    }

    /// The part of these samples: as [`between`](Recording::between), to the sample.
    ///
    /// # Errors
    /// A part that holds no sample or reaches beyond the last one.
    pub fn part(&self, range: std::ops::Range<usize>) -> Result<Self, SignalError> {
        if range.is_empty() || range.end > self.len() {
            let (what, needed) = ("a part of a recording", range.end.max(1));
            return Err(SignalError::TooShort { what, needed, found: self.len() });
        }
        let cut = |x: &[f64]| x[range.clone()].to_vec();
        let part = self.with_samples(self.rate_hz, cut, cut);
        let of_part = part.speed_series().and_then(mean_and_spread).filter(|(mean, _)| *mean > 0.0);
        Ok(match of_part {
            Some((mean, spread)) => {
                Recording { speed_m_s: Some(mean), speed_spread_m_s: Some(spread), ..part }
            }
            None => part,
        })
    }

    /// The recording without each channel's mean and linear trend (least squares).
    #[must_use]
    pub fn detrended(&self) -> Self {
        self.with_samples(self.rate_hz, detrend, <[f64]>::to_vec)
    }

    /// Every `factor`-th sample after a linear-phase low-pass whose delay is taken out (zero phase).
    ///
    /// With f_N the new Nyquist frequency: flat within 10⁻⁴ up to [`PASSBAND`](super::PASSBAND) f_N; what would fold
    /// into that band (above [`STOPBAND`](super::STOPBAND) f_N) is lowered by 80 dB. No sample is invented beyond the
    /// ends: the result starts and stops half a filter inside, 13 of its own samples on either side.
    ///
    /// # Errors
    /// A factor of 0; a recording shorter than the filter.
    pub fn decimated(&self, factor: usize) -> Result<Self, SignalError> {
        if factor == 1 {
            return Ok(self.clone());
        }
        let taps = decimate::filter(factor)?;
        if self.len() < taps.len() {
            return Err(SignalError::TooShort { what: "decimation", needed: taps.len(), found: self.len() });
        }
        // the speed is slow: its value at the instants that are kept
        let kept = |v: &[f64]| v.windows(taps.len()).step_by(factor).map(|w| w[taps.len() / 2]).collect();
        Ok(self.with_samples(self.rate_hz / factor as f64, |x| decimate::apply(&taps, factor, x), kept))
    }

    fn with_samples(
        &self,
        rate_hz: f64,
        change: impl Fn(&[f64]) -> Vec<f64>,
        of_speed: impl Fn(&[f64]) -> Vec<f64>,
    ) -> Self {
        Recording {
            rate_hz,
            speed_m_s: self.speed_m_s,
            speed_spread_m_s: self.speed_spread_m_s,
            speed_series: self.speed_series.as_deref().map(of_speed),
            wheels: self.wheels.clone(),
            channels: self.channels.clone(),
            samples: self.samples.iter().map(|x| change(x)).collect(),
            repairs: self.repairs.clone(),
        }
    }

    fn with_indices(&self, indices: &[usize]) -> Self {
        Recording {
            rate_hz: self.rate_hz,
            speed_m_s: self.speed_m_s,
            speed_spread_m_s: self.speed_spread_m_s,
            speed_series: self.speed_series.clone(),
            wheels: self.wheels.clone(),
            channels: indices.iter().map(|&i| self.channels[i].clone()).collect(),
            samples: indices.iter().map(|&i| self.samples[i].clone()).collect(),
            repairs: self.repairs.clone(),
        }
    }
}

/// Mean and standard deviation of the values that are known.
pub(super) fn mean_and_spread(series: &[f64]) -> Option<(f64, f64)> {
    let known = || series.iter().filter(|v| v.is_finite());
    let n = known().count();
    let mean = known().sum::<f64>() / n as f64;
    let spread = (known().map(|v| (v - mean).powi(2)).sum::<f64>() / n as f64).sqrt();
    (n > 0).then_some((mean, spread))
}

fn positive(name: &'static str, found: f64) -> Result<(), SignalError> {
    if found > 0.0 && found.is_finite() {
        Ok(())
    } else {
        Err(SignalError::Value { name, expected: "a positive finite number", found })
    }
}

fn check_channels(wheels: &[WheelPlace], channels: &[Channel]) -> Result<(), SignalError> {
    if channels.is_empty() {
        return Err(SignalError::NoChannel { why: "a recording needs at least one".to_owned() });
    }
    let mut names = std::collections::BTreeSet::new();
    for channel in channels {
        if !names.insert(&channel.name) {
            return Err(SignalError::DuplicateChannel { name: channel.name.clone() });
        }
        if let Some(index) = channel.wheel.filter(|w| *w >= wheels.len()) {
            let (channel, wheels) = (channel.name.clone(), wheels.len());
            return Err(SignalError::Wheel { channel, index, wheels });
        }
    }
    let places = wheels.iter().map(|w| w.at_m).chain(channels.iter().filter_map(|c| c.at_m));
    match places.flatten().find(|x| !x.is_finite()) {
        Some(found) => Err(SignalError::Value { name: "at_m", expected: "a finite number", found }),
        None => Ok(()),
    }
}

fn check_samples(channels: &[Channel], samples: &[Vec<f64>]) -> Result<(), SignalError> {
    if channels.len() != samples.len() {
        let what = "series, one a channel".to_owned();
        return Err(SignalError::Length { what, expected: channels.len(), found: samples.len() });
    }
    let len = samples[0].len();
    if len == 0 {
        return Err(SignalError::TooShort { what: "a recording", needed: 1, found: 0 });
    }
    for (channel, series) in channels.iter().zip(samples) {
        if series.len() != len {
            let what = format!("samples of channel `{}`", channel.name);
            return Err(SignalError::Length { what, expected: len, found: series.len() });
        }
        if let Some(index) = series.iter().position(|x| !x.is_finite()) {
            let (channel, value) = (channel.name.clone(), series[index]);
            return Err(SignalError::NotFinite { channel, index, value });
        }
    }
    Ok(())
}

/// x − (mean + slope·(k − k̄)), with slope = Σ (k − k̄) x / Σ (k − k̄)².
fn detrend(x: &[f64]) -> Vec<f64> {
    let n = x.len() as f64;
    let centre = (n - 1.0) / 2.0;
    let mean = x.iter().sum::<f64>() / n;
    let moment: f64 = x.iter().enumerate().map(|(k, v)| (k as f64 - centre) * (v - mean)).sum();
    let square = n * (n * n - 1.0) / 12.0;
    let slope = if square > 0.0 { moment / square } else { 0.0 };
    x.iter().enumerate().map(|(k, v)| v - mean - slope * (k as f64 - centre)).collect()
}

#[cfg(test)]
mod tests;
