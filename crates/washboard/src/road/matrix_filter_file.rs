//! Matrix filters as they are written in files.

use super::{FilterOutput, FilterVariable, MatrixFilter, RoadError, Shapes};
use crate::files::{FileError, parse_toml};
use crate::linalg::Mat;
use crate::lti::StateSpace;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A road file of kind `matrix-filter`. [`MatrixFilterSpec::build`] makes the [`MatrixFilter`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MatrixFilterSpec {
    /// `matrix-filter`.
    pub kind: MatrixFilterKind,
    /// What the outputs are.
    pub of: FilterOutput,
    /// What it runs over.
    pub variable: FilterVariable,
    /// Names of the vehicle's road inputs, one a row of c; left out, they are the vehicle's in its own order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub points: Vec<String>,
    /// Band of the data that it was fitted to, rad/s, or rad/m over distance.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fitted_band_rad: Option<[f64; 2]>,
    /// Rows, n × n.
    pub a: Vec<Vec<f64>>,
    /// Rows, n × noises.
    pub b: Vec<Vec<f64>>,
    /// Rows, points × n.
    pub c: Vec<Vec<f64>>,
    /// Rows, points × noises; zero where left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub d: Option<Vec<Vec<f64>>>,
}

/// The one word that `kind` is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MatrixFilterKind {
    /// `matrix-filter`.
    MatrixFilter,
}

/// The kind as it is written.
const KIND: &str = "matrix-filter";

/// The `kind` of a road file, whatever else stands there.
#[derive(Deserialize)]
struct Kind {
    kind: Option<toml::Value>,
}

impl MatrixFilterSpec {
    /// Whether a road file's text is of this kind, or means to be.
    #[must_use]
    pub fn is_meant(text: &str) -> bool {
        let Ok(Kind { kind: Some(toml::Value::String(kind)) }) = toml::from_str(text) else { return false };
        crate::files::nearest(&kind, [KIND, "filter"].into_iter()) == Some(KIND)
    }

    /// The filter of a file's text; `path` is for messages.
    ///
    /// # Errors
    /// Text that is none, or a field that is impossible, each with the file's name.
    pub fn parse(text: &str, path: &Path) -> Result<(Self, MatrixFilter), FileError> {
        let spec: MatrixFilterSpec = parse_toml(text, path)?;
        let filter = spec.build().map_err(|e| FileError::content(path, None, e.to_string()))?;
        Ok((spec, filter))
    }

    /// The filter.
    ///
    /// # Errors
    /// Rows of unequal length, sizes that do not fit, numbers that are not finite, and what [`MatrixFilter::new`] refuses.
    pub fn build(&self) -> Result<MatrixFilter, RoadError> {
        let (n, m) = (self.a.len(), self.c.len());
        let noises = self.b.first().or(self.d.as_ref().and_then(|d| d.first())).map_or(0, Vec::len);
        let a = matrix("a", "a square matrix of finite numbers", &self.a, [n, n])?;
        let b = matrix("b", "as many rows as a, of one length, finite", &self.b, [n, noises])?;
        let c = matrix("c", "rows as long as a, finite", &self.c, [m, n])?;
        let d = match &self.d {
            Some(d) => matrix("d", "as many rows as c, as long as those of b, finite", d, [m, noises])?,
            None => Mat::zeros(m, noises),
        };
        let system = StateSpace::continuous(a, b, c, d).map_err(|e| RoadError::Field {
            field: "a, b, c, d",
            expected: "matrices whose sizes fit",
            found: e.to_string(),
        })?;
        let of = match self.of {
            FilterOutput::Displacement => Shapes::Height,
            FilterOutput::Velocity => Shapes::Velocity,
        };
        let over_distance = self.variable == FilterVariable::Distance;
        MatrixFilter::new(system, of, over_distance, self.points.clone(), self.fitted_band_rad)
    }
}

