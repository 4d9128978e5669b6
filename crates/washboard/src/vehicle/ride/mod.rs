//! A vehicle on a road: spectra, rms and covariance of its outputs.

mod filtered;
mod quadrature;

use super::driven::{Driven, Growth, sources};
use super::{Control, ControlError, Output, Vehicle};
use crate::linalg::{C64, CMat, LinalgError, Mat, eigen, expm, lyapunov};
use crate::lti::LtiError;
use crate::road::{Coherence, Excitation};
use thiserror::Error;

/// A variance below this share of what the wheels would give on roads of their own is zero but for rounding: the roll of
/// a symmetric car whose sides run on one track.
const CANCELLED_VARIANCE: f64 = 1e-12;
/// Speeds of road vehicles, with room.
const SPEEDS_M_S: [f64; 2] = [0.01, 500.0];

/// What is refused of a ride.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum RideError {
    /// The speed is not positive.
    #[error("speed_m_s: expected a positive number (0.01 to 500), found {0}")]
    Speed(f64),
    /// The vehicle has no wheels.
    #[error("the vehicle has no wheels: a road cannot drive it")]
    NoWheels,
    /// A filter of other road inputs than the vehicle's.
    #[error(
        "the road: expected a filter of {expected} points, as many as the vehicle has road inputs, found {found}"
    )]
    Points {
        /// Wheels.
        expected: usize,
        /// Rows of C.
        found: usize,
    },
    /// The vehicle is not stable, so that there is no stationary response.
    #[error("the vehicle has no stationary response: its pole {re:e} {im:+e}i (1/s) is not damped")]
    NotDamped {
        /// Real part of the pole.
        re: f64,
        /// Imaginary part of the pole.
        im: f64,
    },
    /// The loop of vehicle and controller is not stable.
    #[error("the loop with this controller is not stable: its pole {re:e} {im:+e}i (1/s) is not damped")]
    LoopNotDamped {
        /// Real part of the pole.
        re: f64,
        /// Imaginary part of the pole.
        im: f64,
    },
    /// The quadrature did not reach its accuracy.
    #[error(
        "the quadrature of {output} reached a relative error of {reached:e} only (expected {expected:e})"
    )]
    Quadrature {
        /// The worst output.
        output: String,
        /// What it reached.
        reached: f64,
        /// What it should reach.
        expected: f64,
    },
    /// A controller that can't be used on this road.
    #[error(transparent)]
    Control(Box<ControlError>),
    /// A system that can't be built.
    #[error(transparent)]
    Lti(#[from] LtiError),
    /// Linear algebra refused.
    #[error(transparent)]
    Linalg(#[from] LinalgError),
}

impl From<ControlError> for RideError {
    fn from(e: ControlError) -> Self {
        RideError::Control(Box::new(e))
    }
}

/// The variance of an output.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Variance {
    /// A finite one, in the output's unit squared.
    Finite(f64),
    /// Infinite for this road, and why.
    Infinite(&'static str),
}

impl Variance {
    /// √ of a finite variance.
    #[must_use]
    pub fn rms(self) -> Option<f64> {
        match self {
            Variance::Finite(v) => Some(v.max(0.0).sqrt()),
            Variance::Infinite(_) => None,
        }
    }
}

/// A vehicle at a speed on a road.
#[derive(Debug, Clone)]
pub struct Ride<'a> {
    vehicle: &'a Vehicle,
    road: Excitation<'a>,
    speed_m_s: f64,
    places: Vec<[f64; 2]>,
    control: Option<&'a Control>,
    /// Every wheel as if on a road of its own: sizes that cancellations are judged by.
    apart: bool,
    /// Filters behind the outputs of an integral.
    behind: Option<&'a filtered::Behind>,
}

