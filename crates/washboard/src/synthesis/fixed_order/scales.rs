//! Units in which a controller's entries are of the order of 1.

use super::targets::{Aim, Measure, Target};
use crate::lti::GeneralizedPlant;

/// Frequencies around the plants' pace at which gains are looked at.
const POINTS: usize = 25;
/// Decades to each side.
const DECADES: f64 = 1.5;

/// Units of time, of each measurement and of each control.
#[derive(Debug, Clone)]
pub(super) struct Scales {
    /// rad/s.
    pub pace: f64,
    pub measurements: Vec<f64>,
    pub controls: Vec<f64>,
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
            return Scales { pace, measurements: Vec::new(), controls: Vec::new() };
        };
        let omegas: Vec<f64> = (0..POINTS)
            .map(|k| pace * 10f64.powf(DECADES * (2.0 * k as f64 / (POINTS - 1) as f64 - 1.0)))
            .collect();
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
        let over = |of: &dyn Fn(&crate::linalg::CMat) -> f64| {
            let found: Vec<f64> = responses.iter().map(of).filter(|v| *v > 0.0 && v.is_finite()).collect();
            mean(&found)
        };
        let row =
            |g: &crate::linalg::CMat, i: usize| (0..nw).map(|j| g[(i, j)].norm_sqr()).sum::<f64>().sqrt();
        let column = |g: &crate::linalg::CMat, j: usize| {
            (0..nz).map(|i| (weights[i] * g[(i, j)].norm()).powi(2)).sum::<f64>().sqrt()
        };
        let measurements = (0..plant.ny()).map(|i| over(&|g| row(g, nz + i))).collect();
        let disturbed = over(&|g| (0..nw).map(|j| column(g, j).powi(2)).sum::<f64>().sqrt());
        let controls = (0..plant.nu()).map(|j| disturbed / over(&|g| column(g, nw + j))).collect();
        Scales { pace, measurements, controls }
    }

    /// The unit of entry (i, j) of \[A_K, B_K; C_K, D_K\].
    pub fn unit(&self, order: usize, i: usize, j: usize) -> f64 {
        let row = if i < order { self.pace } else { self.controls[i - order] };
        let col = if j < order { 1.0 } else { 1.0 / self.measurements[j - order] };
        row * col
    }
}
