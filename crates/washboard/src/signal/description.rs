//! RUN.toml: what a data file holds, as its owner declares it.

use super::{Direction, Place, Quantity, SpeedUnit, Unit, WheelPlace};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::path::PathBuf;

/// A column of the data file: by its header, or by its number from 0.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged, expecting = "expected a column's header name or its number, counted from 0")]
pub enum Column {
    /// Its number, counted from 0.
    Index(usize),
    /// Its header.
    Name(String),
}

impl fmt::Display for Column {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Column::Index(i) => write!(f, "column {i}"),
            Column::Name(name) => write!(f, "column `{}`", name.chars().take(64).collect::<String>()),
        }
    }
}

/// The format of a data file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Format {
    /// Text, one row a sample.
    Csv,
    /// NumPy's array file.
    Npy,
    /// Mountain-bike telemetry: columns `front` and `rear`.
    Sst,
}

/// What the time stamps of a file are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Stamps {
    /// Samples are taken by a uniform clock; stamps show it late and unevenly (bursts, repeated stamps).
    #[default]
    Clock,
    /// A stamp is the instant of its sample: samples are interpolated onto a uniform clock.
    Instants,
}

/// The unit of time stamps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum TimeUnit {
    /// Seconds.
    #[default]
    #[serde(rename = "s")]
    Second,
    /// Milliseconds.
    #[serde(rename = "ms")]
    Millisecond,
    /// Microseconds.
    #[serde(rename = "us", alias = "µs")]
    Microsecond,
    /// Nanoseconds.
    #[serde(rename = "ns")]
    Nanosecond,
}

impl TimeUnit {
    /// One of it in s.
    #[must_use]
    pub fn in_s(self) -> f64 {
        match self {
            TimeUnit::Second => 1.0,
            TimeUnit::Millisecond => 1e-3,
            TimeUnit::Microsecond => 1e-6,
            TimeUnit::Nanosecond => 1e-9,
        }
    }
}

/// A second CSV file that holds the speed: a satellite receiver's log.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpeedFile {
    /// Relative to the description.
    pub data: PathBuf,
    /// Whether its first row names the columns.
    #[serde(default = "yes")]
    pub header: bool,
    /// The speed, in `speed_unit`.
    pub column: Column,
    /// Its time, in s on the recording's clock: speeds outside the recording are left out. Without it all are used.
    pub time_column: Option<Column>,
}

/// How counts become a length, where one factor cannot say it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Calibration {
    /// A magnetic angle sensor (4096 counts a turn) at the apex of an isosceles triangle whose base is the suspension:
    ///
    /// travel = max − 2 arm cos(2π n/4096 + acos(max/(2 arm))), with n = 0 for counts above 1024 (a wrapped zero).
    As5600IsoscelesTriangle {
        /// Length of either arm, in mm.
        arm_mm: f64,
        /// Base at full extension, in mm; less than 2 arm.
        max_mm: f64,
    },
}

impl Calibration {
    /// The length in m of a count; NaN for a triangle that cannot be.
    #[must_use]
    pub fn metres(self, counts: f64) -> f64 {
        let Calibration::As5600IsoscelesTriangle { arm_mm, max_mm } = self;
        let start = (max_mm / 2.0 / arm_mm).acos();
        let counts = if counts > 1024.0 { 0.0 } else { counts };
        1e-3 * (max_mm - 2.0 * arm_mm * (std::f64::consts::TAU / 4096.0 * counts + start).cos())
    }
}

/// One `[[channel]]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ChannelDescription {
    /// Where its samples are.
    pub column: Column,
    /// The channel's name, where it is not the column's.
    pub name: Option<String>,
    /// What is measured.
    pub quantity: Quantity,
    /// In which unit.
    pub unit: Unit,
    /// With `unit = "counts"`: the size of one count, in SI or in `scale_unit`.
    pub scale: Option<f64>,
    /// The unit of `scale`.
    pub scale_unit: Option<Unit>,
    /// With `unit = "counts"`: another way than `scale`.
    pub calibration: Option<Calibration>,
    /// Along (or about) which axis.
    pub direction: Direction,
    /// On which body.
    pub place: Place,
    /// At which wheel, by name.
    pub wheel: Option<String>,
    /// Or where: x forward, y left, in m.
    pub at_m: Option<[f64; 2]>,
}

