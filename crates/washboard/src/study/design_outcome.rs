//! What a design gives, as it is written to `result.json`.

use super::beyond_band::BeyondBand;
use super::design_fixed_outcome::FixedOrderOutcome;
use super::{
    DesignLimit, DesignMetrics, DesignResponses, DesignSpec, DesignVehicle, Flag, InvariantPoint, Named, Rms,
    Robustness,
};
use crate::linalg::Mat;
use crate::lti::{Continuous, LtiError, StateSpace};
use serde::{Deserialize, Serialize};

/// A controller with its certificate, or why there is none.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DesignOutcome {
    /// How it ended.
    pub status: DesignStatus,
    /// In words, where it is not designed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub why: Option<String>,
    /// What was asked.
    pub design: DesignSpec,
    /// The controller; only a success has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub controller: Option<ControllerFile>,
    /// States of the controller.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub order: Option<usize>,
    /// What the synthesis says of its result: `h2`, `gamma`, `limit` …
    pub claimed: Named<f64>,
    /// Recomputed from vehicle and controller alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub verified: Option<Measured>,
    /// Where the bounds cannot be met: the smallest that can, multiples of the passive norms, all raised by one factor.
    #[serde(default, skip_serializing_if = "Named::is_empty")]
    pub feasible_bound: Named<f64>,
    /// How `fixed-order` searched, and what holds its optimum.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fixed_order: Option<FixedOrderOutcome>,
    /// The vehicles that one controller is for, and the middle of their range.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub vertices: Vec<DesignVertex>,
    /// The gain of the vehicle as stated alone, beside the robust one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub nominal: Option<ControllerFile>,
    /// The controller with fewer states.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub truncated: Vec<TruncatedController>,
    /// The vehicle without control.
    pub passive: Measured,
    /// The value of the goal: 1 or the like for the passive vehicle, smaller is better; `worst` of several vehicles.
    pub objective: Named<f64>,
    /// What a reader must know before the numbers.
    pub warnings: Vec<Flag>,
    /// What holds for every such result.
    pub notes: Vec<Flag>,
    /// SI units of outputs and stacked vectors.
    #[serde(default, skip_serializing_if = "Named::is_empty")]
    pub units: Named<String>,
    /// Gains over frequency from the disturbances to each output (largest singular value), passive and closed.
    pub gains: Gains,
    /// What no controller beats with the same weights; none of a point of a sweep.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limit: Option<DesignLimit>,
    /// The vehicle, as far as a drawing needs it; none of a point of a sweep.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub vehicle: Option<DesignVehicle>,
    /// Frequencies at which no controller changes a response (quarter cars).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub invariant: Vec<InvariantPoint>,
    /// In time, over a bump and on a stretch of road; none of a point of a sweep.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub responses: Option<DesignResponses>,
    /// The loop with each number changed by itself, and with an actuator; none of a point of a sweep.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub robustness: Option<Robustness>,
    /// Forces that the controller needs, N rms on the road, by actuator; empty where they are infinite or none.
    pub forces: Named<Rms>,
    /// Weighted accelerations, tire loads, bottoming, power and bump; of a sweep's points only where `[metrics]` asks for them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub metrics: Option<DesignMetrics>,
}

/// How a design ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DesignStatus {
    /// There is a controller, and the loop confirms what is claimed.
    Designed,
    /// A value was asked for, and no controller belongs to it (`h2-limit`).
    Limit,
    /// No controller meets what is asked.
    Infeasible,
    /// The method ended without success.
    Stalled,
    /// A controller was found, and its loop contradicts it.
    Refused,
}

