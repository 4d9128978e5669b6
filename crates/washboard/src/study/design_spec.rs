//! What a design is told: a DESIGN.toml as data.

use super::design_fixed_spec::{FixedOrderSection, LocalSection, StructureSpec};
use super::design_goal::plain;
use super::design_homes::at_home;
use super::design_mixed_spec::{LyapunovScaleSpec, MixedSection, PolesSection};
use super::{ActuatorSection, Goal, MetricsSection, Named, StudyError};
use crate::vehicle::Disturbance;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// A design. Vehicle and road are files or `case:NAME`; a file's path is relative to the design's own.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DesignSpec {
    /// A vehicle file or `case:NAME`.
    pub vehicle: String,
    /// A road file or `case:NAME`.
    pub road: String,
    /// Forward speed.
    pub speed_m_s: f64,
    /// What the controller sees: outputs of the vehicle; a name without its corner means all corners. Of
    /// `robust-state-feedback` these are the states, chosen where none is given.
    #[serde(default)]
    pub measurements: Vec<String>,
    /// How the controller is found.
    pub method: DesignMethod,
    /// What H2 and H∞ norms are taken from.
    #[serde(default)]
    pub disturbance: DesignDisturbance,
    /// Vehicle fields with other values: dotted names, a bare one means every axle.
    #[serde(default, skip_serializing_if = "Named::is_empty")]
    pub r#override: Named<f64>,
    /// Vehicle fields at which the passive norms that weights refer to are taken; without it, those of the vehicle itself.
    #[serde(default, skip_serializing_if = "Named::is_empty")]
    pub normalize_at: Named<f64>,
    /// ρ of every control: ρ u² is added to the cost, N⁻² (`lqg`, `h2-limit`); √ρ u is a performance (`hinf`).
    #[serde(default)]
    pub input_weight: f64,
    /// Order of Padé's approximation of the delay of wheels that follow.
    #[serde(default = "delay_order")]
    pub delay_order: usize,
    /// What is to be small.
    #[serde(default)]
    pub goal: Goal,
    /// Noises of `lqg`; the methods by inequalities have none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lqg: Option<LqgSection>,
    /// What `interpolation` copies.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interpolation: Option<InterpolationSection>,
    /// Where the loop's poles are to be (`mixed-h2-hinf`, `robust-state-feedback`).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub poles: Option<PolesSection>,
    /// The free scale of the Lyapunov matrix that H2 and H∞ norms share.
    #[serde(default, skip_serializing_if = "LyapunovScaleSpec::is_searched")]
    pub lyapunov_scale: LyapunovScaleSpec,
    /// Vehicle fields that are only known to lie between two values: one gain for all of them (`robust-state-feedback`).
    #[serde(
        default,
        skip_serializing_if = "Named::is_empty",
        deserialize_with = "super::design_pairs::ranges"
    )]
    pub range: Named<[f64; 2]>,
    /// Vehicle fields of the vehicles that one controller is for: with `robust-state-feedback` each has the whole range.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub plant: Vec<Named<f64>>,
    /// Orders to which the controller is truncated too, each in its own loop (`mixed-h2-hinf`).
    #[serde(
        default,
        skip_serializing_if = "Vec::is_empty",
        deserialize_with = "super::design_pairs::orders"
    )]
    pub truncate_to: Vec<usize>,
    /// Noise and back-off of `mixed-h2-hinf`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mixed: Option<MixedSection>,
    /// Which entries of the controller are free (`fixed-order`): all where it is left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub structure: Option<StructureSpec>,
    /// Time constant of the derivative's filter of `structure = "pid"`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pid_filter_s: Option<f64>,
    /// The parts of `structure = "decentralised"`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub local: Vec<LocalSection>,
    /// A controller to begin with: a design's directory or `result.json`, or a file `{a, b, c, d, inputs, outputs}`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start: Option<String>,
    /// How long `fixed-order` looks.
    #[serde(default, rename = "fixed-order", skip_serializing_if = "Option::is_none")]
    pub fixed_order: Option<FixedOrderSection>,
    /// What stands between the controller and the forces: the loop with it is looked at.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub actuator: Option<ActuatorSection>,
    /// Step of the controller as it is written for use, s; none without it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub discretize: Option<Discretize>,
    /// What metrics are taken with.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub metrics: Option<MetricsSection>,
}

