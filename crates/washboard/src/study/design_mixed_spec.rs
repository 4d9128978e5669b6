//! What the designs by matrix inequalities are told: poles, the Lyapunov scale, ranges, noise.

use super::design_goal::{above_zero, plain};
use super::{DesignMethod, DesignSpec, Named, StudyError};
use crate::synthesis::{LyapunovScale, PoleRegion};
use serde::{Deserialize, Serialize};

/// Vertices of a range: 2 to the power of its fields.
const MOST_RANGES: usize = 6;

/// Where the closed loop's poles are to be: all that is given.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PolesSection {
    /// Re s below this, which is not positive.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_real_rad_s: Option<f64>,
    /// Re s above this, which is negative.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub min_real_rad_s: Option<f64>,
    /// |Im s| below this.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_imag_rad_s: Option<f64>,
    /// |s| below this.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_abs_rad_s: Option<f64>,
    /// −Re s and |Im s| below this.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rectangle_rad_s: Option<f64>,
    /// Damping ratios above this.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub min_damping: Option<f64>,
}

/// `"searched"`, `"fixed"` (1), or a number.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(untagged, expecting = "expected \"searched\", \"fixed\" or a number")]
pub enum LyapunovScaleSpec {
    /// Chosen with everything else.
    #[default]
    #[serde(with = "word::searched")]
    Searched,
    /// The normalisation (−I, −γ²I) of published designs.
    #[serde(with = "word::fixed")]
    Fixed,
    /// So many times that.
    Number(f64),
}

/// Words of an untagged choice.
mod word {
    macro_rules! word {
        ($name:ident, $text:literal) => {
            pub mod $name {
                use serde::de::{Deserialize, Deserializer, Error};
                pub fn serialize<S: serde::Serializer>(s: S) -> Result<S::Ok, S::Error> {
                    s.serialize_str($text)
                }
                pub fn deserialize<'de, D: Deserializer<'de>>(d: D) -> Result<(), D::Error> {
                    let found = String::deserialize(d)?;
                    if found == $text { Ok(()) } else { Err(D::Error::custom(found)) }
                }
            }
        };
    }
    word!(searched, "searched");
    word!(fixed, "fixed");
}

/// Sensors and how far from the optimum the controller is.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MixedSection {
    /// Intensity of white noise on every measurement, in its unit squared times seconds, beside a disturbance of intensity 1:
    /// a part of the H2 norms.
    #[serde(default)]
    pub sensor_noise: f64,
    /// The share of the objective that is given up for smaller gains.
    #[serde(default = "back_off")]
    pub back_off: f64,
}

fn back_off() -> f64 {
    1e-3
}

impl Default for MixedSection {
    fn default() -> Self {
        MixedSection { sensor_noise: 0.0, back_off: back_off() }
    }
}

impl LyapunovScaleSpec {
    /// Whether it is the default.
    #[must_use]
    pub fn is_searched(&self) -> bool {
        *self == LyapunovScaleSpec::Searched
    }
}

impl From<LyapunovScaleSpec> for LyapunovScale {
    fn from(of: LyapunovScaleSpec) -> Self {
        match of {
            LyapunovScaleSpec::Searched => LyapunovScale::Searched,
            LyapunovScaleSpec::Fixed => LyapunovScale::Fixed(1.0),
            LyapunovScaleSpec::Number(s) => LyapunovScale::Fixed(s),
        }
    }
}

fn twice<T: PartialEq>(all: &[T]) -> Option<&T> {
    all.iter().enumerate().find(|(k, v)| all[..*k].contains(v)).map(|(_, v)| v)
}

fn setting(field: &'static str, expected: impl Into<String>, found: impl Into<String>) -> StudyError {
    StudyError::Setting { field, expected: expected.into(), found: found.into() }
}

impl PolesSection {
    /// The region.
    ///
    /// # Errors
    /// Numbers of the wrong sign, a region that is empty.
    pub(super) fn region(&self) -> Result<PoleRegion, StudyError> {
        for (field, value) in [
            ("poles.max_imag_rad_s", self.max_imag_rad_s),
            ("poles.max_abs_rad_s", self.max_abs_rad_s),
            ("poles.rectangle_rad_s", self.rectangle_rad_s),
            ("poles.min_real_rad_s", self.min_real_rad_s.map(|v| -v)),
        ] {
            if let Some(found) = value.filter(|v| !(*v > 0.0 && v.is_finite())) {
                let negative = field.ends_with("min_real_rad_s");
                let (sign, found) = if negative { ("negative", -found) } else { ("positive", found) };
                return Err(setting(field, format!("a {sign}, finite number"), found.to_string()));
            }
        }
        if let Some(found) = self.max_real_rad_s.filter(|v| !(*v <= 0.0 && v.is_finite())) {
            let expected = "a finite number, not positive: the loop is to be stable";
            return Err(setting("poles.max_real_rad_s", expected, plain(found)));
        }
        if let Some(found) = self.min_damping.filter(|v| !(*v > 0.0 && *v < 1.0)) {
            let expected = "a ratio between 0 and 1, both left out (0.7 is a usual one; 1 asks for real poles only, which no open region holds)";
            return Err(setting("poles.min_damping", expected, found.to_string()));
        }
        let least = |a: Option<f64>, b: Option<f64>| a.into_iter().chain(b).reduce(f64::min);
        let region = PoleRegion {
            faster_than: self.max_real_rad_s.map(|v| -v),
            slower_than: least(self.min_real_rad_s.map(|v| -v), self.rectangle_rad_s),
            below_frequency: least(self.max_imag_rad_s, self.rectangle_rad_s),
            within: self.max_abs_rad_s,
            cone: self.min_damping.map(f64::acos),
        };
        let far = least(region.slower_than, region.within);
        if let (Some(near), Some(far)) = (region.faster_than, far)
            && near >= far
        {
            let expected = format!(
                "above {}, where min_real_rad_s, rectangle_rad_s or max_abs_rad_s end the region",
                -far
            );
            return Err(setting(
                "poles.max_real_rad_s",
                expected,
                format!("{}: no pole is in this region", -near),
            ));
        }
        Ok(region)
    }
}