impl<'a> Ride<'a> {
    /// A ride.
    ///
    /// # Errors
    /// A speed that is not positive, a vehicle without wheels or with a pole that is not damped, a filter of another number of
    /// points than the vehicle has wheels.
    pub fn new(
        vehicle: &'a Vehicle,
        road: impl Into<Excitation<'a>>,
        speed_m_s: f64,
    ) -> Result<Self, RideError> {
        let ride = Self::standing(vehicle, road.into(), speed_m_s)?;
        ride.check_damped()?;
        Ok(ride)
    }

    fn standing(vehicle: &'a Vehicle, road: Excitation<'a>, speed_m_s: f64) -> Result<Self, RideError> {
        if !(SPEEDS_M_S[0]..=SPEEDS_M_S[1]).contains(&speed_m_s) {
            return Err(RideError::Speed(speed_m_s));
        }
        if vehicle.wheels().is_empty() {
            return Err(RideError::NoWheels);
        }
        if let Excitation::Points(filter) = road
            && filter.size() != vehicle.wheels().len()
        {
            return Err(RideError::Points { expected: vehicle.wheels().len(), found: filter.size() });
        }
        let places = vehicle.wheel_places();
        Ok(Ride { vehicle, road, speed_m_s, places, control: None, apart: false, behind: None })
    }

    /// A ride with a controller in its loop.
    ///
    /// # Errors
    /// As [`Ride::new`], of the closed loop.
    pub fn controlled(
        vehicle: &'a Vehicle,
        road: impl Into<Excitation<'a>>,
        speed_m_s: f64,
        control: &'a Control,
    ) -> Result<Self, RideError> {
        // a vehicle that only its controller damps may ride
        let ride = Self::standing(vehicle, road.into(), speed_m_s)?;
        let ride = Ride { control: Some(control), ..ride };
        ride.check_damped()?;
        Ok(ride)
    }

    /// Poles of the vehicle, or of the loop.
    fn poles(&self) -> Result<Vec<C64>, RideError> {
        if let Some(control) = self.control {
            return Ok(control.poles().to_vec());
        }
        let a = self.vehicle.system().state_matrix().map_err(|_| LinalgError::Singular {
            what: "M",
            why: "the mass matrix is singular",
            value: 0.0,
        })?;
        Ok(eigen(&a)?.0)
    }

    fn check_damped(&self) -> Result<(), RideError> {
        let poles = self.poles()?;
        let largest = poles.iter().map(|p| p.norm()).fold(0.0, f64::max);
        // an undamped pair is computed with a real part of the order of ε |λ|max
        match poles.iter().find(|p| p.re >= -1e-13 * largest) {
            Some(p) if self.control.is_some() => Err(RideError::LoopNotDamped { re: p.re, im: p.im }),
            Some(p) => Err(RideError::NotDamped { re: p.re, im: p.im }),
            None => Ok(()),
        }
    }

    /// Responses of outputs per road height (outputs × wheels).
    ///
    /// # Errors
    /// A dynamic stiffness that is singular at ω.
    pub fn response(&self, outputs: &[&Output], omega_rad_s: f64) -> Result<CMat, LinalgError> {
        match self.control {
            Some(control) => control.output_response(self.vehicle, outputs, omega_rad_s),
            None => self.vehicle.output_response(outputs, omega_rad_s),
        }
    }

    /// The exact spectrum matrix of outputs at ω > 0, S_y = H* S_r Hᵀ (two-sided, unit²·s/rad).
    ///
    /// With S_ij = E\[y_i* y_j\]: what Welch's estimate of csd(y_i, y_j) tends to. Source: De Filippis et al., eq. (50).
    ///
    /// # Errors
    /// A dynamic stiffness that is singular at ω.
    pub fn spectrum(&self, outputs: &[&Output], omega_rad_s: f64) -> Result<CMat, RideError> {
        let h = self.response(outputs, omega_rad_s)?;
        let s = self.road.spectrum(&self.places, omega_rad_s, self.speed_m_s);
        Ok(h.conjugate() * s * h.transpose())
    }

