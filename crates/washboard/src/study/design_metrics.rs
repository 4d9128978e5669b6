//! Metrics of a design: passive and closed, on its road and over a bump.

use super::bump_metrics::{BumpMetrics, BumpSpec};
use super::design_problem::Problem;
use super::ride_metrics::{Judged, RideMetrics, RideMetricsError, check_stroke, long_stroke};
use super::{Flag, StudyError};
use crate::lti::{Continuous, StateSpace};
use crate::vehicle::{Bump, Control, Ride};
use serde::{Deserialize, Serialize};

/// `[metrics]`: what a vehicle is judged with beside its rms.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MetricsSection {
    /// Stroke of every suspension to either side of where it rests, m: how often it bottoms.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stroke_m: Option<f64>,
    /// The bump; 0.1 m over 2 m where it is left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bump: Option<BumpSpec>,
}

/// Passive and closed metrics, and what they are of.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DesignMetrics {
    /// The stroke given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stroke_m: Option<f64>,
    /// The bump.
    pub bump: BumpSpec,
    /// Without control; none of a vehicle that is not stable so.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub passive: Option<RideMetrics>,
    /// With the controller.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub closed: Option<RideMetrics>,
}

impl MetricsSection {
    /// Refuses what no vehicle has.
    pub(super) fn check(&self) -> Result<(), StudyError> {
        check_stroke("metrics.stroke_m", self.stroke_m)?;
        let BumpSpec { height_m, length_m } = self.bump.unwrap_or_default();
        Bump::new(height_m, length_m).map(|_| ()).map_err(|e| StudyError::Setting {
            field: "metrics.bump",
            expected: "a height up to 100 m, not 0, and a positive length".into(),
            found: e.to_string(),
        })
    }
}

impl Problem {
    /// Metrics of the passive vehicle and of the loop; what could not be computed is a note.
    pub fn metrics(
        &self,
        section: &MetricsSection,
        passive_is_stable: bool,
        controller: Option<&StateSpace<Continuous>>,
    ) -> (DesignMetrics, Vec<Flag>) {
        let mut notes: Vec<Flag> = long_stroke(section.stroke_m).into_iter().collect();
        let mut of = |k: Option<&StateSpace<Continuous>>, whose: &str| match self.metrics_of(section, k) {
            Ok((metrics, bump)) => {
                let text = |e| format!("the {whose} has no bump response: {e}");
                notes.extend(bump.map(|e| Flag { name: "metrics".into(), text: text(e) }));
                Some(metrics)
            }
            Err(e) => {
                let text = format!("the {whose} has no metrics: {e}");
                notes.push(Flag { name: "metrics".into(), text });
                None
            }
        };
        let passive = if passive_is_stable { of(None, "passive vehicle") } else { None };
        let closed = controller.and_then(|k| of(Some(k), "closed loop"));
        let bump = section.bump.unwrap_or_default();
        (DesignMetrics { stroke_m: section.stroke_m, bump, passive, closed }, notes)
    }

