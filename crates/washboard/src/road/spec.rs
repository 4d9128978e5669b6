//! Roads as they are written in files.

use super::spec_table::read_table;
use super::{Coherence, IsoClass, Road, RoadError};
use crate::files::{FileError, parse_toml};
use crate::units::Convention;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// A road file: `kind`, that kind's fields, and `[coherence]`. [`RoadSpec::build`] makes the [`Road`].
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(missing_docs)] // the fields are those of docs/interface.md
pub struct RoadSpec {
    pub kind: RoadKind,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub class: Option<IsoClass>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub roughness_m3: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reference_rad_per_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reference_cycles_per_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exponent: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub level: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub corner_cycles_per_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exponent_below: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exponent_above: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub band_rad_per_m: Option<[f64; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub convention: Option<Convention>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub corner_rad_per_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub intensity_m2_per_s: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub data: Option<PathBuf>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub a: Option<Vec<Vec<f64>>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub b: Option<Vec<f64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub c: Option<Vec<f64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub d: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub poles: Option<Vec<[f64; 2]>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub zeros: Option<Vec<[f64; 2]>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gain: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub of: Option<FilterOutput>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub variable: Option<FilterVariable>,
    /// Band of the data that a filter was fitted to, rad/s, or rad/m over distance.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fitted_band_rad: Option<[f64; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coherence: Option<CoherenceSpec>,
}

/// The kinds of road.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[allow(missing_docs)]
pub enum RoadKind {
    #[default]
    Iso8608,
    SplitPowerLaw,
    FirstOrder,
    WhiteVelocity,
    Table,
    Filter,
}

/// What a filter's output is, as written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[allow(missing_docs)]
pub enum FilterOutput {
    Displacement,
    Velocity,
}

/// What a filter runs over, as written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[allow(missing_docs)]
pub enum FilterVariable {
    Time,
    Distance,
}

/// The `[coherence]` table.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CoherenceSpec {
    /// `bogsjo`, `full`, `none` or `independent`.
    pub kind: CoherenceKind,
    /// μ of `bogsjo`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mu: Option<f64>,
}

/// The kinds of coherence.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[allow(missing_docs)]
pub enum CoherenceKind {
    Bogsjo,
    Full,
    None,
    Independent,
}

impl RoadSpec {
    /// Reads a road file; a `table`'s data file is found relative to it.
    ///
    /// # Errors
    /// The file's, or the road's with the file's name.
    pub fn read(path: &Path) -> Result<(Self, Road), FileError> {
        let mut spec = Self::parse(&crate::files::read_text(path)?, path)?;
        if let Some(data) = &mut spec.data {
            *data = path.parent().unwrap_or(Path::new(".")).join(&*data);
        }
        let road = spec.build_in(path)?;
        Ok((spec, road))
    }

    /// A road from TOML text; `path` is only for messages.
    ///
    /// # Errors
    /// As [`parse_toml`].
    pub fn parse(text: &str, path: &Path) -> Result<Self, FileError> {
        parse_toml(text, path).map_err(of_a_matrix)
    }

    /// The road, errors carrying the name of the file that it came from.
    ///
    /// # Errors
    /// See [`RoadSpec::build`] and [`read_table`].
    pub fn build_in(&self, path: &Path) -> Result<Road, FileError> {
        let table = match (&self.kind, &self.data) {
            (RoadKind::Table, Some(data)) => Some(read_table(data, self.convention)?),
            _ => None,
        };
        self.build_with(table).map_err(|e| FileError::content(path, None, e.to_string()))
    }

    /// The road of a spec that needs no data file.
    ///
    /// # Errors
    /// A field that is missing, stray or impossible.
    pub fn build(&self) -> Result<Road, RoadError> {
        self.build_with(None)
    }
}

impl CoherenceSpec {
    /// `kind = "bogsjo"`.
    #[must_use]
    pub fn bogsjo(mu: f64) -> Self {
        CoherenceSpec { kind: CoherenceKind::Bogsjo, mu: Some(mu) }
    }

