//! A design's outcome as rows of a table: outputs by what they say of a car, whole vectors before their corners.

use super::Rms;
use super::design_outcome::DesignOutcome;

/// What an output says of a car.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ResponseGroup {
    /// Accelerations of the body.
    Comfort,
    /// Travels of the suspension.
    RattleSpace,
    /// Deflections and forces of the tires.
    TireLoad,
    /// Accelerations of the wheels.
    Wheels,
    /// Forces of the actuators.
    Force,
    /// Of a vehicle that names its outputs itself.
    Other,
}

impl ResponseGroup {
    /// In the order in which they are read.
    pub const ALL: [ResponseGroup; 6] = [
        ResponseGroup::Comfort,
        ResponseGroup::RattleSpace,
        ResponseGroup::TireLoad,
        ResponseGroup::Force,
        ResponseGroup::Wheels,
        ResponseGroup::Other,
    ];

    /// The group of an output, by its name.
    #[must_use]
    pub fn of(name: &str) -> Self {
        if name.starts_with("actuator_force") {
            ResponseGroup::Force
        } else if name.contains("travel") {
            ResponseGroup::RattleSpace
        } else if name.contains("deflection") || name.starts_with("tire_") {
            ResponseGroup::TireLoad
        } else if name.starts_with("unsprung") {
            ResponseGroup::Wheels
        } else if name.contains("acceleration") {
            ResponseGroup::Comfort
        } else {
            ResponseGroup::Other
        }
    }

    /// Its heading.
    #[must_use]
    pub fn heading(self) -> &'static str {
        match self {
            ResponseGroup::Comfort => "comfort",
            ResponseGroup::RattleSpace => "rattle space",
            ResponseGroup::TireLoad => "tire load",
            ResponseGroup::Wheels => "wheels",
            ResponseGroup::Force => "actuator force",
            ResponseGroup::Other => "other outputs",
        }
    }
}

/// One output or stacked vector, passive and in the loop.
#[derive(Debug, Clone, PartialEq)]
pub struct ResponseRow<'a> {
    /// What it says of a car.
    pub group: ResponseGroup,
    /// Its name.
    pub name: &'a str,
    /// The stacked vector that it is a corner of.
    pub corner_of: Option<&'a str>,
    /// Its unit.
    pub unit: &'a str,
    /// rms on the road: passive, closed.
    pub rms: [Option<Rms>; 2],
    /// rms of the H2 limit.
    pub limit: Option<Rms>,
    /// Largest gain from the disturbance: passive, closed.
    pub peak: [Option<f64>; 2],
}

impl ResponseRow<'_> {
    /// The corner, or the whole name.
    #[must_use]
    pub fn short_name(&self) -> &str {
        let corner = self.corner_of.and_then(|base| self.name.strip_prefix(base)?.strip_prefix('_'));
        corner.unwrap_or(self.name)
    }

    /// The rms of the loop over the passive one, less 1; none where either is infinite, unknown, or passive zero.
    #[must_use]
    pub fn rms_change(&self) -> Option<f64> {
        let [before, after] = self.rms.map(|r| r.and_then(Rms::finite));
        change(before?, after?)
    }

    /// The rms of the H2 limit over the passive one, less 1.
    #[must_use]
    pub fn limit_change(&self) -> Option<f64> {
        change(self.rms[0].and_then(Rms::finite)?, self.limit.and_then(Rms::finite)?)
    }

    /// The same of the largest gains.
    #[must_use]
    pub fn peak_change(&self) -> Option<f64> {
        change(self.peak[0]?, self.peak[1]?)
    }
}

fn change(before: f64, after: f64) -> Option<f64> {
    (before > 0.0 && after.is_finite()).then(|| after / before - 1.0)
}

