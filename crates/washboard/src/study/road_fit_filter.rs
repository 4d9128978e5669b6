//! A shaping filter that a road can be: strictly proper where it shapes height.

use crate::linalg::{C64, CMat, Mat, eigen, solve, solve_complex};
use crate::lti::{Continuous, StateSpace};
use crate::subspace::{ShapeFit, SubspaceError, log10_errors};

/// A filter with fewer states for the low-pass is taken if its log₁₀ error is below this (rounding), or no more than this many times
/// the error of one with more.
const NEGLIGIBLE: f64 = 1e-7;
const AS_NEAR: f64 = 1.01;
/// The same where poles were moved: that alone changes the density nearest to a pole by 1e-4.
const MOVED: f64 = 5e-5;
/// Zeros beyond this many times the band's upper end are at infinity: they change the response by the inverse.
const FAR: f64 = 1e8;
/// Poles beyond this many times the band's upper end are made of what a fit leaves: no sample shows them.
const FAR_POLE: f64 = 30.0;

/// A filter as it is written, and the fit that it came from.
#[derive(Debug)]
pub(super) struct RoadFilter {
    pub system: StateSpace<Continuous>,
    pub poles: Vec<C64>,
    /// Of a scalar filter.
    pub zeros: Vec<C64>,
    /// Of a scalar filter, above 0.
    pub gain: Option<f64>,
    pub roll_off_rad: Option<f64>,
    /// How many times the low-pass was allowed for; 0 where a feedthrough stays.
    pub passes: usize,
    /// Root mean square of log₁₀ of the filter's over the given trace at the samples: of what is written, its low-pass among it.
    pub log10_rms_error: f64,
    /// Its largest magnitude.
    pub log10_max_error: f64,
    pub fit: ShapeFit,
}

impl RoadFilter {
    /// The filter of a spectrum `scale`² as large.
    pub fn times(mut self, scale: f64) -> Result<Self, SubspaceError> {
        if scale != 1.0 {
            let m = self.system.inputs();
            self.system = self.system.times(&Mat::from_fn(m, m, |i, j| if i == j { scale } else { 0.0 }))?;
            self.gain = self.gain.map(|k| k * scale);
        }
        Ok(self)
    }

    /// Poles far beyond the band, by [`FAR_POLE`].
    pub fn far_poles(&self) -> Vec<C64> {
        let far = FAR_POLE * self.fit.band_rad[1];
        self.poles.iter().copied().filter(|p| p.norm() > far).collect()
    }

    /// The share of the variance that the filter's part of these poles has: Σ tr(Rᵢ Rⱼᴴ)/−(pᵢ + p̄ⱼ) of their residues over that of all. None
    /// where poles are repeated, or where the filter keeps a feedthrough.
    pub fn share_of(&self, poles: &[C64]) -> Option<f64> {
        let g = &self.system;
        if g.d().norm_l2() > 0.0 {
            return None;
        }
        let (values, vectors) = eigen(g.a()).ok()?;
        let complex = |m: &Mat| CMat::from_fn(m.nrows(), m.ncols(), |i, j| C64::new(m[(i, j)], 0.0));
        let (seen, driven) = (complex(g.c()) * &vectors, solve_complex(&vectors, &complex(g.b())).ok()?);
        let variance = |kept: &dyn Fn(C64) -> bool| -> f64 {
            let of: Vec<usize> = (0..values.len()).filter(|k| kept(values[*k])).collect();
            let pair = |i: usize, j: usize| {
                let left: C64 = (0..seen.nrows()).map(|k| seen[(k, i)] * seen[(k, j)].conj()).sum();
                let right: C64 = (0..driven.ncols()).map(|k| driven[(i, k)] * driven[(j, k)].conj()).sum();
                (left * right / -(values[i] + values[j].conj())).re
            };
            of.iter().flat_map(|i| of.iter().map(move |j| (*i, *j))).map(|(i, j)| pair(i, j)).sum()
        };
        let least = poles.iter().map(|p| p.norm()).fold(f64::INFINITY, f64::min) * (1.0 - 1e-6);
        let share = variance(&|p| p.norm() >= least) / variance(&|_| true);
        share.is_finite().then_some(share)
    }
}

/// The log₁₀ error up to which a filter of this fit is as near to the samples as one of error `nearest`.
pub(super) fn as_near(fit: &ShapeFit, nearest: f64) -> f64 {
    let rounding = if fit.model.summand.folded > 0 { MOVED } else { NEGLIGIBLE };
    (AS_NEAR * nearest).max(rounding)
}