/// Norms and rms of a loop.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Measured {
    /// Poles, 1/s.
    pub poles: Vec<[f64; 2]>,
    /// Whether all are in the open left half plane.
    pub stable: bool,
    /// H2 norms from the disturbances by output and stacked vector.
    pub h2: Named<Rms>,
    /// H∞ norms.
    pub hinf: Named<f64>,
    /// Where these are attained, rad/s; null at infinity.
    pub hinf_at_rad_s: Named<Option<f64>>,
    /// rms on the road at the speed given, the road's part alone, delays exact.
    pub rms: Named<Rms>,
    /// rms with the sensors' noise (`lqg`).
    #[serde(default, skip_serializing_if = "Named::is_empty")]
    pub rms_with_noise: Named<Rms>,
    /// How much of each variance on the road is from where a fitted filter has no data; none of other roads.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub beyond_band: Option<BeyondBand>,
}

/// One vehicle of a range; outputs of the goal alone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DesignVertex {
    /// Its fields that differ.
    pub at: Named<f64>,
    /// Whether the design is for it; false of a middle, which is only looked at.
    pub corner: bool,
    /// Without control.
    pub passive: Measured,
    /// With the controller of all of them.
    pub closed: Measured,
    /// With the gain of the vehicle as stated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub nominal: Option<Measured>,
    /// The goal's value: `passive`, `closed`, `nominal`.
    pub objective: Named<f64>,
}

/// A controller with states left out, in its loop.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TruncatedController {
    /// States left.
    pub order: usize,
    /// The difference to the whole controller's stable part has at most this H∞ norm, N per unit.
    pub error_bound: f64,
    /// The goal's value; none where the loop is not stable.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub objective: Option<f64>,
    /// Its loop; outputs of the goal alone.
    pub verified: Measured,
    /// Its matrices.
    pub controller: ControllerFile,
}

/// Largest singular values over frequency.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Gains {
    /// Hz.
    pub freq_hz: Vec<f64>,
    /// Without control.
    pub passive: Named<Vec<f64>>,
    /// With it; empty where there is none.
    pub closed: Named<Vec<f64>>,
}

/// A controller as it is written: u = +K y, K = C(sI − A)⁻¹B + D.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ControllerFile {
    /// Rows of A.
    pub a: Vec<Vec<f64>>,
    /// Rows of B.
    pub b: Vec<Vec<f64>>,
    /// Rows of C.
    pub c: Vec<Vec<f64>>,
    /// Rows of D.
    pub d: Vec<Vec<f64>>,
    /// Outputs of the vehicle that it measures.
    pub inputs: Vec<String>,
    /// Actuators that it drives.
    pub outputs: Vec<String>,
}

impl ControllerFile {
    /// From a state space and names.
    #[must_use]
    pub fn new(k: &StateSpace<Continuous>, inputs: Vec<String>, outputs: Vec<String>) -> Self {
        let rows = |m: &Mat| (0..m.nrows()).map(|i| (0..m.ncols()).map(|j| m[(i, j)]).collect()).collect();
        ControllerFile { a: rows(k.a()), b: rows(k.b()), c: rows(k.c()), d: rows(k.d()), inputs, outputs }
    }

    /// The state space.
    ///
    /// # Errors
    /// Rows that do not make matrices that fit each other and the names; numbers that are not finite.
    pub fn state_space(&self) -> Result<StateSpace<Continuous>, LtiError> {
        let (n, m, p) = (self.a.len(), self.inputs.len(), self.outputs.len());
        let no_states = vec![Vec::new(); p];
        let matrix = |name: &'static str, rows: &[Vec<f64>], expected: (usize, usize)| {
            let found = rows.iter().find(|r| r.len() != expected.1).map_or(expected.1, Vec::len);
            if rows.len() != expected.0 || found != expected.1 {
                return Err(LtiError::Shape { name, expected, found: (rows.len(), found) });
            }
            Ok(Mat::from_fn(expected.0, expected.1, |i, j| rows[i][j]))
        };
        StateSpace::continuous(
            matrix("controller.a", &self.a, (n, n))?,
            matrix("controller.b", &self.b, (n, m))?,
            // of a gain there is nothing in a row, and so there may be no rows
            matrix("controller.c", if n == 0 && self.c.is_empty() { &no_states } else { &self.c }, (p, n))?,
            matrix("controller.d", &self.d, (p, m))?,
        )
    }
}