fn delay_order() -> usize {
    crate::vehicle::DELAY_ORDER
}

/// Delays of higher order make plants whose Riccati equations take minutes.
const MOST_DELAY_ORDER: usize = 40;

/// How a controller is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DesignMethod {
    /// The regulator on a Kalman filter: least Σ(wᵢ‖Tᵢ‖₂/‖Gᵢ‖₂)² under sensor noise.
    #[default]
    Lqg,
    /// No controller, but the cost that none can beat as sensor noise vanishes.
    H2Limit,
    /// The least H∞ norm of all weighted outputs together.
    Hinf,
    /// Least H2 norms under bounds on H∞ norms and on poles, by matrix inequalities: output feedback of the plant's order.
    MixedH2Hinf,
    /// The same by one gain from the vehicle's states, for a range of vehicles.
    RobustStateFeedback,
    /// The least largest of H∞ and H2 norms under bounds, by controllers of given order and structure.
    FixedOrder,
    /// A quarter car's acceleration of an LQG design for a tire of more damping, interpolated on the real one.
    Interpolation,
}

impl DesignMethod {
    /// Whether it is by matrix inequalities.
    #[must_use]
    pub fn is_by_inequalities(self) -> bool {
        matches!(self, DesignMethod::MixedH2Hinf | DesignMethod::RobustStateFeedback)
    }

    /// Whether it takes bounds beside its goal.
    #[must_use]
    pub fn takes_bounds(self) -> bool {
        self.is_by_inequalities() || self == DesignMethod::FixedOrder
    }

    /// As it is written.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            DesignMethod::Lqg => "lqg",
            DesignMethod::H2Limit => "h2-limit",
            DesignMethod::Hinf => "hinf",
            DesignMethod::MixedH2Hinf => "mixed-h2-hinf",
            DesignMethod::RobustStateFeedback => "robust-state-feedback",
            DesignMethod::FixedOrder => "fixed-order",
            DesignMethod::Interpolation => "interpolation",
        }
    }
}

/// What drives the norms.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DesignDisturbance {
    /// The velocity of the road, m/s.
    #[default]
    RoadVelocity,
    /// Its height, m.
    RoadDisplacement,
    /// The white noise behind the road's filter.
    RoadNoise,
}

impl From<DesignDisturbance> for Disturbance {
    fn from(d: DesignDisturbance) -> Self {
        match d {
            DesignDisturbance::RoadVelocity => Disturbance::RoadVelocity,
            DesignDisturbance::RoadDisplacement => Disturbance::RoadDisplacement,
            DesignDisturbance::RoadNoise => Disturbance::RoadNoise,
        }
    }
}

/// Absolute intensities.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LqgSection {
    /// Of white noise on every measurement, in its unit squared times seconds.
    #[serde(default = "sensor_noise")]
    pub sensor_noise: f64,
    /// Of the disturbance.
    #[serde(default = "process_noise")]
    pub process_noise: f64,
    /// Whether the cost keeps its cross term of states and controls; false reproduces a printed design that dropped it.
    #[serde(default = "cross_term")]
    pub cross_term: bool,
}

fn cross_term() -> bool {
    true
}

fn sensor_noise() -> f64 {
    1e-8
}

fn process_noise() -> f64 {
    1.0
}

impl Default for LqgSection {
    fn default() -> Self {
        LqgSection { sensor_noise: sensor_noise(), process_noise: process_noise(), cross_term: true }
    }
}

/// The design that is copied, and where the copy is to hold.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InterpolationSection {
    /// Tire damping of the car that the LQG design is made for.
    pub fictitious_tire_damping_n_s_per_m: f64,
    /// Up to here Ψ is 1, rad/s …
    #[serde(default = "band")]
    pub band_rad_s: f64,
    /// … to this share.
    #[serde(default = "tolerance")]
    pub tolerance: f64,
    /// Ψ's a, rad/s, and b, (rad/s)², as given; both or none.
    #[serde(default, skip_serializing_if = "Option::is_none", deserialize_with = "super::design_pairs::psi")]
    pub psi: Option<[f64; 2]>,
}

