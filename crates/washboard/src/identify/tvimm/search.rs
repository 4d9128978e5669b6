//! The search for free modes: Levenberg–Marquardt at right angles to the similarity orbit, from loud noise to the real one.

use super::model::{Evaluation, FreeModel, Point, RATE};
use super::orbit::{Entries, complement};
use super::score;
use crate::identify::likelihood::{
    End, LEAST_NOISE, Problem, RoadValues, Score, Spectra, Stop, Whitening, descend, limits, mean,
};
use crate::linalg::Mat;
use crate::lti::FirstOrder;

/// Longest step of an entry of the balanced state space.
const STEP_ENTRY: f64 = 0.5;
/// Good enough while noise is raised.
const ROUGH_GAIN: f64 = 0.5;
const ROUGH_DECREMENT: f64 = 3.0;
/// Steps while noise is raised, and at the real noise; and as many more there where the model explains the data by then.
const MAX_STEPS: [usize; 2] = [40, 60];
const MORE_STEPS: usize = 120;
/// Second derivatives along a step are differences over this share of it, as Transtrum and Sethna have it.
const BEND: f64 = 0.1;
/// A residual statistic below this may yet become that of a right answer.
const PROMISING: f64 = 0.8;

/// One level of raised noise.
pub(super) struct Stage<'m> {
    pub model: &'m FreeModel,
    measured: Spectra,
    limits: [[f64; 2]; 4],
}

/// The coordinates at a point.
pub(super) struct Frame {
    /// Entries × free.
    pub basis: Mat,
    entries: Entries,
    pub evaluation: Evaluation,
    /// Diagonal of the entries' information.
    diagonal: Vec<f64>,
}

/// Where a search ended.
pub(super) struct Found {
    pub at: Point,
    pub score: Score,
    pub frame: Frame,
    pub decrement: f64,
    pub converged: bool,
    pub steps: usize,
    pub evaluations: usize,
}

/// Minimises from a start while noise is raised by `annealing`'s factors, one after another (the last is 1).
pub(super) fn search(model: &FreeModel, start: &Point, annealing: &[f64]) -> Option<Found> {
    let mut at = start.clone();
    let (mut steps, mut evaluations, mut last) = (0, 0, None);
    for (index, kappa) in annealing.iter().enumerate() {
        let rough = *kappa > 1.0;
        let stage =
            Stage { model, measured: raised(model, kappa - 1.0), limits: limits(model, &start.road, rough) };
        if rough || index > 0 {
            at.ln_noise = model.data.noise.iter().map(|n| (kappa * n).max(LEAST_NOISE).ln()).collect();
        }
        at.road = stage.clamped(at.road);
        at.system = at.system.balanced(at.system.order()).ok()?.0;
        let stop = if rough {
            Stop { max_steps: MAX_STEPS[0], gain: ROUGH_GAIN, decrement: ROUGH_DECREMENT }
        } else {
            Stop { max_steps: MAX_STEPS[1], gain: limits::GAIN, decrement: limits::DECREMENT }
        };
        let end: End<Stage<'_>> = descend(&stage, at, stop)?;
        steps += end.steps;
        evaluations += end.evaluations;
        at = end.at.clone();
        last = Some(ended(end, steps, evaluations));
    }
    last
}

/// Goes on from where [`search`] ended, with more steps, where the model explains the data by then but the search has not
/// converged.
pub(super) fn search_on(model: &FreeModel, start: &Point, found: Found) -> Option<Found> {
    if found.converged || !promising(model, &found) {
        return Some(found);
    }
    let stage = Stage { model, measured: raised(model, 0.0), limits: limits(model, &start.road, false) };
    let stop = Stop { max_steps: MORE_STEPS, gain: limits::GAIN, decrement: limits::DECREMENT };
    let end = descend(&stage, found.at, stop)?;
    let (steps, evaluations) = (found.steps + end.steps, found.evaluations + end.evaluations);
    Some(ended(end, steps, evaluations))
}

/// [`search`], and [`search_on`] after it.
pub(super) fn search_patiently(model: &FreeModel, start: &Point, annealing: &[f64]) -> Option<Found> {
    search_on(model, start, search(model, start, annealing)?)
}

