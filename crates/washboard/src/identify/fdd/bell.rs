//! A mode's bell in the spectrum, its correlation, and the resonance that has them.

use super::decomposition::{Blocks, Mean};
use crate::linalg::{C64, CMat, Mat, solve_complex, symmetric_eigenvalues};
use realfft::{RealFftPlanner, RealToComplex};
use std::f64::consts::{PI, TAU};
use std::ops::RangeInclusive;
use std::sync::Arc;

/// The taper's cosine takes this part of the bell at each end: a sharp end would ring through all lags.
const EDGE: f64 = 0.25;
/// Lags start where the kernel of the tapered bell has died, so many inverse widths after zero …
const FIRST_LAG: f64 = 1.0;
/// … and end where the correlation has fallen to this part of its first, or the window's to the other.
const LAST_LEVEL: f64 = 0.15;
const LAST_WINDOW: f64 = 0.15;
/// Lags of a regression.
const POINTS: usize = 64;
/// The regression covers at least this many cycles.
const FEWEST_CYCLES: f64 = 1.0;
/// Shapes whose Gram matrix has a smaller eigenvalue are too alike for a modal filter.
const INDEPENDENT: f64 = 0.1;

/// Where the bell is, what filters it out, and what its window does.
pub(super) struct Bell {
    bins: RangeInclusive<usize>,
    taper: Vec<f64>,
    filter: Vec<C64>,
    segment: usize,
    rate_hz: f64,
    transform: Arc<dyn RealToComplex<f64>>,
}

/// The lags of a regression, s.
pub(super) struct Range {
    lags_s: Vec<f64>,
    peak_hz: f64,
    start: [f64; 2],
}

impl Bell {
    /// The bell of mode k of these shapes.
    pub fn new(bins: RangeInclusive<usize>, shapes: &[&[C64]], k: usize, blocks: &Blocks) -> Self {
        let count = bins.end() - bins.start() + 1;
        let edge = (EDGE * count as f64).max(1.0);
        let taper = (0..count).map(|i| {
            let inside = (i as f64 + 0.5).min(count as f64 - i as f64 - 0.5);
            if inside >= edge { 1.0 } else { 0.5 - 0.5 * (PI * inside / edge).cos() }
        });
        Self {
            taper: taper.collect(),
            bins,
            filter: modal_filter(shapes, k),
            segment: blocks.segment,
            rate_hz: blocks.rate_hz,
            transform: RealFftPlanner::<f64>::new().plan_fft_forward(blocks.segment),
        }
    }

    /// b = aᴴ-filtered power E|aᵀy|² at the bell's bins.
    pub fn of(&self, mean: &Mean<'_>) -> Vec<f64> {
        let a = &self.filter;
        let n = a.len();
        self.bins
            .clone()
            .map(|k| {
                let s = mean.at(k);
                (0..n * n).map(|ij| (a[ij / n].conj() * s[(ij / n, ij % n)] * a[ij % n]).re).sum()
            })
            .collect()
    }

    /// R(τ) = Σ taper · b e^{iωτ}.
    fn correlation(&self, spectrum: &[f64], lag_s: f64) -> C64 {
        let bin_rad_s = TAU * self.rate_hz / self.segment as f64;
        let turn = C64::new(0.0, bin_rad_s * lag_s).exp();
        let mut at = C64::new(0.0, bin_rad_s * lag_s * *self.bins.start() as f64).exp();
        let mut sum = C64::new(0.0, 0.0);
        for (b, t) in spectrum.iter().zip(&self.taper) {
            sum += at * (b * t);
            at *= turn;
        }
        sum
    }

    /// ρ(τ) = Σ w(t)w(t + τ)/Σ w² of Hann's window, closed form.
    fn window(&self, lag_s: f64) -> f64 {
        let x = lag_s * self.rate_hz / self.segment as f64;
        if x >= 1.0 { 0.0 } else { (1.0 - x) * (2.0 + (TAU * x).cos()) / 3.0 + (TAU * x).sin() / TAU }
    }

    /// Decay in 1/s and phase rate in rad/s by regression over the lags, with weights |R|².
    fn slopes(&self, spectrum: &[f64], range: &Range) -> [f64; 2] {
        let turn = |lag: f64| C64::new(0.0, -TAU * range.peak_hz * lag).exp();
        let mut decay = Regression::default();
        let mut phase = Regression::default();
        let mut unwrapped: Option<f64> = None;
        for &lag in &range.lags_s {
            let r = self.correlation(spectrum, lag);
            let weight = r.norm_sqr();
            let angle = (r * turn(lag)).arg();
            // the branch nearest to the lag before
            let angle = unwrapped.map_or(angle, |before| angle + TAU * ((before - angle) / TAU).round());
            unwrapped = Some(angle);
            decay.add(weight, lag, (r.norm() / self.window(lag)).max(f64::MIN_POSITIVE).ln());
            phase.add(weight, lag, angle);
        }
        [-decay.slope(), TAU * range.peak_hz + phase.slope()]
    }

