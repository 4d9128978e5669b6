//! The physical fit: a vehicle's parameters, its road and the sensors' noise from spectra alone, by Whittle likelihood.

mod data;
mod model;
mod scoring;
mod uncertainty;
mod whittle;

use crate::linalg::{C64, CMat};
use crate::lti::{Mode, Parametric};
use crate::signal::CrossSpectra;
use crate::units::Convention;
use data::BandData;
use model::{Layout, Model};
use std::f64::consts::TAU;
use thiserror::Error;

/// χ above this says that the model does not explain the data: right answers have .33–.44, wrong ones ≥ 1.3.
pub const CHI_LIMIT: f64 = 0.6;
/// The same for an eighth of the band, whose mean scatters more.
const PART_CHI_LIMIT: f64 = 0.9;
/// A mode whose frequency is not known to this share of itself is not identified.
const LARGEST_FREQ_SD: f64 = 0.1;
/// A parameter whose logarithm is not known to this is not identified by itself.
const WEAK_LN_SD: f64 = 1.0;
/// Start of μ where no pair of hubs shows it.
const MU_START: f64 = 4.0;
/// Band in which hub pairs show μ, Hz.
const MU_BAND_HZ: [f64; 2] = [0.6, 12.0];

/// What is refused before a fit starts.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum PhysicalError {
    /// The band holds too few bins.
    #[error(
        "the band {band_hz:?} Hz holds {bins} bins of the spectra, expected at least {least}: a wider band or longer segments"
    )]
    FewBins {
        /// The band.
        band_hz: [f64; 2],
        /// Bins in it.
        bins: usize,
        /// Bins needed.
        least: usize,
    },
    /// The recording is too short for its channels.
    #[error(
        "{averages:.1} independent averages for {channels} channels, expected at least twice as many: a longer recording or shorter segments"
    )]
    FewAverages {
        /// Averages.
        averages: f64,
        /// Channels.
        channels: usize,
    },
    /// A channel has no power in the band.
    #[error("channel `{channel}` has no power in the band, or more than a number can hold")]
    DeadChannel {
        /// Its name.
        channel: String,
    },
    /// One sensor cannot tell a vehicle from its road.
    #[error("one channel (`{channel}`) cannot tell the vehicle from its road: expected at least two")]
    OneChannel {
        /// Its name.
        channel: String,
    },
    /// The vehicle at its start cannot be used.
    #[error("the vehicle cannot be fitted from its start: {0}")]
    Start(String),
}

/// What a fit is told.
#[derive(Debug, Clone, PartialEq)]
pub struct PhysicalSettings {
    /// V, m/s.
    pub speed_m_s: f64,
    /// Band, Hz.
    pub band_hz: [f64; 2],
    /// What S₀ is a density of.
    pub convention: Convention,
}

/// A value and its standard deviation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Value.
    pub value: f64,
    /// Standard deviation: Fisher information, widened by the spread over blocks.
    pub sd: f64,
}

