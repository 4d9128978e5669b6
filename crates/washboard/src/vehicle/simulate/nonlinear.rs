//! Dampers with curves: what they add to the exact response of the linear vehicle, integrated in time.

use super::super::DamperCurve;
use super::synthesis::{RoadInput, between, series, spectrum};
use super::{GUARD_S, MAX_SAMPLES, SimulateError};
use crate::linalg::{C64, LinalgError, Mat, eigen, solve};
use rayon::prelude::*;

/// What a halving of the step may change in the end, as a share of each channel's rms. At kinks of a curve the error falls
/// with the square of the step, elsewhere with the fourth power: what is left is a third of it, or less.
const STEP_TOLERANCE: f64 = 1e-5;
/// A step in which a damper passes a kink is taken in this many, so that kinks do not rule the steps of all.
const STEPS_AT_KINK: usize = 16;
/// Steps a second at first, and at least this many in the time constant of the fastest pole.
const STEPS_PER_SECOND: f64 = 800.0;
const STEPS_PER_TIME_CONSTANT: f64 = 10.0;
/// Instants per sample, at least: the road reaches up to twice the sampling rate.
const LEAST_INSTANTS: usize = 6;
const MAX_HALVINGS: usize = 6;

/// Spectra (the recorded frequencies) of what the curves add to every channel, and what the last halving changed.
///
/// With the linear vehicle's exact response q₀ and dampers of velocity v = R q̇, q = q₀ + w solves
/// M ẅ + C ẇ + K w = −Rᵀ g(v₀ + R ẇ), g = F(v) − c v: exact road, exact delays, no difference of large numbers. Classical
/// Runge–Kutta of order 4 with v₀ at its own instants (between them where a kink
/// is passed in small steps), over the period and a run-up of 20 s that forgets w = 0.
pub(super) fn difference(
    input: &RoadInput<'_>,
    looks: &[(Vec<f64>, usize)],
    linear: &[Vec<C64>],
) -> Result<(Vec<Vec<C64>>, f64), SimulateError> {
    let rate = input.settings.rate_hz;
    let equations = Equations::new(input, looks).map_err(super::RideError::from)?;
    let wanted = STEPS_PER_SECOND.max(STEPS_PER_TIME_CONSTANT * equations.fastest()?) / rate;
    let mut instants = (2 * wanted.ceil() as usize).max(LEAST_INSTANTS);
    let mut last: Option<Vec<Vec<C64>>> = None;
    let mut reached = f64::INFINITY;
    for _ in 0..=MAX_HALVINGS {
        // velocities at every instant, channels at every second one
        let series = equations.curves.len() as f64 + looks.len() as f64 / 2.0;
        let numbers = input.period() as f64 * instants as f64 * series;
        if numbers > MAX_SAMPLES {
            break;
        }
        let found = equations.integrate(input, instants);
        if let Some(before) = last {
            reached = changed(&before, &found, linear);
            if reached <= STEP_TOLERANCE {
                return Ok((found, reached));
            }
        }
        last = Some(found);
        instants *= 2;
    }
    Err(SimulateError::Steps { step_s: 4.0 / (instants as f64 * rate), reached, expected: STEP_TOLERANCE })
}

/// The largest rms of a channel's change over its rms.
fn changed(before: &[Vec<C64>], after: &[Vec<C64>], linear: &[Vec<C64>]) -> f64 {
    let shares = before.iter().zip(after).zip(linear).map(|((a, b), l)| {
        let change: f64 = a.iter().zip(b).map(|(x, y)| (x - y).norm_sqr()).sum();
        let whole: f64 = b.iter().zip(l).map(|(x, y)| (x + y).norm_sqr()).sum();
        // a channel that does not move has not changed; NaN is more than any tolerance
        if change == 0.0 { 0.0 } else { (change / whole).sqrt() }
    });
    shares.fold(0.0, |worst: f64, s| if s.is_nan() { f64::INFINITY } else { worst.max(s) })
}

/// The difference's equations of motion, divided by M, and how channels see its state.
struct Equations<'a> {
    input: &'a RoadInput<'a>,
    /// M⁻¹K, M⁻¹C (n × n) and M⁻¹Rᵀ (n × dampers).
    stiffness: Mat,
    damping: Mat,
    force: Mat,
    /// R and the curves with their linear parts.
    rows: Vec<Vec<f64>>,
    curves: Vec<(&'a DamperCurve, f64)>,
    looks: &'a [(Vec<f64>, usize)],
}

impl<'a> Equations<'a> {
    fn new(input: &'a RoadInput<'a>, looks: &'a [(Vec<f64>, usize)]) -> Result<Self, LinalgError> {
        let (system, dampers) = (input.vehicle.system(), input.vehicle.dampers());
        let columns = Mat::from_fn(system.order(), dampers.len(), |i, j| dampers[j].row[i]);
        Ok(Equations {
            input,
            stiffness: solve(system.m(), system.k())?,
            damping: solve(system.m(), system.c())?,
            force: solve(system.m(), &columns)?,
            rows: dampers.iter().map(|d| d.row.clone()).collect(),
            curves: dampers.iter().map(|d| (&d.curve, d.linear)).collect(),
            looks,
        })
    }

    /// The largest |λ| with every damper at its steepest, 1/s.
    fn fastest(&self) -> Result<f64, SimulateError> {
        let steepest: Vec<f64> = self.curves.iter().map(|(curve, _)| curve.steepest()).collect();
        let vehicle = self.input.vehicle.with_damping(&steepest)?;
        let a = vehicle.system().state_matrix().map_err(super::VehicleError::from)?;
        let (poles, _) = eigen(&a).map_err(super::RideError::from)?;
        Ok(poles.iter().map(|p| p.norm()).fold(0.0, f64::max))
    }

