//! What a reader must know of a design's robustness, in words: numbers that it hangs on, an actuator that it does not bear, modes that its
//! goal does not show, responses far above the passive ones.

use super::design_actuator::ActuatorLoop;
use super::design_outcome::DesignOutcome;
use super::design_problem::Problem;
use super::design_robustness::{Perturbed, PerturbedKind, Robustness};
use super::design_words::short;
use super::{DesignMethod, Flag, StudyError};
use crate::linalg::{C64, CMat, eigen, solve_complex};
use crate::lti::{Continuous, LtiError, StateSpace};
use crate::units::{hz, rad_per_s};

/// A goal that grows by more than this share where one number changes by 5 % is worth a warning: four times the change.
const FRAGILE: f64 = 0.2;
/// Names in a sentence, at most.
const MOST_NAMES: usize = 4;
/// A gain that is so many times the passive one at the same frequency is worth a warning (an acceleration matched to the one of a
/// tire of 20 times the damping multiplies the tire's deflection by 20 at the wheel's own frequency: (4.30)) …
const FOLD: f64 = 10.0;
/// … if it is no smaller than this share of the largest passive gain: next to a passive zero any gain is many times nothing.
const SEEN: f64 = 0.1;
/// A mode of less damping is looked for: a passive car has 20 %.
const LIGHT: f64 = 0.05;
/// A mode shows in an output whose own peak from it would be as high as the largest passive gain, and is hidden below this share of it.
const HIDDEN: f64 = 0.1;

/// Warnings and notes of what was changed.
pub(super) fn fragile(r: &Robustness, outcome: &mut DesignOutcome) {
    let flag = |name: &str, text: String| Flag { name: name.into(), text };
    let all = r.vehicle.iter().chain(&r.controller);
    let (entries, own): (Vec<&Perturbed>, Vec<&Perturbed>) =
        all.partition(|p| p.kind == PerturbedKind::Entry);
    if let Some(text) = sentence(r.share, &own) {
        outcome.warnings.push(flag("fragile", text));
    }
    if let Some(text) = sentence(r.share, &entries) {
        let text = format!(
            "as its matrices are written, {text}; another choice of states (a balanced one, or poles one by one) may not"
        );
        outcome.notes.push(flag("fragile-entries", text));
    }
    if let Some(text) = r.actuator.as_ref().and_then(actuator_words) {
        let stated = r.actuator.as_ref().is_some_and(|a| a.stated);
        let list = if stated { &mut outcome.warnings } else { &mut outcome.notes };
        list.push(flag("actuator", text));
    }
}

/// What of these numbers the loop hangs on.
fn sentence(share: f64, of: &[&Perturbed]) -> Option<String> {
    let by = |p: &Perturbed| format!("{} ({:+.0} %)", p.named(), 100.0 * p.by);
    let list = |all: Vec<String>| {
        let more = all.len().saturating_sub(MOST_NAMES);
        let text = all.into_iter().take(MOST_NAMES).collect::<Vec<_>>().join(", ");
        if more > 0 { format!("{text} and {more} more") } else { text }
    };
    let mut unstable: Vec<&&Perturbed> = of.iter().filter(|p| !p.stable).collect();
    let grows = |p: &Perturbed| p.grows_1_per_s.unwrap_or(f64::INFINITY);
    // a loop that drifts off for minutes is less of a danger than one that swings up at once
    unstable.sort_by(|a, b| grows(b).total_cmp(&grows(a)));
    let unstable: Vec<String> = unstable.into_iter().map(|p| unstable_words(p)).collect();
    let mut worse: Vec<(&&Perturbed, f64)> =
        of.iter().filter_map(|p| Some((p, p.worst()? - 1.0))).filter(|(_, more)| *more > FRAGILE).collect();
    worse.sort_by(|a, b| b.1.total_cmp(&a.1));
    let worse: Vec<String> =
        worse.into_iter().map(|(p, more)| format!("{} makes it {:+.0} %", by(p), 100.0 * more)).collect();
    let percent = 100.0 * share;
    let mut parts = Vec::new();
    if !unstable.is_empty() {
        parts.push(format!("{percent:.0} % of one number makes the loop unstable: {}", list(unstable)));
    }
    if !worse.is_empty() {
        let than = 100.0 * FRAGILE;
        parts.push(format!(
            "{percent:.0} % of one number makes the goal worse by more than {than:.0} %: {}",
            list(worse)
        ));
    }
    (!parts.is_empty()).then(|| parts.join("; "))
}

