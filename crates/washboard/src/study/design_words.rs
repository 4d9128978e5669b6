//! What a design says in words: how it ended, why there is no controller and what may help, what its names stand for.

use super::design_advice::contradicted;
use super::design_outcome::{DesignOutcome, DesignStatus, Measured};
use super::design_problem::Problem;
use super::{DesignDisturbance, DesignMethod, Flag};
use crate::linalg::RiccatiError;
use crate::synthesis::{Assumption, SynthesisError};
use crate::units::hz;

/// A force that an actuator of a car can do: hints of weights are for it, N.
const USUAL_FORCE_N: f64 = 1000.0;
/// Digits of a number in a sentence.
const DIGITS: usize = 3;

impl DesignOutcome {
    /// How it ended, in words.
    #[must_use]
    pub fn verdict(&self) -> String {
        match self.status {
            DesignStatus::Designed => {
                if self.order == Some(0) && self.design.method == DesignMethod::FixedOrder {
                    let (k, of) =
                        (self.controller.as_ref().map_or(0, |k| k.inputs.len()), self.for_how_many());
                    let many = if k == 1 { "measurement" } else { "measurements" };
                    return format!("a gain from {k} {many}, confirmed by its loop{of}");
                }
                if self.order == Some(0) {
                    let of = if self.vertices.is_empty() { "" } else { ", for the whole range" };
                    return format!(
                        "a gain from {} states, confirmed by its loop{of}",
                        self.design.measurements.len()
                    );
                }
                let price = if self.warnings.is_empty() { "" } else { ", with a price" };
                let of = self.for_how_many();
                format!("a controller of order {}, confirmed by its loop{of}{price}", self.order.unwrap_or(0))
            }
            DesignStatus::Limit => "what no controller can beat".to_owned(),
            DesignStatus::Infeasible if self.design.method == DesignMethod::FixedOrder => {
                "no controller of this order and structure was found that keeps the bounds".to_owned()
            }
            DesignStatus::Infeasible => "what is asked cannot be had, so there is no controller".to_owned(),
            DesignStatus::Stalled => "the method did not find a controller".to_owned(),
            DesignStatus::Refused if self.design.method.is_by_inequalities() => {
                "a controller was found, but it is not what is asked".to_owned()
            }
            DesignStatus::Refused => "a controller was found, but its loop contradicts its claim".to_owned(),
        }
    }

    /// Of a fixed-order design for several vehicles.
    fn for_how_many(&self) -> String {
        match self.design.plant.len() {
            2.. if self.design.method == DesignMethod::FixedOrder => {
                format!(", for {} vehicles", self.design.plant.len())
            }
            _ => String::new(),
        }
    }

