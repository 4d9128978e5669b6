//! A controller that its loop confirms and that keeps to `goal.max_pole_rad_s` and `goal.max_gain`: as asked, else farther inside.

use super::design_advice::{infeasible, stalled, unconfirmed};
use super::design_gains::{fast_controller, lighter};
use super::design_outcome::{DesignOutcome, DesignStatus};
use super::design_problem::Problem;
use super::design_search::{Around, Attempt, Ended, Failure, How, Kept, Search, Try, Work, slowest};
use super::design_words::short;
use super::{Flag, design_advice};
use crate::synthesis::{PoleRegion, SynthesisError};
use std::cell::Cell;

/// Shares of the objective that are given up, one after another.
const BACK_OFFS: [f64; 4] = [1e-2, 5e-2, 0.2, 0.5];

impl<T> Kept<T> {
    /// Its numbers among the claims.
    pub fn claim(&self, outcome: &mut DesignOutcome) {
        let [pole, gain] = self.how.found;
        if self.controller.order() > 0 {
            outcome.claimed.insert("fastest_controller_pole", pole);
        }
        outcome.claimed.insert("controller_gain", gain);
        let also = [
            ("back_off", Some(self.how.back_off).filter(|b| *b > 0.0)),
            ("pole_margin", self.how.around.margin),
            ("added_input_weight", self.added_weight()),
        ];
        for (name, value) in also {
            if let Some(value) = value {
                outcome.claimed.insert(name, value);
            }
        }
    }

    fn added_weight(&self) -> Option<f64> {
        Some(self.how.added_weight).filter(|w| *w > 0.0)
    }
}

/// The first controller that keeps to the limits: as asked; with the loop's poles kept as slow as the controller's are to be;
/// where rounding leaves a pole on the axis, or a loop that contradicts its promise, with poles left of a margin; with more of
/// the objective given up; for a gain that is too large with the controls weighted. Without one `outcome` says why.
pub(super) fn within<T>(
    problem: &Problem,
    asked: f64,
    region: PoleRegion,
    outcome: &mut DesignOutcome,
    solve: impl Fn(Try) -> Result<Attempt<T>, SynthesisError>,
) -> Result<Option<Kept<T>>, SynthesisError> {
    let goal = &problem.spec.goal;
    let mut arounds = vec![Around { region, bounded: false, margin: None }];
    if let Some(most) = goal.max_pole_rad_s {
        let within = region.within.map_or(most, |w| w.min(most));
        let region = PoleRegion { within: Some(within), ..region };
        arounds.push(Around { region, bounded: true, margin: None });
    }
    let margins: Vec<Around> = arounds.iter().filter_map(|a| a.with_margin(outcome)).collect();
    let mut search = Search {
        problem,
        solve,
        slowest: slowest(outcome).unwrap_or(f64::INFINITY),
        nearest: None,
        failed: None,
        resting: None,
        work: Cell::new(Work::of(problem)),
    };
    let kept = tried(&mut search, asked, arounds, &margins, outcome)?;
    if search.is_spent() {
        let text = format!(
            "The search ended after {} tries, as many as a plant of {} states gets: fewer norms at once, lyapunov_scale = \"fixed\" or a \
             smaller delay_order make each cheaper",
            search.work.get().tries,
            problem.plant.order()
        );
        let coarse = if outcome.feasible_bound.is_empty() { "" } else { "; smaller bounds may be possible" };
        match &mut outcome.why {
            Some(why) if kept.is_none() => *why += &format!(". {text}{coarse}"),
            _ => outcome.notes.push(Flag { name: "tries".into(), text }),
        }
    }
    Ok(kept)
}