fn unstable_words(p: &Perturbed) -> String {
    let grows = p.grows_1_per_s.map_or_else(String::new, |g| format!(", grows at {} 1/s", short(g)));
    format!("{} ({:+.0} %{grows})", p.named(), 100.0 * p.by)
}

/// Of a loop that is not stable with the actuator, or not known to be.
fn actuator_words(a: &ActuatorLoop) -> Option<String> {
    let given = if a.stated { "the actuator stated" } else { "a usual actuator, were there one," };
    let (hz, ms) = (|v: f64| format!("{} Hz", short(v)), |v: f64| format!("{} ms", short(1e3 * v)));
    let of = format!("{given} of {} and {} of delay", hz(a.actuator.bandwidth_hz), ms(a.actuator.delay_s));
    let (bandwidths, delays) = (a.bandwidth_hz.words(hz), a.delay_s.words(ms));
    let which = format!(
        "bandwidths that are stable with this delay: {bandwidths}; delays that are with this bandwidth: {delays}"
    );
    match a.stable {
        Some(true) => None,
        Some(false) => Some(format!(
            "with {of} the loop is not stable; {which}. Weight the control (input_weight) or bound it (goal.max_gain)"
        )),
        None => Some(format!(
            "whether the loop is stable with {of} is not known: the delay's approximation of order {} is off by {} of the loop's gain; {which}",
            a.delay_order,
            short(a.delay_error)
        )),
    }
}

impl Perturbed {
    /// Which number, in words.
    #[must_use]
    pub fn named(&self) -> String {
        let what = &self.what;
        match self.kind {
            PerturbedKind::Vehicle | PerturbedKind::Gain => what.clone(),
            PerturbedKind::Sensor => format!("gain from {what}"),
            PerturbedKind::Actuator => format!("gain to {what}"),
            PerturbedKind::Pole => format!("controller pole {what}"),
            PerturbedKind::Residue => format!("residue of {what}"),
            PerturbedKind::Entry => format!("entry {what}"),
        }
    }

    /// The goal over its nominal value, or the largest of its norms where nothing is minimised.
    #[must_use]
    pub fn worst(&self) -> Option<f64> {
        let largest = self.norms.iter().map(|(_, v)| *v).reduce(f64::max);
        self.goal.or(largest)
    }
}

/// Warnings of gains far above the passive ones at one frequency, and of modes that hide from the goal.
///
/// # Errors
/// An iteration that does not converge.
pub(super) fn over_frequency(
    problem: &Problem,
    k: &StateSpace<Continuous>,
    outcome: &DesignOutcome,
) -> Result<Vec<Flag>, StudyError> {
    let fail =
        |e: LtiError| StudyError::Design { name: problem.spec.vehicle.clone(), source: Box::new(e.into()) };
    if !outcome.passive.stable {
        return Ok(Vec::new());
    }
    let closed = problem.plant.close(k).map_err(fail)?;
    let folded = folds(problem, &closed, outcome)?;
    // an interpolated design says itself what it hides
    let hidden = match problem.spec.method {
        DesignMethod::Interpolation => None,
        _ => hidden(problem, &closed, outcome).map_err(fail)?,
    };
    Ok(folded.into_iter().chain(hidden).collect())
}

