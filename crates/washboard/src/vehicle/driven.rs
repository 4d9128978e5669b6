//! A vehicle on a road with a rational shaping filter, as one state space driven by white noise.

use super::{Output, Vehicle};
use crate::linalg::{LinalgError, Mat, solve};
use crate::road::{Coherence, Road, SAME_TRACK_M, Shapes};

/// Entries of a feedthrough below this share of the terms that they are a sum of are rounding.
const CANCELLED: f64 = 1e-10;

/// ẋ = A x + B ξ, y = C x: every wheel's own filter, driven by its own ξ; which ξ are one is said by `source`.
pub(super) struct Driven {
    pub a: Mat,
    /// States × wheels.
    pub b: Mat,
    /// Outputs × states; a row means nothing where the output is not [`Growth::Finite`].
    pub c: Mat,
    pub growth: Vec<Growth>,
    /// What the rows of C are.
    pub outputs: Vec<Output>,
}

/// What becomes of an output's variance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Growth {
    /// The state space gives it.
    Finite,
    /// It contains white noise: infinite.
    White,
    /// It contains differences of wandering road heights that belong together: finite, by quadrature only.
    Difference,
    /// It follows a road height that wanders off: infinite.
    Wandering,
}

impl Driven {
    /// None where the road has no rational filter.
    pub fn new(
        vehicle: &Vehicle,
        road: &Road,
        speed_m_s: f64,
        outputs: &[&Output],
    ) -> Result<Option<Self>, LinalgError> {
        let Some(filter) = road.spectrum().shaping_filter(speed_m_s) else { return Ok(None) };
        let system = vehicle.system();
        let (n, w, nf) = (system.order(), vehicle.wheels().len(), filter.a().nrows());
        let over_m = |x: &Mat| solve(system.m(), x);
        let (mk, mc) = (over_m(system.k())?, over_m(system.c())?);
        let (mkw, mcw) = (over_m(vehicle.wheel_stiffness())?, over_m(vehicle.wheel_damping())?);
        let velocity = filter.of() == Shapes::Velocity;
        // Height: x = [q, q̇, x_f]. Velocity: q̃ = q − T r replaces q, and only ṙ enters; T = K⁻¹K_w is where the
        // vehicle rests on a road that stands still.
        let t = if velocity { solve(system.k(), vehicle.wheel_stiffness())? } else { Mat::zeros(n, w) };
        let size = 2 * n + w * nf;
        let (fa, fb, fc, fd) = (filter.a(), filter.b(), filter.c(), filter.d());
        // r (height) or ṙ (velocity) of wheel j is C x_j + D ξ_j; of a height filter ṙ = CA x_j + CB ξ_j (+ D ξ̇)
        let ca: Vec<f64> = (0..nf).map(|k| (0..nf).map(|i| fc[i] * fa[(i, k)]).sum()).collect();
        let cb: f64 = (0..nf).map(|i| fc[i] * fb[i]).sum();
        let (rate_c, rate_d): (&[f64], f64) = if velocity { (fc, fd) } else { (&ca, cb) };
        let xf = |j: usize, k: usize| 2 * n + j * nf + k;
        // a white height through a damped tire makes velocities white: q̇ − M⁻¹C_w D ξ takes their place in the state
        let jump = Mat::from_fn(n, w, |i, j| if velocity { 0.0 } else { mcw[(i, j)] * fd });
        let mut a = Mat::zeros(size, size);
        let mut b = Mat::zeros(size, w);
        for i in 0..n {
            a[(i, n + i)] = 1.0;
            for j in 0..n {
                a[(n + i, j)] = -mk[(i, j)];
                a[(n + i, n + j)] = -mc[(i, j)];
            }
            for j in 0..w {
                for k in 0..nf {
                    a[(i, xf(j, k))] = -t[(i, j)] * rate_c[k];
                    a[(n + i, xf(j, k))] = mcw[(i, j)] * rate_c[k];
                    if !velocity {
                        a[(n + i, xf(j, k))] += mkw[(i, j)] * fc[k];
                    }
                }
                b[(i, j)] = -t[(i, j)] * rate_d + jump[(i, j)];
                let slowed: f64 = (0..n).map(|k| mc[(i, k)] * jump[(k, j)]).sum();
                b[(n + i, j)] = mcw[(i, j)] * rate_d - slowed + if velocity { 0.0 } else { mkw[(i, j)] * fd };
            }
        }
        for j in 0..w {
            for k in 0..nf {
                for l in 0..nf {
                    a[(xf(j, k), xf(j, l))] = fa[(k, l)];
                }
                b[(xf(j, k), j)] = fb[k];
            }
        }
        let sources = sources(road.coherence(), &vehicle.wheel_places());
        let mut c = Mat::zeros(outputs.len(), size);
        let mut growth = Vec::with_capacity(outputs.len());
        for (row, out) in outputs.iter().enumerate() {
            // white[j]: coefficient of ξ_j; unbounded[j]: of its derivatives; height[j]: of r_j that wanders
            let mut white = vec![Sum::default(); w];
            let mut unbounded = vec![Sum::default(); w];
            let mut height = vec![Sum::default(); w];
            let mut add = |col: usize, v: f64| c[(row, col)] += v;
            for (d, q) in out.q.iter().enumerate() {
                for (i, v) in q.iter().enumerate().filter(|(_, v)| **v != 0.0) {
                    match d {
                        0 => {
                            add(i, *v);
                            for j in 0..w {
                                height[j].add(v * t[(i, j)]);
                            }
                        }
                        1 => {
                            add(n + i, *v);
                            for j in 0..w {
                                white[j].add(v * jump[(i, j)]);
                            }
                        }
                        _ => {
                            for j in 0..w {
                                unbounded[j].add(v * jump[(i, j)]);
                            }
                            for col in 0..size {
                                add(col, v * a[(n + i, col)]);
                            }
                            for j in 0..w {
                                white[j].add(v * b[(n + i, j)]);
                            }
                        }
                    }
                }
            }
            for (d, r) in out.r.iter().enumerate() {
                for (j, v) in r.iter().enumerate().filter(|(_, v)| **v != 0.0) {
                    match (d, velocity) {
                        (0, true) => height[j].add(*v),
                        (0, false) => {
                            for k in 0..nf {
                                add(xf(j, k), v * fc[k]);
                            }
                            white[j].add(v * fd);
                        }
                        (1, _) => {
                            for k in 0..nf {
                                add(xf(j, k), v * rate_c[k]);
                            }
                            white[j].add(v * rate_d);
                            unbounded[j].add(if velocity { 0.0 } else { v * fd });
                        }
                        _ => unbounded[j].add(*v),
                    }
                }
            }
            growth.push(if white.iter().chain(&unbounded).any(|s| !s.is_zero()) {
                Growth::White
            } else if height.iter().all(Sum::is_zero) {
                Growth::Finite
            } else if sources
                .iter()
                .all(|group| group.iter().fold(Sum::default(), |s, j| s.plus(height[*j])).is_zero())
            {
                Growth::Difference
            } else {
                Growth::Wandering
            });
        }
        let outputs = outputs.iter().map(|o| (*o).clone()).collect();
        Ok(Some(Driven { a, b, c, growth, outputs }))
    }
}

/// Wheels grouped by the track that they follow: those of one group repeat each other.
pub(super) fn sources(coherence: &Coherence, at_m: &[[f64; 2]]) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (j, at) in at_m.iter().enumerate() {
        let same = |g: &Vec<usize>| match coherence {
            Coherence::Independent => false,
            Coherence::Full => true,
            Coherence::None => (at_m[g[0]][1] - at[1]).abs() < SAME_TRACK_M,
            Coherence::Bogsjo { mu } => *mu == 0.0 || at_m[g[0]][1] == at[1],
        };
        match groups.iter_mut().find(|g| same(g)) {
            Some(group) => group.push(j),
            None => groups.push(vec![j]),
        }
    }
    groups
}

/// A sum that knows the size of its terms, so that it can tell a cancellation from a small value.
#[derive(Debug, Clone, Copy, Default)]
struct Sum {
    value: f64,
    size: f64,
}

impl Sum {
    fn add(&mut self, v: f64) {
        self.value += v;
        self.size += v.abs();
    }

    fn plus(self, other: Sum) -> Sum {
        Sum { value: self.value + other.value, size: self.size + other.size }
    }

    fn is_zero(&self) -> bool {
        self.value.abs() <= CANCELLED * self.size
    }
}
