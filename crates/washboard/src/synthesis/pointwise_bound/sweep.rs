//! One plant's targets over frequencies: a grid, then the neighbourhoods of its largest levels.

use super::terms::{Asked, Term, terms};
use super::{discs, matrices};
use crate::linalg::{C64, CMat};
use crate::lti::{Continuous, GeneralizedPlant, Responder};
use crate::synthesis::{SynthesisError, Target};

/// Points of the grid, a decade.
const DENSITY: f64 = 24.0;
/// The grid goes so many times beyond the plant's slowest and fastest poles.
const BEYOND: f64 = 10.0;
/// Poles below this share of the fastest are at 0.
const AT_REST: f64 = 1e-6;
/// Peaks of the grid that are looked at more closely.
const PEAKS: usize = 3;
/// Steps of a golden section, each .618 of the last: 10⁻⁵ of the grid's step, where a level is flat to 10⁻¹⁰.
const GOLDEN_STEPS: usize = 24;
/// Steps to a zero of G_zu, to the last bit of the frequency.
const ZERO_STEPS: usize = 75;
/// A target whose ‖G_zu‖ is below `VANISHES` of what it is `BESIDE` away (a share of the frequency) is not reached there: a
/// zero on the axis that rounding hides, to within 3e-15 of the frequency. A response that merely falls does so by far less.
const VANISHES: f64 = 3e-12;
const BESIDE: f64 = 1e-3;
/// Levels are lowered by this share: what rounding may add.
const ROUNDING: f64 = 1e-7;
/// A response's relative error is at most this many times ε times the fastest pole over the distance of the nearest.
const ERRORS: f64 = 100.0;
/// Frequencies where that is more than this are left out.
const MOST_DOUBT: f64 = 1e-6;

/// One plant and what is asked of it.
pub(super) struct Sweep {
    responder: Responder<Continuous>,
    poles: Vec<C64>,
    nw: usize,
    asked: Vec<Asked>,
}

/// What a frequency allows.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Least {
    /// No goal below this.
    Goal(f64),
    /// The bounds contradict each other: the least largest share of a limit.
    Impossible(f64),
}

impl Least {
    /// Impossible ones above all goals.
    fn rank(self) -> (bool, f64) {
        match self {
            Least::Goal(v) => (false, v),
            Least::Impossible(v) => (true, v),
        }
    }

    fn above(self, other: Self) -> bool {
        self.rank() > other.rank()
    }
}

impl Sweep {
    /// `None` where nothing is asked of an H∞ norm.
    pub fn new(plant: &GeneralizedPlant, targets: &[&Target]) -> Result<Option<Self>, SynthesisError> {
        let asked: Vec<Asked> = targets.iter().filter_map(|t| Asked::new(t, plant.nw())).collect();
        if asked.is_empty() {
            return Ok(None);
        }
        // rows of z, all inputs
        let (z, inputs): (Vec<usize>, Vec<usize>) =
            ((0..plant.nz()).collect(), (0..plant.nw() + plant.nu()).collect());
        let system = plant.system().select(&z, &inputs)?;
        let responder = system.responder()?;
        let poles = system.poles()?;
        Ok(Some(Sweep { responder, poles, nw: plant.nw(), asked }))
    }

    /// The worst frequency with its goal, and with what its bounds lack.
    pub fn worst(&self, frequencies: &[f64]) -> Result<[Option<(f64, f64)>; 2], SynthesisError> {
        let mut found: Vec<(f64, Least)> = Vec::new();
        for omega in self.grid(frequencies)? {
            found.extend(self.at(omega)?.map(|least| (omega, least)));
        }
        let is_peak = |k: &usize| {
            let beside = [k.checked_sub(1), Some(k + 1)].into_iter().flatten().filter_map(|i| found.get(i));
            beside.into_iter().all(|(_, v)| !v.above(found[*k].1))
        };
        let mut peaks: Vec<usize> = (0..found.len()).filter(is_peak).collect();
        peaks.sort_by(|i, j| {
            let ((a, x), (b, y)) = (found[*j].1.rank(), found[*i].1.rank());
            a.cmp(&b).then(x.total_cmp(&y))
        });
        peaks.truncate(PEAKS);
        let mut best = peaks.first().map(|k| found[*k]);
        for k in peaks {
            let low = k.checked_sub(1).map_or(found[k].0, |i| found[i].0);
            let high = found.get(k + 1).map_or(found[k].0, |f| f.0);
            let refined =
                golden(low, high, GOLDEN_STEPS, |omega| Ok(self.at(omega)?.map(|l| (l, l.rank()))))?;
            if let Some((omega, least)) = refined
                && best.is_none_or(|b| least.above(b.1))
            {
                best = Some((omega, least));
            }
        }
        let has_goal = self.asked.iter().any(Asked::is_goal);
        Ok(match best {
            Some((omega, Least::Impossible(v))) => [None, Some((omega, v))],
            Some((omega, Least::Goal(v))) if has_goal => [Some((omega, v)), None],
            _ => [None, None],
        })
    }

    /// The least level at a frequency; `None` where the plant has a pole there or nothing is proven.
    fn at(&self, omega: f64) -> Result<Option<Least>, SynthesisError> {
        let doubt = self.doubt(omega);
        let Some(g) = self.response(omega).filter(|_| doubt <= MOST_DOUBT) else { return Ok(None) };
        let (all, columns) = terms(&self.asked, &g, self.nw, &self.unreached(omega, &g));
        if all.is_empty() {
            return Ok(Some(Least::Goal(0.0)));
        }
        let scalar = columns == 1 && g.ncols() == self.nw + 1;
        let solve = |of: &[Term]| -> Result<Option<f64>, SynthesisError> {
            let level = if scalar {
                discs::least_level(of, doubt)
            } else {
                matrices::proven_level(of, columns, doubt)?
            };
            Ok(level.map(|v| v * (1.0 - ROUNDING)))
        };
        let bounds: Vec<_> = all.iter().filter(|t| !t.goal).map(Term::as_goal).collect();
        let with_goals = bounds.len() < all.len();
        let goal = if with_goals { solve(&all)? } else { Some(0.0) };
        let doubtful = !with_goals || goal.is_none();
        if doubtful
            && !bounds.is_empty()
            && let Some(share) = solve(&bounds)?
            && share > 1.0
        {
            return Ok(Some(Least::Impossible(share)));
        }
        Ok(goal.map(Least::Goal))
    }

