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

/// The recording that a RUN.toml describes.
///
/// In this order: the wanted columns are read; the part `span_s` is cut out; time stamps become a uniform clock and
/// missing samples are filled or the longest whole piece is used; units become SI; constant channels are left out and
/// clipped ones told; the speed is averaged over the part used. Whatever is changed on the way is in
/// [`Recording::repairs`].
///
/// # Errors
/// A description with an unknown, missing or contradicting field; a unit that is not one of the channel's quantity; a
/// data file that is not what is declared: each names file, field or line and column, what was expected and found.
///
/// Format: `docs/interface.md`, "Recording".
pub fn read_recording(path: &Path) -> Result<Recording, SignalError> {
    let description: RecordingDescription = read_toml(path)?;
    check(&description, path)?;
    let conversions = description.channels.iter().map(|c| to_si(c, path)).collect::<Result<Vec<_>, _>>()?;
    let mut channels = channels(&description, path)?;
    let table = read_table(&description, path)?;
    let laid = laid(&description, table, path)?;
    let (mut samples, mut repairs) = (laid.columns, laid.repairs);
    let speeds = match description.speed_column {
        Some(_) => samples.pop(),
        None => speed_file(&description, path, laid.start_s, laid.end_s)?,
    };
    for (series, si) in samples.iter_mut().zip(&conversions) {
        series.iter_mut().for_each(|x| *x = si(*x));
    }
    leave_out_dead(&mut channels, &mut samples, &mut repairs)?;
    tell_clipped(&channels, &samples, laid.rate_hz, &mut repairs);
    let (speed, spread) = speed(&description, speeds, path)?;
    let recording = Recording::new(laid.rate_hz, speed, description.wheels, channels, samples)?;
    let recording = match spread {
        Some(spread) => recording.with_speed_spread(spread)?,
        None => recording,
    };
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

/// The speeds of another file within a span of the recording's clock.
fn speed_file(
    d: &RecordingDescription,
    path: &Path,
    start_s: f64,
    end_s: f64,
) -> Result<Option<Vec<f64>>, SignalError> {
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
    Ok(Some(inside))
}

/// Mean and spread in m/s.
fn speed(
    d: &RecordingDescription,
    measured: Option<Vec<f64>>,
    path: &Path,
) -> Result<(Option<f64>, Option<f64>), SignalError> {
    let Some(series) = measured else { return Ok((d.speed_m_s, None)) };
    let unit = d.speed_unit.map_or(1.0, SpeedUnit::in_m_s);
    let n = series.len() as f64;
    let mean = series.iter().sum::<f64>() / n;
    let spread = (series.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt();
    if !(mean > 0.0 && mean.is_finite()) {
        let found = format!("{} m/s", mean * unit);
        return Err(SignalError::field(path, "speed", "a positive mean speed", found));
    }
    Ok((Some(mean * unit), Some(spread * unit)))
}
