//! What a sweep gives: a row a point, as it is written to `result.json`.

use super::design_outcome::{DesignOutcome, DesignStatus, Gains, Measured};
use super::{Envelope, Named, ResponseGroup, Rms, SweepAxis};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// All points of a sweep.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SweepOutcome {
    /// The axes; the last varies fastest.
    pub grid: Vec<SweepAxis>,
    /// Whether fixed-order designs began from their neighbours too.
    pub warm_start: bool,
    /// What the goal is, in words, where it is the same at all points.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub goal: Option<String>,
    /// How many points ended how.
    pub counts: Named<usize>,
    /// Numbers of points that are not there yet; a whole sweep has none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub missing: Vec<usize>,
    /// The points in order.
    pub points: Vec<SweepPoint>,
}

/// How a point ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SweepStatus {
    /// There is a controller.
    Designed,
    /// There is a value, and no controller belongs to it.
    Limit,
    /// No controller meets what is asked.
    Infeasible,
    /// The method ended without success.
    Stalled,
    /// A controller was found, and its loop contradicts it.
    Refused,
    /// The design is wrong at this point.
    WrongInput,
    /// The computation failed.
    Failed,
}

impl SweepStatus {
    /// As it is written.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            SweepStatus::Designed => "designed",
            SweepStatus::Limit => "limit",
            SweepStatus::Infeasible => "infeasible",
            SweepStatus::Stalled => "stalled",
            SweepStatus::Refused => "refused",
            SweepStatus::WrongInput => "wrong-input",
            SweepStatus::Failed => "failed",
        }
    }

    /// Whether it has what was asked.
    #[must_use]
    pub fn is_good(self) -> bool {
        matches!(self, SweepStatus::Designed | SweepStatus::Limit)
    }
}

impl From<DesignStatus> for SweepStatus {
    fn from(status: DesignStatus) -> Self {
        match status {
            DesignStatus::Designed => SweepStatus::Designed,
            DesignStatus::Limit => SweepStatus::Limit,
            DesignStatus::Infeasible => SweepStatus::Infeasible,
            DesignStatus::Stalled => SweepStatus::Stalled,
            DesignStatus::Refused => SweepStatus::Refused,
        }
    }
}

/// A point as a row.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SweepPoint {
    /// Counted from 0.
    pub index: usize,
    /// Where it is.
    pub at: Named<Value>,
    /// How it ended.
    pub status: SweepStatus,
    /// In words, where there is no controller.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub why: Option<String>,
    /// States of the controller.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub order: Option<usize>,
    /// The goal's value: `passive`, `verified`, `limit`.
    pub objective: Named<f64>,
    /// What no controller of any order goes below, of the goal (`fixed-order`).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lower_bound: Option<f64>,
    /// rms of the loop by output …
    pub rms: Named<Rms>,
    /// … and as a multiple of the passive one.
    pub rms_relative: Named<f64>,
    /// H2 norms.
    pub h2: Named<Rms>,
    /// As multiples.
    pub h2_relative: Named<f64>,
    /// H∞ norms.
    pub hinf: Named<f64>,
    /// As multiples.
    pub hinf_relative: Named<f64>,
    /// The loop's metrics, of the worst corner, where the design has `[metrics]`; the passive vehicle's where there is no loop. What is
    /// infinite or has not settled is left out.
    #[serde(default, skip_serializing_if = "Named::is_empty")]
    pub metrics: Named<f64>,
    /// Names of the design's warnings.
    pub warnings: Vec<String>,
    /// The file with the controller.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub controller: Option<String>,
}

/// A point's file: a result of `design`, and where on the grid of which sweep it is.
pub type PointFile = Envelope<PointResult>;

/// What stands in a point's file beside the envelope.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PointResult {
    /// Where it belongs.
    pub point: PointStamp,
    /// The design, or why there is none.
    #[serde(flatten)]
    pub result: PointDesign,
}

/// Where a point belongs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PointStamp {
    /// Of the sweep's [seal](super::SweepSeal).
    pub sweep_sha256: String,
    /// Counted from 0.
    pub index: usize,
    /// Where it is.
    pub at: Named<Value>,
    /// The point whose controller was one more start.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub started_from: Option<usize>,
    /// Of all else in the file: what was edited is not what was computed.
    #[serde(default)]
    pub sha256: String,
}

impl Envelope<PointResult> {
    /// With its own SHA-256.
    pub(super) fn sealed(mut self) -> Self {
        self.outcome.point.sha256 = self.digest();
        self
    }

    /// The SHA-256 of the file as it would be without one.
    pub(super) fn digest(&self) -> String {
        let mut bare = self.clone();
        bare.outcome.point.sha256.clear();
        super::envelope::sha256(bare.to_json().as_bytes())
    }
}

/// A point's design.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum PointDesign {
    /// As `design` has it.
    Outcome(Box<DesignOutcome>),
    /// None: the call is wrong here, or the computation failed.
    None {
        /// `wrong-input` or `failed`.
        status: SweepStatus,
        /// In words.
        why: String,
    },
}

