//! What the jobs about roads are told.

use crate::road::FilterOutput;
use crate::units::Convention;
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};
use std::path::PathBuf;

/// A shaping filter from a spectrum, a profile or a road.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RoadFitSpec {
    /// A CSV file of a spectrum or a profile, a road file, `case:NAME`, or the directory that `identify -o` wrote.
    pub source: String,
    /// The file is a profile without a header: distance in m, then heights in m.
    #[serde(default)]
    pub no_header: bool,
    /// n; chosen by Bayes' criterion where it is not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub order: Option<usize>,
    /// The largest order that is tried, where n is chosen.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_order: Option<usize>,
    /// λ of s = λ(z − 1)/(z + 1).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lambda_rad: Option<f64>,
    /// p, the block rows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub block_rows: Option<usize>,
    /// How noisy the samples are taken to be.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub weight: Option<FitWeight>,
    /// What the densities are, where not what the frequency column says.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub convention: Option<DensityConvention>,
    /// What the spectrum is of; displacement where it is not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub of: Option<FilterOutput>,
    /// The part of the band that is fitted: rad/m or rad/s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub band_rad: Option<[f64; 2]>,
    /// Corner of the low-pass that makes the filter strictly proper: rad/m or rad/s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub roll_off_rad: Option<f64>,
    /// How many times that low-pass is passed, 1 or 2; without it 2 of a matrix spectrum, so that velocities are not white, else 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub roll_off_order: Option<usize>,
    /// Names of a vehicle's road inputs, one a channel of a matrix spectrum; without them they are the vehicle's in its order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub points: Vec<String>,
    /// A filter with feedthrough is left as it is.
    #[serde(default)]
    pub proper: bool,
    /// Length of the segments of a profile's spectrum.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub segment_m: Option<f64>,
    /// Bands an octave in which a raw spectrum is averaged before it is fitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub smooth_per_octave: Option<f64>,
    /// FILTER.toml, a road file; or FILTER.json, a state space.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub output: Option<PathBuf>,
    /// Replace what is there.
    #[serde(default)]
    pub overwrite: bool,
}

/// How noisy samples of a spectrum are taken to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FitWeight {
    /// All alike.
    None,
    /// R = S.
    Relative,
    /// R = S²: errors of the logarithm.
    Relative2,
}

/// What numbers a density is made of: a spatial [`Convention`], or one over time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DensityConvention {
    /// var = ∫₀^∞ G dν.
    OneSidedRadPerM,
    /// var = ∫ G dν over the whole axis.
    TwoSidedRadPerM,
    /// var = ∫₀^∞ G dn.
    OneSidedCyclesPerM,
    /// var = ∫ G dn over the whole axis.
    TwoSidedCyclesPerM,
    /// [`Convention::Paper`].
    Paper,
    /// var = ∫₀^∞ G df.
    OneSidedPerHz,
    /// var = ∫ G df over the whole axis: S itself.
    TwoSidedPerHz,
    /// var = ∫₀^∞ G dω.
    OneSidedRadPerS,
    /// var = ∫ G dω over the whole axis.
    TwoSidedRadPerS,
}

impl DensityConvention {
    /// S of the two-sided kind with var = (1/2π) ∫ S, over the density: spatial and temporal ones.
    pub(super) fn factor(self) -> f64 {
        let spatial = |c: Convention| c.two_sided_time(1.0, 1.0);
        match self {
            DensityConvention::OneSidedRadPerM => spatial(Convention::OneSidedRadPerM),
            DensityConvention::TwoSidedRadPerM => spatial(Convention::TwoSidedRadPerM),
            DensityConvention::OneSidedCyclesPerM => spatial(Convention::OneSidedCyclesPerM),
            DensityConvention::TwoSidedCyclesPerM => spatial(Convention::TwoSidedCyclesPerM),
            DensityConvention::Paper => spatial(Convention::Paper),
            DensityConvention::OneSidedPerHz => crate::units::two_sided_from_per_hz(1.0),
            DensityConvention::TwoSidedPerHz => 1.0,
            DensityConvention::OneSidedRadPerS => PI,
            DensityConvention::TwoSidedRadPerS => TAU,
        }
    }

    /// Whether it is over distance.
    pub(super) fn is_spatial(self) -> bool {
        matches!(
            self,
            DensityConvention::OneSidedRadPerM
                | DensityConvention::TwoSidedRadPerM
                | DensityConvention::OneSidedCyclesPerM
                | DensityConvention::TwoSidedCyclesPerM
                | DensityConvention::Paper
        )
    }
}

/// A random profile of a road.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RoadProfileSpec {
    /// A road file or `case:NAME`.
    pub road: String,
    /// Its length.
    pub length_m: f64,
    /// Distance of the points.
    pub step_m: f64,
    /// How far apart two tracks are; one track without it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub track_width_m: Option<f64>,
    /// The speed at which a road over time is driven.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub speed_m_s: Option<f64>,
    /// Same seed, same profile.
    #[serde(default)]
    pub seed: u64,
    /// PROFILE.csv.
    pub output: PathBuf,
    /// Replace what is there.
    #[serde(default)]
    pub overwrite: bool,
}

/// The roughness index of a profile.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RoadIriSpec {
    /// PROFILE.csv.
    pub profile: PathBuf,
    /// The file has no header: distance in m, then heights in m.
    #[serde(default)]
    pub no_header: bool,
    /// Length of the segments; 20 m where it is not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub segment_m: Option<f64>,
    /// Length of the moving average, 0 for none; the standard's where it is not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub moving_average_m: Option<f64>,
}

/// An analytic function from its real or imaginary part, its phase or its magnitude.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RoadAnalyticSpec {
    /// DATA.csv.
    pub data: PathBuf,
    /// n.
    pub order: usize,
    /// p, the block rows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub block_rows: Option<usize>,
    /// λ of s = λ(z − 1)/(z + 1), where the data is over frequency.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lambda_rad: Option<f64>,
    /// The real part is that of a positive real function.
    #[serde(default)]
    pub positive: bool,
    /// A CSV file of the samples, what was fitted and what follows from it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub output: Option<PathBuf>,
    /// Replace what is there.
    #[serde(default)]
    pub overwrite: bool,
}
