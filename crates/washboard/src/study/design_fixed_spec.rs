//! What `method = "fixed-order"` is told: the controller's structure, where the search begins and how long it looks.

use super::design_goal::plain;
use super::design_pairs::MOST_ORDER;
use super::{DesignMethod, DesignSpec, StudyError};
use crate::synthesis::FixedOrderSettings;
use serde::{Deserialize, Serialize};

/// Controller poles are at most this where nothing is said, rad/s: beyond it searches drift to improper controllers.
pub(super) const MAX_POLE_RAD_S: f64 = 5e3;
/// Numbers that a JSON file holds exactly.
pub(super) const MOST_SEED: u64 = 1 << 53;
pub(super) const MOST_TRIES: usize = 10_000;
pub(super) const MOST_ITERATIONS: usize = 100_000;

/// A filter of a derivative that is slower is none.
const MOST_FILTER_S: f64 = 1e3;
/// Limits of gains and poles below this are none that a search can tell from 0.
const LEAST_LIMIT: f64 = 1e-9;

/// Which entries of the controller are free: a word, or rows of \[A_K, B_K; C_K, D_K\].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "structure: expected \"full\", \"strictly-proper\", \"pid\", \"decentralised\", or rows of [A_K, B_K; C_K, D_K] whose entries are \"free\" or numbers"
)]
pub enum StructureSpec {
    /// One that has a name.
    Kind(StructureKind),
    /// Row after row, states before actuators; in each the states before the measurements.
    Entries(Vec<Vec<StructureEntry>>),
}

/// A structure that has a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StructureKind {
    /// All entries are free.
    Full,
    /// D_K = 0.
    StrictlyProper,
    /// k_p + k_i/s + k_d s/(1 + τs), of one measurement and one actuator.
    Pid,
    /// Controllers beside each other: `[[local]]`.
    #[serde(alias = "decentralized")]
    Decentralised,
}

/// One entry of a controller's matrices.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum StructureEntry {
    /// `"free"`.
    Word(FreeEntry),
    /// Kept.
    Number(f64),
}

/// The word of an entry that the design chooses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FreeEntry {
    /// Chosen by the design.
    Free,
}

/// A part of a decentralised controller.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LocalSection {
    /// Which of the design's measurements it sees; a name without its corner means all corners.
    pub measurements: Vec<String>,
    /// Which actuators it drives.
    pub actuators: Vec<String>,
    /// Its own states.
    #[serde(deserialize_with = "super::design_pairs::local_order")]
    pub order: usize,
}

/// How long the search looks, and where from.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct FixedOrderSection {
    /// Random starts.
    #[serde(deserialize_with = "super::design_pairs::tries")]
    pub tries: usize,
    /// Of their numbers.
    #[serde(deserialize_with = "super::design_pairs::seed")]
    pub seed: u64,
    /// Steps of a search at most.
    #[serde(deserialize_with = "super::design_pairs::iterations")]
    pub iterations: usize,
    /// A relative gain below this is none.
    pub tolerance: f64,
    /// Whether lower orders of a full structure are designed first and begun from.
    pub lower_orders: bool,
}

impl Default for FixedOrderSection {
    fn default() -> Self {
        let FixedOrderSettings { tries, seed, iterations, tolerance, lower_orders } =
            FixedOrderSettings::default();
        FixedOrderSection { tries, seed, iterations, tolerance, lower_orders }
    }
}

impl From<FixedOrderSection> for FixedOrderSettings {
    fn from(of: FixedOrderSection) -> Self {
        let FixedOrderSection { tries, seed, iterations, tolerance, lower_orders } = of;
        FixedOrderSettings { tries, seed, iterations, tolerance, lower_orders }
    }
}

fn setting(field: &'static str, expected: impl Into<String>, found: impl Into<String>) -> StudyError {
    StudyError::Setting { field, expected: expected.into(), found: found.into() }
}