    /// The coherence.
    ///
    /// # Errors
    /// A μ that is missing, stray or impossible.
    pub fn build(&self) -> Result<Coherence, RoadError> {
        match (self.kind, self.mu) {
            (CoherenceKind::Bogsjo, mu) => Coherence::bogsjo(need("mu", mu)?),
            (_, Some(mu)) => Err(RoadError::Field {
                field: "mu",
                expected: "no mu, which belongs to `bogsjo`",
                found: mu.to_string(),
            }),
            (CoherenceKind::Full, None) => Ok(Coherence::Full),
            (CoherenceKind::None, None) => Ok(Coherence::None),
            (CoherenceKind::Independent, None) => Ok(Coherence::Independent),
        }
    }
}

/// A field that the kind of road needs.
pub(super) fn need<T>(field: &'static str, value: Option<T>) -> Result<T, RoadError> {
    value.ok_or(RoadError::Field {
        field,
        expected: "this field, which the kind of road needs",
        found: "none".into(),
    })
}

/// Rows where a number was expected are a matrix filter's.
fn of_a_matrix(e: FileError) -> FileError {
    match e {
        FileError::Content { path, line, message } if message.contains("invalid type: sequence") => {
            let message = format!("{message}; rows of several channels are of kind = \"matrix-filter\"");
            FileError::Content { path, line, message }
        }
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Road, String> {
        let spec: RoadSpec = parse_toml(text, Path::new("road.toml")).map_err(|e| e.to_string())?;
        spec.build().map_err(|e| e.to_string())
    }

    #[test]
    fn the_road_of_the_interface_is_read() {
        let road = parse(
            "kind = \"iso8608\"\nroughness_m3 = 16e-6\nexponent = 2.0\nband_rad_per_m = [0.063, 17.77]\n\
             convention = \"paper\"\n[coherence]\nkind = \"bogsjo\"\nmu = 3.8\n",
        )
        .unwrap();
        assert_eq!(road.coherence(), &Coherence::Bogsjo { mu: 3.8 });
        assert!((road.spectrum().psd(6.0, 20.0) - 16e-6 / 20.0 / 0.09).abs() < 1e-18);
    }

    #[test]
    fn a_class_is_the_same_road_in_every_convention_but_the_papers() {
        let psd = |convention: &str| {
            let text = format!(
                "kind = \"iso8608\"\nclass = \"C\"\nband_rad_per_m = [0.1, 10.0]\nconvention = \"{convention}\""
            );
            parse(&text).unwrap().spectrum().psd(6.0, 20.0)
        };
        let physical = psd("one-sided-rad-per-m");
        for convention in ["two-sided-rad-per-m", "one-sided-cycles-per-m", "two-sided-cycles-per-m"] {
            assert!((psd(convention) / physical - 1.0).abs() < 1e-14, "{convention}");
        }
        assert!((physical / psd("paper") - std::f64::consts::PI).abs() < 1e-14);
        let e = parse(
            "kind = \"iso8608\"\nclass = \"C\"\nreference_rad_per_m = 0.63\nband_rad_per_m = [0.1, 10.0]",
        );
        assert!(e.unwrap_err().starts_with("reference_rad_per_m: expected 1"));
    }

    #[test]
    fn wrong_roads_are_refused_by_field() {
        for (text, expected) in [
            ("kind = \"iso8608\"\nclass = \"C\"", "band_rad_per_m: expected"),
            ("kind = \"iso8608\"\nband_rad_per_m = [0.1, 10.0]", "class: expected either"),
            (
                "kind = \"iso8608\"\nclass = \"C\"\nband_rad_per_m = [10.0, 0.1]",
                "band_rad_per_m: expected two",
            ),
            (
                "kind = \"iso8608\"\nclass = \"C\"\nlevel = 1.0",
                "level: not a field of a road of kind `iso8608`",
            ),
            ("kind = \"iso\"", "unknown variant `iso`"),
            (
                "kind = \"first-order\"\ngain = -1.0\ncorner_rad_per_m = 0.1",
                "gain: expected a positive number, found -1",
            ),
            (
                "kind = \"filter\"\na = [[-0.5]]\nb = [1.0]\nc = [1.0]\npoles = [[-0.4, 0.0]]\ngain = 1.0\nof = \"displacement\"\nvariable = \"distance\"",
                "poles: expected poles, zeros and gain of the filter",
            ),
            (
                "kind = \"white-velocity\"\nintensity_m2_per_s = 1.0\n[coherence]\nkind = \"full\"\nmu = 1.0",
                "mu: expected no mu",
            ),
        ] {
            let e = parse(text).unwrap_err();
            assert!(e.contains(expected), "{text}: {e}");
        }
    }
}
