//! Rates of outputs, and what actuators do: their forces and the velocities that these work on.

use super::{Output, Vehicle};

impl Output {
    /// dy/dt; none of a force, or of what is an acceleration already.
    #[must_use]
    pub fn rate(&self) -> Option<Output> {
        let moves = |rows: &[Vec<f64>; 3]| rows[2].iter().any(|v| *v != 0.0);
        if moves(&self.q) || moves(&self.r) || self.u.iter().any(|v| *v != 0.0) {
            return None;
        }
        let unit = match self.unit {
            "m" => "m/s",
            "m/s" => "m/s²",
            "rad" => "rad/s",
            "rad/s" => "rad/s²",
            _ => return None,
        };
        let later = |rows: &[Vec<f64>; 3]| [vec![], rows[0].clone(), rows[1].clone()];
        let named = |n: &str| format!("{n}_rate");
        Some(Output {
            name: named(&self.name),
            base: named(&self.base),
            unit,
            q: later(&self.q),
            r: later(&self.r),
            u: vec![],
        })
    }
}

impl Vehicle {
    /// An actuator's force, N, and the velocity that it works on, so that their product is the power that it gives.
    ///
    /// With its column b of generalised forces that velocity is bᵀq̇. Where a chassis moves the vehicle and does not feel it, b has
    /// the end on the vehicle alone, and the travel of the same place has the other one.
    ///
    /// None for an actuator that the vehicle has not.
    #[must_use]
    pub fn port(&self, actuator: usize) -> Option<[Output; 2]> {
        let super::Actuator { name, column } = self.actuators().get(actuator)?;
        let own = |i: usize| f64::from(u8::from(i == actuator));
        let none = || [vec![], vec![], vec![]];
        let named = |what: &str, unit, q, r, u| {
            let name = format!("{what}_{name}");
            Output { base: name.clone(), name, unit, q, r, u }
        };
        let forces = (0..self.actuators().len()).map(own).collect();
        let force = named("force", "N", none(), none(), forces);
        let apart = self.beyond_chassis(name, column);
        let (q, r) = apart.unwrap_or_else(|| (column.clone(), vec![]));
        let velocity = named("velocity", "m/s", [vec![], q, vec![]], [vec![], r, vec![]], vec![]);
        Some([force, velocity])
    }

    /// The rows over q̇ and ṙ of an actuator's travel, taken the other way, where it differs from its column by chassis points alone.
    fn beyond_chassis(&self, name: &str, column: &[f64]) -> Option<(Vec<f64>, Vec<f64>)> {
        let place = format!("suspension_travel_{name}");
        let travel = self.outputs().iter().find(|o| o.name == place && o.unit == "m")?;
        let chassis = |i: usize| self.dofs()[i].starts_with("chassis_");
        let extends = |(i, v): (usize, &f64)| -v == column[i] || (column[i] == 0.0 && chassis(i));
        let other = |row: &Vec<f64>| row.iter().map(|v| -v).collect::<Vec<f64>>();
        let extends = travel.q[0].len() == column.len() && travel.q[0].iter().enumerate().all(extends);
        extends.then(|| (other(&travel.q[0]), other(&travel.r[0])))
    }
}

#[cfg(test)]
mod tests {
    use crate::vehicle::test_cases as cases;

    #[test]
    fn the_velocity_of_a_cars_actuator_is_that_of_its_travel_the_other_way() {
        // a positive force pulls body and wheel together
        for case in ["turkay-quarter-car", "turkay-half-car", "chalasani-full-car"] {
            let car = cases::vehicle(case).unwrap();
            let travels = car.outputs().iter().filter(|o| o.base == "suspension_travel");
            for (i, travel) in travels.enumerate() {
                let [force, velocity] = car.port(i).unwrap();
                let rate = travel.rate().unwrap();
                assert_eq!((rate.unit, velocity.unit), ("m/s", "m/s"));
                assert!(rate.q[1].iter().zip(&velocity.q[1]).all(|(a, b)| *a == -*b) && rate.q[0].is_empty());
                assert_eq!((force.u[i], force.u.iter().sum::<f64>()), (1.0, 1.0));
            }
            assert!(car.port(car.actuators().len()).is_none());
            let [force, velocity] = car.port(0).unwrap();
            assert!(force.rate().is_none() && velocity.rate().unwrap().rate().is_none());
        }
    }
}