/// What a fit found. `problems` is empty for a success.
#[derive(Debug, Clone)]
pub struct PhysicalOutcome {
    /// Why the answer is no, in words; empty for a success. Each with a name to script against.
    pub problems: Vec<(&'static str, String)>,
    /// What a reader must know of a success, in words.
    pub remarks: Vec<(&'static str, String)>,
    /// Modes with the standard deviations of f (Hz) and ζ.
    pub modes: Vec<(Mode, f64, f64)>,
    /// Free parameters: name, start, estimate.
    pub parameters: Vec<(String, f64, Estimate)>,
    /// S₀ at 1 rad/m.
    pub roughness_m3: Estimate,
    /// e.
    pub exponent: Estimate,
    /// Correlation of the errors of ln S₀ and e.
    pub road_correlation: f64,
    /// μ, with more than one track.
    pub mu: Option<Estimate>,
    /// Delay of the rearmost axle, s, with more than one axle.
    pub delay_s: Option<Estimate>,
    /// White floors, two-sided unit²·s/rad.
    pub noise: Vec<Estimate>,
    /// Bins of the band, Hz.
    pub freq_hz: Vec<f64>,
    /// The model's spectra there, noise and window included, in the channels' units.
    pub fitted: Vec<CMat>,
    /// n_avg · mean |residual|² per bin.
    pub residual: Vec<f64>,
    /// Its mean.
    pub chi: f64,
    /// Whittle cost.
    pub cost: f64,
    /// Newton decrement.
    pub decrement: f64,
    /// Steps taken, evaluations made.
    pub work: [usize; 2],
    /// Factors by which the standard deviations of the vehicle's and of the road's parameters were widened.
    pub widened: [f64; 2],
}

/// Fits a vehicle and its road to measured spectra.
///
/// Minimises n_avg Σ_k (ln|S(ω_k)| + tr S⁻¹Ŝ(ω_k)) over the logarithms of the vehicle's free parameters, S₀, e, μ, the
/// delay and a noise floor a channel, where S = W * (H* S_r Hᵀ) + N is the model seen through the window's kernel.
/// `derivatives[i]` says whether channel i measures displacement (0), velocity (1) or acceleration (2) of the vehicle's
/// row i. `blocks` are spectra of equal pieces of the same recording with the same segments (at least 8): the spread of
/// the likelihood's gradient over them widens the standard deviations where the Fisher information is too sure; none
/// leaves them as they are.
///
/// The common scale of masses, stiffnesses and dampers cannot be seen in responses: hold one of them.
///
/// # Errors
/// [`PhysicalError`] for what cannot be started. A fit that did not succeed is an outcome with `problems`.
pub fn fit_physical(
    vehicle: &dyn Parametric,
    derivatives: &[usize],
    spectra: &CrossSpectra,
    blocks: &[CrossSpectra],
    settings: &PhysicalSettings,
) -> Result<PhysicalOutcome, PhysicalError> {
    if spectra.channels.len() < 2 {
        let channel = spectra.channels.first().cloned().unwrap_or_default();
        return Err(PhysicalError::OneChannel { channel });
    }
    let data = BandData::new(spectra, settings.band_hz)?;
    let values = vehicle.start();
    let base = vehicle.system(&values).map_err(PhysicalError::Start)?;
    let differs = |axis: usize| base.at_m().iter().any(|p| (p[axis] - base.at_m()[0][axis]).abs() > 1e-9);
    let layout = Layout::new(values.len(), differs(1), differs(0), spectra.channels.len());
    let model = Model {
        vehicle,
        derivatives,
        speed_m_s: settings.speed_m_s,
        convention: settings.convention,
        layout,
        data: &data,
        averages: spectra.averages,
    };
    let mut theta = vec![0.0; model.layout.len()];
    values.iter().enumerate().for_each(|(i, v)| theta[i] = v.ln());
    theta[model.layout.exponent()] = 2.0;
    if let Some(i) = model.layout.mu {
        theta[i] = starting_mu(&base, derivatives, spectra, settings).ln();
    }
    for (c, noise) in data.noise.iter().enumerate() {
        theta[model.layout.noise + c] = noise.ln();
    }
    theta[model.layout.s0()] = scoring::level(&model, &theta, &data).map_err(PhysicalError::Start)?;
    let found = scoring::search(&model, &theta).map_err(PhysicalError::Start)?;
    outcome(&model, &theta, &found, blocks).map_err(PhysicalError::Start)
}

fn outcome(
    model: &Model<'_>,
    start: &[f64],
    found: &scoring::Search,
    blocks: &[CrossSpectra],
) -> Result<PhysicalOutcome, String> {
    let (layout, data, theta) = (&model.layout, model.data, &found.theta);
    let mut covariance = uncertainty::Covariance::new(&found.score.fisher, layout);
    let evaluation = model.evaluate(theta, true)?;
    if let Some(first) = blocks.first() {
        let scaled: Vec<Vec<CMat>> = blocks.iter().map(|b| data.scaled(b)).collect();
        let gradients = whittle::block_gradients(&evaluation, layout, theta, data, &scaled)
            .ok_or("the model's spectrum is not positive definite")?;
        covariance.widen(&gradients, first.averages / model.averages);
    }
    let modes = uncertainty::modes(model, theta, &covariance)?;
    let names = vehicle_names(model);
    let residual: Vec<f64> = whittle::residuals(&evaluation, &data.measured)
        .ok_or("the model's spectrum is not positive definite")?
        .into_iter()
        .map(|r| data.averages * r)
        .collect();
    let chi = residual.iter().sum::<f64>() / residual.len() as f64;
    let log = |i: usize| Estimate { value: theta[i].exp(), sd: theta[i].exp() * covariance.sd(i) };
    let mut problems = Vec::new();
    let mut remarks = Vec::new();
    if !found.converged {
        problems.push((
            "not-converged",
            format!(
                "the search ended after {} steps with a Newton decrement of {:.3} (converged below 0.01)",
                found.steps, found.decrement
            ),
        ));
    }
    for i in &found.at_limit {
        let name = names.get(*i).cloned().unwrap_or_else(|| road_name(layout, *i).to_owned());
        problems.push(("at-limit", format!("{name} ran to the limit of its range, {:.4}", theta[*i].exp())));
    }
    if chi > CHI_LIMIT {
        problems.push((
            "misfit",
            format!("the model does not explain the spectra: residual statistic {chi:.2}, expected below {CHI_LIMIT}"),
        ));
    }
    if let Some((from, to, worst)) =
        worst_part(&residual).filter(|p| chi <= CHI_LIMIT && p.2 > PART_CHI_LIMIT)
    {
        let hz = |bin: usize| data.omega[bin] / TAU;
        problems.push((
            "misfit",
            format!(
                "the model does not explain the spectra from {:.2} to {:.2} Hz: residual statistic {worst:.2} there, expected below {PART_CHI_LIMIT}; leave that band out",
                hz(from),
                hz(to)
            ),
        ));
    }
    if let Some((eigenvalue, weights)) = covariance.null_direction() {
        let mut order: Vec<usize> = (0..weights.len()).collect();
        order.sort_by(|a, b| weights[*b].abs().total_cmp(&weights[*a].abs()));
        let most: Vec<String> = order
            .iter()
            .take(4)
            .map(|i| names.get(*i).cloned().unwrap_or_else(|| road_name(layout, *i).to_owned()))
            .collect();
        problems.push((
            "not-identifiable",
            format!(
                "a common change of {} … cannot be seen in these spectra (scaled information {eigenvalue:.1e}): hold one of them or add sensors",
                most.join(", ")
            ),
        ));
    }
    if let Some((mode, sd, _)) = modes.iter().find(|(m, sd, _)| !(*sd <= LARGEST_FREQ_SD * m.freq_hz)) {
        problems.push((
            "not-identifiable",
            format!(
                "these sensors do not determine the mode at {:.2} Hz: its standard deviation is {sd:.2} Hz",
                mode.freq_hz
            ),
        ));
    }
    let weak: Vec<String> = (0..layout.vehicle)
        .filter(|i| !(covariance.sd(*i) <= WEAK_LN_SD))
        .map(|i| names[i].clone())
        .collect();
    if !weak.is_empty() {
        remarks.push(("weak-parameters", format!("not determined by themselves: {}", weak.join(", "))));
    }
    let base = model.system(theta)?;
    let x = base.at_m().iter().map(|p| p[0]);
    let wheelbase = x.clone().fold(f64::NEG_INFINITY, f64::max) - x.fold(f64::INFINITY, f64::min);
    Ok(PhysicalOutcome {
        problems,
        remarks,
        modes,
        parameters: (0..layout.vehicle).map(|i| (names[i].clone(), start[i].exp(), log(i))).collect(),
        roughness_m3: log(layout.s0()),
        exponent: Estimate { value: theta[layout.exponent()], sd: covariance.sd(layout.exponent()) },
        road_correlation: covariance.correlation(layout.s0(), layout.exponent()),
        mu: layout.mu.map(log),
        delay_s: layout.delay.map(|i| {
            let delay = wheelbase / model.speed_m_s * theta[i].exp();
            Estimate { value: delay, sd: delay * covariance.sd(i) }
        }),
        noise: (0..layout.channels)
            .map(|c| {
                let (e, s) = (log(layout.noise + c), data.scale[c] * data.scale[c]);
                Estimate { value: (e.value - model::LEAST_NOISE).max(0.0) * s, sd: e.sd * s }
            })
            .collect(),
        freq_hz: data.omega.iter().map(|w| w / TAU).collect(),
        fitted: evaluation
            .s
            .iter()
            .map(|m| CMat::from_fn(m.nrows(), m.ncols(), |i, j| m[(i, j)] * (data.scale[i] * data.scale[j])))
            .collect(),
        residual,
        chi,
        cost: found.score.cost,
        decrement: found.decrement,
        work: [found.steps, found.evaluations],
        widened: covariance.factors,
    })
}

/// The eighth of the band with the largest mean residual: first bin, last bin, mean.
fn worst_part(residual: &[f64]) -> Option<(usize, usize, f64)> {
    let size = (residual.len() / 8).max(1);
    residual
        .chunks(size)
        .enumerate()
        .filter(|(_, part)| part.len() == size)
        .map(|(i, part)| (i * size, (i + 1) * size - 1, part.iter().sum::<f64>() / size as f64))
        .max_by(|a, b| a.2.total_cmp(&b.2))
}

fn vehicle_names(model: &Model<'_>) -> Vec<String> {
    model.vehicle.names()
}

fn road_name(layout: &Layout, i: usize) -> &'static str {
    if i == layout.s0() {
        "the road's roughness"
    } else if i == layout.exponent() {
        "the road's exponent"
    } else if Some(i) == layout.mu {
        "the coherence's mu"
    } else if Some(i) == layout.delay {
        "the delay"
    } else {
        "a noise floor"
    }
}

/// −ln Re γ = μWω/(2πV) of channel pairs at wheels side by side (their own dynamics cancel in a symmetric car); the
/// median over pairs and band, or a typical value where no pair shows it.
fn starting_mu(
    base: &crate::lti::WheeledSystem,
    derivatives: &[usize],
    spectra: &CrossSpectra,
    settings: &PhysicalSettings,
) -> f64 {
    // channels whose row looks at one unsprung mass only, and the wheel that pushes it
    let wheel_of = |channel: usize| -> Option<usize> {
        let row: Vec<usize> =
            (0..base.rows().ncols()).filter(|j| base.rows()[(channel, *j)] != 0.0).collect();
        let [dof] = row[..] else { return None };
        (0..base.at_m().len()).find(|w| base.wheel_stiffness()[(dof, *w)] != 0.0)
    };
    let at = base.at_m();
    let mut found: Vec<f64> = Vec::new();
    for i in 0..derivatives.len() {
        for j in 0..i {
            let (Some(a), Some(b)) = (wheel_of(i), wheel_of(j)) else { continue };
            let width = (at[a][1] - at[b][1]).abs();
            if at[a][0] != at[b][0] || width == 0.0 {
                continue;
            }
            for (k, f) in spectra.freq_hz.iter().enumerate() {
                if !(MU_BAND_HZ[0]..=MU_BAND_HZ[1]).contains(f) {
                    continue;
                }
                let s: &CMat = &spectra.s[k];
                let gamma: C64 = s[(i, j)] / (s[(i, i)].re * s[(j, j)].re).sqrt();
                if gamma.re > 0.05 {
                    found.push(-gamma.re.ln() * TAU * settings.speed_m_s / (width * spectra.omega_rad_s[k]));
                }
            }
        }
    }
    found.sort_by(f64::total_cmp);
    match found.get(found.len() / 2) {
        // hub pairs read 20–35 % low
        Some(mu) if found.len() > 10 => (1.25 * mu).clamp(0.3, 30.0),
        _ => MU_START,
    }
}