    /// The relative error of a response: (iω − A)⁻¹ loses as many digits as the fastest pole is farther than the nearest.
    fn doubt(&self, omega: f64) -> f64 {
        let fastest = self.poles.iter().map(|p| p.norm()).fold(omega, f64::max);
        let nearest =
            self.poles.iter().map(|p| (C64::new(0.0, omega) - p).norm()).fold(f64::INFINITY, f64::min);
        ERRORS * f64::EPSILON * (fastest / nearest).max(1.0)
    }

    /// Whether each target has a zero of G_zu here.
    fn unreached(&self, omega: f64, g: &CMat) -> Vec<bool> {
        let beside: Vec<CMat> =
            [1.0 - BESIDE, 1.0 + BESIDE].iter().filter_map(|f| self.response(omega * f)).collect();
        let of = |t: &Asked| {
            let here = t.influence(g, self.nw);
            beside.len() == 2 && beside.iter().all(|g| here < VANISHES * t.influence(g, self.nw))
        };
        self.asked.iter().map(of).collect()
    }

    /// G from [w; u] to z; `None` next to a pole.
    fn response(&self, omega: f64) -> Option<CMat> {
        let g = self.responder.at_frequency(omega).ok()?;
        let finite = (0..g.ncols()).all(|j| (0..g.nrows()).all(|i| g[(i, j)].norm_sqr().is_finite()));
        finite.then_some(g)
    }

    /// A logarithmic grid around the poles, the poles' own frequencies, those that are given, and those where a target is
    /// reached least; ascending.
    fn grid(&self, frequencies: &[f64]) -> Result<Vec<f64>, SynthesisError> {
        let poles = &self.poles;
        let fastest = poles.iter().map(|p| p.norm()).fold(0.0, f64::max);
        let moving = || poles.iter().map(|p| p.norm()).filter(|w| *w > AT_REST * fastest);
        let given: Vec<f64> = frequencies.iter().copied().filter(|w| *w > 0.0 && w.is_finite()).collect();
        let all = || moving().chain(given.iter().copied());
        let (low, high) = all().fold((f64::INFINITY, 0.0), |(l, h): (f64, f64), w| (l.min(w), h.max(w)));
        let (low, high) = if high > 0.0 { (low / BEYOND, high * BEYOND) } else { (1.0 / BEYOND, BEYOND) };
        let points = (DENSITY * (high / low).log10()).ceil();
        let mut grid: Vec<f64> =
            (0..=points as usize).map(|k| low * (high / low).powf(k as f64 / points)).collect();
        grid.extend(moving());
        grid.extend(poles.iter().map(|p| p.im).filter(|w| *w > AT_REST * fastest));
        grid.sort_by(f64::total_cmp);
        let mut zeros = given;
        for target in &self.asked {
            zeros.extend(self.least_reached(target, &grid)?);
        }
        grid.extend(zeros);
        grid.sort_by(f64::total_cmp);
        grid.dedup();
        Ok(grid)
    }

    /// Where ‖G_zu‖ of a target has its minima.
    fn least_reached(&self, target: &Asked, grid: &[f64]) -> Result<Vec<f64>, SynthesisError> {
        let reach = |omega: f64| self.response(omega).map(|g| target.influence(&g, self.nw));
        let values: Vec<Option<f64>> = grid.iter().map(|w| reach(*w)).collect();
        let mut all = Vec::new();
        for (w, v) in grid.windows(3).zip(values.windows(3)) {
            if let ([low, _, high], [Some(before), Some(here), Some(after)]) = (w, v)
                && here < before
                && here <= after
            {
                all.extend(
                    golden(*low, *high, ZERO_STEPS, |omega| Ok(reach(omega).map(|v| (v, -v))))?.map(|f| f.0),
                );
            }
        }
        Ok(all)
    }
}

/// The largest of a function with one peak between two frequencies: where, and what is found there.
fn golden<V: Copy, R: PartialOrd + Copy>(
    low: f64,
    high: f64,
    steps: usize,
    mut of: impl FnMut(f64) -> Result<Option<(V, R)>, SynthesisError>,
) -> Result<Option<(f64, V)>, SynthesisError> {
    let share = 0.5 * (5.0f64.sqrt() - 1.0);
    let (mut low, mut high) = (low, high);
    let (mut left, mut right) = (high - share * (high - low), low + share * (high - low));
    let (mut at_left, mut at_right) = (of(left)?, of(right)?);
    for _ in 0..steps {
        let (Some(l), Some(r)) = (at_left, at_right) else { return Ok(None) };
        if l.1 >= r.1 {
            high = right;
            (right, at_right) = (left, at_left);
            left = high - share * (high - low);
            at_left = of(left)?;
        } else {
            low = left;
            (left, at_left) = (right, at_right);
            right = low + share * (high - low);
            at_right = of(right)?;
        }
    }
    let (Some(l), Some(r)) = (at_left, at_right) else { return Ok(None) };
    Ok(Some(if l.1 >= r.1 { (left, l.0) } else { (right, r.0) }))
}