fn matrix(
    field: &'static str,
    expected: &'static str,
    rows: &[Vec<f64>],
    [n, m]: [usize; 2],
) -> Result<Mat, RoadError> {
    let fail = |found: String| Err(RoadError::Field { field, expected, found });
    if rows.len() != n {
        return fail(format!("{} rows where {n} belong", rows.len()));
    }
    for (i, row) in rows.iter().enumerate() {
        if row.len() != m {
            return fail(format!("{} numbers in row {} where {m} belong", row.len(), i + 1));
        }
        if let Some(v) = row.iter().find(|v| !v.is_finite()) {
            return fail(format!("{v} in row {}", i + 1));
        }
    }
    Ok(Mat::from_fn(n, m, |i, j| rows[i][j]))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TWO: &str = "kind = \"matrix-filter\"\nof = \"displacement\"\nvariable = \"time\"\npoints = [\"l\", \"r\"]\n\
        fitted_band_rad = [0.1, 50.0]\na = [[-1.0, 0.5], [0.0, -3.0]]\nb = [[1.0, 0.0], [0.3, 2.0]]\nc = [[1.0, 0.0], [0.2, 1.0]]\n";

    fn parse(text: &str) -> Result<MatrixFilter, String> {
        MatrixFilterSpec::parse(text, Path::new("f.toml")).map(|(_, f)| f).map_err(|e| e.to_string())
    }

    #[test]
    fn a_file_is_written_and_read_back_to_the_last_bit() {
        let (spec, filter) = MatrixFilterSpec::parse(TWO, Path::new("f.toml")).unwrap();
        assert!(MatrixFilterSpec::is_meant(TWO));
        assert!(
            MatrixFilterSpec::is_meant("kind = \"matrix-fliter\"")
                && !MatrixFilterSpec::is_meant("kind = \"filter\"")
        );
        let text = toml::to_string(&spec).unwrap();
        assert_eq!(parse(&text).unwrap(), filter);
        assert_eq!((filter.size(), filter.band_rad()), (2, Some([0.1, 50.0])));
    }

    #[test]
    fn outputs_are_found_by_their_names() {
        let filter = parse(TWO).unwrap();
        let names = |n: &[&str]| n.iter().map(|s| (*s).to_owned()).collect::<Vec<_>>();
        let turned = filter.in_order(&names(&["r", "l"])).unwrap();
        let (s, t) = (filter.height_spectrum(2.0), turned.height_spectrum(2.0));
        assert_eq!((s[(0, 0)], s[(0, 1)]), (t[(1, 1)], t[(1, 0)]));
        // S_ij = E[r_i* r_j]: the upper corner of G* Gᵀ by hand at one frequency
        let iw = crate::linalg::C64::new(0.0, 2.0);
        let x2 = [0.3 / (iw + 3.0), 2.0 / (iw + 3.0)];
        let x1 = [(1.0 + 0.5 * x2[0]) / (iw + 1.0), 0.5 * x2[1] / (iw + 1.0)];
        let y2 = [0.2 * x1[0] + x2[0], 0.2 * x1[1] + x2[1]];
        let known = x1[0].conj() * y2[0] + x1[1].conj() * y2[1];
        assert!((s[(0, 1)] - known).norm() < 1e-14 * known.norm(), "{} {known}", s[(0, 1)]);
        let e = filter.in_order(&names(&["a", "b", "c", "d"])).unwrap_err().to_string();
        assert!(e.contains("2 points, 4 road inputs (a, b, c, d)"), "{e}");
        let e = filter.in_order(&names(&["l", "x"])).unwrap_err().to_string();
        assert!(e.contains("found l, r; the vehicle has l, x"), "{e}");
    }

    #[test]
    fn over_distance_is_the_same_road_at_any_speed() {
        let filter = parse(&TWO.replace("\"time\"", "\"distance\"")).unwrap();
        let at = |v: f64, omega: f64| filter.over_time(v).unwrap().height_spectrum(omega);
        // S(ω) = S(ν)/v at ν = ω/v
        let (one, ten) = (at(1.0, 0.7), at(10.0, 7.0));
        assert!((one[(0, 1)] / 10.0 - ten[(0, 1)]).norm() < 1e-15 * one[(0, 1)].norm());
        let slope =
            parse(&TWO.replace("\"time\"", "\"distance\"").replace("\"displacement\"", "\"velocity\""))
                .unwrap();
        let (one, ten) = (
            slope.over_time(1.0).unwrap().height_spectrum(0.7),
            slope.over_time(10.0).unwrap().height_spectrum(7.0),
        );
        assert!((one[(0, 1)] / 10.0 - ten[(0, 1)]).norm() < 1e-14 * one[(0, 1)].norm());
    }

    #[test]
    fn a_velocity_that_vanishes_at_rest_is_a_height() {
        // s/(s + 1)/(s + 2) of velocity is 1/(s + 1)/(s + 2) of height
        let text = "kind = \"matrix-filter\"\nof = \"velocity\"\nvariable = \"time\"\n\
            a = [[0.0, 1.0], [-2.0, -3.0]]\nb = [[0.0], [1.0]]\nc = [[0.0, 1.0]]\n";
        let height = parse(text).unwrap().as_height();
        assert_eq!(height.of(), Shapes::Height);
        let s = crate::linalg::C64::new(0.0, 3.0);
        let known = (1.0 / ((s + 1.0) * (s + 2.0))).norm_sqr();
        assert!((height.height_spectrum(3.0)[(0, 0)].re / known - 1.0).abs() < 1e-14);
        let wandering = parse(&text.replace("[[0.0, 1.0]]\n", "[[1.0, 1.0]]\n")).unwrap();
        assert_eq!(wandering.as_height().of(), Shapes::Velocity);
    }

    #[test]
    fn wrong_files_are_refused_by_field() {
        for (from, to, expected) in [
            (
                "[-1.0, 0.5]",
                "[1.0, 0.5]",
                "a: expected a stable filter (all poles with negative real part), found a pole with real part 1",
            ),
            (
                "[-1.0, 0.5]",
                "[nan, 0.5]",
                "a: expected a square matrix of finite numbers, found NaN in row 1",
            ),
            (
                "[-1.0, 0.5]",
                "[-1.0]",
                "a: expected a square matrix of finite numbers, found 1 numbers in row 1 where 2 belong",
            ),
            (
                "b = [[1.0, 0.0], ",
                "b = [",
                "b: expected as many rows as a, of one length, finite, found 1 rows where 2 belong",
            ),
            (
                "c = [[1.0, 0.0], ",
                "c = [[1.0], ",
                "c: expected rows as long as a, finite, found 1 numbers in row 1 where 2 belong",
            ),
            (
                "points = [\"l\", ",
                "points = [",
                "points: expected one name a row of c, found 1 names for 2 rows of c",
            ),
            ("\"l\", \"r\"", "\"l\", \"l\"", "points: expected every name once, found `l` twice"),
            ("[0.1, 50.0]", "[50.0, 0.1]", "fitted_band_rad: expected two ascending frequencies"),
            (
                "c = [[1.0, 0.0], [0.2, 1.0]]",
                "c = [[1.0, 0.0], [0.2, 1.0]]\nd = [[0.0, 0.0]]",
                "d: expected as many rows as c",
            ),
            ("of = \"displacement\"\n", "", "missing field `of`"),
            ("points", "point", "unknown field `point`"),
        ] {
            assert!(TWO.contains(from), "{from}");
            let e = parse(&TWO.replace(from, to)).unwrap_err();
            assert!(e.starts_with("f.toml") && e.contains(expected), "{to}: {e}");
        }
    }
}
