//! What a fit of free modes found: estimates with their standard deviations, and everything that speaks against them.

use super::model::FreeModel;
use super::modes;
use super::order::Chosen;
use super::score::{self, PLANE_SD};
use super::search::{Found, Stage, in_seconds};
use super::{FreeDrive, SAME_COST};
use crate::identify::likelihood::{
    Covariance, Estimate, Group, LEAST_NOISE, Reason, Whitening, mean, misfit, speed_off,
};
use crate::linalg::CMat;
use crate::lti::{FirstOrder, Mode, ModeKind};
use crate::units::hz;

/// Sensors whose static gains scatter more do not follow one road.
const STATIC_SPREAD: f64 = 0.005;
/// What remains between reported and actual standard deviations of the modes and of the road.
const EMPIRICAL: [f64; 2] = [1.0, 1.0];

/// One start and where it led.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeTrial {
    /// What it was made from.
    pub name: String,
    /// Whittle cost at its end.
    pub cost: f64,
    /// Residual statistic at its end.
    pub chi: f64,
    /// Whether the search converged.
    pub converged: bool,
    /// Steps taken.
    pub steps: usize,
    /// Evaluations of the model.
    pub evaluations: usize,
}

/// One number of modes, and how well it explains the data.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeOrder {
    /// Pairs of states.
    pub modes: usize,
    /// Free parameters.
    pub parameters: usize,
    /// Whittle cost.
    pub cost: f64,
    /// 2 cost + parameters · ln(independent numbers).
    pub bic: f64,
    /// Residual statistic.
    pub chi: f64,
    /// Whether the search converged.
    pub converged: bool,
    /// Whether it is the one reported.
    pub chosen: bool,
}

/// What a fit found. `problems` is empty for a success.
#[derive(Debug, Clone)]
pub struct FreeOutcome {
    /// Why the answer is no, in words; empty for a success. Each with a name to script against.
    pub problems: Vec<Reason>,
    /// What a reader must know of a success, in words.
    pub remarks: Vec<Reason>,
    /// Modes with the standard deviations of f (Hz) and ζ; shapes are displacements at the sensors.
    pub modes: Vec<(Mode, f64, f64)>,
    /// The response: displacements of the sensors per road height.
    pub system: FirstOrder,
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
    /// Cost at the end.
    pub cost: f64,
    /// Newton decrement at the end.
    pub decrement: f64,
    /// Steps taken, evaluations made, from the start that led to the answer.
    pub work: [usize; 2],
    /// The starts, best first.
    pub trials: Vec<FreeTrial>,
    /// The numbers of modes tried, fewest first.
    pub orders: Vec<FreeOrder>,
    /// Factors by which the standard deviations of the modes and of the road were widened.
    pub widened: [f64; 2],
    /// Standard deviation over the sensors of the static gain H(0)·1.
    pub static_spread: f64,
}

pub(super) fn outcome(
    model: &FreeModel,
    drive: &FreeDrive<'_>,
    chosen: &Chosen,
    trials: Vec<FreeTrial>,
) -> Result<FreeOutcome, String> {
    const INDEFINITE: &str = "the model's spectrum is not positive definite";
    let Chosen { found, orders, .. } = chosen;
    let (free, n) = (found.frame.basis.ncols(), drive.derivatives.len());
    let covariance = covariance(model, drive, found);
    let modes = modes::modes(&found.at.system, &found.frame.basis, &covariance).map_err(|e| e.to_string())?;
    let s = &found.frame.evaluation.s;
    let residual = Whitening::new(s).ok_or(INDEFINITE)?.residuals(&model.data.measured, model.data.averages);
    let static_spread = static_spread(model, found).ok_or("the response has a pole at zero")?;
    let (mut problems, remarks) = speak(model, chosen, &modes, &residual, static_spread, &trials);
    let log = |i: usize, v: f64| Estimate { value: v, sd: v * covariance.sd(free + i) };
    let (road, scale) = (found.at.road, &model.data.scale);
    let delay_s = differs(drive, 0).then(|| {
        let x = drive.at_m.iter().map(|p| p[0]);
        let wheelbase = x.clone().fold(f64::NEG_INFINITY, f64::max) - x.fold(f64::INFINITY, f64::min);
        log(3, wheelbase / drive.speed_m_s * road.ln_delay.exp())
    });
    problems.extend(speed_off(delay_s, road.ln_delay));
    Ok(FreeOutcome {
        problems,
        remarks,
        modes,
        system: in_seconds(&found.at.system),
        roughness_m3: log(0, road.ln_s0.exp()),
        exponent: Estimate { value: road.exponent, sd: covariance.sd(free + 1) },
        road_correlation: covariance.correlation(free, free + 1),
        mu: differs(drive, 1).then(|| log(2, road.mu)),
        delay_s,
        noise: (0..n)
            .map(|c| {
                let (e, unit) = (log(4 + c, found.at.ln_noise[c].exp()), scale[c] * scale[c]);
                Estimate { value: (e.value - LEAST_NOISE).max(0.0) * unit, sd: e.sd * unit }
            })
            .collect(),
        freq_hz: model.data.omega.iter().map(|w| hz(*w)).collect(),
        fitted: s.matrices(scale),
        chi: mean(&residual),
        residual,
        cost: found.score.cost,
        decrement: found.decrement,
        work: [found.steps, found.evaluations],
        trials,
        orders: orders.clone(),
        widened: covariance.factors,
        static_spread,
    })
}

