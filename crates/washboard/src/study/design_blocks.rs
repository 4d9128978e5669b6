//! A design's problem seen by blocks of outputs, and the same goal of a vehicle with other fields.

use super::design_problem::{GoalBlock, PeakBlock, Problem};
use super::{Named, StudyError};
use crate::lti::{GeneralizedPlant, LtiError};
use crate::vehicle::{Output, PlantSettings};

impl Problem {
    /// The plant whose performances are the goals, weighted over their passive norms.
    pub fn weighted(&self) -> Result<GeneralizedPlant, LtiError> {
        let mut names: Vec<&str> = Vec::new();
        let mut factors = Vec::new();
        for goal in &self.goals {
            for i in &goal.members {
                names.push(&self.reported[*i].name);
                factors.push(goal.weight / goal.passive);
            }
        }
        let y: Vec<&str> = self.measurements.iter().map(|o| o.name.as_str()).collect();
        self.plant.select(&names, &y)?.with_weights(&factors)
    }

    /// The measurements as they were asked for, or the states that were chosen.
    pub fn asked_measurements(&self) -> Vec<String> {
        if self.spec.measurements.is_empty() {
            return self.measurements.iter().map(|o| o.name.clone()).collect();
        }
        self.spec.measurements.clone()
    }

    /// Whether anything is minimised, or only bounded.
    pub fn has_objective(&self) -> bool {
        !self.goals.is_empty() || self.peaks.iter().any(|p| p.block.weight > 0.0)
    }

    /// Stacked vectors and single outputs, in the vehicle's order.
    pub fn blocks(&self) -> Vec<(String, Vec<usize>)> {
        let mut blocks: Vec<(String, Vec<usize>)> = Vec::new();
        for (i, output) in self.reported.iter().enumerate() {
            if output.base != output.name && !blocks.iter().any(|(n, _)| *n == output.base) {
                let members = (0..self.reported.len()).filter(|k| self.reported[*k].base == output.base);
                blocks.push((output.base.clone(), members.collect()));
            }
            blocks.push((output.name.clone(), vec![i]));
        }
        for (name, own) in self.spec.goal.groups.iter() {
            let member =
                |i: &usize| own.contains(&self.reported[*i].name) || own.contains(&self.reported[*i].base);
            let members: Vec<usize> = (0..self.reported.len()).filter(member).collect();
            if !members.is_empty() {
                blocks.push((name.to_owned(), members));
            }
        }
        blocks
    }

    /// The same goal of the vehicle with other fields: norms over the same passive ones, and only outputs of the goal.
    ///
    /// # Errors
    /// Fields that the vehicle does not have, values that make none.
    pub fn at(&self, fields: &[(String, f64)]) -> Result<Problem, StudyError> {
        let name = &self.spec.vehicle;
        let of_file = |source| StudyError::Vehicle { name: name.clone(), source };
        let file = self.file.with_overrides(fields).map_err(of_file)?;
        let vehicle = self.ground.vehicle(&file, self.chassis.as_ref()).map_err(of_file)?;
        let own = |blocks: Vec<&GoalBlock>| {
            blocks.into_iter().flat_map(|g| g.members.clone()).collect::<Vec<usize>>()
        };
        let all = self.goals.iter().chain(&self.bounded).chain(self.peaks.iter().map(|p| &p.block));
        let wanted = own(all.collect());
        let costs = |i: &usize| self.spec.input_weight > 0.0 && self.reported[*i].base == "actuator_force";
        let kept: Vec<usize> = (0..self.reported.len()).filter(|i| wanted.contains(i) || costs(i)).collect();
        let find = |o: &Output| vehicle.output(&o.name).cloned();
        let reported =
            kept.iter().map(|i| find(&self.reported[*i])).collect::<Result<Vec<_>, _>>().map_err(of_file)?;
        let measurements =
            self.measurements.iter().map(find).collect::<Result<Vec<_>, _>>().map_err(of_file)?;
        let plant = vehicle
            .plant(
                &reported.iter().collect::<Vec<_>>(),
                &measurements.iter().collect::<Vec<_>>(),
                &self.settings(),
            )
            .map_err(|source| StudyError::Plant { name: name.clone(), source: Box::new(source) })?;
        let moved = |g: &GoalBlock| {
            let members = g.members.iter().filter_map(|m| kept.iter().position(|k| k == m)).collect();
            GoalBlock { members, ..g.clone() }
        };
        Ok(Problem {
            goals: self.goals.iter().map(moved).collect(),
            bounded: self.bounded.iter().map(moved).collect(),
            peaks: self.peaks.iter().map(|p| PeakBlock { block: moved(&p.block), bound: p.bound }).collect(),
            file,
            vehicle,
            reported,
            measurements,
            plant,
            ..self.clone()
        })
    }

    fn settings(&self) -> PlantSettings<'_> {
        PlantSettings {
            road: self.ground.excitation(),
            speed_m_s: self.spec.speed_m_s,
            disturbance: self.spec.disturbance.into(),
            delay_order: self.spec.delay_order,
        }
    }

    /// Units of stacked vectors and single outputs.
    pub fn units(&self) -> Named<String> {
        let unit = |(name, members): (String, Vec<usize>)| {
            let unit = members.first().map_or("", |i| self.reported[*i].unit);
            let alike = members.iter().all(|i| self.reported[*i].unit == unit);
            (name, if alike { unit } else { "mixed" }.to_owned())
        };
        let mut units: Named<String> = self.blocks().into_iter().map(unit).collect();
        for output in &self.measurements {
            units.insert(&output.name, output.unit.to_owned());
        }
        units
    }
}
