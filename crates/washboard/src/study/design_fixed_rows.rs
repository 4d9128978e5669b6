//! A fixed-order search as rows: goals and bounds with what holds the optimum, and what was done.

use super::DesignMethod;
use super::design_fixed_outcome::{FixedOrderTarget, Stationarity, TargetAim, TargetNorm};
use super::design_fixed_spec::StructureKind;
use super::design_outcome::DesignOutcome;
use super::design_words::short;

/// A goal or a bound.
#[derive(Debug, Clone, PartialEq)]
pub struct TargetRow {
    /// Which vehicle; empty where there is one.
    pub vehicle: String,
    /// The output, with its norm.
    pub name: String,
    /// Minimised or bounded.
    pub aim: &'static str,
    /// As a share of the bound, or weighted over the passive norm.
    pub relative: f64,
    /// Whether it holds the optimum, and how much.
    pub multiplier: f64,
    /// Frequencies of the peaks that do, Hz.
    pub peaks: String,
}

/// A number of the search, in words.
#[derive(Debug, Clone, PartialEq)]
pub struct SearchRow {
    /// Which.
    pub words: &'static str,
    /// Its value.
    pub value: String,
}

/// Peaks that a row names.
const MOST_PEAKS: usize = 6;

/// Those that three digits tell apart.
fn peaks(active_hz: &[f64]) -> String {
    let mut all: Vec<String> = active_hz.iter().map(|f| short(*f)).collect();
    all.dedup();
    let more = all.len().saturating_sub(MOST_PEAKS);
    all.truncate(MOST_PEAKS);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    all.join(", ") + &more
}

/// A share in percent with its sign: three digits, and never −0.
fn percent(share: f64) -> String {
    let size = short((100.0 * share).abs());
    if 100.0 * share.abs() < 5e-4 {
        "0".to_owned()
    } else {
        format!("{}{size}", if share < 0.0 { "−" } else { "+" })
    }
}

/// Below this the descent that is left is that of a local optimum and its rounding.
const AT_OPTIMUM: f64 = 1e-2;
/// Above this it is not next to one.
const NEAR_OPTIMUM: f64 = 1.0;

impl Stationarity {
    /// In words: what a step within the ball gains at least, distance × radius of ln goal.
    fn words(&self) -> String {
        let gain = short(100.0 * self.distance * self.radius);
        match self.distance {
            d if d < AT_OPTIMUM => format!("yes (descent left {})", short(d)),
            d if d <= NEAR_OPTIMUM => {
                format!("nearly (descent left {}: a small step may gain {gain} %)", short(d))
            }
            d => format!("no (descent left {}: a small step may gain {gain} %)", short(d)),
        }
    }
}

impl DesignOutcome {
    /// What is said of a controller whose gain has no bound.
    #[must_use]
    pub fn endless_gain(&self) -> Option<&'static str> {
        let bounded = self.claimed.get("controller_gain").is_some();
        self.controller.as_ref().filter(|_| !bounded && self.design.method == DesignMethod::FixedOrder)?;
        let integrates = self.design.structure_kind() == Some(StructureKind::Pid);
        Some(if integrates { "infinite at 0 Hz (integrator)" } else { "infinite (a pole on the axis)" })
    }

    /// Goals and bounds of a fixed-order design.
    #[must_use]
    pub fn target_rows(&self) -> Vec<TargetRow> {
        let row = |t: &FixedOrderTarget| TargetRow {
            vehicle: t.vehicle.map(|k| k.to_string()).unwrap_or_default(),
            name: match (t.norm, t.aim) {
                (TargetNorm::H2, TargetAim::Goal) => "all of minimize_h2, H2".to_owned(),
                (TargetNorm::H2, TargetAim::Bound) => format!("{}, H2", t.name),
                (TargetNorm::Hinf, _) => format!("{}, H∞", t.name),
            },
            aim: match t.aim {
                TargetAim::Goal => "goal",
                TargetAim::Bound => "bound",
            },
            relative: t.relative,
            multiplier: t.multiplier,
            peaks: peaks(&t.active_hz),
        };
        self.fixed_order.iter().flat_map(|f| &f.targets).map(row).collect()
    }

    /// What a fixed-order search did, and how near to a local optimum it ended.
    #[must_use]
    pub fn search_rows(&self) -> Vec<SearchRow> {
        let Some(f) = &self.fixed_order else { return Vec::new() };
        let mut rows = vec![
            SearchRow { words: "starts, of all orders designed", value: f.starts.to_string() },
            SearchRow { words: "of them led to a stable loop", value: f.stabilised.to_string() },
        ];
        let mut more = |words, value: Option<String>| {
            rows.extend(value.map(|value| SearchRow { words, value }));
        };
        let count = |name: &str| f.work.get(name).map(usize::to_string);
        let at = f.lower_bound_hz.map_or_else(String::new, |w| format!(" (at {} Hz)", short(w)));
        more("no controller of any order has a goal below", f.lower_bound.map(|b| format!("{b:.5}{at}")));
        more("the goal is above that by", f.gap.map(|g| format!("{} %", percent(g))));
        more(
            "no controller at all is below, as a share of its bounds",
            f.impossible.map(|b| format!("{b:.5}{at}")),
        );
        more("least largest real part of a pole, rad/s", f.abscissa_rad_s.map(short));
        let limited = if f.converged { "no" } else { "yes: more with fixed-order.iterations" };
        more("stopped at its limit of steps", (!f.targets.is_empty()).then(|| limited.to_owned()));
        more("a local optimum", f.stationarity.filter(|_| self.controller.is_some()).map(|s| s.words()));
        more("largest excess of a bound, %", f.violation.map(|v| short(100.0 * v)));
        more("loops closed", count("loops"));
        more("factorisations at a frequency", count("factorisations"));
        more("eigenvalue problems", count("eigenproblems"));
        more("Lyapunov equations", count("lyapunov"));
        rows
    }
}