/// A whole RUN.toml; see [`read_recording`](super::read_recording).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordingDescription {
    /// The data file, relative to the description.
    pub data: PathBuf,
    /// Its format, where the extension does not say it.
    pub format: Option<Format>,
    /// CSV: whether the first row names the columns.
    pub header: Option<bool>,
    /// CSV: what stands between fields.
    pub delimiter: Option<char>,
    /// Samples per second of a uniform clock.
    pub rate_hz: Option<f64>,
    /// Or the column of time stamps.
    pub time_column: Option<Column>,
    /// The unit of the stamps: s.
    pub time_unit: Option<TimeUnit>,
    /// What the stamps are: a clock's.
    pub stamps: Option<Stamps>,
    /// The part to use, from and to in s on the file's clock (with `rate_hz`: from the first sample).
    pub span_s: Option<[f64; 2]>,
    /// Mean forward speed.
    pub speed_m_s: Option<f64>,
    /// Or the column that holds it.
    pub speed_column: Option<Column>,
    /// Or another file that does.
    pub speed_file: Option<SpeedFile>,
    /// The unit of that column.
    pub speed_unit: Option<SpeedUnit>,
    /// The wheels.
    #[serde(default, rename = "wheel")]
    pub wheels: Vec<WheelPlace>,
    /// The channels.
    #[serde(rename = "channel")]
    pub channels: Vec<ChannelDescription>,
}

fn yes() -> bool {
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::parse_toml;
    use std::path::Path;

    const RUN: &str = r#"
data = "RUN.csv"
rate_hz = 200.0
speed_m_s = 20.0
[[wheel]]
name = "front-left"
at_m = [1.064, 0.745]
[[channel]]
column = "body_fl"
quantity = "acceleration"
unit = "m/s^2"
direction = "+z"
place = "body"
wheel = "front-left"
"#;

    fn parse(text: &str) -> Result<RecordingDescription, String> {
        parse_toml(text, Path::new("RUN.toml")).map_err(|e| e.to_string())
    }

    #[test]
    fn the_documented_file_is_read() {
        let d = parse(RUN).unwrap();
        assert_eq!(d.wheels[0].at_m, [1.064, 0.745]);
        assert_eq!(d.channels[0].column, Column::Name("body_fl".to_owned()));
        assert_eq!(d.channels[0].direction, Direction::PlusZ);
        assert_eq!(parse(&RUN.replace("\"body_fl\"", "3")).unwrap().channels[0].column, Column::Index(3));
    }

    #[test]
    fn a_wrong_or_missing_word_is_named_with_its_line() {
        for (from, to, parts) in [
            ("unit = \"m/s^2\"", "", ["RUN.toml:8", "missing field `unit`"]),
            ("direction = \"+z\"", "", ["RUN.toml:8", "missing field `direction`"]),
            ("\"+z\"", "\"z\"", ["RUN.toml:12", "expected one of `+x`, `-x`"]),
            ("\"m/s^2\"", "\"m/s^3\"", ["RUN.toml:11", "did you mean `m/s^2`?"]),
            ("rate_hz", "rate_hx", ["RUN.toml:3", "did you mean `rate_hz`?"]),
            ("\"body_fl\"", "-3", ["RUN.toml:9", "expected a column's header name"]),
        ] {
            let e = parse(&RUN.replace(from, to)).unwrap_err();
            assert!(parts.iter().all(|p| e.contains(p)), "{e}");
        }
    }

    #[test]
    fn the_triangle_starts_at_zero_and_follows_its_formula() {
        let fork = Calibration::As5600IsoscelesTriangle { arm_mm: 134.9375, max_mm: 234.15625 };
        assert!(fork.metres(0.0).abs() < 1e-15 && fork.metres(2000.0).abs() < 1e-15);
        // by hand: 491 counts are 0.75318 rad; start acos(.86765) = .52066
        assert!((fork.metres(491.0) - 0.155_108).abs() < 1e-6);
    }
}
