//! A fixed-order design as a goal and bounds of smooth pieces: peaks of responses, H2 norms, eigenvalues.

use super::closed::{Closed, Open};
use super::eigenvalues::Spectrum;
use super::h2_norm::moved_resolvent;
use super::peaks::Peak;
use super::resolvent::{Resolvent, Room};
use super::scales::Scales;
use super::structure::Structure;
use super::targets::{Aim, Channel, Measure, Target};
use crate::linalg::{C64, Mat};
use crate::lti::GeneralizedPlant;
use crate::optimize::{Role, SmoothPiece};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Arc, Mutex};

/// The margin is aimed at with this more, a share of the pace.
pub(super) const BEYOND: f64 = 2e-6;

/// Work that was done.
#[derive(Debug, Default)]
pub(super) struct Counters {
    pub loops: AtomicUsize,
    pub factorisations: AtomicUsize,
    pub eigenproblems: AtomicUsize,
    pub lyapunov: AtomicUsize,
}

/// A smooth piece's name.
#[derive(Debug, Clone)]
pub(super) struct Id {
    pub target: usize,
    pub of: Of,
}

/// What it is.
#[derive(Debug, Clone)]
pub(super) enum Of {
    /// Re uᴴT(iω)v; shared, as pieces are copied more often than they are made.
    Peak(Arc<Peak>),
    /// A norm that is smooth itself.
    Smooth,
    /// The eigenvalue nearest to this.
    Eigenvalue(C64),
}

/// What is measured of a plant, with the limits of the controller among them.
pub(super) struct Wanted {
    pub plant: usize,
    pub kind: Kind,
    pub role: Role,
    /// ln of a unit or bound, or these themselves for an abscissa.
    pub unit: f64,
}

pub(super) enum Kind {
    Hinf(Channel),
    H2(Channel),
    Abscissa,
    /// The same as a bound that every loop has.
    Margin,
    /// max |λ|.
    Radius,
}

/// Plants, targets and the map from numbers to controllers.
pub(super) struct Problem {
    pub opens: Vec<Open>,
    /// Whether a plant's loop has to be stable: not that of the controller alone.
    pub stable: Vec<bool>,
    pub wanted: Vec<Wanted>,
    pub structure: Structure,
    pub free: Vec<(usize, usize)>,
    pub scales: Scales,
    /// Frequencies that are always looked at, rad/s.
    pub frequencies: Vec<f64>,
    /// −Re of every pole is at least this.
    pub margin: f64,
    /// |λ| of new states of a controller: where the margin and the controller's limits leave room.
    pub own_poles: (f64, f64),
    pub counters: Counters,
    /// What evaluations that have ended leave for the next ones.
    rooms: Mutex<Vec<Room>>,
}

impl Problem {
    pub fn new(
        plants: &[GeneralizedPlant],
        targets: &[Target],
        structure: Structure,
        limits: (Option<f64>, Option<f64>),
        margin: f64,
        frequencies: &[f64],
    ) -> Self {
        let used: Vec<(Vec<usize>, Vec<usize>)> =
            plants.iter().enumerate().map(|(k, p)| signals(p, k, targets)).collect();
        let mut opens: Vec<Open> = plants.iter().zip(&used).map(|(p, (z, w))| Open::of(p, z, w)).collect();
        let mut stable = vec![true; opens.len()];
        let mut bounds = 0;
        let mut role = |aim: Aim| match aim {
            Aim::Goal(unit) => (Role::Goal, unit),
            Aim::Bound(limit) => {
                bounds += 1;
                (Role::Bound(bounds - 1), limit)
            }
        };
        let mut wanted: Vec<Wanted> = targets
            .iter()
            .map(|t| {
                let (role, number) = role(t.aim);
                let (kind, unit) = match &t.measure {
                    Measure::Hinf(c) => (Kind::Hinf(among(c, &used[t.plant])), number.ln()),
                    Measure::H2(c) => (Kind::H2(among(c, &used[t.plant])), number.ln()),
                    Measure::Abscissa => (Kind::Abscissa, number),
                };
                Wanted { plant: t.plant, kind, role, unit }
            })
            .collect();
        let (nu, ny) = (structure.controls(), structure.measurements());
        let scales = Scales::of(plants, targets).for_structure(&structure);
        // the edge of the stable set is a bound too: norms may fall right up to it, where a mode hardly shows in them
        for plant in 0..opens.len() {
            let unit = -margin - BEYOND * scales.pace;
            wanted.push(Wanted { plant, kind: Kind::Margin, role: Role::Edge, unit });
        }
        if limits != (None, None) {
            let plant = opens.len();
            opens.push(Open::bare(nu, ny));
            stable.push(false);
            if let Some(radius) = limits.0.filter(|_| structure.order() > 0) {
                let (role, number) = role(Aim::Bound(radius));
                wanted.push(Wanted { plant, kind: Kind::Radius, role, unit: number.ln() });
            }
            if let Some(gain) = limits.1 {
                let outputs = (0..nu).map(|i| (i, 1.0)).collect();
                let (role, number) = role(Aim::Bound(gain));
                let kind = Kind::Hinf(Channel { outputs, disturbances: Vec::new() });
                wanted.push(Wanted { plant, kind, role, unit: number.ln() });
            }
        }
        Problem {
            opens,
            stable,
            wanted,
            free: structure.free(),
            structure,
            scales,
            frequencies: frequencies.to_vec(),
            own_poles: own_poles(margin, limits.0),
            margin,
            counters: Counters::default(),
            rooms: Mutex::default(),
        }
    }

