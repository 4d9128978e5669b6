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
        let names: Vec<&str> = self.passive.rms.iter().map(|(name, _)| name).collect();
        let is_corner_of =
            |name: &str, base: &str| name.strip_prefix(base).is_some_and(|rest| rest.starts_with('_'));
        let closed = self.verified.as_ref();
        let row = |name| ResponseRow {
            group: ResponseGroup::of(name),
            name,
            corner_of: names.iter().copied().find(|base| is_corner_of(name, base)),
            unit: self.units.get(name).map_or("", String::as_str),
            rms: [self.passive.rms.get(name).copied(), closed.and_then(|c| c.rms.get(name)).copied()],
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