/// What the page shows of a point that is chosen.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepDetail {
    /// Of the point.
    pub index: usize,
    /// Of the controller, 1/s.
    pub controller_poles: Vec<[f64; 2]>,
    /// Of the loop, 1/s.
    pub loop_poles: Vec<[f64; 2]>,
    /// Units of outputs.
    pub units: Named<String>,
    /// What gains are taken from.
    pub per: String,
    /// Passive and closed.
    pub gains: Gains,
}

/// Closed over passive, where both are finite and the latter is not 0.
fn relative<T: Copy>(closed: &Named<T>, passive: &Named<T>, number: fn(T) -> Option<f64>) -> Named<f64> {
    let ratio = |(name, c): (&str, &T)| {
        let p = passive.get(name).copied().and_then(number).filter(|p| *p > 0.0)?;
        Some((name.to_owned(), number(*c)? / p)).filter(|(_, r)| r.is_finite())
    };
    closed.iter().filter_map(ratio).collect()
}

impl SweepPoint {
    /// The row of a point's file.
    pub(super) fn new(point: &PointResult, file: &str) -> Self {
        let mut row = SweepPoint {
            index: point.point.index,
            at: point.point.at.clone(),
            status: SweepStatus::Failed,
            why: None,
            order: None,
            objective: Named::default(),
            lower_bound: None,
            rms: Named::default(),
            rms_relative: Named::default(),
            h2: Named::default(),
            h2_relative: Named::default(),
            hinf: Named::default(),
            hinf_relative: Named::default(),
            metrics: Named::default(),
            warnings: Vec::new(),
            controller: None,
        };
        let o = match &point.result {
            PointDesign::None { status, why } => {
                (row.status, row.why) = (*status, Some(why.clone()));
                return row;
            }
            PointDesign::Outcome(o) => o,
        };
        (row.status, row.why, row.order) = (o.status.into(), o.why.clone(), o.order);
        row.objective = o.objective.clone();
        row.lower_bound = o.fixed_order.as_ref().and_then(|f| f.lower_bound);
        row.warnings = o.warnings.iter().map(|w| w.name.clone()).collect();
        if let Some(m) = &o.metrics {
            // what has not settled, or is infinite, in the loop is nothing: never the passive vehicle's
            let side = usize::from(m.closed.is_some());
            let own = m.short_rows(&o.units).into_iter();
            row.metrics = own.filter_map(|r| Some((r.key, r.values[side]?))).collect();
        }
        row.controller = o.controller.as_ref().map(|_| file.to_owned());
        if let Some(closed) = &o.verified {
            let Measured { rms, h2, hinf, .. } = closed;
            row.rms_relative = relative(rms, &o.passive.rms, Rms::finite);
            row.h2_relative = relative(h2, &o.passive.h2, Rms::finite);
            row.hinf_relative = relative(hinf, &o.passive.hinf, Some);
            (row.rms, row.h2, row.hinf) = (rms.clone(), h2.clone(), hinf.clone());
        }
        row
    }
}

impl SweepDetail {
    /// Of a design with a loop.
    pub(super) fn new(index: usize, o: &DesignOutcome) -> Option<Self> {
        let closed = o.verified.as_ref()?;
        let poles =
            o.controller.as_ref().and_then(|k| k.state_space().ok()?.poles().ok()).unwrap_or_default();
        Some(SweepDetail {
            index,
            controller_poles: poles.iter().map(|p| [p.re, p.im]).collect(),
            loop_poles: closed.poles.clone(),
            units: o.units.clone(),
            per: o.per().to_owned(),
            gains: o.gains.clone(),
        })
    }
}

impl SweepOutcome {
    /// From the points that are there.
    pub(super) fn new(
        grid: &[SweepAxis],
        warm_start: bool,
        goal: Option<String>,
        missing: Vec<usize>,
        points: Vec<SweepPoint>,
    ) -> Self {
        let mut counts = Named::default();
        for p in &points {
            let before: usize = counts.get(p.status.name()).copied().unwrap_or(0);
            counts.insert(p.status.name(), before + 1);
        }
        SweepOutcome { grid: grid.to_vec(), warm_start, goal, counts, missing, points }
    }

    /// Whether any point has what was asked.
    #[must_use]
    pub fn any_good(&self) -> bool {
        self.points.iter().any(|p| p.status.is_good())
    }

    /// Outputs that stand for comfort, travel and tire load, in this order, of those that some point has an rms of: of each
    /// kind the first, whole vectors before their corners; the tire's deflection before its force.
    #[must_use]
    pub fn trade_offs(&self) -> Vec<&str> {
        let kinds = [ResponseGroup::Comfort, ResponseGroup::RattleSpace, ResponseGroup::TireLoad];
        let mut names: Vec<&str> = Vec::new();
        for (name, _) in self.points.iter().flat_map(|p| p.rms_relative.iter()) {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        let is_corner = |name: &str| {
            names.iter().any(|base| name.strip_prefix(base).is_some_and(|rest| rest.starts_with('_')))
        };
        let first = |kind: &ResponseGroup| {
            let of_kind = || names.iter().copied().filter(|n| ResponseGroup::of(n) == *kind);
            let whole = || of_kind().filter(|n| !is_corner(n));
            whole().find(|n| n.contains("deflection")).or_else(|| whole().next()).or_else(|| of_kind().next())
        };
        kinds.iter().filter_map(first).collect()
    }
}
