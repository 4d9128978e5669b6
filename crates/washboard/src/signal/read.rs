//! From RUN.toml and its data to a recording: files, clock, units, faults, speed, in this order.

use super::condition::{clipped, is_dead};
use super::csv::{CsvLayout, read_csv};
use super::declared::{channels, check, format, to_si};
use super::npy::read_npy;
use super::sst::read_sst;
use super::time_base::{Laid, lay_on_clock, lay_uniform};
use super::{
    Channel, Column, Format, Recording, RecordingDescription, Repair, RepairKind, SignalError, SpeedUnit,
};
use crate::files::{FileError, read_toml};
use std::fs;
use std::path::{Path, PathBuf};

/// The most numbers (rows × wanted columns) that are read from one file: 2²⁷, or 1 GiB of them.
pub const MAX_VALUES: usize = 1 << 27;

/// A speed file's stamps that are farther apart do not tell the speed between them, in s.
pub const MAX_SPEED_GAP_S: f64 = 5.0;

/// What a RUN.toml says of its data.
///
/// # Errors
/// As [`read_toml`]; of a data file in its place, that a description is expected and what makes one.
pub fn read_description(path: &Path) -> Result<RecordingDescription, FileError> {
    let is_toml = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"));
    read_toml(path).map_err(|e| match e {
        FileError::Content { line, message, .. } if !is_toml => {
            let name = path.file_name().unwrap_or(path.as_os_str()).display();
            let message = format!(
                "{message}. A RUN.toml is expected, the description of a recording: it names the data file (data = {:?}), its clock and its channels; `washboard simulate` writes one to start from",
                name.to_string()
            );
            FileError::content(path, line, message)
        }
        other => other,
    })
}

/// The recording that a RUN.toml describes.
///
/// In this order: the wanted columns are read; the part `span_s` is cut out; time stamps become a uniform clock and
/// missing samples are filled or the longest whole piece is used; units become SI; constant channels are left out and
/// clipped ones told; the speed is averaged over the part used, and kept at each sample where it has times of its own
/// ([`Recording::speed_series`]). Whatever is changed on the way is in
/// [`Recording::repairs`].
///
/// # Errors
/// A description with an unknown, missing or contradicting field; a unit that is not one of the channel's quantity; a
/// data file that is not what is declared: each names file, field or line and column, what was expected and found.
///
/// Format: `docs/interface.md`, "Recording".
pub fn read_recording(path: &Path) -> Result<Recording, SignalError> {
    let description = read_description(path)?;
    check(&description, path)?;
    let conversions = description.channels.iter().map(|c| to_si(c, path)).collect::<Result<Vec<_>, _>>()?;
    let mut channels = channels(&description, path)?;
    let table = read_table(&description, path)?;
    let laid = laid(&description, table, path)?;
    let (mut samples, mut repairs) = (laid.columns, laid.repairs);
    let speeds = match description.speed_column {
        Some(_) => samples.pop().map(|v| Speeds { series: Some(v.clone()), used: v }),
        None => {
            speed_file(&description, path, laid.start_s, laid.end_s, samples.first().map_or(0, Vec::len))?
        }
    };
    for (series, si) in samples.iter_mut().zip(&conversions) {
        series.iter_mut().for_each(|x| *x = si(*x));
    }
    leave_out_dead(&mut channels, &mut samples, &mut repairs)?;
    tell_clipped(&channels, &samples, laid.rate_hz, &mut repairs);
    let unit = description.speed_unit.map_or(1.0, SpeedUnit::in_m_s);
    let (speed, spread) = match &speeds {
        Some(speeds) => speed(&speeds.used, unit, path)?,
        None => (description.speed_m_s, None),
    };
    let mut recording = Recording::new(laid.rate_hz, speed, description.wheels, channels, samples)?;
    if let Some(spread) = spread {
        recording = recording.with_speed_spread(spread)?;
    }
    if let Some(series) = speeds.and_then(|s| s.series) {
        recording = recording.with_speed_series(series.iter().map(|v| v * unit).collect())?;
    }
    Ok(recording.with_repairs(repairs))
}

/// The bytes of a binary data file of at most 8 [`MAX_VALUES`] bytes.
pub(super) fn read_bytes(path: &Path) -> Result<Vec<u8>, SignalError> {
    let fail = |source| FileError::Read { path: path.to_owned(), source };
    let size = crate::files::size_of_file(path)?;
    let most = 8 * MAX_VALUES as u64;
    if size > most {
        let expected = format!("at most {most} bytes");
        return Err(SignalError::data(path, None, "file", expected, size.to_string()));
    }
    Ok(fs::read(path).map_err(fail)?)
}

