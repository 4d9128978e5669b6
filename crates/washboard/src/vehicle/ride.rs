//! A vehicle on a road: spectra, rms and covariance of its outputs.

use super::driven::{Driven, Growth, sources};
use super::{Output, Vehicle};
use crate::linalg::{C64, CMat, Integral, LinalgError, Mat, eigen, expm, integrate, lyapunov};
use crate::road::{Coherence, Road, wheel_spectrum, wheel_spectrum_without_delayed};
use std::f64::consts::{PI, TAU};
use thiserror::Error;

/// Relative accuracy of variances by quadrature.
const QUADRATURE_TOLERANCE: f64 = 1e-9;
/// Relative accuracy of the size that cancellations are judged by.
const ROUGH_TOLERANCE: f64 = 1e-3;
/// Relative accuracy of the tail beyond, itself a small share of the whole.
const TAIL_TOLERANCE: f64 = 1e-7;
/// A variance below this share of what the wheels would give on roads of their own is zero but for rounding: the roll of
/// a symmetric car whose sides run on one track.
const CANCELLED_VARIANCE: f64 = 1e-12;
/// Speeds of road vehicles, with room.
const SPEEDS_M_S: [f64; 2] = [0.01, 500.0];
/// Beyond this multiple of the fastest pole the responses are power laws, and what is delayed averages out.
const TAIL_FACTOR: f64 = 300.0;
/// Evaluations that a ride may take before it gives up.
const MAX_EVALUATIONS: usize = 2_000_000;
/// Panels that follow the oscillation of delays; beyond them adaptation has to find it.
const MAX_DELAY_PANELS: f64 = 4000.0;

