//! A design's controller over frequency, from its matrices, and what no controller changes.

use super::design_outcome::DesignOutcome;
use super::design_problem::Problem;
use super::{DesignMethod, Named};
use crate::units::{hz, rad_per_s};
use serde::{Deserialize, Serialize};

/// One entry of the controller: from a measurement to an actuator.
#[derive(Debug, Clone, PartialEq)]
pub struct BodeCurve {
    /// What it measures.
    pub input: String,
    /// What it drives.
    pub output: String,
    /// |K_ij|, N per unit of the measurement, at the frequencies of the gains.
    pub magnitude: Vec<f64>,
    /// Degrees, in (−180, 180].
    pub phase_deg: Vec<f64>,
}

/// A frequency at which a response is the same for every controller.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct InvariantPoint {
    /// The output.
    pub output: String,
    /// ω₁ = √(k_t/(m_s + m_u)) of the travel, ω₂ = √(k_t/m_u) of the acceleration.
    pub symbol: String,
    /// Hz.
    pub freq_hz: f64,
    /// Whether it is one: with tire damping it nearly is.
    pub exact: bool,
}

impl DesignOutcome {
    /// Every entry of a controller with states over frequency.
    #[must_use]
    pub fn bode(&self) -> Vec<BodeCurve> {
        let Some(file) = self.controller.as_ref().filter(|k| !k.a.is_empty()) else { return Vec::new() };
        let omegas: Vec<f64> = self.gains.freq_hz.iter().map(|f| rad_per_s(*f)).collect();
        let Ok(responses) = file.state_space().and_then(|k| k.frequency_response(&omegas)) else {
            return Vec::new();
        };
        let mut all = Vec::new();
        for (i, output) in file.outputs.iter().enumerate() {
            for (j, input) in file.inputs.iter().enumerate() {
                all.push(BodeCurve {
                    input: input.clone(),
                    output: output.clone(),
                    magnitude: responses.iter().map(|r| r[(i, j)].norm()).collect(),
                    phase_deg: responses.iter().map(|r| r[(i, j)].arg().to_degrees()).collect(),
                });
            }
        }
        all
    }

    /// Bounds of largest gains, as gains: multiples of the passive norms. None where these are of another vehicle.
    #[must_use]
    pub fn gain_bounds(&self) -> Named<f64> {
        let goal = &self.design.goal;
        let bounds = goal.bound.iter().chain(goal.bound_hinf.iter());
        let known = self.design.method.takes_bounds()
            && self.design.normalize_at.is_empty()
            && self.design.method != DesignMethod::Interpolation;
        let value =
            |(name, times): (&str, &f64)| Some((name.to_owned(), times * self.passive.hinf.get(name)?));
        bounds.filter(|_| known).filter_map(value).collect()
    }
}

/// Of quarter cars: m_s z̈_s + m_u z̈_u is what the tire gives, so that z̈_s at ω₂, and z_s − z_u at ω₁, follow from the road alone.
///
/// Source: Türkay's thesis, (4.28)–(4.30).
pub(super) fn invariant_points(problem: &Problem) -> Vec<InvariantPoint> {
    let Some(q) = &problem.file.quarter_car else { return Vec::new() };
    let (k, ms, mu) = (q.tire_stiffness_n_per_m, q.sprung_mass_kg, q.unsprung_mass_kg);
    let exact = q.tire_damping_n_s_per_m == 0.0;
    let point = |output: &str, symbol: &str, mass: f64| InvariantPoint {
        output: output.into(),
        symbol: symbol.into(),
        freq_hz: hz((k / mass).sqrt()),
        exact,
    };
    vec![point("suspension_travel", "ω₁", ms + mu), point("sprung_acceleration", "ω₂", mu)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::{DesignSpec, Goal, design};

    /// The gains are the plant's and the loop's at one frequency, each conditioned like 1e3.
    const ROUNDING: f64 = 1e-9;

    #[test]
    fn no_controller_changes_what_is_invariant() {
        let minimize = ["sprung_acceleration", "suspension_travel", "tire_deflection"];
        let spec = DesignSpec {
            vehicle: "case:turkay-quarter-car".into(),
            road: "case:turkay-white-velocity".into(),
            speed_m_s: 20.0,
            measurements: vec!["suspension_travel".into()],
            goal: Goal {
                minimize: minimize.iter().map(|n| ((*n).to_owned(), 1.0)).collect(),
                ..Goal::default()
            },
            ..DesignSpec::default()
        };
        let outcome = design(&spec).unwrap().0;
        assert_eq!(outcome.invariant.len(), 2);
        let problem = Problem::new(&spec, super::super::design_problem::Norm::H2).unwrap();
        let k = outcome.controller.as_ref().unwrap().state_space().unwrap();
        let closed = problem.plant.close(&k).unwrap();
        for point in &outcome.invariant {
            assert!(point.exact);
            let w = [rad_per_s(point.freq_hz), rad_per_s(1.1 * point.freq_hz)];
            let before = problem.gains_at(&problem.plant.passive(), &w).unwrap();
            let after = problem.gains_at(&closed, &w).unwrap();
            let ratio =
                |k: usize| after.get(&point.output).unwrap()[k] / before.get(&point.output).unwrap()[k];
            assert!((ratio(0) - 1.0).abs() < ROUNDING, "{}: {}", point.output, ratio(0));
            assert!((ratio(1) - 1.0).abs() > 1e-3, "{}: {}", point.output, ratio(1));
        }
        // notes on chapter 4
        for (point, known) in outcome.invariant.iter().zip([3.83200, 10.61033]) {
            assert!((point.freq_hz - known).abs() < 5e-5, "{}", point.freq_hz);
        }
    }
}
