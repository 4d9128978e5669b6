//! Why the methods by inequalities gave no controller, and what to state instead, with magnitudes.

use super::design_outcome::{DesignOutcome, DesignStatus, Measured};
use super::design_problem::Problem;
use super::design_words::{short, short_numbers, usual_weight};
use super::{DesignMethod, Named};
use crate::linalg::C64;
use crate::lti::LtiError;
use crate::optimize::Measures;
use crate::synthesis::SynthesisError;

/// Of the usual weight of the control: enough that no direction is free, too little to change a goal by much.
const LIGHT: f64 = 1e-2;
/// Sensors' noise beside a disturbance of intensity 1, and the share given up, with which a full car from few measurements is
/// solved.
const NOISE: f64 = 1e-6;
const BACK_OFF: f64 = 0.05;
/// Poles' limits, of the vehicle's slowest and fastest.
const PACES: [f64; 2] = [0.1, 20.0];

impl Problem {
    /// Bounds, by name: multiples of the passive norms.
    pub fn bounds(&self) -> impl Iterator<Item = (&str, f64)> {
        let peaks = self.peaks.iter().filter_map(|p| Some((p.block.name.as_str(), p.bound?)));
        peaks.chain(self.bounded.iter().map(|b| (b.name.as_str(), b.weight)))
    }

    pub fn has_bounds(&self) -> bool {
        self.bounds().next().is_some()
    }
}

/// What is said where no controller meets the bounds: the smallest factor on all of them that was met. `proved`: the solver
/// says that there is none; else its controllers are spoiled by rounding.
pub(super) fn infeasible(problem: &Problem, times: Option<f64>, proved: bool, outcome: &mut DesignOutcome) {
    outcome.status = if proved { DesignStatus::Infeasible } else { DesignStatus::Stalled };
    let poles = if problem.spec.poles.is_some() { " with poles in the region asked for" } else { "" };
    let list = |k: f64| {
        problem.bounds().map(|(n, b)| format!("{n} = {}", short(k * b))).collect::<Vec<_>>().join(", ")
    };
    let why = match times {
        _ if !problem.has_bounds() => {
            "no controller has its loop's poles in the region asked for (poles)".to_owned()
        }
        Some(times) => {
            for (name, bound) in problem.bounds() {
                // an output may have a bound in either norm: the H2 one has the longer name
                let again = outcome.feasible_bound.get(name).is_some();
                let name = if again { format!("{name} (H2)") } else { name.to_owned() };
                outcome.feasible_bound.insert(name, times * bound);
            }
            let together = if problem.bounds().count() > 1 { ", all raised by one factor" } else { "" };
            let none =
                if proved { "no controller" } else { "no controller that rounding leaves as it is promised" };
            format!(
                "{none}{poles} keeps to the bounds {{ {} }}; the smallest that were found to be possible are {{ {} }}{together} \
                 (multiples of the passive norms, to 1 %)",
                list(1.0),
                list(times),
            )
        }
        None => format!(
            "no controller{poles} was found with the bounds {{ {} }}, nor with any larger ones that were tried: leave the bounds out to see \
             whether it is them",
            list(1.0)
        ),
    };
    let proof = if proved {
        "; one Lyapunov matrix is asked to show all norms and poles at once, which may ask too much of it"
    } else {
        ""
    };
    outcome.why = Some(why + proof);
}

/// The solver gave up.
pub(super) fn stalled(problem: &Problem, measures: &Measures, outcome: &mut DesignOutcome) {
    outcome.status = DesignStatus::Stalled;
    let numbers = [measures.primal, measures.dual, measures.gap];
    let how = if numbers.iter().all(|v| v.is_finite()) {
        format!(
            "it violates them by {:e}, its multipliers by {:e}, and its bounds are {:e} apart (relative)",
            numbers[0], numbers[1], numbers[2]
        )
    } else {
        "its numbers overflow: weights, bounds and norms are too far apart".to_owned()
    };
    let text = format!(
        "the solver of the matrix inequalities came to no answer: {how}. {}",
        room(problem, &outcome.passive)
    );
    outcome.why = Some(short_numbers(&text));
}

/// The only controller has a pole that is at 0 but for rounding.
pub(super) fn unconfirmed(problem: &Problem, pole: C64, outcome: &mut DesignOutcome) {
    outcome.status = DesignStatus::Stalled;
    let text = format!(
        "every controller that was found has a loop with a mode that does not decay but for rounding (its pole is {:e} {:+e}i 1/s), also with \
         the loop's poles left of a margin and with more of the goal given up. {}",
        pole.re,
        pole.im,
        room(problem, &outcome.passive)
    );
    outcome.why = Some(short_numbers(&text));
}

/// A promise that is no number.
pub(super) fn overflowed(name: &str, problem: &Problem, outcome: &mut DesignOutcome) {
    outcome.status = DesignStatus::Refused;
    outcome.claimed = Named::default();
    let text = format!(
        "a controller was found, but its {name} overflows: weights, bounds and norms are too far apart. {}",
        room(problem, &outcome.passive)
    );
    outcome.why = Some(short_numbers(&text));
}