    /// f and ζ of the resonance whose spectrum under the same window, bell and taper has the slopes of this one; or why
    /// there is none.
    pub fn resonance(&self, spectrum: &[f64], range: &Range) -> Result<[f64; 2], String> {
        const STEPS: usize = 40;
        const CONVERGED: f64 = 1e-9;
        let measured = self.slopes(spectrum, range);
        let mut guess = range.start;
        for _ in 0..STEPS {
            let model = self.slopes(&self.model(guess), range);
            let step = [measured[0] - model[0], measured[1] - model[1]];
            guess = [guess[0] + step[0], guess[1] + step[1]];
            if !(guess[0] > 0.0 && guess[1] > 0.0) {
                return Err(
                    "its damping cannot be had: the bell decays no faster than the window alone".into()
                );
            }
            if step[0].hypot(step[1]) <= CONVERGED * guess[1] {
                let omega = guess[0].hypot(guess[1]);
                return Ok([omega / TAU, guess[0] / omega]);
            }
        }
        Err("its damping cannot be had: no resonance has the slopes of this bell".into())
    }

    /// The bell of R(τ) = e^{−στ} cos ω_d τ under the window: its transform at the bell's bins.
    fn model(&self, [sigma, omega_d]: [f64; 2]) -> Vec<f64> {
        let n = self.segment;
        let r = |k: usize| {
            let t = k as f64 / self.rate_hz;
            (-sigma * t).exp() * (omega_d * t).cos() * self.window(t)
        };
        let mut folded = self.transform.make_input_vec();
        let mut spectrum = self.transform.make_output_vec();
        for (k, x) in folded.iter_mut().enumerate() {
            *x = if k == 0 { r(0) } else { r(k) + r(n - k) };
        }
        // lengths are those of the plan, so this can't fail
        let done = self.transform.process(&mut folded, &mut spectrum);
        debug_assert!(done.is_ok());
        self.bins.clone().map(|k| spectrum[k].re).collect()
    }
}

impl Range {
    /// Lags between the death of the bell's kernel and that of the mode or the window.
    pub fn new(bell: &Bell, spectrum: &[f64], peak_hz: f64, width_hz: f64) -> Result<Self, String> {
        let bin_hz = bell.rate_hz / bell.segment as f64;
        let bell_hz = bell.taper.len() as f64 * bin_hz;
        let first = FIRST_LAG / bell_hz;
        let start = bell.correlation(spectrum, first).norm() / bell.window(first).max(f64::MIN_POSITIVE);
        let step = 1.0 / (16.0 * bell_hz);
        let mut last = first;
        while bell.window(last + step) > LAST_WINDOW
            && bell.correlation(spectrum, last + step).norm() > LAST_LEVEL * start * bell.window(last + step)
        {
            last += step;
        }
        let cycles = (last - first) * peak_hz;
        if cycles < FEWEST_CYCLES {
            return Err(format!(
                "its damping cannot be had: the bell of {bell_hz:.3} Hz leaves {cycles:.1} cycles of decay, {FEWEST_CYCLES} is needed"
            ));
        }
        let at = |k: usize| first + (last - first) * k as f64 / (POINTS - 1) as f64;
        let sigma = (PI * width_hz).max(1e-4 * TAU * peak_hz);
        Ok(Self { lags_s: (0..POINTS).map(at).collect(), peak_hz, start: [sigma, TAU * peak_hz] })
    }
}

/// a with aᵀφ_k = 1, and aᵀφ_s = 0 for the other shapes where all of them are independent.
fn modal_filter(shapes: &[&[C64]], k: usize) -> Vec<C64> {
    let alone = || shapes[k].iter().map(|s| s.conj()).collect();
    let (n, count) = (shapes[k].len(), shapes.len());
    if count > n {
        return alone();
    }
    let gram = CMat::from_fn(count, count, |r, s| {
        shapes[r].iter().zip(shapes[s]).map(|(a, b)| a.conj() * b).sum::<C64>()
    });
    // the eigenvalues of a Hermitian matrix are those of [Re −Im; Im Re], twice
    let real = Mat::from_fn(2 * count, 2 * count, |i, j| match (i < count, j < count) {
        (true, true) => gram[(i, j)].re,
        (true, false) => -gram[(i, j - count)].im,
        (false, true) => gram[(i - count, j)].im,
        (false, false) => gram[(i - count, j - count)].re,
    });
    let least = symmetric_eigenvalues(&real).ok().and_then(|v| v.first().copied());
    if !least.is_some_and(|v| v >= INDEPENDENT) {
        return alone();
    }
    // aᵀ = row k of (ΦᴴΦ)⁻¹Φᴴ
    let unit = CMat::from_fn(count, 1, |i, _| C64::new(f64::from(u8::from(i == k)), 0.0));
    let Ok(row) = solve_complex(&gram.transpose().to_owned(), &unit) else { return alone() };
    (0..n).map(|i| (0..count).map(|s| row[(s, 0)] * shapes[s][i].conj()).sum()).collect()
}

/// A weighted straight line.
#[derive(Default)]
struct Regression {
    weight: f64,
    x: f64,
    y: f64,
    xx: f64,
    xy: f64,
}

impl Regression {
    fn add(&mut self, w: f64, x: f64, y: f64) {
        self.weight += w;
        self.x += w * x;
        self.y += w * y;
        self.xx += w * x * x;
        self.xy += w * x * y;
    }

    fn slope(&self) -> f64 {
        let square = self.weight * self.xx - self.x * self.x;
        (self.weight * self.xy - self.x * self.y) / square.max(f64::MIN_POSITIVE)
    }
}
