//! Which track each wheel is on, and the heights that a throw of the dice puts under the wheels.

use super::super::Vehicle;
use super::super::driven::sources;
use crate::linalg::C64;
use crate::road::{Coherence, Road};

/// Which track each wheel is on, and how far behind the foremost wheel.
pub(super) struct Tracks {
    places: Vec<f64>,
    of_wheel: Vec<usize>,
    delay_s: Vec<f64>,
}

impl Tracks {
    pub fn new(vehicle: &Vehicle, road: &Road, speed_m_s: f64) -> Self {
        let at = vehicle.wheel_places();
        let front = at.iter().map(|p| p[0]).fold(f64::NEG_INFINITY, f64::max);
        let independent = *road.coherence() == Coherence::Independent;
        let groups = sources(road.coherence(), &at);
        let places = groups.iter().map(|g| at[g[0]][1]).collect();
        let mut of_wheel = vec![0; at.len()];
        for (track, group) in groups.iter().enumerate() {
            group.iter().for_each(|w| of_wheel[*w] = track);
        }
        let delay_s = at.iter().map(|p| if independent { 0.0 } else { (front - p[0]) / speed_m_s }).collect();
        Tracks { places, of_wheel, delay_s }
    }

    /// Independent throws that a frequency takes.
    pub fn count(&self) -> usize {
        self.places.len()
    }

    /// Heights under the wheels: the Cholesky factor of the tracks' coherence times independent throws, delayed.
    pub fn wheel_inputs(
        &self,
        coherence: &Coherence,
        z: &[C64],
        size: f64,
        omega: f64,
        speed: f64,
    ) -> Vec<C64> {
        let n = self.places.len();
        let mut l = vec![0.0; n * n];
        for i in 0..n {
            for j in 0..=i {
                let gamma = match coherence {
                    Coherence::Independent => f64::from(u8::from(i == j)),
                    _ => coherence.gamma((self.places[i] - self.places[j]).abs(), omega, speed),
                };
                let dot: f64 = (0..j).map(|k| l[i * n + k] * l[j * n + k]).sum();
                l[i * n + j] = if i == j {
                    (gamma - dot).max(0.0).sqrt()
                } else if l[j * n + j] > 0.0 {
                    (gamma - dot) / l[j * n + j]
                } else {
                    0.0
                };
            }
        }
        let heights: Vec<C64> =
            (0..n).map(|i| (0..=i).map(|j| z[j] * l[i * n + j]).sum::<C64>() * size).collect();
        self.of_wheel
            .iter()
            .zip(&self.delay_s)
            .map(|(track, delay)| heights[*track] * C64::new(0.0, -omega * delay).exp())
            .collect()
    }
}
