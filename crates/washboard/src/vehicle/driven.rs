//! A vehicle on a road with a rational shaping filter, as one state space driven by white noise.

use super::{Output, Vehicle};
use crate::linalg::{LinalgError, Mat, solve};
use crate::lti::{Continuous, LtiError, StateSpace};
use crate::road::{Coherence, Excitation, SAME_TRACK_M, Shapes, WheelFilter};

/// Entries of a feedthrough below this share of the terms that they are a sum of are rounding.
const CANCELLED: f64 = 1e-10;

/// ẋ = A x + B ξ, y = C x with x = [q, q̇, x_f]. On a road of tracks every wheel has its own filter, driven by its own ξ; which
/// ξ are one is said by [`sources`].
pub(super) struct Driven {
    pub a: Mat,
    /// States × noises.
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
        road: Excitation<'_>,
        speed_m_s: f64,
        outputs: &[&Output],
    ) -> Result<Option<Self>, LinalgError> {
        let Some(filter) = road.wheel_filter(vehicle.wheels().len(), speed_m_s) else { return Ok(None) };
        Driven::by(vehicle, &filter, &standing(vehicle, road, &filter)?, outputs).map(Some)
    }

    /// The same with states scaled by powers of two: displacements beside velocities of a stiff tire are 1e-6 of them, and Lyapunov's
    /// equation is solved to the largest.
    pub fn balanced(mut self) -> Result<Self, LtiError> {
        let seen = |i: usize, j: usize| if self.growth[i] == Growth::Finite { self.c[(i, j)] } else { 0.0 };
        let c = Mat::from_fn(self.c.nrows(), self.c.ncols(), seen);
        let none = Mat::zeros(c.nrows(), self.b.ncols());
        let (_, scales) =
            StateSpace::continuous(self.a.clone(), self.b.clone(), c, none)?.balanced_scales()?;
        let times = |m: &Mat, by: &dyn Fn(usize, usize) -> f64| {
            Mat::from_fn(m.nrows(), m.ncols(), |i, j| m[(i, j)] * by(i, j))
        };
        self.a = times(&self.a, &|i, j| scales[i] / scales[j]);
        self.b = times(&self.b, &|i, _| scales[i]);
        self.c = times(&self.c, &|_, j| 1.0 / scales[j]);
        Ok(self)
    }

    /// The vehicle behind a filter of all its wheels; `together` are combinations of heights that belong together: rows of
    /// factors of every wheel, each of which must vanish if an output is to follow no height that wanders.
    pub fn by(
        vehicle: &Vehicle,
        filter: &WheelFilter,
        together: &[Vec<f64>],
        outputs: &[&Output],
    ) -> Result<Self, LinalgError> {
        let system = vehicle.system();
        let (n, w) = (system.order(), vehicle.wheels().len());
        let (nf, nx) = (filter.a.nrows(), filter.b.ncols());
        let over_m = |x: &Mat| solve(system.m(), x);
        let (mk, mc) = (over_m(system.k())?, over_m(system.c())?);
        let (mkw, mcw) = (over_m(vehicle.wheel_stiffness())?, over_m(vehicle.wheel_damping())?);
        let velocity = filter.of == Shapes::Velocity;
        // Height: x = [q, q̇, x_f]. Velocity: q̃ = q − T r replaces q, and only ṙ enters; T = K⁻¹K_w is where the
        // vehicle rests on a road that stands still.
        let (t, t_size) = if velocity { resting(vehicle)? } else { (Mat::zeros(n, w), Mat::zeros(n, w)) };
        let size = 2 * n + nf;
        // r (height) or ṙ (velocity) is C x + D ξ; of a height filter ṙ = CA x + CB ξ (+ D ξ̇), r̈ = CA² x + CAB ξ (+ CB ξ̇ + D ξ̈)
        let own = (filter.c.clone(), filter.d.clone());
        let first = slope(&own.0, filter);
        let second = slope(&first.0, filter);
        let derivatives =
            if velocity { [None, Some(own), Some(first)] } else { [Some(own), Some(first), Some(second)] };
        let none = (Mat::zeros(w, nf), Mat::zeros(w, nx));
        let [height_cd, rate_cd, _] = &derivatives;
        let ((height_c, height_d), (rate_c, rate_d)) =
            (height_cd.as_ref().unwrap_or(&none), rate_cd.as_ref().unwrap_or(&none));
        // a white height through a damped tire makes velocities white: q̇ − M⁻¹C_w D ξ takes their place in the state
        let jump = &mcw * height_d;
        let (moved_c, moved_d) = (&t * rate_c, &t * rate_d);
        let force_c = &mcw * rate_c + &mkw * height_c;
        let force_d = &mcw * rate_d + &mkw * height_d - &mc * &jump;
        let mut a = Mat::zeros(size, size);
        let mut b = Mat::zeros(size, nx);
        for i in 0..n {
            a[(i, n + i)] = 1.0;
            for j in 0..n {
                a[(n + i, j)] = -mk[(i, j)];
                a[(n + i, n + j)] = -mc[(i, j)];
            }
            for k in 0..nf {
                a[(i, 2 * n + k)] = -moved_c[(i, k)];
                a[(n + i, 2 * n + k)] = force_c[(i, k)];
            }
            for x in 0..nx {
                b[(i, x)] = jump[(i, x)] - moved_d[(i, x)];
                b[(n + i, x)] = force_d[(i, x)];
            }
        }
        for k in 0..nf {
            for l in 0..nf {
                a[(2 * n + k, 2 * n + l)] = filter.a[(k, l)];
            }
            for x in 0..nx {
                b[(2 * n + k, x)] = filter.b[(k, x)];
            }
        }
        let mut c = Mat::zeros(outputs.len(), size);
        let mut growth = Vec::with_capacity(outputs.len());
        for (row, out) in outputs.iter().enumerate() {
            // white[x]: coefficient of ξ_x; unbounded[x]: of its derivatives; height[j]: of r_j that wanders
            let mut white = vec![Sum::default(); nx];
            let mut unbounded = vec![Sum::default(); nx];
            let mut height = vec![Sum::default(); w];
            let mut add = |col: usize, v: f64| c[(row, col)] += v;
            let noise = |sums: &mut Vec<Sum>, v: f64, of: &Mat, at: usize| {
                sums.iter_mut().enumerate().for_each(|(x, s)| s.add(v * of[(at, x)]));
            };
            for (d, q) in out.q.iter().enumerate() {
                for (i, v) in q.iter().enumerate().filter(|(_, v)| **v != 0.0) {
                    match d {
                        0 => {
                            add(i, *v);
                            for (j, h) in height.iter_mut().enumerate() {
                                *h = h.plus(Sum { value: t[(i, j)], size: t_size[(i, j)] }.times(*v));
                            }
                        }
                        1 => {
                            add(n + i, *v);
                            noise(&mut white, *v, &jump, i);
                        }
                        _ => {
                            noise(&mut unbounded, *v, &jump, i);
                            (0..size).for_each(|col| add(col, v * a[(n + i, col)]));
                            noise(&mut white, *v, &b, n + i);
                        }
                    }
                }
            }
            for (d, r) in out.r.iter().enumerate() {
                for (j, v) in r.iter().enumerate().filter(|(_, v)| **v != 0.0) {
                    match &derivatives[d] {
                        // of a velocity filter the height wanders
                        None => height[j].add(*v),
                        Some((rows, noises)) => {
                            (0..nf).for_each(|k| add(2 * n + k, v * rows[(j, k)]));
                            noise(&mut white, *v, noises, j);
                            // what lower derivatives have as white noise, this one has as its derivative
                            for (_, lower) in derivatives[..d].iter().flatten() {
                                noise(&mut unbounded, *v, lower, j);
                            }
                        }
                    }
                }
            }
            let vanishes = |factors: &Vec<f64>| {
                let products = factors.iter().zip(&height).map(|(f, h)| h.times(*f));
                products.fold(Sum::default(), Sum::plus).is_zero()
            };
            growth.push(if white.iter().chain(&unbounded).any(|s| !s.is_zero()) {
                Growth::White
            } else if height.iter().all(Sum::is_zero) {
                Growth::Finite
            } else if together.iter().all(vanishes) {
                Growth::Difference
            } else {
                Growth::Wandering
            });
        }
        let outputs = outputs.iter().map(|o| (*o).clone()).collect();
        Ok(Driven { a, b, c, growth, outputs })
    }

    /// From [ξ; u] to outputs, u forces of some actuators.
    pub fn with_forces(
        &self,
        vehicle: &Vehicle,
        actuators: &[usize],
    ) -> Result<StateSpace<Continuous>, LtiError> {
        let (n, w, q) = (self.a.nrows(), self.b.ncols(), vehicle.system().order());
        let force = solve(vehicle.system().m(), &vehicle.actuator_columns(actuators))?;
        let pushed = |i: usize, j: usize| if (q..2 * q).contains(&i) { force[(i - q, j)] } else { 0.0 };
        let b =
            Mat::from_fn(n, w + force.ncols(), |i, j| if j < w { self.b[(i, j)] } else { pushed(i, j - w) });
        let d = Mat::from_fn(self.outputs.len(), w + force.ncols(), |i, j| {
            let Some((j, actuator)) = j.checked_sub(w).map(|j| (j, actuators[j])) else { return 0.0 };
            let output = &self.outputs[i];
            let through: f64 = output.q[2].iter().enumerate().map(|(k, v)| v * force[(k, j)]).sum();
            through + output.u.get(actuator).copied().unwrap_or(0.0)
        });
        StateSpace::continuous(self.a.clone(), b, self.c.clone(), d)
    }
}

