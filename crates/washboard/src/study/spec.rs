//! What a job is told: exactly what a command line gives, as data.

use super::{DesignSpec, RoadAnalyticSpec, RoadFitSpec, RoadIriSpec, RoadProfileSpec, StudyError};
use crate::units::Convention;
use crate::vehicle::Stretch;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// A job and its settings. In JSON `job` says which: `{"job": "modes", "vehicle": "case:turkay-half-car"}`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "job", rename_all = "kebab-case")]
pub enum Spec {
    /// See [`modes`](super::modes).
    Modes(ModesSpec),
    /// See [`ride`](super::ride).
    Ride(RideSpec),
    /// See [`respond`](super::respond).
    Respond(RespondSpec),
    /// See [`simulate`](super::simulate).
    Simulate(SimulateSpec),
    /// See [`identify`](super::identify).
    Identify(IdentifySpec),
    /// See [`demo`](super::demo).
    Demo(DemoSpec),
    /// See [`damping`](super::damping).
    Damping(DampingSpec),
    /// See [`compare`](super::compare).
    Compare(CompareSpec),
    /// See [`reproduce`](super::reproduce).
    Reproduce(super::ReproduceSpec),
    /// See [`interpolate_file`](super::interpolate_file).
    Interpolate(super::InterpolateSpec),
    /// See [`design`](super::design).
    Design(Box<DesignSpec>),
    /// See [`sweep`](super::sweep).
    Sweep(super::SweepSpec),
    /// See [`road_fit`](super::road_fit).
    RoadFit(Box<RoadFitSpec>),
    /// See [`road_profile`](super::road_profile).
    RoadProfile(RoadProfileSpec),
    /// See [`road_iri`](super::road_iri).
    RoadIri(RoadIriSpec),
    /// See [`road_analytic`](super::road_analytic).
    RoadAnalytic(RoadAnalyticSpec),
}

/// The modes of a vehicle.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModesSpec {
    /// A vehicle file or `case:NAME`.
    pub vehicle: String,
}

/// A vehicle on a road.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RideSpec {
    /// A vehicle file or `case:NAME`.
    pub vehicle: String,
    /// A road file or `case:NAME`.
    pub road: String,
    /// Forward speed.
    pub speed_m_s: f64,
    /// A controller in the loop: a design's directory or `result.json`, or a file `{a, b, c, d, inputs, outputs}`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub controller: Option<PathBuf>,
    /// Stroke of every suspension to either side of where it rests: how often it bottoms.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stroke_m: Option<f64>,
}

/// A vehicle over a bump, or for a pattern of the road.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RespondSpec {
    /// A vehicle file or `case:NAME`.
    pub vehicle: String,
    /// Forward speed.
    pub speed_m_s: f64,
    /// Height and length of a bump, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bump: Option<[f64; 2]>,
    /// A pattern of the road under the wheels.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub direction: Option<super::Direction>,
    /// A controller in the loop.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub controller: Option<PathBuf>,
}

/// Equivalent linear damping of dampers with curves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DampingSpec {
    /// A vehicle file or `case:NAME`.
    pub vehicle: String,
    /// Road files or `case:NAME`; ISO classes A to E where there is none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub roads: Vec<String>,
    /// Forward speed.
    pub speed_m_s: f64,
}

/// A recorded drive, from a model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SimulateSpec {
    /// A vehicle file or `case:NAME`.
    pub vehicle: String,
    /// A road file or `case:NAME`.
    pub road: String,
    /// Forward speed; this and the length, or stretches.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub speed_m_s: Option<f64>,
    /// Length of the recording.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub duration_s: Option<f64>,
    /// Stretches of constant speed, one after another, with jumps between.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub speeds: Vec<Stretch>,
    /// Samples per second.
    pub rate_hz: f64,
    /// White noise as a multiple of each channel's rms; a sensors file may say otherwise for a sensor.
    #[serde(default)]
    pub noise: f64,
    /// A sensors file; accelerometers at every body corner and hub without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sensors: Option<PathBuf>,
    /// Same seed, same drive.
    #[serde(default)]
    pub seed: u64,
    /// RUN.csv; its description and truth are written beside it.
    pub output: PathBuf,
}

/// From a recording to modes and the road.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IdentifySpec {
    /// RUN.toml.
    pub recording: PathBuf,
    /// More recordings of the same vehicle, at other speeds or on other roads.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub more: Vec<PathBuf>,
    /// What the vehicle is like: a vehicle file or `case:NAME`; without it a generic vehicle on the recording's wheels.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub vehicle: Option<String>,
    /// Values that are known, by their dotted names in a vehicle file: held, and what sets the scale.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub known: Vec<(String, f64)>,
    /// How.
    #[serde(default)]
    pub method: IdentifyMethod,
    /// The band that is fitted, where not the method's own choice.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub band_hz: Option<[f64; 2]>,
    /// Length of a segment of the spectra, where not the method's own choice.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub segment_s: Option<f64>,
    /// What the road's roughness is reported as a density of.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub convention: Option<Convention>,
}

impl IdentifySpec {
    /// Refuses what no recording can satisfy: to be asked first.
    ///
    /// # Errors
    /// A segment that is not positive, a band that is none.
    pub fn check(&self) -> Result<(), StudyError> {
        let setting = |field, expected: &str, found| {
            Err(StudyError::Setting { field, expected: expected.to_owned(), found })
        };
        match self.segment_s {
            Some(s) if !(s.is_finite() && s > 0.0) => {
                return setting("segment_s", "a positive number", s.to_string());
            }
            _ => {}
        }
        match self.band_hz {
            Some([low, high]) if !(low >= 0.0 && high > low && high.is_finite()) => {
                setting("band_hz", "two frequencies from 0, ascending", format!("[{low}, {high}]"))
            }
            _ => Ok(()),
        }
    }
}

/// Two results side by side.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CompareSpec {
    /// The earlier result of `identify` or `demo`: its directory, or its `result.json`.
    pub before: PathBuf,
    /// The later one.
    pub after: PathBuf,
}

/// The methods of identification.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum IdentifyMethod {
    /// A vehicle's parameters and its road, fitted to all cross-spectra.
    #[default]
    Physical,
    /// Covariance-driven stochastic subspace identification.
    Ssi,
    /// The track-vehicle interaction modal model with free modes.
    Tvimm,
    /// The poly-reference least-squares complex frequency estimator.
    Plscf,
    /// Frequency-domain decomposition with enhanced damping.
    Fdd,
}

impl IdentifyMethod {
    /// All of them.
    pub const ALL: [IdentifyMethod; 5] = [
        IdentifyMethod::Physical,
        IdentifyMethod::Ssi,
        IdentifyMethod::Tvimm,
        IdentifyMethod::Plscf,
        IdentifyMethod::Fdd,
    ];

    /// As it is written.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            IdentifyMethod::Physical => "physical",
            IdentifyMethod::Ssi => "ssi",
            IdentifyMethod::Tvimm => "tvimm",
            IdentifyMethod::Plscf => "plscf",
            IdentifyMethod::Fdd => "fdd",
        }
    }

    /// Whether it is operational modal analysis: a structure under white forces, and no vehicle.
    #[must_use]
    pub fn is_operational(self) -> bool {
        matches!(self, IdentifyMethod::Ssi | IdentifyMethod::Plscf | IdentifyMethod::Fdd)
    }
}

/// The main job on a published car.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DemoSpec {
    /// Of the simulated drive.
    #[serde(default)]
    pub seed: u64,
}