fn differs(drive: &FreeDrive<'_>, axis: usize) -> bool {
    drive.at_m.iter().any(|p| (p[axis] - drive.at_m[0][axis]).abs() > 1e-9)
}

fn covariance(model: &FreeModel, drive: &FreeDrive<'_>, found: &Found) -> Covariance {
    let (free, n) = (found.frame.basis.ncols(), drive.derivatives.len());
    let groups = (0..free + 4 + n)
        .map(|i| match i {
            i if i < free => Group::Vehicle,
            i if i == free + 2 && !differs(drive, 1) => Group::Fixed,
            i if i == free + 3 && !differs(drive, 0) => Group::Fixed,
            i if i < free + 3 => Group::Road,
            _ => Group::Sure,
        })
        .collect();
    let mut covariance = Covariance::new(&found.score.fisher, groups, EMPIRICAL);
    let evaluation = &found.frame.evaluation;
    if let (Some(first), Some(whitening)) = (drive.blocks.first(), Whitening::new(&evaluation.s)) {
        let gradient = |block| {
            let pulls = whitening.metric_pull(&model.data.scaled(block), -model.data.averages);
            Stage::project(&found.frame, &model.pull(evaluation, &found.at, &pulls))
        };
        let gradients = drive.blocks.iter().map(gradient).collect();
        covariance.widen(&[(gradients, first.averages / drive.spectra.averages)]);
    }
    covariance
}

/// Standard deviation over vertical sensors of H(0)·1.
fn static_spread(model: &FreeModel, found: &Found) -> Option<f64> {
    let (misfit, _) = score::plane(model, &found.at)?;
    let gains: Vec<f64> = misfit
        .iter()
        .zip(&model.planes)
        .filter(|(_, plane)| plane[0] != 0.0)
        .map(|(m, _)| PLANE_SD * m)
        .collect();
    let middle = mean(&gains);
    Some((gains.iter().map(|g| (g - middle) * (g - middle)).sum::<f64>() / gains.len() as f64).sqrt())
}

/// Everything that speaks against the result, and what a reader must know of a success.
fn speak(
    model: &FreeModel,
    chosen: &Chosen,
    modes: &[(Mode, f64, f64)],
    residual: &[f64],
    static_spread: f64,
    trials: &[FreeTrial],
) -> (Vec<Reason>, Vec<Reason>) {
    let Chosen { found, orders, confirmed } = chosen;
    let (mut problems, mut remarks) = (Vec::new(), Vec::new());
    if !found.converged {
        let text = format!(
            "the search ended after {} steps with a Newton decrement of {:.3} (converged below 0.05)",
            found.steps, found.decrement
        );
        problems.push(("not-converged", text));
    }
    problems.extend(misfit(residual, &model.data.omega));
    if *confirmed == Some(false) {
        let text =
            "only one of the searches with a mode more ended at this answer: no other start confirms it";
        problems.push(("starts-disagree", text.to_owned()));
    }
    if let (None, Some((best, rest))) = (confirmed, trials.split_first()) {
        let others: Vec<&FreeTrial> = rest.iter().filter(|t| t.converged).collect();
        let agree = others.iter().any(|t| t.cost - best.cost <= SAME_COST);
        if let (Some(other), false) = (others.first(), agree) {
            let text = format!(
                "two starts ({}, {}) converged to different answers: their costs differ by {:.1}, and no other start confirms the better one",
                best.name,
                other.name,
                other.cost - best.cost
            );
            problems.push(("starts-disagree", text));
        }
    }
    if static_spread > STATIC_SPREAD {
        let text = format!(
            "the sensors do not follow one road: their static gains scatter by {:.2} %, expected below {:.1} %; is a sensor's scale or place wrong?",
            100.0 * static_spread,
            100.0 * STATIC_SPREAD
        );
        problems.push(("static-gain", text));
    }
    let (count, real) = (
        modes.iter().filter(|m| m.0.kind == ModeKind::Oscillatory).count(),
        modes.iter().filter(|m| m.0.kind != ModeKind::Oscillatory).count(),
    );
    if real > 0 {
        let text = format!(
            "{real} of the poles are real: {count} modes oscillate where the model has room for {}",
            found.at.system.order() / 2
        );
        problems.push(("real-poles", text));
    }
    if let (Some(first), Some(chosen)) = (orders.first(), orders.iter().find(|o| o.chosen))
        && chosen.modes > first.modes
    {
        let text = format!(
            "{} modes do not suffice (residual statistic {:.1}): {} explain the data as {:.2}",
            first.modes, first.chi, chosen.modes, chosen.chi
        );
        remarks.push(("more-modes", text));
    }
    (problems, remarks)
}
