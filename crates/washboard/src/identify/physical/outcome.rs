//! What a physical fit found: estimates with their standard deviations, and everything that speaks against them.

use super::joint::{Joint, Search};
use super::layout::Kind;
use super::{Model, PhysicalDrive, Reason, uncertainty};
use crate::identify::likelihood::{
    Covariance, Estimate, Group, LEAST_NOISE, Spectra, Whitening, mean, misfit, speed_off,
};
use crate::linalg::CMat;
use crate::lti::Mode;
use crate::signal::CrossSpectra;
use crate::units::hz;

/// A mode whose frequency is not known to this share of itself is not identified.
const LARGEST_FREQ_SD: f64 = 0.1;
/// A parameter whose logarithm is not known to this is not identified by itself.
const WEAK_LN_SD: f64 = 1.0;
/// What remains between reported and actual standard deviations of the vehicle's and of the roads' parameters: the floor
/// that is added to spectra counts as noise and scatters less. Measured over 64 simulated drives of 20 minutes and 32 of 5
/// (`examples/study_cars.rs`): with 1 and 1.3 errors over standard deviations were .66 to .75 for modes and .29 to .61 for
/// roads, and 95 % intervals covered 99.4 and 99.8 %.
const EMPIRICAL: [f64; 2] = [0.85, 0.85];

/// What a fit found. `problems` is empty for a success.
#[derive(Debug, Clone)]
pub struct PhysicalOutcome {
    /// Why the answer is no, in words; empty for a success. Each with a name to script against.
    pub problems: Vec<Reason>,
    /// What a reader must know of a success, in words.
    pub remarks: Vec<Reason>,
    /// Modes with the standard deviations of f (Hz) and ζ.
    pub modes: Vec<(Mode, f64, f64)>,
    /// Free parameters: name, start, estimate.
    pub parameters: Vec<(String, f64, Estimate)>,
    /// What belongs to each recording.
    pub drives: Vec<DriveOutcome>,
    /// n_avg · mean |residual|² over all recordings' bins.
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

/// What a fit found of one recording.
#[derive(Debug, Clone)]
pub struct DriveOutcome {
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
    /// Clocks that are off against the median channel's.
    pub clocks: Vec<ClockEstimate>,
    /// Bins of the band, Hz.
    pub freq_hz: Vec<f64>,
    /// The model's spectra there, noise and window included, in the channels' units.
    pub fitted: Vec<CMat>,
    /// n_avg · mean |residual|² per bin.
    pub residual: Vec<f64>,
    /// Its mean.
    pub chi: f64,
}

/// How much later than the median channel's samples a channel's are stamped.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClockEstimate {
    /// The channel.
    pub channel: usize,
    /// s.
    pub offset_s: Estimate,
}