/// One try after another.
fn tried<T, S: Fn(Try) -> Result<Attempt<T>, SynthesisError>>(
    search: &mut Search<'_, T, S>,
    asked: f64,
    mut arounds: Vec<Around>,
    margins: &[Around],
    outcome: &mut DesignOutcome,
) -> Result<Option<Kept<T>>, SynthesisError> {
    let problem = search.problem;
    for back_off in std::iter::once(asked).chain(BACK_OFFS.iter().copied().filter(|b| *b > asked)) {
        // nearer to the middle equations are better conditioned; a solver that stalls does so there too
        let better = matches!(search.failed, Some(Failure::Error(_) | Failure::AtRest(_)));
        if back_off > asked && !search.is_limited() && !better {
            break;
        }
        let mut k = 0;
        while let Some(around) = arounds.get(k).copied() {
            let first = k == 0 && search.nearest.is_none() && search.failed.is_none();
            k += 1;
            match search.one(around, back_off, 0.0)? {
                Ended::Kept(kept) => return Ok(Some(said(problem, asked, *kept, outcome))),
                // what is added may be too much; what is asked may not
                Ended::Infeasible(times) if first => {
                    // what is possible may need a margin too
                    arounds.extend(margins);
                    let least = search.smallest(times, &arounds, asked);
                    infeasible(problem, least, true, outcome);
                    return Ok(None);
                }
                _ => {}
            }
            if search.failed.is_some() && arounds.iter().all(|a| a.margin.is_none()) {
                arounds.extend(margins);
            }
        }
    }
    if search.nearest.is_some() {
        if let Some(kept) = search.weighted(&arounds, asked, &lighter(problem, &outcome.passive))? {
            return Ok(Some(said(problem, asked, kept, outcome)));
        }
        outcome.status = DesignStatus::Refused;
        outcome.why = search.nearest.map(|n| refusal(problem, n));
        return Ok(None);
    }
    let measurable = |k: &Kept<T>| problem.measure(Some(&k.controller)).is_ok_and(|m| m.stable);
    if let Some(kept) = search.resting.take().filter(measurable) {
        return Ok(Some(said(problem, asked, kept, outcome)));
    }
    if problem.has_bounds() {
        let least = search.smallest(None, &arounds, asked);
        if least.is_some() {
            infeasible(problem, least, false, outcome);
            return Ok(None);
        }
    }
    match search.failed.take() {
        Some(Failure::Error(e)) => return Err(e),
        Some(Failure::AtRest(pole)) => unconfirmed(problem, pole, outcome),
        Some(Failure::Stalled(measures)) => stalled(problem, &measures, outcome),
        None => {}
    }
    Ok(None)
}

/// Notes of what the limits cost, a warning of what was added to what is asked, or of what is absurd.
fn said<T>(problem: &Problem, asked: f64, kept: Kept<T>, outcome: &mut DesignOutcome) -> Kept<T> {
    let How { around, back_off, added_weight, found } = kept.how;
    let flag = |name: &str, text: String| Flag { name: name.into(), text };
    if back_off > asked || around.bounded {
        let given = format!(
            "{} % of the least value are given up instead of {} %",
            short(100.0 * back_off),
            short(100.0 * asked)
        );
        let slow = "the loop's poles are kept as slow as the controller's are to be".to_owned();
        let what: Vec<String> =
            (back_off > asked).then_some(given).into_iter().chain(around.bounded.then_some(slow)).collect();
        let goal = &problem.spec.goal;
        let why = if goal.max_pole_rad_s.is_none() && goal.max_gain.is_none() {
            "nearer to the least value rounding makes the loop contradict its promise"
        } else {
            "for a controller that is slow and gentle enough"
        };
        outcome.notes.push(flag("backed-off", format!("{why}: {}", what.join(", and "))));
    }
    if let Some(margin) = around.margin {
        let text = format!(
            "as asked, rounding leaves the loop a pole at 0 or contradicts its promise; this controller is made with the loop's poles left \
             of −{} 1/s, which is not asked: state poles = {{ max_real_rad_s = … }} for another margin",
            short(margin)
        );
        outcome.warnings.push(flag("pole-margin", text));
    }
    if added_weight > 0.0 {
        let text = format!(
            "goal.max_gain is kept by a weight of the control that is not asked: it is made for input_weight = {} (1/N²), and the claims hold \
             this part of the cost too",
            short(problem.spec.input_weight + added_weight)
        );
        outcome.warnings.push(flag("added-weight", text));
    }
    outcome.warnings.extend(fast_controller(problem, &outcome.passive, found));
    kept
}

fn refusal(problem: &Problem, found: [f64; 2]) -> String {
    let goal = &problem.spec.goal;
    let part = |field: &str, what: &str, unit: &str, limit: Option<f64>, found: f64| {
        let limit = limit?;
        (found > limit)
            .then(|| format!("{field} is {} {unit}, and {what} {} {unit}", short(limit), short(found)))
    };
    let parts: Vec<String> = [
        part(
            "goal.max_pole_rad_s",
            "the controller's fastest pole is",
            "rad/s",
            goal.max_pole_rad_s,
            found[0],
        ),
        part("goal.max_gain", "the controller's largest gain is", "N per unit", goal.max_gain, found[1]),
    ]
    .into_iter()
    .flatten()
    .collect();
    let most = 100.0 * BACK_OFFS[BACK_OFFS.len() - 1];
    let weights = if goal.max_gain.is_some() { " and with the control weighted" } else { "" };
    let method = design_advice::remedy(problem);
    format!(
        "{}: that is the nearest of all that were tried, up to {most:.0} % above the least objective{weights}. Allow more, {method}",
        parts.join("; ")
    )
}