/// The columns of a data file: the channels', then the speed's if it is there.
struct Table {
    columns: Vec<Vec<f64>>,
    stamps_s: Option<Vec<f64>>,
    /// The rate that the file itself states.
    rate_hz: Option<f64>,
    path: PathBuf,
}

fn beside(path: &Path, file: &Path) -> PathBuf {
    path.parent().map_or_else(|| file.to_owned(), |dir| dir.join(file))
}

fn read_table(d: &RecordingDescription, path: &Path) -> Result<Table, SignalError> {
    let data = beside(path, &d.data);
    let format = format(d, path)?;
    if format != Format::Csv && (d.header.is_some() || d.delimiter.is_some()) {
        return Err(SignalError::field(
            path,
            "header",
            "header and delimiter with CSV only",
            "another format",
        ));
    }
    // the stamps come first
    let wanted: Vec<Column> = d
        .time_column
        .iter()
        .chain(d.channels.iter().map(|c| &c.column))
        .chain(&d.speed_column)
        .cloned()
        .collect();
    let (mut columns, rate_hz) = match format {
        Format::Csv => {
            let delimiter = d.delimiter.map_or(b',', |c| c as u8);
            let layout = CsvLayout { header: d.header.unwrap_or(true), delimiter };
            (read_csv(&data, layout, &wanted, d.time_column.as_ref().map(|_| 0))?, None)
        }
        Format::Npy => (read_npy(&data, &wanted)?, None),
        Format::Sst => {
            let record = read_sst(&data)?;
            let column = |c: &Column| match c {
                Column::Index(0) => Ok(record.front.clone()),
                Column::Index(1) => Ok(record.rear.clone()),
                Column::Name(n) if n == "front" => Ok(record.front.clone()),
                Column::Name(n) if n == "rear" => Ok(record.rear.clone()),
                other => Err(SignalError::data(
                    &data,
                    None,
                    other.to_string(),
                    "`front` or `rear`",
                    "another name",
                )),
            };
            (wanted.iter().map(column).collect::<Result<Vec<_>, _>>()?, Some(record.rate_hz))
        }
    };
    let stamps_s = d.time_column.is_some().then(|| {
        let unit = d.time_unit.unwrap_or_default().in_s();
        columns.remove(0).into_iter().map(|t| t * unit).collect()
    });
    Ok(Table { columns, stamps_s, rate_hz, path: data })
}

/// The columns on a uniform clock.
fn laid(d: &RecordingDescription, table: Table, path: &Path) -> Result<Laid, SignalError> {
    if let Some(stamps) = table.stamps_s {
        return lay_on_clock(&stamps, table.columns, d.stamps.unwrap_or_default(), d.span_s);
    }
    let rate_hz = match (d.rate_hz, table.rate_hz) {
        (Some(declared), Some(stated)) if declared != stated => {
            let found = format!("{declared}");
            let expected = format!("{stated}, as `{}` says", table.path.display());
            return Err(SignalError::field(path, "rate_hz", expected, found));
        }
        (declared, stated) => declared.or(stated).unwrap_or(0.0),
    };
    lay_uniform(rate_hz, table.columns, d.span_s)
}

fn leave_out_dead(
    channels: &mut Vec<Channel>,
    samples: &mut Vec<Vec<f64>>,
    repairs: &mut Vec<Repair>,
) -> Result<(), SignalError> {
    let count = samples.first().map_or(0, Vec::len);
    let mut index = 0;
    while index < channels.len() {
        if !is_dead(&samples[index]) {
            index += 1;
            continue;
        }
        let name = channels.remove(index).name;
        let value = samples.remove(index).first().copied().unwrap_or(0.0);
        let text = format!("channel `{name}` is constant ({value} in SI) and was left out");
        repairs.push(Repair {
            channel: Some(name),
            what: RepairKind::DeadChannel,
            text,
            count,
            start_s: Some(0.0),
        });
    }
    if channels.is_empty() {
        let why = format!("all {} are constant", repairs.iter().filter(|r| r.channel.is_some()).count());
        return Err(SignalError::NoChannel { why });
    }
    Ok(())
}

fn tell_clipped(channels: &[Channel], samples: &[Vec<f64>], rate_hz: f64, repairs: &mut Vec<Repair>) {
    for (channel, series) in channels.iter().zip(samples) {
        if let Some((count, first)) = clipped(series) {
            let share = 100.0 * count as f64 / series.len() as f64;
            let name = &channel.name;
            let text = format!(
                "channel `{name}` rests at its extreme values for {count} samples ({share:.2} %): clipped, or at a stop; kept"
            );
            let start_s = Some(first as f64 / rate_hz);
            repairs.push(Repair {
                channel: Some(name.clone()),
                what: RepairKind::Clipped,
                text,
                count,
                start_s,
            });
        }
    }
}