pub(super) fn outcome(
    joint: &Joint<'_>,
    start: &[f64],
    found: &Search,
    drives: &[PhysicalDrive<'_>],
    rough: bool,
) -> Result<PhysicalOutcome, String> {
    const INDEFINITE: &str = "the model's spectrum is not positive definite";
    let theta = &found.theta;
    let groups = (0..joint.len())
        .map(|i| match joint.kind(i).1 {
            Kind::Vehicle => Group::Vehicle,
            Kind::Roughness | Kind::Exponent | Kind::Mu => Group::Road,
            // the phase that shows the delay has nothing to do with the road's level
            Kind::Delay | Kind::Noise(_) => Group::Sure,
            Kind::Clock(0) => Group::Fixed,
            Kind::Clock(_) => Group::Sure,
        })
        .collect();
    let mut covariance = Covariance::new(&found.score.fisher, groups, EMPIRICAL);
    let mut sets = Vec::new();
    let mut fits = Vec::new();
    for (r, (model, drive)) in joint.models.iter().zip(drives).enumerate() {
        let local = joint.local(theta, r);
        let evaluation = model.evaluate(&local)?;
        let whitening = Whitening::new(&evaluation.s).ok_or(INDEFINITE)?;
        // a search that ended early is compared by its cost: nobody reads its intervals
        if let (Some(first), false) = (drive.blocks.first(), rough) {
            let slopes = model.slopes(&local)?;
            let gradient = |block: &CrossSpectra| -> Vec<f64> {
                let pulls = whitening.metric_pull(&model.data.scaled(block), -model.data.averages);
                model.pull(&evaluation, &slopes, &local, &pulls)
            };
            let gradients: Vec<Vec<f64>> = drive.blocks.iter().map(gradient).collect();
            let placed = |g: Vec<f64>| {
                let mut all = vec![0.0; joint.len()];
                g.into_iter().enumerate().for_each(|(i, v)| all[joint.place(r, i)] = v);
                all
            };
            sets.push((gradients.into_iter().map(placed).collect(), first.averages / model.averages));
        }
        let residual = whitening.residuals(&model.data.measured, model.data.averages);
        fits.push((evaluation.s, residual));
    }
    if sets.len() == drives.len() {
        covariance.widen(&sets);
    }
    let first = &joint.models[0];
    let modes = uncertainty::modes(first, &joint.local(theta, 0), &covariance)?;
    let names = first.vehicle.names();
    let log = |i: usize| Estimate { value: theta[i].exp(), sd: theta[i].exp() * covariance.sd(i) };
    let mut drive_outcomes = Vec::new();
    for (r, (s, residual)) in fits.into_iter().enumerate() {
        drive_outcomes.push(drive_outcome(joint, r, theta, &covariance, &s, residual)?);
    }
    let all: Vec<f64> = drive_outcomes.iter().flat_map(|d| d.residual.iter().copied()).collect();
    let (problems, remarks) = speak(joint, found, &covariance, &modes, &names, &drive_outcomes);
    Ok(PhysicalOutcome {
        problems,
        remarks,
        modes,
        parameters: (0..joint.vehicle).map(|i| (names[i].clone(), start[i].exp(), log(i))).collect(),
        chi: mean(&all),
        drives: drive_outcomes,
        cost: found.score.cost,
        decrement: found.decrement,
        work: [found.steps, found.evaluations],
        widened: covariance.factors,
    })
}

fn drive_outcome(
    joint: &Joint<'_>,
    r: usize,
    theta: &[f64],
    covariance: &Covariance,
    fitted: &Spectra,
    residual: Vec<f64>,
) -> Result<DriveOutcome, String> {
    let model: &Model<'_> = &joint.models[r];
    let (layout, data) = (&model.layout, &model.data);
    let at = |i: usize| joint.place(r, i);
    let log = |i: usize| {
        let value = theta[at(i)].exp();
        Estimate { value, sd: value * covariance.sd(at(i)) }
    };
    let base = model.system(&joint.local(theta, r))?;
    let x = base.at_m().iter().map(|p| p[0]);
    let wheelbase = x.clone().fold(f64::NEG_INFINITY, f64::max) - x.fold(f64::INFINITY, f64::min);
    let offset = |c: usize| layout.clocks.map_or(0.0, |first| theta[at(first + c)]);
    let mut sorted: Vec<f64> = (0..layout.channels).map(offset).collect();
    sorted.sort_by(f64::total_cmp);
    let median = sorted[sorted.len() / 2];
    let clocks = layout.clocks.map_or_else(Vec::new, |first| {
        (0..layout.channels)
            .map(|channel| ClockEstimate {
                channel,
                offset_s: Estimate {
                    value: offset(channel) - median,
                    sd: covariance.sd(at(first + channel)),
                },
            })
            .filter(|c| c.offset_s.value.abs() > 4.0 * c.offset_s.sd.max(1e-4))
            .collect()
    });
    Ok(DriveOutcome {
        roughness_m3: log(layout.s0()),
        exponent: Estimate { value: theta[at(layout.exponent())], sd: covariance.sd(at(layout.exponent())) },
        road_correlation: covariance.correlation(at(layout.s0()), at(layout.exponent())),
        mu: layout.mu.map(log),
        delay_s: layout.delay.map(|i| {
            let delay = wheelbase / model.drive.speed_m_s * theta[at(i)].exp();
            Estimate { value: delay, sd: delay * covariance.sd(at(i)) }
        }),
        noise: (0..layout.channels)
            .map(|c| {
                let (e, s) = (log(layout.noise + c), data.scale[c] * data.scale[c]);
                Estimate { value: (e.value - LEAST_NOISE).max(0.0) * s, sd: e.sd * s }
            })
            .collect(),
        clocks,
        freq_hz: data.omega.iter().map(|w| hz(*w)).collect(),
        fitted: fitted.matrices(&data.scale),
        chi: mean(&residual),
        residual,
    })
}

/// Everything that speaks against the result, and what a reader must know of a success.
fn speak(
    joint: &Joint<'_>,
    found: &Search,
    covariance: &Covariance,
    modes: &[(Mode, f64, f64)],
    names: &[String],
    drives: &[DriveOutcome],
) -> (Vec<Reason>, Vec<Reason>) {
    let theta = &found.theta;
    let words = |i: usize| names.get(i).cloned().unwrap_or_else(|| joint.kind(i).1.words().to_owned());
    let (mut problems, mut remarks) = (Vec::new(), Vec::new());
    if !found.converged {
        let text = format!(
            "the search ended after {} steps with a Newton decrement of {:.3} (converged below 0.05)",
            found.steps, found.decrement
        );
        problems.push(("not-converged", text));
    }
    let (may_vanish, limits) = (joint.models[0].vehicle.may_vanish(), joint.models[0].vehicle.limits());
    let (mut absent, mut pressed) = (Vec::new(), Vec::new());
    for i in &found.at_limit {
        let low = limits.get(*i).is_some_and(|l| theta[*i] <= l[0].ln());
        let gone = low && may_vanish.get(*i).copied().unwrap_or(false);
        if gone { absent.push(words(*i)) } else { pressed.push(*i) }
    }
    if !absent.is_empty() {
        remarks.push(("absent-parts", format!("as good as absent: {}", absent.join(", "))));
    }
    for i in pressed {
        let value = if joint.kind(i).1 == Kind::Exponent { theta[i] } else { theta[i].exp() };
        problems.push(("at-limit", format!("{} ran to the limit of its range, {value:.4}", words(i))));
    }
    for (r, drive) in drives.iter().enumerate() {
        let of = if drives.len() > 1 { format!("recording {}: ", r + 1) } else { String::new() };
        if let Some((name, text)) = misfit(&drive.residual, &joint.models[r].data.omega) {
            problems.push((name, of.clone() + &text));
        }
        let ln_delay = joint.models[r].layout.delay.map_or(0.0, |i| theta[joint.place(r, i)]);
        if let Some((name, text)) = speed_off(drive.delay_s, ln_delay) {
            problems.push((name, of.clone() + &text));
        }
        for clock in &drive.clocks {
            let text = format!(
                "the clock of `{}` is off: its samples are stamped {:.2} ± {:.2} ms late against the other channels; the fit allows for it",
                joint.models[r].channels[clock.channel],
                1e3 * clock.offset_s.value,
                1e3 * clock.offset_s.sd
            );
            remarks.push(("clock-off", text));
        }
    }
    if let Some((eigenvalue, weights)) = covariance.null_direction() {
        let mut order: Vec<usize> = (0..weights.len()).collect();
        order.sort_by(|a, b| weights[*b].abs().total_cmp(&weights[*a].abs()));
        let most: Vec<String> = order.iter().take(4).map(|i| words(*i)).collect();
        let text = format!(
            "a common change of {} … cannot be seen in these spectra (scaled information {eigenvalue:.1e}): hold one of them or add sensors",
            most.join(", ")
        );
        problems.push(("not-identifiable", text));
    }
    if let Some((mode, sd, _)) = modes.iter().find(|(m, sd, _)| !(*sd <= LARGEST_FREQ_SD * m.freq_hz)) {
        let text = format!(
            "these sensors do not determine the mode at {:.2} Hz: its standard deviation is {sd:.2} Hz",
            mode.freq_hz
        );
        problems.push(("not-identifiable", text));
    }
    let weak: Vec<String> =
        (0..joint.vehicle).filter(|i| !(covariance.sd(*i) <= WEAK_LN_SD)).map(words).collect();
    if !weak.is_empty() {
        remarks.push(("weak-parameters", format!("not determined by themselves: {}", weak.join(", "))));
    }
    (problems, remarks)
}
