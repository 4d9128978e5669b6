//! What a fixed-order design is asked for, and what is refused before it is tried.

use super::structure::Structure;
use super::targets::Target;
use crate::lti::{Continuous, GeneralizedPlant, LtiError, StateSpace};

/// Plants, what is asked of their loops, and the controllers that are allowed.
#[derive(Debug, Clone)]
pub struct FixedOrder {
    /// One or more, with the same measurements and controls.
    pub plants: Vec<GeneralizedPlant>,
    /// Goals and bounds.
    pub targets: Vec<Target>,
    /// The controller's order and free entries.
    pub structure: Structure,
    /// |λ| of every controller pole is at most this, rad/s.
    pub max_pole_rad_s: Option<f64>,
    /// sup σ(K(iω)) is at most this.
    pub max_gain: Option<f64>,
    /// −Re of every pole of every loop is at least this, rad/s.
    pub margin_rad_s: f64,
    /// Controllers to begin with, of any order.
    pub starts: Vec<StateSpace<Continuous>>,
    /// Frequencies that are always looked at, rad/s.
    pub frequencies_rad_s: Vec<f64>,
}

/// How long to look.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FixedOrderSettings {
    /// Random starts. From 16 on starts that are hard to stabilise are brought there by all means, and results are shaken
    /// longer.
    pub tries: usize,
    /// Of their numbers.
    pub seed: u64,
    /// Steps of a search at most.
    pub iterations: usize,
    /// A relative gain below this is none.
    pub tolerance: f64,
    /// Whether lower orders are designed first and begun from: then more states are never worse, as one of them with states
    /// that nothing reads is the result where it is the best.
    pub lower_orders: bool,
}

impl Default for FixedOrderSettings {
    fn default() -> Self {
        FixedOrderSettings { tries: 8, seed: 1, iterations: 400, tolerance: 1e-7, lower_orders: true }
    }
}

/// Refuses plants, targets and numbers that don't fit each other.
pub(super) fn check(asked: &FixedOrder) -> Result<(), LtiError> {
    let join =
        |what: &'static str, expected: String, found: String| Err(LtiError::Join { what, expected, found });
    let Some(first) = asked.plants.first() else {
        return join("a fixed-order design", "a plant".into(), "none".into());
    };
    for p in &asked.plants {
        let (expected, found) =
            ((p.nu(), p.ny()), (asked.structure.controls(), asked.structure.measurements()));
        if expected != found {
            return join(
                "a controller's structure",
                format!("{} controls and {} measurements, as the plant has", expected.0, expected.1),
                format!("{} and {}", found.0, found.1),
            );
        }
        if (p.nz(), p.nw()) != (first.nz(), first.nw()) {
            let of = |p: &GeneralizedPlant| format!("{} performances and {} disturbances", p.nz(), p.nw());
            return join("plants of one design", of(first), of(p));
        }
    }
    if asked.targets.is_empty() {
        return join("a fixed-order design", "a goal or a bound".into(), "none".into());
    }
    asked.targets.iter().try_for_each(|t| t.check(&asked.plants))?;
    for (field, value) in [("max_pole", asked.max_pole_rad_s), ("max_gain", asked.max_gain)] {
        if let Some(found) = value.filter(|v| !(*v > 0.0 && v.is_finite())) {
            return Err(LtiError::Field { field, expected: "a positive, finite number", found });
        }
    }
    if !(asked.margin_rad_s >= 0.0 && asked.margin_rad_s.is_finite()) {
        let (field, expected) = ("margin", "a finite number, not negative");
        return Err(LtiError::Field { field, expected, found: asked.margin_rad_s });
    }
    Ok(())
}