impl StructureSpec {
    /// Its name; none of rows.
    pub(super) fn kind(&self) -> Option<StructureKind> {
        match self {
            StructureSpec::Kind(kind) => Some(*kind),
            StructureSpec::Entries(_) => None,
        }
    }
}

impl DesignSpec {
    /// The structure's name, `full` where nothing is said; none of rows.
    pub(super) fn structure_kind(&self) -> Option<StructureKind> {
        self.structure.as_ref().map_or(Some(StructureKind::Full), StructureSpec::kind)
    }

    /// The bound of the controller's poles.
    pub(super) fn max_pole_rad_s(&self) -> f64 {
        self.goal.max_pole_rad_s.unwrap_or(MAX_POLE_RAD_S)
    }

    /// With what is taken where nothing is said.
    pub(super) fn with_search_stated(mut self) -> Self {
        if self.method == DesignMethod::FixedOrder {
            self.goal.max_pole_rad_s = Some(self.max_pole_rad_s());
            self.fixed_order = Some(self.fixed_order.unwrap_or_default());
        }
        self
    }

    /// Refuses what only `fixed-order` knows of the other methods, and what it cannot have.
    pub(super) fn check_fixed_order(&self) -> Result<(), StudyError> {
        if self.method != DesignMethod::FixedOrder {
            let given = [
                ("goal.order", self.goal.order.is_some()),
                ("structure", self.structure.is_some()),
                ("pid_filter_s", self.pid_filter_s.is_some()),
                ("local", !self.local.is_empty()),
                ("start", self.start.is_some()),
                ("fixed-order", self.fixed_order.is_some()),
            ];
            return match given.iter().find(|(_, given)| *given) {
                Some((field, _)) => {
                    let expected =
                        format!("nothing with method {}: it is of fixed-order", self.method.name());
                    Err(setting(field, expected, "a value"))
                }
                None => Ok(()),
            };
        }
        for (field, value) in
            [("goal.max_pole_rad_s", self.goal.max_pole_rad_s), ("goal.max_gain", self.goal.max_gain)]
        {
            if let Some(found) = value.filter(|v| !(*v >= LEAST_LIMIT && v.is_finite())) {
                let expected = format!("a finite number from {LEAST_LIMIT:e}");
                return Err(setting(field, expected, plain(found)));
            }
        }
        self.check_structure()?;
        self.check_poles()?;
        self.check_locals()?;
        if self.input_weight > 0.0 && !self.goal.minimize_h2.iter().any(|(_, w)| *w > 0.0) {
            let expected = "0, or outputs in goal.minimize_h2: rho u^2 is a part of its sum; goal.max_gain bounds the controller itself";
            return Err(setting("input_weight", expected, plain(self.input_weight)));
        }
        let s = self.fixed_order.unwrap_or_default();
        if s.tries > MOST_TRIES {
            return Err(setting("fixed-order.tries", format!("0 to {MOST_TRIES}"), s.tries.to_string()));
        }
        if s.seed > MOST_SEED {
            return Err(setting("fixed-order.seed", format!("0 to {MOST_SEED}"), s.seed.to_string()));
        }
        if !(1..=MOST_ITERATIONS).contains(&s.iterations) {
            let found = s.iterations.to_string();
            return Err(setting("fixed-order.iterations", format!("1 to {MOST_ITERATIONS}"), found));
        }
        if !((1e-12..=0.1).contains(&s.tolerance)) {
            return Err(setting("fixed-order.tolerance", "1e-12 to 0.1", plain(s.tolerance)));
        }
        Ok(())
    }