/// The loop has a pole at 0 beside others so fast that rounding hides whether it is stable.
pub(super) fn hidden(problem: &Problem, outcome: &mut DesignOutcome) {
    outcome.status = DesignStatus::Refused;
    let text = format!(
        "a controller was found, but its loop has a mode next to 0 beside others so fast that rounding hides whether it is stable. {}",
        room(problem, &outcome.passive)
    );
    outcome.why = Some(short_numbers(&text));
}

/// A controller that its own loop contradicts.
pub(super) fn contradicted(e: &SynthesisError, problem: &Problem, passive: &Measured) -> Option<String> {
    let what = match e {
        SynthesisError::Lti(LtiError::NotStable { pole, .. }) => format!(
            "the inequalities have a solution, but the controller that is computed back from it is spoiled by rounding: its loop is not \
             stable (a pole at {:e} {:+e}i 1/s)",
            pole.re, pole.im
        ),
        SynthesisError::Lti(LtiError::IllPosed { rcond, .. }) => format!(
            "the inequalities have a solution, but only with a gain from the measurements straight to the forces that nearly cancels them \
             (reciprocal condition {rcond:e}): the goal is approached by gains without bound"
        ),
        SynthesisError::Refused { what, claimed, found } if what.contains("its region") => format!(
            "a controller was found, but rounding moves one of its loop's poles out of the region asked for (poles) by {found:e} 1/s, where \
             {claimed:e} are allowed"
        ),
        SynthesisError::Refused { what, claimed, found } => format!(
            "a controller was found, but rounding spoils it: {what} is claimed to be {claimed:e} and recomputed as {found:e}"
        ),
        SynthesisError::Linalg(e) => format!("a controller was found whose loop cannot be measured: {e}"),
        _ => return None,
    };
    Some(format!("{what}. {}", room(problem, passive)))
}

/// What is not stated yet and makes equations better conditioned, with magnitudes to begin with.
fn room(problem: &Problem, passive: &Measured) -> String {
    let spec = &problem.spec;
    let mixed = spec.mixed.unwrap_or_default();
    let is_mixed = spec.method == DesignMethod::MixedH2Hinf;
    let mut state = Vec::new();
    if is_mixed && mixed.sensor_noise == 0.0 {
        state.push(format!("mixed.sensor_noise = {NOISE:e} (the measurements have no noise)"));
    }
    if is_mixed && mixed.back_off < BACK_OFF {
        state.push(format!("mixed.back_off = {BACK_OFF}"));
    }
    if spec.input_weight == 0.0
        && let Some(w) = usual_weight(problem, passive)
    {
        state.push(format!("input_weight = {:.0e} (the forces cost nothing)", LIGHT * w));
    }
    let poles = region(passive).filter(|_| spec.poles.is_none());
    let poles = poles.map_or_else(String::new, |r| format!(", or poles = {r}"));
    if !state.is_empty() {
        return format!("State, one after another or together: {}{poles}", state.join(", "));
    }
    let wider = if problem.has_bounds() { ", wider bounds" } else { "" };
    let noise = if is_mixed {
        format!("mixed.sensor_noise = {:e}, mixed.back_off = 0.2, ", 100.0 * mixed.sensor_noise)
    } else {
        String::new()
    };
    format!(
        "Try {noise}input_weight = {:e}{poles}, a wider region of poles{wider}",
        100.0 * spec.input_weight
    )
}

/// A region of poles that is a car's, as it is written.
fn region(passive: &Measured) -> Option<String> {
    let slowest = passive.poles.iter().map(|p| -p[0]).fold(f64::INFINITY, f64::min);
    let fastest = passive.poles.iter().map(|p| p[0].hypot(p[1])).fold(0.0, f64::max);
    let (slow, fast) = (PACES[0] * slowest, PACES[1] * fastest);
    (slow > 0.0 && fast > slow)
        .then(|| format!("{{ max_real_rad_s = -{}, max_abs_rad_s = {} }}", digit(slow), digit(fast)))
}

/// One digit, as it is written.
fn digit(v: f64) -> String {
    let unit = 10f64.powi(v.log10().floor() as i32);
    let rounded = (v / unit).round() * unit;
    let places = (-v.log10().floor()).max(0.0) as usize;
    format!("{rounded:.places$}")
}

/// A weight of the control, as it is stated.
pub(super) fn weigh(problem: &Problem, passive: &Measured) -> String {
    let region = region(passive).map_or_else(String::new, |r| format!(", or poles = {r}"));
    let weight = usual_weight(problem, passive).filter(|_| problem.spec.input_weight == 0.0);
    let weight = weight.map_or_else(
        || "raise input_weight".to_owned(),
        |w| format!("state input_weight = {:.0e}", LIGHT * w),
    );
    format!("{weight}, goal.max_gain{region}")
}

/// What may help against gains that are too large.
pub(super) fn remedy(problem: &Problem) -> &'static str {
    if problem.spec.method == DesignMethod::RobustStateFeedback {
        "weight the control (input_weight), or widen the bounds"
    } else {
        "state mixed.sensor_noise, weight the control (input_weight), or widen the bounds"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_digit_is_written_plainly() {
        for (v, text) in [(0.171, "0.2"), (1386.0, "1000"), (0.00996, "0.010"), (20.4, "20"), (1.2, "1")] {
            assert_eq!(digit(v), text);
        }
    }
}