    /// ẅ at (w, ẇ) where the linear vehicle's dampers move with v₀; `pieces` becomes each curve's piece.
    fn acceleration(
        &self,
        [w, rate]: [&[f64]; 2],
        v0: impl Fn(usize) -> f64,
        out: &mut [f64],
        pieces: &mut [usize],
    ) {
        let n = w.len();
        for (i, value) in out.iter_mut().enumerate() {
            *value =
                -(0..n).map(|j| self.stiffness[(i, j)] * w[j] + self.damping[(i, j)] * rate[j]).sum::<f64>();
        }
        for (j, (curve, linear)) in self.curves.iter().enumerate() {
            let v = v0(j) + self.rows[j].iter().zip(rate).map(|(r, x)| r * x).sum::<f64>();
            let g = curve.force(v) - linear * v;
            pieces[j] = curve.piece(v);
            for (i, value) in out.iter_mut().enumerate() {
                *value -= self.force[(i, j)] * g;
            }
        }
    }

    /// One step of length h from `state`, with v₀ of each damper at its stages 0, 1/2 and 1; whether a kink was passed.
    fn step(&self, state: &mut State, h: f64, v0: impl Fn(f64, usize) -> f64) -> bool {
        let n = state.w.len();
        for (stage, ahead) in [0.0, 0.5, 0.5, 1.0].into_iter().enumerate() {
            for i in 0..n {
                let [dw, dv] = match stage {
                    0 => [0.0, 0.0],
                    _ => [state.k[stage - 1][0][i], state.k[stage - 1][1][i]],
                };
                state.at[i] = state.w[i] + ahead * h * dw;
                state.speed[i] = state.rate[i] + ahead * h * dv;
            }
            let [first, second] = &mut state.k[stage];
            first.copy_from_slice(&state.speed);
            let pieces = &mut state.pieces[stage];
            self.acceleration([&state.at, &state.speed], |j| v0(ahead, j), second, pieces);
        }
        for i in 0..n {
            let mean = |part: usize| {
                let [a, b, c, d] = [0, 1, 2, 3].map(|stage| state.k[stage][part][i]);
                (a + 2.0 * (b + c) + d) / 6.0
            };
            let [dw, dv] = [mean(0), mean(1)];
            state.w[i] += h * dw;
            state.rate[i] += h * dv;
        }
        state.pieces.iter().any(|p| *p != state.pieces[0])
    }

    /// The recorded frequencies of every channel with `instants` (even) instants a sample, two a step.
    fn integrate(&self, input: &RoadInput<'_>, instants: usize) -> Vec<Vec<C64>> {
        let len = input.period() * instants;
        let velocity: Vec<(Vec<f64>, usize)> = self.rows.iter().map(|row| (row.clone(), 1)).collect();
        let v0: Vec<Vec<f64>> =
            input.responses(&velocity, input.bins()).into_par_iter().map(|s| series(s, len)).collect();
        let h = 2.0 / (instants as f64 * input.settings.rate_hz);
        let (steps, run_up) = (len / 2, ((GUARD_S / h).ceil() as usize).min(len / 2));
        let mut state = State::new(input.vehicle.system().order(), self.curves.len());
        let mut channels = vec![vec![0.0; steps]; self.looks.len()];
        let run = (steps - run_up..steps).map(|i| (i, false)).chain((0..steps).map(|i| (i, true)));
        for (step, recorded) in run {
            let (w, rate) = (state.w.clone(), state.rate.clone());
            let kink = self.step(&mut state, h, |ahead, j| v0[j][(2 * step + (2.0 * ahead) as usize) % len]);
            if recorded {
                for (channel, (row, _)) in channels.iter_mut().zip(self.looks) {
                    channel[step] = row.iter().zip(&w).map(|(r, x)| r * x).sum();
                }
            }
            if kink {
                (state.w, state.rate) = (w, rate);
                let share = 1.0 / STEPS_AT_KINK as f64;
                for part in 0..STEPS_AT_KINK {
                    self.step(&mut state, h * share, |ahead, j| {
                        between(&v0[j], 2.0 * (step as f64 + share * (part as f64 + ahead)))
                    });
                }
            }
        }
        // displacements are smooth where forces have kinks: derivatives are taken of their spectra, so that what lies
        // above the steps' rate does not fold back
        let derivative = |(displacement, (_, d)): (Vec<f64>, &(Vec<f64>, usize))| -> Vec<C64> {
            let found = spectrum(displacement, input.recorded()).into_iter().enumerate();
            found.map(|(k, y)| y * C64::new(0.0, input.omega(k)).powi(*d as i32)).collect()
        };
        channels.into_par_iter().zip(self.looks).map(derivative).collect()
    }
}

/// (w, ẇ), and what a step needs: slopes of the four stages, where each looks, and the curves' pieces there.
struct State {
    w: Vec<f64>,
    rate: Vec<f64>,
    k: [[Vec<f64>; 2]; 4],
    at: Vec<f64>,
    speed: Vec<f64>,
    pieces: [Vec<usize>; 4],
}

impl State {
    fn new(n: usize, dampers: usize) -> Self {
        let zero = || vec![0.0; n];
        State {
            w: zero(),
            rate: zero(),
            k: std::array::from_fn(|_| [zero(), zero()]),
            at: zero(),
            speed: zero(),
            pieces: std::array::from_fn(|_| vec![0; dampers]),
        }
    }
}