/// Where a gain is at least [`FOLD`] times the passive one.
fn folds(
    problem: &Problem,
    closed: &StateSpace<Continuous>,
    outcome: &DesignOutcome,
) -> Result<Option<Flag>, StudyError> {
    let grid = outcome.gains.freq_hz.iter().map(|f| rad_per_s(*f));
    let ends = outcome.gains.freq_hz.first().zip(outcome.gains.freq_hz.last());
    // a light mode's peak is narrower than the grid
    let poles = outcome.verified.iter().flat_map(|v| &v.poles).map(|p| p[1]);
    let inside = |w: &f64| ends.is_some_and(|(low, high)| (*low..=*high).contains(&hz(*w)));
    let omegas: Vec<f64> = grid.chain(poles.filter(inside)).collect();
    let (before, after) =
        (problem.gains_at(&problem.plant.passive(), &omegas)?, problem.gains_at(closed, &omegas)?);
    let mut said: Vec<String> = Vec::new();
    let mut parts = Vec::new();
    for (name, members) in problem.blocks() {
        let base = problem.reported[members[0]].base.clone();
        let peak = outcome.passive.hinf.get(&name).copied().unwrap_or(0.0);
        let (Some(b), Some(a)) = (before.get(&name), after.get(&name)) else { continue };
        let ratios = b.iter().zip(a).zip(&omegas).filter(|((b, a), _)| **b > 0.0 && **a >= SEEN * peak);
        let worst = ratios.map(|((b, a), w)| (a / b, *w)).max_by(|x, y| x.0.total_cmp(&y.0));
        // a whole vector speaks for its corners
        if let Some((fold, w)) =
            worst.filter(|(fold, _)| *fold >= FOLD && peak > 0.0 && !said.contains(&base))
        {
            parts.push(format!("{name} {fold:.0} times at {:.2} Hz", hz(w)));
            said.push(base);
        }
    }
    let text = format!("gains far above the passive vehicle's at the same frequency: {}", parts.join(", "));
    Ok((!parts.is_empty()).then(|| Flag { name: "peak".into(), text }))
}

