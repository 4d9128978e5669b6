//! Directions whose equations hold to more digits than the Schur complement's factor does.

use super::embedding::Direction;
use super::newton::{Newton, Rhs};
use super::scalar::{MatOf, Real, dot, norm};

/// Corrections of a direction, at most.
const REFINEMENTS: usize = 8;
/// Two of them that leave more than this share of what there was are the last.
const CREEP: f64 = 0.8;

impl<T: Real> Newton<'_, T> {
    /// Takes what is left of the first and the third equation away: GMRES with [`Self::solve`] before it, by which the other three
    /// hold. The Schur complement's rounding makes plain corrections creep where it is nearly singular.
    pub(super) fn refined(&self, mut found: Direction<T>, dual: Vec<T>, gap: T, enough: f64) -> Direction<T> {
        let size = |v: &[T]| norm(v);
        let mut first = dual;
        first.push(gap);
        let beta = size(&first);
        if !(beta > enough) {
            return found;
        }
        let over = |v: &[T], by: f64| -> Vec<T> { v.iter().map(|v| *v / T::of(by)).collect() };
        let mut basis = vec![over(&first, beta)];
        let mut directions: Vec<Direction<T>> = Vec::new();
        // R of the Hessenberg matrix by Givens rotations, and the right-hand side that turns with it
        let (mut r, mut turns, mut aim): (Vec<Vec<f64>>, Vec<[f64; 2]>, Vec<f64>) =
            (Vec::new(), Vec::new(), vec![beta]);
        let mut left = vec![beta];
        let zeros = |d: &[[MatOf<T>; 2]]| {
            d.iter().map(|[s, _]| MatOf::zeros(s.nrows(), s.ncols())).collect::<Vec<_>>()
        };
        for k in 0..REFINEMENTS {
            let v = &basis[k];
            let rhs = Rhs {
                dual: v[..v.len() - 1].to_vec(),
                primal: zeros(&found.blocks),
                gap: v[v.len() - 1],
                scaled: zeros(&found.blocks),
                kappa: T::of(0.0),
            };
            let d = self.solve(&rhs);
            let (dual, gap) = self.left(&d, &rhs);
            let mut w: Vec<T> = v.iter().zip(dual.iter().chain([&gap])).map(|(v, l)| *v - *l).collect();
            let mut h = Vec::new();
            for q in &basis {
                let share = dot(q, &w);
                w.iter_mut().zip(q).for_each(|(w, q)| *w -= share * *q);
                h.push(share.double());
            }
            let length = size(&w);
            for (j, [c, s]) in turns.iter().enumerate() {
                (h[j], h[j + 1]) = (c * h[j] + s * h[j + 1], c * h[j + 1] - s * h[j]);
            }
            let all = h[k].hypot(length);
            if !(all > 0.0 && all.is_finite()) {
                break;
            }
            let (c, s) = (h[k] / all, length / all);
            h[k] = all;
            let last = aim[k];
            aim[k] = c * last;
            aim.push(-s * last);
            turns.push([c, s]);
            r.push(h);
            directions.push(d);
            left.push(aim[k + 1].abs());
            let creeps = k > 0 && left[k + 1] > CREEP * left[k - 1];
            if !(aim[k + 1].abs() > enough) || length == 0.0 || creeps {
                break;
            }
            basis.push(over(&w, length));
        }
        let mut y = aim;
        y.truncate(directions.len());
        for k in (0..y.len()).rev() {
            y[k] /= r[k][k];
            for j in 0..k {
                y[j] -= y[k] * r[k][j];
            }
        }
        for (d, y) in directions.iter().zip(&y) {
            found = found.plus(d, T::of(*y));
        }
        found
    }
}