    /// \[A_K, B_K; C_K, D_K\] of x.
    pub fn block(&self, x: &[f64]) -> Mat {
        use super::structure::Entry;
        let s = &self.structure;
        let mut block = Mat::from_fn(s.rows(), s.cols(), |i, j| match s.entry(i, j) {
            Entry::Fixed(v) => v,
            Entry::Free => 0.0,
        });
        for ((i, j), v) in self.free.iter().zip(x) {
            block[(*i, *j)] = v * self.scales.unit(s.order(), *i, *j);
        }
        block
    }

    /// x of a block; entries that are fixed are dropped.
    pub fn of_block(&self, block: &Mat) -> Vec<f64> {
        let order = self.structure.order();
        self.free.iter().map(|(i, j)| block[(*i, *j)] / self.scales.unit(order, *i, *j)).collect()
    }

    /// From a gradient by the block's entries to that by x.
    pub fn gradient(&self, closed: &Closed, by_block: Mat) -> Vec<f64> {
        let order = self.structure.order();
        let g = closed.back(by_block);
        self.free.iter().map(|(i, j)| g[(*i, *j)] * self.scales.unit(order, *i, *j)).collect()
    }

    pub fn close(&self, plant: usize, block: &Mat) -> Option<Closed> {
        self.counters.loops.fetch_add(1, Relaxed);
        self.opens[plant].close(block, self.structure.order())
    }

    /// Room for a loop's factorisations.
    pub fn room(&self) -> Room {
        self.rooms.lock().ok().and_then(|mut rooms| rooms.pop()).unwrap_or_default()
    }

    /// Counts what was factored, and keeps the room for the next loop.
    pub fn done(&self, resolvent: Resolvent) {
        self.counters.factorisations.fetch_add(resolvent.counted, Relaxed);
        if let Ok(mut rooms) = self.rooms.lock() {
            rooms.push(resolvent.into_room());
        }
    }

    /// The largest real part over all plants, in units of their pace, and its gradient.
    pub fn abscissa(&self, x: &[f64]) -> Option<(f64, Vec<f64>)> {
        let block = self.block(x);
        let mut worst: Option<(f64, Vec<f64>)> = None;
        for plant in (0..self.opens.len()).filter(|p| self.stable[*p]) {
            let closed = self.close(plant, &block)?;
            self.counters.eigenproblems.fetch_add(1, Relaxed);
            let spectrum = Spectrum::new(&closed.a)?;
            let k = spectrum.rightmost()?;
            let value = spectrum.values[k].re / self.scales.pace;
            if worst.as_ref().is_none_or(|w| value > w.0) {
                let by_block =
                    spectrum.derivative(k, &self.opens[plant], self.structure.order(), C64::new(1.0, 0.0))?;
                let g = self.gradient(&closed, by_block);
                worst = Some((value, g.iter().map(|v| v / self.scales.pace).collect()));
            }
        }
        worst
    }

