//! Roads as they are written in files.

use super::{Coherence, IsoClass, Road, RoadError, Shapes, ShapingFilter, Spectrum};
use crate::files::{FileError, read_text};
use crate::linalg::{C64, Mat};
use crate::units::{Convention, rad_per_s};
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
        let mut spec: RoadSpec = crate::files::read_toml(path)?;
        if let Some(data) = &mut spec.data {
            *data = path.parent().unwrap_or(Path::new(".")).join(&*data);
        }
        let road = spec.build_in(path)?;
        Ok((spec, road))
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

    fn build_with(&self, table: Option<Spectrum>) -> Result<Road, RoadError> {
        let spectrum = match self.kind {
            RoadKind::Iso8608 => {
                self.only(
                    "iso8608",
                    &[
                        "class",
                        "roughness_m3",
                        "reference_rad_per_m",
                        "exponent",
                        "band_rad_per_m",
                        "convention",
                    ],
                )?;
                let roughness = match (self.class, self.roughness_m3) {
                    (Some(class), None) => {
                        if let Some(other) = self.reference_rad_per_m.filter(|r| *r != 1.0) {
                            let expected = "1, where a class gives the roughness, or a roughness_m3 there";
                            let found = other.to_string();
                            return Err(RoadError::Field { field: "reference_rad_per_m", expected, found });
                        }
                        // a class is one-sided per rad/m; the paper writes that number into its own convention
                        match self.convention.unwrap_or_default() {
                            Convention::Paper => class.roughness_m3(),
                            other => other.density(
                                Convention::OneSidedRadPerM.two_sided_time(class.roughness_m3(), 1.0),
                                1.0,
                            ),
                        }
                    }
                    (None, Some(r)) => r,
                    (class, _) => {
                        let found = if class.is_some() { "both" } else { "neither" };
                        let expected = "either a class or a roughness_m3";
                        return Err(RoadError::Field { field: "class", expected, found: found.to_owned() });
                    }
                };
                Spectrum::power_law(
                    roughness,
                    self.reference_rad_per_m.unwrap_or(1.0),
                    self.exponent.unwrap_or(2.0),
                    need("band_rad_per_m", self.band_rad_per_m)?,
                    self.convention.unwrap_or_default(),
                )?
            }
            RoadKind::SplitPowerLaw => {
                let fields = [
                    "level",
                    "corner_cycles_per_m",
                    "exponent_below",
                    "exponent_above",
                    "band_rad_per_m",
                    "convention",
                ];
                self.only("split-power-law", &fields)?;
                Spectrum::split_power_law(
                    need("level", self.level)?,
                    rad_per_s(need("corner_cycles_per_m", self.corner_cycles_per_m)?),
                    [
                        need("exponent_below", self.exponent_below)?,
                        need("exponent_above", self.exponent_above)?,
                    ],
                    need("band_rad_per_m", self.band_rad_per_m)?,
                    self.convention.unwrap_or_default(),
                )?
            }
            RoadKind::FirstOrder => {
                self.only("first-order", &["gain", "corner_rad_per_m"])?;
                Spectrum::first_order(
                    need("gain", self.gain)?,
                    need("corner_rad_per_m", self.corner_rad_per_m)?,
                )?
            }
            RoadKind::WhiteVelocity => {
                let fields = ["intensity_m2_per_s", "roughness_m3", "reference_cycles_per_m"];
                self.only("white-velocity", &fields)?;
                match (self.intensity_m2_per_s, self.roughness_m3) {
                    (Some(w), None) => Spectrum::white_velocity(w)?,
                    (None, Some(kappa)) => Spectrum::white_velocity_road(
                        kappa,
                        need("reference_cycles_per_m", self.reference_cycles_per_m)?,
                    )?,
                    (w, _) => {
                        let found = if w.is_some() { "both" } else { "neither" };
                        let expected =
                            "either intensity_m2_per_s, or roughness_m3 with reference_cycles_per_m";
                        let field = "intensity_m2_per_s";
                        return Err(RoadError::Field { field, expected, found: found.to_owned() });
                    }
                }
            }
            RoadKind::Table => {
                self.only("table", &["data", "convention"])?;
                need("data", table)?
            }
            RoadKind::Filter => {
                let fields =
                    ["a", "b", "c", "d", "poles", "zeros", "gain", "of", "variable", "fitted_band_rad"];
                self.only("filter", &fields)?;
                super::matrix_filter::check_fitted_band(self.fitted_band_rad)?;
                Spectrum::Filter(self.filter()?)
            }
        };
        let coherence = match &self.coherence {
            None => Coherence::Full,
            Some(c) => c.build()?,
        };
        Ok(Road::new(spectrum, coherence))
    }

    fn filter(&self) -> Result<ShapingFilter, RoadError> {
        let of = match need("of", self.of)? {
            FilterOutput::Displacement => Shapes::Height,
            FilterOutput::Velocity => Shapes::Velocity,
        };
        let over_distance = need("variable", self.variable)? == FilterVariable::Distance;
        let complex = |v: &[[f64; 2]]| v.iter().map(|z| C64::new(z[0], z[1])).collect::<Vec<_>>();
        let by_roots = match &self.poles {
            None => None,
            Some(poles) => {
                let zeros = complex(self.zeros.as_deref().unwrap_or_default());
                Some((zeros, complex(poles), need("gain", self.gain)?))
            }
        };
        if let (Some((zeros, poles, gain)), None) = (&by_roots, &self.a) {
            return ShapingFilter::from_zeros_poles(zeros, poles, *gain, of, over_distance);
        }
        let rows = need("a", self.a.clone())?;
        if let Some(row) = rows.iter().find(|r| r.len() != rows.len()) {
            let found = format!("{} rows, one of {}", rows.len(), row.len());
            return Err(RoadError::Field { field: "a", expected: "a square matrix", found });
        }
        let a = Mat::from_fn(rows.len(), rows.len(), |i, j| rows[i][j]);
        let (b, c, d) = (need("b", self.b.clone())?, need("c", self.c.clone())?, self.d.unwrap_or(0.0));
        let filter = ShapingFilter::new(a, b, c, d, of, over_distance)?;
        if let Some((zeros, poles, gain)) = by_roots {
            agree(&filter, &zeros, &poles, gain)?;
        }
        Ok(filter)
    }

    /// Refuses fields of other kinds.
    fn only(&self, kind: &'static str, fields: &[&str]) -> Result<(), RoadError> {
        let Ok(serde_json::Value::Object(map)) = serde_json::to_value(self) else { return Ok(()) };
        match map.keys().find(|k| *k != "kind" && *k != "coherence" && !fields.contains(&k.as_str())) {
            None => Ok(()),
            Some(field) => Err(RoadError::Stray { field: field.clone(), kind, allowed: fields.join(", ") }),
        }
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

fn need<T>(field: &'static str, value: Option<T>) -> Result<T, RoadError> {
    value.ok_or(RoadError::Field {
        field,
        expected: "this field, which the kind of road needs",
        found: "none".into(),
    })
}

/// Refuses poles, zeros and a gain beside a state space of another |G|, at the frequencies of its poles.
fn agree(filter: &ShapingFilter, zeros: &[C64], poles: &[C64], gain: f64) -> Result<(), RoadError> {
    /// Files may be written with nine digits.
    const ALIKE: f64 = 1e-6;
    let velocity = filter.of() == Shapes::Velocity;
    for omega in poles.iter().map(|p| p.norm()).filter(|w| *w > 0.0) {
        let s = C64::new(0.0, omega);
        let product = |roots: &[C64]| roots.iter().map(|r| s - r).product::<C64>();
        let by_roots = (product(zeros) / product(poles) * gain).norm_sqr();
        let by_states = filter.height_psd(omega, 1.0) * if velocity { omega * omega } else { 1.0 };
        if !((by_roots / by_states - 1.0).abs() < ALIKE) {
            let expected = "poles, zeros and gain of the filter that a, b, c and d are, or only one of both";
            let found = format!("|G|^2 of {by_roots:e} beside {by_states:e} at {omega}");
            return Err(RoadError::Field { field: "poles", expected, found });
        }
    }
    Ok(())
}

/// A table from a CSV with a frequency column `nu_rad_per_m` or `n_cycles_per_m` and a column `psd`, one-sided densities
/// per that unit unless a convention is given.
fn read_table(path: &Path, convention: Option<Convention>) -> Result<Spectrum, FileError> {
    let text = read_text(path)?;
    let fail = |line: usize, message: String| FileError::content(path, Some(line), message);
    let mut lines = text.lines().enumerate().filter(|(_, l)| !l.trim().is_empty());
    let (_, header) = lines
        .next()
        .ok_or_else(|| FileError::content(path, None, "expected a header line, found an empty file"))?;
    let names: Vec<&str> = header.split(',').map(str::trim).collect();
    let column = |name: &str| names.iter().position(|n| *n == name);
    let (x, per_cycle) = match (column("nu_rad_per_m"), column("n_cycles_per_m")) {
        (Some(x), None) => (x, false),
        (None, Some(x)) => (x, true),
        _ => {
            return Err(fail(
                1,
                format!("expected one column nu_rad_per_m or n_cycles_per_m, found {header:?}"),
            ));
        }
    };
    let y = column("psd").ok_or_else(|| fail(1, format!("expected a column psd, found {header:?}")))?;
    let (mut nu, mut density) = (Vec::new(), Vec::new());
    for (index, line) in lines {
        let fields: Vec<&str> = line.split(',').map(str::trim).collect();
        if fields.len() != names.len() {
            return Err(fail(index + 1, format!("expected {} fields, found {}", names.len(), fields.len())));
        }
        let number = |i: usize| {
            fields[i].parse::<f64>().map_err(|_| {
                fail(index + 1, format!("{}: expected a number, found {:?}", names[i], fields[i]))
            })
        };
        nu.push(if per_cycle { rad_per_s(number(x)?) } else { number(x)? });
        density.push(number(y)?);
    }
    let written = if per_cycle { Convention::OneSidedCyclesPerM } else { Convention::OneSidedRadPerM };
    Spectrum::table(nu, density, convention.unwrap_or(written))
        .map_err(|e| FileError::content(path, None, e.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::parse_toml;

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
