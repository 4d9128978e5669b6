//! The road that a [`RoadSpec`] describes.

use super::spec::need;
use super::{Coherence, FilterOutput, FilterVariable, Road, RoadError, RoadKind, RoadSpec, Shapes};
use super::{ShapingFilter, Spectrum};
use crate::linalg::{C64, Mat};
use crate::units::{Convention, rad_per_s};

impl RoadSpec {
    /// `table`: the spectrum of a `table`'s data file.
    pub(super) fn build_with(&self, table: Option<Spectrum>) -> Result<Road, RoadError> {
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
