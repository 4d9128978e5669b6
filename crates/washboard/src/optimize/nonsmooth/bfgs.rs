//! BFGS with a weak Wolfe search: on functions that are not smooth too, as long as no iterate meets a kink.

use super::simplex::dot;

/// A step must gain this share of what the slope promises.
const ENOUGH: f64 = 1e-4;
/// And the slope must have fallen to this share.
const FLATTER: f64 = 0.5;
/// Halvings and doublings of a step, at most.
const MOST_TRIES: usize = 50;
/// After so many, a step that gains is taken as it is: where kinks lie close the slope may never flatten.
const PATIENT: usize = 12;

/// When to stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BfgsSettings {
    /// Steps at most.
    pub iterations: usize,
    /// A value below this is enough.
    pub enough: f64,
    /// A gradient shorter than this is 0.
    pub flat: f64,
}

/// How it ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BfgsEnd {
    /// The value asked for is reached.
    Enough,
    /// The gradient vanishes.
    Flat,
    /// No step gains anything any more: at a kink, or at rounding.
    NoStep,
    /// All steps are made.
    Budget,
}

/// The lowest point.
#[derive(Debug, Clone, PartialEq)]
pub struct BfgsResult {
    /// Where.
    pub x: Vec<f64>,
    /// f there.
    pub value: f64,
    /// Evaluations of f and its gradient.
    pub evaluations: usize,
    /// Why it ended.
    pub end: BfgsEnd,
}

/// Minimises f from x: values and gradients by `of`, none where f is not defined, which counts as +∞.
///
/// The search is that of Lewis and Overton: bracketing and bisection until f(x + td) ≤ f + 10⁻⁴ t gᵀd and the slope at
/// x + td is at least half of gᵀd; it needs no smoothness, and the matrix learns a kink as a large curvature across it.
///
/// Source: Lewis and Overton, Math. Program. 141 (2013) 135–163.
pub fn bfgs(
    x: &[f64],
    settings: &BfgsSettings,
    mut of: impl FnMut(&[f64]) -> Option<(f64, Vec<f64>)>,
) -> Option<BfgsResult> {
    let n = x.len();
    let (mut x, mut evaluations) = (x.to_vec(), 1);
    let (mut f, mut g) = of(&x)?;
    let mut w = identity(n, 1.0);
    let mut fresh = true;
    let mut end = BfgsEnd::Budget;
    for _ in 0..settings.iterations {
        if f < settings.enough {
            end = BfgsEnd::Enough;
            break;
        }
        let length = dot(&g, &g).sqrt();
        if !(length > settings.flat) {
            end = BfgsEnd::Flat;
            break;
        }
        let mut d = times(&w, &g);
        d.iter_mut().for_each(|v| *v = -*v);
        let mut slope = dot(&g, &d);
        if !(slope < 0.0) {
            (w, fresh) = (identity(n, 1.0), true);
            d = g.iter().map(|v| -v).collect();
            slope = -length * length;
        }
        // the first step of a matrix that knows nothing is as long as x, or 1
        let mut t = if fresh { ((1.0 + dot(&x, &x).sqrt()) / length * 0.1).min(1.0) } else { 1.0 };
        let (mut low, mut high) = (0.0, f64::INFINITY);
        let mut found = None;
        for tries in 1..=MOST_TRIES {
            let next: Vec<f64> = x.iter().zip(&d).map(|(x, d)| x + t * d).collect();
            evaluations += 1;
            let tried = of(&next).filter(|(v, g)| v.is_finite() && g.iter().all(|v| v.is_finite()));
            match tried {
                Some((value, gradient)) if value <= f + ENOUGH * t * slope => {
                    let steep = dot(&gradient, &d) < FLATTER * slope;
                    let better =
                        found.as_ref().is_none_or(|(_, v, _): &(Vec<f64>, f64, Vec<f64>)| value < *v);
                    if better {
                        found = Some((next, value, gradient));
                    }
                    if !steep || value < settings.enough {
                        break;
                    }
                    low = t;
                }
                _ => high = t,
            }
            t = if high < f64::INFINITY { 0.5 * (low + high) } else { 2.0 * t };
            if high - low < 1e-15 * high || (tries >= PATIENT && found.is_some()) {
                break;
            }
        }
        let Some((next, value, gradient)) = found else {
            if fresh {
                end = BfgsEnd::NoStep;
                break;
            }
            (w, fresh) = (identity(n, 1.0), true);
            continue;
        };
        let s: Vec<f64> = next.iter().zip(&x).map(|(a, b)| a - b).collect();
        let y: Vec<f64> = gradient.iter().zip(&g).map(|(a, b)| a - b).collect();
        if fresh && dot(&s, &y) > 0.0 {
            w = identity(n, dot(&s, &y) / dot(&y, &y));
        }
        fresh = !update(&mut w, &s, &y) && fresh;
        (x, f, g) = (next, value, gradient);
    }
    if f < settings.enough {
        end = BfgsEnd::Enough;
    }
    Some(BfgsResult { x, value: f, evaluations, end })
}