    fn check_structure(&self) -> Result<(), StudyError> {
        let kind = self.structure_kind();
        let (is_pid, is_local) =
            (kind == Some(StructureKind::Pid), kind == Some(StructureKind::Decentralised));
        match self.pid_filter_s {
            Some(_) if !is_pid => {
                return Err(setting("pid_filter_s", "nothing without structure = \"pid\"", "a value"));
            }
            Some(t) if !(t > 0.0 && t <= MOST_FILTER_S) => {
                let expected = format!("a positive number of seconds, up to {MOST_FILTER_S}");
                return Err(setting("pid_filter_s", expected, plain(t)));
            }
            Some(t) if 1.0 / t > self.max_pole_rad_s() => {
                let most = self.max_pole_rad_s();
                let expected = format!(
                    "{} s or more: its pole at 1/pid_filter_s is kept within goal.max_pole_rad_s = {}",
                    plain(1.0 / most),
                    plain(most)
                );
                return Err(setting("pid_filter_s", expected, plain(t)));
            }
            None if is_pid => {
                let expected = "the time constant of the derivative's filter, s (0.01 to begin with)";
                return Err(setting("pid_filter_s", expected, "none"));
            }
            _ => {}
        }
        if is_pid && self.goal.max_gain.is_some() {
            let expected = "nothing with structure = \"pid\": an integrator's gain has no bound";
            return Err(setting("goal.max_gain", expected, "a value"));
        }
        if is_local && self.local.is_empty() {
            return Err(setting("local", "a [[local]] of each part of the controller", "none"));
        }
        if !is_local && !self.local.is_empty() {
            let expected = "nothing without structure = \"decentralised\"";
            return Err(setting("local", expected, format!("{} of them", self.local.len())));
        }
        if matches!(kind, Some(StructureKind::Full | StructureKind::StrictlyProper))
            && self.goal.order.is_none()
        {
            let expected = format!("the controller's number of states, 0 to {MOST_ORDER}");
            return Err(setting("goal.order", expected, "none"));
        }
        Ok(())
    }

    /// Parts that see nothing or drive nothing, or that see or drive the same twice.
    fn check_locals(&self) -> Result<(), StudyError> {
        for (k, part) in self.local.iter().enumerate() {
            for (field, names) in
                [("local.measurements", &part.measurements), ("local.actuators", &part.actuators)]
            {
                if names.is_empty() {
                    let expected = "at least one name in each [[local]]";
                    return Err(setting(field, expected, format!("none in number {}", k + 1)));
                }
                if let Some(twice) =
                    names.iter().enumerate().find(|(i, n)| names[..*i].contains(n)).map(|(_, n)| n)
                {
                    let found = format!("`{twice}` twice in number {}", k + 1);
                    return Err(setting(field, "each name once in a [[local]]", found));
                }
            }
        }
        if self.start.as_deref() == Some("") {
            let expected = "a design's directory or result.json, or a controller's file";
            return Err(setting("start", expected, "nothing"));
        }
        Ok(())
    }

    fn check_poles(&self) -> Result<(), StudyError> {
        let p = self.poles.unwrap_or_default();
        let others = [
            ("poles.min_real_rad_s", p.min_real_rad_s),
            ("poles.max_imag_rad_s", p.max_imag_rad_s),
            ("poles.max_abs_rad_s", p.max_abs_rad_s),
            ("poles.rectangle_rad_s", p.rectangle_rad_s),
            ("poles.min_damping", p.min_damping),
        ];
        let most = self.max_pole_rad_s();
        if let Some(found) = p.max_real_rad_s.filter(|v| *v < -most) {
            let expected = format!(
                "0 down to {}: loops faster than the controller may be (goal.max_pole_rad_s) are not searched",
                plain(-most)
            );
            return Err(setting("poles.max_real_rad_s", expected, plain(found)));
        }
        match others.iter().find(|(_, v)| v.is_some()) {
            Some((field, _)) => {
                let expected = "nothing with method fixed-order: of the loop's poles it has max_real_rad_s alone, of the controller's \
                                goal.max_pole_rad_s; mixed-h2-hinf has this one";
                Err(setting(field, expected, "a value"))
            }
            None => Ok(()),
        }
    }
}