fn ended(end: End<Stage<'_>>, steps: usize, evaluations: usize) -> Found {
    Found {
        at: end.at,
        score: end.score,
        frame: end.frame,
        decrement: end.decrement,
        converged: end.converged,
        steps,
        evaluations,
    }
}

fn promising(model: &FreeModel, found: &Found) -> bool {
    Whitening::new(&found.frame.evaluation.s)
        .is_some_and(|w| mean(&w.residuals(&model.data.measured, model.data.averages)) < PROMISING)
}

/// What a point looks like, without a step.
pub(super) fn look(model: &FreeModel, at: &Point) -> Option<Found> {
    let stage = Stage { model, measured: raised(model, 0.0), limits: limits(model, &at.road, false) };
    let (score, frame) = stage.look(at)?;
    let (decrement, converged) = (f64::INFINITY, false);
    Some(Found { at: at.clone(), score, frame, decrement, converged, steps: 0, evaluations: 1 })
}

fn raised(model: &FreeModel, share: f64) -> Spectra {
    let more: Vec<f64> = model.data.noise.iter().map(|v| share * v).collect();
    model.data.measured.raised(&more)
}

fn limits(model: &FreeModel, start: &RoadValues, held: bool) -> [[f64; 2]; 4] {
    let differs = |axis: usize| model.at_m.iter().any(|p| (p[axis] - model.at_m[0][axis]).abs() > 1e-9);
    let fixed = |free: bool, limits: [f64; 2], at: f64| if free { limits } else { [at, at] };
    let ln_mu = start.mu.max(1e-9).ln();
    [
        limits::ln_s0(start.ln_s0),
        limits::exponent(held),
        fixed(differs(1), limits::ln_mu(ln_mu, held), ln_mu),
        fixed(differs(0), limits::LN_DELAY, 0.0),
    ]
}

fn coordinates(road: &RoadValues) -> [f64; 4] {
    [road.ln_s0, road.exponent, road.mu.max(1e-9).ln(), road.ln_delay]
}

impl Stage<'_> {
    fn clamped(&self, road: RoadValues) -> RoadValues {
        let mut x = coordinates(&road);
        x.iter_mut().zip(&self.limits).for_each(|(x, l)| *x = x.clamp(l[0], l[1]));
        RoadValues { ln_s0: x[0], exponent: x[1], mu: x[2].exp(), ln_delay: x[3] }
    }

    fn stable(at: &Point) -> bool {
        at.system.poles().is_ok_and(|poles| poles.iter().all(|p| p.re < 0.0))
    }

    /// From gradients by entries, road and noise to one in local coordinates.
    pub fn project(frame: &Frame, full: &[f64]) -> Vec<f64> {
        let e = frame.entries.len();
        let z = frame.basis.transpose() * Mat::from_fn(e, 1, |i, _| full[i]);
        (0..z.nrows()).map(|i| z[(i, 0)]).chain(full[e..].iter().copied()).collect()
    }
}