    /// Variances by the state space of a rational road where there is one, else by quadrature.
    ///
    /// # Errors
    /// A quadrature that does not reach its accuracy.
    pub fn variances(&self, outputs: &[&Output]) -> Result<Vec<Variance>, RideError> {
        let exact = self.variances_by_lyapunov(outputs)?;
        let open: Vec<usize> =
            (0..outputs.len()).filter(|i| exact.as_ref().is_none_or(|e| e[*i].is_none())).collect();
        let subset: Vec<&Output> = open.iter().map(|i| outputs[*i]).collect();
        let integrated = self.variances_by_quadrature(&subset)?;
        let mut all: Vec<Option<Variance>> = exact.unwrap_or_else(|| vec![None; outputs.len()]);
        for (i, v) in open.into_iter().zip(integrated) {
            all[i] = Some(v);
        }
        Ok(all.into_iter().flatten().collect())
    }

    /// Variances by Lyapunov equations, exact delays included: None for a road that is not rational; an entry is None
    /// where only quadrature gives it.
    ///
    /// For wheels i, j on one track with delays δ_i ≤ δ_j, E\[x_i x_jᵀ\] = e^{A(δ_j − δ_i)} P_ij with
    /// A P_ij + P_ij Aᵀ + b_i b_jᵀ = 0.
    ///
    /// # Errors
    /// A Lyapunov equation without a solution.
    pub fn variances_by_lyapunov(
        &self,
        outputs: &[&Output],
    ) -> Result<Option<Vec<Option<Variance>>>, RideError> {
        let Some(driven) = self.driven(outputs)? else { return Ok(None) };
        if self.is_bogsjo() {
            let known = driven.growth.iter().map(|g| infinite(*g)).collect();
            return Ok(Some(known));
        }
        let covariance = self.state_covariance(&driven, 0.0)?;
        let r = &driven.c * &covariance * driven.c.transpose();
        let apart = self.sizes(&driven, outputs)?;
        let clean = |v: f64, size: f64| {
            let least = CANCELLED_VARIANCE * size;
            let zero = v.abs() <= least;
            // a variance below zero is none: the equation's rounding is larger than it
            (v > least || zero).then_some(Variance::Finite(if zero { 0.0 } else { v }))
        };
        let values = driven.growth.iter().enumerate().map(|(i, g)| match g {
            Growth::Finite => clean(r[(i, i)], apart[i]),
            other => infinite(*other),
        });
        Ok(Some(values.collect()))
    }

    /// Variances with every wheel on a road of its own.
    fn sizes(&self, driven: &Driven, outputs: &[&Output]) -> Result<Vec<f64>, RideError> {
        let of = |driven: &Driven| -> Result<Vec<f64>, RideError> {
            let q = &driven.b * driven.b.transpose();
            let r = &driven.c * lyapunov(&driven.a, &q)?.x * driven.c.transpose();
            Ok((0..outputs.len()).map(|i| r[(i, i)]).collect())
        };
        let wheels = self.places.len();
        let filter = match self.road {
            Excitation::Road(_) => return of(driven),
            Excitation::Points(_) => self.road.wheel_filter(wheels, self.speed_m_s),
        };
        let mut sum = vec![0.0; outputs.len()];
        for wheel in 0..wheels {
            let Some(filter) = filter.as_ref().map(|f| f.of_wheel(wheel)) else { return of(driven) };
            let one = self.closed(outputs, |all| {
                let mut one = Driven::by(self.vehicle, &filter, &[], all)?;
                // one wheel alone may have white noise that cancels among all: its state's part is what counts
                one.growth.fill(Growth::Finite);
                Ok(Some(one))
            })?;
            let one = one.map(Driven::balanced).transpose()?;
            let one = one.as_ref().map_or_else(|| of(driven), of)?;
            sum.iter_mut().zip(one).for_each(|(s, v)| *s += v);
        }
        Ok(sum)
    }

