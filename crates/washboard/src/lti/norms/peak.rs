//! The largest singular value at a frequency, and its local maximum near one.

use crate::linalg::{C64, CMat};
use crate::lti::{LtiError, Time};

/// Brent's steps to a local maximum: each but the first few gains more than a digit.
const MOST_STEPS: usize = 80;
/// A place is not looked for any finer than this share of the frequency.
const PLACE: f64 = 1e-13;
/// Two steps of a parabola that gain less than this share of the height end the climb.
const FLAT: f64 = 1e-12;
/// The golden section.
const GOLDEN: f64 = 0.381_966_011_250_105;

/// σ_max(G) over frequency, counted.
pub(crate) struct Gain<F: Fn(f64) -> Result<f64, LtiError>> {
    height: F,
    pub evaluations: usize,
    /// Two steps of a parabola that gain less than this share of the height end a climb.
    pub flat: f64,
}

impl<F: Fn(f64) -> Result<f64, LtiError>> Gain<F> {
    pub fn new(height: F) -> Self {
        Gain { height, evaluations: 0, flat: FLAT }
    }

    /// At a frequency; +∞ on a pole.
    pub fn at(&mut self, omega: f64) -> f64 {
        self.evaluations += 1;
        (self.height)(omega).unwrap_or(f64::INFINITY)
    }

    /// The highest point found between two frequencies, from one inside whose peak is about so wide (0: not known), by
    /// parabolas and golden sections on 1/σ², which near a resonance is a parabola.
    ///
    /// Source: Brent, *Algorithms for Minimization without Derivatives* (1973), ch. 5.
    pub fn climb(&mut self, low: f64, inside: (f64, f64), high: f64, width: f64) -> (f64, f64) {
        if !(inside.1 > 0.0 && inside.1.is_finite() && low < high) {
            return inside;
        }
        let mut bracket = Bracket::new(low, inside, high);
        if width > 0.0 {
            for u in [inside.0 - width, inside.0 + width] {
                if u > bracket.low && u < bracket.high {
                    bracket.take((u, self.at(u)));
                }
            }
        }
        let mut flat = 0;
        for _ in 0..MOST_STEPS {
            let Some((u, parabola)) = bracket.next() else { break };
            let before = bracket.best.1;
            let value = self.at(u);
            bracket.take((u, value));
            flat = if parabola && (value - before).abs() <= self.flat * before { flat + 1 } else { 0 };
            if flat == 2 || bracket.best.1 == f64::INFINITY {
                break;
            }
        }
        bracket.best
    }
}

/// Brent's state: an interval, the highest point in it and the two next.
struct Bracket {
    low: f64,
    high: f64,
    best: (f64, f64),
    second: (f64, f64),
    third: (f64, f64),
    /// The step before the last, and the last.
    steps: [f64; 2],
}

impl Bracket {
    fn new(low: f64, best: (f64, f64), high: f64) -> Self {
        Bracket { low, high, best, second: best, third: best, steps: [high - low; 2] }
    }

    /// Where to look next and whether a parabola says so; none where the interval is as small as its rounding.
    fn next(&mut self) -> Option<(f64, bool)> {
        let (a, b, x) = (self.low, self.high, self.best.0);
        let middle = 0.5 * (a + b);
        let tolerance = PLACE * x.abs().max(f64::MIN_POSITIVE);
        if (x - middle).abs() <= 2.0 * tolerance - 0.5 * (b - a) {
            return None;
        }
        // (σ_best/σ)²: 1 at the best
        let depth = |point: (f64, f64)| (self.best.1 / point.1).powi(2);
        let (w, v) = (self.second, self.third);
        let r = (x - w.0) * (1.0 - depth(v));
        let q = (x - v.0) * (1.0 - depth(w));
        let (p, q) = ((x - v.0) * q - (x - w.0) * r, 2.0 * (q - r));
        let (p, q) = if q > 0.0 { (-p, q) } else { (p, -q) };
        let [before_last, last] = self.steps;
        let parabola = before_last.abs() > tolerance
            && p.abs() < (0.5 * q * before_last).abs()
            && p > q * (a - x)
            && p < q * (b - x);
        let step = if parabola {
            self.steps[0] = last;
            let d = p / q;
            let near_end = x + d - a < 2.0 * tolerance || b - (x + d) < 2.0 * tolerance;
            if near_end { tolerance.copysign(middle - x) } else { d }
        } else {
            self.steps[0] = if x < middle { b - x } else { a - x };
            GOLDEN * self.steps[0]
        };
        self.steps[1] = step;
        let u = if step.abs() >= tolerance { x + step } else { x + tolerance.copysign(step) };
        Some((u, parabola))
    }

