//! Several recordings of one vehicle as one problem: the vehicle is shared, each road, delay and noise is its own.

use super::layout::Kind;
use super::model::Model;
use crate::identify::likelihood::{
    End, LEAST_NOISE, Problem, Score, Spectra, Stop, Whitening, cost, descend, information_bins, limits,
};
use crate::linalg::Mat;
use rayon::prelude::*;

/// Longest step of a clock, s.
const STEP_CLOCK_S: f64 = 0.005;
/// A clock is not further off than this, s.
const CLOCK_S: f64 = 0.2;
/// Good enough while noise is raised.
const ROUGH_GAIN: f64 = 0.1;
const ROUGH_DECREMENT: f64 = 1.0;
/// Steps while noise is raised, and at the real noise: directions that the sensors hardly see converge linearly.
const MAX_STEPS: [usize; 2] = [40, 300];

/// All recordings, and where their parameters stand among all.
pub(super) struct Joint<'a> {
    pub models: Vec<Model<'a>>,
    /// First of each recording's own parameters.
    pub offsets: Vec<usize>,
    pub vehicle: usize,
}

/// The joint problem at one level of raised noise.
struct Stage<'j, 'a> {
    joint: &'j Joint<'a>,
    measured: Vec<Spectra>,
    limits: Vec<[f64; 2]>,
}

/// Where the search ended.
pub(super) struct Search {
    pub theta: Vec<f64>,
    pub score: Score,
    pub decrement: f64,
    pub converged: bool,
    /// Parameters that stand at their limit.
    pub at_limit: Vec<usize>,
    pub steps: usize,
    pub evaluations: usize,
}

impl<'a> Joint<'a> {
    pub fn new(models: Vec<Model<'a>>) -> Self {
        let vehicle = models.first().map_or(0, |m| m.layout.vehicle);
        let mut next = vehicle;
        let offsets = models
            .iter()
            .map(|m| {
                let first = next;
                next += m.layout.len() - vehicle;
                first
            })
            .collect();
        Joint { models, offsets, vehicle }
    }

    pub fn len(&self) -> usize {
        self.vehicle + self.models.iter().map(|m| m.layout.len() - self.vehicle).sum::<usize>()
    }

    /// Place among all parameters of parameter i of recording r.
    pub fn place(&self, r: usize, i: usize) -> usize {
        if i < self.vehicle { i } else { self.offsets[r] + i - self.vehicle }
    }

    /// The parameters of recording r alone.
    pub fn local(&self, theta: &[f64], r: usize) -> Vec<f64> {
        (0..self.models[r].layout.len()).map(|i| theta[self.place(r, i)]).collect()
    }

    /// Recording and kind of each parameter; the vehicle's belong to the first.
    pub fn kind(&self, i: usize) -> (usize, Kind) {
        let r = self.offsets.iter().rposition(|first| *first <= i).unwrap_or(0);
        let local = if i < self.vehicle { i } else { i - self.offsets[r] + self.vehicle };
        (if i < self.vehicle { 0 } else { r }, self.models[r].layout.kind(local))
    }

    /// Cost, gradient and information of all recordings.
    pub fn score(&self, theta: &[f64], measured: &[Spectra]) -> Option<Score> {
        let p = self.len();
        let (mut total, mut gradient, mut fisher) = (0.0, vec![0.0; p], Mat::zeros(p, p));
        for (r, model) in self.models.iter().enumerate() {
            let local = self.local(theta, r);
            let part = part(model, &local, &measured[r])?;
            total += part.cost;
            for a in 0..local.len() {
                gradient[self.place(r, a)] += part.gradient[a];
                for b in 0..local.len() {
                    fisher[(self.place(r, a), self.place(r, b))] += part.fisher[(a, b)];
                }
            }
        }
        Some(Score { cost: total, gradient, fisher })
    }

    /// Minimises from a start while the sensors' noise is raised by `annealing`'s factors, one after another (the last
    /// is 1): a loud floor has a wide basin. `early` ends as roughly at the real noise too.
    pub fn search(&self, start: &[f64], annealing: &[f64], early: bool) -> Result<Search, String> {
        let mut theta = start.to_vec();
        let (mut evaluations, mut steps, mut last) = (0, 0, None);
        for (stage, kappa) in annealing.iter().enumerate() {
            let rough = *kappa > 1.0;
            let problem = Stage {
                joint: self,
                measured: self.models.iter().map(|m| raised(m, kappa - 1.0)).collect(),
                limits: self.limits(start, rough),
            };
            // a stage's floor starts from what was added; the last one goes on from where a search without stages began
            if rough || stage > 0 {
                for (r, model) in self.models.iter().enumerate() {
                    for c in 0..model.layout.channels {
                        theta[self.place(r, model.layout.noise + c)] =
                            (kappa * model.data.noise[c]).max(LEAST_NOISE).ln();
                    }
                }
            }
            theta.iter_mut().zip(&problem.limits).for_each(|(t, l)| *t = t.clamp(l[0], l[1]));
            let stop = if rough || early {
                Stop { max_steps: MAX_STEPS[0], gain: ROUGH_GAIN, decrement: ROUGH_DECREMENT }
            } else {
                Stop { max_steps: MAX_STEPS[1], gain: limits::GAIN, decrement: limits::DECREMENT }
            };
            let end: End<Stage<'_, '_>> = descend(&problem, theta.clone(), stop)
                .ok_or("the model's spectrum is not positive definite at the start")?;
            evaluations += end.evaluations;
            steps += end.steps;
            theta.clone_from(&end.at);
            let at_limit = (0..theta.len())
                .filter(|i| !matches!(self.kind(*i).1, Kind::Noise(_) | Kind::Clock(_)))
                .filter(|i| theta[*i] <= problem.limits[*i][0] || theta[*i] >= problem.limits[*i][1])
                .collect();
            last = Some(Search {
                theta: end.at,
                score: end.score,
                decrement: end.decrement,
                converged: end.converged,
                at_limit,
                steps,
                evaluations,
            });
        }
        last.ok_or_else(|| "no stage".to_owned())
    }