fn band() -> f64 {
    100.0
}

fn tolerance() -> f64 {
    0.05
}

/// How a controller is made discrete for use.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Discretize {
    /// The step, s.
    pub dt_s: f64,
    /// By which rule.
    #[serde(default)]
    pub rule: DiscretizeRule,
}

/// A rule of discretisation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DiscretizeRule {
    /// The trapezium rule: phases right, frequencies bent.
    #[default]
    Tustin,
    /// Exact for measurements that stay between samples.
    ZeroOrderHold,
}

impl DesignSpec {
    /// The design of a file; vehicle and road files in it are relative to it.
    ///
    /// # Errors
    /// A file that can't be read, an unknown key with the nearest that is.
    pub fn read(path: &std::path::Path) -> Result<Self, StudyError> {
        let mut spec: DesignSpec = crate::files::read_toml(path).map_err(at_home)?;
        spec.resolve(path.parent().unwrap_or(std::path::Path::new("")));
        Ok(spec)
    }

    /// Files named relative to a folder, as they are to be opened.
    pub(super) fn resolve(&mut self, folder: &std::path::Path) {
        for name in [&mut self.vehicle, &mut self.road].into_iter().chain(self.start.as_mut()) {
            // an empty name is no file beside the design: it is refused by its field
            if !name.starts_with("case:") && !name.is_empty() {
                *name = folder.join(PathBuf::from(name.as_str())).display().to_string();
            }
        }
    }

    /// Noises of `lqg`, as they are where they are not stated.
    #[must_use]
    pub fn noises(&self) -> LqgSection {
        self.lqg.clone().unwrap_or_default()
    }

    /// Refuses numbers that no design can have.
    ///
    /// # Errors
    /// [`StudyError::Setting`] with the field.
    pub fn check(&self) -> Result<(), StudyError> {
        let noises = self.noises();
        let usual = |v: f64| v == 0.0 || (1e-60..=1e60).contains(&v);
        for (field, found) in [
            ("lqg.sensor_noise", noises.sensor_noise),
            ("lqg.process_noise", noises.process_noise),
            ("input_weight", self.input_weight),
        ] {
            if !usual(found) {
                let expected = "0, or a number from 1e-60 to 1e60".to_owned();
                return Err(StudyError::Setting { field, expected, found: plain(found) });
            }
        }
        if !(0.01..=500.0).contains(&self.speed_m_s) {
            let (field, expected) = ("speed_m_s", "a positive number, 0.01 to 500 m/s".to_owned());
            return Err(StudyError::Setting { field, expected, found: plain(self.speed_m_s) });
        }
        if self.delay_order > MOST_DELAY_ORDER {
            let (field, expected) = ("delay_order", format!("an order up to {MOST_DELAY_ORDER}"));
            return Err(StudyError::Setting { field, expected, found: self.delay_order.to_string() });
        }
        if let Some(d) = self.discretize.filter(|d| !(1e-9..=100.0).contains(&d.dt_s)) {
            let (field, expected) = ("discretize.dt_s", "1e-9 to 100 s".to_owned());
            return Err(StudyError::Setting { field, expected, found: plain(d.dt_s) });
        }
        self.metrics.iter().try_for_each(MetricsSection::check)?;
        let numbered = |(k, p): (usize, &Named<f64>)| {
            p.iter().map(|(n, v)| ("plant", format!("number {}: {n}", k + 1), *v)).collect::<Vec<_>>()
        };
        let named = |field: &'static str, of: &Named<f64>| {
            of.iter().map(|(n, v)| (field, n.to_owned(), *v)).collect::<Vec<_>>()
        };
        let all =
            named("override", &self.r#override).into_iter().chain(named("normalize_at", &self.normalize_at));
        let mut all = all.chain(self.plant.iter().enumerate().flat_map(numbered));
        if let Some((field, name, v)) = all.find(|(_, _, v)| !v.is_finite()) {
            let expected = "finite numbers".to_owned();
            return Err(StudyError::Setting { field, expected, found: format!("{name} = {v}") });
        }
        self.check_actuator()?;
        self.check_fixed_order()?;
        self.check_inequalities()
    }
}