/// Where a vehicle rests on wheels' heights, T = K⁻¹K_w, and the size of what each entry is computed from, |K⁻¹| |K| |T|: a solution whose
/// backward error is ε |K| is wrong by ε of that (Higham, Accuracy and Stability of Numerical Algorithms, 2nd ed., (7.25)). A wheel
/// rests on its own height alone, and Gaussian elimination leaves 1e-17 of the other's: no size by itself, and rounding beside this one.
pub(super) fn resting(vehicle: &Vehicle) -> Result<(Mat, Mat), LinalgError> {
    let k = vehicle.system().k();
    let t = solve(k, vehicle.wheel_stiffness())?;
    let inverse = solve(k, &Mat::identity(k.nrows(), k.nrows()))?;
    let size = magnitudes(&inverse) * magnitudes(k) * magnitudes(&t);
    Ok((t, size))
}

fn magnitudes(m: &Mat) -> Mat {
    Mat::from_fn(m.nrows(), m.ncols(), |i, j| m[(i, j)].abs())
}

/// Rows C A and C B of the derivative of C x; a coefficient that has cancelled is zero.
fn slope(c: &Mat, filter: &WheelFilter) -> (Mat, Mat) {
    let through = Mat::from_fn(c.nrows(), filter.b.ncols(), |i, x| {
        let mut sum = Sum::default();
        (0..c.ncols()).for_each(|k| sum.add(c[(i, k)] * filter.b[(k, x)]));
        if sum.is_zero() { 0.0 } else { sum.value }
    });
    (c * &filter.a, through)
}

/// Combinations of heights that move together where heights wander: wheels of one track, or what a filter lets through at
/// rest (the columns of G(0)).
fn standing(
    vehicle: &Vehicle,
    road: Excitation<'_>,
    filter: &WheelFilter,
) -> Result<Vec<Vec<f64>>, LinalgError> {
    let w = vehicle.wheels().len();
    match road {
        Excitation::Road(road) => {
            let of = |group: Vec<usize>| (0..w).map(|j| f64::from(u8::from(group.contains(&j)))).collect();
            Ok(sources(road.coherence(), &vehicle.wheel_places()).into_iter().map(of).collect())
        }
        Excitation::Points(_) => {
            let rest = if filter.a.nrows() == 0 {
                filter.d.clone()
            } else {
                &filter.d - &filter.c * solve(&filter.a, &filter.b)?
            };
            Ok((0..rest.ncols()).map(|x| (0..w).map(|j| rest[(j, x)]).collect()).collect())
        }
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

    fn times(self, factor: f64) -> Sum {
        Sum { value: self.value * factor, size: self.size * factor.abs() }
    }

    fn is_zero(&self) -> bool {
        self.value.abs() <= CANCELLED * self.size
    }
}
