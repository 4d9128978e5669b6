//! The track-vehicle interaction modal model with free modes: poles, shapes and the road from spectra, no vehicle file.

mod data_start;
#[cfg(test)]
mod derivative_tests;
mod extra;
mod information;
mod model;
mod modes;
mod orbit;
mod order;
mod outcome;
mod score;
mod search;

pub use data_start::{NoDataStart, data_start};
pub use outcome::{FreeOrder, FreeOutcome, FreeTrial};

use super::likelihood::{BandData, CHI_LIMIT, Drive, FitError, RoadValues, Whitening, mean};
use crate::lti::FirstOrder;
use crate::signal::CrossSpectra;
use crate::units::Convention;
use model::{FreeModel, Point, RATE};
use rayon::prelude::*;
use search::Found;

/// Starts whose costs differ by more have led to different answers.
pub(super) const SAME_COST: f64 = 1.0;
/// Noise is raised by these factors, one after another, from a start that may be far off.
const ANNEALING_FAR: [f64; 3] = [300.0, 15.0, 1.0];
/// The same from a start that is an answer already.
const ANNEALING_NONE: [f64; 1] = [1.0];

/// What was measured.
#[derive(Clone, Copy)]
pub struct FreeDrive<'a> {
    /// Spectra of the whole recording.
    pub spectra: &'a CrossSpectra,
    /// Spectra of equal pieces of the same recording with the same segments (at least 8, or none), to widen intervals by.
    pub blocks: &'a [CrossSpectra],
    /// Places of the wheels, m.
    pub at_m: &'a [[f64; 2]],
    /// Whether channel i measures displacement (0), velocity (1) or acceleration (2).
    pub derivatives: &'a [usize],
    /// What each sensor shows of a road's plane that the vehicle follows: of 1, y and x. \[1, y, x\] for a vertical sensor.
    pub planes: &'a [[f64; 3]],
    /// V, m/s.
    pub speed_m_s: f64,
    /// Band, Hz.
    pub band_hz: [f64; 2],
}

/// Where a search starts.
#[derive(Debug, Clone)]
pub struct FreeStart {
    /// What it was made from.
    pub name: String,
    /// Whether it may be far off: noise is then annealed.
    pub far: bool,
    /// Whether the residual at this start, untouched, may say where a mode more is asked for: not at a start from the data,
    /// which has bent its modes to stand in for one that lacks.
    pub base: bool,
    /// Displacements of the sensors per road height under the wheels.
    pub system: FirstOrder,
    /// S₀.
    pub roughness_m3: f64,
    /// e.
    pub exponent: f64,
    /// μ, with more than one track.
    pub mu: Option<f64>,
}

/// Fits free modes and the road to measured spectra.
///
/// Minimises n_avg Σ_k (ln|S(ω_k)| + tr S⁻¹Ŝ(ω_k)) + ½|static misfit/.01|² over all stable systems H(s) = C(sI − A)⁻¹B of an
/// order, the road (S₀, e, μ, delay) and a noise floor a channel, with S = W * (H* S_r Hᵀ) + N seen through the window's
/// kernel. H maps road heights under the wheels to displacements at the sensors; it is the modal sum
/// Σ_n ψ_n L_nᵀ/(iω − λ_n) of the track-vehicle interaction modal model without that poles need be distinct. What
/// calibrates S₀ without a vehicle: statically a vehicle follows the road, H(0)·(plane at the wheels) = (plane at the
/// sensors).
///
/// Steps are Levenberg–Marquardt's on the Fisher information in the complement of the similarity orbit (order·(channels +
/// wheels) free parameters). Starts are searched in their order until two agree; then modes are added, one by one, where the residual asks for them
/// most, as long as it asks and Bayes' criterion falls; a mode that became two real poles is taken out again.
///
/// # Errors
/// [`FitError`] for what cannot be started. A fit that did not succeed is an outcome with `problems`.
///
/// Source: De Filippis et al., *the Track-Vehicle Interaction Modal Model*, eqs. (28)–(61), with the errata of
/// `docs/`; McKelvey, Helmersson, Ribarits, *Data driven local coordinates*, Automatica 40 (2004) 1629–1635.
pub fn fit_free_modes(
    drive: &FreeDrive<'_>,
    starts: &[FreeStart],
    convention: Convention,
) -> Result<FreeOutcome, FitError> {
    if drive.spectra.channels.len() < 2 {
        let channel = drive.spectra.channels.first().cloned().unwrap_or_default();
        return Err(FitError::OneChannel { channel });
    }
    let model = FreeModel {
        data: BandData::new(drive.spectra, drive.band_hz)?,
        drive: Drive { speed_m_s: drive.speed_m_s, convention },
        at_m: drive.at_m.to_vec(),
        derivatives: drive.derivatives.to_vec(),
        planes: drive.planes.to_vec(),
    };
    let search = |start: &FreeStart| {
        let annealing: &[f64] = if start.far { &ANNEALING_FAR } else { &ANNEALING_NONE };
        let found = search::search_patiently(&model, &point(&model, start), annealing)?;
        Some((trial(&model, start.name.clone(), &found), found))
    };
    let bases: Vec<Point> = starts.iter().filter(|s| s.base).take(2).map(|s| point(&model, s)).collect();
    // two searches at least are needed, and one with a mode more: alone they do not keep two cores busy
    let (pair, others) = starts.split_at(starts.len().min(2));
    let (mut trials, ahead) = rayon::join(
        || pair.par_iter().filter_map(search).collect::<Vec<(FreeTrial, Found)>>(),
        || order::ahead(&model, &bases, drive.band_hz),
    );
    trials.sort_by(|a, b| a.0.cost.total_cmp(&b.0.cost));
    for start in others {
        if confirmed(&trials) {
            break;
        }
        trials.extend(search(start));
        trials.sort_by(|a, b| a.0.cost.total_cmp(&b.0.cost));
    }
    let tried: Vec<FreeTrial> = trials.iter().map(|(t, _)| t.clone()).collect();
    let Some((_, best)) = trials.into_iter().next() else {
        return Err(FitError::Start("no start has a likelihood: are the wheels' places right?".into()));
    };
    let chosen = order::choose(&model, best, &bases, ahead, drive.band_hz);
    outcome::outcome(&model, drive, &chosen, tried).map_err(FitError::Start)
}

/// Whether the two best searches converged to the same cost; or whether neither explains the data, so that no third will.
fn confirmed(trials: &[(FreeTrial, Found)]) -> bool {
    match trials {
        [(a, _), (b, _), ..] => {
            a.converged && b.converged && b.cost - a.cost < SAME_COST
                || a.chi > CHI_LIMIT && b.chi > CHI_LIMIT
        }
        _ => false,
    }
}

fn point(model: &FreeModel, start: &FreeStart) -> Point {
    Point {
        system: start.system.in_time_of(RATE),
        road: RoadValues {
            ln_s0: start.roughness_m3.ln(),
            exponent: start.exponent,
            mu: start.mu.unwrap_or(0.0),
            ln_delay: 0.0,
        },
        ln_noise: model.data.noise.iter().map(|n| n.ln()).collect(),
    }
}

fn chi(model: &FreeModel, found: &Found) -> f64 {
    Whitening::new(&found.frame.evaluation.s)
        .map_or(f64::INFINITY, |w| mean(&w.residuals(&model.data.measured, model.data.averages)))
}

fn trial(model: &FreeModel, name: String, found: &Found) -> FreeTrial {
    FreeTrial {
        name,
        cost: found.score.cost,
        chi: chi(model, found),
        converged: found.converged,
        steps: found.steps,
        evaluations: found.evaluations,
    }
}