/// G(s)(ω_r/(s + ω_r))ᵏ.
fn passed(
    mut g: StateSpace<Continuous>,
    corner: f64,
    passes: usize,
) -> Result<StateSpace<Continuous>, SubspaceError> {
    let m = g.outputs();
    let eye = |v: f64| Mat::from_fn(m, m, |i, j| if i == j { v } else { 0.0 });
    let low_pass = StateSpace::continuous(eye(-corner), eye(corner), eye(1.0), Mat::zeros(m, m))?;
    for _ in 0..passes {
        g = g.series(&low_pass)?;
    }
    Ok(g)
}

/// A system and, of a scalar one, its finite zeros.
type WithZeros = (StateSpace<Continuous>, Vec<C64>);

/// The samples that filters are held against.
pub(super) struct Band<'a> {
    pub omega: &'a [f64],
    pub s: &'a [CMat],
    /// Their upper end.
    pub high: f64,
}

impl Band<'_> {
    /// The fit with the low-pass passed k times, once less where that can be.
    pub fn rolled(&self, fit: ShapeFit, corner: f64, passes: usize) -> Result<RoadFilter, SubspaceError> {
        if let Some((system, zeros)) = self.without_one(&fit, corner, passes)? {
            let appended = passes > 1;
            return self.finished(system, zeros, appended.then_some(corner), passes, fit);
        }
        let (system, zeros) = (passed(fit.filter.clone(), corner, passes)?, fit.zeros.clone());
        self.finished(system, zeros, Some(corner), passes, fit)
    }

    /// G(s) c/(s + c) = C(sI − A)⁻¹B′ + c G(−c)/(s + c) with B′ = c(A + cI)⁻¹B: strictly proper without another state where G(−c) is rounding, as it
    /// is where the samples are of a strictly proper filter. Taken where it follows the samples as well and is minimum phase. The other k − 1
    /// low-passes stay: behind a strictly proper filter they make C B exactly 0, and no velocity is white.
    fn without_one(&self, fit: &ShapeFit, c: f64, passes: usize) -> Result<Option<WithZeros>, SubspaceError> {
        let g = &fit.filter;
        let n = g.order();
        let shifted = Mat::from_fn(n, n, |i, j| g.a()[(i, j)] + if i == j { c } else { 0.0 });
        // a pole at −c itself
        let Ok(b) = solve(&shifted, g.b()) else { return Ok(None) };
        let none = Mat::zeros(g.outputs(), g.inputs());
        let proper = StateSpace::continuous(g.a().clone(), b * faer::Scale(c), g.c().clone(), none)?;
        let system = passed(proper, c, passes.saturating_sub(1))?;
        if !(self.log10_errors(&system)?[0] <= as_near(fit, fit.log10_rms_error)) {
            return Ok(None);
        }
        let far = FAR * self.high;
        let zeros: Vec<C64> = system.zeros()?.into_iter().filter(|z| z.norm() < far).collect();
        if !zeros.iter().all(|z| z.re < 0.0) {
            return Ok(None);
        }
        Ok(Some((system, if g.outputs() == 1 { zeros } else { Vec::new() })))
    }

    /// Root mean square and largest magnitude of log₁₀ of fitted over given trace.
    fn log10_errors(&self, g: &StateSpace<Continuous>) -> Result<[f64; 2], SubspaceError> {
        let traces: Vec<f64> = self.s.iter().map(|s| (0..s.nrows()).map(|i| s[(i, i)].re).sum()).collect();
        let errors = log10_errors(g, self.omega, &traces)?;
        let rms = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len().max(1) as f64).sqrt();
        Ok([rms, errors.iter().map(|e| e.abs()).fold(0.0, f64::max)])
    }

    /// States scaled, roots sorted, the gain made positive.
    pub fn finished(
        &self,
        system: StateSpace<Continuous>,
        zeros: Vec<C64>,
        roll_off_rad: Option<f64>,
        passes: usize,
        fit: ShapeFit,
    ) -> Result<RoadFilter, SubspaceError> {
        let (mut system, _) = system.balanced_scales()?;
        let sorted = |mut roots: Vec<C64>| {
            roots.sort_by(|a, b| a.norm().total_cmp(&b.norm()).then(a.im.total_cmp(&b.im)));
            roots
        };
        let (poles, zeros) = (sorted(system.poles()?), sorted(zeros));
        let mut gain = None;
        if system.outputs() == 1 {
            let s = C64::new(0.0, self.high);
            let product = |roots: &[C64]| roots.iter().map(|r| s - r).product::<C64>();
            let found = (system.at(s)?[(0, 0)] * product(&poles) / product(&zeros)).re;
            if found < 0.0 {
                system = system.times(&Mat::from_fn(1, 1, |_, _| -1.0))?;
            }
            gain = Some(found.abs());
        }
        let [log10_rms_error, log10_max_error] = self.log10_errors(&system)?;
        Ok(RoadFilter {
            system,
            poles,
            zeros,
            gain,
            roll_off_rad,
            passes,
            log10_rms_error,
            log10_max_error,
            fit,
        })
    }
}