impl DesignSpec {
    /// Refuses what only the designs by inequalities know of others, and numbers that they cannot have.
    pub(super) fn check_inequalities(&self) -> Result<(), StudyError> {
        let (g, method) = (&self.goal, self.method);
        if !method.takes_bounds() {
            let given = [
                ("goal.bound", !g.bound.is_empty()),
                ("goal.bound_hinf", !g.bound_hinf.is_empty()),
                ("goal.bound_h2", !g.bound_h2.is_empty()),
                ("goal.max_pole_rad_s", g.max_pole_rad_s.is_some()),
                ("goal.max_gain", g.max_gain.is_some()),
                ("poles", self.poles.is_some()),
            ];
            if let Some((field, _)) = given.iter().find(|(_, given)| *given) {
                let expected = format!(
                    "nothing with method {}: mixed-h2-hinf, robust-state-feedback and fixed-order have it",
                    method.name()
                );
                return Err(setting(field, expected, "a value"));
            }
        }
        if !method.is_by_inequalities() && !self.lyapunov_scale.is_searched() {
            let expected = format!(
                "nothing with method {}: mixed-h2-hinf and robust-state-feedback have it",
                method.name()
            );
            return Err(setting("lyapunov_scale", expected, "a value"));
        }
        if method.takes_bounds() && self.lqg.is_some() {
            let of = match method {
                DesignMethod::MixedH2Hinf => "the sensors' noise is mixed.sensor_noise",
                DesignMethod::FixedOrder => {
                    "its sensors have no noise; goal.max_gain bounds what it makes of one"
                }
                _ => "its states have no noise",
            };
            let expected = format!("nothing with method {}: {of}", method.name());
            return Err(setting("lqg", expected, "a section"));
        }
        if let Some(order) = twice(&self.truncate_to) {
            return Err(setting("truncate_to", "each order once", format!("{order} twice")));
        }
        if let Some(at) = self.plant.iter().position(Named::is_empty).filter(|_| self.plant.len() == 1) {
            let found = format!("nothing in [[plant]] number {}", at + 1);
            return Err(setting("plant", "fields of the vehicle and their values", found));
        }
        for (name, members) in g.groups.iter() {
            if members.is_empty() {
                return Err(setting("goal.groups", "outputs in each group", format!("none in `{name}`")));
            }
            if let Some(output) = twice(members) {
                return Err(setting(
                    "goal.groups",
                    "each output once",
                    format!("`{output}` twice in `{name}`"),
                ));
            }
        }
        for (field, given, own) in [
            ("range", !self.range.is_empty(), DesignMethod::RobustStateFeedback),
            ("truncate_to", !self.truncate_to.is_empty(), DesignMethod::MixedH2Hinf),
            ("mixed", self.mixed.is_some(), DesignMethod::MixedH2Hinf),
        ] {
            if given && method != own {
                let expected = format!("nothing with method {}: it is of {}", method.name(), own.name());
                return Err(setting(field, expected, "a value"));
            }
        }
        if !self.plant.is_empty()
            && !matches!(method, DesignMethod::RobustStateFeedback | DesignMethod::FixedOrder)
        {
            let expected = format!(
                "nothing with method {}: it is of robust-state-feedback and fixed-order",
                method.name()
            );
            return Err(setting("plant", expected, "a value"));
        }
        if method == DesignMethod::RobustStateFeedback && g.max_pole_rad_s.is_some() {
            let expected = "nothing: a state feedback has no poles of its own; poles = { max_abs_rad_s = … } bounds the loop's";
            return Err(setting("goal.max_pole_rad_s", expected, "a value"));
        }
        for (field, value) in [("goal.max_pole_rad_s", g.max_pole_rad_s), ("goal.max_gain", g.max_gain)] {
            if let Some(found) = value.filter(|v| !(*v > 0.0 && v.is_finite())) {
                return Err(setting(field, "a positive, finite number", plain(found)));
            }
        }
        above_zero("goal.bound_h2", &g.bound_h2)?;
        if let LyapunovScaleSpec::Number(s) = self.lyapunov_scale
            && !((1e-6..=1e6).contains(&s))
        {
            return Err(setting(
                "lyapunov_scale",
                "\"searched\", \"fixed\", or a number from 1e-6 to 1e6",
                s.to_string(),
            ));
        }
        if let Some(m) = self.mixed {
            if !(m.sensor_noise == 0.0 || (1e-60..=1e60).contains(&m.sensor_noise)) {
                let expected = "0, or a number from 1e-60 to 1e60";
                return Err(setting("mixed.sensor_noise", expected, plain(m.sensor_noise)));
            }
            if !((0.0..=0.5).contains(&m.back_off)) {
                return Err(setting("mixed.back_off", "a share from 0 to 0.5", m.back_off.to_string()));
            }
        }
        if self.range.iter().count() > MOST_RANGES {
            let found = self.range.iter().count().to_string();
            return Err(setting("range", format!("at most {MOST_RANGES} fields"), found));
        }
        for (name, [low, high]) in self.range.iter() {
            if !(low.is_finite() && high.is_finite() && low < high) {
                let found = format!("{name} = [{}, {}]", plain(*low), plain(*high));
                return Err(setting("range", "two finite numbers, the smaller one first", found));
            }
        }
        self.poles.unwrap_or_default().region().map(|_| ())
    }
}
