//! Constraints in words.

use super::{Constraint, Constraints, NotAchievable, Violation};
use crate::lti::rational::number::short;
use crate::lti::{Rational, to_f64};
use num_traits::Zero;
use std::fmt;

impl Constraints {
    /// In words, a line a place: infinity, zero, the axis, and what K's properness asks.
    #[must_use]
    pub fn lines(&self) -> Vec<String> {
        let h = self.response.symbol();
        let mut lines = Vec::new();
        let at_infinity: Vec<_> = self
            .list
            .iter()
            .filter_map(|c| match c {
                Constraint::AtInfinity { power, value } => Some((*power, value)),
                _ => None,
            })
            .collect();
        if let Some((last, _)) = at_infinity.last() {
            let terms: Vec<String> = at_infinity
                .iter()
                .filter(|(_, v)| !v.is_zero())
                .map(|(k, v)| format!("{}{}", number(v), over_s(*k)))
                .chain([format!("O(1{})", over_s(last + 1))])
                .collect();
            lines.push(format!("{h}(s) = {} as s → ∞", terms.join(" + ").replace("+ −", "− ")));
        }
        let at = |keep: fn(&Constraint) -> bool| {
            self.list.iter().filter(|c| keep(c)).map(|c| c.text(h)).collect::<Vec<_>>().join(", ")
        };
        for line in [
            at(|c| matches!(c, Constraint::AtZero { .. })),
            at(|c| matches!(c, Constraint::OnAxis { .. })),
            at(|c| matches!(c, Constraint::NotAtInfinity { .. })),
        ] {
            if !line.is_empty() {
                lines.push(line);
            }
        }
        lines
    }
}

impl Constraint {
    /// In words, for a response of this name.
    #[must_use]
    pub fn text(&self, h: &str) -> String {
        match self {
            Constraint::AtZero { derivative: k, value } => {
                let marks = if *k <= 3 { "'".repeat(*k) } else { format!("^({k})") };
                format!("{h}{marks}(0) = {}", number(value))
            }
            Constraint::AtInfinity { power: 0, value } => format!("{h}(∞) = {}", number(value)),
            Constraint::AtInfinity { power, value } => {
                format!("the coefficient of s^−{power} of {h} at infinity = {}", number(value))
            }
            Constraint::OnAxis { omega_squared, re, im } => {
                let omega = to_f64(omega_squared).sqrt();
                let hz = omega / std::f64::consts::TAU;
                let slope =
                    if im.is_zero() { String::new() } else { format!(" ± j {}", short(to_f64(im) * omega)) };
                format!("{h}(±j{}) = {}{slope} ({} Hz)", short(omega), number(re), short(hz))
            }
            Constraint::NotAtInfinity { power: 0, value } => {
                format!("{h}(∞) ≠ {} (a proper controller)", number(value))
            }
            Constraint::NotAtInfinity { power, value } => {
                format!(
                    "the coefficient of s^−{power} of {h} at infinity ≠ {} (a proper controller)",
                    number(value)
                )
            }
        }
    }
}

/// Seven digits, with a minus sign.
fn number(x: &Rational) -> String {
    short(to_f64(x)).replace('-', "−")
}

fn over_s(k: usize) -> String {
    match k {
        0 => String::new(),
        1 => "/s".to_owned(),
        _ => format!("/s^{k}"),
    }
}

impl fmt::Display for NotAchievable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            NotAchievable::NotStable { proper: false, .. } => write!(f, "the response is not proper"),
            NotAchievable::NotStable { denominator, .. } => {
                write!(f, "the response is not stable: {denominator} is not Hurwitz")
            }
            NotAchievable::Violated(broken) => {
                let text = |v: &Violation| {
                    let im = if v.found.1.is_zero() {
                        String::new()
                    } else {
                        format!(" and {} jω", short(to_f64(&v.found.1)))
                    };
                    format!("{}, but found {}{im}", v.constraint.text("H"), short(to_f64(&v.found.0)))
                };
                write!(f, "{}", broken.iter().map(text).collect::<Vec<_>>().join("; "))
            }
        }
    }
}
