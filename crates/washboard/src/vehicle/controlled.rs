//! A controller on a vehicle: its signals by name, and what the loop does to responses.

use super::driven::{Driven, Growth};
use super::{Output, Vehicle, VehicleError};
use crate::linalg::{C64, CMat, LinalgError, Mat, solve, solve_complex};
use crate::lti::{Continuous, LtiError, Responder, StateSpace};
use thiserror::Error;

/// u = +K y between named outputs and named actuators of a vehicle.
#[derive(Debug, Clone)]
pub struct Control {
    controller: StateSpace<Continuous>,
    measurements: Vec<Output>,
    /// Columns of the vehicle's actuators, in the order of the controller's outputs.
    actuators: Vec<usize>,
    poles: Vec<C64>,
    /// From the controller's outputs to its inputs, by the vehicle.
    back: Responder<Continuous>,
    law: Responder<Continuous>,
}

/// What is refused of a controller on a vehicle.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum ControlError {
    /// A signal that the vehicle does not have.
    #[error(transparent)]
    Vehicle(#[from] VehicleError),
    /// Names that are not as many as the controller's signals.
    #[error("controller.{what}: expected {expected} names, found {found}")]
    Names {
        /// `inputs` or `outputs`.
        what: &'static str,
        /// Its signals.
        expected: usize,
        /// Names given.
        found: usize,
    },
    /// A measurement that contains white noise of the road.
    #[error(
        "the measurement `{0}` contains white noise of this road: a controller cannot use it; take another road or measurement"
    )]
    White(String),
    /// A measurement that wanders off with the road's height.
    #[error(
        "the measurement `{0}` follows a road height that wanders off: a controller cannot use it; take a road of kind first-order, or another measurement"
    )]
    Wanders(String),
    /// The loop is not well posed, or a factorisation failed.
    #[error(transparent)]
    Lti(#[from] LtiError),
    /// Linear algebra refused.
    #[error(transparent)]
    Linalg(#[from] LinalgError),
}

impl Control {
    /// A controller with the names of its inputs (outputs of the vehicle) and outputs (its actuators).
    ///
    /// # Errors
    /// Numbers of names that do not fit, names that the vehicle does not have, a loop that is not well posed.
    pub fn new(
        vehicle: &Vehicle,
        controller: StateSpace<Continuous>,
        inputs: &[String],
        outputs: &[String],
    ) -> Result<Self, ControlError> {
        for (what, expected, found) in
            [("inputs", controller.inputs(), inputs.len()), ("outputs", controller.outputs(), outputs.len())]
        {
            if expected != found {
                return Err(ControlError::Names { what, expected, found });
            }
        }
        let measurements =
            inputs.iter().map(|n| vehicle.output(n).cloned()).collect::<Result<Vec<_>, _>>()?;
        let known = vehicle.actuators();
        let find = |name: &String| {
            known.iter().position(|a| a.name == *name).ok_or_else(|| VehicleError::Unknown {
                what: "actuator",
                name: name.clone(),
                suggestion: crate::files::nearest(name, known.iter().map(|a| a.name.as_str()))
                    .map(str::to_owned),
                known: known.iter().map(|a| a.name.as_str()).collect::<Vec<_>>().join(", "),
            })
        };
        let actuators = outputs.iter().map(find).collect::<Result<Vec<_>, _>>()?;
        let seen: Vec<&Output> = measurements.iter().collect();
        let back = vehicle.actuated(&seen, &actuators)?;
        let poles = back.feedback(&controller)?.poles()?;
        let (back, law) = (back.responder()?, controller.responder()?);
        Ok(Control { controller, measurements, actuators, poles, back, law })
    }

    /// Poles of vehicle and controller in their loop, 1/s.
    #[must_use]
    pub fn poles(&self) -> &[C64] {
        &self.poles
    }

    /// K.
    #[must_use]
    pub fn controller(&self) -> &StateSpace<Continuous> {
        &self.controller
    }

    /// The vehicle's actuators that its outputs drive, in their order.
    #[must_use]
    pub fn actuators(&self) -> &[usize] {
        &self.actuators
    }

    /// What the controller measures.
    #[must_use]
    pub fn measurements(&self) -> &[Output] {
        &self.measurements
    }

    /// Responses of outputs per road height (outputs × wheels) in the closed loop:
    /// G_zr + G_zu K (I − G_yu K)⁻¹ G_yr.
    ///
    /// # Errors
    /// A pole exactly at ω.
    pub fn output_response(
        &self,
        vehicle: &Vehicle,
        outputs: &[&Output],
        omega_rad_s: f64,
    ) -> Result<CMat, LinalgError> {
        let (p, m) = (outputs.len(), self.measurements.len());
        let all: Vec<&Output> = outputs.iter().copied().chain(&self.measurements).collect();
        let open = vehicle.output_response(&all, omega_rad_s)?;
        let (z, y) = (open.submatrix(0, 0, p, open.ncols()), open.submatrix(p, 0, m, open.ncols()));
        let at = |r: &Responder<Continuous>| {
            r.at_frequency(omega_rad_s).map_err(|_| LinalgError::Singular {
                what: "G(iω)",
                why: "a pole stands exactly at the frequency asked for",
                value: omega_rad_s,
            })
        };
        let k = at(&self.law)?;
        let loop_ = CMat::identity(m, m) - at(&self.back)? * &k;
        let u = k * solve_complex(&loop_, &y.to_owned())?;
        // the vehicle's own response to these forces
        let columns = vehicle.actuator_columns(&self.actuators);
        let force = CMat::from_fn(columns.nrows(), columns.ncols(), |i, j| C64::new(columns[(i, j)], 0.0));
        let q = solve_complex(&vehicle.system().dynamic_stiffness(omega_rad_s), &(force * &u))?;
        let iw = C64::new(0.0, omega_rad_s);
        let powers = [C64::new(1.0, 0.0), iw, iw * iw];
        Ok(CMat::from_fn(p, open.ncols(), |i, j| {
            let o = outputs[i];
            let from_q: C64 = (0..3)
                .map(|d| powers[d] * o.q[d].iter().enumerate().map(|(k, v)| q[(k, j)] * *v).sum::<C64>())
                .sum();
            let direct = |(l, a): (usize, &usize)| u[(l, j)] * o.u.get(*a).copied().unwrap_or(0.0);
            z[(i, j)] + from_q + self.actuators.iter().enumerate().map(direct).sum::<C64>()
        }))
    }

    /// The loop closed around a driven vehicle whose last outputs are the measurements, in their order.
    pub(super) fn close(&self, vehicle: &Vehicle, open: Driven) -> Result<Driven, ControlError> {
        let m = self.measurements.len();
        let p = open.c.nrows() - m;
        for (k, output) in self.measurements.iter().enumerate() {
            match open.growth[p + k] {
                Growth::Finite | Growth::Difference => {}
                Growth::White => return Err(ControlError::White(output.name.clone())),
                Growth::Wandering => return Err(ControlError::Wanders(output.name.clone())),
            }
        }
        // what measures a difference of heights that wander hands it to the rest: by quadrature only
        let by_quadrature = open.growth[p..].contains(&Growth::Difference);
        let growth = open.growth[..p].iter().map(|g| match g {
            Growth::Finite if by_quadrature => Growth::Difference,
            other => *other,
        });
        let growth = growth.collect();
        let whole = open.with_forces(vehicle, &self.actuators)?;
        // controllers have states in units of their own
        let closed = whole.lft(&self.controller)?.balanced_scales()?.0;
        Ok(Driven {
            a: closed.a().clone(),
            b: closed.b().clone(),
            c: closed.c().clone(),
            growth,
            outputs: open.outputs[..p].to_vec(),
        })
    }
}

impl Vehicle {
    /// From forces of actuators to outputs, the road standing still: state [q, q̇].
    ///
    /// # Errors
    /// A mass matrix that can't be solved with.
    pub fn actuated(
        &self,
        outputs: &[&Output],
        actuators: &[usize],
    ) -> Result<StateSpace<Continuous>, ControlError> {
        let n = self.system().order();
        let a = self.system().state_matrix().map_err(VehicleError::from)?;
        let force = solve(self.system().m(), &self.actuator_columns(actuators))?;
        let b = Mat::from_fn(2 * n, actuators.len(), |i, j| if i < n { 0.0 } else { force[(i - n, j)] });
        let own = |q: &[f64], i: usize| q.get(i).copied().unwrap_or(0.0);
        let row = |o: &Output, m: &Mat, j: usize| -> f64 {
            o.q[2].iter().enumerate().map(|(k, v)| v * m[(n + k, j)]).sum()
        };
        let c = Mat::from_fn(outputs.len(), 2 * n, |i, j| {
            let direct = if j < n { own(&outputs[i].q[0], j) } else { own(&outputs[i].q[1], j - n) };
            direct + row(outputs[i], &a, j)
        });
        let d = Mat::from_fn(outputs.len(), actuators.len(), |i, j| {
            own(&outputs[i].u, actuators[j]) + row(outputs[i], &b, j)
        });
        Ok(StateSpace::continuous(a, b, c, d)?)
    }

    /// Generalised forces per force of some actuators.
    pub(super) fn actuator_columns(&self, actuators: &[usize]) -> Mat {
        Mat::from_fn(self.system().order(), actuators.len(), |i, j| self.actuators()[actuators[j]].column[i])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::road::Coherence;
    use crate::vehicle::test_cases as cases;
    use crate::vehicle::{Disturbance, PlantSettings, Ride};

    /// A skyhook-like law from body velocity and travel, with a filter so that it has states.
    fn control(car: &Vehicle, y: &[&str], u: &[&str]) -> Control {
        let (p, m) = (y.len(), u.len());
        let a = Mat::from_fn(2, 2, |i, j| [[-30.0, 5.0], [0.0, -80.0]][i][j]);
        let b = Mat::from_fn(2, p, |i, j| (1.0 + i as f64 + 2.0 * j as f64).sin());
        let c = Mat::from_fn(m, 2, |i, j| 900.0 * (0.4 + i as f64 + j as f64).cos());
        let d = Mat::from_fn(m, p, |i, j| 150.0 * (2.0 + i as f64 - j as f64).sin());
        let k = StateSpace::continuous(a, b, c, d).unwrap();
        let names = |n: &[&str]| n.iter().map(|s| (*s).to_owned()).collect::<Vec<_>>();
        Control::new(car, k, &names(y), &names(u)).unwrap()
    }

    #[test]
    fn three_routes_to_the_rms_of_a_closed_loop_agree() {
        // Lyapunov with exact delays, quadrature of mechanics and K, and the generalised plant's H2 norm
        for (case, road, y, u, z) in [
            (
                "turkay-quarter-car",
                "turkay-white-velocity",
                vec!["suspension_travel"],
                vec!["actuator"],
                vec!["sprung_acceleration", "suspension_travel", "tire_deflection", "actuator_force"],
            ),
            (
                "turkay-half-car",
                "turkay-first-order",
                vec!["suspension_travel_front", "heave_velocity"],
                vec!["front", "rear"],
                vec!["heave_acceleration", "suspension_travel_rear", "actuator_force_front"],
            ),
        ] {
            let car = cases::vehicle(case).unwrap();
            let road = cases::road(road).unwrap().with_coherence(Coherence::Independent);
            let k = control(&car, &y, &u);
            assert!(k.poles().iter().all(|p| p.re < 0.0), "{:?}", k.poles());
            let outputs: Vec<&Output> = z.iter().map(|n| car.output(n).unwrap()).collect();
            let measured: Vec<&Output> = k.measurements().iter().collect();
            let ride = Ride::controlled(&car, &road, 20.0, &k).unwrap();
            let exact = ride.variances_by_lyapunov(&outputs).unwrap().unwrap();
            let integral = ride.variances_by_quadrature(&outputs).unwrap();
            let settings = PlantSettings {
                road: (&road).into(),
                speed_m_s: 20.0,
                disturbance: Disturbance::RoadNoise,
                delay_order: 2,
            };
            let plant = car.plant(&outputs, &measured, &settings).unwrap();
            let h2 = plant.close(&k.controller).unwrap().h2_of_outputs().unwrap();
            for i in 0..outputs.len() {
                let (a, b) = (exact[i].unwrap().rms().unwrap(), integral[i].rms().unwrap());
                assert!((a / b - 1.0).abs() < 1e-7, "{case} {}: {a} {b}", z[i]);
                assert!((a / h2[i] - 1.0).abs() < 1e-9, "{case} {}: {a} {}", z[i], h2[i]);
            }
        }
    }

    #[test]
    fn a_controller_of_nothing_changes_nothing_and_wrong_names_are_refused() {
        let car = cases::vehicle("turkay-half-car").unwrap();
        let road = cases::road("iso8608-c").unwrap();
        let names = |n: &[&str]| n.iter().map(|s| (*s).to_owned()).collect::<Vec<_>>();
        let zero = || StateSpace::continuous_gain(Mat::zeros(2, 1)).unwrap();
        let k = Control::new(&car, zero(), &names(&["heave_velocity"]), &names(&["front", "rear"])).unwrap();
        let z = [car.output("heave_acceleration").unwrap()];
        let with = Ride::controlled(&car, &road, 20.0, &k).unwrap().variances(&z).unwrap();
        let without = Ride::new(&car, &road, 20.0).unwrap().variances(&z).unwrap();
        let (a, b) = (with[0].rms().unwrap(), without[0].rms().unwrap());
        assert!((a / b - 1.0).abs() < 1e-14, "{a} {b}");
        let refused = |y: &[&str], u: &[&str]| {
            Control::new(&car, zero(), &names(y), &names(u)).unwrap_err().to_string()
        };
        assert!(refused(&["heave_velocty"], &["front", "rear"]).contains("did you mean `heave_velocity`"));
        assert!(refused(&["heave_velocity"], &["front", "raer"]).contains("no actuator `raer`"));
        assert!(refused(&[], &["front", "rear"]).contains("controller.inputs: expected 1 names, found 0"));
    }

    #[test]
    fn a_loop_that_is_not_stable_is_no_ride() {
        let car = cases::vehicle("turkay-quarter-car").unwrap();
        let road = cases::road("iso8608-c").unwrap();
        let push = StateSpace::continuous_gain(Mat::from_fn(1, 1, |_, _| -1e6)).unwrap();
        let names = |n: &str| vec![n.to_owned()];
        let k = Control::new(&car, push, &names("suspension_travel"), &names("actuator")).unwrap();
        let e = Ride::controlled(&car, &road, 20.0, &k).unwrap_err().to_string();
        assert!(e.contains("the loop with this controller is not stable"), "{e}");
    }
}