/// Lightly damped modes that a minimised or bounded output does not show, and another output does.
fn hidden(
    problem: &Problem,
    closed: &StateSpace<Continuous>,
    outcome: &DesignOutcome,
) -> Result<Option<Flag>, LtiError> {
    let n = closed.order();
    let (poles, v) = eigen(closed.a())?;
    let one = |i: usize, j: usize| C64::new(f64::from(u8::from(i == j)), 0.0);
    let Ok(w) = solve_complex(&v, &CMat::from_fn(n, n, one)) else { return Ok(None) };
    let passive = outcome.passive.poles.iter().map(|p| -p[0] / p[0].hypot(p[1]));
    let usual = passive.fold(1.0, f64::min);
    let light = (0..n).filter(|l| {
        let (p, damping) = (poles[*l], -poles[*l].re / poles[*l].norm());
        p.im > 0.0 && damping < LIGHT.min(0.5 * usual)
    });
    let goals = problem.goals.iter().chain(&problem.bounded).chain(problem.peaks.iter().map(|p| &p.block));
    let goals: Vec<&str> = goals.map(|g| g.name.as_str()).collect();
    let mut parts = Vec::new();
    for l in light {
        let excited = (0..closed.inputs())
            .map(|j| (0..n).map(|i| w[(l, i)] * closed.b()[(i, j)]).sum::<C64>().norm_sqr())
            .sum::<f64>()
            .sqrt();
        // the peak that this mode alone makes, over the largest passive gain
        let share = |(name, members): &(String, Vec<usize>)| {
            let passive = *outcome.passive.hinf.get(name).filter(|p| **p > 0.0)?;
            let seen = members
                .iter()
                .map(|i| (0..n).map(|j| v[(j, l)] * closed.c()[(*i, j)]).sum::<C64>().norm_sqr());
            Some((name.clone(), seen.sum::<f64>().sqrt() * excited / -poles[l].re / passive))
        };
        let shares: Vec<(String, f64)> = problem.blocks().iter().filter_map(share).collect();
        let from: Vec<&str> = shares
            .iter()
            .filter(|(name, s)| *s < HIDDEN && goals.contains(&name.as_str()))
            .map(|(n, _)| n.as_str())
            .collect();
        let most = shares.iter().filter(|(name, _)| !name.starts_with("actuator_force"));
        let most = most.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, s)| *s >= 1.0);
        if let Some((name, times)) = most.filter(|_| !from.is_empty()) {
            parts.push(format!(
                "one at {:.2} Hz with {:.1} % of damping does not show in {}, and makes {name} {} times its largest passive gain",
                hz(poles[l].norm()),
                -100.0 * poles[l].re / poles[l].norm(),
                from.join(", "),
                short(*times)
            ));
        }
    }
    let text = format!("the loop has a mode that the goal does not see: {}", parts.join("; "));
    Ok((!parts.is_empty()).then(|| Flag { name: "hidden-mode".into(), text }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::design_problem::Norm;
    use crate::study::{DesignSpec, Goal, InterpolationSection, Named, design};

    /// At its peak a lightly damped mode is all but alone.
    const OTHERS: f64 = 0.05;

    fn named(pairs: &[(&str, f64)]) -> Named<f64> {
        pairs.iter().map(|(n, v)| ((*n).to_owned(), *v)).collect()
    }

    #[test]
    fn the_mode_that_a_matched_acceleration_hides_is_seen() {
        // thesis, (4.53): matched to a tire of 20 times the damping, the wheel swings on at √(k_t/m_u)
        let spec = DesignSpec {
            vehicle: "case:turkay-quarter-car".into(),
            road: "case:turkay-white-velocity".into(),
            speed_m_s: 20.0,
            measurements: vec!["suspension_travel".into()],
            method: DesignMethod::Interpolation,
            r#override: named(&[("tire_damping_n_s_per_m", 98.0)]),
            interpolation: Some(InterpolationSection {
                fictitious_tire_damping_n_s_per_m: 1960.0,
                band_rad_s: 100.0,
                tolerance: 0.05,
                psi: Some([500.0, 10.0]),
            }),
            ..DesignSpec::default()
        };
        let outcome = design(&spec).unwrap().0;
        let k = outcome.controller.as_ref().unwrap().state_space().unwrap();
        let of = |goal: &str| {
            let goal = Goal { minimize: named(&[(goal, 1.0)]), ..Goal::default() };
            let only = DesignSpec { method: DesignMethod::Lqg, interpolation: None, goal, ..spec.clone() };
            let problem = Problem::new(&only, Norm::H2).unwrap();
            let closed = problem.plant.close(&k).unwrap();
            hidden(&problem, &closed, &outcome).unwrap()
        };
        let text = of("sprung_acceleration").unwrap().text;
        assert!(
            text.contains("one at 10.61 Hz with 2.0 % of damping does not show in sprung_acceleration"),
            "{text}"
        );
        let words: Vec<&str> = text.split_once("makes ").unwrap().1.split(' ').collect();
        let peak = |of: &Named<f64>| *of.get(words[0]).unwrap();
        let ratio = peak(&outcome.verified.as_ref().unwrap().hinf) / peak(&outcome.passive.hinf);
        let said: f64 = words[1].parse().unwrap();
        assert!(ratio > 5.0 && (said / ratio - 1.0).abs() < OTHERS, "{text}: {ratio}");
        // a goal that shows it hides nothing
        assert!(of("tire_deflection").is_none());
        let warned = &outcome.warnings.iter().find(|w| w.name == "peak").unwrap().text;
        let gain = |of: &Named<Vec<f64>>| of.get("suspension_travel").unwrap()[0];
        let fold = gain(&outcome.gains.closed) / gain(&outcome.gains.passive);
        assert!(warned.contains(&format!("suspension_travel {fold:.0} times at 0.05 Hz")), "{warned}");
    }
}
