//! A ride's integrals over frequency: variances and covariances of any road, by adaptive quadrature.

use super::{CANCELLED_VARIANCE, Ride, RideError, Variance, infinite};
use crate::linalg::{C64, CMat, Integral, Mat, integrate};
use crate::vehicle::Output;
use crate::vehicle::driven::Growth;
use std::f64::consts::{PI, TAU};

/// Relative accuracy of variances by quadrature.
const QUADRATURE_TOLERANCE: f64 = 1e-9;
/// Relative accuracy of the size that cancellations are judged by.
const ROUGH_TOLERANCE: f64 = 1e-3;
/// Sizes that cancellations are judged by count from this share of the slowest mode's frequency on.
const SIZED_FROM: f64 = 0.01;
/// Relative accuracy of a band's part.
const BAND_TOLERANCE: f64 = 1e-6;
/// Relative accuracy of the tail beyond, itself a small share of the whole.
const TAIL_TOLERANCE: f64 = 1e-7;
/// Beyond this multiple of the fastest pole the responses are power laws, and what is delayed averages out.
const TAIL_FACTOR: f64 = 300.0;
/// Evaluations that a ride may take before it gives up.
const MAX_EVALUATIONS: usize = 2_000_000;
/// Panels that follow the oscillation of delays; beyond them adaptation has to find it.
const MAX_DELAY_PANELS: f64 = 4000.0;

