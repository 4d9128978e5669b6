//! What a design is to make small, and what it is to keep below a bound.

use super::{DesignMethod, DesignSpec, Named, StudyError};
pub(super) use crate::units::plain;
use serde::{Deserialize, Serialize};

/// Outputs and their weights; a name without its corner is the stacked vector, with one joint norm.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Goal {
    /// In the method's own norm.
    #[serde(default, skip_serializing_if = "Named::is_empty")]
    pub minimize: Named<f64>,
    /// In the H2 norm, said explicitly.
    #[serde(default, skip_serializing_if = "Named::is_empty")]
    pub minimize_h2: Named<f64>,
    /// In the H∞ norm, said explicitly.
    #[serde(default, skip_serializing_if = "Named::is_empty")]
    pub minimize_hinf: Named<f64>,
    /// H∞ norms, at most so many times the passive ones.
    #[serde(default, skip_serializing_if = "Named::is_empty")]
    pub bound: Named<f64>,
    /// The same, said explicitly.
    #[serde(default, skip_serializing_if = "Named::is_empty")]
    pub bound_hinf: Named<f64>,
    /// H2 norms, at most so many times the passive ones.
    #[serde(default, skip_serializing_if = "Named::is_empty")]
    pub bound_h2: Named<f64>,
    /// Names of blocks of outputs with one joint norm.
    #[serde(default, skip_serializing_if = "Named::is_empty")]
    pub groups: Named<Vec<String>>,
    /// States of the controller (`fixed-order`).
    #[serde(
        default,
        skip_serializing_if = "Option::is_none",
        deserialize_with = "super::design_pairs::order"
    )]
    pub order: Option<usize>,
    /// No pole of the controller may be faster, rad/s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_pole_rad_s: Option<f64>,
    /// The controller's largest gain over frequency may not be above this, N per unit of the measurements.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_gain: Option<f64>,
}

impl Goal {
    /// Its lists of outputs with weights or bounds, by their names in a file.
    pub(super) fn lists(&self) -> [(&'static str, &Named<f64>); 6] {
        [
            ("goal.minimize", &self.minimize),
            ("goal.minimize_h2", &self.minimize_h2),
            ("goal.minimize_hinf", &self.minimize_hinf),
            ("goal.bound", &self.bound),
            ("goal.bound_hinf", &self.bound_hinf),
            ("goal.bound_h2", &self.bound_h2),
        ]
    }

    /// The first list that an output, a stacked name or a group stands in, by itself or in a group.
    pub(super) fn field_of(&self, name: &str) -> &'static str {
        let is_it = |listed: &str| {
            let group = self.groups.get(listed);
            listed == name || group.is_some_and(|g| g.iter().any(|m| m == name))
        };
        let lists = self.lists();
        let own = lists.iter().find(|(_, list)| list.iter().any(|(n, _)| is_it(n)));
        own.map_or("goal.minimize", |(field, _)| *field)
    }
}

/// An H∞ norm that is minimised (a weight above 0), bounded, or both.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct HinfPart {
    pub name: String,
    pub weight: f64,
    /// A multiple of the passive norm.
    pub bound: Option<f64>,
}

fn setting(field: &'static str, expected: &str, found: String) -> StudyError {
    StudyError::Setting { field, expected: expected.to_owned(), found }
}