impl DesignOutcome {
    /// All outputs, by groups; within one, whole vectors are followed by their corners.
    #[must_use]
    pub fn rows(&self) -> Vec<ResponseRow<'_>> {
        let closed = self.verified.as_ref();
        // a vehicle that is not stable without control has none of its own
        let measured = closed.filter(|_| self.passive.rms.is_empty()).unwrap_or(&self.passive);
        let names: Vec<&str> = measured.rms.iter().map(|(name, _)| name).collect();
        let is_corner_of =
            |name: &str, base: &str| name.strip_prefix(base).is_some_and(|rest| rest.starts_with('_'));
        let groups = &self.design.goal.groups;
        let row = |name| ResponseRow {
            group: ResponseGroup::of(groups.get(name).and_then(|g| g.first()).map_or(name, String::as_str)),
            name,
            corner_of: names
                .iter()
                .copied()
                .find(|base| groups.get(base).is_none() && is_corner_of(name, base)),
            unit: self.units.get(name).map_or("", String::as_str),
            rms: [self.passive.rms.get(name).copied(), closed.and_then(|c| c.rms.get(name)).copied()],
            limit: self.limit.as_ref().and_then(|l| l.rms.get(name)).copied(),
            peak: [self.passive.hinf.get(name).copied(), closed.and_then(|c| c.hinf.get(name)).copied()],
        };
        let all: Vec<ResponseRow<'_>> = names.iter().copied().map(row).collect();
        let mut rows = Vec::with_capacity(all.len());
        for group in ResponseGroup::ALL {
            for whole in all.iter().filter(|r| r.group == group && r.corner_of.is_none()) {
                rows.push(whole.clone());
                rows.extend(all.iter().filter(|r| r.corner_of == Some(whole.name)).cloned());
            }
        }
        rows
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::{DesignMethod, DesignSpec, Goal, design};

    fn half_car(weights: &[&str], road: &str) -> DesignOutcome {
        let minimize = weights.iter().map(|n| ((*n).to_owned(), 1.0)).collect();
        let spec = DesignSpec {
            vehicle: "case:turkay-half-car".into(),
            road: road.into(),
            speed_m_s: 20.0,
            measurements: vec!["suspension_travel".into()],
            method: DesignMethod::H2Limit,
            input_weight: 1e-9,
            goal: Goal { minimize, ..Goal::default() },
            ..DesignSpec::default()
        };
        design(&spec).unwrap().0
    }

    #[test]
    fn rows_stand_in_groups_and_corners_follow_their_vector() {
        let outcome = half_car(&["heave_acceleration"], "case:turkay-white-velocity");
        let rows = outcome.rows();
        assert_eq!(rows.len(), outcome.passive.rms.iter().count());
        let order: Vec<usize> =
            rows.iter().map(|r| ResponseGroup::ALL.iter().position(|g| *g == r.group).unwrap()).collect();
        assert!(order.is_sorted(), "{order:?}");
        assert_eq!((rows[0].name, rows[0].unit), ("heave_acceleration", "m/s²"));
        let at = rows.iter().position(|r| r.name == "suspension_travel").unwrap();
        let after: Vec<(&str, Option<&str>)> =
            rows[at + 1..at + 3].iter().map(|r| (r.short_name(), r.corner_of)).collect();
        assert_eq!(after, [("front", Some("suspension_travel")), ("rear", Some("suspension_travel"))]);
        // the whole is the root of the squares of its corners, in the same unit
        let rms = |k: usize| rows[at + k].rms[0].and_then(Rms::finite).unwrap();
        assert!((rms(0) / rms(1).hypot(rms(2)) - 1.0).abs() < 1e-12);
        assert!(rows.iter().all(|r| !r.unit.is_empty() && r.rms[1].is_none() && r.rms_change().is_none()));
    }

    #[test]
    fn every_output_of_every_car_has_its_group() {
        for (case, expected) in [
            ("heave_acceleration", ResponseGroup::Comfort),
            ("driver_heave_acceleration", ResponseGroup::Comfort),
            ("unsprung_acceleration_front_left", ResponseGroup::Wheels),
            ("suspension_travel_rear", ResponseGroup::RattleSpace),
            ("tire_deflection", ResponseGroup::TireLoad),
            ("tire_force_front_left", ResponseGroup::TireLoad),
            ("actuator_force_rear", ResponseGroup::Force),
            ("hook_height", ResponseGroup::Other),
        ] {
            assert_eq!(ResponseGroup::of(case), expected, "{case}");
        }
    }
}