/// Speeds as they were measured, in their own unit.
struct Speeds {
    /// What mean and spread are taken of.
    used: Vec<f64>,
    /// One a sample of the recording, where the speeds have times.
    series: Option<Vec<f64>>,
}

/// The speeds of another file within a span of the recording's clock, and at its samples.
fn speed_file(
    d: &RecordingDescription,
    path: &Path,
    start_s: f64,
    end_s: f64,
    samples: usize,
) -> Result<Option<Speeds>, SignalError> {
    let Some(file) = &d.speed_file else { return Ok(None) };
    let data = beside(path, &file.data);
    let wanted: Vec<Column> = std::iter::once(&file.column).chain(&file.time_column).cloned().collect();
    let layout = CsvLayout { header: file.header, ..CsvLayout::default() };
    let columns = read_csv(&data, layout, &wanted, file.time_column.as_ref().map(|_| 1))?;
    let inside: Vec<f64> = match columns.get(1) {
        None => columns[0].clone(),
        Some(times) => {
            let pairs = columns[0].iter().zip(times);
            pairs.filter(|(_, t)| (start_s..=end_s).contains(*t)).map(|(v, _)| *v).collect()
        }
    };
    if inside.is_empty() {
        let expected = format!("speeds between {start_s} and {end_s} s, where the recording is");
        return Err(SignalError::data(&data, None, "time", expected, "none"));
    }
    let step_s = (end_s - start_s) / samples.saturating_sub(1).max(1) as f64;
    let instants: Vec<f64> = (0..samples).map(|k| start_s + k as f64 * step_s).collect();
    let series = columns.get(1).map(|times| at_instants(times, &columns[0], &instants));
    Ok(Some(Speeds { used: inside, series }))
}

/// Straight lines between stamps at most [`MAX_SPEED_GAP_S`] apart, the nearest value up to half of that from a lonely
/// one, NaN where there is none.
fn at_instants(stamps_s: &[f64], values: &[f64], instants_s: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..stamps_s.len()).filter(|i| values[*i].is_finite()).collect();
    order.sort_by(|a, b| stamps_s[*a].total_cmp(&stamps_s[*b]));
    let known: Vec<(f64, f64)> = order.iter().map(|i| (stamps_s[*i], values[*i])).collect();
    let held = |(at, v): &(f64, f64), t: f64| ((t - at).abs() <= MAX_SPEED_GAP_S / 2.0).then_some(*v);
    let at = |t: f64| -> Option<f64> {
        let after = known.partition_point(|(at, _)| *at <= t);
        match (after.checked_sub(1).and_then(|i| known.get(i)), known.get(after)) {
            (Some((a, va)), Some((b, vb))) if b - a <= MAX_SPEED_GAP_S => {
                Some(va + (vb - va) * (t - a) / (b - a))
            }
            (before, next) => before.and_then(|p| held(p, t)).or_else(|| next.and_then(|p| held(p, t))),
        }
    };
    instants_s.iter().map(|t| at(*t).unwrap_or(f64::NAN)).collect()
}

/// Mean and spread in m/s of a series in a unit.
fn speed(series: &[f64], unit: f64, path: &Path) -> Result<(Option<f64>, Option<f64>), SignalError> {
    let n = series.len() as f64;
    let mean = series.iter().sum::<f64>() / n;
    let spread = (series.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt();
    if !(mean > 0.0 && mean.is_finite()) {
        let found = format!("{} m/s", mean * unit);
        return Err(SignalError::field(path, "speed", "a positive mean speed", found));
    }
    Ok((Some(mean * unit), Some(spread * unit)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_log_of_speeds_is_read_between_its_stamps_and_not_over_its_gaps() {
        let (stamps, speeds) = ([0.0, 1.0, 2.0, 20.0, 21.0], [10.0, 12.0, 12.0, 4.0, 6.0]);
        let asked = [-3.0, -2.0, 0.25, 1.5, 2.0, 4.0, 10.0, 18.0, 20.5, 23.0, 24.0];
        let got = at_instants(&stamps, &speeds, &asked);
        // lines inside, the nearest for 2.5 s about a gap and the ends, nothing beyond
        let expected =
            [None, Some(10.0), Some(10.5), Some(12.0), Some(12.0), Some(12.0), None, Some(4.0), Some(5.0)];
        let expected = expected.into_iter().chain([Some(6.0), None]);
        for ((t, v), e) in asked.iter().zip(&got).zip(expected) {
            assert!(e.map_or(v.is_nan(), |e: f64| (v - e).abs() < 1e-12), "{t} s: {v}, expected {e:?}");
        }
        assert!(at_instants(&[], &[], &[1.0])[0].is_nan());
    }
}
