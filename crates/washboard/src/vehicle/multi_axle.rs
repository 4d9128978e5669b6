//! A rigid body on any number of axles of one or two wheels: numbers under names, written as a vehicle of model `matrices`.

use super::body::{BodyOnCorners, Corner};
use super::values::{Axle, positive};
use super::{Matrices, VehicleError, VehicleSpec};
use crate::linalg::Mat;
use crate::signal::WheelPlace;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;

/// Wheels this close in x stand side by side.
const SAME_AXLE_M: f64 = 0.1;
/// Wheels this close in y are on one track.
const SAME_TRACK_M: f64 = 0.1;

/// The body and its axles, from the front: `axle_1`, `axle_2` …
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct MultiAxle {
    pub sprung_mass_kg: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pitch_inertia_kg_m2: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub roll_inertia_kg_m2: Option<f64>,
    /// The c.g. behind the foremost wheel.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub front_axle_m: Option<f64>,
    /// The c.g. left of the middle between the outermost wheels.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cg_left_m: Option<f64>,
    #[serde(flatten)]
    pub axles: BTreeMap<String, Axle>,
}

/// Wheels, and which of them make an axle.
#[derive(Debug, Clone)]
pub(super) struct Layout {
    wheels: Vec<WheelPlace>,
    /// From the front; the left wheel first.
    axles: Vec<Vec<usize>>,
}

