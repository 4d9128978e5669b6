//! What a fixed-order design tells of its search, as it is written to `result.json`.

use super::Named;
use serde::{Deserialize, Serialize};

/// The evidence of a search: what holds the optimum, how near it is to a local one, what was done.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct FixedOrderOutcome {
    /// Goals and bounds in the loop; none where no loop is stable.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub targets: Vec<FixedOrderTarget>,
    /// The largest excess of a bound, a share of it: 0 where all are met.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub violation: Option<f64>,
    /// The least largest real part of a loop's poles, where no start led to a stable loop.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub abscissa_rad_s: Option<f64>,
    /// How far the result is from a local optimum.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stationarity: Option<Stationarity>,
    /// What no controller of any order goes below: a lower bound of the goal, from H∞ goals and bounds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lower_bound: Option<f64>,
    /// The frequency that proves it, or that the bounds are impossible.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lower_bound_hz: Option<f64>,
    /// goal/lower bound − 1; none where the lower bound is next to 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gap: Option<f64>,
    /// Where no control keeps all bounds: the least largest share of a bound, above 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub impossible: Option<f64>,
    /// Whether the last search ended as no model promised more.
    pub converged: bool,
    /// Starts: of all orders that were designed.
    pub starts: usize,
    /// Those of them that led to a stable loop.
    pub stabilised: usize,
    /// What was counted: `loops`, `factorisations`, `eigenproblems`, `lyapunov`.
    #[serde(default, skip_serializing_if = "Named::is_empty")]
    pub work: Named<usize>,
}

/// A goal or a bound in the loop.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FixedOrderTarget {
    /// The output or block; `goal` of all outputs of `minimize_h2` together.
    pub name: String,
    /// Which of the vehicles, from 1; none where there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub vehicle: Option<usize>,
    /// Which norm.
    pub norm: TargetNorm,
    /// Minimised or bounded.
    pub aim: TargetAim,
    /// The norm, as the design has it.
    pub value: f64,
    /// The same from vehicle and controller alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub recomputed: Option<f64>,
    /// What is minimised (w‖T‖/‖G‖), or the share of the bound.
    pub relative: f64,
    /// Where an H∞ norm is attained; null at infinity and of H2 norms.
    pub at_hz: Option<f64>,
    /// Its weight in the conditions of optimality: 0 where it holds nothing.
    pub multiplier: f64,
    /// The peaks that hold the optimum.
    pub active_hz: Vec<f64>,
}

/// A norm by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TargetNorm {
    /// H∞.
    Hinf,
    /// H2.
    H2,
}

/// What becomes of a norm.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TargetAim {
    /// It is minimised.
    Goal,
    /// It is bounded.
    Bound,
}

/// The distance of 0 from the gradients around the result.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Stationarity {
    /// Of ln goal, in units of the controller's entries: 0 at a local optimum.
    pub distance: f64,
    /// Of the ball in which gradients were sampled.
    pub radius: f64,
    /// Points of it.
    pub points: usize,
}
