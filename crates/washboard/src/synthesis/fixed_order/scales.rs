//! Units in which a controller's entries are of the order of 1.

use super::structure::{Entry, Structure};
use super::targets::{Aim, Measure, Target};
use crate::linalg::{C64, CMat, solve_complex};
use crate::lti::GeneralizedPlant;

/// Frequencies around the plants' pace at which gains are looked at.
const POINTS: usize = 25;
/// A control that moves goals by less than this share of what the others do moves none.
const SEEN: f64 = 1e-9;
/// Decades to each side.
const DECADES: f64 = 1.5;

/// Units of time, of each measurement and of each control.
#[derive(Debug, Clone)]
pub(super) struct Scales {
    /// rad/s.
    pub pace: f64,
    pub measurements: Vec<f64>,
    pub controls: Vec<f64>,
    /// Of the controller's states: 1 where they are free, by what measurements make of them where their equations are fixed.
    pub states: Vec<f64>,
}

impl Scales {
    /// The geometric mean of the poles' sizes; measurements by what disturbances make of them; controls by what it takes to
    /// do to the goals what disturbances do.
    pub fn of(plants: &[GeneralizedPlant], targets: &[Target]) -> Self {
        let sizes: Vec<f64> = plants
            .iter()
            .filter_map(|p| p.system().poles().ok())
            .flatten()
            .map(|p| p.norm())
            .filter(|s| *s > 1e-6 && s.is_finite())
            .collect();
        let mean = |v: &[f64]| {
            if v.is_empty() { 1.0 } else { (v.iter().map(|s| s.ln()).sum::<f64>() / v.len() as f64).exp() }
        };
        let pace = mean(&sizes);
        let Some(plant) = plants.first() else {
            return Scales { pace, measurements: Vec::new(), controls: Vec::new(), states: Vec::new() };
        };
        let omegas: Vec<f64> = around(pace).collect();
        let responses: Vec<_> = omegas
            .iter()
            .filter_map(|w| plant.system().frequency_response(&[*w]).ok()?.into_iter().next())
            .collect();
        let (nz, nw) = (plant.nz(), plant.nw());
        // a performance's weight: that of its goals and bounds
        let mut weights = vec![0.0f64; nz];
        for t in targets.iter().filter(|t| t.plant == 0) {
            let (Aim::Goal(unit) | Aim::Bound(unit)) = t.aim;
            if let Measure::Hinf(c) | Measure::H2(c) = &t.measure {
                c.outputs.iter().for_each(|(i, w)| weights[*i] = weights[*i].max(w / unit));
            }
        }
        type Response = crate::linalg::CMat;
        let over = |of: &dyn Fn(&Response) -> f64| {
            let found: Vec<f64> = responses.iter().map(of).filter(|v| *v > 0.0 && v.is_finite()).collect();
            if found.is_empty() { 0.0 } else { mean(&found) }
        };
        let column = |g: &Response, j: usize| {
            (0..nz).map(|i| (weights[i] * g[(i, j)].norm()).powi(2)).sum::<f64>().sqrt()
        };
        let disturbed = over(&|g| (0..nw).map(|j| column(g, j).powi(2)).sum::<f64>().sqrt());
        let moved: Vec<f64> = (0..plant.nu()).map(|j| over(&|g| column(g, nw + j))).collect();
        let most = moved.iter().copied().fold(0.0, f64::max);
        // a control that moves no goal counts like the others
        let ratio = |m: f64| if m > SEEN * most && disturbed > 0.0 { disturbed / m } else { 1.0 };
        let controls: Vec<f64> = moved.iter().map(|m| ratio(*m)).collect();
        // by disturbances, and by controls of one unit
        let row = |g: &Response, i: usize| {
            let by = |j: usize| g[(i, j)].norm() * if j < nw { 1.0 } else { controls[j - nw] };
            (0..nw + controls.len()).map(|j| by(j).powi(2)).sum::<f64>().sqrt()
        };
        let seen: Vec<f64> = (0..plant.ny()).map(|i| over(&|g| row(g, nz + i))).collect();
        let measurements = seen.iter().map(|v| if *v > 0.0 { *v } else { 1.0 }).collect();
        Scales { pace, measurements, controls, states: Vec::new() }
    }

    /// The same for a structure: a state whose equation is given in numbers has the size that these make of the
    /// measurements around the pace, what is free in other equations left out.
    pub fn for_structure(mut self, structure: &Structure) -> Self {
        let n = structure.order();
        let number = |i: usize, j: usize| match structure.entry(i, j) {
            Entry::Fixed(v) => v,
            Entry::Free => 0.0,
        };
        let is_fixed = |i: usize| (0..structure.cols()).all(|j| structure.entry(i, j) != Entry::Free);
        let mut sizes = vec![(0.0, 0usize); n];
        for omega in around(self.pace).filter(|_| n > 0) {
            let m = CMat::from_fn(n, n, |i, j| C64::new(-number(i, j), if i == j { omega } else { 0.0 }));
            let b = CMat::from_fn(n, structure.measurements(), |i, j| {
                C64::new(number(i, n + j) * self.measurements[j], 0.0)
            });
            let Ok(x) = solve_complex(&m, &b) else { continue };
            for (i, size) in sizes.iter_mut().enumerate() {
                let length = (0..x.ncols()).map(|j| x[(i, j)].norm_sqr()).sum::<f64>().sqrt();
                if length > 0.0 && length.is_finite() {
                    *size = (size.0 + length.ln(), size.1 + 1);
                }
            }
        }
        let size = |(i, (sum, count)): (usize, &(f64, usize))| {
            if is_fixed(i) && *count > 0 { (sum / *count as f64).exp() } else { 1.0 }
        };
        self.states = sizes.iter().enumerate().map(size).collect();
        self
    }

    /// The unit of entry (i, j) of \[A_K, B_K; C_K, D_K\] of a controller of an order: of the structure's, or of another with free
    /// states.
    pub fn unit(&self, order: usize, i: usize, j: usize) -> f64 {
        let state = |i: usize| if order == self.states.len() { self.states[i] } else { 1.0 };
        let row = if i < order { self.pace * state(i) } else { self.controls[i - order] };
        let col = if j < order { state(j) } else { self.measurements[j - order] };
        row / col
    }
}

/// Frequencies around a pace, evenly in their logarithm.
fn around(pace: f64) -> impl Iterator<Item = f64> {
    (0..POINTS).map(move |k| pace * 10f64.powf(DECADES * (2.0 * k as f64 / (POINTS - 1) as f64 - 1.0)))
}