    fn is_bogsjo(&self) -> bool {
        let coherence = self.road.road().map(|r| r.coherence());
        matches!(coherence, Some(Coherence::Bogsjo { mu }) if *mu > 0.0)
    }

    /// For each output, why its variance is infinite on this road, or None.
    ///
    /// # Errors
    /// A system that cannot be solved.
    pub fn infinite(&self, outputs: &[&Output]) -> Result<Vec<Option<&'static str>>, RideError> {
        let why = |g: Growth| match infinite(g) {
            Some(Variance::Infinite(why)) => Some(why),
            _ => None,
        };
        Ok(self
            .driven(outputs)?
            .map_or_else(|| vec![None; outputs.len()], |d| d.growth.into_iter().map(why).collect()))
    }

    fn driven(&self, outputs: &[&Output]) -> Result<Option<Driven>, RideError> {
        let driven =
            self.closed(outputs, |all| Ok(Driven::new(self.vehicle, self.road, self.speed_m_s, all)?))?;
        Ok(driven.map(Driven::balanced).transpose()?)
    }

    /// What is driven, in its loop where there is a controller.
    fn closed(
        &self,
        outputs: &[&Output],
        driven: impl FnOnce(&[&Output]) -> Result<Option<Driven>, RideError>,
    ) -> Result<Option<Driven>, RideError> {
        let Some(control) = self.control else { return driven(outputs) };
        let all: Vec<&Output> = outputs.iter().copied().chain(control.measurements()).collect();
        let open = driven(&all)?;
        Ok(open.map(|open| control.close(self.vehicle, open)).transpose()?)
    }

    /// E\[x(t) x(t + τ)ᵀ\] of the driven state.
    fn state_covariance(&self, driven: &Driven, lag_s: f64) -> Result<Mat, RideError> {
        let size = driven.a.nrows();
        let mut sum = Mat::zeros(size, size);
        let stepped = |p: Mat, ahead: f64| -> Result<Mat, RideError> {
            let step = Mat::from_fn(size, size, |i, j| driven.a[(i, j)] * ahead.abs());
            Ok(match ahead.total_cmp(&0.0) {
                std::cmp::Ordering::Greater => expm(&step)? * p,
                std::cmp::Ordering::Less => p * expm(&step)?.transpose(),
                std::cmp::Ordering::Equal => p,
            })
        };
        let Some(road) = self.road.road() else {
            let q = &driven.b * driven.b.transpose();
            return stepped(lyapunov(&driven.a, &q)?.x, -lag_s);
        };
        let first = self.places.iter().map(|p| p[0]).fold(f64::NEG_INFINITY, f64::max);
        let delay = |j: usize| (first - self.places[j][0]) / self.speed_m_s;
        let independent = *road.coherence() == Coherence::Independent;
        for group in sources(road.coherence(), &self.places) {
            // Lyapunov's equation is linear: one solve for each distinct delay between two wheels of a group
            let mut pairs: Vec<(f64, Mat)> = Vec::new();
            for &i in &group {
                for &j in &group {
                    let ahead = if independent { -lag_s } else { delay(j) - delay(i) - lag_s };
                    let product = Mat::from_fn(size, size, |r, c| driven.b[(r, i)] * driven.b[(c, j)]);
                    match pairs.iter_mut().find(|(d, _)| (*d - ahead).abs() < 1e-15) {
                        Some((_, q)) => *q += product,
                        None => pairs.push((ahead, product)),
                    }
                }
            }
            for (ahead, q) in pairs {
                sum += stepped(lyapunov(&driven.a, &q)?.x, ahead)?;
            }
        }
        Ok(sum)
    }
}

fn infinite(growth: Growth) -> Option<Variance> {
    match growth {
        Growth::White => Some(Variance::Infinite("white noise of the road reaches it undiminished")),
        Growth::Wandering => Some(Variance::Infinite("it follows a road height that wanders off")),
        Growth::Finite | Growth::Difference => None,
    }
}