impl DesignSpec {
    /// The outputs that are to be small, in the method's norm: of the methods with bounds in the H2 norm, and perhaps none.
    ///
    /// # Errors
    /// None given, or given in a norm that the method does not minimise.
    pub fn weights(&self) -> Result<Named<f64>, StudyError> {
        let g = &self.goal;
        if self.method == DesignMethod::Interpolation {
            if !(g.minimize.is_empty() && g.minimize_h2.is_empty() && g.minimize_hinf.is_empty()) {
                let expected = "nothing: interpolation copies an LQG design whose three outputs weigh alike";
                return Err(setting("goal.minimize", expected, "weights".into()));
            }
            let all = ["sprung_acceleration", "suspension_travel", "tire_deflection"];
            return Ok(all.iter().map(|n| ((*n).to_owned(), 1.0)).collect());
        }
        if self.method == DesignMethod::FixedOrder {
            at_least_zero("goal.minimize_h2", &g.minimize_h2)?;
            // weights of 0 alone are a slip: bounds alone have no list of weights
            let all = || g.minimize.iter().chain(g.minimize_h2.iter()).chain(g.minimize_hinf.iter());
            if all().next().is_some() && all().all(|(_, w)| *w == 0.0) {
                let expected = "a weight above 0 (or bounds alone, without a list of weights)";
                return Err(setting("goal.minimize", expected, "zeros".into()));
            }
            let above_zero = g.minimize_h2.iter().filter(|(_, w)| **w > 0.0);
            return Ok(above_zero.map(|(n, w)| (n.to_owned(), *w)).collect());
        }
        let (own, own_name, other, other_name) = match self.method {
            DesignMethod::Hinf => {
                (&g.minimize_hinf, "goal.minimize_hinf", &g.minimize_h2, "goal.minimize_h2")
            }
            _ => (&g.minimize_h2, "goal.minimize_h2", &g.minimize_hinf, "goal.minimize_hinf"),
        };
        let mixes = self.method.is_by_inequalities();
        if !other.is_empty() && !mixes {
            let expected = format!("nothing: method {} minimises the other norm", self.method.name());
            return Err(setting(other_name, &expected, "weights".into()));
        }
        let weights = match (g.minimize.is_empty(), own.is_empty()) {
            (false, true) => &g.minimize,
            (true, false) => own,
            (true, true) if mixes => own,
            (true, true) => return Err(setting("goal.minimize", "outputs and their weights", "none".into())),
            (false, false) => return Err(setting(own_name, "either this or goal.minimize", "both".into())),
        };
        let field = if g.minimize.is_empty() { own_name } else { "goal.minimize" };
        at_least_zero(field, weights)?;
        let may_be_none = mixes && weights.is_empty();
        if !may_be_none && weights.iter().all(|(_, w)| *w == 0.0) {
            let zeros = if weights.is_empty() { "none" } else { "zeros" };
            return Err(setting(field, "a weight above 0", zeros.into()));
        }
        Ok(weights.clone())
    }

    /// H∞ norms of the methods with bounds, in the order in which they are named.
    pub(super) fn hinf_parts(&self) -> Result<Vec<HinfPart>, StudyError> {
        let g = &self.goal;
        if !self.method.takes_bounds() {
            return Ok(Vec::new());
        }
        let mut parts: Vec<HinfPart> = Vec::new();
        for (field, bounds) in [("goal.bound", &g.bound), ("goal.bound_hinf", &g.bound_hinf)] {
            above_zero(field, bounds)?;
            for (name, bound) in bounds.iter() {
                if parts.iter().any(|p| p.name == name) {
                    let expected = "each output once in goal.bound and goal.bound_hinf";
                    return Err(setting(field, expected, format!("`{name}` twice")));
                }
                parts.push(HinfPart { name: name.to_owned(), weight: 0.0, bound: Some(*bound) });
            }
        }
        let (field, minimised) = match self.method {
            // whose own norm this is
            DesignMethod::FixedOrder if g.minimize_hinf.is_empty() => ("goal.minimize", &g.minimize),
            DesignMethod::FixedOrder if !g.minimize.is_empty() => {
                return Err(setting("goal.minimize_hinf", "either this or goal.minimize", "both".into()));
            }
            _ => ("goal.minimize_hinf", &g.minimize_hinf),
        };
        at_least_zero(field, minimised)?;
        for (name, weight) in minimised.iter().filter(|(_, w)| **w > 0.0) {
            match parts.iter_mut().find(|p| p.name == name) {
                Some(part) => part.weight = *weight,
                None => parts.push(HinfPart { name: name.to_owned(), weight: *weight, bound: None }),
            }
        }
        Ok(parts)
    }

    /// A name of the goal as outputs: those of its group, or itself.
    pub(super) fn members_of(&self, name: &str) -> Vec<String> {
        self.goal.groups.get(name).cloned().unwrap_or_else(|| vec![name.to_owned()])
    }
}

/// Weights are squared: beyond these no double holds what they make of the goal beside others.
const WEIGHTS: std::ops::RangeInclusive<f64> = 1e-9..=1e9;
/// Multiples of passive norms.
const BOUNDS: std::ops::RangeInclusive<f64> = 1e-9..=1e9;

fn at_least_zero(field: &'static str, named: &Named<f64>) -> Result<(), StudyError> {
    match named.iter().find(|(_, w)| !(**w == 0.0 || WEIGHTS.contains(*w))) {
        Some((name, w)) => Err(setting(
            field,
            "weights: 0, or finite numbers from 1e-9 to 1e9",
            format!("{name} = {}", plain(*w)),
        )),
        None => Ok(()),
    }
}

pub(super) fn above_zero(field: &'static str, named: &Named<f64>) -> Result<(), StudyError> {
    match named.iter().find(|(_, v)| !BOUNDS.contains(*v)) {
        Some((name, v)) => {
            let expected = "multiples of the passive norm, above 0, from 1e-9 to 1e9";
            Err(setting(field, expected, format!("{name} = {}", plain(*v))))
        }
        None => Ok(()),
    }
}
