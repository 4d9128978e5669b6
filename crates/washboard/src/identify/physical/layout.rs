//! Where each parameter of a physical fit stands.

use crate::identify::likelihood::RoadValues;

/// θ of one recording: logarithms of the vehicle's parameters, ln S₀, e, ln μ, ln of the delay's factor, clock offsets
/// in s, ln noise.
#[derive(Debug, Clone)]
pub(super) struct Layout {
    pub vehicle: usize,
    pub mu: Option<usize>,
    pub delay: Option<usize>,
    pub clocks: Option<usize>,
    pub noise: usize,
    pub channels: usize,
}

/// What a parameter is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Vehicle,
    Roughness,
    Exponent,
    Mu,
    Delay,
    /// Of a channel.
    Clock(usize),
    /// Of a channel.
    Noise(usize),
}

impl Layout {
    pub fn new(vehicle: usize, tracks: bool, axles: bool, clocks: bool, channels: usize) -> Self {
        let mut next = vehicle + 2;
        let mut take = |yes: bool, count: usize| {
            yes.then(|| {
                next += count;
                next - count
            })
        };
        let (mu, delay) = (take(tracks, 1), take(axles, 1));
        let clocks = take(clocks, channels);
        Layout { vehicle, mu, delay, clocks, noise: next, channels }
    }

    pub fn s0(&self) -> usize {
        self.vehicle
    }

    pub fn exponent(&self) -> usize {
        self.vehicle + 1
    }

    pub fn len(&self) -> usize {
        self.noise + self.channels
    }

    pub fn road(&self, theta: &[f64]) -> RoadValues {
        RoadValues {
            ln_s0: theta[self.s0()],
            exponent: theta[self.exponent()],
            mu: self.mu.map_or(0.0, |i| theta[i].exp()),
            ln_delay: self.delay.map_or(0.0, |i| theta[i]),
        }
    }

    pub fn kind(&self, i: usize) -> Kind {
        match i {
            i if i < self.vehicle => Kind::Vehicle,
            i if i == self.s0() => Kind::Roughness,
            i if i == self.exponent() => Kind::Exponent,
            i if Some(i) == self.mu => Kind::Mu,
            i if Some(i) == self.delay => Kind::Delay,
            i if i >= self.noise => Kind::Noise(i - self.noise),
            i => Kind::Clock(i - self.clocks.unwrap_or(i)),
        }
    }
}

impl Kind {
    pub fn words(self) -> &'static str {
        match self {
            Kind::Vehicle => "a parameter of the vehicle",
            Kind::Roughness => "the road's roughness",
            Kind::Exponent => "the road's exponent",
            Kind::Mu => "the coherence's mu",
            Kind::Delay => "the delay",
            Kind::Clock(_) => "a sensor's clock",
            Kind::Noise(_) => "a noise floor",
        }
    }
}