    /// A point that was looked at.
    fn take(&mut self, u: (f64, f64)) {
        let x = self.best;
        if u.1 >= x.1 {
            if u.0 < x.0 {
                self.high = x.0;
            } else {
                self.low = x.0;
            }
            (self.third, self.second, self.best) = (self.second, x, u);
            return;
        }
        if u.0 < x.0 {
            self.low = u.0;
        } else {
            self.high = u.0;
        }
        if u.1 >= self.second.1 || self.second.0 == x.0 {
            (self.third, self.second) = (self.second, u);
        } else if u.1 >= self.third.1 || self.third.0 == x.0 || self.third.0 == self.second.0 {
            self.third = u;
        }
    }
}

/// σ_max of a complex matrix: of a row or column its length.
pub(crate) fn largest_singular_value(g: &CMat) -> f64 {
    let (p, m) = (g.nrows(), g.ncols());
    if p == 0 || m == 0 {
        return 0.0;
    }
    let size = (0..m).flat_map(|j| (0..p).map(move |i| (i, j))).fold(0.0f64, |s, k| {
        let z = g[k];
        s.max(z.re.abs()).max(z.im.abs())
    });
    if !(size > 0.0 && size.is_finite()) {
        return if size == 0.0 { 0.0 } else { f64::INFINITY };
    }
    // the Gram matrix of the smaller side: the largest value loses nothing by squaring
    let (least, long) = (p.min(m), p.max(m));
    let entry = |i: usize, k: usize| (if p < m { g[(i, k)] } else { g[(k, i)].conj() }) / size;
    let gram = |i: usize, j: usize| (0..long).map(|k| entry(i, k) * entry(j, k).conj()).sum::<C64>();
    let largest = match least {
        1 => gram(0, 0).re,
        2 => {
            let (a, b, d) = (gram(0, 0).re, gram(1, 0).norm(), gram(1, 1).re);
            0.5 * (a + d) + (0.5 * (a - d)).hypot(b)
        }
        _ => {
            let gram =
                CMat::from_fn(least, least, |i, j| if i < j { C64::new(0.0, 0.0) } else { gram(i, j) });
            let values = gram.self_adjoint_eigenvalues(faer::Side::Lower);
            values.ok().and_then(|v| v.last().copied()).unwrap_or(f64::INFINITY)
        }
    };
    if largest.is_nan() { f64::INFINITY } else { size * largest.max(0.0).sqrt() }
}

/// Where a pole has its peak, and how wide that is.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hint {
    pub omega: f64,
    pub width: f64,
}

/// The poles' frequencies worth a look, ascending: of a pair the peak's own, of a real pole its rate.
pub(super) fn hints<T: Time>(time: T, poles: &[C64]) -> Vec<Hint> {
    let mut all: Vec<Hint> = poles
        .iter()
        .filter(|p| p.im >= 0.0)
        .map(|p| {
            let (omega, width) = time.peak(*p);
            Hint { omega, width }
        })
        .filter(|h| h.omega > 0.0 && h.omega.is_finite())
        .collect();
    all.sort_by(|x, y| x.omega.total_cmp(&y.omega));
    all.dedup_by(|x, y| (x.omega - y.omega).abs() <= 1e-14 * y.omega);
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_singular_value_is_that_of_the_svd() {
        for (r, c) in [(1, 4), (4, 1), (2, 2), (2, 7), (7, 2), (3, 5), (5, 3), (4, 4)] {
            let g = CMat::from_fn(r, c, |i, j| C64::new((3 * i + 5 * j) as f64, (7 * i * j) as f64 - 3.0));
            let expected = g.singular_values().unwrap()[0];
            assert!((largest_singular_value(&g) / expected - 1.0).abs() < 1e-14, "{r} × {c}");
        }
        assert_eq!(largest_singular_value(&CMat::zeros(2, 3)), 0.0);
        assert_eq!(largest_singular_value(&CMat::zeros(0, 3)), 0.0);
    }

    #[test]
    fn a_resonance_of_known_width_is_climbed_in_a_few_steps() {
        let (at, zeta) = (3.0, 1e-5);
        let mut gain = Gain::new(|w: f64| Ok(C64::new(at * at - w * w, 2.0 * zeta * at * w).inv().norm()));
        let start = (at * (1.0 + 0.7 * zeta), gain.at(at * (1.0 + 0.7 * zeta)));
        let (place, height) = gain.climb(0.1, start, 50.0, zeta * at);
        assert!((height * 2.0 * zeta * at * at - 1.0).abs() < 1e-9 && (place / at - 1.0).abs() < 1e-9);
        assert!(gain.evaluations <= 10, "{}", gain.evaluations);
        // without the width, by sections: more steps, the same peak
        let (place, height) = gain.climb(2.0, start, 4.0, 0.0);
        assert!((height * 2.0 * zeta * at * at - 1.0).abs() < 1e-9 && (place / at - 1.0).abs() < 1e-9);
    }
}
