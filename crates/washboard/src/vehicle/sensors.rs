//! Where a sensor on a vehicle looks: the row over q of its displacement.

use super::{Vehicle, VehicleError};
use crate::signal::{Channel, Direction, Place, Quantity, WheelPlace};

impl Vehicle {
    /// The row over q whose `derivative`-th time derivative a channel measures, and that derivative.
    ///
    /// Body and hub accelerometers (or velocity, displacement) along z; gyroscopes of the body about x (roll) and y
    /// (pitch). A place `at_m` is in the recording's frame, which is laid on the vehicle's by the first wheels.
    ///
    /// # Errors
    /// A place that the model does not have.
    pub fn sensor_row(
        &self,
        channel: &Channel,
        wheels: &[WheelPlace],
    ) -> Result<(Vec<f64>, usize), VehicleError> {
        let refuse = |expected: &'static str, found: String| VehicleError::Field {
            field: format!("channel `{}`", channel.name),
            expected,
            found,
        };
        let derivative = match channel.quantity {
            Quantity::Displacement => 0,
            Quantity::Velocity | Quantity::AngularVelocity => 1,
            Quantity::Acceleration => 2,
        };
        if channel.quantity == Quantity::AngularVelocity {
            let name = match (channel.direction, channel.place) {
                (Direction::PlusX, Place::Body | Place::Cab) => "roll_displacement",
                (Direction::PlusY, Place::Body | Place::Cab) => "pitch_displacement",
                (d, p) => {
                    return Err(refuse("a gyroscope of the body about x or y", format!("{d:?} on {p:?}")));
                }
            };
            return Ok((self.output(name)?.q[0].clone(), derivative));
        }
        if channel.direction != Direction::PlusZ {
            let found = format!("{:?}", channel.direction);
            return Err(refuse("a channel along z: these models move vertically", found));
        }
        let row = match (channel.place, channel.wheel, channel.at_m) {
            (Place::Hub, Some(w), _) => self.corner_row(&["unsprung"], w, wheels)?,
            (Place::Body, Some(w), _) => self.corner_row(&["body", "sprung"], w, wheels)?,
            (Place::Cab, Some(w), _) => self.corner_row(&["cabin", "body", "sprung"], w, wheels)?,
            (Place::Body | Place::Cab, None, Some(at)) => self.body_point(at, wheels)?,
            (Place::Suspension, Some(w), _) => {
                // the output is body less hub; a channel of place `suspension` is hub less body: compression is +z
                let name = self.corner_name("suspension_travel", w, wheels)?;
                self.output(&name)?.q[0].iter().map(|v| -v).collect()
            }
            (place, ..) => {
                return Err(refuse(
                    "place body (with wheel or at_m), hub or suspension (with wheel)",
                    format!("{place:?} without a wheel or at_m that fits it"),
                ));
            }
        };
        Ok((row, derivative))
    }

    /// The vehicle's wheel that a wheel of a recording is: by name where the names agree, else by place.
    ///
    /// # Errors
    /// A wheel that cannot be matched.
    pub fn match_wheel(&self, index: usize, wheels: &[WheelPlace]) -> Result<usize, VehicleError> {
        let plain = |s: &str| s.replace(['-', '_', ' '], "").to_lowercase();
        if let Some(i) = self.wheels().iter().position(|w| plain(&w.name) == plain(&wheels[index].name)) {
            return Ok(i);
        }
        let shift = self.frame_shift(wheels);
        let at = wheels[index].at_m;
        let distance = |w: &super::Wheel| (at[0] + shift[0] - w.at_m[0]).hypot(at[1] + shift[1] - w.at_m[1]);
        let nearest = (0..self.wheels().len())
            .min_by(|a, b| distance(&self.wheels()[*a]).total_cmp(&distance(&self.wheels()[*b])));
        match nearest {
            Some(i) if wheels.len() == self.wheels().len() => Ok(i),
            _ => Err(VehicleError::Field {
                field: format!("wheel `{}`", wheels[index].name),
                expected: "the name of one of the vehicle's wheels",
                found: self.wheels().iter().map(|w| w.name.as_str()).collect::<Vec<_>>().join(", "),
            }),
        }
    }

    /// A place of the recording's frame as seen from the c.g.
    #[must_use]
    pub fn in_frame(&self, at_m: [f64; 2], wheels: &[WheelPlace]) -> [f64; 2] {
        let shift = self.frame_shift(wheels);
        [at_m[0] + shift[0], at_m[1] + shift[1]]
    }

    fn corner_name(&self, base: &str, index: usize, wheels: &[WheelPlace]) -> Result<String, VehicleError> {
        let wheel = self.match_wheel(index, wheels)?;
        let corner = &self.wheels()[wheel].name;
        let full = format!("{base}_{corner}");
        // models of one wheel have no corner in their names
        Ok(if self.outputs().iter().any(|o| o.name == full) { full } else { base.to_owned() })
    }

    fn corner_row(
        &self,
        bodies: &[&str],
        wheel: usize,
        wheels: &[WheelPlace],
    ) -> Result<Vec<f64>, VehicleError> {
        let mut last = None;
        for body in bodies {
            let name = self.corner_name(&format!("{body}_displacement"), wheel, wheels)?;
            match self.output(&name) {
                Ok(output) => return Ok(output.q[0].clone()),
                Err(e) => last = Some(e),
            }
        }
        Err(last.unwrap_or_else(|| VehicleError::Field {
            field: "place".into(),
            expected: "a body",
            found: "none".into(),
        }))
    }

    /// z(x, y) = z_G − xθ + yφ.
    fn body_point(&self, at: [f64; 2], wheels: &[WheelPlace]) -> Result<Vec<f64>, VehicleError> {
        let shift = self.frame_shift(wheels);
        let (x, y) = (at[0] + shift[0], at[1] + shift[1]);
        let mut row = self.output("heave_displacement")?.q[0].clone();
        for (name, weight) in [("pitch_displacement", -x), ("roll_displacement", y)] {
            if let Ok(output) = self.output(name) {
                row.iter_mut().zip(&output.q[0]).for_each(|(r, v)| *r += weight * v);
            }
        }
        Ok(row)
    }

    /// What is added to a place of the recording to have it from the c.g.: the foremost axle and the middle of the
    /// tracks are laid on each other.
    fn frame_shift(&self, wheels: &[WheelPlace]) -> [f64; 2] {
        let front = |at: &[[f64; 2]]| at.iter().map(|p| p[0]).fold(f64::NEG_INFINITY, f64::max);
        let middle = |at: &[[f64; 2]]| {
            let y = at.iter().map(|p| p[1]);
            0.5 * (y.clone().fold(f64::NEG_INFINITY, f64::max) + y.fold(f64::INFINITY, f64::min))
        };
        if wheels.is_empty() || self.wheels().is_empty() {
            return [0.0, 0.0];
        }
        let theirs: Vec<[f64; 2]> = wheels.iter().map(|w| w.at_m).collect();
        let ours = self.wheel_places();
        [front(&ours) - front(&theirs), middle(&ours) - middle(&theirs)]
    }
}