    /// Of one loop, and why it has no bump response, in words.
    fn metrics_of(
        &self,
        section: &MetricsSection,
        controller: Option<&StateSpace<Continuous>>,
    ) -> Result<(RideMetrics, Option<String>), RideMetricsError> {
        let y: Vec<String> = self.measurements.iter().map(|o| o.name.clone()).collect();
        let u: Vec<String> = self.vehicle.actuators().iter().map(|a| a.name.clone()).collect();
        let control = controller.map(|k| Control::new(&self.vehicle, k.clone(), &y, &u));
        let control = control.transpose().map_err(crate::vehicle::RideError::from)?;
        let (road, speed_m_s) = (self.ground.excitation(), self.spec.speed_m_s);
        let ride = match &control {
            Some(c) => Ride::controlled(&self.vehicle, road, speed_m_s, c)?,
            None => Ride::new(&self.vehicle, road, speed_m_s)?,
        };
        let judged = Judged {
            vehicle: &self.vehicle,
            speed_m_s,
            stroke_m: section.stroke_m,
            controlled: control.is_some(),
        };
        let mut metrics = RideMetrics::of(&ride, &judged)?;
        // a filter of chassis points has no wheels to lift
        if self.ground.at_points {
            return Ok((metrics, None));
        }
        let bump = section.bump.unwrap_or_default();
        match BumpMetrics::of(&self.vehicle, control.as_ref(), bump, speed_m_s) {
            Ok(found) => metrics.bump = Some(found),
            Err(e) => return Ok((metrics, Some(e.to_string()))),
        }
        Ok((metrics, None))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::Weighting;
    use crate::study::design_measure::Norm;
    use crate::study::{DesignDisturbance, DesignMethod, DesignSpec, Goal, MetricGroup, design};

    fn spec() -> DesignSpec {
        let minimize = [("sprung_acceleration".to_owned(), 1.0), ("suspension_travel".to_owned(), 0.5)];
        DesignSpec {
            vehicle: "case:turkay-quarter-car".into(),
            road: "case:turkay-white-velocity".into(),
            speed_m_s: 20.0,
            measurements: vec!["suspension_travel".into()],
            method: DesignMethod::Lqg,
            disturbance: DesignDisturbance::RoadNoise,
            input_weight: 1e-6,
            goal: Goal { minimize: minimize.into_iter().collect(), ..Goal::default() },
            metrics: Some(MetricsSection { stroke_m: Some(0.05), bump: None }),
            ..DesignSpec::default()
        }
    }

    #[test]
    fn a_loops_weighted_acceleration_is_the_h2_norm_behind_the_filter() {
        let (outcome, _) = design(&spec()).unwrap();
        let metrics = outcome.metrics.as_ref().unwrap();
        assert!(outcome.metrics_words().contains("stroke is ±0.05 m"), "{}", outcome.metrics_words());
        let problem = Problem::new(&spec(), Norm::H2).unwrap();
        let k = outcome.controller.as_ref().unwrap().state_space().unwrap();
        let at = problem.reported.iter().position(|o| o.name == "sprung_acceleration").unwrap();
        let filter = Weighting::Wk.filter().unwrap();
        let loops = [problem.plant.passive(), problem.plant.close(&k).unwrap()];
        for (found, closed) in [&metrics.passive, &metrics.closed].into_iter().zip(loops) {
            let one = closed.select(&[at], &[0]).unwrap().series(&filter).unwrap();
            let known = one.h2_norm().unwrap();
            let found = found.as_ref().unwrap().weighted.get("sprung_acceleration").unwrap().rms;
            assert!((found / known - 1.0).abs() < 1e-7, "{found} {known}");
        }
        let closed = metrics.closed.as_ref().unwrap();
        assert!(closed.travel.get("suspension_travel").unwrap().bottoming_per_km.is_some());
        assert!(closed.actuator.get("actuator").unwrap().absolute_w > 0.0);
        assert!(metrics.passive.as_ref().unwrap().actuator.is_empty());
        let force = outcome.forces.get("actuator_force").and_then(|r| r.finite()).unwrap();
        assert!((closed.actuator.get("actuator").unwrap().force_rms_n / force - 1.0).abs() < 1e-9);
        assert!(outcome.notes.iter().all(|n| n.name != "metrics"), "{:?}", outcome.notes);
        // (5.22): a peak's reduction is the change's opposite
        let rows = metrics.rows(&outcome.units);
        let peak = rows.iter().find(|r| r.key == "bump_peak_sprung_acceleration").unwrap();
        let [before, after] = peak.values.map(Option::unwrap);
        assert!((peak.change().unwrap() + 1.0 - after / before).abs() < 1e-15 && peak.unit == "m/s²");
        assert!(MetricGroup::ALL.iter().all(|g| rows.iter().any(|r| r.group == *g)), "{rows:?}");
        // and they are read back as they are
        let text = serde_json::to_string(&outcome).unwrap();
        assert_eq!(serde_json::from_str::<crate::study::DesignOutcome>(&text).unwrap(), outcome);
    }

    #[test]
    fn a_stroke_in_millimetres_is_told() {
        let long = |stroke_m| DesignSpec {
            metrics: Some(MetricsSection { stroke_m: Some(stroke_m), bump: None }),
            ..spec()
        };
        let told = |stroke_m| {
            let notes = design(&long(stroke_m)).unwrap().0.notes;
            notes.into_iter().find(|n| n.name == "stroke").map(|n| n.text)
        };
        assert!(told(80.0).unwrap().contains("a stroke of 80 m") && told(0.08).is_none());
    }

    #[test]
    fn wrong_strokes_and_bumps_are_refused_by_their_field() {
        for (section, field) in [
            (MetricsSection { stroke_m: Some(-0.1), bump: None }, "metrics.stroke_m"),
            (
                MetricsSection { stroke_m: None, bump: Some(BumpSpec { height_m: 0.0, length_m: 1.0 }) },
                "metrics.bump",
            ),
        ] {
            let e = design(&DesignSpec { metrics: Some(section), ..spec() }).unwrap_err().to_string();
            assert!(e.contains(field), "{e}");
        }
    }
}
