//! The largest singular value at a frequency, and its local maximum near one.

use crate::linalg::{C64, CMat};
use crate::lti::{Continuous, Responder};

/// Brent's steps to a local maximum: each but the first few gains more than a digit.
const MOST_STEPS: usize = 60;
/// A maximum is flat: its place is known to the root of what its height is known to.
const PLACE: f64 = 1e-9;
/// The golden section.
const GOLDEN: f64 = 0.381_966_011_250_105;

/// σ_max(G(iω)) of one system, counted.
pub(super) struct Gain<'a> {
    responder: &'a Responder<Continuous>,
    pub evaluations: usize,
}

impl<'a> Gain<'a> {
    pub fn new(responder: &'a Responder<Continuous>) -> Self {
        Gain { responder, evaluations: 0 }
    }

    /// At a frequency; +∞ on a pole.
    pub fn at(&mut self, omega: f64) -> f64 {
        self.evaluations += 1;
        self.responder.at_frequency(omega).map_or(f64::INFINITY, |g| largest_singular_value(&g))
    }

    /// The highest point found between two frequencies, from one inside: parabolas and golden sections.
    ///
    /// Source: Brent, *Algorithms for Minimization without Derivatives* (1973), ch. 5.
    pub fn climb(&mut self, low: f64, inside: (f64, f64), high: f64) -> (f64, f64) {
        let (mut a, mut b) = (low, high);
        let (mut x, mut fx) = inside;
        let (mut w, mut fw, mut v, mut fv) = (x, fx, x, fx);
        let (mut d, mut e) = (0.0f64, 0.0f64);
        for _ in 0..MOST_STEPS {
            let middle = 0.5 * (a + b);
            let tolerance = PLACE * x.abs().max(f64::MIN_POSITIVE);
            if (x - middle).abs() <= 2.0 * tolerance - 0.5 * (b - a) {
                break;
            }
            let mut golden = true;
            if e.abs() > tolerance {
                let r = (x - w) * (fx - fv);
                let q = (x - v) * (fx - fw);
                let (p, q) = ((x - v) * q - (x - w) * r, 2.0 * (q - r));
                let (p, q) = if q > 0.0 { (-p, q) } else { (p, -q) };
                if p.abs() < (0.5 * q * e).abs() && p > q * (a - x) && p < q * (b - x) {
                    e = d;
                    d = p / q;
                    let u = x + d;
                    if u - a < 2.0 * tolerance || b - u < 2.0 * tolerance {
                        d = tolerance.copysign(middle - x);
                    }
                    golden = false;
                }
            }
            if golden {
                e = if x < middle { b - x } else { a - x };
                d = GOLDEN * e;
            }
            let u = if d.abs() >= tolerance { x + d } else { x + tolerance.copysign(d) };
            let fu = self.at(u);
            if fu >= fx {
                if u < x {
                    b = x
                } else {
                    a = x
                }
                (v, fv, w, fw, x, fx) = (w, fw, x, fx, u, fu);
            } else {
                if u < x {
                    a = u
                } else {
                    b = u
                }
                if fu >= fw || w == x {
                    (v, fv, w, fw) = (w, fw, u, fu);
                } else if fu >= fv || v == x || v == w {
                    (v, fv) = (u, fu);
                }
            }
        }
        (x, fx)
    }
}

/// σ_max of a complex matrix: of a row or column its length.
pub(crate) fn largest_singular_value(g: &CMat) -> f64 {
    if g.nrows() == 0 || g.ncols() == 0 {
        return 0.0;
    }
    if g.nrows() == 1 || g.ncols() == 1 {
        return g.norm_l2();
    }
    let size = g.norm_max();
    if !(size > 0.0 && size.is_finite()) {
        return if size == 0.0 { 0.0 } else { f64::INFINITY };
    }
    // the Gram matrix of the smaller side: the largest value loses nothing by squaring
    let scaled = g * faer::Scale(C64::new(1.0 / size, 0.0));
    let gram = if g.nrows() < g.ncols() { &scaled * scaled.adjoint() } else { scaled.adjoint() * &scaled };
    let values = gram.self_adjoint_eigenvalues(faer::Side::Lower);
    values.ok().and_then(|v| v.last().copied()).map_or(f64::INFINITY, |v| size * v.max(0.0).sqrt())
}

/// What a number of frequencies is worth to look at: the poles' own, and those of their peaks.
pub(super) fn frequencies_of(poles: &[C64]) -> Vec<f64> {
    let mut all: Vec<f64> = poles
        .iter()
        .filter(|p| p.im >= 0.0)
        .flat_map(|p| {
            let peak = (p.im * p.im - p.re * p.re).max(0.0).sqrt();
            [p.norm(), p.im, peak]
        })
        .filter(|w| *w > 0.0 && w.is_finite())
        .collect();
    all.sort_by(f64::total_cmp);
    all.dedup_by(|a, b| (*a - *b).abs() <= 1e-14 * *b);
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_singular_value_is_that_of_the_svd() {
        for (r, c) in [(1, 4), (4, 1), (3, 5), (5, 3), (4, 4)] {
            let g = CMat::from_fn(r, c, |i, j| C64::new((3 * i + 5 * j) as f64, (7 * i * j) as f64 - 3.0));
            let expected = g.singular_values().unwrap()[0];
            assert!((largest_singular_value(&g) / expected - 1.0).abs() < 1e-14, "{r} × {c}");
        }
        assert_eq!(largest_singular_value(&CMat::zeros(2, 3)), 0.0);
        assert_eq!(largest_singular_value(&CMat::zeros(0, 3)), 0.0);
    }
}
