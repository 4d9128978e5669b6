//! A vehicle at rest under its own weight.

use super::{Output, Vehicle};
use crate::linalg::{LinalgError, Mat, solve};

/// Standard gravity, m/s².
///
/// Source: 3rd General Conference on Weights and Measures (1901).
pub const GRAVITY_M_S2: f64 = 9.806_65;

impl Vehicle {
    /// Values of outputs at rest on a level road under the vehicle's weight, from the unloaded springs on.
    ///
    /// With all wheels lifted by 1 m the vehicle rises by e = K⁻¹K_w·1, and no spring feels it; a mass that rises with it weighs
    /// f = −g M e in the coordinates q, whatever these are, and K q = f. The weight of it all is g eᵀM e.
    ///
    /// # Errors
    /// A K that can't be solved with: a rigid motion that no wheel holds.
    pub fn at_rest(&self, outputs: &[&Output]) -> Result<Vec<f64>, LinalgError> {
        let k = self.system().k();
        let lifted = Mat::from_fn(self.wheels().len(), 1, |_, _| 1.0);
        let rise = solve(k, &(self.wheel_stiffness() * lifted))?;
        let weight = self.system().m() * rise;
        let weight = Mat::from_fn(weight.nrows(), 1, |i, _| -GRAVITY_M_S2 * weight[(i, 0)]);
        let q = solve(k, &weight)?;
        let value = |o: &&Output| o.q[0].iter().enumerate().map(|(i, v)| v * q[(i, 0)]).sum();
        Ok(outputs.iter().map(value).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vehicle::test_cases as cases;

    fn loads(case: &str) -> (Vec<String>, Vec<f64>) {
        let car = cases::vehicle(case).unwrap();
        let forces: Vec<&Output> = car.outputs().iter().filter(|o| o.base == "tire_force").collect();
        let found = car.at_rest(&forces).unwrap();
        (forces.iter().map(|o| o.name.clone()).collect(), found.iter().map(|f| -f).collect())
    }

    #[test]
    fn axle_loads_are_those_of_the_levers() {
        // a body on two axles: m_s g l₂/(l₁ + l₂) on the front one, and the wheel's own weight
        let spec = cases::spec("turkay-half-car").half_car.unwrap();
        let (_, found) = loads("turkay-half-car");
        let (l1, l2) = (spec.front_axle_m, spec.rear_axle_m);
        let share = [l2 / (l1 + l2), l1 / (l1 + l2)];
        for (i, axle) in [&spec.front, &spec.rear].into_iter().enumerate() {
            let known = GRAVITY_M_S2 * (share[i] * spec.sprung_mass_kg + axle.unsprung_mass_kg.sides()[0]);
            assert!((found[i] / known - 1.0).abs() < 1e-12, "{} {known}", found[i]);
        }
    }

    #[test]
    fn all_tires_together_carry_the_whole_weight() {
        let spec = cases::spec("chalasani-full-car").full_car.unwrap();
        let wheels: f64 =
            [&spec.front, &spec.rear].iter().map(|a| a.unsprung_mass_kg.sides().iter().sum::<f64>()).sum();
        let (names, found) = loads("chalasani-full-car");
        let weight = GRAVITY_M_S2 * (spec.sprung_mass_kg + wheels);
        assert!((found.iter().sum::<f64>() / weight - 1.0).abs() < 1e-12, "{found:?} {weight}");
        assert!(names.len() == 4 && (found[0] - found[1]).abs() < 1e-9 * found[0], "left and right alike");
        let quarter = cases::spec("turkay-quarter-car").quarter_car.unwrap();
        let known = GRAVITY_M_S2 * (quarter.sprung_mass_kg + quarter.unsprung_mass_kg);
        assert!((loads("turkay-quarter-car").1[0] / known - 1.0).abs() < 1e-12);
    }
}