    fn limits(&self, start: &[f64], held: bool) -> Vec<[f64; 2]> {
        let vehicle = self.models.first().map(|m| m.vehicle.limits()).unwrap_or_default();
        (0..self.len())
            .map(|i| match self.kind(i).1 {
                Kind::Vehicle => vehicle[i].map(f64::ln),
                Kind::Roughness => limits::ln_s0(start[i]),
                Kind::Exponent => limits::exponent(held),
                Kind::Mu => limits::ln_mu(start[i], held),
                Kind::Delay => limits::LN_DELAY,
                // the first channel's is the clock that the others are compared with
                Kind::Clock(0) => [0.0, 0.0],
                Kind::Clock(_) => [-CLOCK_S, CLOCK_S],
                Kind::Noise(_) => limits::ln_noise(),
            })
            .collect()
    }
}

/// One recording's cost, gradient and information.
///
/// The gradient is exact; the information takes each bin's derivatives as at its middle, where the window moves them by a
/// few per cent at most.
fn part(model: &Model<'_>, theta: &[f64], measured: &Spectra) -> Option<Score> {
    let evaluation = model.evaluate(theta).ok()?;
    let whitening = Whitening::new(&evaluation.s)?;
    let (averages, p) = (model.data.averages, theta.len());
    let (cost, pulls) = whitening.pulls(measured, averages);
    let slopes = model.slopes(theta).ok()?;
    let gradient = model.pull(&evaluation, &slopes, theta, &pulls);
    let (bins, weight) = information_bins(measured.len());
    let shape = evaluation.grid.shape;
    let shares: Vec<Mat> = bins
        .into_par_iter()
        .filter_map(|bin| {
            let g = evaluation.grid.at(model.data.middle(bin))?;
            let v = model.whitened_slopes(shape, g, &slopes, theta, whitening.inverse(bin));
            Some(v.transpose() * &v)
        })
        .collect();
    let mut fisher = Mat::zeros(p, p);
    shares.iter().for_each(|s| fisher += s);
    let weight = weight * averages;
    let fisher = Mat::from_fn(p, p, |i, j| weight * fisher[(i.max(j), i.min(j))]);
    cost.is_finite().then_some(Score { cost, gradient, fisher })
}

/// Measured spectra with `share` of each channel's starting noise floor added.
fn raised(model: &Model<'_>, share: f64) -> Spectra {
    let more: Vec<f64> = model.data.noise.iter().map(|v| share * v).collect();
    model.data.measured.raised(&more)
}

impl Problem for Stage<'_, '_> {
    type Point = Vec<f64>;
    type Frame = ();

    fn look(&self, at: &Vec<f64>) -> Option<(Score, ())> {
        Some((self.joint.score(at, &self.measured)?, ()))
    }

    fn cost(&self, at: &Vec<f64>) -> Option<f64> {
        let mut total = 0.0;
        for (r, model) in self.joint.models.iter().enumerate() {
            let s = model.spectra(&self.joint.local(at, r)).ok()?;
            total += cost(&s, &self.measured[r], model.data.averages)?;
        }
        Some(total)
    }

    /// Parameters that do not stand at a limit with the cost falling outwards.
    fn free(&self, at: &Vec<f64>, score: &Score) -> Vec<usize> {
        (0..at.len())
            .filter(|i| {
                let [low, high] = self.limits[*i];
                let pressed =
                    at[*i] <= low && score.gradient[*i] > 0.0 || at[*i] >= high && score.gradient[*i] < 0.0;
                low < high && !pressed
            })
            .collect()
    }

    fn clip(&self, step: &mut [f64], (): &()) {
        for (i, s) in step.iter_mut().enumerate() {
            let limit = match self.joint.kind(i).1 {
                Kind::Noise(_) => limits::STEP_NOISE,
                Kind::Exponent | Kind::Mu => limits::STEP_ROAD,
                Kind::Clock(_) => STEP_CLOCK_S,
                _ => limits::STEP_LEVEL,
            };
            *s = s.clamp(-limit, limit);
        }
    }

    fn moved(&self, at: &Vec<f64>, (): &(), step: &[f64]) -> Vec<f64> {
        at.iter().zip(step).zip(&self.limits).map(|((t, s), l)| (t + s).clamp(l[0], l[1])).collect()
    }
}
