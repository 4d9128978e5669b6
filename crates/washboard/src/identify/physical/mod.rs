//! The physical fit: a vehicle's parameters, its roads and the sensors' noise from spectra alone, by Whittle likelihood.

mod clocks;
#[cfg(test)]
mod derivative_tests;
mod joint;
mod layout;
mod model;
mod outcome;
mod slopes;
mod start;
mod uncertainty;

pub use outcome::{ClockEstimate, DriveOutcome, PhysicalOutcome};

use super::likelihood::{BandData, Drive, FitError, Reason};
use crate::lti::Parametric;
use crate::signal::CrossSpectra;
use crate::units::Convention;
use joint::Joint;
use layout::Layout;
use model::Model;

/// Noise is raised by these factors, one after another, from a start that may be far off.
pub const ANNEALING_FAR: [f64; 3] = [1000.0, 30.0, 1.0];
/// The same from a start whose symmetric part is right.
pub const ANNEALING_NEAR: [f64; 3] = [100.0, 10.0, 1.0];
/// The same from an answer to other data.
pub const ANNEALING_NONE: [f64; 1] = [1.0];

/// One recording of the vehicle.
#[derive(Clone, Copy)]
pub struct PhysicalDrive<'a> {
    /// The family over its parameters, with this recording's sensors as rows; all recordings have the same parameters.
    pub vehicle: &'a dyn Parametric,
    /// Whether channel i measures displacement (0), velocity (1) or acceleration (2) of the vehicle's row i.
    pub derivatives: &'a [usize],
    /// Spectra of the whole recording.
    pub spectra: &'a CrossSpectra,
    /// Spectra of equal pieces of the same recording with the same segments (at least 8, or none): the spread of the
    /// likelihood's gradient over them widens the standard deviations where the Fisher information is too sure.
    pub blocks: &'a [CrossSpectra],
    /// V, m/s.
    pub speed_m_s: f64,
    /// Band, Hz.
    pub band_hz: [f64; 2],
}

/// What a fit is told.
#[derive(Debug, Clone, PartialEq)]
pub struct PhysicalSettings {
    /// What S₀ is a density of.
    pub convention: Convention,
    /// Factors by which noise is raised, one after another; the last is 1.
    pub annealing: Vec<f64>,
    /// Where e and μ of each recording start, where they are known better than 2 and what hub pairs show.
    pub roads: Option<Vec<RoadStart>>,
    /// Whether the search may end early: to compare starts. Its standard deviations are the information's alone.
    pub rough: bool,
    /// Whether sensors' clocks are looked at, and fitted where they are off.
    pub clocks: bool,
}

impl PhysicalSettings {
    /// From a start that may be far off, with clocks looked at.
    #[must_use]
    pub fn new(convention: Convention) -> Self {
        PhysicalSettings {
            convention,
            annealing: ANNEALING_FAR.to_vec(),
            roads: None,
            rough: false,
            clocks: true,
        }
    }
}

/// Where a road starts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoadStart {
    /// e.
    pub exponent: f64,
    /// μ, with more than one track.
    pub mu: Option<f64>,
}

/// Fits a vehicle and its roads to measured spectra of one recording or several.
///
/// Minimises Σ_r n_avg Σ_k (ln|S(ω_k)| + tr S⁻¹Ŝ(ω_k)) over the logarithms of the vehicle's free parameters, which all
/// recordings share, and of each recording S₀, e, μ, the delay and a noise floor a channel, where
/// S = W * (H* S_r Hᵀ) + N is the model seen through the window's kernel.
///
/// The common scale of masses, stiffnesses and dampers cannot be seen in responses: hold one of them.
///
/// Where a sensor's clock is off (its phase tells; one step of the information finds it), clock offsets are fitted too and
/// are kept where the model then explains the data.
///
/// # Errors
/// [`FitError`] for what cannot be started. A fit that did not succeed is an outcome with `problems`.
pub fn fit_physical(
    drives: &[PhysicalDrive<'_>],
    settings: &PhysicalSettings,
) -> Result<PhysicalOutcome, FitError> {
    let joint = joint(drives, settings, false)?;
    let start = start::theta(&joint, drives, settings.roads.as_deref())?;
    let found = joint.search(&start, &settings.annealing, settings.rough).map_err(FitError::Start)?;
    if settings.clocks
        && let Some(off) = clocks::suspicion(&joint, &found.theta, || self::joint(drives, settings, true))
        && let Some(better) = clocks::refit(off, &settings.annealing)
    {
        return outcome::outcome(&better.joint, &better.start, &better.found, drives, settings.rough)
            .map_err(FitError::Start);
    }
    outcome::outcome(&joint, &start, &found, drives, settings.rough).map_err(FitError::Start)
}

fn joint<'a>(
    drives: &[PhysicalDrive<'a>],
    settings: &PhysicalSettings,
    clocks: bool,
) -> Result<Joint<'a>, FitError> {
    let models = drives.iter().map(|d| model(d, settings, clocks)).collect::<Result<Vec<_>, _>>()?;
    if models.is_empty() { Err(FitError::NoDrive) } else { Ok(Joint::new(models)) }
}

fn model<'a>(
    drive: &PhysicalDrive<'a>,
    settings: &PhysicalSettings,
    clocks: bool,
) -> Result<Model<'a>, FitError> {
    let channels = &drive.spectra.channels;
    if channels.len() < 2 {
        return Err(FitError::OneChannel { channel: channels.first().cloned().unwrap_or_default() });
    }
    let values = drive.vehicle.start();
    let base = drive.vehicle.system(&values).map_err(FitError::Start)?;
    let differs = |axis: usize| base.at_m().iter().any(|p| (p[axis] - base.at_m()[0][axis]).abs() > 1e-9);
    Ok(Model {
        vehicle: drive.vehicle,
        derivatives: drive.derivatives,
        drive: Drive { speed_m_s: drive.speed_m_s, convention: settings.convention },
        layout: Layout::new(values.len(), differs(1), differs(0), clocks, channels.len()),
        channels,
        at_m: base.at_m().to_vec(),
        data: BandData::new(drive.spectra, drive.band_hz)?,
        averages: drive.spectra.averages,
    })
}