/// s I, row after row.
pub(super) fn identity(n: usize, s: f64) -> Vec<f64> {
    (0..n * n).map(|k| if k / n == k % n { s } else { 0.0 }).collect()
}

/// W v.
pub(super) fn times(w: &[f64], v: &[f64]) -> Vec<f64> {
    w.chunks_exact(v.len().max(1)).map(|row| dot(row, v)).collect()
}

/// The inverse matrix after a step s along which the gradient changed by y; false and unchanged where sᵀy ≤ 0.
pub(super) fn update(w: &mut [f64], s: &[f64], y: &[f64]) -> bool {
    let n = s.len();
    let sy = dot(s, y);
    if !(sy > 1e-14 * dot(s, s).sqrt() * dot(y, y).sqrt() && sy.is_finite()) {
        return false;
    }
    let wy = times(w, y);
    let factor = (1.0 + dot(y, &wy) / sy) / sy;
    for (i, row) in w.chunks_exact_mut(n).enumerate() {
        for (j, v) in row.iter_mut().enumerate() {
            *v += factor * s[i] * s[j] - (wy[i] * s[j] + s[i] * wy[j]) / sy;
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rosenbrocks_valley_with_a_kink_along_it() {
        // 8 |x₁² − x₂| + (1 − x₁)²: 0 at (1, 1)
        let of = |x: &[f64]| {
            let r = x[0] * x[0] - x[1];
            let s = 8.0 * r.signum();
            Some((8.0 * r.abs() + (1.0 - x[0]).powi(2), vec![2.0 * s * x[0] - 2.0 * (1.0 - x[0]), -s]))
        };
        let settings = BfgsSettings { iterations: 500, enough: f64::NEG_INFINITY, flat: 0.0 };
        let found = bfgs(&[-1.3, 0.7], &settings, of).unwrap();
        assert!(found.value < 1e-6, "{found:?}");
    }

    #[test]
    fn a_quadratic_is_solved_in_a_few_steps_and_a_wall_is_not_crossed() {
        let of = |x: &[f64]| {
            let d = [x[0] - 2.0, 10.0 * (x[1] + 1.0)];
            (x[0] < 2.5).then(|| (0.5 * dot(&d, &d), vec![d[0], 10.0 * d[1]]))
        };
        let settings = BfgsSettings { iterations: 100, enough: f64::NEG_INFINITY, flat: 1e-10 };
        let found = bfgs(&[0.0, 0.0], &settings, of).unwrap();
        assert!(found.end == BfgsEnd::Flat && found.evaluations < 60, "{found:?}");
        assert!((found.x[0] - 2.0).abs() < 1e-9 && (found.x[1] + 1.0).abs() < 1e-9, "{found:?}");
        assert!(bfgs(&[3.0, 0.0], &settings, of).is_none());
    }

    #[test]
    fn where_the_slope_never_flattens_a_gain_is_enough() {
        // down to a wall at 1: bisection alone would go on to rounding
        let of = |x: &[f64]| (x[0] < 1.0).then(|| (-x[0], vec![-1.0]));
        let settings = BfgsSettings { iterations: 1, enough: f64::NEG_INFINITY, flat: 0.0 };
        let found = bfgs(&[0.0], &settings, of).unwrap();
        assert!(found.evaluations <= 13 && found.x[0] > 0.9, "{found:?}");
    }
}