/// What is refused of a ride.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum RideError {
    /// The speed is not positive.
    #[error("speed_m_s: expected a positive number (0.01 to 500), found {0}")]
    Speed(f64),
    /// The vehicle has no wheels.
    #[error("the vehicle has no wheels: a road cannot drive it")]
    NoWheels,
    /// The vehicle is not stable, so that there is no stationary response.
    #[error("the vehicle has no stationary response: its pole {re:e} {im:+e}i (1/s) is not damped")]
    NotDamped {
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
    /// Linear algebra refused.
    #[error(transparent)]
    Linalg(#[from] LinalgError),
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
    road: &'a Road,
    speed_m_s: f64,
    places: Vec<[f64; 2]>,
}

impl<'a> Ride<'a> {
    /// A ride.
    ///
    /// # Errors
    /// A speed that is not positive, a vehicle without wheels or with a pole that is not damped.
    pub fn new(vehicle: &'a Vehicle, road: &'a Road, speed_m_s: f64) -> Result<Self, RideError> {
        if !(SPEEDS_M_S[0]..=SPEEDS_M_S[1]).contains(&speed_m_s) {
            return Err(RideError::Speed(speed_m_s));
        }
        if vehicle.wheels().is_empty() {
            return Err(RideError::NoWheels);
        }
        let a = vehicle.system().state_matrix().map_err(|_| LinalgError::Singular {
            what: "M",
            why: "the mass matrix is singular",
            value: 0.0,
        })?;
        let (poles, _) = eigen(&a)?;
        let largest = poles.iter().map(|p| p.norm()).fold(0.0, f64::max);
        // an undamped pair is computed with a real part of the order of ε |λ|max
        if let Some(p) = poles.iter().find(|p| p.re >= -1e-13 * largest) {
            return Err(RideError::NotDamped { re: p.re, im: p.im });
        }
        Ok(Ride { vehicle, road, speed_m_s, places: vehicle.wheel_places() })
    }

    /// The exact spectrum matrix of outputs at ω > 0, S_y = H* S_r Hᵀ (two-sided, unit²·s/rad).
    ///
    /// With S_ij = E\[y_i* y_j\]: what Welch's estimate of csd(y_i, y_j) tends to. Source: De Filippis et al., eq. (50).
    ///
    /// # Errors
    /// A dynamic stiffness that is singular at ω.
    pub fn spectrum(&self, outputs: &[&Output], omega_rad_s: f64) -> Result<CMat, RideError> {
        let h = self.vehicle.output_response(outputs, omega_rad_s)?;
        let s = wheel_spectrum(self.road, &self.places, omega_rad_s, self.speed_m_s);
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
        if matches!(self.road.coherence(), Coherence::Bogsjo { mu } if *mu > 0.0) {
            let known = driven.growth.iter().map(|g| infinite(*g)).collect();
            return Ok(Some(known));
        }
        let covariance = self.state_covariance(&driven, 0.0)?;
        let r = &driven.c * &covariance * driven.c.transpose();
        let q = &driven.b * driven.b.transpose();
        let apart = &driven.c * lyapunov(&driven.a, &q)?.x * driven.c.transpose();
        let clean = |v: f64, size: f64| if v <= CANCELLED_VARIANCE * size { 0.0 } else { v };
        let values = driven.growth.iter().enumerate().map(|(i, g)| match g {
            Growth::Finite => Some(Variance::Finite(clean(r[(i, i)], apart[(i, i)]))),
            other => infinite(*other),
        });
        Ok(Some(values.collect()))
    }

    /// Variances by adaptive quadrature, (1/π) ∫ S_y dω, over the road's band, or to infinity.
    ///
    /// # Errors
    /// A quadrature that does not reach its accuracy.
    pub fn variances_by_quadrature(&self, outputs: &[&Output]) -> Result<Vec<Variance>, RideError> {
        if outputs.is_empty() {
            return Ok(Vec::new());
        }
        let growth = match self.driven(outputs)? {
            Some(d) => d.growth,
            None => vec![Growth::Finite; outputs.len()],
        };
        let open: Vec<usize> = (0..outputs.len()).filter(|i| infinite(growth[*i]).is_none()).collect();
        let subset: Vec<&Output> = open.iter().map(|i| outputs[*i]).collect();
        let finite = self.integrate_spectra(&subset)?;
        let mut all: Vec<Variance> =
            growth.iter().map(|g| infinite(*g).unwrap_or(Variance::Finite(0.0))).collect();
        for (i, v) in open.into_iter().zip(finite) {
            all[i] = Variance::Finite(v);
        }
        Ok(all)
    }

    /// R_y(τ) = E\[y_i(t) y_j(t + τ)\] of outputs with finite variance.
    ///
    /// # Errors
    /// A quadrature that does not reach its accuracy; an output that is infinite gives NaN in its row and column.
    pub fn covariance(&self, outputs: &[&Output], lag_s: f64) -> Result<Mat, RideError> {
        let n = outputs.len();
        let driven = self.driven(outputs)?;
        let bogsjo = matches!(self.road.coherence(), Coherence::Bogsjo { mu } if *mu > 0.0);
        if let Some(d) = driven.as_ref().filter(|d| !bogsjo && d.growth.iter().all(|g| *g == Growth::Finite))
        {
            return Ok(&d.c * self.state_covariance(d, lag_s)? * d.c.transpose());
        }
        let growth = driven.map_or_else(|| vec![Growth::Finite; n], |d| d.growth);
        // every entry against the size of its row and column: a covariance may cross zero
        let sizes: Vec<f64> = self.variances(outputs)?.into_iter().map(|v| v.rms().unwrap_or(0.0)).collect();
        let floor: Vec<f64> =
            (0..n * n).map(|k| QUADRATURE_TOLERANCE * PI * sizes[k / n] * sizes[k % n]).collect();
        let mut scratch = CMat::zeros(n, n);
        let mut failed = None;
        let breakpoints = self.breakpoints(lag_s.abs());
        let (tail, unbounded) = self.tail();
        let integrand = |omega: f64, out: &mut [f64], averaged: bool, failed: &mut Option<RideError>| {
            match self.spectrum_or_average(outputs, omega, averaged) {
                Ok(s) => scratch = s,
                Err(e) => *failed = Some(e),
            }
            let turn = C64::new(0.0, omega * lag_s).exp();
            for i in 0..n {
                for j in 0..n {
                    out[i * n + j] = if averaged && lag_s != 0.0 { 0.0 } else { (scratch[(i, j)] * turn).re };
                }
            }
        };
        let mut integrand = integrand;
        let body = integrate(
            |w, out| integrand(w, out, false, &mut failed),
            n * n,
            &breakpoints,
            QUADRATURE_TOLERANCE,
            &floor,
            MAX_EVALUATIONS,
        );
        let mut values = body.values;
        if unbounded && lag_s == 0.0 {
            let rest = integrate(
                |u, out| {
                    integrand(tail / (1.0 - u), out, true, &mut failed);
                    out.iter_mut().for_each(|v| *v *= tail / ((1.0 - u) * (1.0 - u)));
                },
                n * n,
                &[0.0, 0.5, 1.0],
                TAIL_TOLERANCE,
                &floor,
                MAX_EVALUATIONS,
            );
            values.iter_mut().zip(rest.values).for_each(|(v, r)| *v += r);
        }
        if let Some(e) = failed {
            return Err(e);
        }
        Ok(Mat::from_fn(n, n, |i, j| {
            if infinite(growth[i]).or(infinite(growth[j])).is_some() {
                f64::NAN
            } else {
                values[i * n + j] / PI
            }
        }))
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
        Ok(Driven::new(self.vehicle, self.road, self.speed_m_s, outputs)?)
    }

    /// E\[x(t) x(t + τ)ᵀ\] of the driven state.
    fn state_covariance(&self, driven: &Driven, lag_s: f64) -> Result<Mat, RideError> {
        let size = driven.a.nrows();
        let mut sum = Mat::zeros(size, size);
        let first = self.places.iter().map(|p| p[0]).fold(f64::NEG_INFINITY, f64::max);
        let delay = |j: usize| (first - self.places[j][0]) / self.speed_m_s;
        let independent = *self.road.coherence() == Coherence::Independent;
        for group in sources(self.road.coherence(), &self.places) {
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
                let p = lyapunov(&driven.a, &q)?.x;
                let step = Mat::from_fn(size, size, |i, j| driven.a[(i, j)] * ahead.abs());
                sum += match ahead.total_cmp(&0.0) {
                    std::cmp::Ordering::Greater => expm(&step)? * p,
                    std::cmp::Ordering::Less => p * expm(&step)?.transpose(),
                    std::cmp::Ordering::Equal => p,
                };
            }
        }
        Ok(sum)
    }

    fn spectrum_or_average(
        &self,
        outputs: &[&Output],
        omega: f64,
        averaged: bool,
    ) -> Result<CMat, RideError> {
        if !averaged {
            return self.spectrum(outputs, omega);
        }
        let h = self.vehicle.output_response(outputs, omega)?;
        let s = wheel_spectrum_without_delayed(self.road, &self.places, omega, self.speed_m_s);
        Ok(h.conjugate() * s * h.transpose())
    }

    /// The diagonal of [`Ride::spectrum_or_average`] alone.
    fn auto_spectra(
        &self,
        outputs: &[&Output],
        omega: f64,
        averaged: bool,
        out: &mut [f64],
    ) -> Result<(), RideError> {
        let h = self.vehicle.output_response(outputs, omega)?;
        let under = if averaged { wheel_spectrum_without_delayed } else { wheel_spectrum };
        let s = under(self.road, &self.places, omega, self.speed_m_s);
        let w = s.nrows();
        for (i, value) in out.iter_mut().enumerate() {
            *value = 0.0;
            for a in 0..w {
                *value += h[(i, a)].norm_sqr() * s[(a, a)].re;
                for b in 0..a {
                    *value += 2.0 * (h[(i, a)].conj() * s[(a, b)] * h[(i, b)]).re;
                }
            }
        }
        Ok(())
    }

    /// (1/π) ∫ S dω of every output, and of the same were every wheel on a road of its own: what cancels is judged by.
    fn integrate_spectra(&self, outputs: &[&Output]) -> Result<Vec<f64>, RideError> {
        if outputs.is_empty() {
            return Ok(Vec::new());
        }
        let apart = self.road.with_coherence(Coherence::Independent);
        let apart = Ride {
            vehicle: self.vehicle,
            road: &apart,
            speed_m_s: self.speed_m_s,
            places: self.places.clone(),
        };
        let size = apart.integrate_to(outputs, ROUGH_TOLERANCE, &[])?.values;
        let floor: Vec<f64> = size.iter().map(|v| CANCELLED_VARIANCE * v).collect();
        let total = self.integrate_to(outputs, QUADRATURE_TOLERANCE, &floor)?;
        for (i, output) in outputs.iter().enumerate() {
            let reached = total.errors[i] / total.values[i].abs().max(floor[i]).max(f64::MIN_POSITIVE);
            // the estimate of the Gauss–Kronrod pair is pessimistic by orders of magnitude
            if !(reached <= 1e3 * QUADRATURE_TOLERANCE) && total.errors[i] > floor[i] {
                let output = output.name.clone();
                return Err(RideError::Quadrature { output, reached, expected: QUADRATURE_TOLERANCE });
            }
        }
        Ok(total.values.iter().zip(floor).map(|(v, f)| if *v <= f { 0.0 } else { v / PI }).collect())
    }

    fn integrate_to(&self, outputs: &[&Output], relative: f64, floor: &[f64]) -> Result<Integral, RideError> {
        let n = outputs.len();
        let mut failed = None;
        let mut diagonal = |omega: f64, out: &mut [f64], averaged: bool| {
            if let Err(e) = self.auto_spectra(outputs, omega, averaged, out) {
                failed = Some(e);
            }
        };
        let points = self.breakpoints(0.0);
        let mut total =
            integrate(|w, out| diagonal(w, out, false), n, &points, relative, floor, MAX_EVALUATIONS);
        let (tail, unbounded) = self.tail();
        if unbounded {
            let rest = integrate(
                |u, out| {
                    diagonal(tail / (1.0 - u), out, true);
                    out.iter_mut().for_each(|v| *v *= tail / ((1.0 - u) * (1.0 - u)));
                },
                n,
                &[0.0, 0.5, 1.0],
                TAIL_TOLERANCE.max(relative),
                floor,
                MAX_EVALUATIONS,
            );
            for i in 0..n {
                total.values[i] += rest.values[i];
                total.errors[i] += rest.errors[i];
            }
        }
        failed.map_or(Ok(total), Err)
    }

    /// Where the tail begins, and whether there is one.
    fn tail(&self) -> (f64, bool) {
        let fastest = self.pole_sizes().into_iter().fold(0.0, f64::max);
        let [_, high] = self.road.spectrum().band_rad_s(self.speed_m_s);
        (TAIL_FACTOR * fastest, high.is_infinite())
    }

    fn pole_sizes(&self) -> Vec<f64> {
        let poles = self.vehicle.system().state_matrix().ok().and_then(|a| eigen(&a).ok());
        poles.map(|(p, _)| p.iter().map(|p| p.norm()).collect()).unwrap_or_default()
    }

    /// Band edges, poles and corners, and panels that follow e^{iωτ} of the longest delay.
    fn breakpoints(&self, lag_s: f64) -> Vec<f64> {
        let [low, high] = self.road.spectrum().band_rad_s(self.speed_m_s);
        let high = if high.is_finite() { high } else { self.tail().0 };
        let mut points = vec![low, high];
        let mut corners = self.pole_sizes();
        corners.extend(self.road.spectrum().corners_rad_s(self.speed_m_s));
        points.extend(corners.iter().flat_map(|p| [0.5 * p, p * 0.9, *p, p * 1.1, 2.0 * p]));
        let ahead = self.places.iter().map(|p| p[0]).fold(f64::NEG_INFINITY, f64::max);
        let behind = self.places.iter().map(|p| p[0]).fold(f64::INFINITY, f64::min);
        let longest = (ahead - behind) / self.speed_m_s + lag_s;
        if longest > 0.0 {
            let panels = ((high - low) * longest / TAU).ceil().min(MAX_DELAY_PANELS);
            points.extend((1..panels as usize).map(|i| low + (high - low) * i as f64 / panels));
        }
        // from a wide band's bottom up by decades
        let mut decade = low.max(1e-6 * high);
        while decade < high {
            points.push(decade);
            decade *= 10.0;
        }
        points.retain(|p| *p >= low && *p <= high);
        points.sort_by(f64::total_cmp);
        points.dedup_by(|a, b| (*a - *b).abs() <= 1e-12 * high);
        points
    }
}

fn infinite(growth: Growth) -> Option<Variance> {
    match growth {
        Growth::White => Some(Variance::Infinite("white noise of the road reaches it undiminished")),
        Growth::Wandering => Some(Variance::Infinite("it follows a road height that wanders off")),
        Growth::Finite | Growth::Difference => None,
    }
}