    /// Why there are no numbers of a closed loop; none where there are.
    #[must_use]
    pub fn no_loop(&self) -> Option<&'static str> {
        match (&self.verified, self.status) {
            (Some(_), _) => None,
            (None, DesignStatus::Limit) => Some(
                "A limit has no controller, so there is no closed loop to show: the numbers of responses are the passive vehicle's.",
            ),
            (None, _) => Some(
                "Without a controller there is no closed loop to show: the numbers are the passive vehicle's.",
            ),
        }
    }

    /// What a gain is per: the unit of the disturbance.
    #[must_use]
    pub fn per(&self) -> &'static str {
        per(self.design.disturbance)
    }

    /// The white noise that H2 norms are from, in words: no rms on a road.
    #[must_use]
    pub fn white(&self) -> &'static str {
        match self.design.disturbance {
            DesignDisturbance::RoadVelocity => "per unit white road velocity",
            DesignDisturbance::RoadDisplacement => "per unit white road height",
            DesignDisturbance::RoadNoise => "from the road's own noise",
        }
    }

    /// The name of the goal's value, in words.
    #[must_use]
    pub fn goal_words(&self) -> &'static str {
        match self.design.method {
            DesignMethod::Hinf => "largest of the weighted peak gains",
            DesignMethod::FixedOrder if self.design.goal.minimize_h2.is_empty() => {
                "largest of the weighted peak gains"
            }
            DesignMethod::FixedOrder => "largest of the weighted norms",
            _ if !self.design.goal.minimize_hinf.is_empty() => "weighted norms, squared and summed",
            _ => "weighted H2 norms, squared and summed",
        }
    }

    /// A claimed number in words, and its unit (empty: a pure number).
    #[must_use]
    pub fn claim_words(&self, name: &str) -> (String, String) {
        let pure = |words: &str| (words.to_owned(), String::new());
        match name {
            "h2_with_noise" => pure("H2 norm with sensor noise"),
            "h2_with_noise_recomputed" => pure("the same, from vehicle and controller alone"),
            "control_riccati_residual" => pure("control Riccati equation's residual, relative"),
            "filter_riccati_residual" => pure("filter Riccati equation's residual, relative"),
            "h2_limit" => pure("H2 norm that no controller beats"),
            "h2_limit_closed_form" => pure("the same, by inner and outer factors"),
            "gamma" => pure("H∞ norm of all weighted outputs together"),
            "level" => pure("level that it was made for"),
            "gamma_recomputed" => pure("H∞ norm, from vehicle and controller alone"),
            "match_error" => pure("error of the copied acceleration, relative"),
            "objective" => pure("the goal's value"),
            "h2" => pure("H2 norm of all weighted outputs together"),
            "pole_margin" => ("the loop's poles are kept left of minus".to_owned(), "1/s".to_owned()),
            "added_input_weight" => ("weight of the control that was added".to_owned(), "1/N²".to_owned()),
            "back_off" => pure("given up for smaller gains, as a share"),
            "optimum" => pure("least value by one Lyapunov matrix"),
            "condition" => pure("condition of I − XY"),
            "iterations" => pure("iterations of the solver"),
            "iterations_double_double" => pure("iterations in double-double precision"),
            "nominal_objective" => pure("the same, of the vehicle as stated alone"),
            "fastest_controller_pole" => ("the controller's fastest pole".to_owned(), "rad/s".to_owned()),
            "controller_gain" => ("the controller's largest gain".to_owned(), "N per unit".to_owned()),
            "tire_factor_at_wheel_hop" => pure("tire at the hidden mode, over the copied design's"),
            other => {
                let unit = |output: &str| self.units.get(output).cloned().unwrap_or_default();
                if let Some(output) = other.strip_prefix("rms_") {
                    (format!("rms of {output} by formula"), unit(output))
                } else if let Some(output) = other.strip_prefix("h2_") {
                    // a bounded one: what is allowed is a multiple of the passive norm
                    let bound = self.design.goal.bound_h2.get(output);
                    let passive = self.passive.h2.get(output).and_then(|r| r.finite());
                    let own = self.design.normalize_at.is_empty() && self.design.plant.is_empty();
                    let allowed = bound.zip(passive).filter(|_| own).map_or_else(String::new, |(b, p)| {
                        format!(" (allowed {} = {b} × passive {})", short(b * p), short(p))
                    });
                    (format!("H2 norm of {output}, {}{allowed}", self.white()), unit(output))
                } else if let Some(output) = other.strip_prefix("hinf_") {
                    (format!("largest gain of {output}"), format!("{} per {}", unit(output), self.per()))
                } else if let Some(output) = other.strip_prefix("lyapunov_scale_") {
                    pure(&format!("Lyapunov scale of {output}"))
                } else {
                    pure(&other.replace('_', " "))
                }
            }
        }
    }
}

fn per(disturbance: DesignDisturbance) -> &'static str {
    match disturbance {
        DesignDisturbance::RoadVelocity => "m/s",
        DesignDisturbance::RoadDisplacement => "m",
        DesignDisturbance::RoadNoise => "unit noise",
    }
}

/// Notes of what stacked names stand for.
pub(super) fn expanded(problem: &Problem) -> Vec<Flag> {
    let outputs = problem.vehicle.outputs();
    let asked = problem.spec.measurements.iter().map(String::as_str);
    let goals = problem.goals.iter().map(|g| g.name.as_str());
    let mut done: Vec<&str> = Vec::new();
    let mut all = Vec::new();
    for name in asked.chain(goals) {
        let members: Vec<&str> =
            outputs.iter().filter(|o| o.base == name && o.name != name).map(|o| o.name.as_str()).collect();
        if members.is_empty() || done.contains(&name) {
            continue;
        }
        done.push(name);
        let ends = members.iter().map(|m| m.strip_prefix(name).unwrap_or(m).trim_start_matches('_'));
        all.push(format!("{name} for {}", ends.collect::<Vec<_>>().join(", ")));
    }
    let text = format!("names without a corner stand for all: {}", all.join("; "));
    if all.is_empty() { Vec::new() } else { vec![Flag { name: "stacked".into(), text }] }
}