impl Ride<'_> {
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

    /// The part of finite variances that a band of frequencies has, (1/π) ∫ S_y dω over it; to 10⁻⁶ of the larger.
    ///
    /// # Errors
    /// A quadrature that does not come near its accuracy.
    pub fn variances_in_band(
        &self,
        outputs: &[&Output],
        band_rad_s: [f64; 2],
    ) -> Result<Vec<f64>, RideError> {
        let [own_low, own_high] = self.road.band_rad_s(self.speed_m_s);
        let (low, high) = (band_rad_s[0].max(own_low), band_rad_s[1].min(own_high));
        if outputs.is_empty() || !(low < high) {
            return Ok(vec![0.0; outputs.len()]);
        }
        let mut points = self.breakpoints(0.0);
        points.retain(|p| *p > low && *p < high);
        points.extend([low, high]);
        points.sort_by(f64::total_cmp);
        let mut failed = None;
        let found = integrate(
            |w, out| {
                if let Err(e) = self.auto_spectra(outputs, w, false, out) {
                    failed = Some(e);
                }
            },
            outputs.len(),
            &points,
            BAND_TOLERANCE,
            &[],
            MAX_EVALUATIONS,
        );
        if let Some(e) = failed {
            return Err(e);
        }
        for (i, output) in outputs.iter().enumerate() {
            let reached = found.errors[i] / found.values[i].abs().max(f64::MIN_POSITIVE);
            if !(reached <= 1e3 * BAND_TOLERANCE) && found.values[i] > 0.0 {
                let output = output.name.clone();
                return Err(RideError::Quadrature { output, reached, expected: BAND_TOLERANCE });
            }
        }
        Ok(found.values.iter().map(|v| v / PI).collect())
    }

    /// R_y(τ) = E\[y_i(t) y_j(t + τ)\] of outputs with finite variance.
    ///
    /// # Errors
    /// A quadrature that does not reach its accuracy; an output that is infinite gives NaN in its row and column.
    pub fn covariance(&self, outputs: &[&Output], lag_s: f64) -> Result<Mat, RideError> {
        let n = outputs.len();
        let driven = self.driven(outputs)?;
        let bogsjo = self.is_bogsjo();
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

    fn spectrum_or_average(
        &self,
        outputs: &[&Output],
        omega: f64,
        averaged: bool,
    ) -> Result<CMat, RideError> {
        if !averaged {
            return self.spectrum(outputs, omega);
        }
        let h = self.response(outputs, omega)?;
        let s = self.road.spectrum_averaged(&self.places, omega, self.speed_m_s);
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
        let h = self.response(outputs, omega)?;
        let s = if averaged {
            self.road.spectrum_averaged(&self.places, omega, self.speed_m_s)
        } else {
            self.road.spectrum(&self.places, omega, self.speed_m_s)
        };
        let w = s.nrows();
        for (i, value) in out.iter_mut().enumerate() {
            *value = 0.0;
            for a in 0..w {
                *value += h[(i, a)].norm_sqr() * s[(a, a)].re;
                if self.apart {
                    continue;
                }
                for b in 0..a {
                    *value += 2.0 * (h[(i, a)].conj() * s[(a, b)] * h[(i, b)]).re;
                }
            }
            if let Some(behind) = self.behind {
                *value *= behind.power_gain(i, omega)?;
            }
        }
        Ok(())
    }

    /// (1/π) ∫ S dω of every output, and of the same were every wheel on a road of its own: what cancels is judged by.
    pub(super) fn integrate_spectra(&self, outputs: &[&Output]) -> Result<Vec<f64>, RideError> {
        if outputs.is_empty() {
            return Ok(Vec::new());
        }
        let apart = Ride { apart: true, ..self.clone() };
        // heights that wander belong together in some outputs: each alone has no size at rest
        let from = SIZED_FROM * self.slowest()?;
        let size = apart.integrate_to(outputs, from, ROUGH_TOLERANCE, &[])?.values;
        let floor: Vec<f64> = size.iter().map(|v| CANCELLED_VARIANCE * v).collect();
        let total = self.integrate_to(outputs, 0.0, QUADRATURE_TOLERANCE, &floor)?;
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

    /// The slowest mode of the vehicle itself that is no rigid motion, rad/s.
    fn slowest(&self) -> Result<f64, RideError> {
        let passive = Ride { control: None, ..self.clone() };
        let sizes: Vec<f64> = passive.poles()?.iter().map(|p| p.norm()).collect();
        let fastest = sizes.iter().copied().fold(0.0, f64::max);
        Ok(sizes.into_iter().filter(|p| *p > 1e-6 * fastest).fold(fastest, f64::min))
    }

    fn integrate_to(
        &self,
        outputs: &[&Output],
        from: f64,
        relative: f64,
        floor: &[f64],
    ) -> Result<Integral, RideError> {
        let n = outputs.len();
        let mut failed = None;
        let mut diagonal = |omega: f64, out: &mut [f64], averaged: bool| {
            if let Err(e) = self.auto_spectra(outputs, omega, averaged, out) {
                failed = Some(e);
            }
        };
        let mut points = self.breakpoints(0.0);
        if points.first().is_some_and(|p| *p < from) && points.last().is_some_and(|p| *p > from) {
            points.retain(|p| *p > from);
            points.insert(0, from);
        }
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
        let [_, high] = self.road.band_rad_s(self.speed_m_s);
        (TAIL_FACTOR * fastest, high.is_infinite())
    }

    fn pole_sizes(&self) -> Vec<f64> {
        let own: Vec<f64> = self.poles().map(|p| p.iter().map(|p| p.norm()).collect()).unwrap_or_default();
        own.into_iter().chain(self.behind.iter().flat_map(|b| b.corners_rad_s.iter().copied())).collect()
    }

    /// Band edges, poles and corners, and panels that follow e^{iωτ} of the longest delay.
    fn breakpoints(&self, lag_s: f64) -> Vec<f64> {
        let [low, high] = self.road.band_rad_s(self.speed_m_s);
        let high = if high.is_finite() { high } else { self.tail().0 };
        let mut points = vec![low, high];
        let mut corners = self.pole_sizes();
        corners.extend(self.road.corners_rad_s(self.speed_m_s));
        points.extend(corners.iter().flat_map(|p| [0.5 * p, p * 0.9, *p, p * 1.1, 2.0 * p]));
        let ahead = self.places.iter().map(|p| p[0]).fold(f64::NEG_INFINITY, f64::max);
        let behind = self.places.iter().map(|p| p[0]).fold(f64::INFINITY, f64::min);
        // a filter of all points has no delays of its own
        let apart = if self.road.road().is_some() { (ahead - behind) / self.speed_m_s } else { 0.0 };
        let longest = apart + lag_s;
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