impl Layout {
    /// Sorts wheels into axles.
    ///
    /// # Errors
    /// No wheel; more than two side by side; wheels on two tracks whose places do not hold a body upright.
    pub fn new(wheels: &[WheelPlace]) -> Result<Self, VehicleError> {
        let refuse = |expected: &'static str, found: String| VehicleError::Field {
            field: "wheel.at_m".into(),
            expected,
            found,
        };
        let x = |w: usize| wheels[w].at_m[0];
        let mut order: Vec<usize> = (0..wheels.len()).collect();
        order.sort_by(|a, b| x(*b).total_cmp(&x(*a)));
        let mut axles: Vec<Vec<usize>> = Vec::new();
        for w in order {
            match axles.last_mut().filter(|axle| x(axle[0]) - x(w) <= SAME_AXLE_M) {
                Some(axle) => axle.push(w),
                None => axles.push(vec![w]),
            }
        }
        for axle in &mut axles {
            axle.sort_by(|a, b| wheels[*b].at_m[1].total_cmp(&wheels[*a].at_m[1]));
            let names = || axle.iter().map(|w| wheels[*w].name.as_str()).collect::<Vec<_>>().join(", ");
            let apart = axle.windows(2).all(|w| wheels[w[0]].at_m[1] - wheels[w[1]].at_m[1] > SAME_TRACK_M);
            if axle.len() > 2 || !apart {
                let expected = "one or two wheels an axle (wheels within 0.1 m in x), left and right";
                return Err(refuse(expected, format!("side by side: {}", names())));
            }
        }
        let this = Layout { wheels: wheels.to_vec(), axles };
        let (pitch, roll) = (this.axles.len() > 1, this.two_tracks());
        let needed = 1 + usize::from(pitch) + usize::from(roll);
        let pairs = this.axles.iter().filter(|a| a.len() == 2).count();
        if wheels.len() < needed || (roll && pairs == 0) {
            let expected =
                "wheels that hold a body upright: one, one track, or at least one pair left and right";
            let found = wheels.iter().map(|w| format!("{} at {:?}", w.name, w.at_m)).collect::<Vec<_>>();
            return Err(refuse(expected, if found.is_empty() { "none".into() } else { found.join(", ") }));
        }
        Ok(this)
    }

    /// Wheel indices of each axle from the front, left wheels first.
    pub fn axles(&self) -> &[Vec<usize>] {
        &self.axles
    }

    pub fn wheels(&self) -> &[WheelPlace] {
        &self.wheels
    }

    fn extent(&self, coordinate: usize) -> [f64; 2] {
        let at = self.wheels.iter().map(|w| w.at_m[coordinate]);
        [at.clone().fold(f64::INFINITY, f64::min), at.fold(f64::NEG_INFINITY, f64::max)]
    }

    fn two_tracks(&self) -> bool {
        let [right, left] = self.extent(1);
        left - right > SAME_TRACK_M
    }

    /// From the foremost to the rearmost wheel, where there are two axles or more.
    pub fn wheelbase_m(&self) -> Option<f64> {
        let [rear, front] = self.extent(0);
        (self.axles.len() > 1).then_some(front - rear)
    }

    /// The narrowest distance of a left and a right wheel, where there are two tracks.
    pub fn track_m(&self) -> Option<f64> {
        let width = |axle: &Vec<usize>| match axle[..] {
            [l, r] => Some(self.wheels[l].at_m[1] - self.wheels[r].at_m[1]),
            _ => None,
        };
        self.axles.iter().filter_map(width).reduce(f64::min).filter(|_| self.two_tracks())
    }

    /// Whether an axle of this name has a left and a right wheel.
    pub fn is_pair(&self, name: &str) -> bool {
        (1..).zip(&self.axles).any(|(i, axle)| axle.len() == 2 && format!("axle_{i}") == name)
    }

    /// The vehicle file of a body with these numbers.
    ///
    /// # Errors
    /// Numbers that make none, in words.
    pub fn spec(&self, table: Value) -> Result<VehicleSpec, String> {
        let numbers: MultiAxle = serde_json::from_value(table).map_err(|e| e.to_string())?;
        Ok(VehicleSpec::from(self.matrices(&numbers).map_err(|e| e.to_string())?))
    }

    fn matrices(&self, numbers: &MultiAxle) -> Result<Matrices, VehicleError> {
        let [rear, front] = self.extent(0);
        let [right, left] = self.extent(1);
        // the c.g. in the frame of the wheels
        let from_front = numbers.front_axle_m.unwrap_or(0.0);
        let centre = [front - from_front, f64::midpoint(left, right) + numbers.cg_left_m.unwrap_or(0.0)];
        if !(rear <= centre[0] && centre[0] <= front && right <= centre[1] && centre[1] <= left) {
            let expected = "a c.g. between the wheels";
            return Err(VehicleError::Field {
                field: "c.g.".into(),
                expected,
                found: format!("{centre:?} m"),
            });
        }
        let mut coordinates = vec![("heave", "m")];
        let mut inertia = vec![numbers.sprung_mass_kg];
        for (name, value) in [("pitch", numbers.pitch_inertia_kg_m2), ("roll", numbers.roll_inertia_kg_m2)] {
            coordinates.extend(value.map(|_| (name, "rad")));
            inertia.extend(value);
        }
        for ((name, _), value) in coordinates.iter().zip(&inertia) {
            positive(if *name == "heave" { "sprung_mass_kg" } else { name }, *value)?;
        }
        let n = self.wheels.len();
        let mut corners: Vec<Option<Corner>> = (0..n).map(|_| None).collect();
        let mut spring = Mat::zeros(n, n);
        for (i, wheels) in self.axles.iter().enumerate() {
            let name = format!("axle_{}", i + 1);
            let axle = numbers.axles.get(&name).ok_or_else(|| VehicleError::Field {
                field: name.clone(),
                expected: "a table",
                found: "none".into(),
            })?;
            axle.check(&name)?;
            for (side, w) in wheels.iter().enumerate() {
                let at = self.wheels[*w].at_m;
                let (x, y) = (at[0] - centre[0], at[1] - centre[1]);
                let mut row = vec![1.0];
                row.extend(numbers.pitch_inertia_kg_m2.map(|_| -x));
                row.extend(numbers.roll_inertia_kg_m2.map(|_| y));
                corners[*w] = Some(Corner {
                    name: self.wheels[*w].name.replace(['-', ' '], "_"),
                    row,
                    at_m: [x, y],
                    damping: axle.suspension_damping_n_s_per_m.sides()[side],
                    damper_curve: None,
                    unsprung_mass: axle.unsprung_mass_kg.sides()[side],
                    tire_stiffness: axle.tire_stiffness_n_per_m.sides()[side],
                    tire_damping: axle.tire_damping_n_s_per_m.sides()[side],
                });
                spring[(*w, *w)] = axle.suspension_stiffness_n_per_m.sides()[side];
            }
            if let [l, r] = wheels[..] {
                let track = self.wheels[l].at_m[1] - self.wheels[r].at_m[1];
                let bar = axle.anti_roll_stiffness_n_m_per_rad / (track * track);
                for (a, b, sign) in [(l, l, 1.0), (r, r, 1.0), (l, r, -1.0), (r, l, -1.0)] {
                    spring[(a, b)] += sign * bar;
                }
            }
        }
        let body = BodyOnCorners {
            coordinates,
            inertia,
            corners: corners.into_iter().flatten().collect(),
            spring,
            points: vec![],
            body_feels_unsprung_velocity: true,
            patterns: vec![],
        };
        Ok(Matrices::of(&body.assemble()))
    }
}