/// A note of groups that are no part of the goal.
pub(super) fn unused(problem: &Problem) -> Option<Flag> {
    let parts = problem.goals.iter().chain(&problem.bounded).chain(problem.peaks.iter().map(|p| &p.block));
    let used: Vec<&str> = parts.map(|g| g.name.as_str()).collect();
    let groups = problem.spec.goal.groups.iter().map(|(name, _)| name);
    let idle: Vec<&str> = groups.filter(|name| !used.contains(name)).collect();
    (!idle.is_empty()).then(|| {
        let text = format!(
            "goal.groups: without a weight or a bound, and so no part of the goal: {}",
            idle.join(", ")
        );
        Flag { name: "unused-group".into(), text }
    })
}

/// Two numbers with as many digits as it takes to tell them apart.
pub(super) fn apart(one: f64, other: f64) -> [String; 2] {
    let difference = (one - other).abs() / one.abs().max(other.abs());
    let digits = if difference > 0.0 { (1.0 - difference.log10()).ceil().clamp(2.0, 16.0) } else { 16.0 };
    [one, other].map(|v| format!("{v:.*e}", digits as usize))
}

/// Why there is no controller, and what may help.
pub(super) fn why(e: &SynthesisError, problem: &Problem, passive: &Measured) -> String {
    let by_inequalities = problem.spec.method.is_by_inequalities();
    if let Some(text) = contradicted(e, problem, passive).filter(|_| by_inequalities) {
        return short_numbers(&text);
    }
    let text = match e {
        SynthesisError::Refused { what, claimed, found } => {
            let [claimed, found] = apart(*claimed, *found);
            let weight = usual_weight(problem, passive).filter(|_| problem.spec.input_weight == 0.0);
            let weight = weight.map_or_else(
                || format!("a larger input_weight than {}", short(problem.spec.input_weight)),
                |w| format!("input_weight = {w:.0e} (1/N²)"),
            );
            return format!(
                "{what} is claimed to be {claimed} and recomputed as {found}, which rounding must not make so different: the equations are \
                 too ill-conditioned. State {weight}, or raise lqg.sensor_noise"
            );
        }
        SynthesisError::Riccati { equation, source: RiccatiError::OnTheBoundary { distance, frequency } } => {
            let help = if *equation == "filter" {
                "the measurements hardly see the road there; raise lqg.sensor_noise, or measure something that the road \
                 moves at that frequency"
            } else {
                "the controls hardly move the goal there; weight them (input_weight), or minimise something that they move \
                 at that frequency"
            };
            format!(
                "the {equation} equation has no stabilising solution: at {frequency:e} rad/s ({:e} Hz) its Hamiltonian has an \
                 eigenvalue on the imaginary axis but for {distance:e} of its size: {help}",
                hz(*frequency)
            )
        }
        SynthesisError::Assumptions(broken) => {
            let mut text = e.to_string();
            if broken.iter().any(|b| b.assumption == Assumption::ControlsWeighted) {
                text += &weight_hint(problem, passive);
            }
            if broken.iter().any(|b| b.assumption == Assumption::MeasurementsNoisy) {
                text += NOISE_HINT;
            }
            text
        }
        SynthesisError::NoLevel { level, why } => {
            // X and Y are the solutions of the control and the filter equation
            let why = why.replace("X: ", "the control equation: ").replace("Y: ", "the filter equation: ");
            let why = match why.split_once("at angular frequency ") {
                Some((what, omega)) if omega.parse::<f64>().is_ok() => format!("{what}at {omega} rad/s"),
                _ => why,
            };
            format!(
                "no controller was found at any H∞ level up to {level:e}; at the last, {why}. Raise lqg.sensor_noise, or \
                 weight the controls (input_weight): as it stands the equations are too ill-conditioned to be solved"
            )
        }
        _ => e.to_string(),
    };
    short_numbers(&text)
}

const NOISE_HINT: &str = ". lqg.sensor_noise is the square of a sensor's noise density per √Hz, over 2: an accelerometer of \
                          100 µg/√Hz has 4.8e-7 (m/s²)² s, a travel sensor with 0.1 mm rms up to 100 Hz has 5e-11 m² s";

/// A weight of the control that is neither none nor all.
fn weight_hint(problem: &Problem, passive: &Measured) -> String {
    let (weight, what) = if problem.spec.method == DesignMethod::Hinf {
        let what = format!("a force of 1 kN per {}", per(problem.spec.disturbance));
        (Some(USUAL_FORCE_N.powi(-2)), what)
    } else {
        (usual_weight(problem, passive), "a force of 1 kN rms on this road".to_owned())
    };
    weight.map_or_else(String::new, |w| {
        format!(". To begin with: input_weight = {w:.1e} (1/N²) makes {what} cost as much as an output of weight 1 without control")
    })
}