impl Problem for Stage<'_> {
    type Point = Point;
    type Frame = Frame;

    fn look(&self, at: &Point) -> Option<(Score, Frame)> {
        let evaluation = Self::stable(at).then(|| self.model.evaluate(at))??;
        let entries = Entries::of(&at.system);
        let (full, basis) = rayon::join(
            || score::full(self.model, &evaluation, &self.measured, at),
            || complement(&at.system).ok(),
        );
        let (full, basis) = (full?, basis?);
        let (e, free, p) = (entries.len(), basis.ncols(), full.gradient.len());
        let diagonal = (0..e).map(|i| full.fisher[(i, i)]).collect();
        let wide = basis.transpose() * full.fisher.submatrix(0, 0, e, p);
        let core = wide.submatrix(0, 0, free, e) * &basis;
        let size = free + p - e;
        let fisher = Mat::from_fn(size, size, |i, j| match (i < free, j < free) {
            (true, true) => 0.5 * (core[(i, j)] + core[(j, i)]),
            (true, false) => wide[(i, e + j - free)],
            (false, true) => wide[(j, e + i - free)],
            (false, false) => full.fisher[(e + i - free, e + j - free)],
        });
        let frame = Frame { basis, entries, evaluation, diagonal };
        let gradient = Stage::project(&frame, &full.gradient);
        Some((Score { cost: full.cost, gradient, fisher }, frame))
    }

    fn cost(&self, at: &Point) -> Option<f64> {
        let s = Self::stable(at).then(|| self.model.spectra(at))??;
        score::cost(self.model, &s, &self.measured, at)
    }

    fn free(&self, at: &Point, score: &Score) -> Vec<usize> {
        let first = score.gradient.len() - 4 - at.ln_noise.len();
        let road = coordinates(&at.road);
        (0..score.gradient.len())
            .filter(|i| {
                if *i < first || *i >= first + 4 {
                    return true;
                }
                let (x, [low, high]) = (road[i - first], self.limits[i - first]);
                let g = score.gradient[*i];
                low < high && !(x <= low && g > 0.0 || x >= high && g < 0.0)
            })
            .collect()
    }

    fn metric(&self, score: &Score, frame: &Frame) -> Option<Mat> {
        let free = frame.basis.ncols();
        let weighted = Mat::from_fn(frame.entries.len(), free, |i, j| {
            frame.basis[(i, j)] * frame.diagonal[i].max(0.0).sqrt()
        });
        let core = weighted.transpose() * &weighted;
        let size = score.gradient.len();
        Some(Mat::from_fn(size, size, |i, j| {
            if i < free && j < free {
                core[(i, j)]
            } else if i == j {
                score.fisher[(i, i)]
            } else {
                0.0
            }
        }))
    }

    fn bend(&self, at: &Point, frame: &Frame, step: &[f64]) -> Option<Vec<f64>> {
        let model = self.model;
        let away = |share: f64| -> Option<(Spectra, Vec<f64>)> {
            let step: Vec<f64> = step.iter().map(|s| share * s).collect();
            let there = self.moved(at, frame, &step);
            Some((model.spectra(&there)?, score::known(model, &there)?.0))
        };
        let (ahead, behind) = rayon::join(|| away(BEND), || away(-BEND));
        let ((ahead, known_ahead), (behind, known_behind)) = (ahead?, behind?);
        let second = |a: f64, b: f64, here: f64| (a + b - 2.0 * here) / (BEND * BEND);
        let s = Spectra::combined([&ahead, &behind, &frame.evaluation.s], |[a, b, here]| second(a, b, here));
        let pulls = Whitening::new(&frame.evaluation.s)?.metric_pull(&s, model.data.averages);
        let mut full = model.pull(&frame.evaluation, at, &pulls);
        let (known, slopes) = score::known(model, at)?;
        for (k, slope) in slopes.iter().enumerate() {
            let bend = second(known_ahead[k], known_behind[k], known[k]);
            slope.iter().for_each(|(i, v)| full[*i] += v * bend);
        }
        Some(Stage::project(frame, &full))
    }

    fn clip(&self, step: &mut [f64], frame: &Frame) {
        let free = frame.basis.ncols();
        let entries = &frame.basis * Mat::from_fn(free, 1, |i, _| step[i]);
        let shrink = (STEP_ENTRY / entries.norm_max().max(f64::MIN_POSITIVE)).min(1.0);
        for (i, s) in step.iter_mut().enumerate() {
            if i < free {
                *s *= shrink;
                continue;
            }
            let limit = match i - free {
                0 | 3 => limits::STEP_LEVEL,
                1 | 2 => limits::STEP_ROAD,
                _ => limits::STEP_NOISE,
            };
            *s = s.clamp(-limit, limit);
        }
    }

    fn moved(&self, at: &Point, frame: &Frame, step: &[f64]) -> Point {
        let free = frame.basis.ncols();
        let change = &frame.basis * Mat::from_fn(free, 1, |i, _| step[i]);
        let system: FirstOrder = frame.entries.moved(&at.system, |k| change[(k, 0)]);
        let x = coordinates(&at.road);
        let road = self.clamped(RoadValues {
            ln_s0: x[0] + step[free],
            exponent: x[1] + step[free + 1],
            mu: (x[2] + step[free + 2]).exp(),
            ln_delay: x[3] + step[free + 3],
        });
        let noise = at.ln_noise.iter().zip(&step[free + 4..]);
        let [lowest, highest] = limits::ln_noise();
        let ln_noise = noise.map(|(n, s)| (n + s).clamp(lowest, highest)).collect();
        Point { system, road, ln_noise }
    }
}

/// The system in s instead of scaled time.
pub(super) fn in_seconds(system: &FirstOrder) -> FirstOrder {
    system.in_time_of(1.0 / RATE)
}