    /// The largest real part over all plants, rad/s.
    pub fn rightmost(&self, x: &[f64]) -> Option<f64> {
        let block = self.block(x);
        let mut worst = f64::NEG_INFINITY;
        for plant in (0..self.opens.len()).filter(|p| self.stable[*p]) {
            let closed = self.close(plant, &block)?;
            self.counters.eigenproblems.fetch_add(1, Relaxed);
            let values = crate::linalg::RealSchur::only_eigenvalues(&closed.a).ok()?;
            worst = values.iter().map(|v| v.re).fold(worst, f64::max);
        }
        Some(worst)
    }

    /// ln √tr P of all loops whose poles are moved left by `shift` (rad/s), (A − γI)P + P(A − γI)ᵀ + I = 0: smooth where the
    /// abscissa is not, and large where that is near the shift. None where a moved loop is not stable.
    pub fn smoothed(&self, x: &[f64], shift: f64) -> Option<(f64, Vec<f64>)> {
        let block = self.block(x);
        let order = self.structure.order();
        let mut sum = 0.0;
        let mut gradient = vec![0.0; x.len()];
        for plant in (0..self.opens.len()).filter(|p| self.stable[*p]) {
            let closed = self.close(plant, &block)?;
            self.counters.lyapunov.fetch_add(2, Relaxed);
            let (squared, by_block) = moved_resolvent(&self.opens[plant], &closed, order, shift)?;
            sum += squared;
            let g = self.gradient(&closed, by_block);
            gradient.iter_mut().zip(&g).for_each(|(a, b)| *a += b);
        }
        gradient.iter_mut().for_each(|g| *g /= 2.0 * sum);
        (sum > 0.0 && sum.is_finite()).then(|| (0.5 * sum.ln(), gradient))
    }

    /// Wants as they are at x: the largest over their pieces, as norms and rad/s.
    pub fn values(&self, pieces: &[SmoothPiece<Id>]) -> Vec<f64> {
        let mut values = vec![f64::NEG_INFINITY; self.wanted.len()];
        for p in pieces {
            values[p.id.target] = values[p.id.target].max(p.value);
        }
        values
    }
}

/// The least and the largest |λ| of states that a controller is given to begin with.
pub(super) fn own_poles(margin: f64, max_pole: Option<f64>) -> (f64, f64) {
    let most = max_pole.unwrap_or(f64::INFINITY);
    let (slowest, fastest) = (2.0 * margin, 0.5 * most);
    let middle = (margin * most).sqrt();
    if slowest <= fastest { (slowest, fastest) } else { (middle, middle) }
}

/// Performances and disturbances of a plant that its targets ask about, ascending.
fn signals(plant: &GeneralizedPlant, number: usize, targets: &[Target]) -> (Vec<usize>, Vec<usize>) {
    let (mut outputs, mut disturbances) = (Vec::new(), Vec::new());
    for t in targets.iter().filter(|t| t.plant == number) {
        if let Measure::Hinf(c) | Measure::H2(c) = &t.measure {
            outputs.extend(c.outputs.iter().map(|o| o.0));
            if c.disturbances.is_empty() {
                disturbances.extend(0..plant.nw());
            }
            disturbances.extend(&c.disturbances);
        }
    }
    for list in [&mut outputs, &mut disturbances] {
        list.sort_unstable();
        list.dedup();
    }
    (outputs, disturbances)
}

/// A channel in the numbers of the signals used.
fn among(channel: &Channel, (outputs, disturbances): &(Vec<usize>, Vec<usize>)) -> Channel {
    let place = |list: &[usize], signal: usize| list.iter().position(|s| *s == signal).unwrap_or(0);
    let all: Vec<usize> = (0..disturbances.len()).collect();
    let named = channel.disturbances.iter().map(|w| place(disturbances, *w)).collect();
    Channel {
        outputs: channel.outputs.iter().map(|(z, weight)| (place(outputs, *z), *weight)).collect(),
        disturbances: if channel.disturbances.is_empty() { all } else { named },
    }
}