/// The weight of the control at which 1 kN rms on this road costs as much as an output of weight 1 without control, 1/N².
pub(super) fn usual_weight(problem: &Problem, passive: &Measured) -> Option<f64> {
    // rms on the road over the norm from the disturbance: the same factor for the force
    let goals = problem.goals.iter().map(|g| g.name.as_str());
    let scale = goals.chain(passive.rms.iter().map(|(n, _)| n)).find_map(|name| {
        let (rms, h2) = (passive.rms.get(name)?.finite()?, passive.h2.get(name)?.finite()?);
        (rms > 0.0 && h2 > 0.0).then_some(rms / h2)
    });
    scale.map(|s| (s / USUAL_FORCE_N).powi(2))
}

/// Long numbers in a sentence with a few digits: `3.6365966576707826e-11` as `3.64e-11`.
pub(super) fn short_numbers(text: &str) -> String {
    let c: Vec<char> = text.chars().collect();
    let (mut out, mut k) = (String::with_capacity(text.len()), 0);
    while k < c.len() {
        let part = |c: char| c.is_alphanumeric() || c == '_' || c == '.';
        // j66.7 is a number
        let imaginary = k > 0 && c[k - 1] == 'j' && !(k > 1 && part(c[k - 2]));
        let inside_a_name = k > 0 && part(c[k - 1]) && !imaginary;
        if !c[k].is_ascii_digit() || inside_a_name {
            out.push(c[k]);
            k += 1;
            continue;
        }
        let digits = |mut at: usize| {
            while at < c.len() && c[at].is_ascii_digit() {
                at += 1;
            }
            at
        };
        let mut end = digits(k);
        if c.get(end) == Some(&'.') && c.get(end + 1).is_some_and(char::is_ascii_digit) {
            end = digits(end + 1);
        }
        if matches!(c.get(end), Some('e' | 'E')) {
            let from = end + 1 + usize::from(matches!(c.get(end + 1), Some('-' | '+')));
            if c.get(from).is_some_and(char::is_ascii_digit) {
                end = digits(from);
            }
        }
        let token: String = c[k..end].iter().collect();
        let long = token.contains('e') || token.chars().filter(char::is_ascii_digit).count() > DIGITS + 1;
        match token.parse::<f64>() {
            Ok(v) if long && (token.contains('.') || token.contains('e')) => out.push_str(&short(v)),
            _ => out.push_str(&token),
        }
        k = end;
    }
    out
}

/// A few digits, an exponent where it is very large or small, no zeros at the end.
pub(super) fn short(v: f64) -> String {
    if v == 0.0 {
        return "0".into();
    }
    if v < 0.0 {
        return format!("-{}", short(-v));
    }
    if !(1e-3..1e5).contains(&v) {
        let text = format!("{v:.*e}", DIGITS - 1);
        return match text.split_once('e') {
            Some((m, e)) if m.contains('.') => {
                format!("{}e{e}", m.trim_end_matches('0').trim_end_matches('.'))
            }
            _ => text,
        };
    }
    let places = (DIGITS as i32 - 1 - v.log10().floor() as i32).max(0) as usize;
    let text = format!("{v:.places$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_numbers_are_told_apart() {
        assert_eq!(apart(0.008_021_234, 0.008_021_334), ["8.021234e-3", "8.021334e-3"]);
        assert_eq!(apart(1.0, 3.0), ["1.00e0", "3.00e0"]);
        let [one, other] = apart(1.0, 1.0 + 1e-14);
        assert_ne!(one, other);
    }

    #[test]
    fn numbers_in_sentences_are_short_and_names_stay() {
        for (long, expected) in [
            ("at distance 3.6365966576707826e-11 of it", "at distance 3.64e-11 of it"),
            ("at frequency 0e0", "at frequency 0"),
            ("below 1e0 was", "below 1 was"),
            ("H(∞) = 11.11574, but found 222.3148", "H(∞) = 11.1, but found 222"),
            ("0.0e0, expected above 1e-10): D12", "0, expected above 1e-10): D12"),
            (
                "input_weight = 1.5e-10 (1/N²), order 12345, 2.5 s",
                "input_weight = 1.5e-10 (1/N²), order 12345, 2.5 s",
            ),
            ("a_1.23456 x2.34567", "a_1.23456 x2.34567"),
            ("H(±j66.66667) = 2", "H(±j66.7) = 2"),
        ] {
            assert_eq!(short_numbers(long), expected);
        }
    }
}
